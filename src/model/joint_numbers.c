// Makes the table of the numbers of a joint from their list.
#include "model/joint_numbers.h"

#include <math.h>

// Behind the name in keys, and for people: of what pushes, and of what turns; behind the name of a
// metric that is a plain number.
#define UNITS_OF_COUNT   "", "", "", "", ""
#define UNITS_OF_SHARE   "", "%", "", "%", "_1"
#define UNITS_OF_FORCE   "_N", "N", "_N_m", "N m", ""
#define UNITS_OF_IMPULSE "_N_s", "N s", "_N_m_s", "N m s", ""
#define UNITS_OF_DEPTH   "_m", "um", "_rad", "mrad", ""

#define ROW_UNITS(name, units)  ROW_UNITS_OF(name, units)
#define ROW_UNITS_OF(name, ...) ROW_UNITS_SPLIT(name, __VA_ARGS__)
#define ROW_UNITS_SPLIT(name, key, unit, turned_key, turned_unit, plain)                           \
    .keys = {name key, name turned_key}, .units = {unit, turned_unit}, .check_end = plain

#define ROW(id, word, of, title, turned, shown_as, detail, timed, value, words)                    \
    [JOINT_NUMBER_##id] = {.name = word,                                                           \
                           .kind = JOINT_NUMBER_OF_##of,                                           \
                           .is_timed = timed,                                                      \
                           .is_detail = detail,                                                    \
                           .format = shown_as,                                                     \
                           .titles = {title, turned},                                              \
                           ROW_UNITS(word, UNITS_OF_##of),                                         \
                           .crank_key = word "_crank_deg",                                         \
                           .meaning = words,
#define ROW_OF_ANY(...)                                                                            \
    ROW(__VA_ARGS__)                                                                               \
    }                                                                                              \
    ,
#define ROW_OF_PLAY(...)                                                                           \
    ROW(__VA_ARGS__).is_of_play = true                                                             \
    }                                                                                              \
    ,

const JointNumber JOINT_NUMBERS[JOINT_NUMBER_COUNT] = {JOINT_NUMBERS_OF_ANY_LIST(ROW_OF_ANY)
                                                           JOINT_NUMBERS_OF_PLAY_LIST(ROW_OF_PLAY)};

static Extreme only(double value)
{
    return (Extreme){value, NAN, NAN};
}

#define FINDER(id, word, of, title, turned, shown_as, detail, timed, value, words)                 \
    static Extreme find_##id(const Trajectory *run, size_t number, const JointExtremes *extremes)  \
    {                                                                                              \
        (void)run, (void)number, (void)extremes;                                                   \
        return value;                                                                              \
    }
JOINT_NUMBERS_OF_ANY_LIST(FINDER)
JOINT_NUMBERS_OF_PLAY_LIST(FINDER)

typedef Extreme (*Finder)(const Trajectory *run, size_t number, const JointExtremes *extremes);

#define ROW_FINDER(id, ...) [JOINT_NUMBER_##id] = find_##id,
static const Finder FINDERS[JOINT_NUMBER_COUNT] = {JOINT_NUMBERS_OF_ANY_LIST(ROW_FINDER)
                                                       JOINT_NUMBERS_OF_PLAY_LIST(ROW_FINDER)};

Extreme joint_numbers_find(JointNumberId id, const Trajectory *run, size_t joint)
{
    const bool is_known =
        !JOINT_NUMBERS[id].is_of_play || trajectory_feels_play(run, &run->linkage.joints[joint]);
    return is_known ? FINDERS[id](run, joint, &run->joints[joint]) : only(NAN);
}
