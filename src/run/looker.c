// Asks a solver for its states inside its last step, and keeps them until the step is done.
#include "run/looker.h"
#include "base/room.h"
#include "base/zeroed.h"

#include <assert.h>
#include <stdlib.h>

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

Look look_room(Looker *looker, double time_s)
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
    return look_room(looker, 0.0);
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
    const Look look = look_room(looker, time_s);
    const Sample *sample = &looker->sample;
    solver_look(looker->solver, looker->state, time_s, part, looker->some, &looker->sample);
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
    const Look look = look_room(looker, step->end_s);
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

LookPeak *looker_peaks(const Looker *looker, RecorderSignal which, size_t number)
{
    return which == RECORDER_FORCE ? looker->force_peaks[number] : looker->alpha_peaks[number];
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
                add_peaks(looker_peaks(looker, signal, number), from_s, look->time_s, path, points);
        }
        path[points++] =
            (LookPoint){look->time_s, is_force ? look->force[number] : look->alpha[number],
                        is_force ? 0.0 : look->omega[number]};
    }
    return points;
}
