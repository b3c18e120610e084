// How fast do bodies turn in space whose axes are not all along z?
#include "commands/run/run_report.h"

#include <math.h>

// The largest of a vector over the samples that are reported, and when.
static Extreme find_largest(const Trajectory *run, size_t body, bool is_rate)
{
    Extreme most = {.value = 0.0, .time_s = NAN, .crank_rad = NAN};
    for (size_t k = 0; k < run->sample_count; k++) {
        const SpaceMotion *motion = trajectory_space_motion(run, k, body);
        const double size = vec3_length(is_rate ? motion->alpha : motion->omega);
        if (run->times[k] >= run->report_from_s && size > most.value) {
            most = (Extreme){size, run->times[k], run->crank_angles[k]};
        }
    }
    return most;
}

static void cell(Table *table, const RunReport *report, Extreme most)
{
    table_cell(table, "%.6g", most.value);
    if (most.value > 0.0) {
        run_when_cell(table, report, most.time_s, most.crank_rad);
    } else {
        table_cell(table, "-");
    }
}

void run_turns_write(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"body", "", TABLE_LEFT},
        {"backend", "", TABLE_LEFT},
        {"|omega| max", "rad/s", TABLE_RIGHT},
        {"", "", TABLE_RIGHT},
        {"|alpha| max", "rad/s^2", TABLE_RIGHT},
        {"", "", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    Table *table = NULL;
    for (size_t body = 0; !space_has_plane(linkage) && body < linkage->body_count; body++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (!run->is_complete || run->space_motions == NULL ||
                (int)body == linkage_driven_body(linkage)) {
                continue;
            }
            if (table == NULL) {
                table = section_begin("Rotation in space, at the samples", 6, HEADS, style, text);
                run_when_head(table, 3, report);
                run_when_head(table, 5, report);
            }
            table_cell(table, "%s", linkage->bodies[body].name);
            table_cell(table, "%s", run->backend);
            cell(table, report, find_largest(run, body, false));
            cell(table, report, find_largest(run, body, true));
        }
    }
    if (table != NULL) {
        section_end(table, text);
    }
}
