// Case files: YAML in, a complete Scenario in SI out; and the words about them.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

enum { CASEFILE_KEY_SIZE = 160, CASEFILE_UNIT_SIZE = 24, CASEFILE_TEXT_SIZE = 256 };

// Reads a case file, or standard input where the path is "-", applies the overrides (each
// KEY=VALUE, such as "run.step=2 us", with the value as the case file would have it; of two for one
// key the later holds), checks everything and builds the scenario, start motions included. An
// override of one of two keys that exclude each other replaces the other.
//
// Fails with ERR_FILE where the file is missing or unreadable, with ERR_CASE where its content is
// wrong (a directory, an empty, binary or huge file included), and with ERR_USAGE where the fault
// lies in an override. The scenario is then untouched; else it is for scenario_free.
bool casefile_load(const char *path, const char *const *overrides, size_t override_count,
                   Scenario *scenario, Err *err);

// The same from memory. The name stands in messages and is the path of the scenario.
bool casefile_load_text(const char *name, const char *text, size_t size,
                        const char *const *overrides, size_t override_count, Scenario *scenario,
                        Err *err);

// A case that is read once for many scenarios, whose overrides differ in nothing but their values.
typedef struct CasefileRepeat CasefileRepeat;

// The text must outlive it. Reads nothing yet. Closing accepts NULL. The overrides are those of a
// program, whose messages begin with the key, or of the command line, with --set KEY=VALUE.
CasefileRepeat *casefile_repeat_open(const char *name, const char *text, size_t size,
                                     bool is_program);
void casefile_repeat_close(CasefileRepeat *repeat);

// The scenario of the case with these overrides, or the error, that casefile_load_text would give.
bool casefile_repeat(CasefileRepeat *repeat, const char *const *overrides, size_t override_count,
                     Scenario *scenario, Err *err);

// What a case file that casefile_load refuses expects: whether it says `refused with` of all its
// runs, which holds for the file itself, and its title, empty where it has none. Settings of the
// command line are left aside.
bool casefile_expects_refusal(const char *path, char title[SCENARIO_TITLE_SIZE],
                              ExpectedOutcome *outcome);

// Appends the case format for people, in lines of so many columns: its sections, a line each; all
// keys of all sections; and the page docs/case-format.md.
void casefile_describe(int width, Text *text);
void casefile_describe_all(int width, Text *text);
void casefile_describe_markdown(Text *text);

// Appends one section with its keys, such as joints, or else all keys that a path or the end of one
// names, such as contact.friction, joints.pin.friction or friction. Fails with ERR_USAGE where the
// word names none.
bool casefile_describe_part(const char *name, int width, Text *text, Err *err);

// Whether the case or the command line gives a key whose path begins so, such as "ode.".
bool casefile_gives(const Scenario *scenario, const char *beginning);

// Appends a line for each key that the case or the command line gives and that the scenario, as it
// is now, makes no use of: where it stands, and what would. A key of the file beside which the
// command line replaces what decides about it is left out. Returns how many. What is not in the
// file is of the command line, or was set by a program.
size_t casefile_unused(const Scenario *scenario, bool is_program, Text *lines);

typedef enum CasefileKind {
    CASEFILE_NUMBER,    // a quantity in SI, or a vector of two or three
    CASEFILE_TOLERATED, // a length with a tolerance: nominal, and both limits as deviations
    CASEFILE_INTEGER,   // a whole number, in numbers[0]
    CASEFILE_WORD,      // one of a list of words
    CASEFILE_WORDS,     // several of a list of words, separated by ", "
    CASEFILE_TEXT,      // free text, or names separated by ", "
    CASEFILE_POINTS,    // numbers in pairs: times and torques or speeds
} CasefileKind;

// One resolved setting of a scenario.
typedef struct CasefileSetting {
    char key[CASEFILE_KEY_SIZE]; // as in a case file: joints.crank-coupler.hole
    CasefileKind kind;
    size_t number_count;                // 0 of words
    char unit[CASEFILE_UNIT_SIZE];      // SI, empty for plain numbers
    char text[CASEFILE_TEXT_SIZE];      // of a word, words or text
    bool applies;                       // the scenario makes use of it
    double numbers[2 * LOAD_TABLE_MAX]; // SI; only so many are set, and the first three
} CasefileSetting;

// Goes through the settings in the schema's order: those of every body, joint and spring of the
// scenario and, with a star for the name, of one that it does not have.
//
//     CasefileWalk walk = casefile_walk(scenario);
//     while (casefile_next(&walk, &setting)) {
typedef struct CasefileWalk {
    const Scenario *scenario;
    size_t row;    // of the schema
    size_t member; // of the row's family, the next
    unsigned met;  // of what rows ask of the scenario as a whole
} CasefileWalk;

CasefileWalk casefile_walk(const Scenario *scenario);

// The next setting; false behind the last.
bool casefile_next(CasefileWalk *walk, CasefileSetting *setting);

// One of them by its key; false where the scenario has none of that key.
bool casefile_find(const Scenario *scenario, const char *key, CasefileSetting *setting);

// What a case says of a signal, or of a part of a sinusoid, which are no settings of a scenario.
typedef struct CasefileSignal {
    Text text;                     // as a case file may have it; for text_finish
    char unit[CASEFILE_UNIT_SIZE]; // SI, of the number; empty where it is none
    size_t number_count;           // 0 of a list of points and of a sinusoid
    double number;                 // SI
} CasefileSignal;

// That of a key such as signals.gust.amplitude or drive.speed.phase, in a case that casefile_load
// accepts with these overrides. False where the case has no such value.
bool casefile_signal(const char *text, size_t size, const char *const *overrides,
                     size_t override_count, const char *key, CasefileSignal *signal);

// How many settings there are.
size_t casefile_setting_count(const Scenario *scenario);
