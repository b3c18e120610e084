// What does the paper's P become in ODE, and how deep do pins go with it?
#include "commands/map/mapping_report.h"
#include "write/units.h"

// Of the readings as a stiffness and as a penalty: columns of their own.
enum {
    STIFFNESS = FIELD_OWN,
    PENALTY = FIELD_OWN << 1,
    TABLES = STIFFNESS | PENALTY,
};

static const void *asked_of(const void *record)
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
    {"asked", FIELD_PART, FIELD_JSON, .of = ASKED_FIELDS, .part = asked_of},
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

static void write_table(const PenaltyMap *map, const char *heading, unsigned where,
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
    write_table(map, "The paper's P read as a stiffness", STIFFNESS, style, text);
    text_append(
        text,
        "  P in N/mm with the viscous damper of the restitution asked for, %s map, %.4g us; "
        "Table III is static, and so is F / P; delivered is the depth of an impact of "
        "the joint's effective mass.\n",
        OPTIONS_ODE_MAPS[map->map], map->step_s * UNITS_US);
    write_table(map, "The paper's P read as a velocity-level penalty", PENALTY, style, text);
    text_append(text,
                "  F = P d', CFM = 1 / P, with ODE's bounce, %.4g us: the depth is what the pin "
                "flies in the step that finds the wall, and follows the step and not P.\n",
                map->step_s * UNITS_US);
}
