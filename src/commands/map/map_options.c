// What was `jointplay map` asked for?
#include "commands/map/map_options.h"

#include "base/shell.h"
#include "casefile/quantity.h"
#include "cli/option_values.h"

#include <stdio.h>
#include <string.h>

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

static bool read_erp(const char *text, void *target, Err *err)
{
    MapOptions *options = target;
    return read_number("erp", text, &options->has_erp, &options->erp, err);
}

static bool read_cfm(const char *text, void *target, Err *err)
{
    MapOptions *options = target;
    return read_number("cfm", text, &options->has_cfm, &options->cfm, err);
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

static const OptionRow OPTIONS[] = {
    {"steps", "LIST",
     "The steps, such as '10 us, 3 us, 1 us' (default: 30 to 0.1 us and the case's own)", 1,
     OPTION_TEXT, AT(steps)},
    {"at-step", "TIME",
     "A step that cannot be changed: also the best ERP and CFM, and kp and kd, at it", 1,
     OPTION_QUANTITY, AT(at_step_s), .dimension = DIMENSION_TIME},
    {"maps", "LIST", "Only these of textbook, corrected, midpoint, exact, impulse", 1, OPTION_TEXT,
     AT(maps)},
    {"laws", "LIST",
     "These elastic laws in place of the case's, with its damping; 'all' for every one", 1,
     OPTION_TEXT, AT(laws)},
    {"mass", "MASS",
     "The effective mass: 'median' (default) or 'most' of the case's run, or such as '0.1 kg'", 1,
     OPTION_TEXT, AT(mass)},
    {"speed", "SPEED",
     "The closing speed: 'median' (default) or 'most' of the case's contacts, or '0.1 m/s'", 1,
     OPTION_TEXT, AT(speed)},
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
     OPTION_QUANTITY, AT(step_s), .dimension = DIMENSION_TIME},
    {"stiffness", "K",
     "Without a case, with --mass: a lone contact of F = K d^n, such as '1e9 N/m^1.5'", 3,
     OPTION_TEXT, AT(stiffness)},
    {"restitution", "E", "Of --stiffness (default: 0.9)", 3, OPTION_TEXT, AT(restitution)},
    {"damping", "LAW",
     "Of --stiffness: a damping law (default: lankarani-nikravesh), or a damper '10 N s/m'", 3,
     OPTION_TEXT, AT(damping)},
    {"clearance", "C", "Of --stiffness: the radial clearance (default: as wide as the steps need)",
     3, OPTION_TEXT, AT(clearance)},
    COMMON_JSON(4),
    COMMON_WIDE(4),
    {"csv", "FILE.csv", "Write one row per joint, law, map and step", 4, OPTION_TEXT, AT(csv)},
    {"plot", "FILE.svg", "Draw the errors of restitution and peak force", 4, OPTION_PICTURE,
     AT(plot)},
    COMMON_OUT(4, "Write <case>-map.txt, .csv, .svg and .json there"),
    COMMON_QUIET(4),
};

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

static bool check(void *target, Err *err)
{
    MapOptions *options = target;
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
    if (!check_lone(options, err)) {
        return false;
    }
    return options->common.path != NULL || options->stiffness != NULL ||
           err_set(err, ERR_USAGE,
                   "no case given: jointplay map CASE.yaml, or --stiffness K --mass M --step TIME, "
                   "or --erp X --cfm Y --step TIME");
}

const Arguments MAP_ARGUMENTS = {
    .program = "jointplay map",
    .usage = "CASE\n--stiffness K --mass MASS [--step TIME]\n--erp X --cfm Y --step TIME "
             "[--mass MASS] [CASE]\n"
             "--kp K --kd C --step TIME [--mass MASS] [CASE]",
    .doc = "Finds the ERP, CFM and step to use for each joint with play, and what they deliver, "
           "predicted and measured in ODE; or the spring, damper and restitution that an ERP and a "
           "CFM stand for.",
    .argument = COMMON_PATH("map takes one case"),
    OPTION_ROWS(OPTIONS),
    .check = check,
};
