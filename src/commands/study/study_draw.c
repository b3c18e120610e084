// How does one column of a study look over another?
#include "casefile/source.h"
#include "cli/arguments.h"
#include "cli/option_values.h"
#include "cli/written.h"
#include "commands/study/study_commands.h"
#include "commands/study/study_path.h"
#include "commands/study/study_plot.h"
#include "write/file.h"

#include <string.h>

typedef struct DrawOptions {
    const char *store;
    const char *file;
    StudyPlot plot;
    bool is_quiet;
} DrawOptions;

static bool read_word(const char *word, void *target, Err *err)
{
    DrawOptions *options = target;
    if (options->file != NULL) {
        return err_set(err, ERR_USAGE, "plot takes a store and a file, and '%s' is one more", word);
    }
    *(options->store == NULL ? &options->store : &options->file) = word;
    return true;
}

static bool read_title(const char *title, void *options, Err *err)
{
    ((DrawOptions *)options)->plot.title = title;
    return source_is_one_line(title, strlen(title)) ||
           err_set(err, ERR_USAGE, "--title: the argument is not text on one line");
}

#define AT(field) .offset = offsetof(DrawOptions, field)

static const OptionRow OPTIONS[] = {
    {"x", "COLUMN", "The column of the horizontal axis", 1, OPTION_TEXT, AT(plot.x)},
    {"y", "COLUMN", "The column of the vertical axis (default: how often each x occurs)", 1,
     OPTION_TEXT, AT(plot.y)},
    {"by", "COLUMN", "A colour for each value of this setting", 1, OPTION_TEXT, AT(plot.by)},
    {"title", "WORDS", "The title of the picture", 1, OPTION_READ, .read = read_title},
    {"quiet", NULL, "Nothing on standard error but errors", 2, OPTION_FLAG, AT(is_quiet),
     .letter = 'q'},
};

static bool check(void *target, Err *err)
{
    const DrawOptions *options = target;
    if (options->file == NULL || options->plot.x == NULL) {
        return err_set(err, ERR_USAGE,
                       "%s: jointplay study plot STORE --x COLUMN --y COLUMN FILE.svg",
                       options->file == NULL ? "a store and a file are needed" : "no --x given");
    }
    return option_values_check_picture("plot", options->file, err);
}

static bool draw(void *target, Err *err)
{
    const DrawOptions *options = target;
    char path[FILE_PATH_SIZE];
    Store *store = study_path_find(options->store, path, err) ? store_view(path, err) : NULL;
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
        .doc = "Draws one column of a study over another, as SVG: one dot per run, or, if many "
               "runs share each x, their median and a band from 5 to 95 %."
               "\vThe first line of 'jointplay study export' names the columns.",
        .argument = {.type = OPTION_READ, .read = read_word},
        OPTION_ROWS(OPTIONS),
        .check = check,
    };
    DrawOptions options = {0};
    return arguments_run(&ARGUMENTS, argc, argv, &options, draw, err);
}

const Command study_command_plot = {
    .name = "plot",
    .summary = "a picture of one column over another",
    .run = run,
};
