// How do mechanisms that share nothing but the ground move side by side?
//
// Each by itself (model/several.h): an event of one ends no step of another.
#include "reference/mechanisms.h"

#include "model/several.h"

// of a step
static const double ROUNDING = 1e-9;

static bool open_each(const Scenario *scenario, void **state, Err *err)
{
    return several_open(scenario, &REFERENCE_ONE, ROUNDING, state, err);
}

static SolverModel model_of_all(const void *state)
{
    SolverModel model = several_model(state);
    size_t coordinates = 0;
    for (size_t i = 0; i < several_count(state); i++) {
        coordinates += reference_coordinates(several_state(state, i));
    }
    reference_label(several_scenario(state), coordinates, model.label);
    return model;
}

const Solver REFERENCE_SEVERAL = {
    .name = "reference",
    .open = open_each,
    .step = several_step,
    .stride = several_stride,
    .record = several_record,
    .observe = several_observe,
    .observe_part = several_observe_part,
    .glance = several_glance,
    .model = model_of_all,
    .close = several_close,
};
