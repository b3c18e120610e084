// What the files of the contact kernel share with each other and with nobody else.
#pragma once

#include "base/vec2.h"
#include "kernel/kernel.h"

// One row between two nodes: Hermite's quintic for the integral of its impulse, whose derivatives
// are impulse and force (kernel/run.c).

// A row at a node.
typedef struct KernelNodeRow {
    double impulse;
    double moment;
    double force;
    double second; // the moment's integral, where it is asked for
} KernelNodeRow;

// The row at a share `s` of the width, s, between two nodes.
static inline KernelNodeRow kernel_quintic(KernelNodeRow first, KernelNodeRow last, double width,
                                           double s, bool is_short)
{
    const double p0 = width * first.impulse;
    const double p1 = width * last.impulse;
    const double f0 = width * width * first.force;
    const double f1 = width * width * last.force;
    const double rise = last.moment - first.moment - p0 - 0.5 * f0;
    const double slope = p1 - p0 - f0;
    const double bend = f1 - f0;
    const double a = 10.0 * rise - 4.0 * slope + 0.5 * bend;
    const double b = -15.0 * rise + 7.0 * slope - bend;
    const double c = 6.0 * rise - 3.0 * slope + 0.5 * bend;
    const double impulse = p0 + s * (f0 + s * (3.0 * a + s * (4.0 * b + s * 5.0 * c)));
    const double force = f0 + s * (6.0 * a + s * (12.0 * b + s * 20.0 * c));
    return (KernelNodeRow){
        .impulse = width > 0.0 ? impulse / width : first.impulse,
        .moment = first.moment + s * (p0 + s * (0.5 * f0 + s * (a + s * (b + s * c)))),
        .second =
            first.second +
            width * s *
                (first.moment +
                 s * (p0 / 2.0 + s * (f0 / 6.0 + s * (a / 4.0 + s * (b / 5.0 + s * c / 6.0))))),
        .force = is_short || width == 0.0 ? first.force + s * (last.force - first.force)
                                          : force / (width * width),
    };
}

// What one contact of a kernel did in a step, for kernels whose contacts it moves: its impulses,
// their integrals and its forces over time, between the nodes as kernel/run.c has it.

typedef struct KernelTrack {
    size_t rows;
    size_t count; // of nodes; 0: nothing acts
    size_t room;
    double *times;  // s, since the start of the step; owned, as the other arrays
    double *values; // by node: impulse, its integral over time, force; each by row
    size_t value_room;
    size_t stop_count;
    size_t stop_room;
    double *stops;  // s: when the contact begins or ends
    size_t version; // how often it has changed in this step by more than is allowed; 0: never
} KernelTrack;

void kernel_track_finish(KernelTrack *track);

// Takes all from a track that it did in the step before.
void kernel_track_clear(KernelTrack *track);

// Writes the track of one contact of a kernel that has been run through a step, and counts a new
// version where an impulse has changed by more than the contact's tolerance, relative to the
// largest one and to that of its impact.
void kernel_track_write(KernelTrack *track, const Kernel *kernel, size_t contact);

// What acts in each row at a time, by row: impulse, its integral over time, and force. At a time of
// several nodes it is that of the last of them, or of the first where it is asked for. `node` is
// the one to begin looking at, and then the one that was found.
void kernel_track_at(const KernelTrack *track, double time_s, bool is_before, size_t *node,
                     double *impulse, double *moment, double *force);

// The first time after another, s, at which the contact begins or ends, or of which there is a
// node; INFINITY where there is none.
double kernel_track_stop(const KernelTrack *track, double after_s);
double kernel_track_node(const KernelTrack *track, double after_s);

// What contacts outside a kernel do to its rows in a step: tracks of theirs, and the mobilities
// by which these move the rows.

// From one track to the rows of one contact.
typedef struct KernelLink {
    size_t source; // which track
    size_t row;    // the contact's first, and how many
    size_t rows;
    const double *mobility; // 1/kg
    bool is_transposed;     // row by row of the track's rows, not of the contact's
} KernelLink;

// What all tracks add to the free motion at a time, by row.
typedef struct KernelAdded {
    double time_s;        // NAN: of none
    bool is_before;       // whether forces that jump then are those before it
    double *position;     // m; owned, with the next two
    double *speed;        // m/s
    double *acceleration; // m/s^2
} KernelAdded;

enum { KERNEL_ADDED = 4 }; // times that a local step comes back to

typedef struct KernelInput {
    size_t source_count;
    size_t source_room;
    const KernelTrack **sources; // the tracks; owned, as are all arrays
    size_t version_room;
    size_t *versions; // of the tracks at which the kernel was run
    size_t node_room;
    size_t *nodes; // by track: where it was looked at last
    size_t link_count;
    size_t link_room;
    KernelLink *links; // of a track one after the other
    bool is_before;    // whether forces that jump are wanted as they are before
    KernelAdded added[KERNEL_ADDED];
    size_t oldest;     // of them
    KernelAdded *last; // the one that was asked for last
} KernelInput;

// An input of no tracks, for so many rows.
KernelInput *kernel_input_create(size_t rows);
void kernel_input_destroy(KernelInput *input);

// Takes all tracks out.
void kernel_input_clear(KernelInput *input);

// Adds a track, which is kept as a pointer; returns its number.
size_t kernel_input_add(KernelInput *input, const KernelTrack *track);

// Adds what moves the rows of a contact.
void kernel_input_link(KernelInput *input, const KernelLink *link);

// Whether any of the tracks has changed since the kernel was run; and that it is run now.
bool kernel_input_has_changed(const KernelInput *input);
void kernel_input_take(KernelInput *input);

// Finds what the tracks add at a time among what is known, or works it out.
const KernelAdded *kernel_input_find(KernelInput *input, size_t row_count, double time_s);

// What they add at a time.
static inline const KernelAdded *kernel_input_at(const Kernel *kernel, double time_s)
{
    KernelInput *input = kernel->input;
    const KernelAdded *last = input->last;
    return last->time_s == time_s && last->is_before == input->is_before
               ? last
               : kernel_input_find(input, kernel->row_count, time_s);
}

// Takes forces that jump at a time as they are before it, or behind it.
void kernel_input_look(const Kernel *kernel, bool is_before);

// The next time, s, at which the contact of a track begins or ends, or any has a node; INFINITY
// where there is none, or no track.
double kernel_input_stop(const Kernel *kernel, double after_s);
double kernel_input_node(const Kernel *kernel, double after_s);

// How the rows of a kernel move: the points of its local steps, and the poses of its contacts at
// them.

// Where a contact is at a point, and how fast its first two rows go; found when it is first asked
// for.
typedef struct KernelKnownPose {
    bool is_known;
    PinHole pose;
    double speed[2];
} KernelKnownPose;

// The bristle of a contact's friction (kernel/bristle.h).
typedef struct KernelBend {
    double bend;         // m
    double bending;      // m/s, its rate
    double bending_rate; // m/s^2, and that one's
} KernelBend;

// The state of a kernel at one time.
typedef struct KernelPoint {
    double time_s;
    KernelKnownPose *known; // by contact; owned
    double *impulse;        // N s, by row; the four are in one array that starts here
    double *moment;         // N s^2, its integral over time, by row, then that one's, N s^3
    double *force;          // N
    double *rate;           // N/s, of the forces along the motion
    double powers[2];       // W, lost in damping and in friction
    double power_rates[2];  // W/s
    double losses[2];       // J, likewise, since the start
    KernelBend *bends;      // by contact; owned with `known`
} KernelPoint;

// A point of so many rows and contacts, all zero.
KernelPoint kernel_point(size_t rows, size_t contacts);
void kernel_point_free(KernelPoint *point);

// Begins a point at another time, of which impulses and moments are about to be written.
void kernel_point_begin(const Kernel *kernel, KernelPoint *point, double time_s);

// The pose of one contact at a point.
const PinHole *kernel_point_pose(const Kernel *kernel, const KernelPoint *point, size_t contact);

// Which columns of a row's mobility may be other than zero.
typedef struct KernelSpan {
    size_t first;
    size_t end;
} KernelSpan;

static inline KernelSpan kernel_span(const Kernel *kernel, size_t row)
{
    const size_t end = row + kernel->reach + 1;
    return (KernelSpan){
        .first = row > kernel->reach ? row - kernel->reach : 0,
        .end = end < kernel->row_count ? end : kernel->row_count,
    };
}

// The rows whose impulses move the first two of a contact, which are where it is.
static inline KernelSpan kernel_contact_span(const Kernel *kernel, size_t contact)
{
    const size_t row = kernel->contacts[contact].first_row;
    return (KernelSpan){kernel_span(kernel, row).first, kernel_span(kernel, row + 1).end};
}

// The motion of a row beside what acts in the kernel's own rows.
static inline double kernel_free_speed(const Kernel *kernel, size_t row, double time_s)
{
    const double speed = kernel->speed[row] + time_s * kernel->free[row];
    return kernel->input == NULL ? speed : speed + kernel_input_at(kernel, time_s)->speed[row];
}

static inline double kernel_free_position(const Kernel *kernel, size_t row, double time_s)
{
    const double position =
        kernel->position[row] + time_s * (kernel->speed[row] + 0.5 * time_s * kernel->free[row]);
    return kernel->input == NULL ? position
                                 : position + kernel_input_at(kernel, time_s)->position[row];
}

static inline double kernel_free_rate(const Kernel *kernel, size_t row, double time_s)
{
    return kernel->input == NULL
               ? kernel->free[row]
               : kernel->free[row] + kernel_input_at(kernel, time_s)->acceleration[row];
}

// Moments, here and below, are by row the integrals of the impulses and then those of the
// integrals.

// Where all rows are, and how fast they go, after impulses and their integrals: the same sums as
// one by one in the order of the impulses, which the compiler turns into vectors.
void kernel_motion_all(const Kernel *kernel, double time_s, const double *impulse,
                       const double *moment, double *positions, double *speeds);

// The pose of one contact after impulses and their integrals.
PinHole kernel_motion_pose(const Kernel *kernel, size_t contact, double time_s,
                           const double *impulse, const double *moment);

// The same of what the contact's first two rows have moved, and how much faster they have become,
// beside the free motion.
PinHole kernel_motion_flight(const Kernel *kernel, size_t contact, double time_s,
                             const double moved[2], const double speeds[2]);

// Where the first two rows of a contact are at a point.
Vec2 kernel_motion_position(const Kernel *kernel, size_t contact, const KernelPoint *point);

// The acceleration of a row, m/s^2 or rad/s^2, under forces, after impulses.
double kernel_motion_acceleration(const Kernel *kernel, size_t row, double time_s,
                                  const double *impulse, const double *force);

// The forces between pins and holes in a kernel, and the nodes that it leaves behind: what
// kernel/run.c is made of.

// How a contact that touches is at a point: its pose, how fast its rows go, what its spring presses
// with, N, and how fast that grows with the depth, N/m.
typedef struct KernelTouch {
    PinHole pose;
    double speed[KERNEL_ROWS_MOST];
    double elastic;
    double tangent;
} KernelTouch;

enum { KERNEL_ERRORS = 5 };

// What a step works with, by row and by contact.
typedef struct KernelWork {
    KernelPoint ends[2]; // of a local step
    KernelPoint inside;  // the points of an explicit step
    KernelPoint last;    // which forces that are asked for by themselves take as well
    KernelPoint trial;   // where a depth is looked at
    KernelTouch *touching;
    double *forces;
    double *positions; // of rows that are worked out together
    double *speeds;
    double *errors[KERNEL_ERRORS]; // of an implicit step
    double *crossings_s;           // when contacts' depths are zero
    bool *has_event;               // whether a contact begins or ends at the end of a local step
    double *mode_ends_s;           // when in a local step the modes of bristles end; INFINITY: not
    BristleMode *modes;            // which follow there
} KernelWork;

// Moments, here and below, are by row the integrals of the impulses and then those of the
// integrals.

// Writes the forces in all rows, and the powers lost in damping and in friction.
void kernel_force_find(Kernel *kernel, double time_s, const double *impulse, const double *moment,
                       double *force, double powers[2]);

// The same at a point, and how the contacts are that touch, by contact.
void kernel_force_find_touching(Kernel *kernel, const KernelPoint *point, double *force,
                                double powers[2], KernelTouch *touching);

// How fast the damping of a contact at a depth takes up its closing speed, 1/s.
double kernel_force_decay(const Kernel *kernel, size_t contact, Vec2 normal, double depth);

// The frequency of a contact at a depth, rad/s.
double kernel_force_frequency(const Kernel *kernel, size_t contact, Vec2 normal, double depth);

// The time in which friction takes hold of what slides in a contact, s, under the forces given.
double kernel_force_friction_time(const Kernel *kernel, size_t contact, const double *force);

// How fast a contact slides at a point, m/s; of one in the plane that has rows for it.
double kernel_force_sliding(const Kernel *kernel, const KernelPoint *point, size_t contact);

// What presses along the normal of a contact that touches at a point, N.
double kernel_force_pressing(const Kernel *kernel, const KernelPoint *point, size_t contact);

// Forgets the nodes of the step before, and gives back room that it alone needed.
void kernel_nodes_begin(Kernel *kernel);

// Adds a node.
void kernel_nodes_add(Kernel *kernel, const KernelPoint *point);

// Gives the first node the forces at the start that the first step, an implicit one, has found.
void kernel_nodes_settle(Kernel *kernel);

// How the force of a contact in a kernel changes with position and speed of its rows.

typedef struct KernelSlopes {
    double force[KERNEL_ROWS_MOST];                      // N, N m
    double by_position[KERNEL_ROWS_MOST][2];             // N/m, of the first two rows
    double by_speed[KERNEL_ROWS_MOST][KERNEL_ROWS_MOST]; // N s/m
} KernelSlopes;

// Writes force and derivatives of one contact, all zero where it does not touch. With `from_depth`
// 0, m, the force is that of kernel_force_find, which never pulls. Above 0 it is smooth instead: it
// goes on linearly below that depth, and the damper may pull.
void kernel_slopes_find(const Kernel *kernel, size_t contact, double time_s, const double *impulse,
                        const double *moment, double from_depth, KernelSlopes *slopes);

// The forces of a kernel with their derivatives in time, along the motion that is under way.

// Writes the forces in all rows, their rates, N/s, the powers lost in damping and in friction, and
// the rates of these, W/s: of a point of which time, impulses and moments are given.
void kernel_rates_find(Kernel *kernel, KernelPoint *point);

// What rounding leaves of a depth, m: the play less an eccentricity, or at a line the gap at the
// start of the world's step less the way since then.
double kernel_depth_rounding(const Kernel *kernel, size_t contact, double time_s);

// A pin in a slot in flight, in the slot's axes.
typedef struct SlotFlight {
    Vec2 position;     // m
    Vec2 speed;        // m/s
    Vec2 acceleration; // m/s^2
    double half_length;
    double distance; // m, from the middle line, at the start
} SlotFlight;

// The time, s, after which one that is at a wall and leaves it is back at that wall or at another;
// INFINITY where that is later than the last one.
double kernel_slot_return(const SlotFlight *flight, double last_s);

// How far a pin in a slot is beyond the part of the wall that it is at, at a point, m, and how far
// it may be for rounding.
double kernel_slot_beyond(const Kernel *kernel, size_t contact, const KernelPoint *point);
double kernel_slot_rounding(const KernelContact *contact);

// Puts a pin that touches, or has just begun to, at the part of its slot where it is at a point, or
// where it is going from there.
void kernel_slot_find_part(Kernel *kernel, size_t contact, KernelPoint *point);

// Lets those that have come to the end of their part go on at the next one. Returns whether any
// has.
bool kernel_slots_follow(Kernel *kernel, KernelPoint *point);

// The friction of ideal joints in a kernel that has some (kernel/rubs.c).

// Before a run: finds what they would hold, and how strongly bristles are damped, of those of which
// that is not known yet.
void kernel_rubs_begin(Kernel *kernel, KernelPoint *point);

// Damps the bristle of one that begins to stick at a point, by what presses there and what moves on
// it.
void kernel_rub_stick_at(Kernel *kernel, size_t contact, KernelPoint *point);

// In a first run: bends the bristles of those that stand, by what their accelerations ask for, once
// their modes are known. Returns whether it is the first.
bool kernel_rubs_hold(Kernel *kernel, KernelPoint *point);

// Adds these frictions to the forces in all rows at a point, which the contacts have written, and
// what they take to the powers.
void kernel_rubs_press(Kernel *kernel, const KernelPoint *point, double *force, double powers[2]);

// The same of the rates: after forces and rates of all else have been written to the point.
void kernel_rubs_rate(Kernel *kernel, KernelPoint *point);

// The rub of a contact that is one.
KernelRub *kernel_rub_of(const Kernel *kernel, size_t contact);

// How long a local step may be for it from a completed point, s.
double kernel_rub_time(const Kernel *kernel, const KernelPoint *point, size_t contact);

// Lets the faces of guides press that press most at a completed point. Returns whether any is
// another one: then its rates are to be found anew.
bool kernel_rubs_face(Kernel *kernel, const KernelPoint *point);

// Explicit local steps of a kernel, which use the forces and their rates.

// A step from a completed point: what it was made from, and where it leads.
typedef struct ExplicitStep {
    int order; // 4 or 5
    double width_s;
    double middle;       // the share of the width at which the forces below are
    KernelPoint *inside; // there, in the kernel's work
    bool extends;        // whether the forces at its end follow from it well enough
} ExplicitStep;

// Takes a step of an order and length. Of its end all is written but the forces.
void kernel_explicit_step(Kernel *kernel, const KernelPoint *from, int order, double width_s,
                          ExplicitStep *step, KernelPoint *to);

// Impulses and moments of some rows at a share of the step, 0 to 1, without any further evaluation:
// from the cubic through the forces and rates at the start and inside.
void kernel_explicit_inside(const Kernel *kernel, const ExplicitStep *step, const KernelPoint *from,
                            KernelSpan span, double share, double *impulse, double *moment);

// The bend of a contact's bristle at a time since the step's start, likewise, m.
double kernel_explicit_bend(const ExplicitStep *step, const KernelPoint *from, size_t contact,
                            double since_s);

// Writes the forces a time after the start of a step by the same cubic.
void kernel_explicit_forces(const Kernel *kernel, const ExplicitStep *step, const KernelPoint *from,
                            double since_s, double *force);

// Writes the forces and powers at the end of a step by the same cubic.
void kernel_explicit_extend(const Kernel *kernel, const ExplicitStep *step, const KernelPoint *from,
                            KernelPoint *to);

// The error of a step over what is allowed, and how long the next step of either order may be, s,
// of the contact that allows the least.
double kernel_explicit_error(const Kernel *kernel, ExplicitStep *step, const KernelPoint *from,
                             double longest_s[2]);

// Local steps of a kernel whose contacts are damped so strongly that explicit steps would be
// unstable: an implicit method, and how long its steps are.

// Whether the next step from a point has to be implicit, where an explicit one would have a length,
// s, and another if it were not for friction.
bool kernel_implicit_is_needed(const Kernel *kernel, const KernelPoint *point, double explicit_s,
                               double frictionless_s);

// One implicit step from a completed point; the forces at its end are left open. Returns the
// estimate of its error over what is allowed, INFINITY where the equations are not solved, and then
// `to` is not to be used.
double kernel_implicit_step(Kernel *kernel, const KernelPoint *from, double width_s,
                            KernelPoint *to);

// The length of the step that follows one with an error.
double kernel_implicit_next(double width_s, double error);

// Writes the forces that the last step found at its start, left by what had died away at its first
// stage: a world's step begins beside the motion of the contact, by rounding or by its own error.
void kernel_implicit_settled(const Kernel *kernel, double *force);

void kernel_implicit_finish(Kernel *kernel);

// Local steps, up to whatever happens in them.

typedef enum LocalStepMethod {
    LOCAL_STEP_FLIGHT, // nothing touches
    LOCAL_STEP_EXPLICIT,
    LOCAL_STEP_IMPLICIT,
} LocalStepMethod;

// A step that has been taken, or tried.
typedef struct LocalStep {
    LocalStepMethod method;
    bool is_ended;           // whether the forces at its end need not be evaluated
    const KernelPoint *from; // completed: with forces and rates
    ExplicitStep explicit;
} LocalStep;

// Puts the trial of the kernel's work to a part of an explicit step that was taken, of what moves
// one contact, and its bristle.
void kernel_local_step_inside(Kernel *kernel, LocalStep *step, size_t contact, double width_s);

// Bristles of contacts with friction that holds, in a kernel that has some.

// What a bristle holds of mu N, how that changes in time, and how fast it bends, which is written:
// from mu N, N, and the sliding speed, m/s, both with their rates.
typedef struct BristleRates {
    double share;      // 1
    double share_rate; // 1/s
} BristleRates;

BristleRates kernel_bristle_rates(const KernelContact *contact, KernelBend *bend,
                                  const double pressing[2], const double speed[2]);

// The bends at the points of an explicit step: in it, at the last point of one of order 5, and at
// its end, where of order 4 there is no last point; and where nothing touches.
void kernel_bends_middle(const Kernel *kernel, const KernelPoint *from, double since_s,
                         KernelPoint *point);
void kernel_bends_last(const Kernel *kernel, const KernelPoint *from, double h,
                       const KernelPoint *inside, KernelPoint *point);
void kernel_bends_finish(const Kernel *kernel, const KernelPoint *from, double h,
                         const KernelPoint *inside, const KernelPoint *last, KernelPoint *to);
void kernel_bends_keep(const Kernel *kernel, const KernelPoint *from, KernelPoint *to);

// A contact begins at a point with a bristle that is not bent.
void kernel_bristle_begin(Kernel *kernel, size_t number, KernelPoint *point);

// At the start of a step of the world: takes the bends from the contacts, and lets those change
// their mode whose bodies that step has moved; and gives them back at its end.
void kernel_bristles_take(Kernel *kernel, KernelPoint *point);
void kernel_bristles_give(Kernel *kernel, const KernelPoint *point);

// Shortens a local step to where the first mode of a bristle ends in it; returns whether one does.
// Once it is taken the modes that have ended within its width change; returns whether any has.
bool kernel_bristles_shorten(Kernel *kernel, LocalStep *step, const KernelPoint *to,
                             double *width_s);
bool kernel_bristles_follow(Kernel *kernel, KernelPoint *point, double width_s);

// Shortens a local step to where another face of a guide begins to press; returns whether one does.
bool kernel_rubs_shorten(Kernel *kernel, LocalStep *step, double *width_s);

// Takes a local step of at most `left_s` up to the first time at which contacts begin or end in it;
// `events` is how many do so there, which is in the kernel's work. Returns false where the step is
// to be tried again. An event at its very start leaves no length. The forces at its end are left
// open.
bool kernel_local_step(Kernel *kernel, LocalStep *step, double left_s, KernelPoint *to,
                       size_t *events);
