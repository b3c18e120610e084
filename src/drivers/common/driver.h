// What every driver written in C shares: the request read, samples kept and the answer written
// (docs/drivers.md). Everything is in SI units; bodies move in the plane.
#pragma once

#include "base/force_curve.h"
#include "base/load_table.h"
#include "kernel/contact_peaks.h"
#include "kernel/contact_state.h"
#include "kernel/force_law.h"
#include "kernel/pin_hole.h"

#include <stdbool.h>
#include <stddef.h>

enum { DRIVER_GROUND = -1, DRIVER_NAME_SIZE = 64, DRIVER_STAMPS = 4 };

// How a body moves at an instant: the centre of mass, and the angle.
typedef struct DriverMotion {
    Vec2 position;
    double angle;
    Vec2 velocity;
    double omega;
} DriverMotion;

typedef struct DriverBody {
    char name[DRIVER_NAME_SIZE];
    double mass;
    double inertia;
    DriverMotion start;
} DriverBody;

typedef enum DriverJointKind {
    DRIVER_REVOLUTE,
    DRIVER_PRISMATIC,
    DRIVER_PIN_IN_HOLE,
} DriverJointKind;

typedef struct DriverJoint {
    char name[DRIVER_NAME_SIZE];
    DriverJointKind kind;
    int bodies[2];        // a and b; DRIVER_GROUND
    Vec2 anchors[2];      // in their frames
    double direction;     // of a line, in body a's frame
    double clearance;     // radial, of a pin in its hole
    double hole_radius;   // likewise
    ForceLaw law;         // likewise
    ContactState contact; // under way at the start
} DriverJoint;

// A spring with a damper between two points; and one that turns the bodies of a joint.
typedef struct DriverSpring {
    int bodies[2];
    Vec2 anchors[2]; // in their frames
    double stiffness;
    double length; // of the relaxed spring
    double damping;
} DriverSpring;

typedef struct DriverTorsion {
    int joint;
    double stiffness;
    double angle; // of the relaxed spring
    double damping;
} DriverTorsion;

// Holds two bodies by springs and dampers along two axes, which turn with the first, and by angle.
typedef struct DriverBushing {
    int bodies[2];
    Vec2 anchors[2];      // in their frames
    double direction;     // of its x axis, in body a's frame
    double angle;         // where it is relaxed
    double stiffness[3];  // along x, along y, by angle
    double damping[3];    // likewise
    ForceCurve curves[3]; // in place of a stiffness, where they have points
} DriverBushing;

typedef enum DriverLoadKind { DRIVER_FORCE, DRIVER_TORQUE, DRIVER_ALONG } DriverLoadKind;

// A load, whose value is over time, or over the coordinate of a joint.
typedef struct DriverLoad {
    DriverLoadKind kind;
    int body; // of a force or a torque
    Vec2 anchor;
    double direction;
    bool turns_along; // with the body
    int joint;        // along whose coordinate it acts
    int over_joint;   // -1: over time
    double shift;     // the argument is that, and the coordinate or the rate times the time
    double rate;
    LoadTable table;
} DriverLoad;

typedef struct DriverCase {
    char way[DRIVER_NAME_SIZE];
    double step_s;
    double duration_s;
    bool wants_model; // as a file of the engine's own
    double record_s;  // least length of records of steps; 0: none are wanted
    Vec2 gravity;     // acceleration of free fall, m/s^2
    size_t body_count;
    DriverBody *bodies; // owned, as all arrays
    size_t joint_count;
    DriverJoint *joints;
    size_t spring_count;
    DriverSpring *springs;
    size_t torsion_count;
    DriverTorsion *torsions;
    size_t bushing_count;
    DriverBushing *bushings;
    size_t load_count;
    DriverLoad *loads;
    bool has_drive;
    int driven_body;
    int drive_joint;
    double drive_speed; // rad/s
    size_t sample_count;
    double *sample_times;
} DriverCase;

// What the program is.
typedef struct DriverIdentity {
    const char *engine;
    const char *version;
    const char *precision;
    const char *const *ways; // ends in NULL
} DriverIdentity;

// The state at a step's end, or what of it belongs to other instants.
typedef struct DriverStamp {
    double position_s; // time of positions and angles
    double velocity_s; // time of velocities
    DriverMotion *motions;
    Vec2 *forces; // on body b of each joint, at position_s
} DriverStamp;

// Totals of a joint.
typedef struct DriverTotals {
    double force_max;
    double depth_max;
    size_t begun;    // contacts
    double approach; // m/s, closing speed at which the last of them began
} DriverTotals;

// What a joint with play did in a step.
typedef struct DriverTouch {
    Vec2 eccentricity; // m, pin centre less hole centre
    Vec2 force;        // N, on body b, its mean
    double force_max;  // N
    double depth_max;  // m
    double approach;   // m/s, closing speed at which its last contact began
} DriverTouch;

// The largest of a contact in its last two steps, between them too; 0 where it has ended.
typedef struct DriverPeak {
    double force; // N
    double depth; // m
} DriverPeak;

// A run under way.
typedef struct DriverRun {
    const DriverCase *of;
    size_t sampled;                    // samples so far
    DriverMotion *motions;             // by sample and body
    Vec2 *forces;                      // by sample and joint
    DriverStamp stamps[DRIVER_STAMPS]; // oldest first
    size_t stamp_count;
    bool is_linear;       // between two stamps; else a cubic through four
    DriverTotals *totals; // by joint
    DriverTouch *touches; // room, by joint
    DriverPeak *peaks;    // by joint
    double *records;      // of steps: times, velocities of bodies, joints
    size_t record_count;
    size_t record_room;
    size_t steps;
    double began_s;
    double wall_s;
    char settings[512]; // of the engine, that are not its defaults
    const char *model;  // a file of the engine's own that has all of it; NULL: none
} DriverRun;

// Reads the request and says what the program is. Returns NULL where that was all that was asked
// for, or where the request is none: then it has said so, and *status is the program's.
DriverCase *driver_read(const DriverIdentity *identity, int *status);

// The file that the driver is asked to read as a model of its own engine, where driver_read has
// returned NULL; NULL: it is not asked for that.
const char *driver_asked_model(void);

// Writes a line of the answer, an object of jansson's.
struct json_t;
void driver_answer(const struct json_t *line);

// Say that the run failed, or what of the case the driver cannot express, and end the program.
void driver_fail(const char *format, ...) __attribute__((noreturn, format(printf, 1, 2)));
void driver_refuse(const char *format, ...) __attribute__((noreturn, format(printf, 1, 2)));

// Whether the way is that one.
bool driver_is_way(const DriverCase *of, const char *way);

// Refuses friction: of ways whose holes are the engine's own.
void driver_refuse_friction(const DriverCase *of);

// A run of no steps. The clock begins with driver_run_begin.
DriverRun driver_run_start(const DriverCase *of);
void driver_run_begin(DriverRun *run);

// Whether all samples are there; the time of the next one.
static inline bool driver_run_is_full(const DriverRun *run)
{
    return run->sampled == run->of->sample_count;
}
static inline double driver_run_next(const DriverRun *run)
{
    return run->of->sample_times[run->sampled];
}

// Room for the next sample, or the next stamp, to be filled in.
DriverMotion *driver_run_motions(DriverRun *run);
Vec2 *driver_run_forces(DriverRun *run);
void driver_run_sampled(DriverRun *run);
DriverStamp *driver_run_stamp(DriverRun *run);

// Takes in the stamp that has been filled in: makes the samples that lie between stamps, and the
// record of the step between the last two.
void driver_run_stamped(DriverRun *run);

// Records a step, or a part of one, that goes on from the last: how the bodies move at its end, and
// what the joints did, those without play passed over. Of ways that do not stamp.
void driver_run_record(DriverRun *run, double start_s, double end_s, const DriverMotion *motions,
                       const DriverTouch *touches);

// Ends the clock, writes the answer, and ends the program: what it has is given back by that.
void driver_run_write(DriverRun *run) __attribute__((noreturn));

// A pin in its hole whose law acts as a force.

// A contact, and what its pin did at the end of the step before.
typedef struct DriverContact {
    ContactState state;
    double gap_before;
    double approach_before;
    double begun_share; // of the last step, since the contact began in it; 0: it did not
    ContactPeaks peaks;
} DriverContact;

// The pin of a joint in its hole, from the motions of all bodies.
PinHole driver_pose(const DriverJoint *joint, const DriverMotion *motions);

// What a contact presses with, friction included: the force on body b at the pin's centre, on body
// a the other way at the hole's, N, and the moments on a and b beside these, N m.
typedef struct DriverPress {
    Vec2 force;
    double moments[2];
} DriverPress;

DriverPress driver_press(const DriverJoint *joint, const DriverContact *contact,
                         const PinHole *pose, const DriverMotion *motions);

// Follows a contact to the end of a step. It began where the gap was zero, and its impact speed is
// that between the speeds at both ends of the step.
void driver_follow(const DriverJoint *joint, const PinHole *pose, DriverContact *contact,
                   DriverTotals *totals);

// Notes the force of a contact that has been followed to the end of a step of a length, s: its
// largest force and depth are between the steps.
void driver_note_force(DriverRun *run, size_t joint, const PinHole *pose, double force,
                       double step_s, DriverContact *contact);

// A point of a body, or of the ground, and its velocity.
Vec2 driver_point(const DriverMotion *motions, int body, Vec2 local);
Vec2 driver_point_velocity(const DriverMotion *motions, int body, Vec2 local);
