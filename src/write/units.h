// On the way out SI becomes what people read: how many of a unit make one of SI.
//
// Units are written in ASCII, as a case file writes them, so that a number can be copied back.
#pragma once

#include "base/text.h"
#include "model/linkage.h"

#include <math.h>

static const double UNITS_DEG = 57.29577951308232; // per rad
static const double UNITS_RPM = 9.549296585513721; // per rad/s
static const double UNITS_MM = 1e3;                // per m
static const double UNITS_UM = 1e6;                // per m
static const double UNITS_MS = 1e3;                // per s
static const double UNITS_US = 1e6;                // per s
static const double UNITS_MRAD = 1e3;              // per rad
static const double UNITS_PERCENT = 1e2;           // per 1
static const double UNITS_MPA = 1e-6;              // per Pa

// How many of a unit make one of SI, by the word for it in a table: 1e3 of "ms"; 1 of SI's own and
// of any other word, and of NULL.
double units_per_si(const char *unit);

// An angle in degrees, 0 to 360. Angles that print as 360.0 are 0.
static inline double units_wrapped_deg(double angle_rad)
{
    const double turned = fmod(angle_rad * UNITS_DEG, 360.0);
    const double wrapped = turned < 0.0 ? turned + 360.0 : turned;
    return wrapped >= 359.95 ? 0.0 : wrapped;
}

// The prefix of a size, as of the largest value of an axis, and what makes it a number with it: "k"
// and 1e-3 of 28,400.
const char *units_prefix(double size, double *factor);

// Three digits with a prefix, for people: "2.36 kN", "28.4 krad/s^2". Of a number that is not
// finite a dash.
void units_append(Text *text, double value, const char *unit);

// A number that is known to lie between two others has no digit that half of that interval is
// larger than ten of, and three at most; without an interval, which is a width of 0, three. A high
// end of INFINITY leaves only the low one: "at least 3.2 kN".

// With a prefix: "3.4 kN" of 3.2 to 3.6 kN.
void units_append_within(Text *text, double value, double low, double high, const char *unit);

// The same and its interval, whose ends are rounded away from it: "3.4 kN (3.2 to 3.6)".
void units_append_interval(Text *text, double value, double low, double high, const char *unit);

// A number that moves over a range is shown with two digits at least: "2.7 kN"; and both ends of
// such a range alone, rounded away from it, with the prefix that the number has: "1.6 to 4.2".
void units_append_spread(Text *text, double value, double low, double high, const char *unit);
void units_append_ends(Text *text, double value, double low, double high);

// As a number alone, with the prefix that `units_append_within` gives another value and interval:
// the second column of a table whose first has the unit.
void units_append_beside(Text *text, double value, double low, double high, double beside,
                         double beside_low, double beside_high);

// As a number alone, without a prefix.
void units_append_digits(Text *text, double value, double low, double high);

// The units of what touches in a joint: those of forces and lengths, or where limits turn it those
// of torques and angles.

typedef struct JointUnits {
    // in keys of files, SI
    const char *force_key;
    const char *impulse_key;
    const char *length_key;
    const char *speed_key;
    // for people; units_per_si knows them
    const char *force;
    const char *impulse;
    const char *length;
    const char *speed;
    // for people, SI
    const char *mass;
    const char *rate;
    const char *stiffness;
    const char *damping;
    const char *cfm;
} JointUnits;

static inline const JointUnits *joint_units(const Joint *joint)
{
    static const JointUnits LINEAR = {
        "N", "N_s", "m", "m_s", "N", "N s", "um", "mm/s", "kg", "m/s", "N/m", "N s/m", "m/(N s)",
    };
    static const JointUnits TURNING = {
        "N_m",   "N_m_s",  "rad",   "rad_s",   "N m",       "N m s",       "mrad",
        "rad/s", "kg m^2", "rad/s", "N m/rad", "N m s/rad", "rad/(N m s)",
    };
    return linkage_is_torsional(joint) ? &TURNING : &LINEAR;
}
