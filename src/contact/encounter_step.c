// How is a local step of an encounter taken, and how long is it?
//
// By the classical Runge-Kutta method of order 4. A step is a share of the radian of the contact's
// oscillation, shorter next to the ends of a contact, where d^1.5 is not smooth. Where the damping
// would make it unstable, by an implicit method (contact/encounter_stiff.c).
#include "contact/encounter_step.h"

#include "contact/encounter_stiff.h"

#include <assert.h>
#include <math.h>

// local steps next to the ends of a contact are down to this share of the others: the error of
// order 2.5 that d^1.5 makes there falls to 1e-6 of what it would be
static const double GRADED = 1.0 / 256.0;
static const double GROWTH = 0.25; // of the time since the onset, or left to the end

static const double FRICTION_PHASE = 0.5; // of the time in which friction takes hold

// of what is left: an implicit step that cannot be solved at this length has no finite forces
static const double SHORTEST = 1e-14;

// Writes a + width b for all rows.
static inline void advance_rows(size_t rows, const double *a, double width_s, const double *b,
                                double *sum)
{
    for (size_t i = 0; i < rows; i++) {
        sum[i] = a[i] + width_s * b[i];
    }
}

// Writes a + width (b + 2 c + 2 d + e) / 6 for all rows.
static inline void weigh_rows(size_t rows, const double *a, double width_s,
                              const double *const stages[4], double *sum)
{
    for (size_t i = 0; i < rows; i++) {
        sum[i] = a[i] + width_s / 6.0 *
                            (stages[0][i] + 2.0 * (stages[1][i] + stages[2][i]) + stages[3][i]);
    }
}

// One step of the classical method from a completed point; the forces at its end are left open.
static void try_explicit(Encounter *encounter, const EncounterPoint *from, double width_s,
                         EncounterPoint *to)
{
    const size_t rows = encounter_rows(encounter);
    assert(rows > 0);
    const double half_s = 0.5 * width_s;
    double forces[3][RESPONSE_ROW_MAX];
    double impulses[3][RESPONSE_ROW_MAX];
    double moment[RESPONSE_ROW_MAX];
    double powers[3][2];
    advance_rows(rows, from->impulse, half_s, from->force, impulses[0]);
    advance_rows(rows, from->moment, half_s, from->impulse, moment);
    encounter_force_find(encounter, from->time_s + half_s, impulses[0], moment, forces[0],
                         powers[0]);
    advance_rows(rows, from->impulse, half_s, forces[0], impulses[1]);
    advance_rows(rows, from->moment, half_s, impulses[0], moment);
    encounter_force_find(encounter, from->time_s + half_s, impulses[1], moment, forces[1],
                         powers[1]);
    advance_rows(rows, from->impulse, width_s, forces[1], impulses[2]);
    advance_rows(rows, from->moment, width_s, impulses[1], moment);
    encounter_force_find(encounter, from->time_s + width_s, impulses[2], moment, forces[2],
                         powers[2]);
    to->time_s = from->time_s + width_s;
    weigh_rows(rows, from->impulse, width_s,
               (const double *const[4]){from->force, forces[0], forces[1], forces[2]}, to->impulse);
    weigh_rows(rows, from->moment, width_s,
               (const double *const[4]){from->impulse, impulses[0], impulses[1], impulses[2]},
               to->moment);
    weigh_rows(2, from->losses, width_s,
               (const double *const[4]){from->powers, powers[0], powers[1], powers[2]}, to->losses);
}

bool encounter_step_try(Encounter *encounter, const EncounterPoint *from, double width_s,
                        EncounterPoint *to)
{
    if (encounter->is_stiff) {
        return encounter_stiff_step(encounter, from, width_s, to) < INFINITY;
    }
    try_explicit(encounter, from, width_s, to);
    return true;
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

// How long an explicit local step is to be, and without regard to friction.
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
        const PinHole pose =
            encounter_force_pose(encounter, i, point->time_s, point->impulse, point->moment);
        const double depth = fmax(pose.penetration, 0.0);
        const double frequency =
            fmax(joint->frequency, encounter_force_frequency(encounter, i, pose.normal, depth));
        const double share_s = encounter->phase / frequency;
        const double least_s = GRADED * share_s;
        *frictionless_s =
            fmin(*frictionless_s, fmin(share_s, fmax(GROWTH * joint->touching_s, least_s)));
        *frictionless_s = fmin(*frictionless_s, width_before_end(&pose, share_s));
        if (encounter->friction > 0.0) {
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
            const PinHole pose =
                encounter_force_pose(encounter, i, from->time_s, from->impulse, from->moment);
            width_s = fmin(width_s, width_before_end(&pose, encounter->phase / joint->frequency));
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

double encounter_step_take(Encounter *encounter, const EncounterPoint *from, double left_s,
                           EncounterPoint *to)
{
    double frictionless_s;
    const double explicit_s = choose_width(encounter, from, left_s, &frictionless_s);
    encounter->is_stiff = encounter_stiff_is_needed(encounter, from, explicit_s, frictionless_s);
    if (encounter->is_stiff) {
        const double width_s = take_stiff(encounter, from, explicit_s, left_s, to);
        if (width_s > 0.0) {
            return width_s;
        }
        encounter->is_stiff = false;
    }
    try_explicit(encounter, from, explicit_s, to);
    return explicit_s;
}
