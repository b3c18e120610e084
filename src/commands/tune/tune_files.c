// Which files does a search leave behind?
#include "commands/tune/tune_files.h"

#include "cli/long_work.h"
#include "cli/output.h"
#include "cli/written.h"
#include "commands/tune/tune_carriers.h"
#include "commands/tune/tune_gazebo.h"
#include "commands/tune/tune_json.h"
#include "commands/tune/tune_mujoco.h"
#include "commands/tune/tune_text.h"
#include "write/file.h"

#include <stdio.h>

// Appends what a file holds; false where there is nothing to be written or, the error set, nothing
// can be.
typedef bool (*Writer)(const TuneReport *report, Text *text, Err *err);

typedef struct Kind {
    const char *ending;
    FileKind kind;
    const char *nothing; // what is said where there is nothing to write
    Writer write;
} Kind;

static bool write_code(const TuneReport *report, Text *text, Err *err)
{
    const TuneTrial *trial = tune_carriers_trial(report);
    if (trial == NULL) {
        return false;
    }
    if (!scheme_has_step(&report->tune->schemes[trial->scheme].scheme)) {
        // its step is chosen once more, against a truth of its own
        long_work_warn("choosing the step for the code",
                       report->tune->truth.wall_s + trial->run.wall_s, true);
    }
    return tune_carriers_code(report, text, err);
}

static bool write_sdf(const TuneReport *report, Text *text, Err *err)
{
    (void)err;
    tune_gazebo_write(report, text);
    return text->length > 0;
}

static bool write_mjcf(const TuneReport *report, Text *text, Err *err)
{
    (void)err;
    tune_mujoco_write(report, text);
    return text->length > 0;
}

static bool write_text(const TuneReport *report, Text *text, Err *err)
{
    (void)err;
    tune_text_write(report, &STYLE_PLAIN, text);
    output_fold(text, &STYLE_PLAIN);
    return true;
}

enum { CODE, SDF, MJCF, TEXT, KIND_COUNT };

static const Kind KINDS[KIND_COUNT] = {
    [CODE] = {"c", FILE_CODE, "no run has an error that means anything", write_code},
    [SDF] = {"sdf", FILE_SDF, "no contact with constants that was tried is stable", write_sdf},
    [MJCF] = {"xml", FILE_MJCF, "no contact with constants that was tried is stable", write_mjcf},
    [TEXT] = {"txt", FILE_REPORT, "", write_text},
};

static bool write_file(const TuneReport *report, const Kind *kind, const char *path, bool is_quiet,
                       Err *err)
{
    Text text;
    text_init(&text);
    bool is_done = kind->write(report, &text, err);
    if (is_done) {
        is_done = written_text(kind->kind, path, text.data, is_quiet, err);
    } else if (err->kind == ERR_NONE) {
        const bool has_play = scenario_has_clearance(report->scenario);
        if (!is_quiet) {
            output_say("not written: %s (%s)\n", path,
                       has_play ? kind->nothing : "no joint of the case has play");
        }
        is_done = true;
    }
    text_finish(&text);
    return is_done;
}

static bool find_path(const TuneOptions *options, const Scenario *scenario, const char *ending,
                      char path[FILE_PATH_SIZE], Err *err)
{
    char name[SCENARIO_PATH_SIZE];
    file_stem(scenario->path, name, sizeof name);
    const int length =
        snprintf(path, FILE_PATH_SIZE, "%s/%s-tune.%s", options->common.folder, name, ending);
    return (length >= 0 && length < FILE_PATH_SIZE) ||
           err_set(err, ERR_FILE, "the path of %s-tune.%s is too long", name, ending);
}

static bool write_folder(const TuneReport *report, const TuneOptions *options, Err *err)
{
    char path[FILE_PATH_SIZE];
    for (int i = 0; i < KIND_COUNT; i++) {
        if (!find_path(options, report->scenario, KINDS[i].ending, path, err) ||
            !write_file(report, &KINDS[i], path, options->common.is_quiet, err)) {
            return false;
        }
    }
    if (!find_path(options, report->scenario, "json", path, err)) {
        return false;
    }
    json_t *object = tune_json_build(report);
    const bool is_written = written_json(path, object, options->common.is_quiet, err);
    json_decref(object);
    return is_written;
}

bool tune_files_claim(const Scenario *scenario, const TuneOptions *options, Err *err)
{
    if ((options->code != NULL && !file_claim("--code", FILE_CODE, options->code, err)) ||
        (options->sdf != NULL && !file_claim("--sdf", FILE_SDF, options->sdf, err)) ||
        (options->mjcf != NULL && !file_claim("--mjcf", FILE_MJCF, options->mjcf, err))) {
        return false;
    }
    char path[FILE_PATH_SIZE];
    for (int i = 0; options->common.folder != NULL && i < KIND_COUNT; i++) {
        if (!find_path(options, scenario, KINDS[i].ending, path, err) ||
            !file_claim("--out", KINDS[i].kind, path, err)) {
            return false;
        }
    }
    return options->common.folder == NULL || (find_path(options, scenario, "json", path, err) &&
                                              file_claim("--out", FILE_RESULT, path, err));
}

bool tune_files_write(const TuneReport *report, const TuneOptions *options, Err *err)
{
    const bool is_quiet = options->common.is_quiet;
    return (options->code == NULL ||
            write_file(report, &KINDS[CODE], options->code, is_quiet, err)) &&
           (options->sdf == NULL || write_file(report, &KINDS[SDF], options->sdf, is_quiet, err)) &&
           (options->mjcf == NULL ||
            write_file(report, &KINDS[MJCF], options->mjcf, is_quiet, err)) &&
           (options->common.folder == NULL || write_folder(report, options, err));
}
