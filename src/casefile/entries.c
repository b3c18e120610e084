// Finds the keys that a case gives, and checks that each is known, single and without a rival.
#include "casefile/entries.h"

#include "casefile/keys.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
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
    EntryPart part;                 // of the value there
} Position;

const char *const ENTRY_PARTS[ENTRY_PART_COUNT] = {"mean", "amplitude", "frequency", "phase"};

bool entries_is_signal(const SchemaRow *row)
{
    return row->type == SCHEMA_TORQUE || row->type == SCHEMA_SPEED || row->type == SCHEMA_ANGLES ||
           row->type == SCHEMA_LOAD || row->type == SCHEMA_SIGNAL;
}

Entry entries_resolve(const Entries *entries, const Entry *entry)
{
    Entry resolved = *entry;
    const bool may_be = entries_is_signal(entry->row) && entry->row->type != SCHEMA_SIGNAL &&
                        entries->names[SCHEMA_SIGNAL_FAMILY].count > 0 &&
                        entry->node->kind == NODE_SCALAR;
    const int number =
        may_be ? entries_number(entries, SCHEMA_SIGNAL_FAMILY, entry->node->text) : -1;
    const Entry *signal = number >= 0 ? entries_find(entries, "signals.*", (size_t)number) : NULL;
    if (signal != NULL) {
        resolved.node = signal->node;
        resolved.source = signal->source;
        resolved.signal = signal;
    }
    return resolved;
}

const char *entries_name(const Entries *entries, const SchemaRow *row, size_t index)
{
    const EntryNames *names = &entries->names[row->family];
    return index < names->count ? names->names[index] : "";
}

size_t entries_family_size(const Entries *entries, const SchemaRow *row)
{
    return row->family == SCHEMA_SINGLE ? 1 : entries->names[row->family].count;
}

const Entry *entries_find(const Entries *entries, const char *path, size_t index)
{
    return entries_find_part(entries, path, strlen(path), index);
}

bool entries_have_rival(const Entries *entries, const SchemaRow *row, size_t index)
{
    for (size_t i = 0; row->rivalry != SCHEMA_NO_RIVAL && i < SCHEMA_ROW_COUNT; i++) {
        if (schema_are_rivals(row, &SCHEMA_ROWS[i]) &&
            entries_at(entries, &SCHEMA_ROWS[i], index) != NULL) {
            return true;
        }
    }
    return false;
}

const Entry *entries_blame(const Entries *entries, const char *paths, size_t index)
{
    const Entry *blamed = NULL;
    for (const char *path = paths; *path != '\0'; path += strspn(path, " ")) {
        const size_t length = strcspn(path, " ");
        const Entry *entry = entries_find_part(entries, path, length, index);
        const bool is_new = entry != NULL && entry->source->is_override;
        if (entry != NULL && (blamed == NULL || (is_new && !blamed->source->is_override))) {
            blamed = entry;
        }
        path += length;
    }
    return blamed;
}

bool entries_refuse(const Entry *entry, Err *err, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    source_refuse(entry->source, entry->node->span, err, format, arguments);
    va_end(arguments);
    return false;
}

bool entries_refuse_group(const EntryGroup *group, Err *err, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    source_refuse(group->source, keys_span(group->node), err, format, arguments);
    va_end(arguments);
    return false;
}

const Entry *entries_speed(const Entries *entries, size_t body_count)
{
    const Entry *found = NULL;
    for (size_t i = 0; found == NULL && i < body_count; i++) {
        found = entries_blame(entries,
                              "bodies.*.velocity bodies.*.velocity-z bodies.*.spin "
                              "bodies.*.spin-x bodies.*.spin-y",
                              i);
    }
    return found;
}

bool entries_refuse_name(const Entries *entries, const Source *source, SchemaFamily family,
                         bool may_be_ground, const char *name, Span span, Err *err)
{
    const EntryNames *names = &entries->names[family];
    // the driven joint of a short form cannot have play, and so cannot be named
    const size_t first = family == SCHEMA_JOINT && entries->form != SCHEMA_LONG ? 1 : 0;
    const char **choices = calloc(names->count + 1, sizeof *choices);
    assert(choices != NULL);
    size_t count = 0;
    if (may_be_ground) {
        choices[count++] = "ground";
    }
    for (size_t i = first; i < names->count; i++) {
        choices[count++] = names->names[i];
    }
    keys_refuse(source, span, SCHEMA_FAMILIES[family].what, name, choices, count, err);
    free(choices);
    return false;
}

// What a key is called elsewhere, the group that it was sought in (NULL: any), and what a case has
// for it.
typedef struct Habit {
    const char *group;
    const char *theirs;
    const char *ours;
} Habit;

static const char KIND_HINT[] =
    "the keys make the kind of a joint: none an ideal pivot, hole and pin one with play, along one "
    "that slides, gears a pair of gears, rack a rack and pinion";
static const char CLEARANCE_HINT[] =
    "the key is radial-clearance, half of the diametral clearance (hole - pin)";
static const char RACK_HINT[] =
    "the key is rack, with the rack's guide and the pinion's pivot: rack: [guide, pivot]";

static const Habit HABITS[] = {
    {NULL, "clearance", CLEARANCE_HINT},
    {NULL, "diametral-clearance", CLEARANCE_HINT},
    {NULL, "play", CLEARANCE_HINT},
    {"joints.*", "kind", KIND_HINT},
    {"joints.*", "type", KIND_HINT},
    {"joints.*", "pinion", RACK_HINT},
    {"joints.*", "rack-and-pinion", RACK_HINT},
    {"joints.*", "diameter", "the keys are hole and pin, both diameters"},
    {"joints.*", "hole-diameter", "the key is hole, a diameter"},
    {"joints.*", "pin-diameter", "the key is pin, a diameter"},
    {"bodies.*", "length", "a body's size follows from its joints; inertia is its own"},
    {"bodies.*", "position", "the key is at, of the centre of mass"},
    {"bodies.*", "centre", "the key is at, of the centre of mass"},
    {NULL, "mu", "the key is contact.friction"},
    {NULL, "cor", "the key is contact.restitution"},
    {NULL, "moment-of-inertia", "the key is inertia"},
    {NULL, "dt", "the key is run.step"},
    {NULL, "timestep", "the key is run.step"},
    {NULL, "time", "the key is run.revolutions, or run.duration without a drive of constant speed"},
    {"drives.*", "joint", "its name under drives is the joint's: drives: {JOINT: {angle: ...}}"},
    {"drive", "rpm", "the key is speed, such as speed: 300 rpm"},
    {"", "links", "the key is bodies"},
    {"", "motor", "the key is drive"},
    {"", "4-bar", "the key is four-bar"},
};

enum { ELSEWHERE_MOST = 3 }; // paths that a message names

static const char *find_habit(const char *group, const char *name)
{
    for (size_t i = 0; i < sizeof HABITS / sizeof *HABITS; i++) {
        const Habit *habit = &HABITS[i];
        const bool is_here = habit->group == NULL || strcmp(habit->group, group) == 0;
        if (is_here && strcmp(habit->theirs, name) == 0) {
            return habit->ours;
        }
    }
    return NULL;
}

// The end of the part of a path that is the name; NULL where none is.
static const char *find_part(const char *path, const char *name)
{
    const size_t length = strlen(name);
    for (const char *part = path; part != NULL; part = strchr(part, '.')) {
        part += *part == '.' ? 1 : 0;
        if (strncmp(part, name, length) == 0 && (part[length] == '.' || part[length] == '\0')) {
            return part + length;
        }
    }
    return NULL;
}

// Appends where in the case a body or joint of that name stands; else where keys of that name may,
// groups of keys among them.
static void append_elsewhere(const Entries *entries, const char *name, Text *text)
{
    for (SchemaFamily family = SCHEMA_BODY; family < SCHEMA_FAMILY_COUNT; family++) {
        if (entries->form == SCHEMA_LONG || family == SCHEMA_JOINT) {
            if (entries_number(entries, family, name) >= 0) {
                text_append(text, "the key is %s.%s", SCHEMA_FAMILIES[family].group, name);
                return;
            }
        }
    }

    char last[SCHEMA_PATH_SIZE] = "";
    size_t count = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT && count <= ELSEWHERE_MOST; i++) {
        char path[SCHEMA_PATH_SIZE];
        schema_path(&SCHEMA_ROWS[i], "NAME", path);
        const char *end = find_part(path, name);
        if (end == NULL || !schema_is_of_form(&SCHEMA_ROWS[i], entries->form)) {
            continue;
        }
        path[end - path] = '\0';
        if (strcmp(path, last) == 0) {
            continue;
        }
        text_copy(last, sizeof last, path);
        text_append(text, "%s%s", count == 0 ? "the key is " : " or ",
                    count == ELSEWHERE_MOST ? "another" : path);
        count++;
    }
}

// Refuses what is no key here: of the other form, or of none.
static bool refuse_key(const Walk *walk, const Position *below, const char *group, const char *name,
                       Span span)
{
    const SchemaForm form = walk->entries->form;
    bool is_of_another = false;
    for (size_t i = 0; i < SCHEMA_FORM_COUNT; i++) {
        if (group[0] == '\0' && strcmp(name, SCHEMA_FORMS[i].key) == 0) {
            return source_error(walk->source, span, "one of the two", walk->err,
                                "'%s' and '%s' exclude each other", name, schema_form(form)->key);
        }
        is_of_another = is_of_another || schema_knows(below->pattern, SCHEMA_FORMS[i].form);
    }
    char names[SCHEMA_CHILD_MAX][LINKAGE_NAME_SIZE];
    const char *choices[SCHEMA_CHILD_MAX];
    const size_t count = schema_children(group, form, names);
    for (size_t i = 0; i < count; i++) {
        choices[i] = names[i];
    }
    char what[LINKAGE_NAME_SIZE] = "key";
    if (strpbrk(name, ".*") == NULL && is_of_another) {
        snprintf(what, sizeof what, "key in a case with %s:", schema_form(form)->key);
    }
    Text elsewhere;
    text_init(&elsewhere);
    const char *habit = find_habit(group, name);
    if (habit == NULL && !is_of_another && strpbrk(name, ".*") == NULL) {
        append_elsewhere(walk->entries, name, &elsewhere);
    }
    const KeysHint hint = {habit != NULL ? habit : elsewhere.data, habit == NULL};
    keys_refuse_knowing(walk->source, span, what, name, choices, count, hint, walk->err);
    text_finish(&elsewhere);
    return false;
}

// The number of the member of that name; where the case names the family, a new name gets the next.
static bool find_member(const Walk *walk, SchemaFamily family, const char *name, Span span,
                        size_t *index)
{
    Entries *entries = walk->entries;
    const SchemaFamilyRow *row = &SCHEMA_FAMILIES[family];
    const int number = entries_number(entries, family, name);
    if (family == SCHEMA_JOINT && entries->form != SCHEMA_LONG) {
        if (number == 0) {
            return source_error(walk->source, span, schema_form(entries->form)->loose, walk->err,
                                "the drive joint ground-crank is ideal always");
        }
        if (number < 0) {
            return entries_refuse_name(entries, walk->source, family, false, name, span, walk->err);
        }
    }
    if (number >= 0) {
        *index = (size_t)number;
        return true;
    }
    static const char LETTERS[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
    const size_t length = strlen(name);
    const bool is_ground = family == SCHEMA_BODY && strcmp(name, "ground") == 0;
    if (length == 0 || length >= LINKAGE_NAME_SIZE || strspn(name, LETTERS) != length ||
        is_ground) {
        return source_error(walk->source, span,
                            is_ground ? "another name: every case has the ground"
                                      : "letters, digits, - and _, at most 47",
                            walk->err, "'%.50s' cannot name a %s", name, row->what);
    }
    EntryNames *names = &entries->names[family];
    if (names->count == row->most) {
        char allowed[LINKAGE_NAME_SIZE];
        snprintf(allowed, sizeof allowed, "at most %zu %s", row->most, row->group);
        return source_error(walk->source, span, allowed, walk->err, "one %s too many", row->what);
    }
    *index = entries_add_name(names, name);
    return true;
}

// Goes to a part of a value that may be a sinusoid.
static bool find_part_of(const Walk *walk, const Position *here, const char *name, Span span,
                         Position *below)
{
    *below = *here;
    for (int i = 0; i < ENTRY_PART_COUNT; i++) {
        if (here->part == ENTRY_WHOLE && strcmp(name, ENTRY_PARTS[i]) == 0) {
            below->part = (EntryPart)i;
            return true;
        }
    }
    if (here->part != ENTRY_WHOLE) {
        return source_error(walk->source, span, "the path of the part alone", walk->err,
                            "a part of a sinusoid has no parts of its own");
    }
    return keys_refuse(walk->source, span, "part of a sinusoid", name, ENTRY_PARTS,
                       ENTRY_PART_COUNT, walk->err);
}

// Goes one key down: fills `below` for the key `name` in the group at `here`.
static bool descend(const Walk *walk, const Position *here, const char *name, Span span,
                    Position *below)
{
    below->index = here->index;
    below->part = ENTRY_WHOLE;
    const SchemaRow *value = schema_find(here->pattern);
    if (value != NULL && entries_is_signal(value)) {
        return find_part_of(walk, here, name, span, below);
    }
    const char *segment = name;
    for (SchemaFamily family = SCHEMA_BODY; family < SCHEMA_FAMILY_COUNT; family++) {
        if (strcmp(here->pattern, SCHEMA_FAMILIES[family].group) == 0) {
            if (!find_member(walk, family, name, span, &below->index)) {
                return false;
            }
            segment = "*";
        }
    }
    const char *dot = here->pattern[0] != '\0' ? "." : "";
    const int length =
        snprintf(below->pattern, sizeof below->pattern, "%s%s%s", here->pattern, dot, segment);
    // a key may hold a dot or a star of its own; it is then no key
    const bool is_plain = segment != name || strpbrk(name, ".*") == NULL;
    const bool is_known = is_plain && length < SCHEMA_PATH_SIZE && name[0] != '\0' &&
                          schema_knows(below->pattern, walk->entries->form);
    return is_known || refuse_key(walk, below, here->pattern, name, span);
}

// Refuses a key whose rival stands in the file, or takes the rival away before an override.
static bool settle_rivals(const Walk *walk, const Entry *entry)
{
    Entries *entries = walk->entries;
    if (!entries_have_rival(entries, entry->row, entry->index)) {
        return true;
    }
    for (size_t i = 0; i < entries->count;) {
        const Entry *other = &entries->entries[i];
        const bool is_rival =
            other->index == entry->index && schema_are_rivals(entry->row, other->row);
        if (is_rival && other->source == walk->source && !walk->source->is_option) {
            const size_t line = source_line(other->source, keys_span(other->node).start);
            return source_error(walk->source, keys_span(entry->node), "one of the two", walk->err,
                                "'%s' and '%s' (line %zu) exclude each other",
                                strrchr(entry->row->path, '.') + 1,
                                strrchr(other->row->path, '.') + 1, line);
        }
        if (is_rival) {
            entries_take_away(entries, i);
        } else {
            i++;
        }
    }
    return true;
}

// What was said before about parts of a value that is given anew.
static void forget_parts(Entries *entries, const Entry *entry)
{
    size_t kept = 0;
    for (size_t i = 0; i < entries->part_count; i++) {
        const Entry *whole = &entries->parts[i].entry;
        if (whole->row != entry->row || whole->index != entry->index) {
            entries->parts[kept++] = entries->parts[i];
        }
    }
    entries->part_count = kept;
}

// A part replaces that of a sinusoid, which the case must give.
static bool add_part(const Walk *walk, const Position *here, const SchemaRow *row, const Node *node)
{
    Entries *entries = walk->entries;
    const Entry *whole = entries_at(entries, row, here->index);
    const Entry resolved = whole != NULL ? entries_resolve(entries, whole) : (Entry){0};
    const EntryPartGiven given = {here->part, {row, here->index, node, walk->source, NULL}};
    size_t place = 0;
    if (whole == NULL || resolved.node->kind != NODE_MAP) {
        return source_error(walk->source, keys_span(node),
                            "a value that the case gives as {amplitude: ..., frequency: ...}",
                            walk->err, "the case gives no sinusoid here that has %s %s",
                            here->part == ENTRY_AMPLITUDE ? "an" : "a", ENTRY_PARTS[here->part]);
    }
    while (place < entries->part_count &&
           (entries->parts[place].part != here->part || entries->parts[place].entry.row != row ||
            entries->parts[place].entry.index != here->index)) {
        place++;
    }
    if (place == ENTRY_PARTS_GIVEN) {
        return source_error(walk->source, keys_span(node), "the sinusoid as a whole", walk->err,
                            "more than %d parts of sinusoids are overridden", ENTRY_PARTS_GIVEN);
    }
    entries->parts[place] = given;
    entries->part_count += place == entries->part_count ? 1 : 0;
    return true;
}

static bool add_entry(const Walk *walk, const SchemaRow *row, size_t index, const Node *node)
{
    const Entry entry = {row, index, node, walk->source, NULL};
    forget_parts(walk->entries, &entry);
    if (!settle_rivals(walk, &entry)) {
        return false;
    }
    entries_put(walk->entries, &entry);
    return true;
}

static void add_group(const Walk *walk, const Position *position, const Node *node)
{
    if (entries_group(walk->entries, position->pattern, position->index) != NULL) {
        return;
    }
    EntryGroup group = {.index = position->index, .node = node, .source = walk->source};
    text_copy(group.path, sizeof group.path, position->pattern);
    entries_add_group(walk->entries, &group);
}

static bool is_alike(size_t number, const void *sought)
{
    (void)number;
    (void)sought;
    return true;
}

// Refuses a key that stands in its map already: only one whose hash does is compared with all.
static bool check_single(const Walk *walk, const Node *map, const Node *node, Lookup *seen)
{
    const uint64_t hash = lookup_hash(node->key->text);
    if (lookup_find(seen, hash, is_alike, NULL) != LOOKUP_NONE) {
        return keys_check_single(walk->source, map, node, walk->err);
    }
    lookup_add(seen, hash, 0);
    return true;
}

// Takes what stands at a position: a value, or the keys below a group.
static bool walk_node(const Walk *walk, const Position *here, const Node *node)
{
    const SchemaRow *row = schema_find(here->pattern);
    if (row != NULL && here->part != ENTRY_WHOLE) {
        return add_part(walk, here, row, node);
    }
    if (row != NULL) {
        return add_entry(walk, row, here->index, node);
    }
    if (!keys_check_map(walk->source, node, walk->err)) {
        return false;
    }
    add_group(walk, here, node);
    Lookup seen = {.count = 0};
    bool is_good = true;
    for (const Node *child = node->first; is_good && child != NULL; child = child->next) {
        Position below;
        is_good = descend(walk, here, child->key->text, child->key->span, &below) &&
                  check_single(walk, node, child, &seen) && walk_node(walk, &below, child);
    }
    lookup_finish(&seen);
    return is_good;
}

// The form whose key stands first in the document: without any it is that of a four-bar.
static SchemaForm find_form(const Node *root)
{
    for (const Node *child = root->kind == NODE_MAP ? root->first : NULL; child != NULL;
         child = child->next) {
        for (size_t i = 0; i < SCHEMA_FORM_COUNT; i++) {
            if (strcmp(child->key->text, SCHEMA_FORMS[i].key) == 0) {
                return SCHEMA_FORMS[i].form;
            }
        }
    }
    return SCHEMA_FOUR_BAR;
}

static void add_names(EntryNames *names, const char *const *words)
{
    for (; *words != NULL; words++) {
        entries_add_name(names, *words);
    }
}

bool entries_read(Entries *entries, const Node *root, const Source *source, Err *err)
{
    entries->form = find_form(root);
    if (entries->form != SCHEMA_LONG) {
        const SchemaFormRow *row = schema_form(entries->form);
        add_names(&entries->names[SCHEMA_BODY], row->links);
        add_names(&entries->names[SCHEMA_JOINT], row->pivots);
    }
    const Walk walk = {entries, source, err};
    const Position top = {.pattern = "", .part = ENTRY_WHOLE};
    return walk_node(&walk, &top, root);
}

// Follows the whole path of a key. Its groups are known by the value, unless that is NULL.
static bool follow(const Walk *walk, const char *key, size_t key_start, const Node *value,
                   Position *here)
{
    // a name of the key that is wrong is shown in the key
    Source in_key = *walk->source;
    in_key.shift = key_start;
    const Walk key_walk = {walk->entries, &in_key, walk->err};
    *here = (Position){.pattern = "", .part = ENTRY_WHOLE};
    const char *rest = key;
    for (;;) {
        char name[SCHEMA_PATH_SIZE];
        const size_t length = strcspn(rest, ".");
        snprintf(name, sizeof name, "%.*s", (int)length, rest);
        const size_t start = source_count(key, (size_t)(rest - key));
        const Span span = {start, start + source_count(rest, length)};
        Position below;
        if (!descend(&key_walk, here, name, span, &below)) {
            return false;
        }
        *here = below;
        if (rest[length] == '\0') {
            return true;
        }
        if (value != NULL && schema_find(here->pattern) == NULL) {
            add_group(walk, here, value);
        }
        rest += length + 1;
    }
}

bool entries_override(Entries *entries, const char *key, size_t key_start, const Node *value,
                      const Source *source, Err *err)
{
    const Walk walk = {entries, source, err};
    Position here;
    return follow(&walk, key, key_start, value, &here) && walk_node(&walk, &here, value);
}

bool entries_key(Entries *entries, const char *key, size_t key_start, const Source *source,
                 const SchemaRow **row, size_t *index, EntryPart *part, Err *err)
{
    const Walk walk = {entries, source, err};
    Position here;
    if (!follow(&walk, key, key_start, NULL, &here)) {
        return false;
    }
    *row = schema_find(here.pattern);
    *index = here.index;
    *part = here.part;
    return true;
}
