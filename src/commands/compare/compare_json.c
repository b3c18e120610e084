// What do other programs read of a comparison?
#include "commands/compare/compare_report.h"
#include "write/json_value.h"
#include "write/measured_fields.h"
#include "write/settings_json.h"

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
            json_array_append_new(points, compare_rows_point(&ladder->points[i]));
        }
    }
    json_object_set_new(object, "order", compare_rows_order(&ladder->orders[index]));
    json_object_set_new(object, "points", points);
    json_object_set_new(object, "ensemble", ensemble_object(report, &ladder->ensembles[index]));
    return object;
}

json_t *compare_json_build(const void *of)
{
    const CompareReport *report = of;
    const Ladder *ladder = report->ladder;
    json_t *object = json_object();
    settings_json_begin(object, report->scenario);
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
        json_array_append_new(cheapest, compare_rows_cheapest(ladder, i));
    }
    json_object_set_new(object, "cheapest", cheapest);
    return object;
}
