// Finds the extremes of signals inside a step.
#include "run/step_extremes.h"
#include "base/curve.h"
#include "base/root.h"

#include <math.h>
#include <string.h>

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
static const double EXTREMES_ALIKE = 1e-12;

enum { POINTS_MAX = LOOK_PARTS_MAX + 4 };

// Signals that are climbed to the top of one by one in a step: the others are seen at the same
// looks, which for signals of one impact are near their peaks. A cluster takes as many looks as
// two.
enum { SOUGHT_MOST = 16 };

enum { CLIMBS_MAX = 12 }; // a parabola gains half as many digits again each time

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
    return signal < bodies
               ? sign * recorder_extreme(looker->recorder, RECORDER_ALPHA, signal, sign)->value
               : recorder_contact_force(looker->recorder, signal - bodies);
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

// Whether a signal may come near the run's extreme between the ends of a step's parts, as far as
// these tell.
static bool aim_may_come_near(const Aim *aim, const Look *before, int parts, const Look *looks)
{
    double most = aim_value(aim, before);
    double least = most;
    double top = most; // what it may reach in between
    for (int k = 0; k < parts; k++) {
        const double value = aim_value(aim, &looks[k]);
        if (aim->looker->some != NULL) {
            const Look *first = k > 0 ? &looks[k - 1] : before;
            const double rise = rise_between(aim, first, &looks[k]);
            top = fmax(top, fmax(value, aim_value(aim, first)) + rise);
        }
        // once a signal and step: fmin and fmax would be calls
        most = value > most ? value : most;
        least = value < least ? value : least;
    }
    top = most > top ? most : top;
    // what stays as it is has no maximum
    return step_extremes_is_near(aim, top, STEP_EXTREMES_RISE_MAX) &&
           top - least > EXTREMES_ALIKE * fabs(most);
}

// How many signals come near the run's extremes; at most so many are counted.
static size_t count_near(Looker *looker, const Look *before, int parts, const Look *looks,
                         size_t enough)
{
    size_t count = 0;
    Aim aim;
    for (size_t number = 0; count < enough && next_aim(looker, &number, &aim);) {
        count += aim_may_come_near(&aim, before, parts, looks) ? 1 : 0;
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
        if (expected - value <= EXTREMES_ALIKE * fabs(value) || !(time_s > three[0].time_s) ||
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

// Looks for one between two times, to a share of a step of a width.
static bool look_for_turn(Turn *turn, double from_s, double to_s, double width_s)
{
    double time_s;
    const bool is_found = root_find(turn_rate, turn, from_s, to_s, NEXT_TO_END * width_s, &time_s);
    if (is_found) {
        turn_rate(time_s, turn); // for the recorder
    }
    return is_found;
}

// Looks for them; at most so many are sought. Returns how many were.
static size_t look_for_turns(Looker *looker, const Look *first, const Look *last, size_t most)
{
    const size_t body_count = solver_body_count(looker->part, &looker->scenario->linkage);
    size_t sought = 0;
    for (size_t k = 0; k < body_count && sought < most; k++) {
        const size_t i = solver_body(looker->part, k);
        if (may_turn(looker, i, first, last)) {
            sought++;
            look_for_turn(&(Turn){looker, i}, first->time_s, last->time_s,
                          last->time_s - first->time_s);
        }
    }
    return sought;
}

// Whether there are more signals than are climbed to one by one: a body has an extreme of omega and
// two of alpha in a step, a joint one.
static bool is_large(const Looker *looker)
{
    const Linkage *linkage = &looker->scenario->linkage;
    return 3 * solver_body_count(looker->part, linkage) +
               solver_joint_count(looker->part, linkage) >
           SOUGHT_MOST;
}

// Whether so many signals of a step may come near the run's extremes that these are found together
// for less than one by one.
static bool look_is_cluster(Looker *looker, const Look *before, int parts, const Look *looks)
{
    const size_t body_count = solver_body_count(looker->part, &looker->scenario->linkage);
    if (!(looks[parts - 1].time_s > before->time_s) || !is_large(looker)) {
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
    looker_peaks(cluster->looker, signal->which, signal->number)[signal->sign > 0.0 ? 1 : 0] = top;
}

// Raises an extreme to the top of its signal.
static void raise_signal(const Cluster *cluster, Signal signal)
{
    Recorder *recorder = cluster->looker->recorder;
    const Extreme *extreme = recorder_extreme(recorder, signal.which, signal.number, signal.sign);
    const double so_far = signal.which == RECORDER_FORCE
                              ? recorder_contact_force(recorder, signal.number)
                              : signal.sign * extreme->value;
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

static void look_at_cluster(Looker *looker, const Look *before, const Look *end)
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

// Signals that a solver can sketch.
//
// A sketch costs no evaluation, and is right to within the error of a step, e:
//     e(s) = e_0 (1 - s) + e_1 s + e_c min(1, 100 d^2),  d = min(s, 1 - s)
// at a share s of the step, with its errors e_0 and e_1 at the ends, where the state is known, and
// e_c from one look inside: where a step is whole the sketch touches the signal at both ends. So it
// is known which signals may have an extreme in the step, and where, before anybody looks at more.

// of the step: from where a top is likely to either side of it
static const double SKETCH_REACH = 0.01;

// of the step: where a sketch is held against a look. The polynomial through a step of order 8 is
// worst at 0.35 and 0.75, and right at 4/7.
static const double SKETCH_CHECK = 0.4;

// e_c over the error there
static const double SKETCH_CAUTION = 2.0;

// of a signal's range in the step: a sketch that is further off says nothing
static const double SKETCH_ERROR_MOST = 0.1;

// Of a large mechanism tops and turns that are found one by one, in some five looks each, rather
// than all together in ten.
enum { LIKELY_MOST = 2 };

// A signal that is to be looked for: its top is likely at that share of the step.
typedef struct Likely {
    Aim aim;
    double share; // NAN: not known
} Likely;

// Of omega of a body, where alpha is likely to be zero.
typedef struct LikelyTurn {
    size_t body;
    double share;
} LikelyTurn;

// What is likely in a step; of each kind one more than are sought.
typedef struct Sketch {
    Cluster cluster; // of sketches instead of looks, with the states at the ends
    Look ends[2];    // the sketch there, and at the check
    Look check;
    Look look; // at the check
    size_t top_count;
    size_t turn_count;
    Likely tops[SOUGHT_MOST + 1];
    LikelyTurn turns[SOUGHT_MOST + 1];
} Sketch;

static Look look_sketch(Looker *looker, double time_s)
{
    const SolverPart *part = looker->part;
    const Linkage *linkage = &looker->scenario->linkage;
    const Look own = look_room(looker, time_s);
    if (part == NULL) {
        looker->solver->sketch(looker->state, time_s, own.omega, own.alpha, own.force);
        return own;
    }
    // from the order of the part to that of the linkage
    const Look look = look_room(looker, time_s);
    looker->solver->sketch(looker->state, time_s, own.omega, own.alpha, own.force);
    for (size_t k = 0; k < solver_body_count(part, linkage); k++) {
        look.omega[solver_body(part, k)] = own.omega[k];
        look.alpha[solver_body(part, k)] = own.alpha[k];
    }
    for (size_t k = 0; k < solver_joint_count(part, linkage); k++) {
        look.force[solver_joint(part, k)] = own.force[k];
    }
    return look;
}

// The error of the sketch of a signal at a share of the step.
static double sketch_error(const double errors[3], double share)
{
    const double near = share < 0.5 ? share : 1.0 - share;
    const double inside = 100.0 * near * near;
    return errors[0] * (1.0 - share) + errors[1] * share +
           errors[2] * (inside < 1.0 ? inside : 1.0);
}

static void sketch_find_errors(const Sketch *sketch, const Aim *aim, double errors[3])
{
    const Look *looks = sketch->cluster.looks;
    const Look *end = &looks[CURVE_NODES - 1];
    errors[0] = fabs(aim_value(aim, &sketch->ends[0]) - aim_value(aim, &looks[0]));
    errors[1] = fabs(aim_value(aim, &sketch->ends[1]) - aim_value(aim, end));
    errors[2] =
        SKETCH_CAUTION * fabs(aim_value(aim, &sketch->check) - aim_value(aim, &sketch->look));
}

// Where the polynomial through a sketch has its top, as a share of the step: 0 or 1 at an end.
static double sketch_top(const double values[CURVE_NODES], size_t top)
{
    double share = curve_node(top);
    const bool is_first = top == 0;
    if (!is_first && top + 1 < CURVE_NODES) {
        const double before = share - curve_node(top - 1);
        const double behind = curve_node(top + 1) - share;
        const double rise = (values[top] - values[top - 1]) / before;
        const double fall = (values[top] - values[top + 1]) / behind;
        return share + 0.5 * (rise * behind - fall * before) / (rise + fall);
    }
    // next to the end it may be higher
    if (curve_at(values, is_first ? NEXT_TO_END : 1.0 - NEXT_TO_END) > values[top]) {
        curve_top(values, &share);
    }
    return share;
}

// Whether a signal may have a top inside the step that is beyond the extreme so far.
static bool has_likely_top(const Sketch *sketch, Likely *likely)
{
    const Look *looks = sketch->cluster.looks;
    const Aim *aim = &likely->aim;
    double values[CURVE_NODES];
    double errors[3];
    size_t top = 0;
    size_t low = 0;
    for (size_t k = 0; k < CURVE_NODES; k++) {
        values[k] = aim_value(aim, &looks[k]);
        top = values[k] > values[top] ? k : top;
        low = values[k] < values[low] ? k : low;
    }
    likely->share = NAN;
    if (isnan(values[1])) {
        return true;
    }
    sketch_find_errors(sketch, aim, errors);
    if (sketch_error(errors, 0.5) > SKETCH_ERROR_MOST * (values[top] - values[low])) {
        return true;
    }
    double expected = values[top];
    if (top > 0 && top + 1 < CURVE_NODES) {
        top_of_three(aim, &looks[top - 1], &expected);
    }
    // a top between two nodes is higher than both by little
    if (!step_extremes_is_near(aim, expected + sketch_error(errors, 0.5), LIKELY)) {
        return false;
    }
    const double share = sketch_top(values, top);
    if (share > 0.0 && share < 1.0) {
        likely->share = share;
        return true;
    }
    // where the sketch does not show a top, there is none unless the error hides it
    for (size_t k = 1; k + 1 < CURVE_NODES; k++) {
        if (values[k] + sketch_error(errors, curve_node(k)) >= values[top]) {
            return true;
        }
    }
    return false;
}

// Whether alpha of a body is likely to be zero between two looks, where omega may then be beyond
// the run's extremes.
static bool has_likely_turn(const Looker *looker, const Sketch *sketch, const Look *first,
                            const Look *last, LikelyTurn *turn)
{
    const Cluster *cluster = &sketch->cluster;
    double alphas[CURVE_NODES];
    double omegas[CURVE_NODES];
    for (size_t k = 0; k < CURVE_NODES; k++) {
        alphas[k] = cluster->looks[k].alpha[turn->body];
        omegas[k] = cluster->looks[k].omega[turn->body];
    }
    double low = (first->time_s - cluster->start_s) / cluster->width_s;
    double high = (last->time_s - cluster->start_s) / cluster->width_s;
    if (isnan(alphas[1])) {
        turn->share = NAN;
        return true;
    }
    while (high - low > NEXT_TO_END) {
        const double middle = 0.5 * (low + high);
        const bool is_before = curve_at(alphas, middle) * first->alpha[turn->body] > 0.0;
        *(is_before ? &low : &high) = middle;
    }
    turn->share = 0.5 * (low + high);
    const double omega = curve_at(omegas, turn->share);
    const double room = STEP_EXTREMES_RISE_MAX * fabs(omega - first->omega[turn->body]);
    const BodyExtremes *extremes = &looker->recorder->trajectory->bodies[turn->body];
    return omega + room > extremes->omega_max.value || omega - room < extremes->omega_min.value;
}

// How far the mean of an acceleration between two looks lies above the middle of its chord, times
// the time between them.
static double area_above(const Look *first, const Look *last, size_t body)
{
    const double width_s = last->time_s - first->time_s;
    return last->omega[body] - first->omega[body] -
           0.5 * width_s * (first->alpha[body] + last->alpha[body]);
}

// Whether an acceleration has no top between two looks, as far as these and their mean tell: a
// parabola that rises from the first to the last by r, and whose mean lies b above the middle of
// its chord, has none between them where 6 b <= r: half of that is asked for.
static bool is_steady(const Look *first, const Look *last, size_t body)
{
    const double width_s = last->time_s - first->time_s;
    return 12.0 * fabs(area_above(first, last, body)) <=
           width_s * fabs(last->alpha[body] - first->alpha[body]);
}

// How far signals may rise above the ends of a step's parts, where the mean says that they bulge by
// 1: a parabola by 1.5, and four times that where it is none.
static const double BULGE_MOST = 6.0;

// The largest bulge that an acceleration may have in a step, over the body's largest so far: what
// forces may bulge by, of which no mean is known.
static double largest_bulge(const Looker *looker, const Look *before, int parts, const Look *looks)
{
    const Linkage *linkage = &looker->scenario->linkage;
    const size_t body_count = solver_body_count(looker->part, linkage);
    double largest = 0.0;
    for (size_t n = 0; n < body_count; n++) {
        const size_t i = solver_body(looker->part, n);
        const BodyExtremes *extremes = &looker->recorder->trajectory->bodies[i];
        const double most = fmax(extremes->alpha_max.value, -extremes->alpha_min.value);
        for (int k = 0; k < parts && !linkage_is_driven(linkage, (int)i); k++) {
            const Look *first = k > 0 ? &looks[k - 1] : before;
            const double width_s = looks[k].time_s - first->time_s;
            const double above = fabs(area_above(first, &looks[k], i));
            largest = above > largest * most * width_s ? above / (most * width_s) : largest;
        }
    }
    return BULGE_MOST * largest;
}

// Whether a signal may have a top between two looks that comes near the run's extreme, as far as
// these and their means tell. Forces may bulge by a share of their largest so far.
static bool may_have_top_between(const Aim *aim, const Look *first, const Look *last, double bulge)
{
    const double start = aim_value(aim, first);
    const double end = aim_value(aim, last);
    const double higher = end > start ? end : start;
    const double change = fabs(end - start);
    double rise = bulge * fabs(aim->extreme);
    if (aim->signal < aim->looker->scenario->linkage.body_count) {
        if (is_steady(first, last, aim->signal)) {
            return false;
        }
        rise = BULGE_MOST * fabs(area_above(first, last, aim->signal)) /
               (last->time_s - first->time_s);
    }
    return rise + change > EXTREMES_ALIKE * fabs(higher) &&
           step_extremes_is_near(aim, higher + rise, STEP_EXTREMES_RISE_MAX);
}

// The same in any part of a step, or where two meet.
static bool may_have_top_inside(const Aim *aim, const Look *before, int parts, const Look *looks,
                                double bulge)
{
    bool may = false;
    for (int k = 0; k < parts && !may; k++) {
        const Look *first = k > 0 ? &looks[k - 1] : before;
        const double value = aim_value(aim, &looks[k]);
        may = may_have_top_between(aim, first, &looks[k], bulge) ||
              (k + 1 < parts && value >= aim_value(aim, first) &&
               value >= aim_value(aim, &looks[k + 1]) &&
               step_extremes_is_near(aim, value, STEP_EXTREMES_RISE_MAX));
    }
    return may;
}

// Whether anything may be beyond the run's extremes, as far as ends of parts tell.
static bool may_have_any(Looker *looker, const Look *before, int parts, const Look *looks,
                         double bulge)
{
    const size_t body_count = solver_body_count(looker->part, &looker->scenario->linkage);
    for (int k = 0; k < parts; k++) {
        const Look *first = k > 0 ? &looks[k - 1] : before;
        for (size_t i = 0; i < body_count; i++) {
            if (may_turn(looker, solver_body(looker->part, i), first, &looks[k])) {
                return true;
            }
        }
    }
    Aim aim;
    for (size_t number = 0; next_aim(looker, &number, &aim);) {
        // what is steady needs no second look for its other sign
        const bool is_body = number <= 2 * body_count;
        if (is_body && parts == 1 && is_steady(before, looks, aim.signal)) {
            number += number % 2;
            continue;
        }
        if (may_have_top_inside(&aim, before, parts, looks, bulge)) {
            return true;
        }
    }
    return false;
}

// Whether the look inside shows a signal near its extreme, higher than at both ends.
static bool has_seen_top(const Sketch *sketch, const Aim *aim)
{
    const double value = aim_value(aim, &sketch->look);
    return value > aim_value(aim, &sketch->cluster.looks[0]) &&
           value > aim_value(aim, &sketch->cluster.looks[CURVE_NODES - 1]) &&
           step_extremes_is_near(aim, value, STEP_EXTREMES_RISE_MAX);
}

// The step from its ends and what lies between, and what is likely in it.
static void sketch_step(Looker *looker, const Look *before, int parts, const Look *looks,
                        double bulge, Sketch *sketch)
{
    const Look *end = &looks[parts - 1];
    const size_t body_count = solver_body_count(looker->part, &looker->scenario->linkage);
    Cluster *cluster = &sketch->cluster;
    *cluster = (Cluster){
        .looker = looker, .start_s = before->time_s, .width_s = end->time_s - before->time_s};
    cluster->looks[0] = *before;
    cluster->looks[CURVE_NODES - 1] = *end;
    for (size_t k = 1; k + 1 < CURVE_NODES; k++) {
        cluster->looks[k] =
            look_sketch(looker, cluster->start_s + curve_node(k) * cluster->width_s);
    }
    const double check_s = cluster->start_s + SKETCH_CHECK * cluster->width_s;
    sketch->ends[0] = look_sketch(looker, cluster->start_s);
    sketch->ends[1] = look_sketch(looker, end->time_s);
    sketch->check = look_sketch(looker, check_s);
    sketch->look = look_inside(looker, check_s);
    sketch->top_count = sketch->turn_count = 0;
    for (int k = 0; k < parts; k++) {
        const Look *first = k > 0 ? &looks[k - 1] : before;
        for (size_t i = 0; i < body_count && sketch->turn_count <= SOUGHT_MOST; i++) {
            LikelyTurn *turn = &sketch->turns[sketch->turn_count];
            turn->body = solver_body(looker->part, i);
            sketch->turn_count += may_turn(looker, turn->body, first, &looks[k]) &&
                                          has_likely_turn(looker, sketch, first, &looks[k], turn)
                                      ? 1
                                      : 0;
        }
    }
    Aim aim;
    for (size_t number = 0; sketch->top_count <= SOUGHT_MOST && next_aim(looker, &number, &aim);) {
        Likely *likely = &sketch->tops[sketch->top_count];
        likely->aim = aim;
        const bool may =
            may_have_top_inside(&aim, before, parts, looks, bulge) || has_seen_top(sketch, &aim);
        sketch->top_count += may && has_likely_top(sketch, likely) ? 1 : 0;
    }
}

// Looks where a signal is likely to have its top, and climbs to it from there. Where it is not
// there its place is not known.
static bool find_likely_top(Looker *looker, const Sketch *sketch, Likely *likely, Look *found)
{
    const Cluster *cluster = &sketch->cluster;
    const double width_s = cluster->width_s;
    const double time_s = cluster->start_s + likely->share * width_s;
    const double reach = fmin(SKETCH_REACH, 0.5 * fmin(likely->share, 1.0 - likely->share));
    const Look points[] = {
        cluster->looks[0],
        look_inside(looker, time_s - reach * width_s),
        look_inside(looker, time_s),
        look_inside(looker, time_s + reach * width_s),
        cluster->looks[CURVE_NODES - 1],
    };
    const Aim aim = {looker, likely->aim.signal, likely->aim.sign,
                     extreme_so_far(looker, likely->aim.signal, likely->aim.sign)};
    const double top = fmax(aim_value(&aim, &points[1]),
                            fmax(aim_value(&aim, &points[2]), aim_value(&aim, &points[3])));
    if (aim_value(&aim, &points[0]) > top || aim_value(&aim, &points[4]) > top) {
        likely->share = NAN;
        return false;
    }
    return step_extremes_find_top(&aim, sizeof points / sizeof *points, points, found);
}

// Looks that show tops of signals whose sketch does not.
typedef struct Shown {
    Looker *looker;
    size_t count;
    Look
        points[LOOK_PARTS_MAX + 2]; // the ends of the step's parts, or those of the step and a look
    Look beside[2];                 // next to the step's ends, once they are asked for
    bool has_beside[2];
} Shown;

static Shown shown_start(const Sketch *sketch, int parts, const Look *looks)
{
    Shown shown = {.looker = sketch->cluster.looker};
    shown.points[shown.count++] = sketch->cluster.looks[0];
    if (parts == 1) {
        shown.points[shown.count++] = sketch->look;
    }
    for (int k = 0; k < parts; k++) {
        shown.points[shown.count++] = looks[k];
    }
    return shown;
}

static const Look *look_beside_end(Shown *shown, bool is_last)
{
    const double start_s = shown->points[0].time_s;
    const double end_s = shown->points[shown->count - 1].time_s;
    const double by_s = NEXT_TO_END * (end_s - start_s);
    Look *beside = &shown->beside[is_last ? 1 : 0];
    if (!shown->has_beside[is_last ? 1 : 0]) {
        *beside = look_inside(shown->looker, is_last ? end_s - by_s : start_s + by_s);
        shown->has_beside[is_last ? 1 : 0] = true;
    }
    return beside;
}

// Climbs to the top of a signal if there may be one.
static bool find_shown_top(Shown *shown, const Aim *aim, Look *found)
{
    const Look *points = shown->points;
    const size_t last = shown->count - 1;
    size_t top = 0;
    for (size_t i = 1; i <= last; i++) {
        top = aim_value(aim, &points[i]) > aim_value(aim, &points[top]) ? i : top;
    }
    if (top > 0 && top < last) {
        return step_extremes_find_top(aim, shown->count, points, found);
    }
    const Look three[] = {points[top == 0 ? 0 : last - 1], *look_beside_end(shown, top != 0),
                          points[top == 0 ? 1 : last]};
    return step_extremes_find_top(aim, 3, three, found);
}

// Climbs to the tops of signals whose sketch does not show them.
static int look_at_others(const Sketch *sketch, int parts, Look looks[LOOK_MAX])
{
    Looker *looker = sketch->cluster.looker;
    Shown shown = shown_start(sketch, parts, looks);
    int count = parts;
    for (size_t i = 0; i < sketch->top_count; i++) {
        Aim aim = sketch->tops[i].aim;
        Look top;
        aim.extreme = extreme_so_far(looker, aim.signal, aim.sign);
        if (isnan(sketch->tops[i].share) && find_shown_top(&shown, &aim, &top)) {
            count = insert(looks, count, &top);
        }
    }
    return count;
}

// Looks for what is likely in a step.
static int look_at_likely(Sketch *sketch, int parts, Look looks[LOOK_MAX])
{
    const Cluster *cluster = &sketch->cluster;
    Looker *looker = cluster->looker;
    const double end_s = cluster->start_s + cluster->width_s;
    for (size_t i = 0; i < sketch->turn_count; i++) {
        const LikelyTurn *likely = &sketch->turns[i];
        Turn turn = {looker, likely->body};
        const double time_s = cluster->start_s + likely->share * cluster->width_s;
        const double reach_s = SKETCH_REACH * cluster->width_s;
        const double from_s = fmax(time_s - reach_s, cluster->start_s);
        if (isnan(likely->share) ||
            !look_for_turn(&turn, from_s, fmin(time_s + reach_s, end_s), cluster->width_s)) {
            look_for_turn(&turn, cluster->start_s, end_s, cluster->width_s);
        }
    }
    Look found[SOUGHT_MOST];
    size_t found_count = 0;
    for (size_t i = 0; i < sketch->top_count; i++) {
        found_count +=
            !isnan(sketch->tops[i].share) &&
                    find_likely_top(looker, sketch, &sketch->tops[i], &found[found_count])
                ? 1
                : 0;
    }
    int count = look_at_others(sketch, parts, looks);
    for (size_t i = 0; i < found_count; i++) {
        count = insert(looks, count, &found[i]);
    }
    return count;
}

int look_into_step(Looker *looker, const Look *before, int parts, bool is_smooth,
                   Look looks[LOOK_MAX])
{
    const Look *end = &looks[parts - 1];
    if (looker->solver->sketch == NULL) {
        if (is_smooth && look_is_cluster(looker, before, parts, looks)) {
            look_at_cluster(looker, before, end);
            return parts;
        }
        return look_for_extremes(looker, before, parts, looks);
    }
    if (!(end->time_s > before->time_s)) {
        return parts;
    }
    const double bulge = largest_bulge(looker, before, parts, looks);
    if (!may_have_any(looker, before, parts, looks, bulge)) {
        return parts;
    }
    Sketch sketch;
    sketch_step(looker, before, parts, looks, bulge, &sketch);
    const size_t count = sketch.top_count + sketch.turn_count;
    if (is_smooth && count > LIKELY_MOST && is_large(looker)) {
        look_at_cluster(looker, before, end);
        return parts;
    }
    sketch.top_count = sketch.top_count < SOUGHT_MOST ? sketch.top_count : SOUGHT_MOST;
    return look_at_likely(&sketch, parts, looks);
}
