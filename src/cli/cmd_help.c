// How is a command used, and how is a case file written?
#include "cli/arguments.h"
#include "cli/command.h"

#include "casefile/casefile.h"

#include <stdio.h>
#include <string.h>

typedef struct HelpOptions {
    const char *topic; // NULL: the list of commands
    bool is_markdown;
} HelpOptions;

enum { KEY_MARKDOWN = 'm' };

static const struct argp_option OPTIONS[] = {
    {"markdown", KEY_MARKDOWN, NULL, 0, "Of the case format: as Markdown", 0},
    {0},
};

static bool take_option(int key, const char *value, void *target, Err *err)
{
    HelpOptions *options = target;
    if (key == KEY_MARKDOWN) {
        options->is_markdown = true;
        return true;
    }
    if (options->topic != NULL) {
        return err_set(err, ERR_USAGE, "one topic at a time: '%s' or '%s'", options->topic, value);
    }
    options->topic = value;
    return true;
}

static void describe_case(bool is_markdown)
{
    Text text;
    text_init(&text);
    if (is_markdown) {
        casefile_describe_markdown(&text);
    } else {
        casefile_describe(&text);
    }
    fputs(text.data, stdout);
    text_finish(&text);
}

static bool run_help(int argc, char **argv, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay help",
        .usage = "[case|COMMAND]",
        .doc = "Tells how a command is used, or how a case file is written.",
        .options = OPTIONS,
        .take = take_option,
    };
    HelpOptions options = {0};
    bool is_answered;
    if (!arguments_parse(&ARGUMENTS, argc, argv, &options, &is_answered, err) || is_answered) {
        return err->kind == ERR_NONE;
    }
    if (options.topic == NULL) {
        command_list();
        return true;
    }
    if (strcmp(options.topic, "case") == 0) {
        describe_case(options.is_markdown);
        return true;
    }
    const Command *command = command_find(options.topic, err);
    if (command == NULL) {
        return false;
    }
    char name[32];
    char option[] = "--help";
    text_copy(name, sizeof name, command->name);
    char *words[] = {name, option, NULL};
    return command->run(2, words, err);
}

const Command cmd_help = {
    .name = "help",
    .summary = "explains a command, or with 'case' the format of a case file",
    .run = run_help,
};
