// What a case says, key by key, before any value is understood: each known key with its node and
// its source, the overrides of the command line already in their places.
#pragma once

#include "casefile/document.h"
#include "casefile/schema.h"

enum { ENTRIES_MAX = 128, ENTRIES_GROUP_MAX = 48 };

// One key that was given. Borrows node and source.
typedef struct Entry {
    const SchemaRow *row;
    size_t index; // of the joint or point
    const Node *node;
    const Source *source;
} Entry;

// One group that was given, such as joints.crank-coupler.
typedef struct EntryGroup {
    char path[SCHEMA_PATH_SIZE]; // with `*`
    size_t index;
    const Node *node;
    const Source *source;
} EntryGroup;

typedef struct Entries {
    size_t count;
    Entry entries[ENTRIES_MAX];
    size_t group_count;
    EntryGroup groups[ENTRIES_GROUP_MAX];
    size_t point_count;
    char point_names[SCENARIO_POINT_MAX][LINKAGE_NAME_SIZE];
} Entries;

// Takes the keys of a case. Fails on an unknown or doubled key, on rivals given together, and on
// a value where keys are expected or the other way round. The entries are then not to be used.
bool entries_read(Entries *entries, const Node *root, const Source *source, Err *err);

// Takes one override: its key and the node of its value. It replaces what was said before about
// the key and about the key's rivals.
bool entries_override(Entries *entries, const char *key, const Node *value, const Source *source,
                      Err *err);

// The entry of a row's path (with `*`), or NULL where the key was not given.
const Entry *entries_find(const Entries *entries, const char *path, size_t index);

// The entry to point at where several keys do not fit together: of those given, the first that
// comes from the command line, else the first. NULL where none is given.
const Entry *entries_blame(const Entries *entries, const char *const *paths, size_t count,
                           size_t index);

// The group of that path (with `*`), or NULL where nothing in it was given.
const EntryGroup *entries_group(const Entries *entries, const char *path, size_t index);

// The name of the entry's joint or point; empty for a single key.
const char *entries_name(const Entries *entries, const SchemaRow *row, size_t index);
