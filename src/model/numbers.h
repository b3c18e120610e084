// The table of the numbers of a run (number_list.h); measure/number_values.h has them from a run.
#pragma once

#include "model/number_list.h"

// Whose numbers an owner has one each of.
typedef enum NumberMembers {
    NUMBER_OF_WHOLE,
    NUMBER_OF_BODIES,
    NUMBER_OF_JOINTS,
} NumberMembers;

typedef struct NumberOwnerRow {
    NumberMembers members;
    const char *path;   // the words of its paths in `expect`
    const char *before; // what stands before the names of its numbers there and in `check`
    const char *part;   // of the names of `check`; empty where that is the name of a member
} NumberOwnerRow;

extern const NumberOwnerRow NUMBER_OWNERS[NUMBER_OWNER_COUNT];

// What a number's unit is one of.
typedef enum NumberTurn {
    NUMBER_PUSHED, // of forces and lengths
    NUMBER_TURNED, // of joints whose limits turn them: torques and angles
    NUMBER_SPED,   // of signals that are accelerations
    NUMBER_TURN_COUNT,
} NumberTurn;

typedef struct Number {
    NumberOwner owner;
    const char *name;
    NumberKind kind;
    const char *titles[NUMBER_TURN_COUNT];    // of its column
    const char *format;                       // for people; NULL: four digits
    unsigned places;                          // NUMBER_JSON and the like
    unsigned traits;                          // NUMBER_TIMED and the like
    const char *keys[NUMBER_TURN_COUNT];      // name and unit, SI
    const char *columns[NUMBER_TURN_COUNT];   // of a study, behind the name of a member
    const char *unit_keys[NUMBER_TURN_COUNT]; // "_rad_s"; empty where there is none
    const char *units[NUMBER_TURN_COUNT];     // for people
    const char *crank_key;                    // of the crank's angle at that time
    const char *check_end;                    // what a metric of check has behind the key
    const char *meaning;
    const char *axis; // the meaning, short
} Number;

extern const Number NUMBERS[NUMBER_COUNT];

// Whether a number is whole.
static inline bool number_is_whole(const Number *number)
{
    return number->kind == NUMBER_OF_COUNT || number->kind == NUMBER_OF_EFFORT;
}

// Whose number it is: a body's, a joint's or that of a run as a whole.
static inline NumberMembers number_members(const Number *number)
{
    return NUMBER_OWNERS[number->owner].members;
}

// Whether it is one of joints with play alone.
static inline bool number_needs_play(const Number *number)
{
    return (number->traits & NUMBER_PLAY) != 0 || number->owner == NUMBER_OWNER_JOINT_CONTACT ||
           number->owner == NUMBER_OWNER_JOINT_WEAR;
}
