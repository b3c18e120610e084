// Do flanks and stops of a joint's coordinate rebound in ODE as the law of their contact asks, show
// the gap that is asked for, and keep the energy?
#include "limited_joint.h"
#include "load_case.h"
#include "ode_error.h"

#include <stdio.h>

enum { IMPACTS = 100 };

// The worst of seeded impacts at so many steps to a contact or more.
static LimitedOff worst_of(OdeStepping stepping, OdeMap map, double fewest, double ratio)
{
    uint64_t random = lcg_stirred(7);
    LimitedOff worst = {0.0, 0.0, 0.0};
    for (int i = 0; i < IMPACTS; i++) {
        const LimitedKind kind = (LimitedKind)(i % LIMITED_KINDS);
        const LimitedImpact impact = limited_impact_draw(&random, kind, fewest, ratio, 0.2);
        const LimitedOff off = limited_impact_run(&impact, stepping, map, ODE_DIRECT);
        worst = limited_worse(worst, off);
    }
    return worst;
}

static void flanks_rebound_as_asked_down_to_ten_steps_a_contact(void **state)
{
    (void)state;
    const LimitedOff off = worst_of(ODE_STAGGERED, ODE_MAP_MIDPOINT, 10.0, 10.0);
    assert_near(off.restitution, 0.0, 0.01);
    assert_near(off.force, 0.0, 0.01);
    const LimitedOff exact = worst_of(ODE_STAGGERED, ODE_MAP_EXACT, 10.0, 10.0);
    assert_near(exact.restitution, 0.0, 0.01);
    const LimitedOff plain = worst_of(ODE_PLAIN, ODE_MAP_CORRECTED, 10.0, 10.0);
    assert_near(plain.restitution, 0.0, 0.01);
    // the control: ODE's textbook
    const LimitedOff textbook = worst_of(ODE_PLAIN, ODE_MAP_TEXTBOOK, 10.0, 10.0);
    assert_true(textbook.restitution > 0.2 && textbook.force > 0.1);
}

// From forty steps a contact to ten contacts a step.
static void flanks_rebound_as_asked_at_any_step_by_impulse(void **state)
{
    (void)state;
    const LimitedOff off = worst_of(ODE_STAGGERED, ODE_MAP_IMPULSE, 0.1, 400.0);
    assert_near(off.restitution, 0.0, 1e-3);
    assert_near(off.force, 0.0, 1e-3);
    assert_near(off.depth, 0.0, 1e-3);
}

static const double BACKLASH = 0.01;   // rad
static const double TORQUE = 2.0;      // N m
static const double STIFFNESS = 500.0; // N m/rad

// A rotor in its backlash under a torque that is reversed slowly.
static Scenario reversal(double backlash, OdeStepping stepping, OdeMap map)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = linkage->joint_count = 1;
    linkage->bodies[0] = (Body){.name = "rotor", .mass = 1.0, .inertia = 0.01};
    linkage->joints[0] = (Joint){
        .name = "hinge",
        .kind = JOINT_REVOLUTE,
        .body_a = LINKAGE_GROUND,
        .limits = {.kind = LIMIT_BACKLASH, .backlash = backlash},
        .contact = {.stiffness = STIFFNESS, .exponent = 1.0, .viscous = 4.0},
    };
    linkage->torque = (Torque){
        .joint = 0,
        .table = {.count = 4,
                  .times = {0.0, 0.35, 0.75, 1.2},
                  .values = {TORQUE, TORQUE, -TORQUE, -TORQUE}},
    };
    scenario.ode.stepping = stepping;
    scenario.ode.map = map;
    scenario.run.step = 2e-4;
    scenario.run.duration = 1.2;
    scenario.run.samples = 4;
    return scenario;
}

// The gap that the reversal shows: the way from rest to rest less what both flanks give way.
static double gap_shown(double backlash, OdeStepping stepping, OdeMap map)
{
    const Scenario scenario = reversal(backlash, stepping, map);
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const double before = trajectory_motion(run, 1, 0)->angle;
    const double after = trajectory_motion(run, 4, 0)->angle;
    assert_near(trajectory_state(run, 1, 0)->force, TORQUE, 1e-6 * TORQUE);
    assert_near(trajectory_state(run, 4, 0)->moment_on_b, TORQUE, 1e-6 * TORQUE);
    assert_near(trajectory_state(run, 1, 0)->gap, -TORQUE / STIFFNESS, 1e-9);
    trajectory_destroy(run);
    return before - after - 2.0 * TORQUE / STIFFNESS;
}

static void a_slow_reversal_shows_the_gap_that_is_asked_for(void **state)
{
    (void)state;
    assert_near(gap_shown(BACKLASH, ODE_PLAIN, ODE_MAP_TEXTBOOK), BACKLASH, 1e-9);
    assert_near(gap_shown(BACKLASH, ODE_PLAIN, ODE_MAP_CORRECTED), BACKLASH, 1e-9);
    assert_near(gap_shown(BACKLASH, ODE_STAGGERED, ODE_MAP_MIDPOINT), BACKLASH, 1e-9);
    assert_near(gap_shown(BACKLASH, ODE_STAGGERED, ODE_MAP_IMPULSE), BACKLASH, 1e-9);
    // (map exact gives the spring's motion, not its depth under a load)
    // the control: a gap that is 1e-8 rad wider
    const double wider = gap_shown(BACKLASH + 1e-8, ODE_STAGGERED, ODE_MAP_MIDPOINT);
    assert_true(fabs(wider - BACKLASH) > 5e-9);
}

// What is missing in the balance of a run's energy, of what the flanks took, at a step.
static double missing_energy(OdeMap map, double step_s)
{
    Scenario scenario = reversal(BACKLASH, ODE_STAGGERED, map);
    scenario.linkage.joints[0].contact.viscous = 0.5;
    scenario.run.step = step_s;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const double missing = fabs(run->energy.residual) / run->energy.dissipated;
    assert_true(run->energy.dissipated > 0.01);
    trajectory_destroy(run);
    return missing;
}

static void the_energy_audit_closes(void **state)
{
    (void)state;
    const OdeMap maps[] = {ODE_MAP_MIDPOINT, ODE_MAP_IMPULSE};
    for (size_t i = 0; i < 2; i++) {
        const double coarse = missing_energy(maps[i], 4e-4);
        const double fine = missing_energy(maps[i], 5e-5);
        assert_true(coarse < 2e-3 && fine < 4e-5 && fine < coarse / 32.0);
    }
}

// Half a turn at a time is all that ODE knows of an angle.
static void flanks_are_met_after_many_turns(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        const LimitedImpact impact = {
            .kind = LIMITED_HINGE_STOP,
            .is_high = i == 0,
            .inertia = 0.01,
            .speed = 40.0,
            .stiffness = 1e5,
            .restitution = 0.8,
            .step = 2e-5,
            .flight = 21.0,
        };
        const LimitedOff off =
            limited_impact_run(&impact, ODE_STAGGERED, ODE_MAP_MIDPOINT, ODE_DIRECT);
        assert_near(off.restitution, 0.0, 2e-3);
        assert_near(off.force, 0.0, 2e-3);
    }
}

static Scenario gear_pair(OdeMap map, double duration_s)
{
    Scenario scenario = load("cases/mechanisms/gear-pair.yaml", NULL, 0);
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = map;
    scenario.run.duration = duration_s;
    return scenario;
}

// Two cycles, and the rattle before them: the driven pinion's speed has kinks.
static void a_gear_pair_that_rattles_follows_the_reference(void **state)
{
    (void)state;
    static const double RATTLE_S = 0.1;
    const Scenario rows = gear_pair(ODE_MAP_MIDPOINT, RATTLE_S);
    const OdeClimb by_rows = ode_climb(&rows, BACKEND_REFERENCE, 1e-5, 2.0, 2);
    assert_true(ode_climb_order(&by_rows, 0, 1) > 1.75);
    assert_near(by_rows.errors[1].omega_max, 0.0, 6e-4);
    const Scenario within = gear_pair(ODE_MAP_IMPULSE, RATTLE_S);
    const OdeClimb by_impulse = ode_climb(&within, BACKEND_REFERENCE, 8e-5, 4.0, 2);
    assert_true(ode_climb_order(&by_impulse, 0, 1) > 1.75);
    assert_near(by_impulse.errors[1].omega_max, 0.0, 1e-6);
    // the control: teeth that are a tenth of a micron further apart
    Scenario wider = kept_copy(&within);
    wider.linkage.joints[2].limits.backlash += 1e-7;
    wider.run.step = 2e-5;
    Trajectory *truth = complete_run(&within, BACKEND_REFERENCE);
    Trajectory *run = complete_run(&wider, BACKEND_ODE);
    assert_true(error_against(run, truth, INFINITY).omega_max > 1e-5);
    trajectory_destroy(truth);
    trajectory_destroy(run);
}

// Where coordinates stand, what presses, and what contacts came to, against the reference.
static void check_records(const Scenario *scenario, size_t joint)
{
    Trajectory *truth = complete_run(scenario, BACKEND_REFERENCE);
    Trajectory *run = complete_run(scenario, BACKEND_ODE);
    for (size_t k = 0; k < truth->sample_count; k++) {
        const JointState *is = trajectory_state(run, k, joint);
        const JointState *was = trajectory_state(truth, k, joint);
        assert_near(is->tilt, was->tilt, 1e-7);
        assert_near(is->eccentricity.x, was->eccentricity.x, 1e-7);
        assert_near(is->gap, was->gap, 1e-7);
        assert_true(is->is_touching == was->is_touching || fabs(was->gap) < 1e-7);
    }
    const JointExtremes *is = &run->joints[joint];
    const JointExtremes *was = &truth->joints[joint];
    assert_int_equal(is->impacts, was->impacts);
    assert_true(was->impacts > 2);
    assert_close(is->force_max.value, was->force_max.value, 1e-4);
    assert_close(is->penetration_max.value, was->penetration_max.value, 1e-4);
    assert_close(is->impulse, was->impulse, 1e-4);
    assert_close(is->spikes[0].approach_speed, was->spikes[0].approach_speed, 1e-4);
    assert_close(run->energy.dissipated, truth->energy.dissipated, 1e-5);
    assert_near(run->energy.drive_work, truth->energy.drive_work, 1e-5 * truth->energy.dissipated);
    trajectory_destroy(truth);
    trajectory_destroy(run);
}

static void records_are_those_of_the_reference(void **state)
{
    (void)state;
    Scenario gears = gear_pair(ODE_MAP_IMPULSE, 0.1);
    gears.run.step = 2e-5;
    check_records(&gears, 2);
    Scenario stops = load("cases/mechanisms/stop-rebound.yaml", NULL, 0);
    stops.run.step = 1e-4;
    check_records(&stops, 0);
}

static Body disc(const char *name, double x, double spin)
{
    Body body = {.mass = 0.2, .inertia = 1e-4, .start = {.position.x = x, .omega = spin}};
    snprintf(body.name, sizeof body.name, "%s", name);
    return body;
}

static Joint pivot(const char *name, int a, int b, double x)
{
    Joint joint = {.kind = JOINT_REVOLUTE, .body_a = a, .body_b = b, .anchor_a.x = x};
    snprintf(joint.name, sizeof joint.name, "%s", name);
    return joint;
}

// Two gears on an arm that swings about the ground, behind so many other rotors of their own.
static Scenario carried_gears(size_t others)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    const int arm = (int)others;
    const int first = (int)others;
    for (size_t i = 0; i < others; i++) {
        char name[] = "rotor-0";
        name[6] = (char)('0' + i);
        linkage->bodies[linkage->body_count++] = disc(name, 0.5 + (double)i, 3.0);
        linkage->joints[linkage->joint_count++] =
            pivot(name, LINKAGE_GROUND, (int)i, 0.5 + (double)i);
    }
    linkage->bodies[linkage->body_count++] = disc("arm", 0.0, 2.0);
    linkage->bodies[linkage->body_count++] = disc("sun", 0.0, 30.0);
    linkage->bodies[linkage->body_count++] = disc("planet", 0.06, 0.0);
    linkage->bodies[arm + 2].start.velocity.y = 0.06 * 2.0;
    linkage->joints[linkage->joint_count++] = pivot("arm", LINKAGE_GROUND, arm, 0.0);
    linkage->joints[linkage->joint_count++] = pivot("sun", arm, arm + 1, 0.0);
    linkage->joints[linkage->joint_count++] = pivot("planet", arm, arm + 2, 0.06);
    linkage->joints[linkage->joint_count++] = (Joint){
        .name = "teeth",
        .kind = JOINT_GEAR,
        .body_a = arm + 1,
        .body_b = arm + 2,
        .gear = {.pivots = {first + 1, first + 2}, .radius_a = 0.02, .radius_b = 0.04},
        .limits = {.kind = LIMIT_BACKLASH, .backlash = 1e-4},
        .contact = {.stiffness = 1e7, .exponent = 1.0},
    };
    scenario.contact.damping = DAMPING_EXACT;
    scenario.contact.restitution = 0.6;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.run.step = 2e-5;
    scenario.gravity = scenario_downward(9.80665);
    scenario.run.duration = 0.01;
    scenario.run.samples = 300;
    return scenario;
}

// What the teeth push the arm counts, too.
static void gears_on_an_arm_follow_the_reference(void **state)
{
    (void)state;
    const Scenario alone = carried_gears(0);
    const OdeClimb climb = ode_climb(&alone, BACKEND_REFERENCE, 2e-5, 4.0, 2);
    assert_near(climb.errors[0].max, 0.0, 1e-5);
    assert_true(climb.errors[1].max < 0.3 * climb.errors[0].max);
    Scenario rows = kept_copy(&alone);
    rows.ode.map = ODE_MAP_MIDPOINT;
    const OdeClimb by_rows = ode_climb(&rows, BACKEND_REFERENCE, 4e-6, 4.0, 2);
    assert_true(ode_climb_order(&by_rows, 0, 1) > 1.75);
    // beside others the same to the last bit
    const Scenario beside = carried_gears(2);
    Trajectory *run = complete_run(&alone, BACKEND_ODE);
    Trajectory *other = complete_run(&beside, BACKEND_ODE);
    assert_true(run->joints[3].impacts > 3);
    assert_int_equal(run->joints[3].impacts, other->joints[5].impacts);
    for (size_t k = 0; k < run->sample_count; k++) {
        for (size_t i = 0; i < 3; i++) {
            assert_true(trajectory_motion(run, k, i)->omega ==
                        trajectory_motion(other, k, i + 2)->omega);
        }
    }
    trajectory_destroy(run);
    trajectory_destroy(other);
}

// The largest difference of two runs of a case: of any body's speed over the largest one, and of
// the energies over the work done.
static double apart_by_turns(const Trajectory *run, const Trajectory *other)
{
    double largest = 0.0;
    double most = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        for (size_t i = 0; i < run->body_count; i++) {
            const double omega = trajectory_motion(run, k, i)->omega;
            largest = fmax(largest, fabs(omega - trajectory_motion(other, k, i)->omega));
            most = fmax(most, fabs(omega));
        }
    }
    const Energy *energy = &run->energy;
    const double scale = fabs(energy->drive_work) + fabs(energy->dissipated);
    const double energies = fmax(fabs(energy->change - other->energy.change),
                                 fabs(energy->dissipated - other->energy.dissipated));
    return fmax(largest / most, energies / scale);
}

// Backlash of a pivot and of gears, some on an arm, with bodies whose frames start turned: what a
// joint's coordinate has at the start is where its flanks are counted from, whatever turns it
// holds. Control: a case whose flanks start elsewhere is told apart.
static void flanks_do_not_see_how_bodies_are_turned_at_the_start(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        const char *settings[8];
        size_t count; // of settings, of which the last two or more turn bodies
        size_t turned;
        const char *moved; // the control
    } CASES[] = {
        {"cases/mechanisms/gear-pair.yaml",
         {"run.duration=0.05 s", "run.samples=500", "bodies.pinion.angle=190 deg",
          "bodies.wheel.angle=-359 deg"},
         4,
         2,
         "joints.mesh.start=-0.03 mm"},
        {"cases/mechanisms/servo-backlash.yaml",
         {"run.duration=1.5 s", "run.samples=50", "bodies.lever.angle=-170 deg"},
         3,
         1,
         "joints.output.backlash=0.6 deg"},
        {"cases/mechanisms/planetary-gear.yaml",
         {"run.duration=20 ms", "run.samples=400", "bodies.sun.angle=181 deg",
          "bodies.arm.angle=-350 deg", "bodies.planet.angle=360 deg", "bodies.load.angle=-190 deg"},
         6,
         4,
         "joints.coupling.backlash=1.1 deg"},
    };
    static const struct {
        BackendKind backend;
        OdeStepping stepping;
        OdeMap map;
    } WAYS[] = {{BACKEND_REFERENCE, ODE_STAGGERED, ODE_MAP_IMPULSE},
                {BACKEND_ODE, ODE_STAGGERED, ODE_MAP_IMPULSE},
                {BACKEND_ODE, ODE_STAGGERED, ODE_MAP_MIDPOINT},
                {BACKEND_ODE, ODE_PLAIN, ODE_MAP_CORRECTED}};
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        const char *moved[] = {CASES[i].settings[0], CASES[i].settings[1], CASES[i].moved};
        const Scenario scenarios[] = {
            load(CASES[i].path, CASES[i].settings, CASES[i].count - CASES[i].turned),
            load(CASES[i].path, CASES[i].settings, CASES[i].count), load(CASES[i].path, moved, 3)};
        for (size_t k = 0; k < sizeof WAYS / sizeof WAYS[0]; k++) {
            Trajectory *runs[3];
            for (size_t n = 0; n < 3; n++) {
                Scenario scenario = kept_copy(&scenarios[n]);
                scenario.ode.stepping = WAYS[k].stepping;
                scenario.ode.map = WAYS[k].map;
                scenario.run.step = i == 1 ? 2e-4 : 2e-5;
                runs[n] = complete_run(&scenario, WAYS[k].backend);
            }
            const double turned = apart_by_turns(runs[0], runs[1]);
            const double other = apart_by_turns(runs[0], runs[2]);
            if (!(turned < 1e-6 && other > 1e-4)) {
                fail_msg("%s, way %zu: %g where bodies are turned, %g with other flanks",
                         CASES[i].path, k, turned, other);
            }
            for (size_t n = 0; n < 3; n++) {
                trajectory_destroy(runs[n]);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flanks_rebound_as_asked_down_to_ten_steps_a_contact),
        cmocka_unit_test(flanks_rebound_as_asked_at_any_step_by_impulse),
        cmocka_unit_test(a_slow_reversal_shows_the_gap_that_is_asked_for),
        cmocka_unit_test(the_energy_audit_closes),
        cmocka_unit_test(flanks_are_met_after_many_turns),
        cmocka_unit_test(a_gear_pair_that_rattles_follows_the_reference),
        cmocka_unit_test(records_are_those_of_the_reference),
        cmocka_unit_test(gears_on_an_arm_follow_the_reference),
        cmocka_unit_test(flanks_do_not_see_how_bodies_are_turned_at_the_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
