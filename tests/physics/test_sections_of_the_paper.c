// Does a section tell a solver's own motion from the mechanism's?
//
// The paper's crank-rocker with a play of 50 um and contacts that never forget their impact has a
// motion in which the follower turns with -78.686 rad/s at a crank angle of 0. That is the
// reference's at two tolerances a decade apart, so that none of its own errors makes it. ODE as its
// manual has it, at 10 us, settles at -77.890 rad/s, where no start of the reference does: the
// step's doing. The control is ODE at the same step with the contacts integrated within it, which
// stays where the reference is.
#include "load_case.h"

#include "measure/section.h"
#include "run/registry.h"
#include "run/run.h"
#include "run/settle.h"

enum { FOLLOWER = 2 };

static const char *const CASE = "cases/paper/impact-k66.yaml";
static const double KNOWN = -78.686;   // rad/s
static const double NEARNESS = 3e-3;   // rad/s: it alternates by 2.5e-3 every revolution
static const double TEXTBOOK = -77.89; // rad/s, of ODE at 10 us

static Scenario settled_at(const char *tolerance)
{
    const char *const settings[] = {"joints.crank-coupler.radial-clearance=50 um",
                                    "contact.resting-speed=none",
                                    "run.samples=36",
                                    "run.settle-starts=6",
                                    "run.start=settled",
                                    "run.step=10 us",
                                    "ode.map=impulse",
                                    "ode.stepping=staggered",
                                    tolerance};
    Scenario scenario = load(CASE, settings, 9);
    scenario.run.settle_budget = 1000.0; // s: a build with sanitizers takes longer
    settle_scenario(&scenario, (RunWatch){.progress = NULL});
    kept_settled(&scenario);
    assert_true(scenario.settled.motion_count > 0);
    return scenario;
}

// How near the follower's angular velocity in any section of any settled motion comes to a value.
static double nearest_to(const Scenario *scenario, double omega)
{
    double nearest = INFINITY;
    for (size_t m = 0; m < scenario->settled.motion_count; m++) {
        const SettledMotion *motion = &scenario->settled.motions[m];
        for (size_t k = 0; k < motion->section_count; k++) {
            const double found = motion->sections[k * scenario->linkage.body_count + FOLLOWER];
            nearest = fmin(nearest, fabs(found - omega));
        }
    }
    return nearest;
}

static void the_reference_settles_there_at_two_tolerances(void **state)
{
    (void)state;
    static const char *const TOLERANCES[] = {"reference.tolerance=1e-10",
                                             "reference.tolerance=1e-9"};
    for (int i = 0; i < 2; i++) {
        const Scenario scenario = settled_at(TOLERANCES[i]);
        assert_true(nearest_to(&scenario, KNOWN) <= NEARNESS);
        assert_true(nearest_to(&scenario, TEXTBOOK) > 10.0 * NEARNESS);
    }
}

static double ode_section(const Scenario *scenario, double revolutions, Sections *sections)
{
    Scenario longer = *scenario;
    longer.run.revolutions = revolutions;
    Trajectory *run =
        run_scenario(&longer, registry_solver(BACKEND_ODE), (RunWatch){.progress = NULL});
    assert_true(run->is_complete);
    *sections = section_find(run);
    const double omega = section_omega(run, FOLLOWER, 0);
    trajectory_destroy(run);
    return omega;
}

static void the_textbooks_step_settles_elsewhere(void **state)
{
    (void)state;
    const char *const settings[] = {"joints.crank-coupler.radial-clearance=50 um",
                                    "contact.resting-speed=none",
                                    "run.samples=36",
                                    "run.start=centred",
                                    "run.step=10 us",
                                    "ode.map=textbook",
                                    "ode.stepping=plain"};
    const Scenario scenario = load(CASE, settings, 7);
    Sections sections;
    assert_near(ode_section(&scenario, 60.0, &sections), TEXTBOOK, NEARNESS);
    assert_int_equal(sections.period, 1);
}

// The control: ODE with its contacts integrated within a step as long stays in the motion that it
// starts in.
static void an_exact_contact_at_that_step_stays(void **state)
{
    (void)state;
    const Scenario scenario = settled_at("reference.tolerance=1e-10");
    const SettledMotion *motion = &scenario.settled.motions[0];
    const double start = motion->sections[(motion->section_count - 1) * 3 + FOLLOWER];
    Sections sections;
    assert_near(ode_section(&scenario, 2.0, &sections), start, 2.0 * NEARNESS);
    assert_true(fabs(start - TEXTBOOK) > 10.0 * NEARNESS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_reference_settles_there_at_two_tolerances),
        cmocka_unit_test(the_textbooks_step_settles_elsewhere),
        cmocka_unit_test(an_exact_contact_at_that_step_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
