// How far are two motions of one linkage apart, in numbers that mean the same for all bodies?
//
//     d(t) = max over bodies |omega_b(t) - ref_b(t)| / max over t |ref_b|
// over every body whose speed is not prescribed. A body that hardly turns is measured by the omega
// with which its furthest joint would move at a thousandth of the speed of the fastest point of the
// linkage: its own would be rounding. Sizes are those of the body itself, so that a pivot far away
// changes nothing. Where no drive turns anything, bodies may not turn at all: the speeds of their
// centres then take the place of omega, and their accelerations that of alpha.
#include "model/distance.h"

enum { LEAST_SAMPLES = 1000 }; // fewer steps of a horizon would say little

static const double SMALLEST_SCALE =
    1e-3; // of the fastest point's: below it lies no motion to speak of

bool distance_is_by_velocity(const Trajectory *reference)
{
    return reference->driven_body == LINKAGE_GROUND;
}

static Vec3 planar_rate(const Motion *motion, bool is_velocity)
{
    return is_velocity ? (Vec3){motion->velocity.x, motion->velocity.y, 0.0}
                       : (Vec3){motion->omega, 0.0, 0.0};
}

Vec3 distance_rate(const Trajectory *trajectory, size_t sample, size_t body, bool is_velocity)
{
    if (trajectory->space_motions == NULL) {
        return planar_rate(trajectory_motion(trajectory, sample, body), is_velocity);
    }
    const SpaceMotion *motion = trajectory_space_motion(trajectory, sample, body);
    return is_velocity ? motion->velocity : motion->omega;
}

Vec3 distance_sample_rate(const Sample *sample, bool is_spatial, size_t body, bool is_velocity)
{
    if (!is_spatial) {
        return planar_rate(&sample->bodies[body], is_velocity);
    }
    const SpaceMotion *motion = &sample->space_bodies[body];
    return is_velocity ? motion->velocity : motion->omega;
}

Vec3 distance_change(const Trajectory *trajectory, size_t sample, size_t body, bool is_velocity)
{
    if (trajectory->space_motions == NULL) {
        const Motion *motion = trajectory_motion(trajectory, sample, body);
        return is_velocity ? (Vec3){motion->acceleration.x, motion->acceleration.y, 0.0}
                           : (Vec3){motion->alpha, 0.0, 0.0};
    }
    const SpaceMotion *motion = trajectory_space_motion(trajectory, sample, body);
    return is_velocity ? motion->acceleration : motion->alpha;
}

double distance_between(Vec3 a, Vec3 b)
{
    const Vec3 apart = vec3_sub(a, b);
    // of turning in the plane
    if (apart.y == 0.0 && apart.z == 0.0) {
        return fabs(apart.x);
    }
    return hypot(hypot(apart.x, apart.y), apart.z);
}

// The largest rates of one body. A point of it moves with |v| + |omega| reach at most.
static DistanceScale body_scale(const Trajectory *reference, size_t body)
{
    const Vec3 still = {0.0, 0.0, 0.0};
    const bool is_velocity = distance_is_by_velocity(reference);
    const double reach = reference->reach[body];
    DistanceScale scale = {.omega = 0.0};
    for (size_t k = 0; k < reference->sample_count; k++) {
        const Vec3 velocity = distance_rate(reference, k, body, true);
        const Vec3 omega = distance_rate(reference, k, body, false);
        const Vec3 acceleration = distance_change(reference, k, body, true);
        const Vec3 alpha = distance_change(reference, k, body, false);
        const double moving = distance_between(velocity, still);
        const double changing = distance_between(acceleration, still);
        const double turning = distance_between(omega, still);
        const double speeding = distance_between(alpha, still);
        scale.omega = fmax(scale.omega, is_velocity ? moving : turning);
        scale.alpha = fmax(scale.alpha, is_velocity ? changing : speeding);
        scale.moving = fmax(scale.moving, moving + turning * reach);
        scale.changing = fmax(scale.changing, changing + speeding * reach);
    }
    return scale;
}

// A share of a rate of the fastest point of all, as a rate of one body; 1 where nothing moves.
static double least_rate(double fastest, double reach, bool is_velocity)
{
    return fastest > 0.0 ? SMALLEST_SCALE * fastest / (is_velocity ? 1.0 : reach) : 1.0;
}

void distance_scales(const Trajectory *reference, DistanceScale scales[LINKAGE_BODY_MAX])
{
    const bool is_velocity = distance_is_by_velocity(reference);
    double moving = 0.0;
    double changing = 0.0;
    for (size_t i = 0; i < reference->body_count; i++) {
        scales[i] = body_scale(reference, i);
        moving = fmax(moving, scales[i].moving);
        changing = fmax(changing, scales[i].changing);
    }
    for (size_t i = 0; i < reference->body_count; i++) {
        const double reach = reference->reach[i];
        DistanceScale *scale = &scales[i];
        scale->omega = fmax(scale->omega, least_rate(moving, reach, is_velocity));
        scale->alpha = fmax(scale->alpha, least_rate(changing, reach, is_velocity));
        scale->moving = fmax(scale->moving, least_rate(moving, reach, true));
        scale->turning = scale->moving / reach;
        if ((int)i == reference->driven_body) {
            scale->omega = 0.0;
            scale->alpha = 0.0;
        }
    }
}

double distance_at(const Trajectory *trajectory, const Trajectory *reference, size_t sample,
                   const DistanceScale *scales)
{
    const bool is_velocity = distance_is_by_velocity(reference);
    double largest = 0.0;
    for (size_t i = 0; i < reference->body_count; i++) {
        if (scales[i].omega > 0.0) {
            const double apart = distance_between(distance_rate(trajectory, sample, i, is_velocity),
                                                  distance_rate(reference, sample, i, is_velocity));
            largest = fmax(largest, apart / scales[i].omega);
        }
    }
    return largest;
}

Scenario distance_grid(const Scenario *scenario)
{
    Scenario fine = *scenario;
    const size_t count = scenario_sample_count(scenario) - 1;
    if (count < LEAST_SAMPLES) {
        fine.run.samples *= (LEAST_SAMPLES + count - 1) / count;
    }
    return fine;
}
