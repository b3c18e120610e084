// Takes one local step: chooses its method and length, and ends it where a contact begins or ends.
//
// A step is explicit as long as the error allows, by the order that needs fewer forces for what is
// left (kernel/explicit.c). Where the damping would make that unstable, by an implicit method
// (kernel/implicit.c). Where nothing touches, in one step.
//
// Depths are zero where contacts begin and end: by the Illinois method on what is known inside a
// step, by Newton's where the step is made anew, and in closed form across a hole in flight.
//
// In flight, with e0 and v the pin's centre and velocity, a its acceleration and c the play, |e0| =
// c:
//     |e0 + v t + a t^2 / 2|^2 - c^2 = t (2 e0 . v + (v . v + e0 . a) t + v . a t^2 + a . a t^3 /
//     4)
// At the wall the pin goes inwards, e0 . v < 0, and the cubic in brackets is below 0 until the pin
// is back at it. Outside a disc all signs are the other way round.
#include "kernel/internal.h"

#include <math.h>
#include <string.h>

enum { HALVINGS = 200 };

typedef struct Cubic {
    double c[4]; // by power
} Cubic;

static double value_of(const Cubic *cubic, double t)
{
    const double *c = cubic->c;
    return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
}

// The root between two times, of which the cubic has another sign at the second.
static double find_root(const Cubic *cubic, double low, double high)
{
    for (int i = 0; i < HALVINGS && high - low > 1e-16 * high; i++) {
        const double middle = 0.5 * (low + high);
        if (value_of(cubic, middle) < 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return high;
}

// The times up to `last` between which the cubic only grows or only falls, in their order.
static size_t find_turns(const Cubic *cubic, double last, double turns[3])
{
    const double a = 3.0 * cubic->c[3];
    const double half = cubic->c[2];
    const double b = cubic->c[1];
    const double square = half * half - a * b;
    const double q = square > 0.0 ? -(half + copysign(sqrt(square), half)) : 0.0;
    // a root of the derivative that does not exist is no number or no time
    const double roots[2] = {q / a, b / q};
    const double first = fmin(roots[0], roots[1]);
    const double second = fmax(roots[0], roots[1]);
    size_t count = 0;
    if (first > 0.0 && first < last) {
        turns[count++] = first;
    }
    if (second > first && second > 0.0 && second < last) {
        turns[count++] = second;
    }
    turns[count++] = last;
    return count;
}

// The first time above 0 at which a cubic that starts below 0 is no longer.
static double first_root(const Cubic *cubic, double last)
{
    double turns[3];
    const size_t count = find_turns(cubic, last, turns);
    double low = 0.0;
    for (size_t i = 0; i < count; i++) {
        if (value_of(cubic, turns[i]) >= 0.0) {
            return find_root(cubic, low, turns[i]);
        }
        low = turns[i];
    }
    return INFINITY;
}

// The time until then, s, from a point at which nothing touches and the pin of a contact is at its
// wall, to rounding, and on its way off it; INFINITY where that is later than `left_s`. In closed
// form but for the root of a cubic: the pin moves under a constant acceleration.
static double flight_time(const Kernel *kernel, size_t contact, const KernelPoint *from,
                          double left_s)
{
    const KernelContact *of = &kernel->contacts[contact];
    // nothing presses: the impulses, and what they do to the accelerations, stay as they are
    double free[2];
    for (size_t i = 0; i < 2; i++) {
        free[i] = kernel_motion_acceleration(kernel, of->first_row + i, from->time_s, from->impulse,
                                             from->force);
    }
    const PinHole pose =
        kernel_motion_pose(kernel, contact, from->time_s, from->impulse, from->moment);
    if (of->shape == KERNEL_LINE) {
        // the gap grows by -approach t + free t^2 / 2
        const double time_s = 2.0 * pose.approach_speed / free[0];
        return time_s > 0.0 && time_s <= left_s ? time_s : INFINITY;
    }
    const Vec2 e = pose.eccentricity;
    const Vec2 a = {free[0], free[1]};
    const Vec2 v = {
        kernel_motion_speed(kernel, of->first_row, from->time_s, from->impulse, from->moment),
        kernel_motion_speed(kernel, of->first_row + 1, from->time_s, from->impulse, from->moment),
    };
    if (of->shape == KERNEL_SLOT) {
        const SlotFlight flight = {kernel_motion_position(kernel, contact, from), v, a,
                                   of->half_length, vec2_length(e)};
        return kernel_slot_return(&flight, left_s);
    }
    const double sign = of->radial_clearance < 0.0 ? -1.0 : 1.0;
    const Cubic cubic = {{
        2.0 * sign * vec2_dot(e, v),
        sign * (vec2_dot(v, v) + vec2_dot(e, a)),
        sign * vec2_dot(v, a),
        sign * 0.25 * vec2_dot(a, a),
    }};
    return first_root(&cubic, left_s);
}

// implicit steps next to the ends of a contact are down to this share of the others
static const double GRADED_SHARE_LEAST = 1.0 / 256.0;
static const double GRADING_SHARE = 0.25; // of the time since the onset, or left to the end

static const double FRICTION_PHASE = 0.5; // of the time in which friction takes hold

// of what is left: an implicit step that cannot be solved at this length has no finite forces
static const double STEP_SHARE_LEAST = 1e-14;

// times a contact's frequency, from which on its damping may need an implicit step
static const double DAMPED_FREQUENCIES = 4.0;

// time constants of damping and friction in an explicit step at most
static const double DECAYS_MOST = 1.5;

// of the time left to a contact's end, an explicit step takes at most
static const double END_SHARE_MOST = 0.5;

enum { STEP_TRIES_MOST = 12 };         // to find a length whose error is small enough
static const double STEP_SHRINK = 0.1; // where an error is no number

// what each order costs, in forces
static const double STEP_FORCES[2] = {2.0, 3.0};

static bool is_any_touching(const Kernel *kernel)
{
    for (size_t i = 0; i < kernel->contact_count; i++) {
        if (kernel->contacts[i].state.is_touching) {
            return true;
        }
    }
    return false;
}

// Where nothing touches the impulses stay as they are.
static void fly(const Kernel *kernel, const KernelPoint *from, double width_s, KernelPoint *to)
{
    const size_t rows = kernel->row_count;
    kernel_point_begin(kernel, to, from->time_s + width_s);
    for (size_t i = 0; i < rows; i++) {
        to->impulse[i] = from->impulse[i];
        to->moment[i] = from->moment[i] + width_s * from->impulse[i];
        to->moment[rows + i] =
            from->moment[rows + i] + width_s * (from->moment[i] + 0.5 * width_s * from->impulse[i]);
        to->force[i] = to->rate[i] = 0.0;
    }
    memcpy(to->losses, from->losses, sizeof to->losses);
    kernel_bends_keep(kernel, from, to);
}

// A step from there of a given length by the same method. Returns false where an implicit one
// cannot be solved; `to` is then near it at best.
static bool try_local_step(Kernel *kernel, LocalStep *step, double width_s, KernelPoint *to)
{
    step->is_ended = false;
    switch (step->method) {
    case LOCAL_STEP_IMPLICIT:
        return kernel_implicit_step(kernel, step->from, width_s, to) < INFINITY;
    case LOCAL_STEP_FLIGHT:
        fly(kernel, step->from, width_s, to);
        return true;
    case LOCAL_STEP_EXPLICIT:
        kernel_explicit_step(kernel, step->from, step->explicit.order, width_s, &step->explicit,
                             to);
        return true;
    }
    return false;
}

void kernel_local_step_inside(Kernel *kernel, LocalStep *step, size_t contact, double width_s)
{
    KernelPoint *at = &kernel->work->trial;
    const KernelContact *of = &kernel->contacts[contact];
    const KernelSpan span = {kernel_span(kernel, of->first_row).first,
                             kernel_span(kernel, of->first_row + of->row_count - 1).end};
    at->time_s = step->from->time_s + width_s;
    at->known[contact].is_known = false;
    kernel_explicit_inside(kernel, &step->explicit, step->from, span,
                           width_s / step->explicit.width_s, at->impulse, at->moment);
    at->bends[contact].bend = kernel_explicit_bend(&step->explicit, step->from, contact, width_s);
}

// The depth of a contact after a part of a step that was taken, m.
static double depth_after(Kernel *kernel, LocalStep *step, size_t contact, double width_s)
{
    KernelPoint *at = &kernel->work->trial;
    if (step->method != LOCAL_STEP_EXPLICIT) {
        try_local_step(kernel, step, width_s, at);
    } else {
        // of a large island only what moves this contact
        at->time_s = step->from->time_s + width_s;
        at->known[contact].is_known = false;
        kernel_explicit_inside(kernel, &step->explicit, step->from,
                               kernel_contact_span(kernel, contact),
                               width_s / step->explicit.width_s, at->impulse, at->moment);
    }
    return kernel_point_pose(kernel, at, contact)->penetration;
}

// How short a local step has to be at least next to the ends of a contact, of a share of its
// oscillation.
static double width_before_end(const PinHole *pose, double share_s)
{
    const double depth = fmax(pose->penetration, 0.0);
    return pose->approach_speed < 0.0
               ? fmax(GRADING_SHARE * depth / -pose->approach_speed, GRADED_SHARE_LEAST * share_s)
               : INFINITY;
}

// How long a local step is that resolves a contact at the phase of implicit steps, and without
// regard to friction: what decides whether its damping needs one.
static double choose_width(const Kernel *kernel, const KernelPoint *point, double left_s,
                           double *frictionless_s)
{
    double width_s = left_s;
    *frictionless_s = left_s;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        if (!contact->state.is_touching) {
            continue;
        }
        const PinHole pose = *kernel_point_pose(kernel, point, i);
        const double depth = fmax(pose.penetration, 0.0);
        const double frequency =
            fmax(contact->frequency, kernel_force_frequency(kernel, i, pose.normal, depth));
        const double share_s = kernel->stiff_phase / frequency;
        const double least_s = GRADED_SHARE_LEAST * share_s;
        *frictionless_s = fmin(*frictionless_s,
                               fmin(share_s, fmax(GRADING_SHARE * contact->state.age_s, least_s)));
        *frictionless_s = fmin(*frictionless_s, width_before_end(&pose, share_s));
        if (contact->law.friction > 0.0) {
            width_s =
                fmin(width_s, FRICTION_PHASE * kernel_force_friction_time(kernel, i, point->force));
        }
    }
    return fmin(width_s, *frictionless_s);
}

// How long an implicit step may be for the ends of contacts.
static double longest_width(const Kernel *kernel, const KernelPoint *from, double left_s)
{
    double width_s = left_s;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        if (contact->state.is_touching) {
            const double share_s = kernel->stiff_phase / contact->frequency;
            const PinHole *pose = kernel_point_pose(kernel, from, i);
            width_s = fmin(width_s, width_before_end(pose, share_s));
        }
    }
    return width_s;
}

// Takes an implicit step as long as its error allows, the first one of a contact no longer than an
// explicit one. Returns its length, 0 where no length will do.
static double take_stiff(Kernel *kernel, const KernelPoint *from, double explicit_s, double left_s,
                         KernelPoint *to)
{
    const double longest_s = longest_width(kernel, from, left_s);
    const double wanted_s = kernel->stiff_width_s > 0.0 ? kernel->stiff_width_s : explicit_s;
    double width_s = fmin(wanted_s, longest_s);
    double error = kernel_implicit_step(kernel, from, width_s, to);
    while (!(error <= 1.0)) {
        width_s = kernel_implicit_next(width_s, error);
        if (width_s < STEP_SHARE_LEAST * left_s) {
            return 0.0;
        }
        error = kernel_implicit_step(kernel, from, width_s, to);
    }
    kernel->stiff_width_s = kernel_implicit_next(width_s, error);
    if (width_s == longest_s) {
        kernel->stiff_width_s = fmax(kernel->stiff_width_s, wanted_s);
    }
    return width_s;
}

// The time that is left to a contact's end, s: where its depth ends, or, with a damper, where that
// has taken all of the force.
static double time_to_end(const KernelContact *contact, const KernelPoint *from,
                          const PinHole *pose)
{
    if (!(pose->approach_speed < 0.0)) {
        return INFINITY;
    }
    const double leaves_s = fmax(pose->penetration, 0.0) / -pose->approach_speed;
    const size_t row = contact->first_row;
    const Vec2 force = {from->force[row], from->force[row + 1]};
    const Vec2 rate = {from->rate[row], from->rate[row + 1]};
    const double falls = -vec2_dot(force, rate);
    return contact->law.viscous > 0.0 && falls > 0.0
               ? fmin(leaves_s, vec2_dot(force, force) / falls)
               : leaves_s;
}

// How soon a pin may be back at the wall, s, that the step of the world has moved off it while they
// touched: nothing presses before, and no error says how long a step may be.
static double time_to_wall(const Kernel *kernel, const KernelContact *contact, double time_s,
                           const PinHole *pose)
{
    const double free[2] = {kernel_free_rate(kernel, contact->first_row, time_s),
                            kernel_free_rate(kernel, contact->first_row + 1, time_s)};
    const double speed = fmax(pose->approach_speed, 0.0);
    const double gap = -pose->penetration;
    return 2.0 * gap / (speed + sqrt(speed * speed + 2.0 * hypot(free[0], free[1]) * gap));
}

// How long an explicit step may be at most for damping, friction, and ends of contacts; and whether
// the damping may need an implicit one.
static double limit_explicit(const Kernel *kernel, const KernelPoint *from, bool *may_be_stiff)
{
    double longest_s = INFINITY;
    *may_be_stiff = false;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        if (!contact->state.is_touching) {
            continue;
        }
        if (contact->is_rub) {
            longest_s = fmin(longest_s, kernel_rub_time(kernel, from, i));
            continue;
        }
        const PinHole pose = *kernel_point_pose(kernel, from, i);
        const double depth = fmax(pose.penetration, 0.0);
        if (pose.penetration < 0.0) {
            longest_s = fmin(longest_s, fmax(time_to_wall(kernel, contact, from->time_s, &pose),
                                             contact->first_width_s));
        }
        longest_s = fmin(longest_s, fmax(END_SHARE_MOST * time_to_end(contact, from, &pose),
                                         contact->first_width_s));
        if (contact->law.hysteresis != 0.0 || contact->law.viscous != 0.0) {
            const double decay = kernel_force_decay(kernel, i, pose.normal, depth);
            const double frequency =
                fmax(contact->frequency, kernel_force_frequency(kernel, i, pose.normal, depth));
            *may_be_stiff =
                *may_be_stiff || contact->is_overdamped || decay > DAMPED_FREQUENCIES * frequency;
            longest_s = fmin(longest_s, DECAYS_MOST / decay);
        }
        if (contact->law.friction > 0.0) {
            longest_s =
                fmin(longest_s, DECAYS_MOST * kernel_force_friction_time(kernel, i, from->force));
        }
    }
    return longest_s;
}

// The order that takes fewer forces to the end, and the length of its next step.
static double choose_explicit(const Kernel *kernel, double limit_s, double left_s, int *order)
{
    double counts[2];
    for (int k = 0; k < 2; k++) {
        counts[k] = ceil(left_s / fmin(kernel->longest_s[k], limit_s) * (1.0 - 1e-12));
    }
    // the forces at the end of a step of order 4 follow from what it knows
    const bool is_higher = STEP_FORCES[1] * counts[1] < STEP_FORCES[0] * counts[0];
    *order = is_higher ? 5 : 4;
    return left_s / fmax(1.0, counts[is_higher]);
}

// Takes an explicit step as long as its error allows.
static double take_explicit(Kernel *kernel, LocalStep *step, double limit_s, double left_s,
                            KernelPoint *to)
{
    const KernelPoint *from = step->from;
    for (int i = 0;; i++) {
        int order;
        double longest_s[2];
        const double width_s = choose_explicit(kernel, limit_s, left_s, &order);
        kernel_explicit_step(kernel, from, order, width_s, &step->explicit, to);
        const double error = kernel_explicit_error(kernel, &step->explicit, from, longest_s);
        const bool is_good = error <= 1.0;
        for (int k = 0; k < 2; k++) {
            // a step cut short by what was left says little of longer ones
            const double before_s = kernel->longest_s[k];
            kernel->longest_s[k] = is_good ? fmin(longest_s[k], fmax(5.0 * width_s, before_s))
                                   : error < INFINITY ? fmax(longest_s[k], STEP_SHRINK * width_s)
                                                      : STEP_SHRINK * width_s;
        }
        if (is_good || i == STEP_TRIES_MOST) {
            step->is_ended = step->explicit.extends && width_s == left_s;
            return width_s;
        }
    }
}

// Takes a step of at most `left_s` from a completed point, by the method that suits, and as long as
// that allows. Returns its length; the forces at its end are left open, as below.
static double take_local_step(Kernel *kernel, LocalStep *step, double left_s, KernelPoint *to)
{
    step->is_ended = false;
    if (!is_any_touching(kernel)) {
        // not beyond what is known of others' pushes
        const double node_s =
            kernel_input_node(kernel, step->from->time_s + STEP_SHARE_LEAST * left_s) -
            step->from->time_s;
        const double width_s = fmin(left_s, node_s);
        step->method = LOCAL_STEP_FLIGHT;
        fly(kernel, step->from, width_s, to);
        return width_s;
    }
    bool may_be_stiff;
    const double limit_s = limit_explicit(kernel, step->from, &may_be_stiff);
    double frictionless_s;
    double explicit_s;
    if (may_be_stiff && !kernel->has_bristles && kernel->rub_count == 0) {
        explicit_s = choose_width(kernel, step->from, left_s, &frictionless_s);
        if (kernel_implicit_is_needed(kernel, step->from, explicit_s, frictionless_s)) {
            step->method = LOCAL_STEP_IMPLICIT;
            const double width_s = take_stiff(kernel, step->from, explicit_s, left_s, to);
            if (width_s > 0.0) {
                return width_s;
            }
        }
    }
    step->method = LOCAL_STEP_EXPLICIT;
    return take_explicit(kernel, step, limit_s, left_s, to);
}

enum { ROOT_STEPS = 60, EVENT_STEPS = 8 };

static const double TURN_ROUNDING = 1e-12; // of a flight, before which a pin has turned by rounding
static const double EVENT_ROUNDING = 1e-14; // of a local step
static const double CLOSED_FORM_OFF_MOST =
    0.5; // of a flight: a closed form that is further off is another one

// of a local step: contacts that begin or end nearer to each other than this do so together, for
// rounding of positions keeps the contacts of equal mechanisms apart by no less
static const double SIMULTANEOUS = 1e-7;

// how many roundings of its depth a pin may be off the wall that it is at
static const double WALL_ROUNDINGS = 64.0;

// The width at which a contact's depth passes zero, between 0 and `width_s`, by the Illinois
// method.
static double find_crossing(Kernel *kernel, LocalStep *step, size_t contact, double first,
                            double width_s, double last)
{
    double low = 0.0;
    double high = width_s;
    double width = high;
    int side = 0;
    for (int i = 0; i < ROOT_STEPS && high - low > 1e-15 * width_s; i++) {
        width = (low * last - high * first) / (last - first);
        const double depth = depth_after(kernel, step, contact, width);
        if (depth == 0.0) {
            break;
        }
        if ((depth > 0.0) == (last > 0.0)) {
            high = width;
            last = depth;
            first *= side == -1 ? 0.5 : 1.0;
            side = -1;
        } else {
            low = width;
            first = depth;
            last *= side == 1 ? 0.5 : 1.0;
            side = 1;
        }
    }
    return width;
}

// The same in a flight, from the closed form. That knows one acceleration, which may change.
static double find_return(Kernel *kernel, LocalStep *step, size_t contact, double whole_s)
{
    KernelPoint *at = &kernel->work->trial;
    double width_s = flight_time(kernel, contact, step->from, whole_s);
    for (int i = 0; i < EVENT_STEPS && kernel->drift != NULL && width_s < INFINITY; i++) {
        try_local_step(kernel, step, width_s, at);
        const PinHole *pose = kernel_point_pose(kernel, at, contact);
        const double later_s = -pose->penetration / pose->approach_speed;
        if (!(fabs(later_s) > EVENT_ROUNDING * whole_s) ||
            !(fabs(later_s) < CLOSED_FORM_OFF_MOST * width_s)) {
            break;
        }
        width_s += later_s;
    }
    return width_s > whole_s ? INFINITY : width_s;
}

// Whether the depth of a contact passes zero in a step, and between which widths and depths: at the
// step's end, or, of a pin that comes to the wall and leaves again in between, where it turns.
static bool find_bracket(Kernel *kernel, LocalStep *step, size_t contact, const KernelPoint *to,
                         double *first, double *width_s, double *last)
{
    const KernelPoint *from = step->from;
    const PinHole start = *kernel_point_pose(kernel, from, contact);
    const PinHole end = *kernel_point_pose(kernel, to, contact);
    *first = start.penetration;
    *last = end.penetration;
    if (kernel->contacts[contact].state.is_touching) {
        if (start.penetration < 0.0 && start.approach_speed > 0.0 && end.approach_speed > 0.0) {
            return false; // moved off the wall by the step of the world, and not back there yet
        }
        *first = fmax(*first, 1e-30); // at the wall, where the contact began
        return *last < 0.0;
    }
    if (*first >= 0.0 && start.approach_speed < 0.0) {
        return false; // at the wall or inside, and on its way out
    }
    // a pin that rounding has put inside meets the wall at the very start, not before it
    *first = fmin(*first, 0.0);
    if (!(*last > 0.0) && start.approach_speed > 0.0 && end.approach_speed < 0.0) {
        *width_s *= start.approach_speed / (start.approach_speed - end.approach_speed);
        *last = depth_after(kernel, step, contact, *width_s);
    }
    return *last > 0.0;
}

// Whether a pin that does not touch is at its wall, to rounding, and on its way off it.
static bool is_leaving(const Kernel *kernel, const KernelPoint *from, size_t contact)
{
    const PinHole *pose = kernel_point_pose(kernel, from, contact);
    const double rounding = kernel_depth_rounding(kernel, contact, from->time_s);
    return !kernel->contacts[contact].state.is_touching &&
           pose->penetration >= -WALL_ROUNDINGS * rounding && pose->approach_speed < 0.0;
}

// Shortens a step to where the first contact begins or ends in it. Returns how many do there; which
// is in the kernel's work.
static size_t find_events(Kernel *kernel, LocalStep *step, const KernelPoint *to, double *width_s)
{
    const double whole_s = *width_s;
    double *crossings = kernel->work->crossings_s;
    size_t found = 0;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        double bracket_s = whole_s;
        double first;
        double last;
        crossings[i] = INFINITY;
        if (step->method == LOCAL_STEP_FLIGHT && kernel->input == NULL &&
            is_leaving(kernel, step->from, i)) {
            crossings[i] = find_return(kernel, step, i, whole_s);
            *width_s = fmin(*width_s, crossings[i]);
            found++;
        } else if (find_bracket(kernel, step, i, to, &first, &bracket_s, &last)) {
            crossings[i] = find_crossing(kernel, step, i, first, bracket_s, last);
            *width_s = fmin(*width_s, crossings[i]);
            found++;
        }
    }
    size_t events = 0;
    for (size_t i = 0; found > 0 && i < kernel->contact_count; i++) {
        kernel->work->has_event[i] = crossings[i] <= *width_s + SIMULTANEOUS * whole_s;
        events += kernel->work->has_event[i] ? 1 : 0;
    }
    return events;
}

// Whether a contact turns inwards between two poses at which something has to be known of it: a pin
// at its wall or inside that comes back, whose next crossing can be found from there on, or one
// that touches and outlasts its impact (kernel/contact_state.h).
static bool turns_inwards(const KernelContact *contact, const PinHole *start, const PinHole *end)
{
    if (!(start->approach_speed < 0.0) || !(end->approach_speed > 0.0)) {
        return false;
    }
    return contact->state.is_touching ? contact->law.resting_speed > 0.0 &&
                                            !contact->state.is_resting && end->penetration > 0.0
                                      : start->penetration >= 0.0 || end->penetration > 0.0;
}

// Shortens a step in which a contact turns inwards to where it does. Returns whether there is one.
static bool shorten_to_turn(const Kernel *kernel, const KernelPoint *from, const KernelPoint *to,
                            double *width_s)
{
    const double whole_s = *width_s;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const PinHole start = *kernel_point_pose(kernel, from, i);
        const PinHole end = *kernel_point_pose(kernel, to, i);
        if (turns_inwards(&kernel->contacts[i], &start, &end)) {
            const double share = start.approach_speed / (start.approach_speed - end.approach_speed);
            // one that turns right away has turned
            *width_s = share > TURN_ROUNDING ? fmin(*width_s, share * whole_s) : *width_s;
        }
    }
    return *width_s < whole_s;
}

// How far a pin in a slot is beyond the part of the wall that it is at, after a part of a step, m.
static double beyond_part(Kernel *kernel, LocalStep *step, size_t contact, double width_s)
{
    depth_after(kernel, step, contact, width_s); // which leaves the point in the trial
    return kernel_slot_beyond(kernel, contact, &kernel->work->trial);
}

// Shortens a step to where a pin that touches comes to the end of the part of its slot's wall that
// it is at: the rates of its force jump there. Returns whether there is one.
static bool shorten_to_part(Kernel *kernel, LocalStep *step, const KernelPoint *to, double *width_s)
{
    const double whole_s = *width_s;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        if (kernel->contacts[i].part == KERNEL_PART_NEAREST) {
            continue;
        }
        const double near = kernel_slot_rounding(&kernel->contacts[i]);
        double low = 0.0;
        double high = whole_s;
        double first = kernel_slot_beyond(kernel, i, step->from);
        double last = kernel_slot_beyond(kernel, i, to);
        if (!(first < 0.0 && last > near)) {
            continue;
        }
        for (int n = 0; n < ROOT_STEPS && last > near; n++) {
            const double secant = low + (high - low) * first / (first - last);
            const double width = n % 3 == 2 ? 0.5 * (low + high) : secant;
            const double beyond = beyond_part(kernel, step, i, width);
            *(beyond > 0.0 ? &high : &low) = width;
            *(beyond > 0.0 ? &last : &first) = beyond;
        }
        *width_s = fmin(*width_s, high);
    }
    return *width_s < whole_s;
}

// Steps to where the first of the contacts found begins or ends: the length is right but for the
// error of what was known between the ends of the step. Returns false where a step cannot be taken.
static bool step_to_first_event(Kernel *kernel, LocalStep *step, double *width_s, KernelPoint *to)
{
    const double whole_s = *width_s;
    size_t first = 0;
    while (!kernel->work->has_event[first]) {
        first++;
    }
    for (int i = 0;; i++) {
        if (!try_local_step(kernel, step, *width_s, to)) {
            return false;
        }
        const PinHole *pose = kernel_point_pose(kernel, to, first);
        const double later_s = -pose->penetration / pose->approach_speed;
        if (i == EVENT_STEPS || step->method != LOCAL_STEP_EXPLICIT ||
            !(fabs(later_s) > EVENT_ROUNDING * whole_s) || !(*width_s + later_s > 0.0) ||
            !(fabs(later_s) < whole_s)) {
            return true;
        }
        *width_s += later_s;
    }
}

bool kernel_local_step(Kernel *kernel, LocalStep *step, double left_s, KernelPoint *to,
                       size_t *events)
{
    double width_s = take_local_step(kernel, step, left_s, to);
    const double whole_s = width_s;
    bool is_solved = true;
    if ((step->method != LOCAL_STEP_FLIGHT || kernel->input != NULL) &&
        shorten_to_turn(kernel, step->from, to, &width_s)) {
        is_solved = try_local_step(kernel, step, width_s, to);
    }
    if (is_solved && step->method != LOCAL_STEP_FLIGHT &&
        shorten_to_part(kernel, step, to, &width_s)) {
        is_solved = try_local_step(kernel, step, width_s, to);
    }
    if (is_solved && kernel->has_bristles && step->method == LOCAL_STEP_EXPLICIT &&
        kernel_bristles_shorten(kernel, step, to, &width_s)) {
        is_solved = try_local_step(kernel, step, width_s, to);
    }
    bool has_turned = false; // a guide, on another face
    if (is_solved && kernel->rub_count > 0 && step->method == LOCAL_STEP_EXPLICIT &&
        kernel_rubs_shorten(kernel, step, &width_s)) {
        is_solved = try_local_step(kernel, step, width_s, to);
        has_turned = true;
    }
    *events = is_solved ? find_events(kernel, step, to, &width_s) : 0;
    if (*events != 0) {
        is_solved = step_to_first_event(kernel, step, &width_s, to);
    }
    if (!is_solved) {
        kernel->stiff_width_s = 0.5 * whole_s;
        return false;
    }
    for (size_t i = 0; i < kernel->contact_count; i++) {
        kernel->contacts[i].state.age_s += width_s;
    }
    const bool has_moved = kernel_slots_follow(kernel, to);
    const bool has_changed = kernel->has_bristles && step->method == LOCAL_STEP_EXPLICIT &&
                             kernel_bristles_follow(kernel, to, width_s);
    step->is_ended = !has_moved && !has_changed && !has_turned && step->is_ended;
    return true;
}
