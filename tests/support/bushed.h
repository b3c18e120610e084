// Mechanisms of links, pins and bushings, and how they move: by an integration that shares nothing
// with the program, in the coordinates of all bodies.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum {
    BUSHED_BODIES = 4,
    BUSHED_PINS = 4,
    BUSHED_MOUNTS = 6,
    BUSHED_POINTS = 8,
    BUSHED_GROUND = -1
};

typedef struct BushedBody {
    double mass;     // kg
    double inertia;  // kg m^2
    double state[6]; // x, y, angle and their rates at time zero
} BushedBody;

typedef struct BushedPin {
    int bodies[2];
    double at[2]; // m, in the world at time zero
} BushedPin;

typedef struct BushedMount {
    int bodies[2];
    double at[2][2];     // m, in the world at time zero, on either body
    double direction;    // rad, of its x axis in the world at time zero
    double stiffness[3]; // along x, along y, by angle
    double damping[3];
    size_t points[3]; // of the curve in place of a stiffness; 0: none
    double over[3][BUSHED_POINTS];
    double pull[3][BUSHED_POINTS];
    bool is_smooth;
    bool has_angle;
    double angle; // rad, where it is relaxed, where the case says so
} BushedMount;

typedef struct Bushed {
    size_t body_count;
    BushedBody bodies[BUSHED_BODIES];
    size_t pin_count;
    BushedPin pins[BUSHED_PINS];
    size_t mount_count;
    BushedMount mounts[BUSHED_MOUNTS];
    double gravity; // m/s^2, downwards
    double driven;  // rad/s, of body 0 about pin 0; 0: it is free
    double end_s;
} Bushed;

// A mechanism of a seed.
Bushed bushed_random(unsigned seed);

// Writes it as a case, with samples; the text is to be freed.
char *bushed_case(const Bushed *bushed);

typedef struct BushedTruth {
    double states[6 * BUSHED_BODIES]; // of all bodies at the end, as above
    double fastest;                   // m/s, of any centre of mass on the way
    double turning;                   // rad/s, likewise of any body
} BushedTruth;

// Moves it to its end. False where it does not get there.
bool bushed_integrate(const Bushed *bushed, BushedTruth *truth);

// The largest difference of states from the truth: positions over 1 m and 1 rad, speeds over the
// fastest on the way.
double bushed_apart(const Bushed *bushed, const double *states, const BushedTruth *truth);
