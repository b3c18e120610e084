// Gathers the few numbers of a run that are asked for first, and writes them.
//
// Drive torque of a body that turns about a fixed pivot, from the moments about it, with the forces
// F_k of its other joints at their points r_k:
//     T = I alpha + m r_c x a_c - sum of r_k x F_k + M_k - r_c x m g
#include "commands/run/run_overview.h"

#include "base/zeroed.h"
#include "contact/damping.h"
#include "contact/law.h"
#include "run/drive_torque.h"
#include "run/ideal.h"
#include "write/assumed.h"
#include "write/json_value.h"
#include "write/settled.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The run whose numbers are shown: the best that is known, with the play that the case has.
static const Trajectory *overview_run(const RunReport *report)
{
    const Trajectory *shown = NULL;
    bool is_truth = false;
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        const bool fits =
            !scenario_has_clearance(report->scenario) || options_backend_has_play(run->backend);
        if (run->is_complete && !is_truth && (fits || shown == NULL)) {
            shown = run;
            is_truth = strcmp(run->backend, OPTIONS_BACKENDS[BACKEND_REFERENCE]) == 0;
        }
    }
    return shown;
}

static double ratio_of(double value, double ideal)
{
    return ideal > 0.0 ? value / ideal : NAN;
}

static OverviewRow joint_row(const RunReport *report, const Trajectory *run, size_t number,
                             const IdealSizes *ideal)
{
    const Scenario *scenario = report->scenario;
    const Joint *joint = &scenario->linkage.joints[number];
    const JointExtremes *extremes = &run->joints[number];
    const JointUnits *units = joint_units(joint);
    const bool is_turn = linkage_is_torsional(joint);
    const bool is_ideal = ideal->is_known && !is_turn;
    const double turns =
        drive_is_steady(&scenario->linkage.driver)
            ? (run->duration_s - run->report_from_s) / linkage_period(&scenario->linkage)
            : 1.0;
    return (OverviewRow){
        .name = joint->name,
        .stem = is_turn ? "torque" : "force",
        .unit = units->force,
        .unit_key = units->force_key,
        .largest = extremes->force_max.value,
        .crank_rad = extremes->force_max.crank_rad,
        .time_s = extremes->force_max.time_s,
        .ratio = is_ideal ? ratio_of(extremes->force_max.value, ideal->force_max[number]) : NAN,
        .impacts = (double)extremes->impacts / turns,
        .contact = trajectory_contact_share(run, number),
        .deepest = extremes->penetration_max.value,
        .depth = units->length_key,
    };
}

static OverviewRow body_row(const Trajectory *run, size_t number, const IdealSizes *ideal)
{
    const BodyExtremes *extremes = &run->bodies[number];
    const Extreme *largest = fabs(extremes->alpha_min.value) > fabs(extremes->alpha_max.value)
                                 ? &extremes->alpha_min
                                 : &extremes->alpha_max;
    const double size = fabs(largest->value);
    return (OverviewRow){
        .name = run->linkage.bodies[number].name,
        .stem = "alpha_size",
        .unit = "rad/s^2",
        .unit_key = "rad_s2",
        .largest = size,
        .crank_rad = largest->crank_rad,
        .time_s = largest->time_s,
        .ratio = ideal->is_known ? ratio_of(size, ideal->alpha_max[number]) : NAN,
        .impacts = NAN,
        .contact = NAN,
        .deepest = NAN,
    };
}

// 1: the peak of a motion is another than that of the run where it is larger by so much: the same
// one is as exact in both
static const double OTHER_PEAK = 1e-4;

// Of several drives each has the name of its joint.
static OverviewRow drive_row(const Scenario *scenario, const Trajectory *run, size_t drive,
                             const IdealSizes *ideal)
{
    const Linkage *linkage = &scenario->linkage;
    const bool is_alone = linkage_drive_count(linkage) <= 1;
    OverviewRow row = {
        .name = is_alone ? "drive" : linkage->joints[linkage_drive(linkage, drive)->joint].name,
        .stem = "torque",
        .unit = "N m",
        .unit_key = "N_m",
        .crank_rad = NAN,
        .impacts = NAN,
        .contact = NAN,
        .deepest = NAN};
    for (size_t k = 0; k < run->sample_count; k++) {
        const double size = fabs(drive_torque_at(scenario, run, drive, k));
        if (run->times[k] >= run->report_from_s && size > row.largest) {
            row.largest = size;
            row.crank_rad = run->crank_angles[k];
            row.time_s = run->times[k];
        }
    }
    row.ratio = ideal->is_known ? ratio_of(row.largest, ideal->torque_max[drive]) : NAN;
    return row;
}

// The settled motion that rows are of where it is more than the run shows: it does not repeat, or
// takes several revolutions to. NULL where the run shows all, or knows no play.
static const SettledMotion *overview_motion(const Scenario *scenario, const Trajectory *run)
{
    const SettledStart *settled = &scenario->settled;
    const bool is_there = settled->motion_count > 0 && options_backend_has_play(run->backend);
    return is_there && settled->motions[0].period != 1 ? &settled->motions[0] : NULL;
}

// Makes the largest of a row that of the motion: over its period, of which the run may be a part,
// or of the distribution of one that does not repeat.
static void take_largest(const SettledMotion *motion, const SettledNumber *number, OverviewRow *row)
{
    const double ideal = row->largest / row->ratio;
    if (motion->period == 0) {
        row->spread = number;
    }
    if (motion->period == 0 || number->headline > row->largest * (1.0 + OTHER_PEAK)) {
        row->crank_rad = NAN;
        row->time_s = NAN;
    }
    row->largest = motion->period == 0 ? number->headline : fmax(row->largest, number->headline);
    row->ratio = row->largest / ideal;
}

static void take_joint(const SettledMotion *motion, const SettledJoint *did, OverviewRow *row)
{
    const bool is_random = motion->period == 0;
    take_largest(motion, &did->force, row);
    row->settled = is_random ? did : NULL;
    row->impacts = is_random ? did->impacts.median : did->impacts.mean;
    row->contact = is_random ? did->contact.median : did->contact.mean;
    row->deepest = is_random ? did->depth.headline : fmax(row->deepest, did->depth.headline);
}

static int by_size(const void *a, const void *b)
{
    const OverviewRow *first = a;
    const OverviewRow *second = b;
    return (first->largest < second->largest) - (first->largest > second->largest);
}

static void add_joints(const RunReport *report, const IdealSizes *ideal, Overview *overview)
{
    const Linkage *linkage = &report->scenario->linkage;
    overview->joints = zeroed(linkage->joint_count, sizeof *overview->joints);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (trajectory_feels_play(overview->run, &linkage->joints[i])) {
            OverviewRow row = joint_row(report, overview->run, i, ideal);
            if (overview->motion != NULL) {
                take_joint(overview->motion, &overview->motion->joints[i], &row);
            }
            overview->joints[overview->joint_count++] = row;
        }
    }
    qsort(overview->joints, overview->joint_count, sizeof *overview->joints, by_size);
}

static void add_bodies(const Linkage *linkage, const IdealSizes *ideal, Overview *overview)
{
    overview->bodies = zeroed(linkage->body_count, sizeof *overview->bodies);
    for (size_t i = 0; i < linkage->body_count; i++) {
        OverviewRow row = body_row(overview->run, i, ideal);
        if (linkage_is_driven(linkage, (int)i) || !(row.largest > 0.0)) {
            continue;
        }
        if (overview->motion != NULL) {
            take_largest(overview->motion, &overview->motion->alpha[i], &row);
        }
        overview->bodies[overview->body_count++] = row;
    }
    qsort(overview->bodies, overview->body_count, sizeof *overview->bodies, by_size);
}

Overview run_overview_make(const RunReport *report)
{
    const Scenario *scenario = report->scenario;
    Overview overview = {.run = overview_run(report)};
    if (overview.run == NULL) {
        return overview;
    }
    overview.motion = overview_motion(scenario, overview.run);
    IdealSizes ideal = ideal_sizes(scenario);
    add_joints(report, &ideal, &overview);
    add_bodies(&scenario->linkage, &ideal, &overview);
    overview.drive_count = drive_torque_count(&scenario->linkage);
    for (size_t i = 0; i < overview.drive_count; i++) {
        overview.drives[i] = drive_row(scenario, overview.run, i, &ideal);
        if (overview.motion != NULL) {
            take_largest(overview.motion, &overview.motion->drives[i], &overview.drives[i]);
        }
    }
    ideal_sizes_free(&ideal);
    return overview;
}

void run_overview_free(Overview *overview)
{
    free(overview->joints);
    free(overview->bodies);
}

// The table.

enum { NAME_MOST = 17, JOINTS_MOST = 5, JOINTS_LEAST = 3, BODIES_MOST = 3 };

// How many of each are shown, and on how wide a screen.
typedef struct OverviewRows {
    size_t joints;
    size_t bodies;
    size_t width; // characters; 0: any number
} OverviewRows;

static void cell_units(Table *table, double value, const char *unit)
{
    Text text;
    text_init(&text);
    if (isfinite(value)) {
        units_append(&text, value, unit);
    }
    table_cell(table, "%s", text.data != NULL ? text.data : "");
    text_finish(&text);
}

static void cell_number(Table *table, const char *format, double value)
{
    char words[32];
    snprintf(words, sizeof words, format, value);
    table_cell(table, "%s", isfinite(value) ? words : "");
}

static void cell_name(const char *name, Table *table)
{
    Text shown;
    text_init(&shown);
    text_append_shown(&shown, name);
    const bool is_long = strlen(shown.data) > NAME_MOST;
    table_cell(table, "%.*s%s", is_long ? NAME_MOST - 1 : NAME_MOST, shown.data,
               is_long ? "~" : "");
    text_finish(&shown);
}

static void overview_row(const OverviewRow *row, bool has_crank, Table *table)
{
    cell_name(row->name, table);
    cell_units(table, row->largest, row->unit);
    cell_number(table, has_crank ? "%.1f" : "%.4g",
                has_crank ? units_wrapped_deg(row->crank_rad) : row->time_s * UNITS_MS);
    cell_number(table, "%.3g", row->ratio);
    cell_number(table, "%.3g", row->impacts);
    cell_number(table, "%.1f %%", row->contact * UNITS_PERCENT);
    cell_units(table, row->deepest, row->depth);
}

// 1: half the width of the interval of the 95 % quantile, to its wider side, over that.
static double width_of(const SettledNumber *of)
{
    return fmax(of->high - of->headline, of->headline - of->low) / of->headline;
}

static void append_width(const SettledNumber *of, Text *text)
{
    const double percent = width_of(of) * UNITS_PERCENT;
    if (isfinite(percent)) {
        text_append(text, percent < 1.0 ? "<1" : "%.0f", percent);
    }
}

// The median or the largest, in the unit of the headline.
static void append_in_its_unit(const SettledNumber *of, double value, double low, double high,
                               Text *text)
{
    units_append_beside(text, value, low, high, of->headline, of->low, of->high);
}

static void append_headline(const SettledNumber *of, const char *unit, Text *text)
{
    if (isinf(of->high)) {
        text_append(text, "> ");
        units_append(text, of->low, unit);
    } else {
        units_append_within(text, of->headline, of->low, of->high, unit);
    }
}

// Times what it is with ideal joints; nothing where that is not known.
static void append_ratio(const SettledNumber *of, double ideal, Text *text)
{
    if (!isfinite(of->headline / ideal)) {
        return;
    }
    if (isinf(of->high)) {
        text_append(text, "> ");
        units_append_digits(text, of->low / ideal, of->low / ideal, of->low / ideal);
    } else {
        units_append_digits(text, of->headline / ideal, of->low / ideal, of->high / ideal);
    }
}

static void append_share(const SettledNumber *share, Text *text)
{
    units_append_digits(text, share->median * UNITS_PERCENT, share->median_low * UNITS_PERCENT,
                        share->median_high * UNITS_PERCENT);
    text_append(text, " %%");
}

void run_overview_cell(const OverviewRow *row, OverviewCell cell, Text *text)
{
    const SettledNumber *of = row->spread;
    const SettledJoint *joint = row->settled;
    switch (cell) {
    case OVERVIEW_HEADLINE:
        append_headline(of, row->unit, text);
        return;
    case OVERVIEW_WIDTH:
        append_width(of, text);
        return;
    case OVERVIEW_MEDIAN:
        append_in_its_unit(of, of->median, of->median_low, of->median_high, text);
        return;
    case OVERVIEW_MOST:
        append_in_its_unit(of, of->largest, of->largest, of->largest, text);
        return;
    case OVERVIEW_RATIO:
        append_ratio(of, of->headline / row->ratio, text);
        return;
    case OVERVIEW_IMPACTS:
        if (joint != NULL) {
            text_append(text, "%.3g", joint->impacts.median);
        }
        return;
    case OVERVIEW_CONTACT:
        if (joint != NULL) {
            append_share(&joint->contact, text);
        }
        return;
    case OVERVIEW_DEPTH:
        if (joint != NULL) {
            append_headline(&joint->depth, row->depth, text);
        }
        return;
    case OVERVIEW_CELL_COUNT:
        return;
    }
}

static void spread_row(const OverviewRow *row, Table *table)
{
    cell_name(row->name, table);
    for (OverviewCell cell = 0; cell < OVERVIEW_CELL_COUNT; cell++) {
        Text words;
        text_init(&words);
        run_overview_cell(row, cell, &words);
        table_cell(table, "%s", words.data);
        text_finish(&words);
    }
}

// The table of a run, or of a motion that repeats.
static Table *run_table(const Overview *overview, bool has_crank)
{
    const SectionHead heads[] = {
        {overview->joint_count > 0 ? "joint, body" : "body", "", TABLE_LEFT | TABLE_KEY},
        {"largest", "", TABLE_RIGHT},
        {"at", has_crank ? "deg" : "ms", TABLE_RIGHT},
        {"x ideal", "", TABLE_RIGHT},
        {"impacts", has_crank ? "a turn" : "", TABLE_RIGHT},
        {"contact", "", TABLE_RIGHT},
        {"deepest", "", TABLE_RIGHT},
    };
    return table_headed(sizeof heads / sizeof *heads, heads);
}

// That of a motion that does not repeat.
static Table *spread_table(const Overview *overview, bool has_crank, size_t width)
{
    const SectionHead heads[] = {
        {overview->joint_count > 0 ? "joint, body" : "body", "", TABLE_LEFT | TABLE_KEY},
        {"95 %", has_crank ? "of turns" : "", TABLE_RIGHT},
        {"+-", "%", TABLE_RIGHT},
        {"50 %", "", TABLE_RIGHT},
        {"most", "", TABLE_RIGHT},
        {"times", "ideal", TABLE_RIGHT | TABLE_MINOR},
        {"impacts", has_crank ? "a turn" : "", TABLE_RIGHT},
        {"contact", "", TABLE_RIGHT},
        {"deepest", "", TABLE_RIGHT},
    };
    Table *table = table_headed(sizeof heads / sizeof *heads, heads);
    table_fit(table, width);
    return table;
}

static void write_row(const Overview *overview, const OverviewRow *row, bool has_crank,
                      Table *table)
{
    if (run_overview_is_random(overview)) {
        spread_row(row, table);
    } else {
        overview_row(row, has_crank, table);
    }
}

// Returns whether --full is said to have what there is no room for.
static bool write_table(const Overview *overview, const Scenario *scenario, OverviewRows rows,
                        Text *text)
{
    const bool has_crank = drive_is_steady(&scenario->linkage.driver);
    const size_t joints = overview->joint_count < rows.joints ? overview->joint_count : rows.joints;
    const size_t bodies = overview->body_count < rows.bodies ? overview->body_count : rows.bodies;
    if (joints + bodies == 0) {
        return false;
    }
    Table *table = run_overview_is_random(overview) ? spread_table(overview, has_crank, rows.width)
                                                    : run_table(overview, has_crank);
    for (size_t i = 0; i < joints; i++) {
        write_row(overview, &overview->joints[i], has_crank, table);
    }
    for (size_t i = 0; i < bodies; i++) {
        write_row(overview, &overview->bodies[i], has_crank, table);
    }
    for (size_t i = 0; i < overview->drive_count; i++) {
        write_row(overview, &overview->drives[i], has_crank, table);
    }
    table_write(table, text);
    table_destroy(table);
    const size_t more_joints = overview->joint_count - joints;
    const size_t more_bodies = overview->body_count - bodies;
    if (more_joints > 0) {
        text_append(text, "  And %zu more joint%s with play", more_joints,
                    more_joints > 1 ? "s" : "");
    }
    if (more_bodies > 0) {
        text_append(text, "%s %zu more %s", more_joints > 0 ? "," : "  And", more_bodies,
                    more_bodies > 1 ? "bodies" : "body");
    }
    if (more_joints + more_bodies > 0) {
        text_append(text, ": --full shows them.\n");
    }
    return more_joints + more_bodies > 0;
}

// How sure it is.

static void append_paragraph(const char *words, Text *text)
{
    Text own;
    text_init(&own);
    text_append(&own, "  %s", words);
    screen_sentence(&own, text);
}

// Of a run that was not held against the reference here.
static void append_unknown_error(const RunReport *report, const Trajectory *run, Text *text)
{
    if (run->trials > 0 && !run->is_short) {
        text_append(text, ": off by %.2g at the most.", run->error_estimate);
    } else if (run_report_has_truth(report)) {
        text_append(text, ".");
    } else {
        text_append(text, ": how far off is not known, for the reference was not run.");
    }
}

// What the tolerance would take that run.budget did not allow, or up to when it is held alone, and
// where that is for the reference, that.
static void append_wanted(const RunReport *report, const Trajectory *run, Text *text)
{
    const double tolerance = report->scenario->run.tolerance;
    if (run->wanted_s > 0.0) {
        text_append(text, "; %.3g would take some ", tolerance);
        units_append(text, run->wanted_s, "s");
        text_append(text, " (--budget none)");
    } else if (run->is_short) {
        text_append(text, "; %.3g is NOT HELD beyond %.4g ms", tolerance,
                    run->estimate_s * UNITS_MS);
    } else if (run->estimate_is_cut) {
        text_append(text, "; %.3g is held to %.4g ms, to where the reference is certain enough",
                    tolerance, run->estimate_s * UNITS_MS);
    }
}

static void append_error(const RunReport *report, size_t number, Text *text)
{
    const Trajectory *run = report->runs[number];
    const TrajectoryError *error = &report->errors[number];
    text_append(text, "%s, ", run->label[0] != '\0' ? run->label : run->backend);
    if (run->step_s > 0.0) {
        text_append(text, "step ");
        units_append(text, run->step_s, "s");
        text_append(text, ", ");
    }
    text_append(text, "%zu steps", run->steps);
    if (!error->is_known) {
        append_unknown_error(report, run, text);
        return;
    }
    const double motion = isfinite(error->max_in_horizon) ? error->max_in_horizon : error->max;
    text_append(text, ": off by %.2g in motion", motion);
    if (isfinite(error->force_max_in_horizon)) {
        text_append(text, ", %.2g in forces", error->force_max_in_horizon);
    }
    append_wanted(report, run, text);
    text_append(text, ".");
}

// How far each engine is off; which runs failed.
static void write_engines(const RunReport *report, Text *text)
{
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        Text words;
        text_init(&words);
        if (!run->is_complete) {
            text_append(&words, "%s FAILED: %.300s", run->backend, run->message);
        } else if (strcmp(run->backend, OPTIONS_BACKENDS[BACKEND_ODE]) == 0 ||
                   run->engine.name[0] != '\0') {
            append_error(report, i, &words);
        }
        if (words.length > 0) {
            append_paragraph(words.data, text);
        }
        text_finish(&words);
    }
}

static void write_certainty(const RunReport *report, Text *text)
{
    if (!run_report_has_truth(report)) {
        return;
    }
    const Truth *truth = report->truth;
    char words[512];
    if (truth->message[0] != '\0') {
        snprintf(words, sizeof words, "The reference is not certified: %.400s", truth->message);
    } else if (truth->is_limited) {
        snprintf(words, sizeof words,
                 "The motion cannot be predicted beyond %.4g ms; to there the reference is right "
                 "to %.2g.",
                 truth->horizon_s * UNITS_MS, truth->uncertainty);
    } else {
        snprintf(words, sizeof words, "The reference is right to %.2g through the whole run.",
                 truth->uncertainty);
    }
    append_paragraph(words, text);
}

// What the runs took: the one line that two runs of a case do not share.
static void write_time(const RunReport *report, Text *text)
{
    Text words;
    text_init(&words);
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        if (run->is_complete) {
            text_append(&words, "%s%s ", words.length > 0 ? ", " : "Time: ", run->backend);
            units_append(&words, run->wall_s, "s");
        }
    }
    if (words.length > 0) {
        append_paragraph(words.data, text);
    }
    text_finish(&words);
}

// 1: of a restitution, what a law may be off by without a word
static const double RESTITUTION_NEAR = 0.005;

// What a damping law gives back of an impact.
typedef struct Rebound {
    DampingKind damping;
    double asked;     // 1, the restitution
    double delivered; // 1
} Rebound;

// The first joint whose damping law does not give back what is asked of it; false where there is
// none.
static bool find_rebound(const Scenario *scenario, Rebound *found)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (!linkage_has_play(joint) || scenario->contact.model != CONTACT_IMPACT) {
            continue;
        }
        const ContactOptions own = law_options(&scenario->contact, joint);
        const double chi = damping_factor(own.damping, own.restitution);
        *found = (Rebound){own.damping, own.restitution, damping_delivered(chi)};
        if (chi > 0.0 && own.damping != DAMPING_DISSIPATION &&
            fabs(found->delivered - found->asked) > RESTITUTION_NEAR) {
            return true;
        }
    }
    return false;
}

static void write_restitution(const Scenario *scenario, Text *text)
{
    Rebound rebound;
    if (find_rebound(scenario, &rebound)) {
        char words[256];
        snprintf(words, sizeof words,
                 "Of the restitution asked for, %.3g, damping %s gives back %.3g; damping exact "
                 "gives back what is asked for.",
                 rebound.asked, OPTIONS_DAMPINGS[rebound.damping], rebound.delivered);
        append_paragraph(words, text);
    }
}

static void write_assumed(const Scenario *scenario, Text *text)
{
    Text assumed;
    text_init(&assumed);
    assumed_text(scenario, &assumed);
    if (assumed.length > 0 && scenario_has_clearance(scenario)) {
        Text words;
        text_init(&words);
        text_append(&words, "Assumed: %s.", assumed.data);
        append_paragraph(words.data, text);
        text_finish(&words);
    }
    text_finish(&assumed);
}

// What the columns of a motion that does not repeat are.
static void write_columns(const RunReport *report, Text *text)
{
    const Trajectory *run = overview_run(report);
    const SettledMotion *motion = run != NULL ? overview_motion(report->scenario, run) : NULL;
    if (motion == NULL || motion->period > 0) {
        return;
    }
    const bool has_crank = drive_is_steady(&report->scenario->linkage.driver);
    char words[128];
    snprintf(words, sizeof words,
             "95 %%, 50 %%: quantiles of a %s's largest; +-: 95 %% interval; most: in %zu.",
             has_crank ? "turn" : "period", motion->counted);
    append_paragraph(words, text);
}

// What is known with the reference: how the motion settled, how sure that is, what was assumed.
static void write_answer(const RunReport *report, Text *text)
{
    settled_sentences(report->scenario, true, text);
    write_columns(report, text);
    write_certainty(report, text);
    write_restitution(report->scenario, text);
    write_assumed(report->scenario, text);
}

// What takes longer: other damping, and the engines.
static void write_beside(const RunReport *report, Text *text)
{
    settled_damping_sentence(report->scenario, text);
    write_engines(report, text);
    write_time(report, text);
}

void run_overview_sentences(const RunReport *report, Text *text)
{
    write_answer(report, text);
    write_beside(report, text);
}

// The table, and below it what is known with the reference. Returns whether --full is said to have
// what there is no room for.
static bool write_table_and_answer(const RunReport *report, const Overview *overview,
                                   OverviewRows rows, Text *text)
{
    text_append(text, "\n");
    size_t start = text->length;
    settled_louder(report->scenario, "below", text);
    text_fold_behind(text, start, STYLE_WIDTH);
    const bool is_full_named = write_table(overview, report->scenario, rows, text);
    start = text->length;
    write_answer(report, text);
    text_fold_behind(text, start, STYLE_WIDTH);
    return is_full_named;
}

static size_t count_lines(const char *text)
{
    size_t lines = 0;
    for (; *text != '\0'; text++) {
        lines += *text == '\n' ? 1 : 0;
    }
    return lines;
}

enum { TITLE_LINES = 3, ENGINE_LINES = 2, BUDGET_LINES = 1, DAMPING_LINES = 2, LAST_LINES = 2 };

// How many lines the rest will take at the most, before it is known.
static size_t lines_of_rest(const Scenario *scenario)
{
    const RunOptions *options = &scenario->run;
    size_t lines = LAST_LINES;
    lines +=
        scenario->settled.motion_count > 0 && scenario_has_clearance(scenario) ? DAMPING_LINES : 0;
    for (size_t i = 0; i < options->backend_count; i++) {
        const BackendKind backend = options->backends[i];
        const bool is_engine = backend != BACKEND_ANALYTIC && backend != BACKEND_REFERENCE;
        const bool may_be_cut = options->step == 0.0 && options->budget > 0.0;
        lines += is_engine ? ENGINE_LINES + (may_be_cut ? BUDGET_LINES : 0) : 0;
    }
    return lines;
}

// Appends the answer on as many lines as leave room for the rest. Returns whether it says what
// --full is for.
static bool append_answer(const RunReport *report, size_t width, Text *text)
{
    Overview overview = run_overview_make(report);
    OverviewRows rows = {JOINTS_MOST, BODIES_MOST, width};
    const size_t most = RUN_OVERVIEW_LINES - TITLE_LINES;
    bool is_full_named = false;
    for (;;) {
        Text own;
        text_init(&own);
        is_full_named = write_table_and_answer(report, &overview, rows, &own);
        const bool fits = count_lines(own.data) + lines_of_rest(report->scenario) <= most;
        // bodies first, then joints: what is left out is said, and --full has it
        if (fits || (rows.bodies == 0 && rows.joints == JOINTS_LEAST)) {
            text_append(text, "%s", own.data);
            text_finish(&own);
            break;
        }
        text_finish(&own);
        if (rows.bodies > 0) {
            rows.bodies--;
        } else {
            rows.joints--;
        }
    }
    run_overview_free(&overview);
    return is_full_named;
}

void run_overview_answer(const void *of, const Style *style, Text *text)
{
    const RunReport *report = of;
    section_title(report->scenario->title, scenario_path(report->scenario), style, text);
    append_answer(report, style->width, text);
}

void run_overview_write(const RunReport *report, size_t width, bool is_alone, Text *text)
{
    const bool is_full_named = append_answer(report, width, text);
    const size_t start = text->length;
    write_beside(report, text);
    text_fold_behind(text, start, STYLE_WIDTH);
    if (is_alone && !is_full_named) {
        text_append(text, "  --full: all tables\n");
    }
}

void run_overview_screen(const void *of, const Style *style, Text *text)
{
    const RunReport *report = of;
    section_title(report->scenario->title, scenario_path(report->scenario), style, text);
    run_overview_write(report, style->width, true, text);
}

static void largest_json(json_t *object, const OverviewRow *row)
{
    char key[64];
    snprintf(key, sizeof key, "%s_max_%s", row->stem, row->unit_key);
    json_value_set(object, key, row->largest);
    if (row->spread != NULL) {
        settled_json_number(object, row->stem, row->unit_key, row->spread);
        json_value_set(object, "width", width_of(row->spread));
    }
    snprintf(key, sizeof key, "%s_max_crank_deg", row->stem);
    json_value_set(object, key, units_wrapped_deg(row->crank_rad));
    snprintf(key, sizeof key, "%s_max_time_s", row->stem);
    json_value_set(object, key, row->time_s);
    json_value_set(object, "ratio_to_ideal", row->ratio);
}

static json_t *row_json(const OverviewRow *row)
{
    json_t *object = json_object();
    json_object_set_new(object, "name", json_value_text(row->name));
    largest_json(object, row);
    if (row->depth != NULL) {
        json_value_set(object, "impacts_per_revolution", row->impacts);
        json_value_set(object, "contact_fraction", row->contact);
        char key[64];
        snprintf(key, sizeof key, "penetration_max_%s", row->depth);
        json_value_set(object, key, row->deepest);
        if (row->settled != NULL) {
            settled_json_number(object, "penetration", row->depth, &row->settled->depth);
        }
    }
    return object;
}

void run_overview_json(json_t *object, const RunReport *report)
{
    Overview overview = run_overview_make(report);
    json_t *joints = json_array();
    json_t *bodies = json_array();
    for (size_t i = 0; i < overview.joint_count; i++) {
        json_array_append_new(joints, row_json(&overview.joints[i]));
    }
    for (size_t i = 0; i < overview.body_count; i++) {
        json_array_append_new(bodies, row_json(&overview.bodies[i]));
    }
    json_t *made = json_object();
    json_object_set_new(made, "backend",
                        overview.run != NULL ? json_string(overview.run->backend) : json_null());
    if (run_overview_is_random(&overview)) {
        json_object_set_new(made, "counted_revolutions",
                            json_integer((json_int_t)overview.motion->counted));
        json_value_set(made, "quantile", SETTLED_QUANTILE);
    }
    json_object_set_new(made, "joints", joints);
    json_object_set_new(made, "bodies", bodies);
    json_object_set_new(made, "drive",
                        overview.drive_count > 0 ? row_json(&overview.drives[0]) : json_null());
    if (overview.drive_count > 1) {
        json_t *drives = json_array();
        for (size_t i = 0; i < overview.drive_count; i++) {
            json_array_append_new(drives, row_json(&overview.drives[i]));
        }
        json_object_set_new(made, "drives", drives);
    }
    Rebound rebound;
    const bool is_other = find_rebound(report->scenario, &rebound);
    json_value_set(made, "restitution_delivered", is_other ? rebound.delivered : NAN);
    json_object_set_new(object, "overview", made);
    run_overview_free(&overview);
}
