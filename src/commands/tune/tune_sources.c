// How do many source files become one that needs nothing but ODE?
//
// As SQLite's amalgamation: the first #include of a file of ours is replaced by the file, and later
// ones are removed. A header also brings the files that implement it, those that include it first.
// Names at file scope must then be unique; tests/command/test_tune_code.c compiles the result.
#include "commands/tune/tune_sources.h"

#include "model/options.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

extern const char embedded_sources[];
extern const char embedded_sources_end[];

enum { FILE_MAX = 256, NAME_SIZE = 64 };

static const char MARK[] = "//// ";
static const char INCLUDE[] = "#include \"";
static const char COLLIDERS[] = "ode/collider_";

typedef struct Source {
    char name[NAME_SIZE];
    char header[NAME_SIZE]; // the first one that it includes; empty for none
    const char *begin;
    const char *end;
    bool is_wanted;
    bool is_written;
} Source;

typedef struct Sources {
    size_t count;
    Source files[FILE_MAX];
} Sources;

static const char *line_end(const char *line)
{
    const char *end = memchr(line, '\n', (size_t)(embedded_sources_end - line));
    return end == NULL ? embedded_sources_end : end + 1;
}

// The name between quotes in a line that includes a file of ours; false for any other line.
static bool read_include(const char *line, const char *end, char name[NAME_SIZE])
{
    const size_t length = sizeof INCLUDE - 1;
    if ((size_t)(end - line) <= length || strncmp(line, INCLUDE, length) != 0) {
        return false;
    }
    snprintf(name, NAME_SIZE, "%.*s", (int)strcspn(line + length, "\""), line + length);
    return true;
}

static void list_sources(Sources *sources)
{
    sources->count = 0;
    Source *source = NULL;
    for (const char *line = embedded_sources; line < embedded_sources_end;) {
        const char *end = line_end(line);
        char name[NAME_SIZE];
        if (strncmp(line, MARK, sizeof MARK - 1) == 0) {
            assert(sources->count < FILE_MAX);
            source = &sources->files[sources->count++];
            *source = (Source){.begin = end};
            snprintf(source->name, NAME_SIZE, "%.*s", (int)(end - line - sizeof MARK),
                     line + sizeof MARK - 1);
        } else if (source->header[0] == '\0' && read_include(line, end, name)) {
            memcpy(source->header, name, NAME_SIZE);
        }
        source->end = end;
        line = end;
    }
}

static Source *find_source(Sources *sources, const char *name)
{
    for (size_t i = 0; i < sources->count; i++) {
        if (strcmp(sources->files[i].name, name) == 0) {
            return &sources->files[i];
        }
    }
    return NULL;
}

// Whether a file is a stepping or a collider, each of which ends in a table of functions that
// stands for all of it, whatever header it includes first.
static bool is_member(const char *name)
{
    char member[NAME_SIZE];
    bool is_stepping = strcmp(name, "ode/impulse.c") == 0;
    for (size_t i = 0; OPTIONS_ODE_STEPPINGS[i] != NULL; i++) {
        snprintf(member, sizeof member, "ode/%s.c", OPTIONS_ODE_STEPPINGS[i]);
        is_stepping = is_stepping || strcmp(name, member) == 0;
    }
    return is_stepping || strncmp(name, COLLIDERS, sizeof COLLIDERS - 1) == 0;
}

// Marks the files that implement a header.
static void want_parts(Sources *sources, const char *header)
{
    for (size_t i = 0; i < sources->count; i++) {
        Source *source = &sources->files[i];
        const size_t length = strlen(source->name);
        if (strcmp(source->header, header) == 0 && source->name[length - 1] == 'c' &&
            !is_member(source->name)) {
            source->is_wanted = true;
        }
    }
}

static bool write_source(Sources *sources, const char *name, Text *text, Err *err)
{
    Source *source = find_source(sources, name);
    if (source == NULL) {
        return err_set(err, ERR_FILE,
                       "the program does not carry its source %s: it must be in the list of "
                       "src/commands/tune/meson.build",
                       name);
    }
    if (source->is_written) {
        return true;
    }
    source->is_written = true;
    want_parts(sources, name);
    // headers first, so that no file is broken in two
    for (const char *line = source->begin; line < source->end; line = line_end(line)) {
        char included[NAME_SIZE];
        if (read_include(line, source->end, included) &&
            !write_source(sources, included, text, err)) {
            return false;
        }
    }
    text_append(text, "\n// ---- %s ----\n\n", name);
    for (const char *line = source->begin; line < source->end; line = line_end(line)) {
        char included[NAME_SIZE];
        if (!read_include(line, source->end, included) && strncmp(line, "#pragma once", 12) != 0) {
            text_append(text, "%.*s", (int)(line_end(line) - line), line);
        }
    }
    return true;
}

bool tune_sources_write(const char *const *files, size_t file_count, Text *text, Err *err)
{
    Sources sources;
    list_sources(&sources);
    bool is_whole = true;
    for (size_t i = 0; i < file_count && is_whole; i++) {
        is_whole = write_source(&sources, files[i], text, err);
    }
    // what was written may need more
    for (size_t i = 0; i < sources.count && is_whole; i++) {
        if (sources.files[i].is_wanted && !sources.files[i].is_written) {
            is_whole = write_source(&sources, sources.files[i].name, text, err);
            i = (size_t)-1;
        }
    }
    return is_whole;
}
