// What a case says, key by key, before any value is understood: each known key with its node and
// its source, the overrides of the command line already in their places.
#pragma once

#include "base/lookup.h"
#include "casefile/document.h"
#include "casefile/schema.h"

// The parts of a sinusoid, each of which has a path for overrides.
enum { ENTRY_PART_COUNT = 4, ENTRY_PARTS_GIVEN = 16 };
typedef enum EntryPart {
    ENTRY_MEAN,
    ENTRY_AMPLITUDE,
    ENTRY_FREQUENCY,
    ENTRY_PHASE,
    ENTRY_WHOLE, // all of the value
} EntryPart;

extern const char *const ENTRY_PARTS[ENTRY_PART_COUNT];

// One key that was given. Borrows node and source.
typedef struct Entry {
    const SchemaRow *row;
    size_t index; // of the member of the family
    const Node *node;
    const Source *source;
    const struct Entry *signal; // of a value that stands under a name: the signal's own entry
} Entry;

// A part of a sinusoid that overrides what the case says of it.
typedef struct EntryPartGiven {
    EntryPart part;
    Entry entry; // the row and member of the whole, with node and source of the part
} EntryPartGiven;

// The names of one family, in the order in which the case gives them.
typedef struct EntryNames {
    size_t count;
    size_t room;
    char (*names)[LINKAGE_NAME_SIZE]; // owned
    Lookup numbers;                   // by name
} EntryNames;

// Where the entries of one row stand: by member, their number and one more; 0 where there is none.
typedef struct EntrySlots {
    size_t room;
    size_t *slots; // owned
} EntrySlots;

// One group that was given, such as joints.crank-coupler.
typedef struct EntryGroup {
    char path[SCHEMA_PATH_SIZE]; // with `*`
    size_t index;
    const Node *node;
    const Source *source;
} EntryGroup;

// Zeroed it is empty; for entries_finish.
typedef struct Entries {
    SchemaForm form; // short or long, as the file says
    size_t count;
    size_t room;
    Entry *entries;    // owned, as the next two
    EntrySlots *slots; // by row of the schema; NULL while there is no entry
    Lookup rows;       // with an entry, now or once, by path
    size_t part_count;
    EntryPartGiven parts[ENTRY_PARTS_GIVEN];
    size_t group_count;
    size_t group_room;
    EntryGroup *groups;
    Lookup group_numbers;                  // by path and index
    EntryNames names[SCHEMA_FAMILY_COUNT]; // a four-bar's from the start
} Entries;

Entries entries_copy(const Entries *entries);
void entries_finish(Entries *entries);

// The entry of a row and member, or NULL where the key was not given.
const Entry *entries_at(const Entries *entries, const SchemaRow *row, size_t index);

// The entry of a row's path (with `*`), of so many bytes, or NULL where the key was not given.
const Entry *entries_find_part(const Entries *entries, const char *path, size_t length,
                               size_t index);

// Puts an entry in the place of that of the same row and member, or behind the others.
void entries_put(Entries *entries, const Entry *entry);

// Takes one away by its place in the list.
void entries_take_away(Entries *entries, size_t slot);

void entries_add_group(Entries *entries, const EntryGroup *group);

// Adds a name to those of a family; returns its number.
size_t entries_add_name(EntryNames *names, const char *name);

// Takes the keys of a case and with them its form. Fails on an unknown or doubled key, on rivals
// given together, and on a value where keys are expected or the other way round. The entries are
// then not to be used.
bool entries_read(Entries *entries, const Node *root, const Source *source, Err *err);

// Takes one override: its key, which stands so many characters into the source's text, and the
// node of its value. It replaces what was said before about the key, and what another source said
// about the key's rivals. Fails as entries_read does.
bool entries_override(Entries *entries, const char *key, size_t key_start, const Node *value,
                      const Source *source, Err *err);

// The row of a key that an override would have, and the member of its family; NULL for the key of a
// group. A name that is new takes its place, as an override's does. Fails on an unknown key.
bool entries_key(Entries *entries, const char *key, size_t key_start, const Source *source,
                 const SchemaRow **row, size_t *index, EntryPart *part, Err *err);

// Whether the value of a row may be a sinusoid, or the name of a signal.
bool entries_is_signal(const SchemaRow *row);

// The entry with the value that stands under its name, where it is the name of a signal; else the
// entry itself.
Entry entries_resolve(const Entries *entries, const Entry *entry);

// The entry of a row's path (with `*`), or NULL where the key was not given.
const Entry *entries_find(const Entries *entries, const char *path, size_t index);

// Whether a rival of a row's key is given.
bool entries_have_rival(const Entries *entries, const SchemaRow *row, size_t index);

// The entry to point at where several keys, their paths separated by blanks, do not fit together:
// of those given, the first that overrides the case, else the first. NULL where none is given.
const Entry *entries_blame(const Entries *entries, const char *paths, size_t index);

// Fails with a message that points at an entry's value, or at the key of a group: what is wrong
// and, behind "\nallowed: ", what would be right.
bool entries_refuse(const Entry *entry, Err *err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
bool entries_refuse_group(const EntryGroup *group, Err *err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// The first velocity or spin that the case gives of its bodies; NULL where it gives none.
const Entry *entries_speed(const Entries *entries, size_t body_count);

// The group of that path (with `*`), or NULL where nothing in it was given.
const EntryGroup *entries_group(const Entries *entries, const char *path, size_t index);

// The name of a member of a row's family, and how many the case has of it; empty and 1 for a
// single key.
const char *entries_name(const Entries *entries, const SchemaRow *row, size_t index);
size_t entries_family_size(const Entries *entries, const SchemaRow *row);

// The number of a name in a family, or -1; and a refusal of a name that is none of the family,
// with the nearest and all that are, the ground among them where it may stand.
int entries_number(const Entries *entries, SchemaFamily family, const char *name);
bool entries_refuse_name(const Entries *entries, const Source *source, SchemaFamily family,
                         bool may_be_ground, const char *name, Span span, Err *err);
