// What becomes of random worlds of the library under each stepping?
//
//     random_worlds FIRST COUNT [STEPS [PASSIVE_STEPS [STEPPING]]]
//
// Asked of each stepping: every step ends; of worlds of plain sizes, with rows those whose steps
// resolve their contacts (random_world.c), nine of ten steps are JP_OK; no force is negative and
// every number finite; no largest force of a contact without damping is above its law at the
// largest depth, in steps that are JP_OK; and the energy of a passive world, all of whose steps are
// JP_OK, does not grow. An abort or a leak is the sanitizers' to find. Prints what was found of
// each stepping, and each world that is not as asked; exits with 1 if there is one. How far damped
// forces are above the law at the closing speeds of the steps' ends is printed only: within a step
// a contact may close faster.
//
// The control, with CONTROL as a sixth word: all largest forces are read a third too large.
#include "random_world.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double LEAST_OK = 0.9; // of the steps of plain sizes

// Above the law's own force: of contacts within the step by rounding alone. Rows know forces at
// steps only, and take the top of a parabola through three, at most an eighth above the largest.
static const double OVER_INSIDE = 1e-6;
static const double OVER_ROWS = 0.125;

// A world is given up on after that.
static const double SECONDS_MOST = 60.0;

// Of the largest kinetic energy: what steps of order 2 leave of it. After plain steps positions are
// half a step ahead of velocities, so that an energy is read only while nothing touches.
static const double GROWTH = 1e-2;

static const double CONTROL = 4.0 / 3.0;

enum { RETRIES = 6, SHORTER = 4 };

// What is found of the worlds of one stepping.
typedef struct Found {
    JpStepping stepping;
    bool is_control;
    size_t worlds;
    size_t passive;
    size_t passive_ok; // every step of theirs was JP_OK
    size_t plain_steps;
    size_t plain_ok;
    size_t plain_coarse;
    size_t stiff_steps; // of sizes too stiff for the step
    size_t stiff_ok;
    size_t stiff_coarse;
    size_t wild_steps;
    size_t wild_ok;
    size_t impacts;
    size_t peaks;         // largest forces that were held against the law
    size_t ended;         // worlds that could not be stepped on
    double slowest;       // s of processor time, of a step
    double peak;          // 1, the largest force over the law's, undamped
    double damped;        // 1, damped
    double growth;        // 1, of a passive world's energy, all of whose steps were JP_OK
    double coarse_growth; // of others
    unsigned faults;      // worlds that are not as asked
    unsigned at[5];
} Found;

static const char *const NAMES[] = {"plain", "staggered", "impulse"};

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void keep_worst(double value, unsigned number, double *worst, unsigned *at)
{
    if (!(value <= *worst)) {
        *worst = value;
        *at = number;
    }
}

// A world while it runs.
typedef struct Run {
    RandomWorld made;
    unsigned number;
    JpSide sides[RANDOM_PLAYS][RANDOM_SIDES];
    double closing[RANDOM_PLAYS];
    size_t fallbacks;  // of the world's rows so far
    bool has_rows;     // the last step was made by rows
    bool is_ok;        // it was JP_OK
    bool is_coarse;    // a step was refused or JP_COARSE
    const char *fault; // the first
} Run;

static void blame(Run *run, const char *fault)
{
    run->fault = run->fault == NULL ? fault : run->fault;
}

// N, by the library's own map of the law; NaN where the law gives none.
static double law_force(const JpContact *contact, double depth, double closing, double impact_speed,
                        double step)
{
    const JpInstant at = {.depth = depth,
                          .closing = closing,
                          .impact_speed = impact_speed,
                          .mass = 1.0,
                          .step = step};
    JpRow row;
    if (jp_row(JP_MAP_TEXTBOOK, contact, &at, &row, NULL) != JP_OK) {
        return NAN;
    }
    return row.erp / (row.cfm * step) * depth + row.rest / row.cfm * closing;
}

// N, at most of rows, which see the contact up to a step later, and damp more by the textbook.
static double row_force(const JpContact *contact, double depth, double closing, double impact_speed,
                        double step)
{
    const double deeper = depth + closing * step;
    return law_force(contact, deeper, closing, impact_speed, step) +
           law_force(contact, deeper, 0.0, impact_speed, step) / deeper * closing * step;
}

// Holds a force that became the largest of a side in a step against the law.
static void check_peak(Run *run, size_t play, size_t side, const JpSide *now, double closing,
                       Found *found)
{
    const JpSide *before = &run->sides[play][side];
    const RandomPlay *of = &run->made.plays[play];
    const JpContact *contact = &of->contact;
    const double force = now->force_max * (found->is_control ? CONTROL : 1.0);
    if (!(now->force_max > before->force_max) || now->impacts > before->impacts + 1) {
        return; // the speeds of more impacts are not all known
    }
    const double onset = before->is_touching && before->impact_speed > 0.0
                             ? fmin(before->impact_speed, now->impact_speed)
                             : now->impact_speed;
    const double fastest = fmax(fmax(closing, run->closing[play]), now->impact_speed);
    const bool is_damped = contact->damping != JP_DAMPING_NONE;
    const bool has_rows = run->has_rows || found->stepping != JP_STEPPING_IMPULSE;
    const double law = random_world_share(of, side) *
                       (has_rows ? row_force : law_force)(contact, fmax(now->depth_max, DBL_MIN),
                                                          fastest, onset, run->made.step);
    if (!isfinite(law)) {
        return;
    }
    const double most = has_rows ? OVER_ROWS : OVER_INSIDE;
    const double over = force / law - 1.0;
    found->peaks++;
    keep_worst(over, run->number, is_damped ? &found->damped : &found->peak,
               &found->at[is_damped ? 1 : 0]);
    if (!is_damped && !(over <= most)) {
        blame(run, "a force above the law");
    }
}

static void check_side(Run *run, size_t play, size_t side, const JpSide *now, double closing,
                       Found *found)
{
    if (!(now->force >= 0.0 && now->force_max >= 0.0 && now->depth_max >= 0.0)) {
        if (run->fault == NULL) {
            printf("world %u: force %g, largest %g, depth %g\n", run->number, now->force,
                   now->force_max, now->depth_max);
        }
        blame(run, "a force or a depth below 0");
    }
    if (!isfinite(now->force_max) || !isfinite(now->work) || !isfinite(now->stored)) {
        blame(run, "a number that is not finite");
    }
    if (!run->made.is_wild && run->is_ok) {
        check_peak(run, play, side, now, closing, found);
    }
    found->impacts += now->impacts - run->sides[play][side].impacts;
    run->sides[play][side] = *now;
}

static void check_sides(Run *run, Found *found)
{
    for (size_t i = 0; i < run->made.play_count; i++) {
        JpSide sides[RANDOM_SIDES];
        double closing = 0.0;
        const size_t count = random_world_sides(&run->made.plays[i], sides, &closing);
        for (size_t k = 0; k < count; k++) {
            check_side(run, i, k, &sides[k], closing, found);
        }
        run->closing[i] = closing;
    }
}

// One step, or shorter ones where it fails, of which only the first counts.
static bool make_step(Run *run, Found *found, bool *is_ok)
{
    double step = run->made.step;
    JpError error = {JP_OK, ""};
    for (int i = 0; i <= RETRIES; i++, step /= SHORTER) {
        const double start = seconds();
        const JpStatus status = jp_world_step(run->made.play, step, &error);
        keep_worst(seconds() - start, run->number, &found->slowest, &found->at[3]);
        *is_ok = i == 0 && status == JP_OK;
        if (!run->made.is_wild && i == 0 && status == JP_COARSE) {
            *(run->made.is_plain ? &found->plain_coarse : &found->stiff_coarse) += 1;
        }
        run->is_ok = status == JP_OK;
        run->is_coarse = run->is_coarse || status != JP_OK;
        if (status <= JP_OK) {
            return true;
        }
        if (strlen(error.text) < 10) {
            blame(run, "a failure without a sentence");
        }
    }
    return false;
}

static void run_world(Run *run, size_t steps, Found *found)
{
    RandomWorld *made = &run->made;
    const bool has_energy = made->is_passive && !made->is_wild;
    const double start = random_world_energy(made);
    double most = start;
    double scale = random_world_kinetic(made);
    size_t ok = 0;
    size_t tried = 0;
    bool is_alive = true;
    const double begun = seconds();
    for (size_t i = 0; i < steps && is_alive; i++) {
        bool is_ok = false;
        random_world_drive(made);
        is_alive = make_step(run, found, &is_ok);
        ok += is_ok ? 1 : 0;
        tried++;
        if (is_alive) {
            JpWorldStats stats = {0};
            jp_world_stats(made->play, &stats, NULL);
            run->has_rows = stats.fallbacks > run->fallbacks;
            run->fallbacks = stats.fallbacks;
            check_sides(run, found);
        }
        found->ended += is_alive ? 0 : 1;
        is_alive = is_alive && seconds() - begun < SECONDS_MOST;
        const bool is_read =
            found->stepping != JP_STEPPING_PLAIN || random_world_stored(made) == 0.0;
        if (has_energy && is_alive && is_read) {
            const double energy = random_world_energy(made);
            most = fmax(most, energy);
            scale = fmax(scale, random_world_kinetic(made));
        }
    }
    *(made->is_wild    ? &found->wild_steps
      : made->is_plain ? &found->plain_steps
                       : &found->stiff_steps) += tried;
    *(made->is_wild ? &found->wild_ok : made->is_plain ? &found->plain_ok : &found->stiff_ok) += ok;
    if (has_energy && scale > 0.0) {
        const double growth = (most - start) / scale;
        found->passive++;
        if (!run->is_coarse && !(growth <= GROWTH)) {
            blame(run, "energy that grows");
        }
        found->passive_ok += run->is_coarse ? 0 : 1;
        keep_worst(growth, run->number, run->is_coarse ? &found->coarse_growth : &found->growth,
                   &found->at[run->is_coarse ? 4 : 2]);
    }
}

static void print_found(const Found *found)
{
    printf("%s: %zu worlds, %zu of %zu plain steps JP_OK (%.2f %%) and %zu JP_COARSE, %zu of %zu "
           "stiff JP_OK and %zu JP_COARSE, %zu of %zu wild JP_OK; %zu impacts; %zu worlds "
           "ended; "
           "slowest step %.3g s (world %u)\n",
           NAMES[found->stepping], found->worlds, found->plain_ok, found->plain_steps,
           100.0 * (double)found->plain_ok / fmax(1.0, (double)found->plain_steps),
           found->plain_coarse, found->stiff_ok, found->stiff_steps, found->stiff_coarse,
           found->wild_ok, found->wild_steps, found->impacts, found->ended, found->slowest,
           found->at[3]);
    printf("    %zu peaks above the law by at most %.3g (world %u), damped %.3g (world %u); "
           "%zu passive worlds gain at most %.3g (world %u), %zu with steps that are not JP_OK "
           "%.3g (world %u)\n",
           found->peaks, found->peak, found->at[0], found->damped, found->at[1], found->passive_ok,
           found->growth, found->at[2], found->passive - found->passive_ok, found->coarse_growth,
           found->at[4]);
}

static Found run_worlds(JpStepping stepping, unsigned first, unsigned count, const size_t steps[2],
                        bool is_control)
{
    Found found = {.stepping = stepping,
                   .is_control = is_control,
                   .peak = -INFINITY,
                   .damped = -INFINITY,
                   .growth = -INFINITY,
                   .coarse_growth = -INFINITY};
    for (unsigned number = first; number < first + count; number++) {
        Run run = {.number = number, .made = random_world(number, stepping)};
        const size_t count_of = steps[run.made.is_passive && !run.made.is_wild ? 1 : 0];
        run_world(&run, count_of, &found);
        found.worlds++;
        if (run.fault != NULL) {
            found.faults++;
            printf("world %u, %s: %s\n", number, NAMES[stepping], run.fault);
        }
        random_world_finish(&run.made);
    }
    return found;
}

int main(int argc, char **argv)
{
    unsigned long numbers[4] = {1, 40, 100, 400};
    for (int i = 1; i < argc && i <= 4; i++) {
        numbers[i - 1] = strtoul(argv[i], NULL, 10);
    }
    const size_t steps[2] = {numbers[2], numbers[3]};
    unsigned faults = 0;
    dInitODE2(0);
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        if (argc > 5 && strcmp(argv[5], "all") != 0 && strcmp(argv[5], NAMES[stepping]) != 0) {
            continue;
        }
        const Found found = run_worlds((JpStepping)stepping, (unsigned)numbers[0],
                                       (unsigned)numbers[1], steps, argc > 6);
        print_found(&found);
        const bool is_enough = (double)found.plain_ok >= LEAST_OK * (double)found.plain_steps;
        faults += found.faults + (is_enough ? 0 : 1);
    }
    dCloseODE();
    return faults > 0 ? 1 : 0;
}
