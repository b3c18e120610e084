// The equations of motion of a linkage with play in the plane, in the coordinates of its tree,
// contacts as smooth forces while their mode is frozen.
#pragma once

#include "contact/touch.h"
#include "model/forces.h"
#include "reference/plane/articulated.h"
#include "reference/plane/tree.h"
#include "reference/system.h"

// Where a contact's bodies touch.
typedef struct PlaneSite {
    Touch touch;
    int pair;         // of the tree: the ends that its distance is measured between
    bool acts_beside; // whether the force's line may pass beside these ends: on a line, between
                      // teeth, and with friction
    double end; // rad or m, of a turn or teeth: gap = sign of the site (tree_coordinate) - end
} PlaneSite;

// A contact's quantities at one instant.
typedef struct ContactForce {
    Press press;
    TouchPose pose;
    Vec2 force;     // N, on body b, friction included
    double couple;  // N m, on body b, of a turn, which has no force
    double sliding; // m/s, with friction: body b against body a, at right angles to the normal
    double bending; // m/s, of the bristle, where it has one
} ContactForce;

// The friction of an ideal joint at one instant (reference/plane/rub.c).
typedef struct RubState {
    double speed;    // rad/s or m/s
    double share;    // 1, of what it may hold
    double bending;  // rad/s or m/s, of its bristle
    double friction; // N m or N, against the sliding
    double pressing; // N m or N, what sliding holds
    Vec2 press;      // N, what presses
} RubState;

// Everything at one instant.
typedef struct DynamicsState {
    SystemState shared;     // the first
    TreeState tree;         // accelerations filled in
    ContactForce *contacts; // by contact
    Vec2 *reactions;        // N, on body b, of ideal joints
    double *couples;        // N m, on body b, of prismatic joints, about its anchor
    RubState *rubs;         // by ideal joint with friction
    double drive_power;     // W, of all drives, or a torque
    double load_power;      // W, of loads
    double damping_power;   // W, that the dampers take
} DynamicsState;

// The forces on the bodies at one instant, while they are gathered.
typedef struct Loads {
    ArticulatedPush *pushes;               // by body: at the centre, and the moment about it
    double driven_power;                   // W, of all forces on driven bodies but the drives'
    Vec2 driven_forces[LINKAGE_DRIVE_MAX]; // N, their sum on each
} Loads;

// The ways in which a contact pushes: along x, along y, and by friction.
enum { DYNAMICS_PUSHED = 3 };

// Room to work in.
typedef struct DynamicsRoom {
    DynamicsState *state;
    Loads loads;
    ArticulatedPush *zeros; // by body
    BodyLoad *added;        // by body
    double *sides;          // of the loops' rows
    double *solved;         // by coordinate, then by row of a loop
    double *closed;         // an integrator's vector
    // of the slopes, by coordinate
    Vec2 *row;
    double *arms;
    double *pushed[DYNAMICS_PUSHED];
} DynamicsRoom;

typedef struct Hinged Hinged;   // of reference/plane/hinged.h
typedef struct RubRoom RubRoom; // of reference/plane/rub.c

typedef struct Dynamics {
    System system; // the first
    Tree tree;
    Articulated *articulated; // owned
    Hinged *hinged;           // owned; NULL where it has no such rates
    RubRoom *rub;             // owned; NULL where no ideal joint has friction
    size_t rub_count;         // of the system's bristles those of ideal joints, the first
    int *bristle_of;          // by contact: its bristle, or -1
    void *memory;             // owned; where all arrays are
    PlaneSite *sites;         // by contact
    double *reach;            // m, of each body's points
    Vec2 *weights;            // N, of each body
    bool has_forces;          // whether springs, dampers or a torque act
    bool may_branch;          // whether loops move freely, and may come to a change point
    bool is_near_branch;      // whether it was near one where the present step began
    double start_energy;      // J, of such a linkage: what it has, less what it was given
    double greatest_energy;   // J, kinetic, so far
    double energy_floor;      // J, the least that is no rounding
    DynamicsRoom room;
} Dynamics;

// The forces of the contacts in the coordinates of a tree.

// One contact's quantities from the state of the tree and the integrator's vector.
void dynamics_contact_find(const Dynamics *dynamics, size_t number, const TreeState *state,
                           const double *y, ContactForce *force);

// The points of body a and of body b at which the force acts, seen from the ends of the contact's
// pair; of two circles without friction the ends themselves.
static inline void dynamics_contact_points(const PlaneSite *site, const TouchPose *pose,
                                           Vec2 *from_a, Vec2 *from_b)
{
    *from_a = *from_b = (Vec2){0.0, 0.0};
    if (site->acts_beside) {
        touch_points(&site->touch, pose, from_a, from_b);
    }
}

// How a pin is to the walls of its slot.
WallPlace dynamics_wall(const Tree *tree, const TreeState *state, const PlaneSite *site,
                        const Contact *contact);

// The pair of the tree between whose ends the gap of a contact is measured: in a slot that of the
// wall that it meets.
int dynamics_contact_pair(const Tree *tree, const PlaneSite *site, ContactWall wall);

// A follower at the profile of a cam.
CamPose dynamics_cam(const Tree *tree, const TreeState *state, const PlaneSite *site);

// Fills in the contacts and their sites, for which there is room. Fails with ERR_CASE where a law
// does not fit a joint.
bool dynamics_list_sites(const Scenario *scenario, Dynamics *dynamics, Err *err);

// A flank of a pair of gears.
MeshFlank dynamics_flank(const Tree *tree, const TreeState *state, const PlaneSite *site);

// Whether a contact's gap is that of an angle or of teeth.
static inline bool dynamics_contact_is_turn(const PlaneSite *site)
{
    return touch_is_end(&site->touch);
}

// The second rate of a contact's gap, m/s^2, after tree_accelerate.
double dynamics_contact_second(const Dynamics *dynamics, size_t number, const TreeState *state,
                               const TouchPose *pose);

// Velocity of the point of an end's body that lies beside the end.
static inline Vec2 dynamics_contact_velocity(const Tree *tree, const TreeState *state, int end,
                                             Vec2 beside)
{
    const int body = tree->end_bodies[end];
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Motion *motion = &state->motions[body];
    const Vec2 arm = vec2_add(state->arms[end], beside);
    return vec2_add(motion->velocity, vec2_scale(motion->omega, vec2_perp(arm)));
}

// The forces on the bodies at one instant, while they are gathered.

// A force on the body of an end, beside the end.
static inline void dynamics_load_end(const Tree *tree, const TreeState *state, int end, Vec2 beside,
                                     Vec2 force, Loads *loads)
{
    const int body = tree->end_bodies[end];
    if (body == LINKAGE_GROUND) {
        return;
    }
    const int drive = tree_drive_of(tree, body);
    if (drive >= 0) {
        loads->driven_power += vec2_dot(force, dynamics_contact_velocity(tree, state, end, beside));
        loads->driven_forces[drive] = vec2_add(loads->driven_forces[drive], force);
        return;
    }
    ArticulatedPush *push = &loads->pushes[body];
    push->force = vec2_add(push->force, force);
    push->moment += vec2_cross(vec2_add(state->arms[end], beside), force);
}

// A couple on a body.
static inline void dynamics_load_couple(const Tree *tree, const TreeState *state, int body,
                                        double couple, Loads *loads)
{
    if (tree_drive_of(tree, body) >= 0) {
        loads->driven_power += couple * tree_omega(state, body);
    } else if (body != LINKAGE_GROUND) {
        loads->pushes[body].moment += couple;
    }
}

// Fails with ERR_CASE where a contact law does not fit a joint.
bool dynamics_init(const Scenario *scenario, Dynamics *dynamics, Err *err);
void dynamics_finish(Dynamics *dynamics);

// Room for a state of these equations; the caller frees it.
DynamicsState *dynamics_state_create(const Dynamics *dynamics);

// Times, s, and coordinates are those since the base of the tree.
//
// The state at a time from the integrator's vector, and the rates of that, which may be NULL: those
// of loops as open as they are. Returns false where the accelerations are not determined.
bool dynamics_evaluate(const Dynamics *dynamics, double since_s, const double *y,
                       DynamicsState *state, double *rates);

// From the forces on the bodies, in the room: the coordinates' second rates; and with the
// accelerations and reactions from them. `again` is as of articulated_accelerate_again.
bool dynamics_solve(const Dynamics *dynamics, bool again, const DynamicsState *state,
                    const Loads *loads);
bool dynamics_react(const Dynamics *dynamics, bool again, DynamicsState *state, Loads *loads);

// Rates of the integrator's vector; NaN where they are not determined. The context is a Dynamics.
void dynamics_rates(double since_s, const double *y, double *rates, void *context);

// What closing the loops of the tree needs.
LoopsRoom dynamics_loops(const Dynamics *dynamics);

// One contact at a time, for events: cheaper than the whole state. Only the bodies that move it are
// evaluated.
ContactForce dynamics_contact(const Dynamics *dynamics, size_t contact, double since_s,
                              const double *y);

// The same of the walls of its slot.
WallPlace dynamics_contact_wall(const Dynamics *dynamics, size_t contact, double since_s,
                                const double *y);

// Writes the coordinates of a Dynamics that this depends on. Returns how many there are; 0 where it
// depends on all.
size_t dynamics_contact_needs(const System *system, size_t contact, size_t *coordinates);

// How the contacts' forces change the accelerations with the coordinates and their rates.

// Writes the derivatives of the accelerations at a state by the coordinates, 1/s^2, and by their
// rates, 1/s, as matrices of its coupling; only those that the forces of pressing contacts cause,
// with the geometry frozen. What is left out changes as slowly as the mechanism itself moves. NaN
// where the accelerations are not determined. The context is a Dynamics.
void dynamics_slopes(double since_s, const double *y, double *by_position, double *by_rate,
                     void *context);

// The friction of ideal joints.

// What presses on a joint: of a pivot the reaction, N; of a guide x the force across it, N, and y
// the force at each end of its length that its moment makes, twice. Of a guide one of four faces
// presses most: x, -x, y, -y.
typedef struct RubPress {
    Vec2 of;
    double most; // N
} RubPress;

// Lists the ideal joints with friction, and the contacts whose friction has bristles, among those
// of the system, for which there is room.
void rub_list(const Scenario *scenario, Dynamics *dynamics);

// Room to work in, for so many; rub_destroy frees it, and accepts NULL.
RubRoom *rub_create(const Dynamics *dynamics);
void rub_destroy(RubRoom *room);

// Solves for the coordinates' second rates, as dynamics_react does, with the friction that what
// presses in the joints makes, which that friction changes: fills in the rubs of the state and adds
// them to the loads. Returns false where the accelerations, or what presses, are not determined.
bool rub_solve(const Dynamics *dynamics, const double *y, bool are_closed, DynamicsState *state,
               Loads *loads);

// The joint whose friction had no single answer in the last rub_solve that failed; -1: none.
int rub_jammed(const Dynamics *dynamics);

// What the events of a bristle need (reference/system.h).
BristleAt rub_bristle(const Dynamics *dynamics, size_t number, double since_s, const double *y);
BristleFace rub_face(const Dynamics *dynamics, size_t number, double since_s, const double *y);
void rub_stick(Dynamics *dynamics, size_t number, const double *y);
void rub_hold(Dynamics *dynamics, double *y);

// The bristle of a contact as its law has it where it presses with a force, N.
BristlePair dynamics_contact_bristle(const Dynamics *dynamics, size_t number, double normal);

// The rates of a mechanism whose bodies hang on hinges, or on nothing, and touch at pins in their
// holes alone: what most mechanisms with play are, and what an integrator asks for most.
//
// The same numbers as those of reference/plane/dynamics.c, to the last bit, from the same
// operations in the same order; but everything of a body stands in one place, and nothing is worked
// out that rates do not need: no angles and positions, no pin that is apart from its wall.

// Prepares the rates of these equations, which must outlive it; hinged_destroy frees it, and
// accepts NULL. Returns NULL where they are of another kind: with loops, slides, springs, dampers
// or torques, friction, or sites that are no pins in holes.
Hinged *hinged_create(const Dynamics *dynamics);
void hinged_destroy(Hinged *hinged);

// Writes rates of the integrator's vector. Returns false where they are not determined, or where
// the drive's speed changes, which is not for here.
bool hinged_rates(const Hinged *hinged, double since_s, const double *y, double *rates);

// Fills in a state and, where asked for, the rates of the integrator's vector there (else NULL).
// Returns false where the second rates are not determined. The drive's speed must be steady.
bool hinged_evaluate(const Hinged *hinged, double since_s, const double *y, DynamicsState *state,
                     double *rates);

// Writes the bodies' positions and velocities; their accelerations stay as they are.
void hinged_motions(const Hinged *hinged, double since_s, const double *y, Motion *motions);
