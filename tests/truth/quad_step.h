// One step of Gauss collocation of a mechanism whose contacts keep their modes.
#pragma once

#include "quad_gauss.h"
#include "quad_mechanism.h"

// How the time of a step of length h lies over x = 0 .. 1.
typedef enum QuadMap {
    QUAD_MAP_PLAIN, // t = t0 + h x
    QUAD_MAP_ONSET, // t = t0 + h x^2: the root of the time since an onset of contact
    QUAD_MAP_END,   // t = t0 + h (2 x - x^2): the root of the time to an end of contact
    QUAD_MAP_COUNT,
} QuadMap;

typedef Quad QuadCoordinates[QUAD_COORDINATE_MAX];

typedef struct QuadStep {
    const QuadProblem *problem;
    size_t size;           // coordinates
    QuadCoordinates lever; // 1 or m: makes a length of each coordinate
    QuadGauss gauss;
    Quad tolerance; // m/s
    // the start, set by the caller
    QuadContacts contacts;
    Quad start_s;
    QuadCoordinates start_position;
    QuadCoordinates start_velocity;
    // the solution
    QuadMap map;
    Quad length_s;
    Quad rate[QUAD_GAUSS_NODES]; // dt/dx, s
    QuadCoordinates position[QUAD_GAUSS_NODES];
    QuadCoordinates velocity[QUAD_GAUSS_NODES];
    QuadCoordinates acceleration[QUAD_GAUSS_NODES];
    QuadCoordinates end_position;
    QuadCoordinates end_velocity;
    Quad tail;          // m/s, estimate of the error of a velocity
    size_t solves;      // so far
    size_t evaluations; // of the accelerations, so far
} QuadStep;

// Makes the nodes; the start is then the caller's to set.
void quad_step_init(QuadStep *step, const QuadProblem *problem, Quad tolerance);

// Solves the step's equations from its start. Returns false where substitution does not settle,
// which a shorter step will.
bool quad_step_solve(QuadStep *step, QuadMap map, Quad length_s);

// The time at a place of the solved step, and the place of a time.
Quad quad_step_time(const QuadStep *step, Quad x);
Quad quad_step_place(const QuadStep *step, Quad time_s);

// The state at a place of the solved step.
void quad_step_state(const QuadStep *step, Quad x, Quad *position, Quad *velocity);
