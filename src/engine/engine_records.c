// Keeps the records of an engine's steps, as they come in the answer of its driver.
#include "engine/engine_records.h"

#include "base/memory.h"
#include "engine/row.h"

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

// of a run's length: where the last record ends at the latest, which may go on after the run
static const double RUNS_MOST = 2.0;

// s: of rounding, over a record's length, that one begins beside the end of the last
static const double RECORD_ROUNDING = 1e-3;

static size_t size_of_record(const EngineRecords *records)
{
    return RECORD_TIMES + RECORD_BODY * records->body_count + RECORD_JOINT * records->joint_count;
}

static const double *numbers_of(const EngineRecords *records, size_t record)
{
    return records->numbers + record * size_of_record(records);
}

EngineRecords engine_records_start(size_t bodies, size_t joints, double record_s, double duration_s)
{
    return (EngineRecords){.record_s = record_s,
                           .duration_s = duration_s,
                           .body_count = bodies,
                           .joint_count = joints};
}

void engine_records_finish(EngineRecords *records)
{
    free(records->numbers);
    records->numbers = NULL;
}

// Reads a joint of which something is known: what has no direction is not negative.
static bool read_touch(const json_t *row, const EngineRow *as, double *numbers, Err *err)
{
    static const struct {
        size_t number;
        const char *name;
    } POSITIVE[] = {{4, "largest force"}, {5, "largest depth"}, {6, "impulse"}};
    if (!engine_row_read(row, as, numbers, err)) {
        return false;
    }
    for (size_t i = 0; i < sizeof POSITIVE / sizeof *POSITIVE; i++) {
        const double value = numbers[POSITIVE[i].number];
        if (value < 0.0) {
            return err_set(err, ERR_SOLVER,
                           "its line 'step' has as '%s[%zu][%zu]', a %s, %.6g, which has to be 0 "
                           "or more",
                           as->field, as->index, POSITIVE[i].number, POSITIVE[i].name, value);
        }
    }
    return true;
}

static bool read_record(const EngineRecords *records, const json_t *line, double *numbers, Err *err)
{
    static const char LINE[] = "step";
    const json_t *bodies = json_object_get(line, "bodies");
    const json_t *joints = json_object_get(line, "joints");
    const EngineRow times = {LINE, LINE, 0, RECORD_TIMES, RECORD_TIMES};
    EngineRow body = {LINE, "bodies", 0, RECORD_BODY, RECORD_BODY};
    EngineRow joint = {LINE, "joints", 0, RECORD_JOINT_KNOWN, RECORD_JOINT};
    if (!engine_row_read(json_object_get(line, LINE), &times, numbers, err) ||
        !engine_row_count(bodies, &body, records->body_count, err) ||
        !engine_row_count(joints, &joint, records->joint_count, err)) {
        return false;
    }
    numbers += RECORD_TIMES;
    for (; body.index < records->body_count; body.index++, numbers += RECORD_BODY) {
        if (!engine_row_read(json_array_get(bodies, body.index), &body, numbers, err)) {
            return false;
        }
    }
    for (; joint.index < records->joint_count; joint.index++, numbers += RECORD_JOINT) {
        const json_t *row = json_array_get(joints, joint.index);
        for (size_t k = 0; k < RECORD_JOINT; k++) {
            numbers[k] = NAN;
        }
        if (!json_is_null(row) && !read_touch(row, &joint, numbers, err)) {
            return false;
        }
    }
    return true;
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
    if (!read_record(records, line, numbers, err)) {
        return false;
    }
    const double last_s =
        records->count > 0 ? engine_records_end(records, records->count - 1) : 0.0;
    const double length_s = numbers[1] - numbers[0];
    if (!(length_s > 0.0) || !(fabs(numbers[0] - last_s) <= RECORD_ROUNDING * length_s)) {
        return err_set(err, ERR_SOLVER,
                       "its step %zu is from %.9g to %.9g s, and the last one ended at %.9g s",
                       records->count, numbers[0], numbers[1], last_s);
    }
    if (numbers[1] > RUNS_MOST * records->duration_s) {
        return err_set(err, ERR_SOLVER,
                       "its step %zu is from %.9g to %.9g s, and the run ends at %.9g s",
                       records->count, numbers[0], numbers[1], records->duration_s);
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
