// Is each contact held beside the right one of the other run?
#include "measure/error.h"

#include "close.h"
#include "mechanism.h"

#include <stdlib.h>

enum { JOINT = 1 };

static const double REACH_S = 3e-3;

// A run whose joint has spikes at these times, ms; force and impulse follow from their number.
static Trajectory *run_with(const double *onsets_ms, size_t count, double scale)
{
    const Scenario scenario = mechanism_paper();
    Trajectory *run = trajectory_create(&scenario, "made");
    run->is_complete = true;
    run->joints[JOINT].spike_count = count;
    for (size_t i = 0; i < count; i++) {
        run->joints[JOINT].spikes[i] = (Spike){
            .onset_s = 1e-3 * onsets_ms[i],
            .force_max = scale * (100.0 + (double)i),
            .impulse = 0.5 * scale * (1.0 + (double)i),
        };
    }
    return run;
}

static SpikeMatch match(const double *onsets_ms, size_t count, const double *truth_ms,
                        size_t truth_count, double horizon_ms)
{
    Trajectory *run = run_with(onsets_ms, count, 1.25);
    Trajectory *truth = run_with(truth_ms, truth_count, 1.0);
    const SpikeMatch result = spike_match(run, truth, JOINT, 1e-3 * horizon_ms, REACH_S);
    trajectory_destroy(run);
    trajectory_destroy(truth);
    return result;
}

static void equal_runs_match_spike_by_spike(void **state)
{
    (void)state;
    const double onsets[] = {5.0, 1.0, 9.0};
    const SpikeMatch result = match(onsets, 3, onsets, 3, INFINITY);
    assert_int_equal(result.pair_count, 3);
    assert_int_equal(result.missed + result.extra, 0);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(result.pairs[i].spike, i);
        assert_int_equal(result.pairs[i].reference_spike, i);
        assert_near(result.pairs[i].onset_delay_s, 0.0, 0.0);
        assert_near(result.pairs[i].force_error, 0.25, 1e-15);
        assert_near(result.pairs[i].impulse_error, 0.25, 1e-15);
    }
}

static void the_order_of_strength_does_not_matter(void **state)
{
    (void)state;
    const double onsets[] = {9.1, 1.2};
    const double truth[] = {1.0, 9.0};
    const SpikeMatch result = match(onsets, 2, truth, 2, INFINITY);
    assert_int_equal(result.pair_count, 2);
    assert_int_equal(result.pairs[0].spike, 1);
    assert_near(result.pairs[0].onset_delay_s, 0.2e-3, 1e-15);
    assert_near(result.pairs[0].force_error, 1.25 * 101.0 / 100.0 - 1.0, 1e-12);
    assert_near(result.pairs[1].onset_delay_s, 0.1e-3, 1e-15);
}

// 3 ms is nearer to 1 than half the gap of the run's spikes would allow, but not of the truth's.
static void a_spike_beyond_half_the_gap_has_no_partner(void **state)
{
    (void)state;
    const double onsets[] = {2.1, 20.0};
    const double truth[] = {1.0, 3.0};
    const SpikeMatch result = match(onsets, 2, truth, 2, INFINITY);
    assert_int_equal(result.pair_count, 1);
    assert_int_equal(result.pairs[0].reference_spike, 1);
    assert_int_equal(result.missed, 1);
    assert_int_equal(result.extra, 1);
    // in the middle it belongs to neither
    const double middle[] = {2.0};
    assert_int_equal(match(middle, 1, truth, 2, INFINITY).pair_count, 0);
}

static void one_alone_matches_within_the_reach(void **state)
{
    (void)state;
    const double early[] = {1.0};
    const double near[] = {3.9};
    const double late[] = {4.1};
    assert_int_equal(match(early, 1, near, 1, INFINITY).pair_count, 1);
    assert_int_equal(match(near, 1, early, 1, INFINITY).pair_count, 1);
    const SpikeMatch apart = match(early, 1, late, 1, INFINITY);
    assert_int_equal(apart.pair_count, 0);
    assert_int_equal(apart.missed, 1);
    assert_int_equal(apart.extra, 1);
    const SpikeMatch none = match(early, 1, late, 0, INFINITY);
    assert_int_equal(none.pair_count, 0);
    assert_int_equal(none.extra, 1);
}

static void spikes_behind_the_horizon_are_left_out(void **state)
{
    (void)state;
    const double onsets[] = {1.0, 5.0, 9.0};
    const double truth[] = {1.1, 5.1, 9.1, 13.0};
    const SpikeMatch result = match(onsets, 3, truth, 4, 5.05);
    assert_int_equal(result.pair_count, 1);
    assert_int_equal(result.missed, 0);
    // the second of the run is early enough, its partner is not: neither missed nor extra
    assert_int_equal(result.extra, 0);
    const SpikeMatch mirrored = match(truth, 4, onsets, 3, 5.05);
    assert_int_equal(mirrored.pair_count, 1);
    assert_int_equal(mirrored.missed + mirrored.extra, 0);
    // one without any partner still counts
    const double lonely[] = {1.0, 3.0};
    assert_int_equal(match(lonely, 2, truth, 4, 5.05).extra, 1);
}

static void a_spike_without_force_is_no_contact(void **state)
{
    (void)state;
    const double onsets_ms[] = {1.0, 1.2, 9.0};
    Trajectory *run = run_with(onsets_ms, 3, 1.25);
    Trajectory *truth = run_with(onsets_ms, 3, 1.0);
    truth->joints[JOINT].spikes[1].force_max = 0.0;
    run->joints[JOINT].spikes[1].force_max = NAN;
    truth->joints[JOINT].spikes[2].impulse = 0.0;
    const SpikeMatch result = spike_match(run, truth, JOINT, INFINITY, REACH_S);
    assert_int_equal(result.pair_count, 1);
    assert_near(result.pairs[0].force_error, 0.25, 1e-15);
    assert_int_equal(result.missed, 0);
    assert_int_equal(result.extra, 1);
    trajectory_destroy(run);
    trajectory_destroy(truth);
}

static void the_reach_is_a_part_of_a_turn_or_of_the_run(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.revolutions = 3.0;
    assert_near(spike_match_reach(&scenario), 0.05 * 0.06, 1e-15);
    scenario.run.revolutions = 0.5;
    assert_near(spike_match_reach(&scenario), 0.05 * 0.03, 1e-15);
    Scenario free_pin = mechanism_pin(1.0, 1e-4);
    free_pin.run.duration = 0.2;
    assert_near(spike_match_reach(&free_pin), 0.05 * 0.2, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_runs_match_spike_by_spike),
        cmocka_unit_test(the_order_of_strength_does_not_matter),
        cmocka_unit_test(a_spike_beyond_half_the_gap_has_no_partner),
        cmocka_unit_test(one_alone_matches_within_the_reach),
        cmocka_unit_test(spikes_behind_the_horizon_are_left_out),
        cmocka_unit_test(a_spike_without_force_is_no_contact),
        cmocka_unit_test(the_reach_is_a_part_of_a_turn_or_of_the_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
