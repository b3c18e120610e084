// What do other programs read of the runs of a case?
#include "commands/run/run_json.h"

#include "commands/run/analytic_json.h"
#include "commands/run/run_truth_json.h"
#include "commands/run/spike_json.h"
#include "write/json_value.h"
#include "write/settings_json.h"
#include "write/units.h"

#include <inttypes.h>
#include <stdio.h>

static void set_extreme(json_t *object, const char *name, const char *unit, Extreme extreme)
{
    char key[64];
    snprintf(key, sizeof key, "%s_%s", name, unit);
    json_value_set(object, key, extreme.value);
    snprintf(key, sizeof key, "%s_crank_deg", name);
    json_value_set(object, key, extreme.crank_rad * UNITS_DEG);
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
        spike_json_set(body, "alpha", "rad_s2", "rad_s", linkage, &run->alpha_spikes[i]);
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
        json_value_set(object, "crank_deg", spike->crank_rad * UNITS_DEG);
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
        // without play that is felt there is no contact to count: null, not 0
        const bool is_felt = trajectory_feels_play(run, &linkage->joints[i]);
        json_object_set_new(joint, "impacts",
                            is_felt ? json_integer((json_int_t)extremes->impacts) : json_null());
        set_extreme(joint, "force_max", "N", extremes->force_max);
        json_value_set(joint, "impulse_N_s", is_felt ? extremes->impulse : NAN);
        json_value_set(joint, "penetration_max_m", is_felt ? extremes->penetration_max.value : NAN);
        json_value_set(joint, "contact_fraction", is_felt ? trajectory_contact_share(run, i) : NAN);
        json_object_set_new(joint, "has_play", json_boolean(has_play));
        if (has_play) {
            json_value_set(joint, "radial_clearance_m",
                           linkage_radial_clearance(&linkage->joints[i]));
        }
        json_object_set_new(joint, "spikes", spikes_array(extremes, is_felt));
        spike_json_set(joint, "force", "N", "N_s", linkage, &run->force_spikes[i]);
        json_object_set_new(joints, linkage->joints[i].name, joint);
    }
    return joints;
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
    json_object_set_new(object, "evaluations", json_integer((json_int_t)run->evaluations));
    json_value_set(object, "duration_s", run->duration_s);
    json_value_set(object, "wall_s", run->wall_s);
    json_value_set(object, "us_per_step", run->wall_s / (double)run->steps * UNITS_US);
    json_value_set(object, "real_time_factor", run->duration_s / run->wall_s);
    json_object_set_new(object, "constraint_rows", json_integer((json_int_t)run->constraint_rows));
    json_object_set_new(object, "contact_rows", json_integer((json_int_t)run->contact_rows));
    json_object_set_new(object, "fallback_rows", json_integer((json_int_t)run->fallback_rows));
    const bool is_estimated = run->trials > 0;
    json_value_set(object, "error_estimate", is_estimated ? run->error_estimate : NAN);
    json_value_set(object, "error_estimate_until_s", is_estimated ? run->estimate_s : NAN);
    json_object_set_new(object, "trials",
                        is_estimated ? json_integer((json_int_t)run->trials) : json_null());
    json_object_set_new(object, "tolerance_held",
                        is_estimated ? json_boolean(!run->is_short) : json_null());
    json_object_set_new(object, "bodies", bodies_object(linkage, run));
    json_object_set_new(object, "joints", joints_object(linkage, run));
    json_object_set_new(object, "error", run_truth_json_error(report, index));
    json_object_set_new(object, "energy", run_truth_json_energy(&run->energy));
    json_object_set_new(object, "spike_bands", spike_json_bands(report, run));
    json_object_set_new(object, "spike_match", run_truth_json_matches(report, index));
    json_object_set_new(object, "ensemble", run_truth_json_ensemble(report, index));
    json_object_set_new(object, "hash", json_sprintf("%016" PRIx64, run->hash));
    return object;
}

// In place of what could not be had: why.
static json_t *message_object(const char *message)
{
    json_t *object = json_object();
    json_object_set_new(object, "message", json_value_text(message));
    return object;
}

json_t *run_json_build(const RunReport *report)
{
    json_t *object = json_object();
    settings_json_begin(object, report->scenario);
    if (report->summary != NULL) {
        json_object_set_new(object, "kinematics", analytic_json_kinematics(report));
        json_object_set_new(object, "inverse_dynamics", analytic_json_forces(report));
    } else if (report->no_summary != NULL) {
        json_object_set_new(object, "kinematics", message_object(report->no_summary));
        json_object_set_new(object, "inverse_dynamics", message_object(report->no_summary));
    }
    if (report->stackup != NULL && report->stackup->has_sources) {
        json_object_set_new(object, "stackup", analytic_json_stackup(report));
    } else if (report->no_stackup != NULL) {
        json_object_set_new(object, "stackup", message_object(report->no_stackup));
    }
    json_object_set_new(object, "truth", run_truth_json_truth(report));
    json_t *runs = json_array();
    for (size_t i = 0; i < report->run_count; i++) {
        json_array_append_new(runs, run_object(report, i));
    }
    json_object_set_new(object, "runs", runs);
    return object;
}
