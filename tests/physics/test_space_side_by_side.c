// Do mechanisms in space that share nothing but the ground move there as each does alone?
//
// The reference and ODE's steps with contacts inside hand on one mechanism after the other. The
// gate turns about a leaning axis, and the top slides along its hole: neither does in the plane.
#include "complete_run.h"
#include "kept.h"

#include "casefile/casefile.h"

#include <stdio.h>
#include <string.h>

static const char GATE[] =
    "  gate: {mass: 4 kg, inertia: 200000 kg mm^2, at: [300 mm, 0 mm], spin: 1 rad/s,\n"
    "         spin-x: 2 rad/s, spin-y: 10 rad/s, velocity-z: -3 m/s, velocity: [0 m/s, 0.3 m/s]}\n";
static const char HINGE[] =
    "  hinge: {between: [ground, gate], at: [0 mm, 0 mm], axis: [0.2, 1, 0.1], low: -30 deg,\n"
    "          high: 20 deg, stiffness: 2e4 N m/rad, restitution: 0.3}\n";
static const char TOP[] =
    "  top: {mass: 0.3 kg, inertia: 200 kg mm^2, inertia-x: 120 kg mm^2, inertia-y: 120 kg mm^2,\n"
    "        at: [1000 mm, 0 mm], spin: 200 rad/s, velocity-z: 0.1 m/s}\n";
static const char SPINDLE[] =
    "  spindle: {between: [ground, top], at: [1000 mm, 0 mm], radial-clearance: 0.1 mm,\n"
    "            width: 30 mm, axial-clearance: 0.5 mm, stiffness: 1e6 N/m, restitution: 0.5}\n";

enum { GATE_ALONE = 1, TOP_ALONE = 2, BOTH = 3 };

static Scenario make(int which)
{
    char text[2048];
    snprintf(text, sizeof text,
             "space: spatial\nbodies:\n%s%sjoints:\n%s%s"
             "contact: {damping: exact}\nrun: {duration: 20 ms, samples: 50, step: 20 us}\n",
             (which & GATE_ALONE) != 0 ? GATE : "", (which & TOP_ALONE) != 0 ? TOP : "",
             (which & GATE_ALONE) != 0 ? HINGE : "", (which & TOP_ALONE) != 0 ? SPINDLE : "");
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("case", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

// The farthest that a body is from where it is alone, m and rad/s, at all samples.
static double apart(const Trajectory *both, size_t body, const Trajectory *alone)
{
    double most = 0.0;
    for (size_t k = 0; k < both->sample_count; k++) {
        const SpaceMotion *is = trajectory_space_motion(both, k, body);
        const SpaceMotion *was = trajectory_space_motion(alone, k, 0);
        most = fmax(most, vec3_length(vec3_sub(is->position, was->position)));
        most = fmax(most, vec3_length(vec3_sub(is->omega, was->omega)));
    }
    return most;
}

static void each_moves_in_space_as_it_does_alone(void **state)
{
    (void)state;
    const Scenario both = make(BOTH);
    const Scenario alone[2] = {make(GATE_ALONE), make(TOP_ALONE)};
    static const BackendKind BACKENDS[2] = {BACKEND_REFERENCE, BACKEND_ODE};
    for (int i = 0; i < 2; i++) {
        Trajectory *beside = complete_run(&both, BACKENDS[i]);
        for (size_t body = 0; body < 2; body++) {
            Trajectory *run = complete_run(&alone[body], BACKENDS[i]);
            // ODE orders the rows of all; both stop at no event of the other
            assert_near(apart(beside, body, run), 0.0, 1e-9);
            trajectory_destroy(run);
        }
        // the control: they leave the plane, the gate by centimetres
        const size_t last = beside->sample_count - 1;
        assert_true(fabs(trajectory_space_motion(beside, last, 0)->position.z) > 0.01);
        assert_true(fabs(trajectory_space_motion(beside, last, 1)->position.z) > 1e-4);
        assert_true(beside->joints[1].axial_max.value > 4e-4);
        trajectory_destroy(beside);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_moves_in_space_as_it_does_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
