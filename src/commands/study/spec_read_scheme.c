// Are the schemes that a study names there, and do they go with its other keys?
#include "commands/study/spec_read.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// The names of all schemes that the runs may have: they depend on which joints have play, and on
// the model of contact, which may itself vary.
static size_t list_schemes(const Spec *spec, Scheme schemes[2 * SCHEME_MAX])
{
    Scenario *other = malloc(sizeof *other);
    assert(other != NULL);
    size_t count = scheme_list(spec->base, schemes);
    for (size_t i = 0; i < spec->variable_count; i++) {
        if (strcmp(spec->variables[i].key, "contact.model") == 0) {
            *other = *spec->base;
            const bool is_impact = other->contact.model == CONTACT_IMPACT;
            other->contact.model = is_impact ? CONTACT_POISSON : CONTACT_IMPACT;
            count += scheme_list(other, schemes + count);
        }
    }
    free(other);
    return count;
}

// Lists those with the exact collider or the case's, and how the others are called.
static bool refuse_unknown(const Reading *reading, const Node *node, const Scheme *schemes,
                           size_t count)
{
    const char *names[2 * SCHEME_MAX];
    const Scheme *other = NULL;
    Text allowed;
    text_init(&allowed);
    for (size_t i = 0; i < count; i++) {
        names[i] = schemes[i].name;
        if (schemes[i].is_asked || !scheme_has_step(&schemes[i])) {
            text_append(&allowed, "%s%s", i > 0 ? ", " : "", schemes[i].name);
        } else if (other == NULL) {
            other = &schemes[i];
        }
    }
    if (other != NULL) {
        text_append(&allowed, "; those with rows also with a collider, such as %s", other->name);
    }
    const char *nearest = text_nearest(node->text, names, count);
    spec_read_refuse(reading, node, allowed.data, "unknown scheme of this case '%.40s'%s%s%s",
                     node->text, nearest != NULL ? "; did you mean '" : "",
                     nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
    text_finish(&allowed);
    return false;
}

static bool check_scheme(const Reading *reading, const Node *node, const Scheme *schemes,
                         size_t count)
{
    if (!spec_read_single(reading, node, "a scheme", "its name, such as direct/plain/corrected")) {
        return false;
    }
    const Scheme *found = NULL;
    for (size_t i = 0; i < count; i++) {
        found = strcmp(schemes[i].name, node->text) == 0 ? &schemes[i] : found;
    }
    if (found == NULL) {
        return refuse_unknown(reading, node, schemes, count);
    }
    const Spec *spec = reading->spec;
    if (scheme_has_step(found) && spec->base->run.step == 0.0 &&
        spec_variable(spec, "run.step") == NULL) {
        return spec_read_refuse(reading, node, "run.step under set or vary, such as 1 us",
                                "%s needs a step, which is auto in the case", node->text);
    }
    return true;
}

// Schemes say by themselves what these keys would.
static bool check_scheme_alone(const Reading *reading, const Node *value)
{
    static const char *const KEYS[] = {"ode.solver", "ode.stepping", "ode.map", "ode.collider",
                                       "run.tolerance"};
    for (size_t i = 0; i < sizeof KEYS / sizeof KEYS[0]; i++) {
        if (spec_variable(reading->spec, KEYS[i]) != NULL || spec_sets(reading->spec, KEYS[i])) {
            return source_error(&reading->source, keys_span(value), "one of the two", reading->err,
                                "scheme and %s exclude each other", KEYS[i]);
        }
    }
    return true;
}

bool spec_read_check_schemes(const Reading *reading)
{
    const Node *value =
        reading->vary != NULL ? spec_read_child(reading->vary, SPEC_SCHEME_KEY) : NULL;
    if (value == NULL) {
        return true;
    }
    Scheme *schemes = calloc(2 * SCHEME_MAX, sizeof *schemes);
    assert(schemes != NULL);
    const size_t count = list_schemes(reading->spec, schemes);
    bool is_good = check_scheme_alone(reading, value);
    for (const Node *item = spec_read_first(value); is_good && item != NULL;
         item = spec_read_next(value, item)) {
        is_good = check_scheme(reading, item, schemes, count);
    }
    free(schemes);
    return is_good;
}
