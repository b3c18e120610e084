// How far do many signals go between the ends of a step?
//
// To climb to the top of each by itself evaluates all bodies for each of many. All are looked at
// together at a few instants instead, and the polynomial through these (base/curve.h) has the
// extremes.
#include "run/look_crowd.h"

#include "base/curve.h"

// of the extreme so far: between two nodes a signal rises by no more above both
static const double NEAR = 0.01;

// What a recorder knows of one signal: its extreme, with the sign that makes this a maximum.
typedef struct Signal {
    RecorderSignal which;
    size_t number; // of the body or joint
    double sign;
} Signal;

typedef struct Crowd {
    Looker *looker; // receives the tops
    double start_s;
    double width_s;
    Look looks[CURVE_NODES];
} Crowd;

static double value_of(const Look *look, const Signal *signal)
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

static LookTop *tops_of(const Looker *looker, RecorderSignal which, size_t number)
{
    return which == RECORDER_FORCE ? looker->force_tops[number] : looker->alpha_tops[number];
}

// Lets the looker have a top of an acceleration or a force, with the speed there.
static void note_top(const Crowd *crowd, const Signal *signal, double share, double value)
{
    const Signal speed = {RECORDER_OMEGA, signal->number, 1.0};
    LookTop top = {crowd->start_s + share * crowd->width_s, signal->sign * value, 0.0, true};
    if (signal->which == RECORDER_OMEGA) {
        return;
    }
    if (signal->which == RECORDER_ALPHA) {
        double speeds[CURVE_NODES];
        for (size_t k = 0; k < CURVE_NODES; k++) {
            speeds[k] = value_of(&crowd->looks[k], &speed);
        }
        top.omega = curve_at(speeds, share);
    }
    tops_of(crowd->looker, signal->which, signal->number)[signal->sign > 0.0 ? 1 : 0] = top;
}

// Raises an extreme to the top of its signal.
static void raise_signal(const Crowd *crowd, Signal signal)
{
    Recorder *recorder = crowd->looker->recorder;
    const Extreme *extreme = recorder_extreme(recorder, signal.which, signal.number, signal.sign);
    const double so_far = signal.sign * extreme->value;
    double values[CURVE_NODES];
    size_t largest = 0;
    for (size_t k = 0; k < CURVE_NODES; k++) {
        values[k] = signal.sign * value_of(&crowd->looks[k], &signal);
        largest = values[k] > values[largest] ? k : largest;
    }
    const bool is_inside = largest > 0 && largest + 1 < CURVE_NODES;
    if (!is_inside && !(values[largest] >= so_far - NEAR * fabs(so_far))) {
        return;
    }
    double share = 0.0;
    const double top = curve_top(values, &share);
    note_top(crowd, &signal, share, top);
    if (top > so_far) {
        const double time_s = crowd->start_s + share * crowd->width_s;
        recorder_raise(recorder, signal.which, signal.number, signal.sign,
                       (Extreme){.time_s = time_s, .value = signal.sign * top});
    }
}

static void forget_tops(LookTop *tops)
{
    for (size_t i = 0; i < LOOK_SIGNS; i++) {
        tops[i].is_known = false;
    }
}

static void raise_all(const Crowd *crowd)
{
    const Linkage *linkage = &crowd->looker->scenario->linkage;
    const SolverPart *part = crowd->looker->part;
    const size_t body_count = solver_body_count(part, linkage);
    const size_t joint_count = solver_joint_count(part, linkage);
    const int driven = linkage_driven_body(linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t body = solver_body(part, k);
        forget_tops(crowd->looker->alpha_tops[body]);
        if ((int)body == driven) {
            continue; // it moves as it is told
        }
        for (int sign = -1; sign <= 1; sign += 2) {
            raise_signal(crowd, (Signal){RECORDER_OMEGA, body, sign});
            raise_signal(crowd, (Signal){RECORDER_ALPHA, body, sign});
        }
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t joint = solver_joint(part, k);
        forget_tops(crowd->looker->force_tops[joint]);
        raise_signal(crowd, (Signal){RECORDER_FORCE, joint, 1.0});
    }
}

void look_at_crowd(Looker *looker, const Look *before, const Look *end)
{
    Crowd crowd = {
        .looker = looker, .start_s = before->time_s, .width_s = end->time_s - before->time_s};
    crowd.looks[0] = *before;
    crowd.looks[CURVE_NODES - 1] = *end;
    for (size_t k = 1; k + 1 < CURVE_NODES; k++) {
        crowd.looks[k] = look_inside(looker, crowd.start_s + curve_node(k) * crowd.width_s);
    }
    raise_all(&crowd);
    looker->has_tops = true;
}

// Adds the tops between two times to a path, the earlier one first.
static size_t add_tops(const LookTop *tops, double from_s, double to_s, LookPoint *path,
                       size_t count)
{
    const size_t first = tops[0].time_s <= tops[1].time_s ? 0 : 1;
    for (size_t i = 0; i < LOOK_SIGNS; i++) {
        const LookTop *top = &tops[i == 0 ? first : 1 - first];
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
        if (looker->has_tops) {
            const double from_s = k > 0 ? looks[k - 1].time_s : before_s;
            points = add_tops(tops_of(looker, signal, number), from_s, look->time_s, path, points);
        }
        path[points++] =
            (LookPoint){look->time_s, is_force ? look->force[number] : look->alpha[number],
                        is_force ? 0.0 : look->omega[number]};
    }
    return points;
}
