// The bodies of a world that is being stepped: every one that joints lead to from a joint of ours,
// and those that were added by hand. Where they are and how they move, kept and put back.
#pragma once

#include <ode/ode.h>

#include <stdbool.h>
#include <stddef.h>

// What says how a body moves: three numbers of its velocity, three of its angular velocity.
enum { BODY_NUMBERS = 6 };

// Where a body is, how it moves and what acts on it.
typedef struct BodyMoment {
    dVector3 position;
    dQuaternion turn;
    dVector3 velocity;
    dVector3 omega;
    dVector3 force;
    dVector3 torque;
    bool is_enabled;
} BodyMoment;

// What a step leaves for the next one.
typedef struct BodyPast {
    bool is_closed;              // whether ODE's joints of the body were closed at its end
    bool has_speeds;             // whether there was one
    double speeds[BODY_NUMBERS]; // m/s, rad/s: with which it began
} BodyPast;

typedef struct BodyRecord {
    dBodyID id;
    bool is_added;      // by hand: stays known without a joint
    unsigned seen;      // the gathering that found it last
    unsigned reached;   // the one in whose step a joint of ours could move it last
    bool is_resting;    // disabled by bodies_rest
    BodyMoment kept;    // by bodies_keep
    BodyMoment found;   // as a step finds it (world/found.h)
    bool is_gyroscopic; // likewise
    // of the step before, for the gyroscopic torque
    dVector3 last_omega; // at its end
    dVector3 last_alpha;
    bool has_last;
    double opening[6]; // m and rad: what it was moved by so that ODE's joints are as open as found
    BodyPast past;
    BodyPast found_past; // as a step finds it
    bool is_gyrating;    // its gyroscopic torque is ours in the step under way
} BodyRecord;

typedef struct Bodies {
    size_t count;
    size_t reach;  // those that joints of ours can move in the step under way: the first ones
    size_t moving; // that trial steps move: all, or as far as these reach
    size_t room;
    BodyRecord *records; // owned
    size_t slot_count;   // a power of two
    size_t *slots;       // owned: by hash of a body, its number plus 1
    dBodyID *queue;      // owned: those whose joints are to be followed
    size_t queue_count;
    unsigned gathering;
} Bodies;

void bodies_finish(Bodies *bodies);

// The record of a body; NULL where it is not known.
BodyRecord *bodies_find(const Bodies *bodies, dBodyID body);

// The record of a body, new where it is not known. NULL where there is no memory.
BodyRecord *bodies_add(Bodies *bodies, dBodyID body);

// Drops what was not added by hand and follows all joints from the bodies that are left and from
// those given (NULL among them is the world itself). Returns false where there is no memory.
bool bodies_gather(Bodies *bodies, const dBodyID *seeds, size_t seed_count);

// ODE multiplies up to four of a body's numbers with each other and takes squares on the way: this
// to the sixth power is a double. What masses and inertias make of them ODE's own assertions see.
static const double BODIES_LARGEST = 1e50;

// Whether all numbers of all bodies are of a size that ODE can multiply with each other. Where they
// are not, the name of one.
bool bodies_are_in_range(const Bodies *bodies, const char **name);

// Notes how a step finds all bodies; puts them back.
void bodies_find_all(Bodies *bodies);
void bodies_put_back_all(Bodies *bodies);

// Finds the bodies that hang together, by joints and the contacts of the step, with those from
// which is looked, and puts them first. From then on trial steps read and put back these alone, and
// the others are as the first of these steps leaves them. All are taken where one of the others may
// be disabled by ODE, whose clock for that begins anew when it is enabled.
void bodies_reach_from(Bodies *bodies, dBodyID body);
void bodies_reach(Bodies *bodies);

// Disables the bodies that are not reached, so that steps leave them alone; ends that.
void bodies_rest(Bodies *bodies);
void bodies_wake(Bodies *bodies);

// Notes everything about all bodies; puts it back. Of these and the next two: of those that move.
void bodies_keep(Bodies *bodies);
void bodies_put_back(const Bodies *bodies);

// Positions alone: notes them; puts bodies back to where they were kept, and leaves velocities.
void bodies_keep_positions(Bodies *bodies);
void bodies_put_back_positions(const Bodies *bodies);

// Moves all bodies on by a time, s, along their velocities.
void bodies_drift(const Bodies *bodies, double time);

// The same from where they were kept.
void bodies_drift_kept(const Bodies *bodies, double time);

// Moves a body on by six speeds times a time or another share.
void bodies_move(dBodyID id, const double *speeds, double times);

// Likewise where it is kept.
void bodies_move_kept(BodyRecord *record, const double *speeds, double times);

// The six speeds of a body.
void bodies_read_speeds(const BodyRecord *record, double *speeds);

// Adds to them.
void bodies_add_speeds(const BodyRecord *record, const double *speeds);

// The quaternion turned on for a time, s, at an angular velocity in the world's frame.
void bodies_turn(const dReal *from, const dReal *omega, double time, dQuaternion turned);

// How many bodies ODE's world has; -1 where that cannot be found out.
long bodies_count(dWorldID world);

// Whether the world has bodies that are not known: their number, or -1 where it cannot be found
// out.
long bodies_unknown(const Bodies *bodies, dWorldID world);
