// Which numbers of a run does a study keep?
//
// The names are those of the JSON output, joined: bodies.follower.omega_max_rad_s becomes
// follower_omega_max_rad_s. What was not measured, or is not finite, is NAN.
#include "commands/study/metrics.h"

#include "base/text.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { BODY_RESULTS = 4, JOINT_RESULTS = 5 };

static const char *const BODY_NAMES[BODY_RESULTS] = {
    "omega_max_rad_s",
    "omega_min_rad_s",
    "alpha_max_rad_s2",
    "alpha_min_rad_s2",
};

static const Column JOINT_COLUMNS[JOINT_RESULTS] = {
    {"impacts", COLUMN_WHOLE},         {"force_max_N", COLUMN_REAL},
    {"impulse_N_s", COLUMN_REAL},      {"penetration_max_m", COLUMN_REAL},
    {"contact_fraction", COLUMN_REAL},
};

// Of the run as a whole; the last ones need a truth.
static const Column RUN_COLUMNS[] = {
    {"impacts", COLUMN_WHOLE},          // in all joints
    {"alpha_peak_rad_s2", COLUMN_REAL}, // largest |alpha| of any body
    {"energy_drive_work_J", COLUMN_REAL},
    {"energy_dissipated_J", COLUMN_REAL},
    {"energy_residual_J", COLUMN_REAL},
    {"step_s", COLUMN_REAL},
    {"steps", COLUMN_WHOLE},
    {"evaluations", COLUMN_WHOLE},
    {"fallback_rows", COLUMN_WHOLE},
    {"error_estimate", COLUMN_REAL},
    {"error_estimate_until_s", COLUMN_REAL},
};
static const Column ERROR_COLUMNS[] = {
    {"error_omega_max", COLUMN_REAL}, {"error_omega_max_in_horizon", COLUMN_REAL},
    {"error_omega_rms", COLUMN_REAL}, {"error_alpha_max", COLUMN_REAL},
    {"error_horizon_s", COLUMN_REAL}, {"error_reference_uncertainty", COLUMN_REAL},
};

enum {
    RUN_RESULTS = sizeof RUN_COLUMNS / sizeof RUN_COLUMNS[0],
    ERROR_RESULTS = sizeof ERROR_COLUMNS / sizeof ERROR_COLUMNS[0],
};

_Static_assert(BODY_RESULTS *LINKAGE_BODY_MAX + JOINT_RESULTS * LINKAGE_JOINT_MAX + RUN_RESULTS +
                       ERROR_RESULTS <=
                   RECORD_RESULT_MAX,
               "every linkage has room for its results");

// Whether a name stands in the layout before a column; stores tell no small letters from large
// ones.
static bool is_taken(const Layout *layout, const Column *until, const char *name)
{
    for (size_t i = 0; i < layout->setting_count; i++) {
        if (&layout->settings[i] != until && strcasecmp(layout->settings[i].name, name) == 0) {
            return true;
        }
    }
    for (size_t i = 0; i < layout->result_count; i++) {
        if (&layout->results[i] != until && strcasecmp(layout->results[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

// Letters and digits stay, whatever else becomes _; rad/s^2 becomes rad_s2, as in the JSON output.
// Names that become one are numbered.
static void name_column(const Layout *layout, Column *column, const char *words)
{
    static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    enum { ROOM = RECORD_NAME_SIZE - 16 }; // the rest is for a number behind the name
    char name[ROOM];
    size_t length = 0;
    for (const char *c = words; *c != '\0' && length < ROOM - 1; c++) {
        if (*c != '^') {
            name[length++] = (char)(strchr(PLAIN, *c) != NULL ? *c : '_');
        }
    }
    name[length] = '\0';
    text_copy(column->name, sizeof column->name, name);
    for (int number = 2; is_taken(layout, column, column->name); number++) {
        snprintf(column->name, sizeof column->name, "%s_%d", name, number);
    }
}

static void add_result(Layout *layout, const char *of, const char *name, ColumnKind kind)
{
    assert(layout->result_count < RECORD_RESULT_MAX);
    Column *column = &layout->results[layout->result_count++];
    column->kind = kind;
    char words[RECORD_NAME_SIZE];
    snprintf(words, sizeof words, "%.80s%s%.80s", of, of[0] != '\0' ? "_" : "", name);
    name_column(layout, column, words);
}

static void add_settings(const Spec *spec, Layout *layout)
{
    for (size_t i = 0; i < spec->variable_count; i++) {
        const Variable *variable = &spec->variables[i];
        Column *column = &layout->settings[layout->setting_count++];
        const char *unit = variable->is_word ? "" : variable->column_unit;
        column->kind = variable->is_word    ? COLUMN_WORD
                       : variable->is_whole ? COLUMN_WHOLE
                                            : COLUMN_REAL;
        char words[RECORD_NAME_SIZE];
        snprintf(words, sizeof words, "%s%s%s", variable->key, unit[0] != '\0' ? "_" : "", unit);
        name_column(layout, column, words);
    }
}

// Whether a body's motion is a result: it is not prescribed.
static bool is_measured(const Linkage *linkage, size_t body)
{
    return (int)body != linkage_driven_body(linkage);
}

void metrics_layout(const Spec *spec, const Scenario *scenario, Layout *layout)
{
    const Linkage *linkage = &scenario->linkage;
    *layout = (Layout){0};
    add_settings(spec, layout);
    for (size_t i = 0; i < linkage->body_count; i++) {
        for (size_t k = 0; is_measured(linkage, i) && k < BODY_RESULTS; k++) {
            add_result(layout, linkage->bodies[i].name, BODY_NAMES[k], COLUMN_REAL);
        }
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const bool has_play = linkage->joints[i].kind == JOINT_CLEARANCE;
        for (size_t k = 0; has_play && k < JOINT_RESULTS; k++) {
            add_result(layout, linkage->joints[i].name, JOINT_COLUMNS[k].name,
                       JOINT_COLUMNS[k].kind);
        }
    }
    for (size_t k = 0; k < RUN_RESULTS; k++) {
        add_result(layout, "", RUN_COLUMNS[k].name, RUN_COLUMNS[k].kind);
    }
    for (size_t k = 0; spec->has_truth && k < ERROR_RESULTS; k++) {
        add_result(layout, "", ERROR_COLUMNS[k].name, ERROR_COLUMNS[k].kind);
    }
}

// Takes results one after another.
typedef struct Taker {
    size_t count;
    double *results;
} Taker;

static void take(Taker *taker, double value)
{
    taker->results[taker->count++] = isfinite(value) ? value : NAN;
}

// Returns the largest |alpha| of any body.
static double take_bodies(const Linkage *linkage, const Trajectory *run, Taker *taker)
{
    double peak = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const BodyExtremes *extremes = &run->bodies[i];
        if (is_measured(linkage, i)) {
            take(taker, extremes->omega_max.value);
            take(taker, extremes->omega_min.value);
            take(taker, extremes->alpha_max.value);
            take(taker, extremes->alpha_min.value);
            peak = fmax(peak, fmax(extremes->alpha_max.value, -extremes->alpha_min.value));
        }
    }
    return peak;
}

// Returns the impacts in all joints; NAN where the run let no play happen.
static double take_joints(const Linkage *linkage, const Trajectory *run, Taker *taker)
{
    double impacts = NAN;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const JointExtremes *extremes = &run->joints[i];
        if (linkage->joints[i].kind != JOINT_CLEARANCE) {
            continue;
        }
        const bool is_felt = trajectory_feels_play(run, &linkage->joints[i]);
        take(taker, is_felt ? (double)extremes->impacts : NAN);
        take(taker, extremes->force_max.value);
        take(taker, is_felt ? extremes->impulse : NAN);
        take(taker, is_felt ? extremes->penetration_max.value : NAN);
        take(taker, is_felt ? trajectory_contact_share(run, i) : NAN);
        if (is_felt) {
            impacts = (isnan(impacts) ? 0.0 : impacts) + (double)extremes->impacts;
        }
    }
    return impacts;
}

static void take_error(const Trajectory *run, const Truth *truth, Taker *taker)
{
    const bool has_truth = truth != NULL && truth->trajectory->is_complete;
    const bool is_certified = has_truth && truth->message[0] == '\0';
    TrajectoryError error = {0};
    if (has_truth) {
        error = error_against(run, truth->trajectory, truth->horizon_s);
    }
    take(taker, error.is_known ? error.omega_max : NAN);
    take(taker, error.is_known ? error.omega_max_in_horizon : NAN);
    take(taker, error.is_known ? error.omega_rms : NAN);
    take(taker, error.is_known ? error.alpha_max : NAN);
    take(taker, error.is_known && is_certified ? truth->horizon_s : NAN);
    take(taker, error.is_known && is_certified ? truth->uncertainty : NAN);
}

void metrics_take(const Scenario *scenario, const Trajectory *trajectory, const Truth *truth,
                  double results[RECORD_RESULT_MAX])
{
    assert(trajectory->is_complete);
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < RECORD_RESULT_MAX; i++) {
        results[i] = NAN;
    }
    Taker taker = {0, results};
    const double peak = take_bodies(linkage, trajectory, &taker);
    const double impacts = take_joints(linkage, trajectory, &taker);
    take(&taker, impacts);
    take(&taker, peak);
    take(&taker, trajectory->energy.drive_work);
    take(&taker, trajectory->energy.dissipated);
    take(&taker, trajectory->energy.residual);
    take(&taker, trajectory->step_s > 0.0 ? trajectory->step_s : NAN);
    take(&taker, (double)trajectory->steps);
    take(&taker, (double)trajectory->evaluations);
    take(&taker, (double)trajectory->fallback_rows);
    take(&taker, trajectory->trials > 0 ? trajectory->error_estimate : NAN);
    take(&taker, trajectory->trials > 0 ? trajectory->estimate_s : NAN);
    take_error(trajectory, truth, &taker);
}
