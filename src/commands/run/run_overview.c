// Gathers the few numbers of a run that are asked for first, and writes them.
//
// Drive torque of a body that turns about a fixed pivot, from the moments about it, with the forces
// F_k of its other joints at their points r_k:
//     T = I alpha + m r_c x a_c - sum of r_k x F_k + M_k - r_c x m g
#include "commands/run/run_overview.h"

#include "base/zeroed.h"
#include "casefile/casefile.h"
#include "casefile/schema.h"
#include "contact/damping.h"
#include "contact/law.h"
#include "measure/creep.h"
#include "run/bushing_load.h"
#include "run/drive_torque.h"
#include "run/ideal.h"
#include "write/assumed.h"
#include "write/json_value.h"
#include "write/settled.h"
#include "write/spread.h"
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

// Gives a row a quantity whose key is made of a stem and a part.
static OverviewCell *set_cell(OverviewRow *row, OverviewQuantity quantity, const char *stem,
                              const char *part, const char *unit_key, const char *unit,
                              double value)
{
    OverviewCell *cell = &row->cells[quantity];
    *cell = (OverviewCell){.is_there = true, .unit_key = unit_key, .unit = unit, .value = value};
    snprintf(cell->key, sizeof cell->key, "%s%s", stem, part);
    return cell;
}

// What stands at a time: its size, where and when that was, and how it is to that with ideal
// joints, NAN where that is not known.
static void set_largest(OverviewRow *row, const char *stem, const char *unit_key, const char *unit,
                        Extreme largest, double ideal)
{
    set_cell(row, OVERVIEW_LARGEST, stem, "_max", unit_key, unit, largest.value);
    set_cell(row, OVERVIEW_CRANK, stem, "_max_crank", "deg", NULL, largest.crank_rad);
    set_cell(row, OVERVIEW_TIME, stem, "_max_time", "s", NULL, largest.time_s);
    set_cell(row, OVERVIEW_RATIO, "ratio_to_ideal", "", NULL, NULL,
             ideal > 0.0 ? largest.value / ideal : NAN);
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
    OverviewRow row = {.name = joint->name};
    set_largest(&row, is_turn ? "torque" : "force", units->force_key, units->force,
                extremes->force_max, is_ideal ? ideal->force_max[number] : NAN);
    if (trajectory_feels_play(run, joint)) {
        set_cell(&row, OVERVIEW_IMPACTS, "impacts_per_revolution", "", NULL, NULL,
                 (double)extremes->impacts / turns);
        set_cell(&row, OVERVIEW_CONTACT, "contact_fraction", "", NULL, NULL,
                 trajectory_contact_share(run, number));
        set_cell(&row, OVERVIEW_DEEPEST, "penetration", "_max", units->length_key,
                 units->length_key, extremes->penetration_max.value);
    }
    return row;
}

static OverviewRow body_row(const Trajectory *run, size_t number, const IdealSizes *ideal)
{
    const BodyExtremes *extremes = &run->bodies[number];
    Extreme largest = fabs(extremes->alpha_min.value) > fabs(extremes->alpha_max.value)
                          ? extremes->alpha_min
                          : extremes->alpha_max;
    largest.value = fabs(largest.value);
    OverviewRow row = {.name = run->linkage.bodies[number].name};
    set_largest(&row, "alpha_size", "rad_s2", "rad/s^2", largest,
                ideal->is_known ? ideal->alpha_max[number] : NAN);
    return row;
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
        .name = is_alone ? "drive" : linkage->joints[linkage_drive(linkage, drive)->joint].name};
    Extreme largest = {.value = 0.0, .time_s = 0.0, .crank_rad = NAN};
    for (size_t k = 0; k < run->sample_count; k++) {
        const double size = fabs(drive_torque_at(scenario, run, drive, k));
        if (run->times[k] >= run->report_from_s && size > largest.value) {
            largest = (Extreme){size, run->times[k], run->crank_angles[k]};
        }
    }
    set_largest(&row, "torque", "N_m", "N m", largest,
                ideal->is_known ? ideal->torque_max[drive] : NAN);
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

static void set_interval(OverviewCell *cell, double value, double low, double high)
{
    cell->value = value;
    cell->has_interval = true;
    cell->low = low;
    cell->high = high;
}

// 1: half the width of the interval of the 95 % quantile, to its wider side, over that.
static double width_of(const SettledNumber *of)
{
    return fmax(of->high - of->headline, of->headline - of->low) / of->headline;
}

// Makes a cell that of the distribution of a motion that does not repeat, with cells of its median
// and its largest.
static void spread_cell(OverviewRow *row, OverviewQuantity quantity, OverviewQuantity median,
                        OverviewQuantity most, const SettledNumber *number)
{
    OverviewCell *cell = &row->cells[quantity];
    char stem[OVERVIEW_KEY_SIZE / 2];
    snprintf(stem, sizeof stem, "%.*s", (int)(strlen(cell->key) - strlen("_max")), cell->key);
    set_interval(cell, number->headline, number->low, number->high);
    set_interval(set_cell(row, median, stem, "_median", cell->unit_key, cell->unit, NAN),
                 number->median, number->median_low, number->median_high);
    set_cell(row, most, stem, "_largest", cell->unit_key, cell->unit, number->largest);
}

// Makes the largest of a row that of the motion: over its period, of which the run may be a part,
// or of the distribution of one that does not repeat.
static void take_largest(const SettledMotion *motion, const SettledNumber *number, OverviewRow *row)
{
    OverviewCell *largest = &row->cells[OVERVIEW_LARGEST];
    OverviewCell *ratio = &row->cells[OVERVIEW_RATIO];
    const double ideal = largest->value / ratio->value;
    if (motion->period == 0 || number->headline > largest->value * (1.0 + OTHER_PEAK)) {
        row->cells[OVERVIEW_CRANK].value = NAN;
        row->cells[OVERVIEW_TIME].value = NAN;
    }
    if (motion->period == 0) {
        spread_cell(row, OVERVIEW_LARGEST, OVERVIEW_MEDIAN, OVERVIEW_MOST, number);
        set_cell(row, OVERVIEW_WIDTH, "width", "", NULL, NULL, width_of(number));
        set_interval(ratio, NAN, number->low / ideal, number->high / ideal);
    } else {
        largest->value = fmax(largest->value, number->headline);
    }
    ratio->value = largest->value / ideal;
}

static void take_joint(const SettledMotion *motion, const SettledJoint *did, OverviewRow *row)
{
    OverviewCell *cells = row->cells;
    const bool is_random = motion->period == 0;
    take_largest(motion, &did->force, row);
    cells[OVERVIEW_IMPACTS].value = is_random ? did->impacts.median : did->impacts.mean;
    if (is_random) {
        set_interval(&cells[OVERVIEW_CONTACT], did->contact.median, did->contact.median_low,
                     did->contact.median_high);
        spread_cell(row, OVERVIEW_DEEPEST, OVERVIEW_DEEPEST_MEDIAN, OVERVIEW_DEEPEST_MOST,
                    &did->depth);
    } else {
        cells[OVERVIEW_CONTACT].value = did->contact.mean;
        cells[OVERVIEW_DEEPEST].value = fmax(cells[OVERVIEW_DEEPEST].value, did->depth.headline);
    }
}

static int by_size(const void *a, const void *b)
{
    const double first = ((const OverviewRow *)a)->cells[OVERVIEW_LARGEST].value;
    const double second = ((const OverviewRow *)b)->cells[OVERVIEW_LARGEST].value;
    return (first < second) - (first > second);
}

static void add_joints(const RunReport *report, const IdealSizes *ideal, Overview *overview)
{
    const Linkage *linkage = &report->scenario->linkage;
    overview->joints = zeroed(linkage->joint_count, sizeof *overview->joints);
    overview->ideal_joints = zeroed(linkage->joint_count, sizeof *overview->ideal_joints);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        OverviewRow row = joint_row(report, overview->run, i, ideal);
        if (!trajectory_feels_play(overview->run, &linkage->joints[i])) {
            // what the limits of a pivot would bear is not what the pivot does
            if (!linkage_is_torsional(&linkage->joints[i]) &&
                isfinite(row.cells[OVERVIEW_LARGEST].value)) {
                overview->ideal_joints[overview->ideal_count++] = row;
            }
            continue;
        }
        if (overview->motion != NULL) {
            take_joint(overview->motion, &overview->motion->joints[i], &row);
        }
        overview->joints[overview->joint_count++] = row;
    }
    qsort(overview->joints, overview->joint_count, sizeof *overview->joints, by_size);
    qsort(overview->ideal_joints, overview->ideal_count, sizeof *overview->ideal_joints, by_size);
}

static void add_bushings(Overview *overview)
{
    const Linkage *linkage = &overview->run->linkage;
    overview->bushings = zeroed(linkage->bushing_count, sizeof *overview->bushings);
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        OverviewRow row = {.name = linkage->bushings[i].name};
        set_largest(&row, "force", "N", "N", bushing_extremes(overview->run, i).force, NAN);
        overview->bushings[overview->bushing_count++] = row;
    }
    qsort(overview->bushings, overview->bushing_count, sizeof *overview->bushings, by_size);
}

// Bodies that turn, but for those that are driven.
static void add_bodies(const RunReport *report, const IdealSizes *ideal, Overview *overview)
{
    const Linkage *linkage = &report->scenario->linkage;
    const double rounding = run_floor_of(report->scenario, overview->run).spinning_up;
    overview->bodies = zeroed(linkage->body_count, sizeof *overview->bodies);
    for (size_t i = 0; i < linkage->body_count; i++) {
        OverviewRow row = body_row(overview->run, i, ideal);
        if (linkage_is_driven(linkage, (int)i) || !(row.cells[OVERVIEW_LARGEST].value > rounding)) {
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
    add_bushings(&overview);
    add_bodies(report, &ideal, &overview);
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
    free(overview->ideal_joints);
    free(overview->bushings);
    free(overview->bodies);
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

// 1: from here on it is said which velocity is off, where it is one of a joint, which no plot has
static const double ERROR_NAMED = 0.01;

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
    const bool is_of_body = strncmp(error->in, "omega of", strlen("omega of")) == 0 ||
                            strncmp(error->in, "velocity of", strlen("velocity of")) == 0;
    text_append(text, ": off by %.2g of the largest ", motion);
    text_append_shown(text, motion > ERROR_NAMED && !is_of_body ? error->in : "velocities");
    if (isfinite(error->force_max_in_horizon)) {
        text_append(text, ", %.2g of the largest forces", error->force_max_in_horizon);
    }
    append_wanted(report, run, text);
    text_append(text, ".");
}

// Whether the case or the command asks for ODE: names backends, a key of ODE's, the step or the
// error of runs, or expects something of ODE's. Of a case that does not, ODE runs too, but how far
// it is off stands in --full.
static bool is_ode_asked(const Scenario *scenario)
{
    static const char *const KEYS[] = {"run.backends", "run.step", "run.tolerance"};
    bool is_asked = casefile_gives(scenario, "ode.");
    for (size_t i = 0; i < scenario->expectation_count; i++) {
        is_asked |= scenario->expectations[i].backend == BACKEND_ODE;
    }
    for (size_t i = 0; i < scenario->key_count; i++) {
        for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS; k++) {
            is_asked |= strcmp(SCHEMA_ROWS[scenario->keys[i].row].path, KEYS[k]) == 0;
        }
    }
    return is_asked;
}

// Whether the first screen leaves out ODE where it goes well.
static bool is_ode_left_out(const RunReport *report)
{
    return run_report_has_truth(report) && !is_ode_asked(report->scenario);
}

// Whether the first screen leaves out a run that went well.
static bool is_unasked(const RunReport *report, const Trajectory *run)
{
    return run->is_complete && strcmp(run->backend, OPTIONS_BACKENDS[BACKEND_ODE]) == 0 &&
           is_ode_left_out(report);
}

// How far each engine is off; which runs failed.
static void write_engines(const RunReport *report, Text *text)
{
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        Text words;
        text_init(&words);
        if (is_unasked(report, run)) {
            // no word
        } else if (!run->is_complete) {
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
                 "The motion cannot be predicted beyond %.4g ms; up to there the reference is "
                 "right to %.2g.",
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
        if (run->is_complete && !is_unasked(report, run)) {
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
        snprintf(
            words, sizeof words, "Damping %s turns restitution %.3g into %.3g; exact keeps %.3g.",
            OPTIONS_DAMPINGS[rebound.damping], rebound.asked, rebound.delivered, rebound.asked);
        append_paragraph(words, text);
    }
}

// Where friction is regularized, and that decides.
static void write_creep(const RunReport *report, Text *text)
{
    const Trajectory *run = overview_run(report);
    double share;
    const int joint = run != NULL ? creep_worst(report->scenario, run, &share) : -1;
    if (joint < 0) {
        return;
    }
    const Joint *of = &run->linkage.joints[joint];
    Text words;
    text_init(&words);
    text_append(&words, "Friction of %s creeps: it slides slower than ", of->name);
    units_append(&words, law_options(&report->scenario->contact, of).friction_speed, "m/s");
    text_append(&words,
                " for %.3g %% of the time in which it is loaded. friction-law: stick holds.",
                100.0 * share);
    append_paragraph(words.data, text);
    text_finish(&words);
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

// The largest force in a joint: of the settled motion, where the run is a part of it.
static double force_most(const Trajectory *run, const SettledMotion *motion, size_t joint)
{
    const double largest = run->joints[joint].force_max.value;
    const double settled = motion != NULL ? motion->joints[joint].force.headline : 0.0;
    return motion != NULL && motion->period == 0 ? settled : fmax(largest, settled);
}

// What the pins between two bodies bear.
typedef struct Shared {
    size_t count;
    double least; // N, of what each bears at most
    double most;  // N
    double mean;  // N
} Shared;

static Shared find_shared(const Trajectory *run, const SettledMotion *motion, size_t joint)
{
    const Linkage *linkage = &run->linkage;
    Shared shared = {.least = INFINITY};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_shares_bodies(&linkage->joints[joint], &linkage->joints[i])) {
            const double force = force_most(run, motion, i);
            shared.least = fmin(shared.least, force);
            shared.most = fmax(shared.most, force);
            shared.mean += (force - shared.mean) / (double)++shared.count;
        }
    }
    return shared;
}

// How evenly pins between the same two bodies share what these bear: of those that bear most.
static void write_shared(const RunReport *report, Text *text)
{
    const Trajectory *run = overview_run(report);
    if (run == NULL || !options_backend_has_play(run->backend)) {
        return;
    }
    const Linkage *linkage = &run->linkage;
    const SettledMotion *motion = overview_motion(report->scenario, run);
    Shared largest = {.most = 0.0};
    size_t of = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Shared shared = find_shared(run, motion, i);
        if (shared.count > 1 && shared.most > largest.most) {
            largest = shared;
            of = i;
        }
    }
    if (largest.count == 0) {
        return;
    }
    Text words;
    text_init(&words);
    text_append(&words, "The %zu pins between %s and %s bear ", largest.count,
                linkage_body_name(linkage, linkage->joints[of].body_a),
                linkage_body_name(linkage, linkage->joints[of].body_b));
    units_append(&words, largest.least, "N");
    text_append(&words, " to ");
    units_append(&words, largest.most, "N");
    text_append(&words, " at most each; the most loaded %.3g times their mean.",
                largest.most / largest.mean);
    append_paragraph(words.data, text);
    text_finish(&words);
}

// Whether both ends of the intervals of a motion's quantiles are known: all are of as many
// revolutions.
static bool has_both_ends(const Trajectory *run, const SettledMotion *motion)
{
    bool has = false;
    for (size_t i = 0; i < run->linkage.joint_count; i++) {
        has |= trajectory_feels_play(run, &run->linkage.joints[i]) &&
               isfinite(motion->joints[i].force.high);
    }
    return has;
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
             "95 %%, 50 %%: quantiles of a %s's largest; %s 95 %% interval; most: in %zu.",
             has_crank ? "turn" : "period",
             has_both_ends(run, motion) ? "+-:" : ">: low end of the", motion->counted);
    append_paragraph(words, text);
}

// What is known with the reference: how the motion settled, how sure that is, what was assumed.
static void write_answer(const RunReport *report, Text *text)
{
    settled_sentences(report->scenario, true, text);
    write_columns(report, text);
    write_shared(report, text);
    write_certainty(report, text);
    write_restitution(report->scenario, text);
    write_creep(report, text);
    write_assumed(report->scenario, text);
}

// What takes longer: other inputs and assumptions, and the engines.
static void write_beside(const RunReport *report, Text *text)
{
    spread_sentences(report->spread, text);
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
    const bool is_full_named = run_overview_table(overview, report->scenario, rows, text);
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

enum { TITLE_LINES = 3, ENGINE_LINES = 2, BUDGET_LINES = 1, SPREAD_LINES = 6 };
enum { TIME_LINES = 1, FULL_LINES = 1 };

// How many lines the rest will take at the most, before it is known.
static size_t lines_of_rest(const RunReport *report)
{
    const Scenario *scenario = report->scenario;
    const RunOptions *options = &scenario->run;
    size_t lines = TIME_LINES + FULL_LINES;
    lines += !report->is_quick && spread_is_of(scenario) ? SPREAD_LINES : 0;
    for (size_t i = 0; i < options->backend_count; i++) {
        const BackendKind backend = options->backends[i];
        const bool is_engine = backend != BACKEND_ANALYTIC && backend != BACKEND_REFERENCE;
        const bool may_be_cut = options->step == 0.0 && options->budget > 0.0;
        const bool is_said = backend != BACKEND_ODE || !is_ode_left_out(report);
        lines += is_engine && is_said ? ENGINE_LINES + (may_be_cut ? BUDGET_LINES : 0) : 0;
    }
    return lines;
}

// Of joints with and without play together as many as people look at.
enum { JOINTS_MOST = 5, JOINTS_LEAST = 3, NAMED_LEAST = 2, BUSHINGS_MOST = 4, BODIES_MOST = 3 };

// Leaves out one row more, which --full has: bodies but for one first, then joints without play but
// for one, then those two, names of joints without play but for two, bushings, and joints with
// play. Returns false where no more are left out.
static bool leave_out_one(OverviewRows *rows)
{
    size_t *const kinds[] = {&rows->bodies, &rows->ideals,   &rows->bodies, &rows->ideals,
                             &rows->named,  &rows->bushings, &rows->joints};
    static const size_t LEAST[] = {1, 1, 0, 0, NAMED_LEAST, 0, JOINTS_LEAST};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (*kinds[i] > LEAST[i]) {
            --*kinds[i];
            return true;
        }
    }
    return false;
}

// Appends the answer on as many lines as leave room for the rest. Returns whether it says what
// --full is for.
static bool append_answer(const RunReport *report, size_t width, Text *text)
{
    Overview overview = run_overview_make(report);
    const size_t felt = overview.joint_count < JOINTS_MOST ? overview.joint_count : JOINTS_MOST;
    const size_t ideals = JOINTS_MOST - felt;
    OverviewRows rows = {.joints = felt,
                         .ideals = ideals,
                         .named = ideals > NAMED_LEAST ? ideals : NAMED_LEAST,
                         .bushings = BUSHINGS_MOST,
                         .bodies = BODIES_MOST,
                         .width = width};
    const size_t most = RUN_OVERVIEW_LINES - TITLE_LINES;
    bool is_full_named = false;
    for (;;) {
        Text own;
        text_init(&own);
        is_full_named = write_table_and_answer(report, &overview, rows, &own);
        // what is named above needs no line at the end
        const size_t rest = lines_of_rest(report) - (is_full_named ? FULL_LINES : 0);
        const bool fits = count_lines(own.data) + rest <= most;
        if (fits || !leave_out_one(&rows)) {
            text_append(text, "%s", own.data);
            text_finish(&own);
            break;
        }
        text_finish(&own);
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

// The numbers of a cell: of force_max and N force_max_N, and with an interval that JSON has
// force_max_low_N and force_max_high_N.
static void cell_json(json_t *object, const OverviewCell *cell, OverviewQuantity quantity)
{
    static const char *const PARTS[] = {"", "_low", "_high"};
    const double values[] = {quantity == OVERVIEW_CRANK ? units_wrapped_deg(cell->value)
                                                        : cell->value,
                             cell->low, cell->high};
    // of shares and ratios the interval decides on digits alone
    const bool has_ends = cell->has_interval && cell->unit_key != NULL;
    for (size_t i = 0; i < (has_ends ? 3 : 1); i++) {
        char key[2 * OVERVIEW_KEY_SIZE];
        snprintf(key, sizeof key, "%s%s%s%s", cell->key, PARTS[i],
                 cell->unit_key != NULL ? "_" : "", cell->unit_key != NULL ? cell->unit_key : "");
        json_value_set(object, key, values[i]);
    }
}

static json_t *rows_json(const OverviewRow *rows, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++) {
        json_t *object = json_object();
        json_object_set_new(object, "name", json_value_text(rows[i].name));
        for (OverviewQuantity k = 0; k < OVERVIEW_QUANTITY_COUNT; k++) {
            if (rows[i].cells[k].is_there) {
                cell_json(object, &rows[i].cells[k], k);
            }
        }
        json_array_append_new(array, object);
    }
    return array;
}

void run_overview_json(json_t *object, const RunReport *report)
{
    Overview overview = run_overview_make(report);
    json_t *made = json_object();
    json_object_set_new(made, "backend",
                        overview.run != NULL ? json_string(overview.run->backend) : json_null());
    if (run_overview_is_random(&overview)) {
        json_object_set_new(made, "counted_revolutions",
                            json_integer((json_int_t)overview.motion->counted));
        json_value_set(made, "quantile", SETTLED_QUANTILE);
    }
    json_object_set_new(made, "joints", rows_json(overview.joints, overview.joint_count));
    json_object_set_new(made, "ideal_joints",
                        rows_json(overview.ideal_joints, overview.ideal_count));
    if (overview.bushing_count > 0) {
        json_object_set_new(made, "bushings", rows_json(overview.bushings, overview.bushing_count));
    }
    json_object_set_new(made, "bodies", rows_json(overview.bodies, overview.body_count));
    json_t *drives = rows_json(overview.drives, overview.drive_count);
    json_t *first = json_array_get(drives, 0);
    json_object_set_new(made, "drive", first != NULL ? json_incref(first) : json_null());
    if (overview.drive_count > 1) {
        json_object_set(made, "drives", drives);
    }
    json_decref(drives);
    Rebound rebound;
    const bool is_other = find_rebound(report->scenario, &rebound);
    json_value_set(made, "restitution_delivered", is_other ? rebound.delivered : NAN);
    json_object_set_new(object, "overview", made);
    run_overview_free(&overview);
}
