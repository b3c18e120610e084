// How well, and at which cost, are N four-bars in a row followed through their change points?
//
// four_bars reference      the reference at 1 to 40 four-bars, up to 20 s, beside the exact values
// four_bars order          ODE's error over its step, N = 2 at 4 s, and the order observed
// four_bars steps          error and time of a step over N at one step: ODE's direct solver, and
//                          its quick one with more and more iterations
// four_bars equal          what each solver takes to come to the same error, over N
// four_bars own            the direct solver with ODE's own dense matrix, over N
// four_bars branch         is the branch of parallelograms kept for 20 s, over N
// Without a word: all of them, some minutes. The problem: tests/support/four_bars.h.
#include "four_bars.h"
#include "base/clock.h"
#include "run/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t COUNTS[] = {1, 4, 16, 64, 256, 1000};
enum { COUNT_COUNT = sizeof COUNTS / sizeof *COUNTS };

static const double DURATION = 2.0; // s: two change points

// A run and what it took.
typedef struct Made {
    Trajectory *run;
    double spent_s; // processor time
} Made;

static Made make(const Scenario *scenario, BackendKind backend)
{
    const double started_s = clock_processor_s();
    Trajectory *run = run_scenario(scenario, registry_solver(backend), (RunWatch){NULL, NULL});
    return (Made){run, clock_processor_s() - started_s};
}

static Scenario four_bars(size_t count, double duration_s)
{
    Scenario scenario = scenario_default();
    scenario.linkage =
        linkage_create((LinkageRoom){.bodies = 2 * count + 1, .joints = 3 * count + 1});
    four_bars_fill(&scenario, count, duration_s);
    return scenario;
}

// Where the tip of the first upright is and how fast it moves, by a series of order 40 in 50
// digits.
typedef struct Exact {
    size_t count;
    double time_s;
    double x;
    double y;
    double vx;
    double vy;
} Exact;

static const Exact EXACT[] = {
    {1, 1, -.26071267518365037752, -.96541643915907315865, -6.6378094961217215, 1.7925539703889306},
    {1, 10, .47838505776097056676, .87815017879120926825, 1.7272640755471536, -.9409521793715156},
    {2, 1, -.19502030194943509311, -.98079920566217382305, -6.6766780368811585, 1.3275783251604871},
    {2, 10, .32845811154081538952, .94451853817860098594, 1.4230514702069441, -.4948688454870430},
    {2, 20, .83974657430684351844, .54297853635288462204, 1.8382226441967427, -2.8429137892740970},
    {40, 10, .18051222668672839422, .98357274058231158875, 1.1484412774694142, -.2107700667794239},
    {40, 20, .41090115376294522598, .91167990097198070565, 1.5667853719090699, -.7061622355938373},
};

// The largest kinetic energy, J.
static double swing(const Scenario *scenario, const Trajectory *run)
{
    double most = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        most = fmax(most, linkage_kinetic_energy(&scenario->linkage, trajectory_motion(run, i, 0)));
    }
    return most;
}

static void tabulate_reference(void)
{
    printf(
        "The reference: the tip of the first upright beside its exact values, over all tips, and "
        "the energy's drift\n"
        "    N  time, s   position, m  velocity, m/s  all tips, m  energy, J   of, J  "
        "evaluations  ms\n");
    for (size_t i = 0; i < sizeof EXACT / sizeof *EXACT; i++) {
        const Exact *exact = &EXACT[i];
        Scenario scenario = four_bars(exact->count, exact->time_s);
        const Made made = make(&scenario, BACKEND_REFERENCE);
        const Trajectory *run = made.run;
        printf("%5zu %8g", exact->count, exact->time_s);
        if (run->is_complete) {
            const Motion *motion = trajectory_motion(run, run->sample_count - 1, 0);
            const double x = cos(motion->angle);
            const double y = sin(motion->angle);
            printf("  %12.1e  %13.1e  %11.1e  %9.1e  %6.4g  %11zu  %.0f\n",
                   hypot(x - exact->x, y - exact->y),
                   hypot(-motion->omega * y - exact->vx, motion->omega * x - exact->vy),
                   four_bars_error(run, atan2(exact->x, exact->y)), fabs(run->energy.residual),
                   swing(&scenario, run), run->evaluations, 1e3 * made.spent_s);
        } else {
            printf("  %s\n", run->message);
        }
        trajectory_destroy(made.run);
        linkage_free(&scenario.linkage);
    }
}

static const OdeStepping STEPPINGS[] = {ODE_PLAIN, ODE_STAGGERED, ODE_EXTRAPOLATED};
enum { STEPPING_COUNT = sizeof STEPPINGS / sizeof *STEPPINGS };

static void tabulate_order(void)
{
    enum { COUNT = 2, HALVINGS = 4 };
    const double duration_s = 4.0;
    const double theta = four_bars_angle(COUNT, duration_s).theta;
    printf("ODE, direct: error of the tips, m, N = %d at %g s, and the order from the step before\n"
           "  step, us",
           COUNT, duration_s);
    for (int way = 0; way < STEPPING_COUNT; way++) {
        printf("  %18s", OPTIONS_ODE_STEPPINGS[STEPPINGS[way]]);
    }
    printf("\n");
    double before[STEPPING_COUNT] = {0};
    for (int k = 0; k <= HALVINGS; k++) {
        Scenario scenario = four_bars(COUNT, duration_s);
        scenario.run.step = 2e-3 / (1 << k);
        printf("%10g", 1e6 * scenario.run.step);
        for (int way = 0; way < STEPPING_COUNT; way++) {
            scenario.ode.stepping = STEPPINGS[way];
            const Made made = make(&scenario, BACKEND_ODE);
            const double error = made.run->is_complete ? four_bars_error(made.run, theta) : NAN;
            printf("  %11.1e", error);
            if (k > 0) {
                printf("  %5.2f", log2(before[way] / error));
            } else {
                printf("       ");
            }
            before[way] = error;
            trajectory_destroy(made.run);
        }
        printf("\n");
        linkage_free(&scenario.linkage);
    }
}

// One run of ODE.
typedef struct Way {
    OdeStepping stepping;
    size_t iterations; // of the quick solver; 0: the direct one
    double step_s;
    bool is_dense; // the direct solver with rows of ODE's own alone
} Way;

typedef struct Point {
    double error;    // m, of the tips at the end; NAN where it failed
    double step_us;  // processor time
    double total_ms; // likewise, a simulated second
} Point;

static Point solve(const Way *way, size_t count)
{
    // rows with a softness below any rounding are not put together outside ODE
    const double no_softness = 1e-30;
    Scenario scenario = four_bars(count, DURATION);
    scenario.run.step = way->step_s;
    scenario.ode.stepping = way->stepping;
    scenario.ode.cfm = way->is_dense ? no_softness : 0.0;
    scenario.ode.solver = way->iterations > 0 ? ODE_QUICK : ODE_DIRECT;
    scenario.ode.iterations = way->iterations > 0 ? way->iterations : scenario.ode.iterations;
    const Made made = make(&scenario, BACKEND_ODE);
    const double theta = four_bars_angle(count, DURATION).theta;
    const Point point = {
        .error = made.run->is_complete ? four_bars_error(made.run, theta) : NAN,
        .step_us = 1e6 * made.spent_s / (double)made.run->steps,
        .total_ms = 1e3 * made.spent_s / DURATION,
    };
    trajectory_destroy(made.run);
    linkage_free(&scenario.linkage);
    return point;
}

// The power of N with which a time grows between the third N and the last one that there is.
static double exponent(const double *times, size_t count)
{
    return log(times[count - 1] / times[2]) / log((double)COUNTS[count - 1] / (double)COUNTS[2]);
}

static void tabulate_steps(void)
{
    static const size_t SHOWN[] = {0, 5, 10, 20, 50, 100};
    enum { WAY_COUNT = sizeof SHOWN / sizeof *SHOWN };
    double times[WAY_COUNT][COUNT_COUNT];
    printf("ODE, staggered, step 1 ms, %g s: error of the tips, m, and processor time of a step, "
           "us, with the direct solver and with the quick one's iterations\n"
           "    N            direct",
           DURATION);
    for (size_t k = 1; k < WAY_COUNT; k++) {
        printf("  %16zu", SHOWN[k]);
    }
    printf("\n");
    for (size_t i = 0; i < COUNT_COUNT; i++) {
        printf("%5zu", COUNTS[i]);
        for (size_t k = 0; k < WAY_COUNT; k++) {
            const Way way = {ODE_STAGGERED, SHOWN[k], 1e-3, false};
            const Point point = solve(&way, COUNTS[i]);
            times[k][i] = point.step_us;
            printf("  %7.1e %8.1f", point.error, point.step_us);
            fflush(stdout);
        }
        printf("\n");
    }
    printf("time ~N^");
    for (size_t k = 0; k < WAY_COUNT; k++) {
        printf("%*.2f", k == 0 ? 15 : 18, exponent(times[k], COUNT_COUNT));
    }
    printf("\n");
}

// The ways that may come to an error: every stepping, step and number of iterations of these. Ways
// of the direct solver have no iterations.
static const double STEPS[] = {8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4}; // s
static const size_t ITERATIONS[] = {5, 7, 10, 15, 20, 30, 50, 100, 200};
enum {
    STEP_COUNT = sizeof STEPS / sizeof *STEPS,
    ITERATION_COUNT = sizeof ITERATIONS / sizeof *ITERATIONS,
    WAY_MOST = STEPPING_COUNT * STEP_COUNT * ITERATION_COUNT,
};

// What a step takes beside its iterations, in iterations: measured at N = 256.
static const double BESIDE = 4.0;

// The ways of one solver at one N by rising work, and their errors as far as they are known.
typedef struct Search {
    size_t count; // N
    size_t way_count;
    Way ways[WAY_MOST];
    double errors[WAY_MOST]; // m; below 0 where the way has not been run
} Search;

// In iterations a simulated second: the same on every machine, whatever else it does. Extrapolated
// stepping takes as many steps of its worlds in all as the others.
static double work_of(const Way *way)
{
    return (BESIDE + (double)way->iterations) / way->step_s;
}

static int by_work(const void *first, const void *second)
{
    const double a = work_of(first);
    const double b = work_of(second);
    return (a > b) - (a < b);
}

static void start_search(size_t count, bool is_quick, Search *search)
{
    *search = (Search){.count = count};
    for (size_t i = 0; i < STEPPING_COUNT * STEP_COUNT; i++) {
        for (size_t k = 0; k < (is_quick ? ITERATION_COUNT : 1); k++) {
            search->errors[search->way_count] = -1.0;
            search->ways[search->way_count++] = (Way){
                .stepping = STEPPINGS[i / STEP_COUNT],
                .iterations = is_quick ? ITERATIONS[k] : 0,
                .step_s = STEPS[i % STEP_COUNT],
            };
        }
    }
    qsort(search->ways, search->way_count, sizeof *search->ways, by_work);
}

// The error of a way, run where it is not known.
static double error_at(Search *search, size_t i)
{
    if (search->errors[i] < 0.0) {
        const double error = solve(&search->ways[i], search->count).error;
        search->errors[i] = isfinite(error) ? error : INFINITY;
    }
    return search->errors[i];
}

// An error may by chance be so many times smaller than that of a better solution.
static const double CHANCE = 3.0;

// Whether the direct solver comes to an error by the stepping and step of a way: more iterations
// bring the quick one towards that, no further, but by chance.
static bool is_fine_enough(Search *direct, const Way *way, double target)
{
    for (size_t i = 0; i < direct->way_count; i++) {
        const Way *other = &direct->ways[i];
        if (other->stepping == way->stepping && other->step_s == way->step_s) {
            return error_at(direct, i) <= CHANCE * target;
        }
    }
    return false;
}

// The way with the least work that comes to an error; NULL where none does.
static const Way *find_least(Search *search, Search *direct, double target)
{
    for (size_t i = 0; i < search->way_count; i++) {
        const Way *way = &search->ways[i];
        if (is_fine_enough(direct, way, target) && error_at(search, i) <= target) {
            return way;
        }
    }
    return NULL;
}

// Ways to one error at one N, each with the median of its processor time.
enum { AT_DIRECT, AT_QUICK, AT_DENSE, AT_COUNT };

typedef struct Equal {
    Way ways[AT_COUNT];
    bool is_there[AT_COUNT];
    double total_ms[AT_COUNT]; // a simulated second; NAN where there is none
} Equal;

// ODE's own dense matrix takes seconds a second from here on.
static const size_t DENSE_MOST = 64;

// In turn, so that what else the machine does meets all of them.
static void time_in_turn(size_t count, Equal *equal)
{
    enum { ROUNDS = 3 };
    double times[AT_COUNT][ROUNDS];
    for (int round = 0; round < ROUNDS; round++) {
        for (int k = 0; k < AT_COUNT; k++) {
            times[k][round] = equal->is_there[k] ? solve(&equal->ways[k], count).total_ms : NAN;
        }
    }
    for (int k = 0; k < AT_COUNT; k++) {
        const double *t = times[k];
        equal->total_ms[k] = fmax(fmin(t[0], t[1]), fmin(fmax(t[0], t[1]), t[2]));
    }
}

static void find_equal(Search searches[2], double target, Equal *equal)
{
    *equal = (Equal){.is_there = {false}};
    for (int k = AT_DIRECT; k <= AT_QUICK; k++) {
        const Way *way = find_least(&searches[k], &searches[AT_DIRECT], target);
        equal->is_there[k] = way != NULL;
        equal->ways[k] = way != NULL ? *way : (Way){.step_s = 0.0};
    }
    equal->ways[AT_DENSE] = equal->ways[AT_DIRECT];
    equal->ways[AT_DENSE].is_dense = true;
    equal->is_there[AT_DENSE] = equal->is_there[AT_DIRECT] && searches[0].count <= DENSE_MOST;
    time_in_turn(searches[0].count, equal);
}

static void print_way(const Equal *equal, int k)
{
    char words[64] = "none";
    const Way *way = &equal->ways[k];
    if (equal->is_there[k]) {
        const int length = snprintf(words, sizeof words, "%s %g ms",
                                    OPTIONS_ODE_STEPPINGS[way->stepping], 1e3 * way->step_s);
        if (way->iterations > 0) {
            snprintf(words + length, sizeof words - (size_t)length, ", %zu", way->iterations);
        }
    }
    printf("  %-22s %8.3g", words, equal->total_ms[k]);
}

static void print_equal(double target, const Equal equals[COUNT_COUNT])
{
    double times[2][COUNT_COUNT];
    printf("Processor time a simulated second, ms, at an error of the tips of %g m at %g s: each "
           "solver by the way with the least work that comes to it, quick with its iterations; "
           "ODE's own dense matrix by the direct one's way\n"
           "    N  %-31s  %-31s  quick/direct     dense  quick/dense\n",
           target, DURATION, "direct", "quick");
    for (size_t i = 0; i < COUNT_COUNT; i++) {
        const double *ms = equals[i].total_ms;
        printf("%5zu", COUNTS[i]);
        print_way(&equals[i], AT_DIRECT);
        print_way(&equals[i], AT_QUICK);
        printf("  %12.2f", ms[AT_QUICK] / ms[AT_DIRECT]);
        if (equals[i].is_there[AT_DENSE]) {
            printf("  %8.3g  %11.2f\n", ms[AT_DENSE], ms[AT_QUICK] / ms[AT_DENSE]);
        } else {
            printf("  %8s  %11s\n", "-", "-");
        }
        times[0][i] = ms[AT_DIRECT];
        times[1][i] = ms[AT_QUICK];
    }
    printf("time ~N^ %29.2f %32.2f\n", exponent(times[0], COUNT_COUNT),
           exponent(times[1], COUNT_COUNT));
}

static void tabulate_equal(void)
{
    static const double TARGETS[] = {1e-2, 1e-3, 1e-4};
    enum { TARGET_COUNT = sizeof TARGETS / sizeof *TARGETS };
    Equal equals[TARGET_COUNT][COUNT_COUNT];
    Search searches[2];
    for (size_t i = 0; i < COUNT_COUNT; i++) {
        start_search(COUNTS[i], false, &searches[AT_DIRECT]);
        start_search(COUNTS[i], true, &searches[AT_QUICK]);
        for (size_t t = 0; t < TARGET_COUNT; t++) {
            find_equal(searches, TARGETS[t], &equals[t][i]);
        }
    }
    for (size_t t = 0; t < TARGET_COUNT; t++) {
        print_equal(TARGETS[t], equals[t]);
        printf(t + 1 < TARGET_COUNT ? "\n" : "");
        fflush(stdout);
    }
}

static void tabulate_own(void)
{
    printf("Plain steps of 1 ms, us a step: the direct solver as it is, with ODE's own dense "
           "matrix, and 20 iterations\n"
           "    N    direct  dense, ODE's     quick  quick/dense\n");
    for (size_t count = 1; count <= 64; count *= 2) {
        const Way ways[] = {
            {ODE_PLAIN, 0, 1e-3, false}, {ODE_PLAIN, 0, 1e-3, true}, {ODE_PLAIN, 20, 1e-3, false}};
        double times[3];
        for (int k = 0; k < 3; k++) {
            times[k] = solve(&ways[k], count).step_us;
        }
        printf("%5zu  %8.1f  %12.1f  %8.1f  %11.2f\n", count, times[0], times[1], times[2],
               times[2] / times[1]);
        fflush(stdout);
    }
}

// Runs for 20 s, eighteen change points and more, and says what has become of the branch.
static void follow(size_t count, BackendKind backend, size_t iterations)
{
    const double duration_s = 20.0;
    Scenario scenario = four_bars(count, duration_s);
    scenario.run.step = 1e-3;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.solver = iterations > 0 ? ODE_QUICK : ODE_DIRECT;
    scenario.ode.iterations = iterations > 0 ? iterations : scenario.ode.iterations;
    const Made made = make(&scenario, backend);
    const FourBarsAngle angle = four_bars_angle(count, duration_s);
    char way[32];
    snprintf(way, sizeof way, backend == BACKEND_REFERENCE ? "reference" : "%s %zu",
             iterations > 0 ? "quick" : "direct", iterations);
    printf("%5zu  %-12s", count, way);
    if (made.run->is_complete) {
        const double spread = four_bars_spread(made.run);
        printf("  %-6s %.1e rad, tips %.1e m\n", spread < 0.1 ? "kept" : "LEFT", spread,
               four_bars_error(made.run, angle.theta));
    } else {
        printf("  says so: %s\n", made.run->message);
    }
    fflush(stdout);
    trajectory_destroy(made.run);
    linkage_free(&scenario.linkage);
}

static void tabulate_branch(void)
{
    const double theta = four_bars_angle(40, 20.0).theta;
    printf("The branch over 20 s, %.0f change points: the most that any upright is turned against "
           "the first\n"
           "    N  solver\n",
           floor(theta / M_PI + 0.5));
    for (size_t i = 0; i < COUNT_COUNT; i++) {
        follow(COUNTS[i], BACKEND_REFERENCE, 0);
        follow(COUNTS[i], BACKEND_ODE, 0);
        if (COUNTS[i] <= 256) {
            follow(COUNTS[i], BACKEND_ODE, 1);
            follow(COUNTS[i], BACKEND_ODE, 20);
        }
    }
}

typedef struct Part {
    const char *name;
    void (*tabulate)(void);
} Part;

int main(int argc, char **argv)
{
    static const Part PARTS[] = {
        {"reference", tabulate_reference}, {"order", tabulate_order}, {"steps", tabulate_steps},
        {"equal", tabulate_equal},         {"own", tabulate_own},     {"branch", tabulate_branch},
    };
    bool is_known = argc == 1;
    for (size_t i = 0; i < sizeof PARTS / sizeof *PARTS; i++) {
        if (argc == 1 || (argc == 2 && strcmp(argv[1], PARTS[i].name) == 0)) {
            PARTS[i].tabulate();
            printf(argc == 1 && i + 1 < sizeof PARTS / sizeof *PARTS ? "\n" : "");
            is_known = true;
        }
    }
    if (!is_known) {
        fprintf(stderr, "usage: four_bars [reference|order|steps|equal|own|branch]\n");
    }
    return is_known ? 0 : 2;
}
