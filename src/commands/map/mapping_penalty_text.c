// What does the paper's P become in ODE, and how deep do pins go with it?
#include "commands/map/mapping_penalty_text.h"

#include "write/section.h"
#include "write/units.h"

static void depth_cell(Table *table, const ImpactDelivered *delivered)
{
    if (delivered->is_measured) {
        table_cell(table, "%.4g", delivered->figures.penetration_max.mean * UNITS_UM);
    } else {
        table_cell(table, "-");
    }
}

static void restitution_cell(Table *table, const ImpactDelivered *delivered)
{
    if (delivered->is_measured) {
        table_cell(table, "%.4g", delivered->figures.restitution.mean);
    } else {
        table_cell(table, "-");
    }
}

static void write_stiffness(const PenaltyMap *map, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"speed", "rpm", TABLE_RIGHT},        {"F, Table I", "N", TABLE_RIGHT},
        {"P, Table II", "N/mm", TABLE_RIGHT}, {"ERP", "1", TABLE_RIGHT},
        {"CFM", "1/(N s/m)", TABLE_RIGHT},    {"impact", "m/s", TABLE_RIGHT},
        {"Table III", "um", TABLE_RIGHT},     {"F / P", "um", TABLE_RIGHT},
        {"delivered", "um", TABLE_RIGHT},     {"restitution", "delivered", TABLE_RIGHT},
    };
    Table *table = section_begin("The paper's P read as a stiffness", 10, HEADS, style, text);
    for (int i = 0; i < PRINTED_SPEED_COUNT; i++) {
        const PenaltyMapRow *row = &map->rows[i];
        table_cell(table, "%.0f", row->rpm);
        table_cell(table, "%.4g", row->force);
        table_cell(table, "%.2f", row->printed);
        if (map->map == ODE_MAP_IMPULSE) {
            table_cell(table, "-");
            table_cell(table, "-");
        } else {
            table_cell(table, "%.4g", row->soft.erp);
            table_cell(table, "%.4g", row->soft.cfm);
        }
        table_cell(table, "%.4g", row->speed);
        table_cell(table, "%.4f", row->approach * UNITS_UM);
        table_cell(table, "%.4g", row->rest_depth * UNITS_UM);
        depth_cell(table, &row->by_spring);
        restitution_cell(table, &row->by_spring);
    }
    section_end(table, text);
    text_append(
        text,
        "  P in N/mm with the viscous damper of the restitution asked for, %s map, %.4g us; "
        "Table III is static, and so is F / P; delivered is the depth of an impact of "
        "the joint's effective mass.\n",
        OPTIONS_ODE_MAPS[map->map], map->step_s * UNITS_US);
}

static void write_penalty(const PenaltyMap *map, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"speed", "rpm", TABLE_RIGHT},
        {"P, Table II", "N s/mm", TABLE_RIGHT},
        {"CFM", "1/(N s/m)", TABLE_RIGHT},
        {"impact", "m/s", TABLE_RIGHT},
        {"Table III", "um", TABLE_RIGHT},
        {"delivered", "um", TABLE_RIGHT},
        {"restitution", "delivered", TABLE_RIGHT},
    };
    Table *table =
        section_begin("The paper's P read as a velocity-level penalty", 7, HEADS, style, text);
    for (int i = 0; i < PRINTED_SPEED_COUNT; i++) {
        const PenaltyMapRow *row = &map->rows[i];
        table_cell(table, "%.0f", row->rpm);
        table_cell(table, "%.2f", row->printed);
        table_cell(table, "%.4g", row->cfm);
        table_cell(table, "%.4g", row->speed);
        table_cell(table, "%.4f", row->approach * UNITS_UM);
        depth_cell(table, &row->by_penalty);
        restitution_cell(table, &row->by_penalty);
    }
    section_end(table, text);
    text_append(text,
                "  F = P d', CFM = 1 / P, with ODE's bounce, %.4g us: the depth is what the pin "
                "flies in the step that finds the wall, and follows the step and not P.\n",
                map->step_s * UNITS_US);
}

void mapping_penalty_text_write(const MappingReport *report, const Style *style, Text *text)
{
    write_stiffness(report->penalty, style, text);
    write_penalty(report->penalty, style, text);
}
