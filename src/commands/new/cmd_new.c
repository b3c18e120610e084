// The command `jointplay new`: writes a commented case to start from.
//
// Each kind is a file of this folder that stands in the program, and is written as it is. A model
// of a robot is read by MuJoCo's driver and becomes a case of its own, which is read before it is
// written. Nothing is written over a file that is there unless --force is given, and then only over
// one that this command wrote.
#include "casefile/casefile.h"
#include "cli/arguments.h"
#include "cli/written.h"
#include "commands/commands.h"
#include "commands/new/new_robot.h"

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
    "file. With --from the case is the mechanism of a robot's model, in FILE.yaml or one named "
    "like "
    "the model."
    "\vKinds:" NEW_KIND_LIST(LINE);
#undef LINE

typedef struct NewOptions {
    const char *path; // NULL: <kind>.yaml
    const char *kind; // NULL: the first
    const char *from; // NULL: no model
    bool is_forced;
    bool is_quiet;
} NewOptions;

#define NEW_AT(field) .offset = offsetof(NewOptions, field)

static const OptionRow NEW_OPTIONS[] = {
    {"kind", "KIND", "Which mechanism (default: four-bar)", 1, OPTION_CHOICE, NEW_AT(kind),
     .words = NEW_WORDS},
    {"from", "MODEL", "The mechanism of a model in MJCF or URDF, read by MuJoCo, as a case", 1,
     OPTION_TEXT, NEW_AT(from)},
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

// The name of a model's file without its folder.
static const char *new_base(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

// The file that is written: the one that is named, or one of the kind's or the model's name.
static bool find_path(const NewOptions *options, char path[FILE_PATH_SIZE], Err *err)
{
    const char *stem = options->from != NULL ? new_base(options->from) : options->kind;
    const char *dot = options->from != NULL ? strrchr(stem, '.') : NULL;
    const int kept = dot != NULL && dot > stem ? (int)(dot - stem) : (int)strlen(stem);
    const int length = options->path != NULL
                           ? snprintf(path, FILE_PATH_SIZE, "%s", options->path)
                           : snprintf(path, FILE_PATH_SIZE, "%.*s.yaml", kept, stem);
    return length < FILE_PATH_SIZE || err_set(err, ERR_FILE, "the path of the case is too long");
}

// Whether the text is a case, as it must be. What is wrong stands at a line that nobody has seen.
static bool check_case(const char *model, const Text *text, Err *err)
{
    static const char NAME[] = "case:";
    Scenario scenario;
    Err own = {0};
    if (!casefile_load_text("case", text->data, text->length, NULL, 0, &scenario, &own)) {
        const char *words = own.text;
        words += strncmp(words, NAME, sizeof NAME - 1) == 0 ? sizeof NAME - 1 : 0;
        words += strspn(words, "0123456789: ");
        return err_set(err, ERR_CASE, "%s cannot be carried by a case: %.*s", model,
                       (int)strcspn(words, "\n"), words);
    }
    scenario_free(&scenario);
    return true;
}

// The case of a model, and the sentences on what it lacks.
static bool text_of_model(const NewOptions *options, Text *text, Err *err)
{
    EngineDriver driver;
    Robot robot;
    RobotCase of = {.note_count = 0};
    Err own = {0};
    if (!engine_find("mujoco", &driver, &own)) {
        return own.kind != ERR_USAGE
                   ? err_set(err, own.kind, "%s", own.text)
                   : err_set(err, ERR_USAGE,
                             "--from reads models by MuJoCo, whose driver is not here: build "
                             "jointplay where MuJoCo is installed ('./bootstrap packages engines' "
                             "does that)");
    }
    if (!robot_read(&driver, options->from, &robot, err)) {
        return false;
    }
    bool is_made = robot_case_make(&robot, &of, &own);
    if (is_made) {
        robot_case_write(&of, new_base(options->from), text);
        is_made = check_case(options->from, text, err);
    } else {
        err_set(err, own.kind, "%s: %s", options->from, own.text);
    }
    for (size_t i = 0; is_made && !options->is_quiet && i < of.note_count; i++) {
        fprintf(stderr, "left out: %s\n", of.notes[i]);
    }
    robot_case_finish(&of);
    robot_finish(&robot);
    return is_made;
}

static bool write_case(void *target, Err *err)
{
    NewOptions *options = target;
    char path[FILE_PATH_SIZE];
    if (options->from != NULL && options->kind != NULL) {
        return err_set(err, ERR_USAGE, "--from and --kind are two ways to begin: give one of them");
    }
    options->kind = options->kind != NULL ? options->kind : NEW_WORDS[0];
    if (!find_path(options, path, err) || !check_free(options, path, err) ||
        !file_claim("the case", FILE_CASE, path, err)) {
        return false;
    }
    Text text;
    text_init(&text);
    bool is_written = true;
    if (options->from != NULL) {
        is_written = text_of_model(options, &text, err);
    } else {
        text_append(&text, "%s", new_text(options->kind));
    }
    is_written = is_written && written_text(FILE_CASE, path, text.data, options->is_quiet, err);
    text_finish(&text);
    return is_written;
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
    NewOptions options = {.kind = NULL};
    return arguments_run(&NEW_ARGUMENTS, argc, argv, &options, write_case, err);
}

const Command cmd_new = {
    .name = "new",
    .summary = "writes a commented case to start from",
    .run = new_run,
    .arguments = &NEW_ARGUMENTS,
};
