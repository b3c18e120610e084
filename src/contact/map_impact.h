// One impact of a mass on ODE's contact row, stepped as ODE steps it, and on the law itself.
#pragma once

#include "contact/map.h"
#include "kernel/force_law.h"

// How ODE is to make its rows.
typedef struct MapImpactRows {
    const Map *map;      // NULL: the velocity-level rows of CONTACT_POISSON
    double cfm;          // m/(N s), of those, like the next three
    double push_out;     // 1, their ERP
    double restitution;  // 1, of ODE's bounce
    double bounce_speed; // m/s, below which nothing bounces
} MapImpactRows;

typedef struct MapImpactCase {
    ForceLaw law;
    double mass;      // kg, effective along the normal
    double speed;     // m/s, closing, > 0
    double step;      // s; of the law itself it is not looked at
    double end;       // m: the depth beyond which the law means nothing; 0 where it has no end
    size_t step_most; // of the row; 0 for as many as anyone would wait for
    MapImpactRows rows;
} MapImpactCase;

// What one impact gives.
typedef struct MapImpact {
    double restitution;     // 1: speed after it over speed before
    double force_max;       // N
    double penetration_max; // m
    double duration;        // s, from the first overlap to the last
    size_t steps;           // with overlap
    size_t fallbacks;       // of those, beyond the map's limit: their row was the textbook's
    double omega_h_max;     // 1, over the steps; 0 where no map was used
    double omega_h_depth;   // m, where that was
    bool is_past_end;       // the pin went past the end of the law, and the rest is not known
    bool is_ended; // false: it is past the end, or goes on for longer than anyone would wait
} MapImpact;

// The impact in ODE. first_overlap is the penetration at the first overlapping step as a share of
// speed * step, 0 to 1: the accident of where the steps fall. As ODE's contact rows (ode/
// contact_rows.c) do it: the secant stiffness and the damping at the depth of each step; beyond the
// map's limit of stability the textbook's row.
MapImpact map_impact(const MapImpactCase *impact, double first_overlap);

// The impact on the continuous law, integrated to about 1e-7 of each number. Not ended where the
// law has no force for such an impact.
MapImpact map_impact_law(const MapImpactCase *impact);

// The depth, m, at which a law has taken up all of an impact's energy without damping; NaN where it
// cannot.
double map_impact_depth(const MapImpactCase *impact);

// A linear spring, N/m, and damper, N s/m, as a law.
ForceLaw map_impact_linear(double stiffness, double damping);

// The phases over which means are taken, at the middles of equal intervals of first_overlap.
enum { MAP_IMPACT_PHASES = 16 };
double map_impact_phase(int number);

// The restitution a map delivers on a linear spring, N/m, and damper, N s/m, at a step, s, 1: the
// mean over the phases.
double map_delivered_restitution(const Map *map, double mass, double stiffness, double damping,
                                 double step);
