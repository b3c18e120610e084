// What did a study do, for a program that asks?
#include "commands/study/study_json.h"

#include "write/fields.h"
#include "write/json_value.h"
#include "write/settings_json.h"

#define AT(type, member) type, FIELD_JSON, .offset = offsetof(StudyReport, member)

// What this process did of it.
static const Field EFFORT_FIELDS[] = {
    {"made", AT(FIELD_COUNT, state.made)},
    {"failed", AT(FIELD_COUNT, state.failed)},
    {"without_truth", AT(FIELD_COUNT, state.without_truth)},
    {"why_without_truth", AT(FIELD_TEXT, state.no_truth)},
    {"jobs", AT(FIELD_COUNT, jobs)},
    {"wall_s", AT(FIELD_NUMBER, state.wall_s)},
    {"inside_s", AT(FIELD_NUMBER, state.inside_s)},
    {"inside_share", AT(FIELD_NUMBER, inside_share)},
    {"children_cpu_s", AT(FIELD_NUMBER, children_cpu_s)},
    {"own_cpu_s", AT(FIELD_NUMBER, own_cpu_s)},
    {0},
};

// Counts of runs are whole numbers, and below 2^53.
static json_t *whole(uint64_t count)
{
    return json_integer((json_int_t)count);
}

json_t *study_json_build(const StudyReport *report)
{
    json_t *outcomes = json_object();
    for (int i = 0; i < RUN_OUTCOME_COUNT; i++) {
        json_object_set_new(outcomes, RUN_OUTCOME_WORDS[i], whole(report->count.outcomes[i]));
    }
    json_t *object = json_object();
    json_object_set_new(object, "tool", settings_json_tool());
    json_object_set_new(object, "study", json_value_text(report->spec->path));
    json_object_set_new(object, "title", json_value_text(report->spec->title));
    json_object_set_new(object, "case", json_value_text(report->spec->case_path));
    json_object_set_new(object, "store", json_value_text(report->store));
    json_object_set_new(object, "shard",
                        json_pack("{s:o, s:o}", "index", whole(report->shard.index + 1), "count",
                                  whole(report->shard.count)));
    json_object_set_new(object, "runs", whole(report->state.total));
    json_object_set_new(object, "done", whole(report->state.done));
    json_object_set_new(object, "outcomes", outcomes);
    json_value_set(object, "wall_s", report->count.wall_s);
    json_object_set_new(object, "now", fields_json(EFFORT_FIELDS, FIELD_JSON, report));
    return object;
}
