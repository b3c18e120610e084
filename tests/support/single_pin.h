// The pin of one_impact.h flying along x against the wall, by itself, for kernel/kernel.h.
#pragma once

#include "close.h"
#include "one_impact.h"

#include "contact/damping.h"
#include "kernel/kernel.h"

static const double LONE_PIN_GAP = 1e-5;   // m, to the wall at the start: 20 us of flight
static const double LONE_PIN_PHASE = 0.05; // rad, the program's default

// F = K d^1.5 (1 + chi d'/v0).
static inline ForceLaw single_pin_hertz(double chi)
{
    ForceLaw law = force_law_power(ONE_IMPACT_HERTZ, 1.5);
    law.hysteresis = chi;
    return law;
}

static inline Kernel single_pin(ForceLaw law, double phase)
{
    Kernel kernel = kernel_start(phase);
    const KernelContact joint = {
        .law = law,
        .radial_clearance = ONE_IMPACT_CLEARANCE,
        .hole_radius = ONE_IMPACT_CLEARANCE + 5e-3,
    };
    kernel_add(&kernel, &joint, KERNEL_ROWS_PLAIN);
    kernel_make_room(&kernel, kernel.row_count);
    kernel.mobility[0] = kernel.mobility[3] = 1.0 / ONE_IMPACT_MASS;
    kernel.position[0] = ONE_IMPACT_CLEARANCE - LONE_PIN_GAP;
    kernel.speed[0] = ONE_IMPACT_SPEED;
    return kernel;
}

// The undamped impact's closed forms: depth, m, and duration, s, 2.943275 d / v.
static inline double single_pin_depth(void)
{
    return pow(5.0 * ONE_IMPACT_MASS * ONE_IMPACT_SPEED * ONE_IMPACT_SPEED /
                   (4.0 * ONE_IMPACT_HERTZ),
               0.4);
}

static inline double single_pin_duration(void)
{
    return 2.0 * sqrt(acos(-1.0)) * tgamma(1.4) / tgamma(0.9) * single_pin_depth() /
           ONE_IMPACT_SPEED;
}

enum { LONE_PIN_ROWS = 9 };

// A kernel's sums at a time, by themselves.
typedef struct PinSums {
    double impulse[LONE_PIN_ROWS];    // N s
    double moment[2 * LONE_PIN_ROWS]; // N s^2, then N s^3
    double force[LONE_PIN_ROWS];      // N
    double dissipated;                // J
    double friction;                  // J
} PinSums;

static inline void pin_sums_at(const Kernel *kernel, size_t node, double time_s, PinSums *sums)
{
    KernelSums found = {.impulse = sums->impulse, .moment = sums->moment, .force = sums->force};
    assert_true(kernel_rows(kernel) <= LONE_PIN_ROWS);
    kernel_at(kernel, node, time_s, &found);
    sums->dissipated = found.dissipated;
    sums->friction = found.friction;
}

// How a joint is then.
static inline KernelPose pin_pose_at(const Kernel *kernel, size_t joint, size_t node, double time_s)
{
    PinSums sums;
    pin_sums_at(kernel, node, time_s, &sums);
    const KernelSums at = {.impulse = sums.impulse, .moment = sums.moment, .force = sums.force};
    return kernel_pose(kernel, joint, node, time_s, &at);
}

// The sums at the end of what has run, and a row's speed there.
static inline PinSums single_pin_end(const Kernel *kernel)
{
    PinSums sums;
    const size_t last = kernel->node_count - 1;
    pin_sums_at(kernel, last, kernel->times[last], &sums);
    return sums;
}

static inline double single_pin_speed_after(const Kernel *kernel)
{
    return ONE_IMPACT_SPEED + single_pin_end(kernel).impulse[0] / ONE_IMPACT_MASS;
}
