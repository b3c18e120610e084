// Steps a world whose contacts are shorter than the step.
//
// A world that is not at a bound responds linearly to pushes in the places at which its joints
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
// In a world that has no bounds (world/closing.h) that step is what g + W P promise, and is not
// made unless somebody reads the forces of its joints (dJointSetFeedback). There
// - A and W change in the step, W' = S + S' (world/response_rate.h), by the formulas of
//   kernel/columns.h; and they are found where bodies are expected at mid-step, (h^2/8) a further
//   than along the speeds of the step's start;
// - ODE's joints are closed at both ends of a step (world/closing.h), from the one before contacts
//   may come until some after they have ended.
//
// The first of these steps is that of all bodies, and stays for those that no joint with play can
// move in the step, by joints and contacts. In the others these are disabled.
//
// With n rows in which joints touch a step costs n + 4 steps of ODE, n + 1 more where the change of
// A is found by trials; n + 3 in a world with bounds; 1 where nothing touches, and 3 while joints
// are kept closed. W and A may be those of the steps before (world/response_cache.h): then the step
// under the contacts' forces has to be as promised, and n steps are saved.
#include "world/impulse.h"

#include "kernel/columns.h"
#include "world/closing.h"
#include "world/coarse.h"
#include "world/inside.h"
#include "world/opening.h"
#include "world/response_cache.h"
#include "world/response_rate.h"
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
        if (!response->is_beyond) {
            set_free(response, step);
        }
        REFUSAL_TRY(response_rate_find(response, step, error));
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
        double *before = response->before;
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

void impulse_reach(JpWorld *world)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        for (int i = 0; joint->place_count > 0 && i < 2; i++) {
            bodies_reach_from(&world->bodies, joint->bodies[i]);
        }
    }
    bodies_reach(&world->bodies);
    world->bodies.moving = world->bodies.count; // until then
}

// Whether the joints of all bodies that are reached were closed at the end of the step before.
static bool are_closed(const Bodies *bodies)
{
    for (size_t i = 0; i < bodies->reach; i++) {
        if (!bodies->records[i].past.is_closed) {
            return false;
        }
    }
    return true;
}

// Finds whether the world is linear, and lists its joints.
static JpStatus find_linear(WorldResponse *response, JpError *error)
{
    JpWorld *world = response->world;
    closing_free(&response->closing);
    response->is_linear = closing_is_linear(world);
    return !response->is_linear || closing_make(world, &response->closing)
               ? JP_OK
               : refusal(error, JP_ERROR_MEMORY, "there is no memory for the joints of a step");
}

// The step without contacts, from which the others differ.
static JpStatus find_base(WorldResponse *response, double step, JpError *error)
{
    REFUSAL_TRY(world_response_step(response, step, response->base, error));
    world_response_read_bodies(response->world, response->speeds);
    set_free(response, step);
    return JP_OK;
}

// The step without contacts of all bodies, which stays for those that are not reached. Joints that
// are closed are held so, if that is of no matter to others: else the reached make it again.
static JpStatus find_bases(WorldResponse *response, double step, JpError *error)
{
    JpWorld *world = response->world;
    if (!are_closed(&world->bodies)) {
        return find_base(response, step, error);
    }
    if (world->bodies.reach < world->bodies.count) {
        REFUSAL_TRY(find_base(response, step, error));
        bodies_rest(&world->bodies);
        bodies_put_back(&world->bodies);
    }
    REFUSAL_TRY(find_linear(response, error));
    response->is_held = response->is_linear && closing_is_possible(response->world, step);
    if (response->is_held) {
        closing_hold(world, &response->closing, CLOSING_ERP);
    }
    return find_base(response, step, error);
}

// How much further bodies are to be expected at mid-step than half a step along the speeds of the
// step's start: (h^2/8) a, a their mean acceleration in the step before, contacts included.
static void find_beyond(WorldResponse *response, double step)
{
    const JpWorld *world = response->world;
    const double share = world->last_step > 0.0 ? 0.125 * step * step / world->last_step : 0.0;
    for (size_t i = 0; i < world->bodies.moving; i++) {
        const BodyRecord *record = &world->bodies.records[i];
        double *beyond = &response->beyond[BODY_NUMBERS * i];
        for (size_t k = 0; k < BODY_NUMBERS; k++) {
            const double now = k < 3 ? record->kept.velocity[k] : record->kept.omega[k - 3];
            beyond[k] = record->past.has_speeds ? share * (now - record->past.speeds[k]) : 0.0;
        }
    }
}

static void move_beyond(WorldResponse *response, double times)
{
    Bodies *bodies = &response->world->bodies;
    for (size_t i = 0; i < bodies->moving; i++) {
        bodies_move_kept(&bodies->records[i], &response->beyond[BODY_NUMBERS * i], times);
    }
}

// Moves bodies and rows to where they are to be expected at mid-step, for what pushes do. The step
// that stays is made where ODE's joints are open as it needs them (world/closing.c): what it gives
// without contacts is kept, and a step from here is what the others differ from.
static JpStatus go_beyond(WorldResponse *response, double step, JpError *error)
{
    JpWorld *world = response->world;
    const size_t size = BODY_NUMBERS * world->bodies.moving * sizeof(double);
    find_beyond(response, step);
    for (size_t i = 0; i < response->place_count; i++) {
        Place *place = response->places[i].place;
        for (size_t k = 0; k < place->row_count; k++) {
            direction_move(&place->rows[k], &world->bodies, response->beyond);
        }
    }
    move_beyond(response, 1.0);
    bodies_put_back(&world->bodies);
    world_response_read_rates(response, response->frozen);
    memcpy(response->later, response->speeds, size);
    REFUSAL_TRY(world_response_step(response, step, response->base, error));
    world_response_read_bodies(world, response->speeds);
    bodies_put_back(&world->bodies);
    for (size_t i = 0; i < BODY_NUMBERS * world->bodies.moving; i++) {
        response->apart[i] = response->later[i] - response->speeds[i];
    }
    response->is_beyond = true;
    return JP_OK;
}

// Takes bodies back from there, with what the step gives where they are.
static void come_back(WorldResponse *response)
{
    const Bodies *bodies = &response->world->bodies;
    for (size_t i = 0; i < bodies->moving; i++) {
        bodies_add_speeds(&bodies->records[i], &response->apart[BODY_NUMBERS * i]);
    }
    move_beyond(response, -1.0);
    bodies_put_back_positions(bodies);
}

// Contacts in places that come near their sides: all of the step but what is done at its end.
static JpStatus find_impulses(WorldResponse *response, double step, bool *is_done, JpError *error)
{
    JpWorld *world = response->world;
    bodies_put_back(&world->bodies);
    bodies_rest(&world->bodies);
    if (!response->is_held) {
        REFUSAL_TRY(find_linear(response, error));
        REFUSAL_TRY(close_joints(response, step, error));
    }
    response->is_closed = response->is_linear && closing_is_possible(response->world, step);
    world->flown = 0;
    for (size_t i = 0; i < response->place_count; i++) {
        world->stats.rows += response->places[i].is_active ? 1 : 0;
    }
    if (response->is_closed && inside_may_drift(response)) {
        REFUSAL_TRY(go_beyond(response, step, error));
    }
    REFUSAL_TRY(make_rounds(response, step, is_done, error));
    closing_release(world, &response->closing);
    if (response->is_beyond) {
        come_back(response);
    }
    return JP_OK;
}

// so many steps ahead a contact is seen to come: it begins with closed joints
static const double AHEAD = 2.0;

// so many steps joints stay closed after a contact, for the next one: what they open by is an error
// of positions, and these steps take two more of ODE each
enum { STAY_CLOSED = 16 };

// A step in which nothing touches: its end has closed joints if something may in the next one.
static JpStatus fly(WorldResponse *response, double step, JpError *error)
{
    JpWorld *world = response->world;
    bool is_soon = response->is_held && ++world->flown <= STAY_CLOSED;
    for (size_t i = 0; i < response->place_count; i++) {
        is_soon = is_soon || is_near(response, &response->places[i], AHEAD * step);
    }
    closing_release(world, &response->closing);
    if (is_soon) {
        bodies_rest(&world->bodies);
        REFUSAL_TRY(find_linear(response, error));
        response->is_closed = response->is_linear && closing_is_possible(response->world, step);
    }
    if (response->is_held && !response->is_closed) {
        bodies_put_back(&world->bodies);
        return opening_open(world, &response->closing, step, response->speeds, error);
    }
    return JP_OK;
}

JpStatus world_impulse_step(JpWorld *world, double step, WorldResponse *response, bool *is_done,
                            JpError *error)
{
    world->bodies.moving = world->bodies.reach;
    if (!world_response_make(world, step, response)) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for the contacts of a step");
    }
    REFUSAL_TRY(trial_check(world, error));
    REFUSAL_TRY(find_bases(response, step, error));
    *is_done = true;
    return activate_near(response, step) ? find_impulses(response, step, is_done, error)
                                         : fly(response, step, error);
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

// Moves the bodies by when in the step the impulses came, and adds to their speeds what the world's
// step has not.
static JpStatus move_on(WorldResponse *response, double step, JpError *error)
{
    const size_t moving = response->world->bodies.moving;
    const size_t numbers = BODY_NUMBERS * moving;
    double *pushed = calloc(3 * numbers + 1, sizeof *pushed);
    if (pushed == NULL) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for the end of a step");
    }
    double *moved = pushed + numbers;
    double *turned = moved + numbers;
    response_rate_push(response, pushed, moved, turned);
    for (size_t i = 0; i < numbers; i++) {
        moved[i] = kernel_columns_late(0.5 * step, moved[i], pushed[i], turned[i]);
    }
    for (size_t i = 0; i < moving; i++) {
        const dBodyID id = response->world->bodies.records[i].id;
        bodies_move(id, &moved[BODY_NUMBERS * i], 1.0);
        bodies_add_speeds(&response->world->bodies.records[i], &turned[BODY_NUMBERS * i]);
    }
    free(pushed);
    return JP_OK;
}

// Keeps the speeds with which the step began.
static void keep_speeds(BodyRecord *record)
{
    memcpy(record->past.speeds, record->kept.velocity, 3 * sizeof *record->past.speeds);
    memcpy(record->past.speeds + 3, record->kept.omega, 3 * sizeof *record->past.speeds);
    record->past.has_speeds = true;
}

JpStatus impulse_finish(JpWorld *world, double step, WorldResponse *response, JpError *error)
{
    bodies_rest(&world->bodies);
    const JpStatus status = move_on(response, step, error);
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
    if (response->is_closed || (response->is_linear && response->side_count > 0)) {
        closing_run(world, &response->closing, step, response->is_closed);
    }
    for (size_t i = 0; i < world->bodies.moving; i++) {
        world->bodies.records[i].past.is_closed = response->is_closed;
        keep_speeds(&world->bodies.records[i]);
    }
    bodies_wake(&world->bodies);
    return status;
}
