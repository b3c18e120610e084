// The command `jointplay help`: the use of a command, and the sections and keys of a case.
#include "casefile/casefile.h"
#include "cli/arguments.h"
#include "cli/output.h"
#include "commands/commands.h"
#include "commands/help/help.h"

#include <stdio.h>
#include <string.h>

enum { WORD_MAX = 2, WORD_SIZE = 32 }; // of a topic: a command and one of its own

typedef struct HelpOptions {
    const char *words[WORD_MAX];
    size_t word_count; // 0: the list of commands
    const char *shell; // to complete command lines in, or NULL
    bool is_markdown;
    bool is_all; // of a case, all keys
    bool is_man;
} HelpOptions;

static const char *const SHELLS[] = {"bash", "zsh", NULL};

static const OptionRow HELP_OPTIONS[] = {
    {"markdown", NULL, "Of the format of a file: as Markdown", 0, OPTION_FLAG,
     offsetof(HelpOptions, is_markdown), .letter = 'm'},
    {"all", NULL, "Of a case file: all keys of all sections", 0, OPTION_FLAG,
     .offset = offsetof(HelpOptions, is_all)},
    {"man", NULL, "Print the manual page of the program or a command, for 'man -l -'", 0,
     OPTION_FLAG, .offset = offsetof(HelpOptions, is_man)},
    {"completion", "SHELL", "Print the script that completes command lines in bash or zsh", 0,
     OPTION_CHOICE, .offset = offsetof(HelpOptions, shell), .words = SHELLS},
};

static bool cmd_help_read_word(const char *word, void *target, Err *err)
{
    HelpOptions *options = target;
    if (options->word_count == WORD_MAX) {
        return err_set(err, ERR_USAGE, "one topic at a time, and '%s' is one more", word);
    }
    options->words[options->word_count++] = word;
    return true;
}

// columns of prose that can be read
enum { HELP_WIDTH_LEAST = 50, HELP_WIDTH_MOST = 100 };

static int help_width(void)
{
    const size_t width = output_style(stdout, false).width;
    return width < HELP_WIDTH_LEAST  ? HELP_WIDTH_LEAST
           : width > HELP_WIDTH_MOST ? HELP_WIDTH_MOST
                                     : (int)width;
}

static void print_format(void (*describe)(bool is_markdown, Text *text), bool is_markdown)
{
    Text text;
    text_init(&text);
    describe(is_markdown, &text);
    fputs(text.data, stdout);
    text_finish(&text);
}

static void print_case(const HelpOptions *options)
{
    Text text;
    text_init(&text);
    if (options->is_markdown) {
        casefile_describe_markdown(&text);
    } else if (options->is_all) {
        casefile_describe_all(help_width(), &text);
    } else {
        casefile_describe(help_width(), &text);
    }
    fputs(text.data, stdout);
    text_finish(&text);
}

// A section of a case, or keys of it.
static bool print_part(const char *name, Err *err)
{
    Text text;
    text_init(&text);
    const bool is_known = casefile_describe_part(name, help_width(), &text, err);
    // without the empty line in front, which divides it from others
    fputs(is_known ? text.data + strspn(text.data, "\n") : "", stdout);
    text_finish(&text);
    return is_known;
}

// A command's own --help, and the format of its file; of 'study status' the help of the second
// word.
static bool explain_command(const HelpOptions *options, Err *err)
{
    const Command *command = command_find_topic(options->words[0], "case", err);
    if (command == NULL) {
        return false;
    }
    if (options->word_count > 1 && command != &cmd_study) {
        return err_set(err, ERR_USAGE, "one topic at a time: '%s' or '%s'", options->words[0],
                       options->words[1]);
    }
    const bool has_format = options->word_count == 1 && command->describe != NULL;
    if (has_format && options->is_markdown) {
        print_format(command->describe, true);
        return true;
    }
    char words[WORD_MAX + 1][WORD_SIZE] = {""};
    char *pointers[WORD_MAX + 2] = {NULL};
    for (size_t i = 0; i <= options->word_count; i++) {
        text_copy(words[i], WORD_SIZE, i < options->word_count ? options->words[i] : "--help");
        pointers[i] = words[i];
    }
    if (!command->run((int)options->word_count + 1, pointers, err)) {
        return false;
    }
    if (has_format) {
        puts("");
        print_format(command->describe, false);
    }
    return true;
}

// The manual page of a command, or of the program where none is named.
static bool print_man(const HelpOptions *options, Err *err)
{
    const Command *command = NULL;
    if (options->word_count > 0) {
        command = command_find(options->words[0], err);
        if (command == NULL) {
            return false;
        }
    }
    Text text;
    text_init(&text);
    help_man(command, &text);
    fputs(text.data, stdout);
    text_finish(&text);
    return true;
}

static void print_completion(const char *shell)
{
    Text text;
    text_init(&text);
    if (strcmp(shell, "bash") == 0) {
        help_completion_bash(&text);
    } else {
        help_completion_zsh(&text);
    }
    fputs(text.data, stdout);
    text_finish(&text);
}

static bool cmd_help_explain(void *target, Err *err)
{
    const HelpOptions *options = target;
    if (options->shell != NULL) {
        print_completion(options->shell);
        return true;
    }
    if (options->is_man) {
        return print_man(options, err);
    }
    if (options->word_count == 0) {
        command_list();
        return true;
    }
    if (strcmp(options->words[0], "case") == 0) {
        if (options->word_count > 1) {
            return print_part(options->words[1], err);
        }
        print_case(options);
        return true;
    }
    Err no_part = {0};
    Err no_command = {0};
    const bool is_command = command_find(options->words[0], &no_command) != NULL;
    return (options->word_count == 1 && !is_command && print_part(options->words[0], &no_part)) ||
           explain_command(options, err);
}

static const Arguments HELP_ARGUMENTS = {
    .program = "jointplay help",
    .usage = "[case|COMMAND]\ncase SECTION|KEY\nstudy COMMAND",
    .doc = "Shows how a command is used, or how a case or study file is written.",
    .argument = {.type = OPTION_READ, .read = cmd_help_read_word},
    OPTION_ROWS(HELP_OPTIONS),
};

static bool run_help(int argc, char **argv, Err *err)
{
    HelpOptions options = {0};
    return arguments_run(&HELP_ARGUMENTS, argc, argv, &options, cmd_help_explain, err);
}

const Command cmd_help = {
    .name = "help",
    .summary = "explains a command, or with 'case' the format of a case file",
    .run = run_help,
    .arguments = &HELP_ARGUMENTS,
};
