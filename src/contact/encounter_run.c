// How do bodies meet at their joints with play while the linkage around them hardly changes?
//
// Rows u of relative motion, W the linkage's mobility and g its free acceleration, both taken as
// constant over the step, f(u, u') the contacts' forces:
//     u'' = g + W f
// With the impulse P' = f and its integral Q' = P that is
//     u' = u0' + g t + W P,   u = u0 + u0' t + g t^2 / 2 + W Q
// so that only P and Q are integrated, in local steps (contact/encounter_step.c). Ends of a contact
// are found to rounding, and steps end there.
#include "contact/encounter.h"

#include "contact/encounter_force.h"
#include "contact/encounter_step.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// beyond this a step of the world holds more of a contact than anybody can want
enum { NODE_MAX = 100000 };

enum { ROOT_STEPS = 60 };

// restitutions below a tenth or so
static const double OVERDAMPED = 8.0;

// of a local step: contacts that begin or end nearer to each other than this do so together, for
// rounding of positions keeps the contacts of equal mechanisms apart by no less
static const double AT_ONCE = 1e-7;

Encounter encounter_start(double friction, double friction_speed, double phase)
{
    return (Encounter){
        .friction = friction,
        .friction_speed = friction_speed,
        .phase = phase,
        .stable = 2.0, // the method is stable up to 2.78
    };
}

size_t encounter_rows(const Encounter *encounter)
{
    return encounter->row_count;
}

bool encounter_add(Encounter *encounter, const EncounterJoint *joint, size_t rows)
{
    if (encounter->joint_count == ENCOUNTER_JOINT_MAX ||
        encounter->row_count + rows > RESPONSE_ROW_MAX) {
        return false;
    }
    EncounterJoint *added = &encounter->joints[encounter->joint_count];
    *added = *joint;
    added->first_row = encounter->row_count;
    added->row_count = rows;
    added->has_friction =
        encounter->friction > 0.0 && (rows > ENCOUNTER_ROWS_PLAIN || added->shape == TOUCH_LINE);
    for (size_t i = 0; i < rows; i++) {
        encounter->joint_of[encounter->row_count++] = (int)encounter->joint_count;
    }
    encounter->joint_count++;
    return true;
}

static void complete_point(Encounter *encounter, EncounterPoint *point)
{
    encounter_force_find(encounter, point->time_s, point->impulse, point->moment, point->force,
                         point->powers);
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
    joint->is_overdamped = encounter_force_decay(encounter, number, pose->normal, depth) >
                           OVERDAMPED * joint->frequency;
}

// Contacts that a step of the world finds begun or over already: by rounding, as the positions of
// the bodies and those of the step before differ in the last bits.
static void settle_contacts(Encounter *encounter, const EncounterPoint *point)
{
    for (size_t i = 0; i < encounter->joint_count; i++) {
        EncounterJoint *joint = &encounter->joints[i];
        const PinHole pose =
            encounter_force_pose(encounter, i, point->time_s, point->impulse, point->moment);
        if (joint->is_touching) {
            joint->is_touching = pose.penetration > 0.0 || pose.approach_speed > 0.0;
        } else if (pose.penetration > 0.0 && pose.approach_speed > 0.0) {
            begin_contact(encounter, i, &pose);
        }
    }
}

static double depth_after(Encounter *encounter, size_t joint, const EncounterPoint *from,
                          double width_s)
{
    EncounterPoint to;
    encounter_step_try(encounter, from, width_s, &to);
    return encounter_force_pose(encounter, joint, to.time_s, to.impulse, to.moment).penetration;
}

// The width at which a joint's depth passes zero, between 0 and `width_s`, by the Illinois method.
static double find_crossing(Encounter *encounter, size_t joint, const EncounterPoint *from,
                            double first, double width_s, double last)
{
    double low = 0.0;
    double high = width_s;
    double width = high;
    int side = 0;
    for (int i = 0; i < ROOT_STEPS && high - low > 1e-15 * width_s; i++) {
        width = (low * last - high * first) / (last - first);
        const double depth = depth_after(encounter, joint, from, width);
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

// Whether the depth of a joint passes zero in a step, and between which widths and depths: at the
// step's end, or, of a pin that comes to the wall and leaves again in between, where it turns.
static bool find_bracket(Encounter *encounter, size_t joint, const EncounterPoint *from,
                         const EncounterPoint *to, double *first, double *width_s, double *last)
{
    const PinHole start =
        encounter_force_pose(encounter, joint, from->time_s, from->impulse, from->moment);
    const PinHole end = encounter_force_pose(encounter, joint, to->time_s, to->impulse, to->moment);
    *first = start.penetration;
    *last = end.penetration;
    if (encounter->joints[joint].is_touching) {
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
        *last = depth_after(encounter, joint, from, *width_s);
    }
    return *last > 0.0;
}

// Shortens a step to where the first contact begins or ends in it. Returns which do there, one bit
// a joint.
static uint32_t find_events(Encounter *encounter, const EncounterPoint *from,
                            const EncounterPoint *to, double *width_s)
{
    const double whole_s = *width_s;
    double crossings[ENCOUNTER_JOINT_MAX];
    for (size_t i = 0; i < encounter->joint_count; i++) {
        double bracket_s = whole_s;
        double first;
        double last;
        crossings[i] = INFINITY;
        if (find_bracket(encounter, i, from, to, &first, &bracket_s, &last)) {
            crossings[i] = find_crossing(encounter, i, from, first, bracket_s, last);
            *width_s = fmin(*width_s, crossings[i]);
        }
    }
    uint32_t events = 0;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        events |= crossings[i] <= *width_s + AT_ONCE * whole_s ? UINT32_C(1) << i : 0;
    }
    return events;
}

// Shortens a flight that leads away from the wall and back to it to where it turns: from there on
// the pin is within its play, and the next crossing can be found.
static bool shorten_flight(const Encounter *encounter, const EncounterPoint *from,
                           const EncounterPoint *to, double *width_s)
{
    const double whole_s = *width_s;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const PinHole start =
            encounter_force_pose(encounter, i, from->time_s, from->impulse, from->moment);
        const PinHole end = encounter_force_pose(encounter, i, to->time_s, to->impulse, to->moment);
        if (!encounter->joints[i].is_touching && start.penetration >= 0.0 &&
            start.approach_speed < 0.0 && end.approach_speed > 0.0) {
            const double share = start.approach_speed / (start.approach_speed - end.approach_speed);
            *width_s = fmin(*width_s, share * whole_s);
        }
    }
    return *width_s < whole_s;
}

static void change_contacts(Encounter *encounter, uint32_t events, const EncounterPoint *point)
{
    for (size_t i = 0; i < encounter->joint_count; i++) {
        if ((events >> i & 1) == 0) {
            continue;
        }
        if (encounter->joints[i].is_touching) {
            encounter->joints[i].is_touching = false;
        } else {
            const PinHole pose =
                encounter_force_pose(encounter, i, point->time_s, point->impulse, point->moment);
            begin_contact(encounter, i, &pose);
        }
    }
}

// A local step of at most `left_s` up to the first event in it; `events` are the joints it is of.
// Returns false where the step is to be tried again. An event at its very start leaves no length.
static bool advance_step(Encounter *encounter, const EncounterPoint *from, double left_s,
                         EncounterPoint *to, uint32_t *events)
{
    double width_s = encounter_step_take(encounter, from, left_s, to);
    const double whole_s = width_s;
    bool is_solved = true;
    if (shorten_flight(encounter, from, to, &width_s)) {
        is_solved = encounter_step_try(encounter, from, width_s, to);
    }
    *events = is_solved ? find_events(encounter, from, to, &width_s) : 0;
    if (*events != 0) {
        is_solved = encounter_step_try(encounter, from, width_s, to);
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

bool encounter_run(Encounter *encounter, double duration)
{
    EncounterPoint points[2];
    EncounterPoint *from = &points[0];
    EncounterPoint *to = &points[1];
    memset(from, 0, sizeof *from);
    encounter->node_count = 0;
    settle_contacts(encounter, from);
    complete_point(encounter, from);
    encounter_nodes_add(encounter, from);
    const double rounding_s = 1e-14 * duration;
    while (duration - from->time_s > rounding_s) {
        if (encounter->node_count > NODE_MAX) {
            return false;
        }
        uint32_t events;
        if (!advance_step(encounter, from, duration - from->time_s, to, &events)) {
            continue;
        }
        if (encounter->is_stiff && encounter->node_count == 1) {
            encounter_nodes_settle(encounter);
        }
        complete_point(encounter, to);
        encounter_nodes_add(encounter, to);
        if (events != 0) {
            change_contacts(encounter, events, to);
            complete_point(encounter, to);
            encounter_nodes_add(encounter, to);
        }
        EncounterPoint *const spare = from;
        from = to;
        to = spare;
    }
    return true;
}
