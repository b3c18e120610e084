// Builds the JSON object of the paper's numbers and the recomputed ones.
//
// {"tables": [{"name", "quantity", "unit", "cells": [{"rpm", "pin", "printed", "recomputed",
//    "value", "as_printed"}...], "cells_as_printed", "cell_count", "difference_max"}...],
//  "cells_as_printed", "cell_count",
//  "physics": {"pins": [...], "laws": [...]},
//  "extremes": [{"row", "status", "target", "printed": {...}, "recomputed": {...}, ...}...],
//  "ideal": {"difference_max", "cells_as_printed", "cell_count"}, "typos": [...]}
#include "commands/paper/paper.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const PLACE_WORDS[] = {
    [TYPO_TABLE_1] = "Table I",   [TYPO_TABLE_2] = "Table II",
    [TYPO_TABLE_3] = "Table III", [TYPO_TABLES_7_8] = "Tables VII and VIII",
    [TYPO_MODEL] = "model",
};

// jansson fails where memory runs out or a number is not finite; neither can be said in the object
static json_t *packed(json_t *value)
{
    assert(value != NULL);
    return value;
}

static json_t *cell_object(const EstimateCell *cell, int row, int pin)
{
    return packed(json_pack("{s:f, s:s, s:f, s:f, s:f, s:b}", "rpm", printed_speed_rpm(row), "pin",
                            PRINTED_PIN_NAMES[pin], "printed", cell->printed, "recomputed",
                            cell->rounded, "value", cell->value, "as_printed",
                            (int)cell->is_as_printed));
}

static json_t *table_object(const PaperResult *result, int index)
{
    const EstimateTable *table = &result->tables[index];
    json_t *cells = json_array();
    for (int row = 0; row < PRINTED_SPEED_COUNT; row++) {
        for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
            json_array_append_new(cells, cell_object(&table->cells[row][pin], row, pin));
        }
    }
    const PrintedTable *printed = &PRINTED_TABLES[index];
    return packed(json_pack("{s:s, s:s, s:s, s:o, s:i, s:i, s:f}", "name", printed->name,
                            "quantity", printed->title, "unit", printed->unit, "cells", cells,
                            "cells_as_printed", table->as_printed, "cell_count", table->cell_count,
                            "difference_max", table->difference_max));
}

#define AT(member) .offset = offsetof(PhysicalPin, member)

// clang-format off
const Field PAPER_PIN_FIELDS[] = {
    {"rpm", FIELD_NUMBER, FIELD_JSON, AT(rpm)},
    {"pin", FIELD_NAME, FIELD_JSON, AT(name)},
    {"force_N", FIELD_NUMBER, FIELD_JSON | PAPER_TABLE, "real", "N", "%.4g", AT(force)},
    {"hertz_approach_m", FIELD_NUMBER, FIELD_JSON | PAPER_TABLE << 2, "Hertz", "um", "%.4g",
     AT(hertz_approach)},
    {"johnson_approach_m", FIELD_NUMBER, FIELD_JSON | PAPER_TABLE << 2, "Johnson", "um", "%.4g",
     AT(johnson_approach)},
    {"johnson_tangent_N_m", FIELD_NUMBER, FIELD_JSON | PAPER_TABLE << 1, "Johnson k", "N/m", "%.4g",
     AT(johnson_tangent)},
    {"contact_half_angle_rad", FIELD_NUMBER, FIELD_JSON, AT(half_angle)},
    {0},
};
// clang-format on
#undef AT

static json_t *physics_object(const Physical *physical)
{
    json_t *pins = json_array();
    for (int row = 0; row < PRINTED_SPEED_COUNT; row++) {
        for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
            json_array_append_new(
                pins, fields_json(PAPER_PIN_FIELDS, FIELD_JSON, &physical->pins[row][pin]));
        }
    }
    json_t *laws = json_array();
    for (int i = 0; i < PHYSICAL_LAW_COUNT; i++) {
        const PhysicalLaw *estimated = &physical->estimated[i];
        const PhysicalLaw *real = &physical->real[i];
        json_array_append_new(laws,
                              packed(json_pack("{s:s, s:f, s:f, s:f, s:f}", "law", estimated->name,
                                               "approach_at_paper_force_m", estimated->approach,
                                               "tangent_at_paper_force_N_m", estimated->tangent,
                                               "approach_at_real_force_m", real->approach,
                                               "tangent_at_real_force_N_m", real->tangent)));
    }
    return packed(json_pack("{s:f, s:f, s:o, s:o}", "paper_force_N", physical->estimated_force,
                            "real_force_N", physical->real_force, "pins", pins, "laws", laws));
}

static json_t *values_object(const double values[PRINTED_QUANTITY_COUNT])
{
    json_t *object = json_object();
    for (size_t i = 0; i < PRINTED_QUANTITY_COUNT; i++) {
        char key[PRINTED_WORDS_SIZE];
        printed_column_key(i, key);
        json_object_set_new(object, key, packed(json_real(values[i])));
    }
    return object;
}

// Six digits say more than a picture shows.
static json_t *curve_numbers(const double *values, size_t count)
{
    json_t *numbers = json_array();
    for (size_t i = 0; i < count; i++) {
        char text[32];
        snprintf(text, sizeof text, "%.6g", values[i]);
        json_array_append_new(numbers, packed(json_real(strtod(text, NULL))));
    }
    return numbers;
}

static json_t *curve_object(const PaperCurve *curve)
{
    static const char *const KEYS[PAPER_CURVE_COUNT] = {
        "coupler_omega_rad_s", "follower_omega_rad_s", "coupler_alpha_rad_s2",
        "follower_alpha_rad_s2"};
    json_t *object = json_object();
    json_object_set_new(object, "crank_deg", curve_numbers(curve->crank_deg, curve->count));
    for (int i = 0; i < PAPER_CURVE_COUNT; i++) {
        json_object_set_new(object, KEYS[i], curve_numbers(curve->values[i], curve->count));
    }
    return object;
}

static json_t *extremes_object(const ExtremesRow *row)
{
    json_t *object = packed(json_pack("{s:s, s:s, s:s, s:b, s:s, s:o}", "row", row->name, "status",
                                      row->is_known ? "ok" : "failed", "message", row->message,
                                      "target", (int)row->is_target, "label", row->label, "printed",
                                      values_object(row->printed)));
    if (!row->is_known) {
        return object;
    }
    json_object_set_new(object, "recomputed", values_object(row->ours));
    json_object_set_new(object, "difference_max", packed(json_real(row->difference_max)));
    json_object_set_new(object, "cells_as_printed", json_integer(row->as_printed));
    json_object_set_new(object, "curve",
                        row->curve.count > 0 ? curve_object(&row->curve) : json_null());
    if (!row->is_target) {
        json_object_set_new(object, "step_s", packed(json_real(row->step_s)));
        json_object_set_new(object, "impacts", json_integer((json_int_t)row->impacts));
        json_object_set_new(object, "force_max_N", packed(json_real(row->force_max)));
    }
    return object;
}

static json_t *typos_array(void)
{
    json_t *typos = json_array();
    for (size_t i = 0; i < TYPOS_COUNT; i++) {
        const Typo *typo = &TYPOS[i];
        json_array_append_new(
            typos,
            packed(json_pack("{s:s, s:s, s:s, s:s, s:s}", "concerns", PLACE_WORDS[typo->place],
                             "where", typo->where, "printed", typo->printed, "reading",
                             typo->reading, "evidence", typo->evidence)));
    }
    return typos;
}

json_t *paper_json_make(const void *of)
{
    const PaperResult *result = of;
    json_t *tables = json_array();
    for (int i = 0; i < PRINTED_TABLE_COUNT; i++) {
        json_array_append_new(tables, table_object(result, i));
    }
    json_t *extremes = json_array();
    for (int i = 0; i < PRINTED_ROW_COUNT; i++) {
        json_array_append_new(extremes, extremes_object(&result->extremes[i]));
    }
    // infinite where an ideal row has no numbers of ours
    json_t *difference = isfinite(result->ideal_difference_max)
                             ? json_real(result->ideal_difference_max)
                             : json_null();
    json_t *ideal =
        packed(json_pack("{s:o, s:i, s:i}", "difference_max", difference, "cells_as_printed",
                         result->ideal_as_printed, "cell_count", result->ideal_cell_count));
    return packed(json_pack("{s:o, s:i, s:i, s:o, s:o, s:o, s:o}", "tables", tables,
                            "cells_as_printed", result->as_printed, "cell_count",
                            result->cell_count, "physics", physics_object(&result->physical),
                            "extremes", extremes, "ideal", ideal, "typos", typos_array()));
}
