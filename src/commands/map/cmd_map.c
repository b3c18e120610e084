// Which ERP, CFM and step for a joint with play, and what do they deliver?
#include "cli/long_work.h"
#include "cli/option_values.h"
#include "cli/output.h"
#include "cli/results.h"
#include "cli/status_line.h"
#include "cli/warnings.h"
#include "commands/commands.h"
#include "commands/map/map_options.h"
#include "commands/map/mapping_inverse.h"
#include "commands/map/mapping_report.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// What is reported during the work.
typedef struct Watching {
    StatusLine line;
    const char *doing; // of a run or of many
} Watching;

static void show(Watching *watching, const char *words)
{
    if (status_line_is_due(&watching->line, status_line_time(&watching->line), INFINITY)) {
        status_line_show(&watching->line, words);
    }
}

// Says it of long work, before it begins.
static void show_plan(double steps, void *context)
{
    // s of a lone pin's step, within a factor of two
    const double step_s = 1.2e-6;
    Watching *watching = context;
    const bool is_warned = long_work_warn("running the settings in ODE", steps * step_s, true);
    watching->line.is_warned = watching->line.is_warned || is_warned;
}

static void show_row(size_t done, size_t total, void *context)
{
    char words[64];
    snprintf(words, sizeof words, "%zu of %zu settings run in ODE", done, total);
    show(context, words);
}

static void show_run(double share, double wall_s, void *context)
{
    (void)wall_s;
    Watching *watching = context;
    char words[96];
    snprintf(words, sizeof words, "%s: %.0f %%", watching->doing, 100.0 * share);
    show(watching, words);
}

static const ResultFile FILES[] = {
    {.ending = ".txt", .kind = FILE_REPORT},
    {"--csv", offsetof(MapOptions, csv), ".csv", FILE_TABLE, .write = mapping_rows_write_csv},
    {"--plot", offsetof(MapOptions, plot), ".svg", FILE_PICTURE, .text = mapping_plot_write},
    {.ending = ".json", .kind = FILE_RESULT},
};

static const Results RESULTS = {
    .suffix = "-map",
    .is_followed = true,
    .json = mapping_json_build,
    .text = mapping_text_write,
    RESULT_FILES(FILES),
};

static const Results INVERSE_RESULTS = {
    .is_followed = true,
    .json = mapping_inverse_json,
    .text = mapping_inverse_text,
};

// The paper's estimate where it was asked for; a word about it where it could be.
static bool make_penalty(const MapOptions *options, const Scenario *scenario, Watching *watching,
                         PenaltyMap **penalty, Err *err)
{
    // where the step is chosen by trials, at the longest of the paper's own order
    const double usual_s = 1e-6;
    const double step_s = options->step_s > 0.0      ? options->step_s
                          : scenario->run.step > 0.0 ? scenario->run.step
                                                     : usual_s;
    watching->doing = "the paper's penalty over its speeds";
    return !options->with_penalty ||
           penalty_map_make(scenario, step_s, (RunWatch){show_run, watching}, penalty, err);
}

// Of a four-bar with the paper's pin, --penalty is mentioned.
static void say_hint(const MapOptions *options, const Scenario *scenario)
{
    PrintedPin pin;
    if (!options->with_penalty && !options->common.is_quiet && scenario->has_fourbar &&
        penalty_map_fits(scenario, &pin)) {
        output_say("--penalty adds the paper's penalty parameter over its 15 speeds\n");
    }
}

static bool map_scenario(const MapOptions *options, const Scenario *scenario,
                         const MappingSettings *settings, Err *err)
{
    const char *path =
        scenario_path(scenario)[0] != '\0' ? scenario_path(scenario) : "lone-contact";
    if (!results_claim(&RESULTS, &options->common, path, err)) {
        return false;
    }
    Watching watching = {status_line_start(options->common.is_quiet), "the reference's run"};
    const MappingWatch watch = {show_plan, show_row, {show_run, &watching}, &watching};
    Mapping mapping = {0};
    PenaltyMap *penalty = NULL;
    bool is_done = mapping_make(scenario, settings, watch, &mapping, err) &&
                   make_penalty(options, scenario, &watching, &penalty, err);
    status_line_end(&watching.line);
    if (is_done) {
        const MappingReport report = {scenario, &mapping, penalty};
        results_print(&RESULTS, &options->common, &report);
        is_done = results_write(&RESULTS, &options->common, path, &report, err);
        say_hint(options, scenario);
    }
    penalty_map_destroy(penalty);
    mapping_finish(&mapping);
    return is_done;
}

// The masses that a row is read on: the one given, else those of the case's joints, else none.
static bool add_masses(const MapOptions *options, const Scenario *scenario, Inverse *inverse,
                       Err *err)
{
    double mass = 0.0;
    if (options->mass != NULL &&
        !option_values_read_quantity("mass", options->mass, DIMENSION_MASS, &mass, err)) {
        return false;
    }
    if (mass > 0.0 || options->common.path == NULL) {
        inverse_add_mass(inverse, "", mass);
        return true;
    }
    if (!scenario_has_clearance(scenario)) {
        return err_set(err, ERR_CASE,
                       "no joint of %s has play, so it has no mass to offer; give "
                       "one, such as --mass '0.1 kg'",
                       scenario_path(scenario));
    }
    MappingJoint *joints = NULL;
    size_t count = 0;
    if (!mapping_joint_measure(scenario, (RunWatch){0}, &joints, &count, err)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        inverse_add_mass(inverse, scenario->linkage.joints[joints[i].joint].name,
                         joints[i].mass_median);
    }
    free(joints);
    return true;
}

static bool read_row(const MapOptions *options, const Scenario *scenario, Err *err)
{
    Inverse *inverse = calloc(1, sizeof *inverse);
    assert(inverse != NULL);
    bool is_read = options->has_kp
                       ? inverse_of_pair(options->kp, options->kd, options->step_s, inverse, err)
                       : inverse_of_row(options->erp, options->cfm, options->step_s, inverse, err);
    is_read = is_read && add_masses(options, scenario, inverse, err);
    if (is_read) {
        results_print(&INVERSE_RESULTS, &options->common, inverse);
    }
    inverse_finish(inverse);
    free(inverse);
    return is_read;
}

// The case, where there is one.
static bool load(const MapOptions *options, Scenario *scenario, Err *err)
{
    const CommonOptions *common = &options->common;
    if (common->path == NULL) {
        return true;
    }
    if (!common_options_load(common, scenario, err)) {
        return false;
    }
    warnings_say(scenario, common);
    return true;
}

static bool map_case(const MapOptions *options, Scenario *scenario, Err *err)
{
    MappingSettings settings;
    return load(options, scenario, err) &&
           map_options_settings(options, scenario, &settings, err) &&
           map_scenario(options, scenario, &settings, err);
}

static bool map_lone(const MapOptions *options, Scenario *scenario, Err *err)
{
    MappingSettings settings;
    return map_lone_make(options, scenario, &settings, err) &&
           map_scenario(options, scenario, &settings, err);
}

static bool do_map(void *target, Err *err)
{
    const MapOptions *options = target;
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    const bool is_done = options->is_inverse
                             ? load(options, scenario, err) && read_row(options, scenario, err)
                         : options->stiffness != NULL ? map_lone(options, scenario, err)
                                                      : map_case(options, scenario, err);
    scenario_destroy(scenario);
    return is_done;
}

static bool map_run(int argc, char **argv, Err *err)
{
    MapOptions options = {0};
    return arguments_run(&MAP_ARGUMENTS, argc, argv, &options, do_map, err);
}

const Command cmd_map = {
    .name = "map",
    .summary = "which ERP, CFM and step for each joint, and what they deliver",
    .run = map_run,
};
