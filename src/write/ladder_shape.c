// Which keys must a line of a store have, and of which types?
#include "write/ladder_shape.h"

#include "write/ladder_json.h"

#include <string.h>

enum { HASH_DIGITS = 16 };

typedef enum Type {
    TYPE_TEXT,
    TYPE_BOOLEAN,
    TYPE_COUNT,  // a whole number that is not negative
    TYPE_NUMBER, // or null, for one that was not finite
    TYPE_STEP,   // s: a number that is not negative
    TYPE_HASH,
    TYPE_OBJECT,
} Type;

typedef struct Key {
    const char *name;
    Type type;
} Key;

static const Key TRUTH[] = {
    {"backend", TYPE_TEXT},       {"uncertainty", TYPE_NUMBER},
    {"horizon_s", TYPE_NUMBER},   {"growth", TYPE_NUMBER},
    {"is_limited", TYPE_BOOLEAN}, {"wall_s", TYPE_NUMBER},
    {"message", TYPE_TEXT},       {NULL, TYPE_TEXT},
};
static const Key ERROR[] = {
    {"scheme", TYPE_TEXT},
    {"step_s", TYPE_STEP},
    {"is_complete", TYPE_BOOLEAN},
    {"message", TYPE_TEXT},
    {"wall_s", TYPE_NUMBER},
    {"steps", TYPE_COUNT},
    {"evaluations", TYPE_COUNT},
    {"hash", TYPE_HASH},
    {"is_known", TYPE_BOOLEAN},
    {"omega_max", TYPE_NUMBER},
    {"omega_max_time_s", TYPE_NUMBER},
    {"omega_max_in_horizon", TYPE_NUMBER},
    {"omega_rms", TYPE_NUMBER},
    {"alpha_max", TYPE_NUMBER},
    {"angle_max_rad", TYPE_NUMBER},
    {NULL, TYPE_TEXT},
};
static const Key TIMING[] = {
    {"scheme", TYPE_TEXT},  {"step_s", TYPE_STEP},   {"is_complete", TYPE_BOOLEAN},
    {"message", TYPE_TEXT}, {"wall_s", TYPE_NUMBER}, {"round", TYPE_COUNT},
    {"machine", TYPE_TEXT}, {NULL, TYPE_TEXT},
};
static const Key ENSEMBLE[] = {
    {"scheme", TYPE_TEXT},  {"step_s", TYPE_STEP},  {"members", TYPE_COUNT},
    {"failed", TYPE_COUNT}, {"message", TYPE_TEXT}, {"joints", TYPE_OBJECT},
    {NULL, TYPE_TEXT},
};
static const Key DISTRIBUTION[] = {
    {"low", TYPE_NUMBER},  {"median", TYPE_NUMBER},    {"high", TYPE_NUMBER},
    {"mean", TYPE_NUMBER}, {"deviation", TYPE_NUMBER}, {NULL, TYPE_TEXT},
};

// A kind of line, by the one key that it has.
typedef struct Kind {
    const char *name;
    const Key *keys;
} Kind;

static bool is_hash(const json_t *value)
{
    const char *text = json_string_value(value);
    return text != NULL && strlen(text) == HASH_DIGITS &&
           strspn(text, "0123456789abcdef") == HASH_DIGITS;
}

static bool is_of_type(const json_t *value, Type type)
{
    switch (type) {
    case TYPE_TEXT:
        return json_is_string(value);
    case TYPE_BOOLEAN:
        return json_is_boolean(value);
    case TYPE_COUNT:
        return json_is_integer(value) && json_integer_value(value) >= 0;
    case TYPE_NUMBER:
        return json_is_number(value) || json_is_null(value);
    case TYPE_STEP:
        return json_is_number(value) && json_number_value(value) >= 0.0;
    case TYPE_HASH:
        return is_hash(value);
    case TYPE_OBJECT:
        break;
    }
    return json_is_object(value);
}

static bool has_keys(const json_t *object, const Key *keys)
{
    bool is_right = json_is_object(object);
    for (; is_right && keys->name != NULL; keys++) {
        is_right = is_of_type(json_object_get(object, keys->name), keys->type);
    }
    return is_right;
}

static bool has_joints(const json_t *joints, const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const json_t *metrics = json_object_get(joints, linkage->joints[i].name);
        for (int k = 0; linkage->joints[i].kind == JOINT_CLEARANCE && k < ENSEMBLE_METRIC_COUNT;
             k++) {
            if (!has_keys(json_object_get(metrics, LADDER_JSON_METRICS[k]), DISTRIBUTION)) {
                return false;
            }
        }
    }
    return true;
}

bool ladder_shape_is_right(const json_t *line, const Linkage *linkage)
{
    static const Kind KINDS[] = {
        {"truth", TRUTH}, {"error", ERROR}, {"timing", TIMING}, {"ensemble", ENSEMBLE}};
    for (size_t i = 0; i < sizeof KINDS / sizeof KINDS[0]; i++) {
        const json_t *object = json_object_get(line, KINDS[i].name);
        if (object != NULL) {
            return has_keys(object, KINDS[i].keys) &&
                   (KINDS[i].keys != ENSEMBLE ||
                    has_joints(json_object_get(object, "joints"), linkage));
        }
    }
    return false;
}
