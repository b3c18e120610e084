// How is a local step of an encounter taken, and how long is it?
//
// Explicitly as long as the error allows, by the order that needs fewer forces for what is left
// (contact/encounter_explicit.c). Where the damping would make that unstable, by an implicit method
// (contact/encounter_stiff.c). Where nothing touches, in one step.
#include "contact/encounter_step.h"

#include "contact/encounter_stiff.h"

#include <math.h>
#include <string.h>

// implicit steps next to the ends of a contact are down to this share of the others
static const double GRADED = 1.0 / 256.0;
static const double GROWTH = 0.25; // of the time since the onset, or left to the end

static const double FRICTION_PHASE = 0.5; // of the time in which friction takes hold

// of what is left: an implicit step that cannot be solved at this length has no finite forces
static const double SHORTEST = 1e-14;

// times a contact's frequency, from which on its damping may need an implicit step
static const double DAMPED = 4.0;

// time constants of damping and friction in an explicit step at most
static const double DECAYS_MOST = 1.5;

// of the time left to a contact's end, an explicit step takes at most
static const double ENDING = 0.5;

enum { TRIES = 12 };              // to find a length whose error is small enough
static const double SHRINK = 0.1; // where an error is no number

// what each order costs, in forces
static const double COSTS[2] = {2.0, 3.0};

static bool is_any_touching(const Encounter *encounter)
{
    for (size_t i = 0; i < encounter->joint_count; i++) {
        if (encounter->joints[i].is_touching) {
            return true;
        }
    }
    return false;
}

// Where nothing touches the impulses stay as they are.
static void fly(const Encounter *encounter, const EncounterPoint *from, double width_s,
                EncounterPoint *to)
{
    const size_t rows = encounter->row_count;
    encounter_point_begin(encounter, to, from->time_s + width_s);
    for (size_t i = 0; i < rows; i++) {
        to->impulse[i] = from->impulse[i];
        to->moment[i] = from->moment[i] + width_s * from->impulse[i];
        to->moment[rows + i] =
            from->moment[rows + i] + width_s * (from->moment[i] + 0.5 * width_s * from->impulse[i]);
        to->force[i] = to->rate[i] = 0.0;
    }
    memcpy(to->losses, from->losses, sizeof to->losses);
}

bool encounter_step_try(Encounter *encounter, EncounterStep *step, double width_s,
                        EncounterPoint *to)
{
    step->is_ended = false;
    switch (step->method) {
    case ENCOUNTER_STIFF:
        return encounter_stiff_step(encounter, step->from, width_s, to) < INFINITY;
    case ENCOUNTER_FLIGHT:
        fly(encounter, step->from, width_s, to);
        return true;
    case ENCOUNTER_EXPLICIT:
        encounter_explicit_step(encounter, step->from, step->explicit.order, width_s,
                                &step->explicit, to);
        return true;
    }
    return false;
}

double encounter_step_depth(Encounter *encounter, EncounterStep *step, size_t joint, double width_s)
{
    EncounterPoint *at = &encounter->work->trial;
    if (step->method != ENCOUNTER_EXPLICIT) {
        encounter_step_try(encounter, step, width_s, at);
    } else {
        encounter_point_begin(encounter, at, step->from->time_s + width_s);
        encounter_explicit_inside(encounter, &step->explicit, step->from,
                                  width_s / step->explicit.width_s, at->impulse, at->moment);
    }
    return encounter_point_pose(encounter, at, joint)->penetration;
}

// How short a local step has to be at least next to the ends of a contact, of a share of its
// oscillation.
static double width_before_end(const PinHole *pose, double share_s)
{
    const double depth = fmax(pose->penetration, 0.0);
    return pose->approach_speed < 0.0
               ? fmax(GROWTH * depth / -pose->approach_speed, GRADED * share_s)
               : INFINITY;
}

// How long a local step is that resolves a contact at the phase of implicit steps, and without
// regard to friction: what decides whether its damping needs one.
static double choose_width(const Encounter *encounter, const EncounterPoint *point, double left_s,
                           double *frictionless_s)
{
    double width_s = left_s;
    *frictionless_s = left_s;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const EncounterJoint *joint = &encounter->joints[i];
        if (!joint->is_touching) {
            continue;
        }
        const PinHole pose = *encounter_point_pose(encounter, point, i);
        const double depth = fmax(pose.penetration, 0.0);
        const double frequency =
            fmax(joint->frequency, encounter_force_frequency(encounter, i, pose.normal, depth));
        const double share_s = encounter->stiff_phase / frequency;
        const double least_s = GRADED * share_s;
        *frictionless_s =
            fmin(*frictionless_s, fmin(share_s, fmax(GROWTH * joint->touching_s, least_s)));
        *frictionless_s = fmin(*frictionless_s, width_before_end(&pose, share_s));
        if (joint->law.friction > 0.0) {
            width_s = fmin(width_s, FRICTION_PHASE *
                                        encounter_force_friction_time(encounter, i, point->force));
        }
    }
    return fmin(width_s, *frictionless_s);
}

// How long an implicit step may be for the ends of contacts.
static double longest_width(const Encounter *encounter, const EncounterPoint *from, double left_s)
{
    double width_s = left_s;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const EncounterJoint *joint = &encounter->joints[i];
        if (joint->is_touching) {
            const double share_s = encounter->stiff_phase / joint->frequency;
            const PinHole *pose = encounter_point_pose(encounter, from, i);
            width_s = fmin(width_s, width_before_end(pose, share_s));
        }
    }
    return width_s;
}

// Takes an implicit step as long as its error allows, the first one of a contact no longer than an
// explicit one. Returns its length, 0 where no length will do.
static double take_stiff(Encounter *encounter, const EncounterPoint *from, double explicit_s,
                         double left_s, EncounterPoint *to)
{
    const double longest_s = longest_width(encounter, from, left_s);
    const double wanted_s = encounter->stiff_width_s > 0.0 ? encounter->stiff_width_s : explicit_s;
    double width_s = fmin(wanted_s, longest_s);
    double error = encounter_stiff_step(encounter, from, width_s, to);
    while (!(error <= 1.0)) {
        width_s = encounter_stiff_next(width_s, error);
        if (width_s < SHORTEST * left_s) {
            return 0.0;
        }
        error = encounter_stiff_step(encounter, from, width_s, to);
    }
    encounter->stiff_width_s = encounter_stiff_next(width_s, error);
    if (width_s == longest_s) {
        encounter->stiff_width_s = fmax(encounter->stiff_width_s, wanted_s);
    }
    return width_s;
}

// The time that is left to a contact's end, s: where its depth ends, or, with a damper, where that
// has taken all of the force.
static double time_to_end(const EncounterJoint *joint, const EncounterPoint *from,
                          const PinHole *pose)
{
    if (!(pose->approach_speed < 0.0)) {
        return INFINITY;
    }
    const double leaves_s = fmax(pose->penetration, 0.0) / -pose->approach_speed;
    const size_t row = joint->first_row;
    const Vec2 force = {from->force[row], from->force[row + 1]};
    const Vec2 rate = {from->rate[row], from->rate[row + 1]};
    const double falls = -vec2_dot(force, rate);
    return joint->law.viscous > 0.0 && falls > 0.0 ? fmin(leaves_s, vec2_dot(force, force) / falls)
                                                   : leaves_s;
}

// How soon a pin may be back at the wall, s, that the step of the world has moved off it while they
// touched: nothing presses before, and no error says how long a step may be.
static double time_to_wall(const Encounter *encounter, const EncounterJoint *joint, double time_s,
                           const PinHole *pose)
{
    const double free[2] = {encounter_free_rate(encounter, joint->first_row, time_s),
                            encounter_free_rate(encounter, joint->first_row + 1, time_s)};
    const double speed = fmax(pose->approach_speed, 0.0);
    const double gap = -pose->penetration;
    return 2.0 * gap / (speed + sqrt(speed * speed + 2.0 * hypot(free[0], free[1]) * gap));
}

// How long an explicit step may be at most for damping, friction, and ends of contacts; and whether
// the damping may need an implicit one.
static double limit_explicit(const Encounter *encounter, const EncounterPoint *from,
                             bool *may_be_stiff)
{
    double longest_s = INFINITY;
    *may_be_stiff = false;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const EncounterJoint *joint = &encounter->joints[i];
        if (!joint->is_touching) {
            continue;
        }
        const PinHole pose = *encounter_point_pose(encounter, from, i);
        const double depth = fmax(pose.penetration, 0.0);
        if (pose.penetration < 0.0) {
            longest_s = fmin(longest_s, fmax(time_to_wall(encounter, joint, from->time_s, &pose),
                                             joint->first_width_s));
        }
        longest_s =
            fmin(longest_s, fmax(ENDING * time_to_end(joint, from, &pose), joint->first_width_s));
        if (joint->law.hysteresis != 0.0 || joint->law.viscous != 0.0) {
            const double decay = encounter_force_decay(encounter, i, pose.normal, depth);
            const double frequency =
                fmax(joint->frequency, encounter_force_frequency(encounter, i, pose.normal, depth));
            *may_be_stiff = *may_be_stiff || joint->is_overdamped || decay > DAMPED * frequency;
            longest_s = fmin(longest_s, DECAYS_MOST / decay);
        }
        if (joint->law.friction > 0.0) {
            longest_s = fmin(
                longest_s, DECAYS_MOST * encounter_force_friction_time(encounter, i, from->force));
        }
    }
    return longest_s;
}

// The order that takes fewer forces to the end, and the length of its next step.
static double choose_explicit(const Encounter *encounter, double limit_s, double left_s, int *order)
{
    double counts[2];
    for (int k = 0; k < 2; k++) {
        counts[k] = ceil(left_s / fmin(encounter->longest_s[k], limit_s) * (1.0 - 1e-12));
    }
    // the forces at the end of a step of order 4 follow from what it knows
    const bool is_higher = COSTS[1] * counts[1] < COSTS[0] * counts[0];
    *order = is_higher ? 5 : 4;
    return left_s / fmax(1.0, counts[is_higher]);
}

// Takes an explicit step as long as its error allows.
static double take_explicit(Encounter *encounter, EncounterStep *step, double limit_s,
                            double left_s, EncounterPoint *to)
{
    const EncounterPoint *from = step->from;
    for (int i = 0;; i++) {
        int order;
        double longest_s[2];
        const double width_s = choose_explicit(encounter, limit_s, left_s, &order);
        encounter_explicit_step(encounter, from, order, width_s, &step->explicit, to);
        const double error = encounter_explicit_error(encounter, &step->explicit, from, longest_s);
        const bool is_good = error <= 1.0;
        for (int k = 0; k < 2; k++) {
            // a step cut short by what was left says little of longer ones
            const double before_s = encounter->longest_s[k];
            encounter->longest_s[k] = is_good ? fmin(longest_s[k], fmax(5.0 * width_s, before_s))
                                      : error < INFINITY ? fmax(longest_s[k], SHRINK * width_s)
                                                         : SHRINK * width_s;
        }
        if (is_good || i == TRIES) {
            step->is_ended = step->explicit.extends && width_s == left_s;
            return width_s;
        }
    }
}

double encounter_step_take(Encounter *encounter, EncounterStep *step, double left_s,
                           EncounterPoint *to)
{
    step->is_ended = false;
    if (!is_any_touching(encounter)) {
        // not beyond what is known of others' pushes
        const double node_s =
            encounter_input_node(encounter, step->from->time_s + SHORTEST * left_s) -
            step->from->time_s;
        const double width_s = fmin(left_s, node_s);
        step->method = ENCOUNTER_FLIGHT;
        fly(encounter, step->from, width_s, to);
        return width_s;
    }
    bool may_be_stiff;
    const double limit_s = limit_explicit(encounter, step->from, &may_be_stiff);
    double frictionless_s;
    double explicit_s;
    if (may_be_stiff) {
        explicit_s = choose_width(encounter, step->from, left_s, &frictionless_s);
        if (encounter_stiff_is_needed(encounter, step->from, explicit_s, frictionless_s)) {
            step->method = ENCOUNTER_STIFF;
            const double width_s = take_stiff(encounter, step->from, explicit_s, left_s, to);
            if (width_s > 0.0) {
                return width_s;
            }
        }
    }
    step->method = ENCOUNTER_EXPLICIT;
    return take_explicit(encounter, step, limit_s, left_s, to);
}
