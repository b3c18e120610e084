// Finds when the bristle of a joint's friction begins to stick, yield or slide.
//
// The margins of its modes (kernel/bristle.h) depend on its bend and on the sliding speed alone.
// Of a guide it also is an event where another of its faces comes to press most (reference/plane/
// rub.c): what presses has a corner there.
//
// As of contacts (reference/events.c) a margin counts as used up beyond its rounding only, and the
// crossing is found on the step's polynomial. Friction is continuous across all these events, so
// that the step need not end on one to the last bit.
#include "reference/stepper.h"

#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>

// in a step: where a margin is looked at beside its end. Where it has come back by then its least
// is looked for.
enum { BRISTLE_POINTS = 4 };

// of a margin: what rounding and the error of a step may leave of one that an event has made zero
static const double BRISTLE_ROUNDING = 1e-12;

// the two ends of a mode, and the face
enum { BRISTLE_ENDS = 2, BRISTLE_FACE = BRISTLE_ENDS, BRISTLE_MARGINS };

typedef struct BristleMargin {
    const System *system;
    Dop853 *integrator;
    size_t bristle;
    int which;
    double rounding; // found with the margin
    BristleMode next;
    int face;
} BristleMargin;

static const double *state_of(const BristleMargin *margin, double time)
{
    Dop853 *integrator = margin->integrator;
    return time == integrator->time                       ? integrator->y
           : time == integrator->time + integrator->tried ? integrator->next
                                                          : dop853_dense(integrator, time);
}

static double bristle_margin_at(double time, void *context)
{
    BristleMargin *margin = context;
    const System *system = margin->system;
    const Bristle *bristle = &system->bristles[margin->bristle];
    const double *y = state_of(margin, time);
    if (margin->which == BRISTLE_FACE) {
        const BristleFace face = system->kind->face(system, margin->bristle, time, y);
        margin->rounding = face.rounding;
        margin->face = face.next;
        return face.margin;
    }
    const BristleAt at = system->kind->bristle(system, margin->bristle, time, y);
    BristlePair pair = bristle->pair;
    pair.damping = at.damping;
    margin->rounding = BRISTLE_ROUNDING + at.rounding * (pair.damping + 1.0 / pair.speed);
    return bristle_margin(&pair, bristle->mode, margin->which, at.bend, at.speed, &margin->next);
}

// The time of the least of a margin that falls and rises again, by the parabola through three
// points that are equally far apart.
static double least_between(double middle, double apart, const double margins[3])
{
    const double bend = margins[0] - 2.0 * margins[1] + margins[2];
    return middle + 0.5 * apart * (margins[0] - margins[2]) / bend;
}

// The time at which a margin is used up in the step; INFINITY where it is not.
static double used_up(BristleMargin *margin)
{
    const double start = margin->integrator->time;
    const double apart = margin->integrator->tried / BRISTLE_POINTS;
    double margins[BRISTLE_POINTS + 1];
    for (int i = 0; i <= BRISTLE_POINTS; i++) {
        const double time =
            i == BRISTLE_POINTS ? start + margin->integrator->tried : start + i * apart;
        margins[i] = bristle_margin_at(time, margin);
        if (i > 0 && margins[i] < -margin->rounding) {
            return events_crossing(bristle_margin_at, margin, time - apart, time);
        }
        const bool has_turned =
            i > 1 && margins[i - 1] < margins[i - 2] && margins[i - 1] < margins[i];
        if (has_turned) {
            const double least = least_between(time - apart, apart, margins + i - 2);
            if (bristle_margin_at(least, margin) < -margin->rounding) {
                return events_crossing(bristle_margin_at, margin, time - 2.0 * apart, least);
            }
        }
    }
    return INFINITY;
}

static bool has_margin(const System *system, size_t number, int which)
{
    const Bristle *bristle = &system->bristles[number];
    BristleMode next;
    if (bristle->contact >= 0 && system->contacts[bristle->contact].mode != CONTACT_PRESSING) {
        return false;
    }
    return which == BRISTLE_FACE
               ? bristle->face >= 0
               : bristle_margin(&bristle->pair, bristle->mode, which, 0.0, 0.0, &next) < INFINITY;
}

void bristle_events_find(const System *system, Dop853 *integrator, const EventPoints *points,
                         EventList *found)
{
    (void)points;
    for (size_t i = 0; i < system->bristle_count && integrator->tried > 0.0; i++) {
        Event event = {.time = INFINITY};
        for (int which = 0; which < BRISTLE_MARGINS; which++) {
            BristleMargin margin = {
                .system = system, .integrator = integrator, .bristle = i, .which = which};
            const double time = has_margin(system, i, which) ? used_up(&margin) : INFINITY;
            if (time < event.time) {
                event = (Event){
                    .time = time,
                    .contact = i,
                    .is_bristle = true,
                    .bends = which == BRISTLE_FACE ? system->bristles[i].mode : margin.next,
                    .face = which == BRISTLE_FACE ? margin.face : system->bristles[i].face,
                };
            }
        }
        if (event.time < INFINITY) {
            found->events[found->count++] = event;
        }
    }
}

void bristle_events_apply(System *system, const Event *event, double *y)
{
    Bristle *bristle = &system->bristles[event->contact];
    const bool slid = bristle_slides(bristle->mode);
    bristle->face = event->face;
    bristle->mode = event->bends;
    if (bristle->pair.law == BRISTLE_STICK && bristle_slides(event->bends)) {
        y[system_bristle_index(system, event->contact)] =
            bristle_way(event->bends) * bristle->pair.limit;
    }
    if (slid && event->bends == BRISTLE_STICKING && bristle->contact < 0) {
        system->kind->stick(system, event->contact, y);
    }
}

// The mode of a bristle that begins at the base.
static void find_mode(System *system, size_t number, const double *y)
{
    Bristle *bristle = &system->bristles[number];
    const BristleAt at = system->kind->bristle(system, number, 0.0, y);
    BristlePair pair = bristle->pair;
    pair.damping = at.damping;
    if (pair.law == BRISTLE_STICK && fabs(at.bend) >= pair.limit) {
        bristle->mode = at.bend > 0.0 ? BRISTLE_SLIDING_FORTH : BRISTLE_SLIDING_BACK;
    } else if (bristle->contact >= 0 && pair.law == BRISTLE_STICK && at.damping == 0.0) {
        // where hardly anything presses yet, whatever slides yields
        bristle->mode = bristle_onset(fabs(at.speed) <= at.rounding ? 0.0 : at.speed);
    } else {
        bristle->mode = bristle_begin(&pair, at.bend, at.speed);
    }
}

static void find_modes(System *system, const double *y)
{
    for (size_t i = 0; i < system->bristle_count; i++) {
        find_mode(system, i, y);
    }
}

void bristle_events_onset(System *system, size_t contact, double *y)
{
    for (size_t i = 0; i < system->bristle_count; i++) {
        if (system->bristles[i].contact == (int)contact) {
            y[system_bristle_index(system, i)] = 0.0;
            find_mode(system, i, y);
        }
    }
}

// The faces that press at the start, of which one may turn on another.
static void find_faces(System *system, const double *y)
{
    for (size_t i = 0; i < system->bristle_count * system->bristle_count; i++) {
        Bristle *bristle = &system->bristles[i % system->bristle_count];
        if (bristle->face >= 0) {
            const BristleFace face = system->kind->face(system, i % system->bristle_count, 0.0, y);
            bristle->face = face.margin < 0.0 ? face.next : bristle->face;
        }
    }
}

void bristle_events_start(System *system, double *y)
{
    double *dampings = zeroed(system->bristle_count, sizeof *dampings);
    const Joint *joints = system->scenario->linkage.joints;
    find_faces(system, y);
    // each as if the others held nothing yet
    for (size_t i = 0; i < system->bristle_count; i++) {
        system->kind->stick(system, i, y);
        dampings[i] = system->bristles[i].pair.damping;
        system->bristles[i].pair.damping = 0.0;
    }
    for (size_t i = 0; i < system->bristle_count; i++) {
        system->bristles[i].pair.damping = dampings[i];
        y[system_bristle_index(system, i)] =
            joints[system->bristles[i].joint].contacts[system_bristle_place(system, i)].bend;
    }
    free(dampings);
    find_modes(system, y);
    system->kind->hold(system, y);
    find_faces(system, y);
    find_modes(system, y);
}
