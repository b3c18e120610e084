// Do extremes and contacts stay what they are where nothing else of a run is kept?
#include "close.h"

#include "mechanism.h"

#include "run/registry.h"
#include "run/run.h"

#include <string.h>

static const RunWatch NOBODY = {NULL, NULL};

static Scenario scenario_of(ContactModel model, bool is_lean)
{
    Scenario scenario = mechanism_loose(1);
    scenario.contact.model = model;
    scenario.ode.stepping = ODE_PLAIN;
    scenario.ode.map = ODE_MAP_TEXTBOOK;
    scenario.run.step = 5e-6;
    scenario.run.samples = 1;
    scenario.run.is_lean = is_lean;
    return scenario;
}

static Trajectory *run(ContactModel model, bool is_lean)
{
    Scenario scenario = scenario_of(model, is_lean);
    Trajectory *made = run_scenario(&scenario, registry_solver(BACKEND_ODE), NOBODY);
    assert_string_equal(made->message, "");
    assert_true(made->is_complete);
    scenario_free(&scenario);
    return made;
}

static void a_run_that_keeps_little_has_the_same_extremes_and_contacts(void **state)
{
    (void)state;
    const ContactModel models[] = {CONTACT_IMPACT, CONTACT_POISSON};
    for (int i = 0; i < 2; i++) {
        Trajectory *whole = run(models[i], false);
        Trajectory *lean = run(models[i], true);
        assert_memory_equal(lean->bodies, whole->bodies, whole->body_count * sizeof *whole->bodies);
        for (size_t k = 0; k < whole->joint_count; k++) {
            const JointExtremes *a = &whole->joints[k];
            const JointExtremes *b = &lean->joints[k];
            assert_int_equal(a->impacts, b->impacts);
            assert_int_equal(a->spike_count, b->spike_count);
            assert_memory_equal(a->spikes, b->spikes, sizeof a->spikes);
        }
        // the crank's pin, the one with play
        assert_true(whole->joints[1].impacts > 0);
        assert_memory_equal(&lean->joints[1], &whole->joints[1], sizeof whole->joints[1]);
        // control: of what is left out there was something
        assert_true(whole->joints[2].force_max.value > 0.0);
        assert_near(lean->joints[2].force_max.value, 0.0, 0.0);
        assert_true(whole->energy.drive_work != lean->energy.drive_work);
        assert_true(whole->hash != lean->hash);
        trajectory_destroy(whole);
        trajectory_destroy(lean);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_that_keeps_little_has_the_same_extremes_and_contacts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
