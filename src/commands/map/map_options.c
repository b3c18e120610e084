// What was `jointplay map` asked for?
#include "commands/map/map_options.h"

#include "base/shell.h"
#include "casefile/quantity.h"
#include "cli/arguments.h"

#include <stdio.h>
#include <string.h>

enum {
    KEY_STEPS = 0x200, // options without a letter of their own
    KEY_MAPS,
    KEY_LAWS,
    KEY_MASS,
    KEY_SPEED,
    KEY_STIFFNESS,
    KEY_RESTITUTION,
    KEY_DAMPING,
    KEY_CLEARANCE,
    KEY_PENALTY,
    KEY_ERP,
    KEY_CFM,
    KEY_KP,
    KEY_KD,
    KEY_STEP,
    KEY_AT_STEP,
    KEY_CSV,
    KEY_PLOT,
};

static const struct argp_option OPTIONS[] = {
    {"steps", KEY_STEPS, "LIST", 0,
     "The steps, such as '10 us, 3 us, 1 us' (default: 30 to 0.1 us and the case's own)", 1},
    {"at-step", KEY_AT_STEP, "TIME", 0,
     "Held to this step: also the best constants there, ERP and CFM, and Gazebo's kp and kd", 1},
    {"maps", KEY_MAPS, "LIST", 0, "Only these of textbook, corrected, midpoint, exact, impulse", 1},
    {"laws", KEY_LAWS, "LIST", 0,
     "These elastic laws in place of the case's, with its damping; 'all' for every one", 1},
    {"mass", KEY_MASS, "MASS", 0,
     "The effective mass: 'median' (default) or 'most' of the case's run, or such as '0.1 kg'", 1},
    {"speed", KEY_SPEED, "SPEED", 0,
     "The closing speed: 'median' (default) or 'most' of the case's contacts, or '0.1 m/s'", 1},
    COMMON_ROW_SET(1),
    {"penalty", KEY_PENALTY, NULL, 0,
     "Also the paper's penalty parameter over its 15 speeds, read both ways", 1},
    {"erp", KEY_ERP, "X", 0, "With --cfm and --step: which spring and damper is that?", 2},
    {"cfm", KEY_CFM, "X", 0, "The CFM of --erp, m/(N s)", 2},
    {"kp", KEY_KP, "K", 0, "With --kd and --step: a spring as Gazebo has it, such as '1e7 N/m'", 2},
    {"kd", KEY_KD, "C", 0, "The damper of --kp, such as '10 N s/m'", 2},
    {"step", KEY_STEP, "TIME", 0, "The step of --erp or --kp; else the only step of the mapping",
     2},
    {"stiffness", KEY_STIFFNESS, "K", 0,
     "Without a case, with --mass: a lone contact of F = K d^n, such as '1e9 N/m^1.5'", 3},
    {"restitution", KEY_RESTITUTION, "E", 0, "Of --stiffness (default: 0.9)", 3},
    {"damping", KEY_DAMPING, "LAW", 0,
     "Of --stiffness: a damping law (default: lankarani-nikravesh), or a damper '10 N s/m'", 3},
    {"clearance", KEY_CLEARANCE, "C", 0,
     "Of --stiffness: the radial clearance (default: as wide as the steps need)", 3},
    COMMON_ROW_JSON(4),
    COMMON_ROW_WIDE(4),
    {"csv", KEY_CSV, "FILE.csv", 0, "Write a row a joint, law, map and step", 4},
    {"plot", KEY_PLOT, "FILE.svg", 0, "Draw the errors of restitution and peak force", 4},
    {"out", COMMON_OUT, "DIR", 0, "Write <case>-map.txt, .csv, .svg and .json there", 4},
    COMMON_ROW_QUIET(4),
    {0},
};

// A plain number is in SI.
static bool read_number(const char *name, const char *text, bool *is_given, double *value, Err *err)
{
    Complaint complaint;
    if (!quantity_number(text, value, &complaint)) {
        return err_set(err, ERR_USAGE, "--%s: %s%s%s", name, complaint.text,
                       complaint.allowed[0] != '\0' ? "; allowed: " : "", complaint.allowed);
    }
    *is_given = true;
    return true;
}

static bool read_kp(const char *text, MapOptions *options, Err *err)
{
    Complaint complaint;
    double exponent = 1.0;
    if (!quantity_number(text, &options->kp, &complaint) &&
        !quantity_stiffness(text, &options->kp, &exponent, &complaint)) {
        return err_set(err, ERR_USAGE, "--kp: %s; allowed: a stiffness such as 1e7 N/m",
                       complaint.text);
    }
    options->has_kp = true;
    return exponent == 1.0 ||
           err_set(err, ERR_USAGE, "--kp: a row is a linear spring; allowed: N/m or N/mm");
}

static bool read_kd(const char *text, MapOptions *options, Err *err)
{
    Complaint complaint;
    if (!quantity_number(text, &options->kd, &complaint) &&
        !quantity_parse(text, DIMENSION_DAMPING, &options->kd, &complaint)) {
        return err_set(err, ERR_USAGE, "--kd: %s; allowed: a damper such as 10 N s/m",
                       complaint.text);
    }
    options->has_kd = true;
    return true;
}

// Of the options that are kept as they are written; NULL for any other.
static const char **place_of(MapOptions *options, int key)
{
    switch (key) {
    case KEY_STEPS:
        return &options->steps;
    case KEY_MAPS:
        return &options->maps;
    case KEY_LAWS:
        return &options->laws;
    case KEY_MASS:
        return &options->mass;
    case KEY_SPEED:
        return &options->speed;
    case KEY_STIFFNESS:
        return &options->stiffness;
    case KEY_RESTITUTION:
        return &options->restitution;
    case KEY_DAMPING:
        return &options->damping;
    case KEY_CLEARANCE:
        return &options->clearance;
    case KEY_CSV:
        return &options->csv;
    case KEY_PLOT:
        return &options->plot;
    default:
        return NULL;
    }
}

static bool take_option(int key, const char *value, void *target, Err *err)
{
    MapOptions *options = target;
    const char **place = place_of(options, key);
    if (place != NULL) {
        *place = value;
        return true;
    }
    switch (key) {
    case KEY_PENALTY:
        options->with_penalty = true;
        return true;
    case KEY_ERP:
        return read_number("erp", value, &options->has_erp, &options->erp, err);
    case KEY_CFM:
        return read_number("cfm", value, &options->has_cfm, &options->cfm, err);
    case KEY_KP:
        return read_kp(value, options, err);
    case KEY_KD:
        return read_kd(value, options, err);
    case KEY_STEP:
        return option_values_read_time("step", value, &options->step_s, err);
    case KEY_AT_STEP:
        return option_values_read_time("at-step", value, &options->at_step_s, err);
    case ARGP_KEY_ARG:
        return common_options_take_path(value, &options->common, "map takes one case", err);
    default:
        return common_options_take(key, value, &options->common, err);
    }
}

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
    if (!(options->step_s > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "a row stands for a spring and damper at one step only; "
                       "give it, such as --step '1 ms'");
    }
    if (options->at_step_s > 0.0 || options->steps != NULL || options->maps != NULL ||
        options->laws != NULL || options->speed != NULL || options->stiffness != NULL ||
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
    if (options->mass == NULL) {
        return err_set(err, ERR_USAGE,
                       "--stiffness needs the effective mass, such as --mass '0.1 kg'");
    }
    return (options->laws == NULL && !options->with_penalty) ||
           err_set(err, ERR_USAGE, "%s needs a case: a stiffness has no pin and hole",
                   options->laws != NULL ? "--laws" : "--penalty");
}

bool map_options_read(int argc, char **argv, MapOptions *options, bool *is_answered, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay map",
        .usage = "CASE\n--stiffness K --mass MASS [--step TIME]\n--erp X --cfm Y --step TIME "
                 "[--mass MASS] [CASE]\n"
                 "--kp K --kd C --step TIME [--mass MASS] [CASE]",
        .doc = "Tells which ERP, CFM and step to use for each joint with play, and what they "
               "deliver, predicted and measured in ODE; or which spring, damper and restitution "
               "an ERP and a CFM are.",
        .options = OPTIONS,
        .take = take_option,
    };
    *options = (MapOptions){0};
    if (!arguments_parse(&ARGUMENTS, argc, argv, options, is_answered, err)) {
        return false;
    }
    if (*is_answered) {
        return true;
    }
    options->is_inverse =
        options->has_erp || options->has_cfm || options->has_kp || options->has_kd;
    if (options->is_inverse) {
        return check_inverse(options, err);
    }
    if (options->at_step_s > 0.0 && (options->steps != NULL || options->step_s > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "--at-step is the only step; it goes with neither --step nor "
                       "--steps");
    }
    if (options->steps != NULL && options->step_s > 0.0) {
        return err_set(err, ERR_USAGE, "--step is one of --steps; give either");
    }
    if (!option_values_check_picture("--plot", options->plot, err)) {
        return false;
    }
    if (!check_lone(options, err)) {
        return false;
    }
    return options->common.path != NULL || options->stiffness != NULL ||
           err_set(err, ERR_USAGE,
                   "no case given: jointplay map CASE.yaml, or --stiffness K --mass M --step TIME, "
                   "or --erp X --cfm Y --step TIME");
}
