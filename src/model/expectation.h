// What a case expects of its own runs: limits for their numbers, and how they end. `expect:` in a
// case file.
#pragma once

#include "model/joint_number_list.h"
#include "model/linkage.h"

enum {
    EXPECTATION_MAX = 48, // of one case
    EXPECTATION_PATH_SIZE = 128,
    EXPECTATION_WORDS_SIZE = 96,
    EXPECTATION_UNIT_SIZE = 16,
    EXPECTATION_ANY_BACKEND = -1,
    OUTCOME_MAX = 24, // of one case
    OUTCOME_WORDS_SIZE = 160,
};

#define EXPECTATION_OF_JOINT(id, ...) EXPECTED_##id,

// What is limited.
typedef enum ExpectedNumber {
    EXPECTED_OMEGA_MAX, // of a body, rad/s
    EXPECTED_OMEGA_MIN,
    EXPECTED_ALPHA_MAX, // rad/s^2
    EXPECTED_ALPHA_MIN,
    EXPECTED_ALPHA_SPIKES,
    EXPECTED_OMEGA_ORDER_1, // rad/s, amplitudes at orders
    EXPECTED_OMEGA_ORDER_2,
    EXPECTED_OMEGA_BETWEEN_ORDERS,
    EXPECTED_OMEGA_SECTION, // rad/s, at the end of the last whole revolution
    // of a joint, in the order of model/joint_number_list.h
    JOINT_NUMBERS_OF_ANY_LIST(EXPECTATION_OF_JOINT) EXPECTED_FORCE_SPIKES,
    JOINT_NUMBERS_OF_PLAY_LIST(EXPECTATION_OF_JOINT)
        EXPECTED_ERROR_MAX, // 1, as the six below up to the horizon of predictability
    EXPECTED_ERROR_OMEGA_MAX,
    EXPECTED_ERROR_OMEGA_RMS,
    EXPECTED_ERROR_ALPHA_MAX,
    EXPECTED_ERROR_FORCE_MAX,
    EXPECTED_ERROR_PEAK_FORCE_MAX,
    EXPECTED_ERROR_PEAK_ALPHA_MAX,
    EXPECTED_DRIVE_WORK, // J
    EXPECTED_DISSIPATED,
    EXPECTED_CHANGE,
    EXPECTED_RESIDUAL,
    EXPECTED_SECTION_PERIOD, // revolutions
    EXPECTED_SECTION_CHANGE, // 1
    EXPECTED_SETTLED_PERIOD, // revolutions, as all to the cost of the case's settled motion
    EXPECTED_SETTLED_MOTIONS,
    EXPECTED_SETTLED_SHARE,     // 1
    EXPECTED_SETTLED_GROWTH,    // 1
    EXPECTED_SETTLED_FORCE_MAX, // of a joint, N, as the two below
    EXPECTED_SETTLED_FORCE_MEDIAN,
    EXPECTED_SETTLED_FORCE_LARGEST,
    EXPECTED_STEPS, // of the cost
    EXPECTED_EVALUATIONS,
    EXPECTED_NUMBER_COUNT,
} ExpectedNumber;

typedef struct Expectation {
    char path[EXPECTATION_PATH_SIZE]; // without a backend: joints.crank-coupler.force_max
    int backend;                      // EXPECTATION_ANY_BACKEND: every one that feels the play
    ExpectedNumber number;
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
