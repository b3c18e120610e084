// What do mechanisms side by side do at the samples, one mechanism after the other?
//
// All of a sample at once would fetch each mechanism into the cache once more; a thousand do not
// fit into it.
#include "run/part_samples.h"

#include "base/zeroed.h"
#include "run/sample_check.h"

PartSamples part_samples_start(Recorder *recorder, const Turning *turning, const Solver *solver,
                               const void *state)
{
    const Linkage *linkage = &recorder->scenario->linkage;
    return (PartSamples){
        .scenario = recorder->scenario,
        .solver = solver,
        .state = state,
        .recorder = recorder,
        .turning = turning,
        .trajectory = recorder->trajectory,
        .sample = sample_create(linkage),
        .parts = zeroed(linkage->body_count, sizeof(const SolverPart *)),
        .next = zeroed(linkage->body_count, sizeof(size_t)),
    };
}

void part_samples_finish(PartSamples *samples)
{
    sample_free(&samples->sample);
    free(samples->parts);
    free(samples->next);
}

static void store(const PartSamples *samples, size_t number, const SolverPart *part)
{
    Trajectory *trajectory = samples->trajectory;
    const Sample *sample = &samples->sample;
    const size_t bodies = number * trajectory->body_count;
    const size_t joints = number * trajectory->joint_count;
    trajectory->times[number] = sample->time_s;
    trajectory->crank_angles[number] = sample->crank_rad;
    for (size_t k = 0; k < part->body_count; k++) {
        const size_t i = (size_t)part->bodies[k];
        trajectory->motions[bodies + i] = sample->bodies[i];
        if (trajectory->space_motions != NULL) {
            trajectory->space_motions[bodies + i] = sample->space_bodies[i];
        }
    }
    for (size_t k = 0; k < part->joint_count; k++) {
        const size_t i = (size_t)part->joints[k];
        trajectory->states[joints + i] = sample->joints[i];
        if (trajectory->space_motions != NULL) {
            trajectory->space_states[joints + i] = sample->space_joints[i];
        }
    }
}

// Takes the next sample of a part, which has been observed.
static bool take(PartSamples *samples, const SolverPart *part, Err *err)
{
    Sample *sample = &samples->sample;
    if (!run_check_sample(&samples->scenario->linkage, part, sample, err)) {
        return false;
    }
    turning_unwrap(samples->turning, part, sample);
    recorder_see(samples->recorder, part, sample);
    store(samples, samples->next[part->number]++, part);
    return true;
}

bool part_samples_take(PartSamples *samples, const StepRecord *record, Err *err)
{
    const SolverPart *part = record->part;
    const double near_s = RUN_ROUNDING * (record->end_s - record->start_s);
    const size_t count = samples->trajectory->sample_count;
    samples->parts[part->number] = part;
    samples->part_count =
        part->number >= samples->part_count ? part->number + 1 : samples->part_count;
    for (;;) {
        const size_t next = samples->next[part->number];
        if (next == count ||
            scenario_sample_time(samples->scenario, next) > record->end_s + near_s) {
            return true;
        }
        samples->solver->observe_part(samples->state, scenario_sample_time(samples->scenario, next),
                                      &samples->sample);
        if (!take(samples, part, err)) {
            return false;
        }
    }
}

bool part_samples_complete(PartSamples *samples, size_t behind, Err *err)
{
    for (size_t i = 0; i < samples->part_count; i++) {
        while (samples->parts[i] != NULL && samples->next[i] < behind) {
            samples->solver->observe(samples->state,
                                     scenario_sample_time(samples->scenario, samples->next[i]),
                                     &samples->sample);
            if (!take(samples, samples->parts[i], err)) {
                return false;
            }
        }
    }
    return true;
}
