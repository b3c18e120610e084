// Finds the speeds that belong to the end of a step.
//
// Those that ODE finds at mid-step, J v' = -(e/h) Phi, leave joints that are open by Phi = h^2 c /
// 2e (world/opening.c) opening by the rate of that, h^2 c' / 2e: much, while a contact turns speeds
// round. One more step at the step's end, with an ERP of 0 and no forces, takes it away, along the
// rows there. It is taken back but for the velocities.
//
// Rows that press only one way, slip or drive would do so again. So this is for worlds of rows that
// do none of it: hinges and sliders without motors and stops, balls and fixed joints.
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

static bool only_holds(const JpWorld *world, dJointID joint)
{
    typedef dReal (*Param)(dJointID, int);
    const dJointType type = dJointGetType(joint);
    if (type == dJointTypeBall || type == dJointTypeFixed || type == dJointTypeNull ||
        !dJointIsEnabled(joint)) {
        return true;
    }
    if (type != dJointTypeHinge && type != dJointTypeSlider) {
        return type == dJointTypeAMotor && is_ours(world, joint);
    }
    const Param param = type == dJointTypeHinge ? dJointGetHingeParam : dJointGetSliderParam;
    return param(joint, dParamFMax) == 0.0 && isinf(param(joint, dParamLoStop)) &&
           isinf(param(joint, dParamHiStop));
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
            if (!only_holds(world, dBodyGetJoint(body, k))) {
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

static void keep(ClosingJoint *kept)
{
    const dJointFeedback *feedback = dJointGetFeedback(kept->joint);
    if (feedback != NULL) {
        kept->feedback = *feedback;
    }
    if (has_own_erp(kept->joint)) {
        kept->erp = own_erp(kept->joint);
    }
}

static void put_back(const ClosingJoint *kept)
{
    dJointFeedback *feedback = dJointGetFeedback(kept->joint);
    if (feedback != NULL) {
        *feedback = kept->feedback;
    }
    if (has_own_erp(kept->joint)) {
        set_own_erp(kept->joint, kept->erp);
    }
}

// A step without forces and errors.
static void step_freely(JpWorld *world, double step)
{
    dVector3 gravity;
    dWorldGetGravity(world->id, gravity);
    const double erp = dWorldGetERP(world->id);
    dWorldSetGravity(world->id, 0.0, 0.0, 0.0);
    dWorldSetERP(world->id, 0.0);
    trial_step(world, step, NULL);
    dWorldSetGravity(world->id, gravity[0], gravity[1], gravity[2]);
    dWorldSetERP(world->id, erp);
}

bool closing_make(const JpWorld *world, Closing *closing)
{
    const size_t count = list_joints(world, NULL);
    *closing = (Closing){.count = count, .joints = calloc(count + 1, sizeof *closing->joints)};
    if (closing->joints != NULL) {
        list_joints(world, closing->joints);
    }
    return closing->joints != NULL;
}

void closing_free(Closing *closing)
{
    free(closing->joints);
    *closing = (Closing){0};
}

void closing_put_back(Closing *closing)
{
    for (size_t i = 0; closing->is_open && i < closing->count; i++) {
        put_back(&closing->joints[i]);
    }
    closing->is_open = false;
}

void closing_run(JpWorld *world, Closing *closing, double step)
{
    const size_t count = closing->count;
    ClosingJoint *kept = closing->joints;
    for (size_t i = 0; i < count; i++) {
        keep(&kept[i]);
    }
    closing->is_open = true;
    for (size_t i = 0; i < count; i++) {
        if (has_own_erp(kept[i].joint)) {
            set_own_erp(kept[i].joint, 0.0);
        }
    }
    bodies_keep_positions(&world->bodies);
    step_freely(world, step);
    bodies_put_back_positions(&world->bodies);
    closing_put_back(closing);
}
