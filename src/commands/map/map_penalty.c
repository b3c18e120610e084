// Converts the paper's penalty parameter P to ODE, and shows how deep pins go with it.
#include "commands/map/map.h"
#include "contact/damping.h"
#include "measure/estimate.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// The paper's penalty parameter P as ODE has it, and how deep pins go with it.
//
// P (Table II) is K_c C^e, printed without a unit; its two uses give it one:
//   a stiffness, N/mm              k = P, F = k d; ERP and CFM by the case's map, with the viscous
//                                  damper c = 2 zeta sqrt(k m) of the case's restitution
//   a velocity-level penalty,      F = p d', Eq. (2): CFM = 1 / p, bounce e
//   N s/mm
// Each is run in ODE as a single pin at the mass and the closing speed that the reference finds at
// that speed of the crank. The approach of Table III is static, at the force of Table I; beside it
// stands F / k, the depth at which the stiffness would carry that force.

static const double RAD_PER_S_PER_RPM = 3.14159265358979323846 / 30.0;
static const double M_PER_UM = 1e-6;
static const double MM_PER_M = 1e3;

enum { TABLE_FORCE, TABLE_PENALTY, TABLE_APPROACH };

bool penalty_map_fits(const Scenario *scenario, PrintedPin *pin)
{
    for (int i = 0; i < PRINTED_PIN_COUNT && drive_is_steady(&scenario->linkage.driver); i++) {
        const int joint = linkage_find_joint(&scenario->linkage, PRINTED_PIN_NAMES[i]);
        if (joint >= 0 && joint_has_hole(scenario->linkage.joints[joint].kind)) {
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
    driver->table.count = 0;
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

static bool map_penalty_fill_row(const Scenario *scenario, const PenaltyMap *map,
                                 PenaltyMapRow *row, Err *err)
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
        if (!map_penalty_fill_row(scenario, made, row, err)) {
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

// The text and the JSON.

// Of the readings as a stiffness and as a penalty: columns of their own.
enum {
    STIFFNESS = FIELD_OWN,
    PENALTY = FIELD_OWN << 1,
    TABLES = STIFFNESS | PENALTY,
};

static const void *map_penalty_asked_of(const void *record)
{
    return &((const PenaltyMapRow *)record)->stiffness.asked;
}

#define ROW(member)    .offset = offsetof(PenaltyMapRow, member)
#define FIGURE(member) .offset = offsetof(ImpactFigures, member)

// clang-format off
static const Field SHOWN_FIELDS[] = {
    {NULL, FIELD_NUMBER, TABLES, "delivered", "um", "%.4g", FIGURE(penetration_max.mean)},
    {NULL, FIELD_NUMBER, TABLES, "restitution", "delivered", "%.4g", FIGURE(restitution.mean)},
    {0},
};
static const Field ROW_FIELDS[] = {
    {"speed_rpm", FIELD_NUMBER, FIELD_JSON | TABLES, "speed", "rpm", "%.0f", ROW(rpm),
     .per_si = 1.0},
    {"force_N", FIELD_NUMBER, FIELD_JSON | STIFFNESS, "F, Table I", "N", "%.4g", ROW(force)},
    {"penalty_printed_N", FIELD_NUMBER, FIELD_JSON | STIFFNESS, "P, Table II", "N/mm", "%.2f",
     ROW(printed)},
    {NULL, FIELD_NUMBER, PENALTY, "P, Table II", "N s/mm", "%.2f", ROW(printed)},
    {"approach_m", FIELD_NUMBER, FIELD_JSON, ROW(approach)},
    {"mass_kg", FIELD_NUMBER, FIELD_JSON, ROW(mass)},
    {"speed_m_s", FIELD_NUMBER, FIELD_JSON, ROW(speed)},
    {"stiffness_N_m", FIELD_NUMBER, FIELD_JSON, ROW(stiffness.secant)},
    {"damping_N_s_m", FIELD_NUMBER, FIELD_JSON, ROW(stiffness.damping)},
    {"erp", FIELD_NUMBER, FIELD_JSON | STIFFNESS, "ERP", "1", "%.4g", ROW(soft.erp)},
    {"cfm_m_N_s", FIELD_NUMBER, FIELD_JSON | STIFFNESS, "CFM", "1/(N s/m)", "%.4g", ROW(soft.cfm)},
    {NULL, FIELD_NUMBER, PENALTY, "CFM", "1/(N s/m)", "%.4g", ROW(cfm)},
    {NULL, FIELD_NUMBER, TABLES, "impact", "m/s", "%.4g", ROW(speed)},
    {NULL, FIELD_NUMBER, TABLES, "Table III", "um", "%.4f", ROW(approach)},
    {"rest_depth_m", FIELD_NUMBER, FIELD_JSON | STIFFNESS, "F / P", "um", "%.4g", ROW(rest_depth)},
    {"asked", FIELD_PART, FIELD_JSON, .of = ASKED_FIELDS, .part = map_penalty_asked_of},
    {"delivered_as_stiffness", FIELD_GROUP, FIELD_JSON, ROW(by_spring), .of = DELIVERED_FIELDS},
    {"penalty_cfm_m_N_s", FIELD_NUMBER, FIELD_JSON, ROW(cfm)},
    {"delivered_as_penalty", FIELD_GROUP, FIELD_JSON, ROW(by_penalty), .of = DELIVERED_FIELDS},
    {NULL, FIELD_IF, STIFFNESS, ROW(by_spring.figures),
     .known = offsetof(PenaltyMapRow, by_spring.is_measured), .of = SHOWN_FIELDS},
    {NULL, FIELD_IF, PENALTY, ROW(by_penalty.figures),
     .known = offsetof(PenaltyMapRow, by_penalty.is_measured), .of = SHOWN_FIELDS},
    {0},
};
// clang-format on

json_t *mapping_penalty_json(const PenaltyMap *map)
{
    json_t *rows = json_array();
    for (int i = 0; i < PRINTED_SPEED_COUNT; i++) {
        json_array_append_new(rows, fields_json(ROW_FIELDS, FIELD_JSON, &map->rows[i]));
    }
    return json_pack("{s:s, s:s, s:f, s:o}", "joint", PRINTED_PIN_NAMES[map->pin], "map",
                     OPTIONS_ODE_MAPS[map->map], "step_s", map->step_s, "rows", rows);
}

static void map_penalty_write_table(const PenaltyMap *map, const char *heading, unsigned where,
                                    const Style *style, Text *text)
{
    Table *table = fields_table(heading, ROW_FIELDS, where, style, text);
    for (int i = 0; i < PRINTED_SPEED_COUNT; i++) {
        fields_table_row(ROW_FIELDS, where, &map->rows[i], table);
    }
    section_end(table, text);
}

void mapping_penalty_text_write(const PenaltyMap *map, const Style *style, Text *text)
{
    map_penalty_write_table(map, "The paper's P read as a stiffness", STIFFNESS, style, text);
    text_append(
        text,
        "  P in N/mm with the viscous damper of the restitution asked for, %s map, %.4g us; "
        "Table III is static, and so is F / P; delivered is the depth of an impact of "
        "the joint's effective mass.\n",
        OPTIONS_ODE_MAPS[map->map], map->step_s * UNITS_US);
    map_penalty_write_table(map, "The paper's P read as a velocity-level penalty", PENALTY, style,
                            text);
    text_append(text,
                "  F = P d', CFM = 1 / P, with ODE's bounce, %.4g us: the depth is what the pin "
                "flies in the step that finds the wall, and follows the step and not P.\n",
                map->step_s * UNITS_US);
}
