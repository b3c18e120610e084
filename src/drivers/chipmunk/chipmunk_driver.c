// Runs a case in Chipmunk, in the ways that its users have.
//
//     native     what touches is joints and shapes of Chipmunk's own (chipmunk_native.c)
//     force      the contact's law is a force, set within the step where the velocities are changed
//     kernel     the contacts integrated within the step, by trial steps (drivers/common/trial.c)
//     staggered  the same, with the velocities read as what they are in that order
//
// A step of Chipmunk moves the bodies first, x(n+1) = x(n) + h v(n), then changes v by the forces
// and the constraints there. So v(n) is the mean velocity of [n, n+1]: read as that at n + 1/2, the
// steps are a leapfrog. `staggered` reads it so, and evaluates the law where the positions are, at
// the velocities that the acceleration of the step before says. A force that is set before a step,
// as is usual, acts where the bodies no longer are: then the law fails at steps above 1 us. The
// driven body is kinematic, about its pivot. Errors of joints are corrected in the next step, all
// of them.
#include "drivers/chipmunk/chipmunk_driver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The bodies as the law is to feel them: their velocities at the time of the positions.
static void read_felt(ChipmunkRun *run)
{
    const double share = run->lag_s / run->of->step_s;
    chipmunk_read(run, run->motions);
    for (size_t i = 0; i < run->of->body_count; i++) {
        DriverMotion *now = &run->motions[i];
        const DriverMotion before = run->before[i];
        run->before[i] = *now;
        if (share > 0.0) {
            now->velocity = vec2_add(now->velocity,
                                     vec2_scale(share, vec2_sub(now->velocity, before.velocity)));
            now->omega += share * (now->omega - before.omega);
        }
    }
}

// N, N m: laws at steps that are too long for them end in such forces, of which Chipmunk aborts.
static const double PUSH_MOST = 1e12;

static void check_actions(const ChipmunkRun *run)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        const DriverAction *on = &run->actions[i];
        const double size = fabs(on->force.x) + fabs(on->force.y) + fabs(on->moment);
        if (!(size <= PUSH_MOST)) {
            driver_fail("the forces on '%s' have diverged after %.6g s: the step is too long for "
                        "its contacts",
                        run->of->bodies[i].name, run->now_s);
        }
    }
}

// Follows the contacts and finds the forces of their laws, of springs and of loads.
static void find_forces(ChipmunkRun *run)
{
    read_felt(run);
    actions_find(run->of, run->motions, run->from_s, run->to_s, run->actions);
    if (!run->is_native) {
        places_follow(run->of, run->motions, run->contacts, run->run.totals);
        places_press(run->of, run->contacts, run->motions, run->actions, run->forces, &run->run,
                     run->of->step_s);
    }
}

// The forces of contacts that are under way at the start.
static void find_first_forces(ChipmunkRun *run)
{
    chipmunk_read(run, run->motions);
    places_press(run->of, run->contacts, run->motions, NULL, run->forces, NULL, 0.0);
}

// Chipmunk's callbacks know their body: what they are for is in the space.
static void change_velocity(cpBody *body, cpVect gravity, cpFloat damping, cpFloat step_s)
{
    ChipmunkRun *run = cpSpaceGetUserData(cpBodyGetSpace(body));
    // the first body of the step: all positions are new, all velocities old
    if (body == run->first) {
        find_forces(run);
        check_actions(run);
        chipmunk_push(run, run->actions);
    }
    cpBodyUpdateVelocity(body, gravity, damping, step_s);
}

// The velocities of driven bodies are known at any time.
static void set_driven(const ChipmunkRun *run, double time_s, DriverMotion *motions)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        const DriverDrive *drive = driver_drive_of(run->of, (int)i);
        if (drive != NULL) {
            const DriveState at = drive_at(&drive->law, time_s);
            const Vec2 arm = vec2_rotate(at.angle, run->centres[i]);
            motions[i].omega = at.omega;
            motions[i].velocity = vec2_scale(at.omega, vec2_perp(arm));
        }
    }
}

static void stamp(ChipmunkRun *run, double velocity_s)
{
    DriverStamp *now = driver_run_stamp(&run->run);
    now->position_s = run->now_s;
    now->velocity_s = velocity_s;
    chipmunk_read(run, now->motions);
    set_driven(run, velocity_s, now->motions);
    memcpy(now->forces, run->forces, run->of->joint_count * sizeof *now->forces);
    driver_run_stamped(&run->run);
}

static void take_step(ChipmunkRun *run)
{
    const double step_s = run->of->step_s;
    run->from_s = run->now_s + run->lag_s;
    run->to_s = run->from_s + step_s;
    if (run->is_native) {
        chipmunk_clear_native(run);
    }
    cpSpaceStep(run->space, step_s);
    run->now_s = step_s * (double)++run->run.steps;
    if (run->is_native) {
        chipmunk_read(run, run->motions);
        set_driven(run, run->now_s, run->motions);
        chipmunk_read_native(run);
    }
    stamp(run, run->now_s + run->lag_s);
}

// Lets the law act within the steps.
static void set_law(ChipmunkRun *run)
{
    cpBody *first = NULL;
    for (size_t i = 0; i < run->of->body_count; i++) {
        if (cpBodyGetType(run->bodies[i]) == CP_BODY_TYPE_DYNAMIC) {
            cpBodySetVelocityUpdateFunc(run->bodies[i], change_velocity);
            first = first == NULL ? run->bodies[i] : first;
        }
    }
    run->first = first;
}

// Brings the velocities half a step ahead of the positions, by half a step in which nothing moves.
static void start_staggered(ChipmunkRun *run)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        const DriverDrive *drive = driver_drive_of(run->of, (int)i);
        if (drive != NULL) {
            cpBodySetAngularVelocity(run->bodies[i],
                                     driver_drive_mean(drive, 0.0, run->of->step_s));
        }
    }
    run->lag_s = 0.0;
    run->from_s = 0.0;
    run->to_s = 0.5 * run->of->step_s;
    chipmunk_let_move(run, chipmunk_stay);
    cpSpaceStep(run->space, run->to_s);
    chipmunk_let_move(run, cpBodyUpdatePosition);
    run->lag_s = run->to_s;
    chipmunk_read(run, run->motions);
    for (size_t i = 0; i < run->of->body_count; i++) {
        // accelerations that are to be expected are those of the start
        DriverMotion *before = &run->before[i];
        before->velocity = vec2_sub(vec2_scale(2.0, before->velocity), run->motions[i].velocity);
        before->omega = 2.0 * before->omega - run->motions[i].omega;
    }
}

int main(void)
{
    static const char *const WAYS[] = {"native", "force", "staggered", "kernel", NULL};
    static const char *const NATIVE[] = {"limits", "stops", "guides", "gears", "drives",
                                         "servos", "waves", "drags",  NULL};
    const DriverIdentity identity = {"Chipmunk", cpVersionString, "double", WAYS, NATIVE};
    int status;
    const DriverCase *of = driver_read(&identity, &status);
    if (of == NULL) {
        return status;
    }
    if (sizeof(cpFloat) != sizeof(double)) {
        driver_fail("this Chipmunk calculates in single precision");
    }
    ChipmunkRun run;
    const bool is_native = driver_is_way(of, "native");
    chipmunk_make(of, &run);
    cpSpaceSetUserData(run.space, &run);
    const bool is_kernel = driver_is_way(of, "kernel");
    if (!is_kernel && (!is_native || actions_any(of))) {
        set_law(&run);
    }
    if (!is_native && !is_kernel) {
        find_first_forces(&run);
    }
    run.run.is_linear = is_native;
    if (is_kernel) {
        chipmunk_run_kernel(&run);
    }
    chipmunk_tell_settings(&run);
    driver_run_begin(&run.run);
    stamp(&run, 0.0);
    if (driver_is_way(of, "staggered")) {
        start_staggered(&run);
    }
    while (!driver_run_is_full(&run.run)) {
        take_step(&run);
    }
    driver_run_write(&run.run);
}
