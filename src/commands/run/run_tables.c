// Writes the tables of a run: bodies, joints, errors, energy and cost.
#include "commands/run/run_report.h"
#include "measure/wear.h"
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

// Whether a table of an owner has a row of a member in a run.
typedef bool RowIsShown(const RunReport *report, const Trajectory *run, size_t member);

// A table of the numbers of the members of an owner that are shown, backend by backend; the name of
// a member is headed by `what`, or there is none. Returns whether there is a row.
static bool write_numbers(const RunReport *report, NumberOwner owner, NumberTurn turn,
                          unsigned without, const char *heading, const char *what,
                          RowIsShown *is_shown, const Style *style, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    NumberFields fields = {.count = 0};
    if (what != NULL) {
        number_fields_label(&fields, what, "", TABLE_LEFT);
    }
    number_fields_label(&fields, "backend", "", TABLE_LEFT);
    number_fields_add(&fields, owner, turn, without | number_fields_lacked(linkage),
                      run_report_has_crank(report));
    RunFloor *floors = NULL;
    Table *table = NULL;
    for (size_t member = 0; member < number_member_count(owner, linkage); member++) {
        for (size_t i = 0; i < report->run_count; i++) {
            if (!report->runs[i]->is_complete || !is_shown(report, report->runs[i], member)) {
                continue;
            }
            if (table == NULL) {
                floors = run_floor_list(report);
                table = fields_table(heading, fields.rows, FIELD_TABLE, style, text);
            }
            if (what != NULL) {
                table_cell(table, "%s", number_member(owner, linkage, member));
            }
            table_cell(table, "%s", report->runs[i]->backend);
            const NumberRecord shown = run_floor_record(report, i, &floors[i], owner, member);
            fields_table_row(fields.rows, FIELD_TABLE, &shown, table);
        }
    }
    free(floors);
    if (table != NULL) {
        section_end(table, text);
    }
    return table != NULL;
}

static bool is_moving(const RunReport *report, const Trajectory *run, size_t body)
{
    (void)run;
    return !linkage_is_driven(&report->scenario->linkage, (int)body);
}

void run_tables_extremes(const RunReport *report, const Style *style, Text *text)
{
    const char *heading = report->scenario->linkage.is_spatial ? "Extremes of the motion about z"
                                                               : "Extremes of the motion";
    write_numbers(report, NUMBER_OWNER_BODY, NUMBER_PUSHED, 0, heading, "body", is_moving, style,
                  text);
}

static bool is_any(const RunReport *report, const Trajectory *run, size_t member)
{
    (void)report, (void)run, (void)member;
    return true;
}

void run_tables_whole(const RunReport *report, const Style *style, Text *text)
{
    write_numbers(report, NUMBER_OWNER_RUN, NUMBER_PUSHED, 0, "All bodies and joints", NULL, is_any,
                  style, text);
}

// What an ideal joint carries, or one whose play a solver does not model.
static bool is_without_play(const RunReport *report, const Trajectory *run, size_t joint)
{
    const Joint *of = &report->scenario->linkage.joints[joint];
    return !linkage_is_torsional(of) && !trajectory_feels_play(run, of);
}

void run_tables_forces(const RunReport *report, const Style *style, Text *text)
{
    write_numbers(report, NUMBER_OWNER_JOINT, NUMBER_PUSHED, NUMBER_PLAY,
                  "Reactions in the joints without play", "joint", is_without_play, style, text);
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
    if (!joint_has_hole(of->kind)) {
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

static bool is_pushed(const RunReport *report, const Trajectory *run, size_t joint)
{
    const Joint *of = &report->scenario->linkage.joints[joint];
    return trajectory_feels_play(run, of) && !linkage_is_torsional(of);
}

static bool is_turned(const RunReport *report, const Trajectory *run, size_t joint)
{
    const Joint *of = &report->scenario->linkage.joints[joint];
    return trajectory_feels_play(run, of) && linkage_is_torsional(of);
}

void run_tables_contacts(const RunReport *report, const Style *style, Text *text)
{
    if (write_numbers(report, NUMBER_OWNER_JOINT, NUMBER_PUSHED, 0,
                      "Contacts in the joints with play", "joint", is_pushed, style, text)) {
        write_untouched(report, false, style->width, text);
    }
    if (write_numbers(report, NUMBER_OWNER_JOINT, NUMBER_TURNED, 0,
                      "Contacts at the limits of pivots", "joint", is_turned, style, text)) {
        write_untouched(report, true, style->width, text);
    }
}

static bool is_worn(const RunReport *report, const Trajectory *run, size_t joint)
{
    const Linkage *linkage = &report->scenario->linkage;
    return wear_has(&linkage->joints[joint]) && wear_of(run, joint).is_known;
}

void run_tables_wear(const RunReport *report, const Style *style, Text *text)
{
    const bool is_steady = drive_is_steady(&report->scenario->linkage.driver);
    if (write_numbers(report, NUMBER_OWNER_JOINT_WEAR, NUMBER_PUSHED, 0, "What wears the pins",
                      "joint", is_worn, style, text)) {
        const size_t start = text->length;
        text_append(text,
                    "  Work and distance are those of %s. Pressure: force over width times "
                    "diameter. Worn at: where force times sliding distance is largest, from the x "
                    "axis of the body with the hole.\n",
                    is_steady ? "a revolution" : "the whole run");
        text_fold_behind(text, start, style->width);
    }
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
            if (!joint_has_hole(linkage->joints[joint].kind) ||
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

// The contacts that were kept of all joints with play that push, or turn.
static size_t count_spikes(const Linkage *linkage, const Trajectory *run, NumberTurn turn)
{
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const bool is_its = trajectory_feels_play(run, &linkage->joints[i]) &&
                            number_turn(NUMBER_OWNER_JOINT_CONTACT, linkage, i) == turn;
        count += is_its ? run->joints[i].spike_count : 0;
    }
    return count;
}

static void run_tables_write_strongest(const RunReport *report, const Trajectory *run,
                                       NumberTurn turn, size_t limit, const Style *style,
                                       Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    const NumberOwner owner = NUMBER_OWNER_JOINT_CONTACT;
    NumberFields fields = {.count = 0};
    number_fields_label(&fields, "joint", "", TABLE_LEFT);
    number_fields_add(&fields, owner, turn, 0, run_report_has_crank(report));
    char heading[128];
    snprintf(heading, sizeof heading, "Strongest contacts%s, %s",
             turn == NUMBER_TURNED ? " at the limits of pivots" : "", run->backend);
    Table *table = fields_table(heading, fields.rows, FIELD_TABLE, style, text);
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        const JointExtremes *extremes = &run->joints[joint];
        const Joint *of = &linkage->joints[joint];
        const bool is_its = linkage_has_play(of) && number_turn(owner, linkage, joint) == turn;
        for (size_t k = 0; is_its && k < extremes->spike_count && k < limit; k++) {
            const NumberSource source = {.run = run, .contact = &extremes->spikes[k]};
            const NumberRecord record = number_record(owner, &source, joint);
            table_cell(table, "%s", of->name);
            fields_table_row(fields.rows, FIELD_TABLE, &record, table);
        }
    }
    section_end(table, text);
}

void run_tables_spikes(const RunReport *report, size_t limit, const Style *style, Text *text)
{
    static const NumberTurn TURNS[] = {NUMBER_PUSHED, NUMBER_TURNED};
    for (size_t k = 0; k < sizeof TURNS / sizeof *TURNS; k++) {
        for (size_t i = report->run_count; i-- > 0;) {
            const Trajectory *run = report->runs[i];
            if (count_spikes(&report->scenario->linkage, run, TURNS[k]) > 0) {
                run_tables_write_strongest(report, run, TURNS[k], limit, style, text);
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
    NumberFields fields = {.count = 0};
    number_fields_add(&fields, NUMBER_OWNER_COST, NUMBER_PUSHED, 0, false);
    const size_t words = fields_table_width(RUN_FIELDS, FIELD_TABLE);
    section_heading("Cost", style, text);
    text_append(text, "\n");
    Table *table = table_create(words + fields_table_width(fields.rows, FIELD_TABLE));
    table_fit(table, style->width);
    fields_table_heads(RUN_FIELDS, FIELD_TABLE, 0, table);
    fields_table_heads(fields.rows, FIELD_TABLE, words, table);
    for (size_t i = 0; i < report->run_count; i++) {
        const NumberSource source = run_report_source(report, i);
        const NumberRecord record = number_record(NUMBER_OWNER_COST, &source, 0);
        fields_table_row(RUN_FIELDS, FIELD_TABLE, report->runs[i], table);
        fields_table_row(fields.rows, FIELD_TABLE, &record, table);
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
            if (!joint_has_guides(linkage->joints[joint].kind) ||
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

// An error as tables have it: up to a horizon only where that is certified.
static TrajectoryError error_shown(const RunReport *report, size_t run)
{
    TrajectoryError shown = report->errors[run];
    if (!run_report_is_certified(report, &report->errors[run])) {
        shown.max_in_horizon = NAN;
    }
    if (shown.is_floor) {
        snprintf(shown.in, sizeof shown.in, "%.*s (floor)", (int)(sizeof shown.in - 9),
                 report->errors[run].in);
    }
    return shown;
}

static void error_row(Table *table, const RunReport *report, size_t run)
{
    const TrajectoryError shown = error_shown(report, run);
    const bool is_certified = run_report_is_certified(report, &report->errors[run]);
    table_cell(table, "%s", report->runs[run]->backend);
    table_cell(table, "%s", shown.against);
    section_number_or_dash(table, is_certified, is_certified ? report->truth->uncertainty : 0.0);
    fields_table_row(ERROR_FIELDS, FIELD_TABLE, &shown, table);
    table_cell(table, run_report_is_limited_by_reference(report, &shown)
                          ? "limited by the reference"
                          : "");
}

// The errors that the motion's says nothing of.
static void write_force_errors(const RunReport *report, const Style *style, Text *text)
{
    const size_t columns = 1 + fields_table_width(ERROR_FIELDS, ERROR_OF_CONTACTS);
    Table *table = NULL;
    for (size_t i = 0; i < report->run_count; i++) {
        const TrajectoryError *error = &report->errors[i];
        if (!report->runs[i]->is_complete || !error->is_known || isnan(error->force_max)) {
            continue;
        }
        if (table == NULL) {
            section_heading("Error of contact forces at the samples, and of peaks", style, text);
            text_append(text, "\n");
            table = table_create(columns);
            table_fit(table, style->width);
            table_head(table, 0, "backend", "", TABLE_LEFT);
            fields_table_heads(ERROR_FIELDS, ERROR_OF_CONTACTS, 1, table);
        }
        table_cell(table, "%s", report->runs[i]->backend);
        fields_table_row(ERROR_FIELDS, ERROR_OF_CONTACTS, error, table);
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

static Table *begin_errors(const Style *style, Text *text)
{
    enum { BEFORE = 3 }; // columns that are no errors; one is behind them
    const size_t width = fields_table_width(ERROR_FIELDS, FIELD_TABLE);
    section_heading("Error at the samples, over the reference's largest value", style, text);
    text_append(text, "\n");
    Table *table = table_create(BEFORE + width + 1);
    table_fit(table, style->width);
    table_head(table, 0, "backend", "", TABLE_LEFT);
    table_head(table, 1, "against", "", TABLE_LEFT | TABLE_MINOR);
    table_head(table, 2, "reference +-", "1", TABLE_RIGHT);
    fields_table_heads(ERROR_FIELDS, FIELD_TABLE, BEFORE, table);
    table_head(table, BEFORE + width, "", "", TABLE_LEFT);
    return table;
}

void run_truth_errors(const RunReport *report, const Style *style, Text *text)
{
    Table *table = NULL;
    bool includes_play = false;
    bool has_floor = false;
    for (size_t i = 0; i < report->run_count; i++) {
        const TrajectoryError *error = &report->errors[i];
        if (!report->runs[i]->is_complete || !error->is_known) {
            continue;
        }
        if (table == NULL) {
            table = begin_errors(style, text);
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
    write_numbers(report, NUMBER_OWNER_ENERGY, NUMBER_PUSHED, 0, "Energy", NULL, is_any, style,
                  text);
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
