// Turns a mechanism until its motion repeats.
//
// Each revolution, or period of a drive whose speed repeats, is a run of the reference by itself,
// from the state of the last (model/state.h), so that what comes out of n revolutions does not
// depend on how many follow. With x_n the section after n revolutions, velocities over the fastest,
// and F_n the largest forces of each joint, the motion repeats after p revolutions where
//     d_n = max(|x_n - x_(n-p)|, |F_n - F_(n-p)| / F_n)
// is small and so is what is still to come of it: with r = d_n / d_(n-p), the sum d_n r / (1 - r).
// Where the last revolutions come near no earlier section, and Mann and Whitney's rank test no
// longer tells later ones from earlier ones, settling_run ends.
#include "run/settling.h"

#include "base/call.h"
#include "base/memory.h"
#include "base/zeroed.h"
#include "run/drive_torque.h"

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

// Of one start alone that is to count as not repeating: revolutions at least, and of its last ones
// those that come near no earlier section.
enum { RANDOM_LEAST = 16, RANDOM_LAST = 6 };

// A motion that does not repeat may have come to it only now: of its revolutions half do not
// count, and not the first ones.
enum { TRANSIENT_SHARE = 2, TRANSIENT_LEAST = 8 };

// Of the reference where the last revolution came near no earlier one: what is random is so at any
// tolerance, and a revolution takes half the time.
static const double SETTLE_LOOSE = 1e-7;
enum { LOOSE_FROM = 6 }; // revolutions, before which a motion has not had the time to come near

// 1: of how near a motion is to an earlier revolution or to a known motion, the reference's
// tolerance on its way there: a peak is then wrong by less than a hundredth of it
static const double NEAR_SHARE = 1e-5;

// Of the reference on that way at the loosest: a peak is off by less than a thousandth.
static const double QUICK_LOOSE = 1e-6;

// Of a force: by so much of the largest so far it may rise between two looks, which parabolas then
// climb to the top of.
static const double FORCE_RISE = 0.01;
enum { FORCE_CLIMBS = 8 };

// Of a rank test: in standard deviations, what one in a hundred samples exceeds by chance.
static const double DRIFT_LEAST = 2.6;

Settling settling_start(const Scenario *scenario)
{
    Settling settling = {
        .scenario = scenario_copy(scenario),
        .reach = zeroed(scenario->linkage.joint_count, sizeof *settling.reach),
        .state = run_state_create(&scenario->linkage),
        .inside = sample_create(&scenario->linkage),
        .change = INFINITY,
        .left = INFINITY,
    };
    settling.scenario.run.revolutions = scenario_settling_turns(scenario);
    settling.scenario.run.duration = scenario_settling_period(scenario);
    settling.scenario.reference.tolerance =
        fmax(settling.scenario.reference.tolerance, SETTLE_REFERENCE);
    return settling;
}

void settling_finish(Settling *settling)
{
    for (size_t i = 0; i < settling->count; i++) {
        free(settling->revolutions[i].numbers);
        free(settling->revolutions[i].section);
    }
    free(settling->revolutions);
    free(settling->reach);
    sample_free(&settling->inside);
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
        .numbers = zeroed(settle_number_count(linkage), sizeof *added->numbers),
        .section = zeroed(SETTLE_RATES * linkage->body_count, sizeof *added->section),
    };
    return added;
}

// A revolution under way.
typedef struct Turn {
    Settling *settling;
    const Solver *solver;
    void *state; // of the solver
    Revolution *revolution;
    double end_s;
    bool *touches;  // by joint, in the step before; owned, like the next
    double *forces; // N or N m, at each look of a step, by joint
} Turn;

static void raise_number(double *number, double value)
{
    *number = fmax(*number, value);
}

// What a step says of a joint with play; returns when its force was larger than before within the
// step, s, or a negative number.
static double take_joint(Turn *turn, const StepRecord *record, size_t index)
{
    const size_t joint = solver_joint(record->part, index);
    double *numbers = turn->revolution->numbers + settle_joint_number(joint, SETTLE_FORCE);
    SettleReach *reach = &turn->settling->reach[joint];
    const JointState *state = &record->joints[index];
    const double before = numbers[SETTLE_FORCE];
    double peak_s = -1.0;
    raise_number(&numbers[SETTLE_FORCE], state->force);
    raise_number(&numbers[SETTLE_DEPTH], joint_state_depth(state));
    if (record->peaks != NULL) {
        const JointPeak *peak = &record->peaks[index];
        const bool is_higher = peak->force > fmax(before, state->force);
        const bool is_inside = peak->force_s > record->start_s && peak->force_s < record->end_s;
        peak_s = is_higher && is_inside ? peak->force_s : -1.0;
        raise_number(&numbers[SETTLE_FORCE], peak->force);
        raise_number(&numbers[SETTLE_DEPTH], peak->depth);
    }
    reach->gap = fmax(reach->gap, state->gap);
    if (state->is_touching) {
        numbers[SETTLE_CONTACT] += (record->end_s - record->start_s) / turn->end_s;
        if (!turn->touches[joint]) {
            numbers[SETTLE_IMPACTS] += 1.0;
            const double approach = record->approach[index];
            reach->approach = fmax(reach->approach, approach);
            reach->slowest = reach->slowest > 0.0 ? fmin(reach->slowest, approach) : approach;
        }
    }
    turn->touches[joint] = state->is_touching;
    return peak_s;
}

// Accelerations and the drives' torques at an instant in the last step.
static void take_instant(Turn *turn, double time_s)
{
    const Scenario *scenario = &turn->settling->scenario;
    const Linkage *linkage = &scenario->linkage;
    Sample *inside = &turn->settling->inside;
    double *numbers = turn->revolution->numbers;
    turn->solver->observe(turn->state, time_s, inside);
    for (size_t i = 0; i < linkage->body_count; i++) {
        raise_number(&numbers[settle_body_number(linkage, i)], fabs(inside->bodies[i].alpha));
    }
    const size_t drives = drive_torque_count(linkage);
    for (size_t i = 0; i < drives; i++) {
        const double torque = drive_torque_of(scenario, inside->bodies, inside->joints, time_s, i);
        raise_number(&numbers[settle_drive_number(linkage, i)], fabs(torque));
    }
}

// The force of a joint at an instant in the last step, N or N m.
static double force_at(const Turn *turn, size_t joint, double time_s)
{
    Sample *inside = &turn->settling->inside;
    turn->solver->observe(turn->state, time_s, inside);
    return inside->joints[joint].force;
}

// Three instants and the force there.
typedef struct ForceTop {
    double time_s[3];
    double force[3];
} ForceTop;

// When the parabola through three instants has its top, s; NAN where it has none.
static double top_of_parabola(const ForceTop *top)
{
    const double *t = top->time_s;
    const double before = (top->force[1] - top->force[0]) / (t[1] - t[0]);
    const double behind = (top->force[2] - top->force[1]) / (t[2] - t[1]);
    const double bend = (behind - before) / (t[2] - t[0]);
    return bend < 0.0 ? 0.5 * (t[0] + t[1]) - 0.5 * before / bend : NAN;
}

// Puts an instant in place of one of the three that is lowest, in order of time.
static void take_into(ForceTop *top, double time_s, double force)
{
    const int out = top->force[0] < top->force[2] ? 0 : 2;
    const int at = out == 0 ? (time_s > top->time_s[1] ? time_s > top->time_s[2] ? 2 : 1 : 0)
                            : (time_s < top->time_s[1] ? time_s < top->time_s[0] ? 0 : 1 : 2);
    const int stride = out == 0 ? 1 : -1;
    for (int i = out; i != at; i += stride) {
        top->time_s[i] = top->time_s[i + stride];
        top->force[i] = top->force[i + stride];
    }
    top->time_s[at] = time_s;
    top->force[at] = force;
}

// Climbs to the largest force of a joint in a step from that of its looks, by parabolas through
// three instants: friction has a part in it, and no step ends where it is largest.
static void climb_force(const Turn *turn, const StepRecord *record, size_t joint, size_t looks)
{
    const double *forces = turn->forces + joint * (looks + 1);
    double *largest = &turn->revolution->numbers[settle_joint_number(joint, SETTLE_FORCE)];
    size_t most = 0;
    for (size_t k = 1; k <= looks; k++) {
        most = forces[k] > forces[most] ? k : most;
    }
    if (forces[most] < (1.0 - FORCE_RISE) * *largest || !(record->end_s > record->start_s)) {
        return;
    }
    const size_t middle = most == 0 ? 1 : most == looks ? looks - 1 : most;
    const double part_s = (record->end_s - record->start_s) / (double)looks;
    ForceTop top;
    for (size_t i = 0; i < 3; i++) {
        top.time_s[i] = record->start_s + (double)(middle - 1 + i) * part_s;
        top.force[i] = forces[middle - 1 + i];
    }
    for (int i = 0; i < FORCE_CLIMBS; i++) {
        const double time_s = top_of_parabola(&top);
        if (!(time_s > record->start_s && time_s < record->end_s) || time_s == top.time_s[0] ||
            time_s == top.time_s[1] || time_s == top.time_s[2]) {
            return;
        }
        const double force = force_at(turn, joint, time_s);
        raise_number(largest, force);
        take_into(&top, time_s, force);
    }
}

// What a step says. An acceleration is as large as any where a force is, which is looked at there.
static void take_record(Turn *turn, const StepRecord *record)
{
    const Linkage *linkage = &turn->settling->scenario.linkage;
    const size_t joints = solver_joint_count(record->part, linkage);
    const size_t looks = record->is_partial ? 0 : turn->settling->looks;
    for (size_t k = 0; k < joints; k++) {
        if (linkage_has_play(&linkage->joints[solver_joint(record->part, k)])) {
            const double peak_s = take_joint(turn, record, k);
            if (looks > 0 && peak_s >= 0.0) {
                take_instant(turn, peak_s);
            }
        }
    }
    for (size_t k = looks > 1 ? 0 : 1; k <= looks; k++) {
        const double share = (double)k / (double)looks;
        take_instant(turn, record->start_s + share * (record->end_s - record->start_s));
        for (size_t i = 0; looks > 1 && i < linkage->joint_count; i++) {
            turn->forces[i * (looks + 1) + k] = turn->settling->inside.joints[i].force;
        }
    }
    for (size_t i = 0; looks > 1 && i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            climb_force(turn, record, i, looks);
        }
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

// Steps to the end of the revolution.
static bool turn_to_end(Turn *turn, Err *err)
{
    double reached_s = 0.0;
    while (reached_s < turn->end_s) {
        if (call_is_cancelled()) {
            return err_set(err, ERR_SOLVER, "%s", CALL_CANCELLED);
        }
        if (!turn->solver->step(turn->state, turn->end_s, err)) {
            return false;
        }
        const StepRecord record = turn->solver->record(turn->state);
        take_record(turn, &record);
        reached_s = record.is_partial ? reached_s : solver_reached(&record);
    }
    return true;
}

bool settling_turn(Settling *settling, Err *err)
{
    const Scenario *scenario = &settling->scenario;
    const Linkage *linkage = &scenario->linkage;
    Turn turn = {
        .settling = settling,
        .solver = &REFERENCE_SOLVER,
        .end_s = scenario_duration(scenario),
    };
    if (!turn.solver->open(scenario, &turn.state, err)) {
        return false;
    }
    turn.forces = zeroed(linkage->joint_count * (settling->looks + 1) + 1, sizeof *turn.forces);
    turn.touches = zeroed(linkage->joint_count, sizeof *turn.touches);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        turn.touches[i] = linkage_starts_touching(&linkage->joints[i]);
    }
    turn.revolution = add_revolution(settling);
    const bool is_turned = turn_to_end(&turn, err);
    if (is_turned) {
        run_state_take(turn.solver, turn.state, turn.end_s, &settling->state);
        take_section(settling, turn.revolution);
        settling->evaluations += turn.solver->model(turn.state).evaluations;
        run_state_start(&settling->state, &settling->scenario);
    }
    turn.solver->close(turn.state);
    free(turn.touches);
    free(turn.forces);
    if (settling->watch != NULL) {
        turn_watch_count(settling->watch, settling->is_callers);
    }
    return is_turned;
}

// The largest difference of two revolutions' sections, over the fastest point's speed.
static double revolution_sections_apart(const Linkage *linkage, const Revolution *now,
                                        const Revolution *then, double fastest)
{
    double apart = 0.0;
    for (size_t i = 0; i < SETTLE_RATES * linkage->body_count; i++) {
        apart = fmax(apart, fabs(now->section[i] - then->section[i]) / fastest);
    }
    return apart;
}

// The largest difference of a joint's largest forces in two revolutions, relative.
static double forces_apart(const Linkage *linkage, const Revolution *now, const Revolution *then)
{
    double apart = 0.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const size_t number = settle_joint_number(i, SETTLE_FORCE);
        const double force = fmax(now->numbers[number], then->numbers[number]);
        const double by = fabs(now->numbers[number] - then->numbers[number]);
        apart = force > 0.0 ? fmax(apart, by / force) : apart;
    }
    return apart;
}

// The larger of both.
static double revolutions_apart(const Linkage *linkage, const Revolution *now,
                                const Revolution *then, double fastest)
{
    return fmax(revolution_sections_apart(linkage, now, then, fastest),
                forces_apart(linkage, now, then));
}

// d_n above, over p revolutions.
static double change_over(const Settling *settling, size_t last, size_t period)
{
    return revolutions_apart(&settling->scenario.linkage, &settling->revolutions[last],
                             &settling->revolutions[last - period], settling->fastest);
}

double settling_forces_change(const Settling *settling, size_t period)
{
    const Revolution *last = &settling->revolutions[settling->count - 1];
    return forces_apart(&settling->scenario.linkage, last, last - period);
}

double settling_section_change(const Settling *settling, size_t period)
{
    const Revolution *last = &settling->revolutions[settling->count - 1];
    return revolution_sections_apart(&settling->scenario.linkage, last, last - period,
                                     settling->fastest);
}

// The shortest period that the revolutions of one of p have to the digits that are asked for: a
// mode that changes its sign every revolution while it dies out is small after two revolutions
// before it is after one.
static size_t shortest_period(const Settling *settling, size_t last, size_t p, double tolerance)
{
    const double same = fmax(SETTLE_SAME_MOTION, 2.0 * tolerance);
    size_t shortest = 1;
    while (shortest < p && !(p % shortest == 0 && change_over(settling, last, shortest) <= same)) {
        shortest++;
    }
    return shortest;
}

// Looks for the shortest period after which nothing more than the tolerance is to come; of
// revolutions at a reference's tolerance that does not stand in the way alone, for looser ones may
// repeat elsewhere.
bool settling_repeats(Settling *settling, double tolerance)
{
    const size_t last = settling->count - 1;
    const Revolution *of = settling->revolutions;
    const bool takes_loose = NEAR_SHARE * tolerance >= settling->scenario.reference.tolerance;
    for (size_t p = 1; p <= SETTLE_PERIOD_MAX && 2 * p <= last; p++) {
        if (!takes_loose && (of[last].is_loose || of[last - p].is_loose)) {
            continue;
        }
        const double change = change_over(settling, last, p);
        const double before = change_over(settling, last - p, p);
        const double ratio = before > 0.0 ? change / before : 0.0;
        const double left =
            ratio < RATIO_MOST ? change * fmax(ratio, 0.5) / (1.0 - ratio) : INFINITY;
        const bool is_rounding = change < CHANGE_LEAST && before < CHANGE_LEAST;
        if (is_rounding || fmax(change, left) <= tolerance) {
            settling->period = shortest_period(settling, last, p, tolerance);
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
    const size_t count = settling->count;
    const size_t share = count / TRANSIENT_SHARE;
    const size_t transient = share > TRANSIENT_LEAST ? share : TRANSIENT_LEAST;
    return settling->period > 0 ? settling->period
           : count > transient  ? count - transient
                                : (count + 1) / 2;
}

bool settling_may_count(const Settling *settling)
{
    return settling->count >= TRANSIENT_LEAST;
}

size_t settling_numbers(const Settling *settling, size_t number, double *values)
{
    const size_t many = settling_counted(settling);
    for (size_t k = 0; k < many; k++) {
        values[k] = settling->revolutions[settling->count - many + k].numbers[number];
    }
    return many;
}

static bool settling_drifts(const Settling *settling)
{
    double *forces = zeroed(settling->count, sizeof *forces);
    bool drifts = false;
    for (size_t i = 0; i < settling->scenario.linkage.joint_count; i++) {
        const size_t many =
            settling_numbers(settling, settle_joint_number(i, SETTLE_FORCE), forces);
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
        for (size_t k = 0; k < p && k + p <= number && farthest < nearest; k++) {
            farthest = fmax(farthest, change_over(settling, number - k, p));
        }
        nearest = fmin(nearest, farthest);
    }
    return nearest;
}

double settling_return(const Settling *settling)
{
    return settling->count > 0 ? nearest_return(settling, settling->count - 1) : INFINITY;
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

// How far the last period of a motion, but for its last so many revolutions, is from that of
// another, from a revolution of that on, both of that many revolutions.
static double apart_from(const Settling *a, size_t before, const Settling *b, size_t period,
                         size_t shift, double enough)
{
    double apart = 0.0;
    for (size_t k = 0; k < period && apart < enough; k++) {
        const Revolution *of_a = &a->revolutions[a->count - before - period + k];
        const Revolution *of_b = &b->revolutions[b->count - period + (k + shift) % period];
        const double fastest = fmax(a->fastest, b->fastest);
        apart = fmax(apart, revolutions_apart(&a->scenario.linkage, of_a, of_b, fastest));
    }
    return apart;
}

double settling_were_apart(const Settling *a, size_t before, const Settling *b, size_t period)
{
    double nearest = INFINITY;
    for (size_t shift = 0; shift < period && period + before <= a->count; shift++) {
        nearest = fmin(nearest, apart_from(a, before, b, period, shift, nearest));
    }
    return nearest;
}

double settling_apart(const Settling *a, const Settling *b, size_t period)
{
    return settling_were_apart(a, 0, b, period);
}

// One revolution at that tolerance of the reference, if it is looser than the result's.
static bool turn_at(Settling *settling, double tolerance, Err *err)
{
    ReferenceOptions *reference = &settling->scenario.reference;
    const double tight = reference->tolerance;
    reference->tolerance = fmax(tight, tolerance);
    const bool is_turned = settling_turn(settling, err);
    if (is_turned) {
        settling->revolutions[settling->count - 1].is_loose = reference->tolerance > tight;
    }
    reference->tolerance = tight;
    return is_turned;
}

bool settling_turn_near(Settling *settling, double near, Err *err)
{
    return turn_at(settling, fmin(NEAR_SHARE * fmin(near, settling_return(settling)), QUICK_LOOSE),
                   err);
}

bool settling_run(Settling *settling, double tolerance, size_t most, Err *err)
{
    bool is_run = true;
    while (is_run && settling->count < most && settling->period == 0 && !settling->is_random) {
        const double nearest = settling_return(settling);
        const bool is_far = settling->count >= LOOSE_FROM && nearest >= NEAR_RETURN;
        is_run = settling->is_quick ? settling_turn_near(settling, nearest, err)
                                    : turn_at(settling, is_far ? SETTLE_LOOSE : 0.0, err);
        settling->is_random =
            is_run && !settling_repeats(settling, tolerance) && settling_is_random(settling);
    }
    return is_run;
}
