// Lists the ways to run a scenario.
#include "measure/scheme.h"
#include "base/text.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ENTRY_SIZE = 256 };

static int word_count(const char *const *words)
{
    int count = 0;
    while (words[count] != NULL) {
        count++;
    }
    return count;
}

// First and last word of a choice: one of them only where it makes no difference.
typedef struct Choice {
    int first;
    int last;
} Choice;

static Choice scheme_choose(const char *const *words, bool matters, int as_it_is)
{
    return matters ? (Choice){0, word_count(words) - 1} : (Choice){as_it_is, as_it_is};
}

// The exact collider goes without saying. A study lists the schemes of every run: to print each
// name would take longer than a short run's steps.
static void name_scheme(Scheme *scheme, bool has_map)
{
    const bool has_collider = scheme->collider != ODE_COLLIDER_PIN_HOLE;
    const char *const parts[] = {
        OPTIONS_ODE_SOLVERS[scheme->solver],
        "/",
        OPTIONS_ODE_STEPPINGS[scheme->stepping],
        has_map ? "/" : "",
        has_map ? OPTIONS_ODE_MAPS[scheme->map] : "",
        has_collider ? "/" : "",
        has_collider ? OPTIONS_ODE_COLLIDERS[scheme->collider] : "",
    };
    size_t length = 0;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const size_t size = strlen(parts[i]);
        assert(length + size < sizeof scheme->name);
        memcpy(scheme->name + length, parts[i], size);
        length += size;
    }
    scheme->name[length] = '\0';
}

// Whether two choices go together in a scenario.
static bool go_together(const Scheme *scheme, const Scenario *scenario, bool has_map)
{
    const bool is_impulse = has_map && scheme->map == ODE_MAP_IMPULSE;
    return (OPTIONS_ODE_STEPPING_IS_GENERAL[scheme->stepping] ||
            scenario_is_extrapolable(scenario)) &&
           !(is_impulse && scheme->stepping != ODE_STAGGERED) &&
           !(is_impulse && scheme->collider != ODE_COLLIDER_PIN_HOLE);
}

// Those that stand for their kind: the textbook's use of ODE, the best of plain and of staggered
// stepping, and the quick solver at its plainest and at its best.
static bool is_usual(const Scheme *scheme, bool has_map)
{
    if (!has_map) {
        return true;
    }
    const bool is_plain = scheme->stepping == ODE_PLAIN;
    const bool is_first = is_plain && scheme->map == ODE_MAP_TEXTBOOK;
    const bool is_best = !is_plain && scheme->map == ODE_MAP_IMPULSE;
    const bool is_direct = scheme->solver == ODE_DIRECT;
    return is_first || is_best || (is_direct && is_plain && scheme->map == ODE_MAP_CORRECTED) ||
           (is_direct && !is_plain && scheme->map == ODE_MAP_MIDPOINT);
}

static void add_ode(const Scheme *scheme, OdeCollider of_case, bool has_map, Scheme *schemes,
                    size_t *count)
{
    assert(*count < SCHEME_MAX);
    Scheme *added = &schemes[(*count)++];
    *added = *scheme;
    added->is_asked = scheme->collider == ODE_COLLIDER_PIN_HOLE || scheme->collider == of_case;
    added->is_usual = added->is_asked && is_usual(scheme, has_map);
    name_scheme(added, has_map);
}

// Steps that ODE chooses for these errors.
static void add_chosen(const Scenario *scenario, Scheme *schemes, size_t *count)
{
    if (scenario_has_clearance(scenario) && scenario->contact.model == CONTACT_POISSON) {
        return;
    }
    for (int digits = 3; digits < 3 + SCHEME_CHOSEN; digits++) {
        Scheme *added = &schemes[(*count)++];
        *added = (Scheme){.backend = BACKEND_ODE, .tolerance = pow(10.0, -digits)};
        snprintf(added->name, sizeof added->name, "auto/1e-%d", digits);
    }
}

static size_t list_ode(const Scenario *scenario, Scheme *schemes)
{
    const OdeOptions *ode = &scenario->ode;
    const bool has_play = scenario_has_clearance(scenario);
    const bool has_map = has_play && scenario->contact.model != CONTACT_POISSON;
    const Choice maps = scheme_choose(OPTIONS_ODE_MAPS, has_map, (int)ode->map);
    // without play every collider is the exact one, which has nothing to do; in space there is no
    // other
    const bool has_colliders = has_play && !scenario->linkage.is_spatial;
    const Choice colliders =
        scheme_choose(OPTIONS_ODE_COLLIDERS, has_colliders, ODE_COLLIDER_PIN_HOLE);
    const int solvers = word_count(OPTIONS_ODE_SOLVERS);
    const int steppings = word_count(OPTIONS_ODE_STEPPINGS);
    size_t count = 0;
    for (int solver = 0; solver < solvers; solver++) {
        for (int stepping = 0; stepping < steppings; stepping++) {
            for (int map = maps.first; map <= maps.last; map++) {
                for (int collider = colliders.first; collider <= colliders.last; collider++) {
                    const Scheme scheme = {.backend = BACKEND_ODE,
                                           .solver = (OdeSolver)solver,
                                           .stepping = (OdeStepping)stepping,
                                           .map = (OdeMap)map,
                                           .collider = (OdeCollider)collider};
                    if (go_together(&scheme, scenario, has_map)) {
                        add_ode(&scheme, ode->collider, has_map, schemes, &count);
                    }
                }
            }
        }
    }
    return count;
}

static void add_backend(BackendKind backend, Scheme *schemes, size_t *count)
{
    schemes[*count] = (Scheme){.backend = backend};
    text_copy(schemes[*count].name, SCHEME_NAME_SIZE, OPTIONS_BACKENDS[backend]);
    (*count)++;
}

bool scheme_check(const Scenario *scenario, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (!linkage_is_driven(linkage, (int)i)) {
            return true;
        }
    }
    return err_set(err, ERR_CASE,
                   "there is nothing to compare: the drive prescribes how '%s' moves, and there is "
                   "no other body whose motion could be in error",
                   linkage->bodies[linkage_driven_body(linkage)].name);
}

size_t scheme_list(const Scenario *scenario, Scheme schemes[SCHEME_MAX])
{
    size_t count = list_ode(scenario, schemes);
    add_chosen(scenario, schemes, &count);
    add_backend(BACKEND_REFERENCE, schemes, &count);
    if (scenario_has_closed_form(scenario) && !scenario_has_clearance(scenario)) {
        add_backend(BACKEND_ANALYTIC, schemes, &count);
    }
    return count;
}

// Takes the next part of a text up to one of the separators; false where there is none.
static bool next_part(const char **text, const char *separators, char part[ENTRY_SIZE])
{
    const char *start = *text + strspn(*text, separators);
    const size_t length = strcspn(start, separators);
    snprintf(part, ENTRY_SIZE, "%.*s", (int)length, start);
    *text = start + length;
    return length > 0;
}

static bool add_way(const EngineDriver *driver, const char *way, Scheme *schemes, size_t *count,
                    Err *err)
{
    if (*count == SCHEME_ENGINE_MAX) {
        return err_set(err, ERR_USAGE, "these are too many ways of engines at once");
    }
    Scheme *added = &schemes[(*count)++];
    *added = (Scheme){.backend = BACKEND_COUNT, .driver = driver, .way = way, .is_usual = true};
    snprintf(added->name, sizeof added->name, "%s/%s", driver->name, way);
    return true;
}

// The way of a driver that a word names; NULL, with ERR_USAGE, where it has none such.
static const char *find_way(const EngineDriver *driver, const char *word, Err *err)
{
    Text known;
    text_init(&known);
    const char *way = NULL;
    for (size_t i = 0; i < driver->way_count; i++) {
        way = strcmp(driver->ways[i], word) == 0 ? driver->ways[i] : way;
        text_append(&known, "%s%s", i > 0 ? ", " : "", driver->ways[i]);
    }
    if (way == NULL) {
        err_set(err, ERR_USAGE, "'%s' cannot run a case the way '%s'; it has %s", driver->name,
                word, known.data);
    }
    text_finish(&known);
    return way;
}

bool scheme_add_engine(const EngineDriver *driver, const char *ways,
                       Scheme schemes[SCHEME_ENGINE_MAX], size_t *count, Err *err)
{
    char word[ENTRY_SIZE];
    bool is_done = true;
    if (ways == NULL) {
        for (size_t i = 0; is_done && i < driver->way_count; i++) {
            is_done = add_way(driver, driver->ways[i], schemes, count, err);
        }
        return is_done;
    }
    while (is_done && next_part(&ways, "+", word)) {
        const char *way = find_way(driver, word, err);
        is_done = way != NULL && add_way(driver, way, schemes, count, err);
    }
    return is_done;
}

bool scheme_is_engine(const char *name, BackendKind *backend, EngineWay *way)
{
    const size_t length = strcspn(name, "/");
    bool is_engine = false;
    bool is_way = name[length] == '\0';
    *way = ENGINE_WAY_BEST;
    for (int i = 0; i < BACKEND_COUNT && !is_engine; i++) {
        *backend = (BackendKind)i;
        is_engine = options_is_engine(*backend) && strlen(OPTIONS_BACKENDS[i]) == length &&
                    strncmp(OPTIONS_BACKENDS[i], name, length) == 0;
    }
    for (int i = 0; i < ENGINE_WAY_COUNT && !is_way; i++) {
        *way = (EngineWay)i;
        is_way = strcmp(OPTIONS_ENGINE_WAYS[i], name + length + 1) == 0;
    }
    return is_engine && is_way;
}

const char *scheme_backend(const Scheme *scheme)
{
    return scheme->driver != NULL ? scheme->driver->name : OPTIONS_BACKENDS[scheme->backend];
}

bool scheme_is_chosen(const Scheme *scheme)
{
    return scheme->backend == BACKEND_ODE && scheme->tolerance > 0.0;
}

bool scheme_has_step(const Scheme *scheme)
{
    return scheme->driver != NULL || (scheme->backend == BACKEND_ODE && scheme->tolerance == 0.0);
}

void scheme_apply(const Scheme *scheme, double step_s, Scenario *scenario)
{
    if (!scheme_has_step(scheme)) {
        if (scheme->tolerance > 0.0) {
            scenario->run.step = 0.0;
            scenario->run.tolerance = scheme->tolerance;
        }
        return;
    }
    scenario->run.step = step_s;
    if (scheme->driver != NULL) {
        return;
    }
    scenario->ode.solver = scheme->solver;
    scenario->ode.stepping = scheme->stepping;
    scenario->ode.map = scheme->map;
    scenario->ode.collider = scheme->collider;
}

static bool scheme_has_word(const Scheme *scheme, const char *word)
{
    if (strcmp(OPTIONS_ODE_COLLIDERS[scheme->collider], word) == 0) {
        return true;
    }
    const char *rest = scheme->name;
    char part[ENTRY_SIZE];
    while (next_part(&rest, "/", part)) {
        if (strcmp(part, word) == 0) {
            return true;
        }
    }
    return false;
}

static bool is_collider(const char *word)
{
    for (size_t i = 0; OPTIONS_ODE_COLLIDERS[i] != NULL; i++) {
        if (strcmp(OPTIONS_ODE_COLLIDERS[i], word) == 0) {
            return true;
        }
    }
    return false;
}

static bool matches(const Scheme *scheme, const char *entry)
{
    char word[ENTRY_SIZE];
    bool is_match = true;
    bool is_asked = scheme->is_asked || !scheme_has_step(scheme);
    if (strcmp(entry, "all") == 0) {
        return true;
    }
    while (next_part(&entry, "/", word)) {
        is_match = is_match && scheme_has_word(scheme, word);
        is_asked = is_asked || is_collider(word);
    }
    return is_match && is_asked;
}

static bool mark_entry(const char *entry, const Scheme *schemes, size_t count, bool *is_kept,
                       Err *err)
{
    const char *names[SCHEME_MAX];
    size_t named = 0;
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        if (schemes[i].backend == BACKEND_ODE) {
            names[named++] = schemes[i].name;
            is_kept[i] = is_kept[i] || matches(&schemes[i], entry);
            found += matches(&schemes[i], entry) ? 1 : 0;
        }
    }
    if (found > 0) {
        return true;
    }
    const char *nearest = text_nearest(entry, names, named);
    return err_set(err, ERR_USAGE, "no scheme of this case is '%s'; %s '%s'", entry,
                   nearest != NULL ? "did you mean" : "one is", nearest ? nearest : names[0]);
}

void scheme_keep_usual(Scheme *schemes, size_t *count)
{
    size_t kept = 0;
    for (size_t i = 0; i < *count; i++) {
        if (schemes[i].is_usual || !scheme_has_step(&schemes[i])) {
            schemes[kept++] = schemes[i];
        }
    }
    *count = kept;
}

bool scheme_filter(const char *list, Scheme *schemes, size_t *count, Err *err)
{
    bool is_kept[SCHEME_MAX] = {false};
    char entry[ENTRY_SIZE];
    size_t entries = 0;
    for (; next_part(&list, ", ", entry); entries++) {
        if (!mark_entry(entry, schemes, *count, is_kept, err)) {
            return false;
        }
    }
    if (entries == 0) {
        return err_set(err, ERR_USAGE, "the list of schemes is empty");
    }
    size_t kept = 0;
    for (size_t i = 0; i < *count; i++) {
        if (is_kept[i] || schemes[i].backend != BACKEND_ODE) {
            schemes[kept++] = schemes[i];
        }
    }
    *count = kept;
    return true;
}
