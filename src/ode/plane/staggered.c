// Steps a planar linkage in ODE as a leapfrog: positions stand half a step behind speeds.
//
// ODE's positions stand at mid-step when its speeds stand at the step's start. Step n, t = n h:
//     positions at t + h/2, speeds v_n at t: contacts are looked for there
//     v_n+1 = v_n + h M^-1 (forces + J^T lambda),  positions move on by h v_n+1       (dWorldStep)
// Everything in a contact row has its right time: depth and normal at t + h/2, the old speeds of
// both bodies at t, the driven body's speed in the row at t + h. The joint rows' error is carried
// off with ERP 1, which makes them a linearised SHAKE: second order.
//
// Its steady state leaves each row phi of an ideal joint open by phi = (h^2/2) (dJ/dt) v, for a
// step keeps phi + h J v' = 0 and bodies turn meanwhile; of a revolute joint that is the difference
// of its arms' centripetal accelerations. The run starts half a step on, moved to that opening
// along M^-1 J', the directions of the joints' own forces: speeds are then right from the first
// step. Where the drive determines the motion it starts four steps early, and accelerations are,
// too.
//
// Read between: speeds linear in each step, positions their integral, accelerations linear between
// mid-steps. That needs the step after: the run is one step ahead of what it hands on. Where a load
// jumps within a step, after a share s of it, speeds are linear on each side, with the acceleration
// a_- of the step before and a_+ that gives the step its mean:
//     s a_- + (1 - s) a_+ = a
// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. 2006, VII.1.4 on SHAKE.
#include "base/zeroed.h"
#include "model/joint_rows.h"
#include "model/loads.h"
#include "model/response.h"
#include "ode/plane/contact_rows.h"
#include "ode/stepping.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// what is left of the start's error is gone after two
enum { SETTLE_STEPS = 4 };

// One step, as it is handed on.
typedef struct Stride {
    double start_s;
    Snapshot *middle; // positions at mid-step, speeds at its start; owned, as are the arrays below
    Vec2 *velocity;   // at its end
    double *omega;
    double *alpha; // mean
    JointState *joints;
    JointPeak *peaks;
    double *impulse;
    double *approach;
    double drive_work; // J
    double load_work;  // J
    double damped;     // J, in dampers
    double rubbed;     // J, in the friction of ideal joints
    ContactEnergy energy;
} Stride;

typedef struct Staggered {
    const Scenario *scenario;
    World world;
    ContactRows contacts;
    double step_s;
    long index; // of the next step: it starts at that many times step_s
    size_t steps;
    Vec2 *offsets;     // by joint, to work with; owned
    Stride strides[3]; // before the one handed on, that one, and the one ahead of it
    Stride *before;
    Stride *now;
    Stride *ahead;
} Staggered;

static void stride_init(const Linkage *linkage, Stride *stride)
{
    stride->middle = zeroed(linkage->body_count, sizeof *stride->middle);
    stride->velocity = zeroed(linkage->body_count, sizeof *stride->velocity);
    stride->omega = zeroed(linkage->body_count, sizeof *stride->omega);
    stride->alpha = zeroed(linkage->body_count, sizeof *stride->alpha);
    stride->joints = zeroed(linkage->joint_count, sizeof *stride->joints);
    stride->peaks = zeroed(linkage->joint_count, sizeof *stride->peaks);
    stride->impulse = zeroed(linkage->joint_count, sizeof *stride->impulse);
    stride->approach = zeroed(linkage->joint_count, sizeof *stride->approach);
}

static void stride_finish(Stride *stride)
{
    free(stride->middle);
    free(stride->velocity);
    free(stride->omega);
    free(stride->alpha);
    free(stride->joints);
    free(stride->peaks);
    free(stride->impulse);
    free(stride->approach);
}

static void staggered_close(void *state)
{
    Staggered *staggered = state;
    if (staggered == NULL) {
        return;
    }
    contact_rows_finish(&staggered->contacts);
    world_finish(&staggered->world);
    for (size_t i = 0; i < 3; i++) {
        stride_finish(&staggered->strides[i]);
    }
    free(staggered->offsets);
    free(staggered);
}

// Moves the bodies so that each ideal joint is as far open as it stays, the response having been
// taken there.
static void open_joints(const Linkage *linkage, double step_s, const Response *response,
                        Motion *motions)
{
    double *openings = zeroed(response->ideal_rows, sizeof *openings);
    double *rates = zeroed(response->ideal_rows, sizeof *rates);
    double *changes = zeroed(3 * linkage->body_count, sizeof *changes);
    response_openings(response, motions, openings, rates);
    for (size_t row = 0; row < response->ideal_rows; row += JOINT_ROWS) {
        JointRows joint;
        joint_rows_find(linkage, motions, response->joint_of[row], &joint);
        openings[row] -= 0.5 * step_s * step_s * joint.bias[0];
        openings[row + 1] -= 0.5 * step_s * step_s * joint.bias[1];
    }
    response_close(response, openings, rates, changes);
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i].position.x += changes[3 * i];
        motions[i].position.y += changes[3 * i + 1];
        motions[i].angle += changes[3 * i + 2];
    }
    free(openings);
    free(rates);
    free(changes);
}

// The bodies half a step on, with the speeds of the start, each ideal joint as far open as it
// stays.
static bool move_on(const Scenario *scenario, double start_s, Response *response, Motion *motions,
                    Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    const double step_s = scenario->run.step;
    for (size_t i = 0; i < linkage->body_count; i++) {
        Motion *motion = &motions[i];
        motion->position = vec2_add(motion->position, vec2_scale(0.5 * step_s, motion->velocity));
        motion->angle += 0.5 * step_s * motion->omega;
    }
    stepping_set_driven(linkage, start_s + 0.5 * step_s, motions);
    if (!response_place(response, motions)) {
        return err_set(err, ERR_SOLVER,
                       "the ideal joints are redundant at the start: give one joint of the "
                       "loop some play");
    }
    open_joints(linkage, step_s, response, motions);
    return true;
}

static bool staggered_open(const Scenario *scenario, void **state, Err *err)
{
    Staggered *staggered = calloc(1, sizeof *staggered);
    assert(staggered != NULL);
    staggered->scenario = scenario;
    staggered->step_s = scenario->run.step;
    staggered->before = &staggered->strides[0];
    staggered->now = &staggered->strides[1];
    staggered->ahead = &staggered->strides[2];
    staggered->offsets = zeroed(scenario->linkage.joint_count, sizeof *staggered->offsets);
    for (size_t i = 0; i < 3; i++) {
        stride_init(&scenario->linkage, &staggered->strides[i]);
    }
    Motion *motions = zeroed(scenario->linkage.body_count, sizeof *motions);
    staggered->index = -stepping_start(scenario, staggered->step_s, SETTLE_STEPS, motions);
    const double start_s = (double)staggered->index * staggered->step_s;
    // built closed, so that every joint gets its anchors where they belong, and moved then
    const bool is_made =
        world_build(scenario, motions, &staggered->world, err) &&
        contact_rows_init(&staggered->contacts, scenario, &staggered->world, true, err) &&
        move_on(scenario, start_s, &staggered->contacts.mass.response, motions, err);
    for (size_t i = 0; is_made && i < scenario->linkage.body_count; i++) {
        world_place(&staggered->world, i, &motions[i]);
    }
    free(motions);
    if (!is_made) {
        staggered_close(staggered);
        return false;
    }
    *state = staggered;
    return true;
}

static void read_speeds(const Staggered *staggered, Stride *stride)
{
    for (size_t i = 0; i < staggered->scenario->linkage.body_count; i++) {
        const dReal *velocity = dBodyGetLinearVel(staggered->world.bodies[i]);
        stride->velocity[i] = (Vec2){velocity[0], velocity[1]};
        stride->omega[i] = dBodyGetAngularVel(staggered->world.bodies[i])[2];
        stride->alpha[i] = (stride->omega[i] - stride->middle[i].omega) / staggered->step_s;
    }
    const Linkage *linkage = &staggered->scenario->linkage;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        stride->alpha[linkage_drive_body(linkage, i)] = 0.0;
    }
}

// Energies, impulses and the drives' part of a step that has been taken.
static void book(Staggered *staggered, double middle_s, Stride *stride)
{
    const Linkage *linkage = &staggered->scenario->linkage;
    World *world = &staggered->world;
    const AppliedWork applied = applied_book(&world->applied, staggered->step_s);
    if (world->rubbing.count > 0) {
        stride->rubbed =
            rubbing_book(&world->rubbing, staggered->step_s, world->applied.loads, stride->joints);
    }
    const double power = contact_rows_drive_power(&staggered->contacts, middle_s,
                                                  staggered->offsets, stride->joints);
    stride->drive_work = staggered->step_s * power + applied.torque + applied.slope;
    stride->load_work = applied.loads;
    stride->damped = applied.damping;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        stride->impulse[i] = stride->joints[i].force * staggered->step_s;
    }
    stride->energy = contact_rows_energy(&staggered->contacts);
    if (world->rubbing.count > 0) {
        rubbing_note(&world->rubbing, stride->joints);
    }
}

static bool advance_staggered(Staggered *staggered, Stride *stride, Err *err)
{
    const double step_s = staggered->step_s;
    World *world = &staggered->world;
    stride->start_s = (double)staggered->index * step_s;
    const double end_s = (double)(staggered->index + 1) * step_s;
    const double middle_s = stride->start_s + 0.5 * step_s;
    world_place_driven(&staggered->world, middle_s, stride->start_s, 1);
    for (size_t i = 0; i < staggered->scenario->linkage.body_count; i++) {
        stride->middle[i] = world_snapshot(world, i);
    }
    applied_push(&world->applied, stride->start_s, step_s, APPLIED_AT_MEAN, 1);
    if (world->rubbing.count > 0) {
        rubbing_push(&world->rubbing, step_s, APPLIED_AT_MEAN);
    }
    if (!contact_rows_make(&staggered->contacts, step_s, stride->joints, stride->approach, err)) {
        return stepping_fail(staggered->scenario, stride->start_s, staggered->steps + 1, step_s,
                             err);
    }
    world_place_driven(world, middle_s, end_s, 1);
    const bool is_quick = staggered->scenario->ode.solver == ODE_QUICK;
    if (!world_step(world, step_s, is_quick, err) || !world_check(world, err)) {
        return stepping_fail(staggered->scenario, stride->start_s, staggered->steps + 1, step_s,
                             err);
    }
    world_joint_forces(world, stride->joints);
    contact_rows_clear(&staggered->contacts, step_s, stride->joints);
    contact_rows_peaks(&staggered->contacts, stride->peaks);
    read_speeds(staggered, stride);
    book(staggered, middle_s, stride);
    staggered->index++;
    staggered->steps++;
    return true;
}

// The step before the first has no accelerations: they go on as they come.
static void guess_before(Staggered *staggered)
{
    for (size_t i = 0; i < staggered->scenario->linkage.body_count; i++) {
        staggered->before->alpha[i] = 2.0 * staggered->now->alpha[i] - staggered->ahead->alpha[i];
        const Vec2 *next = &staggered->now->velocity[i];
        const Vec2 first = staggered->now->middle[i].velocity;
        const Vec2 change = vec2_sub(staggered->ahead->velocity[i], *next);
        const Vec2 gained = vec2_sub(*next, first);
        // a change before the first step of 2 gained - change
        staggered->before->middle[i].velocity =
            vec2_sub(first, vec2_sub(vec2_scale(2.0, gained), change));
        staggered->before->velocity[i] = first;
    }
}

static bool staggered_carry(void *state, Carry *carry);

// Friction comes from what presses in the step before: the first step is taken some times, until it
// is what presses in that step itself.
enum { PRIMING_STEPS = 6 };

static bool prime_friction(Staggered *staggered, Err *err)
{
    Rubbing *rubbing = &staggered->world.rubbing;
    bool is_good = true;
    for (int i = 0; i < PRIMING_STEPS && is_good && rubbing->count > 0; i++) {
        Carry carry = {0};
        carry_begin(&carry, false);
        staggered_carry(staggered, &carry);
        is_good = advance_staggered(staggered, staggered->ahead, err);
        double *pressing = zeroed(rubbing->count, sizeof *pressing);
        for (size_t k = 0; k < rubbing->count; k++) {
            pressing[k] = rubbing->rows[k].rub.pressing[0];
        }
        carry_begin(&carry, true);
        staggered_carry(staggered, &carry);
        carry_finish(&carry);
        for (size_t k = 0; k < rubbing->count; k++) {
            rubbing->rows[k].rub.pressing[0] = pressing[k];
            rubbing->rows[k].rub.known = 0;
        }
        free(pressing);
    }
    return is_good;
}

static bool staggered_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // a fixed step: samples are looked up inside it
    Staggered *staggered = state;
    if (staggered->steps == 0 && !prime_friction(staggered, err)) {
        return false;
    }
    // the first time also the steps before time zero, so that they are timed, and one ahead
    do {
        Stride *const spare = staggered->before;
        staggered->before = staggered->now;
        staggered->now = staggered->ahead;
        staggered->ahead = spare;
        if (!advance_staggered(staggered, staggered->ahead, err)) {
            return false;
        }
    } while (staggered->index < 2);
    if (staggered->steps == 2) {
        guess_before(staggered);
    }
    return true;
}

static void stride_carry(const Linkage *linkage, Stride *stride, Carry *carry)
{
    const size_t bodies = linkage->body_count;
    const size_t joints = linkage->joint_count;
    CARRY(carry, stride->start_s);
    CARRY_ARRAY(carry, stride->middle, bodies);
    CARRY_ARRAY(carry, stride->velocity, bodies);
    CARRY_ARRAY(carry, stride->omega, bodies);
    CARRY_ARRAY(carry, stride->alpha, bodies);
    CARRY_ARRAY(carry, stride->joints, joints);
    CARRY_ARRAY(carry, stride->peaks, joints);
    CARRY_ARRAY(carry, stride->impulse, joints);
    CARRY_ARRAY(carry, stride->approach, joints);
    CARRY(carry, stride->drive_work);
    CARRY(carry, stride->load_work);
    CARRY(carry, stride->damped);
    CARRY(carry, stride->rubbed);
    CARRY(carry, stride->energy);
}

static bool staggered_carry(void *state, Carry *carry)
{
    Staggered *staggered = state;
    const Linkage *linkage = &staggered->scenario->linkage;
    world_carry(&staggered->world, carry);
    contact_rows_carry(&staggered->contacts, carry);
    CARRY(carry, staggered->index);
    CARRY(carry, staggered->steps);
    stride_carry(linkage, staggered->before, carry);
    stride_carry(linkage, staggered->now, carry);
    stride_carry(linkage, staggered->ahead, carry);
    return true;
}

static StepRecord staggered_record(const void *state)
{
    const Staggered *staggered = state;
    const Stride *now = staggered->now;
    return (StepRecord){
        .start_s = now->start_s,
        .end_s = staggered->ahead->start_s,
        .joint_s = now->start_s + 0.5 * staggered->step_s,
        .is_mean = true,
        .omega = now->omega,
        .alpha = now->alpha,
        .joints = now->joints,
        .peaks = now->peaks,
        .impulse = now->impulse,
        .approach = now->approach,
        .drive_work = now->drive_work,
        .load_work = now->load_work,
        .dissipated = now->energy.dissipated + now->damped,
        .friction = now->energy.friction + now->rubbed,
        .elastic = now->energy.elastic,
    };
}

// The mean acceleration of a body's centre in a step.
static Vec2 centre_acceleration(const Stride *stride, size_t body, double step_s)
{
    return vec2_scale(1.0 / step_s,
                      vec2_sub(stride->velocity[body], stride->middle[body].velocity));
}

// The jumps of loads about the step that is handed on.
typedef struct StrideJumps {
    double inside_s; // after its start; 0: none is in it, or there is no step before
    bool is_before;  // whether one is at its start or in the step before: then that one's
                     // acceleration says nothing of this one's
    bool is_ahead;   // likewise at its end or in the next
} StrideJumps;

static StrideJumps jumps_about(const Staggered *staggered)
{
    const Linkage *linkage = &staggered->scenario->linkage;
    const double step_s = staggered->step_s;
    const double start_s = staggered->now->start_s;
    const double rounding_s = STEPPING_ROUNDING * step_s;
    const double inside_s = loads_next_jump(linkage, start_s + rounding_s) - start_s;
    const bool is_inside = start_s > 0.0 && inside_s < step_s - rounding_s;
    return (StrideJumps){
        .inside_s = is_inside ? inside_s : 0.0,
        .is_before =
            loads_next_jump(linkage, start_s - step_s + rounding_s) <= start_s + rounding_s,
        .is_ahead = loads_next_jump(linkage, start_s + step_s - rounding_s) <
                    start_s + 2.0 * step_s - rounding_s,
    };
}

static Motion motion_at(const Staggered *staggered, size_t body, const StrideJumps *jumps,
                        double since_s)
{
    const Stride *now = staggered->now;
    const double step_s = staggered->step_s;
    const Snapshot *middle = &now->middle[body];
    const double off_s = since_s - 0.5 * step_s;
    const Stride *other = off_s < 0.0 ? staggered->before : staggered->ahead;
    const bool is_cut = off_s < 0.0 ? jumps->is_before : jumps->is_ahead;
    const double share = is_cut ? 0.0 : fabs(off_s) / step_s; // of the way to the other's middle
    const Vec2 mean = centre_acceleration(now, body, step_s);
    const Vec2 beside = centre_acceleration(other, body, step_s);
    // positions: v_n t + a t^2 / 2 from the start, where they are h/2 v_n behind mid-step
    const Vec2 moved =
        vec2_add(vec2_scale(off_s, middle->velocity), vec2_scale(0.5 * since_s * since_s, mean));
    return (Motion){
        .position = vec2_add(middle->position, moved),
        .angle = atan2(middle->direction.y, middle->direction.x) + off_s * middle->omega +
                 0.5 * since_s * since_s * now->alpha[body],
        .velocity = vec2_add(middle->velocity, vec2_scale(since_s, mean)),
        .omega = middle->omega + since_s * now->alpha[body],
        .acceleration = vec2_add(vec2_scale(1.0 - share, mean), vec2_scale(share, beside)),
        .alpha = (1.0 - share) * now->alpha[body] + share * other->alpha[body],
    };
}

// Puts the rates of a body's motion onto their side of a jump.
static void set_beside_jump(const Staggered *staggered, size_t body, double jump_s, double since_s,
                            Motion *motion)
{
    const Stride *now = staggered->now;
    const double step_s = staggered->step_s;
    const Vec2 before = centre_acceleration(staggered->before, body, step_s);
    const Vec2 mean = centre_acceleration(now, body, step_s);
    const SteppingRate x = stepping_beside_jump(before.x, mean.x, jump_s, step_s, since_s);
    const SteppingRate y = stepping_beside_jump(before.y, mean.y, jump_s, step_s, since_s);
    const SteppingRate turning = stepping_beside_jump(staggered->before->alpha[body],
                                                      now->alpha[body], jump_s, step_s, since_s);
    motion->velocity = vec2_add(now->middle[body].velocity, (Vec2){x.gain, y.gain});
    motion->acceleration = (Vec2){x.slope, y.slope};
    motion->omega = now->middle[body].omega + turning.gain;
    motion->alpha = turning.slope;
}

static void staggered_observe(const void *state, double time_s, Sample *sample)
{
    const Staggered *staggered = state;
    const Linkage *linkage = &staggered->scenario->linkage;
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    const double since_s = time_s - staggered->now->start_s;
    const StrideJumps jumps = jumps_about(staggered);
    for (size_t i = 0; i < linkage->body_count; i++) {
        Motion *motion = &sample->bodies[i];
        *motion = motion_at(staggered, i, &jumps, since_s);
        if (jumps.inside_s > 0.0) {
            set_beside_jump(staggered, i, jumps.inside_s, since_s, motion);
        }
        motion->angle = world_count_turns(&staggered->world, i, motion->angle);
    }
    stepping_set_driven(linkage, time_s, sample->bodies);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        sample->joints[i] = staggered->now->joints[i];
        stepping_observe_joint(linkage, i, sample);
    }
}

static void staggered_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    contact_rows_states(&((const Staggered *)state)->contacts, states);
}

static SolverModel staggered_model(const void *state)
{
    const Staggered *staggered = state;
    SolverModel model = {
        .step_s = staggered->step_s,
        .constraint_rows = staggered->world.constraint_rows,
        .contact_rows = staggered->contacts.most_rows,
        .fallback_rows = staggered->contacts.fallback_count,
        .steps = staggered->steps,
    };
    stepping_label(staggered->scenario, "staggered", OPTIONS_ODE_MAPS[staggered->scenario->ode.map],
                   model.label);
    return model;
}

const Solver STEPPING_STAGGERED = {
    .name = "staggered",
    .open = staggered_open,
    .step = staggered_step,
    .record = staggered_record,
    .observe = staggered_observe,
    .contacts = staggered_contacts,
    .carry = staggered_carry,
    .model = staggered_model,
    .close = staggered_close,
};
