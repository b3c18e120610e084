// The forces between pins and holes in an encounter, and the nodes that it leaves behind: what
// contact/encounter_run.c is made of.
#pragma once

#include "contact/encounter_motion.h"

// How a joint that touches is at a point: its pose, how fast its rows go, what its spring presses
// with, N, and how fast that grows with the depth, N/m.
typedef struct EncounterTouch {
    PinHole pose;
    double speed[ENCOUNTER_ROWS_MOST];
    double elastic;
    double tangent;
} EncounterTouch;

enum { ENCOUNTER_ERRORS = 5 };

// What a step works with, by row and by joint.
typedef struct EncounterWork {
    EncounterPoint ends[2]; // of a local step
    EncounterPoint inside;  // the points of an explicit step
    EncounterPoint last;    // which forces that are asked for by themselves take as well
    EncounterPoint trial;   // where a depth is looked at
    EncounterTouch *touching;
    double *forces;
    double *positions; // of rows that are worked out together
    double *speeds;
    double *errors[ENCOUNTER_ERRORS]; // of an implicit step
    double *crossings_s;              // when joints' depths are zero
    bool *has_event;                  // whether a contact begins or ends at the end of a local step
} EncounterWork;

// Moments, here and below, are by row the integrals of the impulses and then those of the
// integrals.

// Writes the forces in all rows, and the powers lost in damping and in friction.
void encounter_force_find(Encounter *encounter, double time_s, const double *impulse,
                          const double *moment, double *force, double powers[2]);

// The same at a point, and how the joints are that touch, by joint.
void encounter_force_find_touching(Encounter *encounter, const EncounterPoint *point, double *force,
                                   double powers[2], EncounterTouch *touching);

// How fast the damping of a contact at a depth takes up its closing speed, 1/s.
double encounter_force_decay(const Encounter *encounter, size_t joint, Vec2 normal, double depth);

// The frequency of a contact at a depth, rad/s.
double encounter_force_frequency(const Encounter *encounter, size_t joint, Vec2 normal,
                                 double depth);

// The time in which friction takes hold of what slides in a joint, s, under the forces given.
double encounter_force_friction_time(const Encounter *encounter, size_t joint, const double *force);

// Forgets the nodes of the step before, and gives back room that it alone needed.
void encounter_nodes_begin(Encounter *encounter);

// Adds a node.
void encounter_nodes_add(Encounter *encounter, const EncounterPoint *point);

// Gives the first node the forces at the start that the first step, an implicit one, has found.
void encounter_nodes_settle(Encounter *encounter);
