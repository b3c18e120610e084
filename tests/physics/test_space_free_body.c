// Does a free body with three different inertias turn as Euler's equations have it?
//
// In its own axes, I1 < I2 < I3, started about the first and third so that L^2 > 2 E I2 (Landau and
// Lifshitz, Mechanics, 37):
//     w1 = W1 cn(u, k), w2 = W2 sn(u, k), w3 = W3 dn(u, k),  u = rate t
//     rate^2 = (I3 - I2)(L^2 - 2 E I1) / (I1 I2 I3)
//     k^2 = (I2 - I1)(2 E I3 - L^2) / ((I3 - I2)(L^2 - 2 E I1))
// Jacobi's functions by the arithmetic-geometric mean (Abramowitz and Stegun 16.4).
#include "close.h"

#include "complete_run.h"
#include "mechanism.h"

static const double INERTIAS[3] = {1.0e-4, 1.7e-4, 2.3e-4}; // kg m^2
static const double MASS = 0.4;                             // kg
static const Vec3 SPIN = {30.0, 0.0, 40.0};                 // rad/s, at the start
static const Vec3 VELOCITY = {0.3, -0.2, 0.5};              // m/s

typedef struct Jacobi {
    double sn;
    double cn;
    double dn;
} Jacobi;

enum { MEANS = 8 };

static Jacobi jacobi(double u, double k, double *quarter)
{
    double a[MEANS + 1] = {1.0};
    double c[MEANS + 1] = {k};
    double b = sqrt(1.0 - k * k);
    for (int i = 0; i < MEANS; i++) {
        a[i + 1] = 0.5 * (a[i] + b);
        c[i + 1] = 0.5 * (a[i] - b);
        b = sqrt(a[i] * b);
    }
    *quarter = M_PI / (2.0 * a[MEANS]);
    double phi = ldexp(a[MEANS] * u, MEANS);
    for (int i = MEANS; i > 0; i--) {
        phi = 0.5 * (phi + asin(c[i] / a[i] * sin(phi)));
    }
    return (Jacobi){sin(phi), cos(phi), sqrt(1.0 - k * k * sin(phi) * sin(phi))};
}

// Angular velocity in the body's axes at a time, and the period of its motion.
static Vec3 euler(const double inertias[3], double time_s, double *period_s)
{
    const double i1 = inertias[0];
    const double i2 = inertias[1];
    const double i3 = inertias[2];
    const double twice = i1 * SPIN.x * SPIN.x + i3 * SPIN.z * SPIN.z;
    const double square = i1 * i1 * SPIN.x * SPIN.x + i3 * i3 * SPIN.z * SPIN.z;
    const double first = twice * i3 - square;
    const double third = square - twice * i1;
    const double rate = sqrt((i3 - i2) * third / (i1 * i2 * i3));
    double quarter = 0.0;
    const Jacobi at =
        jacobi(rate * time_s, sqrt((i2 - i1) * first / ((i3 - i2) * third)), &quarter);
    *period_s = 4.0 * quarter / rate;
    return (Vec3){
        sqrt(first / (i1 * (i3 - i1))) * at.cn,
        sqrt(first / (i2 * (i3 - i2))) * at.sn,
        sqrt(third / (i3 * (i3 - i1))) * at.dn,
    };
}

static Scenario free_body(void)
{
    Scenario scenario = mechanism_default();
    Linkage *linkage = &scenario.linkage;
    linkage->is_spatial = true;
    linkage->body_count = 1;
    Body *body = &linkage->bodies[0];
    body->mass = MASS;
    body->inertia = INERTIAS[2];
    body->space.inertia_x = INERTIAS[0];
    body->space.inertia_y = INERTIAS[1];
    body->start.velocity = (Vec2){VELOCITY.x, VELOCITY.y};
    body->space.velocity_z = VELOCITY.z;
    body->start.omega = SPIN.z;
    body->space.omega_x = SPIN.x;
    body->space.omega_y = SPIN.y;
    scenario.gravity = scenario_downward(0.0);
    double period_s = 0.0;
    euler(INERTIAS, 0.0, &period_s);
    scenario.run.duration = 5.0 * period_s;
    scenario.run.samples = 500;
    scenario.reference.tolerance = 1e-14;
    return scenario;
}

// The largest distance of the angular velocity in the body from Euler's with given inertias, of the
// largest.
static double euler_error(const Trajectory *run, const double inertias[3])
{
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const SpaceMotion *motion = trajectory_space_motion(run, k, 0);
        double unused = 0.0;
        const Vec3 truth = euler(inertias, run->times[k], &unused);
        const Vec3 own = quat_rotate_back(motion->turn, motion->omega);
        largest = fmax(largest, vec3_length(vec3_sub(own, truth)));
    }
    return largest / vec3_length(SPIN);
}

static void a_body_turns_as_jacobis_functions(void **state)
{
    (void)state;
    const Scenario scenario = free_body();
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(euler_error(run, INERTIAS) < 1e-11);
    // its angular velocity is that of the start after whole periods
    const SpaceMotion *last = trajectory_space_motion(run, run->sample_count - 1, 0);
    const Vec3 own = quat_rotate_back(last->turn, last->omega);
    assert_true(vec3_length(vec3_sub(own, SPIN)) < 1e-11 * vec3_length(SPIN));
    // control: the closed form of a body a millionth heavier about its second axis
    const double other[3] = {INERTIAS[0], 1.000001 * INERTIAS[1], INERTIAS[2]};
    assert_true(euler_error(run, other) > 1e-7);
    trajectory_destroy(run);
}

static void energy_and_angular_momentum_are_kept_in_the_world(void **state)
{
    (void)state;
    const Scenario scenario = free_body();
    const Linkage *linkage = &scenario.linkage;
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const Vec3 momentum = {INERTIAS[0] * SPIN.x, INERTIAS[1] * SPIN.y, INERTIAS[2] * SPIN.z};
    const double energy = space_kinetic_energy(linkage, trajectory_space_motion(run, 0, 0));
    double turned = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const SpaceMotion *motion = trajectory_space_motion(run, k, 0);
        const Mat3 inertia = space_world_inertia(&linkage->bodies[0], motion->turn);
        const Vec3 now = mat3_apply(&inertia, motion->omega);
        assert_true(vec3_length(vec3_sub(now, momentum)) < 1e-11 * vec3_length(momentum));
        assert_close(space_kinetic_energy(linkage, motion), energy, 1e-11);
        const Vec3 straight = vec3_scale(run->times[k], VELOCITY);
        assert_true(vec3_length(vec3_sub(motion->position, straight)) < 1e-13);
        turned = fmax(turned, vec3_length(vec3_sub(motion->omega, SPIN)));
    }
    // control: neither is kept by an angular velocity that stays as it is
    assert_true(turned > 0.1 * vec3_length(SPIN));
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_body_turns_as_jacobis_functions),
        cmocka_unit_test(energy_and_angular_momentum_are_kept_in_the_world),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
