// What does the closed form say of the mechanism, before any solver has taken a step?
#include "analytic/closed_form.h"
#include "commands/run/run_report.h"
#include "write/section.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>

static void write_follower(const AnalyticSummary *summary, Text *text)
{
    if (!summary->has_limits) {
        text_append(text, "  follower             turns fully\n");
        return;
    }
    text_append(text, "  follower             %.6g to %.6g deg, a swing of %.6g deg\n",
                summary->follower_low * UNITS_DEG, summary->follower_high * UNITS_DEG,
                (summary->follower_high - summary->follower_low) * UNITS_DEG);
    text_append(text,
                "  limits of the swing  at crank %.1f deg (crank and coupler stretched) and "
                "%.1f deg (folded)\n",
                units_wrapped_deg(summary->limit_extended),
                units_wrapped_deg(summary->limit_folded));
}

// One quantity of the slider over a turn, with the digits that a comparison needs.
static void write_slide(const char *name, const char *unit, CurveExtreme extreme, double per_si,
                        Text *text)
{
    text_append(text, "  %-19s  %.9g to %.9g %s (crank %.3f and %.3f deg)\n", name,
                extreme.low * per_si, extreme.high * per_si, unit,
                units_wrapped_deg(extreme.low_angle), units_wrapped_deg(extreme.high_angle));
}

static void write_slider(const AnalyticSummary *summary, Text *text)
{
    text_append(text,
                "  stroke               %.6g mm, its ends at crank %.1f deg (stretched) and "
                "%.1f deg (folded)\n",
                (summary->slide.high - summary->slide.low) * UNITS_MM,
                units_wrapped_deg(summary->limit_extended),
                units_wrapped_deg(summary->limit_folded));
    write_slide("slider position", "mm", summary->slide, UNITS_MM, text);
    write_slide("slider velocity", "m/s", summary->velocity, 1.0, text);
    write_slide("slider acceleration", "m/s^2", summary->acceleration, 1.0, text);
}

void analytic_text_kinematics(const RunReport *report, const Style *style, Text *text)
{
    const AnalyticSummary *summary = report->summary;
    const Scenario *scenario = report->scenario;
    if (report->no_summary != NULL) {
        text_append(text, "\n  no kinematics of the ideal %s: %s\n", closed_form_name(scenario),
                    report->no_summary);
    }
    if (summary == NULL) {
        return;
    }
    text_append(text, "\n%sKinematics of the ideal %s%s\n\n", style->heading,
                closed_form_name(scenario), style->end);
    if (!scenario->has_slidercrank) {
        text_append(text, "  class                %s\n", FOURBAR_GRASHOF_NAMES[summary->grashof]);
    }
    text_append(text, "  transmission angle   %.6g deg (crank %.1f) to %.6g deg (crank %.1f)\n",
                summary->transmission_low * UNITS_DEG,
                units_wrapped_deg(summary->transmission_low_crank),
                summary->transmission_high * UNITS_DEG,
                units_wrapped_deg(summary->transmission_high_crank));
    if (scenario->has_slidercrank) {
        write_slider(summary, text);
    } else {
        write_follower(summary, text);
    }
}

static void force_row(Table *table, const char *name, const char *unit, Extreme high, Extreme low)
{
    table_cell(table, "%s", name);
    table_cell(table, "%s", unit);
    table_cell(table, "%.6g", high.value);
    table_cell(table, "%.1f", units_wrapped_deg(high.crank_rad));
    table_cell(table, "%.6g", low.value);
    table_cell(table, "%.1f", units_wrapped_deg(low.crank_rad));
}

void analytic_text_forces(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"quantity", "", TABLE_LEFT}, {"unit", "", TABLE_LEFT},
        {"max", "", TABLE_RIGHT},     {"at crank", "deg", TABLE_RIGHT},
        {"min", "", TABLE_RIGHT},     {"at crank", "deg", TABLE_RIGHT},
    };
    const AnalyticSummary *summary = report->summary;
    if (summary == NULL) {
        return;
    }
    Table *table = section_begin("Inverse dynamics, every joint ideal", 6, HEADS, style, text);
    force_row(table, "drive torque", "N m", summary->torque_max, summary->torque_min);
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        char name[LINKAGE_NAME_SIZE + 16];
        snprintf(name, sizeof name, "reaction %s", linkage->joints[i].name);
        force_row(table, name, "N", summary->reaction_max[i], summary->reaction_min[i]);
    }
    section_end(table, text);
    text_append(text,
                "  power balance: drive power and rate of energy differ by %.1e of the largest\n",
                summary->power_residual);
}

// The unit in which people read a quantity, and how many of it make one of SI.
static const char *quantity_unit(int quantity, double *per_si)
{
    *per_si = 1.0;
    switch (quantity) {
    case FOURBAR_COUPLER_OMEGA:
    case FOURBAR_FOLLOWER_OMEGA:
        return "rad/s";
    case FOURBAR_COUPLER_ALPHA:
    case FOURBAR_FOLLOWER_ALPHA:
        return "rad/s^2";
    default:
        *per_si = UNITS_DEG;
        return "deg";
    }
}

// The combination in words: "coupler +, crank -, play crank-coupler shortens coupler".
static void describe_combination(const Stackup *stackup, const StackupCombination *combination,
                                 char *words, size_t size)
{
    size_t used = 0;
    words[0] = '\0';
    for (int i = 0; i < STACKUP_LENGTHS && used < size; i++) {
        if (stackup->is_source[i] && combination->length_side[i] != 0) {
            used += (size_t)snprintf(words + used, size - used, "%s%s %s", used > 0 ? ", " : "",
                                     STACKUP_LENGTH_NAMES[i],
                                     combination->length_side[i] > 0 ? "+" : "-");
        }
    }
    for (int i = 0; i < STACKUP_PLAYS && used < size; i++) {
        if (stackup->is_source[STACKUP_LENGTHS + i] && combination->play_link[i] >= 0) {
            used += (size_t)snprintf(words + used, size - used, "%s%s %s %s", used > 0 ? ", " : "",
                                     STACKUP_SOURCE_NAMES[STACKUP_LENGTHS + i],
                                     combination->play_sign[i] > 0 ? "stretches" : "shortens",
                                     STACKUP_LENGTH_NAMES[combination->play_link[i]]);
        }
    }
}

// A change: of an angle in degrees, for a share of an angle means nothing; else in percent.
static void change_cell(Table *table, int quantity, double change, double nominal)
{
    const bool is_angle = quantity == FOURBAR_FOLLOWER_ANGLE || quantity == FOURBAR_TRANSMISSION;
    if (is_angle) {
        table_cell(table, "%+.3f deg", change * UNITS_DEG);
    } else {
        table_cell(table, "%+.3g %%", change / fabs(nominal) * UNITS_PERCENT);
    }
}

// The swing of a follower that turns fully has no ends.
static bool has_row(const RunReport *report, int quantity)
{
    return quantity != FOURBAR_FOLLOWER_ANGLE || report->summary == NULL ||
           report->summary->has_limits;
}

static void bound_row(Table *table, const Stackup *stackup, int quantity, bool is_high)
{
    const StackupRow *row = &stackup->rows[quantity];
    const StackupBound *bound = is_high ? &row->high : &row->low;
    double per_si;
    const char *unit = quantity_unit(quantity, &per_si);
    const double nominal = is_high ? row->nominal_high : row->nominal_low;
    char words[256];
    describe_combination(stackup, &bound->combination, words, sizeof words);
    table_cell(table, "%s", STACKUP_QUANTITY_NAMES[quantity]);
    table_cell(table, "%s", is_high ? "max" : "min");
    table_cell(table, "%s", unit);
    table_cell(table, "%.6g", nominal * per_si);
    table_cell(table, "%.6g", bound->value * per_si);
    change_cell(table, quantity, bound->value - nominal, nominal);
    table_cell(table, "%s", words);
}

// What each source does alone.
static void write_shares(const RunReport *report, const Style *style, Text *text)
{
    const Stackup *stackup = report->stackup;
    size_t sources = 0;
    for (int i = 0; i < STACKUP_SOURCES; i++) {
        sources += stackup->is_source[i] ? 1 : 0;
    }
    Table *table = table_create(2 + sources);
    table_fit(table, style->width);
    table_head(table, 0, "each alone", "", TABLE_LEFT);
    table_head(table, 1, "", "", TABLE_LEFT);
    size_t column = 2;
    for (int i = 0; i < STACKUP_SOURCES; i++) {
        if (stackup->is_source[i]) {
            table_head(table, column++, STACKUP_SOURCE_NAMES[i], "", TABLE_RIGHT);
        }
    }
    for (int cell = 0; cell < 2 * FOURBAR_QUANTITY_COUNT; cell++) {
        const StackupRow *row = &stackup->rows[cell / 2];
        const StackupBound *bound = cell % 2 == 0 ? &row->high : &row->low;
        const double nominal = cell % 2 == 0 ? row->nominal_high : row->nominal_low;
        if (!has_row(report, cell / 2)) {
            continue;
        }
        table_cell(table, "%s", STACKUP_QUANTITY_NAMES[cell / 2]);
        table_cell(table, "%s", cell % 2 == 0 ? "max" : "min");
        for (int i = 0; i < STACKUP_SOURCES; i++) {
            if (stackup->is_source[i]) {
                change_cell(table, cell / 2, bound->alone[i], nominal);
            }
        }
    }
    section_end(table, text);
}

void analytic_text_stackup(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"quantity", "", TABLE_LEFT},
        {"", "", TABLE_LEFT},
        {"unit", "", TABLE_LEFT},
        {"nominal", "", TABLE_RIGHT},
        {"worst case", "", TABLE_RIGHT},
        {"change", "", TABLE_RIGHT},
        {"where", "", TABLE_LEFT | TABLE_DETAIL},
    };
    const Stackup *stackup = report->stackup;
    if (report->no_stackup != NULL) {
        text_append(text, "\n  no tolerance stack-up: %s\n", report->no_stackup);
    }
    if (stackup == NULL || !stackup->has_sources) {
        return;
    }
    Table *table = section_begin("Tolerance stack-up, worst case", 7, HEADS, style, text);
    for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
        if (has_row(report, quantity)) {
            bound_row(table, stackup, quantity, true);
            bound_row(table, stackup, quantity, false);
        }
    }
    section_end(table, text);
    text_append(text, "\n");
    write_shares(report, style, text);
    text_append(text,
                "  Play counts as a link of its radial clearance; impacts are not part of it.\n");
}
