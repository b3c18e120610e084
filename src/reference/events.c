// Finds when a contact begins, ends or goes slack.
//
// Each mode holds while its margins are not negative:
//     apart:    -d             d the penetration
//     pressing:  d, release    release: 1 + chi d'/v0, or the force itself with a viscous damper
//     slack:     d, -release
// A pressing contact that has moved out and comes back (kernel/contact_state.h) also has the margin
// -d': where that is used up its impact is over.
// One whose damping grows with the depth has as well how far it is from where that is whole: beyond
// it the damping goes on by another formula.
// A contact that touches in a slot has as well how far the end of the wall is that it meets: where
// that is used up it goes on at the next one.
// A margin that is negative at one of a few points of a step has crossed zero before it. The
// crossing is found on the step's polynomial; then the step is taken again up to there, and its end
// moved by Newton's method until the penetration is zero to rounding: no step ever passes the
// corner of d^n.
//
// Where an event has put a contact, its new margin is zero but for rounding, of either sign. A
// margin counts as negative only beyond its rounding: so a pin that has just come to the wall is
// not off it again, a contact that begins and one that ends differ by more than rounding, and no
// contact can begin and end for ever at one instant. Contacts whose events lie nearer to each other
// than rounding can resolve change together.
#include "reference/stepper.h"

#include "base/root.h"

#include <float.h>
#include <math.h>

enum {
    HALVINGS = 24,
    LANDING_ITERATIONS = 4,
    MARGIN_REST = 2,
    MARGIN_WALL = 3,
    MARGIN_FULL = 4,
    MARGINS = 5,
};

// m: a thousandth of the depth that rounding of positions of 0.3 m leaves uncertain
static const double LANDING_DEPTH_M = 1e-19;

// of a step: an end that is moved by less moves with its rates, whose square this leaves below
// rounding; a longer way is a step of its own
static const double END_SHIFT_SHARE = 1e-6;

// of a slot's play: a pin may be so far beyond the end of the wall that it meets. What that is off
// by is the square of it in the gap, below rounding, and as much in the direction of the force; it
// keeps a pin that rests there, or a slot that is shorter, from changing its wall for ever
static const double WALL_SHARE = 1e-9;

// roundings of a position or a speed that the sum of a handful of terms leaves uncertain
static const double EVENTS_ROUNDING = 4.0 * DBL_EPSILON;

typedef struct Margin {
    const System *system;
    Dop853 *integrator;
    size_t contact;
    int which;
} Margin;

static double margin_of(const Press *press, const Contact *contact, int which)
{
    if (which == MARGIN_FULL) {
        const double beyond = press->depth - contact->law.full_damping_depth;
        return contact->is_growing ? -beyond : beyond;
    }
    switch (contact->mode) {
    case CONTACT_APART:
        return -press->depth;
    case CONTACT_PRESSING:
        return which == 0 ? press->depth : which == MARGIN_REST ? -press->closing : press->release;
    default:
        return which == 0 ? press->depth : -press->release;
    }
}

// How far rounding alone may take a margin to either side of zero.
static double rounding_of(const System *system, const SystemState *state, size_t number,
                          ContactMode mode, int which)
{
    const Contact *contact = &system->contacts[number];
    double length = 0.0;
    double speed = 0.0;
    system->kind->sizes(system, state, number, &length, &speed);
    const double depth = EVENTS_ROUNDING * length;
    if (which == MARGIN_WALL) {
        return fmax(depth, WALL_SHARE * contact->clearance);
    }
    if (mode == CONTACT_APART || which == 0 || which == MARGIN_FULL) {
        return depth;
    }
    if (which == MARGIN_REST) {
        return EVENTS_ROUNDING * speed;
    }
    if (contact->law.viscous > 0.0) {
        const double reached = fmax(state->contacts[number].depth, depth);
        return force_law_tangent(&contact->law, reached) * depth +
               press_viscous(contact, reached).coefficient * EVENTS_ROUNDING * speed +
               fabs(press_viscous(contact, reached).slope * state->contacts[number].closing) *
                   depth;
    }
    return contact->damping_rate * EVENTS_ROUNDING * speed;
}

// The contact at a time in the step.
static Press press_at(const Margin *margin, double time)
{
    return system_press(margin->system, margin->integrator, margin->contact, time);
}

static double margin_at(double time, void *context)
{
    const Margin *margin = context;
    const System *system = margin->system;
    if (margin->which == MARGIN_WALL) {
        return system_wall(system, margin->integrator, margin->contact, time).within;
    }
    const Press press = press_at(margin, time);
    return margin_of(&press, &system->contacts[margin->contact], margin->which);
}

// The mode that follows when a margin of the present one is used up.
static ContactMode mode_after(ContactMode mode, int which)
{
    if (mode == CONTACT_APART) {
        return CONTACT_PRESSING;
    }
    if (which == 0) {
        return CONTACT_APART;
    }
    if (which == MARGIN_REST || which == MARGIN_WALL || which == MARGIN_FULL) {
        return mode;
    }
    return mode == CONTACT_PRESSING ? CONTACT_SLACK : CONTACT_PRESSING;
}

// Whether a contact has a margin in its mode; MARGIN_FULL is asked of those alone whose damping
// grows.
static bool has_margin(const Contact *contact, int which)
{
    if (contact->mode == CONTACT_APART) {
        return which == 0;
    }
    if (which == MARGIN_REST) {
        return contact->mode == CONTACT_PRESSING && contact->law.resting_speed > 0.0 &&
               contact->is_released && !contact->is_resting;
    }
    return which != MARGIN_WALL || contact->has_walls;
}

double events_crossing(RootFunction margin, void *context, double first, double last)
{
    double good = last;
    for (int i = 0; i < HALVINGS; i++) {
        good = first + 0.5 * (good - first);
        if (margin(good, context) > 0.0) {
            // where the polynomial sees no change of sign, the state at the end alone does: it is
            // there
            double time = last;
            root_find(margin, context, good, last, 0.0, &time);
            return time;
        }
    }
    return first;
}

double events_point_time(const Dop853 *integrator, const EventPoints *points, size_t point)
{
    // the end is the end to the last bit
    const double share = (double)(point + 1) / (double)points->count;
    return point + 1 == points->count ? integrator->time + integrator->tried
                                      : integrator->time + share * integrator->tried;
}

bool events_evaluate(const System *system, Dop853 *integrator, EventPoints *points)
{
    // without contacts bristles look between the ends themselves
    points->count = system->contact_count == 0 && system->bristle_count > 0 ? 1 : EVENTS_POINTS_MAX;
    for (size_t i = 0; i < system->contact_count; i++) {
        points->count = system->contacts[i].mode == CONTACT_PRESSING ? 1 : points->count;
    }
    for (size_t i = 0; i + 1 < points->count; i++) {
        const double time = events_point_time(integrator, points, i);
        const double *y = dop853_dense(integrator, time);
        if (!system->kind->evaluate(system, time, y, points->states[i], NULL)) {
            return false;
        }
    }
    double *rates = integrator->has_end_rates ? NULL : integrator->end_rates;
    integrator->evaluations += rates != NULL ? 1 : 0;
    integrator->has_end_rates = true;
    return system->kind->evaluate(system, integrator->time + integrator->tried, integrator->next,
                                  points->states[points->count - 1], rates);
}

// Takes note of an event of a contact, if it is the first of this contact, from a time at which its
// margin is used up.
static void note_event(const Margin *margin, double time, double beyond, Event *event)
{
    if (time < event->time) {
        const System *system = margin->system;
        const ContactMode mode = system->contacts[margin->contact].mode;
        *event = (Event){
            .time = time,
            .contact = margin->contact,
            .mode = mode_after(mode, margin->which),
            .is_rest = margin->which == MARGIN_REST,
            .is_full = margin->which == MARGIN_FULL,
        };
        if (margin->which == MARGIN_WALL) {
            // as it is beyond the end: a short one may lie wholly behind
            event->wall = system_wall(system, margin->integrator, margin->contact, beyond).next;
        }
    }
}

static double approach_at(double time, void *context)
{
    return press_at(context, time).closing;
}

static double leaving_at(double time, void *context)
{
    const Margin *margin = context;
    return system_wall(margin->system, margin->integrator, margin->contact, time).leaving;
}

// Whether a margin is below zero by more than rounding, as that is in a state.
static bool is_used_up(const Margin *margin, const SystemState *state, double left)
{
    const System *system = margin->system;
    const ContactMode mode = system->contacts[margin->contact].mode;
    return left < 0.0 && left < -rounding_of(system, state, margin->contact, mode, margin->which);
}

// A free pin that went towards its wall and comes back may have been there in between, and one that
// presses where its damping is whole: where the penetration has its extreme it is evaluated once
// more. `outward` is 1 where the margin ends at a depth that grows, -1 where at one that falls.
static bool has_been_there(Margin *margin, double first, double last, const SystemState *state,
                           double outward, double *top)
{
    return outward * state->contacts[margin->contact].closing < 0.0 &&
           outward * approach_at(first, margin) > 0.0 &&
           root_find(approach_at, margin, first, last, 0.0, top) &&
           is_used_up(margin, state, margin_at(*top, margin));
}

// Whether a contact that touches has gone beyond the end of its wall between two times, at the
// second or, where it comes back, before it.
static bool has_left_wall(Margin *margin, double first, double last, const SystemState *state,
                          double *when)
{
    const System *system = margin->system;
    const bool is_end = last == margin->integrator->time + margin->integrator->tried;
    const WallPlace place =
        is_end ? system->kind->wall(system, margin->contact, last, margin->integrator->next)
               : system_wall(system, margin->integrator, margin->contact, last);
    *when = last;
    return is_used_up(margin, state, place.within) ||
           (place.leaving < 0.0 && leaving_at(first, margin) > 0.0 &&
            root_find(leaving_at, margin, first, last, 0.0, when) &&
            is_used_up(margin, state, margin_at(*when, margin)));
}

static void events_evaluate_at(Margin *margin, const EventPoints *points, Event *event)
{
    const System *system = margin->system;
    const Contact *contact = &system->contacts[margin->contact];
    const bool can_turn = contact->mode == CONTACT_APART || margin->which == MARGIN_FULL;
    const double outward = margin->which == MARGIN_FULL && !contact->is_growing ? -1.0 : 1.0;
    double before = margin->integrator->time;
    for (size_t i = 0; i < points->count; i++) {
        const double time = events_point_time(margin->integrator, points, i);
        const SystemState *state = points->states[i];
        const Press *press = &state->contacts[margin->contact];
        double top = time;
        if (margin->which == MARGIN_WALL) {
            if (has_left_wall(margin, before, time, state, &top)) {
                note_event(margin, events_crossing(margin_at, margin, before, top), top, event);
                return;
            }
            before = time;
            continue;
        }
        if (can_turn && has_been_there(margin, before, time, state, outward, &top)) {
            note_event(margin, events_crossing(margin_at, margin, before, top), top, event);
            return;
        }
        if (is_used_up(margin, state, margin_of(press, contact, margin->which))) {
            note_event(margin, events_crossing(margin_at, margin, before, time), time, event);
            return;
        }
        before = time;
    }
}

void events_find(const System *system, Dop853 *integrator, const EventPoints *points,
                 EventList *found)
{
    found->count = 0;
    for (size_t i = 0; i < system->contact_count; i++) {
        Event event = {.time = INFINITY};
        const bool grows = system->contacts[i].law.full_damping_depth > 0.0;
        for (int which = 0; which < (grows ? MARGINS : MARGIN_FULL); which++) {
            Margin margin = {system, integrator, i, which};
            if (has_margin(&system->contacts[i], which)) {
                events_evaluate_at(&margin, points, &event);
            }
        }
        if (event.time < INFINITY) {
            found->events[found->count++] = event;
        }
    }
    if (system->kind->torque != NULL && system->scenario->linkage.torque.limit > 0.0 &&
        drive_limit_find(system, integrator, &found->events[found->count])) {
        found->count++;
    }
    if (system->bristle_count > 0) {
        bristle_events_find(system, integrator, points, found);
    }
}

const Event *events_first(const EventList *found)
{
    const Event *first = NULL;
    for (size_t i = 0; i < found->count; i++) {
        first = first == NULL || found->events[i].time < first->time ? &found->events[i] : first;
    }
    return first;
}

// Whether an event begins or ends at the wall.
static bool is_at_wall(const System *system, const Event *event)
{
    return !event->is_bristle && !event->is_drive &&
           (event->mode == CONTACT_APART || system->contacts[event->contact].mode == CONTACT_APART);
}

// The contact at the end of the tried step.
static Press press_at_end(const System *system, const Dop853 *integrator, size_t contact)
{
    return system->kind->press(system, contact, integrator->time + integrator->tried,
                               integrator->next);
}

static void events_move_end(Dop853 *integrator, double by)
{
    if (integrator->method == NULL && fabs(by) < END_SHIFT_SHARE * integrator->tried) {
        dop853_shift(integrator, by);
    } else {
        dop853_try(integrator, integrator->tried + by);
    }
}

// How far the end of the tried step is from an event, m, and how fast that grows: from the wall, or
// in a slot from where the wall ends.
typedef struct Landing {
    double off;
    double rate;
} Landing;

static Landing landing_at_end(const System *system, const Dop853 *integrator, const Event *event)
{
    if (event->wall != WALL_NEAREST) {
        const WallPlace place = system->kind->wall(
            system, event->contact, integrator->time + integrator->tried, integrator->next);
        return (Landing){-place.within, place.leaving};
    }
    const Press press = press_at_end(system, integrator, event->contact);
    return (Landing){press.depth, press.closing};
}

void events_land(const System *system, Dop853 *integrator, Event *event)
{
    const bool is_landed = is_at_wall(system, event) || event->wall != WALL_NEAREST;
    // the event lies in the step that showed it
    const double longest = integrator->tried;
    dop853_try(integrator, fmax(0.0, event->time - integrator->time));
    Landing landing = landing_at_end(system, integrator, event);
    for (int i = 0; i < LANDING_ITERATIONS && is_landed; i++) {
        const double by = -landing.off / landing.rate;
        const double moved = integrator->tried + by;
        // an event that the step began with lies at its start and moves nowhere
        if (fabs(landing.off) <= LANDING_DEPTH_M || integrator->tried == 0.0 ||
            !(moved >= 0.0 && moved <= longest)) {
            break;
        }
        events_move_end(integrator, by);
        const Landing now = landing_at_end(system, integrator, event);
        if (!(fabs(now.off) < fabs(landing.off))) {
            events_move_end(integrator, -by);
            break;
        }
        landing = now;
    }
    event->time = integrator->time + integrator->tried;
}

void events_gather(const System *system, const Dop853 *integrator, const EventPoints *points,
                   const Event *landed, double same_s, EventList *found)
{
    const size_t all = found->count;
    const SystemState *end = points->states[points->count - 1];
    const double time_s = integrator->time + integrator->tried;
    found->count = 0;
    for (size_t i = 0; i < all; i++) {
        const Event *event = &found->events[i];
        bool is_now =
            (event->contact == landed->contact && event->is_bristle == landed->is_bristle &&
             event->is_drive == landed->is_drive) ||
            fabs(event->time - time_s) <= same_s;
        if (!is_now && is_at_wall(system, event)) {
            const double rounding = rounding_of(system, end, event->contact, CONTACT_APART, 0);
            const Press press =
                system->kind->press(system, event->contact, time_s, integrator->next);
            is_now = fabs(press.depth) <= rounding;
        }
        if (is_now) {
            found->events[found->count++] = *event;
        }
    }
}

void events_apply(System *system, const EventList *events, double time_s, const double *y)
{
    for (size_t i = 0; i < events->count; i++) {
        const Event *event = &events->events[i];
        if (event->is_drive) {
            system->side = event->side;
        }
        if (event->is_drive || event->is_bristle) {
            continue; // of a bristle: bristle_events_apply
        }
        Contact *contact = &system->contacts[event->contact];
        if (contact->mode == CONTACT_APART) {
            contact_begin(contact, system->kind->time(system, time_s),
                          system->kind->press(system, event->contact, time_s, y).closing);
            if (contact->has_walls) {
                contact->wall = system->kind->wall(system, event->contact, time_s, y).wall;
            }
        }
        if (event->wall != WALL_NEAREST) {
            contact->wall = event->wall;
        }
        if (event->mode == CONTACT_APART) {
            contact->wall = WALL_NEAREST;
        }
        if (event->is_rest) {
            contact_rest(contact);
        }
        if (event->is_full) {
            contact->is_growing = !contact->is_growing;
        }
        contact->mode = event->mode;
    }
}
