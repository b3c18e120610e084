// Builds the JSON object of the runs of a case.
#include "commands/run/run_overview.h"
#include "commands/run/run_report.h"
#include "measure/wear.h"
#include "model/coordinate.h"
#include "run/bushing_load.h"
#include "write/assumed.h"
#include "write/json_value.h"
#include "write/measured_fields.h"
#include "write/settings_json.h"
#include "write/spread.h"
#include "write/units.h"

#include <inttypes.h>
#include <stdio.h>

// The reference and what was measured against it.

static json_t *run_json_message_of(const Truth *truth)
{
    return truth->is_uncertified ? json_string("is not certified: --uncertified")
                                 : json_value_not_certified(truth->message);
}

static json_t *run_truth_json_truth(const RunReport *report)
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
                            ? run_json_message_of(truth)
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

// The errors of forces by joint with play, and of peak accelerations by body.
static void set_error_members(json_t *object, const RunReport *report, size_t index)
{
    const Trajectory *run = report->runs[index];
    const Trajectory *against = run_report_against(report, index);
    const Linkage *linkage = &report->scenario->linkage;
    const double horizon_s = run_report_horizon(report);
    json_t *joints = json_object();
    json_t *bodies = json_object();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (error_has_forces(run, against, i)) {
            const JointError error = error_of_joint(run, against, i, horizon_s);
            json_object_set_new(joints, linkage->joints[i].name,
                                fields_json(ERROR_JOINT_FIELDS, FIELD_JSON, &error));
        }
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (!linkage_is_driven(&against->linkage, (int)i)) {
            const BodyError error = error_of_body(run, against, i, horizon_s);
            json_object_set_new(bodies, linkage->bodies[i].name,
                                fields_json(ERROR_BODY_FIELDS, FIELD_JSON, &error));
        }
    }
    json_object_set_new(object, "joints", joints);
    json_object_set_new(object, "bodies", bodies);
}

static json_t *run_truth_json_error(const RunReport *report, size_t run)
{
    const TrajectoryError *error = &report->errors[run];
    if (!error->is_known) {
        return json_null();
    }
    const bool is_certified = run_report_is_certified(report, error);
    json_t *object = json_object();
    json_object_set_new(object, "against", json_string(error->against));
    fields_json_set(ERROR_FIELDS, FIELD_JSON, error, object);
    set_error_members(object, report, run);
    json_object_set_new(object, "includes_play",
                        json_boolean(run_report_includes_play(report, run)));
    NumberSource source = run_report_source(report, run);
    source.truth = is_certified ? source.truth : NULL;
    number_fields_json(object, NUMBER_OWNER_TRUTH, &source, &report->scenario->linkage, 0);
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

static json_t *run_truth_json_matches(const RunReport *report, size_t run)
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

static json_t *run_truth_json_ensemble(const RunReport *report, size_t run)
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

// The closed form of the mechanism.

static void set_follower(json_t *object, const AnalyticSummary *summary)
{
    json_value_set(object, "follower_angle_min_rad", summary->follower_low);
    json_value_set(object, "follower_angle_max_rad", summary->follower_high);
}

static void set_slider(json_t *object, const AnalyticSummary *summary)
{
    json_value_set(object, "slider_position_min_m", summary->slide.low);
    json_value_set(object, "slider_position_max_m", summary->slide.high);
    json_value_set(object, "slider_velocity_min_m_s", summary->velocity.low);
    json_value_set(object, "slider_velocity_min_crank_deg",
                   units_wrapped_deg(summary->velocity.low_angle));
    json_value_set(object, "slider_velocity_max_m_s", summary->velocity.high);
    json_value_set(object, "slider_velocity_max_crank_deg",
                   units_wrapped_deg(summary->velocity.high_angle));
    json_value_set(object, "slider_acceleration_min_m_s2", summary->acceleration.low);
    json_value_set(object, "slider_acceleration_min_crank_deg",
                   units_wrapped_deg(summary->acceleration.low_angle));
    json_value_set(object, "slider_acceleration_max_m_s2", summary->acceleration.high);
    json_value_set(object, "slider_acceleration_max_crank_deg",
                   units_wrapped_deg(summary->acceleration.high_angle));
}

static json_t *analytic_json_kinematics(const RunReport *report)
{
    const AnalyticSummary *summary = report->summary;
    const bool has_slider = report->scenario->has_slidercrank;
    json_t *object = json_object();
    json_object_set_new(
        object, "class",
        json_string(has_slider ? "slider-crank" : FOURBAR_GRASHOF_NAMES[summary->grashof]));
    json_value_set(object, "transmission_angle_min_rad", summary->transmission_low);
    json_value_set(object, "transmission_angle_max_rad", summary->transmission_high);
    json_value_set(object, "transmission_angle_min_crank_deg",
                   units_wrapped_deg(summary->transmission_low_crank));
    json_value_set(object, "transmission_angle_max_crank_deg",
                   units_wrapped_deg(summary->transmission_high_crank));
    if (has_slider) {
        set_slider(object, summary);
    } else {
        set_follower(object, summary);
    }
    if (summary->has_limits) {
        json_value_set(object, "limit_stretched_crank_deg",
                       units_wrapped_deg(summary->limit_extended));
        json_value_set(object, "limit_folded_crank_deg", units_wrapped_deg(summary->limit_folded));
    }
    return object;
}

static json_t *range_object(Extreme high, Extreme low, const char *high_key, const char *low_key)
{
    json_t *object = json_object();
    json_value_set(object, high_key, high.value);
    json_value_set(object, "max_crank_deg", units_wrapped_deg(high.crank_rad));
    json_value_set(object, low_key, low.value);
    json_value_set(object, "min_crank_deg", units_wrapped_deg(low.crank_rad));
    return object;
}

static json_t *analytic_json_forces(const RunReport *report)
{
    const AnalyticSummary *summary = report->summary;
    const Linkage *linkage = &report->scenario->linkage;
    json_t *object = json_object();
    json_object_set_new(
        object, "drive_torque",
        range_object(summary->torque_max, summary->torque_min, "max_N_m", "min_N_m"));
    json_t *reactions = json_object();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        json_object_set_new(
            reactions, linkage->joints[i].name,
            range_object(summary->reaction_max[i], summary->reaction_min[i], "max_N", "min_N"));
    }
    json_object_set_new(object, "reactions", reactions);
    json_value_set(object, "power_residual", summary->power_residual);
    return object;
}

// One end of a quantity: nominal, worst case, the corner it stands in, each source alone.
static json_t *bound_object(const Stackup *stackup, const StackupBound *bound, double nominal)
{
    json_t *object = json_object();
    json_value_set(object, "nominal", nominal);
    json_value_set(object, "worst", bound->value);
    json_t *corner = json_object();
    json_t *alone = json_object();
    for (int i = 0; i < STACKUP_SOURCES; i++) {
        if (!stackup->is_source[i]) {
            continue;
        }
        json_value_set(alone, STACKUP_SOURCE_NAMES[i], bound->alone[i]);
        if (i < STACKUP_LENGTHS) {
            const int side = bound->combination.length_side[i];
            json_object_set_new(corner, STACKUP_SOURCE_NAMES[i],
                                json_string(side > 0   ? "largest"
                                            : side < 0 ? "smallest"
                                                       : "nominal"));
            continue;
        }
        const int link = bound->combination.play_link[i - STACKUP_LENGTHS];
        const int sign = bound->combination.play_sign[i - STACKUP_LENGTHS];
        json_object_set_new(corner, STACKUP_SOURCE_NAMES[i],
                            link < 0 ? json_string("none")
                                     : json_sprintf("%s %s", sign > 0 ? "stretches" : "shortens",
                                                    STACKUP_LENGTH_NAMES[link]));
    }
    json_object_set_new(object, "corner", corner);
    json_object_set_new(object, "alone", alone);
    return object;
}

static json_t *analytic_json_stackup(const RunReport *report)
{
    const Stackup *stackup = report->stackup;
    json_t *rows = json_array();
    for (int i = 0; i < FOURBAR_QUANTITY_COUNT; i++) {
        const StackupRow *row = &stackup->rows[i];
        json_t *object = json_object();
        json_object_set_new(object, "quantity", json_string(STACKUP_QUANTITY_NAMES[i]));
        json_object_set_new(object, "min", bound_object(stackup, &row->low, row->nominal_low));
        json_object_set_new(object, "max", bound_object(stackup, &row->high, row->nominal_high));
        json_array_append_new(rows, object);
    }
    return rows;
}

// A number whose key ends in its unit.
static void set_in(json_t *object, const char *name, const char *unit, double value)
{
    char key[64];
    snprintf(key, sizeof key, "%s_%s", name, unit);
    json_value_set(object, key, value);
}

static json_t *bodies_object(const Linkage *linkage, const NumberSource *of)
{
    const Trajectory *run = of->run;
    json_t *bodies = json_object();
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (!linkage_is_driven(linkage, (int)i)) {
            json_t *body = json_object();
            number_fields_json(body, NUMBER_OWNER_BODY, of, linkage, i);
            spike_json_set(body, NUMBER_OWNER_BODY_SPIKE, run, i);
            json_object_set_new(bodies, linkage->bodies[i].name, body);
        }
    }
    return bodies;
}

static json_t *contacts_array(const Linkage *linkage, const NumberSource *of, size_t joint,
                              bool is_felt)
{
    const JointExtremes *extremes = &of->run->joints[joint];
    json_t *contacts = json_array();
    for (size_t i = 0; is_felt && i < extremes->spike_count; i++) {
        NumberSource source = *of;
        source.contact = &extremes->spikes[i];
        json_t *contact = json_object();
        number_fields_json(contact, NUMBER_OWNER_JOINT_CONTACT, &source, linkage, joint);
        json_array_append_new(contacts, contact);
    }
    return contacts;
}

// Of a slider, at the samples; and of a block how it tilts.
static void set_slide(json_t *object, const Linkage *linkage, const Trajectory *run, size_t number,
                      bool is_felt)
{
    const Joint *joint = &linkage->joints[number];
    const SlideRange range = slide_range_find(linkage, run, number);
    json_value_set(object, "slide_min_m", range.position[0].value);
    json_value_set(object, "slide_max_m", range.position[1].value);
    json_value_set(object, "slide_velocity_min_m_s", range.velocity[0].value);
    json_value_set(object, "slide_velocity_max_m_s", range.velocity[1].value);
    json_value_set(object, "slide_acceleration_min_m_s2", range.acceleration[0].value);
    json_value_set(object, "slide_acceleration_max_m_s2", range.acceleration[1].value);
    if (joint_has_guides(joint->kind)) {
        json_value_set(object, "tilt_max_rad", is_felt ? run->joints[number].tilt_max.value : NAN);
        json_value_set(object, "tilt_limit_rad", linkage_guide_tilt(&joint->guide));
        json_value_set(object, "resultant_max_N", is_felt ? range.resultant.value : NAN);
    }
}

// The ends of a limited coordinate, and where it was at the samples.
static void set_limits(json_t *object, const Linkage *linkage, const Trajectory *run, size_t number)
{
    const Joint *joint = &linkage->joints[number];
    const char *unit = joint_units(joint)->length_key;
    double least = INFINITY;
    double most = -INFINITY;
    for (size_t i = 0; i < run->sample_count; i++) {
        const double now =
            linkage->is_spatial
                ? trajectory_state(run, i, number)->tilt
                : coordinate_position(linkage, trajectory_motion(run, i, 0), (int)number);
        least = fmin(least, now);
        most = fmax(most, now);
    }
    set_in(object, "limit_low", unit, coordinate_low(joint));
    set_in(object, "limit_high", unit, coordinate_high(joint));
    set_in(object, "coordinate_min", unit, least);
    set_in(object, "coordinate_max", unit, most);
}

// What wears a pin, with its share by sectors of the wall.
static void set_wear(json_t *object, const Linkage *linkage, const NumberSource *of, size_t number)
{
    const Wear wear = wear_of(of->run, number);
    if (!wear.is_known) {
        return;
    }
    json_t *made = json_object();
    number_fields_json(made, NUMBER_OWNER_JOINT_WEAR, of, linkage, number);
    json_t *sectors = json_array();
    for (size_t i = 0; i < WEAR_SECTORS; i++) {
        json_array_append_new(sectors, json_value_real(wear.sectors[i]));
    }
    json_object_set_new(made, "sectors", sectors);
    json_object_set_new(object, "wear", made);
}

static json_t *joint_object(const Linkage *linkage, const NumberSource *of, size_t number)
{
    const Trajectory *run = of->run;
    const Joint *joint = &linkage->joints[number];
    const bool has_play = linkage_has_play(joint);
    const bool is_felt = trajectory_feels_play(run, joint);
    json_t *object = json_object();
    number_fields_json(object, NUMBER_OWNER_JOINT, of, linkage, number);
    if (slide_range_has(joint)) {
        set_slide(object, linkage, run, number, is_felt);
    }
    json_object_set_new(object, "has_play", json_boolean(has_play));
    if (joint->limits.kind != LIMIT_NONE) {
        set_limits(object, linkage, run, number);
    } else if (has_play && !joint_has_disc(joint->kind)) {
        json_value_set(object, "radial_clearance_m", linkage_radial_clearance(joint));
    }
    json_object_set_new(object, "spikes", contacts_array(linkage, of, number, is_felt));
    spike_json_set(object, NUMBER_OWNER_JOINT_SPIKE, run, number);
    set_wear(object, linkage, of, number);
    return object;
}

static json_t *joints_object(const Linkage *linkage, const NumberSource *of)
{
    json_t *joints = json_object();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        json_object_set_new(joints, linkage->joints[i].name, joint_object(linkage, of, i));
    }
    return joints;
}

static void set_extreme(json_t *object, const char *name, const char *unit, const Extreme *extreme)
{
    char key[48];
    snprintf(key, sizeof key, "%s_max_%s", name, unit);
    json_value_set(object, key, extreme->value);
    snprintf(key, sizeof key, "%s_max_time_s", name);
    json_value_set(object, key, extreme->time_s);
}

static json_t *bushings_object(const Trajectory *run)
{
    json_t *bushings = json_object();
    for (size_t i = 0; i < run->linkage.bushing_count; i++) {
        const BushingExtremes extremes = bushing_extremes(run, i);
        json_t *object = json_object();
        set_extreme(object, "force", "N", &extremes.force);
        set_extreme(object, "torque", "N_m", &extremes.torque);
        set_extreme(object, "deflection", "m", &extremes.deflection);
        set_extreme(object, "angle", "rad", &extremes.angle);
        json_object_set_new(bushings, run->linkage.bushings[i].name, object);
    }
    return bushings;
}

// What another engine said of itself; null of a solver of our own.
static json_t *engine_object(const TrajectoryEngine *engine)
{
    if (engine->name[0] == '\0') {
        return json_null();
    }
    return json_pack("{s:o, s:o, s:o, s:o, s:o}", "name", json_value_text(engine->name), "version",
                     json_value_text(engine->version), "precision",
                     json_value_text(engine->precision), "way", json_value_text(engine->way),
                     "settings", json_value_text(engine->settings));
}

static json_t *run_object(const RunReport *report, size_t index)
{
    const Trajectory *run = report->runs[index];
    const Linkage *linkage = &report->scenario->linkage;
    json_t *object = fields_json(RUN_FIELDS, FIELD_JSON, run);
    if (!run->is_complete) {
        return object;
    }
    const NumberSource source = run_report_source(report, index);
    number_fields_json(object, NUMBER_OWNER_COST, &source, linkage, 0);
    json_object_set_new(object, "tolerance_held",
                        run->trials > 0 ? json_boolean(!run->is_short && !run->estimate_is_cut)
                                        : json_null());
    number_fields_json(object, NUMBER_OWNER_RUN, &source, linkage, 0);
    json_object_set_new(object, "engine", engine_object(&run->engine));
    json_object_set_new(object, "bodies", bodies_object(linkage, &source));
    json_object_set_new(object, "joints", joints_object(linkage, &source));
    if (linkage->bushing_count > 0) {
        json_object_set_new(object, "bushings", bushings_object(run));
    }
    json_object_set_new(object, "error", run_truth_json_error(report, index));
    json_t *energy = json_object();
    number_fields_json(energy, NUMBER_OWNER_ENERGY, &source, linkage, 0);
    json_object_set_new(object, "energy", energy);
    run_signals_json(object, report->scenario, run);
    json_object_set_new(object, "spike_bands", spike_json_bands(report, run));
    json_object_set_new(object, "spike_match", run_truth_json_matches(report, index));
    json_object_set_new(object, "ensemble", run_truth_json_ensemble(report, index));
    json_object_set_new(object, "hash", json_sprintf("%016" PRIx64, run->hash));
    return object;
}

// Why something is missing.
static json_t *message_object(const char *message)
{
    json_t *object = json_object();
    json_object_set_new(object, "message", json_value_text(message));
    return object;
}

json_t *run_json_build(const void *of)
{
    const RunReport *report = of;
    json_t *object = json_object();
    settings_json_begin(object, report->scenario);
    assumed_json(object, report->scenario);
    run_overview_json(object, report);
    spread_json(object, report->spread);
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
