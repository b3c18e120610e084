// Where are the bodies of a mechanism, by the midpoint rule and extrapolation?
//
// Gragg's midpoint rule with n = 2, 4, 6, ... substeps of one step has an error in even powers of
// the substep; each further row of the table of Aitken and Neville,
//     T_kj = T_k,j-1 + (T_k,j-1 - T_k-1,j-1) / ((n_k / n_k-j)^2 - 1),
// removes one of them (E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations
// I, 1993, section II.9). A step is taken with the first row at which T_kk and T_k,k-1 agree within
// the tolerance.
//
// Between events every contact keeps its mode:
//     apart    no force; ends where the depth d becomes positive: v0 is then the closing speed d'
//     pressed  F(d) (1 + chi d' / v0) + c(d) d'; ends where d or the force becomes negative
//     slack    no force; ends where d becomes negative or the force would be positive
// A pressed contact that has moved out and comes back has outlasted its impact: from where d' is
// zero on v0 is the law's resting speed. A step in which a mode ends is repeated until it ends
// there.
#include "maximal.h"

#include "base/zeroed.h"

#include <assert.h>
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 10, FEWEST = 2, EASY = 5, HARD = 8, LOCATE_MAX = 80, IDLE_MAX = 200 };

static const double FIRST_STEP_S = 1e-7;

// in a run without contacts, where only accuracy counts
static const double STEPS_LEAST_SMOOTH = 200.0;
static const double SHORTEST_S = 1e-17;
static const long STEPS_MOST = 4000000;

// of a step, how near to its end an event is the end
static const Real AT_END = 1e-15L;

// roundings of a number that a step's error may always have
static const Real ROUNDINGS = 4.0L * LDBL_EPSILON;

// a pivot that is so small a share of its row's own diagonal is one of a row that others imply
static const Real DEPENDENT = 1e-14L;

void maximal_init(Maximal *maximal, size_t count, size_t contact_count)
{
    maximal->count = count;
    maximal->contact_count = contact_count;
    maximal->start = zeroed(count, sizeof *maximal->start);
    maximal->arms = zeroed(count, sizeof *maximal->arms);
    maximal->is_speed = zeroed(count, sizeof *maximal->is_speed);
    maximal->contacts = zeroed(contact_count, sizeof *maximal->contacts);
}

void maximal_finish(Maximal *maximal)
{
    free(maximal->start);
    free(maximal->arms);
    free(maximal->is_speed);
    free(maximal->contacts);
}

void maximal_destroy(Maximal *maximal)
{
    if (maximal != NULL) {
        maximal->kind->destroy(maximal);
    }
}

static Real conforming_force(const Conforming *law, Real depth)
{
    if (!(depth > 0.0L)) {
        return 0.0L;
    }
    const Real x = CONFORMING_SCALE * log1pl(log1pl(law->play / depth)) - CONFORMING_SHIFT;
    Real width = 0.0L;
    for (int i = CONFORMING_TERMS - 1; i >= 0; i--) {
        width = width * fminl(x, 1.0L) + law->series[i];
    }
    return law->stiffness * depth / width;
}

// The elastic force of the law, N, to the precision of Real: that of force_law_elastic would do to
// one part in 1e16 only, which is rough for small steps.
static Real elastic_force(const ForceLaw *law, Real depth)
{
    if (law->family == FORCE_LAW_POWER) {
        return law->stiffness * powl(depth, law->exponent);
    }
    if (law->family == FORCE_LAW_CONFORMING) {
        return conforming_force(&law->conforming, depth);
    }
    Real force = force_law_elastic(law, (double)depth);
    for (int i = 0; i < 3 && force > 0.0L; i++) {
        const Real rest = law->offset - logl(force);
        force -= (law->compliance * force * rest - depth) / (law->compliance * (rest - 1.0L));
    }
    return force;
}

// The viscous coefficient at a depth, N s/m.
static Real viscous_at(const ForceLaw *law, Real depth)
{
    if (!(law->full_damping_depth > 0.0) || depth >= law->full_damping_depth) {
        return law->viscous;
    }
    const Real share = depth / law->full_damping_depth;
    return law->viscous * share * share * (3.0L - 2.0L * share);
}

// The force that would press and the sign by which a pressing contact goes slack.
static Real pressing(const MaximalContact *contact, MaximalGap gap, Real *release)
{
    const ForceLaw *law = &contact->law;
    const Real size = elastic_force(law, fabsl(gap.depth));
    // odd below zero depth: a step beyond the end of a contact stays smooth
    const Real elastic = gap.depth < 0.0L ? -size : size;
    const Real rise = 1.0L + contact->damping_rate * gap.closing;
    const Real force = elastic * rise + viscous_at(law, gap.depth) * gap.closing;
    *release = law->viscous > 0.0 ? force : rise;
    return force;
}

Real maximal_press(const MaximalContact *contact, MaximalGap gap)
{
    Real release;
    return contact->mode == MAXIMAL_PRESSED ? pressing(contact, gap, &release) : 0.0L;
}

// Factorises with the largest share of its own diagonal first; rows without a share are left out.
void maximal_solve(size_t n, Real *a, Real *b)
{
    Real *diagonal = zeroed(n, sizeof *diagonal);
    size_t *order = zeroed(n, sizeof *order);
    size_t rank = 0;
    for (size_t i = 0; i < n; i++) {
        diagonal[i] = a[i * n + i];
        order[i] = i;
    }
    for (; rank < n; rank++) {
        size_t best = rank;
        Real share = 0.0L;
        for (size_t i = rank; i < n; i++) {
            const size_t row = order[i];
            const Real own = diagonal[row] > 0.0L ? a[row * n + row] / diagonal[row] : 0.0L;
            if (own > share) {
                share = own;
                best = i;
            }
        }
        if (!(share > DEPENDENT)) {
            break;
        }
        const size_t pivot = order[best];
        order[best] = order[rank];
        order[rank] = pivot;
        for (size_t i = rank + 1; i < n; i++) {
            const size_t row = order[i];
            const Real factor = a[row * n + pivot] / a[pivot * n + pivot];
            if (factor == 0.0L) {
                continue;
            }
            for (size_t k = rank + 1; k < n; k++) {
                a[row * n + order[k]] -= factor * a[pivot * n + order[k]];
            }
            b[row] -= factor * b[pivot];
        }
    }
    for (size_t i = n; i-- > 0;) {
        const size_t row = order[i];
        if (i >= rank) {
            b[row] = 0.0L;
            continue;
        }
        for (size_t k = i + 1; k < rank; k++) {
            b[row] -= a[row * n + order[k]] * b[order[k]];
        }
        b[row] /= a[row * n + row];
    }
    free(diagonal);
    free(order);
}

typedef struct Motor {
    Maximal *maximal;
    double tolerance;
    double since_s; // start of the piece of the time tables
    Real time_s;
    Real *y;
    Real *begin;  // rates there
    Real *next;   // the step tried
    Real *room;   // for the midpoint rule, three states
    Real *table;  // ROWS states, and what they were in the row before
    Real fastest; // m/s, so far
    Real longest; // s, of a step: events are looked for at its end
    int row;      // at which the step was taken
    long steps;
} Motor;

static void midpoint(Motor *motor, Real length, int substeps, Real *end)
{
    const Maximal *maximal = motor->maximal;
    const size_t n = maximal->count;
    const Real h = length / substeps;
    Real *before = motor->room;
    Real *rates = motor->room + n;
    Real *now = end;
    for (size_t i = 0; i < n; i++) {
        before[i] = motor->y[i];
        now[i] = motor->y[i] + h * motor->begin[i];
    }
    for (int step = 1; step < substeps; step++) {
        maximal->kind->rates(maximal, motor->since_s, motor->time_s + step * h, now, rates);
        for (size_t i = 0; i < n; i++) {
            const Real after = before[i] + 2.0L * h * rates[i];
            before[i] = now[i];
            now[i] = after;
        }
    }
}

// The difference of two states in what is allowed of it.
static Real difference(const Motor *motor, Real length, const Real *a, const Real *b)
{
    const Maximal *maximal = motor->maximal;
    Real largest = 0.0L;
    for (size_t i = 0; i < maximal->count; i++) {
        const Real time = maximal->is_speed[i] ? 1.0L : length;
        const Real speed = motor->fastest / maximal->arms[i];
        const Real allowed =
            fmaxl(motor->tolerance * speed * time,
                  ROUNDINGS * fmaxl(fabsl(motor->y[i]), maximal->is_speed[i] ? speed : 0.0L));
        const Real share = fabsl(a[i] - b[i]) / allowed;
        if (!(share <= largest)) {
            largest = share;
        }
    }
    return largest;
}

// Tries a step; whether it is accurate.
static bool try_step(Motor *motor, Real length)
{
    const size_t n = motor->maximal->count;
    Real *table = motor->table;
    for (int k = 0; k < ROWS; k++) {
        Real *row = motor->room + 2 * n;
        midpoint(motor, length, 2 * (k + 1), row);
        // table[j] holds T_k-1,j and becomes T_kj
        for (int j = 0; j <= k; j++) {
            const Real ratio = (Real)(k + 1) / (Real)(k + 1 - j);
            const Real share = j == 0 ? 0.0L : 1.0L / (ratio * ratio - 1.0L);
            for (size_t i = 0; i < n; i++) {
                // row holds T_k,j-1, the entry before that in the table T_k-1,j-1
                const Real above = j == 0 ? 0.0L : motor->next[i];
                const Real value = j == 0 ? row[i] : row[i] + share * (row[i] - above);
                motor->next[i] = table[(size_t)j * n + i];
                table[(size_t)j * n + i] = value;
                row[i] = value;
            }
        }
        if (k >= FEWEST) {
            const Real error =
                difference(motor, length, table + (size_t)k * n, table + (size_t)(k - 1) * n);
            if (error <= 1.0L) {
                memcpy(motor->next, table + (size_t)k * n, n * sizeof *motor->next);
                motor->row = k;
                return true;
            }
            if (k + 1 >= ROWS || !(error < 1e40L)) {
                return false;
            }
        }
    }
    return false;
}

// Whether a pressed contact that comes back has outlasted its impact by that.
static bool may_rest(const MaximalContact *contact)
{
    return contact->mode == MAXIMAL_PRESSED && contact->law.resting_speed > 0.0 &&
           contact->is_released && !contact->is_resting;
}

// By how much a contact's mode still holds: it ends where this is negative. The rate is that of the
// depth, where the margin is one, else 0.
typedef struct Margin {
    Real left;
    Real rate;
    MaximalMode after;
} Margin;

static Margin margin_of(const Maximal *maximal, size_t contact, const Real *y)
{
    const MaximalContact *of = &maximal->contacts[contact];
    const MaximalGap gap = maximal->kind->gap(maximal, contact, y);
    if (of->mode == MAXIMAL_APART) {
        return (Margin){-gap.depth, -gap.closing, MAXIMAL_PRESSED};
    }
    Real release;
    pressing(of, gap, &release);
    if (gap.depth < 0.0L) {
        return (Margin){gap.depth, gap.closing, MAXIMAL_APART};
    }
    if (of->mode == MAXIMAL_PRESSED && release < 0.0L) {
        return (Margin){release, 0.0L, MAXIMAL_SLACK};
    }
    if (of->mode == MAXIMAL_SLACK && release > 0.0L) {
        return (Margin){-release, 0.0L, MAXIMAL_PRESSED};
    }
    if (may_rest(of) && gap.closing > 0.0L) {
        return (Margin){-gap.closing, 0.0L, MAXIMAL_RESTS};
    }
    return (Margin){gap.depth, gap.closing, MAXIMAL_APART};
}

// The margin of one way in which a mode can end.
static Margin margin_towards(const Maximal *maximal, size_t contact, MaximalMode after,
                             const Real *y)
{
    const MaximalContact *of = &maximal->contacts[contact];
    const MaximalGap gap = maximal->kind->gap(maximal, contact, y);
    const Real sign = of->mode == MAXIMAL_APART ? -1.0L : 1.0L;
    if (of->mode == MAXIMAL_APART || after == MAXIMAL_APART) {
        return (Margin){sign * gap.depth, sign * gap.closing, after};
    }
    if (after == MAXIMAL_RESTS) {
        return (Margin){-gap.closing, 0.0L, after};
    }
    Real release;
    pressing(of, gap, &release);
    return (Margin){after == MAXIMAL_SLACK ? release : -release, 0.0L, after};
}

// Shortens the step until a contact's mode ends with it. Returns its length, negative where that
// cannot be had to the accuracy wanted.
static Real locate(Motor *motor, size_t contact, MaximalMode after, Real length)
{
    const Maximal *maximal = motor->maximal;
    Margin low = margin_towards(maximal, contact, after, motor->y);
    Margin high = margin_towards(maximal, contact, after, motor->next);
    Real from = 0.0L;
    Real to = length;
    Real last = length;
    Margin at = high;
    // the step may begin on an event, whose margin is zero but for rounding
    for (int count = 0; low.left <= 0.0L && count < 30; count++) {
        const Real x = from == 0.0L ? to / 2.0L : from / 2.0L;
        if (!try_step(motor, x)) {
            return -1.0L;
        }
        at = margin_towards(maximal, contact, after, motor->next);
        last = x;
        if (at.left > 0.0L) {
            low = at;
            from = x;
        } else {
            high = at;
            to = x;
        }
    }
    if (low.left <= 0.0L) {
        return 0.0L;
    }
    int kept = 0;
    for (int count = 0; count < LOCATE_MAX && to - from > AT_END * length; count++) {
        Real x = (from * high.left - to * low.left) / (high.left - low.left);
        if (at.rate != 0.0L) {
            const Real newton = last - at.left / at.rate;
            x = newton > from && newton < to ? newton : x;
        }
        if (!(x > from && x < to)) {
            x = 0.5L * (from + to);
        }
        if (x == last || !try_step(motor, x)) {
            break;
        }
        const Real moved = fabsl(x - last);
        last = x;
        at = margin_towards(maximal, contact, after, motor->next);
        if (at.left == 0.0L || moved <= AT_END * length) {
            return x;
        }
        if (at.left < 0.0L) {
            to = x;
            high = at;
            low.left = kept == -1 ? low.left / 2.0L : low.left;
            kept = -1;
        } else {
            from = x;
            low = at;
            high.left = kept == 1 ? high.left / 2.0L : high.left;
            kept = 1;
        }
    }
    return try_step(motor, last) ? last : -1.0L;
}

// Where within a step a margin that is positive at both ends may have been zero: at the extreme of
// the cubic through values and rates; 1 where it has none that matters.
static Real dip_of(const Motor *motor, size_t contact, Real length)
{
    const Maximal *maximal = motor->maximal;
    const Margin a = margin_towards(
        maximal, contact,
        maximal->contacts[contact].mode == MAXIMAL_APART ? MAXIMAL_PRESSED : MAXIMAL_APART,
        motor->y);
    const Margin b = margin_towards(maximal, contact, a.after, motor->next);
    if (!(a.rate < 0.0L && b.rate > 0.0L)) {
        return 1.0L;
    }
    const Real da = a.rate * length;
    const Real db = b.rate * length;
    const Real c3 = 2.0L * (a.left - b.left) + da + db;
    const Real c2 = -3.0L * (a.left - b.left) - 2.0L * da - db;
    Real x = -da / (db - da);
    for (int i = 0; i < 8; i++) {
        const Real slope = da + x * (2.0L * c2 + x * 3.0L * c3);
        const Real curve = 2.0L * c2 + 6.0L * c3 * x;
        x = curve != 0.0L ? x - slope / curve : x;
    }
    const Real least = a.left + x * (da + x * (c2 + x * c3));
    const bool matters = least < 0.2L * fminl(a.left, b.left);
    return matters && x > 1e-3L && x < 0.999L ? x : 1.0L;
}

// m: nearer than this a step that begins or ends at a corner is at it
static const Real AT_CORNER = 1e-12L;

// Where something passes zero within a step, by a secant; 1 where it does not.
static Real passing(Real a, Real b)
{
    const bool passes = a < 0.0L ? b > AT_CORNER : b < -AT_CORNER;
    return passes && fabsl(a) > AT_CORNER ? a / (a - b) : 1.0L;
}

// Where within a step the gap of a contact that touches has a corner in its curvature, or its
// damping is whole; 1 where nothing is. Extrapolation does not see what it loses there.
static Real corner_of(const Motor *motor, size_t contact)
{
    const Maximal *maximal = motor->maximal;
    const Real full = maximal->contacts[contact].law.full_damping_depth;
    if (maximal->contacts[contact].mode == MAXIMAL_APART) {
        return 1.0L;
    }
    Real first = 1.0L;
    if (full > 0.0L) {
        first = passing(maximal->kind->gap(maximal, contact, motor->y).depth - full,
                        maximal->kind->gap(maximal, contact, motor->next).depth - full);
    }
    return maximal->kind->corner == NULL
               ? first
               : fminl(first, passing(maximal->kind->corner(maximal, contact, motor->y),
                                      maximal->kind->corner(maximal, contact, motor->next)));
}

// The same of the torque of a soft drive, which may be beyond its limit to either side.
static Real limit_of(const Motor *motor, Real length)
{
    const Maximal *maximal = motor->maximal;
    return maximal->kind->limit == NULL
               ? 1.0L
               : passing(maximal->kind->limit(maximal, motor->time_s, motor->y),
                         maximal->kind->limit(maximal, motor->time_s + length, motor->next));
}

static void change_mode(Motor *motor, size_t contact, MaximalMode after)
{
    MaximalContact *of = &motor->maximal->contacts[contact];
    if (after == MAXIMAL_RESTS) {
        of->is_resting = true;
        of->damping_rate =
            of->law.hysteresis / fmaxl(of->law.resting_speed, (Real)of->law.impact_speed_floor);
        return;
    }
    if (of->mode == MAXIMAL_APART) {
        const MaximalGap gap = motor->maximal->kind->gap(motor->maximal, contact, motor->y);
        of->damping_rate =
            of->law.hysteresis / fmaxl(gap.closing, (Real)of->law.impact_speed_floor);
        of->is_released = of->is_resting = false;
    }
    of->mode = after;
}

static void accept(Motor *motor, Real length)
{
    Maximal *maximal = motor->maximal;
    memcpy(motor->y, motor->next, maximal->count * sizeof *motor->y);
    motor->time_s += length;
    motor->steps++;
    maximal->kind->project(maximal, motor->time_s, motor->y);
    motor->fastest = fmaxl(motor->fastest, maximal->kind->fastest(maximal, motor->y));
    for (size_t i = 0; i < maximal->contact_count; i++) {
        MaximalContact *contact = &maximal->contacts[i];
        contact->is_released =
            contact->is_released || (contact->mode != MAXIMAL_APART &&
                                     maximal->kind->gap(maximal, i, motor->y).closing < 0.0L);
    }
}

// The first event in the step that stands in next, which is shortened to end on it. The number of
// the contact, or contact_count; *length is negative where the step has to be tried again.
static size_t find_event(Motor *motor, Real *length, MaximalMode *after)
{
    const Maximal *maximal = motor->maximal;
    size_t found = maximal->contact_count;
    size_t rounds = 0; // events that rounding cannot tell apart may each come before the others
    for (size_t i = 0; i<maximal->contact_count && * length> 0.0L; i++) {
        const Margin margin = margin_of(maximal, i, motor->next);
        // a contact may go slack before it ends
        const bool is_other = i != found || margin.after != *after;
        if (margin.left < 0.0L && is_other && rounds < 3 * maximal->contact_count) {
            rounds++;
            *length = locate(motor, i, margin.after, *length);
            *after = margin.after;
            found = i;
            i = (size_t)-1; // others may have ended before
        }
    }
    return found;
}

// Whether nothing free has come further than it may unseen.
static Real flight_of(const Motor *motor)
{
    const Maximal *maximal = motor->maximal;
    Real longest = INFINITY;
    for (size_t i = 0; i < maximal->contact_count; i++) {
        const MaximalContact *of = &maximal->contacts[i];
        if (of->mode == MAXIMAL_APART && of->flight > 0.0L) {
            const MaximalGap gap = maximal->kind->gap(maximal, i, motor->y);
            longest = fminl(longest, of->flight / fmaxl(fabsl(gap.closing), 1e-12L));
        }
    }
    return longest;
}

// Takes one step of at most a length; the length for the next.
static bool advance(Motor *motor, Real most, Real *wanted, int *idle)
{
    Maximal *maximal = motor->maximal;
    maximal->kind->rates(maximal, motor->since_s, motor->time_s, motor->y, motor->begin);
    Real length = fminl(fminl(*wanted, flight_of(motor)), fminl(motor->longest, most));
    bool is_cut = length < *wanted;
    while (length > SHORTEST_S || length == most) {
        if (!try_step(motor, length)) {
            length *= 0.4L;
            is_cut = false;
            continue;
        }
        const int row = motor->row;
        Real whole = length;
        for (size_t i = 0; i < maximal->contact_count; i++) {
            if (margin_of(maximal, i, motor->next).left >= 0.0L) {
                whole = fminl(whole, dip_of(motor, i, length) * length);
            }
            whole = fminl(whole, corner_of(motor, i) * length);
        }
        whole = fminl(whole, limit_of(motor, length) * length);
        if (whole < length) {
            length = whole;
            is_cut = true;
            continue;
        }
        MaximalMode after = MAXIMAL_APART;
        Real to_event = length;
        const size_t event = find_event(motor, &to_event, &after);
        if (to_event < 0.0L) {
            length *= 0.4L;
            continue;
        }
        const Real scale = row <= 3 ? 3.0L : row < EASY ? 1.8L : row < HARD ? 1.1L : 0.8L;
        *wanted = is_cut ? fmaxl(*wanted, scale * length) : scale * length;
        if (event == maximal->contact_count) {
            accept(motor, length);
            *idle = 0;
            return true;
        }
        if (to_event > 0.0L) {
            accept(motor, to_event);
        }
        *idle = to_event > 0.0L ? 0 : *idle + 1;
        change_mode(motor, event, after);
        *wanted = fminl(*wanted, fmaxl(0.3L * length, (Real)SHORTEST_S * 1e3L));
        return *idle < IDLE_MAX;
    }
    return false;
}

static double next_bend(const Scenario *scenario, double time_s)
{
    return fmin(drive_next_kink(&scenario->linkage.driver, time_s),
                time_table_next_bend(&scenario->linkage.torque.table, time_s));
}

static bool run_to(Motor *motor, double to_s, Real *wanted)
{
    int idle = 0;
    while (motor->time_s < to_s) {
        const double bend_s = next_bend(motor->maximal->scenario, motor->since_s);
        const Real most = fminl((Real)to_s, (Real)bend_s) - motor->time_s;
        if (motor->steps > STEPS_MOST || !advance(motor, most, wanted, &idle)) {
            return false;
        }
        if (motor->time_s >= bend_s) {
            motor->since_s = bend_s;
            motor->time_s = bend_s;
        }
        if (fabsl(motor->time_s - to_s) <= 1e-18L) {
            motor->time_s = to_s;
        }
    }
    return true;
}

static Motor motor_create(Maximal *maximal, double tolerance)
{
    const size_t n = maximal->count;
    Motor motor = {
        .maximal = maximal,
        .tolerance = tolerance,
        .y = zeroed(n, sizeof(Real)),
        .begin = zeroed(n, sizeof(Real)),
        .next = zeroed(n, sizeof(Real)),
        .room = zeroed(3 * n, sizeof(Real)),
        .table = zeroed(ROWS * n, sizeof(Real)),
    };
    memcpy(motor.y, maximal->start, n * sizeof(Real));
    return motor;
}

static void motor_finish(Motor *motor)
{
    free(motor->y);
    free(motor->begin);
    free(motor->next);
    free(motor->room);
    free(motor->table);
}

Trajectory *maximal_run(const Scenario *scenario, const MaximalFlaw *flaw, double tolerance,
                        double steps_least, double until_s)
{
    Trajectory *trajectory = trajectory_create(scenario, "maximal coordinates");
    Err err = {ERR_NONE, ""};
    Maximal *maximal = scenario->linkage.is_spatial ? maximal_space_create(scenario, flaw, &err)
                                                    : maximal_plane_create(scenario, flaw, &err);
    if (maximal == NULL) {
        snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
        return trajectory;
    }
    Motor motor = motor_create(maximal, tolerance);
    Real wanted = FIRST_STEP_S;
    motor.longest = scenario_duration(scenario) /
                    (maximal->contact_count > 0 ? steps_least : STEPS_LEAST_SMOOTH);
    motor.fastest = fmaxl(maximal->kind->fastest(maximal, motor.y), 1e-3L);
    trajectory->is_complete = true;
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        trajectory->times[k] = scenario_sample_time(scenario, k);
        if (trajectory->times[k] > until_s) {
            continue;
        }
        if (!run_to(&motor, trajectory->times[k], &wanted)) {
            snprintf(trajectory->message, sizeof trajectory->message,
                     "at %.6g ms no step was accurate", 1e3 * (double)motor.time_s);
            trajectory->is_complete = false;
            break;
        }
        maximal->kind->sample(maximal, motor.y, trajectory, k);
    }
    trajectory->steps = (size_t)motor.steps;
    motor_finish(&motor);
    maximal_destroy(maximal);
    return trajectory;
}
