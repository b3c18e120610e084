// Finds the torque that keeps the angular momentum of a turning body through a step.
//
// With I at mid-step, o and n the angular velocities at start and end, the angular momenta in the
// world's frame are
//     L = exp(-h/2 o) I o,   L' = exp(h/2 n) I n        exp(u) x: x turned by the vector u
// ODE steps I (n - o) = h (T + others); L' - L = h (others) needs
//     h T = [1 - exp(h/2 n)] I n - [1 - exp(-h/2 o)] I o
// n = o + h times the angular acceleration of the step before is right to h^2, and T with it. ODE's
// own torque is implicit Euler, of first order.
#include "world/gyration.h"

#include "base/sinc.h"

#include <math.h>
#include <string.h>

// Of a principal inertia: a ball to rounding has no such torque.
static const double ROUND_SHARE = 1e-12;

// x less x turned by a vector times a share.
static void turned_away(const dReal *x, const dReal *by, double share, dVector3 away)
{
    dVector3 once;
    dVector3 twice;
    const double angle = fabs(share) * sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2]);
    const double first = sinc(angle);
    const double half = sinc(0.5 * angle);
    const dVector3 turn = {share * by[0], share * by[1], share * by[2], 0.0};
    dCalcVectorCross3(once, turn, x);
    dCalcVectorCross3(twice, turn, once);
    for (int i = 0; i < 3; i++) {
        away[i] = -first * once[i] - 0.5 * half * half * twice[i];
    }
}

static bool is_ball(const dMass *mass)
{
    const dReal *inertia = mass->I;
    const double size = inertia[0];
    const double off[] = {inertia[5] - size, inertia[10] - size, inertia[1], inertia[2],
                          inertia[6]};
    for (int i = 0; i < 5; i++) {
        if (fabs(off[i]) > ROUND_SHARE * size) {
            return false;
        }
    }
    return true;
}

// I x, both in the world.
static void momentum(dBodyID body, const dMass *mass, const dReal *x, dVector3 product)
{
    dVector3 local;
    dVector3 turned;
    dBodyVectorFromWorld(body, x[0], x[1], x[2], local);
    dMultiply0_331(turned, mass->I, local);
    dBodyVectorToWorld(body, turned[0], turned[1], turned[2], product);
}

static void push(BodyRecord *record, const dMass *mass, double step)
{
    const dReal *start = dBodyGetAngularVel(record->id);
    const bool goes_on =
        record->has_last && memcmp(start, record->last_omega, 3 * sizeof(dReal)) == 0;
    dVector3 end;
    for (int i = 0; i < 3; i++) {
        end[i] = start[i] + (goes_on ? step * record->last_alpha[i] : 0.0);
    }
    dVector3 momenta[2];
    dVector3 changes[2];
    momentum(record->id, mass, start, momenta[0]);
    momentum(record->id, mass, end, momenta[1]);
    turned_away(momenta[0], start, -0.5 * step, changes[0]);
    turned_away(momenta[1], end, 0.5 * step, changes[1]);
    dBodyAddTorque(record->id, (changes[1][0] - changes[0][0]) / step,
                   (changes[1][1] - changes[0][1]) / step, (changes[1][2] - changes[0][2]) / step);
}

void gyration_push(Bodies *bodies, double step)
{
    for (size_t i = 0; i < bodies->count; i++) {
        BodyRecord *record = &bodies->records[i];
        dMass mass;
        dBodyGetMass(record->id, &mass);
        record->is_gyrating = dBodyGetGyroscopicMode(record->id) && dBodyIsEnabled(record->id) &&
                              !dBodyIsKinematic(record->id) && !is_ball(&mass);
        if (record->is_gyrating) {
            push(record, &mass, step);
            dBodySetGyroscopicMode(record->id, 0);
        }
    }
}

void gyration_finish(Bodies *bodies, double step)
{
    for (size_t i = 0; i < bodies->count; i++) {
        BodyRecord *record = &bodies->records[i];
        if (!record->is_gyrating) {
            record->has_last = false;
            continue;
        }
        dBodySetGyroscopicMode(record->id, 1);
        memcpy(record->last_omega, dBodyGetAngularVel(record->id), sizeof record->last_omega);
        for (int k = 0; k < 3; k++) {
            record->last_alpha[k] = (record->last_omega[k] - record->kept.omega[k]) / step;
        }
        record->has_last = true;
    }
}
