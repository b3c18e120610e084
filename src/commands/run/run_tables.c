// Writes the tables of a run: bodies, joints, errors, energy and cost.
#include "commands/run/run_report.h"
#include "model/linkage.h"
#include "write/alike.h"
#include "write/measured_fields.h"
#include "write/units.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The time of an event: the crank's angle, or the time where no drive turns a crank at constant
// speed.

void run_when_head(Table *table, size_t column, const RunReport *report)
{
    const bool is_steady = drive_is_steady(&report->scenario->linkage.driver);
    table_head(table, column, is_steady ? "at crank" : "at time", is_steady ? "deg" : "ms",
               TABLE_RIGHT);
}

void run_when_cell(Table *table, const RunReport *report, double time_s, double crank_rad)
{
    if (drive_is_steady(&report->scenario->linkage.driver)) {
        table_cell(table, "%.1f", crank_rad * UNITS_DEG);
    } else {
        table_cell(table, "%.4f", time_s * UNITS_MS);
    }
}

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
            if (!run->is_complete || linkage_is_driven(linkage, (int)body)) {
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
    const unsigned where = run_report_columns(report);
    const Linkage *linkage = &report->scenario->linkage;
    RunJointFields fields;
    run_fields_of_joint(is_torsional, &fields);
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
                                     fields.rows, where, style, text);
            }
            const RunJoint numbers = run_fields_joint(linkage, run, joint);
            table_cell(table, "%s", linkage->joints[joint].name);
            table_cell(table, "%s", run->backend);
            const RunJoint shown = run_floor_joint(&numbers, is_torsional, &floors[i]);
            fields_table_row(fields.rows, where, &shown, table);
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

static void run_tables_write_strongest(const RunReport *report, const Trajectory *run,
                                       unsigned kind, size_t limit, const Style *style, Text *text)
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
                run_tables_write_strongest(report, run, KINDS[k], limit, style, text);
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
            : run->wanted_s > 0.0 ? "allow more time: run.budget"
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

// How sliders moved along their lines, and how blocks tilted between their guides.

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

// The angular velocity of bodies in space whose axes are not all along z.

// The largest of a vector over the samples that are reported, and when.
static Extreme run_tables_find_largest(const Trajectory *run, size_t body, bool is_rate)
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
                linkage_is_driven(linkage, (int)body)) {
                continue;
            }
            if (table == NULL) {
                table = section_begin("Rotation in space, at the samples", 6, HEADS, style, text);
                run_when_head(table, 3, report);
                run_when_head(table, 5, report);
            }
            table_cell(table, "%s", linkage->bodies[body].name);
            table_cell(table, "%s", run->backend);
            cell(table, report, run_tables_find_largest(run, body, false));
            cell(table, report, run_tables_find_largest(run, body, true));
        }
    }
    if (table != NULL) {
        section_end(table, text);
    }
}

// Errors against the reference, its own uncertainty, and the end of its horizon.

// 1: a reference that is less sure than this holds nowhere
static const double HOLDS = 1e-3;

static void error_row(Table *table, const RunReport *report, size_t run)
{
    const TrajectoryError *error = &report->errors[run];
    const bool is_certified = run_report_is_certified(report, error);
    table_cell(table, "%s", report->runs[run]->backend);
    table_cell(table, "%s", error->against);
    section_number(table, error->max);
    section_number(table, error->max_time_s * UNITS_MS);
    section_number_or_dash(table, is_certified && isfinite(error->max_in_horizon),
                           error->max_in_horizon);
    section_number_or_dash(table, is_certified, is_certified ? report->truth->uncertainty : 0.0);
    table_cell(table, "%s%s", error->in, error->is_floor ? " (floor)" : "");
    section_number(table, error->omega_max);
    section_number(table, error->omega_rms);
    section_number(table, error->alpha_max);
    section_number(table, error->angle_max_rad * UNITS_DEG);
    table_cell(table,
               run_report_is_limited_by_reference(report, error) ? "limited by the reference" : "");
}

static void peak_cells(Table *table, double whole, double in_horizon, const char *in)
{
    section_number_or_dash(table, isfinite(whole), whole);
    section_number_or_dash(table, isfinite(in_horizon), in_horizon);
    table_cell(table, "%s", in);
}

// The errors that the motion's says nothing of.
static void write_force_errors(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"backend", "", TABLE_LEFT},
        {"forces", "1", TABLE_RIGHT},
        {"in horizon", "1", TABLE_RIGHT},
        {"in", "", TABLE_WRAP},
        {"peak forces", "1", TABLE_RIGHT},
        {"in horizon", "1", TABLE_RIGHT | TABLE_MINOR},
        {"in", "", TABLE_WRAP | TABLE_MINOR},
        {"peak alpha", "1", TABLE_RIGHT},
        {"in horizon", "1", TABLE_RIGHT | TABLE_MINOR},
        {"in", "", TABLE_WRAP | TABLE_MINOR},
    };
    Table *table = NULL;
    for (size_t i = 0; i < report->run_count; i++) {
        const TrajectoryError *error = &report->errors[i];
        if (!report->runs[i]->is_complete || !error->is_known || isnan(error->force_max)) {
            continue;
        }
        if (table == NULL) {
            table = section_begin("Error of contact forces at the samples, and of peaks", 10, HEADS,
                                  style, text);
        }
        table_cell(table, "%s", report->runs[i]->backend);
        peak_cells(table, error->force_max, error->force_max_in_horizon, error->force_in);
        peak_cells(table, error->peak_force_max, error->peak_force_max_in_horizon,
                   error->peak_force_in);
        peak_cells(table, error->peak_alpha_max, error->peak_alpha_max_in_horizon,
                   error->peak_alpha_in);
    }
    if (table != NULL) {
        section_end(table, text);
    }
}

// What is to be known about the truth before an error is believed.
static void write_horizon(const RunReport *report, Text *text)
{
    const Truth *truth = report->truth;
    const double end_ms = scenario_duration(report->scenario) * UNITS_MS;
    if (truth->is_uncertified) {
        text_append(text, "  The reference is not certified (--uncertified): neither its own error "
                          "is known nor how far the motion can be predicted.\n");
    } else if (truth->message[0] != '\0') {
        text_append(text, "  The reference could not be certified: %s\n", truth->message);
    } else if (truth->is_limited) {
        text_append(text,
                    "  The motion cannot be predicted beyond %.4g of %.4g ms: by then a "
                    "perturbation of 1e-10 has grown %.3g times. Errors after it mean nothing; "
                    "distributions over many starts can be compared.\n",
                    truth->horizon_s * UNITS_MS, end_ms, truth->growth);
    } else if (!(truth->uncertainty <= HOLDS)) {
        text_append(text, "  The reference's own uncertainty is %.2g over the run of %.4g ms.\n",
                    truth->uncertainty, end_ms);
    } else {
        text_append(text,
                    "  The reference holds through the whole run, %.4g ms: a perturbation of 1e-10 "
                    "grows %.3g times.\n",
                    end_ms, truth->growth);
    }
}

// The reference knows no POISSON model.
static void write_other_model(const RunReport *report, Text *text)
{
    const ContactOptions *contact = &report->scenario->contact;
    if (run_report_mixes_models(report)) {
        text_append(text,
                    "  The reference has the elastic law (%s) in place of the POISSON model: "
                    "errors contain the difference of the two.\n",
                    contact->stiffness > 0.0 ? "given stiffness" : OPTIONS_LAWS[contact->law]);
    }
}

// Whether ODE ran at a step that was given, and nothing says how far it is off.
static bool has_unknown_error(const RunReport *report)
{
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        if (run->is_complete && !report->errors[i].is_known && run->error_estimate == 0.0 &&
            strcmp(run->backend, OPTIONS_BACKENDS[BACKEND_ODE]) == 0) {
            return true;
        }
    }
    return false;
}

// What has to be said about the truth though nothing was compared with it.
static void write_truth_alone(const RunReport *report, const Style *style, Text *text)
{
    if (has_unknown_error(report)) {
        text_append(text,
                    "\n%sError%s\n\n  The error of ode is not known: there is no run of the "
                    "reference to compare it with. Add reference to run.backends.\n",
                    style->heading, style->end);
    }
    const bool is_doubtful = run_report_has_truth(report) && report->truth->message[0] != '\0';
    if (is_doubtful || run_report_mixes_models(report)) {
        text_append(text, "\n%sThe reference%s\n\n", style->heading, style->end);
        if (is_doubtful) {
            write_horizon(report, text);
        }
        write_other_model(report, text);
    }
}

void run_truth_errors(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"backend", "", TABLE_LEFT},
        {"against", "", TABLE_LEFT | TABLE_MINOR},
        {"largest", "1", TABLE_RIGHT},
        {"at time", "ms", TABLE_RIGHT | TABLE_DETAIL},
        {"in horizon", "1", TABLE_RIGHT},
        {"reference +-", "1", TABLE_RIGHT},
        {"in", "", TABLE_WRAP},
        {"omega max", "1", TABLE_RIGHT | TABLE_MINOR},
        {"omega rms", "1", TABLE_RIGHT | TABLE_DETAIL},
        {"alpha max", "1", TABLE_RIGHT | TABLE_DETAIL},
        {"angle max", "deg", TABLE_RIGHT | TABLE_DETAIL},
        {"", "", TABLE_LEFT},
    };
    Table *table = NULL;
    bool includes_play = false;
    bool has_floor = false;
    for (size_t i = 0; i < report->run_count; i++) {
        const TrajectoryError *error = &report->errors[i];
        if (!report->runs[i]->is_complete || !error->is_known) {
            continue;
        }
        if (table == NULL) {
            table = section_begin("Error at the samples, over the reference's largest value", 12,
                                  HEADS, style, text);
        }
        error_row(table, report, i);
        includes_play = includes_play || run_report_includes_play(report, i);
        has_floor = has_floor || error->is_floor;
    }
    if (table == NULL) {
        write_truth_alone(report, style, text);
        return;
    }
    section_end(table, text);
    if (includes_play) {
        text_append(text, "  The analytic solver takes every joint as ideal: an error of it, or "
                          "against it, contains the play itself.\n");
    }
    if (has_floor) {
        text_append(text,
                    "  (floor): that rate is next to nothing in the reference, and its error is "
                    "relative to %g of the speed of the fastest point.\n",
                    DISTANCE_FLOOR);
    }
    if (run_report_has_truth(report)) {
        write_horizon(report, text);
        write_other_model(report, text);
    }
    write_force_errors(report, style, text);
}

void run_truth_energy(const RunReport *report, const Style *style, Text *text)
{
    Table *table = NULL;
    RunFloor *floors = run_floor_list(report);
    const unsigned places = FIELD_TABLE | run_loaded(&report->scenario->linkage);
    for (size_t i = 0; i < report->run_count; i++) {
        const Energy *energy = &report->runs[i]->energy;
        if (!report->runs[i]->is_complete) {
            continue;
        }
        if (table == NULL) {
            table = fields_table("Energy", RUN_ENERGY_FIELDS, places, style, text);
        }
        table_cell(table, "%s", report->runs[i]->backend);
        const Energy shown = run_floor_energy(energy, &floors[i]);
        fields_table_row(RUN_ENERGY_FIELDS, places, &shown, table);
        const double scale = error_energy(report->runs[i]);
        section_number_or_dash(table, scale > 0.0 && isfinite(shown.residual),
                               fabs(shown.residual / scale));
    }
    free(floors);
    if (table != NULL) {
        section_end(table, text);
    }
}

static void match_rows(Table *table, const Joint *joint, const JointExtremes *truth,
                       const SpikeMatch *match)
{
    for (size_t i = 0; i < match->pair_count; i++) {
        const SpikePair *pair = &match->pairs[i];
        const Spike *spike = &truth->spikes[pair->reference_spike];
        table_cell(table, "%s", joint->name);
        table_cell(table, "%.4f", spike->onset_s * UNITS_MS);
        section_number(table, spike->force_max);
        section_number(table, pair->onset_delay_s * UNITS_US);
        table_cell(table, "%+.3g", pair->force_error * UNITS_PERCENT);
        table_cell(table, "%+.3g", pair->impulse_error * UNITS_PERCENT);
    }
}

// Of the largest forces, which are torques where the limits of pivots are met.
static const char *unit_of_forces(const Linkage *linkage)
{
    bool is_torsional[2] = {false, false};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            is_torsional[linkage_is_torsional(&linkage->joints[i])] = true;
        }
    }
    return is_torsional[false] && is_torsional[true] ? "N, N m" : is_torsional[true] ? "N m" : "N";
}

void run_truth_matches(const RunReport *report, const Style *style, Text *text)
{
    const SectionHead heads[] = {
        {"joint", "", TABLE_LEFT},
        {"reference's onset", "ms", TABLE_RIGHT},
        {"force max", unit_of_forces(&report->scenario->linkage), TABLE_RIGHT},
        {"later by", "us", TABLE_RIGHT},
        {"force", "%", TABLE_RIGHT},
        {"impulse", "%", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; report->matches != NULL && i < report->run_count; i++) {
        Table *table = NULL;
        size_t missed = 0;
        size_t extra = 0;
        for (size_t joint = 0; joint < linkage->joint_count; joint++) {
            const SpikeMatch *match = &report->matches[i].joints[joint];
            missed += match->missed;
            extra += match->extra;
            if (table == NULL && match->pair_count + match->missed + match->extra > 0) {
                char heading[128];
                snprintf(heading, sizeof heading, "Contacts matched within the horizon, %s",
                         report->runs[i]->backend);
                table = section_begin(heading, 6, heads, style, text);
            }
            match_rows(table, &linkage->joints[joint], &report->truth->trajectory->joints[joint],
                       match);
        }
        if (table != NULL) {
            section_end(table, text);
            text_append(text,
                        "  Of the strongest contacts kept, %zu of the reference and %zu of %s have "
                        "no match.\n",
                        missed, extra, report->runs[i]->backend);
        }
    }
}

static void distribution_cells(Table *table, const Distribution *distribution, double scale)
{
    section_number(table, distribution->low * scale);
    section_number(table, distribution->median * scale);
    section_number(table, distribution->high * scale);
    section_number(table, distribution->mean * scale);
    section_number(table, distribution->deviation * scale);
}

static void ensemble_rows(Table *table, const RunReport *report, size_t joint, size_t metric)
{
    for (size_t i = 0; i < report->run_count; i++) {
        const Ensemble *ensemble = &report->ensembles[i];
        if (ensemble->members > 0) {
            const Joint *of = &report->scenario->linkage.joints[joint];
            const Field *field = &measured_metric_fields(of)[metric];
            table_cell(table, "%s", report->scenario->linkage.joints[joint].name);
            table_cell(table, "%s%s%s", field->title, field->unit[0] != '\0' ? ", " : "",
                       field->unit);
            table_cell(table, "%s", report->runs[i]->backend);
            distribution_cells(table, &ensemble->joints[joint][metric], units_per_si(field->unit));
        }
    }
}

void run_truth_ensembles(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"joint", "", TABLE_LEFT}, {"what", "", TABLE_LEFT},    {"backend", "", TABLE_LEFT},
        {"low", "", TABLE_RIGHT},  {"median", "", TABLE_RIGHT}, {"high", "", TABLE_RIGHT},
        {"mean", "", TABLE_RIGHT}, {"+-", "", TABLE_RIGHT},
    };
    if (report->ensembles == NULL) {
        return;
    }
    const Linkage *linkage = &report->scenario->linkage;
    char heading[128];
    snprintf(heading, sizeof heading, "Over starts that differ by %g of the speeds",
             ENSEMBLE_PERTURBATION);
    Table *table = section_begin(heading, 8, HEADS, style, text);
    for (size_t joint = 0; joint < ensemble_joint_count(linkage); joint++) {
        const bool has_play = linkage_has_play(&linkage->joints[joint]);
        for (size_t metric = 0; has_play && metric < ENSEMBLE_METRIC_COUNT; metric++) {
            ensemble_rows(table, report, joint, metric);
        }
    }
    section_end(table, text);
    for (size_t i = 0; i < report->run_count; i++) {
        const Ensemble *ensemble = &report->ensembles[i];
        if (ensemble->members + ensemble->failed > 0) {
            text_append(text, "  %s: %zu starts", report->runs[i]->backend, ensemble->members);
            text_append(text, ensemble->failed > 0 ? ", and %zu that failed: %s\n" : "\n",
                        ensemble->failed, ensemble->message);
        } else if (ensemble->is_beyond_budget) {
            text_append(text, "  %s: none within run.budget\n", report->runs[i]->backend);
        }
    }
}
