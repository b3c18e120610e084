// Does a mechanism whose play goes to zero move as with ideal joints, and how fast does it get
// there?
//
// A pin stays within its play c of the ideal position, so the angles of the bodies differ by some
// c / length: order 1. It flies through c in a time of about sqrt(c / a), a the relative
// acceleration, and so arrives with about sqrt(c a): the angular velocities differ by order 1/2.
#include "load_case.h"

#include "measure/error.h"
#include "run/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdio.h>

static const RunWatch NOBODY = {NULL, NULL};

// The closed form, which takes every joint as ideal, against the reference, which does not. The
// contact is stiff: its depth, some 30 nm, is small beside the play.
static TrajectoryError ideal_against(double play_m)
{
    char play[96];
    snprintf(play, sizeof play, "joints.crank-coupler.radial-clearance=%.17g m", play_m);
    const char *settings[] = {play, "contact.stiffness=1e14 N/m^1.5", "run.revolutions=0.2"};
    const Scenario scenario = load("cases/paper/impact-k66.yaml", settings, 3);
    Trajectory *ideal = run_scenario(&scenario, registry_solver(BACKEND_ANALYTIC), NOBODY);
    Trajectory *real = run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
    assert_true(ideal->is_complete && real->is_complete);
    const TrajectoryError error = error_against(ideal, real, INFINITY);
    assert_true(error.is_known);
    trajectory_destroy(real);
    trajectory_destroy(ideal);
    return error;
}

static void angles_converge_with_the_play_and_speeds_with_its_root(void **state)
{
    (void)state;
    TrajectoryError before = ideal_against(1e-3);
    for (double play = 1e-4; play > 0.5e-5; play *= 0.1) {
        const TrajectoryError error = ideal_against(play);
        const double angles = log10(before.angle_max_rad / error.angle_max_rad);
        const double speeds = log10(before.omega_max / error.omega_max);
        assert_near(angles, 1.0, 0.05);
        // the largest speed depends on which impact it follows; the control: its order is not 1
        assert_near(speeds, 0.5, 0.15);
        before = error;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_converge_with_the_play_and_speeds_with_its_root),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
