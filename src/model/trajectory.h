// What one solver made of one scenario: the state at every sample, and what happened in between.
#pragma once

#include "model/marks.h"
#include "model/ranges.h"
#include "model/scale.h"
#include "model/scenario.h"
#include "model/signal_spikes.h"
#include "model/space.h"

#include <stdint.h>

enum { TRAJECTORY_LABEL_SIZE = 96, TRAJECTORY_SPIKE_MAX = 12 };

// One joint at one instant. Of a joint whose limits turn it (linkage_is_torsional) gap and force
// are an angle and a torque, here and in all that is made of them.
typedef struct JointState {
    Vec2 eccentricity;  // pin centre minus hole centre, m; of a prismatic joint or a block between
                        // guides: along and across the line (x along body a's direction); of gears
                        // x is their coordinate less the middle of the gap
    double tilt;        // rad, of a prismatic joint or a block between guides; of a pivot with
                        // limits its coordinate
    double gap;         // radial clearance less eccentricity, m; negative inside the metal; of a
                        // block the smallest of its corners, of a limited coordinate of its ends
    double force;       // size of the force in the joint, N; of a block the sum of its corners'; of
                        // a limited coordinate that of its ends, without what the joint holds
    Vec2 force_on_b;    // the force itself, on body b, N
    double moment_on_b; // N m, about the anchor of body b, of prismatic joints and blocks between
                        // guides: the couple that comes with the force; the torque of limits
    bool is_touching;   // pin and hole overlap (an ideal joint without limits always touches)
} JointState;

// How deep a joint is pressed, m.
static inline double joint_state_depth(const JointState *state)
{
    return state->is_touching && state->gap < 0.0 ? -state->gap : 0.0;
}

// What a joint with play has in space beside that. There `eccentricity` is that of the pin's middle
// in the world's x and y, `gap` the smaller of those at the hole's two ends, `force` the sum of
// what presses there, friction included, and `is_touching` whether an end does.
typedef struct SpaceJointState {
    Vec3 force_on_b;      // N, of all places together
    Vec3 offset;          // m, the pin's middle less the hole's
    Vec3 ends[2];         // m, the pin's axis less the centre of each end of the hole
    double end_gaps[2];   // m
    double end_forces[2]; // N
    double tilt;          // rad, between the axes of pin and hole
    double axial;         // m, of the pin's middle along the hole's axis
    double axial_force;   // N, of the collars on the pin, along the hole's axis
} SpaceJointState;

// A greatest or smallest value and when it stood.
typedef struct Extreme {
    double value;
    double time_s;
    double crank_rad; // not wrapped
} Extreme;

// What a body reaches in every step: name, signal (rad/s, rad/s^2), whether it is the largest value
// or the smallest. A closed form (solver.h, extremes) has them of its own.
// clang-format off
#define BODY_EXTREMES_LIST(member) \
    member(omega_max, omega, raise_to) \
    member(omega_min, omega, lower_to) \
    member(alpha_max, alpha, raise_to) \
    member(alpha_min, alpha, lower_to)
// clang-format on

#define BODY_EXTREMES_MEMBER(name, ...) Extreme name;

typedef struct BodyExtremes {
    BODY_EXTREMES_LIST(BODY_EXTREMES_MEMBER)
} BodyExtremes;

// One contact from its onset to its end.
typedef struct Spike {
    double onset_s;
    double crank_rad; // at the onset, not wrapped
    double duration_s;
    double force_max;       // N
    double impulse;         // N s
    double penetration_max; // m
    double approach_speed;  // m/s, closing speed at the onset
    double peak_s;          // when the force was largest
    Vec2 eccentricity;      // m, pin centre minus hole centre in the step with the largest force
} Spike;

// One contact in the list of all.
typedef struct JointSpike {
    size_t joint;
    Spike spike;
} JointSpike;

typedef struct JointExtremes {
    size_t impacts;                     // contacts begun
    Extreme force_max;                  // N
    Extreme penetration_max;            // m
    double impulse;                     // N s, over all contacts
    double contact_time;                // s
    size_t spike_count;                 // of those kept below
    Spike spikes[TRAJECTORY_SPIKE_MAX]; // the strongest by force, strongest first
    Extreme tilt_max;                   // rad, of a pin in space and of a block between guides
    // in space only
    Extreme axial_max; // m, distance of the pin's middle from the hole's along the axis
} JointExtremes;

enum { WEAR_SECTORS = 24 }; // of the wall of a hole, 15 deg each

// What slid and pressed in a pin and its hole over the reported time of a run.
typedef struct JointWear {
    double contact;               // s: while they touch
    double force;                 // N s
    double distance;              // m, by which they slide on each other while they touch
    double friction;              // J, that friction took
    double worn;                  // N m: force times sliding distance
    double sectors[WEAR_SECTORS]; // N m, of that, by where the pin presses, from the x axis of the
                                  // body with the hole on
} JointWear;

// The state at one sample. Its arrays hold as many entries as the linkage has bodies or joints; an
// assignment shares them.
typedef struct Sample {
    double time_s;
    double crank_rad;
    Motion *bodies; // in space what the plane sees of them: space_planar
    JointState *joints;
    // of a linkage in space only, else NULL
    SpaceMotion *space_bodies;
    SpaceJointState *space_joints;
} Sample;

// Room for a sample of a linkage, all zero, for sample_free; and another's contents put into one.
Sample sample_create(const Linkage *linkage);
void sample_free(Sample *sample);
void sample_copy(const Linkage *linkage, const Sample *from, Sample *to);

// Where the energy of a run went, J.
typedef struct Energy {
    double drive_work; // done by the drive
    double load_work;  // done by loads
    double dissipated; // in the contacts' damping
    double friction;   // in the contacts' friction
    double change;     // of kinetic, potential and elastic energy from start to end
    double residual;   // works less all of the others: zero but for the solver's error
} Energy;

enum { TRAJECTORY_TEXT_SIZE = 64, TRAJECTORY_SETTINGS_SIZE = 512 };

// What another engine said of itself in a run; empty of a solver of our own.
typedef struct TrajectoryEngine {
    char name[TRAJECTORY_TEXT_SIZE]; // "MuJoCo"
    char version[TRAJECTORY_TEXT_SIZE];
    char precision[TRAJECTORY_TEXT_SIZE];    // "double"
    char way[TRAJECTORY_TEXT_SIZE];          // in which it ran the case
    char settings[TRAJECTORY_SETTINGS_SIZE]; // of the engine, that are not its defaults
} TrajectoryEngine;

typedef struct Trajectory {
    char backend[LINKAGE_NAME_SIZE];
    char label[TRAJECTORY_LABEL_SIZE]; // backend and scheme, e.g. "ode direct/plain/textbook"
    bool is_complete;                  // false: the run failed, and only `message` is to be used
    char message[ERR_TEXT_SIZE];       // why it failed
    size_t body_count;
    size_t joint_count;
    double *reach;    // m, of each body's points from its centre: linkage_reach; owned
    ScaleFloor floor; // the least that its numbers are measured in
    Linkage linkage;  // what moved; owned
    size_t sample_count;
    double *times;              // s, by sample; owned, like the three below
    double *crank_angles;       // rad, by sample, not wrapped
    Motion *motions;            // [sample * body_count + body]
    JointState *states;         // [sample * joint_count + joint]
    SpaceMotion *space_motions; // likewise, of a linkage in space; else NULL, like the next
    SpaceJointState *space_states;
    size_t parts;          // stretches of the ranges in a sample interval
    Ranges ranges;         // between the samples, from every step; empty where not asked for
    BodyExtremes *bodies;  // by body; owned, like the three below
    JointExtremes *joints; // by joint
    size_t contact_count;  // all reported ones, in the order of their ends, where they are kept
    size_t contact_room;
    JointSpike *contacts; // owned; NULL unless run.keeps_contacts
    size_t marked_count;
    MarkedContact *marked; // owned; by joint and time; NULL unless run.keeps_marks
    JointWear *wear;       // by joint; owned; NULL where nobody looked into the run's steps
    SignalSpikes *alpha_spikes;
    SignalSpikes *force_spikes;
    double duration_s;    // simulated
    double report_from_s; // extremes, contacts and spikes are those from this time on
    Energy energy;
    TrajectoryEngine engine;
    double step_s;          // 0 where the solver has no fixed step
    size_t steps;           // every step taken, settling and rejected ones included
    double stepped_s;       // that they took: duration_s, or more where another engine had gone on
    size_t evaluations;     // of the equations of motion, where the solver counts them
    double wall_s;          // spent in the stepping loop
    size_t constraint_rows; // of the ideal joints, where the solver builds rows
    size_t contact_rows;    // most at any one step; of the reference its joints with play
    size_t fallback_rows;   // of contacts, where the map asked for would not have been stable
    size_t trials;          // made to choose the step for a tolerance, this run included; else 0
    double error_estimate;  // 1: an upper bound, where the step was chosen; else 0
    double estimate_s;      // s, up to which it holds
    bool estimate_is_cut;   // the reference is too uncertain after that for the error wanted
    bool is_short;          // that is less than was asked for: the trials had no more steps
    double wanted_s;        // s of processor time that a run for the tolerance would take, where
                            // run.budget did not allow it; else 0
    uint64_t hash;          // of every step's velocities, accelerations and joint forces
} Trajectory;

// An empty trajectory with room for the scenario's samples. Without the memory for them it has
// none, and a message that says so.
Trajectory *trajectory_create(const Scenario *scenario, const char *backend);

// One with room for times and the bodies' motions alone (trajectory_store_motion).
Trajectory *trajectory_create_motion(const Scenario *scenario, const char *backend);
void trajectory_destroy(Trajectory *trajectory);

// Puts a sample into its place in the trajectory.
void trajectory_store(Trajectory *trajectory, size_t sample_index, const Sample *sample);

// The same of its time and the bodies' motions alone.
void trajectory_store_motion(Trajectory *trajectory, size_t sample_index, const Sample *sample);

// Gives the trajectory ranges: one or more stretches a sample interval. Without the memory for them
// it has none, and no samples, and a message that says so.
void trajectory_keep_ranges(Trajectory *trajectory, const Scenario *scenario);

// What a signal of a body or joint did from a sample to the next, or to the end of the run. Where
// no ranges are kept the samples at both ends say it.
Range trajectory_body_range(const Trajectory *trajectory, size_t sample, size_t body,
                            RangesOfBody which);
Range trajectory_joint_range(const Trajectory *trajectory, size_t sample, size_t joint,
                             RangesOfJoint which);

// The share of the reported time in which a joint is in contact.
double trajectory_contact_share(const Trajectory *trajectory, size_t joint);

// The state of one body or joint at one sample.
static inline const Motion *trajectory_motion(const Trajectory *trajectory, size_t sample,
                                              size_t body)
{
    return trajectory->motions + sample * trajectory->body_count + body;
}

static inline const JointState *trajectory_state(const Trajectory *trajectory, size_t sample,
                                                 size_t joint)
{
    return trajectory->states + sample * trajectory->joint_count + joint;
}

static inline const SpaceMotion *trajectory_space_motion(const Trajectory *trajectory,
                                                         size_t sample, size_t body)
{
    return trajectory->space_motions + sample * trajectory->body_count + body;
}

static inline const SpaceJointState *trajectory_space_state(const Trajectory *trajectory,
                                                            size_t sample, size_t joint)
{
    return trajectory->space_states + sample * trajectory->joint_count + joint;
}

// Whether the run let the play of a joint happen: it is complete, the joint has play, and the
// solver is not the closed form, which takes every joint as ideal.
bool trajectory_feels_play(const Trajectory *trajectory, const Joint *joint);

// The angle of a body, or of the ground, at any time, rad, between the samples around it.
double trajectory_angle_at(const Trajectory *trajectory, int body, double time_s);

// Largest |omega| of one body over the samples, rad/s.
double trajectory_omega_scale(const Trajectory *trajectory, size_t body);
