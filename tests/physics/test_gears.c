// Do gears with play in their bearings push, gain backlash and keep what must be kept as they
// should?
//
// Nothing outside acts on gears in a floating frame: their linear and angular momentum stay, and
// without damping their energy, whatever their errors of pitch are, only while the forces of the
// flanks are those whose work the gaps say. A gear at rest in its bearing under a moment M is held
// by two forces and its weight: one of M / (r cos alpha) along the line of action, which stands at
// the angle whose cosine is R cos alpha / D with the centres D apart.
#include "complete_run.h"
#include "load_case.h"
#include "scratch.h"

static Scenario case_of(const char *text)
{
    char path[256];
    scratch_path("gears.yaml", path, sizeof path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs(text, stream);
    fclose(stream);
    const Scenario scenario = load(path, NULL, 0);
    unlink(path);
    return scenario;
}

static const char FLOATING[] =
    "bodies:\n"
    "  small: {mass: 0.2 kg, inertia: 40 kg mm^2, at: [0 mm, 0 mm], spin: 60 rad/s,\n"
    "          velocity: [0.1 m/s, 0.05 m/s]}\n"
    "  large: {mass: 0.8 kg, inertia: 900 kg mm^2, at: [%s 0 mm], spin: -7 rad/s,\n"
    "          velocity: [0.1 m/s, 0.05 m/s]}\n"
    "  frame: {mass: 0.5 kg, inertia: 2000 kg mm^2, at: [50 mm, 10 mm], \n"
    "          velocity: [0.1 m/s, 0.05 m/s]}\n"
    "joints:\n"
    "  a: {between: [frame, small], at: [0 mm, 0 mm]%s}\n"
    "  b: {between: [frame, large], at: [%s 0 mm], radial-clearance: 50 um, stiffness: 3e7 N/m}\n"
    "  mesh: {gears: [a, b], teeth: [20, %s], pressure-angle: 20 deg, backlash: 0.3 mm,\n"
    "         stiffness: 1e7 N/m%s}\n"
    "gravity: 0 m/s^2\n"
    "contact: {damping: exact, restitution: 1}\n"
    "reference: {tolerance: 1e-13}\n"
    "run: {duration: 30 ms, samples: 3000}\n";

static const char TABLES[] =
    ", repeats: 20,\n"
    "         transmission-error: [[0 deg, 4 um], [3 deg, 2 um], [6 deg, -2 um], [9 deg, -4 um],\n"
    "                              [12 deg, -2 um], [15 deg, 2 um]],\n"
    "         relief: [[0 deg, 0 um], [3 deg, 9 um], [6 deg, 20 um], [9 deg, 11 um],\n"
    "                  [12 deg, 6 um], [15 deg, 2 um]]";

typedef struct Conserved {
    double energy;
    Vec2 linear;
    double angular; // about the origin
} Conserved;

static Conserved conserved_in(const Linkage *linkage, const Motion *motions)
{
    Conserved kept = {.energy = linkage_kinetic_energy(linkage, motions)};
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        kept.linear = vec2_add(kept.linear, vec2_scale(body->mass, motions[i].velocity));
        kept.angular += body->inertia * motions[i].omega +
                        body->mass * vec2_cross(motions[i].position, motions[i].velocity);
    }
    return kept;
}

static bool is_touching(const Trajectory *run, size_t sample)
{
    bool is_any = false;
    for (size_t i = 0; i < run->joint_count; i++) {
        is_any = is_any || (linkage_has_play(&run->linkage.joints[i]) &&
                            trajectory_state(run, sample, i)->is_touching);
    }
    return is_any;
}

// External gears and a ring, one bearing loose or both, with the errors of their teeth.
static void floating_gears_keep_energy_and_momentum(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        const bool is_ring = i % 2 == 1;
        const bool are_both = i / 2 == 1;
        char text[3000];
        snprintf(text, sizeof text, FLOATING, is_ring ? "40 mm," : "80 mm,",
                 are_both ? ", radial-clearance: 30 um, stiffness: 3e7 N/m" : "",
                 is_ring ? "40 mm," : "80 mm,", is_ring ? "-60" : "60", TABLES);
        const Scenario scenario = case_of(text);
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const Conserved before = conserved_in(&run->linkage, trajectory_motion(run, 0, 0));
        size_t apart = 0;
        assert_true(run->joints[2].impacts > 3);
        assert_true(run->joints[1].impacts > 3);
        for (size_t k = 0; k < run->sample_count; k++) {
            const Conserved now = conserved_in(&run->linkage, trajectory_motion(run, k, 0));
            assert_near(now.linear.x, before.linear.x, 1e-13);
            assert_near(now.linear.y, before.linear.y, 1e-13);
            assert_near(now.angular, before.angular, 1e-14);
            if (!is_touching(run, k)) {
                apart++;
                assert_near(now.energy, before.energy, 1e-10);
            }
        }
        assert_true(apart > 10);
        trajectory_destroy(run);
    }
}

static const char PRESSED[] =
    "bodies:\n"
    "  small: {mass: 0.2 kg, inertia: 40 kg mm^2, at: [0 mm, 0 mm]}\n"
    "  large: {mass: 0.8 kg, inertia: 900 kg mm^2, at: [80 mm, 0 mm]}\n"
    "joints:\n"
    "  a: {between: [ground, small], at: [0 mm, 0 mm]}\n"
    "  b: {between: [ground, large], at: [80 mm, 0 mm], radial-clearance: 200 um,\n"
    "      stiffness: 1e8 N/m, viscous-coefficient: 4000 N s/m}\n"
    "  mesh: {gears: [a, b], teeth: [20, 60], pressure-angle: 20 deg, backlash: 0.3 mm,\n"
    "         start: -0.14 mm, stiffness: 1e8 N/m, viscous-coefficient: 4000 N s/m}\n"
    "loads:\n"
    "  drag: {body: large, torque: 30 N m}\n"
    "torsion-springs:\n"
    "  hold: {joint: a, stiffness: 1e5 N m/rad, damping: 20 N m s/rad}\n"
    "gravity: 0 m/s^2\n"
    "contact: {damping: viscous, viscous-coefficient: 4000 N s/m}\n"
    "run: {duration: 0.4 s, samples: 200}\n";

static void a_loaded_gear_leans_along_the_line_of_action(void **state)
{
    (void)state;
    const Scenario scenario = case_of(PRESSED);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const size_t last = run->sample_count - 1;
    const JointState *bearing = trajectory_state(run, last, 1);
    const double alpha = 20.0 * M_PI / 180.0;
    const double pressed = 30.0 / (0.06 * cos(alpha));
    const Vec2 between = vec2_add((Vec2){0.08, 0.0}, bearing->eccentricity);
    const double working = acos(0.08 * cos(alpha) / vec2_length(between));
    const double line = atan2(between.y, between.x) + 0.5 * M_PI - working;
    assert_close(trajectory_state(run, last, 2)->force, pressed, 1e-8);
    assert_close(bearing->force, pressed, 1e-8);
    // on the pin, against the teeth
    assert_near(
        remainder(atan2(bearing->force_on_b.y, bearing->force_on_b.x) - line - M_PI, 2.0 * M_PI),
        0.0, 1e-7);
    // the control: the line of action is not where the pitch circles would have it
    assert_true(working - alpha > 2e-3);
    trajectory_destroy(run);
}

// Two pairs of teeth, of which one or both carry, are as stiff as one and as two.
static void pairs_of_teeth_share_a_load(void **state)
{
    (void)state;
    const Scenario scenario = load("cases/mechanisms/tooth-pairs.yaml", NULL, 0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    size_t alone = 0;
    for (size_t k = run->sample_count / 3; k < run->sample_count; k++) {
        const double odd = trajectory_state(run, k, 2)->force;
        const double even = trajectory_state(run, k, 3)->force;
        // quasi-static but where a pair comes or goes
        assert_near(odd + even, 1500.0, 10.0);
        if (odd == 0.0 || even == 0.0) {
            assert_near(odd + even, 1500.0, 1.0);
            alone++;
        }
    }
    assert_true(alone > 60);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floating_gears_keep_energy_and_momentum),
        cmocka_unit_test(a_loaded_gear_leans_along_the_line_of_action),
        cmocka_unit_test(pairs_of_teeth_share_a_load),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
