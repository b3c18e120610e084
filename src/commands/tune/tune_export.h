// Where else a setting can go: C code, a loop of one's own, Gazebo, MuJoCo.
#pragma once

#include "commands/tune/tune.h"

// The setting to hand on: the cheapest that meets the error, or what comes nearest to it; NULL
// where no run has an error.
const TuneTrial *tune_export_trial(const TuneReport *report);

// The setting for a loop that steps plainly with ERP and CFM alone: the cheapest that meets the
// error, or the best at the step that is held; NULL where there is none.
const TuneTrial *tune_export_plain(const Tune *tune);

// Appends the C program of that setting against libjointplay. Fails with ERR_CASE where a law does
// not fit its joint.
bool tune_export_code(const TuneReport *report, Text *text, Err *err);

// Why there is no program of that setting against libjointplay; NULL where there is one.
const char *tune_export_lacks(const TuneReport *report);

// Why there is none of any setting of a case in the plane, or NULL.
const char *tune_export_lacks_case(const Scenario *scenario);

// Whether --code would write a program: there is a setting, in the plane, that the library has.
bool tune_export_is_writable(const TuneReport *report);

// The settings, by the numbers of their trials, with which a program could be written: those that
// meet the error, the cheapest first, or else the one to hand on. Returns how many there are.
size_t tune_export_trials(const TuneReport *report, int trials[SCHEME_MAX]);

// The scenario of the setting of a trial, its step chosen where it is chosen for a tolerance.
// ERR_SOLVER where none can be.
bool tune_export_scenario(const TuneReport *report, int trial, Scenario *scenario, Err *err);

// For people, one section each.
void tune_export_write(const TuneReport *report, const Style *style, Text *text);

// Appends C lines for the plain setting of a trial: the surface of a contact of each joint with
// play, worked out anew at each step, and the loop. Returns false, with nothing appended, where the
// law does not fit a joint.
bool tune_snippet_write(const TuneReport *report, const TuneTrial *trial, Text *text);

// What a surface and the world have to say for the linear contact that was chosen. Gazebo combines
// two surfaces: springs one behind the other, dampers side by side.
typedef struct TuneGazebo {
    double kp;        // N/m, of each of the two surfaces
    double kd;        // N s/m, of each
    double soft_erp;  // 1, that Gazebo makes of both at that step
    double soft_cfm;  // m/(N s)
    double min_depth; // m
    double max_vel;   // m/s
    double step_s;
    double error; // 1, measured with ODE at these constants against the law itself
} TuneGazebo;

// False where there is none: no joint has play, or no step was stable.
bool tune_gazebo_find(const Tune *tune, TuneGazebo *gazebo);

// Appends the fragment of SDF, or nothing where there is none.
void tune_gazebo_write(const TuneReport *report, Text *text);

// The same of a whole world with the mechanism, where SDF can say it; else the fragment, with why.
void tune_gazebo_write_world(const TuneReport *report, Text *text);

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
