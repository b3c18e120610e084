// How far two trajectories of one scenario are apart: the largest difference of any of the rates
// below, each relative to its own largest value in the reference.
//
//     of every body              its angular velocity (a vector), the velocity of its centre (a
//     vector) of every joint with play   the velocity of the pin relative to its hole, or of what
//     is limited of pins in space, guides   the rate at which the pin tilts in its hole, the block
//     in its guides
#pragma once

#include "model/trajectory.h"

// A trajectory is predictable up to where the fastest of all perturbations of so small a size has
// grown so many times: past it two solutions that are right to the first number have only five
// digits in common.
static const double DISTANCE_PERTURBATION = 1e-10;
static const double DISTANCE_GROWTH = 1e5;

// The least a rate is measured in, of the speed of the fastest point of all bodies (of an angular
// rate: of that over the body's reach). A rate smaller than that is mostly rounding: the turning of
// what only translates, the centre of a balanced rotor. Where no point is that fast it is the floor
// of a mechanism at rest.
static const double DISTANCE_FLOOR = 1e-6;

// The scenario with samples fine enough to compare on, its own among them.
Scenario distance_grid(const Scenario *scenario);

typedef enum DistanceKind {
    DISTANCE_TURNING, // angular velocity of a body, rad/s
    DISTANCE_MOVING,  // velocity of a body's centre of mass, m/s
    DISTANCE_PLAY,    // velocity of a pin's middle relative to the hole (of a block to its guides,
                      // of a disc to its stop), m/s; of a limited coordinate its rate, m/s or rad/s
    DISTANCE_TILT,    // tilt rate of a block in its guides or of a pin in space in its hole, rad/s
} DistanceKind;

// One rate by which motions are compared.
typedef struct DistanceRate {
    DistanceKind kind;
    int number;     // of the body or joint
    double reach;   // m, of the body: its furthest point, where the rate is angular; else 0
    double largest; // rad/s or m/s, in the reference
    double scale;   // rad/s or m/s, in which it is measured: the largest value or the floor
} DistanceRate;

// Whether a rate is measured in the floor, because its own values are smaller.
static inline bool distance_is_floor(const DistanceRate *rate)
{
    return rate->scale > rate->largest;
}

// All rates of a linkage, those of bodies first, two a body.
typedef struct DistanceMeasure {
    const Linkage *linkage; // of the reference, which must live as long
    size_t count;
    DistanceRate *rates; // owned
} DistanceMeasure;

// The rates of a linkage without scales: largest and scale are 0. For distance_finish.
DistanceMeasure distance_rates(const Linkage *linkage);

// The rates with their scales, those of the reference at its samples. For distance_finish.
DistanceMeasure distance_measure(const Trajectory *reference);
void distance_finish(DistanceMeasure *measure);

// How the bodies of a linkage move at one instant: in the plane, or in space (the other is NULL).
typedef struct DistanceMotion {
    const Motion *planar;
    const SpaceMotion *spatial;
} DistanceMotion;

static inline DistanceMotion distance_motion_at(const Trajectory *trajectory, size_t sample)
{
    return (DistanceMotion){
        trajectory_motion(trajectory, sample, 0),
        trajectory->space_motions != NULL ? trajectory_space_motion(trajectory, sample, 0) : NULL};
}

static inline DistanceMotion distance_motion_of(const Sample *sample)
{
    return (DistanceMotion){sample->bodies, sample->space_bodies};
}

// The value of a rate, in the world's axes; of a scalar x alone. Linear in the bodies' velocities.
Vec3 distance_value(const Linkage *linkage, const DistanceRate *rate, DistanceMotion motion);

// How many numbers of a value there are: 1, 2 or 3.
int distance_components(const Linkage *linkage, const DistanceRate *rate);

// The difference of two values over the rate's scale.
double distance_between(const DistanceRate *rate, Vec3 a, Vec3 b);

// The largest relative distance of any rate between two motions of the linkage. *which, where it is
// not NULL, is then the number of that rate. NAN where one of them is not finite.
double distance_apart(const DistanceMeasure *measure, DistanceMotion a, DistanceMotion b,
                      size_t *which);

// What a rate is called: "omega of coupler", "velocity of coupler", "pin velocity in
// crank-coupler", "tilt rate in guide".
enum { DISTANCE_NAME_SIZE = LINKAGE_NAME_SIZE + 32 };
void distance_name(const Linkage *linkage, const DistanceRate *rate, char name[DISTANCE_NAME_SIZE]);
