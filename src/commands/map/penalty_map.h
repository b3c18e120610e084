// The paper's penalty parameter as rows of ODE, read both ways it can be, beside its approach.
#pragma once

#include "measure/mapping.h"
#include "measure/printed.h"

// One of the paper's speeds.
typedef struct PenaltyMapRow {
    double rpm;
    double force;    // N, Table I
    double printed;  // N, Table II: P
    double approach; // m, Table III
    double mass;     // kg, of the joint's contacts
    double speed;    // m/s, likewise: median closing speed of the reference's run at this speed
    // read as a stiffness in N/mm, with the viscous damper of the restitution asked for
    Scenario turned; // owned: the case at this speed
    MappingContact stiffness;
    ErpCfm soft;               // of it at the step, by the case's map
    double rest_depth;         // m, force / stiffness
    ImpactDelivered by_spring; // what the engine delivered
    // read as a velocity-level penalty in N s/mm
    double cfm;                 // m/(N s)
    ImpactDelivered by_penalty; // what the engine delivered
} PenaltyMapRow;

typedef struct PenaltyMap {
    PrintedPin pin;
    OdeMap map;    // of the readings as a stiffness
    double step_s; // of all rows
    PenaltyMapRow rows[PRINTED_SPEED_COUNT];
} PenaltyMap;

// Whether a scenario has one of the paper's two pins with play, driven; its number if so.
bool penalty_map_fits(const Scenario *scenario, PrintedPin *pin);

// Works out all rows at a step, s. The map is for penalty_map_destroy. Fails with ERR_CASE where
// the scenario does not fit, with ERR_SOLVER where the reference fails at one of the speeds or
// there is no contact at one.
bool penalty_map_make(const Scenario *scenario, double step_s, RunWatch watch, PenaltyMap **map,
                      Err *err);

// Accepts NULL.
void penalty_map_destroy(PenaltyMap *map);
