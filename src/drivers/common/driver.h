// What every driver written in C shares: the request read, samples kept and the answer written
// (docs/drivers.md). Everything is in SI units; bodies move in the plane.
#pragma once

#include "base/cam.h"
#include "base/drive.h"
#include "base/force_curve.h"
#include "base/load_table.h"
#include "base/mesh.h"
#include "kernel/contact_peaks.h"
#include "kernel/contact_state.h"
#include "kernel/force_law.h"
#include "kernel/pin_hole.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

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
    DRIVER_TOUCHING, // a guide, a stop, gears or a rack: it holds nothing, and has places
} DriverJointKind;

typedef struct DriverJoint {
    char name[DRIVER_NAME_SIZE];
    DriverJointKind kind;
    bool slides;      // whether its coordinate is the way along a line, not an angle
    int bodies[2];    // a and b; DRIVER_GROUND
    Vec2 anchors[2];  // in their frames
    double direction; // of a line, in body a's frame
    double clearance; // radial, of a pin in its hole
    ForceLaw law;     // likewise
} DriverJoint;

// How what touches at a place is shaped (docs/drivers.md).
typedef enum DriverShape {
    DRIVER_HOLE,
    DRIVER_DISC,
    DRIVER_LINE,
    DRIVER_CAM,
    DRIVER_SLOT,
    DRIVER_TURN,
    DRIVER_TEETH,
    DRIVER_RACK,
    DRIVER_SHAPE_COUNT,
} DriverShape;

// A place at which the bodies of a joint touch: a pin in its hole, a stop, a corner of a block, an
// end of a coordinate, a flank.
typedef struct DriverPlace {
    int joint;
    DriverShape shape;
    int bodies[2];      // those of the joint
    Vec2 anchors[2];    // in their frames
    double direction;   // in body a's frame: of a line's normal, across a slot, of a rack
    double clearance;   // m, rad of a turn
    double sign;        // of a coordinate at one of its ends
    double radii[2];    // m
    double half_length; // m, of a slot's middle line
    int siblings[2];    // as the kernel has them
    Cam cam;            // of a cam
    Gear gear;          // of gears, as what follows
    Profile *tables;    // owned: of a cam, or the transmission error and the relief of teeth
    double middle;      // m, in the middle of their gap
    ForceLaw law;
    ContactState contact; // under way at the start
    bool is_rub;          // whether it is the friction of an ideal joint, of which `law` has that
                          // part alone; its row is the joint's turning or sliding
} DriverPlace;

// What presses in an ideal joint that rubs. Its place has as `law.friction` the friction over that,
// m of a pivot, 1 of a slider; of a steady one all of it, N m or N.
typedef struct DriverRub {
    bool is_steady; // whatever presses
    double length;  // m, over which a slider's guide takes a couple; 0: that presses nothing
} DriverRub;

// A steady friction as a torque on the coordinate of a joint, or a force: most tanh(rate / speed);
// or one that holds, which the way `native` leaves to the engine.
typedef struct DriverDrag {
    int joint;
    bool holds;
    double most;  // N m or N
    double speed; // rad/s or m/s
} DriverDrag;

// A drive: it turns a body about its joint with the ground.
typedef struct DriverDrive {
    int body;
    int joint;
    Driver law;
} DriverDrive;

// What turns or pushes along the coordinate of a joint over time, and follows an angle:
//     M(t) + stiffness (phi_d(t) - phi) + slope (omega_d(t) - omega),  at most the limit in size
typedef struct DriverServo {
    int joint;
    TimeTable table;
    double stiffness;
    double slope;
    double limit;    // 0: none
    Driver followed; // phi_d and omega_d; both 0 where it is not present
} DriverServo;

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
    char name[DRIVER_NAME_SIZE];
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
    char name[DRIVER_NAME_SIZE];
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
    size_t place_count;  // pins in holes first, then all others; those of a joint follow each other
    DriverPlace *places; // and behind these those of ideal joints that rub
    size_t rub_count;
    DriverRub *rubs;
    size_t drag_count; // in ways that do not take rubs as contacts
    DriverDrag *drags;
    size_t servo_count;
    DriverServo *servos;
    size_t drive_count; // 0 where one drive turns at a constant speed, or none does
    DriverDrive *drives;
    bool has_drive; // whether one turns a body at a constant speed
    int driven_body;
    int drive_joint;
    double drive_speed; // rad/s
    DriverDrive steady; // likewise, as the others are
    size_t sample_count;
    double *sample_times;
} DriverCase;

// What the program is.
typedef struct DriverIdentity {
    const char *engine;
    const char *version;
    const char *precision;
    const char *const *ways; // ends in NULL
    // words of docs/drivers.md that the way `native` takes; ends in NULL
    const char *const *native_takes;
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

// What a joint that touches did in a step.
typedef struct DriverTouch {
    Vec2 eccentricity; // m, pin centre less hole centre; of others the least gap, and 0
    Vec2 force;        // N, on body b, its mean; of a torque that, and 0
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
    bool *touched;        // by joint: whether bodies can touch in it
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

// Opens what answers are written to: the program's standard output, which engines are kept from.
FILE *driver_open_answers(void);

// Say that the run failed, or what of the case the driver cannot express, and end the program.
void driver_fail(const char *format, ...) __attribute__((noreturn, format(printf, 1, 2)));
void driver_refuse(const char *format, ...) __attribute__((noreturn, format(printf, 1, 2)));

// Zeroed room for so many, and one; ends the program where there is none.
void *driver_room(size_t count, size_t size);

// Whether a joint holds its bodies without play.
static inline bool driver_is_ideal(const DriverJoint *joint)
{
    return joint->kind == DRIVER_REVOLUTE || joint->kind == DRIVER_PRISMATIC;
}

// Whether the way is that one.
bool driver_is_way(const DriverCase *of, const char *way);

// The drive that turns a body, which the engine is to prescribe; NULL: none. Of contacts within the
// step only one at a constant speed, for others are rows of the driver's (drivers/common/hold.h).
const DriverDrive *driver_drive_of(const DriverCase *of, int body);

// The drive of a joint, likewise.
const DriverDrive *driver_drive_at_joint(const DriverCase *of, size_t joint);

// The mean speed of a drive between two times, s, rad/s.
double driver_drive_mean(const DriverDrive *drive, double from_s, double to_s);

// The point of the ground about which a drive turns its body, and that point in the body's frame.
// Refuses a drive of another kind.
Vec2 driver_drive_pivot(const DriverCase *of, const DriverDrive *drive, Vec2 *on_body);

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

// A point of a body, or of the ground, and its velocity.
Vec2 driver_point(const DriverMotion *motions, int body, Vec2 local);
Vec2 driver_point_velocity(const DriverMotion *motions, int body, Vec2 local);
