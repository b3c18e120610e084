// One start of a mechanism on its way to the motion that is left of it, revolution by revolution.
#pragma once

#include "model/state.h"
#include "run/turn_watch.h"

enum {
    SETTLE_PERIOD_MAX = 12, // revolutions after which a motion is seen to repeat, at most
    SETTLE_RATES = 6        // of a body at a section
};

// The numbers that a revolution has: of each joint those below, then of each body the largest size
// of its angular acceleration, rad/s^2, and of each drive that of its torque, N m. Of joints
// without play they are 0.
typedef enum SettleJointNumber {
    SETTLE_FORCE,   // N, the largest
    SETTLE_DEPTH,   // m, the deepest penetration
    SETTLE_IMPACTS, // contacts begun
    SETTLE_CONTACT, // 1, the share of the time in contact
    SETTLE_JOINT_NUMBERS
} SettleJointNumber;

static inline size_t settle_joint_number(size_t joint, SettleJointNumber which)
{
    return SETTLE_JOINT_NUMBERS * joint + which;
}

static inline size_t settle_body_number(const Linkage *linkage, size_t body)
{
    return SETTLE_JOINT_NUMBERS * linkage->joint_count + body;
}

static inline size_t settle_drive_number(const Linkage *linkage, size_t drive)
{
    return settle_body_number(linkage, linkage->body_count) + drive;
}

static inline size_t settle_number_count(const Linkage *linkage)
{
    return settle_drive_number(linkage, LINKAGE_DRIVE_MAX);
}

// What happened in one revolution.
typedef struct Revolution {
    double *numbers; // as above; owned
    double *section; // velocities at its end, SETTLE_RATES of each body; owned
    bool is_loose;   // it was turned at a looser tolerance than that of the result
} Revolution;

// How far the relative motion at a joint with play has gone.
typedef struct SettleReach {
    double gap;      // m, the widest; of a joint that turns its bodies rad
    double approach; // m/s or rad/s, the fastest closing speed at which a contact began
    double slowest;  // m/s or rad/s, the slowest; 0: none began
} SettleReach;

typedef struct Settling {
    Scenario scenario;       // whose start is that of the next revolution; owned
    double fastest;          // m/s, of any point of a body at the sections so far
    size_t count;            // revolutions so far
    Revolution *revolutions; // owned
    SettleReach *reach;      // by joint, so far; owned
    RunState state;          // at the end of the last
    Sample inside;           // room for a state within a step
    size_t evaluations;
    bool is_random;   // it does not repeat, and what it does in a revolution no longer drifts
    size_t period;    // revolutions after which it repeats; 0: it has not yet
    double change;    // 1: over the last period, of sections and largest forces
    double left;      // 1: what is estimated to be still to come of it
    bool is_quick;    // its revolutions are not shown, and as loose as its motion allows
    size_t looks;     // instants of a step at which accelerations and torques are looked at, beside
                      // those of the joints' largest forces; 0: nobody asks for them
    TurnWatch *watch; // told of each revolution; NULL: nobody wants to know
    bool is_callers;  // it is turned in the thread of who asked for it
} Settling;

// Prepares a scenario whose drive has a period; it starts as the scenario does.
Settling settling_start(const Scenario *scenario);
void settling_finish(Settling *settling);

// Goes on by one revolution. Fails with ERR_SOLVER.
bool settling_turn(Settling *settling, Err *err);

// Goes on by one revolution at the reference's tolerance that suits how near it is to an earlier
// one, or as near as that (1: relative) to a motion that it may come to.
bool settling_turn_near(Settling *settling, double near, Err *err);

// Whether nothing more than a tolerance, relative, is to come of its motion: then its period is
// that.
bool settling_repeats(Settling *settling, double tolerance);

// Goes on until the motion repeats to within a tolerance, until what it does in a revolution no
// longer drifts though nothing repeats, or so many revolutions are over. Fails with ERR_SOLVER.
bool settling_run(Settling *settling, double tolerance, size_t most, Err *err);

// 1: sections and forces of one motion, from two starts that both have settled, differ by less: a
// peak's five digits
extern const double SETTLE_SAME_MOTION;

// The number of the last revolutions that count: of a motion that does not repeat all but those in
// which it may not have come to it yet.
size_t settling_counted(const Settling *settling);

// Whether its next revolution may be one of these, if it never repeats.
bool settling_may_count(const Settling *settling);

// A number in them; returns how many.
size_t settling_numbers(const Settling *settling, size_t number, double *values);

// How far the last so many revolutions of two are apart, relative, from whichever of the second's
// they are nearest; the second has as many.
double settling_apart(const Settling *a, const Settling *b, size_t period);

// The same of revolutions of the first that ended so many before its last.
double settling_were_apart(const Settling *a, size_t before, const Settling *b, size_t period);

// How far the last revolution is from that so many before it, which has to be there: the largest
// forces of its joints, relative, and the velocities at its end, over the fastest point's.
double settling_forces_change(const Settling *settling, size_t period);
double settling_section_change(const Settling *settling, size_t period);

// How near the last revolutions come to earlier ones, over a whole period: 1, relative.
double settling_return(const Settling *settling);
