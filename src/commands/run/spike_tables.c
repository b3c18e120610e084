// Which spikes did the accelerations and the forces have?
#include "commands/run/run_report.h"
#include "write/joint_units.h"
#include "write/units.h"

#include <stdio.h>

static bool has_joint(const RunReport *report, const Trajectory *run, size_t joint)
{
    return run->is_complete && run->force_spikes[joint].is_known &&
           linkage_has_play(&report->scenario->linkage.joints[joint]);
}

static bool looked_for_any(const RunReport *report, const Trajectory *run)
{
    for (size_t i = 0; i < report->scenario->linkage.body_count; i++) {
        if (run_report_has_body_spikes(report, run, i)) {
            return true;
        }
    }
    return false;
}

static void count_row(Table *table, const RunReport *report, const Trajectory *run,
                      const char *quantity, const char *name, const char *unit,
                      const SignalSpikes *spikes)
{
    table_cell(table, "%s %s", quantity, name);
    table_cell(table, "%s", unit);
    table_cell(table, "%s", run->backend);
    section_number(table, spikes->threshold);
    table_cell(table, "%zu", spikes->count);
    section_number_or_dash(table, spikes->kept > 0, spikes->spikes[0].value);
    if (spikes->kept > 0) {
        run_when_cell(table, report, spikes->spikes[0].time_s, spikes->spikes[0].crank_rad);
    } else {
        table_cell(table, "-");
    }
    if (spike_bands_apply(report)) {
        const SpikeBandSums sums = spike_bands_sums(spikes);
        table_cell(table, "%zu", sums.inside.count);
        section_number_or_dash(table, sums.inside.count > 0, sums.inside.largest);
    }
}

static void write_counts(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"signal", "", TABLE_LEFT},     {"unit", "", TABLE_LEFT},
        {"backend", "", TABLE_LEFT},    {"threshold", "", TABLE_RIGHT},
        {"spikes", "", TABLE_RIGHT},    {"strongest", "", TABLE_RIGHT},
        {"", "", TABLE_RIGHT},          {"in bands", "", TABLE_RIGHT},
        {"strongest", "", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    const bool has_bands = spike_bands_apply(report);
    Table *table = section_begin("Spikes of the signals", has_bands ? 9 : 7, HEADS, style, text);
    run_when_head(table, 6, report);
    for (size_t body = 0; body < linkage->body_count; body++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (run_report_has_body_spikes(report, run, body)) {
                count_row(table, report, run, "alpha", linkage->bodies[body].name, "rad/s^2",
                          &run->alpha_spikes[body]);
            }
        }
    }
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (has_joint(report, run, joint)) {
                const Joint *of = &linkage->joints[joint];
                count_row(table, report, run, linkage_is_torsional(of) ? "torque" : "force",
                          of->name, joint_units(of)->force, &run->force_spikes[joint]);
            }
        }
    }
    section_end(table, text);
    if (has_bands) {
        text_append(text, "  The paper's bands: crank at %.0f to %.0f and %.0f to %.0f deg.\n",
                    spike_bands_first_deg(0), spike_bands_last_deg(0), spike_bands_first_deg(1),
                    spike_bands_last_deg(1));
    }
}

static size_t count_kept(const RunReport *report, const Trajectory *run)
{
    size_t count = 0;
    for (size_t i = 0; i < report->scenario->linkage.body_count; i++) {
        count += run_report_has_body_spikes(report, run, i) ? run->alpha_spikes[i].kept : 0;
    }
    return count;
}

static void write_strongest(const RunReport *report, const Trajectory *run, size_t limit,
                            const Style *style, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    const unsigned where = run_report_columns(report);
    char heading[128];
    snprintf(heading, sizeof heading, "Strongest spikes of the accelerations, %s", run->backend);
    Table *table = fields_table(heading, RUN_SPIKE_FIELDS, where, style, text);
    for (size_t body = 0; body < linkage->body_count; body++) {
        const SignalSpikes *spikes = &run->alpha_spikes[body];
        for (size_t i = 0;
             run_report_has_body_spikes(report, run, body) && i < spikes->kept && i < limit; i++) {
            const int joint = spikes->spikes[i].joint;
            table_cell(table, "%s", linkage->bodies[body].name);
            fields_table_row(RUN_SPIKE_FIELDS, where, &spikes->spikes[i], table);
            table_cell(table, "%s", joint >= 0 ? linkage->joints[joint].name : "-");
        }
    }
    section_end(table, text);
}

void spike_tables_write(const RunReport *report, size_t limit, const Style *style, Text *text)
{
    const Trajectory *last = NULL;
    for (size_t i = 0; i < report->run_count; i++) {
        last = looked_for_any(report, report->runs[i]) ? report->runs[i] : last;
    }
    if (last == NULL) {
        return;
    }
    write_counts(report, style, text);
    if (count_kept(report, last) > 0) {
        write_strongest(report, last, limit, style, text);
    }
}
