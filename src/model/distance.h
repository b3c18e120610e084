// How far two trajectories of one scenario are apart, in omega and alpha relative to each body's
// largest; where no drive turns anything, in the velocities and accelerations of the centres, and
// of bodies that slide or stop in those of their points.
#pragma once

#include "model/trajectory.h"

// A trajectory is predictable up to where the fastest of all perturbations of so small a size has
// grown so many times: past it two solutions that are right to the first number have only five
// digits in common.
static const double DISTANCE_PERTURBATION = 1e-10;
static const double DISTANCE_GROWTH = 1e5;

// The scenario with samples fine enough to compare on, its own among them.
Scenario distance_grid(const Scenario *scenario);

// How fast a body moves: its largest rates over a trajectory, all above 0 but where noted.
typedef struct DistanceScale {
    double omega;     // rad/s, or m/s: what distances are measured in; 0 for the driven body, which
                      // does not count
    double alpha;     // rad/s^2, or m/s^2; likewise
    double moving;    // m/s, of the body's fastest point
    double turning;   // rad/s, with which its furthest joint moves that fast
    bool by_velocity; // whether omega and alpha above are those of velocities
    double changing;  // m/s^2, acceleration of the body's fastest point; 0 where there is none
} DistanceScale;

void distance_scales(const Trajectory *reference, DistanceScale *scales);

// What the distance of a body is measured by.
typedef struct DistanceMeasure {
    bool by_velocity; // of the centre, in place of omega
    double reach;     // m: omega at this reach counts beside the velocity; 0: it does not
} DistanceMeasure;

static inline DistanceMeasure distance_measure(const Trajectory *reference, size_t body)
{
    return (DistanceMeasure){
        .by_velocity = reference->driven_body == LINKAGE_GROUND || reference->slides[body],
        .reach = reference->slides[body] ? reference->reach[body] : 0.0,
    };
}

// A rate of the centre with that of turning at some reach.
static inline Vec3 distance_planar(Vec2 moving, double turning, DistanceMeasure measure)
{
    const double at_reach = measure.reach > 0.0 ? measure.reach * turning : 0.0;
    return measure.by_velocity ? (Vec3){moving.x, moving.y, at_reach} : (Vec3){turning, 0.0, 0.0};
}

// A body's omega or velocity at a sample, and its alpha or acceleration: as vectors, in the plane
// of omega (omega, 0, 0), of velocity (x, y, omega reach).
static inline Vec3 distance_rate(const Trajectory *trajectory, size_t sample, size_t body,
                                 DistanceMeasure measure)
{
    if (trajectory->space_motions == NULL) {
        const Motion *planar = trajectory_motion(trajectory, sample, body);
        return distance_planar(planar->velocity, planar->omega, measure);
    }
    const SpaceMotion *motion = trajectory_space_motion(trajectory, sample, body);
    return measure.by_velocity ? motion->velocity : motion->omega;
}

static inline Vec3 distance_change(const Trajectory *trajectory, size_t sample, size_t body,
                                   DistanceMeasure measure)
{
    if (trajectory->space_motions == NULL) {
        const Motion *motion = trajectory_motion(trajectory, sample, body);
        return distance_planar(motion->acceleration, motion->alpha, measure);
    }
    const SpaceMotion *motion = trajectory_space_motion(trajectory, sample, body);
    return measure.by_velocity ? motion->acceleration : motion->alpha;
}

// The rate of a body in a sample that no trajectory holds.
static inline Vec3 distance_sample_rate(const Sample *sample, bool is_spatial, size_t body,
                                        DistanceMeasure measure)
{
    if (!is_spatial) {
        return distance_planar(sample->bodies[body].velocity, sample->bodies[body].omega, measure);
    }
    const SpaceMotion *motion = &sample->space_bodies[body];
    return measure.by_velocity ? motion->velocity : motion->omega;
}

// How large a vector is, and how far apart two of these are.
static inline double distance_size(Vec2 v)
{
    return v.y == 0.0 ? fabs(v.x) : (v.x == 0.0 ? fabs(v.y) : hypot(v.x, v.y));
}

static inline double distance_between(Vec3 a, Vec3 b)
{
    const Vec3 apart = vec3_sub(a, b);
    // of turning in the plane, and of moving
    const double across = distance_size((Vec2){apart.x, apart.y});
    return apart.z == 0.0 ? across : hypot(across, apart.z);
}

// The largest relative distance of any body at one sample.
double distance_at(const Trajectory *trajectory, const Trajectory *reference, size_t sample,
                   const DistanceScale *scales);
