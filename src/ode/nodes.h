// The motion of a linkage with ideal joints at equally spaced times, the nodes, to high order: from
// several worlds side by side that reach each node in different steps.
#pragma once

#include "model/scenario.h"
#include "ode/plane/world.h"

enum {
    NODES_LEVEL_MAX = 6,
    NODES_KEPT = 6, // the newest ones
};

// One world and its steps.
typedef struct NodesLevel {
    World world;
    size_t steps_a_node;
    double step_s;
    double weight;  // 1, of its motion in the nodes'
    long index;     // steps from time zero to where its speeds stand
    double *turned; // rad, angles half a step later: what whole turns they have; owned
} NodesLevel;

// One body at one node.
typedef struct NodeState {
    double position[3]; // x and y of the centre of mass, m; angle, rad, not wrapped
    double speed[3];    // m/s, m/s, rad/s
} NodeState;

typedef struct Nodes {
    const Scenario *scenario;
    double interval_s; // from node to node
    size_t level_count;
    NodesLevel levels[NODES_LEVEL_MAX];
    bool is_started;
    size_t steps; // of all worlds so far
    long next;    // number of the node that comes next; number zero is at time zero
    size_t kept;  // nodes kept of those before it
    NodeState *states[NODES_KEPT]; // at those, in order; not of the driven body; owned
    Motion *motions;               // to work with; owned
} Nodes;

// Builds the worlds. From node to node it is as long as the scenario's step times the steps that
// all worlds together take there. The nodes must be zeroed, must not be copied, and are to be
// finished after a failure too.
bool nodes_init(const Scenario *scenario, Nodes *nodes, Err *err);
void nodes_finish(Nodes *nodes);

// Works out the next node. The first one is two intervals before time zero, or later where the
// linkage cannot be followed back that far. Fails with ERR_SOLVER where a step of a world does.
bool nodes_advance(Nodes *nodes, Err *err);
