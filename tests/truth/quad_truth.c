// Where are the bodies of a mechanism with play, to more digits than a double can hold?
//
// Steps of Gauss collocation (quad_step.h), each within the tolerance, each ending at the first
// event in it (quad_event.h). The first step after an onset is laid over the root of the time
// since, the last before an end of contact over the root of the time to it. After each step the
// bodies are moved onto the ideal joints, and no contact changes its mode but at an event.
#include "quad_truth.h"

#include "quad_event.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

// s: rounding of the time would be seen in a shorter step
static const double SHORTEST = 1e-26;
// s: about a hundredth of a steel contact
static const double FIRST_STEP = 1e-7;
// m: pins as near as this meet their walls at the same moment
static const double SAME_MOMENT = 1e-28;
// of a step: an event as near its end as this is the one it was made to end on
static const double AT_END = 1e-9;

typedef struct Truth {
    const QuadProblem *problem;
    QuadStep step;
    // where the next step begins
    Quad time_s;
    QuadCoordinates position;
    QuadCoordinates velocity;
    QuadContacts contacts;
    QuadMap map;
    Quad suggested_s[QUAD_MAP_COUNT]; // length of the next step
    TruthFigures figures;
} Truth;

TruthOptions truth_options_default(void)
{
    return (TruthOptions){.tolerance = 1e-18, .steps_max = 1000000};
}

static QuadGap gap_now(const Truth *truth, size_t joint)
{
    return quad_problem_gap(truth->problem, joint, truth->position, truth->velocity);
}

static void load_step(Truth *truth)
{
    QuadStep *step = &truth->step;
    step->start_s = truth->time_s;
    step->contacts = truth->contacts;
    memcpy(step->start_position, truth->position, sizeof step->start_position);
    memcpy(step->start_velocity, truth->velocity, sizeof step->start_velocity);
}

static void accept_step(Truth *truth)
{
    const QuadStep *step = &truth->step;
    TruthFigures *figures = &truth->figures;
    for (size_t k = 0; k < truth->problem->joint_count; k++) {
        for (int i = 0; truth->contacts.mode[k] != QUAD_FREE && i < QUAD_GAUSS_NODES; i++) {
            const QuadGap gap =
                quad_problem_gap(truth->problem, k, step->position[i], step->velocity[i]);
            figures->depth_max = fmax(figures->depth_max, (double)gap.penetration);
        }
    }
    truth->time_s = step->start_s + step->length_s;
    memcpy(truth->position, step->end_position, sizeof truth->position);
    memcpy(truth->velocity, step->end_velocity, sizeof truth->velocity);
    const Quad drift = quad_problem_project(truth->problem, truth->position, truth->velocity);
    figures->drift_max = fmax(figures->drift_max, (double)drift);
    figures->steps++;
    truth->map = QUAD_MAP_PLAIN;
}

static void begin_contact(Truth *truth, size_t joint)
{
    const QuadProblem *problem = truth->problem;
    const QuadGap gap = gap_now(truth, joint);
    truth->contacts.mode[joint] = QUAD_PRESSED;
    truth->contacts.speed[joint] =
        fmaxq(problem->impact_speed_share * gap.rate, problem->impact_speed_floor);
    truth->map = QUAD_MAP_ONSET;
    truth->figures.onsets++;
    truth->figures.onset_s = truth->time_s;
    truth->figures.onset_speed = gap.rate;
}

static void begin_contacts(Truth *truth, size_t joint)
{
    begin_contact(truth, joint);
    for (size_t k = 0; k < truth->problem->joint_count; k++) {
        if (truth->problem->joints[k].has_play && truth->contacts.mode[k] == QUAD_FREE) {
            const QuadGap gap = gap_now(truth, k);
            if (fabsq(gap.penetration) < SAME_MOMENT && gap.rate > 0) {
                begin_contact(truth, k);
            }
        }
    }
}

static void end_contact(Truth *truth, size_t joint)
{
    truth->contacts.mode[joint] = QUAD_FREE;
    truth->figures.ends++;
    truth->figures.end_s = truth->time_s;
    truth->figures.end_speed = -gap_now(truth, joint).rate;
}

static void end_contacts(Truth *truth, size_t joint)
{
    end_contact(truth, joint);
    for (size_t k = 0; k < truth->problem->joint_count; k++) {
        if (truth->problem->joints[k].has_play && truth->contacts.mode[k] != QUAD_FREE) {
            const QuadGap gap = gap_now(truth, k);
            if (fabsq(gap.penetration) < SAME_MOMENT && gap.rate < 0) {
                end_contact(truth, k);
            }
        }
    }
}

static void pass_event(Truth *truth, const QuadEvent *event)
{
    switch (event->kind) {
    case QUAD_EVENT_ONSET:
        begin_contacts(truth, event->joint);
        break;
    case QUAD_EVENT_END:
        end_contacts(truth, event->joint);
        break;
    case QUAD_EVENT_CLAMP:
        truth->contacts.mode[event->joint] = QUAD_CLAMPED;
        truth->figures.clamps++;
        break;
    default:
        truth->contacts.mode[event->joint] = QUAD_PRESSED;
        break;
    }
}

static bool is_accurate(const Truth *truth)
{
    return truth->step.tail <= truth->step.tolerance;
}

// By what the length should change to meet the tolerance: the tail falls as length^N.
static Quad growth(const Truth *truth)
{
    const double ratio = (double)(truth->step.tolerance / fmaxq(truth->step.tail, 1e-40));
    return fmin(fmax(0.85 * pow(ratio, 1.0 / (QUAD_GAUSS_NODES - 2)), 0.2), 3.0);
}

// Tries to make the step onto an event: accurate, and with no other event before its end.
static bool step_onto(Truth *truth, QuadMap map, Quad length, const QuadEvent *event)
{
    if (!quad_event_meet(&truth->step, map, length, event) || !is_accurate(truth)) {
        return false;
    }
    const QuadEvent other = quad_event_first(&truth->step);
    return other.kind == QUAD_EVENT_NONE || other.x > 1 - (Quad)AT_END;
}

// Takes one step, at most to stop_s; it then stands in truth->step.
static bool advance(Truth *truth, Quad stop_s)
{
    const QuadMap map = truth->map;
    QuadStep *step = &truth->step;
    load_step(truth);
    Quad length = fminq(truth->suggested_s[map], stop_s - truth->time_s);
    bool is_cut = length < truth->suggested_s[map]; // by something else than its accuracy
    while (length > SHORTEST) {
        if (!quad_step_solve(step, map, length)) {
            length /= 2;
            is_cut = false;
            continue;
        }
        const QuadEvent event = quad_event_first(step);
        // beyond an end of contact the solution is not smooth and its accuracy tells nothing
        const bool is_end =
            event.kind == QUAD_EVENT_END && truth->contacts.mode[event.joint] == QUAD_PRESSED;
        if (!is_end && !is_accurate(truth)) {
            length *= fminq(growth(truth), 0.9);
            is_cut = false;
            continue;
        }
        if (event.kind == QUAD_EVENT_NONE) {
            const Quad wanted = length * growth(truth);
            truth->suggested_s[map] = is_cut ? fmaxq(truth->suggested_s[map], wanted) : wanted;
            if (map == QUAD_MAP_ONSET) {
                truth->suggested_s[QUAD_MAP_PLAIN] = length / 2;
            }
            accept_step(truth);
            return true;
        }
        is_cut = true;
        if (event.x <= 0) {
            length /= 16;
            continue;
        }
        const Quad to_event = quad_step_time(step, event.x) - step->start_s;
        const QuadMap onto = is_end ? QUAD_MAP_END : map;
        const bool is_reachable = !is_end || map == QUAD_MAP_PLAIN;
        if (is_reachable && step_onto(truth, onto, to_event, &event)) {
            accept_step(truth);
            pass_event(truth, &event);
            return true;
        }
        // come nearer first
        length = fminq(to_event / 2, length * 0.9);
    }
    return false;
}

static void write_sample(const Truth *truth, double time, TruthSample *samples)
{
    QuadCoordinates q;
    QuadCoordinates v;
    memcpy(q, truth->position, sizeof q);
    memcpy(v, truth->velocity, sizeof v);
    if (time < truth->time_s) {
        quad_step_state(&truth->step, quad_step_place(&truth->step, time), q, v);
    }
    for (size_t i = 0; i < truth->problem->body_count; i++) {
        samples[i] = (TruthSample){
            .x = q[3 * i],
            .y = q[3 * i + 1],
            .angle = q[3 * i + 2],
            .x_rate = v[3 * i],
            .y_rate = v[3 * i + 1],
            .omega = v[3 * i + 2],
        };
    }
}

static Truth *truth_create(const QuadProblem *problem, const TruthOptions *options)
{
    Truth *truth = calloc(1, sizeof *truth);
    assert(truth != NULL);
    truth->problem = problem;
    quad_step_init(&truth->step, problem, options->tolerance);
    memcpy(truth->position, problem->start_position, sizeof truth->position);
    memcpy(truth->velocity, problem->start_velocity, sizeof truth->velocity);
    for (int map = 0; map < QUAD_MAP_COUNT; map++) {
        truth->suggested_s[map] = FIRST_STEP;
    }
    for (size_t k = 0; k < problem->joint_count; k++) {
        if (problem->joints[k].has_play && gap_now(truth, k).penetration > 0) {
            begin_contact(truth, k);
        }
    }
    truth->map = QUAD_MAP_PLAIN;
    return truth;
}

bool truth_run(const QuadProblem *problem, const TruthOptions *options, size_t count,
               const double *times, TruthSample *samples, TruthFigures *figures)
{
    Truth *truth = truth_create(problem, options);
    const clock_t started = clock();
    bool is_complete = true;
    for (size_t k = 0; is_complete && k < count; k++) {
        while (is_complete && truth->time_s < times[k]) {
            const double spent_s = (double)(clock() - started) / CLOCKS_PER_SEC;
            is_complete = truth->figures.steps < options->steps_max &&
                          !(options->seconds_max > 0.0 && spent_s > options->seconds_max) &&
                          advance(truth, times[count - 1]);
        }
        if (is_complete) {
            write_sample(truth, times[k], samples + k * problem->body_count);
            truth->figures.samples = k + 1;
            truth->figures.reached_s = times[k];
        }
    }
    truth->figures.solves = truth->step.solves;
    truth->figures.evaluations = truth->step.evaluations;
    truth->figures.energy =
        quad_problem_energy(problem, &truth->contacts, truth->position, truth->velocity);
    if (figures != NULL) {
        *figures = truth->figures;
    }
    free(truth);
    return is_complete;
}
