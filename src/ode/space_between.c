// Where is a body in space at a time inside a step?
#include "ode/space_between.h"

#include "model/space_response.h"

static Vec3 weigh(double share, Vec3 a, Vec3 b)
{
    return vec3_add(vec3_scale(1.0 - share, a), vec3_scale(share, b));
}

SpaceMotion space_between_leapfrog(const SpaceMotion *first, const SpaceMotion *mean,
                                   const SpaceMotion *other, double since_s, double step_s)
{
    const double off_s = since_s - 0.5 * step_s;
    const double share = fabs(off_s) / step_s; // of the way to the other step's middle
    const double square = 0.5 * since_s * since_s;
    const SpaceChange place = {
        vec3_add(vec3_scale(off_s, first->velocity), vec3_scale(square, mean->acceleration)),
        vec3_add(vec3_scale(off_s, first->omega), vec3_scale(square, mean->alpha))};
    const SpaceChange speed = {vec3_scale(since_s, mean->acceleration),
                               vec3_scale(since_s, mean->alpha)};
    SpaceMotion motion = *first;
    space_change(&motion, &place, &speed);
    motion.acceleration = weigh(share, mean->acceleration, other->acceleration);
    motion.alpha = weigh(share, mean->alpha, other->alpha);
    return motion;
}

void space_between_guess(const SpaceMotion *first, const SpaceMotion *second, SpaceMotion *before)
{
    before->acceleration = weigh(-1.0, first->acceleration, second->acceleration);
    before->alpha = weigh(-1.0, first->alpha, second->alpha);
}

SpaceMotion space_between_plain(const SpaceMotion *first, const SpaceMotion *last, double since_s,
                                double step_s)
{
    const double share = since_s / step_s;
    const SpaceChange place = {vec3_scale(share, vec3_sub(last->position, first->position)),
                               vec3_scale(since_s, last->omega)};
    const SpaceChange speed = {vec3_scale(since_s, last->acceleration),
                               vec3_scale(since_s, last->alpha)};
    SpaceMotion motion = *first;
    space_change(&motion, &place, &speed);
    motion.acceleration = last->acceleration;
    motion.alpha = last->alpha;
    return motion;
}
