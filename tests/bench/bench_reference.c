// What does the reference cost, for which error, and what does one contact event cost?
//
// Error: against the reference itself at tolerance 1e-13, over one turn (0.5 mm: 10 ms). Wall times
// are medians over interleaved repetitions. Below, a pin bounces in its hole without loss: the
// evaluations for each impact must not depend on how many there are.
#include "mechanism.h"

#include "base/sorted.h"
#include "measure/error.h"
#include "run/registry.h"
#include "run/run.h"

#include <stdio.h>

enum { REPETITIONS = 9, TOLERANCES = 4, PROBLEMS = 4 };

static const RunWatch NOBODY = {NULL, NULL};
static const double TOLERANCE[TOLERANCES] = {1e-9, 1e-10, 2e-11, 3e-13};
static const char *const NAMES[PROBLEMS] = {"one joint", "two joints", "three joints", "0.5 mm"};

static Trajectory *run_reference(const Scenario *scenario)
{
    return run_scenario(scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
}

static Scenario problem(int number)
{
    const char *const joints[] = {"crank-coupler", "coupler-follower", "follower-ground"};
    Scenario scenario = mechanism_paper();
    scenario.contact.stiffness = 6.6e10;
    const int loose = number < 3 ? number + 1 : 1;
    for (int i = 0; i < loose; i++) {
        mechanism_loosen(&scenario, joints[i]);
    }
    if (number == 3) {
        Clearance *clearance = &scenario.linkage.joints[1].clearance;
        clearance->hole_radius = clearance->pin_radius + 0.5e-3;
        scenario.run.revolutions = 1.0 / 6.0;
    }
    return scenario;
}

static void print_problem(int number)
{
    Scenario scenario = problem(number);
    scenario.reference.tolerance = 1e-13;
    Trajectory *truth = run_reference(&scenario);
    double wall_s[TOLERANCES][REPETITIONS];
    double error[TOLERANCES];
    size_t evaluations[TOLERANCES];
    for (int repetition = 0; repetition < REPETITIONS; repetition++) {
        for (int i = 0; i < TOLERANCES; i++) {
            scenario.reference.tolerance = TOLERANCE[i];
            Trajectory *trajectory = run_reference(&scenario);
            wall_s[i][repetition] = trajectory->wall_s;
            evaluations[i] = trajectory->evaluations;
            error[i] = error_against(trajectory, truth, INFINITY).omega_max;
            trajectory_destroy(trajectory);
        }
    }
    for (int i = 0; i < TOLERANCES; i++) {
        sorted_make(wall_s[i], REPETITIONS);
        printf("%-14s %10.1e %12zu %10.1e %10.2f %10.2f\n", NAMES[number], TOLERANCE[i],
               evaluations[i], error[i], 1e3 * sorted_median(wall_s[i], REPETITIONS),
               1e3 * wall_s[i][0]);
    }
    trajectory_destroy(truth);
}

static void print_impacts(double turns)
{
    Scenario scenario = mechanism_pin(0.1, 1e-4);
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.damping = DAMPING_NONE;
    scenario.linkage.bodies[0].start.velocity = (Vec2){0.5, 0.1};
    scenario.run.duration = turns;
    scenario.run.samples = 10;
    Trajectory *trajectory = run_reference(&scenario);
    const size_t impacts = trajectory->joints[0].impacts;
    printf("%10zu %12zu %14.1f\n", impacts, trajectory->evaluations,
           (double)trajectory->evaluations / (double)impacts);
    trajectory_destroy(trajectory);
}

int main(void)
{
    printf("%-14s %10s %12s %10s %10s %10s\n", "", "tolerance", "evaluations", "error", "wall, ms",
           "least, ms");
    for (int number = 0; number < PROBLEMS; number++) {
        print_problem(number);
    }
    printf("\n%10s %12s %14s\n", "impacts", "evaluations", "per impact");
    print_impacts(0.005);
    print_impacts(0.05);
    print_impacts(0.5);
    return 0;
}
