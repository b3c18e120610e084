// Does work that is made of many runs say of each how far it has come?
//
// Of no run more than some 64 steps go by without a word, samples of perturbed runs being steps;
// what is shown, and when, is the command's.
#include "close.h"
#include "mechanism.h"

#include "measure/chosen_run.h"
#include "measure/ensemble.h"
#include "measure/truth.h"
#include "run/registry.h"

enum { STEPS_BETWEEN = 64 };

typedef struct Heard {
    size_t runs;    // that began: the share went back
    size_t words;   // with a share
    size_t pulses;  // without: perturbed runs side by side
    double longest; // largest share between two words of one run
    double share;   // of the last word that had one
    size_t trials;  // of a step that is chosen
} Heard;

static void hear(double share, double wall_s, void *context)
{
    (void)wall_s;
    Heard *heard = context;
    if (share == 0.0) {
        heard->pulses++;
        return;
    }
    const bool is_new = heard->words == 0 || share < heard->share;
    heard->runs += is_new ? 1 : 0;
    heard->words++;
    heard->longest = fmax(heard->longest, share - (is_new ? 0.0 : heard->share));
    heard->share = share;
}

static void hear_trial(size_t trial, double step_s, void *context)
{
    (void)trial;
    (void)step_s;
    ((Heard *)context)->trials++;
}

static Scenario short_case(void)
{
    Scenario scenario = mechanism_loose(1);
    scenario.run.revolutions = 0.05;
    scenario.run.samples = 1000;
    return scenario;
}

static void three_runs_and_the_perturbed_ones_make_a_truth(void **state)
{
    (void)state;
    const Scenario scenario = short_case();
    Heard heard = {0};
    Truth truth = truth_make(&scenario, (RunWatch){hear, &heard});
    assert_string_equal(truth.message, "");
    print_message("# %zu words of %zu runs, %zu of perturbed ones\n", heard.words, heard.runs,
                  heard.pulses);
    // the case's own samples are few: the first of the three is taken on a finer grid as well
    assert_int_equal(heard.runs, 3);
    assert_true(heard.longest < 0.5);
    // two starts of the one joint with play, each with a step and a look at every sample at the
    // least
    assert_true(heard.pulses >= 2 * (2 * truth.trajectory->sample_count / STEPS_BETWEEN - 1));
    assert_true(heard.words >= 3 * (truth.trajectory->steps / STEPS_BETWEEN - 1));
    truth_finish(&truth);
}

static void every_member_of_an_ensemble_is_watched(void **state)
{
    (void)state;
    const Scenario scenario = short_case();
    for (int i = 0; i < 2; i++) {
        const Solver *solver = registry_solver(i == 0 ? BACKEND_REFERENCE : BACKEND_ODE);
        Heard heard = {0};
        Ensemble ensemble;
        ensemble_run(&scenario, solver, 0.0, (RunWatch){hear, &heard}, &ensemble);
        assert_int_equal(ensemble.members, ENSEMBLE_MEMBERS);
        // all of them are one run to those who watch
        assert_int_equal(heard.runs, 1);
        assert_true(heard.share > 1.0 - 0.5 / ENSEMBLE_MEMBERS);
        assert_true(heard.longest < 1.0 / ENSEMBLE_MEMBERS);
    }
}

static void every_trial_of_a_chosen_step_is_watched(void **state)
{
    (void)state;
    Scenario scenario = short_case();
    scenario.run.step = 0.0;
    scenario.run.tolerance = 1e-4;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    Heard heard = {0};
    Trajectory *run = backend_run(&scenario, BACKEND_ODE, NULL,
                                  (ChosenWatch){.run = {hear, &heard}, .begin = hear_trial}, NULL);
    assert_true(run->is_complete);
    // the reference, and two trials at least
    assert_true(heard.trials >= 3);
    assert_true(heard.words > heard.trials);
    // control: who is not asked to is not called
    const ChosenWatch nobody = {.begin = NULL};
    Trajectory *silent = backend_run(&scenario, BACKEND_ODE, NULL, nobody, NULL);
    assert_true(silent->hash == run->hash);
    trajectory_destroy(silent);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_runs_and_the_perturbed_ones_make_a_truth),
        cmocka_unit_test(every_member_of_an_ensemble_is_watched),
        cmocka_unit_test(every_trial_of_a_chosen_step_is_watched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
