// Keeps the records of an engine's steps, as they come in the answer of its driver.
#include "engine/engine_records.h"

#include "base/memory.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum {
    RECORD_TIMES = 2,       // where it begins and ends
    RECORD_BODY = 3,        // a velocity and an angular velocity
    RECORD_JOINT = 8,       // of EngineTouch
    RECORD_JOINT_KNOWN = 4, // of these, the first ones, that are known where the joint is
    RECORD_MOST = 1 << 20,  // that are believed, many times what is asked for
};

// s: of rounding, over a record's length, that one begins beside the end of the last
static const double RECORD_ROUNDING = 1e-3;

// SI: no number of a step is larger
static const double RECORD_NUMBER_MOST = 1e15;

static size_t size_of_record(const EngineRecords *records)
{
    return RECORD_TIMES + RECORD_BODY * records->body_count + RECORD_JOINT * records->joint_count;
}

static const double *numbers_of(const EngineRecords *records, size_t record)
{
    return records->numbers + record * size_of_record(records);
}

EngineRecords engine_records_start(size_t bodies, size_t joints, double record_s)
{
    return (EngineRecords){.record_s = record_s, .body_count = bodies, .joint_count = joints};
}

void engine_records_finish(EngineRecords *records)
{
    free(records->numbers);
    records->numbers = NULL;
}

// Reads so many numbers of an array, of which the first ones must be there and others may be null.
static bool read_row(const json_t *row, size_t known, size_t count, double *numbers)
{
    if (!json_is_array(row) || json_array_size(row) != count) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        const json_t *value = json_array_get(row, i);
        numbers[i] = json_is_number(value) ? json_number_value(value) : NAN;
        if (json_is_number(value) ? !(fabs(numbers[i]) <= RECORD_NUMBER_MOST)
                                  : i < known || !json_is_null(value)) {
            return false;
        }
    }
    return true;
}

static bool read_record(const EngineRecords *records, const json_t *line, double *numbers)
{
    const json_t *bodies = json_object_get(line, "bodies");
    const json_t *joints = json_object_get(line, "joints");
    bool is_right = read_row(json_object_get(line, "step"), RECORD_TIMES, RECORD_TIMES, numbers) &&
                    json_array_size(bodies) == records->body_count &&
                    json_array_size(joints) == records->joint_count;
    numbers += RECORD_TIMES;
    for (size_t i = 0; is_right && i < records->body_count; i++, numbers += RECORD_BODY) {
        is_right = read_row(json_array_get(bodies, i), RECORD_BODY, RECORD_BODY, numbers);
    }
    for (size_t i = 0; is_right && i < records->joint_count; i++, numbers += RECORD_JOINT) {
        const json_t *row = json_array_get(joints, i);
        for (size_t k = 0; k < RECORD_JOINT; k++) {
            numbers[k] = NAN;
        }
        is_right = json_is_null(row) || read_row(row, RECORD_JOINT_KNOWN, RECORD_JOINT, numbers);
    }
    return is_right;
}

bool engine_records_take(EngineRecords *records, const json_t *line, Err *err)
{
    const size_t size = size_of_record(records);
    if (records->count == records->room) {
        records->room = records->room > 0 ? 2 * records->room : 1024;
        records->numbers = realloc(records->numbers, records->room * size * sizeof(double));
        assert(records->numbers != NULL);
    }
    double *numbers = records->numbers + records->count * size;
    if (!read_record(records, line, numbers)) {
        return err_set(
            err, ERR_SOLVER,
            "its step %zu is not of two times, %zu bodies and %zu joints, or has a number "
            "above %.0e",
            records->count, records->body_count, records->joint_count, RECORD_NUMBER_MOST);
    }
    const double last_s =
        records->count > 0 ? engine_records_end(records, records->count - 1) : 0.0;
    const double length_s = numbers[1] - numbers[0];
    if (!(length_s > 0.0) || !(fabs(numbers[0] - last_s) <= RECORD_ROUNDING * length_s)) {
        return err_set(err, ERR_SOLVER,
                       "its step %zu is from %.9g to %.9g s, and the last one ended at %.9g s",
                       records->count, numbers[0], numbers[1], last_s);
    }
    if (++records->count > RECORD_MOST) {
        return err_set(err, ERR_SOLVER, "has more than %d records of steps", RECORD_MOST);
    }
    return true;
}

double engine_records_begin(const EngineRecords *records, size_t record)
{
    return numbers_of(records, record)[0];
}

double engine_records_end(const EngineRecords *records, size_t record)
{
    return numbers_of(records, record)[1];
}

EngineRates engine_records_body(const EngineRecords *records, size_t record, size_t body)
{
    const double *of = numbers_of(records, record) + RECORD_TIMES + RECORD_BODY * body;
    return (EngineRates){.velocity = {of[0], of[1]}, .omega = of[2]};
}

EngineTouch engine_records_joint(const EngineRecords *records, size_t record, size_t joint)
{
    const double *of = numbers_of(records, record) + RECORD_TIMES +
                       RECORD_BODY * records->body_count + RECORD_JOINT * joint;
    return (EngineTouch){.eccentricity = {of[0], of[1]},
                         .force = {of[2], of[3]},
                         .force_max = of[4],
                         .depth_max = of[5],
                         .impulse = of[6],
                         .approach = of[7]};
}

size_t engine_records_find(const EngineRecords *records, double time_s)
{
    size_t low = 0;
    size_t high = records->count;
    while (low + 1 < high) {
        const size_t middle = low + (high - low) / 2;
        *(engine_records_begin(records, middle) < time_s ? &low : &high) = middle;
    }
    return low;
}
