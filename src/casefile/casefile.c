// Makes a scenario of a case file.
//
// text -> tree of nodes -> known keys (overrides in their places) -> scenario.
#include "casefile/casefile.h"

#include "base/zeroed.h"
#include "casefile/assemble.h"
#include "casefile/input.h"
#include "casefile/quantity.h"
#include "casefile/units.h"
#include "casefile/waves.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// One KEY=VALUE: its text as messages show it, behind the option that it came with, and what it
// says. Messages begin with that text, or with the key where no option is in front.
typedef struct Override {
    Text shown;
    char key[SCHEMA_PATH_SIZE];
    Source source;
    Node *value;
} Override;

static const char OPTION[] = "--set ";
static const char NO_OPTION[] = "";

// What is wrong with one that cannot be read at all: of the command line by its option, of a
// program by its key.
static bool refuse_argument(const char *option, const char *argument, Err *err)
{
    const bool is_one_line = source_is_one_line(argument, strlen(argument));
    if (option[0] == '\0') {
        const int length = (int)strcspn(argument, "=");
        return is_one_line
                   ? err_set(err, ERR_USAGE, "%.60s is no key", argument)
                   : err_set(err, ERR_USAGE, "%.*s: the value is not text on one line",
                             length < SCHEMA_PATH_SIZE ? length : SCHEMA_PATH_SIZE, argument);
    }
    return is_one_line
               ? err_set(err, ERR_USAGE,
                         "--set %.200s: a key and a value are needed\nallowed: --set KEY=VALUE, "
                         "such as --set run.step=2us",
                         argument)
               : err_set(err, ERR_USAGE,
                         "--set: the argument is not text on one line\nallowed: --set KEY=VALUE");
}

static bool override_read(Override *override, const char *option, const char *argument, Err *err)
{
    text_init(&override->shown);
    const char *equals = strchr(argument, '=');
    const size_t key_size = equals != NULL ? (size_t)(equals - argument) : 0;
    if (!source_is_one_line(argument, strlen(argument)) || key_size == 0 ||
        key_size >= sizeof override->key) {
        return refuse_argument(option, argument, err);
    }
    memcpy(override->key, argument, key_size);
    override->key[key_size] = '\0';
    text_append(&override->shown, "%s%s", option, argument);
    override->source = (Source){
        .name = option[0] != '\0' ? override->shown.data : override->key,
        .text = override->shown.data,
        .size = override->shown.length,
        .shift = strlen(option) + source_count(argument, key_size) + 1,
        .what = "case",
        .is_option = true,
        .is_override = true,
    };
    if (!document_parse(&override->source, equals + 1, strlen(equals + 1), &override->value, err)) {
        return false;
    }
    if (override->value == NULL) {
        return err_set(err, ERR_USAGE, "%s: no value\nallowed: %s", override->source.name,
                       option[0] != '\0' ? "--set KEY=VALUE" : "a value as a case file has it");
    }
    return true;
}

static void override_finish(Override *override)
{
    document_destroy(override->value);
    text_finish(&override->shown);
}

// A case and its overrides as trees, and what they say key by key.
typedef struct Reading {
    const char *option; // that overrides came with; empty: none
    Source source;
    Node *root;
    size_t override_count;
    Override *overrides; // owned
    Entries entries;
} Reading;

static void reading_finish(Reading *reading)
{
    for (size_t i = 0; i < reading->override_count; i++) {
        override_finish(&reading->overrides[i]);
    }
    free(reading->overrides);
    document_destroy(reading->root);
    entries_finish(&reading->entries);
    *reading = (Reading){.option = reading->option};
}

static bool read_entries(Reading *reading, Err *err)
{
    if (!entries_read(&reading->entries, reading->root, &reading->source, err)) {
        return false;
    }
    for (size_t i = 0; i < reading->override_count; i++) {
        const Override *override = &reading->overrides[i];
        if (!entries_override(&reading->entries, override->key, strlen(reading->option),
                              override->value, &override->source, err)) {
            return false;
        }
    }
    return true;
}

// Fills a reading that has its option alone, which stays where it is: entries point into it. For
// reading_finish also on failure.
static bool reading_take(Reading *reading, const char *name, const char *text, size_t size,
                         const char *const *overrides, size_t override_count, Err *err)
{
    if (!input_parse("case", name, text, size, &reading->source, &reading->root, err)) {
        return false;
    }
    reading->overrides = zeroed(override_count + 1, sizeof *reading->overrides);
    for (size_t i = 0; i < override_count; i++) {
        reading->override_count++;
        if (!override_read(&reading->overrides[i], reading->option, overrides[i], err)) {
            return false;
        }
    }
    return read_entries(reading, err);
}

// Reads the text and the overrides into trees, which live until the scenario is built.
bool casefile_load_text(const char *name, const char *text, size_t size,
                        const char *const *overrides, size_t override_count, Scenario *scenario,
                        Err *err)
{
    Reading reading = {.option = OPTION};
    const bool is_good = reading_take(&reading, name, text, size, overrides, override_count, err) &&
                         assemble_scenario(&reading.entries, scenario, err);
    reading_finish(&reading);
    return is_good;
}

// The same case again and again.
//
// Which keys a case has follows from its keys and those of the overrides alone: where nothing but
// the single values of overrides differs, the trees are those of the last time, with other texts in
// the places of these values.

struct CasefileRepeat {
    char *name; // owned
    const char *text;
    size_t size;
    bool is_read;
    Reading reading; // where it is
};

CasefileRepeat *casefile_repeat_open(const char *name, const char *text, size_t size,
                                     bool is_program)
{
    CasefileRepeat *repeat = zeroed(1, sizeof *repeat);
    repeat->name = strdup(name);
    assert(repeat->name != NULL);
    repeat->text = text;
    repeat->size = size;
    repeat->reading.option = is_program ? NO_OPTION : OPTION;
    return repeat;
}

void casefile_repeat_close(CasefileRepeat *repeat)
{
    if (repeat != NULL) {
        reading_finish(&repeat->reading);
        free(repeat->name);
        free(repeat);
    }
}

// Whether YAML takes a text as one single value that is the text itself: a number with its unit or
// a word, of letters, digits, blanks between them, and what numbers and units are written with.
static bool is_plain_value(const char *text)
{
    static const char FIRST[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    static const char FURTHER[] =
        " -+.^_/abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    const char *start = text + (text[0] == '-' ? 1 : 0);
    const size_t length = strlen(start);
    return length > 0 && strchr(FIRST, start[0]) != NULL && strspn(start, FURTHER) == length &&
           start[length - 1] != ' ';
}

// Puts another value into the place of that of an override. False where it has another key, or one
// of the two is more than a single value.
static bool override_repeat(Override *override, const char *option, const char *argument)
{
    const char *own = override->shown.data + strlen(option);
    const size_t key_size = strlen(override->key);
    if (strcmp(own, argument) == 0) {
        return true;
    }
    if (strncmp(own, argument, key_size) != 0 || argument[key_size] != '=') {
        return false;
    }
    const char *value = argument + key_size + 1;
    if (!is_plain_value(value) || !is_plain_value(own + key_size + 1)) {
        return false;
    }
    override->shown.length = 0;
    text_append(&override->shown, "%s%s", option, argument);
    override->source.name = option[0] != '\0' ? override->shown.data : override->key;
    override->source.text = override->shown.data;
    override->source.size = override->shown.length;
    free(override->value->text);
    override->value->text = strdup(value);
    assert(override->value->text != NULL);
    override->value->span.end = override->value->span.start + strlen(value);
    return true;
}

static bool reading_repeat(Reading *reading, const char *const *overrides, size_t override_count)
{
    if (override_count != reading->override_count) {
        return false;
    }
    for (size_t i = 0; i < override_count; i++) {
        if (!override_repeat(&reading->overrides[i], reading->option, overrides[i])) {
            return false;
        }
    }
    return true;
}

bool casefile_repeat(CasefileRepeat *repeat, const char *const *overrides, size_t override_count,
                     Scenario *scenario, Err *err)
{
    Reading *reading = &repeat->reading;
    if (!repeat->is_read || !reading_repeat(reading, overrides, override_count)) {
        reading_finish(reading);
        repeat->is_read = reading_take(reading, repeat->name, repeat->text, repeat->size, overrides,
                                       override_count, err);
    }
    return repeat->is_read && assemble_scenario(&reading->entries, scenario, err);
}

// What stands in the case alone: signals, and parts of sinusoids.

// Appends a value as a case file has it.
static void write_node(const Node *node, Text *text)
{
    const bool is_map = node->kind == NODE_MAP;
    if (node->kind == NODE_SCALAR) {
        const bool is_plain = is_plain_value(node->text);
        text_append(text, "%s", is_plain ? "" : "'");
        for (const char *c = node->text; *c != '\0'; c++) {
            text_append(text, "%s%c", !is_plain && *c == '\'' ? "'" : "", *c);
        }
        text_append(text, "%s", is_plain ? "" : "'");
        return;
    }
    text_append(text, "%s", is_map ? "{" : "[");
    for (const Node *item = node->first; item != NULL; item = item->next) {
        text_append(text, "%s", item != node->first ? ", " : "");
        if (is_map) {
            text_append(text, "%s: ", item->key->text);
        }
        write_node(item, text);
    }
    text_append(text, "%s", is_map ? "}" : "]");
}

// Takes a number in SI.
static void take_number(double number, Dimension dimension, CasefileSignal *signal)
{
    signal->number_count = 1;
    signal->number = number;
    text_copy(signal->unit, sizeof signal->unit, units_si(dimension));
}

static void take_node(const Node *node, Dimension dimension, CasefileSignal *signal)
{
    double number;
    write_node(node, &signal->text);
    if (node->kind == NODE_SCALAR &&
        quantity_parse(node->text, dimension, &number, &(Complaint){0})) {
        take_number(number, dimension, signal);
    }
}

// What a sinusoid has that does not say it: an angle begins with 0, and all else is 0.
static void take_default(const Entries *entries, const Entry *own, EntryPart part,
                         CasefileSignal *signal)
{
    const Dimension dimension = waves_dimension(entries, own, part);
    double number = 0.0;
    WaveRead read;
    const Entry entry = entries_resolve(entries, own);
    if (part == ENTRY_MEAN && dimension == DIMENSION_ANGLE &&
        waves_read(entries, &entry, dimension, 1.0, &read, &(Err){0})) {
        number = -read.wave.amplitude * sin(read.wave.phase);
    }
    take_number(number, dimension, signal);
    text_append_number(&signal->text, number);
    text_append(&signal->text, " %s", signal->unit);
}

// The sinusoid with what overrides its parts.
static void write_wave(const Entries *entries, const Entry *own, Text *text)
{
    bool is_first = true;
    text_append(text, "{");
    for (int i = 0; i < ENTRY_PART_COUNT; i++) {
        const Node *node = waves_part(entries, own, (EntryPart)i);
        if (node != NULL) {
            text_append(text, "%s%s: ", is_first ? "" : ", ", ENTRY_PARTS[i]);
            write_node(node, text);
            is_first = false;
        }
    }
    text_append(text, "}");
}

static bool take_signal(const Entries *entries, const Entry *own, EntryPart part,
                        CasefileSignal *signal)
{
    const Entry entry = entries_resolve(entries, own);
    const bool is_wave = waves_is_one(&entry);
    if (part != ENTRY_WHOLE && !is_wave) {
        return false;
    }
    text_init(&signal->text);
    const Node *node = part != ENTRY_WHOLE ? waves_part(entries, own, part) : own->node;
    if (node == NULL) {
        take_default(entries, own, part, signal);
    } else if (part == ENTRY_WHOLE && is_wave) {
        write_wave(entries, own, &signal->text);
    } else {
        take_node(node, waves_dimension(entries, own, part), signal);
    }
    return true;
}

bool casefile_signal(const char *text, size_t size, const char *const *overrides,
                     size_t override_count, const char *key, CasefileSignal *signal)
{
    const Source source = {.name = key, .text = key, .size = strlen(key), .is_option = true};
    Reading reading = {.option = NO_OPTION};
    Err ignored = {0};
    const SchemaRow *row = NULL;
    size_t index;
    EntryPart part;
    *signal = (CasefileSignal){.number_count = 0};
    bool is_there = reading_take(&reading, "", text, size, overrides, override_count, &ignored) &&
                    entries_key(&reading.entries, key, 0, &source, &row, &index, &part, &ignored) &&
                    row != NULL && (part != ENTRY_WHOLE || row->type == SCHEMA_SIGNAL);
    const Entry *own = is_there ? entries_at(&reading.entries, row, index) : NULL;
    is_there = own != NULL && take_signal(&reading.entries, own, part, signal);
    reading_finish(&reading);
    return is_there;
}

bool casefile_load(const char *path, const char *const *overrides, size_t override_count,
                   Scenario *scenario, Err *err)
{
    char *text;
    size_t size;
    const bool is_stdin = strcmp(path, "-") == 0;
    if (!(is_stdin ? input_read_stdin("case", &text, &size, err)
                   : input_read("case", path, &text, &size, err))) {
        return false;
    }
    const bool is_good = casefile_load_text(is_stdin ? INPUT_STDIN : path, text, size, overrides,
                                            override_count, scenario, err);
    free(text);
    return is_good;
}
