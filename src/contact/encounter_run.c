// How do bodies meet at their joints with play while the linkage around them hardly changes?
//
// Rows u of relative motion, W the linkage's mobility and g its free acceleration, both taken as
// constant over the step, f(u, u') the contacts' forces:
//     u'' = g + W f
// With the impulse P' = f and its integral Q' = P that is
//     u' = u0' + g t + W P,   u = u0 + u0' t + g t^2 / 2 + W Q
// Of few rows W may be linear in time, and g in time and in the impulse, as model/response_drift.h
// has it:
//     u'' = g + g' (t - h/2) + 2 S P + (W + (t - h/2) (S + S^T)) f
// which P, Q and the integral R of Q solve as well (contact/encounter_force.c),
// so that only P, Q and R are integrated, in local steps (contact/encounter_step.c). Ends of a
// contact are found to rounding, and steps end there.
#include "contact/encounter.h"

#include "contact/encounter_events.h"
#include "contact/encounter_force.h"
#include "contact/encounter_rates.h"
#include "contact/encounter_step.h"

#include <math.h>
#include <string.h>

// beyond this a step of the world holds more of a contact than anybody can want
enum { NODE_MAX = 100000 };

// the error of a classical step of order 4 in its phase, which is what is meant where one is given
static const double PHASE_ERROR = 1.0 / 120.0;

// what is allowed where it is not given: of the error that comes of a response that is taken as
// constant
static const double ERROR_SHARE = 0.004;

// the same where it changes in the step, which leaves a tenth of that error, and of its square,
// which is left beside that
static const double DRIFT_SHARE = 0.002;
static const double DRIFT_SQUARE = 0.5;
static const double TOLERANCE_LEAST = 1e-10;
static const double TOLERANCE_MOST = 1e-3;

// of a contact's first step: times the tolerance, to the power 2/3, in rad
static const double FIRST = 50.0;

// restitutions below a tenth or so
static const double OVERDAMPED = 8.0;

// The force grows as the power 1.5 of the time since the onset.
static void set_first_width(EncounterJoint *joint)
{
    joint->first_width_s =
        joint->frequency > 0.0
            ? cbrt(FIRST * FIRST * joint->tolerance * joint->tolerance) / joint->frequency
            : 0.0;
}

// How much the mobility of a joint has changed since the step before, in the time between their
// middles, relative to it.
static double response_change(const Encounter *encounter, const EncounterJoint *joint)
{
    const double *own = encounter_mobility(encounter, joint->first_row, joint->first_row);
    const double now[3] = {own[0], own[1], own[encounter->pitch + 1]};
    double change = 0.0;
    double size = 0.0;
    for (size_t i = 0; i < 3; i++) {
        change += (now[i] - joint->mobility_before[i]) * (now[i] - joint->mobility_before[i]);
        size += now[i] * now[i];
    }
    return sqrt(change / size);
}

// The error that is allowed where the response changes by a share in the step.
static double allowed_error(const Encounter *encounter, double change)
{
    return encounter->drift != NULL ? change * (DRIFT_SHARE + DRIFT_SQUARE * change)
                                    : ERROR_SHARE * change;
}

// Sets the errors allowed: a share of what comes of the response being taken as constant, which
// moves a pin by W' h^2 / 12 for each newton second.
static void set_tolerances(Encounter *encounter, double duration_s)
{
    const double phase = encounter->phase;
    const double between_s = 0.5 * (duration_s + encounter->duration_before_s);
    for (size_t i = 0; i < encounter->joint_count; i++) {
        EncounterJoint *joint = &encounter->joints[i];
        const double *own = encounter_mobility(encounter, joint->first_row, joint->first_row);
        if (phase > 0.0) {
            joint->tolerance = phase * phase * phase * phase * PHASE_ERROR;
        } else if (encounter->duration_before_s > 0.0) {
            const double change = response_change(encounter, joint) * duration_s / between_s;
            const double turned = fmin(1.0, joint->frequency * duration_s / M_PI);
            const double allowed = allowed_error(encounter, change) * turned;
            joint->tolerance = fmin(fmax(allowed, TOLERANCE_LEAST), TOLERANCE_MOST);
        } else {
            joint->tolerance = TOLERANCE_LEAST;
        }
        joint->mobility_before[0] = own[0];
        joint->mobility_before[1] = own[1];
        joint->mobility_before[2] = own[encounter->pitch + 1];
        set_first_width(joint);
    }
    encounter->duration_before_s = duration_s;
}

static void begin_contact(Encounter *encounter, size_t number, const PinHole *pose)
{
    EncounterJoint *joint = &encounter->joints[number];
    joint->is_touching = true;
    joint->impact_speed = pose->approach_speed;
    joint->touching_s = 0.0;
    encounter->stiff_width_s = 0.0;
    // the depth at which a spring of that frequency would have taken up the speed
    double depth = 1e-6;
    for (int i = 0; i < 8; i++) {
        const double speed = fmax(pose->approach_speed, joint->law.impact_speed_floor);
        depth = fmin(speed / encounter_force_frequency(encounter, number, pose->normal, depth),
                     0.5 * force_law_depth_limit(&joint->law));
    }
    joint->frequency = encounter_force_frequency(encounter, number, pose->normal, depth);
    const double mobility =
        joint->frequency * joint->frequency / force_law_tangent(&joint->law, depth);
    joint->force_per_speed = joint->frequency / mobility;
    set_first_width(joint);
    for (int k = 0; k < 2; k++) {
        encounter->longest_s[k] = joint->first_width_s;
    }
    joint->is_overdamped = encounter_force_decay(encounter, number, pose->normal, depth) >
                           OVERDAMPED * joint->frequency;
}

// Contacts that a step of the world finds begun or over already: by rounding, as the positions of
// the bodies and those of the step before differ in the last bits.
static void settle_contacts(Encounter *encounter, const EncounterPoint *point)
{
    for (size_t i = 0; i < encounter->joint_count; i++) {
        EncounterJoint *joint = &encounter->joints[i];
        const PinHole *pose = encounter_point_pose(encounter, point, i);
        if (joint->is_touching) {
            joint->is_touching = pose->penetration > 0.0 || pose->approach_speed > 0.0;
        } else if (pose->penetration > 0.0 && pose->approach_speed > 0.0) {
            begin_contact(encounter, i, pose);
        }
    }
}

static void change_contacts(Encounter *encounter, const EncounterPoint *point)
{
    for (size_t i = 0; i < encounter->joint_count; i++) {
        if (!encounter->work->has_event[i]) {
            continue;
        }
        if (encounter->joints[i].is_touching) {
            encounter->joints[i].is_touching = false;
        } else {
            begin_contact(encounter, i, encounter_point_pose(encounter, point, i));
        }
    }
}

// A local step of at most `left_s` up to the first event in it; `events` is how many joints it is
// of. Returns false where the step is to be tried again. An event at its very start leaves no
// length.
static bool advance_step(Encounter *encounter, EncounterStep *step, double left_s,
                         EncounterPoint *to, size_t *events)
{
    double width_s = encounter_step_take(encounter, step, left_s, to);
    const double whole_s = width_s;
    bool is_solved = true;
    if ((step->method != ENCOUNTER_FLIGHT || encounter->input != NULL) &&
        encounter_events_shorten(encounter, step->from, to, &width_s)) {
        is_solved = encounter_step_try(encounter, step, width_s, to);
    }
    *events = is_solved ? encounter_events_find(encounter, step, to, &width_s) : 0;
    if (*events != 0) {
        is_solved = encounter_events_step(encounter, step, &width_s, to);
    }
    if (!is_solved) {
        encounter->stiff_width_s = 0.5 * whole_s;
        return false;
    }
    for (size_t i = 0; i < encounter->joint_count; i++) {
        encounter->joints[i].touching_s += width_s;
    }
    return true;
}

// The point at the start of a step.
static void begin_step(const Encounter *encounter, EncounterPoint *point)
{
    encounter_point_begin(encounter, point, 0.0);
    memset(point->impulse, 0, encounter->row_count * sizeof *point->impulse);
    memset(point->moment, 0, 2 * encounter->row_count * sizeof *point->moment);
    memset(point->losses, 0, sizeof point->losses);
}

bool encounter_run(Encounter *encounter, double duration)
{
    EncounterPoint *from = &encounter->work->ends[0];
    EncounterPoint *to = &encounter->work->ends[1];
    EncounterStep step;
    begin_step(encounter, from);
    encounter_nodes_begin(encounter);
    encounter->event_count = 0;
    set_tolerances(encounter, duration);
    settle_contacts(encounter, from);
    encounter_rates_find(encounter, from);
    encounter_nodes_add(encounter, from);
    const double rounding_s = 1e-14 * duration;
    while (duration - from->time_s > rounding_s) {
        if (encounter->node_count > NODE_MAX || encounter->event_count > encounter->event_most ||
            (encounter->work_most > 0.0 && encounter->work_done > encounter->work_most)) {
            return false;
        }
        size_t events;
        step.from = from;
        // what others do is smooth between the ends of their contacts
        const double stop_s =
            fmin(duration, encounter_input_stop(encounter, from->time_s + rounding_s));
        if (!advance_step(encounter, &step, stop_s - from->time_s, to, &events)) {
            continue;
        }
        if (fabs(to->time_s - stop_s) <= rounding_s && stop_s < duration) {
            encounter_point_begin(encounter, to, stop_s);
            step.is_ended = false;
        }
        if (step.method == ENCOUNTER_STIFF && encounter->node_count == 1) {
            encounter_nodes_settle(encounter);
        }
        if (step.is_ended && events == 0) {
            encounter_explicit_extend(encounter, &step.explicit, from, to);
        } else {
            encounter_rates_find(encounter, to);
        }
        encounter_nodes_add(encounter, to);
        if (events != 0) {
            encounter->event_count++;
            change_contacts(encounter, to);
            encounter_rates_find(encounter, to);
            encounter_nodes_add(encounter, to);
        }
        EncounterPoint *const spare = from;
        from = to;
        to = spare;
    }
    return true;
}
