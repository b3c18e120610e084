// The command `jointplay new`: writes a commented case to start from.
//
// Each kind is a file of this folder that stands in the program. It is written as it is, never over
// a file that is there unless --force is given, and then only over one that this command wrote.
#include "cli/arguments.h"
#include "cli/written.h"
#include "commands/commands.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

// A kind of case: its word and what it is, and the text in the program.
#define NEW_KIND_LIST(X)                                                                           \
    X(four_bar, "four-bar", "a crank-rocker with play in a pin")                                   \
    X(slider_crank, "slider-crank", "with play in the piston pin, and a load")                     \
    X(bodies, "bodies", "any planar linkage, as a list of bodies and joints")                      \
    X(gears, "gears", "a pair with backlash")                                                      \
    X(servo, "servo", "a pivot with backlash or stops")                                            \
    X(space, "space", "a pin that tilts and slides in its hole")

#define DECLARE(name, word, what) extern const char embedded_new_##name[];
NEW_KIND_LIST(DECLARE)
#undef DECLARE

typedef struct NewKind {
    const char *word;
    const char *text; // ends in a zero
} NewKind;

#define ROW(name, word, what) {word, embedded_new_##name},
static const NewKind NEW_KINDS[] = {NEW_KIND_LIST(ROW)};
#undef ROW

#define WORD(name, word, what) word,
static const char *const NEW_WORDS[] = {NEW_KIND_LIST(WORD) NULL};
#undef WORD

#define LINE(name, word, what) "\n" word ": " what
static const char NEW_DOC[] =
    "Writes a commented case to start from, which runs as it is: into FILE.yaml, or into "
    "<kind>.yaml in the current folder; '-' prints it. It asks nothing, and does not replace a "
    "file."
    "\vKinds:" NEW_KIND_LIST(LINE);
#undef LINE

typedef struct NewOptions {
    const char *path; // NULL: <kind>.yaml
    const char *kind;
    bool is_forced;
    bool is_quiet;
} NewOptions;

#define NEW_AT(field) .offset = offsetof(NewOptions, field)

static const OptionRow NEW_OPTIONS[] = {
    {"kind", "KIND", "Which mechanism (default: four-bar)", 1, OPTION_CHOICE, NEW_AT(kind),
     .words = NEW_WORDS},
    {"force", NULL, "Replace a case that this command wrote, with all that was changed in it", 1,
     OPTION_FLAG, NEW_AT(is_forced)},
    {"quiet", NULL, "Nothing on standard error but errors", 1, OPTION_FLAG, NEW_AT(is_quiet),
     .letter = 'q'},
};

// The text of a kind, which is one of the list.
static const char *new_text(const char *kind)
{
    size_t i = 0;
    while (strcmp(NEW_KINDS[i].word, kind) != 0) {
        i++;
        assert(i < sizeof NEW_KINDS / sizeof *NEW_KINDS);
    }
    return NEW_KINDS[i].text;
}

// Whether nothing is in the way, be it only a link that leads nowhere.
static bool check_free(const NewOptions *options, const char *path, Err *err)
{
    struct stat status;
    return options->is_forced || file_is_stream(path) || lstat(path, &status) != 0 ||
           err_set(err, ERR_FILE,
                   "%s is there already; name another file, or give --force to replace it", path);
}

static bool write_case(void *target, Err *err)
{
    const NewOptions *options = target;
    char path[FILE_PATH_SIZE];
    const int length = options->path != NULL
                           ? snprintf(path, sizeof path, "%s", options->path)
                           : snprintf(path, sizeof path, "%s.yaml", options->kind);
    if (length >= (int)sizeof path) {
        return err_set(err, ERR_FILE, "the path of the case is too long");
    }
    return check_free(options, path, err) && file_claim("the case", FILE_CASE, path, err) &&
           written_text(FILE_CASE, path, new_text(options->kind), options->is_quiet, err);
}

static const Arguments NEW_ARGUMENTS = {
    .program = "jointplay new",
    .usage = "[FILE.yaml]",
    .doc = NEW_DOC,
    .argument = {.type = OPTION_TEXT, NEW_AT(path), .what = "new writes one file"},
    OPTION_ROWS(NEW_OPTIONS),
};

static bool new_run(int argc, char **argv, Err *err)
{
    NewOptions options = {.kind = NEW_WORDS[0]};
    return arguments_run(&NEW_ARGUMENTS, argc, argv, &options, write_case, err);
}

const Command cmd_new = {
    .name = "new",
    .summary = "writes a commented case to start from",
    .run = new_run,
    .arguments = &NEW_ARGUMENTS,
};
