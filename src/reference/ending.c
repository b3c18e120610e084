// How long may a step be in which a contact is about to end?
//
// Where a contact ends, its force has a corner, as of d^n, and no formula is of its order across
// it. With depth d, its rate d' < 0 and second rate d'', the contact ends after
//     t = 2 d / (-d' + sqrt(d'^2 - 2 d d'')),
// or not at all where the root is of a negative number. What the corner costs grows with the
// impulse that is still to come, F t. Steps keep to a share of t until that is small enough to be
// crossed: as small as one was that has been crossed before.
#include "reference/ending.h"

#include <math.h>

// Of the step that the errors so far allow: an end that is nearer is worth looking at, and one that
// is nearer than the second number is rounding.
static const double NEAR = 0.9;
static const double NEAREST = 1e-6;

// Of the time to the end: so that it is crossed, and so that it is not. Measured, shares of 0.6 to
// 0.85 cost the same to one in a hundred.
static const double ACROSS = 1.05;
static const double BEFORE = 0.7;

// How what can be crossed changes where an end was crossed, and where it could not be.
static const double MORE = 2.0;
static const double LESS = 0.25;

// of the step: over which the second rate is found
static const double LITTLE = 1e-3;

Ending ending_start(void)
{
    return (Ending){.crossed = INFINITY, .size = -1.0};
}

// The second rate of a depth.
static double second_rate(const System *system, size_t contact, double closing,
                          const Dop853 *integrator)
{
    const double little_s = LITTLE * integrator->step;
    double *y = integrator->at;
    for (size_t i = 0; i < integrator->size; i++) {
        y[i] = integrator->y[i] + little_s * integrator->stages[0][i];
    }
    const Press later = system->kind->press(system, contact, integrator->time + little_s, y);
    return (later.closing - closing) / little_s;
}

// The time after which a contact ends, if that is below a limit; infinite otherwise.
static double time_left(const System *system, size_t contact, const Press *press,
                        const Dop853 *integrator, double limit_s)
{
    const double speed = -press->closing;
    const bool is_pressing = system->contacts[contact].mode == CONTACT_PRESSING;
    // no acceleration makes it less than half of what the speed alone says, but one that grows
    if (!is_pressing || !(speed > 0.0 && press->depth > 0.0) ||
        press->depth > 2.0 * limit_s * speed) {
        return INFINITY;
    }
    const double second = second_rate(system, contact, press->closing, integrator);
    const double square = speed * speed - 2.0 * press->depth * second;
    const double left_s = square > 0.0 ? 2.0 * press->depth / (speed + sqrt(square)) : INFINITY;
    return left_s < limit_s ? left_s : INFINITY;
}

double ending_limit(Ending *ending, const System *system, const SystemState *state,
                    const Dop853 *integrator)
{
    double least_s = integrator->step / NEAR;
    double size = -1.0;
    ending->size = -1.0;
    for (size_t i = 0; integrator->method == NULL && i < system->contact_count; i++) {
        const Press *press = &state->contacts[i];
        const double left_s = time_left(system, i, press, integrator, least_s);
        if (left_s < least_s && left_s > NEAREST * integrator->step) {
            least_s = left_s;
            size = press->elastic * left_s;
        }
    }
    if (size < 0.0) {
        return INFINITY;
    }
    if (size > ending->crossed) {
        return BEFORE * least_s;
    }
    ending->size = size;
    return ACROSS * least_s;
}

void ending_note(Ending *ending, bool is_refused)
{
    if (ending->size >= 0.0) {
        ending->crossed =
            is_refused ? LESS * ending->size : fmax(ending->crossed, MORE * ending->size);
    }
}
