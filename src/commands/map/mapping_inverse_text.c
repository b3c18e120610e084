// What spring, damper and restitution are an ERP and a CFM?
#include "commands/map/mapping_inverse.h"
#include "write/fields.h"
#include "write/json_value.h"
#include "write/number.h"
#include "write/settings_json.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>

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
