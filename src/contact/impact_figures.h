// Impacts of a mass on ODE's contact row wherever the steps fall: what they give, whether that is
// what the law asks for, and up to which step it is.
#pragma once

#include "contact/map_impact.h"

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

// Whether a number is what is asked for, to a share of it. Of a restitution, which may be 0, the
// share is of no less than the share itself.
bool impact_is_near(double value, double asked, double share);
bool impact_is_restitution_near(double value, double asked, double share);

// Whether the restitution is what the law asks for in every phase; and whether peak force and depth
// are, too.
bool impact_bounces_right(const ImpactFigures *figures, const MapImpact *asked, double share);
bool impact_is_right(const ImpactFigures *figures, const MapImpact *asked, double share);

// With fewer steps in the length of the undamped contact none need come near the peak: omega h is
// pi / 2 and more.
extern const double IMPACT_COARSE_STEPS;

// The longest step, s, from which on steps are valid, by trying them from IMPACT_COARSE_STEPS to
// the length of the undamped contact, s, downwards; 0 where none is found.
typedef bool (*ImpactStepCheck)(double step_s, const void *context);
double impact_longest_step(double contact_s, ImpactStepCheck is_valid, const void *context);
