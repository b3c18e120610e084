// What the files of the protocol's side share: the request, and the reading of the answer.
#pragma once

#include "engine/driver.h"
#include "kernel/force_law.h"

#include <jansson.h>

// Says what of a case an engine cannot run: ERR_CASE.
bool engine_refuse(const char *engine, const char *what, Err *err);

// The request for a run of a scenario that engine_check passes, as one line of JSON; the caller
// frees it. NULL, with ERR_CASE, where a contact has no law. Records of at least that length are
// asked for, none where it is 0.
char *engine_request(const Scenario *scenario, const char *way, double record_s, bool wants_model,
                     Err *err);

// Two numbers, as a place, a velocity or a point of a table.
json_t *engine_pair(Vec2 value);

// The law of a contact, and what it brings along at time zero: null where it does not touch.
json_t *engine_law_object(const ForceLaw *law);
json_t *engine_contact_object(const ContactState *state);

// Adds a sinusoid where there is one.
void engine_add_wave(const Wave *wave, json_t *object);

// Adds what touches, but for pins in holes. Fails with ERR_CASE where a contact has no law.
bool engine_add_touches(const Scenario *scenario, json_t *request, Err *err);

// Adds the friction of ideal joints.
void engine_add_rubs(const Scenario *scenario, json_t *request);

// Adds drives that are more than one at a constant speed, and what turns like a servo.
void engine_add_drives(const Scenario *scenario, json_t *request);

// The oldest protocol that has words for a scenario, and the first thing in it that no older one
// has, such as "springs ('x')"; empty where there is none.
enum { ENGINE_NEED_SIZE = 96 };
int engine_needs(const Scenario *scenario, char what[ENGINE_NEED_SIZE]);

// Adds what acts on the bodies beside joints and gravity to the request: springs, torsion springs,
// bushings and loads, a drive's torque being one (docs/drivers.md).
void engine_add_actions(const Scenario *scenario, json_t *request);

// The request that asks a driver what it is.
extern const char ENGINE_HELLO[];

// An answer under way.
typedef struct EngineReply {
    const Scenario *scenario; // NULL: of a driver that is asked what it is
    EngineDriver *driver;
    Trajectory *trajectory; // of a run
    EngineSaid *said;
    EngineRecords *records; // NULL: none are wanted
    Sample sample;          // room; owned, as are the arrays
    double *bodies;         // numbers of a line: by body
    double *joints;         // by joint, and its totals
    double began_s;         // by our clock
    size_t samples;
    bool is_introduced; // the first line is there
    bool is_done;       // the last one is there
} EngineReply;

EngineReply engine_reply_start(const Scenario *scenario, EngineDriver *driver,
                               Trajectory *trajectory, EngineSaid *said);
void engine_reply_finish(EngineReply *reply);

// Takes a line of the answer, an EngineReply (engine/converse.h).
bool engine_reply_take(char *line, size_t size, void *reply, Err *err);

// Whether all that belongs to an answer was there once the driver has ended.
bool engine_reply_check(const EngineReply *reply, Err *err);
