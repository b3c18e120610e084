// The numbers of a joint in a run: one row each says all that is to be known of it.
//
// Text and JSON of `run`, the columns of a study, the metrics of `check`, the limits of `expect`
// and the tables of the pages follow from these rows.
#pragma once

// clang-format off
// id, name in keys, kind; heading of its column, that where limits turn the joint, format for
// people; whether the column is left out where it is narrow; whether it has a time; value, meaning.
//
// The value is an Extreme, of the joint's `extremes` in the `run`, where it has this `number`;
// only(x) is one that stands at no time. It is finite in every complete run that has it, or `check`
// refuses the run. Rows of kind COUNT stand before the others in tables and studies, those of kind
// SHARE behind them.
#define JOINT_NUMBERS_OF_ANY_LIST(row) \
    row(FORCE_MAX, "force_max", FORCE, "force max", "torque max", NULL, false, true, \
        extremes->force_max, "largest force")

// Of joints with play: known where the solver lets it happen.
#define JOINT_NUMBERS_OF_PLAY_LIST(row) \
    row(IMPACTS, "impacts", COUNT, "impacts", "impacts", NULL, false, false, \
        only((double)extremes->impacts), "contacts begun") \
    row(IMPULSE, "impulse", IMPULSE, "impulse", "impulse", NULL, true, false, \
        only(extremes->impulse), "impulse of all contacts") \
    row(PENETRATION_MAX, "penetration_max", DEPTH, "deepest", "deepest", NULL, false, false, \
        only(extremes->penetration_max.value), "deepest penetration") \
    row(CONTACT_FRACTION, "contact_fraction", SHARE, "in contact", "in contact", "%.1f", false, \
        false, only(trajectory_contact_share(run, number)), "share of the time in contact")
// clang-format on

#define JOINT_NUMBERS_ID(id, ...) JOINT_NUMBER_##id,

typedef enum JointNumberId {
    JOINT_NUMBERS_OF_ANY_LIST(JOINT_NUMBERS_ID) JOINT_NUMBERS_OF_PLAY_LIST(JOINT_NUMBERS_ID)
        JOINT_NUMBER_COUNT
} JointNumberId;

// What a number is of; its unit follows, and below which size it is rounding (run_floor_joint).
typedef enum JointNumberKind {
    JOINT_NUMBER_OF_COUNT,   // a whole number
    JOINT_NUMBER_OF_SHARE,   // 1
    JOINT_NUMBER_OF_FORCE,   // N, or N m where limits turn the joint
    JOINT_NUMBER_OF_IMPULSE, // N s, N m s
    JOINT_NUMBER_OF_DEPTH,   // m, rad
} JointNumberKind;
