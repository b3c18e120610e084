// A model of a robot as a case: what of it a case can carry, by which names, in which plane.
#pragma once

#include "base/text.h"
#include "engine/robot.h"
#include "model/linkage.h"

typedef char CaseName[LINKAGE_NAME_SIZE];

// What becomes of a joint.
typedef enum RobotFate {
    ROBOT_STAYS, // a joint of the case
    ROBOT_LOOSE, // one of those by which its body is free
    ROBOT_FIXED, // out of the plane: what it carries is fixed
} RobotFate;

typedef struct RobotCase {
    Robot *robot; // with what is fixed out of the plane taken into what it is fixed to
    bool is_planar;
    Vec3 right; // x, y and z of the case, in the file's world
    Vec3 up;
    Vec3 normal;
    int *held;        // by body: itself, or what it is fixed to; owned, as all arrays
    RobotFate *fates; // by joint
    CaseName *bodies; // names
    CaseName *joints;
    CaseName *loops;
    CaseName *couplings;
    size_t note_count;
    char **notes; // what is left out, a sentence each
} RobotCase;

// Finds how a robot is carried, which is changed. Fails with ERR_CASE where it cannot be.
bool robot_case_make(Robot *robot, RobotCase *of, Err *err);
void robot_case_finish(RobotCase *of);

// Adds a sentence on what is left out.
void robot_case_note(RobotCase *of, const char *format, ...) __attribute__((format(printf, 2, 3)));

// The name in the case of a body or the ground.
const char *robot_case_body(const RobotCase *of, int body);

// The name in the case of one of the robot's joints.
static inline const char *robot_case_joint(const RobotCase *of, const RobotJoint *joint)
{
    return of->joints[joint - of->robot->joints];
}

// What a joint or loop is fixed to or held by.
static inline int robot_case_held(const RobotCase *of, int body)
{
    return body == ROBOT_GROUND ? ROBOT_GROUND : of->held[body];
}

// Whether a joint turns about the case's z by the left hand.
static inline double robot_case_sign(const RobotCase *of, const RobotJoint *joint)
{
    return vec3_dot(joint->axis, of->normal) < 0.0 ? -1.0 : 1.0;
}

// Appends the whole case, of a model in a file of that name.
void robot_case_write(RobotCase *of, const char *file, Text *text);
