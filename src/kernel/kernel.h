// The contact kernel: contacts integrated by themselves, in local steps of their own, within one
// step of the world. In go the rows of relative motion at the contacts, their mobility and free
// acceleration; out come impulses, their integrals (moments), forces and losses, at nodes between
// which they can be evaluated. It knows neither mechanisms nor the engine that moves the bodies.
//
// Each contact point has rows of its own. Of a pin in its hole: x and y of the pin's centre less
// the hole's, and with friction the turns of the hole's and of the pin's body; of two discs
// likewise. Of a circle on a line: the gap along the line's normal, and the sliding along it. Of a
// pin in a slot: its centre in the slot's own axes, across and along, from its middle; its turns
// are felt at the wall with one arm, for these rows compare it with the slot's point under it. In
// space x and y are across the pin's axis, and friction also has rows for the sliding along the
// axis and for the turns of both bodies about x and y. With u the rows, W their mobility, g their
// free acceleration and f the contacts' forces,  u'' = g + W f, where W and g may change in the
// step (kernel/motion.c).
#pragma once

#include "base/carry.h"
#include "kernel/contact_state.h"
#include "kernel/force_law.h"
#include "kernel/pin_hole.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// What a circle of body b touches on body a.
typedef enum KernelShape {
    KERNEL_HOLE, // it is inside a circle
    KERNEL_DISC, // it is outside a circle
    KERNEL_LINE, // it is on one side of a line; also of any gap that is a row by itself
    KERNEL_SLOT, // it is inside a slot with two ends (kernel/pin_hole.h)
} KernelShape;

enum {
    KERNEL_ROWS_PLAIN = 2, // of a contact without friction
    KERNEL_ROWS_PLANE = 4, // with friction in the plane
    KERNEL_ROWS_MOST = 9,  // with friction in space
};

// The rows of a contact with friction, after those of its position: turns about the pin's axis of
// the hole's and of the pin's body, and in space the sliding along the axis, and the turns of both
// about x and y.
enum {
    KERNEL_ROW_TURN = 2,
    KERNEL_ROW_AXIAL = 4,
    KERNEL_ROW_HOLE = 5,
    KERNEL_ROW_PIN = 7,
};

// The part of a slot's wall that a contact is at while it touches in a run: its force is smooth
// there, beyond the end of the part as well, and a local step ends where the part does.
typedef enum KernelPart {
    KERNEL_PART_NEAREST, // whichever is there: of what does not touch, of other shapes, and after a
                         // run
    KERNEL_PART_WALLS,   // the straight ones
    KERNEL_PART_LOW,     // the arc at the end that comes first along the slot
    KERNEL_PART_HIGH,    // and the one that comes last
} KernelPart;

// One contact point. The first eight are given, and the state where it touches already as it is
// added; the rest lives on from one step to the next. A disc outside another is a hole of negative
// size: the same formulas hold for both.
typedef struct KernelContact {
    ForceLaw law;
    KernelShape shape;
    double radial_clearance; // m; of a disc less than 0, minus the sum of the radii; not of a line
    double hole_radius;      // m; of a disc minus the radius of that on body a; not of a line; of a
                             // slot half its width
    double half_length;      // m, of a slot's middle line
    int joint;               // contacts of one joint have the same number, and follow each other
    int siblings[2];         // the first and the last contact that can touch together with this
                             // one, counted from here; 0 and 0 where there is none
    bool is_rub;             // whether it is the friction of an ideal joint (KernelRub)
    bool has_friction;
    bool has_bristle; // whether that holds
    size_t first_row;
    size_t row_count;
    ContactState state;
    KernelPart part;
    double frequency;       // rad/s, of its oscillation at the depth to be expected; 0 of a contact
                            // that was set touching and has not been looked at yet
    double force_per_speed; // N s/m: the force to be expected of a closing speed
    double tolerance;       // 1: error of the force in a local step that is allowed, relative to it
    double first_width_s;   // of the first local step of a contact, and of the last
    double mobility_before[3]; // 1/kg: of its first two rows in the step before
    bool is_overdamped;        // its damping stops the pin long before its spring would
} KernelContact;

// How an ideal joint slides at a point.
typedef struct KernelRubbing {
    double sliding;    // m/s, rad/s
    double rate;       // its rate
    double share;      // of what sliding holds, 1
    double share_rate; // 1/s
    double pressing;   // N
    double way[2];     // in which the reaction presses
    double pushed[2];  // N/s, what forces and impulses in the rows make it grow by
} KernelRubbing;

// The friction of an ideal joint that turns or slides, which grows with the joint's reaction. It is
// a contact that touches always, at a line whose gap is the joint's coordinate less what it never
// comes to, and all of it acts in the first row. With R the reaction at a time t in the step, f the
// forces in all rows and P their impulses,
//     R = R_m + R'_m (t - h/2) + (A + A' (t - h/2)) f + B P,   friction  T = s a N,   N = |R|, or
//     of a guide its
// larger part; s the share that is held, a the arm, as `law.friction` has it. What f holds of such
// frictions is in R as well (kernel/rubs.c). A local step ends where another part presses.
typedef struct KernelRub {
    size_t contact;
    bool is_guide;
    int face;              // of a guide: which part presses, x or y, forth or back
    double steady;         // N, that N is always; 0: as the reaction has it
    double alone;          // 1/kg, 1/(kg m^2): mobility of its two bodies without their joints
    double reaction[2];    // R_m: N, of a guide N across and the couple over half its length
    double rate[2];        // R'_m, N/s
    const double *answers; // A: by row of the kernel, two numbers each; not owned
    const double *turning; // A', 1/s, likewise
    const double *late;    // B, 1/s, likewise
    double most;           // what it would hold as it was found last, N or N m; 0: nothing yet
    bool is_new;           // whether there has been no run yet
    bool is_damped;        // whether the damping of its bristle has been found
    KernelRubbing at;      // where it was looked at last
} KernelRub;

// Contacts that are integrated together.
typedef struct Kernel {
    size_t contact_count;
    KernelContact *contacts; // owned, as are all arrays
    size_t row_count;        // all contacts together
    int *contact_of;         // of a row: which of the contacts here
    size_t contact_room;     // of these arrays
    bool has_bristles;       // whether the friction of any of them holds
    size_t rub_count;        // of these that are frictions of ideal joints
    KernelRub *rubs;         // these; owned
    size_t row_room;
    double phase;        // rad of a contact's oscillation in one local step; 0: as many as suit
    double stiff_phase;  // rad, likewise, where steps are implicit
    double stable;       // time constants of a contact's damping in an explicit local step, at most
    double longest_s[2]; // of the next explicit step, of order 4 and 5
    double duration_before_s;      // of the step of the world before; 0: there was none
    struct ImplicitStages *stages; // of implicit steps; NULL before the first
    struct KernelWork *work;
    double stiff_width_s; // of the next implicit step; 0 where a contact has just begun

    // of the step under way, to be filled in before kernel_run
    double *mobility; // row by row: all of a row, or what is next to its diagonal
    size_t reach;     // rows further apart do not move each other
    size_t pitch;     // of `mobility`: between what two neighbouring rows have in one column
    size_t origin;    // likewise: of the first row and column
    double *drift;    // of few rows: how the mobility changes, 1/(kg s), laid out as it is; NULL
                      // where it is taken as constant in the step
    double *mobility_rate; // likewise, in the whole: what kernel_set_drift makes of it
    double *free_rate;     // how the free acceleration changes by itself; NULL with `drift`
    double middle_s;       // since the start: when mobility and free acceleration are as given
    double *free;          // acceleration while nothing acts
    double *position;      // at the start, m; of a line the gap and 0; not of turns
    double *speed;         // at the start, m/s, rad/s
    size_t event_most;  // times in a step at which contacts may begin or end, until it is given up
    size_t event_count; // so far in the step
    struct KernelInput *input; // what contacts outside do to the rows; NULL: nothing. Not owned

    // what came of it: nodes, the first at the start, two where a contact begins or ends
    size_t node_count;
    size_t node_room;
    double *times;      // s, since the start
    double *values;     // by node: impulse, its integral over time, that one's, force; each by row
    double *closings;   // by node: closing speeds, m/s, of all contacts; 0 where one does not touch
    double *losses;     // by node: J lost in damping and in friction since the start
    uint64_t *touching; // by node: which contacts touch from there on, a word for each 64
    size_t evaluations; // of the forces, since the beginning
    double work_done;   // since it was set to 0: operations on one pair of rows
    double work_most;   // at which a step is given up; 0: never
} Kernel;

// How one contact is at an instant, in its first two rows. The size of the eccentricity is less
// than 0 of a disc and infinite of a line, and of a slot between its ends.
typedef struct KernelPose {
    PinHole pose;
    Vec2 force; // N, on the pin, friction included
    bool is_touching;
} KernelPose;

// A kernel of no contacts yet.
Kernel kernel_start(double phase);

// Adds a contact, of which the first eight members are given, with its rows:
// KERNEL_ROWS_PLAIN, or more of one with friction, but for a line's. Where it is the friction of an
// ideal joint, what the reaction is like is to be written to the kernel's last rub, before a run
// but for what a run finds. A kernel with such is no island's.
void kernel_add(Kernel *kernel, const KernelContact *contact, size_t rows);

// Makes room for what a step is given, once all contacts are there: mobilities, all zero, between
// rows that are no further apart than `reach`.
void kernel_make_room(Kernel *kernel, size_t reach);

// Carries all that lives on from step to step.
void kernel_carry(Kernel *kernel, Carry *carry);

// Makes room for positions, speeds and free accelerations alone, of one that is not run.
void kernel_make_rows(Kernel *kernel);
void kernel_finish(Kernel *kernel);

// The mobility of two rows no further apart than `reach`, by their numbers.
static inline double *kernel_mobility(const Kernel *kernel, size_t row, size_t column)
{
    return kernel->mobility + kernel->origin + row * kernel->pitch + column;
}

// Counts what one evaluation of the forces takes: of each row a force of its law, about as much as
// on so many pairs of rows, and what it does to the others.
enum { KERNEL_ROW_WORK = 64 };
static inline void kernel_count_work(Kernel *kernel)
{
    const double rows = (double)kernel->row_count;
    kernel->work_done += rows * (KERNEL_ROW_WORK + fmin(rows, 2.0 * (double)kernel->reach + 1.0));
}

// The number of rows, all contacts together.
size_t kernel_rows(const Kernel *kernel);

// Of a kernel whose rows all move each other: room for a mobility that changes in the step.
void kernel_make_drift(Kernel *kernel);

// Lets the mobility that has been filled in change in the step to come, of a length, s, about its
// middle: `drift` is S, row by row, 1/(kg s), with which the mobility grows by S + S' and an
// impulse P adds 2 S P to the rows' accelerations (kernel/motion.c). These change by
// themselves, too, as has been written to `free_rate`.
void kernel_set_drift(Kernel *kernel, const double *drift, double duration);

// Integrates a step of a length, s. Returns false where that takes more local steps than there can
// be sense in, or more events than are allowed.
bool kernel_run(Kernel *kernel, double duration);

// Impulses and their integrals over time, by row, and the losses, from the start to a time in the
// step, and the forces then.
typedef struct KernelSums {
    double *impulse;   // N s, N m s; owned, as the next two
    double *moment;    // N s^2: integral of the impulse, by row, then that of the integral, N s^3
    double *force;     // N, N m
    double dissipated; // J
    double friction;   // J
} KernelSums;

// Sums of so many rows, all zero.
KernelSums kernel_sums(size_t rows);
void kernel_sums_free(KernelSums *sums);

// What a node has in all rows: impulses, their integrals, these ones' integrals, and forces.
static inline const double *kernel_node_values(const Kernel *kernel, size_t node)
{
    return kernel->values + 4 * kernel->row_count * node;
}

static inline const double *kernel_node_forces(const Kernel *kernel, size_t node)
{
    return kernel_node_values(kernel, node) + 3 * kernel->row_count;
}

// The sums at a time between two neighbouring nodes, of which `node` is the first.
void kernel_at(const Kernel *kernel, size_t node, double time_s, KernelSums *sums);

// The same of no more rows than where one contact is depends on, and without losses.
void kernel_around(const Kernel *kernel, size_t contact, size_t node, double time_s,
                   KernelSums *sums);

// The same of the rows of one contact alone: impulses, their moments and forces, by row of it.
void kernel_contact_at(const Kernel *kernel, size_t contact, size_t node, double time_s,
                       double *impulse, double *moment, double *force);

// The pose of one contact there, from the sums at the same time.
KernelPose kernel_pose(const Kernel *kernel, size_t contact, size_t node, double time_s,
                       const KernelSums *sums);

// The node at or before a time: the last of several at that time.
size_t kernel_node(const Kernel *kernel, double time_s);

// Whether a contact touches from a node on, and whether any does.
static inline bool kernel_touches(const Kernel *kernel, size_t node, size_t contact)
{
    const size_t words = (kernel->contact_count + 63) / 64;
    return (kernel->touching[node * words + contact / 64] >> contact % 64 & 1) != 0;
}
bool kernel_touches_any(const Kernel *kernel, size_t node);

// The rate of a row, m/s or rad/s, after impulses and their integrals.
double kernel_motion_speed(const Kernel *kernel, size_t row, double time_s, const double *impulse,
                           const double *moment);

// The pose of a contact whose first two rows are where they are and go as fast as that.
PinHole kernel_motion_pose_of(const Kernel *kernel, size_t contact, const double position[2],
                              const double speed[2]);

// of the step of the world: nodes nearer to each other have a force that is linear between them
static const double KERNEL_LINEAR_WIDTH = 1e-7;

// Contacts of a mechanism with many of them, integrated apart where they do not feel each other
// within a step: each island of contacts by itself, in local steps of its own.
//
// A contact is active in a step if it touches in it, or may. Its impulses move its partners, the
// contacts with a mobility from it. An island is a set of active contacts that are connected so, or
// a block of one where that is large (kernel/islands.c). All other contacts fly, pushed by their
// partners.

// Which contacts move which: those of contact i are partners[first_partner[i]] up to before
// partners[first_partner[i + 1]], in order, itself among them; and the mobility between two of
// them, row by row, of the later one's rows from the other's.
typedef struct KernelCoupling {
    const size_t *first_partner;
    const size_t *partners;
    const double *(*block)(const void *context, size_t member, size_t other);
    const void *context;
} KernelCoupling;

// Writes the mobilities of a kernel that consists of some contacts, in order, or of all (NULL).
void kernel_fill(Kernel *kernel, const KernelCoupling *coupling, const size_t *members);

// How far apart rows of a kernel of some contacts are at most that move each other.
size_t kernel_coupling_reach(const KernelCoupling *coupling, const Kernel *kernel,
                             const size_t *members);

enum {
    // active contacts of an island, and events in a step of a larger one, up to which it is not
    // divided
    KERNEL_UNDIVIDED_MOST = 48,
    KERNEL_UNDIVIDED_EVENTS_MOST = 24,
};

// One island, or a block of one.
typedef struct KernelIsland {
    Kernel kernel;   // of its contacts
    size_t *members; // by contact of it: its number among all, in order; owned
    bool is_run;     // in this step
    size_t node;     // of the time that was looked at last
    KernelSums sums; // then
    double look_s;
    // of a block of a larger island
    struct KernelInput *input; // what the others do to it; NULL of one that never was a block
    bool *is_boundary;         // by contact: whether it moves contacts of others; owned
    double longest_s[2];       // of the next explicit and implicit step, as the step began
    double stiff_width_s;
} KernelIsland;

typedef struct KernelIslands {
    Kernel *all; // contacts and their rows, of all islands: what lives on from step to step
    KernelCoupling coupling;
    size_t count;
    KernelIsland **islands;   // of this step; owned, as are all arrays
    KernelIsland **kept;      // by contact: the island that begins with it in this step or the last
    size_t *island_of;        // by contact: its number, or `count`
    size_t *number_in;        // by contact: which of its island's it is
    bool *is_active;          // by contact
    double *pushes;           // m/s, by contact: how fast others may make one that flies
    size_t *joined;           // by contact, of contacts that belong together
    double (*longest_s)[2];   // by contact: of the next explicit step
    double duration_before_s; // of the step before
    size_t undivided_most;    // active contacts of an island that is not divided, whatever happens
    size_t events_most;       // of a larger one, events in a step up to which it is not divided
    size_t *clusters;         // by contact: which may be in one block
    size_t *parents;          // by contact: the first of those that belong together
    bool *is_divided;         // by contact: whether it is in a block of its island
    bool *is_to_divide;       // by contact: whether its island had too many events in this step
    bool *is_kept_whole;      // by contact: whether its blocks have not agreed in this step
    unsigned *waits;          // by contact: steps in which its island is divided right away
    unsigned *patience;       // by contact: how many of them there were the last time
    struct KernelTrack *tracks; // by contact: what those of blocks do
} KernelIslands;

// Prepares the islands of all contacts. Both are kept as pointers.
KernelIslands *kernel_islands_create(Kernel *all, const KernelCoupling *coupling);
void kernel_islands_destroy(KernelIslands *islands);

// Carries all that lives on from step to step, of all contacts too.
void kernel_islands_carry(KernelIslands *islands, Carry *carry);

// Integrates a step of a length, s, from the positions, speeds and free accelerations of all rows.
// Returns false where that takes too many local steps.
bool kernel_islands_run(KernelIslands *islands, double duration);

// Looks at one island at a time in the step, s, behind one of its nodes.
void kernel_island_look(KernelIsland *island, size_t node, double time_s);

// The same of no more of the island than where one of its contacts is depends on, by its number in
// it: until the next look kernel_islands_pose may be asked for that one alone, or for others at the
// same time.
void kernel_island_look_around(KernelIsland *island, size_t number, size_t node, double time_s);

// Looks at all of them, and writes the sums of all rows.
void kernel_islands_look(KernelIslands *islands, double time_s, KernelSums *sums);

// How a contact is at a time at which its island was looked at last, or, if it flies, those of its
// partners, whose sums are given by row of all.
KernelPose kernel_islands_pose(const KernelIslands *islands, size_t member, double time_s,
                               const KernelSums *sums);
