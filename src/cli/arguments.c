// Reads the words of a command line by a table of options.
//
// argp only parses here: it neither prints nor exits, so that main alone does.
#include "cli/arguments.h"

#include "base/claims.h"
#include "base/text.h"
#include "cli/option_hint.h"
#include "cli/option_values.h"

#include <argp.h>
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

// the key of an option without a letter is the number of its row, from KEY_FIRST on
enum { OPTION_MAX = 32, OPTION_NAME_SIZE = 64, KEY_HELP = 'h', KEY_FIRST = 0x100 };

typedef struct Reading {
    const Arguments *arguments;
    const struct argp_option *options; // argp's rows: those of the arguments, and --help
    void *target;
    bool is_answered;
    Err *err;
} Reading;

// The option of a word from the command line ("--step=1us", "-q"), or NULL. All
// letters behind one dash ("-qx") must be options.
static const struct argp_option *find_option(const struct argp_option *options, const char *word)
{
    const bool is_long = strncmp(word, "--", 2) == 0;
    const char *name = is_long ? word + 2 : word + 1;
    const size_t length = is_long ? strcspn(name, "=") : strlen(name);
    const struct argp_option *found = NULL;
    for (size_t i = 0; i < (is_long ? 1 : length); i++) {
        found = NULL;
        for (const struct argp_option *option = options; option->name != NULL; option++) {
            const bool is_name = is_long && strlen(option->name) == length &&
                                 strncmp(name, option->name, length) == 0;
            if (is_name || (!is_long && name[i] == option->key)) {
                found = option;
            }
        }
        if (found == NULL) {
            return NULL;
        }
    }
    return found;
}

static bool fail_unknown(const Reading *reading, const char *word)
{
    char bare[OPTION_NAME_SIZE];
    snprintf(bare, sizeof bare, "%.*s", (int)strcspn(word, "="), word);
    Text hint;
    text_init(&hint);
    option_hint_write(reading->options, word, &hint);
    if (hint.length > 0) {
        err_set(reading->err, ERR_USAGE, "unknown option '%s'; did you mean %s?", bare, hint.data);
    } else {
        err_set(reading->err, ERR_USAGE, "unknown option '%s'; '%s --help' lists the options", bare,
                reading->arguments->program);
    }
    text_finish(&hint);
    return false;
}

// argp reports only where parsing stopped: the wrong word is that one or the next.
static void explain(const Reading *reading, const struct argp_state *state)
{
    for (int i = state->next - 1; i <= state->next; i++) {
        if (i > 0 && i < state->argc && state->argv[i][0] == '-' &&
            find_option(reading->options, state->argv[i]) == NULL) {
            fail_unknown(reading, state->argv[i]);
            return;
        }
    }
    const char *word = state->argv[state->next - 1];
    const struct argp_option *option = find_option(reading->options, word);
    if (option != NULL && option->arg != NULL) {
        err_set(reading->err, ERR_USAGE, "option '--%s' needs a value: --%s %s", option->name,
                option->name, option->arg);
    } else {
        err_set(reading->err, ERR_USAGE, "option '%s' takes no value", word);
    }
}

// An option whose value is called FILE writes that file; no two may write the same one.
static bool claim_file(const OptionRow *row, const char *value, Err *err)
{
    if (row->value == NULL || strncmp(row->value, "FILE", 4) != 0) {
        return true;
    }
    Claim claim;
    char user[OPTION_NAME_SIZE];
    snprintf(user, sizeof user, "--%s", row->name);
    if (claims_find(value, &claim) && strcmp(claim.user, user) != 0) {
        return err_set(err, ERR_USAGE, "%s and %s would both write %s", claim.user, user, value);
    }
    claims_note_written(user, value);
    return true;
}

static bool check_picture(const OptionRow *row, const char *path, Err *err)
{
    char user[OPTION_NAME_SIZE];
    snprintf(user, sizeof user, "--%s", row->name);
    return option_values_check_picture(user, path, err);
}

static bool take_text(const OptionRow *row, const char *value, const char **text, Err *err)
{
    if (row->name == NULL && *text != NULL) {
        return err_set(err, ERR_USAGE, "%s, not %s and %s", row->what, *text, value);
    }
    *text = value;
    return true;
}

static bool take_choice(const OptionRow *row, const char *value, const char **text, Err *err)
{
    Text allowed;
    text_init(&allowed);
    for (const char *const *word = row->words; *word != NULL; word++) {
        text_append(&allowed, "%s%s", word == row->words ? "" : ", ", *word);
        *text = strcmp(value, *word) == 0 ? *word : *text;
    }
    if (*text == NULL || strcmp(value, *text) != 0) {
        err_set(err, ERR_USAGE, "--%s is %s; allowed: %s", row->name, value, allowed.data);
    }
    text_finish(&allowed);
    return err->kind == ERR_NONE;
}

static bool take_item(const OptionRow *row, const char *value, const char **list, size_t *count,
                      Err *err)
{
    if (*count == (size_t)row->high) {
        return err_set(err, ERR_USAGE, "more than %.0f %s on one command line", row->high,
                       row->what);
    }
    list[(*count)++] = value;
    return true;
}

static bool take_value(const Reading *reading, const OptionRow *row, const char *value)
{
    Err *err = reading->err;
    // a command without options of its own has nothing to fill
    void *field = reading->target == NULL ? NULL : (char *)reading->target + row->offset;
    switch (row->type) {
    case OPTION_NONE:
        return err_set(err, ERR_USAGE, "'%s' takes no argument, and '%s' is one",
                       reading->arguments->program, value);
    case OPTION_FLAG:
        *(bool *)field = true;
        return true;
    case OPTION_PICTURE:
        return check_picture(row, value, err) && take_text(row, value, field, err);
    case OPTION_TEXT:
        return take_text(row, value, field, err);
    case OPTION_CHOICE:
        return take_choice(row, value, field, err);
    case OPTION_LIST:
        return take_item(row, value, field,
                         (size_t *)(void *)((char *)reading->target + row->count_offset), err);
    case OPTION_COUNT:
        return option_values_read_count(row->name, value, (size_t)row->low, (size_t)row->high,
                                        field, err);
    case OPTION_QUANTITY:
        return option_values_read_quantity(row->name, value, row->dimension, field, err);
    case OPTION_READ:
        return row->read(value, reading->target, err);
    }
    return false;
}

static int key_of(const Arguments *arguments, size_t row)
{
    const int letter = arguments->options[row].letter;
    return letter != 0 ? letter : KEY_FIRST + (int)row;
}

static error_t parse_key(int key, char *value, struct argp_state *state)
{
    Reading *reading = state->input;
    const Arguments *arguments = reading->arguments;
    if (key == KEY_HELP) {
        reading->is_answered = true;
        return 0;
    }
    if (key == ARGP_KEY_ERROR) {
        // an error that is set already is more precise
        if (reading->err->kind == ERR_NONE) {
            explain(reading, state);
        }
        return 0;
    }
    const OptionRow *row = key == ARGP_KEY_ARG ? &arguments->argument : NULL;
    for (size_t i = 0; row == NULL && i < arguments->option_count; i++) {
        row = key_of(arguments, i) == key ? &arguments->options[i] : NULL;
    }
    if (row == NULL) {
        return ARGP_ERR_UNKNOWN;
    }
    const bool is_taken = claim_file(row, value, reading->err) && take_value(reading, row, value);
    return is_taken ? 0 : EINVAL;
}

// argp's rows of a command's options, with --help at the end.
static void list_options(const Arguments *arguments, struct argp_option options[OPTION_MAX])
{
    assert(arguments->option_count + 2 <= OPTION_MAX);
    for (size_t i = 0; i < arguments->option_count; i++) {
        const OptionRow *row = &arguments->options[i];
        options[i] = (struct argp_option){row->name, key_of(arguments, i), row->value, 0, row->doc,
                                          row->group};
    }
    options[arguments->option_count] = (struct argp_option){
        .name = "help", .key = KEY_HELP, .doc = "Print this and do nothing", .group = -1};
}

bool arguments_run(const Arguments *arguments, int argc, char **argv, void *options,
                   bool (*work)(void *options, Err *err), Err *err)
{
    struct argp_option rows[OPTION_MAX] = {0};
    list_options(arguments, rows);
    const struct argp argp = {
        .options = rows,
        .parser = parse_key,
        .args_doc = arguments->usage,
        .doc = arguments->doc,
    };
    Reading reading = {arguments, rows, options, false, err};
    const unsigned flags = ARGP_NO_ERRS | ARGP_NO_EXIT | ARGP_NO_HELP;
    argp_parse(&argp, argc, argv, flags, NULL, &reading);
    if (reading.is_answered) {
        char program[OPTION_NAME_SIZE];
        text_copy(program, sizeof program, arguments->program);
        argp_help(&argp, stdout, ARGP_HELP_STD_HELP, program);
        *err = (Err){0};
        return true;
    }
    return err->kind == ERR_NONE && (arguments->check == NULL || arguments->check(options, err)) &&
           work(options, err);
}
