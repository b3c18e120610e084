// How do mechanisms that share nothing but the ground move side by side, contacts integrated within
// the step?
//
// Each by itself (model/several.h), in a world of its own: a contact of one shortens no step of
// another, and nothing is solved for all of them together. Memory is read into the cache once for
// all steps up to the time that is asked for: a thousand mechanisms do not fit into it.
#include "ode/impulse_parts.h"

#include "ode/stepping.h"

bool impulse_parts_open(const Scenario *scenario, const Solver *solver,
                        dWorldID (*world)(const void *state), void **state, Err *err)
{
    if (!several_open(scenario, solver, STEPPING_ROUNDING, state, err)) {
        return false;
    }
    // they are stepped one after the other: one working memory will do
    for (size_t i = 1; i < several_count(*state); i++) {
        const dWorldID own = world(several_state(*state, i));
        dWorldUseSharedWorkingMemory(own, NULL); // its own, yet empty
        dWorldUseSharedWorkingMemory(own, world(several_state(*state, 0)));
    }
    return true;
}

static bool open_plane(const Scenario *scenario, void **state, Err *err)
{
    return impulse_parts_open(scenario, &STEPPING_IMPULSE, impulse_world, state, err);
}

const Solver STEPPING_IMPULSE_PARTS = {
    .name = "impulse",
    .open = open_plane,
    .step = several_step,
    .record = several_record,
    .observe = several_observe,
    .observe_part = several_observe_part,
    .contacts = several_contacts,
    .model = several_model,
    .close = several_close,
};
