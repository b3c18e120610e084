// Takes other engines into a comparison: which, in which ways, and how cheap each is.
#include "commands/compare/compare.h"
#include "write/json_value.h"
#include "write/table.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { LIST_SIZE = 1024, TARGET_COUNT = 5 };

// errors for which the cheapest of every backend is named
static const double TARGETS[TARGET_COUNT] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};

// One entry of --backends.
typedef struct Entry {
    char name[LIST_SIZE];
    const char *ways; // behind the '/', or NULL
} Entry;

static bool next_entry(const char **list, Entry *entry)
{
    const char *start = *list + strspn(*list, ", ");
    const size_t length = strcspn(start, ", ");
    snprintf(entry->name, sizeof entry->name, "%.*s", (int)length, start);
    *list = start + length;
    char *mark = strchr(entry->name, '/');
    entry->ways = mark != NULL ? mark + 1 : NULL;
    if (mark != NULL) {
        *mark = '\0';
    }
    return length > 0;
}

static EngineDriver *find_known(CompareEngines *engines, const char *name)
{
    for (size_t i = 0; i < engines->count; i++) {
        if (strcmp(engines->drivers[i].name, name) == 0) {
            return &engines->drivers[i];
        }
    }
    return NULL;
}

// The drivers that --driver names.
static bool read_given(const CompareOptions *options, CompareEngines *engines, Err *err)
{
    for (size_t i = 0; i < options->driver_count; i++) {
        EngineDriver *driver = &engines->drivers[engines->count];
        if (!engine_given(options->drivers[i], driver, err)) {
            return false;
        }
        if (find_known(engines, driver->name) != NULL) {
            return err_set(err, ERR_USAGE, "--driver names '%s' twice", driver->name);
        }
        engines->count++;
    }
    return true;
}

// The driver of a name; it is looked for where it is not known yet.
static EngineDriver *find(CompareEngines *engines, const char *name, Err *err)
{
    EngineDriver *known = find_known(engines, name);
    if (known != NULL) {
        return known;
    }
    if (engines->count == ENGINE_DRIVER_MAX) {
        err_set(err, ERR_USAGE, "--backends names more than %d engines", ENGINE_DRIVER_MAX);
        return NULL;
    }
    EngineDriver *driver = &engines->drivers[engines->count];
    if (!engine_find(name, driver, err)) {
        return NULL;
    }
    engines->count++;
    return driver;
}

static bool take_entry(CompareEngines *engines, const Entry *entry, bool *has_ode, Err *err)
{
    if (strcmp(entry->name, "ode") == 0) {
        *has_ode = true;
        return entry->ways == NULL ||
               err_set(err, ERR_USAGE, "--schemes, and not --backends, chooses ways of ODE");
    }
    EngineDriver *driver = find(engines, entry->name, err);
    return driver != NULL &&
           scheme_add_engine(driver, entry->ways, engines->schemes, &engines->scheme_count, err);
}

CompareEngines *compare_engines_read(const CompareOptions *options, Err *err)
{
    CompareEngines *engines = calloc(1, sizeof *engines);
    assert(engines != NULL);
    engines->has_ode = options->backends == NULL;
    bool is_read = read_given(options, engines, err);
    for (size_t i = 0; is_read && options->backends == NULL && i < engines->count; i++) {
        is_read = scheme_add_engine(&engines->drivers[i], NULL, engines->schemes,
                                    &engines->scheme_count, err);
    }
    Entry entry;
    size_t entries = 0;
    for (const char *list = options->backends; is_read && list != NULL && next_entry(&list, &entry);
         entries++) {
        is_read = take_entry(engines, &entry, &engines->has_ode, err);
    }
    if (is_read && options->backends != NULL && entries == 0) {
        is_read = err_set(err, ERR_USAGE, "the list of backends is empty");
    }
    if (!is_read) {
        free(engines);
        return NULL;
    }
    return engines;
}

bool compare_engines_check(const CompareEngines *engines, const Scenario *scenario,
                           double time_limit_s, Err *err)
{
    const char *ways[ENGINE_WAY_MAX];
    for (size_t i = 0, next; i < engines->scheme_count; i = next) {
        const EngineDriver *driver = engines->schemes[i].driver;
        for (next = i; next < engines->scheme_count && next - i < ENGINE_WAY_MAX &&
                       engines->schemes[next].driver == driver;
             next++) {
            ways[next - i] = engines->schemes[next].way;
        }
        if (!engine_takes(driver, ways, next - i, scenario, time_limit_s, err)) {
            err_prefix(err, scenario_path(scenario));
            return false;
        }
    }
    return true;
}

void compare_engines_apply(const CompareEngines *engines, Scheme *schemes, size_t *count)
{
    size_t kept = 0;
    for (size_t i = 0; i < *count; i++) {
        if (engines->has_ode || schemes[i].backend != BACKEND_ODE) {
            schemes[kept++] = schemes[i];
        }
    }
    *count = kept;
    for (size_t i = 0; i < engines->scheme_count; i++) {
        assert(*count < SCHEME_MAX);
        schemes[(*count)++] = engines->schemes[i];
    }
}

// Another engine, or another build of its driver, is another comparison.
json_t *compare_engines_key(const Ladder *ladder)
{
    json_t *key = json_array();
    const EngineDriver *last = NULL;
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        const EngineDriver *driver = ladder->schemes[i].driver;
        struct stat file = {.st_size = 0};
        if (driver == NULL || driver == last) {
            continue;
        }
        last = driver;
        stat(driver->program, &file);
        json_array_append_new(
            key, json_pack("{s:o, s:s, s:s, s:s, s:I, s:I}", "program",
                           json_value_text(driver->program), "engine", driver->engine, "version",
                           driver->version, "precision", driver->precision, "size",
                           (json_int_t)file.st_size, "changed_s", (json_int_t)file.st_mtime));
    }
    return key;
}

static bool is_new_driver(const Ladder *ladder, size_t scheme)
{
    const EngineDriver *driver = ladder->schemes[scheme].driver;
    return driver != NULL && (scheme == 0 || ladder->schemes[scheme - 1].driver != driver);
}

bool compare_engines_are_any(const Ladder *ladder)
{
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        if (ladder->schemes[i].driver != NULL) {
            return true;
        }
    }
    return false;
}

json_t *compare_engines_json(const Ladder *ladder)
{
    json_t *list = json_array();
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        const EngineDriver *driver = ladder->schemes[i].driver;
        if (!is_new_driver(ladder, i)) {
            continue;
        }
        json_t *ways = json_array();
        for (size_t k = 0; k < driver->way_count; k++) {
            json_array_append_new(ways, json_string(driver->ways[k]));
        }
        json_array_append_new(list,
                              json_pack("{s:s, s:o, s:o, s:o, s:o, s:o}", "name", driver->name,
                                        "program", json_value_text(driver->program), "engine",
                                        json_value_text(driver->engine), "version",
                                        json_value_text(driver->version), "precision",
                                        json_value_text(driver->precision), "ways", ways));
    }
    return list;
}

void compare_engines_write(const Ladder *ladder, Text *text)
{
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        const EngineDriver *driver = ladder->schemes[i].driver;
        if (is_new_driver(ladder, i)) {
            text_append(text, "  %-11s %s %s, in %s precision, by ", driver->name, driver->engine,
                        driver->version, driver->precision);
            text_append_shown(text, driver->program);
            text_append(text, "\n");
        }
    }
}

// The cheapest point of a backend for a target, or NULL.
static const LadderPoint *cheapest_of(const Ladder *ladder, const char *backend, double target)
{
    const LadderPoint *best = NULL;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        const bool is_its = strcmp(scheme_backend(&ladder->schemes[point->scheme]), backend) == 0;
        if (is_its && !point->is_failed && isfinite(point->wall_median_s) &&
            point->error + ladder->truth.uncertainty <= target &&
            (best == NULL || point->wall_median_s < best->wall_median_s)) {
            best = point;
        }
    }
    return best;
}

// The first scheme, from a number on, of ODE or another engine than that of the scheme before it;
// the count where there is none.
static size_t next_engine(const Ladder *ladder, size_t scheme)
{
    for (; scheme < ladder->scheme_count; scheme++) {
        const Scheme *now = &ladder->schemes[scheme];
        const Scheme *last = scheme > 0 ? now - 1 : NULL;
        const bool is_engine = now->backend == BACKEND_ODE || now->driver != NULL;
        if (is_engine &&
            (last == NULL || last->backend != now->backend || last->driver != now->driver)) {
            break;
        }
    }
    return scheme;
}

void compare_engines_write_times(const Ladder *ladder, const Style *style, Text *text)
{
    section_heading("Least time of each backend for an error of at most ..., ms", style, text);
    text_append(text, "\n");
    Table *table = table_create(1 + TARGET_COUNT);
    table_fit(table, style->width);
    table_head(table, 0, "backend", "", TABLE_LEFT);
    for (size_t i = 0; i < TARGET_COUNT; i++) {
        char words[32];
        snprintf(words, sizeof words, "%.0e", TARGETS[i]);
        table_head(table, 1 + i, words, "", TABLE_RIGHT);
    }
    for (size_t i = next_engine(ladder, 0); i < ladder->scheme_count;
         i = next_engine(ladder, i + 1)) {
        const char *backend = scheme_backend(&ladder->schemes[i]);
        table_cell(table, "%s", backend);
        for (size_t k = 0; k < TARGET_COUNT; k++) {
            const LadderPoint *point = cheapest_of(ladder, backend, TARGETS[k]);
            section_finite(table, "%.3g", point != NULL ? point->wall_median_s * UNITS_MS : NAN);
        }
    }
    section_end(table, text);
}

// The way of a point: its scheme without the engine's name.
static const char *way_of(const Ladder *ladder, const LadderPoint *point)
{
    const Scheme *scheme = &ladder->schemes[point->scheme];
    return scheme->driver != NULL ? scheme->way : scheme->name;
}

static void write_cheapest(const Ladder *ladder, const LadderPoint *point, Table *table)
{
    if (point == NULL) {
        table_cell(table, "none of these");
        for (int i = 0; i < 3; i++) {
            table_cell(table, " ");
        }
        return;
    }
    table_cell(table, "%s", way_of(ladder, point));
    table_cell(table, point->step_s > 0.0 ? "%.4g" : "its own", point->step_s * UNITS_US);
    table_cell(table, "%.2e", point->error);
    table_cell(table, "%.4g", point->wall_median_s * UNITS_MS);
}

const char *compare_engines_settings(const Ladder *ladder, size_t scheme)
{
    const size_t point = ladder_finest(ladder, scheme);
    return ladder->schemes[scheme].driver != NULL && point < ladder->point_count
               ? ladder->points[point].run.message
               : "";
}

void compare_engines_write_ways(const Ladder *ladder, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"backend", "", TABLE_LEFT},      {"error at most", "", TABLE_RIGHT},
        {"cheapest way", "", TABLE_LEFT}, {"step", "us", TABLE_RIGHT},
        {"error", "1", TABLE_RIGHT},      {"wall time", "ms", TABLE_RIGHT},
    };
    Table *table = section_begin("Cheapest way of each backend", sizeof HEADS / sizeof *HEADS,
                                 HEADS, style, text);
    for (size_t i = next_engine(ladder, 0); i < ladder->scheme_count;
         i = next_engine(ladder, i + 1)) {
        const char *backend = scheme_backend(&ladder->schemes[i]);
        for (size_t k = 0; k < TARGET_COUNT; k++) {
            table_cell(table, "%s", k == 0 ? backend : "");
            table_cell(table, "%.0e", TARGETS[k]);
            write_cheapest(ladder, cheapest_of(ladder, backend, TARGETS[k]), table);
        }
        table_rule(table);
    }
    section_end(table, text);
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        const char *settings = compare_engines_settings(ladder, i);
        if (settings[0] != '\0') {
            Text words;
            text_init(&words);
            text_append(&words, "  %s: ", ladder->schemes[i].name);
            text_append_shown(&words, settings);
            screen_line(&words, text);
        }
    }
}

json_t *compare_engines_cheapest(const Ladder *ladder)
{
    json_t *list = json_array();
    for (size_t i = next_engine(ladder, 0); i < ladder->scheme_count;
         i = next_engine(ladder, i + 1)) {
        const char *backend = scheme_backend(&ladder->schemes[i]);
        for (size_t k = 0; k < TARGET_COUNT; k++) {
            const LadderPoint *point = cheapest_of(ladder, backend, TARGETS[k]);
            const bool has_step = point != NULL && point->step_s > 0.0;
            json_t *row = json_pack("{s:s, s:f, s:s?}", "backend", backend, "error_at_most",
                                    TARGETS[k], "scheme", point != NULL ? point->name : NULL);
            json_value_set(row, "step_s", has_step ? point->step_s : NAN);
            json_value_set(row, "error_max", point != NULL ? point->error : NAN);
            json_value_set(row, "wall_median_s", point != NULL ? point->wall_median_s : NAN);
            json_array_append_new(list, row);
        }
    }
    return list;
}
