// What a case expects of its own runs: limits for their numbers, and how they end. `expect:` in a
// case file.
#pragma once

#include "model/linkage.h"
#include "model/numbers.h"

enum {
    EXPECTATION_MAX = 48, // of one case
    EXPECTATION_PATH_SIZE = 128,
    EXPECTATION_WORDS_SIZE = 96,
    EXPECTATION_UNIT_SIZE = 16,
    EXPECTATION_ANY_BACKEND = -1,
    OUTCOME_MAX = 24, // of one case
    OUTCOME_WORDS_SIZE = 160,
};

typedef struct Expectation {
    char path[EXPECTATION_PATH_SIZE]; // without a backend: joints.crank-coupler.force_max
    int backend;                      // EXPECTATION_ANY_BACKEND: every one that feels the play
    NumberId number;
    int member;                         // of the bodies or joints; 0 where there is none
    double low;                         // SI; -INFINITY where there is no such end
    double high;                        // SI; INFINITY likewise
    bool is_open;                       // the ends themselves are outside
    char words[EXPECTATION_WORDS_SIZE]; // as the case has it: "below 1.2 kN"
    char unit[EXPECTATION_UNIT_SIZE];   // of the words, empty for plain numbers
    double unit_si;                     // 1 of the unit in SI
} Expectation;

// How a run can end.
typedef enum OutcomeKind {
    OUTCOME_AGREES,   // complete, its error within a limit
    OUTCOME_REPORTED, // complete, its error above a limit: `jointplay run` prints that error
    OUTCOME_DETECTED, // stopped with a message after its first step, or short of its tolerance
    OUTCOME_REFUSED,  // not begun: the case or a solver says why
    OUTCOME_KIND_COUNT,
} OutcomeKind;

typedef struct ExpectedOutcome {
    char of[EXPECTATION_PATH_SIZE]; // a backend, or the words of schemes of ODE, with / between
                                    // them; empty: every backend that feels the play
    OutcomeKind kind;
    double limit;                     // 1, of the error: agreed within, or reported above
    char message[OUTCOME_WORDS_SIZE]; // words of the message of a run that is detected or refused
    char words[OUTCOME_WORDS_SIZE];   // as the case has it: "agrees within 1e-6"
} ExpectedOutcome;
