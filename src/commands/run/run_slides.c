// How did sliders move along their lines, and how did blocks tilt between their guides?
#include "commands/run/run_floor.h"
#include "commands/run/run_report.h"
#include "commands/run/slide_range.h"
#include "write/units.h"

#include <math.h>
#include <stdlib.h>

static void slider_row(Table *table, const RunReport *report, const Trajectory *run, size_t joint,
                       const RunFloor *floor, int end)
{
    const Linkage *linkage = &report->scenario->linkage;
    const SlideRange range = slide_range_find(linkage, run, joint);
    table_cell(table, "%s", linkage->joints[joint].name);
    table_cell(table, "%s", run->backend);
    table_cell(table, end == 1 ? "max" : "min");
    table_cell(table, "%.6g", run_floor_cut(range.position[end].value, floor->length) * UNITS_MM);
    table_cell(table, "%.6g", run_floor_cut(range.velocity[end].value, floor->speed));
    run_when_cell(table, report, range.velocity[end].time_s, range.velocity[end].crank_rad);
    table_cell(table, "%.6g", run_floor_cut(range.acceleration[end].value, floor->acceleration));
    run_when_cell(table, report, range.acceleration[end].time_s, range.acceleration[end].crank_rad);
}

void run_slides_motion(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"joint", "", TABLE_LEFT},
        {"backend", "", TABLE_LEFT},
        {"", "", TABLE_LEFT},
        {"position", "mm", TABLE_RIGHT},
        {"velocity", "m/s", TABLE_RIGHT},
        {"", "", TABLE_RIGHT},
        {"accel.", "m/s^2", TABLE_RIGHT},
        {"", "", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    RunFloor *floors = run_floor_list(report);
    Table *table = NULL;
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (!run->is_complete || !slide_range_has(&linkage->joints[joint])) {
                continue;
            }
            if (table == NULL) {
                table = section_begin("Sliders along their lines, at the samples", 8, HEADS, style,
                                      text);
                run_when_head(table, 5, report);
                run_when_head(table, 7, report);
            }
            slider_row(table, report, run, joint, &floors[i], 1);
            slider_row(table, report, run, joint, &floors[i], 0);
        }
    }
    free(floors);
    if (table != NULL) {
        section_end(table, text);
    }
}

static void block_row(Table *table, const RunReport *report, const Trajectory *run, size_t number)
{
    const Joint *joint = &report->scenario->linkage.joints[number];
    const JointExtremes *extremes = &run->joints[number];
    const double limit = linkage_guide_tilt(&joint->guide);
    table_cell(table, "%s", joint->name);
    table_cell(table, "%s", run->backend);
    section_number(table, extremes->tilt_max.value * UNITS_MRAD);
    run_when_cell(table, report, extremes->tilt_max.time_s, extremes->tilt_max.crank_rad);
    section_number(table, limit * UNITS_MRAD);
    table_cell(table, "%.1f", extremes->tilt_max.value / limit * UNITS_PERCENT);
    section_number(table, extremes->force_max.value);
    section_number(table,
                   slide_range_find(&report->scenario->linkage, run, number).resultant.value);
}

void run_slides_blocks(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"joint", "", TABLE_LEFT},         {"backend", "", TABLE_LEFT},
        {"tilt max", "mrad", TABLE_RIGHT}, {"", "", TABLE_RIGHT},
        {"limit", "mrad", TABLE_RIGHT},    {"of limit", "%", TABLE_RIGHT},
        {"corners", "N", TABLE_RIGHT},     {"resultant", "N", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    Table *table = NULL;
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (linkage->joints[joint].kind != JOINT_GUIDE ||
                !trajectory_feels_play(run, &linkage->joints[joint])) {
                continue;
            }
            if (table == NULL) {
                table = section_begin("Blocks between their guides", 8, HEADS, style, text);
                run_when_head(table, 3, report);
            }
            block_row(table, report, run, joint);
        }
    }
    if (table != NULL) {
        section_end(table, text);
    }
}
