// What did the bodies do, what did the joints feel, how far off is it, and at what cost?
#include "report/run_tables.h"

#include "base/table.h"
#include "report/units.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

typedef struct Head {
    const char *title;
    const char *unit;
    TableAlign align;
} Head;

// Begins a section; the caller fills the table and hands it to end_section.
static Table *begin_section(const char *heading, size_t columns, const Head *heads,
                            const Style *style, Text *text)
{
    text_append(text, "\n%s%s%s\n\n", style->heading, heading, style->end);
    Table *table = table_create(columns);
    for (size_t i = 0; i < columns; i++) {
        table_head(table, i, heads[i].title, heads[i].unit, heads[i].align);
    }
    return table;
}

static void end_section(Table *table, Text *text)
{
    table_write(table, text);
    table_destroy(table);
}

// Four digits; a number that would need an exponent for them gets all of its own instead.
static void number_cell(Table *table, double value)
{
    const bool is_long = fabs(value) >= 1e4 && fabs(value) < 1e8;
    table_cell(table, is_long ? "%.0f" : "%.4g", value);
}

static void extreme_cells(Table *table, Extreme extreme)
{
    table_cell(table, "%.6g", extreme.value);
    table_cell(table, "%.1f", units_wrapped_deg(extreme.crank_rad));
}

void run_tables_extremes(const RunReport *report, const Style *style, Text *text)
{
    static const Head HEADS[] = {
        {"body", "", TABLE_LEFT},
        {"backend", "", TABLE_LEFT},
        {"omega max", "rad/s", TABLE_RIGHT},
        {"at crank", "deg", TABLE_RIGHT},
        {"omega min", "rad/s", TABLE_RIGHT},
        {"at crank", "deg", TABLE_RIGHT},
        {"alpha max", "rad/s^2", TABLE_RIGHT},
        {"at crank", "deg", TABLE_RIGHT},
        {"alpha min", "rad/s^2", TABLE_RIGHT},
        {"at crank", "deg", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    Table *table = begin_section("Extremes of the motion", 10, HEADS, style, text);
    for (size_t body = 0; body < linkage->body_count; body++) {
        if ((int)body == linkage_driven_body(linkage)) {
            continue;
        }
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (run->is_complete) {
                table_cell(table, "%s", linkage->bodies[body].name);
                table_cell(table, "%s", run->backend);
                extreme_cells(table, run->bodies[body].omega_max);
                extreme_cells(table, run->bodies[body].omega_min);
                extreme_cells(table, run->bodies[body].alpha_max);
                extreme_cells(table, run->bodies[body].alpha_min);
            }
        }
    }
    end_section(table, text);
}

static void contact_row(Table *table, const Joint *joint, const Trajectory *run,
                        const JointExtremes *extremes)
{
    table_cell(table, "%s", joint->name);
    table_cell(table, "%s", run->backend);
    table_cell(table, "%zu", extremes->impacts);
    number_cell(table, extremes->force_max.value);
    table_cell(table, "%.1f", units_wrapped_deg(extremes->force_max.crank_rad));
    number_cell(table, extremes->impulse);
    number_cell(table, extremes->penetration_max.value * UNITS_UM);
    table_cell(table, "%.1f", extremes->contact_time / run->duration_s * UNITS_PERCENT);
}

void run_tables_contacts(const RunReport *report, const Style *style, Text *text)
{
    static const Head HEADS[] = {
        {"joint", "", TABLE_LEFT},        {"backend", "", TABLE_LEFT},
        {"impacts", "", TABLE_RIGHT},     {"force max", "N", TABLE_RIGHT},
        {"at crank", "deg", TABLE_RIGHT}, {"impulse", "N s", TABLE_RIGHT},
        {"deepest", "um", TABLE_RIGHT},   {"in contact", "%", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    Table *table = NULL;
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (!run_report_feels_play(run, &linkage->joints[joint])) {
                continue;
            }
            if (table == NULL) {
                table = begin_section("Contacts in the joints with play", 8, HEADS, style, text);
            }
            contact_row(table, &linkage->joints[joint], run, &run->joints[joint]);
        }
    }
    if (table != NULL) {
        end_section(table, text);
    }
}

// The contacts that were kept of all joints with play.
static size_t count_spikes(const Linkage *linkage, const Trajectory *run)
{
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        count += run_report_feels_play(run, &linkage->joints[i]) ? run->joints[i].spike_count : 0;
    }
    return count;
}

static void spike_row(Table *table, const Joint *joint, const Spike *spike)
{
    table_cell(table, "%s", joint->name);
    table_cell(table, "%.4f", spike->onset_s * UNITS_MS);
    table_cell(table, "%.1f", units_wrapped_deg(spike->crank_rad));
    number_cell(table, spike->approach_speed * UNITS_MM);
    number_cell(table, spike->force_max);
    number_cell(table, spike->duration_s * UNITS_US);
    number_cell(table, spike->impulse);
    number_cell(table, spike->penetration_max * UNITS_UM);
}

void run_tables_spikes(const RunReport *report, size_t limit, const Style *style, Text *text)
{
    static const Head HEADS[] = {
        {"joint", "", TABLE_LEFT},       {"onset", "ms", TABLE_RIGHT},
        {"crank", "deg", TABLE_RIGHT},   {"approach", "mm/s", TABLE_RIGHT},
        {"force max", "N", TABLE_RIGHT}, {"duration", "us", TABLE_RIGHT},
        {"impulse", "N s", TABLE_RIGHT}, {"deepest", "um", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = report->run_count; i-- > 0;) {
        const Trajectory *run = report->runs[i];
        if (count_spikes(linkage, run) == 0) {
            continue;
        }
        char heading[128];
        snprintf(heading, sizeof heading, "Strongest contacts, %s", run->backend);
        Table *table = begin_section(heading, 8, HEADS, style, text);
        for (size_t joint = 0; joint < linkage->joint_count; joint++) {
            const JointExtremes *extremes = &run->joints[joint];
            const bool has_play = linkage->joints[joint].kind == JOINT_CLEARANCE;
            for (size_t k = 0; has_play && k < extremes->spike_count && k < limit; k++) {
                spike_row(table, &linkage->joints[joint], &extremes->spikes[k]);
            }
        }
        end_section(table, text);
        return;
    }
}

void run_tables_errors(const RunReport *report, const Style *style, Text *text)
{
    static const Head HEADS[] = {
        {"backend", "", TABLE_LEFT},       {"against", "", TABLE_LEFT},
        {"omega max", "1", TABLE_RIGHT},   {"at time", "ms", TABLE_RIGHT},
        {"omega rms", "1", TABLE_RIGHT},   {"alpha max", "1", TABLE_RIGHT},
        {"angle max", "deg", TABLE_RIGHT},
    };
    Table *table = NULL;
    for (size_t i = 0; i < report->run_count; i++) {
        const TrajectoryError *error = &report->errors[i];
        if (!report->runs[i]->is_complete || !error->is_known) {
            continue;
        }
        if (table == NULL) {
            table = begin_section("Error at the samples, over the reference's largest value", 7,
                                  HEADS, style, text);
        }
        table_cell(table, "%s", report->runs[i]->backend);
        table_cell(table, "%s", error->against);
        number_cell(table, error->omega_max);
        number_cell(table, error->omega_max_time_s * UNITS_MS);
        number_cell(table, error->omega_rms);
        number_cell(table, error->alpha_max);
        number_cell(table, error->angle_max_rad * UNITS_DEG);
    }
    if (table == NULL) {
        return;
    }
    end_section(table, text);
    if (scenario_has_clearance(report->scenario)) {
        text_append(text, "  The analytic solver takes every joint as ideal: "
                          "what stands here contains the play itself.\n");
    }
}

static void cost_row(Table *table, const Trajectory *run)
{
    table_cell(table, "%s", run->backend);
    if (!run->is_complete) {
        table_cell(table, "failed");
        for (int i = 0; i < 4; i++) {
            table_cell(table, "-");
        }
        return;
    }
    table_cell(table, "done");
    table_cell(table, "%zu", run->steps);
    number_cell(table, run->wall_s * UNITS_MS);
    if (run->steps > 0 && run->wall_s > 0.0) {
        number_cell(table, run->wall_s / (double)run->steps * UNITS_US);
        number_cell(table, run->duration_s / run->wall_s);
    } else {
        table_cell(table, "-");
        table_cell(table, "-");
    }
}

void run_tables_cost(const RunReport *report, const Style *style, Text *text)
{
    static const Head HEADS[] = {
        {"backend", "", TABLE_LEFT},   {"status", "", TABLE_LEFT},
        {"steps", "", TABLE_RIGHT},    {"wall time", "ms", TABLE_RIGHT},
        {"a step", "us", TABLE_RIGHT}, {"simulated/wall", "1", TABLE_RIGHT},
    };
    Table *table = begin_section("Cost", 6, HEADS, style, text);
    for (size_t i = 0; i < report->run_count; i++) {
        cost_row(table, report->runs[i]);
    }
    end_section(table, text);
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        if (!run->is_complete) {
            text_append(text, "\n  %s%s failed: %s%s\n", style->failure, run->backend, run->message,
                        style->end);
        }
    }
}
