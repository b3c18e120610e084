// What does the paper's penalty parameter P become in ODE, and how deep do pins go with it?
//
// P (Table II) is K_c C^e, printed without a unit; its two uses give it one:
//   a stiffness, N/mm              k = P, F = k d; ERP and CFM by the case's map, with the viscous
//                                  damper c = 2 zeta sqrt(k m) of the case's restitution
//   a velocity-level penalty,      F = p d', Eq. (2): CFM = 1 / p, bounce e
//   N s/mm
// Each is run in ODE as a lone pin at the mass and the closing speed that the reference finds at
// that speed of the crank. The approach of Table III is static, at the force of Table I; beside it
// stands F / k, the depth at which the stiffness would carry that force.
#include "commands/map/penalty_map.h"

#include "contact/damping.h"
#include "measure/estimate.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double RAD_PER_S_PER_RPM = 3.14159265358979323846 / 30.0;
static const double M_PER_UM = 1e-6;
static const double MM_PER_M = 1e3;

enum { TABLE_FORCE, TABLE_PENALTY, TABLE_APPROACH };

bool penalty_map_fits(const Scenario *scenario, PrintedPin *pin)
{
    for (int i = 0; i < PRINTED_PIN_COUNT && drive_is_steady(&scenario->linkage.driver); i++) {
        const int joint = linkage_find_joint(&scenario->linkage, PRINTED_PIN_NAMES[i]);
        if (joint >= 0 && scenario->linkage.joints[joint].kind == JOINT_CLEARANCE) {
            *pin = (PrintedPin)i;
            return true;
        }
    }
    return false;
}

// The scenario with its drive at another speed; what moves at the start moves in proportion. For
// scenario_free.
static Scenario at_speed(const Scenario *scenario, double rpm)
{
    Scenario turned = scenario_copy(scenario);
    Driver *driver = &turned.linkage.driver;
    const double ratio = rpm * RAD_PER_S_PER_RPM / fabs(driver->speed);
    driver->speed *= ratio;
    driver->speeds.count = 0;
    for (size_t i = 0; i < turned.linkage.body_count; i++) {
        Motion *start = &turned.linkage.bodies[i].start;
        start->velocity = vec2_scale(ratio, start->velocity);
        start->omega *= ratio;
        start->acceleration = vec2_scale(ratio * ratio, start->acceleration);
        start->alpha *= ratio * ratio;
    }
    return turned;
}

static bool run_spring(const Scenario *turned, const MappingJoint *joint, const PenaltyMap *map,
                       PenaltyMapRow *row, Err *err)
{
    Scenario scenario = *turned;
    ContactOptions *contact = &scenario.contact;
    const double stiffness = row->printed * MM_PER_M;
    contact->model = CONTACT_IMPACT;
    contact->stiffness = stiffness;
    contact->exponent = 1.0;
    contact->damping = DAMPING_VISCOUS;
    contact->viscous_coefficient =
        2.0 * damping_linear_ratio(contact->restitution) * sqrt(stiffness * row->mass);
    if (!mapping_contact_make(&scenario, joint, row->mass, row->speed, &row->stiffness, err)) {
        return false;
    }
    const MapContact at = {
        .stiffness = stiffness,
        .damping = contact->viscous_coefficient,
        .step = map->step_s,
        .mass = row->mass,
        .depth = row->stiffness.asked.penetration_max,
    };
    row->soft = map->map == ODE_MAP_IMPULSE ? (ErpCfm){0} : map_get(map->map)->convert(&at);
    row->rest_depth = row->force / stiffness;
    const ImpactFigures expected = mapping_predict(&row->stiffness, map->map, map->step_s);
    const Scenario ready = mapping_scenario(&row->stiffness, map->map, map->step_s);
    row->by_spring =
        impact_deliver(&ready, joint->joint, row->mass, row->speed, expected.duration.most);
    return true;
}

static bool run_penalty(const Scenario *turned, const MappingJoint *joint, const PenaltyMap *map,
                        PenaltyMapRow *row, Err *err)
{
    Scenario scenario = *turned;
    MappingContact contact;
    scenario.contact.model = CONTACT_POISSON;
    scenario.contact.penalty = penalty_velocity_level(row->printed);
    if (!mapping_contact_make(&scenario, joint, row->mass, row->speed, &contact, err)) {
        return false;
    }
    row->cfm = map_poisson_cfm(scenario.contact.penalty);
    const ImpactFigures expected = mapping_predict(&contact, ODE_MAP_TEXTBOOK, map->step_s);
    const Scenario ready = mapping_scenario(&contact, ODE_MAP_TEXTBOOK, map->step_s);
    row->by_penalty =
        impact_deliver(&ready, joint->joint, row->mass, row->speed, expected.duration.most);
    return true;
}

static bool fill_row(const Scenario *scenario, const PenaltyMap *map, PenaltyMapRow *row, Err *err)
{
    row->turned = at_speed(scenario, row->rpm);
    MappingJoint *joints = NULL;
    size_t count = 0;
    if (!mapping_joint_measure(&row->turned, (RunWatch){0}, &joints, &count, err)) {
        return false;
    }
    const int wanted = linkage_find_joint(&row->turned.linkage, PRINTED_PIN_NAMES[map->pin]);
    size_t found = 0;
    while (joints[found].joint != wanted) {
        found++;
    }
    const MappingJoint joint = joints[found];
    free(joints);
    row->mass = joint.mass_median;
    row->speed = joint.speed_median;
    if (!(row->speed > 0.0)) {
        return err_set(err, ERR_SOLVER, "no contact of %s begins with a closing speed",
                       PRINTED_PIN_NAMES[map->pin]);
    }
    return run_spring(&row->turned, &joint, map, row, err) &&
           run_penalty(&row->turned, &joint, map, row, err);
}

bool penalty_map_make(const Scenario *scenario, double step_s, RunWatch watch, PenaltyMap **map,
                      Err *err)
{
    PrintedPin pin;
    if (!penalty_map_fits(scenario, &pin)) {
        return err_set(err, ERR_CASE,
                       "--penalty is for a driven four-bar with play in its %s or %s joint, for "
                       "which the paper gives its tables",
                       PRINTED_PIN_NAMES[0], PRINTED_PIN_NAMES[1]);
    }
    PenaltyMap *made = calloc(1, sizeof *made);
    assert(made != NULL);
    made->pin = pin;
    made->map = scenario->ode.map;
    made->step_s = step_s;
    EstimateTable tables[PRINTED_TABLE_COUNT];
    const EstimateInputs inputs = estimate_inputs_printed();
    estimate_compute(&inputs, tables);
    for (int i = 0; i < PRINTED_SPEED_COUNT; i++) {
        PenaltyMapRow *row = &made->rows[i];
        row->rpm = printed_speed_rpm(i);
        row->force = tables[TABLE_FORCE].cells[i][pin].value;
        row->printed = tables[TABLE_PENALTY].cells[i][pin].value;
        row->approach = tables[TABLE_APPROACH].cells[i][pin].value * M_PER_UM;
        if (watch.progress != NULL) {
            watch.progress((double)i / PRINTED_SPEED_COUNT, 0.0, watch.context);
        }
        if (!fill_row(scenario, made, row, err)) {
            char where[48];
            snprintf(where, sizeof where, "at %.4g rpm", row->rpm);
            err_prefix(err, where);
            penalty_map_destroy(made);
            return false;
        }
    }
    *map = made;
    return true;
}

void penalty_map_destroy(PenaltyMap *map)
{
    for (int i = 0; map != NULL && i < PRINTED_SPEED_COUNT; i++) {
        scenario_free(&map->rows[i].turned);
    }
    free(map);
}
