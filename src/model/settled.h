// The settled motion of a scenario: what is left of its start once it has turned long enough, how
// that was found, and how sure it is.
#pragma once

#include "base/drive.h"
#include "base/err.h"
#include "model/linkage.h"

#include <stdint.h>

// A number of a settled motion that each of its revolutions has one of, such as the largest force
// of a joint. Of a motion that repeats every p revolutions all of these but `mean` are the largest
// of the p.
typedef struct SettledNumber {
    double headline; // of a motion that does not repeat the 95 % quantile of its revolutions
    double low;      // its 95 % confidence interval
    double high;
    double median;
    double median_low; // its 95 % confidence interval
    double median_high;
    double largest; // of the revolutions counted
    double mean;    // of a revolution
} SettledNumber;

// What a joint does in a settled motion; nothing (zero) of one without play but the force.
typedef struct SettledJoint {
    SettledNumber force;   // N
    SettledNumber depth;   // m, the deepest penetration
    SettledNumber impacts; // contacts begun
    SettledNumber contact; // 1, the share of the time in contact
} SettledJoint;

// One that starts have come to.
typedef struct SettledMotion {
    size_t starts;        // how many of those whose motion is known
    double share_low;     // 1, the 95 % confidence interval of their share
    double share_high;    // 1
    size_t period;        // revolutions after which it repeats; 0: it does not
    double change;        // 1, over the last of them
    size_t counted;       // revolutions that its numbers are of, of all of its starts
    size_t watched;       // revolutions that each of its starts was watched for, at least
    SettledJoint *joints; // by joint; owned
    SettledNumber *alpha; // rad/s^2, by body: the largest size of its angular acceleration; owned
    SettledNumber drives[LINKAGE_DRIVE_MAX]; // N m, by drive: the largest size of its torque
    size_t section_count; // revolutions whose ends are below: those of a period, of a motion that
                          // does not repeat some of its last
    double *sections; // rad/s, of each body at the end of each: [revolution * body_count + body];
                      // owned
} SettledMotion;

enum { SETTLED_MULTIPLIERS = 8 }; // that are found at most

// How fast small changes of a state grow in a settled motion.
typedef struct SettledGrowth {
    double factor;      // 1: in a revolution, below 1 where they die out; NAN: not known
    bool is_at_most;    // they were gone before it could be told: it is not above the factor
    size_t revolutions; // that it was seen over
    // 1: by what small changes are multiplied in a period, real and imaginary part, the largest
    // first; none where only the factor was found
    size_t multiplier_count;
    double multipliers[SETTLED_MULTIPLIERS][2];
    size_t body; // number of the one that the change of the largest moves fastest, where there are
                 // multipliers
} SettledGrowth;

// How the start of a scenario was found (run/settle.h).
typedef struct SettledStart {
    size_t revolutions;   // that it took; 0: the start is as written
    bool is_pressed;      // START_PRESSED: the pins were put on their walls
    bool is_followed;     // it was found from that of a neighbour in a study
    double followed_from; // of the key that is followed, SI: the neighbour's value
    bool is_brief;        // it does not repeat, and was turned for too short a time to have
                          // numbers of its own: it is a start, and no more
    uint64_t neighbour;   // or of a block of runs: the number of the neighbour's run
    bool is_checked;      // it was also found from a neighbour's, and its forces are then apart
    double apart_from_followed; // by so much at most, 1; NAN: not known
    size_t tried;               // starts that were turned
    size_t starts;              // of them those whose motion is known
    bool is_spent;              // run.settle-budget ended the search
    double width;           // 1: of a motion that does not repeat the half width of the interval
                            // of a joint's headline, over the headline: the widest
    double *first;          // N, by joint: its largest force in the first revolution from the
                            // start as written; owned
    size_t motion_count;    // different ones
    SettledMotion *motions; // that of most starts first, which runs start in; owned
    Linkage *others; // by motion, but for the first: the linkage where it starts in it; owned, and
                     // no copy has them
    bool has_growth; // somebody has looked for the growth of small changes
    SettledGrowth growth;        // of the motion that runs start in
    char message[ERR_TEXT_SIZE]; // why there is none
} SettledStart;

// Whether another motion than that which runs start in has a joint with a larger headline, by more
// than one motion's digits; the loudest such joint, relative, and its motion.
bool settled_is_louder(const SettledStart *settled, const Linkage *linkage, size_t *motion,
                       size_t *joint);

// A copy with arrays of its own, for settled_start_free.
SettledStart settled_start_copy(const SettledStart *settled, const Linkage *linkage);

// Forgets how the start was found; the start itself stays.
void settled_start_free(SettledStart *settled);

// Frees what a motion owns.
void settled_motion_free(SettledMotion *motion);
