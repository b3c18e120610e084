// Makes MuJoCo's whole model of a case with its contacts made linear, by MuJoCo's driver, and runs
// it there against the law itself.
#include "commands/tune/tune_model.h"

#include "commands/tune/tune_linear.h"
#include "engine/driver.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char NATIVE[] = "native"; // a limited tendon, by spring and damper of a linear law

// The program that --driver names for MuJoCo, or the driver that came with us.
static bool find_driver(const Scenario *scenario, EngineDriver *driver, Err *err)
{
    const char *given = scenario->engines[BACKEND_MUJOCO].driver;
    return given != NULL ? engine_given(given, driver, err)
                         : engine_find(OPTIONS_BACKENDS[BACKEND_MUJOCO], driver, err);
}

static void measure(const TuneSearch *search, const EngineDriver *driver, const Scenario *scenario,
                    TuneModel *model)
{
    EngineSaid said;
    Trajectory *run =
        engine_run_model(driver, NATIVE, scenario, search->time_limit_s, &said, &model->text);
    LadderRun result = {.kind = LADDER_ERROR, .is_complete = run->is_complete};
    model->steps = run->steps;
    model->processor_s = run->wall_s;
    snprintf(result.message, sizeof result.message, "%.*s", LADDER_MESSAGE_SIZE - 1, run->message);
    if (run->is_complete) {
        const Truth *truth = search->truth;
        result.error =
            error_against(run, truth->trajectory, truth->is_limited ? truth->horizon_s : INFINITY);
    }
    model->error = tune_error(search->tune, &result, model->reason);
    trajectory_destroy(run);
}

void tune_model_run(const TuneSearch *search, double step_s)
{
    Tune *tune = search->tune;
    TuneModel *model = &tune->model;
    EngineDriver driver;
    Err err = {0};
    if (!engine_check(OPTIONS_BACKENDS[BACKEND_MUJOCO], search->scenario, &err) ||
        !find_driver(search->scenario, &driver, &err)) {
        snprintf(model->reason, sizeof model->reason, "%.*s", LADDER_MESSAGE_SIZE - 1, err.text);
        return;
    }
    Scenario scenario = tune_linear_scenario(search->scenario, &tune->linears[tune->linear]);
    scenario.run.step = step_s;
    model->step_s = step_s;
    snprintf(model->engine, sizeof model->engine, "%.60s %.60s", driver.engine, driver.version);
    measure(search, &driver, &scenario, model);
}

bool tune_model_write(const Tune *tune, Text *text)
{
    const TuneModel *model = &tune->model;
    if (model->text == NULL) {
        return false;
    }
    const TuneLinear *linear = &tune->linears[tune->linear];
    text_append(text,
                "<!-- spring %.4g N/m, damper %.4g N s/m: limits of the tendons that are the\n"
                "     pins in their holes, scaled by tendon_invweight0 of this model. The whole\n"
                "     mechanism, run in %s from the key \"start\"%s%.2g. -->\n",
                linear->stiffness, linear->damping, model->engine,
                isfinite(model->error) ? ": its error is " : ", where it failed, error ",
                model->error);
    text_append(text, "%s", model->text);
    return true;
}
