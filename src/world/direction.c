// Reads how two bodies move in a direction, and pushes them in it.
//
// The rate is a . (v1 + omega1 x r1 - v2 - omega2 x r2), or a . (omega1 - omega2) of a turn, r the
// arms as they were when the direction was made.
#include "world/direction.h"

#include <string.h>

static void arm_of(dBodyID body, const dReal *point, dVector3 arm)
{
    static const dVector3 ORIGIN = {0.0, 0.0, 0.0, 0.0};
    const dReal *centre = body != NULL ? dBodyGetPosition(body) : ORIGIN;
    for (int i = 0; i < 3; i++) {
        arm[i] = point[i] - centre[i];
    }
    arm[3] = 0.0;
}

Direction direction_about(const dBodyID bodies[2], const dReal *axis)
{
    return (Direction){
        .bodies = {bodies[0], bodies[1]},
        .is_turn = true,
        .axis = {axis[0], axis[1], axis[2], 0.0},
    };
}

Direction direction_along(const dBodyID bodies[2], const dReal *axis, const dReal *first,
                          const dReal *second)
{
    Direction made = direction_about(bodies, axis);
    made.is_turn = false;
    arm_of(bodies[0], first, made.arms[0]);
    arm_of(bodies[1], second, made.arms[1]);
    return made;
}

Direction direction_later(const Direction *direction, double time)
{
    Direction later = *direction;
    for (int i = 0; i < 2 && !direction->is_turn; i++) {
        if (direction->bodies[i] != NULL) {
            dVector3 carried;
            dCalcVectorCross3(carried, dBodyGetAngularVel(direction->bodies[i]),
                              direction->arms[i]);
            for (int k = 0; k < 3; k++) {
                later.arms[i][k] += time * carried[k];
            }
        }
    }
    return later;
}

void direction_move(Direction *direction, const Bodies *bodies, const double *moves)
{
    for (int i = 0; i < 2 && !direction->is_turn; i++) {
        const BodyRecord *record =
            direction->bodies[i] != NULL ? bodies_find(bodies, direction->bodies[i]) : NULL;
        if (record != NULL) {
            const double *move = &moves[BODY_NUMBERS * (size_t)(record - bodies->records)];
            dVector3 carried;
            dCalcVectorCross3(carried, move + 3, direction->arms[i]);
            for (int k = 0; k < 3; k++) {
                direction->arms[i][k] += carried[k];
            }
        }
    }
}

double direction_of_move(const Direction *direction, int number, const double move[6])
{
    const dVector3 turn = {move[3], move[4], move[5], 0.0};
    if (direction->is_turn) {
        return dCalcVectorDot3(direction->axis, turn);
    }
    dVector3 turned;
    dCalcVectorCross3(turned, turn, direction->arms[number]);
    return dCalcVectorDot3(direction->axis, move) + dCalcVectorDot3(direction->axis, turned);
}

double direction_rate(const Direction *direction)
{
    double rate = 0.0;
    for (int i = 0; i < 2; i++) {
        const dBodyID body = direction->bodies[i];
        if (body == NULL) {
            continue;
        }
        double speeds[6];
        memcpy(speeds, dBodyGetLinearVel(body), 3 * sizeof *speeds);
        memcpy(speeds + 3, dBodyGetAngularVel(body), 3 * sizeof *speeds);
        const double own = direction_of_move(direction, i, speeds);
        rate += i == 0 ? own : -own;
    }
    return rate;
}

// The torque of a force of 1 about a body's centre; of a turn the axis itself.
static void couple_of(const Direction *direction, int number, dVector3 couple)
{
    if (direction->is_turn) {
        memcpy(couple, direction->axis, sizeof(dVector3));
    } else {
        dCalcVectorCross3(couple, direction->arms[number], direction->axis);
    }
}

void direction_push(const Direction *direction, double force)
{
    for (int i = 0; i < 2; i++) {
        const dBodyID body = direction->bodies[i];
        if (body == NULL) {
            continue;
        }
        const double push = i == 0 ? force : -force;
        const dReal *axis = direction->axis;
        dVector3 couple;
        couple_of(direction, i, couple);
        if (!direction->is_turn) {
            dBodyAddForce(body, push * axis[0], push * axis[1], push * axis[2]);
        }
        dBodyAddTorque(body, push * couple[0], push * couple[1], push * couple[2]);
    }
}

// x . I^-1 x of a body, x in the world.
static double turning_mobility(dBodyID body, const dMass *mass, const dReal *x)
{
    dMatrix3 inverse;
    dVector3 local;
    dVector3 turned;
    if (!dInvertPDMatrix(mass->I, inverse, 3)) {
        return 0.0;
    }
    dBodyVectorFromWorld(body, x[0], x[1], x[2], local);
    dMultiply0_331(turned, inverse, local);
    return dCalcVectorDot3(local, turned);
}

double direction_mobility(const Direction *direction)
{
    double mobility = 0.0;
    for (int i = 0; i < 2; i++) {
        const dBodyID body = direction->bodies[i];
        if (body == NULL || dBodyIsKinematic(body)) {
            continue;
        }
        dMass mass;
        dVector3 couple;
        dBodyGetMass(body, &mass);
        couple_of(direction, i, couple);
        mobility += turning_mobility(body, &mass, couple);
        mobility += direction->is_turn
                        ? 0.0
                        : dCalcVectorDot3(direction->axis, direction->axis) / mass.mass;
    }
    return mobility;
}
