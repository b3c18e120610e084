// Is the file that would be replaced of the same kind?
//
// A user's own table, drawing or script is none of ours, whatever its name ends in: only what
// begins as this program begins such a file is replaced. A new beginning needs a mark here; the old
// one stays, for the files that have it.
#define _GNU_SOURCE // memmem

#include "write/file_kind.h"

#include <assert.h>
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum {
    MARK_MAX = 4,        // beginnings of one kind
    HEAD_SIZE = 1 << 16, // bytes that are looked at: the first line of a study's table is long
    SHOWN_SIZE = 33,     // of the beginning of a file that is no kind of ours
};

// How a file begins, blanks and line ends aside, and what stands further down.
typedef struct Mark {
    const char *opening;
    const char *further; // NULL: nothing more is asked
} Mark;

typedef struct Kind {
    const char *name; // in a message
    Mark marks[MARK_MAX];
} Kind;

static const Kind KINDS[FILE_KIND_COUNT] = {
    [FILE_TABLE] = {"a table of jointplay (CSV)",
                    {{"time_s,", NULL},
                     {"scheme,step_s,", NULL},
                     {"joint,law,map,step_s,", NULL},
                     {"run,", ",outcome,reason,"}}},
    [FILE_PICTURE] = {"a picture of jointplay (SVG)",
                      {{"<svg xmlns=\"http://www.w3.org/2000/svg\" width=", "<style>text{"}}},
    [FILE_RESULT] = {"a result of jointplay (JSON)", {{"{\"tool\": {\"version\":", "\"ode\":"}}},
    [FILE_REPORT] = {"a report of jointplay (text)",
                     {{"", "\n\n  case    "}, {"A lone contact", "\n\n  valid    "}}},
    [FILE_CODE] = {"C code of jointplay tune",
                   {{"// A mechanism with play in its joints in the Open Dynamics Engine,",
                     "`jointplay tune`"}}},
    [FILE_SDF] = {"SDF of jointplay tune", {{"<!-- error with these constants, measured:", NULL}}},
    [FILE_MJCF] = {"MJCF of jointplay tune", {{"<!-- spring ", "not run here; for bodies"}}},
    [FILE_JUNIT] = {"JUnit XML of jointplay check",
                    {{"<?xml version=\"1.0\" encoding=\"UTF-8\"?><testsuites name=\"jointplay "
                      "check\"",
                      NULL}}},
    [FILE_COMMENT] = {"a comment of jointplay check (Markdown)", {{"### jointplay check", NULL}}},
    [FILE_BASELINE] = {"a baseline of jointplay check",
                       {{"{\"format\": \"jointplay baseline", NULL}}},
    [FILE_ROWS] = {"rows of a study (JSON Lines)", {{"{\"run\":", "\"outcome\":"}}},
    [FILE_SCRIPT] = {"a script of jointplay study slurm",
                     {{"#!/bin/bash", "Written by 'jointplay study slurm'"}}},
    [FILE_STORE] = {"a store of a study", {{"SQLite format 3", "JPST"}}},
    [FILE_JOURNAL] = {"a store of a comparison", {{"{\"compare\":", NULL}}},
};

static bool begins_with(const char *head, size_t size, const char *opening)
{
    size_t i = 0;
    for (; *opening != '\0'; opening++) {
        if (isspace((unsigned char)*opening)) {
            continue;
        }
        while (i < size && isspace((unsigned char)head[i])) {
            i++;
        }
        if (i == size || head[i] != *opening) {
            return false;
        }
        i++;
    }
    return true;
}

static bool is_of_kind(const Kind *kind, const char *head, size_t size)
{
    for (size_t i = 0; i < MARK_MAX && kind->marks[i].opening != NULL; i++) {
        const char *further = kind->marks[i].further;
        if (begins_with(head, size, kind->marks[i].opening) &&
            (further == NULL || memmem(head, size, further, strlen(further)) != NULL)) {
            return true;
        }
    }
    return false;
}

// The first line, or what there is room for of it.
static void show_head(const char *head, size_t size, char shown[SHOWN_SIZE])
{
    size_t start = 0;
    while (start < size && isspace((unsigned char)head[start])) {
        start++;
    }
    size_t length = 0;
    for (; start + length < size && length < SHOWN_SIZE - 1; length++) {
        const char letter = head[start + length];
        if (letter == '\n' || letter == '\r') {
            break;
        }
        shown[length] = (char)(letter >= ' ' && letter <= '~' ? letter : '?');
    }
    shown[length] = '\0';
}

static bool refuse(const char *user, const char *path, const char *what, const Kind *kind, Err *err)
{
    return err_set(err, ERR_FILE,
                   "%s would replace %s, which %s and is not %s; delete it first or name another "
                   "file",
                   user, path, what, kind->name);
}

static bool refuse_head(const char *user, const char *path, const char *head, size_t size,
                        const Kind *kind, Err *err)
{
    char what[2 * SHOWN_SIZE + 64];
    for (size_t i = 0; i < FILE_KIND_COUNT; i++) {
        if (is_of_kind(&KINDS[i], head, size)) {
            snprintf(what, sizeof what, "is %s", KINDS[i].name);
            return refuse(user, path, what, kind, err);
        }
    }
    char shown[SHOWN_SIZE];
    show_head(head, size, shown);
    snprintf(what, sizeof what, "begins '%s'", shown);
    return refuse(user, path, what, kind, err);
}

static bool read_head(const char *path, char *head, size_t *size)
{
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) {
        return false;
    }
    *size = fread(head, 1, HEAD_SIZE, stream);
    const bool is_read = !ferror(stream);
    fclose(stream);
    return is_read;
}

bool file_kind_check(FileKind kind, const char *user, const char *path, Err *err)
{
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) {
        return true;
    }
    char *head = malloc(HEAD_SIZE);
    assert(head != NULL);
    size_t size = 0;
    bool is_own = false;
    if (!read_head(path, head, &size)) {
        char what[128];
        snprintf(what, sizeof what, "cannot be read (%s)", strerror(errno));
        refuse(user, path, what, &KINDS[kind], err);
    } else {
        is_own = is_of_kind(&KINDS[kind], head, size) ||
                 refuse_head(user, path, head, size, &KINDS[kind], err);
    }
    free(head);
    return is_own;
}

bool file_kind_is_kept(FileKind kind)
{
    return kind == FILE_STORE || kind == FILE_JOURNAL;
}
