// From stiffness, damping and step to ODE's ERP and CFM, back, and what they will deliver.
//
// One contact row of ODE, with F >= 0: v_out + CFM F = (ERP / h) d, v_out the separating speed
// after the step; positions then move with the new speed.
#pragma once

#include "model/options.h"

typedef struct ErpCfm {
    double erp; // 1; ODE does not clamp a contact's soft_erp, so it may exceed 1
    double cfm; // m/(N s)
} ErpCfm;

// A contact as the map finds it at the start of a step. Not every map looks at all of it.
typedef struct MapContact {
    double stiffness; // k, N/m: force over depth
    double damping;   // c, N s/m; it or the stiffness must be > 0
    double step;      // h, s
    double mass;      // m, kg: effective along the normal
    double depth;     // d, m, > 0
    double closing;   // m/s, rate of the depth before the step
} MapContact;

typedef struct Map {
    const char *name;       // as in a case
    const char *summary;    // one line for people
    double stability_limit; // 1: omega h must stay below it; infinite where it always holds
    double stand_in_share;  // 1: of h k, the damper that stands in for none; 0 for no need
    bool needs_mass;        // whether it looks at the effective mass
    ErpCfm (*convert)(const MapContact *contact);
} Map;

// Of every map but ODE_MAP_IMPULSE, which makes no rows.
const Map *map_get(OdeMap kind);

// The spring and damper that ERP and CFM stand for when read as implicit Euler, the inverse of
// the textbook map: kp = ERP / (h CFM), N/m, kd = (1 - ERP) / CFM, N s/m. cfm > 0.
void map_invert(ErpCfm row, double step, double *stiffness, double *damping);

// The CFM, m/(N s), of the velocity-level penalty F = p d', p in N s/m > 0, may be infinite.
double map_poisson_cfm(double penalty);

// The restitution that ODE's bounce delivers beside a CFM: (e - r) / (1 + r), r = CFM m / h, from
// the one asked for, the effective mass, kg, and the step, s. Negative: the row lets the body in.
double map_bounce_delivered(double restitution, double cfm, double mass, double step);

// What one impact on ODE's contact row gives, stepped as ODE steps it.
typedef struct MapImpact {
    double restitution;     // 1; 0 where the contact had not ended in step_max steps
    double force_max;       // N
    double penetration_max; // m
    unsigned steps;         // with force or overlap
} MapImpact;

// One impact of an effective mass, kg, at a speed, m/s, on a linear spring, N/m, and damper,
// N s/m, at a step, s. first_overlap is the penetration at the first overlapping step as a share
// of speed * step, 0 to 1: the accident of where the steps fall.
MapImpact map_impact(const Map *map, double mass, double stiffness, double damping, double step,
                     double speed, double first_overlap);

// The restitution a map delivers, 1: the mean over where the first overlapping step falls.
double map_delivered_restitution(const Map *map, double mass, double stiffness, double damping,
                                 double step);
