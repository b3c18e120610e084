// Runs a case in MuJoCo, in the ways that its users have, and with contacts within the step.
//
//     native     the hole is a tendon between the two centres, limited to the play; of a law that
//     is a
//                spring with a damper the limit is that, else as hard as it can be
//     force      the contact's law is a force (mjcb_passive), stepped by RK4
//     staggered  the same by Euler's method, whose velocities are read as those of half a step
//                earlier than its positions: v(n+1/2) = v(n-1/2) + h a(x(n), v(n)), v(n) foreseen
//                by the acceleration of the step before, in contact by its own
//     kernel     the contacts integrated within the step (mujoco_kernel.c)
#include "drivers/mujoco/mujoco_driver.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// steps of the time constant of limits and loops: MuJoCo allows no fewer
static const double HARDNESS_STEPS = 2.0;

// The law as a force.

// MuJoCo's callbacks know nothing but the model and the data
static MujocoRun *active;
static bool are_contacts_pushed;

static void push(const mjModel *model, mjData *data)
{
    MujocoRun *run = active;
    (void)model;
    if (run->is_instant) {
        run->from_s = run->to_s = data->time;
    }
    mujoco_read(run, data->qpos, data->qvel, run->acted);
    double *pushes = run->coordinates; // they have been read
    actions_find(run->of, run->acted, run->from_s, run->to_s, run->actions);
    if (are_contacts_pushed) {
        places_press(run->of, run->contacts, run->acted, run->actions, run->pressed, NULL, 0.0);
    }
    memset(pushes, 0, run->tree.coordinates * sizeof *pushes);
    tree_act(&run->tree, run->acted, run->actions, pushes);
    for (size_t i = 0; i < run->tree.coordinates; i++) {
        data->qfrc_passive[run->addresses[i]] += pushes[i];
    }
}

void mujoco_let_act(MujocoRun *run, bool has_contacts)
{
    active = run;
    are_contacts_pushed = has_contacts;
    // a model that is wanted as a file has them itself
    if (has_contacts || (actions_any(run->of) && !run->of->wants_model)) {
        mjcb_passive = push;
    }
}

// The bodies as the contacts are to feel them: velocities that lag behind are brought up to the
// positions by the last acceleration.
static const DriverMotion *at_positions(MujocoRun *run, double lag_s, const DriverMotion *motions)
{
    const mjData *data = run->data;
    if (lag_s == 0.0) {
        return motions;
    }
    for (size_t i = 0; i < run->tree.coordinates; i++) {
        run->rates[i] += lag_s * data->qacc[run->addresses[i]];
    }
    tree_motions(&run->tree, run->coordinates, run->rates, run->motions);
    return run->motions;
}

// Stamps the state, and follows the contacts, whose forces are given or those of the law.
static void stamp(MujocoRun *run, double position_s, double velocity_s, const Vec2 *forces)
{
    DriverStamp *now = driver_run_stamp(&run->run);
    now->position_s = position_s;
    now->velocity_s = velocity_s;
    mujoco_read(run, run->data->qpos, run->data->qvel, now->motions);
    const DriverMotion *felt = at_positions(run, position_s - velocity_s, now->motions);
    places_follow(run->of, felt, run->contacts, run->run.totals);
    if (forces == NULL) {
        places_press(run->of, run->contacts, felt, NULL, now->forces, &run->run, run->of->step_s);
    }
    for (size_t i = 0; forces != NULL && i < run->of->joint_count; i++) {
        DriverTotals *totals = &run->run.totals[i];
        now->forces[i] = forces[i];
        totals->force_max = fmax(totals->force_max, vec2_length(now->forces[i]));
    }
    driver_run_stamped(&run->run);
    mujoco_check(run);
}

static void run_force(MujocoRun *run)
{
    const double step_s = run->of->step_s;
    mujoco_let_act(run, true);
    run->is_instant = true;
    driver_run_begin(&run->run);
    stamp(run, 0.0, 0.0, NULL);
    while (!driver_run_is_full(&run->run)) {
        mj_step(run->model, run->data);
        const double now_s = step_s * (double)++run->run.steps;
        stamp(run, now_s, now_s, NULL);
    }
}

static bool is_touching(const MujocoRun *run)
{
    for (size_t i = 0; i < run->of->place_count; i++) {
        if (run->contacts[i].state.is_touching) {
            return true;
        }
    }
    return false;
}

static void run_staggered(MujocoRun *run)
{
    const double step_s = run->of->step_s;
    const int count = run->model->nv;
    mjData *data = run->data;
    double *rates = calloc((size_t)count, sizeof *rates); // half a step behind the positions
    if (rates == NULL) {
        driver_fail("there is no memory");
    }
    mujoco_let_act(run, true);
    // a loop's constraint damps what it is told of, and must be told what it has done itself
    const double ahead_s = run->tree.left_count == 0 ? 0.5 * step_s : 0.0;
    driver_run_begin(&run->run);
    mj_forward(run->model, data);
    stamp(run, 0.0, 0.0, NULL);
    for (int i = 0; i < count; i++) {
        rates[i] = data->qvel[i] - 0.5 * step_s * data->qacc[i];
    }
    while (!driver_run_is_full(&run->run)) {
        const double now_s = step_s * (double)++run->run.steps;
        run->from_s = now_s - 1.5 * step_s;
        run->to_s = now_s - 0.5 * step_s;
        for (int i = 0; i < count; i++) {
            data->qvel[i] = rates[i] + ahead_s * data->qacc[i];
        }
        mj_step1(run->model, data);
        if (ahead_s > 0.0 && is_touching(run)) {
            // once more, with the velocities that this step's own accelerations say
            mj_fwdAcceleration(run->model, data);
            for (int i = 0; i < count; i++) {
                data->qvel[i] = rates[i] + ahead_s * data->qacc_smooth[i];
            }
            mj_fwdVelocity(run->model, data);
        }
        mj_step2(run->model, data);
        for (int i = 0; i < count; i++) {
            // every coordinate is that of a hinge or a slide
            const double foreseen = data->qvel[i] - step_s * data->qacc[i];
            rates[i] += step_s * data->qacc[i];
            data->qpos[i] += step_s * (rates[i] - foreseen - step_s * data->qacc[i]);
            data->qvel[i] = rates[i];
        }
        stamp(run, now_s, now_s - 0.5 * step_s, NULL);
    }
    free(rates);
}

// The normal of the pin of a joint in its hole.
static Vec2 normal_of(const MujocoRun *run, size_t joint)
{
    size_t place = 0;
    while (run->of->places[place].joint != (int)joint) {
        place++;
    }
    return place_pose(&run->of->places[place], run->motions).normal;
}

// The forces of the tendons at their limits.
static void read_tendons(const MujocoRun *run, Vec2 *forces)
{
    const mjData *data = run->data;
    int tendon = 0;
    for (size_t i = 0; i < run->of->joint_count; i++) {
        forces[i] = (Vec2){0.0, 0.0};
        if (run->of->joints[i].kind != DRIVER_PIN_IN_HOLE) {
            continue;
        }
        const Vec2 normal = normal_of(run, i);
        for (int row = 0; row < data->nefc; row++) {
            if (data->efc_type[row] == mjCNSTR_LIMIT_TENDON && data->efc_id[row] == tendon) {
                forces[i] = vec2_scale(data->efc_force[row], normal);
            }
        }
        tendon++;
    }
}

static void run_native(MujocoRun *run)
{
    const double step_s = run->of->step_s;
    Vec2 *forces = calloc(run->of->joint_count + 1, sizeof *forces);
    if (forces == NULL) {
        driver_fail("there is no memory");
    }
    run->run.is_linear = true;
    mujoco_let_act(run, false);
    driver_run_begin(&run->run);
    stamp(run, 0.0, 0.0, forces);
    while (!driver_run_is_full(&run->run)) {
        run->from_s = step_s * (double)run->run.steps;
        run->to_s = run->from_s + step_s;
        mj_step(run->model, run->data);
        const double now_s = step_s * (double)++run->run.steps;
        mujoco_read(run, run->data->qpos, run->data->qvel, run->motions);
        read_tendons(run, forces);
        stamp(run, now_s, now_s, forces);
    }
    free(forces);
}

// MuJoCo's own handlers write to a file and end the program.
static void complain(const char *words)
{
    driver_fail("MuJoCo: %s", words);
}

// Whether every law is a spring with a damper, which a tendon's limit can be.
static bool are_linear(const DriverCase *of)
{
    bool are_all = true;
    for (size_t i = 0; i < of->joint_count; i++) {
        are_all = are_all && (of->joints[i].kind != DRIVER_PIN_IN_HOLE ||
                              force_law_is_linear(&of->joints[i].law));
    }
    return are_all;
}

int main(void)
{
    static const char *const WAYS[] = {"native", "force", "staggered", "kernel", NULL};
    const DriverIdentity identity = {"MuJoCo", mj_versionString(), "double", WAYS};
    int status;
    const DriverCase *of = driver_read(&identity, &status);
    mju_user_error = complain;
    if (of == NULL) {
        return driver_asked_model() != NULL ? mujoco_tell_model(driver_asked_model()) : status;
    }
    mju_user_warning = complain;
    const bool is_native = driver_is_way(of, "native");
    if (is_native) {
        driver_refuse_friction(of);
    }
    const bool has_springs = is_native && are_linear(of);
    const MujocoModel how = {.integrator = driver_is_way(of, "force") ? "RK4" : "Euler",
                             .has_tendons = is_native,
                             .has_springs = has_springs,
                             .hardness_s = HARDNESS_STEPS * of->step_s};
    MujocoRun run;
    mujoco_make(of, &how, &run);
    snprintf(run.run.settings, sizeof run.run.settings,
             "integrator %s, contacts off, solref and solreflimit '%.4g 1', solimp '.9999 .9999', "
             "tolerance 1e-14, driven body with an armature of 1e9 kg m^2",
             how.integrator, how.hardness_s);
    if (has_springs) {
        snprintf(run.run.settings, sizeof run.run.settings,
                 "integrator %s, contacts off, solreflimit of spring and damper of the law times "
                 "tendon_invweight0, solimplimit .0001, of loops solref '%.4g 1', driven body with "
                 "an armature of 1e9 kg m^2",
                 how.integrator, how.hardness_s);
    }
    if (is_native) {
        run_native(&run);
    } else if (driver_is_way(of, "force")) {
        run_force(&run);
    } else if (driver_is_way(of, "staggered")) {
        run_staggered(&run);
    } else {
        mujoco_run_kernel(&run);
    }
    driver_run_write(&run.run);
}
