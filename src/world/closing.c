// Closes ODE's joints at the end of a step.
//
// Speeds that ODE finds at mid-step, J v' = -(e/h) Phi, leave joints that are open by Phi = h^2 c /
// 2e (world/opening.c) opening by the rate of that, h^2 c' / 2e: much, while a contact turns speeds
// round. One more step at the step's end, with an ERP of 0 and no forces, takes it away, along the
// rows there:  v_0 = v' - G J v'. Another one with an ERP of 1 shows by how much joints are open,
//     v_1 = v_0 - (1/h) G Phi
// and bodies are moved by h (v_1 - v_0). Of both steps all else is taken back.
//
// A step that begins with closed joints has them open by Phi = h^2 c / 8 at mid-step; with an ERP
// of 4 it ends with J v' = -(h/2) c, as closed joints at the end need.
//
// Rows that press only one way or slip would do so again. So this is for worlds of rows that do
// none of it: hinges and sliders without stops, whose motors, if any, have no bound, balls, fixed
// joints and dampers. Dampers, motors or distance joints with a CFM, are left out of these steps.
#include "world/closing.h"

#include "world/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// What a closing changes of a ball or fixed joint, and puts back.
static double own_erp(dJointID joint)
{
    return dJointGetType(joint) == dJointTypeBall ? dJointGetBallParam(joint, dParamERP)
                                                  : dJointGetFixedParam(joint, dParamERP);
}

static void set_own_erp(dJointID joint, double erp)
{
    if (dJointGetType(joint) == dJointTypeBall) {
        dJointSetBallParam(joint, dParamERP, erp);
    } else {
        dJointSetFixedParam(joint, dParamERP, erp);
    }
}

// A row of the library's that presses in no step with impulses.
static bool is_ours(const JpWorld *world, dJointID id)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        for (size_t i = 0; i < joint->place_count; i++) {
            if (joint->places[i].row.motor == id) {
                return true;
            }
        }
    }
    return false;
}

// A motor without a bound, or none, on a hinge or slider without stops.
static bool is_unbounded(dJointID joint, dJointType type)
{
    typedef dReal (*Param)(dJointID, int);
    const Param param = type == dJointTypeHinge ? dJointGetHingeParam : dJointGetSliderParam;
    const dReal most = param(joint, dParamFMax);
    return (most == 0.0 || isinf(most)) && isinf(param(joint, dParamLoStop)) &&
           isinf(param(joint, dParamHiStop));
}

// Whether a joint has a row that yields, as a damper does: a motor without a bound, or a distance
// joint, that is softer than the world.
static bool yields(const JpWorld *world, dJointID joint)
{
    const double hard = dWorldGetCFM(world->id);
    switch (dJointGetType(joint)) {
    case dJointTypeHinge:
        return dJointGetHingeParam(joint, dParamFMax) > 0.0 &&
               dJointGetHingeParam(joint, dParamCFM) > hard;
    case dJointTypeSlider:
        return dJointGetSliderParam(joint, dParamFMax) > 0.0 &&
               dJointGetSliderParam(joint, dParamCFM) > hard;
    case dJointTypeDBall:
        return dJointGetDBallParam(joint, dParamCFM) > hard;
    default:
        return false;
    }
}

static bool is_joint_linear(const JpWorld *world, dJointID joint)
{
    const dJointType type = dJointGetType(joint);
    if (type == dJointTypeBall || type == dJointTypeFixed || type == dJointTypeNull ||
        !dJointIsEnabled(joint)) {
        return true;
    }
    if (type == dJointTypeHinge || type == dJointTypeSlider) {
        return is_unbounded(joint, type);
    }
    return (type == dJointTypeDBall && yields(world, joint)) ||
           (type == dJointTypeAMotor && is_ours(world, joint));
}

// Lets a row that yields push, or not.
static void let_push(dJointID joint, bool does_push)
{
    switch (dJointGetType(joint)) {
    case dJointTypeHinge:
        dJointSetHingeParam(joint, dParamFMax, does_push ? dInfinity : 0.0);
        break;
    case dJointTypeSlider:
        dJointSetSliderParam(joint, dParamFMax, does_push ? dInfinity : 0.0);
        break;
    default:
        (does_push ? dJointEnable : dJointDisable)(joint);
        break;
    }
}

bool closing_is_linear(const JpWorld *world)
{
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const dBodyID body = world->bodies.records[i].id;
        if (dBodyGetLinearDamping(body) != 0.0 || dBodyGetAngularDamping(body) != 0.0 ||
            isfinite(dBodyGetMaxAngularSpeed(body)) || !dBodyIsEnabled(body)) {
            return false;
        }
        for (int k = 0; k < dBodyGetNumJoints(body); k++) {
            if (!is_joint_linear(world, dBodyGetJoint(body, k))) {
                return false;
            }
        }
    }
    return true;
}

static bool has_own_erp(dJointID joint)
{
    return dJointGetType(joint) == dJointTypeBall || dJointGetType(joint) == dJointTypeFixed;
}

// Lists the joints of all bodies, those of two of them twice. Returns their number.
static size_t list_joints(const JpWorld *world, ClosingJoint *kept)
{
    size_t count = 0;
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const dBodyID body = world->bodies.records[i].id;
        const int joints = dBodyGetNumJoints(body);
        for (int k = 0; k < joints; k++, count++) {
            if (kept != NULL) {
                kept[count].joint = dBodyGetJoint(body, k);
            }
        }
    }
    return count;
}

bool closing_is_read(const JpWorld *world)
{
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const dBodyID body = world->bodies.records[i].id;
        const int joints = dBodyGetNumJoints(body);
        for (int k = 0; k < joints; k++) {
            const dJointID joint = dBodyGetJoint(body, k);
            if (dJointGetFeedback(joint) != NULL && !is_ours(world, joint)) {
                return true;
            }
        }
    }
    return false;
}

static void set_erp(JpWorld *world, const Closing *closing, double erp)
{
    dWorldSetERP(world->id, erp);
    for (size_t i = 0; i < closing->count; i++) {
        if (has_own_erp(closing->joints[i].joint)) {
            set_own_erp(closing->joints[i].joint, erp);
        }
    }
}

void closing_hold(JpWorld *world, Closing *closing, double erp)
{
    closing->is_held = true;
    set_erp(world, closing, erp);
}

void closing_release(JpWorld *world, Closing *closing)
{
    if (closing->is_held) {
        dWorldSetERP(world->id, closing->erp);
        closing_put_back(closing);
    }
}

// What ODE's joints may yield in a step by their CFM, of what the same forces do to the heaviest
// body by itself: joints that stay open take that back in the next steps, closed ones never do.
static const double YIELD_MOST = 5e-6;

static bool is_hard(const JpWorld *world, double step)
{
    double heaviest = 0.0;
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const dBodyID body = world->bodies.records[i].id;
        dMass mass;
        dBodyGetMass(body, &mass);
        heaviest = dBodyIsKinematic(body) ? heaviest : fmax(heaviest, mass.mass);
    }
    return dWorldGetCFM(world->id) * heaviest <= YIELD_MOST * step;
}

// Whether all joints have the world's ERP.
static bool is_even(const JpWorld *world)
{
    const double erp = dWorldGetERP(world->id);
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const dBodyID body = world->bodies.records[i].id;
        for (int k = 0; k < dBodyGetNumJoints(body); k++) {
            const dJointID joint = dBodyGetJoint(body, k);
            if (has_own_erp(joint) && own_erp(joint) != erp) {
                return false;
            }
        }
    }
    return erp > 0.0;
}

bool closing_is_possible(const JpWorld *world, double step)
{
    return is_even(world) && is_hard(world, step);
}

// The velocities after a step without forces at an ERP; bodies are then as they are kept.
static void step_freely(JpWorld *world, const Closing *closing, double step, double erp,
                        double *speeds)
{
    set_erp(world, closing, erp);
    trial_step(world, step, NULL);
    for (size_t i = 0; i < world->bodies.moving; i++) {
        bodies_read_speeds(&world->bodies.records[i], &speeds[BODY_NUMBERS * i]);
    }
    bodies_put_back(&world->bodies);
}

static bool holds(dJointID joint)
{
    const dJointType type = dJointGetType(joint);
    return dJointIsEnabled(joint) && (type == dJointTypeHinge || type == dJointTypeSlider ||
                                      type == dJointTypeBall || type == dJointTypeFixed);
}

bool closing_make(const JpWorld *world, Closing *closing)
{
    const size_t count = list_joints(world, NULL);
    const size_t numbers = 2 * BODY_NUMBERS * world->bodies.moving;
    *closing = (Closing){.count = count,
                         .erp = dWorldGetERP(world->id),
                         .joints = calloc(count + 1, sizeof *closing->joints),
                         .speeds = calloc(numbers + 1, sizeof *closing->speeds),
                         .kept = calloc(world->bodies.moving + 1, sizeof *closing->kept)};
    if (closing->joints == NULL || closing->speeds == NULL || closing->kept == NULL) {
        closing->count = 0; // nothing is to be put back
        return false;
    }
    list_joints(world, closing->joints);
    for (size_t i = 0; i < count; i++) {
        if (has_own_erp(closing->joints[i].joint)) {
            closing->joints[i].erp = own_erp(closing->joints[i].joint);
        }
        closing->has_any = closing->has_any || holds(closing->joints[i].joint);
        closing->joints[i].yields =
            dJointIsEnabled(closing->joints[i].joint) && yields(world, closing->joints[i].joint);
    }
    return true;
}

void closing_free(Closing *closing)
{
    free(closing->joints);
    free(closing->speeds);
    free(closing->kept);
    *closing = (Closing){0};
}

void closing_put_back(Closing *closing)
{
    for (size_t i = 0; i < closing->count; i++) {
        const ClosingJoint *kept = &closing->joints[i];
        dJointFeedback *feedback = closing->is_open ? dJointGetFeedback(kept->joint) : NULL;
        if (feedback != NULL) {
            *feedback = kept->feedback;
        }
        if (closing->is_open && kept->yields) {
            let_push(kept->joint, true);
        }
        if (closing->is_held && has_own_erp(kept->joint)) {
            set_own_erp(kept->joint, kept->erp);
        }
    }
    closing->is_open = closing->is_held = false;
}

// Sets aside feedback, and what yields.
static void set_aside(Closing *closing)
{
    for (size_t i = 0; i < closing->count; i++) {
        const dJointFeedback *feedback = dJointGetFeedback(closing->joints[i].joint);
        if (feedback != NULL) {
            closing->joints[i].feedback = *feedback;
        }
        if (closing->joints[i].yields) {
            let_push(closing->joints[i].joint, false);
        }
    }
    closing->is_open = closing->is_held = true;
}

void closing_run(JpWorld *world, Closing *closing, double step, bool has_positions)
{
    const size_t numbers = BODY_NUMBERS * world->bodies.moving;
    if (!closing->has_any) {
        return;
    }
    double *speeds = closing->speeds;
    double *moved = closing->speeds + numbers;
    dVector3 gravity;
    set_aside(closing);
    dWorldGetGravity(world->id, gravity);
    dWorldSetGravity(world->id, 0.0, 0.0, 0.0);
    for (size_t i = 0; i < world->bodies.moving; i++) {
        closing->kept[i] = world->bodies.records[i].kept;
    }
    bodies_keep(&world->bodies);
    step_freely(world, closing, step, 0.0, speeds);
    if (has_positions) {
        step_freely(world, closing, step, 1.0, moved);
    }
    dWorldSetGravity(world->id, gravity[0], gravity[1], gravity[2]);
    closing_release(world, closing);
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const dBodyID id = world->bodies.records[i].id;
        const double *of = &speeds[BODY_NUMBERS * i];
        world->bodies.records[i].kept = closing->kept[i];
        double *by = &moved[BODY_NUMBERS * i];
        for (size_t k = 0; k < BODY_NUMBERS; k++) {
            by[k] -= of[k];
        }
        if (has_positions) {
            bodies_move(id, by, step);
        }
        dBodySetLinearVel(id, of[0], of[1], of[2]);
        dBodySetAngularVel(id, of[3], of[4], of[5]);
    }
}
