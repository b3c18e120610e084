// Turns a mechanism until its motion repeats.
//
// Each revolution is a run of the reference by itself, from the state of the last (model/state.h),
// so that what comes out of n revolutions does not depend on how many follow. With x_n the section
// after n revolutions, velocities over the fastest, and F_n the largest forces of each joint, the
// motion repeats after p revolutions where
//     d_n = max(|x_n - x_(n-p)|, |F_n - F_(n-p)| / F_n)
// is small and so is what is still to come of it: with r = d_n / d_(n-p), the sum d_n r / (1 - r).
#include "run/settle.h"

#include "base/memory.h"
#include "base/sorted.h"
#include "base/zeroed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RATES = 6 }; // of a body at a section

// 1: of two changes, the ratio above which nothing can be said of what is to come
static const double RATIO_MOST = 0.98;

// 1: changes below this are those of rounding and of the reference's tolerance
static const double CHANGE_LEAST = 1e-9;

// Of sections and forces: a motion that still changes by less repeats. A peak then has the five
// digits that a drawing takes, and two more.
static const double SETTLE_TOLERANCE = 1e-7;

Settling settling_start(const Scenario *scenario)
{
    Settling settling = {
        .scenario = scenario_copy(scenario),
        .state = run_state_create(&scenario->linkage),
        .change = INFINITY,
        .left = INFINITY,
    };
    settling.scenario.run.revolutions = 1.0;
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
        .section = zeroed(RATES * linkage->body_count, sizeof *added->section),
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
        if (record->tops != NULL) {
            force = fmax(force, record->tops[k].force);
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
        const double rates[RATES] = {motion.velocity.x, motion.velocity.y, motion.velocity.z,
                                     turning.x,         turning.y,         turning.z};
        memcpy(revolution->section + RATES * i, rates, sizeof rates);
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

// d_n above, over p revolutions.
static double change_over(const Settling *settling, size_t last, size_t period)
{
    const Linkage *linkage = &settling->scenario.linkage;
    const Revolution *now = &settling->revolutions[last];
    const Revolution *then = &settling->revolutions[last - period];
    double change = 0.0;
    for (size_t i = 0; i < RATES * linkage->body_count; i++) {
        change = fmax(change, fabs(now->section[i] - then->section[i]) / settling->fastest);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const double force = fmax(now->force_max[i], then->force_max[i]);
        const double apart = fabs(now->force_max[i] - then->force_max[i]);
        change = force > 0.0 ? fmax(change, apart / force) : change;
    }
    return change;
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
            settling->period = p;
            settling->change = change;
            settling->left = is_rounding ? change : left;
            return true;
        }
    }
    return false;
}

bool settling_run(Settling *settling, double tolerance, size_t most, Err *err)
{
    while (settling->count < most) {
        if (!settling_turn(settling, err)) {
            return false;
        }
        if (settling_repeats(settling, tolerance)) {
            return true;
        }
    }
    return true;
}

// The start of one scenario becomes that of another of the same linkage.
static void take_start(const Linkage *from, Linkage *to)
{
    memcpy(to->bodies, from->bodies, to->body_count * sizeof *to->bodies);
    memcpy(to->joints, from->joints, to->joint_count * sizeof *to->joints);
    memcpy(to->torsions, from->torsions, to->torsion_count * sizeof *to->torsions);
    to->driver.start = from->driver.start;
}

// What a joint did; of a motion that does not repeat over its second half.
static SettledJoint sum_up(const Settling *settling, size_t joint)
{
    const size_t last = settling->count;
    const size_t many = settling->period > 0 ? settling->period : (last + 1) / 2;
    double *forces = zeroed(many, sizeof *forces);
    SettledJoint found = {.first = settling->revolutions[0].force_max[joint]};
    for (size_t k = 0; k < many; k++) {
        forces[k] = settling->revolutions[last - many + k].force_max[joint];
        found.impacts +=
            (double)settling->revolutions[last - many + k].impacts[joint] / (double)many;
    }
    sorted_make(forces, many);
    const double most = (double)(many - 1);
    found.force = settling->period > 0 ? forces[many - 1] : forces[(many - 1) / 2];
    found.low = settling->period > 0 ? found.force : forces[(size_t)(FEW * most)];
    found.high = settling->period > 0 ? found.force : forces[(size_t)ceil((1.0 - FEW) * most)];
    free(forces);
    return found;
}

void settle_scenario(Scenario *scenario)
{
    SettledStart *settled = &scenario->settled;
    if (!scenario_settles(scenario) || settled->revolutions > 0) {
        return;
    }
    Settling settling = settling_start(scenario);
    Err err = {ERR_NONE, ""};
    if (settling_run(&settling, SETTLE_TOLERANCE, scenario->run.settle_most, &err)) {
        take_start(&settling.scenario.linkage, &scenario->linkage);
        settled->revolutions = settling.count;
        settled->period = settling.period;
        settled->change = settling.change;
        settled->joints = zeroed(scenario->linkage.joint_count, sizeof *settled->joints);
        for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
            settled->joints[i] = sum_up(&settling, i);
        }
    } else {
        snprintf(settled->message, sizeof settled->message, "revolution %zu: %s", settling.count,
                 err.text);
    }
    settling_finish(&settling);
}
