// Which method takes the next step?
//
// Rates die away in a contact of damping c with the time constant m / c. The explicit method is
// held to steps of some three of them, however smooth the motion is; that is what is looked for.
// The sum of all rates of decay is minus the trace of dA/du.
#include "reference/stiffness.h"

#include <math.h>

enum { LOOK_EVERY = 32 }; // explicit steps

// Steps times the sum of the rates of decay. Above the first the explicit method is held back,
// below the second it takes the same steps for a fifth of the work.
static const double STIFF = 1.5;
static const double EASY = 0.5;

// What accelerations are differentiated by: of the fastest speed, and of a depth
static const double SPEED_SHARE = 1e-7;
static const double DEPTH_SHARE = 1e-3;

double stiffness_damping(const DynamicsContact *contact, const ContactForce *force)
{
    return force->elastic * contact->damping_rate + contact->law.viscous;
}

// The smallest depth that a force depends on in the next step, m; 0 where nothing presses.
static double smallest_depth(const Dynamics *dynamics, const DynamicsState *state, double step)
{
    double smallest = 0.0;
    for (size_t i = 0; i < dynamics->contact_count; i++) {
        const PinHole *pose = &state->contacts[i].pose;
        if (dynamics->contacts[i].mode == CONTACT_PRESSING) {
            const double depth = fabs(pose->penetration) + step * fabs(pose->approach_speed);
            smallest = smallest > 0.0 ? fmin(smallest, depth) : depth;
        }
    }
    return smallest;
}

static void set_nudges(const Tree *tree, const SpeedScale *scale, double depth, double *nudge)
{
    const size_t n = tree->coordinate_count;
    for (size_t i = 0; i < n; i++) {
        nudge[i] = DEPTH_SHARE * depth;
        nudge[n + i] = SPEED_SHARE * scale->moving;
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const size_t angle = tree->nodes[i].angle_column;
        const double turning = scale->turning[tree->nodes[i].body];
        nudge[angle] = DEPTH_SHARE * depth * turning / scale->moving;
        nudge[n + angle] = SPEED_SHARE * turning;
    }
}

void stiffness_follow(Stiffness *stiffness, const Dynamics *dynamics, const DynamicsState *state,
                      const SpeedScale *scale, bool is_event, Dop853 *integrator)
{
    const double depth = smallest_depth(dynamics, state, integrator->step);
    stiffness->steps = is_event ? 0 : stiffness->steps + 1;
    if (!(depth > 0.0)) {
        integrator->method = NULL;
        return;
    }
    if (integrator->method == NULL && stiffness->steps < LOOK_EVERY) {
        return;
    }
    stiffness->steps = 0;
    if (stiffness->radau == NULL) {
        stiffness->radau = radau_create();
    }
    Radau *radau = stiffness->radau;
    set_nudges(&dynamics->tree, scale, depth, radau->nudge);
    if (integrator->method == NULL || is_event) {
        radau_look(radau, integrator);
    }
    const double most = integrator->method == NULL ? STIFF : EASY;
    integrator->method = integrator->step * radau->decay > most ? &radau->method : NULL;
}

void stiffness_finish(Stiffness *stiffness)
{
    radau_destroy(stiffness->radau);
}
