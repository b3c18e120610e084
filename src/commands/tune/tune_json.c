// Builds the JSON object of a search.
#include "commands/tune/tune.h"
#include "commands/tune/tune_export.h"
#include "commands/tune/tune_search.h"
#include "write/json_value.h"
#include "write/settings_json.h"

#include <inttypes.h>
#include <string.h>

static const char *const OUTCOMES[] = {[TUNE_OPEN] = "open",
                                       [TUNE_MEETS] = "meets",
                                       [TUNE_COSTLIER] = "dearer",
                                       [TUNE_STALLED] = "stalled",
                                       [TUNE_TOO_LONG] = "too-long"};

static json_t *tune_json_truth_object(const LadderTruth *truth)
{
    json_t *object = json_object();
    json_object_set_new(object, "backend", json_string(truth->backend));
    json_value_set(object, "uncertainty", truth->uncertainty);
    json_value_set(object, "horizon_s", truth->horizon_s);
    json_object_set_new(object, "is_limited", json_boolean(truth->is_limited));
    json_value_set(object, "wall_s", truth->wall_s);
    return object;
}

static json_t *trial_object(const Tune *tune, const TuneTrial *trial)
{
    const Scheme *scheme = &tune->schemes[trial->scheme].scheme;
    json_t *object = json_object();
    json_object_set_new(object, "scheme", json_string(scheme->name));
    json_value_set(object, scheme_has_step(scheme) ? "step_s" : "tolerance", trial->value);
    json_object_set_new(object, "status", json_string(trial->run.is_complete ? "ok" : "failed"));
    json_object_set_new(object, "message", json_value_text(trial->reason));
    json_value_set(object, "error_max", trial->error);
    json_object_set_new(object, "meets", json_boolean(trial->meets));
    json_object_set_new(object, "steps", json_integer((json_int_t)trial->run.steps));
    json_object_set_new(object, "evaluations", json_integer((json_int_t)trial->run.evaluations));
    json_value_set(object, "processor_s", trial->run.processor_s);
    json_value_set(object, "wall_s", trial->run.wall_s);
    json_object_set_new(object, "hash", json_sprintf("%016" PRIx64, trial->run.hash));
    return object;
}

// A setting that may be handed on: the trial, its keys and the command line that runs it.
static json_t *setting_object(const TuneReport *report, const TuneTrial *trial)
{
    if (trial == NULL) {
        return json_null();
    }
    const Tune *tune = report->tune;
    json_t *object = trial_object(tune, trial);
    const TuneScheme *scheme = &tune->schemes[trial->scheme];
    const bool is_timed = trial == tune_best(tune, (int)trial->scheme);
    json_value_set(object, "processor_median_s", is_timed ? scheme->processor_median_s : NAN);
    json_value_set(object, "wall_median_s", is_timed ? scheme->wall_median_s : NAN);
    Text text;
    text_init(&text);
    tune_setting_command(report, trial, " ", &text);
    json_object_set_new(object, "command", json_value_text(text.data));
    text_finish(&text);
    text_init(&text);
    tune_setting_keys(report, trial, "\n", &text);
    json_t *keys = json_object();
    for (char *line = text.data; line != NULL && *line != '\0';) {
        char *end = strchr(line, '\n');
        if (end != NULL) {
            *end++ = '\0';
        }
        char *equals = strchr(line, '=');
        *equals = '\0';
        json_object_set_new(keys, line, json_string(equals + 1));
        line = end;
    }
    json_object_set_new(object, "keys", keys);
    text_finish(&text);
    return object;
}

static json_t *tune_json_scheme_object(const Tune *tune, size_t number)
{
    const TuneScheme *scheme = &tune->schemes[number];
    const TuneTrial *best = tune_best(tune, (int)number);
    json_t *object = json_object();
    json_object_set_new(object, "scheme", json_string(scheme->scheme.name));
    json_object_set_new(object, "outcome", json_string(OUTCOMES[scheme->outcome]));
    json_object_set_new(object, "by_order", json_boolean(scheme->is_by_order));
    json_object_set_new(object, "runs", json_integer((json_int_t)scheme->trials));
    json_object_set_new(object, "best", best != NULL ? trial_object(tune, best) : json_null());
    json_value_set(object, "processor_median_s", scheme->processor_median_s);
    json_value_set(object, "wall_median_s", scheme->wall_median_s);
    json_object_set_new(object, "least",
                        scheme->least != TUNE_NONE
                            ? trial_object(tune, &tune->trials[scheme->least])
                            : json_null());
    return object;
}

// What a writer of text makes of the report.
static json_t *written_value(void (*write)(const TuneReport *report, Text *text),
                             const TuneReport *report)
{
    Text text;
    text_init(&text);
    write(report, &text);
    json_t *value = json_value_text(text.data);
    text_finish(&text);
    return value;
}

// Of limits that turn a joint the constants are torques and angles.
static json_t *of_contact(const TuneReport *report, json_t *object)
{
    const TuneContact *contact = &report->tune->contact;
    const Joint *joint = &report->scenario->linkage.joints[contact->joint];
    return contact->is_limit && linkage_is_torsional(joint) ? torsional_keys(object) : object;
}

static json_t *linear_object(const TuneReport *report, const TuneLinear *linear)
{
    static const char *const SOURCES[] = {[TUNE_LINEAR_SECANT] = "law",
                                          [TUNE_LINEAR_MEDIAN] = "median-impact",
                                          [TUNE_LINEAR_HARDEST] = "hardest-impact"};
    json_t *object = json_object();
    json_object_set_new(object, "best_for", json_string(SOURCES[linear->source]));
    json_object_set_new(object, "is_row", json_boolean(linear->is_row));
    json_value_set(object, "erp", linear->row.erp);
    json_value_set(object, "cfm_m_N_s", linear->row.cfm);
    json_value_set(object, "depth_m", linear->depth);
    json_value_set(object, "stiffness_N_m", linear->stiffness);
    json_value_set(object, "damping_N_s_m", linear->damping);
    json_value_set(object, "step_s", linear->step_s);
    json_value_set(object, "error_max", linear->error);
    json_object_set_new(object, "message", json_value_text(linear->reason));
    return of_contact(report, object);
}

static json_t *gazebo_object(const TuneReport *report)
{
    TuneGazebo gazebo;
    if (!tune_gazebo_find(report->tune, &gazebo)) {
        return json_null();
    }
    json_t *object = json_object();
    json_object_set_new(object, "is_limit", json_boolean(report->tune->contact.is_limit));
    json_value_set(object, "kp", gazebo.kp);
    json_value_set(object, "kd", gazebo.kd);
    json_value_set(object, "soft_erp", gazebo.soft_erp);
    json_value_set(object, "soft_cfm", gazebo.soft_cfm);
    json_value_set(object, "min_depth", gazebo.min_depth);
    json_value_set(object, "max_vel", gazebo.max_vel);
    json_value_set(object, "max_step_size", gazebo.step_s);
    json_value_set(object, "error_max", gazebo.error);
    json_object_set_new(object, "sdf", written_value(tune_gazebo_write, report));
    return object;
}

static json_t *mujoco_object(const TuneReport *report)
{
    TuneMujoco mujoco;
    if (!tune_mujoco_find(report, &mujoco)) {
        return json_null();
    }
    json_t *object = json_object();
    json_object_set_new(object, "is_limit", json_boolean(report->tune->contact.is_limit));
    json_object_set_new(object, "solref", json_pack("[f, f]", mujoco.solref[0], mujoco.solref[1]));
    json_object_set_new(
        object, "solimp",
        json_pack("[f, f, f, f, f]", mujoco.impedance, mujoco.impedance, 1.0, 0.5, 1.0));
    json_value_set(object, "inverse_mass_1_kg", mujoco.weight);
    json_value_set(object, "stiffness_N_m", mujoco.stiffness);
    json_value_set(object, "damping_N_s_m", mujoco.damping);
    json_value_set(object, "step_s", mujoco.step_s);
    json_object_set_new(object, "mjcf", written_value(tune_mujoco_write, report));
    const TuneModel *model = &report->tune->model;
    json_object_set_new(object, "run_in",
                        model->text != NULL ? json_value_text(model->engine) : json_null());
    json_value_set(object, "error_max", model->text != NULL ? model->error : NAN);
    return of_contact(report, object);
}

static json_t *loop_object(const TuneReport *report)
{
    const TuneTrial *plain = tune_export_plain(report->tune);
    json_t *object = setting_object(report, plain);
    if (plain != NULL) {
        Text text;
        text_init(&text);
        const bool is_there = tune_snippet_write(report, plain, &text);
        json_object_set_new(object, "lines", is_there ? json_value_text(text.data) : json_null());
        text_finish(&text);
    }
    return object;
}

static void set_asked(json_t *object, const Tune *tune)
{
    static const char *const COSTS[] = {
        [TUNE_TIME] = "time", [TUNE_STEPS] = "steps", [TUNE_LENGTH] = "step-length"};
    json_value_set(object, "error_asked", tune->target);
    json_object_set_new(object, "error_of", json_string(OPTIONS_TOLERANCES_OF[tune->of]));
    json_object_set_new(object, "cost", json_string(COSTS[tune->cost]));
    json_value_set(object, "step_held_s", tune->held_s > 0.0 ? tune->held_s : NAN);
    json_value_set(object, "max_cost_s", tune->limit.time_s > 0.0 ? tune->limit.time_s : NAN);
    json_object_set_new(object, "max_cost_steps",
                        tune->limit.steps > 0 ? json_integer((json_int_t)tune->limit.steps)
                                              : json_null());
}

// The program of --code as it was run, null where it was not.
static json_t *program_object(const TuneProgram *program)
{
    if (!program->is_run) {
        return json_null();
    }
    json_t *object = json_object();
    json_value_set(object, "step_s", program->step_s);
    json_value_set(object, "error_max", program->error);
    json_object_set_new(object, "meets", json_boolean(program->meets));
    json_object_set_new(object, "steps", json_integer((json_int_t)program->steps));
    json_value_set(object, "processor_s", program->processor_s);
    json_value_set(object, "first_step_s", program->step_first_s);
    json_value_set(object, "first_error_max", program->error_first);
    json_object_set_new(object, "message", json_value_text(program->reason));
    return object;
}

json_t *tune_json_build(const void *target)
{
    const TuneReport *report = target;
    const Tune *tune = report->tune;
    json_t *object = json_object();
    settings_json_begin(object, report->scenario);
    set_asked(object, tune);
    json_object_set_new(object, "truth", tune_json_truth_object(&tune->truth));
    json_object_set_new(object, "is_met", json_boolean(tune_report_is_met(report)));
    const TuneTrial *winner = tune_best(tune, tune->winner);
    const bool is_held = tune->held_s > 0.0;
    json_object_set_new(object, "cheapest", setting_object(report, is_held ? NULL : winner));
    json_object_set_new(
        object, "best_at_step",
        setting_object(report, tune->held != TUNE_NONE ? &tune->trials[tune->held] : NULL));
    json_object_set_new(object, "longest_step", setting_object(report, is_held ? winner : NULL));
    json_object_set_new(
        object, "least_error",
        setting_object(report, tune->within != TUNE_NONE ? &tune->trials[tune->within] : NULL));
    json_t *schemes = json_array();
    for (size_t i = 0; i < tune->scheme_count; i++) {
        json_array_append_new(schemes, tune_json_scheme_object(tune, i));
    }
    json_object_set_new(object, "schemes", schemes);
    json_t *trials = json_array();
    for (size_t i = 0; i < tune->trial_count; i++) {
        json_array_append_new(trials, trial_object(tune, &tune->trials[i]));
    }
    json_object_set_new(object, "trials", trials);
    json_object_set_new(object, "reference", tune_reference_object(report));
    json_object_set_new(object, "own_loop", loop_object(report));
    json_t *linears = json_array();
    for (size_t i = 0; i < tune->linear_count; i++) {
        json_array_append_new(linears, linear_object(report, &tune->linears[i]));
    }
    json_object_set_new(object, "constants", linears);
    json_object_set_new(object, "own_row",
                        tune->row != TUNE_NONE ? linear_object(report, &tune->linears[tune->row])
                                               : json_null());
    json_object_set_new(object, "program", program_object(&tune->program));
    json_object_set_new(object, "gazebo", gazebo_object(report));
    json_object_set_new(object, "mujoco", mujoco_object(report));
    return object;
}
