// Finds the multipliers of a settled motion from the change of its state over a period.
//
// x is the state at the beginning of a revolution: positions and speeds of the bodies, as far as
// joints and drive leave them free, and the speeds at which contacts under way began where their
// damping remembers these. A small change y of it has become M y after a period. With Y the changes
// of n starts, and Z what has become of them, each beside the motion itself, Z = Y A, and the
// eigenvalues of A are those of M: the multipliers (G. Floquet, Ann. Sci. ENS 12 (1883) 47). The
// largest says what becomes of most changes in the end, and its vector which they are.
//
// Speeds are changed by a share of the slowest impact of the motion, so that no contact is missed
// or met twice, positions by what these do in the time of a contact. Changes are not quite in
// proportion to that. Two more starts are therefore changed by c, half as far and to both sides
// along the vector of the largest multiplier. With z+ and z- what has become of them and y' the
// left vector,
//     y' (z+ - z-) / (y' (c+ - c-))
// is a real multiplier but for errors of second order, of which the share y' (z+ + z-) / y' (z+ -
// z-) tells; one of a pair that is not real is that of A, and wrong by y' (z - A c) / (y' c). Where
// too much is wrong nothing is found.
#include "base/dense.h"
#include "base/eigen.h"
#include "base/zeroed.h"
#include "contact/law.h"
#include "model/joint_rows.h"
#include "model/kinematics.h"
#include "model/nearest.h"
#include "run/settle_parts.h"
#include "run/settle_together.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDES = 2 };

enum {
    MONODROMY_PERIOD_MOST = 4, // revolutions
    MONODROMY_FREE_MOST = 4,   // freedoms, of position and of speed
    MONODROMY_MOST = 8,        // changes, with those of contacts; of more the other way is shorter
};

// Of the reference: what rounding and it leave is then some thousandths of the least change.
static const double MONODROMY_REFERENCE = 1e-11;

// 1: a change of speed, of the slowest impact
static const double OF_IMPACT = 3e-4;

// 1: the same where nothing impacts, of the fastest point's speed; and at least
static const double OF_FASTEST = 1e-5;
static const double OF_FASTEST_LEAST = 1e-7;

// of a revolution, in which changes of speed become those of position where nothing touches
static const double FREE_SHARE = 1e-3;

// 1: of the largest that is left of a change that joints and drive do not allow
static const double ALLOWED_LEAST = 1e-6;

// 1: of the two starts along a vector, of the size of the others
static const double ALONG_SIZE = 0.5;

// 1: how far off the largest multiplier may be, of itself; and below what it is gone
static const double RIGHT_TO = 0.02;
static const double GONE = 0.02;

// 1: what a real one that is found from two sides may differ by from that of A, of itself, and how
// far from being in proportion both sides may be: the square of it is left
static const double SIDES_APART = 0.15;

// 1: how near to 1 a multiplier is, and how small the speeds of its change, of a coordinate that
// nothing depends on, such as the angle of a roller
static const double NEUTRAL = 1e-3;

// One start on its way through a period.
typedef struct MonodromyRun {
    Settling settling;
    bool is_run;
    double *start; // state, as below, less that of the motion itself; owned, like the next
    double *end;
} MonodromyRun;

// Which contact remembers the speed at which it began.
typedef struct Memory {
    size_t joint;
    size_t place;
} Memory;

typedef enum MonodromyStage {
    STAGE_MOTION, // the motion itself
    STAGE_STARTS, // those beside it
    STAGE_SIDES,  // along the vector of the largest multiplier
    STAGE_OVER,
} MonodromyStage;

struct MonodromyRuns {
    const Scenario *scenario; // of the caller
    TurnWatch *watch;
    size_t period;
    size_t free_count;
    SpeedChange *free; // directions that joints and drive leave, each of all bodies; owned
    size_t memory_count;
    Memory memories[MONODROMY_MOST];
    size_t count;                                  // of changes
    double by;                                     // m/s, of speeds
    double time_s;                                 // that makes positions of speeds
    size_t rows;                                   // numbers of a state, all of them speeds
    MonodromyRun runs[1 + MONODROMY_MOST + SIDES]; // the motion, starts beside it, both sides
    MonodromyStage stage;
    size_t next; // run to be begun
    size_t end;  // of those of the stage
    size_t going;
    double *matrix; // A; owned
    double complex values[MONODROMY_MOST];
    size_t largest;                      // of them that which is not neutral
    double complex left[MONODROMY_MOST]; // its vectors
    double complex right[MONODROMY_MOST];
};

static double *direction_rate(SpeedChange *change, size_t rate)
{
    return rate == 0 ? &change->velocity.x : rate == 1 ? &change->velocity.y : &change->omega;
}

// The product of two changes, each rotation by what it does at the reach of its body.
static double directions_product(const Linkage *linkage, const SpeedChange *a, const SpeedChange *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const double reach = linkage_reach(linkage, (int)i);
        sum += vec2_dot(a[i].velocity, b[i].velocity) + reach * reach * a[i].omega * b[i].omega;
    }
    return sum;
}

static void directions_add(const Linkage *linkage, double factor, const SpeedChange *from,
                           SpeedChange *to)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        to[i].velocity = vec2_add(to[i].velocity, vec2_scale(factor, from[i].velocity));
        to[i].omega += factor * from[i].omega;
    }
}

// Directions of length 1, at right angles to one another, that joints and drive leave of the
// changes of each single rate, the longest of what is left first. False where there are too many.
static bool find_directions(MonodromyRuns *runs)
{
    const Linkage *linkage = &runs->scenario->linkage;
    const size_t bodies = linkage->body_count;
    const size_t each = 3 * bodies;
    SpeedChange *all = zeroed(each * bodies + 1, sizeof *all);
    Motion *motions = zeroed(bodies + 1, sizeof *motions);
    runs->free = zeroed(MONODROMY_FREE_MOST * bodies + 1, sizeof *runs->free);
    linkage_start(linkage, motions);
    for (size_t i = 0; i < each; i++) {
        const double reach = linkage_reach(linkage, (int)(i / 3));
        const double unit = i % 3 < 2 ? 1.0 : reach > 0.0 ? 1.0 / reach : 0.0;
        *direction_rate(&all[i * bodies + i / 3], i % 3) = unit;
        nearest_change(linkage, motions, all + i * bodies);
    }
    bool is_more = true;
    for (size_t count = 0; is_more && count <= MONODROMY_FREE_MOST; count++) {
        size_t longest = 0;
        double square = 0.0;
        for (size_t i = 0; i < each; i++) {
            const SpeedChange *of = all + i * bodies;
            const double found = directions_product(linkage, of, of);
            longest = found > square ? i : longest;
            square = fmax(square, found);
        }
        is_more = square > ALLOWED_LEAST * ALLOWED_LEAST;
        if (!is_more || count == MONODROMY_FREE_MOST) {
            break;
        }
        SpeedChange *next = runs->free + runs->free_count++ * bodies;
        directions_add(linkage, 1.0 / sqrt(square), all + longest * bodies, next);
        for (size_t i = 0; i < each; i++) {
            SpeedChange *of = all + i * bodies;
            directions_add(linkage, -directions_product(linkage, next, of), next, of);
        }
    }
    free(motions);
    free(all);
    return !is_more && runs->free_count > 0;
}

// The contacts that remember the speed at which they began. False where there are too many.
static bool find_memories(MonodromyRuns *runs)
{
    const Linkage *linkage = &runs->scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        for (size_t k = 0; k < JOINT_PLACES; k++) {
            const ContactState *state = &joint->contacts[k];
            ForceLaw law;
            Err unused = {ERR_NONE, ""};
            if (!state->is_touching || state->is_resting ||
                !law_of_joint(runs->scenario, joint, &law, &unused) || !(law.hysteresis > 0.0) ||
                !(state->impact_speed > law.impact_speed_floor)) {
                continue;
            }
            if (runs->memory_count == MONODROMY_MOST) {
                return false;
            }
            runs->memories[runs->memory_count++] = (Memory){i, k};
        }
    }
    return true;
}

static void add_run(MonodromyRuns *runs, size_t number)
{
    MonodromyRun *run = &runs->runs[number];
    run->settling = settling_start(runs->scenario);
    run->settling.watch = runs->watch;
    ReferenceOptions *reference = &run->settling.scenario.reference;
    reference->tolerance = fmax(runs->scenario->reference.tolerance, MONODROMY_REFERENCE);
    run->is_run = true;
    run->start = zeroed(runs->rows + 1, sizeof *run->start);
    run->end = zeroed(runs->rows + 1, sizeof *run->end);
    runs->end = number + 1;
}

static size_t turns_of(const MonodromyRuns *runs)
{
    return (1 + runs->count + SIDES) * runs->period;
}

MonodromyRuns *monodromy_runs_begin(const Scenario *scenario, TurnWatch *watch)
{
    const SettledStart *settled = &scenario->settled;
    const Linkage *linkage = &scenario->linkage;
    if (settled->motion_count == 0 || linkage->is_spatial) {
        return NULL;
    }
    const size_t period = settled->motions[0].period;
    if (period == 0 || period > MONODROMY_PERIOD_MOST) {
        return NULL;
    }
    MonodromyRuns *runs = zeroed(1, sizeof *runs);
    runs->scenario = scenario;
    runs->watch = watch;
    runs->period = period;
    const bool is_found = find_directions(runs) && find_memories(runs);
    runs->count = 2 * runs->free_count + runs->memory_count;
    if (!is_found || runs->count > MONODROMY_MOST) {
        free(runs->free);
        free(runs);
        return NULL;
    }
    runs->rows = 6 * linkage->body_count + runs->memory_count;
    watch->most += turns_of(runs);
    add_run(runs, 0);
    return runs;
}

// Lets joints with play start where moved bodies have them, to the digits of the change.
static void move_play(const Linkage *from, const Motion *motions, const Motion *moved, Linkage *to)
{
    for (size_t i = 0; i < to->joint_count; i++) {
        Joint *joint = &to->joints[i];
        if (joint_is_loose(joint->kind)) {
            const Vec2 by = vec2_sub(kinematics_opening(from, moved, (int)i),
                                     kinematics_opening(from, motions, (int)i));
            joint_rows_set_start(joint, vec2_add(joint_rows_start(joint), by));
        }
    }
}

// Closes the joints of moved bodies; pins that share freedoms start where these then are, as
// closing turns the bodies by what the starts of all together need not allow. False where they
// cannot be.
static bool close_moved(Linkage *linkage, Motion *moved)
{
    const size_t size = linkage->body_count * sizeof *moved;
    Motion *closed = zeroed(linkage->body_count + 1, sizeof *closed);
    memcpy(closed, moved, size);
    bool is_closed = nearest_positions(linkage, closed);
    if (is_closed) {
        memcpy(moved, closed, size);
    } else if (settle_is_shared(linkage, moved)) {
        is_closed = settle_close_together(linkage, moved);
    }
    free(closed);
    return is_closed;
}

// Changes a start by multiples of all changes. False where it cannot be put together.
static bool change_along(const MonodromyRuns *runs, const double *factors, Scenario *scenario)
{
    const Linkage *from = &runs->scenario->linkage;
    Linkage *linkage = &scenario->linkage;
    const size_t bodies = from->body_count;
    Motion *motions = zeroed(bodies + 1, sizeof *motions);
    Motion *moved = zeroed(bodies + 1, sizeof *moved);
    linkage_start(from, motions);
    memcpy(moved, motions, bodies * sizeof *moved);
    for (size_t k = 0; k < runs->free_count; k++) {
        const SpeedChange *along = runs->free + k * bodies;
        const double position = factors[k] * runs->by * runs->time_s;
        const double speed = factors[runs->free_count + k] * runs->by;
        for (size_t i = 0; i < bodies; i++) {
            Motion *motion = &moved[i];
            motion->position = vec2_add(motion->position, vec2_scale(position, along[i].velocity));
            motion->angle += position * along[i].omega;
            motion->velocity = vec2_add(motion->velocity, vec2_scale(speed, along[i].velocity));
            motion->omega += speed * along[i].omega;
        }
    }
    move_play(from, motions, moved, linkage);
    const bool is_closed = close_moved(linkage, moved);
    nearest_speeds(linkage, false, moved);
    for (size_t i = 0; i < bodies; i++) {
        linkage->bodies[i].start = moved[i];
    }
    for (size_t k = 0; k < runs->memory_count; k++) {
        const Memory *memory = &runs->memories[k];
        ContactState *state = &linkage->joints[memory->joint].contacts[memory->place];
        const double share = OF_IMPACT * factors[2 * runs->free_count + k];
        state->impact_speed *= 1.0 + share;
        state->damping_speed *= 1.0 + share;
    }
    free(moved);
    free(motions);
    return is_closed;
}

// The state that a scenario starts in, all of it in speeds.
static void take_state(const MonodromyRuns *runs, const Scenario *scenario, double *state)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Motion *motion = &linkage->bodies[i].start;
        const double reach = linkage_reach(linkage, (int)i);
        double *own = state + 6 * i;
        own[0] = motion->position.x / runs->time_s;
        own[1] = motion->position.y / runs->time_s;
        own[2] = motion->angle * reach / runs->time_s;
        own[3] = motion->velocity.x;
        own[4] = motion->velocity.y;
        own[5] = motion->omega * reach;
    }
    // as far from one another as the changes of speeds
    for (size_t k = 0; k < runs->memory_count; k++) {
        const Memory *memory = &runs->memories[k];
        const double before =
            runs->scenario->linkage.joints[memory->joint].contacts[memory->place].impact_speed;
        const ContactState *now = &linkage->joints[memory->joint].contacts[memory->place];
        const bool is_kept = now->is_touching && !now->is_resting;
        const double unit = runs->by / (OF_IMPACT * before);
        state[6 * linkage->body_count + k] = is_kept ? now->impact_speed * unit : 0.0;
    }
}

// How the start of a run differs from the motion's: before it is turned, or after.
static void take_difference(const MonodromyRuns *runs, const Scenario *of, const Scenario *beside,
                            double *difference)
{
    double *motion = zeroed(runs->rows + 1, sizeof *motion);
    take_state(runs, of, difference);
    take_state(runs, beside, motion);
    for (size_t i = 0; i < runs->rows; i++) {
        difference[i] -= motion[i];
    }
    free(motion);
}

// By how much speeds are changed, and how long they take to move the bodies as far as positions
// are: in the time of a contact the speed at which it begins comes to its depth.
static void find_sizes(MonodromyRuns *runs)
{
    const Settling *motion = &runs->runs[0].settling;
    const Linkage *linkage = &motion->scenario.linkage;
    double slowest = INFINITY;
    runs->time_s = FREE_SHARE * scenario_settling_period(runs->scenario);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const SettleReach *reach = &motion->reach[i];
        double depth = 0.0;
        for (size_t k = 0; k < motion->count; k++) {
            depth =
                fmax(depth, motion->revolutions[k].numbers[settle_joint_number(i, SETTLE_DEPTH)]);
        }
        if (reach->slowest > 0.0) {
            const Joint *joint = &linkage->joints[i];
            const double arm =
                linkage_is_torsional(joint) ? linkage_reach(linkage, joint->body_b) : 1.0;
            slowest = fmin(slowest, arm * reach->slowest);
        }
        if (reach->approach > 0.0 && depth > 0.0) {
            runs->time_s = fmin(runs->time_s, depth / reach->approach);
        }
    }
    runs->by = isfinite(slowest) ? OF_IMPACT * slowest : OF_FASTEST * motion->fastest;
    runs->by = fmax(runs->by, OF_FASTEST_LEAST * motion->fastest);
    runs->by = fmin(runs->by, OF_FASTEST * motion->fastest);
}

static bool begin_run(MonodromyRuns *runs, const double *factors, size_t number)
{
    add_run(runs, number);
    MonodromyRun *run = &runs->runs[number];
    run->is_run = change_along(runs, factors, &run->settling.scenario);
    take_difference(runs, &run->settling.scenario, runs->scenario, run->start);
    return run->is_run;
}

static bool begin_starts(MonodromyRuns *runs)
{
    if (!runs->runs[0].is_run) {
        return false;
    }
    find_sizes(runs);
    bool are_begun = true;
    for (size_t k = 0; k < runs->count && are_begun; k++) {
        double factors[MONODROMY_MOST] = {0.0};
        factors[k] = 1.0;
        are_begun = begin_run(runs, factors, 1 + k);
    }
    return are_begun;
}

static double rows_product(size_t count, const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Writes which multiples of the changes of the starts a change is, by least squares. False where
// these are not independent.
static bool in_changes(const MonodromyRuns *runs, const double *change, double *multiples)
{
    double products[MONODROMY_MOST * MONODROMY_MOST];
    const size_t n = runs->count;
    for (size_t i = 0; i < n; i++) {
        const double *start = runs->runs[1 + i].start;
        multiples[i] = rows_product(runs->rows, start, change);
        for (size_t k = 0; k < n; k++) {
            products[i * n + k] = rows_product(runs->rows, start, runs->runs[1 + k].start);
        }
    }
    return dense_solve(n, products, multiples);
}

static bool find_matrix(MonodromyRuns *runs)
{
    const size_t n = runs->count;
    runs->matrix = zeroed(n * n, sizeof *runs->matrix);
    for (size_t k = 0; k < n; k++) {
        MonodromyRun *run = &runs->runs[1 + k];
        double column[MONODROMY_MOST];
        if (!run->is_run) {
            return false;
        }
        take_difference(runs, &run->settling.scenario, &runs->runs[0].settling.scenario, run->end);
        if (!in_changes(runs, run->end, column)) {
            return false;
        }
        for (size_t i = 0; i < n; i++) {
            runs->matrix[i * n + k] = column[i];
        }
    }
    return eigen_values(n, runs->matrix, runs->values);
}

// Whether a multiplier is that of a coordinate that nothing depends on.
static bool is_neutral(const MonodromyRuns *runs, double complex value, const double complex *right)
{
    double positions = 0.0;
    double others = 0.0;
    for (size_t i = 0; i < runs->count; i++) {
        double *sum = i < runs->free_count ? &positions : &others;
        *sum = hypot(*sum, cabs(right[i]));
    }
    return cabs(value - 1.0) < NEUTRAL && others < NEUTRAL * positions;
}

static bool find_largest(MonodromyRuns *runs)
{
    const size_t n = runs->count;
    for (size_t k = 0; k < n; k++) {
        const double complex value = runs->values[k];
        if (!eigen_vector(n, runs->matrix, value, false, runs->right) ||
            !eigen_vector(n, runs->matrix, value, true, runs->left)) {
            return false;
        }
        if (!is_neutral(runs, value, runs->right)) {
            runs->largest = k;
            return true;
        }
    }
    return false;
}

static bool begin_sides(MonodromyRuns *runs)
{
    if (!find_matrix(runs) || !find_largest(runs)) {
        return false;
    }
    bool are_begun = true;
    for (size_t side = 0; side < SIDES && are_begun; side++) {
        double factors[MONODROMY_MOST] = {0.0};
        for (size_t i = 0; i < runs->count; i++) {
            factors[i] = (side == 0 ? ALONG_SIZE : -ALONG_SIZE) * creal(runs->right[i]);
        }
        are_begun = begin_run(runs, factors, 1 + runs->count + side);
    }
    return are_begun;
}

// Writes what the starts to both sides are, and what has become of them, in multiples of the
// changes. False where one of them has failed.
static bool take_sides(const MonodromyRuns *runs, double start[SIDES][MONODROMY_MOST],
                       double end[SIDES][MONODROMY_MOST])
{
    bool are_run = runs->end == 1 + runs->count + SIDES;
    for (size_t side = 0; side < SIDES && are_run; side++) {
        const MonodromyRun *run = &runs->runs[1 + runs->count + side];
        take_difference(runs, &run->settling.scenario, &runs->runs[0].settling.scenario, run->end);
        are_run = run->is_run && in_changes(runs, run->start, start[side]) &&
                  in_changes(runs, run->end, end[side]);
    }
    return are_run;
}

// The largest multiplier, and what it may be wrong by. False where that is not known.
static bool find_checked(const MonodromyRuns *runs, double *size, double *wrong)
{
    const size_t n = runs->count;
    double start[SIDES][MONODROMY_MOST];
    double end[SIDES][MONODROMY_MOST];
    if (!take_sides(runs, start, end)) {
        return false;
    }
    double complex ahead = 0.0;
    double complex behind = 0.0;
    double complex missing = 0.0;
    double complex along = 0.0;
    for (size_t i = 0; i < n; i++) {
        double change[MONODROMY_MOST];
        for (size_t k = 0; k < n; k++) {
            change[k] = start[0][k] - start[1][k];
        }
        ahead += runs->left[i] * end[0][i];
        behind += runs->left[i] * end[1][i];
        along += runs->left[i] * change[i];
        missing += runs->left[i] * rows_product(n, runs->matrix + i * n, change);
    }
    const double complex value = runs->values[runs->largest];
    const double complex found = (ahead - behind) / along;
    const double apart = cabs((ahead - behind - missing) / along);
    const double uneven = cabs(ahead + behind) / cabs(ahead - behind);
    const bool is_real = cimag(value) == 0.0;
    *size = is_real ? cabs(found) : cabs(value);
    *wrong = is_real && fmax(apart / *size, uneven) <= SIDES_APART ? uneven * uneven * *size
                                                                   : apart + uneven * *size;
    return isfinite(*size) && isfinite(*wrong);
}

static bool begin_stage(MonodromyRuns *runs)
{
    switch (runs->stage) {
    case STAGE_MOTION:
        runs->stage = STAGE_STARTS;
        return begin_starts(runs);
    case STAGE_STARTS:
        runs->stage = STAGE_SIDES;
        return begin_sides(runs);
    case STAGE_SIDES:
    case STAGE_OVER:
        break;
    }
    runs->stage = STAGE_OVER;
    return true;
}

static SideBySideNext monodromy_next(size_t *index, void *context)
{
    MonodromyRuns *runs = context;
    if (runs->stage != STAGE_OVER && runs->next == runs->end && runs->going == 0 &&
        !begin_stage(runs)) {
        runs->stage = STAGE_OVER;
        runs->next = runs->end;
    }
    if (runs->next < runs->end) {
        *index = runs->next++;
        runs->going++;
        return SIDE_BY_SIDE_PIECE;
    }
    return runs->stage == STAGE_OVER ? SIDE_BY_SIDE_NONE : SIDE_BY_SIDE_LATER;
}

static void monodromy_work(size_t index, bool is_callers, void *context)
{
    MonodromyRuns *runs = context;
    MonodromyRun *run = &runs->runs[index];
    Err unused = {ERR_NONE, ""};
    run->settling.is_callers = is_callers;
    for (size_t k = 0; k < runs->period && run->is_run; k++) {
        run->is_run = settling_turn(&run->settling, &unused);
    }
}

static void monodromy_ended(size_t index, void *context)
{
    (void)index;
    ((MonodromyRuns *)context)->going--;
}

SideBySideTasks monodromy_runs_tasks(MonodromyRuns *runs)
{
    return (SideBySideTasks){
        .most = 1 + runs->count + SIDES,
        .next = monodromy_next,
        .work = monodromy_work,
        .end = monodromy_ended,
        .context = runs,
    };
}

// The body that the change of the largest multiplier moves fastest.
static size_t find_body(const MonodromyRuns *runs)
{
    const Linkage *linkage = &runs->scenario->linkage;
    size_t body = 0;
    double fastest = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        double complex rates[3] = {0.0};
        for (size_t k = 0; k < runs->free_count; k++) {
            const SpeedChange *along = &runs->free[k * linkage->body_count + i];
            const double complex share = runs->right[runs->free_count + k];
            rates[0] += share * along->velocity.x;
            rates[1] += share * along->velocity.y;
            rates[2] += share * along->omega * linkage_reach(linkage, (int)i);
        }
        const double speed = hypot(hypot(cabs(rates[0]), cabs(rates[1])), cabs(rates[2]));
        body = speed > fastest ? i : body;
        fastest = fmax(fastest, speed);
    }
    return body;
}

// The growth that follows; its factor is NAN where nothing is found.
static SettledGrowth growth_found(const MonodromyRuns *runs)
{
    SettledGrowth growth = {.factor = NAN};
    double size;
    double wrong;
    if (!find_checked(runs, &size, &wrong)) {
        return growth;
    }
    const bool is_right = wrong <= RIGHT_TO * size;
    const double bound = size + 2.0 * wrong;
    if (is_right || bound <= GONE) {
        growth.is_at_most = !is_right;
        growth.factor = pow(is_right ? size : bound, 1.0 / (double)runs->period);
        growth.revolutions = runs->period;
        growth.body = find_body(runs);
        growth.multiplier_count = runs->count;
        for (size_t i = 0; i < runs->count; i++) {
            growth.multipliers[i][0] = creal(runs->values[i]);
            growth.multipliers[i][1] = cimag(runs->values[i]);
        }
    }
    return growth;
}

bool monodromy_runs_end(MonodromyRuns *runs, Scenario *scenario)
{
    SettledStart *settled = &scenario->settled;
    const SettledGrowth growth = growth_found(runs);
    const bool is_found = isfinite(growth.factor);
    if (is_found) {
        settled->has_growth = true;
        settled->growth = growth;
    }
    for (size_t i = 0; i < runs->end; i++) {
        settling_finish(&runs->runs[i].settling);
        free(runs->runs[i].start);
        free(runs->runs[i].end);
    }
    free(runs->matrix);
    free(runs->free);
    free(runs);
    return is_found;
}
