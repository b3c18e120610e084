// What are errors and distributions called, and in which units?
#include "write/measured_fields.h"

#define ERROR(member)  .offset = offsetof(TrajectoryError, member)
#define SPREAD(member) .offset = offsetof(Distribution, member)
#define METRIC(number) .offset = sizeof(Distribution) * (number)

enum { KEPT = FIELD_JSON | FIELD_STORE, SHOWN = KEPT | FIELD_CSV };

// clang-format off
const Field ERROR_FIELDS[] = {
    {"is_known", FIELD_FLAG, FIELD_STORE, ERROR(is_known)},
    {"omega_max", FIELD_NUMBER, SHOWN, ERROR(omega_max)},
    {"omega_max_time_s", FIELD_NUMBER, KEPT, ERROR(omega_max_time_s)},
    {"omega_max_in_horizon", FIELD_NUMBER, KEPT, ERROR(omega_max_in_horizon)},
    {"omega_rms", FIELD_NUMBER, SHOWN, ERROR(omega_rms)},
    {"alpha_max", FIELD_NUMBER, SHOWN, ERROR(alpha_max)},
    {"angle_max_rad", FIELD_NUMBER, SHOWN, ERROR(angle_max_rad)},
    {0},
};

static const Field DISTRIBUTION_FIELDS[] = {
    {"low", FIELD_NUMBER, KEPT, "low", "", SPREAD(low)},
    {"median", FIELD_NUMBER, KEPT, "median", "", SPREAD(median)},
    {"high", FIELD_NUMBER, KEPT, "high", "", SPREAD(high)},
    {"mean", FIELD_NUMBER, KEPT, "mean", "", SPREAD(mean)},
    {"deviation", FIELD_NUMBER, KEPT, "+-", "", SPREAD(deviation)},
    {0},
};

const Field METRIC_FIELDS[ENSEMBLE_METRIC_COUNT + 1] = {
    {"force_max_N", FIELD_GROUP, KEPT, "force max", "N", METRIC(ENSEMBLE_FORCE_MAX),
     .of = DISTRIBUTION_FIELDS},
    {"impulse_N_s", FIELD_GROUP, KEPT, "impulse", "N s", METRIC(ENSEMBLE_IMPULSE),
     .of = DISTRIBUTION_FIELDS},
    {"impacts", FIELD_GROUP, KEPT, "impacts", "", METRIC(ENSEMBLE_IMPACTS),
     .of = DISTRIBUTION_FIELDS},
    {"penetration_max_m", FIELD_GROUP, KEPT, "deepest", "um", METRIC(ENSEMBLE_PENETRATION_MAX),
     .of = DISTRIBUTION_FIELDS},
    {"contact_fraction", FIELD_GROUP, KEPT, "in contact", "%", METRIC(ENSEMBLE_CONTACT_SHARE),
     .of = DISTRIBUTION_FIELDS},
    {0},
};

static const Field TURNING_METRIC_FIELDS[ENSEMBLE_METRIC_COUNT + 1] = {
    {"force_max_N_m", FIELD_GROUP, KEPT, "force max", "N m", METRIC(ENSEMBLE_FORCE_MAX),
     .of = DISTRIBUTION_FIELDS},
    {"impulse_N_m_s", FIELD_GROUP, KEPT, "impulse", "N m s", METRIC(ENSEMBLE_IMPULSE),
     .of = DISTRIBUTION_FIELDS},
    {"impacts", FIELD_GROUP, KEPT, "impacts", "", METRIC(ENSEMBLE_IMPACTS),
     .of = DISTRIBUTION_FIELDS},
    {"penetration_max_rad", FIELD_GROUP, KEPT, "deepest", "mrad", METRIC(ENSEMBLE_PENETRATION_MAX),
     .of = DISTRIBUTION_FIELDS},
    {"contact_fraction", FIELD_GROUP, KEPT, "in contact", "%", METRIC(ENSEMBLE_CONTACT_SHARE),
     .of = DISTRIBUTION_FIELDS},
    {0},
};
// clang-format on

const Field *measured_metric_fields(const Joint *joint)
{
    return linkage_is_torsional(joint) ? TURNING_METRIC_FIELDS : METRIC_FIELDS;
}

json_t *ensemble_joints_json(const Linkage *linkage, const Ensemble *ensemble)
{
    json_t *joints = json_object();
    for (size_t i = 0; i < ensemble_joint_count(linkage); i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            const Field *fields = measured_metric_fields(&linkage->joints[i]);
            json_object_set_new(joints, linkage->joints[i].name,
                                fields_json(fields, FIELD_JSON, ensemble->joints[i]));
        }
    }
    return joints;
}

bool ensemble_joints_read(const Linkage *linkage, const json_t *joints, Ensemble *ensemble)
{
    bool is_right = true;
    for (size_t i = 0; is_right && i < ensemble_joint_count(linkage); i++) {
        is_right =
            !linkage_has_play(&linkage->joints[i]) ||
            fields_json_read(measured_metric_fields(&linkage->joints[i]), FIELD_STORE,
                             json_object_get(joints, linkage->joints[i].name), ensemble->joints[i]);
    }
    return is_right;
}
