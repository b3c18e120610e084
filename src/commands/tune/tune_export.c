// How can a setting be used outside this program?
#include "commands/tune/tune_export.h"

#include "commands/tune/tune_limit.h"
#include "commands/tune/tune_linear.h"
#include "commands/tune/tune_report.h"
#include "commands/tune/tune_setting.h"
#include "commands/tune/tune_world.h"
#include "measure/chosen_run.h"
#include "write/joint_units.h"
#include "write/section.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const TuneTrial *tune_export_trial(const TuneReport *report)
{
    const Tune *tune = report->tune;
    if (tune->held_s > 0.0) {
        return tune->held != TUNE_NONE ? &tune->trials[tune->held] : NULL;
    }
    if (tune_report_is_met(report)) {
        return tune_best(tune, tune->winner);
    }
    if (tune_report_has_limit(report) && tune->within != TUNE_NONE) {
        return &tune->trials[tune->within];
    }
    const TuneTrial *best = tune_best(tune, tune->winner);
    return best != NULL || tune->within == TUNE_NONE ? best : &tune->trials[tune->within];
}

// The code makes no trials: it gets the step that they choose.
static bool choose_step(Scenario *scenario, Err *err)
{
    Trajectory *run = chosen_run_make(scenario, NULL, (ChosenWatch){.begin = NULL}, NULL);
    const bool is_chosen = run->is_complete || err_set(err, ERR_SOLVER, "%s", run->message);
    if (is_chosen) {
        *scenario = chosen_run_scenario(scenario, run->step_s);
    }
    trajectory_destroy(run);
    return is_chosen;
}

bool tune_export_scenario(const TuneReport *report, Scenario *scenario, Err *err)
{
    const TuneTrial *trial = tune_export_trial(report);
    assert(trial != NULL);
    *scenario = *report->scenario;
    tune_apply(&report->tune->schemes[trial->scheme], trial->value, scenario);
    return scenario->run.step > 0.0 || choose_step(scenario, err);
}

// The scenario of a program that was run already: its step is known.
static void take_program(const TuneReport *report, Scenario *scenario)
{
    const TuneTrial *trial = tune_export_trial(report);
    *scenario = *report->scenario;
    tune_apply(&report->tune->schemes[trial->scheme], trial->value, scenario);
    if (scenario->run.step == 0.0) {
        *scenario = chosen_run_scenario(scenario, report->tune->program.step_s);
    }
    scenario->run.step = report->tune->program.step_s;
}

bool tune_export_code(const TuneReport *report, Text *text, Err *err)
{
    const TuneTrial *trial = tune_export_trial(report);
    const TuneProgram *program = &report->tune->program;
    assert(trial != NULL);
    Scenario *scenario = malloc(sizeof *scenario);
    assert(scenario != NULL);
    take_program(report, scenario);
    Text words;
    Text command;
    text_init(&words);
    text_init(&command);
    tune_setting_words(report, trial, &words);
    tune_setting_command(report, trial, " ", &command);
    const TuneCode code = {.scenario = scenario,
                           .words = words.data,
                           .command = command.data,
                           .error = program->error,
                           .target = report->tune->target,
                           .step_first_s = program->step_first_s,
                           .error_first = program->error_first};
    const bool is_written = tune_world_write(&code, text, err);
    text_finish(&words);
    text_finish(&command);
    free(scenario);
    return is_written;
}

const char *tune_export_lacks(const TuneReport *report)
{
    const TuneTrial *trial = tune_export_trial(report);
    assert(trial != NULL);
    Scenario scenario = *report->scenario;
    tune_apply(&report->tune->schemes[trial->scheme], trial->value, &scenario);
    if (scenario.run.step == 0.0) {
        // the way of stepping that a step chosen for a tolerance is for
        scenario = scenario_with_step(&scenario, scenario.run.step);
    }
    return tune_world_lacks(&scenario);
}

// Text, each line moved in by four spaces.
static void append_indented(const char *lines, Text *text)
{
    while (*lines != '\0') {
        const size_t length = strcspn(lines, "\n");
        text_append(text, "%s%.*s\n", length > 0 ? "    " : "", (int)length, lines);
        lines += length + (lines[length] == '\n' ? 1 : 0);
    }
}

// What the program of --code is worth.
static void write_program(const TuneProgram *program, Text *text)
{
    if (isnan(program->error)) {
        text_append(text, "  Run with libjointplay, the setting has no error: %s.\n",
                    program->reason);
        return;
    }
    text_append(text,
                "  Run with libjointplay, at steps of %.3g ms, the setting has an error of "
                "%.3g at the times that the program of --code prints.",
                program->step_s * UNITS_MS, program->error);
    if (program->step_s < program->step_first_s) {
        text_append(text, " At the %.3g ms found above it would be %.3g, so the step is shorter.",
                    program->step_first_s * UNITS_MS, program->error_first);
    }
    text_append(text, " Compile it with: cc FILE.c -o run $(pkg-config --cflags --libs jointplay) "
                      "-lm\n");
}

static void write_code(const TuneReport *report, const Style *style, Text *text)
{
    text_append(text, "\n%sAs ODE C code%s\n\n", style->heading, style->end);
    if (tune_export_trial(report) == NULL) {
        text_append(text, "  There is no setting to write.\n");
        return;
    }
    const TuneProgram *program = &report->tune->program;
    const char *lacks = tune_export_lacks(report);
    if (program->is_run) {
        write_program(program, text);
    } else if (report->scenario->linkage.is_spatial) {
        text_append(text, "  There is none: programs are written for cases in the plane alone.\n");
    } else if (lacks != NULL) {
        text_append(text, "  There is none: %s.\n", lacks);
    } else {
        text_append(text, "  --code FILE.c writes the setting as a short program against "
                          "libjointplay, for worlds of your own: cc FILE.c -o run $(pkg-config "
                          "--cflags --libs jointplay) -lm\n");
    }
}

const TuneTrial *tune_export_plain(const Tune *tune)
{
    if (tune->held_s > 0.0) {
        return tune->held_plain != TUNE_NONE ? &tune->trials[tune->held_plain] : NULL;
    }
    return tune_best(tune, tune->plain);
}

// The best setting for a loop that cannot be changed, and what it costs.
static void write_loop(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    const TuneTrial *plain = tune_export_plain(tune);
    const TuneTrial *winner = tune_best(tune, tune->winner);
    if (!scenario_has_clearance(report->scenario)) {
        return;
    }
    text_append(text, "\n%sIn a loop of your own%s\n\n", style->heading, style->end);
    if (tune->held_s > 0.0) {
        tune_held_text_row(tune, text);
        text_append(text, "\n");
    }
    if (plain == NULL) {
        if (tune->held_s > 0.0) {
            text_append(text, "  No plain step with ERP and CFM alone has a meaningful error at "
                              "this step.\n");
            return;
        }
        text_append(text, "  No plain step with ERP and CFM alone that was tried meets the error; "
                          "the schemes above say how far each came.\n");
        return;
    }
    text_append(text, "  ERP and CFM alone, in a loop that steps as ODE's manual says: ");
    tune_setting_words(report, plain, text);
    text_append(text, ", error %.3g", plain->error);
    if (winner != NULL && tune->plain != tune->winner && tune->held_s == 0.0) {
        const double ratio = tune_trial_cost(tune, plain) / tune_trial_cost(tune, winner);
        text_append(text, "; %.3g times the %s of the cheapest", ratio,
                    tune->cost == TUNE_STEPS ? "world steps" : "time");
    }
    text_append(text, ".\n\n");
    Text lines;
    text_init(&lines);
    if (tune_snippet_write(report, plain, &lines)) {
        append_indented(lines.data, text);
    } else {
        text_append(text, "  The map needs more than a few lines; --schemes direct/plain/corrected "
                          "--code FILE.c has them all.\n");
    }
    text_finish(&lines);
}

static void write_linears(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    const JointUnits *units = joint_units(&report->scenario->linkage.joints[tune->contact.joint]);
    const SectionHead heads[] = {
        {"spring at", units->length, TABLE_RIGHT},
        {"spring", units->stiffness, TABLE_RIGHT},
        {"damper", units->damping, TABLE_RIGHT},
        {"step", "us", TABLE_RIGHT},
        {"error", "1", TABLE_RIGHT},
        {"", "", TABLE_WRAP},
    };
    Table *table = section_begin("A contact with constants", 6, heads, style, text);
    for (size_t i = 0; i < tune->linear_count; i++) {
        const TuneLinear *linear = &tune->linears[i];
        table_cell(table, "%.3g", linear->depth * units_per_si(units->length));
        table_cell(table, "%.4g", linear->stiffness);
        table_cell(table, "%.4g", linear->damping);
        table_cell(table, "%.4g", linear->step_s * UNITS_US);
        section_finite(table, "%.2e", linear->error);
        table_cell(table, "%s",
                   (int)i == tune->linear                                    ? "taken"
                   : linear->error + tune->truth.uncertainty <= tune->target ? "met in this run"
                                                                             : linear->reason);
    }
    section_end(table, text);
}

static void write_gazebo(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    if (tune->linear_count == 0) {
        if (scenario_has_clearance(report->scenario)) {
            text_append(text, "\n%sAs Gazebo SDF and MuJoCo MJCF%s\n\n  There is none: %s.\n",
                        style->heading, style->end, tune_linear_lacks(report->scenario, tune));
        }
        return;
    }
    const JointUnits *units = joint_units(&report->scenario->linkage.joints[tune->contact.joint]);
    if (tune->held_s > 0.0) {
        tune_held_text_constants(report, style, text);
    } else {
        write_linears(report, style, text);
    }
    text_append(text,
                "  Gazebo and MuJoCo have a constant spring and damper a contact, and plain steps. "
                "These were run in ODE with the textbook map, against the law itself; the damper "
                "%sgives an impact on %.4g %s the law's own restitution.\n",
                tune->held_s > 0.0 ? "beside the law's spring " : "", tune->contact.mass,
                units->mass);
    if (tune->held_s > 0.0) {
        text_append(text, "  Those for an impact are the best for a lone one at this step, as by "
                          "`map --at-step`; a row without kp and kd has no such pair.\n");
    }
    TuneGazebo gazebo;
    text_append(text, "\n%sAs Gazebo SDF%s\n\n", style->heading, style->end);
    if (!tune_gazebo_find(tune, &gazebo)) {
        text_append(text, "  No step that was tried is stable with constants.\n");
        return;
    }
    if (!isfinite(tune->target)) {
        text_append(text, "  At a step of %.4g us the error of the whole motion is %.2g.\n\n",
                    gazebo.step_s * UNITS_US, gazebo.error);
    } else if (gazebo.error + tune->truth.uncertainty <= tune->target) {
        text_append(text, "  Meets the error with a step of %.4g us: %.2g.\n\n",
                    gazebo.step_s * UNITS_US, gazebo.error);
    } else {
        text_append(
            text,
            "  Gazebo's constants do not reach %.3g here: of those in the table the best is %.2g "
            "off, at a step of %.4g us.\n\n",
            tune->target, gazebo.error, gazebo.step_s * UNITS_US);
    }
    Text lines;
    text_init(&lines);
    tune_gazebo_write(report, &lines);
    append_indented(lines.data, text);
    text_finish(&lines);
}

static void write_mujoco(const TuneReport *report, const Style *style, Text *text)
{
    TuneMujoco mujoco;
    if (!tune_mujoco_find(report, &mujoco)) {
        return;
    }
    text_append(text, "\n%sAs MuJoCo MJCF%s\n\n", style->heading, style->end);
    text_append(
        text,
        "  The same spring and damper. Not run here. What does not carry over: the exponent "
        "of the law, damping that grows with depth, and a share %.1g of the acceleration "
        "without contact.\n\n",
        mujoco.impedance);
    if (tune_mujoco_is_finer(report, &mujoco)) {
        text_append(
            text,
            "  MuJoCo's spring is explicit and needs a shorter step than the one asked for: "
            "the timestep here is %.3g us.\n\n",
            mujoco.step_s * UNITS_US);
    }
    Text lines;
    text_init(&lines);
    tune_mujoco_write(report, &lines);
    append_indented(lines.data, text);
    text_finish(&lines);
}

void tune_export_write(const TuneReport *report, const Style *style, Text *text)
{
    write_code(report, style, text);
    write_loop(report, style, text);
    write_gazebo(report, style, text);
    write_mujoco(report, style, text);
}
