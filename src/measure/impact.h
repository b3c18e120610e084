// One impact of a lone pin on the wall of its hole, or of a corner or stop on its line: what is
// asked of it, what ODE is predicted to deliver, and what it delivers when it is run.
#pragma once

#include "contact/map_impact.h"
#include "model/scenario.h"

// A number over the accident of where the steps fall.
typedef struct ImpactSpread {
    double mean;
    double least;
    double most;
} ImpactSpread;

// What an impact gives, over MAP_IMPACT_PHASES phases.
typedef struct ImpactFigures {
    ImpactSpread restitution;     // 1
    ImpactSpread force_max;       // N
    ImpactSpread penetration_max; // m
    ImpactSpread duration;        // s, of the overlap
    size_t fallbacks;             // rows of all phases where the map would not have been stable
    double omega_h_max;           // 1, predicted, over the steps of all phases
    double omega_h_depth;         // m, where that was
    bool is_past_end;             // in some phase the pin goes past the end of the law
    double past_end_depth;        // m, how deep it is there
    bool is_too_fine;             // more steps than are tried: nothing else is known
    bool is_ended;                // in every phase
} ImpactFigures;

// Figures without any spread: those of the law itself.
ImpactFigures impact_figures_of(const MapImpact *impact);

// Adds one phase, counted from 0, to figures that begin zeroed but for is_ended.
void impact_add_phase(ImpactFigures *figures, int number, const MapImpact *impact);

// What ODE is predicted to deliver, from the contact row alone.
ImpactFigures impact_predict(const MapImpactCase *impact);

// What a run in ODE delivered.
typedef struct ImpactDelivered {
    bool is_measured;
    char message[ERR_TEXT_SIZE]; // why it could not be
    ImpactFigures figures;
} ImpactDelivered;

// Runs a lone pin of a mass, kg, in the hole of a joint of the scenario, or a lone body against a
// wall where the joint is no pin in a hole, without gravity, at a closing speed, m/s, and the
// scenario's own step, contact and map, over all phases. `contact_s` is the longest that the
// contact is expected to last, s. Nothing is measured, and the message says why, where a step takes
// the pin across the hole, a run would be too long or failed, or had another number of contacts
// than one.
ImpactDelivered impact_deliver(const Scenario *scenario, int joint, double mass, double speed,
                               double contact_s);
