// Keeps the history of every signal of a run and finds the spikes in it.
//
// Every step puts the angular acceleration of each body that is not driven, and the force of each
// joint, into a trace (run/trace.c). Integrals are the solver's own: omega, and the impulse of the
// contacts.
// A step whose values are means stands at its middle. One whose values are instants is looked at
// inside, too, as far as its straight line is off: with s = s_0, s_1 at the ends of a step h and
// the integral J known, a parabola stands 3/2 (J / h - (s_0 + s_1) / 2) off its chord at the
// middle, and n parts bring that down to 1 / n^2 of it.
#include "run/tracer.h"
#include "base/grouped.h"
#include "base/sorted.h"
#include "base/union_find.h"
#include "base/zeroed.h"
#include "model/loads.h"
#include "run/spikes.h"
#include "run/step_extremes.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// The joints with play from which a force reaches a body.

// Whether a body hands on forces from one of its joints to another.
static bool hands_on(const Linkage *linkage, int body)
{
    return body != LINKAGE_GROUND && !linkage_is_driven(linkage, body);
}

// By body: the first of those that ideal joints connect with it.
static size_t *tracer_connect(const Linkage *linkage)
{
    size_t *parents = zeroed(linkage->body_count, sizeof *parents);
    union_find_start(parents, linkage->body_count);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint_is_ideal(joint->kind) && hands_on(linkage, joint->body_a) &&
            hands_on(linkage, joint->body_b)) {
            union_find_join(parents, (size_t)joint->body_a, (size_t)joint->body_b);
        }
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        parents[i] = union_find_root(parents, i);
    }
    return parents;
}

// The set that one end of a joint with play acts on; none where its other end does already.
static size_t set_of(const Linkage *linkage, const size_t *parents, size_t end)
{
    const Joint *joint = &linkage->joints[end / 2];
    const bool is_a = end % 2 == 0;
    const int body = is_a ? joint->body_a : joint->body_b;
    if (!linkage_has_play(joint) || !hands_on(linkage, body)) {
        return GROUPED_NONE;
    }
    const size_t set = parents[body];
    return !is_a && set_of(linkage, parents, end - 1) == set ? GROUPED_NONE : set;
}

Causes causes_find(const Linkage *linkage)
{
    const size_t ends = 2 * linkage->joint_count;
    Causes causes = {
        .set_of = tracer_connect(linkage),
        .firsts = zeroed(linkage->body_count + 1, sizeof *causes.firsts),
        .ends = zeroed(ends, sizeof *causes.ends),
    };
    size_t *sets = zeroed(ends, sizeof *sets);
    for (size_t i = 0; i < ends; i++) {
        sets[i] = set_of(linkage, causes.set_of, i);
    }
    grouped_list(linkage->body_count, ends, sets, causes.firsts, causes.ends);
    free(sets);
    return causes;
}

void causes_finish(Causes *causes)
{
    free(causes->set_of);
    free(causes->firsts);
    free(causes->ends);
}

enum {
    // of a trace: 400 kB each; some 600 impacts of full height
    POINTS_MOST = 1 << 14,
};

// the least tolerance of a history over the least prominence of a spike
static const double FINENESS = 1e-2;

// Of a case without a known scale: a spike stands out by so much of the signal's own range...
static const double OWN_SHARE = 0.1;

// ... and in an angular acceleration by so much of what the forces could do: less is rounding, as
// of a pin without friction
static const double ROUNDING = 1e-6;

// of a step: a corner so near to its start is there
static const double CORNER_ROUNDING = 1e-9;

typedef struct Tracer {
    const Scenario *scenario;
    Looker looker;
    bool has_corners; // whether a drive's acceleration or a load jumps
    bool has_traces;  // whether joints have play: else it looks for extremes alone
    SpikeScale scale;
    Trace *alpha;    // by body; owned, like the next two
    Trace *force;    // by joint
    double *impulse; // N s, so far
    Look last;       // at the end of the last step, of each part its own
    bool *has_begun; // by part; owned, like the next two
    double *body_s;  // by body, when it was in a record last, of solvers that tell what has changed
    double *joint_s; // by joint
    Causes causes;
} Tracer;

// When a drive's acceleration or a load jumps next after a time, s.
static double next_corner(const Linkage *linkage, double time_s)
{
    return fmin(linkage_next_kink(linkage, time_s), loads_next_jump(linkage, time_s));
}

static bool is_traced(const Tracer *tracer, size_t body)
{
    return !linkage_is_driven(&tracer->scenario->linkage, (int)body);
}

static void *tracer_begin(const Scenario *scenario, const Solver *solver, const void *state,
                          Recorder *recorder, const void *shared)
{
    // with ideal joints alone a solver that cannot sketch a step would be asked too often
    if (solver->is_ideal || (!scenario_has_clearance(scenario) && solver->sketch == NULL)) {
        return NULL;
    }
    Tracer *tracer = calloc(1, sizeof *tracer);
    assert(tracer != NULL);
    tracer->scenario = scenario;
    tracer->looker = looker_start(scenario, solver, state, recorder);
    tracer->has_begun = zeroed(scenario->linkage.body_count, sizeof *tracer->has_begun);
    tracer->has_corners = isfinite(next_corner(&scenario->linkage, 0.0));
    tracer->has_traces = scenario_has_clearance(scenario);
    if (!tracer->has_traces) {
        return tracer;
    }
    tracer->alpha = zeroed(scenario->linkage.body_count, sizeof *tracer->alpha);
    tracer->force = zeroed(scenario->linkage.joint_count, sizeof *tracer->force);
    tracer->impulse = zeroed(scenario->linkage.joint_count, sizeof *tracer->impulse);
    tracer->body_s = zeroed(scenario->linkage.body_count, sizeof *tracer->body_s);
    tracer->joint_s = zeroed(scenario->linkage.joint_count, sizeof *tracer->joint_s);
    tracer->causes = causes_find(&scenario->linkage);
    tracer->scale = shared != NULL ? *(const SpikeScale *)shared : spike_scale(scenario);
    const double fine = tracer->scale.is_known ? FINENESS * scenario->run.spike_threshold : 0.0;
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        tracer->alpha[i] = trace_start(fine * tracer->scale.alpha, POINTS_MOST);
    }
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        tracer->force[i] = trace_start(fine * tracer->scale.force, POINTS_MOST);
    }
    return tracer;
}

// A step of means: they stand at its middle, and half of the change comes before.
static void add_means(Tracer *tracer, const StepRecord *step)
{
    const Linkage *linkage = &tracer->scenario->linkage;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    const double half_s = 0.5 * (step->end_s - step->start_s);
    const double middle_s = step->start_s + half_s;
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(step->part, k);
        if (is_traced(tracer, i)) {
            trace_add(&tracer->alpha[i], middle_s, step->alpha[k],
                      step->omega[k] - half_s * step->alpha[k]);
        }
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t i = solver_joint(step->part, k);
        const double half = 0.5 * step->impulse[k];
        trace_add(&tracer->force[i], middle_s, step->joints[k].force, tracer->impulse[i] + half);
        tracer->impulse[i] += step->impulse[k];
    }
}

// The parts that bring a chord within the tolerance, whose ends and mean are given.
static double parts_for(double first, double last, double mean, double tolerance)
{
    const double off = 1.5 * fabs(mean - 0.5 * (first + last));
    return off > tolerance ? sqrt(off / tolerance) : 1.0;
}

static bool has_play(const Tracer *tracer, size_t joint)
{
    return linkage_has_play(&tracer->scenario->linkage.joints[joint]);
}

static int count_parts(const Tracer *tracer, const StepRecord *step)
{
    const Linkage *linkage = &tracer->scenario->linkage;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    const double width_s = step->end_s - step->start_s;
    double parts = 1.0;
    if (!(width_s > 0.0)) {
        return 1;
    }
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(step->part, k);
        const double mean = (step->omega[k] - tracer->last.omega[i]) / width_s;
        if (is_traced(tracer, i)) {
            const double own =
                parts_for(tracer->last.alpha[i], step->alpha[k], mean, tracer->alpha[i].tolerance);
            parts = own > parts ? own : parts; // once a signal and step: fmax would be a call
        }
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t i = solver_joint(step->part, k);
        if (has_play(tracer, i)) {
            const double own = parts_for(tracer->last.force[i], step->joints[k].force,
                                         step->impulse[k] / width_s, tracer->force[i].tolerance);
            parts = own > parts ? own : parts;
        }
    }
    return (int)ceil(fmin(parts, LOOK_PARTS_MAX));
}

// The force of a joint at the looks. Its impulse in the parts is in proportion to what the broken
// line holds; the impulse of a contact in the whole step, N s, is the solver's.
static void add_forces(Tracer *tracer, size_t joint, double impulse, int count, const Look *looks)
{
    LookPoint path[LOOK_PATH_MAX];
    double sums[LOOK_PATH_MAX];
    double sum = 0.0;
    LookPoint before = {.time_s = tracer->last.time_s, .value = tracer->last.force[joint]};
    const size_t points =
        look_path(&tracer->looker, RECORDER_FORCE, joint, before.time_s, count, looks, path);
    for (size_t k = 0; k < points; k++) {
        sum += 0.5 * (path[k].time_s - before.time_s) * (before.value + path[k].value);
        sums[k] = sum;
        before = path[k];
    }
    const double factor = has_play(tracer, joint) && sum > 0.0 ? impulse / sum : 1.0;
    for (size_t k = 0; k < points; k++) {
        trace_add(&tracer->force[joint], path[k].time_s, path[k].value,
                  tracer->impulse[joint] + factor * sums[k]);
    }
    tracer->impulse[joint] += factor * sum;
}

// Adds looks at bodies to their traces.
static void tracer_add_bodies(Tracer *tracer, const SolverPart *part, int count, const Look *looks)
{
    const size_t body_count = solver_body_count(part, &tracer->scenario->linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(part, k);
        LookPoint path[LOOK_PATH_MAX];
        const size_t points = is_traced(tracer, i)
                                  ? look_path(&tracer->looker, RECORDER_ALPHA, i,
                                              tracer->last.time_s, count, looks, path)
                                  : 0;
        for (size_t at = 0; at < points; at++) {
            trace_add(&tracer->alpha[i], path[at].time_s, path[at].value, path[at].omega);
        }
    }
}

// Whether a step begins at a corner: the end of the step before it then says nothing of its start.
static bool begins_at_corner(const Tracer *tracer, const StepRecord *step)
{
    const double rounding_s = CORNER_ROUNDING * (step->end_s - step->start_s);
    return tracer->has_corners &&
           next_corner(&tracer->scenario->linkage, step->start_s - rounding_s) <=
               step->start_s + rounding_s;
}

// Where the run begins, or a corner lies, nothing has been looked at before.
static void look_at_start(Tracer *tracer, const StepRecord *step)
{
    const size_t joint_count = solver_joint_count(step->part, &tracer->scenario->linkage);
    if (tracer->last.omega == NULL) {
        tracer->last = looker_first(&tracer->looker);
    }
    const Look look = look_inside(&tracer->looker, step->start_s);
    if (tracer->has_traces) {
        tracer_add_bodies(tracer, step->part, 1, &look);
    }
    for (size_t k = 0; tracer->has_traces && k < joint_count; k++) {
        const size_t i = solver_joint(step->part, k);
        trace_add(&tracer->force[i], look.time_s, look.force[i], tracer->impulse[i]);
    }
    looker_keep(&tracer->looker, &tracer->last, &look);
}

// The signals of a record in the time since `last` was set.
static void add_signals(Tracer *tracer, const StepRecord *step)
{
    const int parts = count_parts(tracer, step);
    const double part_s = (step->end_s - step->start_s) / parts;
    Look looks[LOOK_MAX];
    for (int k = 0; k + 1 < parts; k++) {
        looks[k] = look_inside(&tracer->looker, step->start_s + (k + 1) * part_s);
    }
    looks[parts - 1] = look_at_end(&tracer->looker, step);
    const int count = look_into_step(&tracer->looker, &tracer->last, parts, step->is_smooth, looks);
    tracer_add_bodies(tracer, step->part, count, looks);
    const size_t joint_count = solver_joint_count(step->part, &tracer->scenario->linkage);
    for (size_t k = 0; k < joint_count; k++) {
        add_forces(tracer, solver_joint(step->part, k), step->impulse[k], count, looks);
    }
    looker_keep(&tracer->looker, &tracer->last, &looks[count - 1]);
}

// One body or joint that has changed in a record, from when it was in one last.
static void add_one(Tracer *tracer, const StepRecord *step, const SolverSome *one)
{
    const bool is_body = one->body_count > 0;
    const size_t k = is_body ? one->bodies[0] : one->joints[0];
    const size_t i = is_body ? solver_body(step->part, k) : solver_joint(step->part, k);
    const int number = (int)i;
    const SolverPart part = {0, one->body_count, one->joint_count, &number, &number};
    double *last_s = is_body ? &tracer->body_s[i] : &tracer->joint_s[i];
    if (is_body && !is_traced(tracer, i)) {
        return; // it moves as it is told
    }
    const StepRecord own = {
        .part = &part,
        .start_s = *last_s,
        .end_s = step->end_s,
        .is_smooth = step->is_smooth,
        .omega = step->omega + k,
        .alpha = step->alpha + k,
        .joints = step->joints + k,
        .impulse = step->impulse + k,
    };
    tracer->looker.part = &part;
    tracer->looker.some = one;
    tracer->last.time_s = *last_s;
    add_signals(tracer, &own);
    *last_s = step->end_s;
    tracer->looker.some = NULL;
}

// Each body and joint that has changed by itself: a look at one costs no more than what acts on it.
static void add_changed(Tracer *tracer, const StepRecord *step)
{
    const SolverSome *changed = step->changed;
    for (size_t n = 0; n < changed->body_count; n++) {
        add_one(tracer, step, &(SolverSome){.body_count = 1, .bodies = &changed->bodies[n]});
    }
    for (size_t n = 0; n < changed->joint_count; n++) {
        add_one(tracer, step, &(SolverSome){.joint_count = 1, .joints = &changed->joints[n]});
    }
    tracer->looker.part = NULL;
}

static void add_instants(Tracer *tracer, const StepRecord *step)
{
    bool *has_begun = &tracer->has_begun[step->part != NULL ? step->part->number : 0];
    tracer->looker.part = step->part;
    if (!*has_begun || (step->changed == NULL && begins_at_corner(tracer, step))) {
        look_at_start(tracer, step);
        *has_begun = true;
    }
    if (step->changed != NULL) {
        add_changed(tracer, step);
        return;
    }
    if (step->part != NULL) {
        tracer->last.time_s = step->start_s; // the last step was another part's
    }
    add_signals(tracer, step);
}

// Looks for the extremes of a step without a trace.
static void look_alone(Tracer *tracer, const StepRecord *step)
{
    bool *has_begun = &tracer->has_begun[step->part != NULL ? step->part->number : 0];
    tracer->looker.part = step->part;
    if (!*has_begun || begins_at_corner(tracer, step)) {
        look_at_start(tracer, step);
        *has_begun = true;
    }
    tracer->last.time_s = step->start_s;
    Look looks[LOOK_MAX];
    looks[0] = look_at_end(&tracer->looker, step);
    look_into_step(&tracer->looker, &tracer->last, 1, step->is_smooth, looks);
    looker_keep(&tracer->looker, &tracer->last, &looks[0]);
}

static void tracer_look(void *own, const StepRecord *step)
{
    Tracer *tracer = own;
    if (step->is_mean && tracer->has_traces) {
        add_means(tracer, step);
    } else if (!step->is_mean && tracer->has_traces) {
        add_instants(tracer, step);
    } else if (!step->is_mean) {
        look_alone(tracer, step);
    }
}

// The values of a trace within a time.
static double range_within(const Trace *trace, double from_s, double to_s)
{
    double least = INFINITY;
    double most = -INFINITY;
    // the first point inside, by halving
    size_t low = 0;
    size_t high = trace->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (trace->points[middle].time_s < from_s) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    for (size_t i = low; i < trace->count && trace->points[i].time_s <= to_s; i++) {
        least = fmin(least, trace->points[i].value);
        most = fmax(most, trace->points[i].value);
    }
    return most - least;
}

// The joint with play whose force changes most within a spike of a body, of those that reach it.
static int tracer_find_joint(const Tracer *tracer, size_t body, const SignalSpike *spike)
{
    const Causes *causes = &tracer->causes;
    int found = -1;
    double most = 0.0;
    for (size_t k = 0; k < causes_count(causes, body); k++) {
        const int joint = (int)causes_joint(causes, body, k);
        const double range = range_within(&tracer->force[joint], spike->onset_s, spike->end_s);
        found = range > most ? joint : found;
        most = fmax(most, range);
    }
    return found;
}

static bool tracer_is_stronger(const void *a, const void *b)
{
    return fabs(((const SignalSpike *)a)->value) > fabs(((const SignalSpike *)b)->value);
}

static void count_sector(SignalSpikes *spikes, const SignalSpike *spike)
{
    const double turn = spike->crank_rad / (2.0 * M_PI);
    const double share = turn - floor(turn);
    const size_t sector = (size_t)(share * SIGNAL_SECTOR_COUNT) % SIGNAL_SECTOR_COUNT;
    spikes->sectors[sector].count++;
    spikes->sectors[sector].largest = fmax(spikes->sectors[sector].largest, fabs(spike->value));
}

// The spikes of one signal, of a body or of none (-1), that reach a threshold. A signal that is
// nothing has none.
static void tell_signal(const Tracer *tracer, const Trace *trace, double threshold, int body,
                        SignalSpikes *spikes)
{
    const Linkage *linkage = &tracer->scenario->linkage;
    SignalSpike *found = NULL;
    *spikes = (SignalSpikes){
        .is_known = true, .threshold = threshold, .resolution = 2.0 * trace->tolerance};
    const size_t count = threshold > 0.0 ? spikes_find(trace, threshold, &found) : 0;
    for (size_t i = 0; i < count; i++) {
        if (found[i].time_s < scenario_report_from(tracer->scenario)) {
            continue;
        }
        spikes->count++;
        found[i].crank_rad = linkage_crank_angle(linkage, found[i].time_s);
        found[i].joint = body >= 0 ? tracer_find_joint(tracer, (size_t)body, &found[i]) : -1;
        sorted_insert(spikes->spikes, &spikes->kept, SIGNAL_SPIKE_MAX, &found[i], sizeof found[i],
                      tracer_is_stronger);
        if (linkage->driver.is_present) {
            count_sector(spikes, &found[i]);
        }
    }
    free(found);
}

// Thresholds of a case without a known scale: a share of the signal's own range.
static double own_threshold(const Tracer *tracer, const Trace *trace, double least)
{
    const double from_s = scenario_report_from(tracer->scenario);
    return OWN_SHARE * tracer->scenario->run.spike_threshold *
           fmax(range_within(trace, from_s, INFINITY), least);
}

// What a force on an arm makes of a body that hangs at the other end, rad/s^2.
static double alpha_of_force(const Body *body, double arm, double force)
{
    return force * arm / (body->inertia + body->mass * arm * arm);
}

static void tell_all(Tracer *tracer, Trajectory *trajectory)
{
    const Scenario *scenario = tracer->scenario;
    const Linkage *linkage = &scenario->linkage;
    double largest = 0.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        trace_close(&tracer->force[i]);
        largest = fmax(largest, tracer->force[i].largest);
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        const double least =
            ROUNDING * alpha_of_force(&linkage->bodies[i], trajectory->reach[i], largest);
        trace_close(&tracer->alpha[i]);
        tell_signal(tracer, &tracer->alpha[i],
                    tracer->scale.is_known ? scenario->run.spike_threshold * tracer->scale.alpha
                                           : own_threshold(tracer, &tracer->alpha[i], least),
                    (int)i, &trajectory->alpha_spikes[i]);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        // of forces that a solver does not know nothing can be told
        if (isnan(trajectory->joints[i].force_max.value)) {
            continue;
        }
        tell_signal(tracer, &tracer->force[i],
                    tracer->scale.is_known ? scenario->run.spike_threshold * tracer->scale.force
                                           : own_threshold(tracer, &tracer->force[i], 0.0),
                    -1, &trajectory->force_spikes[i]);
    }
}

static void tracer_end(void *own, Trajectory *trajectory)
{
    Tracer *tracer = own;
    if (trajectory->is_complete && tracer->has_traces) {
        tell_all(tracer, trajectory);
    }
    for (size_t i = 0; tracer->has_traces && i < tracer->scenario->linkage.body_count; i++) {
        trace_finish(&tracer->alpha[i]);
    }
    for (size_t i = 0; tracer->has_traces && i < tracer->scenario->linkage.joint_count; i++) {
        trace_finish(&tracer->force[i]);
    }
    free(tracer->alpha);
    free(tracer->force);
    free(tracer->impulse);
    free(tracer->has_begun);
    free(tracer->body_s);
    free(tracer->joint_s);
    causes_finish(&tracer->causes);
    looker_finish(&tracer->looker);
    free(tracer);
}

static void *tracer_share(const Scenario *scenario)
{
    SpikeScale *scale = zeroed(1, sizeof *scale);
    *scale = spike_scale(scenario);
    return scale;
}

const RunProbe TRACER_PROBE = {tracer_begin, tracer_look, tracer_end, tracer_share, NULL};

Trajectory *tracer_run(const Scenario *scenario, const Solver *solver, RunWatch watch)
{
    return run_guarded(scenario, solver, watch, &TRACER_PROBE, NULL);
}
