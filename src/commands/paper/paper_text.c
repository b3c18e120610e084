// Writes the paper's numbers beside the recomputed ones as text.
#include "commands/paper/paper.h"
#include "write/units.h"

#include <stdio.h>
#include <string.h>

static const char *const PHYSICS_NOTES[PRINTED_TABLE_COUNT] = {
    "real: the largest pin force over a turn by inverse dynamics, ideal joints, gravity included",
    "Johnson k: tangent stiffness of a cylinder in the hole under the real force; the paper's k is"
    " P / 0.042 mm",
    "Hertz: sphere in a socket, the paper's Eq. (3); Johnson: cylinder in the hole; both under the"
    " real force",
};

// how the cells of each table are made, one constant fitted in all
static const char *const FORMULAS[PRINTED_TABLE_COUNT] = {
    "F = kappa max|alpha| (rpm / 1000)^2; alpha from Table VIII, kappa fitted to these tables",
    "P = 2 E* (0.1 mm sqrt(F / N)) (0.042 mm); B with F rounded as in Table I but for 100 rpm",
    "delta = 3/4 (F / (E* sqrt(5 mm)))^(2/3); F as for Table II",
};

static const char *const PIN_TITLES[PRINTED_PIN_COUNT] = {"A printed", "B printed"};

static void begin_section(const char *name, const char *title, const Style *style, Text *text)
{
    text_append(text, "\n%s%s: %s%s\n\n", style->heading, name, title, style->end);
}

static void write_typos(TypoPlace place, Text *text)
{
    for (size_t i = 0; i < TYPOS_COUNT; i++) {
        const Typo *typo = &TYPOS[i];
        if (typo->place == place) {
            const bool is_below_blank =
                text->length > 1 && strcmp(text->data + text->length - 2, "\n\n") == 0;
            text_append(text, is_below_blank ? "" : "\n");
            text_append(text, "  typo        in %s: \"%s\"\n  read as     %s\n  because     %s\n",
                        typo->where, typo->printed, typo->reading, typo->evidence);
        }
    }
}

static void head_estimate(Table *table, int index)
{
    size_t column = 0;
    table_head(table, column++, "speed", "rpm", TABLE_RIGHT);
    for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
        const char *unit = PRINTED_TABLES[index].unit;
        table_head(table, column++, PIN_TITLES[pin], unit, TABLE_RIGHT);
        table_head(table, column++, "recomputed", unit, TABLE_RIGHT);
        table_head(table, column++, "difference", unit, TABLE_RIGHT);
        column = fields_table_heads(PAPER_PIN_FIELDS, PAPER_TABLE << index, column, table);
    }
}

static void estimate_row(Table *table, const PaperResult *result, int index, int row)
{
    const int decimals = PRINTED_TABLES[index].decimals;
    table_cell(table, "%.0f", printed_speed_rpm(row));
    for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
        const EstimateCell *cell = &result->tables[index].cells[row][pin];
        table_cell(table, "%.*f", decimals, cell->printed);
        table_cell(table, "%.*f", decimals, cell->rounded);
        if (cell->is_as_printed) {
            table_cell(table, "0");
        } else {
            table_cell(table, "%+.*f", decimals, cell->rounded - cell->printed);
        }
        fields_table_row(PAPER_PIN_FIELDS, PAPER_TABLE << index, &result->physical.pins[row][pin],
                         table);
    }
}

static void write_estimate(const PaperResult *result, int index, const Style *style, Text *text)
{
    const PrintedTable *printed = &PRINTED_TABLES[index];
    const EstimateTable *ours = &result->tables[index];
    begin_section(printed->name, printed->title, style, text);
    Table *table = table_create(
        1 + PRINTED_PIN_COUNT * (3 + fields_table_width(PAPER_PIN_FIELDS, PAPER_TABLE << index)));
    table_fit(table, style->width);
    head_estimate(table, index);
    for (int row = 0; row < PRINTED_SPEED_COUNT; row++) {
        estimate_row(table, result, index, row);
    }
    section_end(table, text);
    text_append(text, "  %d of %d cells as printed. A: %s pin, B: %s pin.\n  %s.\n  %s.\n",
                ours->as_printed, ours->cell_count, PRINTED_PIN_NAMES[PRINTED_CRANK_COUPLER],
                PRINTED_PIN_NAMES[PRINTED_COUPLER_FOLLOWER], FORMULAS[index], PHYSICS_NOTES[index]);
}

static void write_laws(const PaperResult *result, const Style *style, Text *text)
{
    const Physical *physical = &result->physical;
    static const SectionHead HEADS[] = {
        {"law", "", TABLE_LEFT},         {"paper's force", "um", TABLE_RIGHT},
        {"tangent", "N/m", TABLE_RIGHT}, {"real force", "um", TABLE_RIGHT},
        {"tangent", "N/m", TABLE_RIGHT},
    };
    char heading[64];
    snprintf(heading, sizeof heading, "What physics gives: %s pin at 1000 rpm",
             PRINTED_PIN_NAMES[PRINTED_CRANK_COUPLER]);
    Table *table = section_begin(heading, 5, HEADS, style, text);
    for (int i = 0; i < PHYSICAL_LAW_COUNT; i++) {
        table_cell(table, "%s", physical->estimated[i].name);
        table_cell(table, "%.3g", physical->estimated[i].approach * UNITS_UM);
        table_cell(table, "%.3g", physical->estimated[i].tangent);
        table_cell(table, "%.3g", physical->real[i].approach * UNITS_UM);
        table_cell(table, "%.3g", physical->real[i].tangent);
    }
    section_end(table, text);
    const double half_angle =
        physical->pins[PHYSICAL_BASE_ROW][PRINTED_CRANK_COUPLER].half_angle * UNITS_DEG;
    text_append(text,
                "  Approach under the paper's %.4g N and under the real %.5g N, %.0f times more.\n"
                "  At the real force the contact's half-angle is %.0f degrees, so Hertz's and the "
                "cylinder laws, made for narrow contacts, are only approximate there.\n",
                physical->estimated_force, physical->real_force,
                physical->real_force / physical->estimated_force, half_angle);
}

// One of Tables VII (first = 0) and VIII (first = 4).
static void write_extremes(const PaperResult *result, int first, size_t width, Text *text)
{
    const int decimals = PRINTED_COLUMNS[first].decimals;
    Table *table = table_create(6);
    table_fit(table, width);
    table_head(table, 0, "row", "", TABLE_LEFT);
    table_head(table, 1, "", "", TABLE_LEFT);
    for (size_t i = 0; i < 4; i++) {
        const PrintedColumn *column = &PRINTED_COLUMNS[(size_t)first + i];
        const Number *number = &NUMBERS[column->number];
        // the heading of the table has the quantity: "omega max" is "max" in it
        char title[PRINTED_WORDS_SIZE];
        snprintf(title, sizeof title, "%s%s", column->body,
                 strchr(number->titles[NUMBER_PUSHED], ' '));
        table_head(table, 2 + i, title, number->units[NUMBER_PUSHED], TABLE_RIGHT);
    }
    for (int row = 0; row < PRINTED_ROW_COUNT; row++) {
        const ExtremesRow *extremes = &result->extremes[row];
        table_cell(table, "%s", extremes->name);
        table_cell(table, "printed");
        for (int i = first; i < first + 4; i++) {
            table_cell(table, "%.*f", decimals, extremes->printed[i]);
        }
        table_cell(table, "%s", "");
        table_cell(table, "ours");
        for (int i = first; i < first + 4; i++) {
            if (extremes->is_known) {
                table_cell(table, "%.*f", decimals, extremes->ours[i]);
            } else {
                table_cell(table, "failed");
            }
        }
    }
    section_end(table, text);
}

// How each row of ours was made.
static void write_origins(const PaperResult *result, const Style *style, Text *text)
{
    for (int row = 0; row < PRINTED_ROW_COUNT; row++) {
        const ExtremesRow *extremes = &result->extremes[row];
        text_append(text, "  %s: %s", extremes->name, extremes->label);
        if (!extremes->is_known) {
            text_append(text, ", %sFAILED%s: %s\n", style->failure, style->end, extremes->message);
        } else if (extremes->is_target) {
            text_append(text, ", largest relative difference %.1e, %d of %d cells as printed\n",
                        extremes->difference_max, extremes->as_printed, PRINTED_QUANTITY_COUNT);
        } else {
            text_append(text, ", step %.4g us, %zu impacts, largest pin force %.4g N\n",
                        extremes->step_s * UNITS_US, extremes->impacts, extremes->force_max);
        }
    }
}

void paper_text_write(const void *of, const Style *style, Text *text)
{
    const PaperResult *result = of;
    text_append(text,
                "%sA New Approach for Estimation of Penalty Parameter with Tolerance "
                "Stack-Up: its numbers%s\n\n",
                style->heading, style->end);
    text_append(text, "  Tables I to III: %d of %d cells as printed.\n", result->as_printed,
                result->cell_count);
    text_append(text,
                "  Tables VII and VIII, ideal rows: largest relative difference %.1e, %d of %d "
                "cells as printed.\n",
                result->ideal_difference_max, result->ideal_as_printed, result->ideal_cell_count);
    static const TypoPlace PLACES[] = {TYPO_TABLE_1, TYPO_TABLE_2, TYPO_TABLE_3};
    for (int i = 0; i < PRINTED_TABLE_COUNT; i++) {
        write_estimate(result, i, style, text);
        write_typos(PLACES[i], text);
    }
    write_laws(result, style, text);
    begin_section("Table VII", "angular velocity, crank clockwise at 1000 rpm", style, text);
    write_extremes(result, 0, style->width, text);
    begin_section("Table VIII", "angular acceleration, crank clockwise at 1000 rpm", style, text);
    write_extremes(result, 4, style->width, text);
    write_origins(result, style, text);
    text_append(text,
                "  The paper gives no step, damping, restitution, friction or sampling for its "
                "stack-up rows: compare their orders of magnitude, not their digits.\n");
    write_typos(TYPO_TABLES_7_8, text);
    begin_section("Elsewhere", "typos of no one table", style, text);
    write_typos(TYPO_MODEL, text);
}
