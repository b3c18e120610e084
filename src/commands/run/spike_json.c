// What do other programs read of the spikes?
#include "commands/run/run_report.h"
#include "write/json_value.h"

#include <stdio.h>

static void set_with_unit(json_t *object, const char *name, const char *unit, double value)
{
    char key[128];
    snprintf(key, sizeof key, "%s_%s", name, unit);
    json_value_set(object, key, value);
}

void spike_json_set(json_t *object, unsigned where, const Linkage *linkage,
                    const SignalSpikes *spikes)
{
    const bool is_alpha = where == RUN_ALPHA;
    const char *name = is_alpha ? "alpha" : "force";
    const char *unit = is_alpha ? "rad_s2" : where == RUN_FORCE ? "N" : "N_m";
    const unsigned columns =
        where | FIELD_JSON | (linkage->driver.is_present ? RUN_DRIVEN : RUN_NO_CRANK);
    char key[64];
    json_t *array = spikes->is_known ? json_array() : json_null();
    for (size_t i = 0; spikes->is_known && i < spikes->kept; i++) {
        const int joint = spikes->spikes[i].joint;
        json_t *spike = fields_json(RUN_SPIKE_FIELDS, columns, &spikes->spikes[i]);
        json_object_set_new(spike, "joint",
                            joint >= 0 ? json_string(linkage->joints[joint].name) : json_null());
        json_array_append_new(array, spike);
    }
    snprintf(key, sizeof key, "%s_spikes", name);
    json_object_set_new(object, key, array);
    snprintf(key, sizeof key, "%s_spike_count", name);
    json_object_set_new(object, key,
                        spikes->is_known ? json_integer((json_int_t)spikes->count) : json_null());
    snprintf(key, sizeof key, "%s_spike_threshold", name);
    set_with_unit(object, key, unit, spikes->is_known ? spikes->threshold : NAN);
    snprintf(key, sizeof key, "%s_spike_resolution", name);
    set_with_unit(object, key, unit, spikes->is_known ? spikes->resolution : NAN);
}

static json_t *band_object(const SignalSpikes *spikes, const char *unit)
{
    const SpikeBandSums sums = spike_bands_sums(spikes);
    json_t *object = json_object();
    json_object_set_new(object, "inside", json_integer((json_int_t)sums.inside.count));
    json_object_set_new(object, "outside", json_integer((json_int_t)sums.outside.count));
    set_with_unit(object, "largest_inside", unit,
                  sums.inside.count > 0 ? sums.inside.largest : NAN);
    set_with_unit(object, "largest_outside", unit,
                  sums.outside.count > 0 ? sums.outside.largest : NAN);
    return object;
}

json_t *spike_json_bands(const RunReport *report, const Trajectory *run)
{
    const Linkage *linkage = &report->scenario->linkage;
    if (!spike_bands_apply(report)) {
        return json_null();
    }
    json_t *bands = json_array();
    json_t *bodies = json_object();
    json_t *joints = json_object();
    for (size_t i = 0; i < SPIKE_BAND_COUNT; i++) {
        json_array_append_new(
            bands, json_pack("[f, f]", spike_bands_first_deg(i), spike_bands_last_deg(i)));
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        if ((int)i != linkage_driven_body(linkage) && run->alpha_spikes[i].is_known) {
            json_object_set_new(bodies, linkage->bodies[i].name,
                                band_object(&run->alpha_spikes[i], "rad_s2"));
        }
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (run->force_spikes[i].is_known) {
            json_object_set_new(joints, linkage->joints[i].name,
                                band_object(&run->force_spikes[i], "N"));
        }
    }
    return json_pack("{s:o, s:o, s:o}", "bands_deg", bands, "bodies", bodies, "joints", joints);
}
