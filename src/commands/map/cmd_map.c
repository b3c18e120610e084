// The command `jointplay map`: its options, the contact they ask for, and its output.
#include "base/shell.h"
#include "casefile/casefile.h"
#include "casefile/quantity.h"
#include "cli/common_options.h"
#include "cli/long_work.h"
#include "cli/option_values.h"
#include "cli/output.h"
#include "cli/results.h"
#include "cli/status_line.h"
#include "cli/warnings.h"
#include "commands/commands.h"
#include "commands/map/map.h"
#include "commands/map/map_settings.h"
#include "contact/law.h"
#include "contact/map_impact.h"
#include "measure/mapping.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct MapOptions {
    CommonOptions common; // without a path where a row alone is to be read
    MapChoices choices;
    const char
        *stiffness; // of a contact without a case, as given, or NULL; likewise the next three
    const char *restitution;
    const char *damping;
    const char *clearance;
    bool with_penalty;
    bool is_inverse;       // ERP and CFM, or kp and kd, are to be read
    bool has_erp, has_cfm; // which of them were given
    bool has_kp, has_kd;   //
    double erp, cfm;       // 1, m/(N s)
    double kp, kd;         // N/m, N s/m
    const char *csv;
    const char *plot;
} MapOptions;

// The options.

// A plain number is in SI.
static bool cmd_map_read_number(const char *name, const char *text, bool *is_given, double *value,
                                Err *err)
{
    Complaint complaint;
    if (!quantity_number(text, value, &complaint)) {
        return err_set(err, ERR_USAGE, "--%s: %s%s%s", name, complaint.text,
                       complaint.allowed[0] != '\0' ? "; allowed: " : "", complaint.allowed);
    }
    *is_given = true;
    return true;
}

static bool read_erp(const char *text, void *target, Err *err)
{
    MapOptions *options = target;
    return cmd_map_read_number("erp", text, &options->has_erp, &options->erp, err);
}

static bool read_cfm(const char *text, void *target, Err *err)
{
    MapOptions *options = target;
    return cmd_map_read_number("cfm", text, &options->has_cfm, &options->cfm, err);
}

static bool read_kp(const char *text, void *target, Err *err)
{
    MapOptions *options = target;
    Complaint complaint;
    double exponent = 1.0;
    if (!quantity_number(text, &options->kp, &complaint) &&
        !quantity_stiffness(text, DIMENSION_STIFFNESS, &options->kp, &exponent, &complaint)) {
        return err_set(err, ERR_USAGE, "--kp: %s; allowed: a stiffness such as 1e7 N/m",
                       complaint.text);
    }
    options->has_kp = true;
    return exponent == 1.0 ||
           err_set(err, ERR_USAGE, "--kp: a row is a linear spring; allowed: N/m or N/mm");
}

static bool read_kd(const char *text, void *target, Err *err)
{
    MapOptions *options = target;
    Complaint complaint;
    if (!quantity_number(text, &options->kd, &complaint) &&
        !quantity_parse(text, DIMENSION_DAMPING, &options->kd, &complaint)) {
        return err_set(err, ERR_USAGE, "--kd: %s; allowed: a damper such as 10 N s/m",
                       complaint.text);
    }
    options->has_kd = true;
    return true;
}

#define AT(field) .offset = offsetof(MapOptions, field)

static const OptionRow MAP_OPTIONS[] = {
    {"steps", "LIST",
     "The steps, such as '10 us, 3 us, 1 us' (default: 30 to 0.1 us and the case's own)", 1,
     OPTION_TEXT, AT(choices.steps)},
    {"at-step", "TIME",
     "A step that cannot be changed: also the best ERP and CFM, and kp and kd, at it", 1,
     OPTION_QUANTITY, AT(choices.at_step_s), .dimension = DIMENSION_TIME},
    {"maps", "LIST", "Only these of textbook, corrected, midpoint, exact, impulse", 1, OPTION_TEXT,
     AT(choices.maps), .words = OPTIONS_ODE_MAPS},
    {"laws", "LIST",
     "These elastic laws in place of the case's, with its damping; 'all' for every one", 1,
     OPTION_TEXT, AT(choices.laws), .words = OPTIONS_LAWS},
    {"mass", "MASS",
     "The effective mass: 'median' (default) or 'most' of the case's run, or such as '0.1 kg'", 1,
     OPTION_TEXT, AT(choices.mass)},
    {"speed", "SPEED",
     "The closing speed: 'median' (default) or 'most' of the case's contacts, or '0.1 m/s'", 1,
     OPTION_TEXT, AT(choices.speed)},
    COMMON_SET(1),
    {"penalty", NULL, "Also the paper's penalty parameter over its 15 speeds, read both ways", 1,
     OPTION_FLAG, AT(with_penalty)},
    {"erp", "X", "With --cfm and --step: which spring and damper is that?", 2, OPTION_READ,
     .read = read_erp},
    {"cfm", "X", "The CFM of --erp, m/(N s)", 2, OPTION_READ, .read = read_cfm},
    {"kp", "K", "With --kd and --step: a spring as Gazebo has it, such as '1e7 N/m'", 2,
     OPTION_READ, .read = read_kp},
    {"kd", "C", "The damper of --kp, such as '10 N s/m'", 2, OPTION_READ, .read = read_kd},
    {"step", "TIME", "The step of --erp or --kp; else the only step of the mapping", 2,
     OPTION_QUANTITY, AT(choices.step_s), .dimension = DIMENSION_TIME},
    {"stiffness", "K",
     "Without a case, with --mass: a lone contact of F = K d^n, such as '1e9 N/m^1.5'", 3,
     OPTION_TEXT, AT(stiffness)},
    {"restitution", "E", "Of --stiffness (default: 0.9)", 3, OPTION_TEXT, AT(restitution)},
    {"damping", "LAW",
     "Of --stiffness: a damping law (default: lankarani-nikravesh), or a damper '10 N s/m'", 3,
     OPTION_TEXT, AT(damping), .words = OPTIONS_DAMPINGS},
    {"clearance", "C", "Of --stiffness: the radial clearance (default: as wide as the steps need)",
     3, OPTION_TEXT, AT(clearance)},
    COMMON_JSON(4),
    COMMON_FULL(4),
    COMMON_WIDE(4),
    {"csv", "FILE.csv", "Write one row per joint, law, map and step", 4, OPTION_TEXT, AT(csv)},
    {"plot", "FILE.svg", "Draw the errors of restitution and peak force", 4, OPTION_PICTURE,
     AT(plot)},
    COMMON_OUT(4, "Write <case>-map.txt, .csv, .svg and .json there"),
    COMMON_QUIET(4),
};
#undef AT

// What reading a row needs, and what it has no use for.
static bool check_inverse(const MapOptions *options, Err *err)
{
    const bool is_row = options->has_erp || options->has_cfm;
    const bool is_pair = options->has_kp || options->has_kd;
    if (is_row && is_pair) {
        return err_set(err, ERR_USAGE, "--erp and --cfm, or --kp and --kd, and not of both");
    }
    if (is_row && !(options->has_erp && options->has_cfm)) {
        return err_set(err, ERR_USAGE, "--erp and --cfm are read together; --%s is missing",
                       options->has_erp ? "cfm" : "erp");
    }
    if (is_pair && !(options->has_kp && options->has_kd)) {
        return err_set(err, ERR_USAGE, "--kp and --kd are read together; --%s is missing",
                       options->has_kp ? "kd" : "kp");
    }
    if (!(options->choices.step_s > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "a row stands for a spring and damper at one step only; "
                       "give it, such as --step '1 ms'");
    }
    if (options->choices.at_step_s > 0.0 || options->choices.steps != NULL ||
        options->choices.maps != NULL || options->choices.laws != NULL ||
        options->choices.speed != NULL || options->stiffness != NULL ||
        options->restitution != NULL || options->damping != NULL || options->clearance != NULL ||
        options->with_penalty || options->csv != NULL || options->plot != NULL ||
        options->common.folder != NULL) {
        return err_set(err, ERR_USAGE,
                       "--%s reads one row: of the other options only --step, --mass, --set, "
                       "--json and --quiet go with it",
                       is_row ? "erp" : "kp");
    }
    return true;
}

static bool refuse_stiffness(const char *stiffness, Err *err)
{
    Text setting;
    Text word;
    text_init(&setting);
    text_init(&word);
    text_append(&setting, "contact.stiffness=%s", stiffness);
    shell_append_word(&word, setting.data);
    err_set(err, ERR_USAGE, "--stiffness is of a contact without a case; of a case: --set %s",
            word.data);
    text_finish(&setting);
    text_finish(&word);
    return false;
}

// What a contact without a case needs, and what goes with nothing else.
static bool check_lone(const MapOptions *options, Err *err)
{
    if (options->stiffness == NULL) {
        return (options->restitution == NULL && options->damping == NULL &&
                options->clearance == NULL) ||
               err_set(err, ERR_USAGE,
                       "--restitution, --damping and --clearance are of a contact without a case, "
                       "with --stiffness; of a case --set replaces them, such as --set "
                       "contact.restitution=0.8");
    }
    if (options->common.path != NULL) {
        return refuse_stiffness(options->stiffness, err);
    }
    if (options->choices.mass == NULL) {
        return err_set(err, ERR_USAGE,
                       "--stiffness needs the effective mass, such as --mass '0.1 kg'");
    }
    return (options->choices.laws == NULL && !options->with_penalty) ||
           err_set(err, ERR_USAGE, "%s needs a case: a stiffness has no pin and hole",
                   options->choices.laws != NULL ? "--laws" : "--penalty");
}

static bool cmd_map_check(void *target, Err *err)
{
    MapOptions *options = target;
    options->is_inverse =
        options->has_erp || options->has_cfm || options->has_kp || options->has_kd;
    if (options->is_inverse) {
        return check_inverse(options, err);
    }
    if (options->choices.at_step_s > 0.0 &&
        (options->choices.steps != NULL || options->choices.step_s > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "--at-step is the only step; it goes with neither --step nor "
                       "--steps");
    }
    if (options->choices.steps != NULL && options->choices.step_s > 0.0) {
        return err_set(err, ERR_USAGE, "--step is one of --steps; give either");
    }
    if (!check_lone(options, err)) {
        return false;
    }
    return options->common.path != NULL || options->stiffness != NULL ||
           err_set(err, ERR_USAGE,
                   "no case given: jointplay map CASE.yaml, or --stiffness K --mass M --step TIME, "
                   "or --erp X --cfm Y --step TIME");
}

static const Arguments MAP_ARGUMENTS = {
    .program = "jointplay map",
    .usage = "CASE\n--stiffness K --mass MASS [--step TIME]\n--erp X --cfm Y --step TIME "
             "[--mass MASS] [CASE]\n"
             "--kp K --kd C --step TIME [--mass MASS] [CASE]",
    .doc = "Finds the ERP, CFM and step to use for each joint with play, and what they deliver, "
           "predicted and measured in ODE; or the spring, damper and restitution that an ERP and a "
           "CFM stand for.",
    .argument = COMMON_PATH("map takes one case"),
    OPTION_ROWS(MAP_OPTIONS),
    .check = cmd_map_check,
};

// The scenario of a contact of which only stiffness, mass and step are known.

enum { OVERRIDE_SIZE = 128, OWN_MOST = 4 };

// of the longer of a step and the contact's depth at its speed: room for flight, contact and flight
static const double ROOM_STEPS = 20.0;
static const double ROOM_DEPTHS = 100.0;

// m/s, where no speed is given: a pin of an ordinary mechanism
static const double USUAL_SPEED = 0.1;

// of the play: no depth is too deep for a contact that has no size
static const double PIN_PLAYS = 10.0;

static const char CASE[] = "title: A lone contact\n"
                           "bodies:\n"
                           "  pin: {mass: 1 kg, inertia: 1 kg m^2, at: [0 mm, 0 mm]}\n"
                           "joints:\n"
                           "  contact: {between: [ground, pin], at: [0 mm, 0 mm], hole: 2 m, "
                           "pin: 1 m, width: 1 m}\n"
                           "contact: {stiffness: 1 N/m, damping: lankarani-nikravesh, "
                           "restitution: 0.9}\n"
                           "run: {duration: 1 s, samples: 2, step: 1 us}\n";

typedef struct Overrides {
    char own[OWN_MOST][OVERRIDE_SIZE];
    const char *list[OPTION_SETTING_MAX + OWN_MOST];
    size_t count;
} Overrides;

static void add_own(Overrides *overrides, const char *key, const char *value)
{
    if (value != NULL) {
        char *own = overrides->own[overrides->count];
        snprintf(own, OVERRIDE_SIZE, "%s=%s", key, value);
        overrides->list[overrides->count++] = own;
    }
}

static bool cmd_map_is_word(const char *text, const char *const *words)
{
    for (size_t i = 0; words[i] != NULL; i++) {
        if (strcmp(text, words[i]) == 0) {
            return true;
        }
    }
    return false;
}

// The options in the words of a case file; --set comes behind them.
static void list_overrides(const MapOptions *options, Overrides *overrides)
{
    add_own(overrides, "contact.stiffness", options->stiffness);
    add_own(overrides, "contact.restitution", options->restitution);
    if (options->damping != NULL && !cmd_map_is_word(options->damping, OPTIONS_DAMPINGS)) {
        add_own(overrides, "contact.damping", "viscous");
        add_own(overrides, "contact.viscous-coefficient", options->damping);
    } else {
        add_own(overrides, "contact.damping", options->damping);
    }
    for (size_t i = 0; i < options->common.override_count; i++) {
        overrides->list[overrides->count++] = options->common.overrides[i];
    }
}

// A hole about the pin: as wide as it was given, else as flight and contact need.
static bool fit_hole(const MapOptions *options, const MappingSettings *settings, Scenario *scenario,
                     Err *err)
{
    Joint *joint = &scenario->linkage.joints[0];
    MapImpactCase impact = {.mass = settings->mass, .speed = settings->speed};
    if (!law_of_joint(scenario, joint, &impact.law, err)) {
        return false;
    }
    // the steps are sorted, the longest first
    const double room = ROOM_STEPS * settings->speed * settings->steps[0] +
                        ROOM_DEPTHS * map_impact_depth(&impact); // m
    double play = room;
    if (options->clearance != NULL && !option_values_read_quantity("clearance", options->clearance,
                                                                   DIMENSION_LENGTH, &play, err)) {
        return false;
    }
    joint->clearance.pin_radius = PIN_PLAYS * fmax(play, room);
    joint->clearance.hole_radius = joint->clearance.pin_radius + play;
    return isfinite(room) || err_set(err, ERR_USAGE,
                                     "--stiffness, --mass, --speed and the steps make a contact "
                                     "whose depth is no finite number");
}

// Makes the scenario of one pin at its wall from the options, with the same words and checks as a
// case file, and puts mass, speed and steps into the settings. Without --clearance the hole is as
// wide as the steps need. Fails with ERR_USAGE.
static bool map_without_case_make(const MapOptions *options, Scenario *scenario,
                                  MappingSettings *settings, Err *err)
{
    Overrides overrides = {.count = 0};
    list_overrides(options, &overrides);
    if (!casefile_load_text("a lone contact", CASE, sizeof CASE - 1, overrides.list,
                            overrides.count, scenario, err)) {
        return false;
    }
    scenario_set_path(scenario, ""); // there is no file
    scenario->run.step = 0.0;        // nor a step but those of the options
    if (!map_settings_read(&options->choices, scenario, settings, err)) {
        return false;
    }
    if (settings->mass_source != MAPPING_GIVEN ||
        (options->choices.speed != NULL && settings->speed_source != MAPPING_GIVEN)) {
        return err_set(err, ERR_USAGE,
                       "a contact without a case has no run to take the %s from; give a quantity, "
                       "such as --%s",
                       settings->mass_source != MAPPING_GIVEN ? "mass" : "speed",
                       settings->mass_source != MAPPING_GIVEN ? "mass '0.1 kg'"
                                                              : "speed '0.1 m/s'");
    }
    if (options->choices.speed == NULL) {
        settings->speed = USUAL_SPEED;
        settings->speed_source = MAPPING_USUAL;
    }
    return fit_hole(options, settings, scenario, err);
}

// What is reported during the work.
typedef struct Watching {
    StatusLine line;
    const char *doing; // of a run or of many
} Watching;

static void cmd_map_show(Watching *watching, const char *words)
{
    if (status_line_is_due(&watching->line, status_line_time(&watching->line), INFINITY)) {
        status_line_show(&watching->line, words);
    }
}

// Says it of long work, before it begins.
static void show_plan(double steps, void *context)
{
    // s of a single pin's step, within a factor of two
    const double step_s = 1.2e-6;
    Watching *watching = context;
    const bool is_warned = long_work_warn("running the settings in ODE", steps * step_s, true);
    watching->line.is_warned = watching->line.is_warned || is_warned;
}

static void show_row(size_t done, size_t total, void *context)
{
    char words[64];
    snprintf(words, sizeof words, "%zu of %zu settings run in ODE", done, total);
    cmd_map_show(context, words);
}

static void show_run(double share, double wall_s, void *context)
{
    (void)wall_s;
    Watching *watching = context;
    char words[96];
    snprintf(words, sizeof words, "%s: %.0f %%", watching->doing, 100.0 * share);
    cmd_map_show(watching, words);
}

static const ResultFile MAP_FILES[] = {
    {.ending = ".txt", .kind = FILE_REPORT},
    {"--csv", offsetof(MapOptions, csv), ".csv", FILE_TABLE, .write = mapping_rows_write_csv},
    {"--plot", offsetof(MapOptions, plot), ".svg", FILE_PICTURE, .text = mapping_plot_write},
    {.ending = ".json", .kind = FILE_RESULT},
};

static const Results MAP_RESULTS = {
    .suffix = "-map",
    .is_followed = true,
    .json = mapping_json_build,
    .text = mapping_text_write,
    .screen = mapping_screen_write,
    RESULT_FILES(MAP_FILES),
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
    const double step_s = options->choices.step_s > 0.0 ? options->choices.step_s
                          : scenario->run.step > 0.0    ? scenario->run.step
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
    if (!results_claim(&MAP_RESULTS, &options->common, path, err)) {
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
        results_print(&MAP_RESULTS, &options->common, &report);
        is_done = results_write(&MAP_RESULTS, &options->common, path, &report, err);
        say_hint(options, scenario);
    }
    penalty_map_destroy(penalty);
    mapping_finish(&mapping);
    return is_done;
}

// The masses that a row is read on: the one given, else those of the case's joints, else none.
static bool cmd_map_add_masses(const MapOptions *options, const Scenario *scenario,
                               Inverse *inverse, Err *err)
{
    double mass = 0.0;
    if (options->choices.mass != NULL &&
        !option_values_read_quantity("mass", options->choices.mass, DIMENSION_MASS, &mass, err)) {
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

static bool cmd_map_read_row(const MapOptions *options, const Scenario *scenario, Err *err)
{
    Inverse *inverse = calloc(1, sizeof *inverse);
    assert(inverse != NULL);
    bool is_read =
        options->has_kp
            ? inverse_of_pair(options->kp, options->kd, options->choices.step_s, inverse, err)
            : inverse_of_row(options->erp, options->cfm, options->choices.step_s, inverse, err);
    is_read = is_read && cmd_map_add_masses(options, scenario, inverse, err);
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
           map_settings_read(&options->choices, scenario, &settings, err) &&
           map_scenario(options, scenario, &settings, err);
}

static bool map_without_case(const MapOptions *options, Scenario *scenario, Err *err)
{
    MappingSettings settings;
    return map_without_case_make(options, scenario, &settings, err) &&
           map_scenario(options, scenario, &settings, err);
}

static bool do_map(void *target, Err *err)
{
    const MapOptions *options = target;
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    const bool is_done = options->is_inverse ? load(options, scenario, err) &&
                                                   cmd_map_read_row(options, scenario, err)
                         : options->stiffness != NULL ? map_without_case(options, scenario, err)
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
    .arguments = &MAP_ARGUMENTS,
};
