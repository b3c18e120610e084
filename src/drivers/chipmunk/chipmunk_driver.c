// Runs a case in Chipmunk, in the ways that its users have.
//
//     native     the hole is a slide joint between the two centres, from 0 to the play
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
#include "drivers/chipmunk/chipmunk_line.h"
#include "drivers/common/trial.h"

#include <chipmunk/chipmunk.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Iterations of the solver. Of the ideal four-bar at 20 us 10 leave an error of 2.7e-4, 30
// of 1.8e-5, 100 and 300 of 1.2e-5. Where no loop is closed, and the law is a force, 10 are as good
// as 300; with a slide joint in its place 10 change the largest force by a tenth, and 30 by a
// thousandth.
enum { ITERATIONS_OPEN = 10, ITERATIONS_SLIDING = 30, ITERATIONS_CLOSED = 100 };

// Differences of trials are no better than the solver: so many as leave this share of the
// accelerations, found at the start. How many these are depends on the masses: 30 to 240.
enum { ITERATIONS_TRIAL = 30, ITERATIONS_TRIAL_MOST = 1000 };
static const double SOLVED = 1e-12;
static const double SOLVED_LEAST = 1e-6; // above which a case is refused

// rad and m, by which coordinates are apart where it is tried; and m/s^2 and rad/s^2, with what
enum { TRIED_PLACES = 4 };
static const double TRIED_APART = 0.4;
static const double TRIED_ACCELERATION = 100.0;
static const double TRIED_TURNING = 1e4;

typedef struct ChipmunkRun {
    const DriverCase *of;
    Tree tree;
    int iterations;
    cpSpace *space;
    cpBody **bodies;         // by body; owned, as all arrays
    Vec2 *centres;           // of each body's frame, where the centre of mass is
    cpConstraint **holds;    // by joint; NULL of a law
    DriverContact *contacts; // by place
    DriverMotion *motions;
    DriverMotion *before;  // of the step before
    Vec2 *forces;          // by joint, on body b
    DriverAction *actions; // by body
    double from_s;         // between which loads act as their mean
    double to_s;
    bool is_native;
    double lag_s; // of velocities behind positions, as the law is to know
    double now_s; // of the positions
    DriverRun run;
} ChipmunkRun;

static void *room(size_t count, size_t size)
{
    void *memory = calloc(count + 1, size);
    if (memory == NULL) {
        driver_fail("there is no memory");
    }
    return memory;
}

static cpVect to_vect(Vec2 a)
{
    return cpv(a.x, a.y);
}

static cpBody *body_of(const ChipmunkRun *run, int body)
{
    return body == DRIVER_GROUND ? cpSpaceGetStaticBody(run->space) : run->bodies[body];
}

// A joint's point in the frame that Chipmunk has of a body: the driven one turns about its pivot.
static cpVect anchor_of(const ChipmunkRun *run, const DriverJoint *joint, int side)
{
    const int body = joint->bodies[side];
    const Vec2 centre = body == DRIVER_GROUND ? (Vec2){0.0, 0.0} : run->centres[body];
    return to_vect(vec2_add(joint->anchors[side], centre));
}

static void make_body(ChipmunkRun *run, size_t i)
{
    const DriverBody *body = &run->of->bodies[i];
    const DriverMotion *start = &body->start;
    const bool is_driven = run->of->has_drive && run->of->driven_body == (int)i;
    cpBody *made = is_driven ? cpBodyNewKinematic() : cpBodyNew(body->mass, body->inertia);
    Vec2 position = start->position;
    Vec2 velocity = start->velocity;
    if (is_driven) {
        const DriverJoint *joint = &run->of->joints[run->of->drive_joint];
        const int own = joint->bodies[1] == (int)i ? 1 : 0;
        if (joint->bodies[1 - own] != DRIVER_GROUND || joint->kind != DRIVER_REVOLUTE) {
            driver_refuse("a drive that does not turn a body about the ground");
        }
        position = joint->anchors[1 - own];
        velocity = (Vec2){0.0, 0.0};
        run->centres[i] = vec2_scale(-1.0, joint->anchors[own]);
    }
    cpBodySetPosition(made, to_vect(position));
    cpBodySetAngle(made, start->angle);
    cpBodySetVelocity(made, to_vect(velocity));
    cpBodySetAngularVelocity(made, start->omega);
    cpSpaceAddBody(run->space, made);
    run->bodies[i] = made;
}

static void hold(ChipmunkRun *run, size_t joint, cpConstraint *constraint)
{
    if (constraint == NULL) {
        driver_fail("there is no memory");
    }
    cpConstraintSetErrorBias(constraint, 0.0);
    cpSpaceAddConstraint(run->space, constraint);
    run->holds[joint] = constraint;
}

static void make_joint(ChipmunkRun *run, size_t i, bool is_native)
{
    const DriverJoint *joint = &run->of->joints[i];
    cpBody *a = body_of(run, joint->bodies[0]);
    cpBody *b = body_of(run, joint->bodies[1]);
    const cpVect on_a = anchor_of(run, joint, 0);
    const cpVect on_b = anchor_of(run, joint, 1);
    if (run->of->has_drive && run->of->drive_joint == (int)i) {
        return; // the kinematic body stands on it
    }
    if (trial_holds(&run->tree, i)) {
        return;
    }
    if (joint->kind == DRIVER_REVOLUTE) {
        hold(run, i, cpPivotJointNew2(a, b, on_a, on_b));
    } else if (joint->kind == DRIVER_PRISMATIC) {
        hold(run, i, chipmunk_line_new(a, b, cpvforangle(joint->direction)));
        const double held = cpBodyGetAngle(b) - cpBodyGetAngle(a);
        // a rotary limit of no width holds nothing as long as it is kept
        cpConstraint *angle = cpGearJointNew(a, b, held, 1.0);
        cpConstraintSetErrorBias(angle, 0.0);
        cpSpaceAddConstraint(run->space, angle);
    } else if (joint->kind == DRIVER_PIN_IN_HOLE && is_native) {
        hold(run, i, cpSlideJointNew(a, b, on_a, on_b, 0.0, joint->clearance));
    }
}

static void read_motions(const ChipmunkRun *run, DriverMotion *motions)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        const cpBody *body = run->bodies[i];
        const cpVect at = cpBodyGetPosition(body);
        const cpVect going = cpBodyGetVelocity(body);
        DriverMotion *motion = &motions[i];
        motion->angle = cpBodyGetAngle(body);
        motion->omega = cpBodyGetAngularVelocity(body);
        const Vec2 arm = vec2_rotate(motion->angle, run->centres[i]);
        motion->position = vec2_add((Vec2){at.x, at.y}, arm);
        motion->velocity =
            vec2_add((Vec2){going.x, going.y}, vec2_scale(motion->omega, vec2_perp(arm)));
    }
}

// The bodies as the law is to feel them: their velocities at the time of the positions.
static void read_felt(ChipmunkRun *run)
{
    const double share = run->lag_s / run->of->step_s;
    read_motions(run, run->motions);
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
    read_motions(run, run->motions);
    places_press(run->of, run->contacts, run->motions, NULL, run->forces, NULL, 0.0);
}

// Lets forces and moments act on the bodies until the end of the step under way.
static void push(const ChipmunkRun *run, const DriverAction *actions)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        if (cpBodyGetType(run->bodies[i]) == CP_BODY_TYPE_DYNAMIC) {
            cpBodySetForce(run->bodies[i], to_vect(actions[i].force));
            cpBodySetTorque(run->bodies[i], actions[i].moment);
        }
    }
}

// Chipmunk's callbacks know their body: what they are for is in the space.
static void change_velocity(cpBody *body, cpVect gravity, cpFloat damping, cpFloat step_s)
{
    ChipmunkRun *run = cpSpaceGetUserData(cpBodyGetSpace(body));
    // the first body of the step: all positions are new, all velocities old
    if (body == cpBodyGetUserData(run->bodies[0])) {
        find_forces(run);
        push(run, run->actions);
    }
    cpBodyUpdateVelocity(body, gravity, damping, step_s);
}

static void stamp(ChipmunkRun *run, double velocity_s)
{
    DriverStamp *now = driver_run_stamp(&run->run);
    now->position_s = run->now_s;
    now->velocity_s = velocity_s;
    read_motions(run, now->motions);
    if (run->of->has_drive) {
        // the driven body's velocity is known at any time
        DriverMotion *driven = &now->motions[run->of->driven_body];
        const double angle = driven->angle + driven->omega * (velocity_s - run->now_s);
        const Vec2 arm = vec2_rotate(angle, run->centres[run->of->driven_body]);
        driven->velocity = vec2_scale(driven->omega, vec2_perp(arm));
    }
    memcpy(now->forces, run->forces, run->of->joint_count * sizeof *now->forces);
    driver_run_stamped(&run->run);
}

// The forces of slide joints, along the line of the centres.
static void read_slides(ChipmunkRun *run)
{
    read_motions(run, run->motions);
    places_follow(run->of, run->motions, run->contacts, run->run.totals);
    for (size_t i = 0; i < run->of->place_count; i++) {
        const DriverPlace *place = &run->of->places[i];
        DriverTotals *totals = &run->run.totals[place->joint];
        const double force = cpConstraintGetImpulse(run->holds[place->joint]) / run->of->step_s;
        run->forces[place->joint] = vec2_scale(force, place_pose(place, run->motions).normal);
        totals->force_max = fmax(totals->force_max, force);
    }
}

static void take_step(ChipmunkRun *run)
{
    const double step_s = run->of->step_s;
    run->from_s = run->now_s + run->lag_s;
    run->to_s = run->from_s + step_s;
    if (run->of->has_drive) {
        // to a rounding, however many steps there are
        cpBodySetAngle(run->bodies[run->of->driven_body],
                       run->of->bodies[run->of->driven_body].start.angle +
                           run->of->drive_speed * run->now_s);
    }
    cpSpaceStep(run->space, step_s);
    run->now_s = step_s * (double)++run->run.steps;
    if (run->is_native) {
        read_slides(run);
    }
    stamp(run, run->now_s + run->lag_s);
}

static void make(const DriverCase *of, ChipmunkRun *run)
{
    const bool is_native = driver_is_way(of, "native");
    *run = (ChipmunkRun){.of = of,
                         .space = cpSpaceNew(),
                         .bodies = room(of->body_count, sizeof *run->bodies),
                         .centres = room(of->body_count, sizeof *run->centres),
                         .holds = room(of->joint_count, sizeof *run->holds),
                         .contacts = places_start(of),
                         .tree = tree_make(of),
                         .motions = room(of->body_count, sizeof *run->motions),
                         .before = room(of->body_count, sizeof *run->before),
                         .forces = room(of->joint_count, sizeof *run->forces),
                         .actions = room(of->body_count, sizeof *run->actions),
                         .is_native = is_native,
                         .run = driver_run_start(of)};
    const bool is_open = run->tree.left_count == 0;
    const int open = driver_is_way(of, "kernel") ? ITERATIONS_TRIAL
                     : is_native                 ? ITERATIONS_SLIDING
                                                 : ITERATIONS_OPEN;
    run->iterations = is_open || driver_is_way(of, "kernel") ? open : ITERATIONS_CLOSED;
    cpSpaceSetIterations(run->space, run->iterations);
    cpSpaceSetGravity(run->space, to_vect(of->gravity));
    cpSpaceSetUserData(run->space, run);
    for (size_t i = 0; i < of->body_count; i++) {
        make_body(run, i);
    }
    for (size_t i = 0; i < of->joint_count; i++) {
        make_joint(run, i, is_native);
    }
    read_motions(run, run->before);
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
    cpBodySetUserData(run->bodies[0], first);
}

static void stay(cpBody *body, cpFloat step_s)
{
    (void)body;
    (void)step_s;
}

static void let_move(ChipmunkRun *run, cpBodyPositionFunc how)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        cpBodySetPositionUpdateFunc(run->bodies[i], how);
    }
}

// Brings the velocities half a step ahead of the positions, by half a step in which nothing moves.
static void start_staggered(ChipmunkRun *run)
{
    run->lag_s = 0.0;
    run->from_s = 0.0;
    run->to_s = 0.5 * run->of->step_s;
    let_move(run, stay);
    cpSpaceStep(run->space, run->to_s);
    let_move(run, cpBodyUpdatePosition);
    run->lag_s = run->to_s;
    read_motions(run, run->motions);
    for (size_t i = 0; i < run->of->body_count; i++) {
        // accelerations that are to be expected are those of the start
        DriverMotion *before = &run->before[i];
        before->velocity = vec2_sub(vec2_scale(2.0, before->velocity), run->motions[i].velocity);
        before->omega = 2.0 * before->omega - run->motions[i].omega;
    }
}

// The contacts within the step: the space is asked for accelerations, and moves nothing itself.

typedef struct Trials {
    ChipmunkRun *run;
    Tree tree;
    double step_s; // of a trial
    DriverMotion *before;
    DriverMotion *after;
    DriverAction *actions;
} Trials;

// Puts a body where the trial has it, in the frame that Chipmunk has of it.
static void place(const ChipmunkRun *run, size_t i, const DriverMotion *motion)
{
    const Vec2 arm = vec2_rotate(motion->angle, run->centres[i]);
    const Vec2 going = vec2_scale(motion->omega, vec2_perp(arm));
    if (run->of->has_drive && run->of->driven_body == (int)i) {
        cpBodySetAngle(run->bodies[i], motion->angle); // about its pivot, which stays
        return;
    }
    cpBodySetPosition(run->bodies[i], to_vect(vec2_sub(motion->position, arm)));
    cpBodySetAngle(run->bodies[i], motion->angle);
    cpBodySetVelocity(run->bodies[i], to_vect(vec2_sub(motion->velocity, going)));
    cpBodySetAngularVelocity(run->bodies[i], motion->omega);
}

static void accelerate(void *engine, const double *q, const double *v, const DriverAction *actions,
                       double *a)
{
    Trials *trials = engine;
    ChipmunkRun *run = trials->run;
    trial_place(&trials->tree, q, v, actions, trials->before, trials->actions);
    for (size_t i = 0; i < run->of->body_count; i++) {
        place(run, i, &trials->before[i]);
    }
    push(run, trials->actions);
    cpSpaceStep(run->space, trials->step_s);
    read_motions(run, trials->after);
    trial_read(&trials->tree, trials->before, trials->after, trials->step_s, a);
}

// The accelerations under actions that move every body, asked for after others: the solver begins
// with what it found last.
static void accelerate_anew(Trials *trials, const double *q, const double *v, DriverAction *actions,
                            double *a)
{
    const DriverCase *of = trials->run->of;
    memset(actions, 0, of->body_count * sizeof *actions);
    accelerate(trials, q, v, actions, a);
    for (size_t i = 0; i < of->body_count; i++) {
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        const double size = sign * TRIED_ACCELERATION * of->bodies[i].mass;
        actions[i] = (DriverAction){{size, size}, -sign * TRIED_TURNING * of->bodies[i].inertia};
    }
    accelerate(trials, q, v, actions, a);
}

// Whether half as many iterations find the same accelerations but for a share of them; leaves the
// solver with as many as there were.
static bool is_solved(Trials *trials, const double *q, const double *v, double share)
{
    ChipmunkRun *run = trials->run;
    const size_t count = trials->tree.coordinates;
    double *a[2] = {room(count, sizeof **a), room(count, sizeof **a)};
    DriverAction *actions = room(run->of->body_count, sizeof *actions);
    double change = 0.0;
    double size = 0.0;
    for (int half = 1; half >= 0; half--) {
        cpSpaceSetIterations(run->space, run->iterations / (half + 1));
        accelerate_anew(trials, q, v, actions, a[half]);
    }
    for (size_t i = 0; i < count; i++) {
        change = fmax(change, fabs(a[0][i] - a[1][i]));
        size = fmax(size, fabs(a[0][i]));
    }
    free(actions);
    free(a[1]);
    free(a[0]);
    return change <= share * size;
}

// Doubles the iterations until accelerations change no more, at the start and where each coordinate
// is elsewhere: how many are needed depends on how the bodies stand.
static void choose_iterations(Trials *trials)
{
    ChipmunkRun *run = trials->run;
    const size_t count = trials->tree.coordinates;
    double *q = room(count, sizeof *q);
    double *v = room(count, sizeof *v);
    tree_start(&trials->tree, v);
    run->iterations *= 2;
    for (int place = 0; place < TRIED_PLACES; place++) {
        for (size_t i = 0; i < count; i++) {
            q[i] = TRIED_APART * place * (i % 2 == 0 ? 1.0 : -1.0);
        }
        while (!is_solved(trials, q, v, SOLVED) && run->iterations < ITERATIONS_TRIAL_MOST) {
            run->iterations *= 2;
        }
        if (!is_solved(trials, q, v, SOLVED_LEAST)) {
            driver_refuse("contacts within the step of bodies whose masses differ so much that %d "
                          "iterations do not solve them",
                          run->iterations);
        }
    }
    run->iterations /= 2; // which were enough
    cpSpaceSetIterations(run->space, run->iterations);
    free(v);
    free(q);
}

static void tell_settings(ChipmunkRun *run)
{
    snprintf(run->run.settings, sizeof run->run.settings,
             "%d iterations, errorBias 0 of all constraints, driven body kinematic",
             run->iterations);
}

static _Noreturn void run_trials(ChipmunkRun *run)
{
    const size_t bodies = run->of->body_count;
    Trials trials = {.run = run,
                     .tree = run->tree,
                     .step_s = trial_step(run->of),
                     .before = room(bodies, sizeof *trials.before),
                     .after = room(bodies, sizeof *trials.after),
                     .actions = room(bodies, sizeof *trials.actions)};
    let_move(run, stay);
    choose_iterations(&trials);
    tell_settings(run);
    trial_run(&trials.tree, &(TrialEngine){accelerate, NULL, &trials}, &run->run);
}

int main(void)
{
    static const char *const WAYS[] = {"native", "force", "staggered", "kernel", NULL};
    const DriverIdentity identity = {"Chipmunk", cpVersionString, "double", WAYS};
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
    if (is_native) {
        driver_refuse_friction(of);
    }
    make(of, &run);
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
        run_trials(&run);
    }
    tell_settings(&run);
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
