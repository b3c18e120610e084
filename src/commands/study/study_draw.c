// How does one column of a study look over another?
#include "casefile/source.h"
#include "cli/arguments.h"
#include "cli/option_values.h"
#include "cli/written.h"
#include "commands/study/study_commands.h"
#include "commands/study/study_place.h"
#include "commands/study/study_plot.h"
#include "write/file.h"

#include <string.h>

enum { KEY_X = 0x200, KEY_Y, KEY_BY, KEY_TITLE, KEY_QUIET = 'q' };

typedef struct DrawOptions {
    const char *store;
    const char *file;
    StudyPlot plot;
    bool is_quiet;
} DrawOptions;

static const struct argp_option OPTIONS[] = {
    {"x", KEY_X, "COLUMN", 0, "The column to the right", 1},
    {"y", KEY_Y, "COLUMN", 0, "The column upwards (default: how often each x occurs)", 1},
    {"by", KEY_BY, "COLUMN", 0, "A colour for each value of this setting", 1},
    {"title", KEY_TITLE, "WORDS", 0, "The title of the picture", 1},
    {"quiet", KEY_QUIET, NULL, 0, "Nothing on standard error but errors", 2},
    {0},
};

static bool take_word(DrawOptions *options, const char *word, Err *err)
{
    if (options->file != NULL) {
        return err_set(err, ERR_USAGE, "plot takes a store and a file, and '%s' is one more", word);
    }
    const char **place = options->store == NULL ? &options->store : &options->file;
    *place = word;
    return true;
}

static bool take_option(int key, const char *value, void *target, Err *err)
{
    DrawOptions *options = target;
    switch (key) {
    case KEY_X:
        options->plot.x = value;
        return true;
    case KEY_Y:
        options->plot.y = value;
        return true;
    case KEY_BY:
        options->plot.by = value;
        return true;
    case KEY_TITLE:
        options->plot.title = value;
        return source_is_one_line(value, strlen(value)) ||
               err_set(err, ERR_USAGE, "--title: the argument is not text on one line");
    case KEY_QUIET:
        options->is_quiet = true;
        return true;
    default:
        return take_word(options, value, err);
    }
}

static bool draw(const DrawOptions *options, Err *err)
{
    char path[FILE_PATH_SIZE];
    Store *store = study_place_find(options->store, path, err) ? store_view(path, err) : NULL;
    if (store == NULL) {
        return false;
    }
    Text svg;
    text_init(&svg);
    bool is_drawn = file_claim("the picture", FILE_PICTURE, options->file, err) &&
                    study_plot_write(store, &options->plot, &svg, err);
    is_drawn = store_close(store, err) && is_drawn &&
               written_text(FILE_PICTURE, options->file, svg.data, options->is_quiet, err);
    text_finish(&svg);
    return is_drawn;
}

static bool run(int argc, char **argv, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay study plot",
        .usage = "FILE-or-STORE FILE.svg",
        .doc = "Draws one column of a study over another, as SVG: a dot a run, or where many runs "
               "share each x their median and a band from 5 to 95 %."
               "\vThe first line of 'jointplay study export' names the columns.",
        .options = OPTIONS,
        .take = take_option,
    };
    DrawOptions options = {0};
    bool is_answered;
    if (!arguments_parse(&ARGUMENTS, argc, argv, &options, &is_answered, err) || is_answered) {
        return err->kind == ERR_NONE;
    }
    if (options.file == NULL || options.plot.x == NULL) {
        return err_set(err, ERR_USAGE,
                       "%s: jointplay study plot STORE --x COLUMN --y COLUMN FILE.svg",
                       options.file == NULL ? "a store and a file are needed" : "no --x given");
    }
    return option_values_check_picture("plot", options.file, err) && draw(&options, err);
}

const Command study_command_plot = {
    .name = "plot",
    .summary = "a picture of one column over another",
    .run = run,
};
