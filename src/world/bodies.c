// Lists the bodies that a step moves, and where they were.
//
// ODE has no list of a world's bodies. A step moves all of them, so that one that is to be undone
// has to know them: those that hang together with ours by joints are found along these; the others
// are added by hand. How many there are in all is counted in ODE's own export.
#define _GNU_SOURCE // open_memstream
#include "world/bodies.h"

#include "base/sinc.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_ROOM = 16 };

void bodies_finish(Bodies *bodies)
{
    free(bodies->records);
    free(bodies->slots);
    free(bodies->queue);
    *bodies = (Bodies){0};
}

static size_t slot_of(const Bodies *bodies, dBodyID body)
{
    const uint64_t mixed = (uint64_t)(uintptr_t)body * 0x9e3779b97f4a7c15U;
    size_t slot = (size_t)(mixed >> 32) & (bodies->slot_count - 1);
    while (bodies->slots[slot] != 0 && bodies->records[bodies->slots[slot] - 1].id != body) {
        slot = (slot + 1) & (bodies->slot_count - 1);
    }
    return slot;
}

BodyRecord *bodies_find(const Bodies *bodies, dBodyID body)
{
    if (bodies->slot_count == 0) {
        return NULL;
    }
    const size_t number = bodies->slots[slot_of(bodies, body)];
    return number == 0 ? NULL : &bodies->records[number - 1];
}

static void fill_slots(Bodies *bodies)
{
    memset(bodies->slots, 0, bodies->slot_count * sizeof *bodies->slots);
    for (size_t i = 0; i < bodies->count; i++) {
        bodies->slots[slot_of(bodies, bodies->records[i].id)] = i + 1;
    }
}

static bool make_body_room(Bodies *bodies)
{
    if (bodies->count < bodies->room) {
        return true;
    }
    const size_t room = bodies->room == 0 ? FIRST_ROOM : 2 * bodies->room;
    BodyRecord *records = realloc(bodies->records, room * sizeof *records);
    if (records == NULL) {
        return false;
    }
    bodies->records = records;
    size_t *slots = realloc(bodies->slots, 4 * room * sizeof *slots);
    if (slots == NULL) {
        return false;
    }
    bodies->slots = slots;
    dBodyID *queue = realloc(bodies->queue, room * sizeof *queue);
    if (queue == NULL) {
        return false;
    }
    bodies->queue = queue;
    bodies->room = room;
    bodies->slot_count = 4 * room;
    fill_slots(bodies);
    return true;
}

BodyRecord *bodies_add(Bodies *bodies, dBodyID body)
{
    BodyRecord *known = bodies_find(bodies, body);
    if (known != NULL) {
        return known;
    }
    if (!make_body_room(bodies)) {
        return NULL;
    }
    bodies->slots[slot_of(bodies, body)] = bodies->count + 1;
    BodyRecord *record = &bodies->records[bodies->count++];
    *record = (BodyRecord){.id = body};
    return record;
}

// Marks a body of this gathering, new or not, whose joints are to be followed.
static bool see(Bodies *bodies, dBodyID body)
{
    if (body == NULL) {
        return true;
    }
    BodyRecord *record = bodies_add(bodies, body);
    if (record == NULL) {
        return false;
    }
    if (record->seen != bodies->gathering) {
        record->seen = bodies->gathering;
        bodies->queue[bodies->queue_count++] = body;
    }
    return true;
}

static void drop_unseen(Bodies *bodies)
{
    size_t kept = 0;
    for (size_t i = 0; i < bodies->count; i++) {
        if (bodies->records[i].seen == bodies->gathering) {
            bodies->records[kept++] = bodies->records[i];
        }
    }
    if (kept != bodies->count) {
        bodies->count = kept;
        fill_slots(bodies);
    }
}

// Bodies that were gathered before keep their records, for what they hold of the last step; whether
// the ones behind them still exist is known once a joint leads there.
bool bodies_gather(Bodies *bodies, const dBodyID *seeds, size_t seed_count)
{
    bodies->gathering++;
    bodies->queue_count = 0;
    bool is_done = true;
    for (size_t i = 0; i < bodies->count && is_done; i++) {
        is_done = !bodies->records[i].is_added || see(bodies, bodies->records[i].id);
    }
    for (size_t i = 0; i < seed_count && is_done; i++) {
        is_done = see(bodies, seeds[i]);
    }
    for (size_t i = 0; i < bodies->queue_count && is_done; i++) {
        const dBodyID body = bodies->queue[i];
        const int joints = dBodyGetNumJoints(body);
        for (int j = 0; j < joints && is_done; j++) {
            const dJointID joint = dBodyGetJoint(body, j);
            is_done = see(bodies, dJointGetBody(joint, 0)) && see(bodies, dJointGetBody(joint, 1));
        }
    }
    if (is_done) {
        drop_unseen(bodies);
    }
    bodies->reach = bodies->moving = bodies->count;
    bodies->queue_count = 0;
    return is_done;
}

void bodies_reach_from(Bodies *bodies, dBodyID body)
{
    BodyRecord *record = body != NULL ? bodies_find(bodies, body) : NULL;
    if (record != NULL && record->reached != bodies->gathering) {
        record->reached = bodies->gathering;
        bodies->queue[bodies->queue_count++] = body;
    }
}

// Puts the bodies that are reached first, in the order in which they are.
static void put_reached_first(Bodies *bodies)
{
    size_t reached = 0;
    bool is_changed = false;
    for (size_t i = 0; i < bodies->count; i++) {
        if (bodies->records[i].reached != bodies->gathering) {
            continue;
        }
        if (i != reached) {
            const BodyRecord other = bodies->records[reached];
            bodies->records[reached] = bodies->records[i];
            bodies->records[i] = other;
            is_changed = true;
        }
        reached++;
    }
    bodies->reach = bodies->moving = reached;
    if (is_changed) {
        fill_slots(bodies);
    }
}

void bodies_reach(Bodies *bodies)
{
    for (size_t i = 0; i < bodies->count; i++) {
        if (dBodyGetAutoDisableFlag(bodies->records[i].id)) {
            bodies_reach_from(bodies, bodies->records[i].id);
        }
    }
    for (size_t i = 0; i < bodies->queue_count; i++) {
        const dBodyID body = bodies->queue[i];
        const int joints = dBodyGetNumJoints(body);
        for (int j = 0; j < joints; j++) {
            const dJointID joint = dBodyGetJoint(body, j);
            bodies_reach_from(bodies, dJointGetBody(joint, 0));
            bodies_reach_from(bodies, dJointGetBody(joint, 1));
        }
    }
    put_reached_first(bodies);
}

void bodies_rest(Bodies *bodies)
{
    bodies->moving = bodies->reach;
    for (size_t i = bodies->reach; i < bodies->count; i++) {
        BodyRecord *record = &bodies->records[i];
        if (dBodyIsEnabled(record->id)) {
            dBodyDisable(record->id);
            record->is_resting = true;
        }
    }
}

void bodies_wake(Bodies *bodies)
{
    for (size_t i = bodies->reach; i < bodies->count; i++) {
        BodyRecord *record = &bodies->records[i];
        if (record->is_resting) {
            dBodyEnable(record->id);
            record->is_resting = false;
        }
    }
    bodies->moving = bodies->count;
}

static bool is_vector_in_range(const dReal *vector)
{
    return fabs(vector[0]) + fabs(vector[1]) + fabs(vector[2]) <= 0.1 * BODIES_LARGEST;
}

static bool is_body_in_range(dBodyID id)
{
    const dReal *vectors[] = {dBodyGetPosition(id), dBodyGetLinearVel(id), dBodyGetAngularVel(id),
                              dBodyGetForce(id), dBodyGetTorque(id)};
    const dReal *turn = dBodyGetQuaternion(id);
    double sum = fabs(turn[0]) + fabs(turn[1]) + fabs(turn[2]) + fabs(turn[3]);
    for (int v = 0; v < 5; v++) {
        sum += fabs(vectors[v][0]) + fabs(vectors[v][1]) + fabs(vectors[v][2]);
    }
    return sum <= BODIES_LARGEST;
}

// What of a body that is out of range is so most of all.
static const char *name_out_of_range(dBodyID id)
{
    static const char *const NAMES[] = {"position", "velocity", "angular velocity", "force",
                                        "torque"};
    const dReal *vectors[] = {dBodyGetPosition(id), dBodyGetLinearVel(id), dBodyGetAngularVel(id),
                              dBodyGetForce(id), dBodyGetTorque(id)};
    for (int v = 0; v < 5; v++) {
        if (!is_vector_in_range(vectors[v])) {
            return NAMES[v];
        }
    }
    return "orientation";
}

bool bodies_are_in_range(const Bodies *bodies, const char **name)
{
    for (size_t i = 0; i < bodies->count; i++) {
        if (!is_body_in_range(bodies->records[i].id)) {
            *name = name_out_of_range(bodies->records[i].id);
            return false;
        }
    }
    return true;
}

static void keep_position(dBodyID id, BodyMoment *kept)
{
    memcpy(kept->position, dBodyGetPosition(id), sizeof kept->position);
    memcpy(kept->turn, dBodyGetQuaternion(id), sizeof kept->turn);
}

static void keep_moment(dBodyID id, BodyMoment *kept)
{
    keep_position(id, kept);
    memcpy(kept->velocity, dBodyGetLinearVel(id), sizeof kept->velocity);
    memcpy(kept->omega, dBodyGetAngularVel(id), sizeof kept->omega);
    memcpy(kept->force, dBodyGetForce(id), sizeof kept->force);
    memcpy(kept->torque, dBodyGetTorque(id), sizeof kept->torque);
    kept->is_enabled = dBodyIsEnabled(id);
}

static void put_back_position(dBodyID id, const BodyMoment *kept)
{
    dBodySetPosition(id, kept->position[0], kept->position[1], kept->position[2]);
    dBodySetQuaternion(id, kept->turn);
}

static void put_back_moment(dBodyID id, const BodyMoment *kept)
{
    put_back_position(id, kept);
    dBodySetLinearVel(id, kept->velocity[0], kept->velocity[1], kept->velocity[2]);
    dBodySetAngularVel(id, kept->omega[0], kept->omega[1], kept->omega[2]);
    dBodySetForce(id, kept->force[0], kept->force[1], kept->force[2]);
    dBodySetTorque(id, kept->torque[0], kept->torque[1], kept->torque[2]);
    if (kept->is_enabled != dBodyIsEnabled(id)) {
        (kept->is_enabled ? dBodyEnable : dBodyDisable)(id);
    }
}

void bodies_find_all(Bodies *bodies)
{
    for (size_t i = 0; i < bodies->count; i++) {
        BodyRecord *record = &bodies->records[i];
        keep_moment(record->id, &record->found);
        record->is_gyroscopic = dBodyGetGyroscopicMode(record->id);
        record->found_past = record->past;
    }
}

void bodies_put_back_all(Bodies *bodies)
{
    for (size_t i = 0; i < bodies->count; i++) {
        BodyRecord *record = &bodies->records[i];
        put_back_moment(record->id, &record->found);
        dBodySetGyroscopicMode(record->id, record->is_gyroscopic);
        record->is_gyrating = record->is_resting = false;
        record->past = record->found_past;
    }
    bodies->moving = bodies->count;
}

void bodies_keep_positions(Bodies *bodies)
{
    for (size_t i = 0; i < bodies->moving; i++) {
        keep_position(bodies->records[i].id, &bodies->records[i].kept);
    }
}

void bodies_keep(Bodies *bodies)
{
    for (size_t i = 0; i < bodies->moving; i++) {
        keep_moment(bodies->records[i].id, &bodies->records[i].kept);
    }
}

void bodies_put_back_positions(const Bodies *bodies)
{
    for (size_t i = 0; i < bodies->moving; i++) {
        put_back_position(bodies->records[i].id, &bodies->records[i].kept);
    }
}

void bodies_put_back(const Bodies *bodies)
{
    for (size_t i = 0; i < bodies->moving; i++) {
        put_back_moment(bodies->records[i].id, &bodies->records[i].kept);
    }
}

void bodies_turn(const dReal *from, const dReal *by, double time, dQuaternion turned)
{
    const double rate = sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2]);
    const double half = 0.5 * rate * time;
    const double along = 0.5 * time * sinc(half);
    const dQuaternion step = {sinc_cos(half), along * by[0], along * by[1], along * by[2]};
    dQMultiply0(turned, step, from);
}

void bodies_move(dBodyID id, const double *speeds, double times)
{
    const dReal *at = dBodyGetPosition(id);
    dBodySetPosition(id, at[0] + times * speeds[0], at[1] + times * speeds[1],
                     at[2] + times * speeds[2]);
    dQuaternion turned;
    bodies_turn(dBodyGetQuaternion(id), &speeds[3], times, turned);
    dBodySetQuaternion(id, turned);
}

void bodies_add_speeds(const BodyRecord *record, const double *speeds)
{
    double sums[BODY_NUMBERS];
    bodies_read_speeds(record, sums);
    for (int k = 0; k < BODY_NUMBERS; k++) {
        sums[k] += speeds[k];
    }
    dBodySetLinearVel(record->id, sums[0], sums[1], sums[2]);
    dBodySetAngularVel(record->id, sums[3], sums[4], sums[5]);
}

void bodies_move_kept(BodyRecord *record, const double *speeds, double times)
{
    dQuaternion turned;
    bodies_turn(record->kept.turn, &speeds[3], times, turned);
    memcpy(record->kept.turn, turned, sizeof record->kept.turn);
    for (int k = 0; k < 3; k++) {
        record->kept.position[k] += times * speeds[k];
    }
}

void bodies_read_speeds(const BodyRecord *record, double *speeds)
{
    memcpy(speeds, dBodyGetLinearVel(record->id), 3 * sizeof *speeds);
    memcpy(speeds + 3, dBodyGetAngularVel(record->id), 3 * sizeof *speeds);
}

// Moves a body on from a position and an orientation.
static void drift_from(dBodyID id, const dReal *at, const dReal *turn, double time)
{
    const dReal *velocity = dBodyGetLinearVel(id);
    dQuaternion turned;
    bodies_turn(turn, dBodyGetAngularVel(id), time, turned);
    dBodySetPosition(id, at[0] + time * velocity[0], at[1] + time * velocity[1],
                     at[2] + time * velocity[2]);
    dBodySetQuaternion(id, turned);
}

void bodies_drift(const Bodies *bodies, double time)
{
    for (size_t i = 0; i < bodies->count; i++) {
        const dBodyID id = bodies->records[i].id;
        if (dBodyIsEnabled(id)) {
            drift_from(id, dBodyGetPosition(id), dBodyGetQuaternion(id), time);
        }
    }
}

void bodies_drift_kept(const Bodies *bodies, double time)
{
    for (size_t i = 0; i < bodies->count; i++) {
        const BodyRecord *record = &bodies->records[i];
        const dReal *at = record->kept.position;
        if (dBodyIsEnabled(record->id)) {
            drift_from(record->id, at, record->kept.turn, time);
        } else {
            dBodySetPosition(record->id, at[0], at[1], at[2]);
            dBodySetQuaternion(record->id, record->kept.turn);
        }
    }
}

long bodies_count(dWorldID world)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (file == NULL) {
        return -1;
    }
    dWorldExportDIF(world, file, "jp_");
    const bool is_written = fclose(file) == 0;
    long count = 0;
    for (const char *at = text; is_written && at != NULL; at = strstr(at + 1, "\njp_body[")) {
        count++;
    }
    free(text);
    return is_written ? count - 1 : -1;
}

long bodies_unknown(const Bodies *bodies, dWorldID world)
{
    const long count = bodies_count(world);
    return count < 0 ? -1 : count - (long)bodies->count;
}
