// Depths are zero where contacts begin and end: by the Illinois method on what is known inside a
// step, by Newton's where the step is made anew, and in closed form across a hole in flight.
#include "contact/encounter_events.h"

#include "contact/encounter_error.h"
#include "contact/encounter_flight.h"
#include "contact/encounter_force.h"

#include <math.h>

enum { ROOT_STEPS = 60, EVENT_STEPS = 8 };

static const double TURNED = 1e-12; // of a flight, before which a pin has turned by rounding
static const double EVENT_ROUNDING = 1e-14; // of a local step
static const double NEARBY = 0.5; // of a flight: a closed form that is further off is another one

// of a local step: contacts that begin or end nearer to each other than this do so together, for
// rounding of positions keeps the contacts of equal mechanisms apart by no less
static const double AT_ONCE = 1e-7;

// how many roundings of its depth a pin may be off the wall that it is at
static const double AT_WALL = 64.0;

// The width at which a joint's depth passes zero, between 0 and `width_s`, by the Illinois method.
static double find_crossing(Encounter *encounter, EncounterStep *step, size_t joint, double first,
                            double width_s, double last)
{
    double low = 0.0;
    double high = width_s;
    double width = high;
    int side = 0;
    for (int i = 0; i < ROOT_STEPS && high - low > 1e-15 * width_s; i++) {
        width = (low * last - high * first) / (last - first);
        const double depth = encounter_step_depth(encounter, step, joint, width);
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
static double find_return(Encounter *encounter, EncounterStep *step, size_t joint, double whole_s)
{
    EncounterPoint *at = &encounter->work->trial;
    double width_s = encounter_flight_time(encounter, joint, step->from, whole_s);
    for (int i = 0; i < EVENT_STEPS && encounter->drift != NULL && width_s < INFINITY; i++) {
        encounter_step_try(encounter, step, width_s, at);
        const PinHole *pose = encounter_point_pose(encounter, at, joint);
        const double later_s = -pose->penetration / pose->approach_speed;
        if (!(fabs(later_s) > EVENT_ROUNDING * whole_s) || !(fabs(later_s) < NEARBY * width_s)) {
            break;
        }
        width_s += later_s;
    }
    return width_s > whole_s ? INFINITY : width_s;
}

// Whether the depth of a joint passes zero in a step, and between which widths and depths: at the
// step's end, or, of a pin that comes to the wall and leaves again in between, where it turns.
static bool find_bracket(Encounter *encounter, EncounterStep *step, size_t joint,
                         const EncounterPoint *to, double *first, double *width_s, double *last)
{
    const EncounterPoint *from = step->from;
    const PinHole start = *encounter_point_pose(encounter, from, joint);
    const PinHole end = *encounter_point_pose(encounter, to, joint);
    *first = start.penetration;
    *last = end.penetration;
    if (encounter->joints[joint].is_touching) {
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
        *last = encounter_step_depth(encounter, step, joint, *width_s);
    }
    return *last > 0.0;
}

// Whether a pin that does not touch is at its wall, to rounding, and on its way off it.
static bool is_leaving(const Encounter *encounter, const EncounterPoint *from, size_t joint)
{
    const PinHole *pose = encounter_point_pose(encounter, from, joint);
    const double rounding = encounter_error_rounding(encounter, joint, from->time_s);
    return !encounter->joints[joint].is_touching && pose->penetration >= -AT_WALL * rounding &&
           pose->approach_speed < 0.0;
}

size_t encounter_events_find(Encounter *encounter, EncounterStep *step, const EncounterPoint *to,
                             double *width_s)
{
    const double whole_s = *width_s;
    double *crossings = encounter->work->crossings_s;
    size_t found = 0;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        double bracket_s = whole_s;
        double first;
        double last;
        crossings[i] = INFINITY;
        if (step->method == ENCOUNTER_FLIGHT && encounter->input == NULL &&
            is_leaving(encounter, step->from, i)) {
            crossings[i] = find_return(encounter, step, i, whole_s);
            *width_s = fmin(*width_s, crossings[i]);
            found++;
        } else if (find_bracket(encounter, step, i, to, &first, &bracket_s, &last)) {
            crossings[i] = find_crossing(encounter, step, i, first, bracket_s, last);
            *width_s = fmin(*width_s, crossings[i]);
            found++;
        }
    }
    size_t events = 0;
    for (size_t i = 0; found > 0 && i < encounter->joint_count; i++) {
        encounter->work->has_event[i] = crossings[i] <= *width_s + AT_ONCE * whole_s;
        events += encounter->work->has_event[i] ? 1 : 0;
    }
    return events;
}

bool encounter_events_shorten(const Encounter *encounter, const EncounterPoint *from,
                              const EncounterPoint *to, double *width_s)
{
    const double whole_s = *width_s;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        if (encounter->joints[i].is_touching) {
            continue;
        }
        const PinHole start = *encounter_point_pose(encounter, from, i);
        const PinHole end = *encounter_point_pose(encounter, to, i);
        if (start.approach_speed < 0.0 && end.approach_speed > 0.0 &&
            (start.penetration >= 0.0 || end.penetration > 0.0)) {
            const double share = start.approach_speed / (start.approach_speed - end.approach_speed);
            // one that turns right away has turned
            *width_s = share > TURNED ? fmin(*width_s, share * whole_s) : *width_s;
        }
    }
    return *width_s < whole_s;
}

bool encounter_events_step(Encounter *encounter, EncounterStep *step, double *width_s,
                           EncounterPoint *to)
{
    const double whole_s = *width_s;
    size_t first = 0;
    while (!encounter->work->has_event[first]) {
        first++;
    }
    for (int i = 0;; i++) {
        if (!encounter_step_try(encounter, step, *width_s, to)) {
            return false;
        }
        const PinHole *pose = encounter_point_pose(encounter, to, first);
        const double later_s = -pose->penetration / pose->approach_speed;
        if (i == EVENT_STEPS || step->method != ENCOUNTER_EXPLICIT ||
            !(fabs(later_s) > EVENT_ROUNDING * whole_s) || !(*width_s + later_s > 0.0) ||
            !(fabs(later_s) < whole_s)) {
            return true;
        }
        *width_s += later_s;
    }
}
