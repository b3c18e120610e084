// A mass bounces on a wall: the contact kernel by itself, without the program, the library or ODE.
// Prints TAP.
//
// An undamped Hertz impact, m x'' = -K x^1.5 at a closing speed v, in closed form:
//     depth d = (5 m v^2 / (4 K))^(2/5)
//     duration T = 2 sqrt(pi) Gamma(7/5) / Gamma(9/10) d / v = 2.943275 d / v
// K. L. Johnson, Contact Mechanics (1985), 11.4. The mass leaves with the speed it came with.
#include "kernel/kernel.h"

#include <stdio.h>

static const double MASS = 0.5;       // kg
static const double STIFFNESS = 5e9;  // N/m^1.5
static const double SPEED = 0.3;      // m/s
static const double GAP = 1e-5;       // m, at the start
static const double STEP = 1e-3;      // s: some 30 us of flight, the impact, and flight again
static const double PHASE = 0.05;     // rad: of the contact's oscillation in a local step
static const double TOLERANCE = 1e-6; // relative: a local step of that phase misses by 3e-8
static const double OTHER = 1.001;    // a stiffness that is off by so much must be seen

typedef struct Bounce {
    double depth;    // m
    double duration; // s
    double speed;    // m/s, away from the wall
} Bounce;

static Bounce bounce(double stiffness)
{
    const KernelContact wall = {.law = force_law_power(stiffness, 1.5), .shape = KERNEL_LINE};
    Kernel kernel = kernel_start(PHASE);
    kernel_add(&kernel, &wall, KERNEL_ROWS_PLAIN);
    kernel_make_room(&kernel, kernel_rows(&kernel));
    *kernel_mobility(&kernel, 0, 0) = *kernel_mobility(&kernel, 1, 1) = 1.0 / MASS;
    kernel.position[0] = GAP;
    kernel.speed[0] = -SPEED;
    Bounce found = {.depth = 0.0};
    KernelSums sums = kernel_sums(kernel_rows(&kernel));
    const bool is_done = kernel_run(&kernel, STEP);
    for (size_t node = 0; is_done && node + 1 < kernel.node_count; node++) {
        if (kernel_touches(&kernel, node, 0)) {
            found.duration += kernel.times[node + 1] - kernel.times[node];
            for (int part = 0; part < 64; part++) { // the depth is stationary at its largest
                const double width = kernel.times[node + 1] - kernel.times[node];
                const double time = kernel.times[node] + part / 64.0 * width;
                kernel_at(&kernel, node, time, &sums);
                found.depth =
                    fmax(found.depth, kernel_pose(&kernel, 0, node, time, &sums).pose.penetration);
            }
        }
    }
    kernel_at(&kernel, kernel.node_count - 1, STEP, &sums);
    found.speed = is_done ? sums.impulse[0] / MASS - SPEED : NAN;
    kernel_sums_free(&sums);
    kernel_finish(&kernel);
    return found;
}

static bool report(int number, const char *claim, bool holds)
{
    printf("%s %d - %s\n", holds ? "ok" : "not ok", number, claim);
    return holds;
}

static double off_by(double value, double truth)
{
    return fabs(value / truth - 1.0);
}

int main(void)
{
    const double depth = pow(1.25 * MASS * SPEED * SPEED / STIFFNESS, 0.4);
    const double duration = 2.0 * sqrt(acos(-1.0)) * tgamma(1.4) / tgamma(0.9) * depth / SPEED;
    const Bounce right = bounce(STIFFNESS);
    const Bounce wrong = bounce(OTHER * STIFFNESS);
    printf("# off by: depth %.1e, duration %.1e, speed %.1e; of the control: %.1e, %.1e\n",
           off_by(right.depth, depth), off_by(right.duration, duration), off_by(right.speed, SPEED),
           off_by(wrong.depth, depth), off_by(wrong.duration, duration));
    printf("1..4\n");
    bool holds =
        report(1, "the depth of an impact is Hertz's", off_by(right.depth, depth) < TOLERANCE);
    holds &= report(2, "its duration is Hertz's", off_by(right.duration, duration) < TOLERANCE);
    holds &=
        report(3, "the mass leaves as fast as it came", off_by(right.speed, SPEED) < TOLERANCE);
    holds &= report(4, "another stiffness is seen in both",
                    off_by(wrong.depth, depth) > TOLERANCE &&
                        off_by(wrong.duration, duration) > TOLERANCE);
    return holds ? 0 : 1;
}
