// What does the closed form say of the mechanism, for other programs?
#include "commands/run/run_report.h"
#include "write/json_value.h"
#include "write/units.h"

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

json_t *analytic_json_kinematics(const RunReport *report)
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

json_t *analytic_json_forces(const RunReport *report)
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

json_t *analytic_json_stackup(const RunReport *report)
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
