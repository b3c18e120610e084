// What was asked for on the command line?
//
// argp reads it, but prints nothing and ends nothing: what it would say it says through Err, so
// that one place prints errors and one place ends the program.
#include "cli/arguments.h"

#include "base/claims.h"
#include "base/text.h"
#include "cli/option_hint.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { OPTION_MAX = 32, OPTION_NAME_SIZE = 64, KEY_HELP = 'h' };

typedef struct Reading {
    const Arguments *arguments;
    const struct argp_option *options;
    void *target;
    bool is_answered;
    Err *err;
} Reading;

// The option of a word from the command line ("--step=1us", "-q"), or NULL. Of several letters
// behind one dash ("-qx") the first that is no option makes it none.
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

// argp says only that something was wrong, and how far it came: the word stands there or next.
static void explain(const Reading *reading, const struct argp_state *state)
{
    const int places[2] = {state->next - 1, state->next};
    for (int i = 0; i < 2; i++) {
        const int place = places[i];
        if (place > 0 && place < state->argc && state->argv[place][0] == '-' &&
            find_option(reading->options, state->argv[place]) == NULL) {
            fail_unknown(reading, state->argv[place]);
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

// Whatever writes a file shows it by what it calls its value. No two options write the same one.
static bool claim_file(const Reading *reading, int key, const char *value)
{
    for (const struct argp_option *option = reading->options; option->name != NULL; option++) {
        if (option->key != key || option->arg == NULL || strncmp(option->arg, "FILE", 4) != 0) {
            continue;
        }
        Claim claim;
        char user[OPTION_NAME_SIZE];
        snprintf(user, sizeof user, "--%s", option->name);
        if (claims_find(value, &claim) && strcmp(claim.user, user) != 0) {
            return err_set(reading->err, ERR_USAGE, "%s and %s would both write %s", claim.user,
                           user, value);
        }
        claims_note_written(user, value);
    }
    return true;
}

static error_t parse_key(int key, char *value, struct argp_state *state)
{
    Reading *reading = state->input;
    if (key == KEY_HELP) {
        reading->is_answered = true;
        return 0;
    }
    if (key == ARGP_KEY_ERROR) {
        // whatever is set already says it better
        if (reading->err->kind == ERR_NONE) {
            explain(reading, state);
        }
        return 0;
    }
    if (key >= ARGP_KEY_END) {
        return ARGP_ERR_UNKNOWN;
    }
    return claim_file(reading, key, value) &&
                   reading->arguments->take(key, value, reading->target, reading->err)
               ? 0
               : EINVAL;
}

bool arguments_parse(const Arguments *arguments, int argc, char **argv, void *target,
                     bool *is_answered, Err *err)
{
    struct argp_option options[OPTION_MAX] = {0};
    size_t count = 0;
    for (const struct argp_option *option = arguments->options; option->name != NULL; option++) {
        assert(count + 2 < OPTION_MAX);
        options[count++] = *option;
    }
    options[count] = (struct argp_option){
        .name = "help", .key = KEY_HELP, .doc = "Print this and do nothing", .group = -1};
    const struct argp argp = {
        .options = options,
        .parser = parse_key,
        .args_doc = arguments->usage,
        .doc = arguments->doc,
    };
    Reading reading = {arguments, options, target, false, err};
    const unsigned flags = ARGP_NO_ERRS | ARGP_NO_EXIT | ARGP_NO_HELP;
    argp_parse(&argp, argc, argv, flags, NULL, &reading);
    *is_answered = reading.is_answered;
    if (reading.is_answered) {
        char program[OPTION_NAME_SIZE];
        text_copy(program, sizeof program, arguments->program);
        argp_help(&argp, stdout, ARGP_HELP_STD_HELP, program);
        *err = (Err){0};
    }
    return err->kind == ERR_NONE;
}
