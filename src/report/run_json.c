// What do other programs read of the runs of a case?
#include "report/run_json.h"

#include "casefile/casefile.h"
#include "report/analytic_json.h"
#include "report/json_value.h"
#include "report/units.h"
#include "version.h"

#include <inttypes.h>
#include <stdio.h>

static json_t *tool_object(void)
{
    return json_pack("{s:s, s:s, s:s, s:s}", "version", JOINTPLAY_VERSION, "ode",
                     JOINTPLAY_ODE_VERSION, "ccd", JOINTPLAY_CCD_VERSION, "gsl",
                     JOINTPLAY_GSL_VERSION);
}

static json_t *setting_value(const CasefileSetting *setting)
{
    const double *numbers = setting->numbers;
    switch (setting->kind) {
    case CASEFILE_INTEGER:
        return json_integer((json_int_t)numbers[0]);
    case CASEFILE_NUMBER:
        break;
    default:
        return json_value_text(setting->text);
    }
    if (setting->number_count == 1) {
        return json_value_real(numbers[0]);
    }
    if (setting->number_count == 2) {
        return json_pack("[o, o]", json_value_real(numbers[0]), json_value_real(numbers[1]));
    }
    return json_pack("{s:o, s:o, s:o}", "nominal", json_value_real(numbers[0]), "lower",
                     json_value_real(numbers[1]), "upper", json_value_real(numbers[2]));
}

// Every setting that the scenario makes use of, by the key it has in a case file, in SI; and the
// units of those that have one.
static void set_settings(json_t *object, const Scenario *scenario)
{
    json_t *settings = json_object();
    json_t *units = json_object();
    CasefileSetting setting;
    for (size_t i = 0; casefile_setting(scenario, i, &setting); i++) {
        if (setting.applies) {
            json_object_set_new(settings, setting.key, setting_value(&setting));
        }
        if (setting.applies && setting.unit[0] != '\0') {
            json_object_set_new(units, setting.key, json_string(setting.unit));
        }
    }
    json_object_set_new(object, "settings", settings);
    json_object_set_new(object, "setting_units", units);
}

static void set_extreme(json_t *object, const char *name, const char *unit, Extreme extreme)
{
    char key[64];
    snprintf(key, sizeof key, "%s_%s", name, unit);
    json_value_set(object, key, extreme.value);
    snprintf(key, sizeof key, "%s_crank_deg", name);
    json_value_set(object, key, units_wrapped_deg(extreme.crank_rad));
}

static json_t *bodies_object(const Linkage *linkage, const Trajectory *run)
{
    json_t *bodies = json_object();
    for (size_t i = 0; i < linkage->body_count; i++) {
        if ((int)i == linkage_driven_body(linkage)) {
            continue;
        }
        const BodyExtremes *extremes = &run->bodies[i];
        json_t *body = json_object();
        set_extreme(body, "omega_max", "rad_s", extremes->omega_max);
        set_extreme(body, "omega_min", "rad_s", extremes->omega_min);
        set_extreme(body, "alpha_max", "rad_s2", extremes->alpha_max);
        set_extreme(body, "alpha_min", "rad_s2", extremes->alpha_min);
        json_object_set_new(bodies, linkage->bodies[i].name, body);
    }
    return bodies;
}

static json_t *spikes_array(const JointExtremes *extremes, bool is_felt)
{
    json_t *spikes = json_array();
    for (size_t i = 0; is_felt && i < extremes->spike_count; i++) {
        const Spike *spike = &extremes->spikes[i];
        json_t *object = json_object();
        json_value_set(object, "onset_s", spike->onset_s);
        json_value_set(object, "crank_deg", units_wrapped_deg(spike->crank_rad));
        json_value_set(object, "approach_speed_m_s", spike->approach_speed);
        json_value_set(object, "force_max_N", spike->force_max);
        json_value_set(object, "duration_s", spike->duration_s);
        json_value_set(object, "impulse_N_s", spike->impulse);
        json_value_set(object, "penetration_max_m", spike->penetration_max);
        json_array_append_new(spikes, object);
    }
    return spikes;
}

static json_t *joints_object(const Linkage *linkage, const Trajectory *run)
{
    json_t *joints = json_object();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const JointExtremes *extremes = &run->joints[i];
        json_t *joint = json_object();
        const bool has_play = linkage->joints[i].kind == JOINT_CLEARANCE;
        json_object_set_new(joint, "impacts", json_integer((json_int_t)extremes->impacts));
        set_extreme(joint, "force_max", "N", extremes->force_max);
        json_value_set(joint, "impulse_N_s", extremes->impulse);
        json_value_set(joint, "penetration_max_m", extremes->penetration_max.value);
        json_value_set(joint, "contact_fraction", extremes->contact_time / run->duration_s);
        json_object_set_new(joint, "has_play", json_boolean(has_play));
        if (has_play) {
            json_value_set(joint, "radial_clearance_m",
                           linkage_radial_clearance(&linkage->joints[i]));
        }
        json_object_set_new(
            joint, "spikes",
            spikes_array(extremes, run_report_feels_play(run, &linkage->joints[i])));
        json_object_set_new(joints, linkage->joints[i].name, joint);
    }
    return joints;
}

static json_t *error_object(const RunReport *report, const TrajectoryError *error)
{
    if (!error->is_known) {
        return json_null();
    }
    json_t *object = json_object();
    json_object_set_new(object, "against", json_string(error->against));
    json_value_set(object, "omega_max", error->omega_max);
    json_value_set(object, "omega_max_time_s", error->omega_max_time_s);
    json_value_set(object, "omega_rms", error->omega_rms);
    json_value_set(object, "alpha_max", error->alpha_max);
    json_value_set(object, "angle_max_rad", error->angle_max_rad);
    json_object_set_new(object, "includes_play",
                        json_boolean(scenario_has_clearance(report->scenario)));
    // not measured in this version
    json_object_set_new(object, "horizon_s", json_null());
    json_object_set_new(object, "reference_uncertainty", json_null());
    return object;
}

static json_t *run_object(const RunReport *report, size_t index)
{
    const Trajectory *run = report->runs[index];
    const Linkage *linkage = &report->scenario->linkage;
    json_t *object =
        json_pack("{s:s, s:s, s:s, s:s}", "backend", run->backend, "label", run->label, "status",
                  run->is_complete ? "ok" : "failed", "message", run->message);
    if (!run->is_complete) {
        return object;
    }
    json_value_set(object, "step_s", run->step_s > 0.0 ? run->step_s : NAN);
    json_object_set_new(object, "steps", json_integer((json_int_t)run->steps));
    json_value_set(object, "duration_s", run->duration_s);
    json_value_set(object, "wall_s", run->wall_s);
    json_value_set(object, "us_per_step", run->wall_s / (double)run->steps * UNITS_US);
    json_value_set(object, "real_time_factor", run->duration_s / run->wall_s);
    json_object_set_new(object, "constraint_rows", json_integer((json_int_t)run->constraint_rows));
    json_object_set_new(object, "contact_rows", json_integer((json_int_t)run->contact_rows));
    json_object_set_new(object, "bodies", bodies_object(linkage, run));
    json_object_set_new(object, "joints", joints_object(linkage, run));
    json_object_set_new(object, "error", error_object(report, &report->errors[index]));
    json_object_set_new(object, "hash", json_sprintf("%016" PRIx64, run->hash));
    return object;
}

json_t *run_json_build(const RunReport *report)
{
    json_t *object = json_object();
    json_object_set_new(object, "tool", tool_object());
    json_object_set_new(object, "case", json_value_text(report->scenario->path));
    json_object_set_new(object, "title", json_value_text(report->scenario->title));
    set_settings(object, report->scenario);
    if (report->summary != NULL) {
        json_object_set_new(object, "kinematics", analytic_json_kinematics(report));
        json_object_set_new(object, "inverse_dynamics", analytic_json_forces(report));
    }
    if (report->stackup != NULL && report->stackup->has_sources) {
        json_object_set_new(object, "stackup", analytic_json_stackup(report));
    }
    json_t *runs = json_array();
    for (size_t i = 0; i < report->run_count; i++) {
        json_array_append_new(runs, run_object(report, i));
    }
    json_object_set_new(object, "runs", runs);
    return object;
}
