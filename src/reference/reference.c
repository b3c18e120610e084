// How does the linkage with play really move? (A solver.)
//
// Hands on to the solver of one mechanism, or to that of several side by side.
#include "base/zeroed.h"
#include "model/members.h"
#include "reference/mechanisms.h"

#include <stdio.h>

typedef struct Reference {
    const Solver *solver;
    void *state; // of it
} Reference;

void reference_label(const Scenario *scenario, size_t coordinates,
                     char label[TRAJECTORY_LABEL_SIZE])
{
    snprintf(label, TRAJECTORY_LABEL_SIZE, "order 8, tolerance %.3g, %zu coordinate%s",
             scenario->reference.tolerance, coordinates, coordinates == 1 ? "" : "s");
}

static bool reference_open(const Scenario *scenario, void **state, Err *err)
{
    Reference *reference = zeroed(1, sizeof *reference);
    const Linkage *linkage = &scenario->linkage;
    const bool is_several = linkage->body_count > 0 && members_count(linkage) > 1;
    reference->solver = is_several ? &REFERENCE_SEVERAL : &REFERENCE_ONE;
    if (!reference->solver->open(scenario, &reference->state, err)) {
        free(reference);
        return false;
    }
    *state = reference;
    return true;
}

static bool reference_step(void *state, double stop_s, Err *err)
{
    Reference *reference = state;
    return reference->solver->step(reference->state, stop_s, err);
}

static bool reference_stride(void *state, double stop_s, double *end_s, Err *err)
{
    Reference *reference = state;
    return reference->solver->stride(reference->state, stop_s, end_s, err);
}

static StepRecord reference_record(const void *state)
{
    const Reference *reference = state;
    return reference->solver->record(reference->state);
}

static void reference_observe(const void *state, double time_s, Sample *sample)
{
    const Reference *reference = state;
    reference->solver->observe(reference->state, time_s, sample);
}

static void reference_observe_part(const void *state, double time_s, Sample *sample)
{
    const Reference *reference = state;
    reference->solver->observe_part(reference->state, time_s, sample);
}

static void reference_glance(const void *state, double time_s, Sample *sample)
{
    const Reference *reference = state;
    reference->solver->glance(reference->state, time_s, sample);
}

static SolverModel reference_model(const void *state)
{
    const Reference *reference = state;
    return reference->solver->model(reference->state);
}

static void reference_close(void *state)
{
    Reference *reference = state;
    if (reference != NULL) {
        reference->solver->close(reference->state);
        free(reference);
    }
}

const Solver REFERENCE_SOLVER = {
    .name = "reference",
    .open = reference_open,
    .step = reference_step,
    .stride = reference_stride,
    .record = reference_record,
    .observe = reference_observe,
    .observe_part = reference_observe_part,
    .glance = reference_glance,
    .model = reference_model,
    .close = reference_close,
};
