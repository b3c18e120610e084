// What do contacts do within a step in which the world around them hardly changes?
//
// With P_j the impulses and Q_j their integrals over time, g the accelerations while nothing
// presses and W the mobility,
//     u_i = u0_i + v0_i t + g_i t^2/2 + sum W_ij Q_j,   v_i = v0_i + g_i t + sum W_ij P_j
//     P' = F(u, v),  Q' = P
// by the classic Runge-Kutta method of order 4, in local steps of LOCAL_PHASE radians of the
// contact's own oscillation. Where a side begins or ends to touch, the local step is cut there to
// rounding; flights between contacts are one step each, to the exact time of the next contact.
#include "world/inside.h"

#include "contact/map_impact.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double LOCAL_PHASE = 0.05; // rad: leaves about phase^4 / 100 of an impact
static const double LOCAL_DECAY = 0.25; // time constants of a damper: stable below 2.8
enum { LOCAL_STEPS_MOST = 1000000, CUTS = 48 };

// The local step under way.
typedef struct Local {
    Inside *inside;
    double time; // s, since the start
    double *state;
    double *next;
    double *work; // of the Runge-Kutta method
} Local;

static void motion_of(const Local *local, const double *state, double time, size_t number,
                      double *position, double *speed)
{
    const Inside *inside = local->inside;
    const InsideJoint *joint = &inside->joints[number];
    const double *mobility = &inside->mobility[number * inside->count];
    *position = joint->position + time * (joint->speed + 0.5 * time * joint->free);
    *speed = joint->speed + time * joint->free;
    for (size_t i = 0; i < inside->count; i++) {
        const double *other = &state[INSIDE_STATE * i];
        *position += mobility[i] * other[2];
        *speed += mobility[i] * (other[0] - other[1]);
    }
}

// A damper presses from the first touch on, at no depth yet.
static double force_of(const Side *side, double position, double speed)
{
    const double depth = fmax(-side_gap(side, position), DBL_MIN);
    return side->is_touching
               ? force_law_force(&side->law, depth, -side->sign * speed, side->impact_speed)
               : 0.0;
}

static void rates_of(const Local *local, const double *state, double time, double *rates)
{
    for (size_t i = 0; i < local->inside->count; i++) {
        double position;
        double speed;
        motion_of(local, state, time, i, &position, &speed);
        const Side *sides = local->inside->joints[i].sides;
        double *rate = &rates[INSIDE_STATE * i];
        rate[0] = force_of(&sides[0], position, speed);
        rate[1] = force_of(&sides[1], position, speed);
        rate[2] = state[INSIDE_STATE * i] - state[INSIDE_STATE * i + 1];
        rate[3] = rate[0] * speed;
        rate[4] = -rate[1] * speed;
    }
}

// From the state to the next one.
static void step_by(const Local *local, double length)
{
    static const double SHARES[] = {0.0, 0.5, 0.5, 1.0};
    static const double WEIGHTS[] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    const size_t size = INSIDE_STATE * local->inside->count;
    double *at = local->work;
    double *rates = local->work + size;
    memcpy(local->next, local->state, size * sizeof(double));
    memset(rates, 0, size * sizeof(double));
    for (int stage = 0; stage < 4; stage++) {
        const double ahead = SHARES[stage] * length;
        for (size_t i = 0; i < size; i++) {
            at[i] = local->state[i] + ahead * rates[i];
        }
        rates_of(local, at, local->time + ahead, rates);
        for (size_t i = 0; i < size; i++) {
            local->next[i] += WEIGHTS[stage] * length * rates[i];
        }
    }
}

// Whether a side does at a time what it did not before: touch, or not touch.
static bool side_changes(const Side *side, double position)
{
    return side->is_touching == (side_gap(side, position) > 0.0);
}

static bool any_changes(const Local *local, const double *state, double time)
{
    for (size_t i = 0; i < local->inside->count; i++) {
        double position;
        double speed;
        motion_of(local, state, time, i, &position, &speed);
        const Side *sides = local->inside->joints[i].sides;
        if (side_changes(&sides[0], position) || side_changes(&sides[1], position)) {
            return true;
        }
    }
    return false;
}

// The length of the local step, cut to just behind the first change in it; takes it into `next`.
static double cut_step(const Local *local, double length)
{
    step_by(local, length);
    if (!any_changes(local, local->next, local->time + length)) {
        return length;
    }
    double before = 0.0;
    double behind = length;
    for (int i = 0; i < CUTS; i++) {
        const double middle = 0.5 * (before + behind);
        step_by(local, middle);
        *(any_changes(local, local->next, local->time + middle) ? &behind : &before) = middle;
    }
    step_by(local, behind);
    return behind;
}

// The first time after now at which gap + speed t + half bend t^2 is 0, coming from above; infinite
// where there is none.
static double first_touch(double gap, double speed, double half_bend)
{
    if (half_bend == 0.0) {
        return speed < 0.0 ? -gap / speed : INFINITY;
    }
    const double square = speed * speed - 4.0 * half_bend * gap;
    if (square < 0.0 || (speed >= 0.0 && half_bend > 0.0)) {
        return INFINITY;
    }
    // without a difference of almost equal numbers
    return speed < 0.0 ? -2.0 * gap / (speed - sqrt(square))
                       : (-speed - sqrt(square)) / (2.0 * half_bend);
}

bool inside_is_near(const InsideJoint *joint, double duration)
{
    for (int i = 0; i < 2; i++) {
        const Side *side = &joint->sides[i];
        const double gap = side_gap(side, joint->position);
        if (side->is_touching || gap < 0.0 ||
            first_touch(gap, side->sign * joint->speed, 0.5 * side->sign * joint->free) <=
                duration) {
            return true;
        }
    }
    return false;
}

// How long a local step may be for a side that touches.
static double side_step(const Side *side, double position, double speed, double mobility)
{
    const double depth = fmax(-side_gap(side, position), 0.0);
    const MapImpactCase impact = {.law = side->law,
                                  .mass = 1.0 / mobility,
                                  .speed = fabs(speed) + side->law.impact_speed_floor};
    const double ahead = map_impact_depth(&impact); // to be expected
    const double deepest = depth > ahead || isnan(ahead) ? depth : ahead;
    const double frequency = sqrt(force_law_tangent(&side->law, deepest) * mobility);
    const double decay = force_law_damping(&side->law, deepest, side->impact_speed) * mobility;
    return fmin(LOCAL_PHASE / frequency, LOCAL_DECAY / decay);
}

// How long the next local step may be: of flights to the next contact.
static double longest_step(const Local *local, double left)
{
    const Inside *inside = local->inside;
    double longest = left;
    for (size_t i = 0; i < inside->count; i++) {
        const InsideJoint *joint = &inside->joints[i];
        double reach = 0.0; // of all joints together
        for (size_t j = 0; j < inside->count; j++) {
            reach += fabs(inside->mobility[i * inside->count + j]);
        }
        double position;
        double speed;
        motion_of(local, local->state, local->time, i, &position, &speed);
        for (int k = 0; k < 2; k++) {
            const Side *side = &joint->sides[k];
            const double flight = first_touch(side_gap(side, position), side->sign * speed,
                                              0.5 * side->sign * joint->free);
            longest =
                fmin(longest, side->is_touching ? side_step(side, position, speed, reach) : flight);
        }
    }
    return longest;
}

// Notes where sides are after a local step of a length, or at the start: what begins, ends, and is
// largest.
static void note(const Local *local, double length)
{
    for (size_t i = 0; i < local->inside->count; i++) {
        double position;
        double speed;
        motion_of(local, local->state, local->time, i, &position, &speed);
        for (int k = 0; k < 2; k++) {
            Side *side = &local->inside->joints[i].sides[k];
            side->inside = fmax(-side_gap(side, position), 0.0);
            side->share = 1.0;
            if (side->is_touching && length > 0.0) {
                side_note_tops(side, force_of(side, position, speed), length);
            }
            if (side_changes(side, position)) {
                side->is_touching = !side->is_touching;
                if (side->is_touching) {
                    side_begin(side, -side->sign * speed);
                }
            }
        }
    }
}

static void add_totals(const Local *local, double duration)
{
    for (size_t i = 0; i < local->inside->count; i++) {
        InsideJoint *joint = &local->inside->joints[i];
        const double *state = &local->state[INSIDE_STATE * i];
        joint->moment = state[2];
        for (int k = 0; k < 2; k++) {
            joint->impulse[k] = state[k];
            joint->sides[k].impulse += state[k];
            joint->sides[k].work += state[3 + k];
            joint->sides[k].force = state[k] / duration;
        }
    }
}

bool inside_run(Inside *inside, double duration)
{
    const size_t size = INSIDE_STATE * inside->count;
    Local local = {.inside = inside,
                   .state = inside->room,
                   .next = inside->room + size,
                   .work = inside->room + 2 * size};
    memset(local.state, 0, size * sizeof(double));
    note(&local, 0.0); // sides that are inside without having been before
    for (int i = 0; i < LOCAL_STEPS_MOST; i++) {
        const double left = duration - local.time;
        if (!(left > 0.0)) {
            add_totals(&local, duration);
            return true;
        }
        const double length = longest_step(&local, left);
        // a flight that rounding ends too early still has to get on
        const double taken = cut_step(&local, fmax(length, 0x1p-52 * duration));
        double *swap = local.state;
        local.state = local.next;
        local.next = swap;
        local.time = taken >= left ? duration : local.time + taken;
        note(&local, taken);
    }
    return false;
}
