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

DistanceMeasure distance_measure(const Trajectory *reference, size_t body);

// A body's omega or velocity at a sample, and its alpha or acceleration: as vectors, in the plane
// of omega (omega, 0, 0), of velocity (x, y, omega reach).
Vec3 distance_rate(const Trajectory *trajectory, size_t sample, size_t body,
                   DistanceMeasure measure);
Vec3 distance_change(const Trajectory *trajectory, size_t sample, size_t body,
                     DistanceMeasure measure);

// The rate of a body in a sample that no trajectory holds.
Vec3 distance_sample_rate(const Sample *sample, bool is_spatial, size_t body,
                          DistanceMeasure measure);

// How far apart two of these are.
double distance_between(Vec3 a, Vec3 b);

// The largest relative distance of any body at one sample.
double distance_at(const Trajectory *trajectory, const Trajectory *reference, size_t sample,
                   const DistanceScale *scales);
