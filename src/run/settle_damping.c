// Finds how the largest forces of a settled motion move when its damping is halved and doubled.
//
// Both turn from the settled motion on. Their forces are shown to four digits: the reference needs
// no tolerance and the motion no repetition beyond these. A motion that does not repeat is said by
// the median of its later revolutions, which half of the most has to a few hundredths of its
// spread.
#include "base/zeroed.h"
#include "contact/law.h"
#include "run/settle_parts.h"

#include <math.h>
#include <stdlib.h>

enum { SCALE_COUNT = 2 };

static const double SCALES[SCALE_COUNT] = {0.5, 2.0};

// 1: what may still be to come of forces that are shown to four digits, which are then right to
// half of the last
static const double DAMPED_TOLERANCE = 1e-5;

// Of the reference: on the shipped cases forces at it are off by up to 2e-5.
static const double DAMPED_REFERENCE = 1e-9;

// Revolutions: a change that shrinks to 0.7 of itself in one comes to 1e-5.
static const size_t DAMPED_MOST = 32;

struct DampingRuns {
    Settling settlings[SCALE_COUNT];
    bool are_settled[SCALE_COUNT];
    double tolerance; // 1
    size_t next;
};

DampingRuns *damping_runs_begin(const Scenario *scenario, TurnWatch *watch)
{
    if (scenario->settled.motion_count == 0 || !law_has_damping(scenario)) {
        return NULL;
    }
    DampingRuns *runs = zeroed(1, sizeof *runs);
    // a motion that repeats to fewer digits does so with other damping, too
    const SettledMotion *motion = &scenario->settled.motions[0];
    runs->tolerance =
        motion->period > 0 ? fmax(DAMPED_TOLERANCE, motion->change) : DAMPED_TOLERANCE;
    for (size_t i = 0; i < SCALE_COUNT; i++) {
        Settling *settling = &runs->settlings[i];
        *settling = settling_start(scenario);
        ReferenceOptions *reference = &settling->scenario.reference;
        reference->tolerance = fmax(reference->tolerance, DAMPED_REFERENCE);
        settling->scenario.contact.damping_scale *= SCALES[i];
        settling->is_quick = true;
        settling->watch = watch;
    }
    watch->most += SCALE_COUNT * DAMPED_MOST;
    return runs;
}

static SideBySideNext damping_runs_next(size_t *index, void *context)
{
    DampingRuns *runs = context;
    *index = runs->next;
    if (runs->next == SCALE_COUNT) {
        return SIDE_BY_SIDE_NONE;
    }
    runs->next++;
    return SIDE_BY_SIDE_PIECE;
}

static void damping_runs_work(size_t index, bool is_callers, void *context)
{
    DampingRuns *runs = context;
    Settling *settling = &runs->settlings[index];
    const size_t allowed = settling->scenario.run.settle_most;
    const size_t most = allowed < DAMPED_MOST ? allowed : DAMPED_MOST;
    Err unused = {ERR_NONE, ""};
    settling->is_callers = is_callers;
    runs->are_settled[index] = settling_run(settling, runs->tolerance, most, &unused);
}

SideBySideTasks damping_runs_tasks(DampingRuns *runs)
{
    return (SideBySideTasks){
        .most = SCALE_COUNT,
        .next = damping_runs_next,
        .work = damping_runs_work,
        .context = runs,
    };
}

void damping_runs_end(DampingRuns *runs, Scenario *scenario)
{
    SettledStart *settled = &scenario->settled;
    SettledMotion *const found[SCALE_COUNT] = {&settled->halved, &settled->doubled};
    for (size_t i = 0; i < SCALE_COUNT; i++) {
        if (runs->are_settled[i]) {
            const Settling *settling = &runs->settlings[i];
            settled_motion_free(found[i]);
            *found[i] = settle_motion_of(&settling, 1, 1);
        }
        settling_finish(&runs->settlings[i]);
    }
    free(runs);
}
