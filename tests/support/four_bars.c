// Where are N four-bars in a row after some time?
#include "four_bars.h"

#include <math.h>
#include <stdio.h>

static const double GRAVITY = 9.81;  // m/s^2
static const double LENGTH = 1.0;    // m, of every link
static const double RK4_STEP = 1e-4; // s

static void add_link(Linkage *linkage, const char *kind, Vec2 at, double angle, double omega,
                     double speed)
{
    Body *body = &linkage->bodies[linkage->body_count];
    *body = (Body){.mass = 1.0, .inertia = LENGTH * LENGTH / 12.0};
    snprintf(body->name, sizeof body->name, "%s-%zu", kind, linkage->body_count++);
    body->start =
        (Motion){.position = at, .angle = angle, .velocity = {speed, 0.0}, .omega = omega};
}

static void add_link_joint(Linkage *linkage, int a, double along_a, int b, double along_b)
{
    Joint *joint = &linkage->joints[linkage->joint_count];
    *joint =
        (Joint){.body_a = a, .body_b = b, .anchor_a = {along_a, 0.0}, .anchor_b = {along_b, 0.0}};
    snprintf(joint->name, sizeof joint->name, "joint-%zu", linkage->joint_count++);
}

void four_bars_fill(Scenario *scenario, size_t count, double duration_s)
{
    Linkage *linkage = &scenario->linkage;
    const double half = 0.5 * LENGTH;
    for (size_t i = 0; i <= count; i++) {
        const double x = LENGTH * (double)i;
        const int upright = (int)(2 * i);
        add_link(linkage, "upright", (Vec2){x, half}, 0.5 * M_PI, -1.0, half);
        if (i < count) {
            add_link(linkage, "coupler", (Vec2){x + half, LENGTH}, 0.0, 0.0, LENGTH);
        }
        add_link_joint(linkage, LINKAGE_GROUND, x, upright, -half);
        if (i > 0) {
            add_link_joint(linkage, upright - 1, half, upright, half);
        }
        if (i < count) {
            add_link_joint(linkage, upright, half, upright + 1, -half);
        }
    }
    scenario->gravity = scenario_downward(GRAVITY);
    scenario->run.duration = duration_s;
    scenario->run.samples = 100;
}

// The classical Runge-Kutta method.
FourBarsAngle four_bars_angle(size_t count, double time_s)
{
    const double n = (double)count;
    const double k = GRAVITY * 3.0 * (3.0 * n + 1.0) / (2.0 * (4.0 * n + 1.0));
    const long steps = lround(time_s / RK4_STEP);
    const double h = time_s / (double)steps;
    double x = 0.0;
    double v = 1.0;
    for (long i = 0; i < steps; i++) {
        const double a1 = k * sin(x);
        const double a2 = k * sin(x + 0.5 * h * v);
        const double a3 = k * sin(x + 0.5 * h * (v + 0.5 * h * a1));
        const double a4 = k * sin(x + h * (v + 0.5 * h * a2));
        x += h * (v + h / 6.0 * (a1 + a2 + a3));
        v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    return (FourBarsAngle){x, v};
}

double four_bars_error(const Trajectory *run, double theta)
{
    double largest = 0.0;
    for (size_t i = 0; i < run->body_count; i += 2) {
        const double angle = trajectory_motion(run, run->sample_count - 1, i)->angle;
        largest = fmax(largest, hypot(cos(angle) - sin(theta), sin(angle) - cos(theta)));
    }
    return LENGTH * largest;
}

double four_bars_spread(const Trajectory *run)
{
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const double first = trajectory_motion(run, k, 0)->angle;
        for (size_t i = 2; i < run->body_count; i += 2) {
            largest = fmax(largest, fabs(trajectory_motion(run, k, i)->angle - first));
        }
    }
    return largest;
}
