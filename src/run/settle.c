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
// Independent starts are settled side by side. Two of them have come to one motion where the
// sections and forces of one period agree, whichever revolution is its first.
#include "run/settle.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/side_by_side.h"
#include "base/sorted.h"
#include "base/zeroed.h"
#include "contact/law.h"
#include "model/nearest.h"
#include "model/perturb.h"
#include "run/pressed.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// 1: of two changes, the ratio above which nothing can be said of what is to come
static const double RATIO_MOST = 0.98;

// 1: changes below this are those of rounding and of the reference's tolerance
static const double CHANGE_LEAST = 1e-9;

// Of sections and forces: a motion that still changes by less repeats. A peak then has the five
// digits that a drawing takes, and two more.
static const double SETTLE_TOLERANCE = 1e-7;

// Of the reference while it settles: each revolution then takes half the time of one at the default
// tolerance, and peaks differ from those by less than 1e-7.
static const double SETTLE_REFERENCE = 1e-10;

// 1: sections and forces of one motion, from two starts, differ by less: a peak's five digits
static const double MOTION_TOLERANCE = 1e-5;

// 1: a section that comes as near to an earlier one may be on its way to repeat
static const double NEAR_RETURN = 1e-2;

// Of a motion that is to count as one that does not repeat: revolutions at least of each start, and
// of its last ones those that come near no earlier section. Four starts then have 32 that count.
enum { RANDOM_LEAST = 16, RANDOM_LAST = 6 };

// Of the reference where the last revolution came near no earlier one: what is random is so at any
// tolerance, and a revolution takes half the time.
static const double SETTLE_LOOSE = 1e-7;
enum { LOOSE_FROM = 6 }; // revolutions, before which a motion has not had the time to come near

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

// of the largest forces of the revolutions: those below 5 % and above 95 % of them
static const double FEW = 0.05;

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
           !(p % shortest == 0 && change_over(settling, last, shortest) <= MOTION_TOLERANCE)) {
        shortest++;
    }
    return shortest;
}

// Looks for the shortest period after which nothing more than the tolerance is to come.
static bool settling_repeats(Settling *settling, double tolerance)
{
    const size_t last = settling->count - 1;
    for (size_t p = 1; p <= SETTLE_PERIOD_MAX && 2 * p <= last; p++) {
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

// The number of revolutions that count of a motion that does not repeat: its later half.
static size_t settling_counted(const Settling *settling)
{
    return settling->period > 0 ? settling->period : (settling->count + 1) / 2;
}

// The largest forces of a joint in the revolutions that count.
static size_t counted_forces(const Settling *settling, size_t joint, double *forces)
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
        const size_t many = counted_forces(settling, i, forces);
        drifts = drifts || drift_of(forces, many) > DRIFT_LEAST;
    }
    free(forces);
    return drifts;
}

// Whether a revolution comes near one of the last before it.
static bool is_near_return(const Settling *settling, size_t number)
{
    for (size_t p = 1; p <= SETTLE_PERIOD_MAX && p <= number; p++) {
        if (change_over(settling, number, p) < NEAR_RETURN) {
            return true;
        }
    }
    return false;
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

bool settling_run(Settling *settling, double tolerance, size_t most, Err *err)
{
    ReferenceOptions *reference = &settling->scenario.reference;
    const double tight = reference->tolerance;
    bool is_run = true;
    while (is_run && settling->count < most && settling->period == 0 && !settling->is_random) {
        const bool is_loose =
            settling->count >= LOOSE_FROM && !is_near_return(settling, settling->count - 1);
        reference->tolerance = is_loose ? fmax(tight, SETTLE_LOOSE) : tight;
        is_run = settling_turn(settling, err);
        if (settling->turned != NULL) {
            settling->turned(settling->context);
        }
        settling->is_random =
            is_run && !settling_repeats(settling, tolerance) && settling_is_random(settling);
    }
    reference->tolerance = tight;
    return is_run;
}

// The start of one scenario becomes that of another of the same linkage.
static void take_start(const Linkage *from, Linkage *to)
{
    memcpy(to->bodies, from->bodies, to->body_count * sizeof *to->bodies);
    memcpy(to->joints, from->joints, to->joint_count * sizeof *to->joints);
    memcpy(to->torsions, from->torsions, to->torsion_count * sizeof *to->torsions);
    memcpy(to->loads, from->loads, to->load_count * sizeof *to->loads);
    to->driver.start = from->driver.start;
}

// One of several starts on its way.
typedef struct Start {
    Settling settling;
    bool is_made;    // whether there is such a start
    bool is_settled; // false: `err` says why
    Err err;
    size_t motion; // the number of that which it came to
    struct StartsWatch *watch;
} Start;

// How far all starts have come together.
typedef struct StartsWatch {
    RunWatch watch;
    double started_s;     // by the clock
    atomic_size_t turned; // revolutions of all
    size_t most;          // of all
} StartsWatch;

static void count_turn(void *context)
{
    StartsWatch *watch = context;
    atomic_fetch_add(&watch->turned, 1);
}

static void tell_turn(void *context)
{
    StartsWatch *watch = context;
    count_turn(watch);
    watch->watch.progress((double)atomic_load(&watch->turned) / (double)watch->most,
                          clock_now_s() - watch->started_s, watch->watch.context);
}

static void start_run(size_t index, bool is_callers, void *context)
{
    Start *start = (Start *)context + index;
    if (start->is_made) {
        // only the caller's thread may show anything
        start->settling.turned = is_callers ? tell_turn : count_turn;
        start->settling.context = start->watch;
        const size_t most = start->settling.scenario.run.settle_most;
        start->is_settled = settling_run(&start->settling, SETTLE_TOLERANCE, most, &start->err);
    }
}

static void tell_nobody(double share, double wall_s, void *context)
{
    (void)share;
    (void)wall_s;
    (void)context;
}

static void starts_run(Start *starts, size_t count, RunWatch watch)
{
    StartsWatch all = {.watch = watch, .started_s = clock_now_s()};
    all.watch.progress = watch.progress != NULL ? watch.progress : tell_nobody;
    for (size_t i = 0; i < count; i++) {
        starts[i].watch = &all;
        all.most += starts[i].is_made ? starts[i].settling.scenario.run.settle_most : 0;
    }
    side_by_side_run(count, side_by_side_processors(), start_run, starts);
}

static void starts_finish(Start *starts, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (starts[i].is_made) {
            settling_finish(&starts[i].settling);
        }
    }
    free(starts);
}

// Of the drive's speed at the bodies' reach: by how much the third start and those after it differ
// from that as written.
static const double START_SIZES[] = {0.05, 0.2, 0.01};
enum { START_SIZE_COUNT = sizeof START_SIZES / sizeof *START_SIZES };

bool settle_change_start(Scenario *scenario, double size, unsigned member)
{
    const Linkage *linkage = &scenario->linkage;
    PerturbUnit *units = zeroed(linkage->body_count, sizeof *units);
    const double omega = fabs(linkage->driver.speed);
    for (size_t i = 0; i < linkage->body_count; i++) {
        units[i] = (PerturbUnit){omega * linkage_reach(linkage, (int)i), omega};
    }
    const bool is_changed = perturb_start(scenario, units, size, member);
    free(units);
    return is_changed;
}

static bool start_perturbed(Scenario *scenario, size_t number)
{
    return settle_change_start(scenario, START_SIZES[number % START_SIZE_COUNT],
                               (unsigned)number + 1);
}

// The starts that a motion is looked for from: as written, pressed, and with other velocities.
static Start *starts_create(const Scenario *scenario, size_t count)
{
    Start *starts = zeroed(count, sizeof *starts);
    for (size_t i = 0; i < count; i++) {
        starts[i].settling = settling_start(scenario);
        starts[i].is_made = true;
        Scenario *own = &starts[i].settling.scenario;
        Err err = {ERR_NONE, ""};
        const bool has_own =
            i == 0 || (i == 1 && pressed_start(own, &err)) || start_perturbed(own, i);
        if (!has_own) {
            settling_finish(&starts[i].settling);
            starts[i].is_made = false;
        }
    }
    return starts;
}

// Whether the last period of a motion is that of another, from a revolution of that on.
static bool agree_from(const Settling *a, const Settling *b, size_t shift)
{
    const Linkage *linkage = &a->scenario.linkage;
    for (size_t k = 0; k < a->period; k++) {
        const Revolution *of_a = &a->revolutions[a->count - a->period + k];
        const Revolution *of_b = &b->revolutions[b->count - b->period + (k + shift) % b->period];
        const double fastest = fmax(a->fastest, b->fastest);
        if (revolutions_apart(linkage, of_a, of_b, fastest) > MOTION_TOLERANCE) {
            return false;
        }
    }
    return true;
}

// Whether two starts have come to one motion. All that do not repeat count as one.
static bool is_same_motion(const Settling *a, const Settling *b)
{
    if (a->period != b->period) {
        return false;
    }
    bool agree = a->period == 0;
    for (size_t shift = 0; !agree && shift < a->period; shift++) {
        agree = agree_from(a, b, shift);
    }
    return agree;
}

// Numbers the motions in the order of the starts; returns how many there are.
static size_t starts_number(Start *starts, size_t count)
{
    size_t motions = 0;
    for (size_t i = 0; i < count; i++) {
        if (!starts[i].is_settled) {
            continue;
        }
        size_t k = 0;
        while (k < i && !(starts[k].is_settled &&
                          is_same_motion(&starts[k].settling, &starts[i].settling))) {
            k++;
        }
        starts[i].motion = k < i ? starts[k].motion : motions++;
    }
    return motions;
}

// What a joint does in a motion, over all starts that have come to it.
static SettledJoint sum_up(const Start *starts, size_t count, size_t motion, size_t joint)
{
    size_t room = 0;
    for (size_t i = 0; i < count; i++) {
        room += starts[i].is_settled ? starts[i].settling.count : 0;
    }
    double *forces = zeroed(room, sizeof *forces);
    SettledJoint found = {0};
    size_t many = 0;
    size_t period = 0;
    for (size_t i = 0; i < count; i++) {
        const Settling *settling = &starts[i].settling;
        if (!starts[i].is_settled || starts[i].motion != motion || (period > 0 && many > 0)) {
            continue;
        }
        period = settling->period;
        const size_t added = counted_forces(settling, joint, forces + many);
        for (size_t k = 0; k < added; k++) {
            found.impacts += (double)settling->revolutions[settling->count - 1 - k].impacts[joint];
        }
        many += added;
    }
    sorted_make(forces, many);
    const double most = (double)(many - 1);
    found.impacts /= (double)many;
    found.force = period > 0 ? forces[many - 1] : sorted_median(forces, many);
    found.low = period > 0 ? found.force : forces[(size_t)(FEW * most)];
    found.high = period > 0 ? found.force : forces[(size_t)ceil((1.0 - FEW) * most)];
    free(forces);
    return found;
}

// The angular velocities at the ends of the revolutions that count, of the first start that came to
// the motion.
static void add_sections(const Settling *settling, SettledMotion *motion)
{
    const Linkage *linkage = &settling->scenario.linkage;
    const size_t counted = settling_counted(settling);
    motion->section_count = counted < SETTLE_PERIOD_MAX ? counted : SETTLE_PERIOD_MAX;
    motion->sections =
        zeroed(motion->section_count * linkage->body_count, sizeof *motion->sections);
    for (size_t k = 0; k < motion->section_count; k++) {
        const size_t number = settling->count - motion->section_count + k;
        for (size_t i = 0; i < linkage->body_count; i++) {
            // the last of the rates is that about z, times the reach
            const double *rates = settling->revolutions[number].section + SETTLE_RATES * i;
            const double reach = linkage_reach(linkage, (int)i);
            motion->sections[k * linkage->body_count + i] =
                reach > 0.0 ? rates[SETTLE_RATES - 1] / reach : 0.0;
        }
    }
}

static SettledMotion describe_motion(const Start *starts, size_t count, size_t motion)
{
    SettledMotion found = {0};
    const Linkage *linkage = NULL;
    for (size_t i = 0; i < count; i++) {
        if (starts[i].is_settled && starts[i].motion == motion) {
            found.period = starts[i].settling.period;
            found.change = starts[i].settling.change;
            if (found.starts == 0) {
                add_sections(&starts[i].settling, &found);
            }
            found.starts++;
            linkage = &starts[i].settling.scenario.linkage;
        }
    }
    found.joints = zeroed(linkage->joint_count, sizeof *found.joints);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        found.joints[i] = sum_up(starts, count, motion, i);
    }
    return found;
}

// The first start of those that came to the motion of most starts.
static size_t chosen_start(const Start *starts, size_t count, size_t motions)
{
    size_t chosen = 0;
    size_t most = 0;
    for (size_t motion = 0; motion < motions; motion++) {
        size_t came = 0;
        size_t first = count;
        for (size_t i = 0; i < count; i++) {
            if (starts[i].is_settled && starts[i].motion == motion) {
                first = first < count ? first : i;
                came++;
            }
        }
        if (came > most) {
            most = came;
            chosen = first;
        }
    }
    return chosen;
}

// Puts what the starts have come to into the scenario.
static void take_starts(Start *starts, size_t count, Scenario *scenario)
{
    SettledStart *settled = &scenario->settled;
    const size_t motions = starts_number(starts, count);
    if (motions == 0) {
        snprintf(settled->message, sizeof settled->message, "revolution %zu: %.1900s",
                 starts[0].settling.count, starts[0].err.text);
        if (!scenario->run.is_start_given) {
            scenario->run.start = START_CENTRED;
            scenario->run.centred_because = "it fails before its motion has settled";
        }
        return;
    }
    const size_t chosen = chosen_start(starts, count, motions);
    const Settling *settling = &starts[chosen].settling;
    take_start(&settling->scenario.linkage, &scenario->linkage);
    settled->revolutions = settling->count;
    settled->motion_count = motions;
    settled->motions = zeroed(motions, sizeof *settled->motions);
    settled->motions[0] = describe_motion(starts, count, starts[chosen].motion);
    for (size_t motion = 0, at = 1; motion < motions; motion++) {
        if (motion != starts[chosen].motion) {
            settled->motions[at++] = describe_motion(starts, count, motion);
        }
    }
    for (size_t i = 0; i < motions; i++) {
        settled->starts += settled->motions[i].starts;
    }
    settled->first = zeroed(scenario->linkage.joint_count, sizeof *settled->first);
    if (starts[0].settling.count > 0) {
        memcpy(settled->first, starts[0].settling.revolutions[0].force_max,
               scenario->linkage.joint_count * sizeof *settled->first);
    }
}

void settle_scenario(Scenario *scenario, RunWatch watch)
{
    SettledStart *settled = &scenario->settled;
    if (!scenario_lacks_start(scenario)) {
        return;
    }
    if (scenario->run.start == START_PRESSED) {
        Err err = {ERR_NONE, ""};
        settled->is_pressed = pressed_start(scenario, &err);
        snprintf(settled->message, sizeof settled->message, "%s", err.text);
        return;
    }
    const size_t count = scenario->run.settle_starts;
    Start *starts = starts_create(scenario, count);
    starts_run(starts, count, watch);
    take_starts(starts, count, scenario);
    starts_finish(starts, count);
}

// Whether a start can be handed from one linkage to the other: both have the same bodies and
// joints, and nothing counts whole turns.
static bool can_follow(const Scenario *scenario, const Scenario *neighbour)
{
    const Linkage *own = &scenario->linkage;
    const Linkage *other = &neighbour->linkage;
    bool can = neighbour->settled.motion_count > 0 && scenario->run.start == START_SETTLED &&
               !own->is_spatial && !other->is_spatial && own->torsion_count == 0 &&
               own->body_count == other->body_count && own->joint_count == other->joint_count;
    for (size_t i = 0; can && i < own->joint_count; i++) {
        can = own->joints[i].kind == other->joints[i].kind &&
              own->joints[i].limits.kind == LIMIT_NONE && own->joints[i].kind != JOINT_GEAR;
    }
    return can;
}

// A distance within some play as one within another: in the free part by its share of the play, in
// the wall by its depth.
static double in_other_play(double distance, double play, double other_play)
{
    return distance <= play ? distance * other_play / play : other_play + distance - play;
}

// Where a pin or block stands in its play, and what its contacts carry.
static void follow_joint(const Joint *from, Joint *to)
{
    if (!linkage_has_play(to)) {
        return;
    }
    const double play = linkage_radial_clearance(from);
    const double own_play = linkage_radial_clearance(to);
    memcpy(to->contacts, from->contacts, sizeof to->contacts);
    if (to->kind == JOINT_CLEARANCE) {
        const Vec2 at = from->clearance.start;
        const double distance = vec2_length(at);
        to->clearance.start =
            distance > 0.0 ? vec2_scale(in_other_play(distance, play, own_play) / distance, at)
                           : at;
    } else if (to->kind == JOINT_GUIDE) {
        const Vec2 at = from->guide.start;
        to->guide.start = (Vec2){copysign(in_other_play(fabs(at.x), play, own_play), at.x), at.y};
    }
}

// How much faster the drive turns than the neighbour's.
static double drive_ratio(const Scenario *scenario, const Scenario *neighbour)
{
    const Driver *own = &scenario->linkage.driver;
    const Driver *other = &neighbour->linkage.driver;
    return drive_is_steady(own) && drive_is_steady(other) ? own->speed / other->speed : 1.0;
}

// The neighbour's start with the scenario's own sizes: positions moved as little as these need, and
// speeds in proportion to the drive's. False where there is none.
static bool start_as_neighbour(const Scenario *neighbour, Scenario *scenario)
{
    Linkage *linkage = &scenario->linkage;
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(&neighbour->linkage, motions);
    const double ratio = drive_ratio(scenario, neighbour);
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i].velocity = vec2_scale(ratio, motions[i].velocity);
        motions[i].omega *= ratio;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        follow_joint(&neighbour->linkage.joints[i], &linkage->joints[i]);
    }
    const bool is_placed = nearest_positions(linkage, motions);
    if (is_placed) {
        nearest_speeds(linkage, false, motions);
        for (size_t i = 0; i < linkage->body_count; i++) {
            linkage->bodies[i].start = motions[i];
        }
    }
    free(motions);
    return is_placed;
}

bool settle_follow(Scenario *scenario, const Scenario *neighbour, RunWatch watch)
{
    Start *start = zeroed(1, sizeof *start);
    bool is_followed = scenario_lacks_start(scenario) && can_follow(scenario, neighbour);
    if (is_followed) {
        *start = (Start){.settling = settling_start(scenario), .is_made = true};
        is_followed = start_as_neighbour(neighbour, &start->settling.scenario);
    }
    if (is_followed) {
        starts_run(start, 1, watch);
        is_followed = start->is_settled;
    }
    if (is_followed) {
        take_starts(start, 1, scenario);
        scenario->settled.is_followed = true;
    }
    starts_finish(start, 1);
    if (!is_followed) {
        settle_scenario(scenario, watch);
    }
    return is_followed;
}

void settle_damping(Scenario *scenario, RunWatch watch)
{
    static const double SCALES[] = {0.5, 2.0};
    SettledStart *settled = &scenario->settled;
    if (settled->motion_count == 0 || !law_has_damping(scenario)) {
        return;
    }
    Start *starts = zeroed(2, sizeof *starts);
    for (size_t i = 0; i < 2; i++) {
        starts[i].settling = settling_start(scenario);
        starts[i].settling.scenario.contact.damping_scale *= SCALES[i];
        starts[i].is_made = true;
    }
    starts_run(starts, 2, watch);
    for (size_t i = 0; i < 2; i++) {
        starts[i].motion = i;
        if (starts[i].is_settled) {
            SettledMotion *found = i == 0 ? &settled->halved : &settled->doubled;
            free(found->joints);
            free(found->sections);
            *found = describe_motion(starts, 2, i);
        }
    }
    starts_finish(starts, 2);
}
