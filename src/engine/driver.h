// Drivers: programs that run a case on a physics engine and say what came of it (docs/drivers.md).
//
// One conversation is one request, a JSON object on the driver's standard input, and an answer of
// one JSON object a line. A driver is asked once what it is, and then for runs.
#pragma once

#include "engine/engine_records.h"
#include "model/trajectory.h"

enum {
    ENGINE_PROTOCOL = 3,   // the newest; drivers of older ones get what these have words for
    ENGINE_NAME_SIZE = 32, // of drivers and ways
    ENGINE_TEXT_SIZE = 128,
    ENGINE_WAY_MAX = 8,
    ENGINE_DRIVER_MAX = 16,
    ENGINE_PATH_SIZE = 4096,
};

// A driver, and what it says of itself.
typedef struct EngineDriver {
    char name[ENGINE_NAME_SIZE];
    char program[ENGINE_PATH_SIZE];
    int protocol;                  // the newest that it speaks
    char engine[ENGINE_TEXT_SIZE]; // "MuJoCo"
    char version[ENGINE_TEXT_SIZE];
    char precision[ENGINE_TEXT_SIZE]; // "double"
    size_t way_count;
    char ways[ENGINE_WAY_MAX][ENGINE_NAME_SIZE]; // in which it can run a case
    unsigned takes[ENGINE_WAY_MAX]; // by way: what it takes, by the numbers of engine/features.h
} EngineDriver;

// Whether a word can be the name of a driver: lower-case letters, digits and '-', a letter first.
bool engine_is_name(const char *word);

// Finds a driver that came with the program, by its name, and asks it what it is. Fails with
// ERR_USAGE where there is none, and says which there are.
bool engine_find(const char *name, EngineDriver *driver, Err *err);

// The name in NAME=PROGRAM. Fails with ERR_USAGE where that has another form, or a backend of our
// own.
bool engine_given_name(const char *name_and_program, char name[ENGINE_NAME_SIZE], Err *err);

// Asks a program that is said to be a driver what it is: NAME=PROGRAM. Fails with ERR_USAGE where
// that has another form, with ERR_SOLVER where the program is no driver of this protocol.
bool engine_given(const char *name_and_program, EngineDriver *driver, Err *err);

// The names of the drivers that came with the program, separated by ", "; empty where none did.
void engine_list(char *text, size_t size);

// What a run says of itself beside its trajectory.
typedef struct EngineSaid {
    char settings[4 * ENGINE_TEXT_SIZE]; // of the engine, that are not its defaults
    double opening_m;                    // largest, of an ideal joint at a sample
    bool is_refused;                     // the driver does not take the case in that way
    char refused[ENGINE_TEXT_SIZE];      // what of it
    char **model; // where a file of the engine's own goes; NULL: it is not wanted
} EngineSaid;

// Runs a scenario by a driver in one of its ways, at the scenario's step, within so many seconds.
// Never fails as a function: where the run failed, or the case cannot be expressed, the trajectory
// is not complete and says why. Its wall time is that of the driver's stepping loop. The caller
// destroys it. `said` may be NULL.
Trajectory *engine_run(const EngineDriver *driver, const char *way, const Scenario *scenario,
                       double time_limit_s, EngineSaid *said);

// The same with records of what the engine did between the samples, of at least the length that
// they ask for: none where the driver tells nothing of it.
Trajectory *engine_run_recorded(const EngineDriver *driver, const char *way,
                                const Scenario *scenario, double time_limit_s, EngineSaid *said,
                                EngineRecords *records);

// The same; *model becomes the file of the engine's own that has the whole model, where the driver
// writes one, for free(), or NULL.
Trajectory *engine_run_model(const EngineDriver *driver, const char *way, const Scenario *scenario,
                             double time_limit_s, EngineSaid *said, char **model);

// Whether a scenario is of a kind that drivers can be told of; ERR_CASE, naming the engine and what
// its driver cannot take, where not.
bool engine_check(const char *engine, const Scenario *scenario, Err *err);

// Whether a driver takes a scenario in one of these ways at least, which need not have a start yet:
// the driver is asked for the first sample of each, within the limit of a run, s, and some 20 s at
// most. ERR_CASE as above, by the last of the ways. What else goes wrong shows when it runs.
bool engine_takes(const EngineDriver *driver, const char *const *ways, size_t count,
                  const Scenario *scenario, double time_limit_s, Err *err);
