// The contact as MuJoCo's solref and solimp can have it.
#pragma once

#include "base/text.h"
#include "commands/tune/tune_report.h"

typedef struct TuneMujoco {
    double weight;    // A, 1/kg: the inverse mass that MuJoCo takes, of the two bodies as free ones
    double impedance; // d, 1
    double solref[2]; // -stiffness, 1/s^2, and -damping, 1/s
    double stiffness; // N/m, of the contact
    double damping;   // N s/m
    double step_s;    // s: MuJoCo's contact is explicit, so that it may need a finer one than ODE's
} TuneMujoco;

// False where there is none: no joint has play, or no linear contact is stable.
bool tune_mujoco_find(const TuneReport *report, TuneMujoco *mujoco);

// Whether a step that is held is too long for MuJoCo with these constants.
bool tune_mujoco_is_finer(const TuneReport *report, const TuneMujoco *mujoco);

// Appends the fragment of MJCF, or nothing where there is none.
void tune_mujoco_write(const TuneReport *report, Text *text);
