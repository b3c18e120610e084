// A mass bounces on a wall: the contact kernel by itself. Prints TAP. On F = K d^n without damping
// a mass m leaves at the speed v that it came with; by Johnson, Contact Mechanics (1985), 11.4,
//     F = K d^n at most, d = (m v^2 / (2 p K))^p, p = 1/(n + 1);  of n = 1 F = sqrt(K m) v, N
//     T = 2 d / v sqrt(pi) Gamma(1 + p) / Gamma(1/2 + p);  of n = 1 T = pi sqrt(m / K), s
#include "jointplay_kernel.h"

#include <stdio.h>

static const double MASS = 0.5, SPEED = 0.3, GAP = 1e-5; // kg, m/s, m
static const double STEP = 1e-3;                         // s: flight, the impact, and flight again
static const double PHASE = 0.03;     // rad: of the contact's oscillation in a local step
static const double TOLERANCE = 1e-6; // relative: a local step of that phase misses by 4e-7

// What comes of it over what should, less 1: peak force, duration and speed, for a stiffness.
static void bounce(double stiffness, double exponent, double truth, double off[3])
{
    const double p = 1.0 / (exponent + 1.0);
    const double depth = pow(0.5 * MASS * SPEED * SPEED / (p * truth), p);
    KernelContact wall = {.law = force_law_power(stiffness, exponent), .shape = KERNEL_LINE};
    Kernel kernel = kernel_start(PHASE);
    kernel_add(&kernel, &wall, KERNEL_ROWS_PLAIN);
    kernel_make_room(&kernel, kernel_rows(&kernel));
    *kernel_mobility(&kernel, 0, 0) = *kernel_mobility(&kernel, 1, 1) = 1.0 / MASS;
    kernel.position[0] = GAP;
    kernel.speed[0] = -SPEED;
    double peak = kernel_run(&kernel, STEP) ? 0.0 : NAN, duration = 0.0;
    KernelSums sums = kernel_sums(kernel_rows(&kernel));
    for (size_t node = 0; node + 1 < kernel.node_count; node++) {
        const double start = kernel.times[node], width = kernel.times[node + 1] - start;
        duration += kernel_touches(&kernel, node, 0) ? width : 0.0;
        for (int part = 0; part < 256; part++) {
            kernel_at(&kernel, node, start + part / 256.0 * width, &sums);
            peak = sums.force[0] > peak ? sums.force[0] : peak;
        }
    }
    kernel_at(&kernel, kernel.node_count - 1, STEP, &sums);
    off[0] = fabs(peak / (truth * pow(depth, exponent)) - 1.0);
    const double ratio = 2.0 * sqrt(acos(-1.0)) * tgamma(1.0 + p) / tgamma(0.5 + p);
    off[1] = fabs(duration * SPEED / (ratio * depth) - 1.0);
    off[2] = fabs((sums.impulse[0] / MASS - SPEED) / SPEED - 1.0);
    kernel_sums_free(&sums);
    kernel_finish(&kernel);
}

int main(void)
{
    static const double STIFFNESSES[] = {1e8, 5e9}, EXPONENTS[] = {1.0, 1.5}; // N/m^exponent, 1
    bool is_right = puts("1..2") > 0;
    for (int i = 0; i < 2; i++) { // the second bounce is a control
        double off[3], other[3];
        bounce(STIFFNESSES[i], EXPONENTS[i], STIFFNESSES[i], off);
        bounce(1.001 * STIFFNESSES[i], EXPONENTS[i], STIFFNESSES[i], other);
        const bool holds =
            fmax(fmax(off[0], off[1]), off[2]) < TOLERANCE && fmin(other[0], other[1]) > TOLERANCE;
        printf("%s %d - n = %g: off by %.1e, %.1e, %.1e\n", holds ? "ok" : "not ok", i + 1,
               EXPONENTS[i], off[0], off[1], off[2]);
        is_right = is_right && holds;
    }
    return is_right ? 0 : 1;
}
