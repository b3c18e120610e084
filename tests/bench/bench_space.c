// What does a step in space cost beside one in the plane, of the same mechanism?
//
// The paper's four-bar with play in the crank-coupler pin, a tenth of a turn; each pair of runs
// taken in turn. The processor's time, not the clock's, and the smallest of many:
// what else the machine does adds to every other.
#include "mechanism.h"

#include "base/clock.h"
#include "kept.h"
#include "run/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdio.h>

enum { REPETITIONS = 25, ROWS = 8 };

static double run_us(const Scenario *scenario, BackendKind backend)
{
    const double start_s = clock_processor_s();
    Trajectory *run = run_scenario(scenario, registry_solver(backend), (RunWatch){NULL, NULL});
    const double us = 1e6 * (clock_processor_s() - start_s) / (double)run->steps;
    trajectory_destroy(run);
    return us;
}

static Scenario lifted(const Scenario *flat)
{
    Scenario scenario = kept_copy(flat);
    scenario.linkage.is_spatial = true;
    for (size_t i = 0; i < scenario.linkage.body_count; i++) {
        Body *body = &scenario.linkage.bodies[i];
        body->space.inertia_x = 0.1 * body->inertia;
        body->space.inertia_y = body->inertia;
    }
    for (size_t i = 0; i < scenario.linkage.joint_count; i++) {
        scenario.linkage.joints[i].space.axis = (Vec3){0.0, 0.0, 1.0};
    }
    return scenario;
}

int main(void)
{
    static const struct {
        const char *name;
        BackendKind backend;
        OdeSolver solver;
        OdeStepping stepping;
        OdeMap map;
        double step_s;
        double friction;
    } CASES[ROWS] = {
        {"plain, textbook", BACKEND_ODE, ODE_DIRECT, ODE_PLAIN, ODE_MAP_TEXTBOOK, 1e-6, 0.0},
        {"staggered, midpoint", BACKEND_ODE, ODE_DIRECT, ODE_STAGGERED, ODE_MAP_MIDPOINT, 1e-6,
         0.0},
        {"staggered, impulse, 1 us", BACKEND_ODE, ODE_DIRECT, ODE_STAGGERED, ODE_MAP_IMPULSE, 1e-6,
         0.0},
        {"staggered, impulse, 10 us", BACKEND_ODE, ODE_DIRECT, ODE_STAGGERED, ODE_MAP_IMPULSE,
         10e-6, 0.0},
        {"midpoint, friction", BACKEND_ODE, ODE_DIRECT, ODE_STAGGERED, ODE_MAP_MIDPOINT, 1e-6, 0.1},
        {"impulse, 10 us, friction", BACKEND_ODE, ODE_DIRECT, ODE_STAGGERED, ODE_MAP_IMPULSE, 10e-6,
         0.1},
        {"quick, staggered, midpoint", BACKEND_ODE, ODE_QUICK, ODE_STAGGERED, ODE_MAP_MIDPOINT,
         1e-6, 0.0},
        {"reference", BACKEND_REFERENCE, ODE_DIRECT, ODE_STAGGERED, ODE_MAP_IMPULSE, 1e-6, 0.0},
    };
    printf("%-28s %14s %14s %8s\n", "", "plane, us/step", "space, us/step", "ratio");
    for (int row = 0; row < ROWS; row++) {
        Scenario flat = mechanism_loose(1);
        flat.run.revolutions = 0.1;
        flat.run.step = CASES[row].step_s;
        flat.ode.solver = CASES[row].solver;
        flat.ode.stepping = CASES[row].stepping;
        flat.ode.map = CASES[row].map;
        flat.contact.friction = CASES[row].friction;
        const Scenario spatial = lifted(&flat);
        double least[2] = {INFINITY, INFINITY};
        for (int i = 0; i < REPETITIONS; i++) {
            least[0] = fmin(least[0], run_us(&flat, CASES[row].backend));
            least[1] = fmin(least[1], run_us(&spatial, CASES[row].backend));
        }
        printf("%-28s %14.3f %14.3f %8.2f\n", CASES[row].name, least[0], least[1],
               least[1] / least[0]);
    }
    return 0;
}
