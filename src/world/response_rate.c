// Finds how a world's response to pushes changes within a step.
//
// With A what a push in a row does to all bodies and L = M A its momenta, which in space turn with
// the bodies,
//     S_ik = A_k . L_i',   L' = M A' + omega x (M A) - M (omega x A)
// is by how much the mobility between two rows changes, W' = S + S': forces of ideal joints do no
// work along A_k, and what is left of L_i' is the turning of row i. A' follows from the responses
// in this step and in those before (world/response_cache.h).
#include "world/response_rate.h"

#include "kernel/columns.h"
#include "world/inside.h"
#include "world/response_cache.h"

#include <math.h>
#include <string.h>

// rad, by which a pin may turn about another axis than its own in a step: rounding
static const double ASKEW_MOST = 1e-9;

static bool is_askew(const WorldResponse *response, const ResponsePlace *of)
{
    const dBodyID pin = of->joint->bodies[0];
    if (of->place->shape != PLACE_HOLE || pin == NULL) {
        return false;
    }
    // the pin's axis is at right angles to the first two rows
    const dReal *omega = dBodyGetAngularVel(pin);
    return response->step * (fabs(dCalcVectorDot3(omega, of->place->rows[0].axis)) +
                             fabs(dCalcVectorDot3(omega, of->place->rows[1].axis))) >
           ASKEW_MOST;
}

static bool is_any_askew(const WorldResponse *response)
{
    for (size_t i = 0; i < response->place_count; i++) {
        const ResponsePlace *of = &response->places[i];
        if (of->is_active && is_askew(response, of)) {
            return true;
        }
    }
    return false;
}

// I x, both in the world.
static void turn_momentum(dBodyID body, const dMass *mass, const double *x, double product[3])
{
    dVector3 local;
    dVector3 turned;
    dVector3 momentum;
    dBodyVectorFromWorld(body, x[0], x[1], x[2], local);
    dMultiply0_331(turned, mass->I, local);
    dBodyVectorToWorld(body, turned[0], turned[1], turned[2], momentum);
    memcpy(product, momentum, 3 * sizeof *product);
}

// L' of a body, from its part of A and A'.
static void momentum_rate(dBodyID body, const dMass *mass, const double *column, const double *rate,
                          double momentum[BODY_NUMBERS])
{
    const dReal *omega = dBodyGetAngularVel(body);
    dVector3 spun;
    dVector3 carried;
    double spin[4] = {0.0};
    double late[3];
    for (int k = 0; k < 3; k++) {
        momentum[k] = mass->mass * rate[k];
    }
    turn_momentum(body, mass, rate + 3, momentum + 3);
    turn_momentum(body, mass, column + 3, spin);
    dCalcVectorCross3(spun, omega, spin);
    dCalcVectorCross3(carried, omega, column + 3);
    turn_momentum(body, mass, carried, late);
    for (int k = 0; k < 3; k++) {
        momentum[3 + k] += spun[k] - late[k];
    }
}

// Adds a body's part of S.
static void add_body(WorldResponse *response, size_t number)
{
    const dBodyID body = response->world->bodies.records[number].id;
    const size_t rows = response->row_count;
    const size_t numbers = BODY_NUMBERS * response->world->bodies.moving;
    const size_t first = BODY_NUMBERS * number;
    dMass mass;
    dBodyGetMass(body, &mass);
    for (size_t i = 0; i < rows; i++) {
        double momentum[BODY_NUMBERS];
        momentum_rate(body, &mass, &response->bodies[i * numbers + first],
                      &response->rates[i * numbers + first], momentum);
        for (size_t k = 0; k < rows; k++) { // those of rows that are not active are 0
            const double *column = &response->bodies[k * numbers + first];
            for (size_t n = 0; n < BODY_NUMBERS; n++) {
                response->drift[i * rows + k] += column[n] * momentum[n];
            }
        }
    }
}

JpStatus response_rate_find(WorldResponse *response, double step, JpError *error)
{
    const Bodies *bodies = &response->world->bodies;
    response->has_rates = inside_may_drift(response) && !is_any_askew(response);
    if (!response->has_rates) {
        return JP_OK;
    }
    if (!response_cache_rates(response)) {
        REFUSAL_TRY(world_response_find_rates(response, step, error));
    }
    memset(response->drift, 0, response->row_count * response->row_count * sizeof(double));
    for (size_t i = 0; i < bodies->moving; i++) {
        if (!dBodyIsKinematic(bodies->records[i].id)) {
            add_body(response, i);
        }
    }
    return JP_OK;
}

void response_rate_push(const WorldResponse *response, double *speeds, double *positions,
                        double *turned)
{
    const size_t numbers = BODY_NUMBERS * response->world->bodies.moving;
    const KernelColumns columns = {
        .rows = response->row_count,
        .coordinates = numbers,
        .columns = response->bodies,
        .rates = response->has_rates ? response->rates : NULL,
    };
    memset(speeds, 0, numbers * sizeof *speeds);
    memset(positions, 0, numbers * sizeof *positions);
    memset(turned, 0, numbers * sizeof *turned);
    kernel_columns_push(&columns, 0.5 * response->step, response->net, response->moment, speeds,
                        positions);
    kernel_columns_turn(&columns, response->step, response->net, response->moment, turned);
}
