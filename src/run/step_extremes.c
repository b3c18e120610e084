// Finds the extremes of signals inside a step.
#include "run/step_extremes.h"
#include "base/curve.h"
#include "base/room.h"
#include "base/root.h"
#include "base/zeroed.h"

// One signal at a time.
//
// A step whose values are instants may be long: its extremes stand inside. An angular velocity has
// one where the angular acceleration changes its sign. For accelerations and forces steps that come
// near the largest value so far are looked at in the middle and next to their ends, so that a
// maximum has lower values on either side; parabolas through three looks lead to it. The recorder
// sees every look.

// of the extreme so far: a signal hardly rises higher above the ends of a part of a step, or above
// two instants side by side
static const double STEP_EXTREMES_RISE_MAX = 0.01;

// of the extreme so far: a maximum that three points let expect is not off by more
static const double LIKELY = 1e-3;

// of the step: a maximum nearer to an end is too low by the square of it
static const double NEXT_TO_END = 1e-3;

// of a value: lower differences are rounding
static const double ALIKE = 1e-12;

enum { POINTS_MAX = LOOK_PARTS_MAX + 4 };

// Signals that are climbed to the top of one by one in a step: the others are seen at the same
// looks, which for signals of one impact are near their peaks. A cluster takes as many looks as
// two.
enum { SOUGHT_MOST = 16 };

enum { CLIMBS_MAX = 12 }; // a parabola gains half as many digits again each time

Looker looker_start(const Scenario *scenario, const Solver *solver, const void *state,
                    Recorder *recorder)
{
    const Linkage *linkage = &scenario->linkage;
    return (Looker){.scenario = scenario,
                    .solver = solver,
                    .state = state,
                    .recorder = recorder,
                    .sample = sample_create(linkage),
                    .alpha_peaks = zeroed(linkage->body_count, sizeof(LookPeak[LOOK_SIGNS])),
                    .force_peaks = zeroed(linkage->joint_count, sizeof(LookPeak[LOOK_SIGNS]))};
}

void looker_finish(Looker *looker)
{
    for (size_t i = 0; i < looker->block_count; i++) {
        free(looker->blocks[i]);
    }
    free(looker->blocks);
    free(looker->alpha_peaks);
    free(looker->force_peaks);
    sample_free(&looker->sample);
}

// Where the numbers of a look stand in its block.
static Look look_in(const Looker *looker, double *block, double time_s)
{
    const size_t bodies = looker->scenario->linkage.body_count;
    return (Look){time_s, block, block + bodies, block + 2 * bodies};
}

static Look new_look(Looker *looker, double time_s)
{
    const Linkage *linkage = &looker->scenario->linkage;
    looker->blocks = room_grow(looker->blocks, &looker->block_count, looker->look_count + 1,
                               sizeof *looker->blocks);
    double **block = &looker->blocks[looker->look_count++];
    if (*block == NULL) {
        *block = zeroed(2 * linkage->body_count + linkage->joint_count, sizeof **block);
    }
    return look_in(looker, *block, time_s);
}

Look looker_first(Looker *looker)
{
    assert(looker->look_count == 0);
    return new_look(looker, 0.0);
}

void looker_keep(Looker *looker, Look *first, const Look *look)
{
    const Linkage *linkage = &looker->scenario->linkage;
    const size_t body_count = solver_body_count(looker->part, linkage);
    const size_t joint_count = solver_joint_count(looker->part, linkage);
    assert(looker->look_count > 0 && looker->blocks[0] == first->omega);
    first->time_s = look->time_s;
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(looker->part, k);
        first->omega[i] = look->omega[i];
        first->alpha[i] = look->alpha[i];
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t i = solver_joint(looker->part, k);
        first->force[i] = look->force[i];
    }
    looker->look_count = 1;
    looker->has_peaks = false;
}

Look look_inside(Looker *looker, double time_s)
{
    const Linkage *linkage = &looker->scenario->linkage;
    const SolverPart *part = looker->part;
    const Solver *solver = looker->solver;
    const Look look = new_look(looker, time_s);
    const Sample *sample = &looker->sample;
    if (looker->some != NULL) {
        solver->observe_some(looker->state, time_s, looker->some, &looker->sample);
    } else if (part != NULL) {
        solver->observe_part(looker->state, time_s, &looker->sample);
    } else {
        solver->observe(looker->state, time_s, &looker->sample);
    }
    recorder_see(looker->recorder, part, sample);
    const size_t body_count = solver_body_count(part, linkage);
    const size_t joint_count = solver_joint_count(part, linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(part, k);
        look.omega[i] = sample->bodies[i].omega;
        look.alpha[i] = sample->bodies[i].alpha;
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t i = solver_joint(part, k);
        look.force[i] = sample->joints[i].force;
    }
    return look;
}

Look look_at_end(Looker *looker, const StepRecord *step)
{
    const Linkage *linkage = &looker->scenario->linkage;
    const Look look = new_look(looker, step->end_s);
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(step->part, k);
        look.omega[i] = step->omega[k];
        look.alpha[i] = step->alpha[k];
    }
    for (size_t k = 0; k < joint_count; k++) {
        look.force[solver_joint(step->part, k)] = step->joints[k].force;
    }
    return look;
}

// An acceleration or a force, and whether its largest or its smallest value is looked for.
typedef struct Aim {
    Looker *looker;
    size_t signal; // alpha of each body, then the forces
    double sign;
    double extreme; // so far
} Aim;

// The value of a signal, with the sign that makes what is looked for a maximum.
static double aim_value(const Aim *aim, const Look *look)
{
    const size_t bodies = aim->looker->scenario->linkage.body_count;
    return aim->sign *
           (aim->signal < bodies ? look->alpha[aim->signal] : look->force[aim->signal - bodies]);
}

static double extreme_so_far(const Looker *looker, size_t signal, double sign)
{
    const size_t bodies = looker->scenario->linkage.body_count;
    const Extreme *extreme =
        signal < bodies ? recorder_extreme(looker->recorder, RECORDER_ALPHA, signal, sign)
                        : recorder_extreme(looker->recorder, RECORDER_FORCE, signal - bodies, sign);
    return sign * extreme->value;
}

static bool step_extremes_is_near(const Aim *aim, double value, double share)
{
    return value >= aim->extreme - share * fabs(aim->extreme);
}

// The next signal of the part with a sign to look for; false behind the last. The smallest force is
// nothing that is reported.
static bool next_aim(Looker *looker, size_t *number, Aim *aim)
{
    const Linkage *linkage = &looker->scenario->linkage;
    const SolverPart *part = looker->part;
    const size_t body_count = solver_body_count(part, linkage);
    while (*number < 2 * body_count &&
           linkage_is_driven(linkage, (int)solver_body(part, *number / 2))) {
        *number += 2;
    }
    const size_t i = (*number)++;
    if (i >= 2 * body_count + solver_joint_count(part, linkage)) {
        return false;
    }
    const bool is_body = i < 2 * body_count;
    const size_t signal = is_body ? solver_body(part, i / 2)
                                  : linkage->body_count + solver_joint(part, i - 2 * body_count);
    const double sign = is_body && i % 2 == 1 ? -1.0 : 1.0;
    *aim = (Aim){looker, signal, sign, extreme_so_far(looker, signal, sign)};
    return true;
}

// How far an acceleration may rise above both of its values at two looks: a parabola through them
// has its top no further above than by 3/2 of what its mean, which the speeds tell, lies above the
// middle of the chord. Of bodies that are looked at one by one: others see each other's looks.
static double rise_between(const Aim *aim, const Look *first, const Look *last)
{
    const double width_s = last->time_s - first->time_s;
    if (aim->signal >= aim->looker->scenario->linkage.body_count || !(width_s > 0.0)) {
        return 0.0;
    }
    const double mean =
        aim->sign * (last->omega[aim->signal] - first->omega[aim->signal]) / width_s;
    const double above = mean - 0.5 * (aim_value(aim, first) + aim_value(aim, last));
    return fmax(1.5 * above, 0.0);
}

// How many signals come near the run's extremes; at most so many are counted.
static size_t count_near(Looker *looker, const Look *before, int parts, const Look *looks,
                         size_t enough)
{
    size_t count = 0;
    Aim aim;
    for (size_t number = 0; count < enough && next_aim(looker, &number, &aim);) {
        double most = aim_value(&aim, before);
        double least = most;
        double top = most; // what it may reach in between
        for (int k = 0; k < parts; k++) {
            const double value = aim_value(&aim, &looks[k]);
            if (looker->some != NULL) {
                const Look *first = k > 0 ? &looks[k - 1] : before;
                const double rise = rise_between(&aim, first, &looks[k]);
                top = fmax(top, fmax(value, aim_value(&aim, first)) + rise);
            }
            // once a signal and step: fmin and fmax would be calls
            most = value > most ? value : most;
            least = value < least ? value : least;
        }
        top = most > top ? most : top;
        // what stays as it is has no maximum
        count += step_extremes_is_near(&aim, top, STEP_EXTREMES_RISE_MAX) &&
                         top - least > ALIKE * fabs(most)
                     ? 1
                     : 0;
    }
    return count;
}

// The time at which a parabola through three looks, of which the middle one is largest, is largest,
// and its value there.
static double top_of_three(const Aim *aim, const Look three[3], double *value)
{
    const double middle = aim_value(aim, &three[1]);
    const double before_s = three[1].time_s - three[0].time_s;
    const double behind_s = three[2].time_s - three[1].time_s;
    const double before = (middle - aim_value(aim, &three[0])) / before_s;
    const double behind = (aim_value(aim, &three[2]) - middle) / behind_s;
    const double bend = (behind - before) / (before_s + behind_s);
    const double slope = before + bend * before_s;
    const double ahead_s = bend < 0.0 ? -0.5 * slope / bend : 0.0;
    *value = middle + 0.5 * slope * ahead_s;
    return three[1].time_s + ahead_s;
}

// Narrows three looks about a maximum, the middle one largest, down to rounding.
static void climb(const Aim *aim, Look three[3])
{
    for (int i = 0; i < CLIMBS_MAX; i++) {
        double expected;
        const double time_s = top_of_three(aim, three, &expected);
        const double value = aim_value(aim, &three[1]);
        if (expected - value <= ALIKE * fabs(value) || !(time_s > three[0].time_s) ||
            !(time_s < three[2].time_s)) {
            return;
        }
        const Look look = look_inside(aim->looker, time_s);
        const bool is_behind = time_s > three[1].time_s;
        if (aim_value(aim, &look) > value) {
            three[is_behind ? 0 : 2] = three[1];
            three[1] = look;
        } else {
            three[is_behind ? 2 : 0] = look;
        }
    }
}

// Puts a look between the others, in order of time; leaves it out where there is one already.
static int insert(Look *looks, int count, const Look *look)
{
    int at = count;
    while (at > 0 && looks[at - 1].time_s > look->time_s) {
        at--;
    }
    if (count == LOOK_MAX || (at > 0 && looks[at - 1].time_s == look->time_s)) {
        return count;
    }
    memmove(&looks[at + 1], &looks[at], (size_t)(count - at) * sizeof *looks);
    looks[at] = *look;
    return count + 1;
}

// Climbs to the top of a signal in a step if it may be higher than the extreme so far.
static bool step_extremes_find_top(const Aim *aim, size_t count, const Look *points, Look *found)
{
    size_t top = 0;
    for (size_t i = 1; i < count; i++) {
        top = aim_value(aim, &points[i]) > aim_value(aim, &points[top]) ? i : top;
    }
    if (top == 0 || top + 1 == count) {
        return false;
    }
    Look three[3] = {points[top - 1], points[top], points[top + 1]};
    double expected;
    top_of_three(aim, three, &expected);
    if (!step_extremes_is_near(aim, expected, LIKELY)) {
        return false;
    }
    climb(aim, three);
    *found = three[1];
    return true;
}

// A body whose angular velocity may have an extreme between two looks.
typedef struct Turn {
    Looker *looker;
    size_t body;
} Turn;

static double turn_rate(double time_s, void *context)
{
    const Turn *turn = context;
    const size_t looks = turn->looker->look_count;
    const double alpha = look_inside(turn->looker, time_s).alpha[turn->body];
    turn->looker->look_count = looks; // nobody else needs that one
    return alpha;
}

// Whether that may be beyond the run's extremes.
static bool may_turn(const Looker *looker, size_t body, const Look *first, const Look *last)
{
    if (!(first->alpha[body] * last->alpha[body] < 0.0)) {
        return false;
    }
    // omega rises above its ends by no more than a parabola of their slopes would
    const double room = 0.5 * (last->time_s - first->time_s) *
                        fmax(fabs(first->alpha[body]), fabs(last->alpha[body]));
    const BodyExtremes *extremes = &looker->recorder->trajectory->bodies[body];
    return fmax(first->omega[body], last->omega[body]) + room > extremes->omega_max.value ||
           fmin(first->omega[body], last->omega[body]) - room < extremes->omega_min.value;
}

// Looks for them; at most so many are sought. Returns how many were.
static size_t look_for_turns(Looker *looker, const Look *first, const Look *last, size_t most)
{
    const size_t body_count = solver_body_count(looker->part, &looker->scenario->linkage);
    size_t sought = 0;
    for (size_t k = 0; k < body_count && sought < most; k++) {
        const size_t i = solver_body(looker->part, k);
        Turn turn = {looker, i};
        double time_s;
        if (!may_turn(looker, i, first, last)) {
            continue;
        }
        sought++;
        if (root_find(turn_rate, &turn, first->time_s, last->time_s,
                      NEXT_TO_END * (last->time_s - first->time_s), &time_s)) {
            turn_rate(time_s, &turn); // for the recorder
        }
    }
    return sought;
}

bool look_is_cluster(Looker *looker, const Look *before, int parts, const Look *looks)
{
    const size_t body_count = solver_body_count(looker->part, &looker->scenario->linkage);
    const size_t joint_count = solver_joint_count(looker->part, &looker->scenario->linkage);
    // a body has an extreme of omega and two of alpha in a step, a joint one
    if (!(looks[parts - 1].time_s > before->time_s) ||
        3 * body_count + joint_count <= SOUGHT_MOST) {
        return false;
    }
    size_t count = count_near(looker, before, parts, looks, SOUGHT_MOST + 1);
    for (int k = 0; k < parts && count <= SOUGHT_MOST; k++) {
        const Look *first = k > 0 ? &looks[k - 1] : before;
        for (size_t i = 0; i < body_count; i++) {
            const size_t body = solver_body(looker->part, i);
            count += may_turn(looker, body, first, &looks[k]) ? 1 : 0;
        }
    }
    return count > SOUGHT_MOST;
}

int look_for_extremes(Looker *looker, const Look *before, int parts, Look looks[LOOK_MAX])
{
    const double end_s = looks[parts - 1].time_s;
    const double width_s = end_s - before->time_s;
    const Look *first = before;
    size_t sought = 0;
    for (int k = 0; k < parts; k++) {
        sought += look_for_turns(looker, first, &looks[k], SOUGHT_MOST - sought);
        first = &looks[k];
    }
    if (!(width_s > 0.0) || count_near(looker, before, parts, looks, 1) == 0) {
        return parts;
    }
    Look points[POINTS_MAX];
    size_t count = 0;
    // a record may have an acceleration by where the bodies are at mid-step: beside those of looks
    // that hides a maximum next to the end
    const bool has_own_ends = looker->some != NULL && looker->some->body_count > 0;
    points[count++] = has_own_ends ? look_inside(looker, before->time_s) : *before;
    points[count++] = look_inside(looker, before->time_s + NEXT_TO_END * width_s);
    if (parts == 1) {
        points[count++] = look_inside(looker, before->time_s + 0.5 * width_s);
    }
    for (int k = 0; k + 1 < parts; k++) {
        points[count++] = looks[k];
    }
    points[count++] = look_inside(looker, end_s - NEXT_TO_END * width_s);
    points[count++] = has_own_ends ? look_inside(looker, end_s) : looks[parts - 1];
    int look_count = parts;
    Aim aim;
    sought = 0;
    for (size_t number = 0; sought < SOUGHT_MOST && next_aim(looker, &number, &aim);) {
        Look top;
        if (step_extremes_find_top(&aim, count, points, &top)) {
            look_count = insert(looks, look_count, &top);
            sought++;
        }
    }
    return look_count;
}

// Many signals together.
//
// To climb to the top of each by itself evaluates all bodies for each of many. All are looked at
// together at a few instants instead, and the polynomial through these (base/curve.h) has the
// extremes.

// What a recorder knows of one signal: its extreme, with the sign that makes this a maximum.
typedef struct Signal {
    RecorderSignal which;
    size_t number; // of the body or joint
    double sign;
} Signal;

typedef struct Cluster {
    Looker *looker; // receives the peaks
    double start_s;
    double width_s;
    Look looks[CURVE_NODES];
} Cluster;

static double step_extremes_value_of(const Look *look, const Signal *signal)
{
    switch (signal->which) {
    case RECORDER_OMEGA:
        return look->omega[signal->number];
    case RECORDER_ALPHA:
        return look->alpha[signal->number];
    default:
        return look->force[signal->number];
    }
}

static LookPeak *peaks_of(const Looker *looker, RecorderSignal which, size_t number)
{
    return which == RECORDER_FORCE ? looker->force_peaks[number] : looker->alpha_peaks[number];
}

// Lets the looker have a top of an acceleration or a force, with the speed there.
static void note_peak(const Cluster *cluster, const Signal *signal, double share, double value)
{
    const Signal speed = {RECORDER_OMEGA, signal->number, 1.0};
    LookPeak top = {cluster->start_s + share * cluster->width_s, signal->sign * value, 0.0, true};
    if (signal->which == RECORDER_OMEGA) {
        return;
    }
    if (signal->which == RECORDER_ALPHA) {
        double speeds[CURVE_NODES];
        for (size_t k = 0; k < CURVE_NODES; k++) {
            speeds[k] = step_extremes_value_of(&cluster->looks[k], &speed);
        }
        top.omega = curve_at(speeds, share);
    }
    peaks_of(cluster->looker, signal->which, signal->number)[signal->sign > 0.0 ? 1 : 0] = top;
}

// Raises an extreme to the top of its signal.
static void raise_signal(const Cluster *cluster, Signal signal)
{
    Recorder *recorder = cluster->looker->recorder;
    const Extreme *extreme = recorder_extreme(recorder, signal.which, signal.number, signal.sign);
    const double so_far = signal.sign * extreme->value;
    double values[CURVE_NODES];
    size_t largest = 0;
    for (size_t k = 0; k < CURVE_NODES; k++) {
        values[k] = signal.sign * step_extremes_value_of(&cluster->looks[k], &signal);
        largest = values[k] > values[largest] ? k : largest;
    }
    const bool is_inside = largest > 0 && largest + 1 < CURVE_NODES;
    if (!is_inside && !(values[largest] >= so_far - STEP_EXTREMES_RISE_MAX * fabs(so_far))) {
        return;
    }
    double share = 0.0;
    const double top = curve_top(values, &share);
    note_peak(cluster, &signal, share, top);
    if (top > so_far) {
        const double time_s = cluster->start_s + share * cluster->width_s;
        recorder_raise(recorder, signal.which, signal.number, signal.sign,
                       (Extreme){.time_s = time_s, .value = signal.sign * top});
    }
}

static void forget_peaks(LookPeak *peaks)
{
    for (size_t i = 0; i < LOOK_SIGNS; i++) {
        peaks[i].is_known = false;
    }
}

static void step_extremes_raise_all(const Cluster *cluster)
{
    const Linkage *linkage = &cluster->looker->scenario->linkage;
    const SolverPart *part = cluster->looker->part;
    const size_t body_count = solver_body_count(part, linkage);
    const size_t joint_count = solver_joint_count(part, linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t body = solver_body(part, k);
        forget_peaks(cluster->looker->alpha_peaks[body]);
        if (linkage_is_driven(linkage, (int)body)) {
            continue; // it moves as it is told
        }
        for (int sign = -1; sign <= 1; sign += 2) {
            raise_signal(cluster, (Signal){RECORDER_OMEGA, body, sign});
            raise_signal(cluster, (Signal){RECORDER_ALPHA, body, sign});
        }
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t joint = solver_joint(part, k);
        forget_peaks(cluster->looker->force_peaks[joint]);
        raise_signal(cluster, (Signal){RECORDER_FORCE, joint, 1.0});
    }
}

void look_at_cluster(Looker *looker, const Look *before, const Look *end)
{
    Cluster cluster = {
        .looker = looker, .start_s = before->time_s, .width_s = end->time_s - before->time_s};
    cluster.looks[0] = *before;
    cluster.looks[CURVE_NODES - 1] = *end;
    for (size_t k = 1; k + 1 < CURVE_NODES; k++) {
        cluster.looks[k] = look_inside(looker, cluster.start_s + curve_node(k) * cluster.width_s);
    }
    step_extremes_raise_all(&cluster);
    looker->has_peaks = true;
}

// Adds the peaks between two times to a path, the earlier one first.
static size_t add_peaks(const LookPeak *peaks, double from_s, double to_s, LookPoint *path,
                        size_t count)
{
    const size_t first = peaks[0].time_s <= peaks[1].time_s ? 0 : 1;
    for (size_t i = 0; i < LOOK_SIGNS; i++) {
        const LookPeak *top = &peaks[i == 0 ? first : 1 - first];
        if (top->is_known && top->time_s > from_s && top->time_s < to_s) {
            path[count++] = (LookPoint){top->time_s, top->value, top->omega};
        }
    }
    return count;
}

size_t look_path(const Looker *looker, RecorderSignal signal, size_t number, double before_s,
                 int count, const Look *looks, LookPoint path[LOOK_PATH_MAX])
{
    const bool is_force = signal == RECORDER_FORCE;
    size_t points = 0;
    for (int k = 0; k < count; k++) {
        const Look *look = &looks[k];
        if (looker->has_peaks) {
            const double from_s = k > 0 ? looks[k - 1].time_s : before_s;
            points =
                add_peaks(peaks_of(looker, signal, number), from_s, look->time_s, path, points);
        }
        path[points++] =
            (LookPoint){look->time_s, is_force ? look->force[number] : look->alpha[number],
                        is_force ? 0.0 : look->omega[number]};
    }
    return points;
}
