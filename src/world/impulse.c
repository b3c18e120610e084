// Steps a world whose contacts are shorter than the step.
//
// A world that is not at a bound responses linearly to pushes in the places at which its joints
// with play touch. Rows J of these are frozen at mid-step: of a hinge or slider its coordinate, of
// a pin two directions across its axis. Their response is found by steps that are taken back: one
// without contacts gives their accelerations g; one with a push in a row, a column of their
// mobility W, and what the push does to all bodies, A. How fast rows turn with the bodies follows
// from their rates at the start, u0' with the rows of there and J v with those of mid-step:
//     g = (J v' - J v) / h + (J v - u0') / (h/2)
// With them the contacts are integrated within the step (world/inside.h), to impulses P and their
// integrals over time Q. Then the world steps, for good, under the mean forces P / h, and positions
// that have moved by h/2 along the new velocities are moved on by A (Q - (h/2) P).
//
// Where that step does not give the velocities that g + W P promise, a bound was passed: of
// friction, of a motor, of a contact that opened. Then g and W are found again about that step, up
// to ROUNDS times; if they still differ, the step stands as it is and is counted as a fallback.
//
// In a world whose joints of ODE only hold, that step is what g + W P promise, and is not made
// unless somebody reads their forces (dJointSetFeedback). One more step closes the velocities
// (world/closing.h).
//
// The first of these steps is that of all bodies, and stays for those that no joint with play can
// move in the step, by joints and contacts. In the others these are disabled.
//
// With n rows in which joints touch a step costs n + 3 steps of ODE, and 1 where none does. W and A
// may be those of the steps before (world/response_cache.h): then the step under the contacts'
// forces has to be as promised, and n steps are saved.
#include "world/impulse.h"

#include "world/closing.h"
#include "world/coarse.h"
#include "world/inside.h"
#include "world/opening.h"
#include "world/response_cache.h"
#include "world/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 4 };

// of the rows' speeds: above what rounding in ODE's factorisation leaves
static const double PROMISE = 1e-7;

// The accelerations of all rows less their rotors while nothing presses, from the rates of a step
// under the impulses of the base.
static void set_free(WorldResponse *response, double step)
{
    for (size_t i = 0; i < response->place_count; i++) {
        const ResponsePlace *of = &response->places[i];
        const Rotor *rotor = &of->joint->rotor;
        for (size_t k = 0; k < of->place->row_count; k++) {
            const size_t row = of->first_row + k;
            const double gained = response->base[row] - response->frozen[row] -
                                  world_response_to(response, response->pushed, row);
            const double turned = response->frozen[row] - rotor->speed - of->place->start_rate[k];
            response->free[row] = (gained + 2.0 * turned) / step - rotor->drive / rotor->inertia;
        }
    }
}

// Whether the rates after the step are those that g and W promise.
static bool is_as_promised(const WorldResponse *response, const double *pushed_before)
{
    double scale = 0.0;
    double off = 0.0;
    for (size_t i = 0; i < response->row_count; i++) {
        const double part = world_response_to(response, response->net, i);
        const double before = world_response_to(response, pushed_before, i);
        off = fmax(off, fabs(response->found[i] - response->base[i] - part + before));
        scale = fmax(scale, fmax(fabs(part), fabs(response->frozen[i])));
    }
    return off <= PROMISE * scale;
}

// Takes what ODE's joints are open by out of where the places are.
static JpStatus close_joints(WorldResponse *response, double step, JpError *error)
{
    REFUSAL_TRY(opening_find(response->world, step, response->speeds, error));
    for (size_t i = 0; i < response->place_count; i++) {
        Place *place = response->places[i].place;
        for (size_t k = 0; k < place->row_count && k < PLACE_ROWS_PLANE; k++) {
            place->start[k] -= opening_shift(response->world, &place->rows[k]);
        }
    }
    return JP_OK;
}

// Whether a place comes to touch with what the contacts of others do to it, at the step's start.
static bool is_near(const WorldResponse *response, const ResponsePlace *of, double step)
{
    const Place *place = of->place;
    const double *free = &response->free[of->first_row];
    if (place_is_near(place, place->start_rate, free, step)) {
        return true;
    }
    double speed[PLACE_ROWS_MOST];
    for (size_t k = 0; k < place->row_count; k++) {
        speed[k] =
            place->start_rate[k] + world_response_to(response, response->net, of->first_row + k);
    }
    return place_is_near(place, speed, free, step);
}

// Activates all places of joints of which one comes near its sides in the step, with what the
// others' contacts do to it. Returns whether there are any new ones.
static bool activate_near(WorldResponse *response, double step)
{
    bool is_any = false;
    for (size_t i = 0; i < response->place_count; i++) {
        ResponsePlace *of = &response->places[i];
        if (of->is_active || !is_near(response, of, step)) {
            continue;
        }
        is_any = true;
        for (size_t k = 0; k < response->place_count; k++) {
            response->places[k].is_active |= response->places[k].joint == of->joint;
        }
    }
    return is_any;
}

// The contacts of the step by the world's response about the base; joints that they bring near
// their sides join in. `is_found` is false where that takes too many local steps.
static JpStatus find_contacts(WorldResponse *response, double step, bool can_reuse, bool *is_found,
                              JpError *error)
{
    for (size_t i = 0; i < response->place_count; i++) {
        response->places[i].is_known = false;
    }
    response->is_cached = false;
    if (can_reuse) {
        response_cache_fill(response);
    }
    do {
        *is_found = world_response_is_within_work(response);
        if (!*is_found) {
            break;
        }
        REFUSAL_TRY(world_response_find_columns(response, step, error));
        set_free(response, step);
        REFUSAL_TRY(inside_run(response, step, is_found, error));
    } while (*is_found && activate_near(response, step));
    if (*is_found && !response->is_cached && !response_cache_keep(response)) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for the responses of a step");
    }
    return JP_OK;
}

// Rounds of contacts and the step under them, which stays in the end.
static JpStatus make_rounds(WorldResponse *response, double step, bool *is_done, JpError *error)
{
    JpWorld *world = response->world;
    const size_t size = response->row_count * sizeof(double);
    for (int round = 1;; round++) {
        REFUSAL_TRY(find_contacts(response, step, round == 1, is_done, error));
        if (!*is_done) {
            return JP_OK;
        }
        if (response->is_linear && !response->is_cached && !closing_is_read(world)) {
            world_response_take(response);
            return JP_OK;
        }
        double *before = response->free; // which is found anew
        memcpy(before, response->pushed, size);
        memcpy(response->pushed, response->net, size);
        REFUSAL_TRY(world_response_step(response, step, response->found, error));
        const bool is_promised = is_as_promised(response, before);
        if (response->is_cached) {
            response_cache_note(world, is_promised);
        }
        if (is_promised || round == ROUNDS) {
            if (!is_promised) {
                world->stats.fallbacks++;
                coarse_note(world,
                            "the world's response to the contacts was not found in %d rounds of "
                            "the step of %g s: bounds are passed in it",
                            (int)ROUNDS, step);
            }
            return JP_OK;
        }
        memcpy(response->base, response->found, size);
        world_response_read_bodies(world, response->speeds);
        bodies_put_back(&world->bodies);
    }
}

// Which bodies the joints with play can move in the step.
static void find_reach(JpWorld *world)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        bodies_reach_from(&world->bodies, joint->bodies[0]);
        bodies_reach_from(&world->bodies, joint->bodies[1]);
    }
    bodies_reach(&world->bodies);
}

JpStatus world_impulse_step(JpWorld *world, double step, WorldResponse *response, bool *is_done,
                            JpError *error)
{
    find_reach(world);
    if (!world_response_make(world, step, response)) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for the contacts of a step");
    }
    REFUSAL_TRY(trial_check(world, error));
    REFUSAL_TRY(world_response_step(response, step, response->base, error));
    world_response_read_bodies(world, response->speeds);
    set_free(response, step);
    *is_done = true;
    if (!activate_near(response, step)) {
        return JP_OK;
    }
    bodies_put_back(&world->bodies);
    bodies_rest(&world->bodies);
    response->is_linear = closing_is_linear(world);
    if (response->is_linear && !closing_make(world, &response->closing)) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for the joints of a step");
    }
    REFUSAL_TRY(close_joints(response, step, error));
    for (size_t i = 0; i < response->place_count; i++) {
        world->stats.rows += response->places[i].is_active ? 1 : 0;
    }
    return make_rounds(response, step, is_done, error);
}

// Moves a body on along what an impulse in a row does to it, times a moment, N s^2.
static void move_on(dBodyID body, const double *speeds, double moment)
{
    const dReal *at = dBodyGetPosition(body);
    dBodySetPosition(body, at[0] + moment * speeds[0], at[1] + moment * speeds[1],
                     at[2] + moment * speeds[2]);
    dQuaternion turned;
    bodies_turn(dBodyGetQuaternion(body), &speeds[3], moment, turned);
    dBodySetQuaternion(body, turned);
}

// Rotors, and the mean forces on pins.
static void finish_place(const ResponsePlace *of, const WorldResponse *response, double step)
{
    Rotor *rotor = &of->joint->rotor;
    const double *net = &response->net[of->first_row];
    if (isfinite(rotor->inertia)) {
        const double late = response->moment[of->first_row] - 0.5 * step * net[0];
        rotor->speed += (step * rotor->drive - net[0]) / rotor->inertia;
        rotor->position -= late / rotor->inertia;
    }
    for (size_t k = 0; k < of->place->row_count; k++) {
        const Direction *row = response->rows[of->first_row + k];
        const Vec3 axis = {row->axis[0], row->axis[1], row->axis[2]};
        if (!row->is_turn) {
            of->joint->force = vec3_add(of->joint->force, vec3_scale(net[k] / step, axis));
        }
    }
}

void impulse_finish(JpWorld *world, double step, WorldResponse *response)
{
    const size_t reach = world->bodies.reach;
    const size_t numbers = BODY_NUMBERS * reach;
    for (size_t i = 0; i < response->row_count; i++) {
        const double late = response->moment[i] - 0.5 * step * response->net[i];
        for (size_t b = 0; late != 0.0 && b < reach; b++) {
            move_on(world->bodies.records[b].id, &response->bodies[i * numbers + BODY_NUMBERS * b],
                    late);
        }
    }
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        joint->force = (Vec3){0.0, 0.0, 0.0};
    }
    for (size_t i = 0; i < response->place_count; i++) {
        finish_place(&response->places[i], response, step);
    }
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        joint->rotor.position += 0.5 * step * joint->rotor.speed;
    }
    inside_book(response);
    if (response->is_linear) {
        bodies_rest(&world->bodies);
        closing_run(world, &response->closing, step);
        bodies_wake(&world->bodies);
    }
}
