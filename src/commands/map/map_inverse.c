// Converts an ERP and a CFM to the spring, damper and restitution that they are.
#include "commands/map/map.h"
#include "contact/damping.h"
#include "contact/map.h"
#include "write/fields.h"
#include "write/json_value.h"
#include "write/number.h"
#include "write/settings_json.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>

// The spring and damper that an ERP and a CFM are, and their restitution.
//
// A row that stays the same through a contact is a linear spring and damper, read by the map that
// it is taken to come from: kp = ERP / (h CFM) by the textbook and the corrected map, with kd = (1
// - ERP) / CFM and 1 / CFM; by the exact map as contact/map.c says. The restitution of the spring
// and damper themselves is that of the continuous oscillator; what ODE gives back is the row's,
// whatever it is read as.
//
// In the engine the row is that of the velocity-level model without bounce: CFM and ERP as they
// are.

const OdeMap INVERSE_READINGS[INVERSE_READING_COUNT] = {ODE_MAP_TEXTBOOK, ODE_MAP_CORRECTED,
                                                        ODE_MAP_EXACT};

// the hole of the pin that is run: so much play that it is met once, whatever the row
static const double PIN_RADIUS = 10e-3; // m
static const double PLAY = 1e-3;        // m

// m/s: nothing is as fast, so that nothing bounces
static const double NO_BOUNCE = 1e100;

// how far the pin goes in, about, and how far it flies in a step, at the most
static const double DEPTH = 1e-5;  // m
static const double FLIGHT = 1e-5; // m

// beyond the undamped rows of every map, whose ERP is 1e10
static const double ERP_MOST = 1e12;

// N/m and N s/m: with masses from 1e-50 to 1e50 kg nothing overflows
static const double PAIR_MOST = 1e100;

bool inverse_of_pair(double kp, double kd, double step_s, Inverse *inverse, Err *err)
{
    if (!(kp >= 0.0 && kd >= 0.0 && kp + kd > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "--kp and --kd must not be below 0, and one of them above: without spring "
                       "and damper there is no contact");
    }
    if (!(kp < PAIR_MOST && kd < PAIR_MOST)) {
        return err_set(err, ERR_USAGE, "--kp %.4g and --kd %.4g; allowed: below %.0e", kp, kd,
                       PAIR_MOST);
    }
    const MapContact contact = {.stiffness = kp, .damping = kd, .step = step_s};
    *inverse = (Inverse){.is_pair = true, .kp = kp, .kd = kd, .step_s = step_s};
    inverse->row = map_get(ODE_MAP_TEXTBOOK)->convert(&contact);
    return true;
}

bool inverse_of_row(double erp, double cfm, double step_s, Inverse *inverse, Err *err)
{
    if (!(erp >= 0.0)) {
        return err_set(err, ERR_USAGE,
                       "--erp is %.4g; allowed: 0 and above (a contact that pulls "
                       "its bodies into each other is none)",
                       erp);
    }
    if (!(cfm > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "--cfm is %.4g; a spring and damper have one above 0: a row of CFM 0 is "
                       "rigid, it presses as hard as it must and takes away ERP of the depth in "
                       "each step",
                       cfm);
    }
    const double spring = erp / (step_s * cfm);
    if (!(erp <= ERP_MOST && cfm > 1.0 / PAIR_MOST && cfm < PAIR_MOST && spring < PAIR_MOST)) {
        return err_set(err, ERR_USAGE,
                       "--erp %.4g and --cfm %.4g at a step of %.4g s are no contact of numbers: "
                       "allowed are an ERP up to %.0e, and a CFM and ERP / (h CFM) below %.0e",
                       erp, cfm, step_s, ERP_MOST, PAIR_MOST);
    }
    *inverse = (Inverse){.step_s = step_s, .row = map_row(erp, cfm)};
    return true;
}

static void read_by(const Inverse *inverse, double mass, OdeMap kind, InverseReading *reading)
{
    const Map *map = map_get(kind);
    MapContact contact = {.step = inverse->step_s, .mass = mass};
    *reading = (InverseReading){.map = kind,
                                .stiffness = NAN,
                                .damping = NAN,
                                .omega_h = NAN,
                                .ratio = NAN,
                                .restitution = NAN};
    if ((map->needs_mass && !(mass > 0.0)) || !map->invert(inverse->row, &contact)) {
        return;
    }
    reading->is_there = true;
    reading->stiffness = contact.stiffness;
    reading->damping = contact.damping;
    reading->omega_h = mass > 0.0 ? sqrt(contact.stiffness / mass) * inverse->step_s : NAN;
    if (mass > 0.0 && contact.stiffness > 0.0) {
        reading->ratio = 0.5 * contact.damping / sqrt(contact.stiffness * mass);
        reading->restitution = damping_linear_restitution(reading->ratio);
    }
}

// The pin in its hole, with the row; for scenario_free.
static Scenario pin_of(const Inverse *inverse)
{
    Scenario scenario = scenario_default();
    scenario.linkage = linkage_create((LinkageRoom){.joints = 1});
    scenario.linkage.joint_count = 1;
    scenario.linkage.joints[0] = (Joint){
        .name = "hole",
        .kind = JOINT_CLEARANCE,
        .body_a = LINKAGE_GROUND,
        .clearance = {.hole_radius = PIN_RADIUS + PLAY,
                      .pin_radius = PIN_RADIUS,
                      .width = PIN_RADIUS},
    };
    scenario.contact.model = CONTACT_POISSON;
    scenario.contact.bounce_speed = NO_BOUNCE;
    scenario.contact.penalty = 1.0 / inverse->row.cfm;
    scenario.ode.push_out = inverse->row.erp;
    scenario.ode.stepping = ODE_PLAIN;
    scenario.ode.map = ODE_MAP_TEXTBOOK;
    scenario.run.step = inverse->step_s;
    return scenario;
}

void inverse_finish(Inverse *inverse)
{
    free(inverse->masses);
}

void inverse_add_mass(Inverse *inverse, const char *joint, double mass)
{
    InverseMass *grown = realloc(inverse->masses, (inverse->mass_count + 1) * sizeof *grown);
    assert(grown != NULL);
    inverse->masses = grown;
    InverseMass *added = &inverse->masses[inverse->mass_count++];
    *added = (InverseMass){.joint = joint, .mass = mass};
    for (int i = 0; i < INVERSE_READING_COUNT; i++) {
        read_by(inverse, mass, INVERSE_READINGS[i], &added->readings[i]);
    }
    if (!(mass > 0.0)) {
        snprintf(added->delivered.message, ERR_TEXT_SIZE, "no mass is known");
        return;
    }
    const double step_s = inverse->step_s;
    const double stiffness = inverse->row.erp / (step_s * inverse->row.cfm);
    added->speed = fmin(DEPTH * sqrt(stiffness / mass), FLIGHT / step_s);
    added->speed = added->speed > 0.0 ? added->speed : FLIGHT / step_s;
    const MapImpactCase impact = {
        .mass = mass,
        .speed = added->speed,
        .step = step_s,
        .rows = {.cfm = inverse->row.cfm, .push_out = inverse->row.erp},
    };
    added->predicted = impact_predict(&impact);
    if (!added->predicted.is_ended) {
        snprintf(added->delivered.message, ERR_TEXT_SIZE, "the contact does not end");
        return;
    }
    Scenario scenario = pin_of(inverse);
    added->delivered =
        impact_deliver(&scenario, 0, mass, added->speed, added->predicted.duration.most);
    scenario_free(&scenario);
}

// The text and the JSON.

// Why a map has no reading of the row.
static const char *lack_of(const Inverse *inverse, OdeMap map, double mass)
{
    if (map_get(map)->needs_mass && !(mass > 0.0)) {
        return "needs the mass: --mass, or a case";
    }
    return map == ODE_MAP_TEXTBOOK && inverse->row.rest < 0.0
               ? "none: an ERP above 1 would be a negative damper"
               : "none: no oscillator makes this row";
}

static const char *remark_of(const InverseReading *reading)
{
    return reading->stiffness == 0.0 ? "no spring: nothing is pressed out again"
           : reading->damping == 0.0 ? "no damper"
           : reading->ratio >= 1.0   ? "creeps out: damped critically or more"
                                     : "";
}

#define AT(member) .offset = offsetof(InverseReading, member)

// clang-format off
static const Field READING_FIELDS[] = {
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "read by the map"},
    {"map", FIELD_CHOICE, FIELD_JSON, AT(map), .of = OPTIONS_ODE_MAPS},
    {"stiffness_N_m", FIELD_NUMBER, FIELD_ALL, "spring k", "N/m", "%.4g", AT(stiffness)},
    {"damping_N_s_m", FIELD_NUMBER, FIELD_ALL, "damper c", "N s/m", "%.4g", AT(damping)},
    {"damping_ratio", FIELD_NUMBER, FIELD_ALL, "zeta", "1", "%.4g", AT(ratio)},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "omega h", "1", "%.4g", AT(omega_h)},
    {"restitution", FIELD_NUMBER, FIELD_ALL, "restitution", "of k and c", "%.4g", AT(restitution)},
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "", .align = TABLE_WRAP},
    {0},
};
// clang-format on
#undef AT

static void write_mass(const Inverse *inverse, const InverseMass *mass, const Style *style,
                       Text *text)
{
    char heading[LINKAGE_NAME_SIZE + 64];
    if (mass->mass > 0.0) {
        snprintf(heading, sizeof heading, "On %.4g kg%s%s", mass->mass,
                 mass->joint[0] != '\0' ? ", the median of " : "", mass->joint);
    } else {
        snprintf(heading, sizeof heading, "On a mass that is not known");
    }
    Table *table = fields_table(heading, READING_FIELDS, FIELD_TABLE, style, text);
    for (int i = 0; i < INVERSE_READING_COUNT; i++) {
        const InverseReading *reading = &mass->readings[i];
        table_cell(table, "%s", OPTIONS_ODE_MAPS[reading->map]);
        fields_table_row(READING_FIELDS, FIELD_TABLE, reading, table);
        table_cell(table, "%s",
                   reading->is_there ? remark_of(reading)
                                     : lack_of(inverse, reading->map, mass->mass));
    }
    section_end(table, text);
    if (mass->predicted.is_ended && mass->mass > 0.0) {
        const ImpactSpread *predicted = &mass->predicted.restitution;
        text_append(text,
                    "  By any map, ODE gives back %.4g of the speed (%.4g to %.4g, by "
                    "where the steps fall)",
                    predicted->mean, predicted->least, predicted->most);
    }
    if (mass->delivered.is_measured) {
        text_append(text, "; %.4g in a run.\n", mass->delivered.figures.restitution.mean);
    } else {
        text_append(text, "%sNot run: %s.\n",
                    mass->predicted.is_ended && mass->mass > 0.0 ? ".\n  " : "  ",
                    mass->delivered.message);
    }
}

void mapping_inverse_text(const void *of, const Style *style, Text *text)
{
    const Inverse *inverse = of;
    if (inverse->is_pair) {
        text_append(text, "%skp = %.6g N/m and kd = %.6g N s/m at a step of %.4g us%s\n\n",
                    style->heading, inverse->kp, inverse->kd, inverse->step_s * UNITS_US,
                    style->end);
    } else {
        text_append(text, "%sERP = %.6g and CFM = %.6g m/(N s) at a step of %.4g us%s\n\n",
                    style->heading, inverse->row.erp, inverse->row.cfm, inverse->step_s * UNITS_US,
                    style->end);
    }
    text_append(text, "  row         ERP = %s, CFM = %s m/(N s)\n",
                number_shortest(inverse->row.erp).text, number_shortest(inverse->row.cfm).text);
    text_append(
        text, "  means       separating speed after the step + CFM F = (ERP / h) depth, F >= 0\n");
    for (size_t i = 0; i < inverse->mass_count; i++) {
        write_mass(inverse, &inverse->masses[i], style, text);
    }
}

static json_t *mass_object(const InverseMass *mass)
{
    json_t *object = json_object();
    const bool is_known = mass->mass > 0.0;
    json_object_set_new(object, "joint", json_string(mass->joint));
    json_value_set(object, "mass_kg", is_known ? mass->mass : NAN);
    json_t *readings = json_array();
    for (int i = 0; i < INVERSE_READING_COUNT; i++) {
        json_array_append_new(readings,
                              fields_json(READING_FIELDS, FIELD_JSON, &mass->readings[i]));
    }
    json_object_set_new(object, "readings", readings);
    json_value_set(object, "predicted_restitution",
                   is_known && mass->predicted.is_ended ? mass->predicted.restitution.mean : NAN);
    json_value_set(object, "delivered_restitution",
                   mass->delivered.is_measured ? mass->delivered.figures.restitution.mean : NAN);
    json_object_set_new(object, "message", json_value_text(mass->delivered.message));
    return object;
}

json_t *mapping_inverse_json(const void *of)
{
    const Inverse *inverse = of;
    json_t *object = json_object();
    json_object_set_new(object, "tool", settings_json_tool());
    json_object_set_new(object, "given", json_string(inverse->is_pair ? "kp-kd" : "erp-cfm"));
    json_value_set(object, "step_s", inverse->step_s);
    json_value_set(object, "erp", inverse->row.erp);
    json_value_set(object, "cfm_m_N_s", inverse->row.cfm);
    json_t *masses = json_array();
    for (size_t i = 0; i < inverse->mass_count; i++) {
        json_array_append_new(masses, mass_object(&inverse->masses[i]));
    }
    json_object_set_new(object, "masses", masses);
    return object;
}
