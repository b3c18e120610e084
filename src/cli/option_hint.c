// Finds the option that was meant by one that does not exist.
//
// A key of the case is often given as if it were an option: by its last part, or whole. An exact
// key goes before an option that is only like it, that before the same option of another command,
// and that before a key that is like it.
#include "cli/option_hint.h"

#include "casefile/schema.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 64, OPTIONS_MOST = 64, KEYS_MOST = 4 };

static const char *last_part(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot == NULL ? path : dot + 1;
}

static const char *nearest_option(const struct argp_option *options, const char *name)
{
    const char *names[OPTIONS_MOST];
    size_t count = 0;
    for (const struct argp_option *option = options; option->name != NULL; option++) {
        if (count < OPTIONS_MOST) {
            names[count++] = option->name;
        }
    }
    return text_nearest(name, names, count);
}

// The last part of a key that is nearest to the name.
static const char *nearest_part(const char *name)
{
    const char **parts = calloc(SCHEMA_ROW_COUNT, sizeof *parts);
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        parts[i] = last_part(SCHEMA_ROWS[i].path);
    }
    const char *nearest = text_nearest(name, parts, SCHEMA_ROW_COUNT);
    free(parts);
    return nearest;
}

static bool has_option(const struct argp_option *options, const char *name)
{
    for (const struct argp_option *option = options; option->name != NULL; option++) {
        if (strcmp(option->name, name) == 0) {
            return true;
        }
    }
    return false;
}

// What other programs call an option, and what it is called here.
typedef struct Habit {
    const char *theirs;
    const char *ours;
} Habit;

static const Habit HABITS[] = {
    {"format", "json"}, {"output", "out"}, {"all", "full"}, {"tolerance", "error"}};

// The option that stands for another program's, where the command has it; else NULL.
static const char *habitual_option(const struct argp_option *options, const char *name)
{
    for (size_t i = 0; i < sizeof HABITS / sizeof *HABITS; i++) {
        if (strcmp(HABITS[i].theirs, name) == 0 && has_option(options, HABITS[i].ours)) {
            return HABITS[i].ours;
        }
    }
    return NULL;
}

// Appends every key that is the name or ends in it; false where there is none.
static bool write_keys(const char *name, const char *value, Text *text)
{
    size_t count = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT && count < KEYS_MOST; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        if (strcmp(row->path, name) == 0 || strcmp(last_part(row->path), name) == 0) {
            char path[SCHEMA_PATH_SIZE];
            schema_path(row, "NAME", path);
            text_append(text, "%s'--set %s=%s'", count == 0 ? "" : " or ", path, value);
            count++;
        }
    }
    return count > 0;
}

// The command that has an option which others are often given; NULL where there is none.
static const char *find_owner(const char *name)
{
    static const Habit OWNERS[] = {
        {"error", "tune"},     {"max-cost", "tune"},   {"at-step", "tune"},  {"code", "tune"},
        {"sdf", "tune"},       {"mjcf", "tune"},       {"erp", "map"},       {"cfm", "map"},
        {"penalty", "map"},    {"schemes", "compare"}, {"series", "run"},    {"contacts", "run"},
        {"columns", "run"},    {"bless", "check"},     {"quick", "check"},   {"junit", "check"},
        {"markdown", "check"}, {"shard", "study"},     {"dry-run", "study"}, {"kind", "new"},
    };
    for (size_t i = 0; i < sizeof OWNERS / sizeof *OWNERS; i++) {
        if (strcmp(OWNERS[i].theirs, name) == 0) {
            return OWNERS[i].ours;
        }
    }
    return NULL;
}

void option_hint_write(const struct argp_option *options, const char *word, Text *text)
{
    char name[NAME_SIZE];
    const size_t dashes = strspn(word, "-");
    const size_t length = strcspn(word + dashes, "=");
    snprintf(name, sizeof name, "%.*s", (int)length, word + dashes);
    const char *given = word + dashes + length;
    const char *value = *given == '=' && given[1] != '\0' ? given + 1 : "VALUE";
    const char *habitual = dashes == 2 ? habitual_option(options, name) : NULL;
    if (habitual != NULL) {
        text_append(text, "'--%s'", habitual);
        return;
    }
    const bool takes_keys = dashes == 2 && has_option(options, "set");
    if (takes_keys && write_keys(name, value, text)) {
        return;
    }
    const char *option = nearest_option(options, name);
    if (option != NULL) {
        text_append(text, "'--%s'", option);
        return;
    }
    const char *owner = dashes == 2 ? find_owner(name) : NULL;
    if (owner != NULL) {
        text_append(text, "'jointplay %s --%s'", owner, name);
        return;
    }
    const char *part = takes_keys ? nearest_part(name) : NULL;
    if (part != NULL) {
        write_keys(part, value, text);
    }
}
