// Keeps which files a command uses, and for what.
//
// Two paths lead to one file where they are one path without links and dots, or where both are
// there and have one number on their disk. The number of a file that is gone is given to the next
// one: it counts only as long as the path that was noted still leads to it.
#include "base/claims.h"

#include "base/call.h"

#include <assert.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { USER_SIZE = 32 };

typedef struct Place {
    const char *path;
    char resolved[PATH_MAX];
    bool is_there;
    struct stat status; // where it is there
} Place;

typedef struct Entry {
    bool is_read;
    char user[USER_SIZE];
    char *path;     // owned
    char *resolved; // owned
    bool was_there;
    dev_t device; // where it was there
    ino_t number; //
} Entry;

static Entry *entries;
static size_t entry_count;
static size_t entry_room;

// A path without links and dots: its own where it is there, else that of the folder it is for.
static void resolve(const char *path, char target[PATH_MAX])
{
    char folder[PATH_MAX];
    const char *slash = strrchr(path, '/');
    const char *name = slash == NULL ? path : slash + 1;
    snprintf(folder, sizeof folder, "%.*s.", (int)(name - path), path);
    char *whole = realpath(path, NULL);
    char *above = realpath(folder, NULL);
    if (whole == NULL && above != NULL) {
        snprintf(target, PATH_MAX, "%s/%s", above, name);
    } else {
        snprintf(target, PATH_MAX, "%s", whole != NULL ? whole : path);
    }
    free(whole);
    free(above);
}

// Standard output is one place, whatever it leads to.
static bool is_standard(const char *path)
{
    return strcmp(path, "-") == 0;
}

static void find_place(const char *path, Place *place)
{
    place->path = path;
    place->is_there = !is_standard(path) && stat(path, &place->status) == 0;
    if (is_standard(path)) {
        snprintf(place->resolved, sizeof place->resolved, "-");
    } else {
        resolve(path, place->resolved);
    }
}

// A pipe, a terminal or a device: as many as like may use it.
static bool is_shared(const Place *place)
{
    return place->is_there && !S_ISREG(place->status.st_mode);
}

static bool is_same(const Place *place, const Entry *entry)
{
    if (strcmp(place->resolved, entry->resolved) == 0) {
        return true;
    }
    struct stat now;
    return place->is_there && entry->was_there && place->status.st_ino == entry->number &&
           place->status.st_dev == entry->device && stat(entry->path, &now) == 0 &&
           now.st_ino == entry->number && now.st_dev == entry->device;
}

static char *copy_of(const char *path)
{
    char *copy = strdup(path);
    assert(copy != NULL);
    return copy;
}

static void note(const char *user, bool is_read, const char *path)
{
    if (call_current() != NULL) {
        return; // a library writes no files
    }
    for (size_t i = 0; i < entry_count; i++) {
        // a case is read once for every step that is asked for
        if (entries[i].is_read == is_read && strcmp(entries[i].path, path) == 0) {
            return;
        }
    }
    Place place;
    find_place(path, &place);
    if (is_shared(&place)) {
        return;
    }
    if (entry_count == entry_room) {
        entry_room = 2 * entry_room + 8;
        entries = realloc(entries, entry_room * sizeof *entries);
        assert(entries != NULL);
    }
    Entry *entry = &entries[entry_count++];
    *entry = (Entry){.is_read = is_read,
                     .path = copy_of(path),
                     .resolved = copy_of(place.resolved),
                     .was_there = place.is_there};
    if (place.is_there) {
        entry->device = place.status.st_dev;
        entry->number = place.status.st_ino;
    }
    snprintf(entry->user, sizeof entry->user, "%s", user);
}

void claims_note_read(const char *user, const char *path)
{
    note(user, true, path);
}

void claims_note_written(const char *user, const char *path)
{
    note(user, false, path);
}

bool claims_find(const char *path, Claim *claim)
{
    Place place;
    find_place(path, &place);
    bool is_found = false;
    for (size_t i = 0; !is_shared(&place) && i < entry_count; i++) {
        const Entry *entry = &entries[i];
        if ((!is_found || (entry->is_read && !claim->is_read)) && is_same(&place, entry)) {
            *claim = (Claim){entry->user, entry->is_read};
            is_found = true;
        }
    }
    return is_found;
}
