// Is the same case the same run: again, after others, in a new process, by either solver?
#include "close.h"

#include "mechanism.h"

#include "run/registry.h"
#include "run/run.h"

#include <sys/wait.h>
#include <unistd.h>

static const RunWatch NOBODY = {NULL, NULL};

static Scenario scenario_of(OdeSolver solver, const char *loose_joint)
{
    Scenario scenario = mechanism_paper();
    scenario.run.step = 2e-6;
    scenario.run.revolutions = 0.25;
    scenario.ode.solver = solver;
    if (loose_joint != NULL) {
        mechanism_loosen(&scenario, loose_joint);
    }
    return scenario;
}

static uint64_t hash_of(const Scenario *scenario)
{
    Trajectory *trajectory = run_scenario(scenario, registry_solver(BACKEND_ODE), NOBODY);
    assert_true(trajectory->is_complete);
    const uint64_t hash = trajectory->hash;
    trajectory_destroy(trajectory);
    return hash;
}

static uint64_t hash_in_new_process(const Scenario *scenario)
{
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
        Trajectory *trajectory = run_scenario(scenario, registry_solver(BACKEND_ODE), NOBODY);
        const uint64_t hash = trajectory->hash;
        _exit(write(ends[1], &hash, sizeof hash) == sizeof hash ? 0 : 1);
    }
    uint64_t hash = 0;
    assert_int_equal(read(ends[0], &hash, sizeof hash), sizeof hash);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    close(ends[0]);
    close(ends[1]);
    return hash;
}

static void both_solvers_give_one_hash_whatever_ran_before(void **state)
{
    (void)state;
    const Scenario direct = scenario_of(ODE_DIRECT, "crank-coupler");
    const Scenario quick = scenario_of(ODE_QUICK, "crank-coupler");
    const Scenario other = scenario_of(ODE_QUICK, "coupler-follower");
    const uint64_t direct_hash = hash_of(&direct);
    const uint64_t quick_hash = hash_of(&quick);
    hash_of(&other);
    assert_true(hash_of(&quick) == quick_hash);
    assert_true(hash_of(&direct) == direct_hash);
    assert_true(hash_in_new_process(&quick) == quick_hash);
    assert_true(hash_in_new_process(&direct) == direct_hash);
}

// The control: the hash sees the smallest change there is.
static void the_last_bit_of_an_input_changes_the_hash(void **state)
{
    (void)state;
    Scenario scenario = scenario_of(ODE_DIRECT, "crank-coupler");
    const uint64_t before = hash_of(&scenario);
    scenario.linkage.bodies[1].mass = nextafter(scenario.linkage.bodies[1].mass, 1.0);
    assert_true(hash_of(&scenario) != before);
}

// And the quick solver without its seed would not be reproducible at all.
static void the_quick_solver_depends_on_its_seed(void **state)
{
    (void)state;
    Scenario scenario = scenario_of(ODE_QUICK, NULL);
    const uint64_t before = hash_of(&scenario);
    scenario.ode.seed = 2;
    assert_true(hash_of(&scenario) != before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_solvers_give_one_hash_whatever_ran_before),
        cmocka_unit_test(the_last_bit_of_an_input_changes_the_hash),
        cmocka_unit_test(the_quick_solver_depends_on_its_seed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
