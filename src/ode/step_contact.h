// What a step of ODE with one row a contact makes of that contact: since when it touches, how its
// row gives way, how far it is beyond the map, what it lost and stores. The same of a pin or stop
// in the plane (ode/plane/contact_rows.h), of an end of an angle, and of a pin in space.
//
// Of an angle lengths are angles, forces torques and masses inertias.
#pragma once

#include "contact/law_row.h"
#include "contact/onset.h"
#include "kernel/contact_peaks.h"
#include "kernel/contact_state.h"
#include "ode/stepping.h"

// How a step finds a place.
typedef struct StepFound {
    bool touches;
    double gap;     // m, where the bodies are
    double inside;  // m, depth there, negative outside: of a polygon's side not the gap's
    double depth;   // m, of the row, where it touches
    double share;   // 1, of the step in which it overlaps
    double closing; // m/s, rate of the depth before the step
    double onset_s; // since the step's start, where it begins to touch in the step
} StepFound;

typedef struct StepContact {
    ForceLaw law;
    ContactState state; // touching: the present step has a row; of a contact that does not touch
                        // the speed is that at which it closes
    Onset onset;
    ContactPeaks peaks; // of the contact under way, where positions stand at mid-step
    StepFound found;
    double mass;       // kg, effective along the normal that it was worked out for
    double stiff_mass; // kg, with which the stiffest motion of the joint's places meets it
    bool falls_back;   // the map is not stable at this step: the row is the textbook's
    double damping;    // N s/m, of the row; not of CONTACT_POISSON
    double pressing;   // N, in the step
    double elastic;    // J, stored in the contact after the step
    double dissipated; // J, lost along the normal in the step
    double friction;   // J, lost in sliding in the step
} StepContact;

// A step and where it stands: staggered, positions are those of mid-step and speeds those of its
// start, and the onset of a contact is located between steps.
typedef struct StepKind {
    double step_s;
    bool is_staggered;
} StepKind;

// Notes how a step finds a contact: it begins, goes on or ends.
void step_contact_find(StepContact *contact, const StepFound *found, StepKind step);

// Its row by a map, once its masses are known; notes whether it had to fall back, and the damping.
ErpCfm step_contact_soft(StepContact *contact, const Map *map, double step_s);

// How a contact is after the step.
typedef struct StepAfter {
    double pressing; // N, in the step
    double depth;    // m, negative outside
    double closing;  // m/s
} StepAfter;

// Books what a contact lost along its normal and stores, by its law: the damper at the speed after
// the step, the spring at the depth after it. Where nothing presses that still overlaps, the damper
// takes all that the spring gives. What the step itself gains or loses beyond that is ODE's error
// and stays in the residual. The velocity-level model has no spring: all its work is lost.
void step_contact_book(StepContact *contact, ContactModel model, StepAfter after, StepKind step);

// Adds what it lost and stores to that of all.
void step_contact_add_energy(const StepContact *contact, ContactEnergy *sum);

// Raises the peaks of its joint to those of the contact under way.
void step_contact_raise(const StepContact *contact, JointPeak *top);
