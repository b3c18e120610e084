// Makes the runs of a study that are missing in its store.
#include "base/clock.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/status_line.h"
#include "commands/study/indices.h"
#include "commands/study/metrics.h"
#include "commands/study/study.h"
#include "version.h"
#include "write/settings_json.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { PRINT_SIZE = 17, UNUSED_LOOKS = 64 };

// How far it has come, and how long the rest will take.
static void show_progress(const SweepState *state, void *line)
{
    const double rate = (double)state->made / state->wall_s;
    const double left_s = state->made > 0 ? (double)(state->total - state->done) / rate : INFINITY;
    if (!status_line_is_due(line, state->wall_s, left_s)) {
        return;
    }
    Text words;
    text_init(&words);
    text_append(&words, "%" PRIu64 " of %" PRIu64 " runs", state->done, state->total);
    if (state->failed > 0) {
        text_append(&words, ", %" PRIu64 " failed", state->failed);
    }
    if (state->made > 0) {
        text_append(&words, ", %.3g runs/s", rate);
        status_line_append_left(&words, left_s);
    }
    status_line_show(line, words.data);
    text_finish(&words);
}

static bool study_run_should_stop(void *line)
{
    (void)line;
    return interrupt_number() != 0;
}

// The columns are those of the case as the study's first run has it.
static bool find_layout(const Spec *spec, Layout *layout, Err *err)
{
    Cell values[RECORD_SETTING_MAX];
    BackendKind backend;
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    // where its values make no case, that of the file has the same bodies and joints
    Err first = {0};
    design_values(spec, 0, values);
    const bool is_found =
        (design_scenario(spec, values, scenario, &backend, &first) ||
         casefile_load_text(spec->case_path, spec->case_text, spec->case_size,
                            (const char *const *)spec->set, spec->set_count, scenario, err)) &&
        metrics_fit(scenario, err);
    if (is_found) {
        metrics_layout(spec, scenario, layout);
    }
    scenario_destroy(scenario);
    return is_found;
}

// What one cannot see in the store: how this went.
static void append_effort(const StudyReport *report, Text *text)
{
    const SweepState *state = &report->state;
    if (state->made == 0) {
        text_append(text, "\nNothing was left to run; the runs are kept in ");
        text_append_shown(text, report->store);
        text_append(text, ".\n");
        return;
    }
    text_append(text,
                "\nMade %" PRIu64 " runs in %.4g s, %zu at a time; %.1f %% of that time was spent "
                "inside runs.\nThey are kept in ",
                state->made, state->wall_s, report->jobs, 100.0 * report->inside_share);
    text_append_shown(text, report->store);
    text_append(text, ".\n");
    if (state->without_truth > 0) {
        text_append(text,
                    "%" PRIu64 " of them have no error, because there is no reference to "
                    "compare them with: %s.\n",
                    state->without_truth, state->no_truth);
    }
}

static bool print_text(const StudyReport *report, Store *store, const CommonOptions *options,
                       Err *err)
{
    const Style style = output_style(stdout, options->is_wide);
    const StudyPart part = {report->store, store, report->state.total};
    Text text;
    text_init(&text);
    bool is_written = study_text_status(&part, 1, "", &style, &text, err);
    if (is_written) {
        append_effort(report, &text);
        is_written = study_text_summary(store, options->is_full, &style, &text, err) &&
                     indices_text(report->spec, store, &style, &text, err);
    }
    if (is_written) {
        output_text(&text, &style);
    }
    text_finish(&text);
    return is_written;
}

static bool print_report(StudyReport *report, const CommonOptions *options, Err *err)
{
    Store *store = store_view(report->store, err);
    bool is_printed = store != NULL && store_count(store, &report->count, err);
    if (is_printed && options->is_json) {
        json_t *object = study_json_build(report);
        is_printed = indices_json(report->spec, store, object, err);
        output_json(object);
    } else {
        is_printed = is_printed && print_text(report, store, options, err);
    }
    return store_close(store, err) && is_printed;
}

static bool check_runs(const StudyReport *report, Err *err)
{
    return report->count.rows == 0 || report->count.outcomes[RUN_OUTCOME_OK] > 0 ||
           err_set(err, ERR_SOLVER, "every run of %s failed",
                   report->shard.count > 1 ? "this part" : "the study");
}

static bool prepare_store(const StudyOptions *options, Store *store, Err *err)
{
    uint64_t forgotten = 0;
    if (options->is_retrying && !store_forget_failed(store, &forgotten, err)) {
        return false;
    }
    if (options->is_retrying && !options->common.is_quiet) {
        output_say("making %" PRIu64 " failed or damaged runs again\n", forgotten);
    }
    return true;
}

// Opens the store by what makes its rows those of one study and one program, so that results never
// mix. The machine is no part of it, for shards are made on many; nor are the limits, which decide
// whether a run comes to its end, and not to which.
static Store *open_store(const StudyOptions *options, const Spec *spec, const Layout *layout,
                         Err *err)
{
    char print[PRINT_SIZE];
    char build[BUILD_PRINT_SIZE];
    snprintf(print, sizeof print, "%016" PRIx64, spec->print);
    build_print(build);
    const StoreHead head = {
        .layout = layout,
        .run_count = design_run_count(spec),
        .key_count = 4,
        .keys = {{"study", print, "the study file or its case has changed"},
                 {"program", JOINTPLAY_VERSION, "another version of jointplay made it"},
                 {"ode", JOINTPLAY_ODE_VERSION, "it was made with another version of ODE"},
                 {"build", build, "another build of jointplay made it"}},
    };
    return store_open(options->store, &head, options->is_fresh, err);
}

// Makes what is missing. The store is closed in any case, with what was made in it.
static bool sweep(const StudyOptions *options, const Spec *spec, const Layout *layout,
                  SweepEnd *end, SweepState *state, Err *err)
{
    StatusLine line = status_line_start(options->common.is_quiet);
    const Sweep order = {
        .spec = spec,
        .layout = layout,
        .shard = options->shard,
        .jobs = options->common.jobs,
        .store = open_store(options, spec, layout, err),
        .report = show_progress,
        .should_stop = study_run_should_stop,
        .context = &line,
    };
    if (order.store == NULL) {
        return false;
    }
    interrupt_watch();
    const bool is_swept =
        prepare_store(options, order.store, err) && sweep_execute(&order, end, state, err);
    status_line_end(&line);
    return store_close(order.store, err) && is_swept;
}

// How long a study is tried for, s, and how long its first run is waited for.
static const double PACE_S = 3.0;
static const double PACE_MOST_S = 20.0;

static void take_pace(const SweepState *state, void *pace)
{
    StudyPace *known = pace;
    known->made = state->made;
    known->wall_s = state->wall_s;
}

static bool is_pace_known(void *context)
{
    const StudyPace *pace = context;
    // the first run of a block settles all of it
    return interrupt_number() != 0 || pace->wall_s > PACE_MOST_S ||
           (pace->made >= pace->least && pace->wall_s > PACE_S);
}

StudyPace study_run_pace(const StudyOptions *options, const Spec *spec, const Layout *layout)
{
    const uint64_t blocks = spec->has_neighbours ? design_block_size(spec) : 1;
    StudyPace pace = {.made = 0, .least = blocks > 1 ? options->common.jobs * blocks : 1};
    const char *temporary = getenv("TMPDIR");
    char folder[FILE_PATH_SIZE / 2];
    snprintf(folder, sizeof folder, "%s/jointplay-XXXXXX", temporary != NULL ? temporary : "/tmp");
    if (mkdtemp(folder) == NULL) {
        return pace;
    }
    StudyOptions *trial = malloc(sizeof *trial);
    assert(trial != NULL);
    *trial = *options;
    snprintf(trial->store, sizeof trial->store, "%s/pace.sqlite", folder);
    Err err = {0};
    const Sweep order = {
        .spec = spec,
        .layout = layout,
        .shard = options->shard,
        .jobs = options->common.jobs,
        .store = open_store(trial, spec, layout, &err),
        .report = take_pace,
        .should_stop = is_pace_known,
        .context = &pace,
    };
    SweepEnd end;
    SweepState state = {.made = 0};
    if (order.store != NULL) {
        interrupt_watch();
        if (sweep_execute(&order, &end, &state, &err)) {
            take_pace(&state, &pace);
        }
        store_close(order.store, &err);
        unlink(trial->store);
    }
    free(trial);
    rmdir(folder);
    return pace;
}

static double cpu_time(int who)
{
    struct rusage usage;
    getrusage(who, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static bool study_run_make_runs(const StudyOptions *options, const Spec *spec, const Layout *layout,
                                Err *err)
{
    StudyReport report = {.spec = spec,
                          .store = options->store,
                          .shard = options->shard,
                          .jobs = options->common.jobs};
    SweepEnd end;
    if (!file_claim("--store", FILE_STORE, options->store, err) ||
        !sweep(options, spec, layout, &end, &report.state, err)) {
        return false;
    }
    if (end == SWEEP_STOPPED) {
        if (!options->common.is_quiet) {
            output_say("stopped; %" PRIu64 " of %" PRIu64 " runs are kept in %s, and the same "
                       "command%s%s goes on from there\n",
                       report.state.done, report.state.total, options->store,
                       options->is_fresh ? " without --fresh" : "",
                       !options->is_retrying ? ""
                       : options->is_fresh   ? " and --retry-failed"
                                             : " without --retry-failed");
        }
        interrupt_obey();
        return true;
    }
    report.children_cpu_s = cpu_time(RUSAGE_CHILDREN);
    report.own_cpu_s = cpu_time(RUSAGE_SELF);
    const double offered_s = (double)report.jobs * report.state.wall_s;
    report.inside_share =
        report.state.made > 0 && offered_s > 0.0 ? report.state.inside_s / offered_s : NAN;
    return print_report(&report, &options->common, err) && check_runs(&report, err);
}

// Leaves of some lines those that are among others too.
static void keep_shared(Text *lines, const char *others)
{
    Text shared;
    text_init(&shared);
    for (const char *line = lines->data; *line != '\0';) {
        const size_t size = strcspn(line, "\n") + 1;
        for (const char *other = others; *other != '\0'; other = strchr(other, '\n') + 1) {
            if (strncmp(other, line, size) == 0) {
                text_append_bytes(&shared, line, size);
                break;
            }
        }
        line += size;
    }
    text_finish(lines);
    *lines = shared;
}

// Says one line of casefile_unused in words of a study.
static void say_unused_key(const char *line)
{
    static const char HERE[] = " has no effect here";
    static const char SET[] = " of the command line";
    const char *here = strstr(line, HERE);
    const char *set = strstr(line, SET);
    const bool is_set = set != NULL && set < here;
    const char *rest = here + strlen(HERE);
    output_say("jointplay: warning: %.*s%s has no effect in any run%.*s\n",
               (int)((is_set ? set : here) - line), line, is_set ? " of the study" : "",
               (int)strcspn(rest, "\n"), rest);
}

// Says which keys of the case and the study change none of the runs, of which so many are looked
// at, evenly over all.
static void study_run_say_unused(const Spec *spec)
{
    const uint64_t count = design_run_count(spec);
    const uint64_t looks = count < UNUSED_LOOKS ? count : UNUSED_LOOKS;
    Text unused;
    bool is_first = true;
    text_init(&unused);
    for (uint64_t i = 0; i < looks && (is_first || unused.length > 0); i++) {
        // the last one too: what varies fastest has moved between any two
        const uint64_t run =
            looks > 1 ? (uint64_t)((double)i * (double)(count - 1) / (double)(looks - 1)) : 0;
        Cell values[RECORD_SETTING_MAX];
        Scenario scenario;
        BackendKind backend;
        Err err = {0};
        design_values(spec, run, values);
        if (!design_scenario(spec, values, &scenario, &backend, &err)) {
            continue;
        }
        Text lines;
        text_init(&lines);
        casefile_unused(&scenario, false, &lines);
        if (is_first) {
            text_append(&unused, "%s", lines.data);
            is_first = false;
        } else {
            keep_shared(&unused, lines.data);
        }
        text_finish(&lines);
        scenario_free(&scenario);
    }
    for (const char *line = unused.data; *line != '\0'; line = strchr(line, '\n') + 1) {
        say_unused_key(line);
    }
    text_finish(&unused);
}

bool study_run(void *target, Err *err)
{
    const StudyOptions *options = target;
    const CommonOptions *common = &options->common;
    for (size_t i = 0; i < common->driver_count; i++) {
        BackendKind backend;
        if (!common_options_driver(common->drivers[i], &backend, err)) {
            return false;
        }
    }
    Spec *spec = spec_open(common->path, err);
    if (spec != NULL) {
        spec->drivers = common->drivers;
        spec->driver_count = common->driver_count;
    }
    Layout *layout = calloc(1, sizeof *layout);
    assert(layout != NULL);
    if (spec != NULL && !common->is_quiet) {
        study_run_say_unused(spec);
    }
    const bool is_done = spec != NULL && find_layout(spec, layout, err) &&
                         (options->is_dry ? study_run_dry(options, spec, layout, err)
                                          : study_run_make_runs(options, spec, layout, err));
    spec_close(spec);
    free(layout);
    return is_done;
}
