// The contact as Gazebo's constants can have it.
#pragma once

#include "base/text.h"
#include "commands/tune/tune_report.h"

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
