// What do the settings of a contact come to, what is wrong with them, and what do they deliver?
#include "commands/map/mapping_report.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FAULT_KEY_SIZE = 64 };

static void write_settings(const MappingContact *contact, const MappingRow *rows,
                           const Style *style, Text *text)
{
    const ForceLaw *law = &contact->impact.law;
    mapping_rows_write_table(rows, contact->row_count, style, text);
    if (!mapping_contact_is_poisson(contact)) {
        text_append(text, "  ERP and CFM at the law's deepest point%s\n",
                    law->family == FORCE_LAW_POWER && law->exponent == 1.0 && law->hysteresis == 0.0
                        ? "; of a linear spring and damper they hold at any depth, but for the "
                          "midpoint's ERP."
                        : "; the engine gets them recomputed at the depth of each step.");
    }
}

// What is wrong with each setting that is not valid, and what would be right.
static void write_faults(const MappingContact *contact, const MappingRow *rows, const Style *style,
                         Text *text)
{
    bool is_begun = false;
    for (size_t i = 0; i < contact->row_count; i++) {
        if (rows[i].verdict == VERDICT_VALID) {
            continue;
        }
        if (!is_begun) {
            text_append(text, "\n%sWhat is wrong, and what would be right%s\n\n", style->heading,
                        style->end);
            is_begun = true;
        }
        char key[FAULT_KEY_SIZE];
        snprintf(key, sizeof key, "%s, %.4g us", rows[i].map_name, rows[i].step_s * UNITS_US);
        text_append(text, "  %s: %s\n", key, rows[i].words);
    }
}

// Two cells: predicted, and delivered where it was measured.
static void pair_cells(Table *table, const MappingRow *row, const ImpactSpread *predicted,
                       const ImpactSpread *delivered, double unit)
{
    section_finite(table, "%.4g", row->predicted.is_ended ? unit * predicted->mean : NAN);
    section_finite(table, "%.4g", row->delivered.is_measured ? unit * delivered->mean : NAN);
}

static void write_figures(const MappingContact *contact, const MappingRow *rows, const Style *style,
                          Text *text)
{
    // the length of the contact is in the JSON and the CSV: 80 columns have no room for it
    const JointUnits *units = mapping_report_units(contact);
    const double depth_scale = units_per_si(units->length);
    char peak[32];
    char depth[32];
    snprintf(peak, sizeof peak, "peak, %s", units->force);
    snprintf(depth, sizeof depth, "depth, %s", units->length);
    const SectionHead heads[] = {
        {"map", "", TABLE_LEFT},
        {"step", "us", TABLE_RIGHT | TABLE_KEY},
        {"restitution", "predicted", TABLE_RIGHT},
        {"", "in ODE", TABLE_RIGHT},
        {peak, "predicted", TABLE_RIGHT},
        {"", "in ODE", TABLE_RIGHT},
        {depth, "predicted", TABLE_RIGHT},
        {"", "in ODE", TABLE_RIGHT},
    };
    Table *table = section_begin("Predicted and delivered", 8, heads, style, text);
    if (!mapping_contact_is_poisson(contact)) {
        const MapImpact *asked = &contact->asked;
        const double values[] = {asked->restitution, asked->force_max,
                                 asked->penetration_max * depth_scale};
        table_cell(table, "asked");
        table_cell(table, "-");
        for (int i = 0; i < 3; i++) {
            table_cell(table, "%.4g", values[i]);
            table_cell(table, "%s", "");
        }
        table_rule(table);
    }
    for (size_t i = 0; i < contact->row_count; i++) {
        const ImpactFigures *predicted = &rows[i].predicted;
        const ImpactFigures *delivered = &rows[i].delivered.figures;
        mapping_rows_begin(rows, i, table);
        pair_cells(table, &rows[i], &predicted->restitution, &delivered->restitution, 1.0);
        pair_cells(table, &rows[i], &predicted->force_max, &delivered->force_max, 1.0);
        pair_cells(table, &rows[i], &predicted->penetration_max, &delivered->penetration_max,
                   depth_scale);
    }
    section_end(table, text);
}

// Why rows could not be run; the same reason of neighbours is given once.
static void write_unmeasured(const MappingContact *contact, const MappingRow *rows, Text *text)
{
    const char *last = "";
    for (size_t i = 0; i < contact->row_count; i++) {
        const MappingRow *row = &rows[i];
        if (!row->delivered.is_measured && strcmp(row->delivered.message, last) != 0) {
            text_append(text, "  not run in ODE: %s at %.4g us: %s\n", row->map_name,
                        row->step_s * UNITS_US, row->delivered.message);
        }
        last = row->delivered.is_measured ? "" : row->delivered.message;
    }
}

void mapping_settings_text_write(const MappingReport *report, const MappingContact *contact,
                                 const Style *style, Text *text)
{
    const MappingRow *rows = &report->mapping->rows[contact->first_row];
    write_settings(contact, rows, style, text);
    write_faults(contact, rows, style, text);
    write_figures(contact, rows, style, text);
    write_unmeasured(contact, rows, text);
}
