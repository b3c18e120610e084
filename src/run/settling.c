// Turns a mechanism until its motion repeats.
//
// Each revolution, or period of a drive whose speed repeats, is a run of the reference by itself,
// from the state of the last (model/state.h), so that what comes out of n revolutions does not
// depend on how many follow. With x_n the section after n revolutions, velocities over the fastest,
// and F_n the largest forces of each joint, the motion repeats after p revolutions where
//     d_n = max(|x_n - x_(n-p)|, |F_n - F_(n-p)| / F_n)
// is small and so is what is still to come of it: with r = d_n / d_(n-p), the sum d_n r / (1 - r).
// A motion that comes near no earlier section does not repeat. Then the largest force of a
// revolution is a random number, which has settled where Mann and Whitney's rank test tells the
// later revolutions from earlier ones no more.
//
// A start that is not the first may turn at a tolerance of the reference that follows how near its
// motion is to repeating, or to that of the first.
#include "run/settling.h"

#include "base/memory.h"
#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// 1: of two changes, the ratio above which nothing can be said of what is to come
static const double RATIO_MOST = 0.98;

// 1: changes below this are those of rounding and of the reference's tolerance
static const double CHANGE_LEAST = 1e-9;

// Of the reference while it settles: each revolution then takes half the time of one at the default
// tolerance, and peaks differ from those by less than 1e-7.
static const double SETTLE_REFERENCE = 1e-10;

const double SETTLE_SAME_MOTION = 1e-5;

// 1: a section that comes as near to an earlier one may be on its way to repeat
static const double NEAR_RETURN = 1e-2;

// Of a motion that is to count as one that does not repeat: revolutions at least of each start, and
// of its last ones those that come near no earlier section. Four starts then have 32 that count.
enum { RANDOM_LEAST = 16, RANDOM_LAST = 6 };

// Of the reference where the last revolution came near no earlier one: what is random is so at any
// tolerance, and a revolution takes half the time.
static const double SETTLE_LOOSE = 1e-7;
enum { LOOSE_FROM = 6 }; // revolutions, before which a motion has not had the time to come near

// 1: of how near a motion is to an earlier revolution or to a known motion, the reference's
// tolerance on its way there: a peak is then wrong by less than a hundredth of it
static const double NEAR_SHARE = 1e-5;

// Of the reference on that way at the loosest: a peak is off by less than a thousandth.
static const double QUICK_LOOSE = 1e-6;

// Of a rank test: in standard deviations, what one in a hundred samples exceeds by chance.
static const double DRIFT_LEAST = 2.6;

Settling settling_start(const Scenario *scenario)
{
    Settling settling = {
        .scenario = scenario_copy(scenario),
        .state = run_state_create(&scenario->linkage),
        .change = INFINITY,
        .left = INFINITY,
    };
    settling.scenario.run.revolutions = 1.0;
    settling.scenario.run.duration = linkage_period(&scenario->linkage);
    settling.scenario.reference.tolerance =
        fmax(settling.scenario.reference.tolerance, SETTLE_REFERENCE);
    return settling;
}

void settling_finish(Settling *settling)
{
    for (size_t i = 0; i < settling->count; i++) {
        free(settling->revolutions[i].force_max);
        free(settling->revolutions[i].impacts);
        free(settling->revolutions[i].section);
    }
    free(settling->revolutions);
    run_state_free(&settling->state);
    scenario_free(&settling->scenario);
}

static Revolution *add_revolution(Settling *settling)
{
    const Linkage *linkage = &settling->scenario.linkage;
    settling->revolutions =
        memory_grown(settling->revolutions, settling->count + 1, sizeof *settling->revolutions);
    Revolution *added = &settling->revolutions[settling->count++];
    *added = (Revolution){
        .force_max = zeroed(linkage->joint_count, sizeof *added->force_max),
        .impacts = zeroed(linkage->joint_count, sizeof *added->impacts),
        .section = zeroed(SETTLE_RATES * linkage->body_count, sizeof *added->section),
    };
    return added;
}

// Takes what a step says of the joints; `touches` says which touched at its start.
static void take_record(const Linkage *linkage, const StepRecord *record, bool *touches,
                        Revolution *revolution)
{
    const size_t count = solver_joint_count(record->part, linkage);
    for (size_t k = 0; k < count; k++) {
        const size_t i = solver_joint(record->part, k);
        if (!linkage_has_play(&linkage->joints[i])) {
            continue;
        }
        const JointState *joint = &record->joints[k];
        double force = joint->force;
        if (record->peaks != NULL) {
            force = fmax(force, record->peaks[k].force);
        }
        revolution->force_max[i] = fmax(revolution->force_max[i], force);
        revolution->impacts[i] += joint->is_touching && !touches[i] ? 1 : 0;
        touches[i] = joint->is_touching;
    }
}

static void take_section(Settling *settling, Revolution *revolution)
{
    const Linkage *linkage = &settling->scenario.linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Motion *planar = &settling->state.sample.bodies[i];
        SpaceMotion motion = {.velocity = {planar->velocity.x, planar->velocity.y, 0.0},
                              .omega = {0.0, 0.0, planar->omega}};
        if (linkage->is_spatial) {
            motion = settling->state.sample.space_bodies[i];
        }
        const Vec3 turning = vec3_scale(linkage_reach(linkage, (int)i), motion.omega);
        const double rates[SETTLE_RATES] = {motion.velocity.x, motion.velocity.y, motion.velocity.z,
                                            turning.x,         turning.y,         turning.z};
        memcpy(revolution->section + SETTLE_RATES * i, rates, sizeof rates);
        settling->fastest =
            fmax(settling->fastest, vec3_length(motion.velocity) + vec3_length(turning));
    }
}

bool settling_turn(Settling *settling, Err *err)
{
    const Scenario *scenario = &settling->scenario;
    const double end_s = scenario_duration(scenario);
    const Solver *solver = &REFERENCE_SOLVER;
    void *state = NULL;
    if (!solver->open(scenario, &state, err)) {
        return false;
    }
    bool *touches = zeroed(scenario->linkage.joint_count, sizeof *touches);
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        touches[i] = linkage_starts_touching(&scenario->linkage.joints[i]);
    }
    Revolution *revolution = add_revolution(settling);
    double reached_s = 0.0;
    bool is_taken = true;
    while (is_taken && reached_s < end_s) {
        is_taken = solver->step(state, end_s, err);
        if (is_taken) {
            const StepRecord record = solver->record(state);
            take_record(&scenario->linkage, &record, touches, revolution);
            reached_s = record.is_partial ? reached_s : solver_reached(&record);
        }
    }
    if (is_taken) {
        run_state_take(solver, state, end_s, &settling->state);
        take_section(settling, revolution);
        settling->evaluations += solver->model(state).evaluations;
        run_state_start(&settling->state, &settling->scenario);
    }
    solver->close(state);
    free(touches);
    if (settling->watch != NULL) {
        turn_watch_count(settling->watch, settling->is_callers);
    }
    return is_taken;
}

// The larger of the differences of two revolutions' sections and largest forces, relative.
static double revolutions_apart(const Linkage *linkage, const Revolution *now,
                                const Revolution *then, double fastest)
{
    double apart = 0.0;
    for (size_t i = 0; i < SETTLE_RATES * linkage->body_count; i++) {
        apart = fmax(apart, fabs(now->section[i] - then->section[i]) / fastest);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const double force = fmax(now->force_max[i], then->force_max[i]);
        const double by = fabs(now->force_max[i] - then->force_max[i]);
        apart = force > 0.0 ? fmax(apart, by / force) : apart;
    }
    return apart;
}

// d_n above, over p revolutions.
static double change_over(const Settling *settling, size_t last, size_t period)
{
    return revolutions_apart(&settling->scenario.linkage, &settling->revolutions[last],
                             &settling->revolutions[last - period], settling->fastest);
}

// The shortest period that the revolutions of one of p have to the digits of one motion: a mode
// that changes its sign every revolution while it dies out is small after two revolutions before it
// is after one.
static size_t shortest_period(const Settling *settling, size_t last, size_t p)
{
    size_t shortest = 1;
    while (shortest < p &&
           !(p % shortest == 0 && change_over(settling, last, shortest) <= SETTLE_SAME_MOTION)) {
        shortest++;
    }
    return shortest;
}

// Looks for the shortest period after which nothing more than the tolerance is to come; of
// revolutions at the reference's own tolerance alone, for looser ones may repeat elsewhere.
static bool settling_repeats(Settling *settling, double tolerance)
{
    const size_t last = settling->count - 1;
    const Revolution *of = settling->revolutions;
    for (size_t p = 1; p <= SETTLE_PERIOD_MAX && 2 * p <= last; p++) {
        if (of[last].is_loose || of[last - p].is_loose) {
            continue;
        }
        const double change = change_over(settling, last, p);
        const double before = change_over(settling, last - p, p);
        const double ratio = before > 0.0 ? change / before : 0.0;
        const double left =
            ratio < RATIO_MOST ? change * fmax(ratio, 0.5) / (1.0 - ratio) : INFINITY;
        const bool is_rounding = change < CHANGE_LEAST && before < CHANGE_LEAST;
        if (is_rounding || fmax(change, left) <= tolerance) {
            settling->period = shortest_period(settling, last, p);
            settling->change = change;
            settling->left = is_rounding ? change : left;
            return true;
        }
    }
    return false;
}

// How far the ranks of the later half of some numbers are from those of the earlier half, in
// standard deviations: U = (number of pairs of which the later is larger) - its mean, n m / 2.
static double drift_of(const double *values, size_t count)
{
    const size_t half = count / 2;
    const double pairs = (double)half * (double)(count - half);
    double larger = 0.0;
    for (size_t i = 0; i < half; i++) {
        for (size_t k = half; k < count; k++) {
            larger += values[k] > values[i] ? 1.0 : values[k] == values[i] ? 0.5 : 0.0;
        }
    }
    return fabs(larger - 0.5 * pairs) / sqrt(pairs * (double)(count + 1) / 12.0);
}

size_t settling_counted(const Settling *settling)
{
    return settling->period > 0 ? settling->period : (settling->count + 1) / 2;
}

size_t settling_forces(const Settling *settling, size_t joint, double *forces)
{
    const size_t many = settling_counted(settling);
    for (size_t k = 0; k < many; k++) {
        forces[k] = settling->revolutions[settling->count - many + k].force_max[joint];
    }
    return many;
}

static bool settling_drifts(const Settling *settling)
{
    double *forces = zeroed(settling->count, sizeof *forces);
    bool drifts = false;
    for (size_t i = 0; i < settling->scenario.linkage.joint_count; i++) {
        const size_t many = settling_forces(settling, i, forces);
        drifts = drifts || drift_of(forces, many) > DRIFT_LEAST;
    }
    free(forces);
    return drifts;
}

// How near the revolutions up to one come to those a period before, all of that period: of one
// alone chance brings many of a motion that does not repeat near to an earlier one.
static double nearest_return(const Settling *settling, size_t number)
{
    double nearest = INFINITY;
    for (size_t p = 1; p <= SETTLE_PERIOD_MAX && p <= number; p++) {
        double farthest = 0.0;
        for (size_t k = 0; k < p && k + p <= number; k++) {
            farthest = fmax(farthest, change_over(settling, number - k, p));
        }
        nearest = fmin(nearest, farthest);
    }
    return nearest;
}

static bool is_near_return(const Settling *settling, size_t number)
{
    return nearest_return(settling, number) < NEAR_RETURN;
}

// Whether the last revolutions come near no earlier one, and do not drift.
static bool settling_is_random(const Settling *settling)
{
    if (settling->count < RANDOM_LEAST) {
        return false;
    }
    for (size_t k = 1; k <= RANDOM_LAST; k++) {
        if (is_near_return(settling, settling->count - k)) {
            return false;
        }
    }
    return !settling_drifts(settling);
}

// How far the last period of a motion is from that of another, from a revolution of that on, both
// of that many revolutions.
static double apart_from(const Settling *a, const Settling *b, size_t period, size_t shift)
{
    double apart = 0.0;
    for (size_t k = 0; k < period; k++) {
        const Revolution *of_a = &a->revolutions[a->count - period + k];
        const Revolution *of_b = &b->revolutions[b->count - period + (k + shift) % period];
        const double fastest = fmax(a->fastest, b->fastest);
        apart = fmax(apart, revolutions_apart(&a->scenario.linkage, of_a, of_b, fastest));
    }
    return apart;
}

double settling_apart(const Settling *a, const Settling *b, size_t period)
{
    double nearest = INFINITY;
    for (size_t shift = 0; shift < period && period <= a->count; shift++) {
        nearest = fmin(nearest, apart_from(a, b, period, shift));
    }
    return nearest;
}

// How far the last revolutions are from a motion that is known to repeat.
static double known_apart(const Settling *settling)
{
    const Settling *known = settling->known;
    return known != NULL ? settling_apart(settling, known, known->period) : INFINITY;
}

// Whether it has come to that motion, which is then its own.
static bool is_known(Settling *settling)
{
    const double apart = known_apart(settling);
    if (!(apart <= SETTLE_SAME_MOTION)) {
        return false;
    }
    settling->period = settling->known->period;
    settling->change = apart;
    settling->left = apart;
    return true;
}

// Of the reference in the next revolution.
static double next_tolerance(const Settling *settling, double tight)
{
    const size_t count = settling->count;
    const double nearest = count > 0 ? nearest_return(settling, count - 1) : INFINITY;
    if (settling->is_quick) {
        const double near = fmin(nearest, known_apart(settling));
        return fmax(tight, fmin(NEAR_SHARE * near, QUICK_LOOSE));
    }
    return count >= LOOSE_FROM && nearest >= NEAR_RETURN ? fmax(tight, SETTLE_LOOSE) : tight;
}

bool settling_run(Settling *settling, double tolerance, size_t most, Err *err)
{
    ReferenceOptions *reference = &settling->scenario.reference;
    const double tight = reference->tolerance;
    bool is_run = true;
    while (is_run && settling->count < most && settling->period == 0 && !settling->is_random) {
        reference->tolerance = next_tolerance(settling, tight);
        is_run = settling_turn(settling, err);
        if (is_run) {
            settling->revolutions[settling->count - 1].is_loose = reference->tolerance > tight;
        }
        settling->is_random = is_run && !is_known(settling) &&
                              !settling_repeats(settling, tolerance) &&
                              settling_is_random(settling);
    }
    reference->tolerance = tight;
    return is_run;
}
