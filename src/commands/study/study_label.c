// Names the columns of a study in words, with the units of the study file.
#include "commands/study/study_label.h"
#include "commands/study/metrics.h"
#include "commands/study/store.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// How a unit stands at the end of a name, the longest first.
static const char *const ENDINGS[][2] = {
    {"_Pa_m_s", "Pa m/s"}, {"_N_m_s", "N m s"},  {"_rad_s2", "rad/s^2"},
    {"_m_s2", "m/s^2"},    {"_kg_m2", "kg m^2"}, {"_rad_s", "rad/s"},
    {"_N_m", "N m"},       {"_N_s", "N s"},      {"_m_s", "m/s"},
    {"_rad", "rad"},       {"_kg", "kg"},        {"_Pa", "Pa"},
    {"_N", "N"},           {"_m", "m"},          {"_s", "s"},
    {"_J", "J"},
};
enum { ENDING_COUNT = sizeof ENDINGS / sizeof *ENDINGS };

// The unit at the end of a name, and how long the name is without it.
static const char *unit_of(const char *name, size_t *length)
{
    *length = strlen(name);
    for (size_t i = 0; i < ENDING_COUNT; i++) {
        const size_t size = strlen(ENDINGS[i][0]);
        if (*length > size && strcmp(name + *length - size, ENDINGS[i][0]) == 0) {
            *length -= size;
            return ENDINGS[i][1];
        }
    }
    return "";
}

// Letters of a name as words: _ and - are blanks.
static void spell(const char *name, size_t length, char *words, size_t size)
{
    snprintf(words, size, "%.*s", (int)length, name);
    for (char *c = words; *c != '\0'; c++) {
        *c = (char)(*c == '_' || *c == '-' ? ' ' : *c);
    }
}

// What the groups of a case are called; a member of another group is called by its own name.
static const char *const GROUPS[][2] = {
    {"run", ""},
    {"ode", ""},
    {"drive", "the drive"},
    {"contact", "the contact"},
    {"material", "the material"},
};

// "joints.crank-coupler.radial-clearance" is the radial clearance of crank-coupler.
static void spell_key(const char *key, char *words, size_t size)
{
    const char *last = strrchr(key, '.');
    spell(last != NULL ? last + 1 : key, strlen(last != NULL ? last + 1 : key), words, size);
    if (last == NULL) {
        return;
    }
    const char *owner = key;
    for (const char *c = key; c < last; c++) {
        owner = *c == '.' ? c + 1 : owner;
    }
    char name[CASEFILE_KEY_SIZE];
    snprintf(name, sizeof name, "%.*s", (int)(last - owner), owner);
    const char *shown = name;
    for (size_t i = 0; i < sizeof GROUPS / sizeof *GROUPS; i++) {
        shown = strcmp(name, GROUPS[i][0]) == 0 ? GROUPS[i][1] : shown;
    }
    const size_t length = strlen(words);
    snprintf(words + length, size - length, "%s%s", shown[0] != '\0' ? " of " : "", shown);
}

// The variable whose column this is, or NULL.
static const Variable *variable_of(const Layout *layout, const Spec *spec, size_t column)
{
    if (spec == NULL || column >= layout->setting_count || column >= spec->variable_count) {
        return NULL;
    }
    Layout *own = malloc(sizeof *own);
    if (own == NULL) {
        return NULL;
    }
    metrics_layout(spec, spec->base, own);
    const bool is_it =
        strcmp(own->settings[column].name, store_column_at(layout, column)->name) == 0;
    free(own);
    return is_it ? &spec->variables[column] : NULL;
}

static StudyLabel label_variable(const Variable *variable)
{
    StudyLabel label = {.per_si = 1.0};
    spell_key(variable->key, label.words, sizeof label.words);
    label.is_linear = variable->kind == VARIABLE_LINEAR || variable->kind == VARIABLE_UNIFORM;
    label.is_log = variable->kind == VARIABLE_LOGARITHMIC || variable->kind == VARIABLE_LOG_UNIFORM;
    if (variable->given != NULL) {
        snprintf(label.unit, sizeof label.unit, "%s", variable->given->name);
        label.per_si = variable->given->denominator / variable->given->numerator;
    } else if (!variable->is_word) {
        snprintf(label.unit, sizeof label.unit, "%s", variable->column_unit);
    }
    return label;
}

// A body's or joint's own name, where the study has one that becomes these letters of a column.
static void name_owner(const Spec *spec, const char *column, size_t length, char *name, size_t size)
{
    snprintf(name, size, "%.*s", (int)length, column);
    const Linkage *linkage = spec != NULL ? &spec->base->linkage : NULL;
    const size_t bodies = linkage != NULL ? linkage->body_count : 0;
    const size_t all = bodies + (linkage != NULL ? linkage->joint_count : 0);
    for (size_t i = 0; i < all; i++) {
        const char *own = i < bodies ? linkage->bodies[i].name : linkage->joints[i - bodies].name;
        bool is_it = strlen(own) == length;
        for (size_t k = 0; is_it && k < length; k++) {
            is_it = column[k] == (isalnum((unsigned char)own[k]) ? own[k] : '_');
        }
        if (is_it) {
            snprintf(name, size, "%s", own);
            return;
        }
    }
}

StudyLabel study_label(const Layout *layout, const Spec *spec, size_t column)
{
    const char *name = store_column_at(layout, column)->name;
    const Variable *variable = variable_of(layout, spec, column);
    if (variable != NULL) {
        return label_variable(variable);
    }
    StudyLabel label = {.per_si = 1.0};
    const char *title;
    const char *key;
    size_t owner_length;
    size_t length;
    snprintf(label.unit, sizeof label.unit, "%s", unit_of(name, &length));
    if (column < layout->setting_count || !metrics_title(name, &title, &key, &owner_length)) {
        spell(name, length, label.words, sizeof label.words);
    } else if (owner_length == 0) {
        snprintf(label.words, sizeof label.words, "%s", title);
    } else {
        char owner[RECORD_NAME_SIZE];
        name_owner(spec, name, owner_length, owner, sizeof owner);
        snprintf(label.words, sizeof label.words, "%s of %s", title, owner);
    }
    return label;
}
