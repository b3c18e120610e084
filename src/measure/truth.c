// Computes the solution that errors are measured against, its uncertainty and its horizon.
//
// Uncertainty: two more runs say what the first one's error may be. The second has a thirtieth of
// its tolerance. The third has a tenth of it, other steps therefore, and inputs rounded once more:
// where rounding rules, which no tolerance shows, these two differ from one another as much as the
// first may be off. With d the largest distances up to the horizon,
//     uncertainty = max(d(1, 2), d(1, 3)) + d(2, 3), at least rounding times growth.
// Were all three errors draws of one normal distribution, the first would be above three times that
// in one case of 200.
// Horizon: starts 1e-10 beside move away, the fastest of all of them (model/growth.c); where that
// has grown 1e5 times, two solutions that are right to 1e-10 have only five digits in common, and
// an engine's none. The same holds where the second or third run is that far away. All are watched
// on a grid of at least a thousand samples, for the case's own samples may be few.
// Sizes: errors are relative to the largest rates at the case's own samples. Where these
// miss a spike that is less than on the grid, and the uncertainty, which stands beside errors, is
// therefore taken in it; the horizon, which samples must not move, in that of the grid.
#include "measure/truth.h"
#include "base/clock.h"
#include "base/zeroed.h"
#include "contact/law.h"
#include "measure/error.h"
#include "model/distance.h"
#include "model/growth.h"
#include "model/shake.h"
#include "run/registry.h"
#include "run/run.h"
#include "run/tracer.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct TruthRuns TruthRuns;

// The runs that make a truth.
//
// first, second -> third, perturbed runs beside the second. The first is taken on the grid as well
// where the case's own samples are fewer: its steps are the same. Whoever has nothing else to do
// goes on with a perturbed run up to the samples where all of them are looked at (model/growth.c).

// tolerances of the second and third run over the first's
static const double SECOND = 1.0 / 30.0;
static const double THIRD = 1.0 / 10.0;

// Tolerance of the perturbed runs over the perturbation: growth is then wrong by some hundredths.
static const double PERTURBED_SHARE = 1e-3;

enum { THIRD_SEED = 1 }; // of its inputs' rounding

// The last is the first on the grid, of the same steps.
enum { RUN_FIRST, RUN_SECOND, RUN_THIRD, RUN_FINE, RUN_COUNT };

// The perturbed runs, from when they begin.
typedef struct Perturbed {
    bool is_begun;
    Scenario scenario;
    DistanceMeasure measure;
    PerturbBasis basis;
    GrowthRuns *runs; // owned
    double started_s; // by the clock
} Perturbed;

struct TruthRuns {
    Scenario scenarios[RUN_COUNT]; // the third owns its linkage, the others share the caller's
    Trajectory *trajectories[RUN_COUNT]; // owned, but where two are one
    bool is_fine;                        // whether the case's own samples are the grid
    size_t next;
    bool is_over[RUN_FINE];
    RunWatch watch;
    Perturbed perturbed;
};

// The scenario with another tolerance of the reference.
static Scenario with_tolerance(const Scenario *scenario, double tolerance)
{
    Scenario other = *scenario;
    other.reference.tolerance = tolerance;
    return other;
}

// The tolerance of perturbed runs: theirs is the error of the distance to the second.
static double perturbed_tolerance(const Scenario *scenario)
{
    const double first = law_reference_tolerance(scenario);
    return fmin(first, fmax(SECOND * first, PERTURBED_SHARE * DISTANCE_PERTURBATION));
}

static void truth_beat(void *context)
{
    const TruthRuns *runs = context;
    runs->watch.progress(0.0, clock_now_s() - runs->perturbed.started_s, runs->watch.context);
}

static void begin_perturbed(TruthRuns *runs)
{
    Perturbed *perturbed = &runs->perturbed;
    const Scenario *fine = &runs->scenarios[RUN_FINE];
    const Trajectory *second = runs->trajectories[RUN_SECOND];
    perturbed->is_begun = true;
    for (size_t i = 0; i < RUN_FINE; i++) {
        if (runs->is_over[i] && !runs->trajectories[i]->is_complete) {
            return;
        }
    }
    if (fine->linkage.body_count > PERTURB_BODY_MAX) {
        return;
    }
    perturbed->scenario = with_tolerance(fine, perturbed_tolerance(fine));
    perturbed->started_s = clock_now_s();
    perturbed->measure = distance_measure(second);
    PerturbUnit units[PERTURB_BODY_MAX];
    perturb_units(second, units);
    perturb_basis(&perturbed->scenario, &perturbed->measure, units, &perturbed->basis);
    perturbed->runs = growth_begin(&(GrowthWork){
        .solver = registry_solver(BACKEND_REFERENCE),
        .scenario = &perturbed->scenario,
        .beside = second,
        .measure = &perturbed->measure,
        .basis = &perturbed->basis,
        .size = DISTANCE_PERTURBATION,
        .most = DISTANCE_GROWTH,
        .until_s = INFINITY,
        .pulse = {runs->watch.progress != NULL ? truth_beat : NULL, runs},
    });
}

static SideBySideNext next_piece(size_t *index, void *context)
{
    TruthRuns *runs = context;
    if (runs->next < RUN_FINE) {
        *index = runs->next++;
        return SIDE_BY_SIDE_PIECE;
    }
    if (!runs->is_over[RUN_SECOND]) {
        return SIDE_BY_SIDE_LATER;
    }
    if (!runs->perturbed.is_begun) {
        begin_perturbed(runs);
    }
    if (runs->perturbed.runs == NULL) {
        return SIDE_BY_SIDE_NONE;
    }
    const SideBySideNext next = growth_next(index, runs->perturbed.runs);
    *index += RUN_FINE;
    return next;
}

// What looks at the first run: for its spikes, and for its motion on the grid.
typedef struct Looking {
    const Scenario *fine;
    Trajectory *grid;
    Sample sample; // owned
    size_t next;   // sample of the grid
    bool is_whole; // whether all samples up to there could be taken
    const Solver *solver;
    const void *state;
    void *spikes; // of the tracer; NULL: it has nothing to look at
} Looking;

static void *looking_begin(const Scenario *scenario, const Solver *solver, const void *state,
                           Recorder *recorder, const void *shared)
{
    // whoever shares it has it to write in
    Looking *looking = *(Looking *const *)shared;
    looking->solver = solver;
    looking->state = state;
    looking->spikes = TRACER_PROBE.begin(scenario, solver, state, recorder, NULL);
    return looking;
}

// Of parts that are stepped by themselves no instant is one of all.
static void looking_look(void *own, const StepRecord *step)
{
    Looking *looking = own;
    if (looking->spikes != NULL) {
        TRACER_PROBE.look(looking->spikes, step);
    }
    looking->is_whole = looking->is_whole && step->part == NULL;
    const double near_s = RUN_ROUNDING * (step->end_s - step->start_s);
    while (looking->is_whole && looking->next < looking->grid->sample_count) {
        Sample *sample = &looking->sample;
        sample->time_s = scenario_sample_time(looking->fine, looking->next);
        if (sample->time_s > step->end_s + near_s) {
            break;
        }
        Err unused = {ERR_NONE, ""};
        solver_glance(looking->solver, looking->state, sample->time_s, sample);
        looking->is_whole = run_check_sample(&looking->fine->linkage, NULL, sample, &unused);
        trajectory_store_motion(looking->grid, looking->next++, sample);
    }
}

static void looking_end(void *own, Trajectory *trajectory)
{
    Looking *looking = own;
    if (looking->spikes != NULL) {
        TRACER_PROBE.end(looking->spikes, trajectory);
    }
}

// Makes the first run, and on the grid as well. Another run is made for that where its steps do not
// have it.
static void make_first(TruthRuns *runs, RunWatch watch)
{
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    const Scenario *fine = &runs->scenarios[RUN_FINE];
    Looking looking = {
        .fine = fine,
        .grid = trajectory_create_motion(fine, solver->name),
        .sample = sample_create(&fine->linkage),
        .is_whole = true,
    };
    Looking *const shared = &looking;
    const RunProbe probe = {looking_begin, looking_look, looking_end, NULL, &shared};
    Trajectory *first = run_guarded(&runs->scenarios[RUN_FIRST], solver, watch, &probe, NULL);
    Trajectory *grid = looking.grid;
    runs->trajectories[RUN_FIRST] = first;
    grid->is_complete = first->is_complete && looking.next == grid->sample_count;
    if (first->is_complete && !(looking.is_whole && grid->is_complete)) {
        trajectory_destroy(grid);
        grid = run_motion(fine, solver, watch);
    } else {
        memcpy(grid->message, first->message, sizeof grid->message);
    }
    runs->trajectories[RUN_FINE] = grid;
    sample_free(&looking.sample);
}

static void make_run(TruthRuns *runs, size_t index, bool is_callers)
{
    const Scenario *scenario = &runs->scenarios[index];
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    const RunWatch watch = is_callers ? runs->watch : (RunWatch){NULL, NULL};
    if (index != RUN_FIRST) {
        // the others are there to be compared with
        runs->trajectories[index] = run_motion(scenario, solver, watch);
    } else if (runs->is_fine) {
        runs->trajectories[index] = tracer_run(scenario, solver, watch);
    } else {
        make_first(runs, watch);
    }
}

static void truth_do_piece(size_t index, bool is_callers, void *context)
{
    TruthRuns *runs = context;
    if (index < RUN_FINE) {
        make_run(runs, index, is_callers);
    } else {
        growth_walk(index - RUN_FINE, is_callers, runs->perturbed.runs);
    }
}

static void end_piece(size_t index, void *context)
{
    TruthRuns *runs = context;
    if (index < RUN_FINE) {
        runs->is_over[index] = true;
    } else {
        growth_walked(index - RUN_FINE, runs->perturbed.runs);
    }
}

// Makes all of them by at most so many threads; truth_runs_finish frees it.
//
static TruthRuns *truth_runs_make(const Scenario *scenario, RunWatch watch, size_t threads)
{
    TruthRuns *runs = calloc(1, sizeof *runs);
    assert(runs != NULL);
    const double tolerance = law_reference_tolerance(scenario);
    const Scenario fine = distance_grid(scenario);
    runs->watch = watch;
    runs->scenarios[RUN_FIRST] = *scenario;
    runs->scenarios[RUN_FINE] = fine;
    runs->scenarios[RUN_SECOND] = with_tolerance(&fine, SECOND * tolerance);
    const Scenario third = with_tolerance(&fine, THIRD * tolerance);
    runs->scenarios[RUN_THIRD] = scenario_copy(&third);
    shake_inputs(&runs->scenarios[RUN_THIRD], THIRD_SEED);
    runs->is_fine = scenario_sample_count(&fine) == scenario_sample_count(scenario);
    const SideBySideTasks tasks = {
        // most mechanisms have two starts for each joint with play
        .most = RUN_FINE + 2 * scenario->linkage.joint_count,
        .next = next_piece,
        .work = truth_do_piece,
        .end = end_piece,
        .context = runs,
    };
    side_by_side_tasks(&tasks, threads);
    if (runs->is_fine) {
        runs->trajectories[RUN_FINE] = runs->trajectories[RUN_FIRST];
    }
    return runs;
}

static const Trajectory *truth_runs_first(const TruthRuns *runs)
{
    return runs->trajectories[RUN_FIRST];
}

static const Trajectory *truth_runs_fine(const TruthRuns *runs)
{
    return runs->trajectories[RUN_FINE];
}

static const Trajectory *truth_runs_second(const TruthRuns *runs)
{
    return runs->trajectories[RUN_SECOND];
}

// The first at the case's own samples and on the fine grid, and the two that it is compared with,
// on that; none of them need be complete.
static const Trajectory *truth_runs_third(const TruthRuns *runs)
{
    return runs->trajectories[RUN_THIRD];
}

static double truth_runs_duration(const TruthRuns *runs)
{
    return scenario_duration(&runs->scenarios[RUN_FINE]);
}

// Of the perturbed runs, up to a time, s; asked once. False where there were none: of mechanisms of
// more than PERTURB_BODY_MAX bodies, or where another run is not complete.
static bool truth_runs_growth(TruthRuns *runs, double until_s, Growth *growth)
{
    if (runs->perturbed.runs == NULL) {
        return false;
    }
    *growth = growth_end(runs->perturbed.runs, until_s);
    runs->perturbed.runs = NULL;
    return true;
}

// Returns the first run, the caller's from here on, and frees all else.
static Trajectory *truth_runs_finish(TruthRuns *runs)
{
    Growth unused;
    truth_runs_growth(runs, 0.0, &unused);
    Trajectory *first = runs->trajectories[RUN_FIRST];
    for (size_t i = RUN_SECOND; i < RUN_COUNT; i++) {
        if (runs->trajectories[i] != first) {
            trajectory_destroy(runs->trajectories[i]);
        }
    }
    distance_finish(&runs->perturbed.measure);
    scenario_free(&runs->scenarios[RUN_THIRD]);
    free(runs);
    return first;
}

// 1: no speed is held to less than this share of itself
static const double ROUNDING = 0x1p-53;

static Trajectory *run(const Scenario *scenario, BackendKind backend, RunWatch watch)
{
    return run_scenario(scenario, registry_solver(backend), watch);
}

// How far two runs are apart at each sample of the grid.
typedef struct Apart {
    size_t count; // 0 where they cannot be compared
    const double *times;
    double *distance; // relative to sizes on the grid; owned, like the next
    double *stated;   // as errors are stated: relative to sizes at the case's own samples
} Apart;

// With sizes on the grid and at the case's own samples.
static Apart apart_of(const Trajectory *trajectory, const Trajectory *other,
                      const DistanceMeasure *on_grid, const DistanceMeasure *at_own)
{
    Apart apart = {.times = trajectory->times};
    apart.distance = zeroed(trajectory->sample_count + 1, sizeof *apart.distance);
    apart.stated = zeroed(trajectory->sample_count + 1, sizeof *apart.stated);
    const bool is_known = error_series(other, trajectory, on_grid, apart.distance) &&
                          error_series(other, trajectory, at_own, apart.stated);
    apart.count = is_known ? trajectory->sample_count : 0;
    return apart;
}

static void apart_finish(Apart *apart)
{
    free(apart->distance);
    free(apart->stated);
}

// Shortens the horizon to where two runs are further apart than the limit. Runs that cannot be
// compared leave none.
static void shorten_horizon(const Apart *apart, Truth *truth)
{
    const size_t count = apart->count;
    double reached = 0.0;
    size_t k = 0;
    while (k < count && apart->distance[k] <= DISTANCE_GROWTH * DISTANCE_PERTURBATION &&
           apart->times[k] <= truth->horizon_s) {
        reached = apart->times[k++];
    }
    truth->is_limited =
        truth->is_limited || count == 0 || (k < count && apart->times[k] <= truth->horizon_s);
    truth->horizon_s = fmin(truth->horizon_s, reached);
}

// The largest distance up to the horizon, as errors are stated.
static double largest_stated(const Apart *apart, const Truth *truth)
{
    double largest = 0.0;
    for (size_t k = 0; k < apart->count && apart->times[k] <= truth->horizon_s; k++) {
        // a number that is not finite is no small one
        largest = !(apart->stated[k] <= largest) ? apart->stated[k] : largest;
    }
    return largest;
}

// How many times a distance may be larger by sizes at the case's own samples than by the grid's.
static double ratio_of_sizes(const DistanceMeasure *on_grid, const DistanceMeasure *at_own)
{
    double largest = 1.0;
    for (size_t i = 0; i < at_own->count; i++) {
        largest = fmax(largest, on_grid->rates[i].scale / at_own->rates[i].scale);
    }
    return largest;
}

static void certify_ideal(const Scenario *scenario, RunWatch watch, Truth *truth)
{
    truth->trajectory = run(scenario, BACKEND_ANALYTIC, watch);
    truth->horizon_s = scenario_duration(scenario);
    Trajectory *second = run(scenario, BACKEND_REFERENCE, watch);
    const TrajectoryError error = error_against(second, truth->trajectory, truth->horizon_s);
    truth->uncertainty = error.is_known ? error.max + ROUNDING : INFINITY;
    trajectory_destroy(second);
}

// Keeps the first reason why a run is not complete.
static void truth_note_failure(const Trajectory *trajectory, Truth *truth)
{
    if (!trajectory->is_complete && truth->message[0] == '\0') {
        snprintf(truth->message, sizeof truth->message, "%s", trajectory->message);
    }
}

// Shortens the horizon to where the fastest of all perturbations has grown too much. Of large
// mechanisms the other two runs alone say how far they can be predicted.
static void take_growth(TruthRuns *runs, Truth *truth)
{
    Growth growth;
    if (!truth_runs_growth(runs, truth->horizon_s, &growth)) {
        return;
    }
    truth->growth = growth.largest;
    truth->is_limited = truth->is_limited || growth.is_limited;
    truth->horizon_s = growth.until_s;
    if (growth.is_failed) {
        snprintf(truth->message, sizeof truth->message, "%s", growth.failure.text);
    }
}

// Compares the first run on the fine grid with the second and third, and the second with perturbed
// ones.
static void truth_certify(TruthRuns *runs, Truth *truth)
{
    const Trajectory *first = truth_runs_fine(runs);
    const Trajectory *second = truth_runs_second(runs);
    const Trajectory *third = truth_runs_third(runs);
    truth_note_failure(first, truth);
    truth_note_failure(second, truth);
    truth_note_failure(third, truth);
    truth->is_limited = false;
    truth->horizon_s = truth_runs_duration(runs);
    DistanceMeasure of_first = distance_measure(first);
    DistanceMeasure of_second = distance_measure(second);
    DistanceMeasure own = distance_measure(truth_runs_first(runs));
    Apart aparts[] = {
        apart_of(second, first, &of_second, &own), apart_of(first, third, &of_first, &own),
        apart_of(second, third, &of_second, &own), // of the other two
    };
    shorten_horizon(&aparts[0], truth);
    shorten_horizon(&aparts[2], truth);
    if (truth->message[0] == '\0') {
        take_growth(runs, truth);
    }
    // now that the horizon is known
    for (int i = 0; i < 3; i++) {
        shorten_horizon(&aparts[i], truth);
    }
    const double to_others =
        fmax(largest_stated(&aparts[0], truth), largest_stated(&aparts[1], truth));
    truth->uncertainty = fmax(to_others + largest_stated(&aparts[2], truth),
                              ROUNDING * truth->growth * ratio_of_sizes(&of_first, &own));
    if (truth->message[0] != '\0') {
        truth->is_limited = true;
        truth->horizon_s = 0.0;
        truth->uncertainty = INFINITY;
    }
    for (int i = 0; i < 3; i++) {
        apart_finish(&aparts[i]);
    }
    distance_finish(&of_first);
    distance_finish(&of_second);
    distance_finish(&own);
}

BackendKind truth_backend(const Scenario *scenario)
{
    return scenario_has_closed_form(scenario) && !scenario_has_clearance(scenario)
               ? BACKEND_ANALYTIC
               : BACKEND_REFERENCE;
}

static Truth certified(const Scenario *scenario, RunWatch watch, size_t threads)
{
    Truth truth = {.growth = 1.0, .horizon_s = 0.0, .is_limited = true, .uncertainty = INFINITY};
    TruthRuns *runs = truth_runs_make(scenario, watch, threads);
    if (truth_runs_first(runs)->is_complete) {
        truth_certify(runs, &truth);
    }
    truth.trajectory = truth_runs_finish(runs);
    return truth;
}

Truth truth_make_on(const Scenario *scenario, RunWatch watch, size_t threads)
{
    Truth truth = {.growth = 1.0};
    if (truth_backend(scenario) == BACKEND_ANALYTIC) {
        certify_ideal(scenario, watch, &truth);
        return truth;
    }
    return certified(scenario, watch, threads);
}

Truth truth_make(const Scenario *scenario, RunWatch watch)
{
    return truth_make_on(scenario, watch, 1);
}

// of the other run's tolerance to the truth's
static const double OTHER = 1e1;

Scenario truth_at_other_tolerance(const Scenario *scenario)
{
    const double own = law_reference_tolerance(scenario);
    return with_tolerance(scenario, own < law_loosest_tolerance(scenario) / OTHER ? OTHER * own
                                                                                  : own / OTHER);
}

double truth_uncertainty_of(const Truth *truth, const Scenario *scenario, ToleranceOf kind,
                            double until_s, RunWatch watch)
{
    if (kind == TOLERANCE_OF_MOTION) {
        return truth->uncertainty;
    }
    const Scenario other = truth_at_other_tolerance(scenario);
    Trajectory *second = tracer_run(&other, registry_solver(BACKEND_REFERENCE), watch);
    const TrajectoryError error = error_against(second, truth->trajectory, until_s);
    const double apart = error_of_kind(&error, kind, true);
    trajectory_destroy(second);
    return error.is_known && isfinite(apart) ? apart + truth->uncertainty : INFINITY;
}

Truth truth_make_uncertified(const Scenario *scenario, RunWatch watch)
{
    Truth truth = {
        .uncertainty = INFINITY,
        .horizon_s = scenario_duration(scenario),
        .growth = 1.0,
        .is_uncertified = true,
        .message = "it was not requested",
    };
    truth.trajectory = tracer_run(scenario, registry_solver(truth_backend(scenario)), watch);
    return truth;
}

void truth_finish(Truth *truth)
{
    trajectory_destroy(truth->trajectory);
    *truth = (Truth){.trajectory = NULL};
}

// A truth as one flat piece of memory, for a pipe.
//
// Truth | Trajectory | its arrays, those in space where there are any; the pointers in the first
// two are replaced on arrival.

// The arrays of a trajectory and their sizes in bytes.
typedef struct Part {
    void *start;
    size_t size;
} Part;

enum { PART_COUNT = 12, PART_WEAR = 11 };

static void list_parts(const Trajectory *trajectory, Part parts[PART_COUNT])
{
    const size_t samples = trajectory->sample_count;
    const size_t body_count = trajectory->body_count;
    const size_t joint_count = trajectory->joint_count;
    parts[0] = (Part){trajectory->times, samples * sizeof(double)};
    parts[1] = (Part){trajectory->crank_angles, samples * sizeof(double)};
    parts[2] = (Part){trajectory->motions, samples * trajectory->body_count * sizeof(Motion)};
    parts[3] = (Part){trajectory->states, samples * trajectory->joint_count * sizeof(JointState)};
    const bool is_spatial = trajectory->space_motions != NULL;
    const size_t bodies = is_spatial ? samples * trajectory->body_count : 0;
    const size_t joints = is_spatial ? samples * trajectory->joint_count : 0;
    parts[4] = (Part){trajectory->space_motions, bodies * sizeof(SpaceMotion)};
    parts[5] = (Part){trajectory->space_states, joints * sizeof(SpaceJointState)};
    parts[6] = (Part){trajectory->reach, body_count * sizeof(double)};
    parts[7] = (Part){trajectory->bodies, body_count * sizeof(BodyExtremes)};
    parts[8] = (Part){trajectory->joints, joint_count * sizeof(JointExtremes)};
    parts[9] = (Part){trajectory->alpha_spikes, body_count * sizeof(SignalSpikes)};
    parts[10] = (Part){trajectory->force_spikes, joint_count * sizeof(SignalSpikes)};
    parts[PART_WEAR] =
        (Part){trajectory->wear, trajectory->wear != NULL ? joint_count * sizeof(JointWear) : 0};
}

size_t truth_pack_size(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    size_t a_sample = 2 * sizeof(double) + linkage->body_count * sizeof(Motion) +
                      linkage->joint_count * sizeof(JointState);
    if (linkage->is_spatial) {
        a_sample += linkage->body_count * sizeof(SpaceMotion) +
                    linkage->joint_count * sizeof(SpaceJointState);
    }
    const size_t once = linkage->body_count * (sizeof(double) + sizeof(BodyExtremes)) +
                        linkage->joint_count * (sizeof(JointExtremes) + sizeof(JointWear)) +
                        (linkage->body_count + linkage->joint_count) * sizeof(SignalSpikes);
    return sizeof(Truth) + sizeof(Trajectory) + once + scenario_sample_count(scenario) * a_sample;
}

void truth_pack_write(const Truth *truth, void *packed)
{
    char *target = packed;
    memcpy(target, truth, sizeof *truth);
    memcpy(target + sizeof *truth, truth->trajectory, sizeof *truth->trajectory);
    target += sizeof *truth + sizeof *truth->trajectory;
    Part parts[PART_COUNT];
    list_parts(truth->trajectory, parts);
    for (int i = 0; i < PART_COUNT; i++) {
        if (parts[i].size > 0) {
            memcpy(target, parts[i].start, parts[i].size);
        }
        target += parts[i].size;
    }
}

Truth truth_pack_read(const Scenario *scenario, const void *packed)
{
    const char *source = packed;
    Truth truth;
    memcpy(&truth, source, sizeof truth);
    truth.trajectory = trajectory_create(scenario, "");
    Part parts[PART_COUNT];
    list_parts(truth.trajectory, parts);
    const Linkage linkage = truth.trajectory->linkage;
    memcpy(truth.trajectory, source + sizeof truth, sizeof *truth.trajectory);
    // ranges, contacts and marks are for the pictures and series of `run`, which has its truth in
    // the same process
    truth.trajectory->ranges = (Ranges){0};
    truth.trajectory->contacts = NULL;
    truth.trajectory->contact_count = truth.trajectory->contact_room = 0;
    truth.trajectory->marked = NULL;
    truth.trajectory->marked_count = 0;
    truth.trajectory->times = parts[0].start;
    truth.trajectory->crank_angles = parts[1].start;
    truth.trajectory->motions = parts[2].start;
    truth.trajectory->states = parts[3].start;
    truth.trajectory->space_motions = parts[4].start;
    truth.trajectory->space_states = parts[5].start;
    truth.trajectory->reach = parts[6].start;
    truth.trajectory->linkage = linkage;
    truth.trajectory->bodies = parts[7].start;
    truth.trajectory->joints = parts[8].start;
    truth.trajectory->alpha_spikes = parts[9].start;
    truth.trajectory->force_spikes = parts[10].start;
    if (truth.trajectory->wear != NULL) {
        parts[PART_WEAR].size = linkage.joint_count * sizeof(JointWear);
        parts[PART_WEAR].start = zeroed(linkage.joint_count, sizeof(JointWear));
        truth.trajectory->wear = parts[PART_WEAR].start;
    }
    source += sizeof truth + sizeof *truth.trajectory;
    for (int i = 0; i < PART_COUNT; i++) {
        if (parts[i].size > 0) {
            memcpy(parts[i].start, source, parts[i].size);
        }
        source += parts[i].size;
    }
    return truth;
}
