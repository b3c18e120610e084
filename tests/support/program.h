// Runs the real program and keeps what it printed. Where it is stands in the environment:
// JOINTPLAY_PROGRAM, and JOINTPLAY_CASES for the folder of cases.
#pragma once

#include "close.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PROGRAM_OUTPUT_SIZE = 1 << 18, PROGRAM_FOLDER_SIZE = 512, PROGRAM_PATH_SIZE = 1024 };

// One folder a test, made and taken away by set-up and tear-down; its output after each run.
typedef struct Program {
    char folder[PROGRAM_FOLDER_SIZE];
    int status; // exit status; -1 where it was ended by a signal
    char output[PROGRAM_OUTPUT_SIZE];
    char errors[PROGRAM_OUTPUT_SIZE];
} Program;

static inline void program_read(const char *path, char *target)
{
    FILE *stream = fopen(path, "r");
    assert_non_null(stream);
    target[fread(target, 1, PROGRAM_OUTPUT_SIZE - 1, stream)] = '\0';
    fclose(stream);
}

// Runs it in its folder with the words of a shell; "$cases" stands for the folder of cases.
static inline void program_run(Program *program, const char *words)
{
    char command[4 * PROGRAM_PATH_SIZE];
    char path[PROGRAM_PATH_SIZE + 16];
    const char *redirect = strstr(words, ">") == NULL ? ">.output" : "";
    snprintf(command, sizeof command,
             "cd '%s' && cases=$JOINTPLAY_CASES && : >.output && \"$JOINTPLAY_PROGRAM\" %s %s "
             "2>.errors",
             program->folder, words, redirect);
    const int status = system(command);
    program->status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    snprintf(path, sizeof path, "%s/.output", program->folder);
    program_read(path, program->output);
    snprintf(path, sizeof path, "%s/.errors", program->folder);
    program_read(path, program->errors);
}

// A file in the program's folder.
static inline void program_path(const Program *program, const char *name, char *path)
{
    snprintf(path, PROGRAM_PATH_SIZE, "%s/%s", program->folder, name);
}

// meson has malloc fill what is given back. In the program, which keeps megabytes of it, each
// realloc would fill all of that, which takes as long as everything else. Tests of its parts run
// with it, and sanitizers fill what is given out.
static inline void program_keep_freed_memory(void)
{
    setenv("MALLOC_PERTURB_", "0", 1);
}

static inline int program_set_up(void **state)
{
    const char *parent = getenv("TMPDIR");
    Program *program = calloc(1, sizeof *program);
    snprintf(program->folder, sizeof program->folder, "%s/jointplay-XXXXXX",
             parent == NULL ? "/tmp" : parent);
    *state = program;
    program_keep_freed_memory();
    return mkdtemp(program->folder) == NULL ? -1 : 0;
}

static inline int program_tear_down(void **state)
{
    Program *program = *state;
    char command[2 * PROGRAM_PATH_SIZE];
    snprintf(command, sizeof command, "rm -r '%s'", program->folder);
    const int status = system(command);
    free(program);
    return status;
}

#define assert_says(text, words) program_check_words((text), (words), __FILE__, __LINE__)

// Each run of blanks and line breaks as one blank: sentences break where a line is full.
static inline char *program_one_line(const char *text)
{
    char *line = malloc(strlen(text) + 1);
    size_t length = 0;
    for (; *text != '\0'; text++) {
        const bool is_blank = *text == ' ' || *text == '\n';
        if (!is_blank || length == 0 || line[length - 1] != ' ') {
            line[length++] = is_blank ? ' ' : *text;
        }
    }
    line[length] = '\0';
    return line;
}

static inline void program_check_words(const char *text, const char *words, const char *file,
                                       int line)
{
    char *said = program_one_line(text);
    char *wanted = program_one_line(words);
    const bool is_said = strstr(said, wanted) != NULL;
    free(said);
    free(wanted);
    if (!is_said) {
        print_error("'%s' is not in:\n%.600s\n", words, text);
        _fail(file, line);
    }
}

// A command line that is wrong ends with status 2, one line of words, and no data.
static inline void program_fails_usage(Program *program, const char *words, const char *message)
{
    program_run(program, words);
    assert_int_equal(program->status, 2);
    assert_string_equal(program->output, "");
    assert_int_equal(strncmp(program->errors, "jointplay: ", 11), 0);
    assert_says(program->errors, message);
}

// New reference: what the program printed, which must be JSON.
static inline json_t *program_json(const Program *program)
{
    json_t *root = json_loads(program->output, 0, NULL);
    assert_non_null(root);
    return root;
}
