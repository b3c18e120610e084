// Is nothing lost between samples, and is each contact counted once?
#include "close.h"

#include "mechanism.h"

#include "run/step_extremes.h"

#include <string.h>

typedef struct Steps {
    double omega[3];
    double alpha[3];
    JointState joints[4];
    double impulse[4];
    double approach[4];
} Steps;

// One step of a microsecond in which the crank-coupler pin has a force and a gap.
static void add_step(Recorder *recorder, Steps *steps, int index, double force, double gap)
{
    steps->impulse[1] = 1e-6 * force;
    steps->joints[1] = (JointState){.force = force, .gap = gap, .is_touching = gap < 0.0};
    const StepRecord record = {
        .start_s = 1e-6 * index,
        .end_s = 1e-6 * (index + 1),
        .joint_s = 1e-6 * index,
        .omega = steps->omega,
        .alpha = steps->alpha,
        .joints = steps->joints,
        .impulse = steps->impulse,
        .approach = steps->approach,
        .drive_work = 3.0,
        .dissipated = 2.0,
        .friction = 0.5,
    };
    recorder_add(recorder, &record);
}

static void contacts_are_counted_from_onset_to_end(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    Trajectory *trajectory = trajectory_create(&scenario, "test");
    Recorder recorder = recorder_start(&scenario, trajectory, NULL, NULL);
    Steps steps = {.approach = {0.0, 0.25, 0.0, 0.0}};
    const double forces[] = {0.0, 10.0, 30.0, 20.0, 0.0, 0.0, 5.0, 0.0, 7.0};
    const double gaps[] = {1e-6, -1e-7, -3e-7, -2e-7, 1e-6, 1e-6, -5e-8, 1e-6, -7e-8};
    for (int i = 0; i < 9; i++) {
        add_step(&recorder, &steps, i, forces[i], gaps[i]);
    }
    recorder_finish(&recorder);
    const JointExtremes *joint = &trajectory->joints[1];
    assert_int_equal(joint->impacts, 3);
    assert_near(joint->force_max.value, 30.0, 0.0);
    assert_near(joint->force_max.time_s, 2e-6, 1e-20);
    assert_near(joint->penetration_max.value, 3e-7, 0.0);
    assert_near(joint->impulse, 72e-6, 1e-18);
    assert_near(joint->contact_time, 5e-6, 1e-18);
    assert_int_equal(joint->spike_count, 3);
    assert_near(trajectory->energy.drive_work, 27.0, 1e-12);
    assert_near(trajectory->energy.dissipated, 18.0, 1e-12);
    assert_near(trajectory->energy.friction, 4.5, 1e-12);
    // strongest first; the one under way at the end is kept too
    assert_near(joint->spikes[0].force_max, 30.0, 0.0);
    assert_near(joint->spikes[0].onset_s, 1e-6, 0.0);
    assert_near(joint->spikes[0].duration_s, 3e-6, 1e-18);
    assert_near(joint->spikes[0].impulse, 60e-6, 1e-18);
    assert_near(joint->spikes[0].approach_speed, 0.25, 0.0);
    assert_near(joint->spikes[0].crank_rad, scenario.linkage.driver.speed * 1e-6, 1e-15);
    assert_near(joint->spikes[1].force_max, 7.0, 0.0);
    assert_near(joint->spikes[2].force_max, 5.0, 0.0);
    trajectory_destroy(trajectory);
}

// Six steps of 1 us with a contact in the middle four, reported from 2.25 us: what is a mean over a
// step is spread evenly over it, and so is the impulse where nobody can look inside.
static void a_contact_under_way_is_cut(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.run.report_from = 2.25e-6;
    scenario.run.keeps_contacts = true;
    Trajectory *trajectory = trajectory_create(&scenario, "test");
    Recorder recorder = recorder_start(&scenario, trajectory, NULL, NULL);
    Steps steps = {.approach = {0.0}};
    const double forces[] = {0.0, 50.0, 40.0, 10.0, 20.0, 0.0};
    for (int i = 0; i < 6; i++) {
        add_step(&recorder, &steps, i, forces[i], forces[i] > 0.0 ? -1e-9 * forces[i] : 1e-6);
    }
    recorder_finish(&recorder);
    const JointExtremes *joint = &trajectory->joints[1];
    assert_near(joint->contact_time, 2.75e-6, 1e-18);
    assert_near(joint->impulse, 0.75 * 40e-6 + 30e-6, 1e-18);
    assert_near(joint->force_max.value, 40.0, 0.0);
    assert_near(joint->force_max.time_s, 2.25e-6, 0.0);
    assert_near(joint->penetration_max.value, 40e-9, 1e-20);
    assert_int_equal(joint->impacts, 0);
    assert_int_equal(joint->spike_count, 0);
    assert_int_equal(trajectory->contact_count, 0);
    trajectory_destroy(trajectory);
}

static void only_the_strongest_contacts_are_kept(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    Trajectory *trajectory = trajectory_create(&scenario, "test");
    Recorder recorder = recorder_start(&scenario, trajectory, NULL, NULL);
    Steps steps = {.approach = {0.0}};
    // forty contacts of one step; their forces go up and down: 0, 7, 14, ... modulo 40
    for (int i = 0; i < 40; i++) {
        add_step(&recorder, &steps, 2 * i, (double)(7 * i % 40), -1e-7);
        add_step(&recorder, &steps, 2 * i + 1, 0.0, 1e-7);
    }
    recorder_finish(&recorder);
    const JointExtremes *joint = &trajectory->joints[1];
    assert_int_equal(joint->impacts, 40);
    assert_int_equal(joint->spike_count, TRAJECTORY_SPIKE_MAX);
    for (int i = 0; i < TRAJECTORY_SPIKE_MAX; i++) {
        assert_near(joint->spikes[i].force_max, 39.0 - i, 0.0);
    }
    trajectory_destroy(trajectory);
}

static void extremes_hold_a_single_step(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    Trajectory *trajectory = trajectory_create(&scenario, "test");
    Recorder recorder = recorder_start(&scenario, trajectory, NULL, NULL);
    Steps steps = {.approach = {0.0}};
    for (int i = 0; i < 100; i++) {
        steps.omega[1] = -10.0 - (i == 42 ? 5.0 : 0.0);
        steps.alpha[1] = i == 43 ? 1e6 : -1.0;
        add_step(&recorder, &steps, i, 0.0, 0.0);
    }
    recorder_finish(&recorder);
    const BodyExtremes *body = &trajectory->bodies[1];
    assert_near(body->omega_min.value, -15.0, 0.0);
    assert_near(body->omega_min.time_s, 43e-6, 1e-18);
    // all values negative: the largest is not the zero it began with
    assert_near(body->omega_max.value, -10.0, 0.0);
    assert_near(body->alpha_max.value, 1e6, 0.0);
    assert_near(body->alpha_max.crank_rad, scenario.linkage.driver.speed * 44e-6, 1e-15);
    trajectory_destroy(trajectory);
}

static void the_order_of_steps_is_part_of_the_hash(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    uint64_t hashes[2];
    for (int order = 0; order < 2; order++) {
        Trajectory *trajectory = trajectory_create(&scenario, "test");
        Recorder recorder = recorder_start(&scenario, trajectory, NULL, NULL);
        Steps steps = {.approach = {0.0}};
        for (int i = 0; i < 2; i++) {
            steps.omega[1] = i == order ? 1.0 : 2.0;
            add_step(&recorder, &steps, i, 0.0, 0.0);
        }
        hashes[order] = trajectory->hash;
        recorder_finish(&recorder);
        trajectory_destroy(trajectory);
    }
    assert_true(hashes[0] != hashes[1]);
}

// What happens before the reported time is in the ranges and the hash, and in nothing else.
static void a_start_that_is_not_reported_leaves_no_extremes(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    const double forces[] = {0.0, 90.0, 0.0, 10.0, 30.0, 0.0, 0.0, 20.0, 0.0};
    // the second contact is under way at 4 us
    for (int i = 0; i < 2; i++) {
        scenario.run.report_from = i == 0 ? 4e-6 : 0.0;
        Trajectory *trajectory = trajectory_create(&scenario, "test");
        trajectory_keep_ranges(trajectory, &scenario);
        Recorder recorder = recorder_start(&scenario, trajectory, NULL, NULL);
        Steps steps = {.approach = {0.0}};
        for (int k = 0; k < 9; k++) {
            steps.omega[1] = k == 0 ? 1e3 : -10.0;
            add_step(&recorder, &steps, k, forces[k], forces[k] > 0.0 ? -1e-7 : 1e-6);
        }
        recorder_finish(&recorder);
        const JointExtremes *joint = &trajectory->joints[1];
        assert_int_equal(joint->impacts, i == 0 ? 1 : 3);
        assert_int_equal(joint->spike_count, i == 0 ? 1 : 3);
        assert_near(joint->force_max.value, i == 0 ? 30.0 : 90.0, 0.0);
        assert_near(joint->spikes[0].force_max, i == 0 ? 20.0 : 90.0, 0.0);
        assert_near(joint->impulse, i == 0 ? 50e-6 : 150e-6, 1e-18);
        assert_near(joint->contact_time, i == 0 ? 2e-6 : 4e-6, 1e-18);
        assert_near(trajectory->bodies[1].omega_max.value, i == 0 ? -10.0 : 1e3, 0.0);
        const Range range = trajectory_joint_range(trajectory, 0, 1, RANGES_FORCE);
        assert_near(range.most, 90.0, 0.0);
        trajectory_destroy(trajectory);
    }
}

// The same steps, as means and as instants, over stretches of two and a half steps.
static void every_step_is_in_the_range_of_its_stretch(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    for (int i = 0; i < 2; i++) {
        Trajectory *trajectory = trajectory_create(&scenario, "test");
        trajectory->ranges = ranges_create(&scenario.linkage, 4, 2.5e-6);
        Recorder recorder = recorder_start(&scenario, trajectory, NULL, NULL);
        double omega[3] = {0.0};
        double alpha[3] = {0.0};
        JointState joints[4] = {{.gap = 0.0}};
        const double none[4] = {0.0};
        for (int k = 0; k < 10; k++) {
            alpha[1] = k == 2 ? 100.0 + k : k == 7 ? -50.0 : 1.0;
            const StepRecord record = {.start_s = 1e-6 * k,
                                       .end_s = 1e-6 * (k + 1),
                                       .joint_s = 1e-6 * k,
                                       .is_mean = i == 0,
                                       .omega = omega,
                                       .alpha = alpha,
                                       .joints = joints,
                                       .impulse = none,
                                       .approach = none};
            recorder_add(&recorder, &record);
        }
        recorder_finish(&recorder);
        const size_t signal = ranges_of_body(1, RANGES_ALPHA);
        const Ranges *ranges = &trajectory->ranges;
        // a mean from 2 to 3 us belongs to both sides of 2.5 us, an instant at 3 us to one
        assert_near(ranges_over(ranges, signal, 0, 1).most, i == 0 ? 102.0 : 1.0, 0.0);
        assert_near(ranges_over(ranges, signal, 1, 2).most, 102.0, 0.0);
        assert_near(ranges_over(ranges, signal, 2, 3).least, i == 0 ? -50.0 : 1.0, 0.0);
        assert_near(ranges_over(ranges, signal, 3, 4).least, -50.0, 0.0);
        assert_near(ranges_over(ranges, signal, 0, 4).most, 102.0, 0.0);
        trajectory_destroy(trajectory);
    }
}

// A joint's force and a body's angular velocity go through swings.
static void observe_swings(const void *solver_state, double time_s, Sample *sample)
{
    (void)solver_state;
    sample->time_s = time_s;
    sample->bodies[1].alpha = 5.0 * cos(time_s);
    sample->bodies[1].omega = 5.0 * sin(time_s);
    sample->joints[1].force = 7.0 * sin(time_s);
}

// One step over half a swing shows nothing of its top at its ends.
static void tops_within_a_step_that_is_looked_into_are_extremes(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const Solver solver = {.name = "swings", .observe = observe_swings};
    Trajectory *trajectory = trajectory_create(&scenario, "test");
    Recorder recorder = recorder_start(&scenario, trajectory, NULL, NULL);
    Looker looker = looker_start(&scenario, &solver, NULL, &recorder);
    Sample end = sample_create(&scenario.linkage);
    Look looks[LOOK_MAX];
    const double first_s = 0.25;
    const double last_s = M_PI - 0.25;
    observe_swings(NULL, last_s, &end);
    Steps steps = {.approach = {0.0}};
    steps.omega[1] = end.bodies[1].omega;
    steps.alpha[1] = end.bodies[1].alpha;
    add_step(&recorder, &steps, 0, end.joints[1].force, 0.0);
    const Look before = look_inside(&looker, first_s);
    const StepRecord record = {.start_s = first_s,
                               .end_s = last_s,
                               .omega = steps.omega,
                               .alpha = steps.alpha,
                               .joints = steps.joints};
    looks[0] = look_at_end(&looker, &record);
    const JointExtremes *joint = &trajectory->joints[1];
    const BodyExtremes *body = &trajectory->bodies[1];
    // the control: the ends of the step
    assert_near(joint->force_max.value, 7.0 * sin(0.25), 1e-12);
    assert_near(body->omega_max.value, 5.0 * sin(0.25), 1e-12);
    look_for_extremes(&looker, &before, 1, looks);
    assert_close(joint->force_max.value, 7.0, 1e-10);
    assert_near(joint->force_max.time_s, 0.5 * M_PI, 1e-4);
    // where omega turns, alpha is zero: found to a thousandth of the step
    assert_close(body->omega_max.value, 5.0, 1e-5);
    assert_close(body->alpha_max.value, 5.0 * cos(0.25), 1e-12);
    sample_free(&end);
    looker_finish(&looker);
    recorder_finish(&recorder);
    trajectory_destroy(trajectory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contacts_are_counted_from_onset_to_end),
        cmocka_unit_test(a_contact_under_way_is_cut),
        cmocka_unit_test(only_the_strongest_contacts_are_kept),
        cmocka_unit_test(extremes_hold_a_single_step),
        cmocka_unit_test(a_start_that_is_not_reported_leaves_no_extremes),
        cmocka_unit_test(every_step_is_in_the_range_of_its_stretch),
        cmocka_unit_test(tops_within_a_step_that_is_looked_into_are_extremes),
        cmocka_unit_test(the_order_of_steps_is_part_of_the_hash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
