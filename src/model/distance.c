// How far are two motions of one linkage apart, in numbers that mean the same for all bodies?
//
//     d(t) = max over bodies |omega_b(t) - ref_b(t)| / max over t |ref_b|
// over every body whose speed is not prescribed. A body that hardly turns is measured by the omega
// with which its furthest joint would move at a thousandth of the speed of the fastest point of the
// linkage: its own would be rounding. Sizes are those of the body itself, so that a pivot far away
// changes nothing. Where no drive turns anything, bodies may not turn at all: the speeds of their
// centres then take the place of omega, and their accelerations that of alpha. How a body turns
// that slides on another, or stops at it, does not say how it moves: it is measured by the velocity
// (x, y, omega reach) of its points.
#include "model/distance.h"

enum { LEAST_SAMPLES = 1000 }; // fewer steps of a horizon would say little

static const double SMALLEST_SCALE =
    1e-3; // of the fastest point's: below it lies no motion to speak of

// How large the rates of a body are at a sample: of its centre, and of its turning.
typedef struct Sizes {
    double moving;
    double turning;
    double changing;
    double speeding;
} Sizes;

static inline Sizes sizes_at(const Trajectory *reference, size_t sample, size_t body)
{
    if (reference->space_motions == NULL) {
        const Motion *motion = trajectory_motion(reference, sample, body);
        return (Sizes){distance_size(motion->velocity), fabs(motion->omega),
                       distance_size(motion->acceleration), fabs(motion->alpha)};
    }
    const Vec3 still = {0.0, 0.0, 0.0};
    const SpaceMotion *motion = trajectory_space_motion(reference, sample, body);
    return (Sizes){
        distance_between(motion->velocity, still),
        distance_between(motion->omega, still),
        distance_between(motion->acceleration, still),
        distance_between(motion->alpha, still),
    };
}

static inline double raised(double largest, double value)
{
    return value > largest ? value : largest;
}

// The largest rates of one body. A point of it moves with |v| + |omega| reach at most.
static DistanceScale body_scale(const Trajectory *reference, size_t body)
{
    const Vec3 still = {0.0, 0.0, 0.0};
    const DistanceMeasure own = distance_measure(reference, body);
    const double reach = reference->reach[body];
    DistanceScale scale = {.by_velocity = own.by_velocity};
    for (size_t k = 0; k < reference->sample_count; k++) {
        const Sizes at = sizes_at(reference, k, body);
        double rate = own.by_velocity ? at.moving : at.turning;
        double change = own.by_velocity ? at.changing : at.speeding;
        if (own.reach > 0.0) {
            rate = distance_between(distance_rate(reference, k, body, own), still);
            change = distance_between(distance_change(reference, k, body, own), still);
        }
        scale.omega = raised(scale.omega, rate);
        scale.alpha = raised(scale.alpha, change);
        scale.moving = raised(scale.moving, at.moving + at.turning * reach);
        scale.changing = raised(scale.changing, at.changing + at.speeding * reach);
    }
    return scale;
}

// A share of a rate of the fastest point of all, as a rate of one body; 1 where nothing moves.
static double least_rate(double fastest, double reach, bool is_velocity)
{
    return fastest > 0.0 ? SMALLEST_SCALE * fastest / (is_velocity ? 1.0 : reach) : 1.0;
}

void distance_scales(const Trajectory *reference, DistanceScale *scales)
{
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
        scale->omega = fmax(scale->omega, least_rate(moving, reach, scale->by_velocity));
        scale->alpha = fmax(scale->alpha, least_rate(changing, reach, scale->by_velocity));
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
    double largest = 0.0;
    for (size_t i = 0; i < reference->body_count; i++) {
        if (scales[i].omega > 0.0) {
            const DistanceMeasure measure = distance_measure(reference, i);
            const double apart = distance_between(distance_rate(trajectory, sample, i, measure),
                                                  distance_rate(reference, sample, i, measure));
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
