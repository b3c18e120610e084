// Says of each file that hands on a setting what it is worth, and by how much it misses the target.
#include "commands/tune/tune_files.h"
#include "commands/tune/tune_export.h"
#include "commands/tune/tune_linear.h"
#include "write/table.h"
#include "write/units.h"

#include <math.h>

static TuneFile of_program(const TuneReport *report)
{
    const TuneProgram *program = &report->tune->program;
    return (TuneFile){
        .is_there = program->is_run,
        .option = "--code",
        .measure = "run with libjointplay",
        .error = program->error,
        .reason = program->reason,
        .step_s = program->step_s,
        .steps = program->steps,
        .processor_s = program->processor_s,
    };
}

// Constants, run in ODE with the textbook map, as Gazebo runs them.
static TuneFile of_constants(const TuneReport *report, const char *option, const char *measure)
{
    const Tune *tune = report->tune;
    TuneFile file = {.option = option, .measure = measure, .error = NAN, .reason = ""};
    if (tune->linear != TUNE_NONE) {
        const TuneLinear *linear = &tune->linears[tune->linear];
        file.is_there = true;
        file.error = linear->error;
        file.reason = linear->reason;
        file.step_s = linear->step_s;
        file.steps = linear->run.steps;
        file.processor_s = linear->run.processor_s;
    }
    return file;
}

static TuneFile of_model(const TuneReport *report)
{
    const TuneModel *model = &report->tune->model;
    TuneMujoco mujoco;
    if (model->text == NULL) {
        TuneFile file = of_constants(report, "--mjcf", "these constants in ODE; not run in MuJoCo");
        file.is_there = file.is_there && tune_mujoco_find(report, &mujoco);
        return file;
    }
    return (TuneFile){
        .is_there = true,
        .option = "--mjcf",
        .measure = "the whole model, run in MuJoCo",
        .error = model->error,
        .reason = model->reason,
        .step_s = model->step_s,
        .steps = model->steps,
        .processor_s = model->processor_s,
    };
}

static TuneFile find_file(const TuneReport *report, TuneFileKind kind)
{
    switch (kind) {
    case TUNE_FILE_CODE:
        return of_program(report);
    case TUNE_FILE_SDF:
        return of_constants(report, "--sdf", "run in ODE as Gazebo does");
    case TUNE_FILE_MJCF:
        return of_model(report);
    case TUNE_FILE_COUNT:
        break;
    }
    return (TuneFile){.error = NAN};
}

TuneFile tune_file(const TuneReport *report, TuneFileKind kind)
{
    const Tune *tune = report->tune;
    TuneFile file = find_file(report, kind);
    file.meets = isfinite(file.error) && file.error + tune->truth.uncertainty <= tune->target;
    return file;
}

// That a file misses the target, and by how much.
static void append_miss(const TuneReport *report, const TuneFile *file, Text *text)
{
    const double target = report->tune->target;
    if (isnan(file->error)) {
        text_append(text, "at a step of %.4g us it %s", file->step_s * UNITS_US, file->reason);
        return;
    }
    text_append(text, "it has an error of %.3g at a step of %.4g us, %.3g times the %.3g asked for",
                file->error, file->step_s * UNITS_US, file->error / target, target);
}

bool tune_file_is_wanted(const TuneReport *report, TuneFileKind kind, Text *reason)
{
    const Tune *tune = report->tune;
    const TuneFile file = tune_file(report, kind);
    const bool misses = file.is_there && isfinite(tune->target) && !file.meets;
    // of a program the nearest is of use only where nothing met the target
    const bool is_code = kind == TUNE_FILE_CODE;
    const bool is_wanted = is_code ? !isnan(file.error) && !(misses && tune_report_is_met(report))
                                   : !(misses && tune->asked[kind] == TUNE_IN_FOLDER);
    if (!is_wanted) {
        append_miss(report, &file, reason);
        if (!is_code) {
            text_append(reason, "; %s FILE writes it all the same", file.option);
        }
    }
    return is_wanted;
}

static void tune_files_write_line(const TuneReport *report, const TuneFile *file, Text *text)
{
    Text words;
    text_init(&words);
    text_append(&words, "  %s: ", file->option);
    if (isnan(file->error)) {
        text_append(&words, "NOT WRITTEN; at a step of %.4g us it %s.", file->step_s * UNITS_US,
                    file->reason);
    } else {
        text_append(&words, "step %.4g us, error %.3g, %zu steps, %.4g ms; %s.",
                    file->step_s * UNITS_US, file->error, file->steps, file->processor_s * UNITS_MS,
                    file->measure);
    }
    if (isfinite(file->error) && isfinite(report->tune->target) && !file->meets) {
        text_append(&words, " MISSES %.3g by %.3g times.", report->tune->target,
                    file->error / report->tune->target);
    }
    screen_line(&words, text);
}

void tune_files_write(const TuneReport *report, Text *text)
{
    for (int kind = 0; kind < TUNE_FILE_COUNT; kind++) {
        const TuneFile file = tune_file(report, (TuneFileKind)kind);
        if (report->tune->asked[kind] != TUNE_UNASKED && file.is_there) {
            tune_files_write_line(report, &file, text);
        }
    }
}

bool tune_files_check(const TuneReport *report, Err *err)
{
    const Tune *tune = report->tune;
    Text words;
    text_init(&words);
    for (int kind = 0; kind < TUNE_FILE_COUNT; kind++) {
        const TuneFile file = tune_file(report, (TuneFileKind)kind);
        // a program that misses it is not written, and that says why
        const bool is_written = tune->asked[kind] == TUNE_NAMED && kind != TUNE_FILE_CODE;
        if (is_written && file.is_there && isfinite(tune->target) && !file.meets) {
            text_append(&words, "%sthe file of %s misses the error: ", words.length > 0 ? "\n" : "",
                        file.option);
            append_miss(report, &file, &words);
        }
    }
    const bool is_good = words.length == 0;
    if (!is_good) {
        err_set_lines(err, ERR_DIFFERS, words.data);
    }
    text_finish(&words);
    return is_good;
}
