// What do other programs read of the truth and of what was measured against it?
#include "commands/run/run_report.h"
#include "write/json_value.h"
#include "write/measured_fields.h"

static json_t *message_of(const Truth *truth)
{
    return truth->is_uncertified ? json_string("is not certified: --uncertified")
                                 : json_value_not_certified(truth->message);
}

json_t *run_truth_json_truth(const RunReport *report)
{
    const Truth *truth = report->truth;
    if (truth == NULL) {
        return json_null();
    }
    json_t *object = json_object();
    json_object_set_new(object, "backend", json_string(truth->trajectory->backend));
    json_object_set_new(object, "status",
                        json_string(truth->trajectory->is_complete ? "ok" : "failed"));
    const bool is_certified = truth->message[0] == '\0';
    json_object_set_new(object, "message",
                        truth->trajectory->is_complete
                            ? message_of(truth)
                            : json_value_text(truth->trajectory->message));
    if (truth->trajectory->is_complete) {
        json_value_set(object, "uncertainty", truth->uncertainty);
        json_value_set(object, "horizon_s", is_certified ? truth->horizon_s : NAN);
        json_value_set(object, "growth", is_certified ? truth->growth : NAN);
        json_object_set_new(object, "other_contact_model",
                            json_boolean(run_report_mixes_models(report)));
        json_object_set_new(object, "is_limited", json_boolean(truth->is_limited));
    }
    return object;
}

json_t *run_truth_json_error(const RunReport *report, size_t run)
{
    const TrajectoryError *error = &report->errors[run];
    if (!error->is_known) {
        return json_null();
    }
    const bool is_certified = run_report_is_certified(report, error);
    const Truth *truth = report->truth;
    json_t *object = json_object();
    json_object_set_new(object, "against", json_string(error->against));
    fields_json_set(ERROR_FIELDS, FIELD_JSON, error, object);
    json_object_set_new(object, "includes_play",
                        json_boolean(run_report_includes_play(report, run)));
    json_value_set(object, "horizon_s", is_certified ? truth->horizon_s : NAN);
    json_value_set(object, "reference_uncertainty", is_certified ? truth->uncertainty : NAN);
    json_object_set_new(object, "limited_by_reference",
                        json_boolean(run_report_is_limited_by_reference(report, error)));
    return object;
}

static json_t *match_object(const SpikeMatch *match, const JointExtremes *truth)
{
    json_t *pairs = json_array();
    for (size_t i = 0; i < match->pair_count; i++) {
        const SpikePair *pair = &match->pairs[i];
        json_t *object = json_object();
        json_object_set_new(object, "spike", json_integer((json_int_t)pair->spike));
        json_object_set_new(object, "reference_spike",
                            json_integer((json_int_t)pair->reference_spike));
        json_value_set(object, "reference_onset_s", truth->spikes[pair->reference_spike].onset_s);
        json_value_set(object, "onset_delay_s", pair->onset_delay_s);
        json_value_set(object, "force_error", pair->force_error);
        json_value_set(object, "impulse_error", pair->impulse_error);
        json_array_append_new(pairs, object);
    }
    json_t *object = json_object();
    json_object_set_new(object, "pairs", pairs);
    json_object_set_new(object, "missed", json_integer((json_int_t)match->missed));
    json_object_set_new(object, "extra", json_integer((json_int_t)match->extra));
    return object;
}

json_t *run_truth_json_matches(const RunReport *report, size_t run)
{
    const Linkage *linkage = &report->scenario->linkage;
    json_t *joints = json_object();
    for (size_t i = 0; report->matches != NULL && i < linkage->joint_count; i++) {
        const SpikeMatch *match = &report->matches[run].joints[i];
        if (match->pair_count + match->missed + match->extra > 0) {
            json_object_set_new(joints, linkage->joints[i].name,
                                match_object(match, &report->truth->trajectory->joints[i]));
        }
    }
    if (json_object_size(joints) == 0) {
        json_decref(joints);
        return json_null();
    }
    return joints;
}

json_t *run_truth_json_ensemble(const RunReport *report, size_t run)
{
    const Ensemble *ensemble = report->ensembles != NULL ? &report->ensembles[run] : NULL;
    if (ensemble == NULL || ensemble->members + ensemble->failed == 0) {
        return json_null();
    }
    json_t *object = json_object();
    json_object_set_new(object, "members", json_integer((json_int_t)ensemble->members));
    json_object_set_new(object, "failed", json_integer((json_int_t)ensemble->failed));
    json_object_set_new(object, "message", json_value_text(ensemble->message));
    json_object_set_new(object, "joints",
                        ensemble_joints_json(&report->scenario->linkage, ensemble));
    return object;
}
