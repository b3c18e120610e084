// How does a world answer to a push?
#include "world/trial.h"

JpStatus trial_step(JpWorld *world, double step, JpError *error)
{
    const int is_done =
        world->options.is_quick ? dWorldQuickStep(world->id, step) : dWorldStep(world->id, step);
    world->stats.world_steps++;
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
        return refusal(error, JP_ERROR_WORLD,
                       "%ld bodies of the world are linked with no joint of ours; add them with "
                       "jp_world_add_body",
                       unknown);
    }
    world->known_when_counted = world->bodies.count;
    return JP_OK;
}

// The rate of the coordinate after a step under a push, which is taken back.
static JpStatus rate_under(JpJoint *joint, double force, double step, double *rate, JpError *error)
{
    JpWorld *world = joint->world;
    coordinate_push(&joint->coordinate, force);
    const JpStatus status = trial_step(world, step, error);
    *rate = coordinate_rate(&joint->coordinate);
    bodies_put_back(&world->bodies);
    return status;
}

JpStatus trial_mobility(JpJoint *joint, double force, double step, double *mobility, JpError *error)
{
    double rates[2];
    REFUSAL_TRY(trial_check(joint->world, error));
    REFUSAL_TRY(rate_under(joint, 0.0, step, &rates[0], error));
    REFUSAL_TRY(rate_under(joint, force, step, &rates[1], error));
    *mobility = (rates[1] - rates[0]) / (step * force) + 1.0 / joint->rotor.inertia;
    return JP_OK;
}
