// What are errors and distributions called, and in which units?
#include "write/measured_fields.h"

#define ERROR(member)  offsetof(TrajectoryError, member)
#define SPREAD(member) offsetof(Distribution, member)
#define METRIC(number) (sizeof(Distribution) * (number))

enum { KEPT = FIELD_JSON | FIELD_STORE, SHOWN = KEPT | FIELD_CSV };

// clang-format off
const Field ERROR_FIELDS[] = {
    {"is_known",             NULL, NULL, FIELD_FLAG,   ERROR(is_known),             .where = FIELD_STORE},
    {"omega_max",            NULL, NULL, FIELD_NUMBER, ERROR(omega_max),            .where = SHOWN},
    {"omega_max_time_s",     NULL, NULL, FIELD_NUMBER, ERROR(omega_max_time_s),     .where = KEPT},
    {"omega_max_in_horizon", NULL, NULL, FIELD_NUMBER, ERROR(omega_max_in_horizon), .where = KEPT},
    {"omega_rms",            NULL, NULL, FIELD_NUMBER, ERROR(omega_rms),            .where = SHOWN},
    {"alpha_max",            NULL, NULL, FIELD_NUMBER, ERROR(alpha_max),            .where = SHOWN},
    {"angle_max_rad",        NULL, NULL, FIELD_NUMBER, ERROR(angle_max_rad),        .where = SHOWN},
    {0},
};

static const Field DISTRIBUTION_FIELDS[] = {
    {"low",       "low",    "", FIELD_NUMBER, SPREAD(low),       .where = KEPT},
    {"median",    "median", "", FIELD_NUMBER, SPREAD(median),    .where = KEPT},
    {"high",      "high",   "", FIELD_NUMBER, SPREAD(high),      .where = KEPT},
    {"mean",      "mean",   "", FIELD_NUMBER, SPREAD(mean),      .where = KEPT},
    {"deviation", "+-",     "", FIELD_NUMBER, SPREAD(deviation), .where = KEPT},
    {0},
};

const Field METRIC_FIELDS[ENSEMBLE_METRIC_COUNT + 1] = {
    {"force_max_N",       "force max",  "N",   FIELD_GROUP, METRIC(ENSEMBLE_FORCE_MAX),
     KEPT, .of = DISTRIBUTION_FIELDS},
    {"impulse_N_s",       "impulse",    "N s", FIELD_GROUP, METRIC(ENSEMBLE_IMPULSE),
     KEPT, .of = DISTRIBUTION_FIELDS},
    {"impacts",           "impacts",    "",    FIELD_GROUP, METRIC(ENSEMBLE_IMPACTS),
     KEPT, .of = DISTRIBUTION_FIELDS},
    {"penetration_max_m", "deepest",    "um",  FIELD_GROUP, METRIC(ENSEMBLE_PENETRATION_MAX),
     KEPT, .of = DISTRIBUTION_FIELDS},
    {"contact_fraction",  "in contact", "%",   FIELD_GROUP, METRIC(ENSEMBLE_CONTACT_SHARE),
     KEPT, .of = DISTRIBUTION_FIELDS},
    {0},
};
// clang-format on

json_t *ensemble_joints_json(const Linkage *linkage, const Ensemble *ensemble)
{
    json_t *joints = json_object();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_CLEARANCE) {
            json_object_set_new(joints, linkage->joints[i].name,
                                fields_json(METRIC_FIELDS, FIELD_JSON, ensemble->joints[i]));
        }
    }
    return joints;
}

bool ensemble_joints_read(const Linkage *linkage, const json_t *joints, Ensemble *ensemble)
{
    bool is_right = true;
    for (size_t i = 0; is_right && i < linkage->joint_count; i++) {
        is_right =
            linkage->joints[i].kind != JOINT_CLEARANCE ||
            fields_json_read(METRIC_FIELDS, FIELD_STORE,
                             json_object_get(joints, linkage->joints[i].name), ensemble->joints[i]);
    }
    return is_right;
}
