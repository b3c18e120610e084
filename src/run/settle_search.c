// Looks for the motions that a mechanism settles in, from several starts.
//
// The first start is turned by itself for a while: what it meets says how far the others may differ
// from it (run/settle_draw.h). Then all are turned in rounds, side by side, and a start is done
// with when
// - it repeats to what the answer needs, and a while later still does, to far more digits where it
//   has them: its motion is a known one from the next round on, or
// - it is on its way into a known motion.
// What has not repeated after as many revolutions as a motion is to be watched for, and after five
// times as many as the slowest start took that does repeat, does not repeat. All of these go on
// until the intervals of their forces are as narrow as asked for. Where the budget does not allow
// that of all, some are left undecided.
//
// Starts see only motions that were known before the round, and what a start does does not depend
// on which thread turns it: but for a budget that is spent the result is the same on any machine.
#include "base/clock.h"
#include "base/zeroed.h"
#include "run/pressed.h"
#include "run/settle_draw.h"
#include "run/settle_parts.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// 1: of sections and forces, what a motion that repeats may still change by: peaks are right to it
static const double REPEATS = 1e-3;

// 1: the same of the state that runs start in: a peak's five digits and two more
static const double CONFIRMED = 1e-7;

// 1: a revolution whose forces, or whose section, differ by more from those a period before does
// not repeat it. Chance brings one or two revolutions of a motion that does not repeat as near, and
// not all of them; and peaks may well be as steady as that where the state is not.
static const double FORCES_LEFT = 2e-3;
static const double SECTION_LEFT = 1e-2;

// 1: how near a start is to a known motion that comes nearer to it, and by what share of its
// distance a period it has to
static const double JOINING = 1e-2;
static const double JOINING_SHARE = 0.7;

// Revolutions.
enum {
    FIRST_MOST = 24,     // of the first start before the others begin
    ROUND_FIRST = 8,     // of each start at the end of the first round; twice as many of the next
    ROUND_MOST = 100,    // of a round
    CONFIRM_LEAST = 16,  // after which a motion that repeats but does not gain digits is confirmed
    CONFIRM_TIMES = 2,   // and as many times those that it took
    TIMES_AS_LONG = 5,   // that one is watched for that does not repeat where others do
    STARTS_LEAST = 4,    // that are watched to the end whatever the budget
    FINISH_LOOKS = 16,   // at accelerations in each step of a known motion's last period
    ALLOWANCE_FROM = 16, // each has had, before the budget leaves further ones undecided
};

typedef enum StartState {
    START_NONE,      // there is no such start
    START_FAILED,    // `err` says why
    START_TURNING,   // it has not repeated
    START_REPEATING, // it has, and is still to be confirmed
    START_DONE,      // its motion is known to repeat
    START_UNDECIDED, // the budget did not allow to go on
} StartState;

enum { MOTION_NEW = -1 };

// One of several starts on its way.
typedef struct Start {
    struct Search *search;
    Settling settling;
    StartState state;
    Err err;
    size_t goal;    // revolutions at the end of the round
    size_t seen_at; // revolutions when it was seen to repeat
    size_t period;  // after which it was
    double change;  // 1: the most that its forces have changed by over a period since
    int motion;     // number of the known motion, or MOTION_NEW
} Start;

typedef struct Search {
    Start *starts; // owned, like all arrays
    size_t count;
    size_t *live; // numbers of those that are turned in the round
    size_t live_count;
    size_t *known; // number of the first start of each motion that repeats
    size_t known_count;
    double began_s; // of processor time
    double budget_s;
    atomic_bool is_spent;
    TurnWatch watch;
} Search;

static bool is_going(const Start *start)
{
    return start->state == START_TURNING || start->state == START_REPEATING;
}

static double spent_s(const Search *search)
{
    return clock_processor_s() - search->began_s;
}

// Whether a start is on its way into a known motion, or there.
static bool is_joining(const Settling *settling, const Settling *known, double apart)
{
    const size_t period = known->period;
    if (apart <= fmax(REPEATS, 2.0 * (known->change + known->left))) {
        return true;
    }
    if (!(apart <= JOINING)) {
        return false;
    }
    const double before = settling_were_apart(settling, period, known, period);
    const double then = settling_were_apart(settling, 2 * period, known, period);
    return apart <= JOINING_SHARE * before && before <= JOINING_SHARE * then && isfinite(then);
}

// How near a start is to a known motion, 1; done where it is on its way into it.
static double find_near(Start *start)
{
    const Search *search = start->search;
    double nearest = INFINITY;
    for (size_t i = 0; i < search->known_count && is_going(start); i++) {
        const Settling *known = &search->starts[search->known[i]].settling;
        const double apart = settling_apart(&start->settling, known, known->period);
        nearest = fmin(nearest, apart);
        if (is_joining(&start->settling, known, apart)) {
            start->state = START_DONE;
            start->motion = (int)i;
        }
    }
    return nearest;
}

// Whether it has repeated for so long, times a number, that it will, whatever digits it has.
static bool has_repeated_long(const Start *start, size_t times)
{
    const size_t since = start->settling.count - start->seen_at;
    return since >= CONFIRM_LEAST && since >= times * start->seen_at;
}

// Its motion is known to repeat, to no more digits than it has shown.
static void take_repeated(Start *start)
{
    start->settling.period = start->period;
    start->settling.change = start->change;
    start->settling.left = 0.0;
    start->state = START_DONE;
    start->motion = MOTION_NEW;
}

static void look_whether_repeats(Start *start)
{
    Settling *settling = &start->settling;
    if (start->state == START_TURNING) {
        if (settling_repeats(settling, REPEATS)) {
            start->state = START_REPEATING;
            start->seen_at = settling->count;
            start->period = settling->period;
            start->change = 0.0;
            settling->period = 0;
        }
        return;
    }
    const double change = settling_forces_change(settling, start->period);
    start->change = fmax(start->change, change);
    if (settling_repeats(settling, CONFIRMED)) {
        start->state = START_DONE;
        start->motion = MOTION_NEW;
    } else if (change > FORCES_LEFT ||
               settling_section_change(settling, start->period) > SECTION_LEFT) {
        start->state = START_TURNING;
    } else if (has_repeated_long(start, CONFIRM_TIMES)) {
        take_repeated(start);
    }
}

// Turns a start to the end of the round, or until it is done.
static void start_run(size_t index, bool is_callers, void *context)
{
    Search *search = context;
    Start *start = &search->starts[search->live[index]];
    Settling *settling = &start->settling;
    settling->is_callers = is_callers;
    double near = find_near(start);
    while (is_going(start) && settling->count < start->goal && !atomic_load(&search->is_spent)) {
        // what does not repeat counts from here on, of all its numbers
        settling->looks = settling_may_count(settling) ? 1 : 0;
        if (!settling_turn_near(settling, near, &start->err)) {
            start->state = START_FAILED;
            return;
        }
        near = find_near(start);
        if (is_going(start)) {
            look_whether_repeats(start);
        }
        if (spent_s(search) > search->budget_s) {
            atomic_store(&search->is_spent, true);
        }
    }
}

// Puts the motions that were found in the round among the known ones, in the order of the starts.
static void take_new(Search *search)
{
    for (size_t k = 0; k < search->live_count; k++) {
        Start *start = &search->starts[search->live[k]];
        if (start->state != START_DONE || start->motion != MOTION_NEW) {
            continue;
        }
        for (size_t i = 0; i < search->known_count && start->motion == MOTION_NEW; i++) {
            const Settling *known = &search->starts[search->known[i]].settling;
            const double apart = settling_apart(&start->settling, known, known->period);
            const double unsure =
                fmax(known->change + known->left, start->settling.change + start->settling.left);
            if (apart <= fmax(SETTLE_SAME_MOTION, 4.0 * unsure)) {
                start->motion = (int)i;
            }
        }
        if (start->motion == MOTION_NEW) {
            start->motion = (int)search->known_count;
            search->known[search->known_count++] = search->live[k];
        }
    }
}

// Those of the first so many starts that are on their way, to be turned to so many revolutions.
static void find_live(Search *search, size_t goal, size_t count)
{
    search->live_count = 0;
    for (size_t i = 0; i < count; i++) {
        if (is_going(&search->starts[i])) {
            search->starts[i].goal = goal;
            search->live[search->live_count++] = i;
        }
    }
}

static void run_round(Search *search, size_t goal, size_t count)
{
    find_live(search, goal, count);
    side_by_side_run(search->live_count, side_by_side_processors(), start_run, search);
    take_new(search);
}

// The starts beside the first: pressed, and drawn from what its play allows.
static void make_starts(Search *search, const Scenario *scenario)
{
    const SettleReach *reach = search->starts[0].settling.reach;
    for (size_t i = 1; i < search->count; i++) {
        Start *start = &search->starts[i];
        Err err = {ERR_NONE, ""};
        start->search = search;
        start->settling = settling_start(scenario);
        start->settling.watch = &search->watch;
        start->state = START_TURNING;
        Scenario *own = &start->settling.scenario;
        const bool is_made =
            (i == 1 && pressed_start(own, &err)) || settle_draw(own, reach, i - 1, search->count);
        if (!is_made) {
            settling_finish(&start->settling);
            start->state = START_NONE;
        }
    }
}

// Revolutions for which a start is watched before it counts as one that does not repeat.
static size_t watch_least(const Search *search, const RunOptions *run)
{
    size_t least = run->settle_least;
    for (size_t i = 0; i < search->count; i++) {
        if (search->starts[i].state == START_DONE) {
            const size_t longer = TIMES_AS_LONG * search->starts[i].settling.count;
            least = longer > least ? longer : least;
        }
    }
    return least < run->settle_most ? least : run->settle_most;
}

// Leaves as many starts undecided as the budget does not allow to watch for so long.
static void leave_undecided(Search *search, size_t goal, size_t least)
{
    const size_t turned = atomic_load(&search->watch.turned);
    const double per_turn_s = spent_s(search) / (double)(turned > 0 ? turned : 1);
    const double allowed = (search->budget_s - spent_s(search)) /
                           (per_turn_s * (double)(least > goal ? least - goal : 1));
    find_live(search, goal, search->count);
    for (size_t i = 0; i < search->live_count; i++) {
        if (i >= STARTS_LEAST && (double)i >= allowed) {
            search->starts[search->live[i]].state = START_UNDECIDED;
        }
    }
}

// Takes up what was left where others no longer need the budget.
static bool take_up(Search *search)
{
    bool is_any = false;
    for (size_t i = 0; i < search->count; i++) {
        if (search->starts[i].state == START_UNDECIDED) {
            search->starts[i].state = START_TURNING;
            is_any = true;
        }
    }
    return is_any;
}

// The motions that do not repeat.

// Their starts, and to which motion each belongs.
typedef struct Random {
    const Settling **settlings; // by start; owned, like the next three
    size_t *motions;
    size_t count;
    SettledMotion *found;
    size_t found_count;
} Random;

static void random_free(Random *random)
{
    for (size_t i = 0; i < random->found_count; i++) {
        settled_motion_free(&random->found[i]);
    }
    free(random->settlings);
    free(random->motions);
    free(random->found);
}

// The motion of all starts that belong to it.
static SettledMotion pooled(const Random *random, size_t motion, size_t of)
{
    const Settling **own = zeroed(random->count, sizeof *own);
    size_t count = 0;
    for (size_t i = 0; i < random->count; i++) {
        if (random->motions[i] == motion) {
            own[count++] = random->settlings[i];
        }
    }
    const SettledMotion found = settle_motion_of(own, count, of);
    free(own);
    return found;
}

// Sorts the starts that do not repeat by how their forces are distributed.
static Random random_motions(const Search *search, size_t of)
{
    Random random = {
        .settlings = zeroed(search->count, sizeof *random.settlings),
        .motions = zeroed(search->count, sizeof *random.motions),
        .found = zeroed(search->count, sizeof *random.found),
    };
    for (size_t i = 0; i < search->count; i++) {
        const Start *start = &search->starts[i];
        if (!is_going(start) || start->settling.count == 0) {
            continue;
        }
        const Settling *settling = &start->settling;
        const Linkage *linkage = &settling->scenario.linkage;
        SettledMotion alone = settle_motion_of(&settling, 1, of);
        size_t k = 0;
        while (k < random.found_count && settle_motions_differ(&random.found[k], &alone, linkage)) {
            k++;
        }
        settled_motion_free(&alone);
        random.settlings[random.count] = settling;
        random.motions[random.count++] = k;
        random.found_count = k < random.found_count ? random.found_count : k + 1;
        settled_motion_free(&random.found[k]);
        random.found[k] = pooled(&random, k, of);
    }
    return random;
}

// How wide the widest interval of a force is.
static double random_width(const Search *search)
{
    Random random = random_motions(search, search->count);
    double widest = 0.0;
    for (size_t k = 0; k < random.found_count; k++) {
        const Linkage *linkage = &search->starts[0].settling.scenario.linkage;
        widest = fmax(widest, settle_motion_width(&random.found[k], linkage));
    }
    random_free(&random);
    return widest;
}

// Whether a start is still to be confirmed: chance brings one that does not repeat as near to an
// earlier revolution as one that does.
static bool any_repeating(const Search *search)
{
    bool is_any = false;
    for (size_t i = 0; i < search->count; i++) {
        is_any = is_any || search->starts[i].state == START_REPEATING;
    }
    return is_any;
}

// Whether the intervals are as narrow as asked for. A half width of all of a force asks for
// nothing: few revolutions do not bound a quantile at all.
static bool is_narrow(const Search *search, double settle_to)
{
    return settle_to >= 1.0 || random_width(search) <= settle_to;
}

// Turns all starts until each is done or has been watched for long enough.
static void search_run(Search *search, const Scenario *scenario)
{
    const RunOptions *run = &scenario->run;
    const size_t first = FIRST_MOST < run->settle_most ? FIRST_MOST : run->settle_most;
    run_round(search, first, 1);
    make_starts(search, scenario);
    if (is_going(&search->starts[0])) {
        leave_undecided(search, 0, run->settle_least);
    }
    for (size_t goal = ROUND_FIRST;;) {
        goal = goal < run->settle_most ? goal : run->settle_most;
        run_round(search, goal, search->count);
        const size_t least = watch_least(search, run);
        if (goal >= ALLOWANCE_FROM && goal < least) {
            leave_undecided(search, goal, least);
        }
        find_live(search, goal, search->count);
        if (search->live_count == 0 && !take_up(search)) {
            return;
        }
        const bool is_watched =
            goal >= least && !any_repeating(search) && is_narrow(search, run->settle_to);
        if (atomic_load(&search->is_spent) || goal >= run->settle_most || is_watched) {
            return;
        }
        const size_t further = goal < ROUND_MOST ? goal : ROUND_MOST;
        goal = goal < least && goal + further > least ? least : goal + further;
    }
}

// What has repeated for a while when the search ends is taken to. Where some starts repeat and the
// budget has ended the search, one that was not watched for long enough may be on its way to them,
// and is no motion of its own.
static void decide(Search *search, const RunOptions *run)
{
    search->live_count = 0;
    for (size_t i = 0; i < search->count; i++) {
        Start *start = &search->starts[i];
        if (start->state == START_REPEATING && has_repeated_long(start, 0)) {
            take_repeated(start);
            search->live[search->live_count++] = i;
        }
    }
    take_new(search);
    const size_t least = watch_least(search, run);
    for (size_t i = 0; i < search->count; i++) {
        Start *start = &search->starts[i];
        const bool is_short = start->settling.count < least;
        if (is_going(start) && is_short && search->known_count > 0 &&
            atomic_load(&search->is_spent)) {
            start->state = START_UNDECIDED;
        }
    }
}

// One more period of each known motion, as exact as the result, in which all of its numbers are
// looked for.
static void finish_known(size_t index, bool is_callers, void *context)
{
    Search *search = context;
    Settling *settling = &search->starts[search->known[index]].settling;
    Err unused = {ERR_NONE, ""};
    settling->looks = FINISH_LOOKS;
    settling->is_callers = is_callers;
    for (size_t k = 0; k < settling->period && settling_turn(settling, &unused); k++) {
    }
}

// Puts what was found into the scenario.

void settle_take_start(const Linkage *from, Linkage *to)
{
    memcpy(to->bodies, from->bodies, to->body_count * sizeof *to->bodies);
    memcpy(to->joints, from->joints, to->joint_count * sizeof *to->joints);
    memcpy(to->torsions, from->torsions, to->torsion_count * sizeof *to->torsions);
    memcpy(to->bushings, from->bushings, to->bushing_count * sizeof *to->bushings);
    memcpy(to->loads, from->loads, to->load_count * sizeof *to->loads);
    to->driver.start = from->driver.start;
    to->torque.followed.start = from->torque.followed.start;
}

static size_t decided_count(const Search *search, size_t *tried)
{
    size_t decided = 0;
    *tried = 0;
    for (size_t i = 0; i < search->count; i++) {
        const Start *start = &search->starts[i];
        const bool is_tried = start->state != START_NONE;
        *tried += is_tried ? 1 : 0;
        decided += start->state == START_DONE || is_going(start) ? 1 : 0;
    }
    return decided;
}

// A motion that was found, and the start that runs begin in.
typedef struct Found {
    SettledMotion motion;
    const Settling *settling;
} Found;

static Found known_motion(const Search *search, size_t number, size_t of)
{
    const Settling **own = zeroed(search->count, sizeof *own);
    size_t count = 1;
    own[0] = &search->starts[search->known[number]].settling;
    for (size_t i = 0; i < search->count; i++) {
        const Start *start = &search->starts[i];
        if (start->state == START_DONE && start->motion == (int)number &&
            i != search->known[number]) {
            own[count++] = &start->settling;
        }
    }
    const Found found = {settle_motion_of(own, count, of), own[0]};
    free(own);
    return found;
}

// All motions, that of most starts first; of as many starts that which was found first.
static size_t all_motions(const Search *search, size_t of, Found *found, double *width)
{
    size_t count = 0;
    for (size_t i = 0; i < search->known_count; i++) {
        found[count++] = known_motion(search, i, of);
    }
    Random random = random_motions(search, of);
    *width = 0.0;
    for (size_t k = 0; k < random.found_count; k++) {
        size_t first = 0;
        while (random.motions[first] != k) {
            first++;
        }
        const Linkage *linkage = &random.settlings[first]->scenario.linkage;
        found[count++] = (Found){random.found[k], random.settlings[first]};
        *width = fmax(*width, settle_motion_width(&random.found[k], linkage));
        random.found[k] = (SettledMotion){0};
    }
    random_free(&random);
    for (size_t i = 1; i < count; i++) {
        const Found own = found[i];
        size_t at = i;
        for (; at > 0 && found[at - 1].motion.starts < own.motion.starts; at--) {
            found[at] = found[at - 1];
        }
        found[at] = own;
    }
    return count;
}

static void take_motions(const Search *search, Scenario *scenario)
{
    SettledStart *settled = &scenario->settled;
    Found *found = zeroed(search->count, sizeof *found);
    settled->starts = decided_count(search, &settled->tried);
    settled->motion_count = all_motions(search, settled->starts, found, &settled->width);
    settled->is_spent = atomic_load(&search->is_spent);
    settled->motions = zeroed(settled->motion_count, sizeof *settled->motions);
    for (size_t i = 0; i < settled->motion_count; i++) {
        settled->motions[i] = found[i].motion;
    }
    settled->others = zeroed(settled->motion_count, sizeof *settled->others);
    for (size_t i = 1; i < settled->motion_count; i++) {
        settled->others[i - 1] = linkage_copy(&found[i].settling->scenario.linkage);
    }
    settled->revolutions = found[0].settling->count;
    settle_take_start(&found[0].settling->scenario.linkage, &scenario->linkage);
    free(found);
    settled->first = zeroed(scenario->linkage.joint_count, sizeof *settled->first);
    const Settling *first = &search->starts[0].settling;
    for (size_t i = 0; i < scenario->linkage.joint_count && first->count > 0; i++) {
        settled->first[i] = first->revolutions[0].numbers[settle_joint_number(i, SETTLE_FORCE)];
    }
}

static Search search_create(const Scenario *first, size_t count, RunWatch watch)
{
    Search search = {
        .starts = zeroed(count, sizeof *search.starts),
        .count = count,
        .live = zeroed(count, sizeof *search.live),
        .known = zeroed(count, sizeof *search.known),
        .began_s = clock_processor_s(),
        .budget_s = first->run.settle_budget,
        .watch = turn_watch_begin(watch),
    };
    search.watch.most = count * first->run.settle_least;
    search.watch.budget_s = search.budget_s;
    return search;
}

static void search_free(Search *search)
{
    for (size_t i = 0; i < search->count; i++) {
        if (search->starts[i].state != START_NONE) {
            settling_finish(&search->starts[i].settling);
        }
    }
    free(search->starts);
    free(search->live);
    free(search->known);
}

bool settle_search(Scenario *scenario, const Scenario *first, size_t count, RunWatch watch)
{
    Search search = search_create(first, count, watch);
    search.starts[0] = (Start){
        .search = &search,
        .settling = settling_start(first),
        .state = START_TURNING,
    };
    search.starts[0].settling.watch = &search.watch;
    search_run(&search, scenario);
    decide(&search, &scenario->run);
    side_by_side_run(search.known_count, side_by_side_processors(), finish_known, &search);
    size_t tried;
    const bool is_found = decided_count(&search, &tried) > 0;
    if (is_found) {
        take_motions(&search, scenario);
    } else {
        snprintf(scenario->settled.message, sizeof scenario->settled.message,
                 "revolution %zu: %.1900s", search.starts[0].settling.count,
                 search.starts[0].err.text);
    }
    search_free(&search);
    return is_found;
}
