// Reads what is asked of a mapping beside the case: steps, maps, laws, mass and speed.
#include "commands/map/map_settings.h"
#include "cli/option_values.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PART_SIZE = 64 };

// from where a steel contact is hardly seen to where the textbook map sees it right
static const double DEFAULT_STEPS[] = {3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7};

// Reads a list of words of the choices; each one once.
static bool read_words(const char *name, const char *list, const char *const *choices, int *words,
                       size_t room, size_t *count, Err *err)
{
    *count = 0;
    while (*list != '\0') {
        char part[PART_SIZE];
        list += strspn(list, " ");
        const size_t length = strcspn(list, ",");
        size_t end = length;
        for (; end > 0 && list[end - 1] == ' '; end--) {
        }
        snprintf(part, sizeof part, "%.*s", (int)end, list);
        list += length + (list[length] == ',' ? 1 : 0);
        int word = 0;
        while (choices[word] != NULL && strcmp(choices[word], part) != 0) {
            word++;
        }
        bool is_twice = false;
        for (size_t i = 0; i < *count; i++) {
            is_twice = is_twice || words[i] == word;
        }
        if (choices[word] == NULL || is_twice || *count == room) {
            Text allowed;
            text_init(&allowed);
            for (int i = 0; choices[i] != NULL; i++) {
                text_append(&allowed, "%s%s", i == 0 ? "" : ", ", choices[i]);
            }
            err_set(err, ERR_USAGE, "--%s: '%s' %s; allowed: %s", name, part,
                    is_twice ? "is given twice" : "is none of them", allowed.data);
            text_finish(&allowed);
            return false;
        }
        words[(*count)++] = word;
    }
    return *count > 0 || err_set(err, ERR_USAGE, "--%s: the list is empty", name);
}

// A source by its word, or a value of its own.
static bool read_source(const char *name, const char *text, Dimension dimension,
                        MappingSource *source, double *value, Err *err)
{
    *source = MAPPING_MEDIAN;
    if (text == NULL || strcmp(text, "median") == 0) {
        return true;
    }
    if (strcmp(text, "most") == 0) {
        *source = MAPPING_MOST;
        return true;
    }
    *source = MAPPING_GIVEN;
    return option_values_read_quantity(name, text, dimension, value, err);
}

static bool map_settings_read_steps(const MapChoices *choices, const Scenario *scenario,
                                    MappingSettings *settings, Err *err)
{
    if (choices->steps != NULL) {
        return option_values_read_times("steps", choices->steps, MAPPING_STEP_MAX, settings->steps,
                                        &settings->step_count, err);
    }
    if (choices->step_s > 0.0) {
        settings->steps[settings->step_count++] = choices->step_s;
        return true;
    }
    if (choices->at_step_s > 0.0) {
        settings->steps[settings->step_count++] = choices->at_step_s;
        settings->is_held = true;
        return true;
    }
    // the usual ones, coarse to fine, with the case's own in order
    double own = scenario->run.step;
    for (size_t i = 0; i < sizeof DEFAULT_STEPS / sizeof *DEFAULT_STEPS; i++) {
        const double usual = DEFAULT_STEPS[i];
        const bool is_same = fabs(own - usual) < 1e-9 * usual;
        if (own > 0.0 && (own > usual || is_same)) {
            settings->steps[settings->step_count++] = own;
            own = 0.0;
        }
        if (!is_same) {
            settings->steps[settings->step_count++] = usual;
        }
    }
    if (own > 0.0) {
        settings->steps[settings->step_count++] = own;
    }
    return true;
}

// Whether all that touches in a case turns: masses are then inertias, and speeds angular.
static bool map_settings_is_torsional(const Linkage *linkage)
{
    size_t turning = 0;
    size_t loose = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        turning += linkage_is_torsional(&linkage->joints[i]) ? 1 : 0;
        loose += linkage_has_play(&linkage->joints[i]) ? 1 : 0;
    }
    return loose > 0 && turning == loose;
}

bool map_settings_read(const MapChoices *choices, const Scenario *scenario,
                       MappingSettings *settings, Err *err)
{
    *settings = (MappingSettings){0};
    int words[MAPPING_LAW_MAX];
    const bool is_poisson = scenario->contact.model == CONTACT_POISSON;
    if (is_poisson && (choices->maps != NULL || choices->laws != NULL)) {
        return err_set(err, ERR_USAGE,
                       "--%s: the case's contact model is poisson, whose rows know no map and no "
                       "elastic law; --set contact.model=impact has them",
                       choices->maps != NULL ? "maps" : "laws");
    }
    if (choices->maps == NULL) {
        settings->map_count = MAPPING_MAP_COUNT;
    } else if (!read_words("maps", choices->maps, OPTIONS_ODE_MAPS, words, MAPPING_MAP_COUNT,
                           &settings->map_count, err)) {
        return false;
    }
    for (size_t i = 0; i < settings->map_count; i++) {
        settings->maps[i] = choices->maps == NULL ? (OdeMap)i : (OdeMap)words[i];
    }
    if (choices->laws != NULL && strcmp(choices->laws, "all") == 0) {
        for (int i = LAW_AUTO + 1; i < LAW_COUNT; i++) {
            settings->laws[settings->law_count++] = (LawKind)i;
        }
    } else if (choices->laws != NULL) {
        if (!read_words("laws", choices->laws, OPTIONS_LAWS, words, MAPPING_LAW_MAX,
                        &settings->law_count, err)) {
            return false;
        }
        for (size_t i = 0; i < settings->law_count; i++) {
            settings->laws[i] = (LawKind)words[i];
        }
    }
    const bool is_turning = map_settings_is_torsional(&scenario->linkage);
    return map_settings_read_steps(choices, scenario, settings, err) &&
           read_source("mass", choices->mass, is_turning ? DIMENSION_INERTIA : DIMENSION_MASS,
                       &settings->mass_source, &settings->mass, err) &&
           read_source("speed", choices->speed,
                       is_turning ? DIMENSION_ANGULAR_SPEED : DIMENSION_SPEED,
                       &settings->speed_source, &settings->speed, err);
}
