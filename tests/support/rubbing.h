// Mechanisms whose ideal joints have friction that sticks, integrated by equations of their own: a
// truth for the reference.
//
// In coordinates of every body by itself, with a multiplier for each row of a joint; the frictions
// by repeated substitution; in steps of the classical Runge-Kutta method that end where a bristle
// begins to yield, slide or stick, or another face of a guide presses.
#pragma once

#include <stdbool.h>

enum { RUBBING_BODIES = 4, RUBBING_JOINTS = 5 };

typedef enum RubbingMode { RUBBING_STICKS, RUBBING_YIELDS, RUBBING_SLIDES } RubbingMode;

typedef struct RubbingBody {
    double mass;    // kg
    double inertia; // kg m^2
    double q[3];    // m, m, rad
    double v[3];
} RubbingBody;

typedef struct RubbingJoint {
    bool slides;
    int a; // -1: the ground
    int b;
    double at_a[2]; // m, in the bodies' frames
    double at_b[2]; //
    double along;   // rad, of a slider, in body a's frame
    double mu;      // 1
    double radius;  // m, of a pivot
    double steady;  // N m or N, instead of these
    double length;  // m, of a slider's guide; 0: none
    double bend;    // m or rad at which it slides
    double ratio;   // 1, static over sliding friction
    double speed;   // m/s or rad/s, over which that falls
    double zeta;    // 1
    bool is_driven; // of a pivot: its angle grows by:
    double drive;   // rad/s
    // what it does
    RubbingMode mode;
    double way; // 1 or -1, of what yields or slides
    int face;
    double z;       // m or rad
    double damping; // s/m or s/rad
    double force;   // N m or N, found last
    double pressed; // N m or N, that sliding holds
    double reaction[2];
} RubbingJoint;

typedef struct Rubbing {
    int body_count;
    int joint_count;
    double gravity; // m/s^2, downwards
    RubbingBody bodies[RUBBING_BODIES];
    RubbingJoint joints[RUBBING_JOINTS];
    int events;
    double lost; // J, in friction
} Rubbing;

// Brings the velocities to what the joints and the drive ask, and lets the bristles begin unbent.
void rubbing_start(Rubbing *rubbing);

// Goes on by a time, s, in steps of a length.
void rubbing_run(Rubbing *rubbing, double duration_s, double step_s);
