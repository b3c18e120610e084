// What does one step cost: bare dWorldStep, and the whole loop with contacts, records and samples?
//
// The paper's four-bar with play in the crank-coupler pin, one revolution at 1 us; for each row the
// median over interleaved repetitions, and its ratio to the bare engine on the ideal mechanism.
#include "mechanism.h"

#include "base/clock.h"
#include "base/sorted.h"
#include "kept.h"
#include "model/kinematics.h"
#include "ode/engine.h"
#include "ode/plane/world.h"
#include "run/registry.h"
#include "run/run.h"

#include <stdio.h>
#include <stdlib.h>

enum { REPETITIONS = 9, BARE_STEPS = 60000, ROWS = 9 };

// The engine alone: the crank placed, the world stepped, nothing read.
static double bare_us(const Scenario *scenario)
{
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(&scenario->linkage, motions);
    World world;
    Err err = {ERR_NONE, ""};
    if (!world_build(scenario, motions, &world, &err)) {
        fprintf(stderr, "%s\n", err.text);
        exit(1);
    }
    const double start = clock_now_s();
    for (int i = 0; i < BARE_STEPS; i++) {
        Motion crank = motions[0];
        crank.angle = linkage_crank_angle(&scenario->linkage, 1e-6 * i);
        crank.position = vec2_rotate(crank.angle, (Vec2){0.054, 0.0});
        crank.velocity = vec2_scale(crank.omega, vec2_perp(crank.position));
        world_place(&world, 0, &crank);
        engine_step(world.id, 1e-6, false, &err);
    }
    const double us = 1e6 * (clock_now_s() - start) / BARE_STEPS;
    world_finish(&world);
    return us;
}

static double run_us(const Scenario *scenario)
{
    Trajectory *trajectory =
        run_scenario(scenario, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
    const double us = 1e6 * trajectory->wall_s / (double)trajectory->steps;
    trajectory_destroy(trajectory);
    return us;
}

// The scenario stepped in another way.
static Scenario stepped(const Scenario *scenario, OdeStepping stepping, OdeMap map)
{
    Scenario other = kept_copy(scenario);
    other.ode.stepping = stepping;
    other.ode.map = map;
    return other;
}

int main(void)
{
    Scenario ideal = mechanism_paper();
    Scenario loose = mechanism_paper();
    mechanism_loosen(&loose, "crank-coupler");
    Scenario quick = kept_copy(&loose);
    quick.ode.solver = ODE_QUICK;
    const struct {
        const char *name;
        Scenario scenario;
    } rows[ROWS] = {
        {"bare dWorldStep, ideal", ideal},
        {"ideal, plain", ideal},
        {"ideal, staggered", stepped(&ideal, ODE_STAGGERED, ODE_MAP_TEXTBOOK)},
        {"play, plain, textbook", loose},
        {"play, staggered, textbook", stepped(&loose, ODE_STAGGERED, ODE_MAP_TEXTBOOK)},
        {"play, plain, midpoint", stepped(&loose, ODE_PLAIN, ODE_MAP_MIDPOINT)},
        {"play, staggered, midpoint", stepped(&loose, ODE_STAGGERED, ODE_MAP_MIDPOINT)},
        {"play, staggered, impulse", stepped(&loose, ODE_STAGGERED, ODE_MAP_IMPULSE)},
        {"play, plain, quick", quick},
    };
    double times[ROWS][REPETITIONS];
    for (int repetition = 0; repetition < REPETITIONS; repetition++) {
        for (int row = 0; row < ROWS; row++) {
            times[row][repetition] =
                row == 0 ? bare_us(&rows[row].scenario) : run_us(&rows[row].scenario);
        }
    }
    printf("%-26s %12s %12s %10s\n", "", "us/step", "smallest", "ratio");
    double first = 0.0;
    for (int row = 0; row < ROWS; row++) {
        sorted_make(times[row], REPETITIONS);
        const double median = sorted_median(times[row], REPETITIONS);
        first = row == 0 ? median : first;
        printf("%-26s %12.3f %12.3f %10.2f\n", rows[row].name, median, times[row][0],
               median / first);
    }
    return 0;
}
