// Has what is to be run, for how long, and how often it is looked at.
#include "model/scenario.h"

#include "base/zeroed.h"
#include "model/common_period.h"
#include "model/joint_friction.h"

#include <stdio.h>
#include <string.h>

const char *const SCENARIO_SPACES[] = {"planar", "spatial", NULL};

Scenario scenario_default(void)
{
    return (Scenario){
        .gravity = {0.0, -9.80665, 0.0}, // m/s^2, standard gravity
        .material = material_options_default(),
        .contact = contact_options_default(),
        .run = run_options_default(),
        .reference = reference_options_default(),
        .ode = ode_options_default(),
    };
}

void scenario_start_as_written(Scenario *scenario, const char *reason)
{
    RunOptions *run = &scenario->run;
    snprintf(run->centred_because, sizeof run->centred_because, "%s", reason);
    run->start = START_CENTRED;
}

Scenario scenario_copy(const Scenario *scenario)
{
    Scenario copy = *scenario;
    copy.linkage = linkage_copy(&scenario->linkage);
    copy.path = zeroed_copy(scenario->path, 1 + strlen(scenario_path(scenario)), 1);
    copy.expectations = zeroed_copy(scenario->expectations, scenario->expectation_count,
                                    sizeof *scenario->expectations);
    copy.keys = zeroed_copy(scenario->keys, scenario->key_count, sizeof *scenario->keys);
    copy.tolerances =
        zeroed_copy(scenario->tolerances, scenario->tolerance_count, sizeof *scenario->tolerances);
    copy.settled = settled_start_copy(&scenario->settled, &scenario->linkage);
    copy.outcomes =
        zeroed_copy(scenario->outcomes, scenario->outcome_count, sizeof *scenario->outcomes);
    return copy;
}

Scenario scenario_around(const Scenario *scenario, Linkage linkage)
{
    Scenario around = *scenario;
    around.linkage = linkage;
    around.path = NULL;
    around.expectations = NULL;
    // that the start is found holds for whatever is a part of it
    around.settled = (SettledStart){.revolutions = scenario->settled.revolutions,
                                    .is_pressed = scenario->settled.is_pressed};
    around.outcomes = NULL;
    around.keys = NULL;
    around.key_count = 0;
    around.tolerances = NULL;
    around.tolerance_count = 0;
    around.expectation_count = around.outcome_count = 0;
    return around;
}

const char *scenario_path(const Scenario *scenario)
{
    return scenario->path != NULL ? scenario->path : "";
}

void scenario_set_path(Scenario *scenario, const char *path)
{
    free(scenario->path);
    scenario->path = zeroed_copy(path, 1 + strlen(path), 1);
}

void scenario_free(Scenario *scenario)
{
    linkage_free(&scenario->linkage);
    free(scenario->path);
    free(scenario->expectations);
    settled_start_free(&scenario->settled);
    free(scenario->outcomes);
    free(scenario->keys);
    free(scenario->tolerances);
    scenario->path = NULL;
    scenario->expectations = NULL;
    scenario->outcomes = NULL;
    scenario->keys = NULL;
    scenario->tolerances = NULL;
    scenario->key_count = scenario->tolerance_count = 0;
    scenario->expectation_count = scenario->outcome_count = 0;
}

void scenario_destroy(Scenario *scenario)
{
    if (scenario != NULL) {
        scenario_free(scenario);
        free(scenario);
    }
}

double scenario_duration(const Scenario *scenario)
{
    return drive_is_steady(&scenario->linkage.driver)
               ? scenario->run.revolutions * linkage_period(&scenario->linkage)
               : scenario->run.duration;
}

// Number of sample intervals in the run; a last, partial one is left out.
static size_t interval_count(const Scenario *scenario)
{
    const double samples = (double)scenario->run.samples;
    if (scenario->run.interval > 0.0) {
        return (size_t)floor(scenario_duration(scenario) / scenario->run.interval + 1e-9);
    }
    if (!drive_is_steady(&scenario->linkage.driver)) {
        return scenario->run.samples;
    }
    // 1e-9 of an interval: a whole number of intervals stays whole in spite of rounding
    return (size_t)floor(scenario->run.revolutions * samples + 1e-9);
}

size_t scenario_sample_count(const Scenario *scenario)
{
    return interval_count(scenario) + 1;
}

double scenario_report_from(const Scenario *scenario)
{
    const RunOptions *run = &scenario->run;
    return run->is_report_from_in_turns ? run->report_from * linkage_period(&scenario->linkage)
                                        : run->report_from;
}

bool scenario_reports_any(const Scenario *scenario)
{
    const double rounding = 1e-9;
    return scenario_report_from(scenario) < (1.0 - rounding) * scenario_duration(scenario);
}

double scenario_sample_time(const Scenario *scenario, size_t sample)
{
    if (scenario->run.interval > 0.0) {
        return scenario->run.interval * (double)sample;
    }
    const double turn = drive_is_steady(&scenario->linkage.driver)
                            ? linkage_period(&scenario->linkage)
                            : scenario->run.duration;
    return turn * (double)sample / (double)scenario->run.samples;
}

double scenario_settling_period(const Scenario *scenario)
{
    return common_period_find(&scenario->linkage).period_s;
}

double scenario_settling_turns(const Scenario *scenario)
{
    return drive_is_steady(&scenario->linkage.driver)
               ? round(scenario_settling_period(scenario) / linkage_period(&scenario->linkage))
               : 1.0;
}

bool scenario_settles(const Scenario *scenario)
{
    return scenario->run.start == START_SETTLED && scenario_settling_period(scenario) > 0.0 &&
           scenario->contact.model == CONTACT_IMPACT && scenario_has_clearance(scenario);
}

bool scenario_lacks_start(const Scenario *scenario)
{
    const SettledStart *settled = &scenario->settled;
    const bool presses = scenario->run.start == START_PRESSED && scenario_has_clearance(scenario);
    return (scenario_settles(scenario) && settled->revolutions == 0) ||
           (presses && !settled->is_pressed);
}

void scenario_set_stiffness(Scenario *scenario, double stiffness, double exponent)
{
    scenario->contact.stiffness = stiffness;
    scenario->contact.exponent = exponent;
    scenario->contact.is_for_all = true;
}

bool scenario_has_clearance(const Scenario *scenario)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (linkage_has_play(&scenario->linkage.joints[i])) {
            return true;
        }
    }
    return false;
}

bool scenario_has_closed_form(const Scenario *scenario)
{
    return scenario->has_fourbar || scenario->has_slidercrank;
}

bool scenario_is_extrapolable(const Scenario *scenario)
{
    return !scenario_has_clearance(scenario) && !scenario->linkage.is_spatial &&
           drive_is_smooth(&scenario->linkage.driver) && scenario->linkage.torque.limit == 0.0 &&
           joint_friction_first(&scenario->linkage) < 0;
}

bool scenario_integrates_contacts(const Scenario *scenario)
{
    return scenario->ode.stepping == ODE_STAGGERED && scenario->ode.map == ODE_MAP_IMPULSE &&
           scenario->contact.model == CONTACT_IMPACT &&
           (scenario_has_clearance(scenario) || joint_friction_first(&scenario->linkage) >= 0);
}

Scenario scenario_with_step(const Scenario *scenario, double step_s)
{
    Scenario given = *scenario;
    given.run.step = step_s;
    given.ode.stepping = scenario_is_extrapolable(scenario) ? ODE_EXTRAPOLATED : ODE_STAGGERED;
    given.ode.map = ODE_MAP_IMPULSE;
    // which follows the exact circle and asks no collider
    given.ode.collider = ODE_COLLIDER_PIN_HOLE;
    // contacts need fine steps and flight does not
    given.ode.gear = 2;
    return given;
}

bool scenario_check(const Scenario *scenario, Err *err)
{
    if (!linkage_check(&scenario->linkage, err)) {
        return false;
    }
    const RunOptions *run = &scenario->run;
    if (!(run->step >= 0.0) || !isfinite(run->step)) {
        return err_set(err, ERR_CASE, "step %g s, allowed: above 0, or 0 for one that is chosen",
                       run->step);
    }
    if (run->samples == 0 || !(scenario_duration(scenario) > 0.0) ||
        scenario_sample_count(scenario) < 2) {
        return err_set(err, ERR_CASE, "the run holds no sample: %g s, %zu samples",
                       scenario_duration(scenario), run->samples);
    }
    if (!(run->report_from >= 0.0) || !scenario_reports_any(scenario)) {
        return err_set(err, ERR_CASE, "reports from %g s, allowed: before the end of the run, %g s",
                       scenario_report_from(scenario), scenario_duration(scenario));
    }
    const Vec3 gravity = scenario->gravity;
    if (!isfinite(gravity.x) || !isfinite(gravity.y) || !isfinite(gravity.z)) {
        return err_set(err, ERR_CASE, "gravity [%g, %g, %g] m/s^2, allowed: any finite numbers",
                       gravity.x, gravity.y, gravity.z);
    }
    if (gravity.z != 0.0 && !scenario->linkage.is_spatial) {
        return err_set(err, ERR_CASE, "gravity of %g m/s^2 along z, allowed in the plane: 0",
                       gravity.z);
    }
    return true;
}
