// Do mechanisms that the field knows move as it has published, and does the energy of springs,
// dampers and torques balance beside contacts? Runs in the source root.
#include "load_case.h"
#include "ode_error.h"

#include "kept.h"
#include "model/kinematics.h"

static const char ANDREWS[] = "cases/mechanisms/andrews.yaml";
static const char RUN_UP[] = "cases/mechanisms/run-up.yaml";

enum { ANGLES = 7 };

// beta, Theta, gamma, Phi, delta, Omega, epsilon at 30 ms. Published: F. Mazzia, C. Magherini, Test
// Set for Initial Value Problem Solvers, 2008; its digits are good to 1e-10. Tight: two other
// solutions, with the energy kept to 3e-15 J, which agree to 3e-13.
static const double PUBLISHED[ANGLES] = {
    15.81077119629904,  -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
    0.5244099658805304, 0.5347301163226948, 1.048080741042263,
};
static const double TIGHT[ANGLES] = {
    15.8107711951537, -15.7563710584118, 0.0408222401196,  -0.534730116342,
    0.52440996587995, 0.534730116342,    1.04808074104194,
};

static double andrews_error(const Trajectory *run, const double *truth)
{
    double k[ANGLES];
    for (size_t i = 0; i < ANGLES; i++) {
        k[i] = trajectory_motion(run, run->sample_count - 1, i)->angle;
    }
    const double angles[ANGLES] = {k[0], k[1] - k[0], k[2], k[3] - k[4], k[4], k[5] - k[6], k[6]};
    double largest = 0.0;
    for (size_t i = 0; i < ANGLES; i++) {
        largest = fmax(largest, fabs(angles[i] - truth[i]));
    }
    return largest;
}

static void andrews_mechanism_ends_where_it_is_published_to_end(void **state)
{
    (void)state;
    Scenario scenario = load_with(ANDREWS, "run.samples=30");
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(andrews_error(run, PUBLISHED) < 2e-9);
    assert_true(andrews_error(run, TIGHT) < 1e-11);
    trajectory_destroy(run);
    // the control: a spring that is a millionth stiffer
    scenario.linkage.springs[0].stiffness *= 1.0 + 1e-6;
    run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(andrews_error(run, TIGHT) > 1e-8);
    trajectory_destroy(run);
}

static double andrews_ode(OdeStepping stepping, double step_s)
{
    Scenario scenario = load_with(ANDREWS, "run.samples=30");
    scenario.ode.stepping = stepping;
    scenario.run.step = step_s;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const double error = andrews_error(run, TIGHT);
    trajectory_destroy(run);
    return error;
}

static void ode_approaches_andrews_mechanism_with_its_orders(void **state)
{
    (void)state;
    const double coarse = andrews_ode(ODE_STAGGERED, 1e-5);
    const double fine = andrews_ode(ODE_STAGGERED, 5e-6);
    assert_near(ode_order(coarse, fine, 2.0), 2.0, 0.1);
    const double high_coarse = andrews_ode(ODE_EXTRAPOLATED, 1e-5);
    const double high_fine = andrews_ode(ODE_EXTRAPOLATED, 5e-6);
    assert_true(ode_order(high_coarse, high_fine, 2.0) > 4.5);
    assert_true(high_fine < 1e-5);
}

// A four-bar with play, spring, dampers and a torque over time.
static void energy_balances_beside_contacts(void **state)
{
    (void)state;
    const char *const overrides[] = {"run.duration=20 ms", "run.samples=20"};
    const Scenario scenario = load(RUN_UP, overrides, 2);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const Energy *energy = &run->energy;
    assert_true(energy->drive_work > 1e-3);
    assert_true(fabs(energy->residual) < 1e-9 * energy->drive_work);
    // the control: without what the dampers took it is a million times more
    Scenario undamped = kept_copy(&scenario);
    undamped.linkage.torsions[0].damping = undamped.linkage.springs[0].damping = 0.0;
    Trajectory *other = complete_run(&undamped, BACKEND_REFERENCE);
    assert_true(energy->dissipated - other->energy.dissipated > 1e-3 * energy->drive_work);
    trajectory_destroy(other);
    trajectory_destroy(run);
}

// The same with ODE: the contacts within a step, the dampers as rows.
static void ode_keeps_its_order_beside_contacts(void **state)
{
    (void)state;
    const char *const overrides[] = {"run.duration=5 ms", "run.samples=50"};
    Scenario scenario = load(RUN_UP, overrides, 2);
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    const double coarse = ode_error_at(scenario, BACKEND_REFERENCE, 4e-6).max;
    const double fine = ode_error_at(scenario, BACKEND_REFERENCE, 1e-6).max;
    assert_near(ode_order(coarse, fine, 4.0), 2.0, 0.3);
    scenario.ode.map = ODE_MAP_MIDPOINT;
    assert_true(ode_error_at(scenario, BACKEND_REFERENCE, 5e-7).max < 1e-3);
}

// A damper that the drive's own body carries, so that its force is the drive's to overcome.
static void a_driven_body_pays_for_its_springs(void **state)
{
    (void)state;
    Scenario scenario = load_with(RUN_UP, "run.samples=60");
    Linkage *linkage = &scenario.linkage;
    Motion motions[KINEMATICS_BODY_MAX];
    Err err = {0};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        linkage->joints[i].kind = JOINT_REVOLUTE;
    }
    linkage->torque.table.count = 0;
    linkage->driver = (Driver){.is_present = true, .speed = 1000.0 * 2.0 * M_PI / 60.0};
    linkage_start(linkage, motions);
    assert_true(kinematics_solve(linkage, 0.0, motions, &err));
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i].start = motions[i];
    }
    scenario.run.revolutions = 1.0;
    Trajectory *reference = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(fabs(reference->energy.residual) < 1e-9 * reference->energy.drive_work);
    scenario.ode.stepping = ODE_EXTRAPOLATED;
    scenario.run.step = 2.5e-5;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    assert_close(ode->energy.drive_work, reference->energy.drive_work, 1e-5);
    assert_close(ode->energy.dissipated, reference->energy.dissipated, 1e-5);
    trajectory_destroy(ode);
    // the control: without springs the drive works less
    scenario.linkage.spring_count = scenario.linkage.torsion_count = 0;
    ode = complete_run(&scenario, BACKEND_ODE);
    assert_true(reference->energy.drive_work - ode->energy.drive_work > 0.1);
    trajectory_destroy(ode);
    trajectory_destroy(reference);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(andrews_mechanism_ends_where_it_is_published_to_end),
        cmocka_unit_test(ode_approaches_andrews_mechanism_with_its_orders),
        cmocka_unit_test(energy_balances_beside_contacts),
        cmocka_unit_test(ode_keeps_its_order_beside_contacts),
        cmocka_unit_test(a_driven_body_pays_for_its_springs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
