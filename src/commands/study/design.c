// Which runs are there, and which scenario is each?
//
// A run's number is a number of mixed radix: from slow to fast one digit for each key of the grid
// that changes the truth, one for the draw, one for each key of the grid that does not. Runs that
// differ in the last ones only (and in the draw, where nothing that is drawn changes the truth) are
// a group.
#include "commands/study/design.h"

#include "base/text.h"
#include "commands/study/draw.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t grid_count(const Spec *spec, bool changes_truth)
{
    uint64_t count = 1;
    for (size_t i = 0; i < spec->variable_count; i++) {
        const Variable *variable = &spec->variables[i];
        if (!variable->is_drawn && variable->changes_truth == changes_truth) {
            count *= variable->count;
        }
    }
    return count;
}

static uint64_t group_size(const Spec *spec)
{
    bool draws_share = true;
    for (size_t i = 0; i < spec->variable_count; i++) {
        const Variable *variable = &spec->variables[i];
        draws_share = draws_share && !(variable->is_drawn && variable->changes_truth);
    }
    return grid_count(spec, false) * (draws_share ? spec->draws : 1);
}

uint64_t design_run_count(const Spec *spec)
{
    return grid_count(spec, true) * spec->draws * grid_count(spec, false);
}

// One of the numbers of a range; its ends are exact.
static double range_number(const Variable *variable, uint64_t digit)
{
    const double share = (double)digit / (double)(variable->count - 1);
    const bool is_log = variable->kind == VARIABLE_LOGARITHMIC;
    const double number = digit == 0                     ? variable->low
                          : digit == variable->count - 1 ? variable->high
                          : is_log ? variable->low * pow(variable->high / variable->low, share)
                                   : variable->low + share * (variable->high - variable->low);
    return variable->is_whole ? round(number) : number;
}

// Takes the digits of one half of the grid off the run's number, the fastest first.
static void take_digits(const Spec *spec, bool changes_truth, uint64_t *rest, Cell *values)
{
    for (size_t i = spec->variable_count; i-- > 0;) {
        const Variable *variable = &spec->variables[i];
        if (variable->is_drawn || variable->changes_truth != changes_truth) {
            continue;
        }
        const uint64_t digit = *rest % variable->count;
        *rest /= variable->count;
        if (variable->is_word) {
            text_copy(values[i].word, sizeof values[i].word, variable->words[digit]);
        } else if (variable->kind == VARIABLE_LIST) {
            values[i].number = variable->numbers[digit];
        } else {
            values[i].number = range_number(variable, digit);
        }
    }
}

void design_values(const Spec *spec, uint64_t run, Cell values[RECORD_SETTING_MAX])
{
    assert(run < design_run_count(spec));
    // nothing is left to chance behind the end of a word
    memset(values, 0, RECORD_SETTING_MAX * sizeof *values);
    uint64_t rest = run;
    take_digits(spec, false, &rest, values);
    const uint64_t draw = rest % spec->draws;
    rest /= spec->draws;
    take_digits(spec, true, &rest, values);
    for (size_t i = 0; i < spec->variable_count; i++) {
        const Variable *variable = &spec->variables[i];
        if (variable->is_drawn) {
            values[i].number = draw_value(variable, draw_variable_share(spec, variable, draw));
        }
    }
}

uint64_t design_group(const Spec *spec, uint64_t run)
{
    return run / group_size(spec);
}

// How many runs in a row a shard takes: a group, or one where there are fewer groups than shards.
static uint64_t portion_size(const Spec *spec, Shard shard)
{
    const uint64_t size = group_size(spec);
    return design_run_count(spec) / size >= shard.count ? size : 1;
}

uint64_t design_next(const Spec *spec, Shard shard, uint64_t from)
{
    assert(shard.index < shard.count);
    const uint64_t runs = design_run_count(spec);
    const uint64_t size = portion_size(spec, shard);
    if (from >= runs) {
        return runs;
    }
    const uint64_t portion = from / size;
    const uint64_t turn = portion % shard.count;
    if (turn == shard.index) {
        return from;
    }
    const uint64_t ahead = (shard.index + shard.count - turn) % shard.count;
    // compared in portions: their product with the size may be out of range
    const uint64_t portions = runs / size;
    return ahead < portions - portion ? (portion + ahead) * size : runs;
}

uint64_t design_shard_count(const Spec *spec, Shard shard)
{
    assert(shard.index < shard.count);
    const uint64_t size = portion_size(spec, shard);
    const uint64_t portions = design_run_count(spec) / size;
    const uint64_t own = portions / shard.count + (shard.index < portions % shard.count ? 1 : 0);
    return own * size;
}

// The overrides of a run, each KEY=VALUE, one under another in a text.
typedef struct Overrides {
    size_t count;
    Text texts[SPEC_VARIABLE_MAX];
    const char *all[SPEC_SETTING_MAX + SPEC_VARIABLE_MAX];
} Overrides;

static void add_value(const Variable *variable, const Cell *value, Text *text)
{
    if (variable->is_word) {
        text_append(text, "%s=%s", variable->key, value->word);
    } else if (variable->is_whole) {
        text_append(text, "%s=%.0f", variable->key, value->number);
    } else {
        const char *blank = variable->unit[0] != '\0' ? " " : "";
        text_append(text, "%s=", variable->key);
        text_append_number(text, value->number);
        text_append(text, "%s%s", blank, variable->unit);
    }
}

static void overrides_make(const Spec *spec, const Cell *values, Overrides *overrides)
{
    *overrides = (Overrides){0};
    for (size_t i = 0; i < spec->set_count; i++) {
        overrides->all[overrides->count++] = spec->set[i];
    }
    for (size_t i = 0; i < spec->variable_count; i++) {
        text_init(&overrides->texts[i]);
        if (strcmp(spec->variables[i].key, SPEC_SCHEME_KEY) != 0) {
            add_value(&spec->variables[i], &values[i], &overrides->texts[i]);
            overrides->all[overrides->count++] = overrides->texts[i].data;
        }
    }
}

static void overrides_finish(const Spec *spec, Overrides *overrides)
{
    for (size_t i = 0; i < spec->variable_count; i++) {
        text_finish(&overrides->texts[i]);
    }
}

static bool apply_scheme(const char *name, Scenario *scenario, BackendKind *backend, Err *err)
{
    Scheme schemes[SCHEME_MAX];
    const size_t count = scheme_list(scenario, schemes);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(schemes[i].name, name) != 0) {
            continue;
        }
        if (scheme_has_step(&schemes[i]) && scenario->run.step == 0.0) {
            return err_set(err, ERR_CASE, "scheme %s needs a step: run.step is auto", name);
        }
        scheme_apply(&schemes[i], scenario->run.step, scenario);
        *backend = schemes[i].backend;
        return true;
    }
    return err_set(err, ERR_CASE, "with these values there is no scheme %s", name);
}

// Messages go into a column: without the lines that show the place, and without the option's name,
// as nobody gave one.
static void keep_sentence(const Err *own, Err *err)
{
    static const char OPTION[] = "--set ";
    const bool is_option = strncmp(own->text, OPTION, strlen(OPTION)) == 0;
    const char *start = own->text + (is_option ? strlen(OPTION) : 0);
    err_set(err, ERR_CASE, "%.*s", (int)strcspn(start, "\n"), start);
}

bool design_scenario(const Spec *spec, const Cell *values, Scenario *scenario, BackendKind *backend,
                     Err *err)
{
    // the name of the case without its folder: rows are the same wherever a study is run from
    const char *slash = strrchr(spec->case_path, '/');
    const char *name = slash != NULL ? slash + 1 : spec->case_path;
    Overrides overrides;
    overrides_make(spec, values, &overrides);
    Err own = {0};
    Scenario built = {.point_count = 0};
    BackendKind chosen = BACKEND_ODE;
    bool is_good = casefile_load_text(name, spec->case_text, spec->case_size, overrides.all,
                                      overrides.count, &built, &own);
    for (size_t i = 0; is_good && i < spec->variable_count; i++) {
        if (strcmp(spec->variables[i].key, SPEC_SCHEME_KEY) == 0) {
            is_good = apply_scheme(values[i].word, &built, &chosen, &own);
        }
    }
    overrides_finish(spec, &overrides);
    if (!is_good) {
        scenario_free(&built);
        keep_sentence(&own, err);
        return false;
    }
    *scenario = built;
    *backend = chosen;
    return true;
}
