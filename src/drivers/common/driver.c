// Speaks the protocol of drivers: reads the request, keeps samples, writes the answer.
//
// An engine's states stand at its steps, and in some ways positions and velocities stand at
// different times. Samples between them are those of a cubic through four of these (Lagrange), in
// ways whose velocities jump of the line between two.
#include "drivers/common/driver.h"

#include "kernel/friction_law.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { PROTOCOL = 3, REQUEST_MOST = 1 << 28 };

static void *memory(size_t count, size_t size)
{
    void *room = calloc(count + 1, size);
    if (room == NULL) {
        driver_fail("there is no memory");
    }
    return room;
}

static double clock_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Where answers go: the program's standard output, which engines are kept from, for some greet.

static FILE *answers;

static void open_answers(void)
{
    const int channel = dup(STDOUT_FILENO);
    answers = channel >= 0 ? fdopen(channel, "w") : NULL;
    if (answers == NULL || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
        _Exit(1);
    }
}

// Answers that end everything.

static _Noreturn void end_with(const char *key, const char *format, va_list arguments)
{
    char words[512];
    vsnprintf(words, sizeof words, format, arguments);
    json_t *line = json_pack("{s:s%}", key, words, strlen(words));
    char *text = line != NULL ? json_dumps(line, JSON_COMPACT) : NULL;
    if (text != NULL) {
        fprintf(answers, "%s\n", text);
    } else {
        fprintf(answers, "{\"%s\": \"for a reason that is no text\"}\n", key);
    }
    fflush(answers);
    _Exit(0);
}

void driver_fail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    end_with("failed", format, arguments);
}

void driver_refuse(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    end_with("refused", format, arguments);
}

// The request.

static const json_t *member(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    if (value == NULL) {
        driver_fail("the request has no '%s'", key);
    }
    return value;
}

static double number(const json_t *object, const char *key)
{
    return json_number_value(member(object, key));
}

static Vec2 pair(const json_t *object, const char *key)
{
    const json_t *value = member(object, key);
    return (Vec2){json_number_value(json_array_get(value, 0)),
                  json_number_value(json_array_get(value, 1))};
}

static void copy_text(const json_t *object, const char *key, char target[DRIVER_NAME_SIZE])
{
    const char *text = json_string_value(member(object, key));
    snprintf(target, DRIVER_NAME_SIZE, "%s", text != NULL ? text : "");
}

static DriverBody read_body(const json_t *object)
{
    DriverBody body = {.mass = number(object, "mass_kg"),
                       .inertia = number(object, "inertia_kg_m2"),
                       .start = {.position = pair(object, "position_m"),
                                 .angle = number(object, "angle_rad"),
                                 .velocity = pair(object, "velocity_m_s"),
                                 .omega = number(object, "omega_rad_s")}};
    copy_text(object, "name", body.name);
    return body;
}

static ForceLaw read_law(const json_t *object)
{
    ForceLaw law = {.family = FORCE_LAW_POWER};
    const char *family = json_string_value(member(object, "family"));
    if (strcmp(family, "conforming") == 0) {
        law.family = FORCE_LAW_CONFORMING;
        law.conforming.stiffness = number(object, "stiffness_N_m");
        law.conforming.play = number(object, "play_m");
        const json_t *series = member(object, "series");
        for (size_t i = 0; i < CONFORMING_TERMS; i++) {
            law.conforming.series[i] = json_number_value(json_array_get(series, i));
        }
    } else if (strcmp(family, "power") == 0) {
        law.stiffness = number(object, "stiffness_N_m");
        law.exponent = number(object, "exponent");
    } else {
        law.family = FORCE_LAW_LOGARITHMIC;
        law.compliance = number(object, "compliance_m_N");
        law.offset = number(object, "offset");
        law.log_scale = number(object, "log_scale");
    }
    law.hysteresis = number(object, "hysteresis");
    law.viscous = number(object, "viscous_N_s_m");
    law.full_damping_depth = number(object, "full_damping_depth_m");
    law.impact_speed_floor = number(object, "impact_speed_floor_m_s");
    law.resting_speed = number(object, "resting_speed_m_s");
    law.friction = number(object, "friction");
    law.friction_speed = number(object, "friction_speed_m_s");
    return law;
}

static ContactState read_contact(const json_t *object)
{
    if (json_is_null(object)) {
        return (ContactState){.is_touching = false};
    }
    return (ContactState){.is_touching = true,
                          .is_slack = json_is_true(member(object, "is_slack")),
                          .is_released = json_is_true(member(object, "is_released")),
                          .is_resting = json_is_true(member(object, "is_resting")),
                          .impact_speed = number(object, "impact_speed_m_s"),
                          .damping_speed = number(object, "damping_speed_m_s"),
                          .age_s = number(object, "age_s")};
}

static DriverJoint read_joint(const json_t *object)
{
    DriverJoint joint = {.kind = DRIVER_REVOLUTE};
    copy_text(object, "name", joint.name);
    joint.bodies[0] = (int)number(object, "body_a");
    joint.bodies[1] = (int)number(object, "body_b");
    joint.anchors[0] = pair(object, "anchor_a_m");
    joint.anchors[1] = pair(object, "anchor_b_m");
    const char *kind = json_string_value(member(object, "kind"));
    if (strcmp(kind, "prismatic") == 0) {
        joint.kind = DRIVER_PRISMATIC;
        joint.direction = number(object, "direction_rad");
    } else if (strcmp(kind, "pin-in-hole") == 0) {
        joint.kind = DRIVER_PIN_IN_HOLE;
        joint.clearance = number(object, "radial_clearance_m");
        joint.hole_radius = number(object, "hole_radius_m");
        joint.law = read_law(member(object, "law"));
        joint.contact = read_contact(member(object, "contact"));
    } else if (strcmp(kind, "revolute") != 0) {
        driver_refuse("the %s '%s'", kind, joint.name);
    }
    return joint;
}

static void read_drive(const json_t *drive, DriverCase *of)
{
    of->driven_body = DRIVER_GROUND;
    of->has_drive = !json_is_null(drive);
    if (of->has_drive) {
        of->driven_body = (int)number(drive, "body");
        of->drive_joint = (int)number(drive, "joint");
        of->drive_speed = number(drive, "speed_rad_s");
    }
}

static DriverSpring read_spring(const json_t *object)
{
    return (DriverSpring){.bodies = {(int)number(object, "body_a"), (int)number(object, "body_b")},
                          .anchors = {pair(object, "anchor_a_m"), pair(object, "anchor_b_m")},
                          .stiffness = number(object, "stiffness_N_m"),
                          .length = number(object, "length_m"),
                          .damping = number(object, "damping_N_s_m")};
}

static DriverTorsion read_torsion(const json_t *object)
{
    return (DriverTorsion){.joint = (int)number(object, "joint"),
                           .stiffness = number(object, "stiffness_N_m_rad"),
                           .angle = number(object, "angle_rad"),
                           .damping = number(object, "damping_N_m_s_rad")};
}

// One of the curves of a bushing; without points there is none.
static void read_curve(const json_t *object, const char *key, ForceCurveShape shape,
                       ForceCurve *curve)
{
    const json_t *points = member(object, key);
    curve->count = json_array_size(points);
    if (curve->count > FORCE_CURVE_MAX || curve->count == 1) {
        driver_fail("a bushing has a curve of %zu points", curve->count);
    }
    for (size_t i = 0; i < curve->count; i++) {
        const json_t *point = json_array_get(points, i);
        curve->at[i] = json_number_value(json_array_get(point, 0));
        curve->values[i] = json_number_value(json_array_get(point, 1));
    }
    force_curve_settle(curve, shape);
}

static void read_bushing(const json_t *object, DriverBushing *bushing)
{
    const char *word = json_string_value(member(object, "shape"));
    const bool is_smooth =
        word != NULL && strcmp(word, FORCE_CURVE_SHAPES[FORCE_CURVE_SMOOTH]) == 0;
    const ForceCurveShape shape = is_smooth ? FORCE_CURVE_SMOOTH : FORCE_CURVE_LINEAR;
    const Vec2 stiffness = pair(object, "stiffness_N_m");
    const Vec2 damping = pair(object, "damping_N_s_m");
    *bushing = (DriverBushing){
        .bodies = {(int)number(object, "body_a"), (int)number(object, "body_b")},
        .anchors = {pair(object, "anchor_a_m"), pair(object, "anchor_b_m")},
        .direction = number(object, "direction_rad"),
        .angle = number(object, "angle_rad"),
        .stiffness = {stiffness.x, stiffness.y, number(object, "stiffness_N_m_rad")},
        .damping = {damping.x, damping.y, number(object, "damping_N_m_s_rad")},
    };
    read_curve(object, "force_x", shape, &bushing->curves[0]);
    read_curve(object, "force_y", shape, &bushing->curves[1]);
    read_curve(object, "torque", shape, &bushing->curves[2]);
}

static void read_table(const json_t *object, LoadTable *table)
{
    const json_t *points = member(object, "points");
    const char *shape = json_string_value(member(object, "shape"));
    table->count = json_array_size(points);
    table->period = number(object, "period");
    if (table->count > LOAD_TABLE_MAX) {
        driver_fail("a load has more than %d points", LOAD_TABLE_MAX);
    }
    for (size_t i = 0; i < table->count; i++) {
        const json_t *point = json_array_get(points, i);
        table->at[i] = json_number_value(json_array_get(point, 0));
        table->values[i] = json_number_value(json_array_get(point, 1));
    }
    for (int i = 0; i < LOAD_SHAPE_COUNT; i++) {
        table->shape =
            shape != NULL && strcmp(shape, LOAD_SHAPES[i]) == 0 ? (LoadShape)i : table->shape;
    }
    load_table_settle(table);
}

static void read_load(const json_t *object, DriverLoad *load)
{
    const json_t *over = json_object_get(object, "over_joint");
    load->over_joint = over != NULL ? (int)json_number_value(over) : -1;
    load->shift = number(object, "shift");
    load->rate = over != NULL ? 0.0 : number(object, "rate");
    read_table(object, &load->table);
    if (json_object_get(object, "joint") != NULL) {
        load->kind = DRIVER_ALONG;
        load->joint = (int)number(object, "joint");
        return;
    }
    load->kind = DRIVER_TORQUE;
    load->body = (int)number(object, "body");
    if (json_object_get(object, "direction_rad") != NULL) {
        load->kind = DRIVER_FORCE;
        load->anchor = pair(object, "anchor_m");
        load->direction = number(object, "direction_rad");
        load->turns_along = json_is_true(member(object, "turns_along"));
    }
}

// What acts on the bodies; a request of protocol 1 has nothing of it, one of 2 no bushings.
static void read_actions(const json_t *request, DriverCase *of)
{
    const json_t *springs = json_object_get(request, "springs");
    const json_t *torsions = json_object_get(request, "torsion_springs");
    const json_t *bushings = json_object_get(request, "bushings");
    const json_t *loads = json_object_get(request, "loads");
    of->bushing_count = json_array_size(bushings);
    of->bushings = memory(of->bushing_count, sizeof *of->bushings);
    for (size_t i = 0; i < of->bushing_count; i++) {
        read_bushing(json_array_get(bushings, i), &of->bushings[i]);
    }
    of->spring_count = json_array_size(springs);
    of->torsion_count = json_array_size(torsions);
    of->load_count = json_array_size(loads);
    of->springs = memory(of->spring_count, sizeof *of->springs);
    of->torsions = memory(of->torsion_count, sizeof *of->torsions);
    of->loads = memory(of->load_count, sizeof *of->loads);
    for (size_t i = 0; i < of->spring_count; i++) {
        of->springs[i] = read_spring(json_array_get(springs, i));
    }
    for (size_t i = 0; i < of->torsion_count; i++) {
        of->torsions[i] = read_torsion(json_array_get(torsions, i));
    }
    for (size_t i = 0; i < of->load_count; i++) {
        read_load(json_array_get(loads, i), &of->loads[i]);
    }
}

static DriverCase *read_case(const json_t *request)
{
    DriverCase *of = memory(1, sizeof *of);
    copy_text(request, "way", of->way);
    of->step_s = number(request, "step_s");
    of->duration_s = number(request, "duration_s");
    of->record_s = json_number_value(json_object_get(request, "record_s"));
    of->gravity = pair(request, "gravity_m_s2");
    of->wants_model = json_is_true(json_object_get(request, "model"));
    const json_t *bodies = member(request, "bodies");
    const json_t *joints = member(request, "joints");
    const json_t *times = member(request, "sample_times_s");
    of->body_count = json_array_size(bodies);
    of->joint_count = json_array_size(joints);
    of->sample_count = json_array_size(times);
    of->bodies = memory(of->body_count, sizeof *of->bodies);
    of->joints = memory(of->joint_count, sizeof *of->joints);
    of->sample_times = memory(of->sample_count, sizeof *of->sample_times);
    for (size_t i = 0; i < of->body_count; i++) {
        of->bodies[i] = read_body(json_array_get(bodies, i));
    }
    for (size_t i = 0; i < of->joint_count; i++) {
        of->joints[i] = read_joint(json_array_get(joints, i));
    }
    for (size_t i = 0; i < of->sample_count; i++) {
        of->sample_times[i] = json_number_value(json_array_get(times, i));
    }
    read_drive(member(request, "drive"), of);
    read_actions(request, of);
    return of;
}

static void say_hello(const DriverIdentity *identity)
{
    json_t *ways = json_array();
    for (size_t i = 0; identity->ways[i] != NULL; i++) {
        json_array_append_new(ways, json_string(identity->ways[i]));
    }
    json_t *line = json_pack("{s:i, s:s, s:s, s:s, s:o}", "jointplay-driver", PROTOCOL, "engine",
                             identity->engine, "version", identity->version, "precision",
                             identity->precision, "ways", ways);
    json_dumpf(line, answers, JSON_COMPACT);
    fputc('\n', answers);
    fflush(answers);
    json_decref(line);
}

void driver_answer(const json_t *line)
{
    json_dumpf(line, answers, JSON_COMPACT | JSON_REAL_PRECISION(17));
    fputc('\n', answers);
    fflush(answers);
}

static char *asked_model;

const char *driver_asked_model(void)
{
    return asked_model;
}

DriverCase *driver_read(const DriverIdentity *identity, int *status)
{
    open_answers();
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
        of = read_case(request);
        bool is_known = false;
        for (size_t i = 0; identity->ways[i] != NULL; i++) {
            is_known = is_known || driver_is_way(of, identity->ways[i]);
        }
        if (!is_known) {
            driver_fail("there is no way '%s'", of->way);
        }
    }
    if (ask != NULL && strcmp(ask, "model") == 0) {
        const char *file = json_string_value(member(request, "file"));
        asked_model = strdup(file != NULL ? file : "");
    }
    json_decref(request);
    return of;
}

bool driver_is_way(const DriverCase *of, const char *way)
{
    return strcmp(of->way, way) == 0;
}

void driver_refuse_friction(const DriverCase *of)
{
    for (size_t i = 0; i < of->joint_count; i++) {
        if (of->joints[i].law.friction > 0.0) {
            driver_refuse("friction in '%s', for a hole of the engine's own has none",
                          of->joints[i].name);
        }
    }
}

// The run.

DriverRun driver_run_start(const DriverCase *of)
{
    DriverRun run = {
        .of = of,
        .motions = memory(of->sample_count * of->body_count, sizeof *run.motions),
        .forces = memory(of->sample_count * of->joint_count, sizeof *run.forces),
        .totals = memory(of->joint_count, sizeof *run.totals),
        .touches = memory(of->joint_count, sizeof *run.touches),
        .peaks = memory(of->joint_count, sizeof *run.peaks),
    };
    for (size_t i = 0; i < DRIVER_STAMPS; i++) {
        run.stamps[i].motions = memory(of->body_count, sizeof(DriverMotion));
        run.stamps[i].forces = memory(of->joint_count, sizeof(Vec2));
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
        if (run->of->joints[i].kind == DRIVER_PIN_IN_HOLE) {
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
    for (size_t i = 0; i < run->of->joint_count; i++) {
        const DriverJoint *joint = &run->of->joints[i];
        if (joint->kind == DRIVER_PIN_IN_HOLE) {
            const PinHole pose = driver_pose(joint, last->motions);
            run->touches[i] =
                (DriverTouch){.eccentricity = pose.eccentricity,
                              .force = last->forces[i],
                              .force_max = fmax(vec2_length(last->forces[i]), run->peaks[i].force),
                              .depth_max = fmax(pose.penetration, run->peaks[i].depth),
                              .approach = run->totals[i].approach};
        }
    }
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
        if (run->of->joints[i].kind != DRIVER_PIN_IN_HOLE) {
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

// Pins in their holes.

Vec2 driver_point(const DriverMotion *motions, int body, Vec2 local)
{
    return body == DRIVER_GROUND
               ? local
               : vec2_add(motions[body].position, vec2_rotate(motions[body].angle, local));
}

Vec2 driver_point_velocity(const DriverMotion *motions, int body, Vec2 local)
{
    if (body == DRIVER_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Vec2 arm = vec2_rotate(motions[body].angle, local);
    return vec2_add(motions[body].velocity, vec2_scale(motions[body].omega, vec2_perp(arm)));
}

PinHole driver_pose(const DriverJoint *joint, const DriverMotion *motions)
{
    const Vec2 hole = driver_point(motions, joint->bodies[0], joint->anchors[0]);
    const Vec2 pin = driver_point(motions, joint->bodies[1], joint->anchors[1]);
    const Vec2 going =
        vec2_sub(driver_point_velocity(motions, joint->bodies[1], joint->anchors[1]),
                 driver_point_velocity(motions, joint->bodies[0], joint->anchors[0]));
    return pin_hole_pose(hole, pin, going, joint->clearance);
}

static double omega_of(const DriverMotion *motions, int body)
{
    return body == DRIVER_GROUND ? 0.0 : motions[body].omega;
}

// With n the normal, t = perp n, R the hole's radius and r = R - |e|, the pin slides at
//     v_t = t . (v_b - v_a) + R w_a - r w_b,   friction  mu N tanh(v_t / v_s)  against it
DriverPress driver_press(const DriverJoint *joint, const DriverContact *contact,
                         const PinHole *pose, const DriverMotion *motions)
{
    if (!(pose->penetration > 0.0)) {
        return (DriverPress){.force = {0.0, 0.0}};
    }
    const double began = fmax(contact->approach_before, pose->approach_speed);
    const double speed = contact->state.is_touching ? contact->state.damping_speed : began;
    const double force =
        force_law_force(&joint->law, pose->penetration, pose->approach_speed, speed);
    DriverPress press = {.force = vec2_scale(force, pose->normal)};
    if (joint->law.friction > 0.0) {
        const int *bodies = joint->bodies;
        const Vec2 tangent = vec2_perp(pose->normal);
        const double pin_arm = joint->hole_radius - pose->eccentricity_size;
        const Vec2 going = vec2_sub(driver_point_velocity(motions, bodies[1], joint->anchors[1]),
                                    driver_point_velocity(motions, bodies[0], joint->anchors[0]));
        const double sliding = vec2_dot(tangent, going) +
                               joint->hole_radius * omega_of(motions, bodies[0]) -
                               pin_arm * omega_of(motions, bodies[1]);
        const double held =
            joint->law.friction * force * friction_hold(sliding, joint->law.friction_speed).held;
        press.force = vec2_sub(press.force, vec2_scale(held, tangent));
        press.moments[0] = -joint->hole_radius * held;
        press.moments[1] = pin_arm * held;
    }
    return press;
}

void driver_follow(const DriverJoint *joint, const PinHole *pose, DriverContact *contact,
                   DriverTotals *totals)
{
    ContactState *state = &contact->state;
    contact->begun_share = 0.0;
    if (pose->penetration > 0.0) {
        if (!state->is_touching) {
            const double before = fmax(contact->gap_before, 0.0);
            const double share = before / (before + pose->penetration);
            contact->begun_share = 1.0 - share;
            *state = contact_state_begun((1.0 - share) * contact->approach_before +
                                         share * pose->approach_speed);
            totals->begun++;
            totals->approach = state->impact_speed;
        }
        contact_state_follow(state, pose->approach_speed, joint->law.resting_speed);
        totals->depth_max = fmax(totals->depth_max, pose->penetration);
    } else {
        state->is_touching = false;
    }
    contact->gap_before = pose->gap;
    contact->approach_before = pose->approach_speed;
}

void driver_note_force(DriverRun *run, size_t joint, const PinHole *pose, double force,
                       double step_s, DriverContact *contact)
{
    DriverPeak *peak = &run->peaks[joint];
    *peak = (DriverPeak){.force = 0.0};
    if (!(pose->penetration > 0.0)) {
        contact->peaks = (ContactPeaks){.force = 0.0};
        return;
    }
    if (contact->begun_share > 0.0) {
        // a damper may press from the first instant on
        const double speed = contact->state.impact_speed;
        contact_peaks_begin(&contact->peaks,
                            force_law_viscous(&run->of->joints[joint].law, 0.0) * speed,
                            contact->begun_share * step_s);
    }
    contact_peaks_note_step(&contact->peaks, force, pose->penetration, 1.0, step_s);
    *peak = (DriverPeak){contact->peaks.force, contact->peaks.depth};
    run->totals[joint].force_max = fmax(run->totals[joint].force_max, peak->force);
    run->totals[joint].depth_max = fmax(run->totals[joint].depth_max, peak->depth);
}
