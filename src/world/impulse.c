// How does a world step whose contacts are shorter than the step?
//
// A world that is not at a bound answers linearly to pushes in its joints. Its answer is found by
// steps that are taken back: one without contacts gives the accelerations g of all coordinates; one
// with a push in a joint, a column of their mobility W, and what the push does to all bodies, A.
// With them the contacts are integrated within the step (world/inside.h), to impulses P and their
// integrals over time Q. Then the world steps, for good, under the mean forces P / h, and positions
// that have moved by h/2 along the new velocities are moved on by A (Q - (h/2) P).
//
// Where that step does not give the velocities that g + W P promise, a bound was passed: of
// friction, of a motor, of a contact that opened. Then g and W are found again about that step, up
// to ROUNDS times; if they still differ, the step stands as it is and is counted as a fallback.
//
// With n joints that touch a step costs n + 2 steps of ODE, and 1 where none does.
#include "world/impulse.h"

#include "world/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 4, BODY_NUMBERS = 6 };

// of the coordinates' speeds: above what rounding in ODE's factorisation leaves
static const double PROMISE = 1e-7;

static bool make_room(const JpWorld *world, Impulse *impulse)
{
    size_t n = 0;
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        n++;
    }
    const size_t body = BODY_NUMBERS * world->bodies.count;
    const size_t numbers = 4 * n + n * n + (n + 1) * body + n * n + INSIDE_ROOM(n);
    impulse->joint_count = n;
    impulse->memory = calloc(
        1, numbers * sizeof(double) +
               n * (sizeof(JpJoint *) + 2 * sizeof(InsideJoint) + sizeof(size_t) + sizeof(bool)) +
               1);
    if (impulse->memory == NULL) {
        return false;
    }
    double *at = impulse->memory;
    impulse->rates = at;
    impulse->pushed = impulse->rates + 3 * n;
    impulse->columns = impulse->pushed + n;
    impulse->bodies = impulse->columns + n * n;
    impulse->base = impulse->bodies + n * body;
    impulse->mobility = impulse->base + body;
    impulse->room = impulse->mobility + n * n;
    impulse->contacts = (InsideJoint *)(impulse->room + INSIDE_ROOM(n));
    impulse->joints = (JpJoint **)(impulse->contacts + 2 * n);
    impulse->active = (size_t *)(impulse->joints + n);
    impulse->is_active = (bool *)(impulse->active + n);
    return true;
}

void impulse_free(Impulse *impulse)
{
    free(impulse->memory);
    *impulse = (Impulse){0};
}

static void read_bodies(const JpWorld *world, double *speeds)
{
    for (size_t i = 0; i < world->bodies.count; i++) {
        const dBodyID id = world->bodies.records[i].id;
        memcpy(&speeds[BODY_NUMBERS * i], dBodyGetLinearVel(id), 3 * sizeof(double));
        memcpy(&speeds[BODY_NUMBERS * i + 3], dBodyGetAngularVel(id), 3 * sizeof(double));
    }
}

static void read_rates(const Impulse *impulse, double *rates)
{
    for (size_t i = 0; i < impulse->joint_count; i++) {
        rates[i] = coordinate_rate(&impulse->joints[i]->coordinate);
    }
}

static double net_impulse(const InsideJoint *contact)
{
    return contact->impulse[0] - contact->impulse[1];
}

// A step under the mean forces of the impulses that there are, and the rates after it.
static JpStatus step_under(JpWorld *world, const Impulse *impulse, double step, double *rates,
                           JpError *error)
{
    for (size_t i = 0; i < impulse->joint_count; i++) {
        if (impulse->pushed[i] != 0.0) {
            coordinate_push(&impulse->joints[i]->coordinate, impulse->pushed[i] / step);
        }
    }
    REFUSAL_TRY(trial_step(world, step, error));
    read_rates(impulse, rates);
    return JP_OK;
}

// The answer to a push in one joint, beside the step that the base and the last rates are of.
static JpStatus find_column(JpWorld *world, Impulse *impulse, size_t number, double step,
                            JpError *error)
{
    const size_t n = impulse->joint_count;
    const JpJoint *joint = impulse->joints[number];
    const double *rates = &impulse->rates[n];
    double *column = &impulse->columns[number * n];
    double *bodies = &impulse->bodies[number * BODY_NUMBERS * world->bodies.count];
    // as hard as the contact will be, and away from where it presses
    const double speed = fabs(joint->rate) + fabs(rates[number] - impulse->rates[number]) +
                         joint->sides[0].law.impact_speed_floor;
    const double position = impulse->contacts[number].position;
    const bool is_low = side_gap(&joint->sides[0], position) < side_gap(&joint->sides[1], position);
    const double push = (is_low ? speed : -speed) / play_mobility(joint);
    coordinate_push(&joint->coordinate, push / step);
    JpStatus status = step_under(world, impulse, step, column, error);
    read_bodies(world, bodies);
    bodies_put_back(&world->bodies);
    for (size_t i = 0; i < n; i++) {
        column[i] = (column[i] - rates[i]) / push;
    }
    for (size_t i = 0; i < BODY_NUMBERS * world->bodies.count; i++) {
        bodies[i] = (bodies[i] - impulse->base[i]) / push;
    }
    return status;
}

// Joins a joint to those whose contacts are integrated.
static void activate(Impulse *impulse, size_t number)
{
    impulse->is_active[number] = true;
    impulse->active[impulse->active_count++] = number;
}

// The accelerations of all coordinates less their rotors while nothing presses, from the rates of a
// step under the impulses that there are.
static void set_free(Impulse *impulse, double step)
{
    const size_t n = impulse->joint_count;
    for (size_t i = 0; i < n; i++) {
        const Rotor *rotor = &impulse->joints[i]->rotor;
        double gained = impulse->rates[n + i] - impulse->rates[i];
        for (size_t j = 0; j < n; j++) {
            gained -= impulse->columns[j * n + i] * impulse->pushed[j];
        }
        impulse->contacts[i].free = gained / step - rotor->drive / rotor->inertia;
    }
}

// Sides as the step before left them, and the motion at the step's start.
static void reset_contacts(Impulse *impulse, double step)
{
    for (size_t i = 0; i < impulse->joint_count; i++) {
        JpJoint *joint = impulse->joints[i];
        InsideJoint *contact = &impulse->contacts[i];
        memcpy(contact->sides, joint->sides, sizeof contact->sides);
        contact->position = play_position(joint) - 0.5 * step * joint->rate;
        contact->speed = joint->rate;
        contact->impulse[0] = contact->impulse[1] = contact->moment = 0.0;
        contact->sides[0].force = contact->sides[1].force = 0.0;
    }
}

// Integrates the contacts of the active joints; false where that takes too many local steps.
static bool integrate(Impulse *impulse, double step)
{
    const size_t n = impulse->joint_count;
    const size_t count = impulse->active_count;
    InsideJoint *packed = impulse->contacts + n;
    for (size_t i = 0; i < count; i++) {
        const size_t row = impulse->active[i];
        packed[i] = impulse->contacts[row];
        for (size_t j = 0; j < count; j++) {
            const double own = i == j ? 1.0 / impulse->joints[row]->rotor.inertia : 0.0;
            impulse->mobility[i * count + j] = impulse->columns[impulse->active[j] * n + row] + own;
        }
    }
    Inside inside = {count, packed, impulse->mobility, impulse->room};
    if (!inside_run(&inside, step)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        impulse->contacts[impulse->active[i]] = packed[i];
    }
    return true;
}

// Whether the rates after the step are those that g and W promise.
static bool is_as_promised(const Impulse *impulse, double step)
{
    const size_t n = impulse->joint_count;
    double scale = 0.0;
    double off = 0.0;
    for (size_t i = 0; i < n; i++) {
        const Rotor *rotor = &impulse->joints[i]->rotor;
        double promised =
            impulse->rates[i] + step * (impulse->contacts[i].free + rotor->drive / rotor->inertia);
        for (size_t j = 0; j < n; j++) {
            const double part = impulse->columns[j * n + i] * net_impulse(&impulse->contacts[j]);
            promised += part;
            scale = fmax(scale, fabs(part));
        }
        off = fmax(off, fabs(impulse->rates[2 * n + i] - promised));
        scale = fmax(scale, fabs(impulse->rates[i]));
    }
    return off <= PROMISE * scale;
}

// Joints that come near a side in the step, with what the others' contacts do to them, become
// active.
static bool activate_near(Impulse *impulse, double step)
{
    const size_t n = impulse->joint_count;
    const size_t before = impulse->active_count;
    for (size_t i = 0; i < n; i++) {
        if (impulse->is_active[i]) {
            continue;
        }
        InsideJoint ahead = impulse->contacts[i];
        bool is_near = inside_is_near(&ahead, step);
        // the same with the others' impulses at the start
        for (size_t j = 0; j < n; j++) {
            ahead.speed += impulse->columns[j * n + i] * net_impulse(&impulse->contacts[j]);
        }
        is_near = is_near || inside_is_near(&ahead, step);
        if (is_near) {
            activate(impulse, i);
        }
    }
    return impulse->active_count > before;
}

// The contacts of the step by the world's answer about the base; joints that they bring near their
// sides join in. False where it takes too many local steps.
static JpStatus find_contacts(JpWorld *world, Impulse *impulse, double step, bool *is_found,
                              JpError *error)
{
    size_t known = 0;
    do {
        for (; known < impulse->active_count; known++) {
            REFUSAL_TRY(find_column(world, impulse, impulse->active[known], step, error));
        }
        set_free(impulse, step);
        reset_contacts(impulse, step);
        *is_found = integrate(impulse, step);
    } while (*is_found && activate_near(impulse, step));
    return JP_OK;
}

// Rounds of contacts and the step under them, which stays in the end.
static JpStatus make_rounds(JpWorld *world, Impulse *impulse, double step, bool *is_done,
                            JpError *error)
{
    const size_t n = impulse->joint_count;
    for (int round = 1;; round++) {
        REFUSAL_TRY(find_contacts(world, impulse, step, is_done, error));
        if (!*is_done) {
            return JP_OK;
        }
        for (size_t i = 0; i < n; i++) {
            impulse->pushed[i] = net_impulse(&impulse->contacts[i]);
        }
        double *found = &impulse->rates[2 * n];
        REFUSAL_TRY(step_under(world, impulse, step, found, error));
        const bool is_promised = is_as_promised(impulse, step);
        if (is_promised || round == ROUNDS) {
            world->stats.fallbacks += is_promised ? 0 : 1;
            return JP_OK;
        }
        memcpy(&impulse->rates[n], found, n * sizeof(double));
        read_bodies(world, impulse->base);
        bodies_put_back(&world->bodies);
    }
}

JpStatus impulse_step(JpWorld *world, double step, Impulse *impulse, bool *is_done, JpError *error)
{
    *impulse = (Impulse){0};
    if (!make_room(world, impulse)) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for the contacts of a step");
    }
    size_t number = 0;
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        impulse->joints[number] = joint;
        impulse->rates[number++] = joint->rate + joint->rotor.speed;
    }
    REFUSAL_TRY(trial_check(world, error));
    REFUSAL_TRY(step_under(world, impulse, step, &impulse->rates[impulse->joint_count], error));
    read_bodies(world, impulse->base);
    set_free(impulse, step);
    reset_contacts(impulse, step);
    *is_done = true;
    if (!activate_near(impulse, step)) {
        return JP_OK;
    }
    bodies_put_back(&world->bodies);
    world->stats.rows += impulse->active_count;
    return make_rounds(world, impulse, step, is_done, error);
}

// Moves a body on along what an impulse of a joint does to it, times a moment, N s^2.
static void move_on(dBodyID body, const double *speeds, double moment)
{
    const dReal *at = dBodyGetPosition(body);
    dBodySetPosition(body, at[0] + moment * speeds[0], at[1] + moment * speeds[1],
                     at[2] + moment * speeds[2]);
    dQuaternion turned;
    bodies_turn(dBodyGetQuaternion(body), &speeds[3], moment, turned);
    dBodySetQuaternion(body, turned);
}

void impulse_finish(JpWorld *world, double step, Impulse *impulse)
{
    for (size_t i = 0; i < impulse->joint_count; i++) {
        JpJoint *joint = impulse->joints[i];
        const InsideJoint *contact = &impulse->contacts[i];
        Rotor *rotor = &joint->rotor;
        const double net = impulse->pushed[i];
        const double late = contact->moment - 0.5 * step * net;
        for (int k = 0; k < SIDE_COUNT; k++) {
            joint->sides[k] = contact->sides[k];
            joint->sides[k].force = contact->impulse[k] / step;
        }
        rotor->speed += (step * rotor->drive - net) / rotor->inertia;
        rotor->position += 0.5 * step * rotor->speed - late / rotor->inertia;
        for (size_t b = 0; late != 0.0 && b < world->bodies.count; b++) {
            const double *speeds = &impulse->bodies[BODY_NUMBERS * (i * world->bodies.count + b)];
            move_on(world->bodies.records[b].id, speeds, late);
        }
    }
}
