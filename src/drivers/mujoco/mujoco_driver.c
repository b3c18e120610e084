// Runs a case in MuJoCo, in the ways that its users have, and with contacts within the step.
//
//     native     what touches is limits, tendons and shapes of MuJoCo's own (mujoco_native.c); of a
//                hole whose law is a spring with a damper the limit is that, else all are as hard
//                as they can be
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

// What a drive turns its body with, rad/s^2. Where its acceleration jumps in a step of which its
// values at instants are asked, these are shifted by what that leaves out.
static double turning_of(const MujocoRun *run, size_t body)
{
    const Driver *law = &driver_drive_of(run->of, (int)body)->law;
    if (!run->is_instant) {
        return run->turning[body];
    }
    const double step_s = run->of->step_s;
    const double from_s = step_s * (double)run->run.steps;
    double alpha = drive_since(law, from_s, run->data->time).alpha;
    if (drive_next_kink(law, from_s) < from_s + step_s) {
        alpha += (drive_at(law, from_s + step_s).omega -
                  drive_since(law, from_s, from_s + step_s).omega) /
                 step_s;
    }
    return alpha;
}

// Sets what drives turn their bodies with in a step, at whose start they turn as MuJoCo has it:
// at its end with a speed that is a mean of some time before it, or the one then.
static void find_turning(MujocoRun *run, double end_s, double mean_s)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        const DriverDrive *drive = driver_drive_of(run->of, (int)i);
        if (drive != NULL) {
            const double now = run->data->qvel[run->addresses[run->tree.bodies[i].first]];
            const double next = mean_s > 0.0 ? driver_drive_mean(drive, end_s - mean_s, end_s)
                                             : drive_at(&drive->law, end_s).omega;
            run->turning[i] = (next - now) / run->of->step_s;
        }
    }
}

// Puts driven bodies where their drives have them; their speeds as well, or a mean of some time
// before.
static void set_drives(MujocoRun *run, double time_s, double mean_s)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        const DriverDrive *drive = driver_drive_of(run->of, (int)i);
        if (drive != NULL) {
            const int at = run->addresses[run->tree.bodies[i].first];
            run->data->qpos[at] = drive_angle(&drive->law, time_s) - run->of->bodies[i].start.angle;
            run->data->qvel[at] = mean_s > 0.0 ? driver_drive_mean(drive, time_s - mean_s, time_s)
                                               : drive_at(&drive->law, time_s).omega;
        }
    }
}

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
    for (size_t i = 0; i < run->of->body_count; i++) {
        if (driver_drive_of(run->of, (int)i) != NULL) {
            pushes[run->tree.bodies[i].first] += MUJOCO_ARMATURE * turning_of(run, i);
        }
    }
    for (size_t i = 0; i < run->tree.coordinates; i++) {
        data->qfrc_passive[run->addresses[i]] += pushes[i];
    }
}

void mujoco_let_act(MujocoRun *run, bool has_contacts)
{
    active = run;
    are_contacts_pushed = has_contacts;
    // a model that is wanted as a file has them itself
    const bool is_pushed = actions_any(run->of) || run->of->drive_count > 0;
    if (has_contacts || (is_pushed && !run->of->wants_model)) {
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

// Stamps the state, and follows the contacts.
static void stamp(MujocoRun *run, double position_s, double velocity_s)
{
    DriverStamp *now = driver_run_stamp(&run->run);
    now->position_s = position_s;
    now->velocity_s = velocity_s;
    mujoco_read(run, run->data->qpos, run->data->qvel, now->motions);
    const DriverMotion *felt = at_positions(run, position_s - velocity_s, now->motions);
    places_follow(run->of, felt, run->contacts, run->run.totals);
    places_press(run->of, run->contacts, felt, NULL, now->forces, &run->run, run->of->step_s);
    driver_run_stamped(&run->run);
    mujoco_check(run);
}

static void run_force(MujocoRun *run)
{
    const double step_s = run->of->step_s;
    mujoco_let_act(run, true);
    run->is_instant = true;
    driver_run_begin(&run->run);
    stamp(run, 0.0, 0.0);
    while (!driver_run_is_full(&run->run)) {
        mj_step(run->model, run->data);
        const double now_s = step_s * (double)++run->run.steps;
        set_drives(run, now_s, 0.0);
        stamp(run, now_s, now_s);
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
    for (size_t i = 0; i < run->of->body_count; i++) {
        const DriverDrive *drive = driver_drive_of(run->of, (int)i);
        run->turning[i] = drive != NULL ? drive_at(&drive->law, 0.0).alpha : 0.0;
    }
    mj_forward(run->model, data);
    stamp(run, 0.0, 0.0);
    for (int i = 0; i < count; i++) {
        rates[i] = data->qvel[i] - 0.5 * step_s * data->qacc[i];
    }
    while (!driver_run_is_full(&run->run)) {
        const double now_s = step_s * (double)++run->run.steps;
        run->from_s = now_s - 1.5 * step_s;
        run->to_s = now_s - 0.5 * step_s;
        memcpy(data->qvel, rates, (size_t)count * sizeof *rates);
        find_turning(run, now_s, step_s);
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
        set_drives(run, now_s, step_s);
        memcpy(rates, data->qvel, (size_t)count * sizeof *rates);
        stamp(run, now_s, now_s - 0.5 * step_s);
    }
    free(rates);
}

// What the engine has pushed with in the step, at its end.
static void stamp_native(MujocoRun *run, double now_s, double *pushes)
{
    DriverStamp *now = driver_run_stamp(&run->run);
    now->position_s = now->velocity_s = now_s;
    mujoco_read(run, run->data->qpos, run->data->qvel, run->motions);
    memcpy(now->motions, run->motions, run->of->body_count * sizeof *now->motions);
    mujoco_read_pushes(run, pushes);
    native_follow(&run->native, run->motions, pushes, run->contacts, &run->run, now->forces);
    driver_run_stamped(&run->run);
    mujoco_check(run);
}

static void run_native(MujocoRun *run)
{
    const double step_s = run->of->step_s;
    double *pushes = driver_room(run->of->place_count, sizeof *pushes);
    run->run.is_linear = true;
    mujoco_let_act(run, false);
    driver_run_begin(&run->run);
    stamp_native(run, 0.0, pushes);
    while (!driver_run_is_full(&run->run)) {
        run->from_s = step_s * (double)run->run.steps;
        run->to_s = run->from_s + step_s;
        find_turning(run, run->to_s, 0.0);
        mj_step(run->model, run->data);
        const double now_s = step_s * (double)++run->run.steps;
        set_drives(run, now_s, 0.0);
        stamp_native(run, now_s, pushes);
    }
    free(pushes);
}

// MuJoCo's own handlers write to a file and end the program.
static void complain(const char *words)
{
    driver_fail("MuJoCo: %s", words);
}

// Whether there are holes whose laws all are a spring with a damper, which a tendon's limit can be.
static bool are_linear(const DriverCase *of)
{
    bool are_all = true;
    size_t holes = 0;
    for (size_t i = 0; i < of->joint_count; i++) {
        const bool is_hole = of->joints[i].kind == DRIVER_PIN_IN_HOLE;
        are_all = are_all && (!is_hole || force_law_is_linear(&of->joints[i].law));
        holes += is_hole ? 1 : 0;
    }
    return are_all && holes > 0;
}

int main(void)
{
    static const char *const WAYS[] = {"native", "force", "staggered", "kernel", NULL};
    static const char *const NATIVE[] = {"limits", "stops", "guides", "gears", "racks", "drives",
                                         "servos", "waves", "drags",  "rubs",  NULL};
    const DriverIdentity identity = {"MuJoCo", mj_versionString(), "double", WAYS, NATIVE};
    int status;
    const DriverCase *of = driver_read(&identity, &status);
    mju_user_error = complain;
    if (of == NULL) {
        return driver_asked_model() != NULL ? mujoco_tell_model(driver_asked_model()) : status;
    }
    mju_user_warning = complain;
    const bool is_native = driver_is_way(of, "native");
    const bool has_springs = is_native && are_linear(of);
    const MujocoModel how = {.integrator = driver_is_way(of, "force") ? "RK4" : "Euler",
                             .has_tendons = is_native,
                             .has_springs = has_springs,
                             .hardness_s = HARDNESS_STEPS * of->step_s};
    MujocoRun run;
    mujoco_make(of, &how, &run);
    snprintf(run.run.settings, sizeof run.run.settings,
             "integrator %s, contacts %s, solref and solreflimit '%.4g 1', solimp '.9999 .9999', "
             "tolerance 1e-14, driven body with an armature of 1e9 kg m^2",
             how.integrator, run.native.face_count > 0 ? "by pairs" : "off", how.hardness_s);
    if (has_springs) {
        snprintf(run.run.settings, sizeof run.run.settings,
                 "integrator %s, contacts %s, solreflimit of spring and damper of the law times "
                 "tendon_invweight0, solimplimit .0001, of loops solref '%.4g 1', driven body with "
                 "an armature of 1e9 kg m^2",
                 how.integrator, run.native.face_count > 0 ? "by pairs" : "off", how.hardness_s);
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
