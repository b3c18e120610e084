// Finds the motions that a random case settles in, from many starts, without the program: the truth
// beside which the program's settling is judged.
//
//     settled_truth SEED [FIRST [LAST]]   the random cases of a seed, 1 to 60
//     settled_truth NAME...               A, B, C, G, D600: cases known elsewhere
//     settled_truth --first PERIODS SEED CASE   the largest force of the first periods from the
//     settled_truth --first PERIODS NAME        case's own start
//
// A start is a position anywhere in the play and a relative velocity of at most what crosses the
// play twice in a period, or what the first 50 periods from the case's own start reach. One
// coordinate: 64 starts of 500 periods; linkages: 16 of 200. A start ends where it has repeated for
// 100 periods. Those that do not repeat are turned twice, four and eight times as long, as long as
// one of the others repeats, one seems to be about to, they disagree in their quantiles, or the
// last quarter of all their periods differs from the quarter before: then they may be in a
// transient.
//
// One line a motion:
//   period         of the motion in periods of the case, 1 to 12; 0: it does not repeat
//   starts of      that come to it
//   force          the largest of the motion; where it does not repeat its 95 % quantile
//   q95 median largest   of the largest force in each period; over the later half of all its starts
//   spread         of the starts, over the force: of a motion that repeats of its force, of another
//                  of the 95 % quantiles of single starts
//   settled-after  periods until the force of each period stays within 1e-3 of the motion's: least,
//                  median and most of its starts; -1 where it does not repeat
#include "settled_turn.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PERIOD_MOST = 12,
    PILOT = 50,
    LONGEST = 8,
    WINDOW = 100,
    CHECKED = 20,
    SECTION = 4,
    WALL_STARTS = 64,
    WALL_PERIODS = 500,
    PIN_STARTS = 16,
    PIN_PERIODS = 200,
};

// of a step: forces of a motion that repeats are then good to 1e-7; linkages, whose contacts are
// many and whose motions hardly ever repeat, to 1e-5
static const double TOLERANCE_WALL = 1e-9;
static const double TOLERANCE_PIN = 1e-7;
// the first period is compared with the program's own, impacts multiply what it is off by
static const double TOLERANCE_FIRST = 1e-12;
// of sections over their scales and of forces over the largest
static const double REPEATS = 1e-5;
static const double SEEMS_TO = 1e-2;
static const double IS_SAME = 1e-3;
static const double HAS_SETTLED = 1e-3;
// between the quantiles of starts that do not repeat: motions of their own
static const double IS_OTHER = 0.15;
// between quarters: in the 95 % quantile, and in the median, which moves more by chance
static const double QUANTILE_MOVES = 0.1;
static const double MEDIAN_MOVES = 0.2;
// of the imposed motion: where nothing ever separates errors are measured by this
static const double LENGTH_LEAST = 1e-2;

// What became of one start.
typedef struct Start {
    Turn turn;
    size_t count;                // of periods turned
    double *peaks;               // by period
    double (*sections)[SECTION]; // likewise, at its end
    int period;                  // 0: it does not repeat
    double nearest;              // of the sections of a period before, over the window
    double q95;                  // of the later half
    int motion;
} Start;

typedef struct Truth {
    const SettledCase *sizes;
    Model model;
    TurnScale scale;  // of errors and sections
    double low, high; // of a wall: between which starts lie
    double speed;     // of starts at most
    int start_count;
    size_t periods;
    Start *starts;
    double *pool; // room for the forces of all periods of all starts
    int motion_count;
} Truth;

static double distance(const Start *start, size_t a, size_t b)
{
    double largest = 0.0;
    for (int i = 0; i < SECTION; i++) {
        largest = fmax(largest, fabs(start->sections[a][i] - start->sections[b][i]));
    }
    return largest;
}

// By how much the last periods differ from those so many before, forces included.
static double change_over(const Start *start, size_t period)
{
    double largest = 0.0;
    double force = 0.0;
    double change = 0.0;
    for (size_t k = start->count - WINDOW; k < start->count; k++) {
        largest = fmax(largest, distance(start, k, k - period));
        force = fmax(force, start->peaks[k]);
        change = fmax(change, fabs(start->peaks[k] - start->peaks[k - period]));
    }
    return fmax(largest, force > 0.0 ? change / force : 0.0);
}

// The period to a tolerance; 0 where there is none, or where a shorter one is nearly as good: then
// what is left of the start still dies away.
static int period_to(Start *start, double tolerance)
{
    start->nearest = INFINITY;
    for (int p = 1; p <= PERIOD_MOST; p++) {
        const double change = change_over(start, (size_t)p);
        if (change <= tolerance && start->nearest > fmax(IS_SAME, tolerance)) {
            return p;
        }
        start->nearest = fmin(start->nearest, change);
    }
    return 0;
}

static double tolerance_of(const Model *model)
{
    return model->is_pin ? TOLERANCE_PIN : TOLERANCE_WALL;
}

static void take_section(const Truth *truth, const Turn *turn, double *section)
{
    for (int i = 0; i < 2; i++) {
        section[i] = turn->offset.x[i] / truth->scale.length;
        section[2 + i] = turn->offset.v[i] / truth->scale.speed;
    }
}

static void turn_on(const Truth *truth, Start *start, size_t periods)
{
    start->peaks = realloc(start->peaks, periods * sizeof *start->peaks);
    start->sections = realloc(start->sections, periods * sizeof *start->sections);
    if (start->peaks == NULL || start->sections == NULL) {
        abort();
    }
    while (start->count < periods && start->period == 0) {
        turn_period(&start->turn);
        start->peaks[start->count] = start->turn.peak;
        take_section(truth, &start->turn, start->sections[start->count++]);
        if (start->turn.is_failed) {
            fprintf(stderr, "%s: a start failed in period %zu\n", truth->sizes->name, start->count);
            exit(1);
        }
        if (start->count > WINDOW + PERIOD_MOST && start->count % CHECKED == 0) {
            start->period = period_to(start, REPEATS);
        }
    }
}

// What the imposed motion suggests for the scales of a first run.
static TurnScale first_scale(const Model *model)
{
    const ModelWall *wall = &model->wall;
    double length = model->is_pin ? model->clearance : wall->high - wall->low;
    if (!model->is_pin && !isfinite(length)) {
        length = wall->amplitude > 0.0                      ? wall->amplitude
                 : isfinite(wall->high) && wall->high > 0.0 ? wall->high
                                                            : 1e-2;
    }
    return (TurnScale){length, 2.0 * length / model->period};
}

// The range of the play, and what the motion from the case's own start reaches.
static void run_pilot(Truth *truth)
{
    const Model *model = &truth->model;
    double y[MODEL_STATES] = {0.0};
    model_written(model, truth->sizes, y);
    const TurnScale first = first_scale(model);
    Turn turn = turn_start(model, first, tolerance_of(model), y);
    for (int k = 0; k < PILOT; k++) {
        turn_period(&turn);
    }
    truth->low = isfinite(model->wall.low) ? model->wall.low : -turn.reached;
    truth->high = isfinite(model->wall.high) ? model->wall.high : turn.reached;
    const double play = model->is_pin ? 2.0 * model->clearance : truth->high - truth->low;
    truth->speed = fmax(2.0 * play / model->period, turn.fastest);
    truth->scale.length =
        model->is_pin ? model->clearance : fmax(play, LENGTH_LEAST * first.length);
    truth->scale.speed = fmax(2.0 * truth->scale.length / model->period, turn.fastest);
}

// A point of the unit disc.
static void draw_in_disc(SettledDraw *draw, double point[2])
{
    do {
        point[0] = settled_draw(draw, -1.0, 1.0);
        point[1] = settled_draw(draw, -1.0, 1.0);
    } while (hypot(point[0], point[1]) > 1.0);
}

static void draw_start(const Truth *truth, SettledDraw *draw, double *y)
{
    double x[2] = {0.0};
    double v[2] = {0.0};
    do {
        if (truth->model.is_pin) {
            draw_in_disc(draw, x);
            draw_in_disc(draw, v);
        } else {
            v[0] = settled_draw(draw, -1.0, 1.0);
        }
        for (int i = 0; i < 2; i++) {
            x[i] *= truth->model.clearance;
            v[i] *= truth->speed;
        }
        if (!truth->model.is_pin) {
            x[0] = settled_draw(draw, truth->low, truth->high);
        }
    } while (!model_place(&truth->model, x, v, y));
}

static uint64_t hash_of(const char *name)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (; *name != '\0'; name++) {
        hash = (hash ^ (unsigned char)*name) * 0x100000001b3u;
    }
    return hash;
}

static int compare(const void *a, const void *b)
{
    const double left = *(const double *)a;
    const double right = *(const double *)b;
    return (left > right) - (left < right);
}

// The quantile of sorted numbers.
static double quantile(const double *sorted, size_t count, double share)
{
    const double at = share * (double)(count - 1);
    const size_t low = (size_t)at;
    const size_t high = low + 1 < count ? low + 1 : low;
    return sorted[low] + (at - (double)low) * (sorted[high] - sorted[low]);
}

// The largest forces of the periods that stand for a start: its last period, or its later half.
static size_t add_peaks(const Start *start, double *pool, size_t used)
{
    const size_t kept = start->period > 0 ? (size_t)start->period : start->count / 2;
    memcpy(pool + used, start->peaks + start->count - kept, kept * sizeof *pool);
    return used + kept;
}

static void find_quantile(Start *start, double *pool)
{
    const size_t used = add_peaks(start, pool, 0);
    qsort(pool, used, sizeof *pool, compare);
    start->q95 = quantile(pool, used, 0.95);
}

// Whether a quantile of the starts that do not repeat lies further than that from another.
static bool is_apart(const Truth *truth)
{
    double sorted[WALL_STARTS];
    size_t count = 0;
    for (int i = 0; i < truth->start_count; i++) {
        Start *start = &truth->starts[i];
        if (start->period == 0) {
            find_quantile(start, truth->pool);
            sorted[count++] = start->q95;
        }
    }
    qsort(sorted, count, sizeof *sorted, compare);
    bool is_any = false;
    for (size_t i = 1; i < count; i++) {
        is_any = is_any || sorted[i] > sorted[i - 1] * (1.0 + IS_OTHER);
    }
    return is_any;
}

typedef struct Level {
    double median, q95;
} Level;

// The forces in a quarter of their periods, of all starts that do not repeat.
static Level level_of(const Truth *truth, size_t quarter)
{
    size_t used = 0;
    for (int i = 0; i < truth->start_count; i++) {
        const Start *start = &truth->starts[i];
        const size_t length = start->count / 4;
        if (start->period == 0) {
            memcpy(truth->pool + used, start->peaks + quarter * length, length * sizeof(double));
            used += length;
        }
    }
    qsort(truth->pool, used, sizeof *truth->pool, compare);
    return (Level){quantile(truth->pool, used, 0.5), quantile(truth->pool, used, 0.95)};
}

static bool is_moving(const Truth *truth)
{
    const Level before = level_of(truth, 2);
    const Level last = level_of(truth, 3);
    return fabs(last.q95 - before.q95) > QUANTILE_MOVES * before.q95 ||
           fabs(last.median - before.median) > MEDIAN_MOVES * before.median;
}

// Whether starts that do not repeat may still be in a transient.
static bool is_undecided(const Truth *truth)
{
    int repeating = 0;
    bool seems_to = false;
    for (int i = 0; i < truth->start_count; i++) {
        repeating += truth->starts[i].period > 0;
        seems_to = seems_to || truth->starts[i].nearest < SEEMS_TO;
    }
    return repeating < truth->start_count &&
           (repeating > 0 || seems_to || is_apart(truth) || is_moving(truth));
}

static void run_starts(Truth *truth)
{
    SettledDraw draw = settled_draw_start(hash_of(truth->sizes->name), 77);
    for (int i = 0; i < truth->start_count; i++) {
        double y[MODEL_STATES] = {0.0};
        draw_start(truth, &draw, y);
        Start *start = &truth->starts[i];
        start->turn = turn_start(&truth->model, truth->scale, tolerance_of(&truth->model), y);
        turn_on(truth, start, truth->periods);
    }
    for (size_t longer = 2; longer <= LONGEST && is_undecided(truth); longer *= 2) {
        for (int i = 0; i < truth->start_count; i++) {
            turn_on(truth, &truth->starts[i], longer * truth->periods);
        }
    }
    // what still dies away by then is taken as it is
    for (int i = 0; i < truth->start_count; i++) {
        Start *start = &truth->starts[i];
        start->period = start->period > 0 ? start->period : period_to(start, IS_SAME);
    }
}

static double largest_of(const Start *start)
{
    double largest = 0.0;
    for (size_t k = start->count - (size_t)start->period; k < start->count; k++) {
        largest = fmax(largest, start->peaks[k]);
    }
    return largest;
}

// Whether two starts that repeat do so in one motion: sections and forces of a period agree, in the
// order of some of its periods.
static bool is_same(const Start *a, const Start *b)
{
    const size_t p = (size_t)a->period;
    const double force = largest_of(a);
    for (size_t shift = 0; a->period == b->period && shift < p; shift++) {
        bool agrees = true;
        for (size_t k = 0; k < p && agrees; k++) {
            const size_t i = a->count - p + k;
            const size_t j = b->count - p + (k + shift) % p;
            for (int n = 0; n < SECTION; n++) {
                agrees = agrees && fabs(a->sections[i][n] - b->sections[j][n]) <= IS_SAME;
            }
            agrees = agrees && fabs(a->peaks[i] - b->peaks[j]) <= IS_SAME * force;
        }
        if (agrees) {
            return true;
        }
    }
    return false;
}

// Starts that do not repeat, in the order of their quantiles, are one motion until there is a gap.
static void sort_others(Truth *truth)
{
    double bound = -INFINITY;
    for (;;) {
        Start *next = NULL;
        for (int i = 0; i < truth->start_count; i++) {
            Start *start = &truth->starts[i];
            if (start->motion < 0 && (next == NULL || start->q95 < next->q95)) {
                next = start;
            }
        }
        if (next == NULL) {
            return;
        }
        truth->motion_count += next->q95 > bound;
        next->motion = truth->motion_count - 1;
        bound = next->q95 * (1.0 + IS_OTHER);
    }
}

static void find_motions(Truth *truth)
{
    for (int i = 0; i < truth->start_count; i++) {
        Start *start = &truth->starts[i];
        start->motion = -1;
        find_quantile(start, truth->pool);
        for (int k = 0; k < i && start->period > 0 && start->motion < 0; k++) {
            if (is_same(start, &truth->starts[k])) {
                start->motion = truth->starts[k].motion;
            }
        }
        if (start->period > 0 && start->motion < 0) {
            start->motion = truth->motion_count++;
        }
    }
    sort_others(truth);
}

// After how many periods the forces stay near those of the motion.
static double settled_after(const Start *start)
{
    const size_t p = (size_t)start->period;
    const double near = HAS_SETTLED * largest_of(start);
    size_t k = start->count;
    while (p > 0 && k > 0) {
        const size_t alike = start->count - p + (k - 1 + p - start->count % p) % p;
        if (!(fabs(start->peaks[k - 1] - start->peaks[alike]) <= near)) {
            break;
        }
        k--;
    }
    return p > 0 ? (double)k : -1.0;
}

typedef struct Bounds {
    double least, most;
} Bounds;

static Bounds bounds_of(const Truth *truth, int motion)
{
    Bounds bounds = {INFINITY, 0.0};
    for (int i = 0; i < truth->start_count; i++) {
        const Start *start = &truth->starts[i];
        if (start->motion == motion) {
            const double force = start->period > 0 ? largest_of(start) : start->q95;
            bounds.least = fmin(bounds.least, force);
            bounds.most = fmax(bounds.most, force);
        }
    }
    return bounds;
}

static void print_motion(const Truth *truth, int motion)
{
    double *pool = truth->pool;
    double after[WALL_STARTS];
    size_t used = 0;
    size_t count = 0;
    const Start *first = NULL;
    for (int i = 0; i < truth->start_count; i++) {
        const Start *start = &truth->starts[i];
        if (start->motion == motion) {
            first = first == NULL ? start : first;
            after[count++] = settled_after(start);
            used = first->period > 0 && used > 0 ? used : add_peaks(start, pool, used);
        }
    }
    qsort(pool, used, sizeof *pool, compare);
    qsort(after, count, sizeof *after, compare);
    const Bounds bounds = bounds_of(truth, motion);
    const double q95 = quantile(pool, used, 0.95);
    const double force = first->period > 0 ? largest_of(first) : q95;
    printf("%-15s %d %2d %2zu %2d %#.8g %#.8g %#.8g %#.8g %.1e %g %g %g\n", truth->sizes->name,
           motion + 1, first->period, count, truth->start_count, force, q95,
           quantile(pool, used, 0.5), pool[used - 1], (bounds.most - bounds.least) / force,
           after[0], quantile(after, count, 0.5), after[count - 1]);
}

static void find_truth(const SettledCase *sizes)
{
    Truth truth = {.sizes = sizes, .model = model_make(sizes)};
    truth.start_count = truth.model.is_pin ? PIN_STARTS : WALL_STARTS;
    truth.periods = truth.model.is_pin ? PIN_PERIODS : WALL_PERIODS;
    truth.starts = calloc((size_t)truth.start_count, sizeof *truth.starts);
    truth.pool = calloc((size_t)truth.start_count * truth.periods * LONGEST, sizeof *truth.pool);
    if (truth.starts == NULL || truth.pool == NULL) {
        abort();
    }
    run_pilot(&truth);
    run_starts(&truth);
    find_motions(&truth);
    size_t evaluations = 0;
    for (int i = 0; i < truth.start_count; i++) {
        evaluations += truth.starts[i].turn.evaluations;
    }
    for (int motion = 0; motion < truth.motion_count; motion++) {
        print_motion(&truth, motion);
    }
    fflush(stdout);
    fprintf(stderr, "%s: %.1f M evaluations, play %.3g, speed %.3g\n", sizes->name,
            1e-6 * (double)evaluations, truth.scale.length, truth.speed);
    for (int i = 0; i < truth.start_count; i++) {
        free(truth.starts[i].peaks);
        free(truth.starts[i].sections);
    }
    free(truth.starts);
    free(truth.pool);
}

// The largest force of the first periods from the case's own start.
static void print_first(const SettledCase *sizes, int periods)
{
    const Model model = model_make(sizes);
    double y[MODEL_STATES] = {0.0};
    model_written(&model, sizes, y);
    Turn turn = turn_start(&model, first_scale(&model), TOLERANCE_FIRST, y);
    double largest = 0.0;
    for (int k = 0; k < periods; k++) {
        turn_period(&turn);
        largest = fmax(largest, turn.peak);
    }
    printf("%s %.10g\n", sizes->name, largest);
}

static bool find_case(const char *word, const char *number, SettledCase *sizes)
{
    if (number == NULL) {
        return settled_case_named(word, sizes);
    }
    *sizes = settled_case_draw(strtoull(word, NULL, 10), atoi(number));
    return true;
}

static int print_usage(void)
{
    fprintf(stderr, "usage: settled_truth SEED [FIRST [LAST]] | NAME... | --first PERIODS SEED "
                    "CASE | --first PERIODS NAME\n");
    return 2;
}

static void print_head(void)
{
    printf("# case motion period starts of force q95 median largest spread settled-after: least "
           "median most\n");
}

int main(int argc, char **argv)
{
    SettledCase sizes;
    if (argc < 2) {
        return print_usage();
    }
    if (strcmp(argv[1], "--first") == 0) {
        if (argc < 4 || !find_case(argv[3], argc > 4 ? argv[4] : NULL, &sizes)) {
            return print_usage();
        }
        print_first(&sizes, atoi(argv[2]));
        return 0;
    }
    print_head();
    if (settled_case_named(argv[1], &sizes)) {
        for (int i = 1; i < argc; i++) {
            if (!settled_case_named(argv[i], &sizes)) {
                return print_usage();
            }
            find_truth(&sizes);
        }
        return 0;
    }
    const int first = argc > 2 ? atoi(argv[2]) : 1;
    const int last = argc > 3 ? atoi(argv[3]) : argc > 2 ? first : SETTLED_CASES;
    for (int number = first; number <= last; number++) {
        sizes = settled_case_draw(strtoull(argv[1], NULL, 10), number);
        find_truth(&sizes);
    }
    return 0;
}
