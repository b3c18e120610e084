// Finds how a world responds to a push.
#include "world/trial.h"

#include "world/work.h"

JpStatus trial_step(JpWorld *world, double step, JpError *error)
{
    const int is_done =
        world->options.is_quick ? dWorldQuickStep(world->id, step) : dWorldStep(world->id, step);
    world->stats.world_steps++;
    world->work += work_of_step(world);
    return is_done ? JP_OK : refusal(error, JP_ERROR_MEMORY, "ODE has no memory for a step");
}

JpStatus trial_check(JpWorld *world, JpError *error)
{
    if (world->known_when_counted == world->bodies.count) {
        return JP_OK;
    }
    const long unknown = bodies_unknown(&world->bodies, world->id);
    if (unknown < 0) {
        return refusal(error, JP_ERROR_MEMORY, "the bodies of the world could not be counted");
    }
    if (unknown > 0) {
        return refusal(
            error, JP_ERROR_WORLD,
            "%ld bodies of the world are connected with no joint of the library; add them with "
            "jp_world_add_body",
            unknown);
    }
    world->known_when_counted = world->bodies.count;
    return JP_OK;
}

// The rate in a direction after a step under a push, which is taken back.
static JpStatus rate_under(JpWorld *world, const Direction *direction, double force, double step,
                           double *rate, JpError *error)
{
    direction_push(direction, force);
    const JpStatus status = trial_step(world, step, error);
    *rate = direction_rate(direction);
    bodies_put_back(&world->bodies);
    return status;
}

JpStatus trial_mobility(JpWorld *world, const Direction *direction, double force, double step,
                        double *mobility, JpError *error)
{
    double rates[2];
    REFUSAL_TRY(trial_check(world, error));
    REFUSAL_TRY(rate_under(world, direction, 0.0, step, &rates[0], error));
    REFUSAL_TRY(rate_under(world, direction, force, step, &rates[1], error));
    *mobility = (rates[1] - rates[0]) / (step * force);
    return JP_OK;
}
