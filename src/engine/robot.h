// A mechanism as an engine has read it from a model of its own, such as MJCF or URDF.
//
// Bodies are those that move, each with all that is fixed to it, in the posture of the file.
// Places, axes and inertias are in the world's axes; coordinates of joints are 0 in that posture.
// SI units, radians.
#pragma once

#include "base/vec3.h"
#include "engine/driver.h"

enum { ROBOT_GROUND = -1, ROBOT_NAME_SIZE = 96 };

typedef struct RobotBody {
    char name[ROBOT_NAME_SIZE]; // may be empty
    int parent;                 // which comes before it; ROBOT_GROUND
    double mass;                // kg
    Vec3 centre;                // m, of mass
    Mat3 inertia;               // kg m^2, about the centre
} RobotBody;

typedef enum RobotJointKind { ROBOT_HINGE, ROBOT_SLIDE, ROBOT_BALL, ROBOT_FREE } RobotJointKind;

// What lets a body move against its parent; several of one body follow each other.
typedef struct RobotJoint {
    char name[ROBOT_NAME_SIZE];
    RobotJointKind kind;
    int body;
    Vec3 place;
    Vec3 axis;   // of length 1, of a hinge or slide
    double zero; // the engine's own value of the coordinate in the posture of the file
    bool is_limited;
    double range[2];        // rad, m
    double limit_stiffness; // N m/rad, N/m, of what holds it there
    double limit_damping;   // N m s/rad, N s/m
    double stiffness;       // N m/rad, N/m
    double relaxed;         // rad, m: where its spring is
    double damping;         // N m s/rad, N s/m
    double friction;        // N m, N
    double armature;        // kg m^2, kg
} RobotJoint;

// A point in which two bodies are held together.
typedef struct RobotLoop {
    char name[ROBOT_NAME_SIZE];
    int bodies[2];
    Vec3 place;
} RobotLoop;

// Two joints of which the first follows the second.
typedef struct RobotCoupling {
    char name[ROBOT_NAME_SIZE];
    int joints[2];
    double ratio;     // of the first one's speed to the second's
    bool is_straight; // whether that is all: no offset, no curve
} RobotCoupling;

// The force on a joint is gain times a control, constant, less stiffness and damping of it, for
// which the coordinate is the engine's own.
typedef struct RobotActuator {
    char name[ROBOT_NAME_SIZE];
    int joint;
    double gain;
    double constant;
    double stiffness;
    double damping;
    bool is_limited;
    double control[2];
} RobotActuator;

typedef struct Robot {
    char format[ENGINE_NAME_SIZE]; // "MJCF"
    Vec3 gravity;                  // m/s^2, acceleration of free fall
    size_t body_count;
    RobotBody *bodies; // owned, as all arrays
    size_t joint_count;
    RobotJoint *joints;
    size_t loop_count;
    RobotLoop *loops;
    size_t coupling_count;
    RobotCoupling *couplings;
    size_t actuator_count;
    RobotActuator *actuators;
    size_t left_out_count;
    char **left_out; // what the answer has no words for, a sentence each
} Robot;

// Asks a driver to read a model. Fails with ERR_FILE where the file is missing or no file, with
// ERR_CASE where it is no model of that engine, and with ERR_SOLVER where the driver cannot read
// models or goes wrong. The caller frees it with robot_finish.
bool robot_read(const EngineDriver *driver, const char *path, Robot *robot, Err *err);
void robot_finish(Robot *robot);
