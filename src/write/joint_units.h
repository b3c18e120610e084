// The units of what touches in a joint: those of forces and lengths, or where limits turn it those
// of torques and angles.
#pragma once

#include "model/linkage.h"

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
