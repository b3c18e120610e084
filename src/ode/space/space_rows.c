// Steps a linkage in space in ODE with contacts as rows of the world.
//
// Plain and staggered stepping, as ode/plane/plain.c and ode/plane/staggered.c have them in the
// plane. Bodies turn by finite rotations: staggered, by h omega from mid-step to mid-step. Turning
// inertias are ODE's own affair in plain stepping; in staggered stepping a torque of second order
// stands for them (ode/space/space_world.c), with the angular acceleration of the step before for
// what else acts.
#include "base/zeroed.h"
#include "model/space.h"
#include "model/space_response.h"
#include "ode/engine.h"
#include "ode/space/space_contacts.h"
#include "ode/space/space_joints.h"
#include "ode/space/space_stops.h"
#include "ode/space/space_world.h"
#include "ode/stepping.h"

#include <string.h>

// The motion of a body in space at a time inside a step.

static Vec3 weigh(double share, Vec3 a, Vec3 b)
{
    return vec3_add(vec3_scale(1.0 - share, a), vec3_scale(share, b));
}

// Within a step of a leapfrog: `first` has the speeds of the step's start and positions of its
// middle, `mean` and `other` the mean accelerations of this step and of the one beside it, on the
// side of the time, s since the start. Speeds are linear, positions their integral, accelerations
// linear between mid-steps.
static SpaceMotion space_between_leapfrog(const SpaceMotion *first, const SpaceMotion *mean,
                                          const SpaceMotion *other, double since_s, double step_s)
{
    const double off_s = since_s - 0.5 * step_s;
    const double share = fabs(off_s) / step_s; // of the way to the other step's middle
    const double square = 0.5 * since_s * since_s;
    const SpaceChange place = {
        vec3_add(vec3_scale(off_s, first->velocity), vec3_scale(square, mean->acceleration)),
        vec3_add(vec3_scale(off_s, first->omega), vec3_scale(square, mean->alpha))};
    const SpaceChange speed = {vec3_scale(since_s, mean->acceleration),
                               vec3_scale(since_s, mean->alpha)};
    SpaceMotion motion = *first;
    space_change(&motion, &place, &speed);
    motion.acceleration = weigh(share, mean->acceleration, other->acceleration);
    motion.alpha = weigh(share, mean->alpha, other->alpha);
    return motion;
}

// The step before the first has no accelerations: they go on as they come, from the first two.
static void space_between_guess(const SpaceMotion *first, const SpaceMotion *second,
                                SpaceMotion *before)
{
    before->acceleration = weigh(-1.0, first->acceleration, second->acceleration);
    before->alpha = weigh(-1.0, first->alpha, second->alpha);
}

// Within a plain step, from its start to its end: positions and speeds are linear, accelerations
// those of `last`, means of the step. ODE moves its bodies by the speed at the end.
static SpaceMotion space_between_plain(const SpaceMotion *first, const SpaceMotion *last,
                                       double since_s, double step_s)
{
    const double share = since_s / step_s;
    const SpaceChange place = {vec3_scale(share, vec3_sub(last->position, first->position)),
                               vec3_scale(since_s, last->omega)};
    const SpaceChange speed = {vec3_scale(since_s, last->acceleration),
                               vec3_scale(since_s, last->alpha)};
    SpaceMotion motion = *first;
    space_change(&motion, &place, &speed);
    motion.acceleration = last->acceleration;
    motion.alpha = last->alpha;
    return motion;
}

typedef struct SpaceStride {
    double start_s;
    SpaceMotion *first; // by body: speeds at the step's start, and positions there (plain) or at
                        // mid-step (staggered); owned, like the arrays below
    SpaceMotion *last;  // as ODE leaves them; accelerations are means of the step
    double *omega;      // rad/s, about z, at its end
    double *alpha;      // rad/s^2, about z, mean
    SpaceJoints joints;
    double *impulse; // by joint
    double *approach;
    JointPeak *peaks;
    double drive_work; // J
    ContactEnergy energy;
} SpaceStride;

// One step with contacts as rows of the world, as it is handed on.

static void space_stride_create(const Linkage *linkage, SpaceStride *stride)
{
    stride->first = zeroed(linkage->body_count, sizeof *stride->first);
    stride->last = zeroed(linkage->body_count, sizeof *stride->last);
    stride->omega = zeroed(linkage->body_count, sizeof *stride->omega);
    stride->alpha = zeroed(linkage->body_count, sizeof *stride->alpha);
    stride->joints = space_joints_create(linkage);
    stride->impulse = zeroed(linkage->joint_count, sizeof *stride->impulse);
    stride->peaks = zeroed(linkage->joint_count, sizeof *stride->peaks);
    stride->approach = zeroed(linkage->joint_count, sizeof *stride->approach);
}

static void space_stride_free(SpaceStride *stride)
{
    free(stride->first);
    free(stride->last);
    free(stride->omega);
    free(stride->alpha);
    space_joints_free(&stride->joints);
    free(stride->impulse);
    free(stride->approach);
    free(stride->peaks);
}

// Fills in forces, energies, impulses and the drive's part of a step that has been taken, and
// removes its contacts. `driven` is the motion of the driven body in its rows.
static void space_stride_book(SpaceStride *stride, const SpaceMotion *driven, double step_s,
                              const World *world, SpaceContacts *contacts, SpaceStops *stops)
{
    const Linkage *linkage = world->linkage;
    const int body = linkage_driven_body(linkage);
    SpaceChange others = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    space_contacts_clear(contacts, step_s, &stride->joints);
    space_contacts_load(contacts, body, driven->position, &others);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!linkage_is_ideal(linkage, i)) {
            continue;
        }
        space_joints_hold(&stride->joints, i, space_world_force(world, i));
        if (body >= 0 && (joint->body_a == body || joint->body_b == body)) {
            const SpaceChange load = space_world_load(world, i, body);
            others.move = vec3_add(others.move, load.move);
            others.turn = vec3_add(others.turn, load.turn);
        }
    }
    space_stops_clear(stops, step_s, &stride->joints);
    space_stops_peaks(stops, stride->peaks);
    stride->drive_work = 0.0;
    if (body >= 0) {
        Vec3 force;
        stride->drive_work =
            step_s * space_joints_drive(contacts->scenario, driven, &others, &force);
        space_joints_hold(&stride->joints, (size_t)linkage->driver.joint, force);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        stride->impulse[i] = stride->joints.plane[i].force * step_s;
    }
    space_contacts_impulses(contacts, step_s, stride->impulse);
    stride->energy = space_contacts_energy(contacts);
    const ContactEnergy ends = space_stops_energy(stops);
    stride->energy.dissipated += ends.dissipated;
    stride->energy.elastic += ends.elastic;
}

typedef struct SpaceRows {
    const Scenario *scenario;
    bool is_staggered;
    World world;
    SpaceResponse response;
    SpaceHold *hold; // owned
    SpaceContacts contacts;
    SpaceStops stops;
    double step_s;
    long index; // of the next step: it starts at that many times step_s
    int driven;
    Vec3 *rest;             // rad/s^2, by body: of the last step, beside the turning inertias'
    Vec3 *gyration;         // rad/s^2, room: by those
    SpaceMotion *seen;      // room
    SpaceStride strides[3]; // before the one handed on, that one, and the one ahead of it
    SpaceStride *before;
    SpaceStride *now;
    SpaceStride *ahead; // of plain stepping the one handed on
} SpaceRows;

static void space_rows_close(void *state)
{
    SpaceRows *rows = state;
    if (rows != NULL) {
        space_contacts_finish(&rows->contacts);
        space_stops_finish(&rows->stops);
        world_finish(&rows->world);
        space_response_finish(&rows->response);
        space_hold_free(rows->hold);
        for (size_t i = 0; i < sizeof rows->strides / sizeof *rows->strides; i++) {
            space_stride_free(&rows->strides[i]);
        }
        free(rows->rest);
        free(rows->gyration);
        free(rows->seen);
        free(rows);
    }
}

// Builds the world closed, so that every joint gets its anchors where they belong, and moves it
// then.
static bool build(SpaceRows *rows, Err *err)
{
    const Scenario *scenario = rows->scenario;
    if (!space_contacts_list(&rows->contacts, scenario, err) ||
        !space_stops_list(&rows->stops, scenario, err)) {
        return false;
    }
    SpaceMotion *motions = rows->seen;
    space_start(&scenario->linkage, motions);
    const size_t pins = rows->contacts.count;
    SpaceResponsePlace *places =
        space_contacts_response_places(&rows->contacts, pins + rows->stops.count);
    space_stops_response_places(&rows->stops, places + pins);
    const bool is_built = space_world_build(scenario, motions, places, pins + rows->stops.count,
                                            &rows->world, &rows->response, &rows->hold, err);
    free(places);
    if (!is_built) {
        return false;
    }
    space_contacts_init(&rows->contacts, &rows->world, &rows->response, rows->is_staggered);
    space_stops_init(&rows->stops, &rows->world, &rows->response, pins, rows->is_staggered);
    return !rows->is_staggered ||
           space_world_move_on(&rows->world, &rows->response, rows->step_s, motions, err);
}

static bool open_rows(const Scenario *scenario, bool is_staggered, void **state, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    SpaceRows *rows = zeroed(1, sizeof *rows);
    rows->scenario = scenario;
    rows->is_staggered = is_staggered;
    rows->step_s = scenario->run.step;
    rows->driven = linkage_driven_body(&scenario->linkage);
    rows->before = &rows->strides[0];
    rows->now = &rows->strides[1];
    rows->ahead = &rows->strides[2];
    rows->rest = zeroed(linkage->body_count, sizeof *rows->rest);
    rows->gyration = zeroed(linkage->body_count, sizeof *rows->gyration);
    rows->seen = zeroed(linkage->body_count, sizeof *rows->seen);
    for (size_t i = 0; i < sizeof rows->strides / sizeof *rows->strides; i++) {
        space_stride_create(linkage, &rows->strides[i]);
    }
    if (build(rows, err)) {
        *state = rows;
        return true;
    }
    space_rows_close(rows);
    return false;
}

static bool open_plain(const Scenario *scenario, void **state, Err *err)
{
    return open_rows(scenario, false, state, err);
}

static bool open_staggered(const Scenario *scenario, void **state, Err *err)
{
    return open_rows(scenario, true, state, err);
}

// The driven body in a step: where it stands, and its speeds at the step's start and as the rows
// see them.
typedef struct Driven {
    SpaceMotion placed;
    SpaceMotion start;
    SpaceMotion seen;
} Driven;

static Driven find_driven(const SpaceRows *rows, double start_s)
{
    const Linkage *linkage = &rows->scenario->linkage;
    Driven driven = {.placed = {.turn = {1.0, 0.0, 0.0, 0.0}}};
    if (rows->driven >= 0) {
        driven.placed = driven.start = driven.seen = space_driven(linkage, start_s);
    }
    if (rows->driven >= 0 && rows->is_staggered) {
        driven.placed = space_driven(linkage, start_s + 0.5 * rows->step_s);
        driven.seen = space_driven(linkage, start_s + rows->step_s);
    }
    return driven;
}

// Puts the driven body to its position with its speeds at one of the times.
static void place_driven(SpaceRows *rows, const Driven *driven, const SpaceMotion *speeds)
{
    if (rows->driven >= 0) {
        SpaceMotion placed = driven->placed;
        placed.velocity = speeds->velocity;
        placed.omega = speeds->omega;
        space_world_place(&rows->world, (size_t)rows->driven, &placed);
    }
}

// Lets the turning of inertias act; writes the angular accelerations it makes.
static void gyrate(SpaceRows *rows, const SpaceStride *stride, Vec3 *alpha)
{
    for (size_t i = 0; i < rows->scenario->linkage.body_count; i++) {
        alpha[i] = (Vec3){0.0, 0.0, 0.0};
        if (rows->is_staggered && (int)i != rows->driven) {
            const Vec3 torque = space_world_gyration(&rows->response, i, &stride->first[i],
                                                     rows->rest[i], rows->step_s, &alpha[i]);
            dBodyAddTorque(rows->world.bodies[i], torque.x, torque.y, torque.z);
        }
    }
}

// The motions as the rows of the step see them: the bodies accelerated by gravity and by their
// turning inertias.
static void look_ahead(const SpaceRows *rows, const SpaceStride *stride, const Vec3 *gyration,
                       const Driven *driven, SpaceMotion *seen)
{
    const Linkage *linkage = &rows->scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        seen[i] = stride->first[i];
        seen[i].acceleration = rows->scenario->gravity;
        seen[i].alpha = gyration[i];
    }
    if (rows->driven >= 0) {
        seen[rows->driven].velocity = driven->seen.velocity;
        seen[rows->driven].omega = driven->seen.omega;
        seen[rows->driven].acceleration = seen[rows->driven].alpha = (Vec3){0.0, 0.0, 0.0};
    }
}

// Speeds and accelerations of a step that has been taken.
static void read_motions(SpaceRows *rows, const Vec3 *gyration, SpaceStride *stride)
{
    for (size_t i = 0; i < rows->scenario->linkage.body_count; i++) {
        SpaceMotion *last = &stride->last[i];
        const SpaceMotion *first = &stride->first[i];
        const double rate = 1.0 / rows->step_s;
        *last = space_world_motion(&rows->world, i);
        last->acceleration = vec3_scale(rate, vec3_sub(last->velocity, first->velocity));
        last->alpha = vec3_scale(rate, vec3_sub(last->omega, first->omega));
        if ((int)i == rows->driven) {
            last->alpha = (Vec3){0.0, 0.0, 0.0};
        }
        rows->rest[i] = vec3_sub(last->alpha, gyration[i]);
        stride->omega[i] = last->omega.z;
        stride->alpha[i] = last->alpha.z;
    }
    if (rows->driven >= 0 && !rows->is_staggered) {
        stride->omega[rows->driven] = stride->first[rows->driven].omega.z;
    }
}

// Holds the ideal joints where they are no rows of ODE.
static bool hold(SpaceRows *rows, const SpaceStride *stride, Err *err)
{
    if (rows->hold == NULL) {
        return true;
    }
    if (!space_response_place(&rows->response, stride->first, NULL)) {
        return err_set(err, ERR_SOLVER,
                       "the ideal joints are redundant here: give one joint of the loop some play");
    }
    space_hold_push(rows->hold, &rows->response, stride->first, rows->step_s, &rows->world);
    return true;
}

static bool advance(SpaceRows *rows, SpaceStride *stride, Err *err)
{
    const Linkage *linkage = &rows->scenario->linkage;
    const double step_s = rows->step_s;
    World *world = &rows->world;
    stride->start_s = (double)rows->index * step_s;
    const Driven driven = find_driven(rows, stride->start_s);
    place_driven(rows, &driven, &driven.start);
    for (size_t i = 0; i < linkage->body_count; i++) {
        stride->first[i] = space_world_motion(world, i);
    }
    space_joints_clear(linkage, &stride->joints);
    space_joints_place(&rows->response, stride->first, stride->joints.plane, stride->joints.space);
    Vec3 *gyration = rows->gyration;
    gyrate(rows, stride, gyration);
    const bool is_quick = rows->scenario->ode.solver == ODE_QUICK;
    SpaceMotion *seen = rows->seen;
    look_ahead(rows, stride, gyration, &driven, seen);
    bool is_good =
        space_contacts_make(&rows->contacts, stride->first, seen, step_s, stride->approach, err);
    is_good = is_good && space_stops_make(&rows->stops, stride->first, step_s, &stride->joints,
                                          stride->approach, err);
    place_driven(rows, &driven, &driven.seen);
    is_good = is_good && hold(rows, stride, err);
    is_good =
        is_good && engine_step(world->id, step_s, is_quick, err) && space_world_check(world, err);
    if (!is_good) {
        return stepping_fail(rows->scenario, stride->start_s, (size_t)rows->index + 1, step_s, err);
    }
    read_motions(rows, gyration, stride);
    space_stride_book(stride, &driven.placed, step_s, world, &rows->contacts, &rows->stops);
    rows->index++;
    return true;
}

static bool space_rows_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // a fixed step: samples are looked up inside it
    SpaceRows *rows = state;
    if (!rows->is_staggered) {
        return advance(rows, rows->ahead, err);
    }
    // the first time also one ahead
    do {
        SpaceStride *const spare = rows->before;
        rows->before = rows->now;
        rows->now = rows->ahead;
        rows->ahead = spare;
        if (!advance(rows, rows->ahead, err)) {
            return false;
        }
    } while (rows->index < 2);
    for (size_t i = 0; rows->index == 2 && i < rows->scenario->linkage.body_count; i++) {
        space_between_guess(&rows->now->last[i], &rows->ahead->last[i], &rows->before->last[i]);
    }
    return true;
}

static const SpaceStride *handed_on(const SpaceRows *rows)
{
    return rows->is_staggered ? rows->now : rows->ahead;
}

static void space_stride_carry(const Linkage *linkage, SpaceStride *stride, Carry *carry)
{
    const size_t bodies = linkage->body_count;
    const size_t joints = linkage->joint_count;
    CARRY(carry, stride->start_s);
    CARRY_ARRAY(carry, stride->first, bodies);
    CARRY_ARRAY(carry, stride->last, bodies);
    CARRY_ARRAY(carry, stride->omega, bodies);
    CARRY_ARRAY(carry, stride->alpha, bodies);
    CARRY_ARRAY(carry, stride->joints.plane, joints);
    CARRY_ARRAY(carry, stride->joints.space, joints);
    CARRY_ARRAY(carry, stride->impulse, joints);
    CARRY_ARRAY(carry, stride->approach, joints);
    CARRY_ARRAY(carry, stride->peaks, joints);
    CARRY(carry, stride->drive_work);
    CARRY(carry, stride->energy);
}

static bool space_rows_carry(void *state, Carry *carry)
{
    SpaceRows *rows = state;
    const Linkage *linkage = &rows->scenario->linkage;
    world_carry(&rows->world, carry);
    space_contacts_carry(&rows->contacts, carry);
    space_stops_carry(&rows->stops, carry);
    CARRY(carry, rows->index);
    CARRY_ARRAY(carry, rows->rest, linkage->body_count);
    space_stride_carry(linkage, rows->before, carry);
    space_stride_carry(linkage, rows->now, carry);
    space_stride_carry(linkage, rows->ahead, carry);
    return true;
}

static StepRecord space_rows_record(const void *state)
{
    const SpaceRows *rows = state;
    const SpaceStride *now = handed_on(rows);
    const long number = rows->is_staggered ? rows->index - 1 : rows->index;
    return (StepRecord){
        .start_s = now->start_s,
        .end_s = (double)number * rows->step_s,
        .joint_s = now->start_s + (rows->is_staggered ? 0.5 * rows->step_s : 0.0),
        .is_mean = true,
        .omega = now->omega,
        .alpha = now->alpha,
        .joints = now->joints.plane,
        .space_joints = now->joints.space,
        .impulse = now->impulse,
        .approach = now->approach,
        .peaks = rows->is_staggered ? now->peaks : NULL,
        .drive_work = now->drive_work,
        .dissipated = now->energy.dissipated,
        .friction = now->energy.friction,
        .elastic = now->energy.elastic,
    };
}

static void space_rows_observe(const void *state, double time_s, Sample *sample)
{
    const SpaceRows *rows = state;
    const Linkage *linkage = &rows->scenario->linkage;
    const SpaceStride *now = handed_on(rows);
    const double since_s = time_s - now->start_s;
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const SpaceStride *other =
            since_s < 0.5 * rows->step_s ? rows->before : rows->ahead; // of staggered stepping
        sample->space_bodies[i] =
            rows->is_staggered
                ? space_between_leapfrog(&now->first[i], &now->last[i], &other->last[i], since_s,
                                         rows->step_s)
                : space_between_plain(&now->first[i], &now->last[i], since_s, rows->step_s);
        if ((int)i == rows->driven) {
            sample->space_bodies[i] = space_driven(linkage, time_s);
        }
        sample->bodies[i] = space_planar(&sample->space_bodies[i]);
    }
    memcpy(sample->joints, now->joints.plane, linkage->joint_count * sizeof *sample->joints);
    memcpy(sample->space_joints, now->joints.space,
           linkage->joint_count * sizeof *sample->space_joints);
    space_joints_place(&rows->response, sample->space_bodies, sample->joints, sample->space_joints);
}

static void space_rows_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    const SpaceRows *rows = state;
    space_contacts_states(&rows->contacts, states);
    space_stops_states(&rows->stops, states);
}

static SolverModel space_rows_model(const void *state)
{
    const SpaceRows *rows = state;
    SolverModel model = {
        .step_s = rows->step_s,
        .constraint_rows = rows->world.constraint_rows,
        .contact_rows = rows->contacts.most_rows,
        .fallback_rows = rows->contacts.fallback_count + rows->stops.fallback_count,
        .steps = (size_t)rows->index,
    };
    stepping_label(rows->scenario, rows->is_staggered ? "staggered" : "plain",
                   OPTIONS_ODE_MAPS[rows->scenario->ode.map], model.label);
    return model;
}

const Solver SPACE_PLAIN = {
    .name = "plain",
    .open = open_plain,
    .step = space_rows_step,
    .record = space_rows_record,
    .observe = space_rows_observe,
    .contacts = space_rows_contacts,
    .carry = space_rows_carry,
    .model = space_rows_model,
    .close = space_rows_close,
};

const Solver SPACE_STAGGERED = {
    .name = "staggered",
    .open = open_staggered,
    .step = space_rows_step,
    .record = space_rows_record,
    .observe = space_rows_observe,
    .contacts = space_rows_contacts,
    .carry = space_rows_carry,
    .model = space_rows_model,
    .close = space_rows_close,
};
