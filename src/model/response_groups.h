// The bodies of a linkage in groups that ideal joints hold together: what acts in a joint with play
// moves the groups of its bodies, and no others.
#pragma once

#include "model/response.h"

typedef struct ResponseGroups {
    size_t count;
    size_t *group_of;   // by body; `count` of the driven body. Owned, as are all arrays
    size_t *first_body; // of a group, and behind the last one
    size_t *bodies;
    size_t *first_place; // likewise: the places that have one of its bodies
    size_t *places;
    size_t *first_node; // likewise: the ideal joints as nodes of the response's matrix, in the
                        // order of their elimination
    size_t *nodes;
    int *joints;         // of these nodes
    size_t *first_block; // likewise: the blocks of the response in the columns of these nodes; NULL
                         // of a response in space
    size_t *blocks;
} ResponseGroups;

// Ideal joints as nodes of a response's matrix, and behind them places: the joint of each.
typedef struct ResponseNodes {
    const Linkage *linkage;
    const Sparse *matrix;
    size_t ideal;
    size_t count;
    const int *joints;
} ResponseNodes;

void response_groups_make(const ResponseNodes *nodes, ResponseGroups *groups);

// The same of a response in the plane.
void response_groups_init(const Response *response, ResponseGroups *groups);
void response_groups_finish(ResponseGroups *groups);

// Some groups, and the places in which impulses act; their bodies are in the groups.
typedef struct ResponsePart {
    size_t group_count;
    size_t *groups;
    size_t place_count;
    size_t *places;
} ResponsePart;

// Takes the response of the groups of a part at the positions of the motions, as response_place
// does for all; of the part's places, the bodies of those on lines or limits have motions, too.
// Returns false where ideal joints are redundant there. Only response_groups_apply with such a part
// may be asked afterwards.
bool response_groups_place(Response *response, const ResponseGroups *groups,
                           const ResponsePart *part, const Motion *motions);

// Writes by how much impulses in the places of a part, by row of play, change the velocities of its
// groups' bodies: x, y, angle, three a body. Returns the impulses in all rows, of which those of
// the groups' ideal joints are right until the response is used again.
const double *response_groups_apply(const Response *response, const ResponseGroups *groups,
                                    const ResponsePart *part, const double *impulses,
                                    double *changes);
