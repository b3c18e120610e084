// One impact of a lone pin on the wall of its hole, or of a corner or stop on its line: what ODE
// delivers when it is run.
#pragma once

#include "contact/impact_figures.h"
#include "model/scenario.h"

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
