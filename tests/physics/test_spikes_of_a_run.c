// Are the spikes of a run those of the motion, and not of its samples or its step?
#include "close.h"

#include "mechanism.h"
#include "one_impact.h"

#include "run/registry.h"
#include "run/tracer.h"

// The caller destroys the trajectory.
static Trajectory *traced_run(const Scenario *scenario, BackendKind backend)
{
    Trajectory *run = tracer_run(scenario, registry_solver(backend), (RunWatch){0});
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    return run;
}

// The paper's crank-rocker with play of half a millimetre in one joint, a tenth of a turn: free
// flight between hard impacts.
static Scenario rattling(size_t samples)
{
    Scenario scenario = mechanism_loose(1);
    scenario.linkage.joints[1].clearance.hole_radius =
        scenario.linkage.joints[1].clearance.pin_radius + 5e-4;
    scenario.run.revolutions = 0.1;
    scenario.run.samples = samples;
    return scenario;
}

static void assert_same(const SignalSpikes *first, const SignalSpikes *second)
{
    assert_true(first->is_known && second->is_known);
    assert_true(first->threshold == second->threshold);
    assert_true(first->resolution == second->resolution);
    assert_int_equal(first->count, second->count);
    assert_int_equal(first->kept, second->kept);
    for (size_t i = 0; i < first->kept; i++) {
        const SignalSpike *a = &first->spikes[i];
        const SignalSpike *b = &second->spikes[i];
        assert_true(a->onset_s == b->onset_s && a->time_s == b->time_s && a->end_s == b->end_s);
        assert_true(a->value == b->value && a->prominence == b->prominence);
        assert_true(a->width_s == b->width_s && a->impulse == b->impulse);
        assert_int_equal(a->joint, b->joint);
    }
    for (size_t i = 0; i < SIGNAL_SECTOR_COUNT; i++) {
        assert_int_equal(first->sectors[i].count, second->sectors[i].count);
        assert_true(first->sectors[i].largest == second->sectors[i].largest);
    }
}

static void samples_change_nothing(void **state)
{
    (void)state;
    static const OdeMap MAPS[] = {ODE_MAP_TEXTBOOK, ODE_MAP_MIDPOINT, ODE_MAP_IMPULSE};
    // the last is the reference
    for (size_t k = 0; k < 4; k++) {
        Trajectory *runs[2];
        for (size_t i = 0; i < 2; i++) {
            Scenario scenario = rattling(i == 0 ? 360 : 36000);
            scenario.ode.map = MAPS[k % 3];
            scenario.ode.stepping = k == 0 ? ODE_PLAIN : ODE_STAGGERED;
            runs[i] = traced_run(&scenario, k == 3 ? BACKEND_REFERENCE : BACKEND_ODE);
        }
        assert_true(runs[0]->alpha_spikes[1].count >= 3);
        for (size_t i = 1; i < 3; i++) {
            assert_same(&runs[0]->alpha_spikes[i], &runs[1]->alpha_spikes[i]);
        }
        for (size_t i = 0; i < 4; i++) {
            assert_same(&runs[0]->force_spikes[i], &runs[1]->force_spikes[i]);
        }
        // the control: what the samples show does change with them
        double shown[2] = {0.0, 0.0};
        for (size_t i = 0; i < 2; i++) {
            for (size_t sample = 0; sample < runs[i]->sample_count; sample++) {
                shown[i] = fmax(shown[i], trajectory_motion(runs[i], sample, 1)->alpha);
            }
        }
        assert_true(shown[0] < shown[1]);
        trajectory_destroy(runs[0]);
        trajectory_destroy(runs[1]);
    }
}

static void the_strongest_spike_is_the_largest_value_of_all_steps(void **state)
{
    (void)state;
    const Scenario scenario = rattling(360);
    for (BackendKind backend = BACKEND_REFERENCE; backend <= BACKEND_ODE; backend++) {
        Trajectory *run = traced_run(&scenario, backend);
        const SignalSpikes *spikes = &run->alpha_spikes[1];
        const double largest =
            fmax(run->bodies[1].alpha_max.value, -run->bodies[1].alpha_min.value);
        // of the reference looks inside of steps may show a little more
        assert_true(fabs(spikes->spikes[0].value) >= largest);
        assert_close(fabs(spikes->spikes[0].value), largest,
                     backend == BACKEND_REFERENCE ? 1e-3 : 0.0);
        assert_true(run->force_spikes[1].spikes[0].value == run->joints[1].force_max.value);
        trajectory_destroy(run);
    }
}

// A pin that flies against its wall, once.
static Scenario one_impact(double restitution)
{
    Scenario scenario = one_impact_hertz(ODE_MAP_IMPULSE, DAMPING_EXACT, restitution);
    Motion *start = &scenario.linkage.bodies[0].start;
    start->position.x = ONE_IMPACT_CLEARANCE - 1e-4;
    start->velocity.x = ONE_IMPACT_SPEED;
    scenario.run.samples = 2;
    scenario.run.duration = 1e-3;
    scenario.run.step = 1e-6;
    return scenario;
}

static void an_impact_has_the_impulse_of_the_change_of_momentum(void **state)
{
    (void)state;
    for (BackendKind backend = BACKEND_REFERENCE; backend <= BACKEND_ODE; backend++) {
        for (int k = 0; k < 3; k++) {
            const double restitution = 0.9 - 0.3 * k;
            const Scenario scenario = one_impact(restitution);
            Trajectory *run = traced_run(&scenario, backend);
            const SignalSpikes *spikes = &run->force_spikes[0];
            const double momentum = ONE_IMPACT_MASS * ONE_IMPACT_SPEED;
            assert_int_equal(spikes->count, 1);
            // what dissipates much lets go slowly: the knee leaves some of a long tail out
            assert_close(spikes->spikes[0].impulse, momentum * (1.0 + restitution),
                         k == 0 ? 1e-6 : 1e-2);
            // the control: without the way back it would be less by far
            assert_true(spikes->spikes[0].impulse > 1.2 * momentum);
            assert_near(spikes->spikes[0].onset_s, 1e-4 / ONE_IMPACT_SPEED, 2e-6);
            // the pin does not turn, and rounding is no spike
            assert_int_equal(run->alpha_spikes[0].count, 0);
            trajectory_destroy(run);
        }
    }
}

static double omega_at(const Trajectory *run, size_t body, double time_s)
{
    const double place = time_s / (run->times[1] - run->times[0]);
    const size_t sample = (size_t)place;
    const double share = place - (double)sample;
    const double first = trajectory_motion(run, sample, body)->omega;
    return first + share * (trajectory_motion(run, sample + 1, body)->omega - first);
}

static void the_impulse_of_an_acceleration_is_the_jump_of_omega(void **state)
{
    (void)state;
    const Scenario scenario = rattling(360000);
    for (BackendKind backend = BACKEND_REFERENCE; backend <= BACKEND_ODE; backend++) {
        Trajectory *run = traced_run(&scenario, backend);
        for (size_t body = 1; body < 3; body++) {
            const SignalSpikes *spikes = &run->alpha_spikes[body];
            assert_true(spikes->kept >= 2);
            for (size_t i = 0; i < spikes->kept; i++) {
                const SignalSpike *spike = &spikes->spikes[i];
                const double jump =
                    omega_at(run, body, spike->end_s) - omega_at(run, body, spike->onset_s);
                // a knee at a zero is known to the resolution over a stretch of 5 us; samples are
                // 0.17 us apart and add less
                assert_near(spike->impulse, jump, 5e-6 * spikes->resolution);
                assert_true(spikes->resolution * 5e-6 < 5e-3 * fabs(jump) || i > 0);
                assert_true(spike->impulse * spike->value > 0.0);
            }
        }
        trajectory_destroy(run);
    }
}

// The largest difference of the two strongest alpha spikes of the coupler to the reference's: of
// the value, the width and the impulse.
static void spike_errors(OdeMap map, double step_s, double errors[3])
{
    Scenario scenario = rattling(360);
    scenario.run.revolutions = 0.03; // up to the second impact
    scenario.run.step = step_s;
    scenario.ode.map = map;
    scenario.ode.stepping = map == ODE_MAP_TEXTBOOK ? ODE_PLAIN : ODE_STAGGERED;
    Trajectory *truth = traced_run(&scenario, BACKEND_REFERENCE);
    Trajectory *run = traced_run(&scenario, BACKEND_ODE);
    const SignalSpikes *expected = &truth->alpha_spikes[1];
    const SignalSpikes *found = &run->alpha_spikes[1];
    errors[0] = errors[1] = errors[2] = 0.0;
    assert_int_equal(found->count, expected->count);
    for (size_t i = 0; i < 2; i++) {
        const SignalSpike *a = &found->spikes[i];
        const SignalSpike *b = &expected->spikes[i];
        errors[0] = fmax(errors[0], fabs(a->value / b->value - 1.0));
        errors[1] = fmax(errors[1], fabs(a->width_s / b->width_s - 1.0));
        errors[2] = fmax(errors[2], fabs(a->impulse / b->impulse - 1.0));
    }
    trajectory_destroy(truth);
    trajectory_destroy(run);
}

static void finer_steps_come_closer_to_the_spikes_of_the_reference(void **state)
{
    (void)state;
    double coarse[3];
    double fine[3];
    // plain stepping and the textbook map: first order, in the spikes as in all else
    spike_errors(ODE_MAP_TEXTBOOK, 8e-6, coarse);
    spike_errors(ODE_MAP_TEXTBOOK, 5e-7, fine);
    assert_near(log2(coarse[0] / fine[0]) / 4.0, 1.0, 0.25);
    assert_near(log2(coarse[2] / fine[2]) / 4.0, 1.0, 0.25);
    assert_true(fine[1] < 0.25 * coarse[1]);
    // staggered stepping is better than that at a coarse step already, down to the resolution, 2e-3
    // of the peak, and to where knees are seen
    spike_errors(ODE_MAP_MIDPOINT, 2e-6, fine);
    assert_true(fine[0] < 2e-3 && fine[1] < 2e-3 && fine[2] < 5e-3);
}

// Whether a time lies within a contact of the joint.
static bool is_in_contact(const JointExtremes *joint, double time_s)
{
    for (size_t i = 0; i < joint->spike_count; i++) {
        const Spike *contact = &joint->spikes[i];
        if (time_s >= contact->onset_s && time_s <= contact->onset_s + contact->duration_s) {
            return true;
        }
    }
    return false;
}

static void spikes_of_the_coupler_come_from_contacts_of_the_joint(void **state)
{
    (void)state;
    const Scenario scenario = rattling(360);
    for (BackendKind backend = BACKEND_REFERENCE; backend <= BACKEND_ODE; backend++) {
        Trajectory *run = traced_run(&scenario, backend);
        const SignalSpikes *spikes = &run->alpha_spikes[1];
        const JointExtremes *joint = &run->joints[1];
        assert_int_equal(joint->impacts, joint->spike_count);
        // in contact for a small part of the time: chance would not put all spikes there
        assert_true(joint->contact_time < 0.3 * run->duration_s);
        assert_true(spikes->count >= 5);
        for (size_t i = 0; i < spikes->kept; i++) {
            assert_true(is_in_contact(joint, spikes->spikes[i].time_s));
            assert_int_equal(spikes->spikes[i].joint, 1);
        }
        trajectory_destroy(run);
    }
}

static void looking_changes_no_run(void **state)
{
    (void)state;
    const Scenario scenario = rattling(360);
    for (BackendKind backend = BACKEND_REFERENCE; backend <= BACKEND_ODE; backend++) {
        Trajectory *looked_at = traced_run(&scenario, backend);
        Trajectory *alone = run_scenario(&scenario, registry_solver(backend), (RunWatch){0});
        assert_true(looked_at->hash == alone->hash);
        assert_int_equal(looked_at->steps, alone->steps);
        // inside a step the reference evaluates its equations where somebody asks, and there alone
        assert_true(looked_at->evaluations > alone->evaluations || backend == BACKEND_ODE);
        assert_true(looked_at->evaluations == alone->evaluations || backend != BACKEND_ODE);
        assert_false(alone->alpha_spikes[1].is_known);
        trajectory_destroy(looked_at);
        trajectory_destroy(alone);
    }
}

static void ideal_joints_are_not_asked_for_spikes(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.revolutions = 0.05;
    Trajectory *run = traced_run(&scenario, BACKEND_REFERENCE);
    assert_false(run->alpha_spikes[1].is_known);
    trajectory_destroy(run);
    // the closed form takes a joint with play as ideal
    mechanism_loosen(&scenario, "crank-coupler");
    run = traced_run(&scenario, BACKEND_ANALYTIC);
    assert_false(run->alpha_spikes[1].is_known);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_change_nothing),
        cmocka_unit_test(the_strongest_spike_is_the_largest_value_of_all_steps),
        cmocka_unit_test(an_impact_has_the_impulse_of_the_change_of_momentum),
        cmocka_unit_test(the_impulse_of_an_acceleration_is_the_jump_of_omega),
        cmocka_unit_test(finer_steps_come_closer_to_the_spikes_of_the_reference),
        cmocka_unit_test(spikes_of_the_coupler_come_from_contacts_of_the_joint),
        cmocka_unit_test(looking_changes_no_run),
        cmocka_unit_test(ideal_joints_are_not_asked_for_spikes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
