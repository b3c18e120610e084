// Speaks the protocol of drivers: reads the request, keeps samples, writes the answer.
//
// An engine's states stand at its steps, and in some ways positions and velocities stand at
// different times. Samples between them are those of a cubic through four of these (Lagrange), in
// ways whose velocities jump of the line between two.
#include "drivers/common/driver.h"

#include "drivers/common/place.h"
#include "drivers/common/reading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PROTOCOL = 3 };

// where answers go
static FILE *answers;

static double clock_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// The request.

// What a way takes of what the protocol has: contacts within the step all of it, as forces all but
// friction that holds or grows with an ideal joint's reaction; by the engine's own means what that
// engine has.
static json_t *words_of(const DriverIdentity *identity, const char *way)
{
    static const char *const WITHIN[] = {"limits", "stops", "cams",   "slots", "guides",
                                         "gears",  "racks", "servos", "waves", "drives",
                                         "drags",  "stick", "rubs",   NULL};
    static const char *const FORCE[] = {"limits", "stops",  "cams",  "slots",  "guides", "gears",
                                        "racks",  "servos", "waves", "drives", "drags",  NULL};
    const char *const *word = strcmp(way, "native") == 0   ? identity->native_takes
                              : strcmp(way, "kernel") == 0 ? WITHIN
                                                           : FORCE;
    json_t *words = json_array();
    for (; *word != NULL; word++) {
        json_array_append_new(words, json_string(*word));
    }
    return words;
}

static void say_hello(const DriverIdentity *identity)
{
    json_t *ways = json_array();
    json_t *takes = json_object();
    for (size_t i = 0; identity->ways[i] != NULL; i++) {
        json_array_append_new(ways, json_string(identity->ways[i]));
        json_object_set_new(takes, identity->ways[i], words_of(identity, identity->ways[i]));
    }
    json_t *line = json_pack("{s:i, s:s, s:s, s:s, s:o, s:o}", "jointplay-driver", PROTOCOL,
                             "engine", identity->engine, "version", identity->version, "precision",
                             identity->precision, "ways", ways, "takes", takes);
    json_dumpf(line, answers, JSON_COMPACT);
    fputc('\n', answers);
    fflush(answers);
    json_decref(line);
}

static char *asked_model;

const char *driver_asked_model(void)
{
    return asked_model;
}

DriverCase *driver_read(const DriverIdentity *identity, int *status)
{
    answers = driver_open_answers();
    json_t *request = json_loadf(stdin, JSON_DISABLE_EOF_CHECK, NULL);
    *status = 0;
    const json_int_t protocol = json_integer_value(json_object_get(request, "jointplay-driver"));
    if (protocol < 1 || protocol > PROTOCOL) {
        fprintf(stderr,
                "this is a driver of jointplay's protocols 1 to %d, and reads a request of them "
                "from standard input\n",
                PROTOCOL);
        *status = 2;
        json_decref(request);
        return NULL;
    }
    say_hello(identity);
    const char *ask = json_string_value(json_object_get(request, "ask"));
    DriverCase *of = NULL;
    if (ask != NULL && strcmp(ask, "run") == 0) {
        of = driver_read_case(request);
        bool is_known = false;
        for (size_t i = 0; identity->ways[i] != NULL; i++) {
            is_known = is_known || driver_is_way(of, identity->ways[i]);
        }
        if (!is_known) {
            driver_fail("there is no way '%s'", of->way);
        }
    }
    if (ask != NULL && strcmp(ask, "model") == 0) {
        const char *file = json_string_value(json_object_get(request, "file"));
        asked_model = strdup(file != NULL ? file : "");
    }
    json_decref(request);
    return of;
}

// The run.

DriverRun driver_run_start(const DriverCase *of)
{
    DriverRun run = {
        .of = of,
        .motions = driver_room(of->sample_count * of->body_count, sizeof *run.motions),
        .forces = driver_room(of->sample_count * of->joint_count, sizeof *run.forces),
        .totals = driver_room(of->joint_count, sizeof *run.totals),
        .touches = driver_room(of->joint_count, sizeof *run.touches),
        .touched = driver_room(of->joint_count, sizeof *run.touched),
        .peaks = driver_room(of->joint_count, sizeof *run.peaks),
    };
    for (size_t i = 0; i < of->place_count; i++) {
        run.touched[of->places[i].joint] = true;
    }
    for (size_t i = 0; i < DRIVER_STAMPS; i++) {
        run.stamps[i].motions = driver_room(of->body_count, sizeof(DriverMotion));
        run.stamps[i].forces = driver_room(of->joint_count, sizeof(Vec2));
    }
    return run;
}

void driver_run_begin(DriverRun *run)
{
    run->began_s = clock_s();
}

DriverMotion *driver_run_motions(DriverRun *run)
{
    return run->motions + run->sampled * run->of->body_count;
}

Vec2 *driver_run_forces(DriverRun *run)
{
    return run->forces + run->sampled * run->of->joint_count;
}

void driver_run_sampled(DriverRun *run)
{
    run->sampled++;
}

DriverStamp *driver_run_stamp(DriverRun *run)
{
    if (run->stamp_count == DRIVER_STAMPS) {
        const DriverStamp oldest = run->stamps[0];
        memmove(run->stamps, run->stamps + 1, (DRIVER_STAMPS - 1) * sizeof *run->stamps);
        run->stamps[DRIVER_STAMPS - 1] = oldest;
        run->stamp_count--;
    }
    return &run->stamps[run->stamp_count];
}

// The weights of the stamps at a time: of a cubic, or of the line between the two about it.
static void find_weights(const DriverRun *run, double time_s, bool is_velocity,
                         double weights[DRIVER_STAMPS])
{
    double times[DRIVER_STAMPS];
    for (size_t i = 0; i < DRIVER_STAMPS; i++) {
        times[i] = is_velocity ? run->stamps[i].velocity_s : run->stamps[i].position_s;
        weights[i] = 0.0;
    }
    size_t first = 0;
    size_t last = DRIVER_STAMPS - 1;
    if (run->is_linear) {
        while (first + 2 < DRIVER_STAMPS && times[first + 1] < time_s) {
            first++;
        }
        last = first + 1;
    }
    for (size_t i = first; i <= last; i++) {
        weights[i] = 1.0;
        for (size_t k = first; k <= last; k++) {
            weights[i] *= k != i ? (time_s - times[k]) / (times[i] - times[k]) : 1.0;
        }
    }
}

static void make_sample(DriverRun *run, double time_s)
{
    double at[DRIVER_STAMPS];
    double going[DRIVER_STAMPS];
    find_weights(run, time_s, false, at);
    find_weights(run, time_s, true, going);
    DriverMotion *motions = driver_run_motions(run);
    Vec2 *forces = driver_run_forces(run);
    for (size_t i = 0; i < DRIVER_STAMPS; i++) {
        const DriverStamp *stamp = &run->stamps[i];
        for (size_t k = 0; k < run->of->body_count; k++) {
            const DriverMotion *from = &stamp->motions[k];
            DriverMotion *to = &motions[k];
            to->position = vec2_add(to->position, vec2_scale(at[i], from->position));
            to->angle += at[i] * from->angle;
            to->velocity = vec2_add(to->velocity, vec2_scale(going[i], from->velocity));
            to->omega += going[i] * from->omega;
        }
        for (size_t k = 0; k < run->of->joint_count; k++) {
            forces[k] = vec2_add(forces[k], vec2_scale(at[i], stamp->forces[k]));
        }
    }
    driver_run_sampled(run);
}

// Records of steps.

enum { RECORD_TIMES = 2, RECORD_BODY = 3, RECORD_JOINT = 8 };

static size_t record_size(const DriverRun *run)
{
    return RECORD_TIMES + RECORD_BODY * run->of->body_count + RECORD_JOINT * run->of->joint_count;
}

// The record that a step goes into: the last one as long as that is too short, or a new one.
static double *record_for(DriverRun *run, double start_s)
{
    const size_t size = record_size(run);
    double *last = run->record_count > 0 ? run->records + (run->record_count - 1) * size : NULL;
    if (last != NULL && last[1] - last[0] < run->of->record_s) {
        return last;
    }
    if (run->record_count == run->record_room) {
        run->record_room = run->record_room > 0 ? 2 * run->record_room : 1024;
        run->records = realloc(run->records, run->record_room * size * sizeof *run->records);
        if (run->records == NULL) {
            driver_fail("there is no memory");
        }
    }
    double *record = run->records + run->record_count++ * size;
    memset(record, 0, size * sizeof *record);
    record[0] = record[1] = start_s;
    return record;
}

// Adds what a joint did in a step to what it did before in the same record.
static void record_touch(const DriverTouch *touch, double before_s, double length_s, double *joint)
{
    const double share = length_s / (before_s + length_s);
    joint[0] = touch->eccentricity.x;
    joint[1] = touch->eccentricity.y;
    joint[2] += share * (touch->force.x - joint[2]);
    joint[3] += share * (touch->force.y - joint[3]);
    joint[4] = fmax(joint[4], touch->force_max);
    joint[5] = fmax(joint[5], touch->depth_max);
    joint[6] += length_s * vec2_length(touch->force);
    joint[7] = touch->approach;
}

void driver_run_record(DriverRun *run, double start_s, double end_s, const DriverMotion *motions,
                       const DriverTouch *touches)
{
    if (!(run->of->record_s > 0.0) || start_s >= run->of->duration_s || !(end_s > start_s)) {
        return;
    }
    double *record = record_for(run, start_s);
    const double before_s = record[1] - record[0];
    record[1] = end_s;
    double *body = record + RECORD_TIMES;
    for (size_t i = 0; i < run->of->body_count; i++, body += RECORD_BODY) {
        body[0] = motions[i].velocity.x;
        body[1] = motions[i].velocity.y;
        body[2] = motions[i].omega;
    }
    for (size_t i = 0; i < run->of->joint_count; i++, body += RECORD_JOINT) {
        if (run->touched[i]) {
            record_touch(&touches[i], before_s, end_s - start_s, body);
        }
    }
}

// The step between the velocities of the last two stamps, with the forces that act between them:
// those at the positions of the first.
static void record_stamps(DriverRun *run)
{
    if (!(run->of->record_s > 0.0) || run->stamp_count < 2) {
        return;
    }
    const DriverStamp *last = &run->stamps[run->stamp_count - 2];
    const DriverStamp *now = last + 1;
    places_touches(run, last->motions, last->forces, run->touches);
    driver_run_record(run, last->velocity_s, now->velocity_s, now->motions, run->touches);
}

void driver_run_stamped(DriverRun *run)
{
    run->stamp_count++;
    record_stamps(run);
    if (run->stamp_count < DRIVER_STAMPS) {
        return;
    }
    const DriverStamp *inner = &run->stamps[DRIVER_STAMPS - 2];
    const double known_s = fmin(inner->position_s, inner->velocity_s);
    while (!driver_run_is_full(run) && driver_run_next(run) <= known_s) {
        make_sample(run, driver_run_next(run));
    }
}

// The answer.

static void write_rows(const DriverRun *run, size_t sample)
{
    const DriverCase *of = run->of;
    fprintf(answers, "{\"sample\":%.17g,\"bodies\":[", of->sample_times[sample]);
    for (size_t i = 0; i < of->body_count; i++) {
        const DriverMotion *at = &run->motions[sample * of->body_count + i];
        if (!isfinite(at->position.x + at->position.y + at->angle + at->velocity.x +
                      at->velocity.y + at->omega)) {
            fputc('\n', answers);
            driver_fail("the motion of '%s' is not finite after %.6g s", of->bodies[i].name,
                        of->sample_times[sample]);
        }
        fprintf(answers, "%s[%.17g,%.17g,%.17g,%.17g,%.17g,%.17g]", i > 0 ? "," : "",
                at->position.x, at->position.y, at->angle, at->velocity.x, at->velocity.y,
                at->omega);
    }
    fprintf(answers, "],\"joints\":[");
    for (size_t i = 0; i < of->joint_count; i++) {
        const Vec2 force = run->forces[sample * of->joint_count + i];
        fprintf(answers, "%s[%.9g,%.9g]", i > 0 ? "," : "", isfinite(force.x) ? force.x : 0.0,
                isfinite(force.y) ? force.y : 0.0);
    }
    fprintf(answers, "]}\n");
}

// null, and numbers that are not finite.
static void write_number(double number, const char *before)
{
    if (isfinite(number)) {
        fprintf(answers, "%s%.13g", before, number);
    } else {
        fprintf(answers, "%snull", before);
    }
}

static void write_record(const DriverRun *run, const double *record)
{
    fprintf(answers, "{\"step\":[%.17g,%.17g],\"bodies\":[", record[0], record[1]);
    const double *at = record + RECORD_TIMES;
    for (size_t i = 0; i < run->of->body_count; i++, at += RECORD_BODY) {
        write_number(at[0], i > 0 ? ",[" : "[");
        write_number(at[1], ",");
        write_number(at[2], ",");
        fputc(']', answers);
    }
    fprintf(answers, "],\"joints\":[");
    for (size_t i = 0; i < run->of->joint_count; i++, at += RECORD_JOINT) {
        fprintf(answers, "%s", i > 0 ? "," : "");
        if (!run->touched[i]) {
            fprintf(answers, "null");
            continue;
        }
        for (size_t k = 0; k < RECORD_JOINT; k++) {
            write_number(at[k], k > 0 ? "," : "[");
        }
        fputc(']', answers);
    }
    fprintf(answers, "]}\n");
}

static void write_done(const DriverRun *run)
{
    json_t *joints = json_array();
    for (size_t i = 0; i < run->of->joint_count; i++) {
        const DriverTotals *of = &run->totals[i];
        json_array_append_new(
            joints, json_pack("[f, f, I]", of->force_max, of->depth_max, (json_int_t)of->begun));
    }
    json_t *done = json_pack("{s:{s:I, s:f, s:o, s:s}}", "done", "steps", (json_int_t)run->steps,
                             "wall_s", run->wall_s, "joints", joints, "settings", run->settings);
    if (done == NULL) {
        driver_fail("the totals of the joints are not finite");
    }
    if (run->of->wants_model && run->model != NULL) {
        json_object_set_new(json_object_get(done, "done"), "model", json_string(run->model));
    }
    json_dumpf(done, answers, JSON_COMPACT | JSON_REAL_PRECISION(17));
    fputc('\n', answers);
    json_decref(done);
}

void driver_run_write(DriverRun *run)
{
    run->wall_s = clock_s() - run->began_s;
    for (size_t i = 0; i < run->of->sample_count; i++) {
        write_rows(run, i);
    }
    for (size_t i = 0; i < run->record_count; i++) {
        write_record(run, run->records + i * record_size(run));
    }
    write_done(run);
    fflush(answers);
    _Exit(ferror(answers) ? 1 : 0);
}
