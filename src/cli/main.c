// Runs the command that was asked for: the only place that prints errors and ends the program.
#include "base/descriptors.h"
#include "cli/arguments.h"
#include "cli/no_memory.h"
#include "cli/output.h"
#include "commands/commands.h"
#include "engine/driver.h"
#include "version.h"

#include <argp.h>
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

static bool fail_without_command(const char *word, void *options, Err *err)
{
    (void)word;
    (void)options;
    return err_set(err, ERR_USAGE, "no command given; 'jointplay help' lists the commands");
}

static bool print_versions(const char *value, void *options, Err *err)
{
    (void)value;
    (void)options;
    (void)err;
    printf("jointplay %s\nODE %s, libccd %s\n", JOINTPLAY_VERSION, JOINTPLAY_ODE_VERSION,
           JOINTPLAY_CCD_VERSION);
    char drivers[ENGINE_DRIVER_MAX * ENGINE_NAME_SIZE];
    engine_list(drivers, sizeof drivers);
    printf("drivers of other engines: %s\n", drivers[0] != '\0' ? drivers : "none");
    return true;
}

static bool do_nothing(void *options, Err *err)
{
    (void)options;
    return err->kind == ERR_NONE;
}

// Answers an option that stands before any command.
static bool answer_option(char **argv, Err *err)
{
    static const OptionRow OPTIONS[] = {
        {"version", NULL, "Print the versions of the program and its libraries", 0, OPTION_READ,
         .letter = 'V', .read = print_versions},
    };
    static const Arguments ARGUMENTS = {
        .program = "jointplay",
        .argument = {.type = OPTION_READ, .read = fail_without_command},
        OPTION_ROWS(OPTIONS),
    };
    char *words[] = {argv[0], argv[1], NULL};
    return arguments_run(&ARGUMENTS, 2, words, NULL, do_nothing, err);
}

static bool run_program(int argc, char **argv, Err *err)
{
    if (argc < 2) {
        return fail_without_command(NULL, NULL, err);
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        command_list();
        return true;
    }
    if (argv[1][0] == '-') {
        return answer_option(argv, err);
    }
    if (argc == 3 && strcmp(argv[2], "--version") == 0 && command_find(argv[1], err) != NULL) {
        return print_versions(NULL, NULL, err);
    }
    const Command *command = command_find(argv[1], err);
    return command != NULL && command->run(argc - 1, argv + 1, err);
}

// One line, as compilers print it, but folded on a terminal, which would break it within a word.
static void print_error(const Err *err)
{
    const Style style = output_style(stderr, false);
    Text text;
    text_init(&text);
    text_append(&text, "%sjointplay:%s %s\n", style.failure, style.end, err->text);
    text_fold(&text, output_is_terminal(stderr) ? style.width : 0);
    fputs(text.data, stderr);
    text_finish(&text);
}

// What one run gives back the next one takes, in whichever thread: a page that the system gives
// takes as long as thousands of instructions. Arrays of 32 MiB and more, the most that malloc has
// for this, go back at once.
static void keep_memory(void)
{
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TRIM_THRESHOLD, 64 << 20);
    mallopt(M_ARENA_MAX, 1);
}

int main(int argc, char **argv)
{
    Err err = {0};
    no_memory_begin();
    keep_memory();
    const bool is_ready = descriptors_reserve(&err);
    // a closed pipe and a file that is too large are then failed writes, which have an exit status
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    output_begin();
    argp_err_exit_status = ERR_USAGE;
    if (is_ready) {
        run_program(argc, argv, &err);
        output_end(&err);
    }
    if (err.kind != ERR_NONE && err.text[0] != '\0') {
        print_error(&err);
    }
    return err.kind;
}

const Command *const COMMANDS[] = {&cmd_new,   &cmd_run,  &cmd_report, &cmd_compare,
                                   &cmd_map,   &cmd_tune, &cmd_study,  &cmd_check,
                                   &cmd_paper, &cmd_help, NULL};
