// Finds by what factor small changes of the state grow in a revolution of a settled motion.
//
// Beside the settled motion two others are turned, whose bodies start a little faster or slower.
// With x_k the difference of the velocities of one from those of the settled motion at the end of
// revolution k, small against them and far above rounding, two modes that last longest give
//     x_(k+2p) = a x_(k+p) + b x_k
// of a motion that repeats every p revolutions. a and b by least squares, each equation over
// |x_k|; the growth a revolution is |z|^(1/p) of the larger root of z^2 = a z + b. Where the motion
// does not repeat, or too few differences can be told, the growth is that of |x| alone: its mean
// over the revolutions.
#include "base/zeroed.h"
#include "run/settle_parts.h"

#include <math.h>
#include <stdlib.h>

enum {
    GROWTH_STARTS = 2,      // beside the motion itself
    GROWTH_MOST = 10,       // revolutions, and some more of longer periods
    GROWTH_PERIOD_MOST = 4, // that modes are looked for of
};

// Of a start, over the drive's speed at the bodies' reach: small enough for what follows to be in
// proportion to it, with room to die out by the first and to grow by the second.
static const double GROWTH_REPEATING = 1e-5;
static const double GROWTH_RANDOM = 1e-7;

// 1: changes that can be told from those of the reference's tolerance, which it has for settling,
// and that are still in proportion
static const double GROWTH_LEAST = 30.0 * 1e-10;
static const double GROWTH_LARGEST = 1e-3;

// of the drive's speed at the bodies' reach, in which a start is changed, at most so many are the
// fastest point's speed, in which sections are compared
static const double START_SHARE = 10.0;

// 1: the squared sine of the angle between x_k and x_(k+p), below which there is one mode alone
static const double ONE_MODE = 1e-4;

// The settled motion, and those beside it.
typedef struct Beside {
    Settling settling;
    bool is_made; // whether there is such a start
    bool is_run;  // whether it came through all its revolutions
} Beside;

static double difference_at(const Beside *starts, size_t start, size_t number, size_t rate)
{
    return starts[start].settling.revolutions[number].section[rate] -
           starts[0].settling.revolutions[number].section[rate];
}

static size_t rate_count(const Beside *starts)
{
    return SETTLE_RATES * starts[0].settling.scenario.linkage.body_count;
}

// |x_k|, over the fastest point's speed.
static double sections_apart(const Beside *starts, size_t start, size_t number)
{
    double apart = 0.0;
    for (size_t i = 0; i < rate_count(starts); i++) {
        apart = fmax(apart, fabs(difference_at(starts, start, number, i)));
    }
    return apart / starts[0].settling.fastest;
}

static bool is_told(const Beside *starts, size_t start, size_t number)
{
    if (number >= starts[0].settling.count || number >= starts[start].settling.count) {
        return false;
    }
    const double apart = sections_apart(starts, start, number);
    return apart >= GROWTH_LEAST && apart <= GROWTH_LARGEST;
}

// The sums of the least squares: of x_(k+p) and x_k with themselves, each other and x_(k+2p).
typedef struct GrowthSums {
    size_t count; // equations, each of all rates
    double now_now;
    double now_then;
    double then_then;
    double now_next;
    double then_next;
} GrowthSums;

static void add_equation(const Beside *starts, size_t start, size_t k, size_t p, GrowthSums *sums)
{
    const double size = sections_apart(starts, start, k) * starts[0].settling.fastest;
    for (size_t i = 0; i < rate_count(starts); i++) {
        const double then = difference_at(starts, start, k, i) / size;
        const double now = difference_at(starts, start, k + p, i) / size;
        const double next = difference_at(starts, start, k + 2 * p, i) / size;
        sums->now_now += now * now;
        sums->now_then += now * then;
        sums->then_then += then * then;
        sums->now_next += now * next;
        sums->then_next += then * next;
    }
    sums->count++;
}

// |z| of the larger root of z^2 = a z + b.
static double larger_root(double a, double b)
{
    const double under = 0.25 * a * a + b;
    return under < 0.0 ? sqrt(-b) : fabs(0.5 * a) + sqrt(under);
}

// Growth over p revolutions, by two modes or one; NAN of too few equations.
static double growth_of_modes(const Beside *starts, size_t p, size_t *revolutions)
{
    GrowthSums sums = {0};
    for (size_t i = 1; i <= GROWTH_STARTS; i++) {
        for (size_t k = 0; starts[i].is_run && k + 2 * p < starts[i].settling.count; k++) {
            if (is_told(starts, i, k) && is_told(starts, i, k + p) &&
                is_told(starts, i, k + 2 * p)) {
                add_equation(starts, i, k, p, &sums);
                *revolutions = k + 2 * p > *revolutions ? k + 2 * p : *revolutions;
            }
        }
    }
    if (sums.count < 2) {
        return NAN;
    }
    const double both = sums.now_now * sums.then_then;
    const double determinant = both - sums.now_then * sums.now_then;
    if (determinant < ONE_MODE * both) {
        return fabs(sums.now_next / sums.now_now);
    }
    const double a =
        (sums.now_next * sums.then_then - sums.then_next * sums.now_then) / determinant;
    const double b = (sums.then_next * sums.now_now - sums.now_next * sums.now_then) / determinant;
    return larger_root(a, b);
}

// The most that a change can have grown that was gone before two of its sizes could be told; NaN of
// one that is still there.
static SettledGrowth gone_growth(const Beside *starts, size_t start, double size)
{
    const size_t count = starts[start].settling.count;
    size_t gone = 0;
    while (gone < count && sections_apart(starts, start, gone) >= GROWTH_LEAST) {
        gone++;
    }
    if (gone == count) {
        return (SettledGrowth){.factor = NAN};
    }
    // a drive that stands still as the revolution begins says nothing of how far the start is away
    if (gone == 0 && !drive_is_steady(&starts[0].settling.scenario.linkage.driver)) {
        return (SettledGrowth){.factor = NAN};
    }
    const double before = gone == 0 ? size / START_SHARE : sections_apart(starts, start, gone - 1);
    return (SettledGrowth){.factor = GROWTH_LEAST / before, .is_at_most = true, .revolutions = 1};
}

// The mean growth of |x| in a revolution, of the start in which it is larger.
static SettledGrowth mean_growth(const Beside *starts, double size)
{
    SettledGrowth growth = {.factor = NAN};
    for (size_t i = 1; i <= GROWTH_STARTS; i++) {
        if (!starts[i].is_run) {
            continue;
        }
        const size_t count = starts[i].settling.count;
        size_t first = 0;
        while (first < count && !is_told(starts, i, first)) {
            first++;
        }
        size_t last = first;
        while (is_told(starts, i, last + 1)) {
            last++;
        }
        SettledGrowth found = {.factor = NAN, .revolutions = last - first};
        if (last > first) {
            const double grown = sections_apart(starts, i, last) / sections_apart(starts, i, first);
            found.factor = pow(grown, 1.0 / (double)(last - first));
        } else {
            found = gone_growth(starts, i, size);
        }
        growth = !(found.factor <= growth.factor) && !isnan(found.factor) ? found : growth;
    }
    return growth;
}

static SettledGrowth find_growth(const Beside *starts, size_t period, double size)
{
    if (period > 0 && period <= GROWTH_PERIOD_MOST) {
        size_t revolutions = 0;
        const double growth = growth_of_modes(starts, period, &revolutions);
        if (isfinite(growth)) {
            return (SettledGrowth){.factor = pow(growth, 1.0 / (double)period),
                                   .revolutions = revolutions};
        }
    }
    return mean_growth(starts, size);
}

// The runs, revolution by revolution, all of them at the same time.

struct BesideRuns {
    Beside starts[1 + GROWTH_STARTS];
    size_t period;
    double size;
    size_t most;   // revolutions of each
    size_t turned; // that all have had
    size_t begun;  // starts, of the next
    size_t going;  // that are being turned
    bool is_over;  // there will be no further one
};

BesideRuns *beside_runs_begin(const Scenario *scenario, TurnWatch *watch)
{
    if (scenario->settled.motion_count == 0) {
        return NULL;
    }
    BesideRuns *runs = zeroed(1, sizeof *runs);
    const size_t period = scenario->settled.motions[0].period;
    const size_t more = period > 1 && period <= GROWTH_PERIOD_MOST ? 2 * (period - 1) : 0;
    runs->period = period;
    runs->size = period > 0 ? GROWTH_REPEATING : GROWTH_RANDOM;
    runs->most = GROWTH_MOST + more;
    for (size_t i = 0; i <= GROWTH_STARTS; i++) {
        Beside *beside = &runs->starts[i];
        beside->settling = settling_start(scenario);
        beside->settling.watch = watch;
        beside->is_made =
            i == 0 || settle_change_start(&beside->settling.scenario, runs->size, (unsigned)i);
        beside->is_run = beside->is_made;
    }
    watch->most += (1 + GROWTH_STARTS) * runs->most;
    return runs;
}

// Whether nothing more can be told of a start that has turned: over a whole period it was nearer to
// the settled motion than differences can be told, or, where that does not repeat, farther than
// they are in proportion.
static bool is_over(const BesideRuns *runs, size_t start)
{
    const size_t count = runs->starts[start].settling.count;
    const size_t period = runs->period > 0 ? runs->period : 1;
    bool is_over = count >= period;
    for (size_t k = 1; is_over && k <= period; k++) {
        const double apart = sections_apart(runs->starts, start, count - k);
        is_over = runs->period > 0 ? apart < GROWTH_LEAST : apart > GROWTH_LARGEST;
    }
    return is_over;
}

static bool are_over(const BesideRuns *runs)
{
    bool are_over = runs->turned == runs->most || !runs->starts[0].is_run;
    bool are_beside = false;
    for (size_t i = 1; !are_over && i <= GROWTH_STARTS; i++) {
        are_beside = are_beside || (runs->starts[i].is_run && !is_over(runs, i));
    }
    return are_over || !are_beside;
}

static SideBySideNext beside_runs_next(size_t *index, void *context)
{
    BesideRuns *runs = context;
    if (runs->begun > GROWTH_STARTS && runs->going > 0) {
        return SIDE_BY_SIDE_LATER;
    }
    if (runs->begun > GROWTH_STARTS && !runs->is_over) {
        runs->turned++;
        runs->is_over = are_over(runs);
        runs->begun = 0;
    }
    if (runs->is_over) {
        return SIDE_BY_SIDE_NONE;
    }
    *index = runs->begun++;
    runs->going++;
    return SIDE_BY_SIDE_PIECE;
}

static void beside_runs_work(size_t index, bool is_callers, void *context)
{
    Beside *beside = &((BesideRuns *)context)->starts[index];
    Err unused = {ERR_NONE, ""};
    beside->settling.is_callers = is_callers;
    beside->is_run = beside->is_run && settling_turn(&beside->settling, &unused);
}

static void beside_runs_ended(size_t index, void *context)
{
    (void)index;
    ((BesideRuns *)context)->going--;
}

SideBySideTasks beside_runs_tasks(BesideRuns *runs)
{
    return (SideBySideTasks){
        .most = 1 + GROWTH_STARTS,
        .next = beside_runs_next,
        .work = beside_runs_work,
        .end = beside_runs_ended,
        .context = runs,
    };
}

void beside_runs_end(BesideRuns *runs, Scenario *scenario)
{
    SettledStart *settled = &scenario->settled;
    settled->has_growth = true;
    settled->growth = runs->starts[0].is_run ? find_growth(runs->starts, runs->period, runs->size)
                                             : (SettledGrowth){.factor = NAN};
    for (size_t i = 0; i <= GROWTH_STARTS; i++) {
        settling_finish(&runs->starts[i].settling);
    }
    free(runs);
}
