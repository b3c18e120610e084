// What an engine did between the samples of a run: records of its steps, as a driver has them.
//
// A record is of one step or of several. Numbers that the driver does not know are none (NAN).
#pragma once

#include "base/err.h"
#include "base/vec2.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

// Of a joint in a record.
typedef struct EngineTouch {
    Vec2 eccentricity; // m, pin centre less hole centre
    Vec2 force;        // N, on body b, its mean
    double force_max;  // N
    double depth_max;  // m
    double impulse;    // N s
    double approach;   // m/s, closing speed at which its last contact began
} EngineTouch;

// Of a body at a record's end.
typedef struct EngineRates {
    Vec2 velocity; // m/s, of the centre of mass
    double omega;  // rad/s
} EngineRates;

typedef struct EngineRecords {
    double record_s;   // the least length of one, asked for
    double duration_s; // of the run
    size_t body_count;
    size_t joint_count;
    size_t count;
    size_t room;
    double *numbers; // owned: times, bodies and joints of each
} EngineRecords;

EngineRecords engine_records_start(size_t bodies, size_t joints, double record_s,
                                   double duration_s);
void engine_records_finish(EngineRecords *records);

// Takes a line of the answer. Fails with ERR_SOLVER where it is none, or not the next one.
bool engine_records_take(EngineRecords *records, const json_t *line, Err *err);

double engine_records_begin(const EngineRecords *records, size_t record); // s
double engine_records_end(const EngineRecords *records, size_t record);   // s
EngineRates engine_records_body(const EngineRecords *records, size_t record, size_t body);
EngineTouch engine_records_joint(const EngineRecords *records, size_t record, size_t joint);

// The record that a time lies in, or the last one before it.
size_t engine_records_find(const EngineRecords *records, double time_s);
