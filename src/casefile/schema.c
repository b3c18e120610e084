// Which row does a key belong to, and where in the scenario does its value go?
#include "casefile/schema.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

bool schema_is_setting(const SchemaRow *row)
{
    return row->type != SCHEMA_EXPECT;
}

const SchemaRow *schema_find(const char *path)
{
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        if (strcmp(SCHEMA_ROWS[i].path, path) == 0) {
            return &SCHEMA_ROWS[i];
        }
    }
    return NULL;
}

// What stands behind "group." in the path, or NULL where the path is not below the group.
static const char *below(const char *path, const char *group)
{
    const size_t length = strlen(group);
    if (length == 0) {
        return path;
    }
    return strncmp(path, group, length) == 0 && path[length] == '.' ? path + length + 1 : NULL;
}

static bool is_of_form(const SchemaRow *row, SchemaForm form)
{
    return row->form == SCHEMA_BOTH || row->form == form;
}

const char *schema_unit(const SchemaRow *row)
{
    return row->plain_unit != NULL ? row->plain_unit : units_si(row->dimension);
}

void schema_list_words(const SchemaRow *row, Text *text)
{
    for (size_t i = 0; row->words[i] != NULL; i++) {
        text_append(text, "%s%s", i > 0 ? ", " : "", row->words[i]);
    }
}

bool schema_are_rivals(const SchemaRow *row, const SchemaRow *other)
{
    return row->rivalry != SCHEMA_NO_RIVAL && other->rivalry == row->rivalry &&
           other->side != row->side;
}

bool schema_knows(const char *path, SchemaForm form)
{
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        if (is_of_form(row, form) &&
            (strcmp(row->path, path) == 0 || below(row->path, path) != NULL)) {
            return true;
        }
    }
    return false;
}

static size_t add_child(char names[SCHEMA_CHILD_MAX][LINKAGE_NAME_SIZE], size_t count,
                        const char *name, int length)
{
    char child[LINKAGE_NAME_SIZE];
    snprintf(child, sizeof child, "%.*s", length, name);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(names[i], child) == 0) {
            return count;
        }
    }
    assert(count < SCHEMA_CHILD_MAX);
    text_copy(names[count], LINKAGE_NAME_SIZE, child);
    return count + 1;
}

size_t schema_children(const char *group, SchemaForm form,
                       char names[SCHEMA_CHILD_MAX][LINKAGE_NAME_SIZE])
{
    size_t count = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const char *rest = below(SCHEMA_ROWS[i].path, group);
        if (rest != NULL && rest[0] != '*' && is_of_form(&SCHEMA_ROWS[i], form)) {
            count = add_child(names, count, rest, (int)strcspn(rest, "."));
        }
    }
    return count;
}

void schema_path(const SchemaRow *row, const char *name, char path[SCHEMA_PATH_SIZE])
{
    const char *star = strchr(row->path, '*');
    if (star == NULL) {
        text_copy(path, SCHEMA_PATH_SIZE, row->path);
        return;
    }
    snprintf(path, SCHEMA_PATH_SIZE, "%.*s%s%s", (int)(star - row->path), row->path, name,
             star + 1);
}

static size_t field_offset(const SchemaRow *row, size_t index)
{
    assert(index < SCHEMA_FAMILIES[row->family].most);
    return row->offset + index * SCHEMA_FAMILIES[row->family].stride;
}

void *schema_field(const SchemaRow *row, Scenario *scenario, size_t index)
{
    return (char *)scenario + field_offset(row, index);
}

const void *schema_field_const(const SchemaRow *row, const Scenario *scenario, size_t index)
{
    return (const char *)scenario + field_offset(row, index);
}
