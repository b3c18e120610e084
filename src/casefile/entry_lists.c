// Keeps the entries of a case so that each is found by its key.
//
// Entries stand in one list, in the order in which the case gives them. For each row of the schema
// a list by member says at which place the member's entry is.
#include "base/hash.h"
#include "base/room.h"
#include "casefile/entries.h"

static size_t row_number(const SchemaRow *row)
{
    return (size_t)(row - SCHEMA_ROWS);
}

const Entry *entries_at(const Entries *entries, const SchemaRow *row, size_t index)
{
    if (entries->slots == NULL) {
        return NULL;
    }
    const EntrySlots *slots = &entries->slots[row_number(row)];
    const size_t slot = index < slots->room ? slots->slots[index] : 0;
    return slot == 0 ? NULL : &entries->entries[slot - 1];
}

static void note_slot(Entries *entries, size_t slot)
{
    if (entries->slots == NULL) {
        entries->slots = calloc(SCHEMA_ROW_COUNT, sizeof *entries->slots);
        assert(entries->slots != NULL);
    }
    const Entry *entry = &entries->entries[slot];
    EntrySlots *slots = &entries->slots[row_number(entry->row)];
    if (slots->room == 0) {
        lookup_add(&entries->rows, lookup_hash(entry->row->path), row_number(entry->row));
    }
    slots->slots = room_grow(slots->slots, &slots->room, entry->index + 1, sizeof *slots->slots);
    slots->slots[entry->index] = slot + 1;
}

void entries_put(Entries *entries, const Entry *entry)
{
    const Entry *found = entries_at(entries, entry->row, entry->index);
    const size_t slot = found != NULL ? (size_t)(found - entries->entries) : entries->count++;
    entries->entries =
        room_grow(entries->entries, &entries->room, entries->count, sizeof *entries->entries);
    entries->entries[slot] = *entry;
    note_slot(entries, slot);
}

void entries_take_away(Entries *entries, size_t slot)
{
    const Entry *gone = &entries->entries[slot];
    entries->slots[row_number(gone->row)].slots[gone->index] = 0;
    for (size_t i = slot + 1; i < entries->count; i++) {
        entries->entries[i - 1] = entries->entries[i];
        note_slot(entries, i - 1);
    }
    entries->count--;
}

// A path of so many bytes, which another may follow.
typedef struct SoughtPath {
    const char *path;
    size_t length;
} SoughtPath;

static bool is_row(size_t number, const void *of)
{
    const SoughtPath *sought = of;
    const char *own = SCHEMA_ROWS[number].path;
    return strncmp(own, sought->path, sought->length) == 0 && own[sought->length] == '\0';
}

const Entry *entries_find_part(const Entries *entries, const char *path, size_t length,
                               size_t index)
{
    const SoughtPath sought = {path, length};
    const int row =
        lookup_find(&entries->rows, hash_bytes(HASH_START, path, length), is_row, &sought);
    return row == LOOKUP_NONE ? NULL : entries_at(entries, &SCHEMA_ROWS[row], index);
}

// What is looked for among groups or names.
typedef struct Sought {
    const Entries *entries;
    const EntryNames *names;
    const char *text;
    size_t index;
} Sought;

static uint64_t group_hash(const char *path, size_t index)
{
    return hash_word(lookup_hash(path), index);
}

static bool is_group(size_t number, const void *of)
{
    const Sought *sought = of;
    const EntryGroup *group = &sought->entries->groups[number];
    return group->index == sought->index && strcmp(group->path, sought->text) == 0;
}

static bool is_name(size_t number, const void *of)
{
    const Sought *sought = of;
    return strcmp(sought->names->names[number], sought->text) == 0;
}

void entries_add_group(Entries *entries, const EntryGroup *group)
{
    entries->groups = room_grow(entries->groups, &entries->group_room, entries->group_count + 1,
                                sizeof *entries->groups);
    lookup_add(&entries->group_numbers, group_hash(group->path, group->index),
               entries->group_count);
    entries->groups[entries->group_count++] = *group;
}

const EntryGroup *entries_group(const Entries *entries, const char *path, size_t index)
{
    const Sought sought = {.entries = entries, .text = path, .index = index};
    const int found =
        lookup_find(&entries->group_numbers, group_hash(path, index), is_group, &sought);
    return found == LOOKUP_NONE ? NULL : &entries->groups[found];
}

size_t entries_add_name(EntryNames *names, const char *name)
{
    names->names = room_grow(names->names, &names->room, names->count + 1, sizeof *names->names);
    text_copy(names->names[names->count], LINKAGE_NAME_SIZE, name);
    lookup_add(&names->numbers, lookup_hash(names->names[names->count]), names->count);
    return names->count++;
}

int entries_number(const Entries *entries, SchemaFamily family, const char *name)
{
    const Sought sought = {.names = &entries->names[family], .text = name};
    return lookup_find(&entries->names[family].numbers, lookup_hash(name), is_name, &sought);
}

Entries entries_copy(const Entries *entries)
{
    Entries copy = *entries;
    copy.room = copy.count;
    copy.entries = room_copy(entries->entries, copy.count, sizeof *copy.entries);
    copy.group_room = copy.group_count;
    copy.groups = room_copy(entries->groups, copy.group_count, sizeof *copy.groups);
    copy.group_numbers = lookup_copy(&entries->group_numbers);
    for (size_t i = 0; i < SCHEMA_FAMILY_COUNT; i++) {
        EntryNames *names = &copy.names[i];
        names->room = names->count;
        names->names = room_copy(names->names, names->count, sizeof *names->names);
        names->numbers = lookup_copy(&names->numbers);
    }
    copy.slots = NULL;
    copy.rows = (Lookup){.count = 0};
    for (size_t i = 0; i < copy.count; i++) {
        note_slot(&copy, i);
    }
    return copy;
}

void entries_finish(Entries *entries)
{
    for (size_t i = 0; entries->slots != NULL && i < SCHEMA_ROW_COUNT; i++) {
        free(entries->slots[i].slots);
    }
    for (size_t i = 0; i < SCHEMA_FAMILY_COUNT; i++) {
        free(entries->names[i].names);
        lookup_finish(&entries->names[i].numbers);
    }
    free(entries->slots);
    free(entries->entries);
    free(entries->groups);
    lookup_finish(&entries->group_numbers);
    lookup_finish(&entries->rows);
    *entries = (Entries){.count = 0};
}
