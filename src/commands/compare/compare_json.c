// What do other programs read of a comparison?
#include "commands/compare/compare_json.h"

#include "write/json_value.h"
#include "write/measured_fields.h"
#include "write/settings_json.h"
#include "write/units.h"

#include <inttypes.h>

static json_t *truth_object(const CompareReport *report)
{
    const LadderTruth *truth = &report->ladder->truth;
    json_t *object = json_object();
    json_object_set_new(object, "backend", json_string(truth->backend));
    json_value_set(object, "uncertainty", truth->uncertainty);
    const bool is_certified = truth->message[0] == '\0';
    json_object_set_new(object, "message", json_value_not_certified(truth->message));
    json_value_set(object, "horizon_s", is_certified ? truth->horizon_s : NAN);
    json_object_set_new(object, "is_limited", json_boolean(truth->is_limited));
    json_value_set(object, "growth", is_certified ? truth->growth : NAN);
    json_object_set_new(object, "other_contact_model",
                        json_boolean(compare_report_mixes_models(report)));
    json_value_set(object, "wall_s", truth->wall_s);
    return object;
}

static json_t *error_object(const LadderPoint *point)
{
    json_t *object = json_object();
    fields_json_set(ERROR_FIELDS, FIELD_JSON, &point->run.error, object);
    return object;
}

static json_t *wall_array(const Ladder *ladder, const LadderPoint *point)
{
    json_t *walls = json_array();
    for (size_t i = 0; i < ladder->repeats; i++) {
        if (point->is_timed[i]) {
            json_array_append_new(walls, json_value_real(point->wall_s[i]));
        }
    }
    return walls;
}

static json_t *point_object(const Ladder *ladder, const LadderPoint *point)
{
    json_t *object = json_object();
    json_value_set(object, "step_s", point->step_s > 0.0 ? point->step_s : NAN);
    json_object_set_new(object, "status", json_string(point->is_failed ? "failed" : "ok"));
    json_object_set_new(object, "message", json_value_text(point->reason));
    if (point->is_failed) {
        return object;
    }
    json_object_set_new(object, "steps", json_integer((json_int_t)point->run.steps));
    json_object_set_new(object, "evaluations", json_integer((json_int_t)point->run.evaluations));
    json_value_set(object, "error_omega", point->error);
    json_object_set_new(object, "limited_by_truth", json_boolean(point->is_limited_by_truth));
    json_object_set_new(object, "error", error_object(point));
    json_value_set(object, "wall_median_s", point->wall_median_s);
    json_value_set(object, "wall_min_s", point->wall_min_s);
    json_value_set(object, "wall_max_s", point->wall_max_s);
    json_object_set_new(object, "wall_s", wall_array(ladder, point));
    json_value_set(object, "us_per_step",
                   point->wall_median_s / (double)point->run.steps * UNITS_US);
    json_object_set_new(object, "on_frontier", json_boolean(point->is_on_frontier));
    json_object_set_new(object, "hash", json_sprintf("%016" PRIx64, point->run.hash));
    return object;
}

static json_t *order_object(const Ladder *ladder, const Order *order)
{
    if (!order->is_known) {
        return json_null();
    }
    json_t *object = json_object();
    json_value_set(object, "order", order->order);
    json_value_set(object, "from_step_s", ladder->steps[order->first]);
    json_value_set(object, "to_step_s", ladder->steps[order->last]);
    json_object_set_new(object, "points",
                        json_integer((json_int_t)(order->last - order->first + 1)));
    json_value_set(object, "spread", order->spread);
    return object;
}

static json_t *ensemble_object(const CompareReport *report, const LadderEnsemble *ensemble)
{
    if (!ensemble->is_known) {
        return json_null();
    }
    json_t *object = json_object();
    json_value_set(object, "step_s", ensemble->step_s > 0.0 ? ensemble->step_s : NAN);
    json_object_set_new(object, "members", json_integer((json_int_t)ensemble->ensemble.members));
    json_object_set_new(object, "failed", json_integer((json_int_t)ensemble->ensemble.failed));
    json_object_set_new(object, "message", json_value_text(ensemble->ensemble.message));
    if (ensemble->ensemble.members > 0) {
        json_object_set_new(object, "joints",
                            ensemble_joints_json(&report->scenario->linkage, &ensemble->ensemble));
    }
    return object;
}

static json_t *scheme_object(const CompareReport *report, size_t index)
{
    const Ladder *ladder = report->ladder;
    const Scheme *scheme = &ladder->schemes[index];
    json_t *object = json_pack("{s:s, s:s}", "scheme", scheme->name, "backend",
                               OPTIONS_BACKENDS[scheme->backend]);
    if (scheme_has_step(scheme)) {
        json_object_set_new(object, "solver", json_string(OPTIONS_ODE_SOLVERS[scheme->solver]));
        json_object_set_new(object, "stepping",
                            json_string(OPTIONS_ODE_STEPPINGS[scheme->stepping]));
        json_object_set_new(object, "map", json_string(OPTIONS_ODE_MAPS[scheme->map]));
        json_object_set_new(object, "collider",
                            json_string(OPTIONS_ODE_COLLIDERS[scheme->collider]));
    }
    if (scheme->tolerance > 0.0) {
        json_value_set(object, "tolerance", scheme->tolerance);
    }
    json_t *points = json_array();
    for (size_t i = 0; i < ladder->point_count; i++) {
        if (ladder->points[i].scheme == index) {
            json_array_append_new(points, point_object(ladder, &ladder->points[i]));
        }
    }
    json_object_set_new(object, "order", order_object(ladder, &ladder->orders[index]));
    json_object_set_new(object, "points", points);
    json_object_set_new(object, "ensemble", ensemble_object(report, &ladder->ensembles[index]));
    return object;
}

static json_t *cheapest_object(const Ladder *ladder, size_t index)
{
    json_t *object = json_object();
    json_value_set(object, "error_at_most", LADDER_TARGETS[index]);
    if (ladder->cheapest[index] == ladder->point_count) {
        json_object_set_new(object, "scheme", json_null());
        return object;
    }
    const LadderPoint *point = &ladder->points[ladder->cheapest[index]];
    json_object_set_new(object, "scheme", json_string(ladder->schemes[point->scheme].name));
    json_value_set(object, "step_s", point->step_s > 0.0 ? point->step_s : NAN);
    json_value_set(object, "error_omega", point->error);
    json_value_set(object, "wall_median_s", point->wall_median_s);
    return object;
}

json_t *compare_json_build(const CompareReport *report)
{
    const Ladder *ladder = report->ladder;
    json_t *object = json_object();
    json_object_set_new(object, "tool", settings_json_tool());
    json_object_set_new(object, "case", json_value_text(report->scenario->path));
    json_object_set_new(object, "title", json_value_text(report->scenario->title));
    settings_json_set(object, report->scenario);
    json_object_set_new(object, "machine", json_value_text(report->machine));
    json_object_set_new(object, "repeats", json_integer((json_int_t)ladder->repeats));
    json_object_set_new(object, "truth", truth_object(report));
    json_t *schemes = json_array();
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        json_array_append_new(schemes, scheme_object(report, i));
    }
    json_object_set_new(object, "schemes", schemes);
    json_t *cheapest = json_array();
    for (size_t i = 0; i < LADDER_TARGET_COUNT; i++) {
        json_array_append_new(cheapest, cheapest_object(ladder, i));
    }
    json_object_set_new(object, "cheapest", cheapest);
    return object;
}
