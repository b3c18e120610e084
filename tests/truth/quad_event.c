// When does contact begin, when does it end, and when does its force?
//
// An event is a root of the margin by which a joint's mode still holds:
//     onset  -d,     end  d,     clamp  m,     unclamp  -m
// with m = 1 + chi d'/v0, or d' + F_el / c. It is looked for at the nodes of a solved step, and
// between two nodes where d has an extreme that could reach the wall. Then it is a root in the
// step's length h: Newton's method for d, whose rate is known, the secant's for the force.
#include "quad_event.h"

enum { N = QUAD_GAUSS_NODES, LOCATE_MAX = 60, DIP_MAX = 40, MEET_MAX = 15 };

// m or 1: a hundred times what is rounded off
static const double ON_EVENT = 1e-31;
// 1: a change of the time that rounding makes
static const double TIME_DIGITS = 1e-33;
// good enough for a first guess: Newton's method doubles these digits
static const double LOCATED = 1e-18;

static Quad margin_of(const QuadStep *step, const QuadEvent *event, const QuadGap *gap)
{
    switch (event->kind) {
    case QUAD_EVENT_ONSET:
        return -gap->penetration;
    case QUAD_EVENT_END:
        return gap->penetration;
    default: {
        const Quad margin = quad_problem_margin(step->problem, &step->contacts, event->joint, gap);
        return event->kind == QUAD_EVENT_CLAMP ? margin : -margin;
    }
    }
}

// The event that has happened to a joint by now, if any.
static QuadEventKind happened(const QuadStep *step, size_t joint, const QuadGap *gap)
{
    const QuadMode mode = step->contacts.mode[joint];
    if (mode == QUAD_FREE) {
        return gap->penetration > 0 ? QUAD_EVENT_ONSET : QUAD_EVENT_NONE;
    }
    if (gap->penetration < 0) {
        return QUAD_EVENT_END;
    }
    const Quad margin = quad_problem_margin(step->problem, &step->contacts, joint, gap);
    if (mode == QUAD_PRESSED) {
        return margin < 0 ? QUAD_EVENT_CLAMP : QUAD_EVENT_NONE;
    }
    return margin > 0 ? QUAD_EVENT_UNCLAMP : QUAD_EVENT_NONE;
}

static QuadGap gap_at(const QuadStep *step, size_t joint, Quad x)
{
    QuadCoordinates position;
    QuadCoordinates velocity;
    quad_step_state(step, x, position, velocity);
    return quad_problem_gap(step->problem, joint, position, velocity);
}

static Quad margin_at(const QuadStep *step, const QuadEvent *event, Quad x)
{
    const QuadGap gap = gap_at(step, event->joint, x);
    return margin_of(step, event, &gap);
}

// Where an event's margin is lost between two places: regula falsi, halving the end that stays.
static Quad locate(const QuadStep *step, const QuadEvent *event, Quad low, Quad high)
{
    Quad at_low = margin_at(step, event, low);
    Quad at_high = margin_at(step, event, high);
    int kept = 0;
    for (int count = 0; count < LOCATE_MAX && high - low > LOCATED; count++) {
        Quad x = (low + high) / 2;
        if (at_low > 0 && at_high < 0) {
            x = (low * at_high - high * at_low) / (at_high - at_low);
        }
        const Quad value = margin_at(step, event, x);
        if (value == 0) {
            return x;
        }
        if (value < 0) {
            high = x;
            at_high = value;
            at_low = kept == -1 ? at_low / 2 : at_low;
            kept = -1;
        } else {
            low = x;
            at_low = value;
            at_high = kept == 1 ? at_high / 2 : at_high;
            kept = 1;
        }
    }
    return high;
}

// Whether the wall is crossed and crossed back between two places, and a place beyond it.
static bool dips(const QuadStep *step, size_t joint, Quad low, Quad high, Quad *x)
{
    const Quad side = step->contacts.mode[joint] == QUAD_FREE ? -1 : 1;
    for (int count = 0; count < DIP_MAX; count++) {
        *x = (low + high) / 2;
        const QuadGap gap = gap_at(step, joint, *x);
        if (side * gap.penetration < 0) {
            return true;
        }
        *(side * gap.rate < 0 ? &low : &high) = *x;
    }
    return false;
}

// Whether d could reach the wall between two places: at both it moves towards it from within.
static bool could_dip(const QuadStep *step, size_t joint, const QuadGap *low, const QuadGap *high,
                      Quad duration)
{
    const Quad side = step->contacts.mode[joint] == QUAD_FREE ? -1 : 1;
    const Quad nearest = fminq(fabsq(low->penetration), fabsq(high->penetration));
    // twice what the steeper of the tangents covers
    return side * low->rate < 0 && side * high->rate > 0 &&
           nearest < 2 * duration * fmaxq(fabsq(low->rate), fabsq(high->rate));
}

static QuadEvent first_of(const QuadStep *step, size_t joint)
{
    QuadEvent event = {QUAD_EVENT_NONE, joint, 1};
    Quad low = 0;
    QuadGap gap_low = {.rate = 0};
    for (int i = 0; i <= N; i++) {
        const Quad x = i < N ? step->gauss.node[i] : (Quad)1;
        const QuadGap gap =
            quad_problem_gap(step->problem, joint, i < N ? step->position[i] : step->end_position,
                             i < N ? step->velocity[i] : step->end_velocity);
        // a step laid towards an end of contact ends on it
        const bool is_looked_at = i < N || step->map != QUAD_MAP_END;
        event.kind = is_looked_at ? happened(step, joint, &gap) : QUAD_EVENT_NONE;
        if (event.kind != QUAD_EVENT_NONE) {
            event.x = i == 0 ? 0 : locate(step, &event, low, x);
            return event;
        }
        const Quad duration = quad_step_time(step, x) - quad_step_time(step, low);
        Quad beyond = 0;
        if (i > 0 && could_dip(step, joint, &gap_low, &gap, duration) &&
            dips(step, joint, low, x, &beyond)) {
            event.kind =
                step->contacts.mode[joint] == QUAD_FREE ? QUAD_EVENT_ONSET : QUAD_EVENT_END;
            event.x = locate(step, &event, low, beyond);
            return event;
        }
        low = x;
        gap_low = gap;
    }
    return event;
}

QuadEvent quad_event_first(const QuadStep *step)
{
    QuadEvent first = {QUAD_EVENT_NONE, 0, 1};
    for (size_t k = 0; k < step->problem->joint_count; k++) {
        if (step->problem->joints[k].has_play) {
            const QuadEvent event = first_of(step, k);
            if (event.kind != QUAD_EVENT_NONE &&
                (first.kind == QUAD_EVENT_NONE || event.x < first.x)) {
                first = event;
            }
        }
    }
    return first;
}

bool quad_event_meet(QuadStep *step, QuadMap map, Quad length_s, const QuadEvent *event)
{
    const bool is_of_gap = event->kind == QUAD_EVENT_ONSET || event->kind == QUAD_EVENT_END;
    Quad length = length_s;
    Quad other = 0;
    Quad value_other = margin_at(step, event, 0);
    for (int round = 0; round < MEET_MAX; round++) {
        if (!quad_step_solve(step, map, length)) {
            return false;
        }
        const QuadGap gap =
            quad_problem_gap(step->problem, event->joint, step->end_position, step->end_velocity);
        const Quad value = margin_of(step, event, &gap);
        if (fabsq(value) <= ON_EVENT) {
            return true;
        }
        Quad slope = event->kind == QUAD_EVENT_ONSET ? -gap.rate : gap.rate;
        if (!is_of_gap) {
            slope = (value - value_other) / (length - other);
            value_other = value;
            other = length;
        }
        const Quad change = -value / slope;
        if (!(fabsq(change) < length / 2)) {
            return false;
        }
        if (fabsq(change) < TIME_DIGITS * (step->start_s + length)) {
            return true;
        }
        length += change;
    }
    return false;
}
