// What wears a pin and its hole: how far they slide on each other while they are pressed, how hard,
// what friction takes, and where on the wall.
#pragma once

#include "model/trajectory.h"

// Means over the reported time of a run that was looked into (run/wearing.h). Per revolution where
// a drive turns at constant speed, else over all of it. Numbers that a joint lacks are NAN.
typedef struct Wear {
    bool is_known;
    double friction_work;  // J, a revolution; NAN without friction
    double distance;       // m, a revolution: by which they slide while they touch
    double pressure;       // Pa: force over width times diameter of the pin, mean of the time
                           // in contact; NAN of a joint whose width is not known
    double pressure_speed; // W/m^2, mean of the whole time: pressure times sliding speed
    double angle;          // rad, from the x axis of the body with the hole: the middle of the
                           // sector that is worn most
    double share;          // 1, of all wear in that sector: 1 / WEAR_SECTORS where it is even
    double sectors[WEAR_SECTORS]; // 1, of force times sliding distance, from that axis on
} Wear;

// Whether a joint is one that this is told of: a pin in a hole.
bool wear_has(const Joint *joint);

// Unknown of another joint, of a run that feels no play or was not looked into, and of a pin that
// never touches.
Wear wear_of(const Trajectory *run, size_t joint);
