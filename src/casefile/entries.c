// Which keys does the case give, and is each one known, single and without a rival?
#include "casefile/entries.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

// Where the walk stands in the tree of keys.
typedef struct Walk {
    Entries *entries;
    const Source *source;
    Err *err;
} Walk;

typedef struct Position {
    char pattern[SCHEMA_PATH_SIZE]; // with `*` for names
    size_t index;                   // of the joint or point, once known
} Position;

const char *entries_name(const Entries *entries, const SchemaRow *row, size_t index)
{
    switch (row->family) {
    case SCHEMA_JOINT:
        return SCHEMA_JOINT_NAMES[index];
    case SCHEMA_POINT:
        return entries->point_names[index];
    default:
        return "";
    }
}

static Entry *find_entry(Entries *entries, const SchemaRow *row, size_t index)
{
    for (size_t i = 0; i < entries->count; i++) {
        if (entries->entries[i].row == row && entries->entries[i].index == index) {
            return &entries->entries[i];
        }
    }
    return NULL;
}

const Entry *entries_find(const Entries *entries, const char *path, size_t index)
{
    for (size_t i = 0; i < entries->count; i++) {
        const Entry *entry = &entries->entries[i];
        if (entry->index == index && strcmp(entry->row->path, path) == 0) {
            return entry;
        }
    }
    return NULL;
}

const Entry *entries_blame(const Entries *entries, const char *const *paths, size_t count,
                           size_t index)
{
    const Entry *blamed = NULL;
    for (size_t i = 0; i < count; i++) {
        const Entry *entry = entries_find(entries, paths[i], index);
        const bool is_new = entry != NULL && entry->source->is_option;
        if (entry != NULL && (blamed == NULL || (is_new && !blamed->source->is_option))) {
            blamed = entry;
        }
    }
    return blamed;
}

const EntryGroup *entries_group(const Entries *entries, const char *path, size_t index)
{
    for (size_t i = 0; i < entries->group_count; i++) {
        const EntryGroup *group = &entries->groups[i];
        if (group->index == index && strcmp(group->path, path) == 0) {
            return group;
        }
    }
    return NULL;
}

// The span of a node's key, or of the node where it has none.
static Span key_span(const Node *node)
{
    return node->key != NULL ? node->key->span : node->span;
}

static bool refuse_unknown(const Walk *walk, const char *group, const char *name, Span span)
{
    if (strcmp(group, "joints") == 0 && strcmp(name, "ground-crank") == 0) {
        return source_error(walk->source, span, "crank-coupler, coupler-follower, follower-ground",
                            walk->err, "the drive joint ground-crank is ideal always");
    }
    char names[SCHEMA_CHILD_MAX][LINKAGE_NAME_SIZE];
    const char *choices[SCHEMA_CHILD_MAX];
    const size_t count = schema_children(group, names);
    Text allowed;
    text_init(&allowed);
    for (size_t i = 0; i < count; i++) {
        choices[i] = names[i];
        text_append(&allowed, "%s%s", i > 0 ? ", " : "", names[i]);
    }
    const char *nearest = text_nearest(name, choices, count);
    const char *what = strcmp(group, "joints") == 0 ? "joint" : "key";
    char hint[LINKAGE_NAME_SIZE + 24] = "";
    if (nearest != NULL) {
        snprintf(hint, sizeof hint, "; did you mean '%s'?", nearest);
    } else if (name[0] >= '0' && name[0] <= '9') {
        // 14,5 mm inside braces is a value 14 and a key 5 mm
        text_copy(hint, sizeof hint, "; numbers have a decimal point");
    }
    source_error(walk->source, span, allowed.data, walk->err, "unknown %s '%.40s'%s", what, name,
                 hint);
    text_finish(&allowed);
    return false;
}

// The number of the point of that name; a new name gets the next number.
static bool find_point(const Walk *walk, const char *name, Span span, size_t *index)
{
    Entries *entries = walk->entries;
    for (size_t i = 0; i < entries->point_count; i++) {
        if (strcmp(entries->point_names[i], name) == 0) {
            *index = i;
            return true;
        }
    }
    static const char LETTERS[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
    const size_t length = strlen(name);
    if (length == 0 || length >= LINKAGE_NAME_SIZE || strspn(name, LETTERS) != length) {
        return source_error(walk->source, span, "letters, digits, - and _, at most 47", walk->err,
                            "'%.50s' cannot name a point", name);
    }
    if (entries->point_count == SCENARIO_POINT_MAX) {
        return source_error(walk->source, span, "at most 4 points", walk->err,
                            "one traced point too many");
    }
    *index = entries->point_count++;
    text_copy(entries->point_names[*index], LINKAGE_NAME_SIZE, name);
    return true;
}

// Goes one key down: fills `below` for the key `name` in the group at `here`.
static bool descend(const Walk *walk, const Position *here, const char *name, Span span,
                    Position *below)
{
    below->index = here->index;
    const char *segment = name;
    if (strcmp(here->pattern, "points") == 0) {
        if (!find_point(walk, name, span, &below->index)) {
            return false;
        }
        segment = "*";
    }
    for (size_t i = 0; i < SCHEMA_JOINT_COUNT && strcmp(here->pattern, "joints") == 0; i++) {
        if (strcmp(SCHEMA_JOINT_NAMES[i], name) == 0) {
            below->index = i;
            segment = "*";
        }
    }
    const char *dot = here->pattern[0] != '\0' ? "." : "";
    const int length =
        snprintf(below->pattern, sizeof below->pattern, "%s%s%s", here->pattern, dot, segment);
    // a key may hold a dot or a star of its own; it is then no key
    const bool is_plain = strcmp(segment, "*") == 0 ? segment != name : strpbrk(name, ".*") == NULL;
    const bool is_known = is_plain && length < SCHEMA_PATH_SIZE && name[0] != '\0' &&
                          (schema_find(below->pattern) != NULL || schema_is_group(below->pattern));
    return is_known || refuse_unknown(walk, here->pattern, name, span);
}

// Refuses a key whose rival stands in the file, or takes the rival away before an override.
static bool settle_rivals(const Walk *walk, const Entry *entry)
{
    Entries *entries = walk->entries;
    size_t kept = 0;
    for (size_t i = 0; i < entries->count; i++) {
        const Entry *other = &entries->entries[i];
        const bool is_rival = entry->row->rivalry != SCHEMA_NO_RIVAL &&
                              other->row->rivalry == entry->row->rivalry &&
                              other->row->side != entry->row->side && other->index == entry->index;
        if (is_rival && !walk->source->is_option) {
            const size_t line = source_line(other->source, key_span(other->node).start);
            return source_error(walk->source, key_span(entry->node), "one of the two", walk->err,
                                "'%s' and '%s' (line %zu) exclude each other",
                                strrchr(entry->row->path, '.') + 1,
                                strrchr(other->row->path, '.') + 1, line);
        }
        if (!is_rival) {
            entries->entries[kept++] = *other;
        }
    }
    entries->count = kept;
    return true;
}

static bool add_entry(const Walk *walk, const SchemaRow *row, size_t index, const Node *node)
{
    const Entry entry = {row, index, node, walk->source};
    if (!settle_rivals(walk, &entry)) {
        return false;
    }
    Entry *found = find_entry(walk->entries, row, index);
    if (found == NULL) {
        assert(walk->entries->count < ENTRIES_MAX);
        found = &walk->entries->entries[walk->entries->count++];
    }
    *found = entry;
    return true;
}

static void add_group(const Walk *walk, const Position *position, const Node *node)
{
    if (entries_group(walk->entries, position->pattern, position->index) != NULL) {
        return;
    }
    assert(walk->entries->group_count < ENTRIES_GROUP_MAX);
    EntryGroup *group = &walk->entries->groups[walk->entries->group_count++];
    text_copy(group->path, sizeof group->path, position->pattern);
    group->index = position->index;
    group->node = node;
    group->source = walk->source;
}

static bool check_doubled(const Walk *walk, const Node *map, const Node *node)
{
    for (const Node *other = map->first; other != node; other = other->next) {
        if (strcmp(other->key->text, node->key->text) == 0) {
            const size_t first = source_line(walk->source, other->key->span.start);
            const size_t second = source_line(walk->source, node->key->span.start);
            char lines[64];
            snprintf(lines, sizeof lines, first == second ? "line %zu" : "lines %zu and %zu", first,
                     second);
            return source_error(walk->source, node->key->span, "one of them", walk->err,
                                "the key '%s' is given twice, in %s", node->key->text, lines);
        }
    }
    return true;
}

// Takes what stands at a position: a value, or the keys below a group.
static bool walk_node(const Walk *walk, const Position *here, const Node *node)
{
    const SchemaRow *row = schema_find(here->pattern);
    if (row != NULL) {
        return add_entry(walk, row, here->index, node);
    }
    if (node->kind != NODE_MAP) {
        const bool is_missing = node->kind == NODE_SCALAR && node->text[0] == '\0';
        return source_error(walk->source, is_missing ? key_span(node) : node->span,
                            "key: value, on lines of their own or as {key: value}", walk->err,
                            "expected a mapping of keys here, found %s",
                            is_missing                ? "nothing"
                            : node->kind == NODE_LIST ? "a list"
                                                      : "a single value");
    }
    add_group(walk, here, node);
    for (const Node *child = node->first; child != NULL; child = child->next) {
        Position below;
        if (!descend(walk, here, child->key->text, child->key->span, &below) ||
            !check_doubled(walk, node, child) || !walk_node(walk, &below, child)) {
            return false;
        }
    }
    return true;
}

bool entries_read(Entries *entries, const Node *root, const Source *source, Err *err)
{
    const Walk walk = {entries, source, err};
    const Position top = {.pattern = ""};
    return walk_node(&walk, &top, root);
}

bool entries_override(Entries *entries, const char *key, const Node *value, const Source *source,
                      Err *err)
{
    const Walk walk = {entries, source, err};
    Position here = {.pattern = ""};
    const char *rest = key;
    for (;;) {
        char name[SCHEMA_PATH_SIZE];
        const size_t length = strcspn(rest, ".");
        snprintf(name, sizeof name, "%.*s", (int)length, rest);
        Position below;
        if (!descend(&walk, &here, name, value->span, &below)) {
            return false;
        }
        here = below;
        if (rest[length] == '\0') {
            break;
        }
        // a group that only an override names is known by the override's value
        add_group(&walk, &here, value);
        rest += length + 1;
    }
    return walk_node(&walk, &here, value);
}
