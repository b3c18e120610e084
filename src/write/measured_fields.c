// The field tables of errors and distributions, and what first screens say of the truth.
#include "write/measured_fields.h"

#include "write/units.h"

#define ERROR(member)    .offset = offsetof(TrajectoryError, member)
#define OF_JOINT(member) .offset = offsetof(JointError, member)
#define OF_BODY(member)  .offset = offsetof(BodyError, member)
#define SPREAD(member)   .offset = offsetof(Distribution, member)
#define METRIC(number)   .offset = sizeof(Distribution) * (number)

enum { KEPT = FIELD_JSON | FIELD_STORE };

// Where a number of model/number_list.h stands, and how its column is set.
#define IN_TABLE(traits)                                                                           \
    (((traits) & (NUMBER_OF_FORCES | NUMBER_OF_PEAKS)) != 0 ? ERROR_OF_CONTACTS : FIELD_TABLE)
#define WHERE(places, traits)                                                                      \
    (((places)&NUMBER_JSON) != 0 ? KEPT : 0) | (((places)&NUMBER_CSV) != 0 ? FIELD_CSV : 0) |      \
        (((places)&NUMBER_TEXT) != 0 ? IN_TABLE(traits) : 0)
#define ALIGN(traits)                                                                              \
    (((traits)&NUMBER_DETAIL) != 0 ? TABLE_DETAIL : 0) |                                           \
        (((traits)&NUMBER_MINOR) != 0 ? TABLE_MINOR : 0)
#define FIRST_KEY(...)                FIRST_KEY_OF(__VA_ARGS__)
#define FIRST_KEY_OF(key, unit, ...)  key
#define FIRST_UNIT(...)               FIRST_UNIT_OF(__VA_ARGS__)
#define FIRST_UNIT_OF(key, unit, ...) unit

// clang-format off
#define ERROR_ROW(owner, id, name, kind, title, turned, format, places, traits, member, ...) \
    {name FIRST_KEY(NUMBER_UNITS_##kind), FIELD_NUMBER, WHERE(places, traits), title, \
     FIRST_UNIT(NUMBER_UNITS_##kind), format, ERROR(member), .align = ALIGN(traits)},
#define ERROR_WORDS(name, title, places, traits, member) \
    {name, FIELD_TEXT, WHERE(places, traits), title, "", ERROR(member), \
     .size = sizeof(((TrajectoryError *)NULL)->member), .align = TABLE_WRAP | ALIGN(traits)},

const Field ERROR_FIELDS[] = {
    {"is_known", FIELD_FLAG, FIELD_STORE, ERROR(is_known)},
    {"in_is_floor", FIELD_FLAG, KEPT, ERROR(is_floor)},
    NUMBERS_OF_ERROR_LIST(ERROR_ROW, ERROR_WORDS)
    {0},
};

const Field ERROR_JOINT_FIELDS[] = {
    {"force_max", FIELD_NUMBER, FIELD_JSON, OF_JOINT(force_max)},
    {"force_max_in_horizon", FIELD_NUMBER, FIELD_JSON, OF_JOINT(force_max_in_horizon)},
    {"peak_force_max", FIELD_NUMBER, FIELD_JSON, OF_JOINT(peak_max)},
    {"peak_force_max_in_horizon", FIELD_NUMBER, FIELD_JSON, OF_JOINT(peak_max_in_horizon)},
    {"missed", FIELD_COUNT, FIELD_JSON, OF_JOINT(missed)},
    {"extra", FIELD_COUNT, FIELD_JSON, OF_JOINT(extra)},
    {0},
};

const Field ERROR_BODY_FIELDS[] = {
    {"peak_alpha_max", FIELD_NUMBER, FIELD_JSON, OF_BODY(peak_max)},
    {"peak_alpha_max_in_horizon", FIELD_NUMBER, FIELD_JSON, OF_BODY(peak_max_in_horizon)},
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

// A row for each metric: the keys and units of what a joint's contacts push, or turn.
#define METRIC_ROW(key, title, unit, number) \
    {key, FIELD_GROUP, KEPT, title, unit, METRIC(number), .of = DISTRIBUTION_FIELDS}
#define METRIC_ROWS(force_key, force, impulse_key, impulse, depth_key, depth) \
    METRIC_ROW("force_max_" force_key, "force max", force, ENSEMBLE_FORCE_MAX), \
    METRIC_ROW("impulse_" impulse_key, "impulse", impulse, ENSEMBLE_IMPULSE), \
    METRIC_ROW("impacts", "impacts", "", ENSEMBLE_IMPACTS), \
    METRIC_ROW("penetration_max_" depth_key, "deepest", depth, ENSEMBLE_PENETRATION_MAX), \
    METRIC_ROW("contact_fraction", "in contact", "%", ENSEMBLE_CONTACT_SHARE), \
    {0}

static const Field PUSHING_FIELDS[ENSEMBLE_METRIC_COUNT + 1] = {
    METRIC_ROWS("N", "N", "N_s", "N s", "m", "um"),
};
static const Field TURNING_FIELDS[ENSEMBLE_METRIC_COUNT + 1] = {
    METRIC_ROWS("N_m", "N m", "N_m_s", "N m s", "rad", "mrad"),
};
// clang-format on

const Field *measured_metric_fields(const Joint *joint)
{
    return linkage_is_torsional(joint) ? TURNING_FIELDS : PUSHING_FIELDS;
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

void screen_truth(const LadderTruth *truth, Text *text)
{
    Text words;
    text_init(&words);
    if (truth->message[0] != '\0') {
        text_append(&words, "  Errors are against %s, which could not be certified: %.300s",
                    truth->backend, truth->message);
    } else {
        text_append(&words, "  Errors are against %s, which is right to %.2g", truth->backend,
                    truth->uncertainty);
    }
    if (truth->is_limited && truth->message[0] == '\0') {
        text_append(&words, ", up to %.4g ms: beyond, the motion cannot be predicted",
                    truth->horizon_s * UNITS_MS);
    }
    text_append(&words, ".");
    screen_line(&words, text);
}
