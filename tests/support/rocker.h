// A slider-crank whose slider is the end of a rocker, however long, written down in many ways.
#pragma once

#include "model/scenario.h"

// How the case is written. None of it but the length has a part in the motion, and that hardly.
typedef struct RockerView {
    double length;       // m, from the pin to the pivot far away
    double turn;         // rad, of the whole mechanism in the ground's frame
    Vec2 shift;          // m, of the ground's origin
    double frames;       // rad, of the bodies' frames, another multiple for each
    bool in_millimetres; // and grams, in place of metres and kilograms
} RockerView;

// Crank 50 mm, rod 120 mm, 5000 rpm, no gravity, 0.5 mm of play between rod and rocker, whose mass
// is at the pin. One turn; reference and ODE.
Scenario rocker_make(RockerView view);
