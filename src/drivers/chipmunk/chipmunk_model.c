// Makes Chipmunk's space of a case.
//
// A driven body is kinematic, about its pivot, and moves by a function of its own: to where its
// drive has it at the end of the step, with the mean speed of the step to come. Errors of joints
// are corrected in the next step, all of them.
#include "drivers/chipmunk/chipmunk_driver.h"

#include "drivers/chipmunk/chipmunk_line.h"
#include "drivers/common/trial.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

// Iterations of the solver. Of the ideal four-bar at 20 us 10 leave an error of 2.7e-4, 30
// of 1.8e-5, 100 and 300 of 1.2e-5. Where no loop is closed, and the law is a force, 10 are as good
// as 300 with two joints; with those of a planetary gear 10 leave an error of 30, 30 of 0.39,
// and 100 and 300 of 0.14. With a slide joint in its place 10 change the largest force by a tenth,
// and 30 by a thousandth.
enum { ITERATIONS_OPEN = 10, ITERATIONS_SLIDING = 30, ITERATIONS_CLOSED = 100, OPEN_JOINTS = 2 };

enum { ITERATIONS_TRIAL = 30 };

cpBody *chipmunk_body(const ChipmunkRun *run, int body)
{
    return body == DRIVER_GROUND ? cpSpaceGetStaticBody(run->space) : run->bodies[body];
}

cpVect chipmunk_point(const ChipmunkRun *run, int body, Vec2 local)
{
    const Vec2 centre = body == DRIVER_GROUND ? (Vec2){0.0, 0.0} : run->centres[body];
    return chipmunk_vect(vec2_add(local, centre));
}

// Moves a driven body to the end of the step, where its mean speed is that of the next one.
static void move_driven(cpBody *body, cpFloat step_s)
{
    const ChipmunkRun *run = cpSpaceGetUserData(cpBodyGetSpace(body));
    const DriverDrive *drive = cpBodyGetUserData(body);
    const double end_s = run->now_s + step_s;
    cpBodySetAngle(body, drive_angle(&drive->law, end_s));
    cpBodySetAngularVelocity(body, driver_drive_mean(drive, end_s, end_s + step_s));
}

static void make_body(ChipmunkRun *run, size_t i)
{
    const DriverBody *body = &run->of->bodies[i];
    const DriverMotion *start = &body->start;
    const DriverDrive *drive = driver_drive_of(run->of, (int)i);
    cpBody *made = drive != NULL ? cpBodyNewKinematic() : cpBodyNew(body->mass, body->inertia);
    Vec2 position = start->position;
    Vec2 velocity = start->velocity;
    if (drive != NULL) {
        Vec2 on_body;
        position = driver_drive_pivot(run->of, drive, &on_body);
        velocity = (Vec2){0.0, 0.0};
        run->centres[i] = vec2_scale(-1.0, on_body);
    }
    cpBodySetPosition(made, chipmunk_vect(position));
    cpBodySetAngle(made, start->angle);
    cpBodySetVelocity(made, chipmunk_vect(velocity));
    cpBodySetAngularVelocity(made, start->omega);
    if (drive != NULL) {
        cpBodySetUserData(made, (void *)(uintptr_t)drive);
        cpBodySetPositionUpdateFunc(made, move_driven);
    }
    cpSpaceAddBody(run->space, made);
    run->bodies[i] = made;
}

void chipmunk_add(ChipmunkRun *run, cpConstraint *constraint)
{
    if (constraint == NULL) {
        driver_fail("there is no memory");
    }
    cpConstraintSetErrorBias(constraint, 0.0);
    cpSpaceAddConstraint(run->space, constraint);
}

static void make_joint(ChipmunkRun *run, size_t i)
{
    const DriverJoint *joint = &run->of->joints[i];
    cpBody *a = chipmunk_body(run, joint->bodies[0]);
    cpBody *b = chipmunk_body(run, joint->bodies[1]);
    if (driver_drive_at_joint(run->of, i) != NULL || trial_holds(&run->tree, i)) {
        return; // a kinematic body stands on it, or rows of the driver's hold it
    }
    if (joint->kind == DRIVER_REVOLUTE) {
        chipmunk_add(
            run, cpPivotJointNew2(a, b, chipmunk_point(run, joint->bodies[0], joint->anchors[0]),
                                  chipmunk_point(run, joint->bodies[1], joint->anchors[1])));
    } else if (joint->kind == DRIVER_PRISMATIC) {
        chipmunk_add(run, chipmunk_line_new(a, b, cpvforangle(joint->direction)));
        const double held = cpBodyGetAngle(b) - cpBodyGetAngle(a);
        // a rotary limit of no width holds nothing as long as it is kept
        chipmunk_add(run, cpGearJointNew(a, b, held, 1.0));
    }
}

void chipmunk_read(const ChipmunkRun *run, DriverMotion *motions)
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

// Lets forces and moments act on the bodies until the end of the step under way.
void chipmunk_push(const ChipmunkRun *run, const DriverAction *actions)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        if (cpBodyGetType(run->bodies[i]) == CP_BODY_TYPE_DYNAMIC) {
            cpBodySetForce(run->bodies[i], chipmunk_vect(actions[i].force));
            cpBodySetTorque(run->bodies[i], actions[i].moment);
        }
    }
}

void chipmunk_stay(cpBody *body, cpFloat step_s)
{
    (void)body;
    (void)step_s;
}

void chipmunk_let_move(ChipmunkRun *run, cpBodyPositionFunc how)
{
    for (size_t i = 0; i < run->of->body_count; i++) {
        const bool is_driven = driver_drive_of(run->of, (int)i) != NULL;
        cpBodySetPositionUpdateFunc(run->bodies[i],
                                    is_driven && how == cpBodyUpdatePosition ? move_driven : how);
    }
}

static int first_iterations(const ChipmunkRun *run)
{
    const DriverCase *of = run->of;
    size_t held = 0;
    for (size_t i = 0; i < of->joint_count; i++) {
        held += driver_is_ideal(&of->joints[i]) && driver_drive_at_joint(of, i) == NULL ? 1 : 0;
    }
    if (driver_is_way(of, "kernel")) {
        return ITERATIONS_TRIAL;
    }
    if (run->tree.left_count > 0 || held > OPEN_JOINTS) {
        return ITERATIONS_CLOSED;
    }
    return run->is_native ? ITERATIONS_SLIDING : ITERATIONS_OPEN;
}

void chipmunk_make(const DriverCase *of, ChipmunkRun *run)
{
    const bool is_native = driver_is_way(of, "native");
    *run = (ChipmunkRun){.of = of,
                         .space = cpSpaceNew(),
                         .bodies = driver_room(of->body_count, sizeof *run->bodies),
                         .centres = driver_room(of->body_count, sizeof *run->centres),
                         .pushes = driver_room(of->place_count, sizeof *run->pushes),
                         .contacts = places_start(of),
                         .tree = tree_make(of),
                         .motions = driver_room(of->body_count, sizeof *run->motions),
                         .before = driver_room(of->body_count, sizeof *run->before),
                         .forces = driver_room(of->joint_count, sizeof *run->forces),
                         .actions = driver_room(of->body_count, sizeof *run->actions),
                         .is_native = is_native,
                         .run = driver_run_start(of)};
    run->iterations = first_iterations(run);
    cpSpaceSetIterations(run->space, run->iterations);
    cpSpaceSetGravity(run->space, chipmunk_vect(of->gravity));
    cpSpaceSetUserData(run->space, run);
    for (size_t i = 0; i < of->body_count; i++) {
        make_body(run, i);
    }
    for (size_t i = 0; i < of->joint_count; i++) {
        make_joint(run, i);
    }
    if (is_native) {
        chipmunk_make_native(run);
    }
    chipmunk_read(run, run->before);
}

void chipmunk_tell_settings(ChipmunkRun *run)
{
    snprintf(run->run.settings, sizeof run->run.settings,
             "%d iterations, errorBias 0 of all constraints, driven body kinematic",
             run->iterations);
    if (run->native.face_count > 0) {
        native_tell(&run->run, ", collisionSlop 1e-7, collisionBias 0, no elasticity");
    }
    if (run->native.has_rigid_teeth) {
        native_tell(&run->run, ", gears by cpGearJoint, without play");
    }
}
