// Which method takes the next step?
//
// Rates die away in a contact of damping c with the time constant m / c. The explicit method is
// held to steps of some three of them, however smooth the motion is; that is what is looked for:
// the largest eigenvalue of -dA/du. Their sum would not do: of several contacts, none of which
// holds steps back, it had the implicit method take over at a multiple of the work.
//
// At a small tolerance steps are shorter still: the accelerations at the stages, which are of low
// order, err by c / m of the stages' speeds. Of a contact that does not oscillate for long,
//     (c / 2 sqrt(k m))^2 = (c / m) (c / k) / 4  >  1 / 4
// that costs many times the steps that the motion needs. No rate tells by how many: the implicit
// method is put on trial, and stays where its steps are longer by more than they cost. (Trials of
// contacts that do oscillate cost up to a tenth of the work and win nothing.)
#include "reference/stiffness.h"

#include <math.h>

enum { LOOK_EVERY = 32 }; // explicit steps

// Steps times the largest rate of decay. Above the first the explicit method is held back,
// below the second it takes the same steps for a fifth of the work.
static const double STIFF = 2.5;
static const double EASY = 0.5;

// A trial costs the work of some steps. It is worth while from these on, of a contact by itself:
// steps times its rate of decay, and that rate times c / k.
static const double DOUBTFUL = 0.02;
static const double OVERDAMPED = 1.0;

// an implicit step takes the work of some eight explicit ones
static const double WORTH = 8.0;

// What accelerations are differentiated by: of the fastest speed, and of a depth
static const double SPEED_SHARE = 1e-7;
static const double DEPTH_SHARE = 1e-3;

// The smallest depth that a force depends on in the next step, m; 0 where nothing presses.
static double smallest_depth(const System *system, const SystemState *state, double step)
{
    double smallest = 0.0;
    for (size_t i = 0; i < system->contact_count; i++) {
        const Press *press = &state->contacts[i];
        if (system->contacts[i].mode == CONTACT_PRESSING) {
            const double depth =
                (fabs(press->depth) + step * fabs(press->closing)) * system->contacts[i].arm;
            smallest = smallest > 0.0 ? fmin(smallest, depth) : depth;
        }
    }
    return smallest;
}

static void set_nudges(const System *system, const SpeedScale *scale, double depth, double *nudge)
{
    const size_t n = system->coordinate_count;
    for (size_t i = 0; i < n; i++) {
        const int body = system->coordinates[i].turning;
        const double moved = DEPTH_SHARE * depth;
        nudge[i] = body < 0 ? moved : moved * scale->turning[body] / scale->moving;
        nudge[n + i] = SPEED_SHARE * (body < 0 ? scale->moving : scale->turning[body]);
    }
}

// Whether the damping of the contacts outweighs their springs by so much that explicit steps may be
// far shorter than need be.
static bool is_doubtful(const System *system, const SystemState *state, double step, double decay)
{
    double relaxation_s = 0.0; // the longest time in which a spring moves its damper
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        const double depth = fabs(state->contacts[i].depth);
        const double stiffness = force_law_tangent(&contact->law, depth);
        if (contact->mode == CONTACT_PRESSING) {
            const double damping = press_damping(contact, &state->contacts[i]);
            relaxation_s = stiffness > 0.0 ? fmax(relaxation_s, damping / stiffness) : relaxation_s;
        }
    }
    return step * decay > DOUBTFUL && decay * relaxation_s > OVERDAMPED;
}

// Whether the implicit method takes over from the explicit one, or is put on trial.
static bool takes_over(Stiffness *stiffness, const System *system, const SystemState *state,
                       Dop853 *integrator)
{
    const double decay = stiffness->radau->decay;
    if (integrator->step * decay > STIFF) {
        return true;
    }
    if (!is_doubtful(system, state, integrator->step, decay)) {
        return false;
    }
    if (stiffness->wait > 0) {
        stiffness->wait--;
        return false;
    }
    stiffness->beaten_s = integrator->step;
    integrator->step *= 2.0 * WORTH;
    return true;
}

// Whether the implicit method stays: after a trial where its step was worth it.
static bool stays(Stiffness *stiffness, double taken_s, Dop853 *integrator)
{
    const double beaten_s = stiffness->beaten_s;
    stiffness->beaten_s = 0.0;
    if (beaten_s == 0.0) {
        return integrator->step * stiffness->radau->decay > EASY;
    }
    if (taken_s > WORTH * beaten_s) {
        stiffness->pause = 0;
        return true;
    }
    integrator->step = beaten_s;
    // the next trials come at ever longer intervals
    stiffness->pause = 2 * stiffness->pause + 1;
    stiffness->wait = stiffness->pause;
    return false;
}

void stiffness_follow(Stiffness *stiffness, const System *system, const SystemState *state,
                      const SpeedScale *scale, double taken_s, bool is_event, Dop853 *integrator)
{
    const double depth = smallest_depth(system, state, integrator->step);
    const bool is_implicit = integrator->method != NULL;
    stiffness->steps = is_event ? 0 : stiffness->steps + 1;
    if (is_event || !(depth > 0.0)) {
        stiffness->beaten_s = 0.0;
        stiffness->wait = stiffness->pause = 0;
    }
    if (!(depth > 0.0)) {
        integrator->method = NULL;
        return;
    }
    if (!is_implicit && stiffness->steps < LOOK_EVERY) {
        return;
    }
    stiffness->steps = 0;
    if (stiffness->radau == NULL) {
        stiffness->radau = radau_create(integrator);
    }
    Radau *radau = stiffness->radau;
    set_nudges(system, scale, depth, radau->nudge);
    if (!is_implicit || is_event) {
        radau_look(radau, integrator);
    }
    const bool is_next = is_implicit ? stays(stiffness, taken_s, integrator)
                                     : takes_over(stiffness, system, state, integrator);
    integrator->method = is_next ? &radau->method : NULL;
}

void stiffness_finish(Stiffness *stiffness)
{
    radau_destroy(stiffness->radau);
}
