// What did a study do, for a program that asks?
#include "commands/study/study_json.h"

#include "write/json_value.h"
#include "write/settings_json.h"

// Counts of runs are whole numbers, and below 2^53.
static json_t *whole(uint64_t count)
{
    return json_integer((json_int_t)count);
}

static json_t *build_fates(const StoreCount *count)
{
    json_t *fates = json_object();
    for (int i = 0; i < FATE_COUNT; i++) {
        json_object_set_new(fates, FATE_WORDS[i], whole(count->fates[i]));
    }
    return fates;
}

// What this process did of it.
static json_t *build_effort(const StudyReport *report)
{
    const SweepState *state = &report->state;
    json_t *effort = json_object();
    json_object_set_new(effort, "made", whole(state->made));
    json_object_set_new(effort, "failed", whole(state->failed));
    json_object_set_new(effort, "without_truth", whole(state->without_truth));
    json_object_set_new(effort, "why_without_truth", json_value_text(state->no_truth));
    json_object_set_new(effort, "jobs", whole(report->jobs));
    json_value_set(effort, "wall_s", state->wall_s);
    json_value_set(effort, "inside_s", state->inside_s);
    json_value_set(effort, "inside_share", study_report_inside(report));
    json_value_set(effort, "children_cpu_s", report->children_cpu_s);
    json_value_set(effort, "own_cpu_s", report->own_cpu_s);
    return effort;
}

json_t *study_json_build(const StudyReport *report)
{
    const Spec *spec = report->spec;
    json_t *object = json_object();
    json_object_set_new(object, "tool", settings_json_tool());
    json_object_set_new(object, "study", json_value_text(spec->path));
    json_object_set_new(object, "title", json_value_text(spec->title));
    json_object_set_new(object, "case", json_value_text(spec->case_path));
    json_object_set_new(object, "store", json_value_text(report->store));
    json_object_set_new(object, "shard",
                        json_pack("{s:o, s:o}", "index", whole(report->shard.index + 1), "count",
                                  whole(report->shard.count)));
    json_object_set_new(object, "runs", whole(report->state.total));
    json_object_set_new(object, "done", whole(report->state.done));
    json_object_set_new(object, "fates", build_fates(&report->count));
    json_value_set(object, "wall_s", report->count.wall_s);
    json_object_set_new(object, "now", build_effort(report));
    return object;
}
