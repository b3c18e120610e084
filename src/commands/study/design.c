// Gives the scenario of each run of a study from the run's number.
//
// A run's number is a number of mixed radix: from slow to fast one digit for each key of the grid
// that changes the truth, one for the draw, one for each key of the grid that does not. Runs that
// differ in the last ones only (and in the draw, where nothing that is drawn changes the truth) are
// a group.
#include "commands/study/design.h"

#include "base/hash.h"
#include "base/text.h"
#include "cli/common_options.h"
#include "commands/study/normal.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The value of a variable in a draw.
//
// Random numbers come from a counter: three rounds of a 64-bit mixer, over seed, stream and
// position. Each round is a bijection in which every bit of what goes in flips every bit of what
// comes out with a chance of a half (Stafford's variant 13 of MurmurHash3's finaliser, as in
// Steele, Lea and Flood, Fast splittable pseudorandom number generators, OOPSLA 2014).
//
// A Latin hypercube of n draws takes draw i of a variable from the share
//     u = (s(i) + r) / n,
// s an order of 0 to n-1 and r from 0 to 1. s is a Feistel network over the next power of four: two
// halves of a number's bits, each in turn changed by a random function of the other. That is a
// bijection whatever the function; a result beyond n is put in again until it is not (Black and
// Rogaway, Ciphers with arbitrary finite domains, CT-RSA 2002), at most four times on the average.
// The network makes even permutations alone: half of the time the first two positions are swapped.
//
// Values follow from shares by the inverse of their distribution:
//     uniform      low + u (high - low)
//     log-uniform  low (high / low)^u
//     normal       mean + deviation z(u), z of the standard normal distribution between its limits
//     triangular   low + sqrt(u (high - low) (mode - low)) up to the mode, the same from above

// two rounds a half would do for large numbers; small ones have few bits to mix with
enum { ROUND_COUNT = 10 };

// What keeps the numbers of one purpose apart from another's.
typedef enum Purpose { PURPOSE_SHARE, PURPOSE_POSITION } Purpose;

static uint64_t mix(uint64_t bits)
{
    bits += HASH_START; // so that 0 is no fixed point
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    return bits ^ (bits >> 31);
}

static uint64_t random_bits(uint64_t seed, uint64_t stream, Purpose purpose, uint64_t position)
{
    return mix(mix(mix(seed) ^ (stream + (uint64_t)purpose)) ^ position);
}

double draw_share(uint64_t seed, uint64_t stream, uint64_t position)
{
    // 52 bits and a half: the ends 0 and 1 are out of reach
    return ((double)(random_bits(seed, stream, PURPOSE_SHARE, position) >> 12) + 0.5) * 0x1p-52;
}

uint64_t draw_position(uint64_t seed, uint64_t stream, uint64_t count, uint64_t item)
{
    assert(item < count);
    unsigned half = 1;
    while (count >> (2 * half) != 0) {
        half++;
    }
    const uint64_t mask = ((uint64_t)1 << half) - 1;
    const uint64_t own = random_bits(seed, stream, PURPOSE_POSITION, count);
    uint64_t position = item;
    do {
        uint64_t left = position >> half;
        uint64_t right = position & mask;
        for (uint64_t round = 0; round < ROUND_COUNT; round++) {
            const uint64_t next = left ^ (mix(own ^ (right * ROUND_COUNT + round)) & mask);
            left = right;
            right = next;
        }
        position = left << half | right;
        position ^= position < 2 ? own >> 63 : 0;
    } while (position >= count);
    return position;
}

uint64_t draw_stream(const char *key)
{
    return hash_bytes(HASH_START, key, strlen(key));
}

// The share of a draw of a Latin hypercube.
static double latin_share(uint64_t seed, uint64_t stream, uint64_t count, uint64_t draw)
{
    const double share = draw_share(seed, stream, draw);
    const double position = (double)draw_position(seed, stream, count, draw);
    // what rounding would lift into the next share stays in its own
    return fmin(position + share, nextafter(position + 1.0, 0.0)) / (double)count;
}

// Whether a draw of DRAW_SOBOL has a variable of the second sample.
static bool is_of_second(const Spec *spec, const Variable *variable, uint64_t draw)
{
    const uint64_t sample = draw / spec->draw_base;
    uint64_t number = 2;
    for (const Variable *other = spec->variables; other < variable; other++) {
        number += other->is_drawn ? 1 : 0;
    }
    return sample == 1 || sample == number;
}

double draw_variable_share(const Spec *spec, const Variable *variable, uint64_t draw)
{
    const uint64_t stream = draw_stream(variable->key);
    switch (spec->method) {
    case DRAW_RANDOM:
        break;
    case DRAW_LATIN_HYPERCUBE:
        return latin_share(spec->seed, stream, spec->draws, draw);
    case DRAW_SOBOL:
        return latin_share(spec->seed,
                           is_of_second(spec, variable, draw) ? hash_bytes(stream, "second", 6)
                                                              : stream,
                           spec->draw_base, draw % spec->draw_base);
    }
    return draw_share(spec->seed, stream, draw);
}

static double normal_value(const Variable *variable, double share)
{
    const double low = (variable->low - variable->centre) / variable->deviation;
    const double high = (variable->high - variable->centre) / variable->deviation;
    return variable->centre + variable->deviation * normal_quantile(share, low, high);
}

static double triangular_value(const Variable *variable, double share)
{
    const double width = variable->high - variable->low;
    const double below = variable->centre - variable->low;
    if (share * width <= below) {
        return variable->low + sqrt(share * width * below);
    }
    return variable->high - sqrt((1.0 - share) * width * (variable->high - variable->centre));
}

// Each whole number from the lowest to the highest has the same share.
static double whole_value(const Variable *variable, double share)
{
    return variable->low + floor(share * (variable->high - variable->low + 1.0));
}

double draw_value(const Variable *variable, double share)
{
    double value = NAN;
    switch (variable->kind) {
    case VARIABLE_UNIFORM:
        value = variable->is_whole ? whole_value(variable, share)
                                   : variable->low + share * (variable->high - variable->low);
        break;
    case VARIABLE_LOG_UNIFORM:
        value = variable->low * pow(variable->high / variable->low, share);
        break;
    case VARIABLE_NORMAL:
        value = normal_value(variable, share);
        break;
    case VARIABLE_TRIANGULAR:
        value = triangular_value(variable, share);
        break;
    case VARIABLE_LIST:
    case VARIABLE_LINEAR:
    case VARIABLE_LOGARITHMIC:
        assert(false);
    }
    return fmin(fmax(value, variable->low), variable->high);
}

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

uint64_t design_group_size(const Spec *spec)
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

double design_number(const Variable *variable, uint64_t digit)
{
    return variable->kind == VARIABLE_LIST ? variable->numbers[digit]
                                           : range_number(variable, digit);
}

// Whether the values of a variable are those of a key of the case.
static bool is_of_case(const Variable *variable)
{
    return strcmp(variable->key, SPEC_SCHEME_KEY) != 0 &&
           strcmp(variable->key, SPEC_DIRECTION_KEY) != 0;
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
        } else {
            values[i].number = design_number(variable, digit);
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
    return run / design_group_size(spec);
}

uint64_t design_block_size(const Spec *spec)
{
    return (spec->has_neighbours ? DESIGN_BLOCK_GROUPS : 1) * design_group_size(spec);
}

// How many runs in a row a shard takes: a block, or a group where there are fewer blocks than
// shards, or one where there are fewer groups.
static uint64_t portion_size(const Spec *spec, Shard shard)
{
    const uint64_t runs = design_run_count(spec);
    const uint64_t block = design_block_size(spec);
    const uint64_t group = design_group_size(spec);
    return runs / block >= shard.count ? block : runs / group >= shard.count ? group : 1;
}

// How many portions there are; the last may have fewer runs.
static uint64_t portion_count(const Spec *spec, uint64_t size)
{
    const uint64_t runs = design_run_count(spec);
    return runs / size + (runs % size > 0 ? 1 : 0);
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
    const uint64_t portions = portion_count(spec, size);
    return ahead < portions - portion ? (portion + ahead) * size : runs;
}

uint64_t design_shard_count(const Spec *spec, Shard shard)
{
    assert(shard.index < shard.count);
    const uint64_t size = portion_size(spec, shard);
    const uint64_t portions = portion_count(spec, size);
    const uint64_t own = portions / shard.count + (shard.index < portions % shard.count ? 1 : 0);
    const bool has_last = (portions - 1) % shard.count == shard.index;
    return own * size - (has_last ? portions * size - design_run_count(spec) : 0);
}

// The overrides of a run, each KEY=VALUE, one under another in a text.
typedef struct Overrides {
    size_t count;
    Text texts[SPEC_VARIABLE_MAX];
    const char *all[SPEC_SETTING_MAX + SPEC_VARIABLE_MAX];
} Overrides;

static void design_add_value(const Variable *variable, const Cell *value, Text *text)
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
        if (is_of_case(&spec->variables[i])) {
            design_add_value(&spec->variables[i], &values[i], &overrides->texts[i]);
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

static bool design_apply_scheme(const char *name, Scenario *scenario, BackendKind *backend,
                                Err *err)
{
    Scheme schemes[SCHEME_MAX];
    EngineWay way;
    if (scheme_is_engine(name, backend, &way)) {
        scenario->engines[*backend].way = way;
        return true;
    }
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

// 1: of the reference's steps where nobody asks for more. Largest forces of a motion that repeats
// are then right to some 1e-6, in a third of the time of 3e-13.
static const double QUICK_TOLERANCE = 1e-8;

bool design_scenario(const Spec *spec, const Cell *values, Scenario *scenario, BackendKind *backend,
                     Err *err)
{
    Overrides overrides;
    overrides_make(spec, values, &overrides);
    Err own = {0};
    Scenario built = {.point_count = 0};
    BackendKind chosen = spec->backend;
    bool is_good = casefile_repeat(spec->repeat, overrides.all, overrides.count, &built, &own);
    for (size_t i = 0; is_good && i < spec->variable_count; i++) {
        if (strcmp(spec->variables[i].key, SPEC_SCHEME_KEY) == 0) {
            is_good = design_apply_scheme(values[i].word, &built, &chosen, &own);
        }
    }
    for (size_t i = 0; is_good && i < spec->driver_count; i++) {
        BackendKind of;
        is_good = common_options_driver(spec->drivers[i], &of, &own);
        built.engines[of].driver = spec->drivers[i];
    }
    common_options_limit_drivers(spec->limits.time_s, &built);
    overrides_finish(spec, &overrides);
    if (!is_good) {
        scenario_free(&built);
        keep_sentence(&own, err);
        return false;
    }
    if (spec->is_quick) {
        built.reference.tolerance = QUICK_TOLERANCE;
    }
    *scenario = built;
    *backend = chosen;
    return true;
}
