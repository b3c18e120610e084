// Fills in what the kernel is to know of the reactions of joints that rub.
//
// Reactions beside the kernel's rows, at mid-step as the free accelerations are: lambda = -D_ii^-1
// gamma_i (model/response.c); a force of 1 in a row brings A with it, and as speeds change by an
// impulse of 1 there, B (model/response_drift.h), with what dampers do at those speeds besides. How
// they change by themselves is seen from the step before, less what its impulses did.
#include "ode/plane/impulse_rubs.h"

#include "base/zeroed.h"
#include "kernel/friction_answer.h"
#include "kernel/friction_law.h"
#include "model/forces.h"
#include "model/joint_friction.h"
#include "model/joint_rows.h"

#include <assert.h>
#include <string.h>

size_t impulse_rubs_list(const Scenario *scenario, Touch *places)
{
    const Linkage *linkage = &scenario->linkage;
    size_t count = 0;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!joint_friction_is(joint) || !linkage_is_ideal(linkage, (size_t)i)) {
            continue;
        }
        const bool slides = joint_slides(joint->kind);
        places[count++] = (Touch){
            .joint = i,
            .place = JOINT_PLACES - 1,
            .shape = slides ? TOUCH_LINE : TOUCH_TURN,
            .anchor_a = joint->anchor_a,
            .anchor_b = joint->anchor_b,
            .direction = joint->direction,
            .sign = slides ? 0.0 : coordinate_sense(joint),
        };
    }
    return count;
}

KernelContact impulse_rubs_contact(const Scenario *scenario, const Touch *place)
{
    const Joint *joint = &scenario->linkage.joints[place->joint];
    const BristlePair pair = joint_friction_pair(&scenario->contact, joint);
    const ContactState *start = &joint->contacts[place->place];
    return (KernelContact){
        .law = {.family = FORCE_LAW_POWER,
                .exponent = 1.0,
                .friction = joint_friction_over(joint),
                .friction_speed = pair.speed,
                .bristle = pair},
        .shape = KERNEL_LINE,
        .joint = place->joint,
        .state = {.is_touching = true, .bend = start->bend, .bristle = start->bristle},
        .is_rub = true,
    };
}

static size_t ideal_row_of(const Response *response, int joint)
{
    for (size_t row = 0; row < response->ideal_rows; row += 2) {
        if (response->joint_of[row] == joint) {
            return row;
        }
    }
    assert(false); // an ideal joint that no drive turns has rows
    return 0;
}

void impulse_rubs_make(const Scenario *scenario, const Response *response, size_t first,
                       const Touch *places, Kernel *kernel, ImpulseRubs *rubs)
{
    const size_t n = kernel->rub_count;
    const size_t rows = kernel->row_count;
    const size_t bodies = scenario->linkage.body_count;
    *rubs = (ImpulseRubs){
        .scenario = scenario,
        .count = n,
        .rubs = zeroed(n, sizeof *rubs->rubs),
        .answers = zeroed(2 * n * rows, sizeof(double)),
        .turning = zeroed(2 * n * rows, sizeof(double)),
        .late = zeroed(2 * n * rows, sizeof(double)),
        .reactions = zeroed(response->ideal_rows, sizeof(double)),
        .driven = zeroed(response->ideal_rows, sizeof(double)),
        .unit = zeroed(rows, sizeof(double)),
        .changes = zeroed(n * (n + 2), sizeof(double)),
        .motions = zeroed(bodies, sizeof *rubs->motions),
        .loads = zeroed(bodies, sizeof *rubs->loads),
        .speeds = zeroed(3 * bodies, sizeof(double)),
    };
    for (size_t i = 0; i < n; i++) {
        ImpulseRub *rub = &rubs->rubs[i];
        KernelRub *of = &kernel->rubs[i];
        rub->joint = places[first + i].joint;
        rub->row = ideal_row_of(response, rub->joint);
        const Joint *joint = &scenario->linkage.joints[rub->joint];
        const bool slides = joint_slides(joint->kind);
        rub->weigh = !slides                        ? 1.0
                     : joint->friction.length > 0.0 ? 2.0 / joint->friction.length
                                                    : 0.0;
        of->is_guide = slides;
        of->steady = joint->friction.steady > 0.0 ? 1.0 : 0.0;
        of->alone = joint_friction_mobility(&scenario->linkage, joint);
        of->answers = rubs->answers + 2 * i * rows;
        of->turning = rubs->turning + 2 * i * rows;
        of->late = rubs->late + 2 * i * rows;
    }
}

void impulse_rubs_finish(ImpulseRubs *rubs)
{
    free(rubs->rubs);
    free(rubs->answers);
    free(rubs->turning);
    free(rubs->late);
    free(rubs->reactions);
    free(rubs->driven);
    free(rubs->unit);
    free(rubs->changes);
    free(rubs->motions);
    free(rubs->loads);
    free(rubs->speeds);
    *rubs = (ImpulseRubs){.count = 0};
}

void impulse_rubs_carry(ImpulseRubs *rubs, const Kernel *kernel, Carry *carry)
{
    CARRY_ARRAY(carry, rubs->late, 2 * rubs->count * kernel->row_count);
}

void impulse_rubs_keep(ImpulseRubs *rubs, const Kernel *kernel, const double *impulses)
{
    for (size_t i = 0; i < rubs->count; i++) {
        const double *late = rubs->late + 2 * i * kernel->row_count;
        for (size_t k = 0; k < 2; k++) {
            double *before = &rubs->rubs[i].before[k];
            *before = kernel->rubs[i].reaction[k];
            for (size_t row = 0; impulses != NULL && row < kernel->row_count; row++) {
                *before += late[2 * row + k] * impulses[row];
            }
        }
    }
}

// Takes the two numbers of a joint from those of all ideal rows.
static void take_pair(const ImpulseRub *rub, const double *rows, double *pair)
{
    pair[0] = rows[rub->row];
    pair[1] = rub->weigh * rows[rub->row + 1];
}

// What an impulse of 1 in a row is answered with in the ideal ones, which drift knows.
static const double *answer_to(ImpulseRubs *rubs, const Response *response,
                               const ResponseDrift *drift, size_t row)
{
    if (drift != NULL) {
        return drift->answers + row * response->row_count;
    }
    rubs->unit[row] = 1.0;
    response_react(response, rubs->unit, rubs->reactions);
    rubs->unit[row] = 0.0;
    return rubs->reactions;
}

int impulse_rubs_respond(ImpulseRubs *rubs, const Response *response, const ResponseDrift *drift,
                         Kernel *kernel)
{
    const size_t n = rubs->count;
    const size_t rows = kernel->row_count;
    for (size_t row = 0; row < rows; row++) {
        const double *answer = answer_to(rubs, response, drift, row);
        for (size_t i = 0; i < n; i++) {
            const size_t at = 2 * (i * rows + row);
            take_pair(&rubs->rubs[i], answer, rubs->answers + at);
            if (drift != NULL) {
                const size_t first = row * response->ideal_rows;
                take_pair(&rubs->rubs[i], drift->turned + first, rubs->turning + at);
                take_pair(&rubs->rubs[i], drift->late + first, rubs->late + at);
            }
        }
    }
    const int failed = friction_answer_of_rubs_fails(kernel, rubs->changes);
    return failed < 0 ? -1 : rubs->rubs[failed].joint;
}

// Fills in the reactions of bodies that are as given, but stand still, to loads alone.
static void react_to_loads(ImpulseRubs *rubs, const Response *response, const Motion *middle,
                           double *reactions)
{
    for (size_t i = 0; i < rubs->scenario->linkage.body_count; i++) {
        rubs->motions[i] = middle[i];
        rubs->motions[i].velocity = (Vec2){0.0, 0.0};
        rubs->motions[i].omega = 0.0;
    }
    response_free_reactions(response, rubs->motions, (Vec2){0.0, 0.0}, rubs->loads, reactions);
}

// Fills in what dampers do at the speeds that an impulse of 1 in a row brings.
static void find_damping(ImpulseRubs *rubs, const Response *response, const Motion *middle,
                         size_t row)
{
    const Linkage *linkage = &rubs->scenario->linkage;
    rubs->unit[row] = 1.0;
    response_apply(response, rubs->unit, rubs->speeds);
    rubs->unit[row] = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        rubs->motions[i] = middle[i];
        rubs->motions[i].velocity = (Vec2){rubs->speeds[3 * i], rubs->speeds[3 * i + 1]};
        rubs->motions[i].omega = rubs->speeds[3 * i + 2];
        rubs->loads[i] = (BodyLoad){{0.0, 0.0}, 0.0};
    }
    forces_add_dampers(linkage, rubs->motions, rubs->loads);
}

void impulse_rubs_damp(ImpulseRubs *rubs, const Response *response, const Motion *middle,
                       Kernel *kernel)
{
    const size_t rows = kernel->row_count;
    // what a drive asks for is no damper's
    memset(rubs->loads, 0, rubs->scenario->linkage.body_count * sizeof *rubs->loads);
    react_to_loads(rubs, response, middle, rubs->driven);
    for (size_t row = 0; row < rows; row++) {
        find_damping(rubs, response, middle, row);
        react_to_loads(rubs, response, middle, rubs->reactions);
        for (size_t i = 0; i < rubs->count; i++) {
            double *late = rubs->late + 2 * (i * rows + row);
            double pushed[2];
            double driven[2];
            take_pair(&rubs->rubs[i], rubs->reactions, pushed);
            take_pair(&rubs->rubs[i], rubs->driven, driven);
            late[0] = late[0] + pushed[0] - driven[0];
            late[1] = late[1] + pushed[1] - driven[1];
        }
    }
}

void impulse_rubs_react(ImpulseRubs *rubs, const Response *response, const Motion *middle,
                        Vec2 gravity, const BodyLoad *loads, double since_s, Kernel *kernel)
{
    response_free_reactions(response, middle, gravity, loads, rubs->reactions);
    for (size_t i = 0; i < rubs->count; i++) {
        KernelRub *of = &kernel->rubs[i];
        take_pair(&rubs->rubs[i], rubs->reactions, of->reaction);
        for (size_t k = 0; k < 2; k++) {
            const double change = of->reaction[k] - rubs->rubs[i].before[k];
            of->rate[k] = since_s > 0.0 ? change / since_s : 0.0;
        }
    }
}

void impulse_rubs_add(const Linkage *linkage, const Touch *place, double held,
                      const Motion *motions, JointState *state)
{
    if (touch_is_torque(place)) {
        state->moment_on_b += coordinate_sense(&linkage->joints[place->joint]) * place->sign * held;
        return;
    }
    const Vec2 along = joint_rows_along(linkage, motions, place->joint);
    state->force_on_b = vec2_add(state->force_on_b, vec2_scale(held, along));
}

double impulse_rubs_add_driven(const Scenario *scenario, size_t drive, const Motion *driven,
                               JointState *joints)
{
    const int number = linkage_drive(&scenario->linkage, drive)->joint;
    const Joint *joint = &scenario->linkage.joints[number];
    if (!joint_friction_is(joint)) {
        return 0.0;
    }
    const BristlePair pair = joint_friction_pair(&scenario->contact, joint);
    const double most =
        joint_friction_over(joint) * (joint->friction.steady > 0.0 ? 1.0 : joints[number].force);
    const double held = pair.law == BRISTLE_REGULARIZED
                            ? friction_hold(driven->omega, pair.speed).held
                            : copysign(bristle_left(&pair, driven->omega), driven->omega);
    joints[number].moment_on_b = -most * held;
    return most * held * driven->omega;
}
