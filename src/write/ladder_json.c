// How is a finished run written down so that it can be taken up again?
//
// A line is an object of one key, its kind, with the fields of that kind below.
#include "write/ladder_json.h"

#include "base/text.h"
#include "write/json_value.h"
#include "write/measured_fields.h"
#include "write/settings_json.h"

#include <math.h>
#include <string.h>

enum { MACHINE_SIZE = 128 };

// A run, or an ensemble, with the point that it is of.
typedef struct Line {
    char scheme[SCHEME_NAME_SIZE];
    double step_s;
    LadderRun run;
    char machine[MACHINE_SIZE];
    Ensemble ensemble;
} Line;

// Which kinds of line a field stands in.
enum {
    ERROR = FIELD_OWN,
    TIMING = FIELD_OWN << 1,
    ENSEMBLE = FIELD_OWN << 2,
    RUN = ERROR | TIMING
};

#define TRUTH(member)      offsetof(LadderTruth, member)
#define LINE(member)       offsetof(Line, member)
#define TEXT(type, member) .size = sizeof(((type *)NULL)->member)

// clang-format off
static const Field TRUTH_FIELDS[] = {
    {"backend",     .type = FIELD_TEXT,   TRUTH(backend),     FIELD_STORE, TEXT(LadderTruth, backend)},
    {"uncertainty", .type = FIELD_NUMBER, TRUTH(uncertainty), FIELD_STORE},
    {"horizon_s",   .type = FIELD_NUMBER, TRUTH(horizon_s),   FIELD_STORE},
    {"growth",      .type = FIELD_NUMBER, TRUTH(growth),      FIELD_STORE},
    {"is_limited",  .type = FIELD_FLAG,   TRUTH(is_limited),  FIELD_STORE},
    {"wall_s",      .type = FIELD_NUMBER, TRUTH(wall_s),      FIELD_STORE},
    {"message",     .type = FIELD_TEXT,   TRUTH(message),     FIELD_STORE, TEXT(LadderTruth, message)},
    {0},
};

static const Field LINE_FIELDS[] = {
    {"scheme",      .type = FIELD_TEXT,   LINE(scheme),           RUN | ENSEMBLE, TEXT(Line, scheme)},
    {"step_s",      .type = FIELD_STEP,   LINE(step_s),           RUN | ENSEMBLE},
    {"is_complete", .type = FIELD_FLAG,   LINE(run.is_complete),  RUN},
    {"message",     .type = FIELD_TEXT,   LINE(run.message),      RUN, TEXT(Line, run.message)},
    {"wall_s",      .type = FIELD_NUMBER, LINE(run.wall_s),       RUN},
    {"steps",       .type = FIELD_COUNT,  LINE(run.steps),        ERROR},
    {"evaluations", .type = FIELD_COUNT,  LINE(run.evaluations),  ERROR},
    {"hash",        .type = FIELD_HASH,   LINE(run.hash),         ERROR},
    {NULL,          .type = FIELD_GROUP,  LINE(run.error),        ERROR, .of = ERROR_FIELDS},
    {"round",       .type = FIELD_COUNT,  LINE(run.round),        TIMING},
    {"machine",     .type = FIELD_TEXT,   LINE(machine),          TIMING, TEXT(Line, machine)},
    {"members",     .type = FIELD_COUNT,  LINE(ensemble.members), ENSEMBLE},
    {"failed",      .type = FIELD_COUNT,  LINE(ensemble.failed),  ENSEMBLE},
    {"message",     .type = FIELD_TEXT,   LINE(ensemble.message), ENSEMBLE, TEXT(Line, ensemble.message)},
    {0},
};
// clang-format on

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
    return json_pack("{s:o}", "truth", fields_json(TRUTH_FIELDS, FIELD_STORE, truth));
}

json_t *ladder_json_run(const Ladder *ladder, const LadderRun *run, const char *machine)
{
    const LadderPoint *point = &ladder->points[run->point];
    Line line = {.step_s = point->step_s, .run = *run};
    text_copy(line.scheme, sizeof line.scheme, ladder->schemes[point->scheme].name);
    text_copy(line.machine, sizeof line.machine, machine);
    return run->kind == LADDER_ERROR
               ? json_pack("{s:o}", "error", fields_json(LINE_FIELDS, ERROR | FIELD_STORE, &line))
               : json_pack("{s:o}", "timing", fields_json(LINE_FIELDS, TIMING, &line));
}

json_t *ladder_json_ensemble(const Ladder *ladder, const Linkage *linkage, size_t scheme,
                             const LadderEnsemble *ensemble)
{
    Line line = {.step_s = ensemble->step_s, .ensemble = ensemble->ensemble};
    text_copy(line.scheme, sizeof line.scheme, ladder->schemes[scheme].name);
    json_t *object = fields_json(LINE_FIELDS, ENSEMBLE, &line);
    json_object_set_new(object, "joints", ensemble_joints_json(linkage, &ensemble->ensemble));
    return json_pack("{s:o}", "ensemble", object);
}

static LadderJsonTaken take_truth(Ladder *ladder, const json_t *object)
{
    LadderTruth truth = {.is_known = true};
    if (!fields_json_read(TRUTH_FIELDS, FIELD_STORE, object, &truth)) {
        return LADDER_JSON_DAMAGED;
    }
    if (ladder->truth.is_known) {
        return LADDER_JSON_UNUSED;
    }
    // one that could not be certified is as uncertain as can be, and JSON knows no infinity
    truth.uncertainty = isnan(truth.uncertainty) ? INFINITY : truth.uncertainty;
    ladder->truth = truth;
    return LADDER_JSON_TAKEN;
}

static LadderJsonTaken take_run(Ladder *ladder, const json_t *object, LadderKind kind,
                                const char *machine)
{
    Line line = {.run.kind = kind};
    const unsigned where = kind == LADDER_ERROR ? ERROR | FIELD_STORE : TIMING;
    if (!fields_json_read(LINE_FIELDS, where, object, &line)) {
        return LADDER_JSON_DAMAGED;
    }
    if (kind == LADDER_TIMING && strcmp(line.machine, machine) != 0) {
        return LADDER_JSON_OTHER_MACHINE;
    }
    line.run.point = ladder_find(ladder, line.scheme, line.step_s);
    return ladder_add(ladder, &line.run) ? LADDER_JSON_TAKEN : LADDER_JSON_UNUSED;
}

static LadderJsonTaken take_ensemble(Ladder *ladder, const Linkage *linkage, const json_t *object)
{
    Line line = {0};
    if (!fields_json_read(LINE_FIELDS, ENSEMBLE, object, &line) ||
        !ensemble_joints_read(linkage, json_object_get(object, "joints"), &line.ensemble)) {
        return LADDER_JSON_DAMAGED;
    }
    const size_t point = ladder_find(ladder, line.scheme, line.step_s);
    if (point == ladder->point_count || ladder->ensembles[ladder->points[point].scheme].is_known) {
        return LADDER_JSON_UNUSED;
    }
    ladder->ensembles[ladder->points[point].scheme] =
        (LadderEnsemble){true, line.step_s, line.ensemble};
    return LADDER_JSON_TAKEN;
}

LadderJsonTaken ladder_json_take(Ladder *ladder, const Linkage *linkage, const json_t *line,
                                 const char *machine)
{
    const json_t *object;
    if ((object = json_object_get(line, "truth")) != NULL) {
        return take_truth(ladder, object);
    }
    if ((object = json_object_get(line, "error")) != NULL) {
        return take_run(ladder, object, LADDER_ERROR, machine);
    }
    if ((object = json_object_get(line, "timing")) != NULL) {
        return take_run(ladder, object, LADDER_TIMING, machine);
    }
    object = json_object_get(line, "ensemble");
    return object != NULL ? take_ensemble(ladder, linkage, object) : LADDER_JSON_DAMAGED;
}
