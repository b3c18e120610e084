// Writes a mapping as JSON and CSV.
#include "commands/map/map.h"
#include "write/json_value.h"
#include "write/settings_json.h"
#include "write/units.h"

#include <math.h>

// The numbers of a contact, of its settings and of its best constants, in JSON, CSV and
// tables.

static const char *const SOURCES[] = {
    [MAPPING_MEDIAN] = "median", [MAPPING_MOST] = "most",   [MAPPING_GIVEN] = "given",
    [MAPPING_USUAL] = "usual",   [MAPPING_FLOOR] = "floor",
};

static const char *predicted_status(const void *record)
{
    const ImpactFigures *figures = record;
    return figures->is_ended      ? "ok"
           : figures->is_past_end ? "past-end"
           : figures->is_too_fine ? "too-fine"
                                  : "sticks";
}

static const char *delivered_status(const void *record)
{
    return ((const ImpactDelivered *)record)->is_measured ? "ok" : "not run";
}

static const void *contact_of(const void *record)
{
    return ((const MappingRow *)record)->contact;
}

static const void *map_rows_asked_of(const void *record)
{
    return &((const MappingRow *)record)->contact->asked;
}

static const char *map_rows_joint_of(const void *record)
{
    return mapping_report_joint(record)->name;
}

static double damping_of(const void *record)
{
    const MappingContact *contact = record;
    return mapping_contact_is_poisson(contact) ? contact->scenario.contact.penalty
                                               : contact->damping;
}

static double longest_of(const void *record)
{
    const MappingRow *row = record;
    const double longest_s = row->contact->largest_s[row->map];
    return longest_s > 0.0 ? longest_s : NAN;
}

static const char *map_rows_message_of(const void *record)
{
    const MappingRow *row = record;
    return row->delivered.is_measured ? row->words : row->delivered.message;
}

static const char *contact_status(const void *record)
{
    return ((const MappingContact *)record)->lack[0] == '\0' ? "ok" : "not mapped";
}

static json_t *map_rows_is_torsional(const void *record)
{
    return json_boolean(linkage_is_torsional(mapping_report_joint(record)));
}

static const void *if_mapped(const void *record)
{
    return ((const MappingContact *)record)->lack[0] == '\0' ? record : NULL;
}

static const void *if_poisson(const void *record)
{
    return mapping_contact_is_poisson(record) ? record : NULL;
}

static const void *if_law(const void *record)
{
    return mapping_contact_is_poisson(record) ? NULL : record;
}

static const void *if_run(const void *record)
{
    return ((const MappingContact *)record)->joint.mass_most > 0.0 ? record : NULL;
}

static const void *if_met(const void *record)
{
    return ((const MappingContact *)record)->joint.onsets > 0 ? record : NULL;
}

// Steps by map; of the impulse map any is valid.
static json_t *steps_object(const double *steps)
{
    json_t *object = json_object();
    for (int map = ODE_MAP_TEXTBOOK; map < ODE_MAP_IMPULSE; map++) {
        json_value_set(object, OPTIONS_ODE_MAPS[map], steps[map] > 0.0 ? steps[map] : NAN);
    }
    return object;
}

static json_t *largest_of(const void *record)
{
    return steps_object(((const MappingContact *)record)->largest_s);
}

static json_t *hardest_of(const void *record)
{
    return steps_object(((const MappingContact *)record)->hardest_s);
}

// the best constants have the figures without the rows that fell back
enum {
    HELD = FIELD_OWN,
    BOTH = FIELD_JSON | HELD,
    PUSHED = FIELD_OWN << 1, // of tables: of a contact that pushes, or one that turns
    TURNED = FIELD_OWN << 2,
};

#define SPREAD(member)    .offset = offsetof(ImpactSpread, member)
#define FIGURE(member)    .offset = offsetof(ImpactFigures, member)
#define DELIVERED(member) .offset = offsetof(ImpactDelivered, member)
#define IMPACT(member)    .offset = offsetof(MapImpact, member)
#define ROW(member)       .offset = offsetof(MappingRow, member)
#define CONTACT(member)   .offset = offsetof(MappingContact, member)
#define SETTING(member)   .offset = offsetof(ConstantsSetting, member)

// clang-format off
static const Field SPREAD_FIELDS[] = {
    {"mean", FIELD_NUMBER, BOTH, SPREAD(mean)},
    {"least", FIELD_NUMBER, BOTH, SPREAD(least)},
    {"most", FIELD_NUMBER, BOTH, SPREAD(most)},
    {0},
};
static const Field FIGURE_FIELDS[] = {
    {"restitution", FIELD_GROUP, BOTH, FIGURE(restitution), .of = SPREAD_FIELDS},
    {"force_max_N", FIELD_GROUP, BOTH, FIGURE(force_max), .of = SPREAD_FIELDS},
    {"penetration_max_m", FIELD_GROUP, BOTH, FIGURE(penetration_max), .of = SPREAD_FIELDS},
    {"duration_s", FIELD_GROUP, BOTH, FIGURE(duration), .of = SPREAD_FIELDS},
    {"fallback_rows", FIELD_COUNT, FIELD_JSON, FIGURE(fallbacks)},
    {"restitution", FIELD_NUMBER, FIELD_CSV, FIGURE(restitution.mean)},
    {"force_max_N", FIELD_NUMBER, FIELD_CSV, FIGURE(force_max.mean)},
    {"penetration_max_m", FIELD_NUMBER, FIELD_CSV, FIGURE(penetration_max.mean)},
    {"duration_s", FIELD_NUMBER, FIELD_CSV, FIGURE(duration.mean)},
    {0},
};
static const Field PREDICTED_FIELDS[] = {
    {"status", FIELD_NAME, FIELD_JSON, .word = predicted_status},
    {NULL, FIELD_IF, FIELD_FILES, .known = offsetof(ImpactFigures, is_ended), .of = FIGURE_FIELDS},
    {0},
};
const Field DELIVERED_FIELDS[] = {
    {"status", FIELD_NAME, FIELD_JSON, .word = delivered_status},
    {"message", FIELD_TEXT, FIELD_JSON, DELIVERED(message)},
    {NULL, FIELD_IF, FIELD_FILES, DELIVERED(figures),
     .known = offsetof(ImpactDelivered, is_measured), .of = FIGURE_FIELDS},
    {0},
};
const Field ASKED_FIELDS[] = {
    {"restitution", FIELD_NUMBER, FIELD_FILES, IMPACT(restitution)},
    {"force_max_N", FIELD_NUMBER, FIELD_FILES, IMPACT(force_max)},
    {"penetration_max_m", FIELD_NUMBER, FIELD_FILES, IMPACT(penetration_max)},
    {"duration_s", FIELD_NUMBER, FIELD_FILES, IMPACT(duration)},
    {0},
};

// What a row of CSV has of its contact, before and behind map and step.
static const Field NAME_FIELDS[] = {
    {"joint", FIELD_NAME, FIELD_CSV, .word = map_rows_joint_of},
    {"law", FIELD_NAME, FIELD_CSV, CONTACT(law_name)},
    {0},
};
static const Field USED_FIELDS[] = {
    {"mass_kg", FIELD_NUMBER, FIELD_CSV, CONTACT(impact.mass)},
    {"speed_m_s", FIELD_NUMBER, FIELD_CSV, CONTACT(impact.speed)},
    {"stiffness_N_m", FIELD_NUMBER, FIELD_CSV, CONTACT(secant)},
    {"damping_N_s_m", FIELD_NUMBER, FIELD_CSV, .number = damping_of},
    {0},
};
const Field MAPPING_ROW_FIELDS[] = {
    {NULL, FIELD_PART, FIELD_CSV, .of = NAME_FIELDS, .part = contact_of},
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "map"},
    {NULL, FIELD_LABEL, FIELD_TABLE, "step", "us", .align = TABLE_RIGHT},
    {"map", FIELD_NAME, FIELD_FILES, ROW(map_name)},
    {"stepping", FIELD_CHOICE, FIELD_JSON, ROW(stepping), .of = OPTIONS_ODE_STEPPINGS},
    {"step_s", FIELD_NUMBER, FIELD_FILES, ROW(step_s)},
    {NULL, FIELD_PART, FIELD_CSV, .of = USED_FIELDS, .part = contact_of},
    {"steps_a_contact", FIELD_NUMBER, FIELD_ALL, "Tc / h", "1", "%.3g", ROW(steps_a_contact),
     .align = TABLE_MINOR},
    {"omega_h", FIELD_NUMBER, FIELD_ALL, "omega h", "1", "%.3g", ROW(omega_h),
     .align = TABLE_DETAIL},
    {"stability_limit", FIELD_NUMBER, FIELD_JSON, ROW(stability_limit)},
    {"erp", FIELD_NUMBER, FIELD_ALL, "ERP", "1", "%.6g", ROW(soft.erp)},
    {"cfm_m_N_s", FIELD_NUMBER, FIELD_FILES | PUSHED, "CFM", "1/(N s/m)", "%.6g", ROW(soft.cfm)},
    {NULL, FIELD_NUMBER, TURNED, "CFM", "1/(N m s/rad)", "%.6g", ROW(soft.cfm)},
    {"asked", FIELD_PART, FIELD_CSV, .of = ASKED_FIELDS, .part = map_rows_asked_of},
    {"predicted", FIELD_GROUP, FIELD_CSV, ROW(predicted), .of = PREDICTED_FIELDS},
    {"delivered", FIELD_GROUP, FIELD_CSV, ROW(delivered), .of = DELIVERED_FIELDS},
    {"verdict", FIELD_CHOICE, FIELD_ALL, .title = "verdict", ROW(verdict), .of = VERDICT_NAMES},
    {"words", FIELD_TEXT, FIELD_JSON, ROW(words)},
    {"predicted", FIELD_GROUP, FIELD_JSON, ROW(predicted), .of = PREDICTED_FIELDS},
    {"delivered", FIELD_GROUP, FIELD_JSON, ROW(delivered), .of = DELIVERED_FIELDS},
    {"longest_valid_step_s", FIELD_NUMBER, FIELD_CSV, .number = longest_of},
    {"message", FIELD_TEXT, FIELD_CSV, .word = map_rows_message_of},
    {0},
};

static const Field MASS_FIELDS[] = {
    {"mass_least_kg", FIELD_NUMBER, FIELD_JSON, CONTACT(joint.mass_least)},
    {"mass_median_kg", FIELD_NUMBER, FIELD_JSON, CONTACT(joint.mass_median)},
    {"mass_most_kg", FIELD_NUMBER, FIELD_JSON, CONTACT(joint.mass_most)},
    {0},
};
static const Field MET_FIELDS[] = {
    {"speed_median_m_s", FIELD_NUMBER, FIELD_JSON, CONTACT(joint.speed_median)},
    {"speed_most_m_s", FIELD_NUMBER, FIELD_JSON, CONTACT(joint.speed_most)},
    {"run_force_max_N", FIELD_NUMBER, FIELD_JSON, CONTACT(joint.force_max)},
    {"run_penetration_max_m", FIELD_NUMBER, FIELD_JSON, CONTACT(joint.penetration_max)},
    {0},
};
static const Field PENALTY_FIELDS[] = {
    {"penalty_N_s_m", FIELD_NUMBER, FIELD_JSON, CONTACT(scenario.contact.penalty)},
    {0},
};
static const Field LAW_FIELDS[] = {
    {"half_period_s", FIELD_NUMBER, FIELD_JSON, CONTACT(half_period_s)},
    {"stiffness_secant_N_m", FIELD_NUMBER, FIELD_JSON, CONTACT(secant)},
    {"stiffness_tangent_N_m", FIELD_NUMBER, FIELD_JSON, CONTACT(tangent)},
    {"damping_N_s_m", FIELD_NUMBER, FIELD_JSON, CONTACT(damping)},
    {"damping_equivalent_N_s_m", FIELD_NUMBER, FIELD_JSON, CONTACT(equivalent)},
    {"longest_valid_step_s", FIELD_VALUE, FIELD_JSON, .json = largest_of},
    {"longest_valid_step_hardest_s", FIELD_VALUE, FIELD_JSON, .json = hardest_of},
    {0},
};
static const Field MAPPED_FIELDS[] = {
    {"asked", FIELD_GROUP, FIELD_JSON, CONTACT(asked), .of = ASKED_FIELDS},
    {NULL, FIELD_PART, FIELD_JSON, .of = PENALTY_FIELDS, .part = if_poisson},
    {NULL, FIELD_PART, FIELD_JSON, .of = LAW_FIELDS, .part = if_law},
    {0},
};
static const Field CONTACT_FIELDS[] = {
    {"joint", FIELD_NAME, FIELD_JSON, .word = map_rows_joint_of},
    {"is_torsional", FIELD_VALUE, FIELD_JSON, .json = map_rows_is_torsional},
    {"law", FIELD_NAME, FIELD_JSON, CONTACT(law_name)},
    {"status", FIELD_NAME, FIELD_JSON, .word = contact_status},
    {"message", FIELD_TEXT, FIELD_JSON, CONTACT(lack)},
    {"mass_kg", FIELD_NUMBER, FIELD_JSON, CONTACT(impact.mass)},
    {"mass_from", FIELD_CHOICE, FIELD_JSON, CONTACT(mass_source), .of = SOURCES},
    {NULL, FIELD_PART, FIELD_JSON, .of = MASS_FIELDS, .has_nulls = true, .part = if_run},
    {"speed_m_s", FIELD_NUMBER, FIELD_JSON, CONTACT(impact.speed)},
    {"speed_from", FIELD_CHOICE, FIELD_JSON, CONTACT(speed_source), .of = SOURCES},
    {"contacts", FIELD_COUNT, FIELD_JSON, CONTACT(joint.onsets)},
    {NULL, FIELD_PART, FIELD_JSON, .of = MET_FIELDS, .has_nulls = true, .part = if_met},
    {NULL, FIELD_PART, FIELD_JSON, .of = MAPPED_FIELDS, .part = if_mapped},
    {0},
};

static const Field SETTING_FIELDS[] = {
    {"map", FIELD_CHOICE, HELD, SETTING(map), .of = OPTIONS_ODE_MAPS},
    {"erp", FIELD_NUMBER, HELD, SETTING(row.erp)},
    {"cfm_m_N_s", FIELD_NUMBER, HELD, SETTING(row.cfm)},
    {"stiffness_N_m", FIELD_NUMBER, HELD, SETTING(stiffness)},
    {"damping_N_s_m", FIELD_NUMBER, HELD, SETTING(damping)},
    {"verdict", FIELD_CHOICE, HELD, SETTING(verdict), .of = VERDICT_NAMES},
    {"restitution_met", FIELD_FLAG, HELD, SETTING(is_restitution_met)},
    {"misfit", FIELD_NUMBER, HELD, SETTING(misfit)},
    {"predicted", FIELD_IF, HELD, SETTING(predicted),
     .known = offsetof(ConstantsSetting, predicted.is_ended), .of = FIGURE_FIELDS},
    {"delivered", FIELD_IF, HELD, SETTING(delivered.figures),
     .known = offsetof(ConstantsSetting, delivered.is_measured), .of = FIGURE_FIELDS},
    {"message", FIELD_TEXT, HELD, SETTING(delivered.message)},
    {0},
};
// clang-format on

static json_t *held_json(const Constants *held)
{
    json_t *settings = json_array();
    for (int i = 0; i < CONSTANTS_MAP_COUNT; i++) {
        json_array_append_new(settings, fields_json(SETTING_FIELDS, HELD, &held->settings[i]));
    }
    return json_pack("{s:f, s:f, s:f, s:o}", "step_s", held->step_s, "flight_m", held->flight,
                     "play_m", held->play, "settings", settings);
}

static json_t *contact_json(const MappingReport *report, const MappingContact *contact)
{
    json_t *object = fields_json(CONTACT_FIELDS, FIELD_JSON, contact);
    json_t *rows = json_array();
    for (size_t i = 0; i < contact->row_count; i++) {
        json_array_append_new(rows, fields_json(MAPPING_ROW_FIELDS, FIELD_JSON,
                                                &report->mapping->rows[contact->first_row + i]));
    }
    json_object_set_new(object, "rows", rows);
    if (contact->held != NULL) {
        json_object_set_new(object, "best_constants", held_json(contact->held));
    }
    return linkage_is_torsional(mapping_report_joint(contact)) ? torsional_keys(object) : object;
}

json_t *mapping_json_build(const void *of)
{
    const MappingReport *report = of;
    json_t *object = json_object();
    settings_json_begin(object, report->scenario);
    json_value_set(object, "valid_share", MAPPING_VALID_SHARE);
    json_object_set_new(object, "phases", json_integer(MAP_IMPACT_PHASES));
    json_t *contacts = json_array();
    for (size_t i = 0; i < report->mapping->contact_count; i++) {
        json_array_append_new(contacts, contact_json(report, &report->mapping->contacts[i]));
    }
    json_object_set_new(object, "contacts", contacts);
    if (report->penalty != NULL) {
        json_object_set_new(object, "penalty", mapping_penalty_json(report->penalty));
    }
    return object;
}

void mapping_rows_begin(const MappingRow *rows, size_t index, Table *table)
{
    const bool is_first = index == 0 || rows[index].map != rows[index - 1].map;
    if (is_first && index > 0) {
        table_rule(table);
    }
    table_cell(table, "%s", is_first ? rows[index].map_name : "");
    table_cell(table, "%.4g", rows[index].step_s * UNITS_US);
}

void mapping_rows_write_table(const MappingRow *rows, size_t count, const Style *style, Text *text)
{
    const bool is_turning = count > 0 && linkage_is_torsional(mapping_report_joint(rows->contact));
    const unsigned where = FIELD_TABLE | (is_turning ? TURNED : PUSHED);
    Table *table = fields_table("Settings", MAPPING_ROW_FIELDS, where, style, text);
    for (size_t i = 0; i < count; i++) {
        mapping_rows_begin(rows, i, table);
        fields_table_row(MAPPING_ROW_FIELDS, where, &rows[i], table);
    }
    section_end(table, text);
}
