// How much energy do the bodies hold?
//
//     T = sum (m v^2 + I w^2) / 2,   V = sum m g y
#include "model/energy.h"

double energy_kinetic(const Linkage *linkage, const Motion *motions)
{
    double energy = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Motion *motion = &motions[i];
        energy += 0.5 * linkage->bodies[i].mass * vec2_dot(motion->velocity, motion->velocity) +
                  0.5 * linkage->bodies[i].inertia * motion->omega * motion->omega;
    }
    return energy;
}

double energy_potential(const Linkage *linkage, const Motion *motions, double gravity)
{
    double energy = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        energy += linkage->bodies[i].mass * gravity * motions[i].position.y;
    }
    return energy;
}
