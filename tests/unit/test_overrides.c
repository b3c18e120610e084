// Do settings of the command line replace what the file says, and point at what is wrong with them?
// Runs in the source root.
#include "load_case.h"

static const char IMPACT[] = "cases/paper/stackup-impact.yaml";

static void overrides_replace_what_the_file_says(void **state)
{
    (void)state;
    static const char *const OVERRIDES[] = {
        "run.step=5 us",
        "run.step=2us",
        "run.backends=[ode]",
        "contact.law=johnson",
        "drive={speed: -1 rad/s}",
        "title=another",
        "material.youngs-modulus=70 GPa",
    };
    const Scenario scenario = load(IMPACT, OVERRIDES, sizeof OVERRIDES / sizeof OVERRIDES[0]);
    assert_near(scenario.run.step, 2e-6, 0.0);
    assert_int_equal(scenario.run.backend_count, 1);
    assert_int_equal(scenario.run.backends[0], BACKEND_ODE);
    assert_int_equal(scenario.contact.law, LAW_JOHNSON);
    assert_near(scenario.linkage.driver.speed, -1.0, 0.0);
    assert_string_equal(scenario.title, "another");
    assert_near(scenario.material.youngs_modulus, 7e10, 0.0);
    const Scenario one = load_with(IMPACT, "run.backends=analytic");
    assert_int_equal(one.run.backends[0], BACKEND_ANALYTIC);
}

static void an_override_takes_the_place_of_its_rival(void **state)
{
    (void)state;
    const Scenario stiff = load_with(IMPACT, "contact.stiffness=6.6e10 N/m^1.5");
    assert_near(stiff.contact.stiffness, 6.6e10, 0.0);
    const Scenario play = load_with(IMPACT, "joints.crank-coupler.radial-clearance=0.1 mm");
    assert_near(play.linkage.joints[1].clearance.pin_radius, 4.993e-3, 0.0);
    assert_near(play.linkage.joints[1].clearance.hole_radius, 5.093e-3, 1e-18);
    static const char *const BACK[] = {"contact.stiffness=6.6e10 N/m^1.5", "contact.law=johnson"};
    const Scenario law = load(IMPACT, BACK, 2);
    assert_near(law.contact.stiffness, 0.0, 0.0);
    assert_int_equal(law.contact.law, LAW_JOHNSON);
}

static void wrong_overrides_are_usage_errors(void **state)
{
    (void)state;
    refuse(IMPACT, "contact.restitution=1.5", ERR_USAGE,
           "--set contact.restitution=1.5: contact.restitution is out of range: 1.5\n"
           "    --set contact.restitution=1.5\n"
           "                              ^~~\n"
           "allowed: 0 to 1");
    refuse(IMPACT, "joints.crank-coupler.hole=9 mm", ERR_USAGE,
           "--set joints.crank-coupler.hole=9 mm: the pin (9.986 mm) must be smaller than the "
           "hole (9 mm)\n"
           "    --set joints.crank-coupler.hole=9 mm\n"
           "                                    ^~~~\n"
           "allowed: a hole above 9.986 mm");
    refuse(IMPACT, "run.stp=1 us", ERR_USAGE,
           "--set run.stp=1 us: unknown key 'stp'; did you mean 'step'?\n"
           "    --set run.stp=1 us\n"
           "              ^~~\n"
           "allowed: revolutions, duration, samples, step, budget, tolerance, tolerance-of, "
           "most-steps, "
           "spike-threshold, "
           "report-from, start, settle-starts, settle-least, settle-most, settle-to, "
           "settle-budget, backends");
    refuse(IMPACT, "joints.follower-ground.hole=9 mm", ERR_USAGE,
           "--set joints.follower-ground.hole=9 mm: joints.follower-ground.pin is missing\n"
           "    --set joints.follower-ground.hole=9 mm\n"
           "                                      ^~~~\n"
           "allowed: hole and pin, or radial-clearance");
    refuse(IMPACT, "drive.speed=0.001 rpm", ERR_USAGE,
           "--set drive.speed=0.001 rpm: the run of 6e+04 s takes 6e+10 steps of 1e-06 s\n"
           "    --set drive.speed=0.001 rpm\n"
           "                      ^~~~~~~~~\n"
           "allowed: at most 1e+09 steps: here a step of 6e-05 s or more, or fewer revolutions");
    refuse("cases/mechanisms/start-and-stop.yaml", "contact.law=esdu-78035", ERR_USAGE,
           "--set contact.law=esdu-78035: the law esdu-78035 needs the width of joint "
           "coupler-follower\n"
           "    --set contact.law=esdu-78035\n"
           "                      ^~~~~~~~~~\n"
           "allowed: width: 13 mm, or a law without it");
}

static void malformed_overrides_say_what_is_needed(void **state)
{
    (void)state;
    refuse(IMPACT, "run.step", ERR_USAGE,
           "--set run.step: a key and a value are needed\n"
           "allowed: --set KEY=VALUE, such as --set run.step=2us");
    refuse(IMPACT, "=1", ERR_USAGE,
           "--set =1: a key and a value are needed\n"
           "allowed: --set KEY=VALUE, such as --set run.step=2us");
    refuse(IMPACT, "run.step=", ERR_USAGE, "--set run.step=: no value\nallowed: --set KEY=VALUE");
    refuse(IMPACT, "run.step=[", ERR_USAGE,
           "--set run.step=[: not valid YAML: while parsing a flow node: did not find expected "
           "node content\n"
           "    --set run.step=[\n"
           "                    ^");
    refuse(IMPACT, "title=a\nb", ERR_USAGE,
           "--set: the argument is not text on one line\nallowed: --set KEY=VALUE");
    refuse(IMPACT, "run.step.x=1", ERR_USAGE,
           "--set run.step.x=1: unknown key 'x'\n"
           "    --set run.step.x=1\n"
           "                   ^");
    refuse(IMPACT, "joints.foo.hole=1 mm", ERR_USAGE,
           "--set joints.foo.hole=1 mm: unknown joint 'foo'\n"
           "    --set joints.foo.hole=1 mm\n"
           "                 ^~~\n"
           "allowed: crank-coupler, coupler-follower, follower-ground");
    refuse(IMPACT, "joints.crank-coupler.start=centered", ERR_USAGE,
           "--set joints.crank-coupler.start=centered: 'centered' is not a position; did you mean "
           "'centred'?\n"
           "    --set joints.crank-coupler.start=centered\n"
           "                                     ^~~~~~~~\n"
           "allowed: centred, or [x, y] such as [5 um, 0 um]");
    refuse(IMPACT, "ode.seed=0.5", ERR_USAGE,
           "--set ode.seed=0.5: '0.5' is not a whole number\n"
           "    --set ode.seed=0.5\n"
           "                   ^~~\n"
           "allowed: a whole number, 0 to 4.29497e+09");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(overrides_replace_what_the_file_says),
        cmocka_unit_test(an_override_takes_the_place_of_its_rival),
        cmocka_unit_test(wrong_overrides_are_usage_errors),
        cmocka_unit_test(malformed_overrides_say_what_is_needed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
