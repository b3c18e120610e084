// What did the bodies do, what did the joints feel, how far off is it, and at what cost?
#include "commands/run/run_floor.h"
#include "commands/run/run_report.h"
#include "write/alike.h"
#include "write/joint_units.h"
#include "write/units.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

// Of the clearance: a pin that moves less is at rest in its hole.
static const double UNTOUCHED_STILL = 1e-3;

void run_tables_extremes(const RunReport *report, const Style *style, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    const unsigned where = run_report_columns(report);
    RunFloor *floors = run_floor_list(report);
    Table *table = NULL;
    for (size_t body = 0; body < linkage->body_count; body++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (!run->is_complete || (int)body == linkage_driven_body(linkage)) {
                continue;
            }
            if (table == NULL) {
                table = fields_table(linkage->is_spatial ? "Extremes of the motion about z"
                                                         : "Extremes of the motion",
                                     RUN_BODY_FIELDS, where, style, text);
            }
            table_cell(table, "%s", linkage->bodies[body].name);
            table_cell(table, "%s", run->backend);
            const BodyExtremes shown = run_floor_body(&run->bodies[body], &floors[i]);
            fields_table_row(RUN_BODY_FIELDS, where, &shown, table);
        }
    }
    free(floors);
    if (table != NULL) {
        section_end(table, text);
    }
}

// The farthest that a pin was from the centre of its hole at the samples, m.
static double farthest_pin(const Trajectory *run, size_t joint)
{
    double distance = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        distance = fmax(distance, vec2_length(trajectory_state(run, i, joint)->eccentricity));
    }
    return distance;
}

// That a joint was not touched, and how far a pin came in its play.
static void write_still(const RunReport *report, const Trajectory *run, size_t joint, Text *text)
{
    const Joint *of = &report->scenario->linkage.joints[joint];
    text_append(text, "no contact in the whole run.");
    if (of->kind != JOINT_CLEARANCE) {
        return;
    }
    const double clearance = linkage_radial_clearance(of) * UNITS_UM;
    const double share = farthest_pin(run, joint) * UNITS_UM / clearance;
    if (share < UNTOUCHED_STILL) {
        text_append(text,
                    " The pin moves by less than %.2g of its %.4g um of play: nothing pushes it, "
                    "or the run of %.4g ms is too short.",
                    UNTOUCHED_STILL, clearance, run->duration_s * UNITS_MS);
    } else {
        text_append(text,
                    " The pin comes no farther than %.2g of its %.4g um of play: the run of "
                    "%.4g ms is too short, or the play too large for it.",
                    share, clearance, run->duration_s * UNITS_MS);
    }
}

// A run without a single contact has no spikes, and is hardly what was wanted.
static void write_untouched(const RunReport *report, bool is_torsional, size_t width, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        char between[64];
        snprintf(between, sizeof between, ", %s: ", run->backend);
        Alike *alike = alike_start();
        for (size_t joint = 0; joint < linkage->joint_count; joint++) {
            if (!trajectory_feels_play(run, &linkage->joints[joint]) ||
                linkage_is_torsional(&linkage->joints[joint]) != is_torsional ||
                run->joints[joint].contact_time > 0.0) {
                continue;
            }
            Text said;
            text_init(&said);
            write_still(report, run, joint, &said);
            alike_add(alike, linkage->joints[joint].name, said.data);
            text_finish(&said);
        }
        alike_end(alike, "  ", between, width, text);
    }
}

// The contacts of joints that push, or of those that turn.
static void write_contacts(const RunReport *report, bool is_torsional, const Style *style,
                           Text *text)
{
    const unsigned where = run_report_columns(report) | (is_torsional ? RUN_TURNED : RUN_PUSHED);
    const Linkage *linkage = &report->scenario->linkage;
    RunFloor *floors = run_floor_list(report);
    Table *table = NULL;
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (!trajectory_feels_play(run, &linkage->joints[joint]) ||
                linkage_is_torsional(&linkage->joints[joint]) != is_torsional) {
                continue;
            }
            if (table == NULL) {
                table = fields_table(is_torsional ? "Contacts at the limits of pivots"
                                                  : "Contacts in the joints with play",
                                     RUN_JOINT_FIELDS, where, style, text);
            }
            const RunJoint numbers = run_fields_joint(linkage, run, joint);
            table_cell(table, "%s", linkage->joints[joint].name);
            table_cell(table, "%s", run->backend);
            const RunJoint shown = run_floor_joint(&numbers, is_torsional, &floors[i]);
            fields_table_row(RUN_JOINT_FIELDS, where, &shown, table);
        }
    }
    free(floors);
    if (table != NULL) {
        section_end(table, text);
        write_untouched(report, is_torsional, style->width, text);
    }
}

void run_tables_contacts(const RunReport *report, const Style *style, Text *text)
{
    write_contacts(report, false, style, text);
    write_contacts(report, true, style, text);
}

static void pin_row(Table *table, const RunReport *report, const Trajectory *run, size_t number)
{
    const Joint *joint = &report->scenario->linkage.joints[number];
    const JointExtremes *extremes = &run->joints[number];
    const double limit = 2.0 * linkage_radial_clearance(joint) / joint->clearance.width;
    table_cell(table, "%s", joint->name);
    table_cell(table, "%s", run->backend);
    section_number(table, extremes->tilt_max.value * UNITS_MRAD);
    table_cell(table, "%.1f", sin(extremes->tilt_max.value) / limit * UNITS_PERCENT);
    run_when_cell(table, report, extremes->tilt_max.time_s, extremes->tilt_max.crank_rad);
    section_number(table, extremes->axial_max.value * UNITS_UM);
    run_when_cell(table, report, extremes->axial_max.time_s, extremes->axial_max.crank_rad);
}

void run_tables_pins(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"joint", "", TABLE_LEFT},
        {"backend", "", TABLE_LEFT},
        {"tilt max", "mrad", TABLE_RIGHT},
        {"of its limit", "%", TABLE_RIGHT},
        {"", "", TABLE_RIGHT},
        {"slid max", "um", TABLE_RIGHT},
        {"", "", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    Table *table = NULL;
    for (size_t joint = 0; linkage->is_spatial && joint < linkage->joint_count; joint++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (linkage->joints[joint].kind != JOINT_CLEARANCE ||
                !trajectory_feels_play(run, &linkage->joints[joint])) {
                continue;
            }
            if (table == NULL) {
                table = section_begin("Pins in space", 7, HEADS, style, text);
                run_when_head(table, 4, report);
                run_when_head(table, 6, report);
            }
            pin_row(table, report, run, joint);
        }
    }
    if (table != NULL) {
        section_end(table, text);
    }
}

// The contacts that were kept of all joints with play that are of one kind.
static size_t count_spikes(const Linkage *linkage, const Trajectory *run, unsigned kind)
{
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool is_its = trajectory_feels_play(run, joint) && run_report_contact(joint) == kind;
        count += is_its ? run->joints[i].spike_count : 0;
    }
    return count;
}

static void write_strongest(const RunReport *report, const Trajectory *run, unsigned kind,
                            size_t limit, const Style *style, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    const unsigned where = run_report_columns(report) | kind;
    char heading[128];
    snprintf(heading, sizeof heading, "Strongest contacts%s, %s",
             kind == RUN_TURNED ? " at the limits of pivots" : "", run->backend);
    Table *table = fields_table(heading, RUN_CONTACT_FIELDS, where, style, text);
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        const JointExtremes *extremes = &run->joints[joint];
        const Joint *of = &linkage->joints[joint];
        const bool is_its = linkage_has_play(of) && run_report_contact(of) == kind;
        for (size_t k = 0; is_its && k < extremes->spike_count && k < limit; k++) {
            table_cell(table, "%s", of->name);
            fields_table_row(RUN_CONTACT_FIELDS, where, &extremes->spikes[k], table);
        }
    }
    section_end(table, text);
}

void run_tables_spikes(const RunReport *report, size_t limit, const Style *style, Text *text)
{
    static const unsigned KINDS[] = {RUN_PUSHED, RUN_TURNED};
    for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS; k++) {
        for (size_t i = report->run_count; i-- > 0;) {
            const Trajectory *run = report->runs[i];
            if (count_spikes(&report->scenario->linkage, run, KINDS[k]) > 0) {
                write_strongest(report, run, KINDS[k], limit, style, text);
                break;
            }
        }
    }
}

// How the step came about and what its error is; of a tolerance that could not be held to the end
// up to when it was.
static void write_chosen(const RunReport *report, const Trajectory *run, Text *text)
{
    text_append(text, "  %s: step %.4g us, chosen by %zu trial%s; the steps are those of all.\n",
                run->backend, run->step_s * UNITS_US, run->trials, run->trials == 1 ? "" : "s");
    if (run->is_short) {
        text_append(
            text, "  The tolerance %.3g holds up to %.4g ms of %.4g ms only; for more, %s.\n",
            report->scenario->run.tolerance, run->estimate_s * UNITS_MS, run->duration_s * UNITS_MS,
            run_report_leaves_branch(report, run)
                ? "give one of the ideal joints play: they pass a change point there, "
                  "where no step keeps to the motion's branch"
                : "allow more steps: run.most-steps");
    }
    // without the reference's doubts what is not whole ends at the horizon, at a sample
    const double *last_s = &run->times[run->sample_count - 1];
    const bool is_whole = run->is_short || run->estimate_s > 0.5 * (last_s[-1] + last_s[0]);
    text_append(text, "  Its error is at most %.2g up to %.4g ms%s.\n", run->error_estimate,
                run->estimate_s * UNITS_MS,
                run->estimate_is_cut ? "; after that the reference is too uncertain to say"
                : is_whole           ? ""
                                     : "; the motion cannot be predicted further");
}

void run_tables_cost(const RunReport *report, const Style *style, Text *text)
{
    Table *table = fields_table("Cost", RUN_FIELDS, FIELD_TABLE, style, text);
    for (size_t i = 0; i < report->run_count; i++) {
        fields_table_row(RUN_FIELDS, FIELD_TABLE, report->runs[i], table);
    }
    section_end(table, text);
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        if (!run->is_complete) {
            text_append(text, "\n  %s%s failed: %s%s\n", style->failure, run->backend, run->message,
                        style->end);
            continue;
        }
        if (run->trials > 0) {
            write_chosen(report, run, text);
        }
        if (run->fallback_rows > 0) {
            text_append(text,
                        "  %s%s: the map would not have been stable in %zu contact row%s at this "
                        "step; the textbook map was used. A shorter step avoids that.%s\n",
                        style->failure, run->backend, run->fallback_rows,
                        run->fallback_rows == 1 ? "" : "s", style->end);
        }
    }
}
