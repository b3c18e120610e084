// How does a measured start survive the end of the program?
//
// {"metrics": [[name, kind, is slow, value, scale, floor], ...], "start": [member, share, shake]}.
// The hash stands in the place of the value, as hexadecimal digits.
#include "commands/check/measure_json.h"

#include "base/text.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static json_t *start_array(CheckStart start)
{
    return json_pack("[I, f, I]", (json_int_t)start.member, start.share, (json_int_t)start.shake);
}

json_t *measure_json_build(CheckStart start, const CheckMeasure *measure)
{
    json_t *metrics = json_array();
    for (size_t i = 0; i < measure->count; i++) {
        const CheckMetric *metric = &measure->metrics[i];
        json_t *value = metric->kind == CHECK_HASH ? json_sprintf("%016" PRIx64, metric->hash)
                                                   : json_real(metric->value);
        json_array_append_new(metrics,
                              json_pack("[s, i, b, o, f, f]", metric->name, (int)metric->kind,
                                        (int)metric->is_slow, value, metric->scale, metric->floor));
    }
    return json_pack("{s:o, s:o}", "start", start_array(start), "metrics", metrics);
}

static bool take_metric(json_t *line, CheckMetric *metric)
{
    const char *name;
    int kind;
    int is_slow;
    json_t *value;
    if (json_unpack(line, "[s, i, b, o, F, F]", &name, &kind, &is_slow, &value, &metric->scale,
                    &metric->floor) != 0 ||
        kind < CHECK_REAL || kind > CHECK_HASH ||
        (kind == CHECK_HASH ? !json_is_string(value) : !json_is_number(value))) {
        return false;
    }
    text_copy(metric->name, sizeof metric->name, name);
    metric->kind = (CheckKind)kind;
    metric->is_slow = is_slow != 0;
    if (metric->kind == CHECK_HASH) {
        metric->hash = strtoull(json_string_value(value), NULL, 16);
    } else {
        metric->value = json_number_value(value);
    }
    return true;
}

bool measure_json_take(const json_t *line, CheckStart start, CheckMeasure *measure)
{
    const json_t *metrics = json_object_get(line, "metrics");
    json_t *wanted = start_array(start);
    const bool is_it = json_equal(json_object_get(line, "start"), wanted) != 0;
    json_decref(wanted);
    const size_t count = json_array_size(metrics);
    if (!is_it || count == 0 || count > CHECK_METRIC_MAX) {
        return false;
    }
    *measure = (CheckMeasure){.is_complete = true, .count = count};
    for (size_t i = 0; i < count; i++) {
        if (!take_metric(json_array_get(metrics, i), &measure->metrics[i])) {
            *measure = (CheckMeasure){.is_complete = false};
            return false;
        }
    }
    return true;
}

json_t *measure_json_plan(const CheckPlan *plan, const char *no_truth)
{
    return json_pack("{s:{s:b, s:f, s:b, s:f, s:b, s:s}}", "plan", "has_truth",
                     (int)plan->has_truth, "uncertainty", plan->uncertainty, "is_limited",
                     (int)plan->is_limited, "horizon_s", plan->horizon_s, "is_full",
                     (int)plan->is_full, "no_truth", no_truth);
}

bool measure_json_take_plan(const json_t *line, CheckPlan *plan, char *no_truth, size_t size)
{
    int has_truth;
    int is_limited;
    int is_full;
    double uncertainty;
    double horizon_s;
    const char *reason;
    if (json_unpack((json_t *)line, "{s:{s:b, s:F, s:b, s:F, s:b, s:s}}", "plan", "has_truth",
                    &has_truth, "uncertainty", &uncertainty, "is_limited", &is_limited, "horizon_s",
                    &horizon_s, "is_full", &is_full, "no_truth", &reason) != 0) {
        return false;
    }
    *plan = (CheckPlan){.has_truth = has_truth != 0,
                        .uncertainty = uncertainty,
                        .is_limited = is_limited != 0,
                        .horizon_s = horizon_s,
                        .is_full = is_full != 0};
    text_copy(no_truth, size, reason);
    return true;
}
