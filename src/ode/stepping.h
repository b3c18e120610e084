// What all ways of stepping ODE have in common: where the driven body stands, the balance of forces
// on it, labels and messages.
#pragma once

#include "model/forces.h"
#include "model/solver.h"

// The ways of stepping, each a solver behind ODE_SOLVER, in ode/plane/NAME.c under its own name.
#define STEPPING_DECLARE(id, word, plane, ...) extern const Solver plane;
OPTIONS_ODE_STEPPING_LIST(STEPPING_DECLARE)
extern const Solver STEPPING_IMPULSE;       // where contacts are integrated within the step
extern const Solver STEPPING_IMPULSE_PARTS; // of mechanisms that share nothing but the ground

// Those of a linkage in space, in ode/space.
extern const Solver SPACE_PLAIN;
extern const Solver SPACE_STAGGERED;
extern const Solver SPACE_IMPULSE;
extern const Solver SPACE_IMPULSE_PARTS; // likewise

// What all contacts together lost in the step along the normal and in sliding, and store after it,
// J.
typedef struct ContactEnergy {
    double dissipated;
    double friction;
    double elastic;
} ContactEnergy;

// How the body of a drive (linkage_drive) moves at a time: it turns about its joint with the
// ground, exactly.
Motion stepping_driven(const Linkage *linkage, size_t drive, double time_s);

// Puts the bodies of all drives among the motions of all bodies.
void stepping_set_driven(const Linkage *linkage, double time_s, Motion *motions);

// Where the centre of a drive's body stands from its joint with the ground, m, at an angle.
typedef struct SteppingArm {
    double angle; // rad
    Vec2 arm;
} SteppingArm;

SteppingArm stepping_arm(const Linkage *linkage, size_t drive, double time_s);

// How the body of a drive moves within a step: with the acceleration that holds from its start on,
// also where the step ends at a kink of the drive's speed. From where it stands at a time nearby
// that is soon worked out.
Motion stepping_driven_since(const Linkage *linkage, size_t drive, const SteppingArm *near,
                             double from_s, double time_s);

// Where the bodies stand at the start of a run, or at most so many steps earlier: where the drive
// determines the motion, and not further back than the linkage closes. Returns how many steps.
long stepping_start(const Scenario *scenario, double step_s, long steps_back, Motion *motions);

// By joint, from the anchor on a body to where the force of an ideal joint acts, m: that of a
// prismatic joint at the anchor on its body b.
void stepping_offsets(const Linkage *linkage, const Motion *motions, int body, Vec2 *offsets);

// The force in the joint of a drive, N, and its power, W, from its body's own equations: all other
// forces on it are known. `joints` holds those forces and couples, and receives the driven joint's;
// `offsets` lead, by joint, from the body's anchor to where the force acts, m; `load` is of springs
// and dampers on the body.
double stepping_drive(const Scenario *scenario, size_t drive, const Motion *driven,
                      const BodyLoad *load, const Vec2 *offsets, JointState *joints);

// The force in the driven joint alone.
void stepping_drive_force(const Scenario *scenario, size_t drive, const Motion *driven,
                          const BodyLoad *load, JointState *joints);

// Where a step ends that would end on a tick, s: there, but not beyond the run, so that no contact
// is recorded there. What is left to its end by less than a share of a tick is no step of its own.
static const double STEPPING_ROUNDING = 1e-6;
double stepping_end(const Scenario *scenario, double start_s, double end_s, double tick_s);

// A rate on one side of a jump of loads: its derivative there, and what it has gained since the
// step began.
typedef struct SteppingRate {
    double slope;
    double gain;
} SteppingRate;

// Of a rate whose derivative is `before` up to a jump, so many s after the start of the step, and
// in the mean over the step `mean`.
SteppingRate stepping_beside_jump(double before, double mean, double jump_s, double step_s,
                                  double since_s);

// Puts time, crank angle and number of the step in front of what went wrong there; returns false.
bool stepping_fail(const Scenario *scenario, double time_s, size_t step, double step_s, Err *err);

// The label of a way of stepping, such as "ode direct/plain/textbook", with the collider behind it
// unless it is the exact one; a map that does not matter is NULL.
void stepping_label(const Scenario *scenario, const char *stepping, const char *map,
                    char label[TRAJECTORY_LABEL_SIZE]);

// Where a block is in its guides, or the slider of a prismatic joint on its line: eccentricity and
// tilt.
void stepping_observe_line(const Linkage *linkage, int joint, const Motion *motions,
                           JointState *state);

// Where the limited coordinate of a pivot or of gears is: tilt, or the first part of the
// eccentricity.
void stepping_observe_coordinate(const Linkage *linkage, int joint, const Motion *motions,
                                 JointState *state);

// Where a joint stands in a sample whose bodies are filled in; its forces stay.
void stepping_observe_joint(const Linkage *linkage, size_t joint, Sample *sample);
