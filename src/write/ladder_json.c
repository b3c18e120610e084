// How is a finished run written down so that it can be taken up again?
#include "write/ladder_json.h"

#include "write/error_json.h"
#include "write/json_value.h"
#include "write/ladder_shape.h"
#include "write/settings_json.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const LADDER_JSON_METRICS[ENSEMBLE_METRIC_COUNT] = {
    [ENSEMBLE_FORCE_MAX] = "force_max_N",
    [ENSEMBLE_IMPULSE] = "impulse_N_s",
    [ENSEMBLE_IMPACTS] = "impacts",
    [ENSEMBLE_PENETRATION_MAX] = "penetration_max_m",
    [ENSEMBLE_CONTACT_SHARE] = "contact_fraction",
};

static const char *const DISTRIBUTION_KEYS[] = {"low", "median", "high", "mean", "deviation"};

// A number of a line; null stands for one that was not finite.
static double number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

static size_t count(const json_t *object, const char *key)
{
    return (size_t)json_integer_value(json_object_get(object, key));
}

static void copy(const json_t *object, const char *key, char *target, size_t size)
{
    const char *text = json_string_value(json_object_get(object, key));
    snprintf(target, size, "%s", text == NULL ? "" : text);
}

json_t *ladder_json_key(const Ladder *ladder, const Scenario *scenario, const char *build)
{
    json_t *steps = json_array();
    for (size_t i = 0; i < ladder->step_count; i++) {
        json_array_append_new(steps, json_value_real(ladder->steps[i]));
    }
    return json_pack("{s:o, s:s, s:o, s:o}", "tool", settings_json_tool(), "build", build,
                     "settings", settings_json_all(scenario), "steps_s", steps);
}

json_t *ladder_json_truth(const LadderTruth *truth)
{
    json_t *object = json_object();
    json_object_set_new(object, "backend", json_string(truth->backend));
    json_value_set(object, "uncertainty", truth->uncertainty);
    json_value_set(object, "horizon_s", truth->horizon_s);
    json_value_set(object, "growth", truth->growth);
    json_object_set_new(object, "is_limited", json_boolean(truth->is_limited));
    json_value_set(object, "wall_s", truth->wall_s);
    json_object_set_new(object, "message", json_value_text(truth->message));
    return json_pack("{s:o}", "truth", object);
}

static json_t *begin_point(const Ladder *ladder, const LadderPoint *point)
{
    json_t *object = json_object();
    json_object_set_new(object, "scheme", json_string(ladder->schemes[point->scheme].name));
    json_value_set(object, "step_s", point->step_s);
    return object;
}

static void set_error(json_t *object, const LadderRun *run)
{
    const TrajectoryError *error = &run->error;
    json_object_set_new(object, "steps", json_integer((json_int_t)run->steps));
    json_object_set_new(object, "evaluations", json_integer((json_int_t)run->evaluations));
    json_object_set_new(object, "hash", json_sprintf("%016" PRIx64, run->hash));
    json_object_set_new(object, "is_known", json_boolean(error->is_known));
    error_json_set(object, error);
}

json_t *ladder_json_run(const Ladder *ladder, const LadderRun *run, const char *machine)
{
    json_t *object = begin_point(ladder, &ladder->points[run->point]);
    json_object_set_new(object, "is_complete", json_boolean(run->is_complete));
    json_object_set_new(object, "message", json_value_text(run->message));
    json_value_set(object, "wall_s", run->wall_s);
    if (run->kind == LADDER_ERROR) {
        set_error(object, run);
        return json_pack("{s:o}", "error", object);
    }
    json_object_set_new(object, "round", json_integer((json_int_t)run->round));
    json_object_set_new(object, "machine", json_value_text(machine));
    return json_pack("{s:o}", "timing", object);
}

static json_t *distributions(const Distribution *metrics)
{
    json_t *object = json_object();
    for (int i = 0; i < ENSEMBLE_METRIC_COUNT; i++) {
        const Distribution *d = &metrics[i];
        const double values[] = {d->low, d->median, d->high, d->mean, d->deviation};
        json_t *inner = json_object();
        for (int k = 0; k < 5; k++) {
            json_value_set(inner, DISTRIBUTION_KEYS[k], values[k]);
        }
        json_object_set_new(object, LADDER_JSON_METRICS[i], inner);
    }
    return object;
}

json_t *ladder_json_joints(const Linkage *linkage, const Ensemble *ensemble)
{
    json_t *joints = json_object();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_CLEARANCE) {
            json_object_set_new(joints, linkage->joints[i].name,
                                distributions(ensemble->joints[i]));
        }
    }
    return joints;
}

json_t *ladder_json_ensemble(const Ladder *ladder, const Linkage *linkage, size_t scheme,
                             const LadderEnsemble *ensemble)
{
    json_t *object =
        json_pack("{s:s, s:f, s:I, s:I, s:o, s:o}", "scheme", ladder->schemes[scheme].name,
                  "step_s", ensemble->step_s, "members", (json_int_t)ensemble->ensemble.members,
                  "failed", (json_int_t)ensemble->ensemble.failed, "message",
                  json_value_text(ensemble->ensemble.message), "joints",
                  ladder_json_joints(linkage, &ensemble->ensemble));
    return json_pack("{s:o}", "ensemble", object);
}

static LadderJsonFate take_truth(Ladder *ladder, const json_t *object)
{
    LadderTruth *truth = &ladder->truth;
    if (truth->is_known) {
        return LADDER_JSON_UNUSED;
    }
    *truth = (LadderTruth){
        .is_known = true,
        .uncertainty = number(object, "uncertainty"),
        .horizon_s = number(object, "horizon_s"),
        .growth = number(object, "growth"),
        .is_limited = json_is_true(json_object_get(object, "is_limited")),
        .wall_s = number(object, "wall_s"),
    };
    // one that could not be certified is as uncertain as can be, and JSON knows no infinity
    truth->uncertainty = isnan(truth->uncertainty) ? INFINITY : truth->uncertainty;
    copy(object, "backend", truth->backend, sizeof truth->backend);
    copy(object, "message", truth->message, sizeof truth->message);
    return LADDER_JSON_TAKEN;
}

static size_t find_point(const Ladder *ladder, const json_t *object)
{
    const char *scheme = json_string_value(json_object_get(object, "scheme"));
    return ladder_find(ladder, scheme == NULL ? "" : scheme, number(object, "step_s"));
}

static LadderJsonFate take_run(Ladder *ladder, const json_t *object, LadderKind kind,
                               const char *machine)
{
    LadderRun run = {
        .kind = kind,
        .point = find_point(ladder, object),
        .round = count(object, "round"),
        .is_complete = json_is_true(json_object_get(object, "is_complete")),
        .wall_s = number(object, "wall_s"),
        .steps = count(object, "steps"),
        .evaluations = count(object, "evaluations"),
        .error = {.is_known = json_is_true(json_object_get(object, "is_known")),
                  .omega_max = number(object, "omega_max"),
                  .omega_max_time_s = number(object, "omega_max_time_s"),
                  .omega_max_in_horizon = number(object, "omega_max_in_horizon"),
                  .omega_rms = number(object, "omega_rms"),
                  .alpha_max = number(object, "alpha_max"),
                  .angle_max_rad = number(object, "angle_max_rad")},
    };
    char hash[32];
    copy(object, "hash", hash, sizeof hash);
    run.hash = strtoull(hash, NULL, 16);
    copy(object, "message", run.message, sizeof run.message);
    const char *taken_on = json_string_value(json_object_get(object, "machine"));
    if (kind == LADDER_TIMING && (taken_on == NULL || strcmp(taken_on, machine) != 0)) {
        return LADDER_JSON_OTHER_MACHINE;
    }
    return ladder_add(ladder, &run) ? LADDER_JSON_TAKEN : LADDER_JSON_UNUSED;
}

static LadderJsonFate take_ensemble(Ladder *ladder, const Linkage *linkage, const json_t *object)
{
    const size_t point = find_point(ladder, object);
    if (point == ladder->point_count || ladder->ensembles[ladder->points[point].scheme].is_known) {
        return LADDER_JSON_UNUSED;
    }
    LadderEnsemble *stored = &ladder->ensembles[ladder->points[point].scheme];
    Ensemble *ensemble = &stored->ensemble;
    stored->is_known = true;
    stored->step_s = number(object, "step_s");
    ensemble->members = count(object, "members");
    ensemble->failed = count(object, "failed");
    copy(object, "message", ensemble->message, sizeof ensemble->message);
    const json_t *joints = json_object_get(object, "joints");
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const json_t *joint = json_object_get(joints, linkage->joints[i].name);
        for (int k = 0; k < ENSEMBLE_METRIC_COUNT; k++) {
            const json_t *metric = json_object_get(joint, LADDER_JSON_METRICS[k]);
            ensemble->joints[i][k] = (Distribution){number(metric, "low"), number(metric, "median"),
                                                    number(metric, "high"), number(metric, "mean"),
                                                    number(metric, "deviation")};
        }
    }
    return LADDER_JSON_TAKEN;
}

LadderJsonFate ladder_json_take(Ladder *ladder, const Linkage *linkage, const json_t *line,
                                const char *machine)
{
    if (!ladder_shape_is_right(line, linkage)) {
        return LADDER_JSON_DAMAGED;
    }
    const json_t *object = json_object_get(line, "truth");
    if (object != NULL) {
        return take_truth(ladder, object);
    }
    object = json_object_get(line, "error");
    if (object != NULL) {
        return take_run(ladder, object, LADDER_ERROR, machine);
    }
    object = json_object_get(line, "timing");
    if (object != NULL) {
        return take_run(ladder, object, LADDER_TIMING, machine);
    }
    object = json_object_get(line, "ensemble");
    return object != NULL ? take_ensemble(ladder, linkage, object) : LADDER_JSON_UNUSED;
}
