// Do constants for a step that is held run as they are said to in a whole mechanism?
//
// The outside truth is the other way in the program to the same row: kp and kd as a linear law with
// a viscous damper under the textbook map, and their ERP = h kp / (h kp + kd) and
// CFM = 1 / (h kp + kd) as numbers of a row without any law. The same motion has to come of both.
#include "close.h"
#include "mechanism.h"

#include "commands/tune/tune_linear.h"
#include "measure/error.h"
#include "run/registry.h"

static const double STEP_S = 1e-5;

static TuneLinear constants(double cfm_factor)
{
    const double stiffness = 2e8;
    const double damping = 600.0;
    const double sum = STEP_S * stiffness + damping;
    return (TuneLinear){
        .row = {.erp = STEP_S * stiffness / sum, .cfm = cfm_factor / sum},
        .stiffness = stiffness,
        .damping = damping,
        .step_s = STEP_S,
    };
}

static Trajectory *run(const TuneLinear *linear)
{
    const Scenario loose = mechanism_loose(1);
    const Scenario scenario = tune_linear_scenario(&loose, linear);
    Trajectory *made = run_scenario(&scenario, registry_solver(BACKEND_ODE), (RunWatch){0});
    assert_true(made->is_complete);
    return made;
}

static void a_row_of_numbers_moves_as_the_spring_and_damper_it_is_made_of(void **state)
{
    (void)state;
    const TuneLinear pair = constants(1.0);
    TuneLinear row = constants(1.0);
    TuneLinear other = constants(2.0);
    row.is_row = other.is_row = true;
    Trajectory *of_pair = run(&pair);
    Trajectory *of_row = run(&row);
    Trajectory *of_other = run(&other);
    const TrajectoryError same = error_against(of_row, of_pair, INFINITY);
    const TrajectoryError control = error_against(of_other, of_pair, INFINITY);
    assert_true(same.is_known && control.is_known);
    // rounding, grown by the impacts of a fifth of a turn
    assert_true(same.max < 1e-8);
    // control: a row with twice the CFM is another contact
    assert_true(control.max > 1e-3);
    trajectory_destroy(of_pair);
    trajectory_destroy(of_row);
    trajectory_destroy(of_other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_row_of_numbers_moves_as_the_spring_and_damper_it_is_made_of),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
