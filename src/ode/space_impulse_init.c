// What does a step in space with contacts integrated inside it need, and of which size?
#include "base/zeroed.h"
#include "ode/space_impulse_step.h"

void space_impulse_step_finish(SpaceImpulseStep *step)
{
    kernel_islands_destroy(step->islands);
    response_groups_finish(&step->groups);
    impulse_scope_finish(&step->whole);
    kernel_finish(&step->kernel);
    space_response_finish(step->response);
    space_response_finish(step->there);
    space_hold_free(step->hold);
    free(step->response);
    free(step->there);
    kernel_sums_free(&step->total);
    world_finish(&step->world);
    void *const arrays[] = {step->places,     step->stops,     step->angles,     step->rows,
                            step->before,     step->after,     step->free,       step->free_rate,
                            step->rest,       step->gyration,  step->middle,     step->closing,
                            step->mean,       step->motions,   step->changes[0], step->changes[1],
                            step->changes[2], step->play_rows, step->play[0],    step->play[1],
                            step->ideal[0],   step->ideal[1],  step->forces};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
}

static bool init_kernel(SpaceImpulseStep *step, Err *err)
{
    const Scenario *scenario = step->scenario;
    step->kernel = kernel_start(scenario->ode.contact_phase);
    step->places = pin_space_list(scenario, &step->place_count, err);
    if (step->places == NULL) {
        return false;
    }
    size_t stop_count;
    step->pin_count = step->place_count;
    step->stops = stop_space_list(scenario, &stop_count, err);
    if (step->stops == NULL) {
        return false;
    }
    step->place_count += stop_count;
    for (size_t i = 0; i < step->pin_count; i++) {
        const PinSpace *place = &step->places[i];
        const size_t rows = pin_space_row_count(place);
        const Joint *joint = &scenario->linkage.joints[place->joint];
        const KernelContact added = {
            .law = place->law,
            .radial_clearance = place->clearance,
            .hole_radius = joint->clearance.hole_radius,
            .joint = place->joint,
            .state = joint->contacts[place->place],
            .siblings = {place->place == 1 ? -1 : 0, place->place == 0 ? 1 : 0},
        };
        kernel_add(&step->kernel, &added, rows);
    }
    for (size_t i = 0; i < stop_count; i++) {
        const StopSpace *stop = &step->stops[i];
        const Joint *joint = &scenario->linkage.joints[stop->joint];
        const KernelContact added = {.law = stop->law,
                                     .shape = KERNEL_LINE,
                                     .joint = stop->joint,
                                     .state = joint->contacts[stop_space_place(stop)]};
        kernel_add(&step->kernel, &added, PIN_SPACE_PLAIN_ROWS);
    }
    step->total = kernel_sums(kernel_rows(&step->kernel));
    return true;
}

// Makes room for the mobilities that are not always zero, or for islands.
static void make_room(SpaceImpulseStep *step)
{
    if (step->place_count > IMPULSE_FEW_PLACES) {
        const KernelCoupling coupling = space_impulse_step_coupling(step->response);
        kernel_make_rows(&step->kernel);
        step->islands = kernel_islands_create(&step->kernel, &coupling);
        space_response_groups_init(step->response, &step->groups);
        return;
    }
    size_t *places = zeroed(step->place_count, sizeof *places);
    for (size_t i = 0; i < step->place_count; i++) {
        places[i] = i;
    }
    const KernelCoupling coupling = space_impulse_step_coupling(step->response);
    kernel_make_room(&step->kernel, kernel_coupling_reach(&coupling, &step->kernel, places));
    free(places);
}

static void make_arrays(SpaceImpulseStep *step)
{
    const size_t bodies = step->scenario->linkage.body_count;
    const size_t joints = step->scenario->linkage.joint_count;
    const size_t rows = kernel_rows(&step->kernel);
    const size_t ideal = SPACE_JOINT_ROWS * joints;
    step->response = zeroed(1, sizeof *step->response);
    step->there = zeroed(1, sizeof *step->there);
    step->rows = zeroed(step->place_count, sizeof *step->rows);
    step->angles = zeroed(joints, sizeof *step->angles);
    for (size_t i = step->pin_count; i < step->place_count; i++) {
        const int joint = space_impulse_step_joint(step, i);
        step->angles[joint] = space_coordinate_start(&step->scenario->linkage, joint);
    }
    step->before = zeroed(bodies, sizeof *step->before);
    step->after = zeroed(bodies, sizeof *step->after);
    step->free = zeroed(bodies, sizeof *step->free);
    step->free_rate = zeroed(bodies, sizeof *step->free_rate);
    step->rest = zeroed(bodies, sizeof *step->rest);
    step->gyration = zeroed(bodies, sizeof *step->gyration);
    step->middle = zeroed(bodies, sizeof *step->middle);
    step->closing = zeroed(ideal, sizeof *step->closing);
    step->mean = zeroed(joints, sizeof *step->mean);
    step->motions = zeroed(bodies, sizeof *step->motions);
    for (size_t i = 0; i < SPACE_IMPULSE_ROOMS; i++) {
        step->changes[i] = zeroed(bodies, sizeof *step->changes[i]);
    }
    step->play_rows = zeroed(rows, sizeof *step->play_rows);
    for (size_t i = 0; i < 2; i++) {
        step->play[i] = zeroed(rows, sizeof *step->play[i]);
        step->ideal[i] = zeroed(ideal, sizeof *step->ideal[i]);
    }
    step->forces = zeroed(joints, sizeof *step->forces);
}

// Builds the world, and two responses of the linkage with all places.
static bool build(SpaceImpulseStep *step, Err *err)
{
    const Scenario *scenario = step->scenario;
    const size_t count = step->place_count;
    SpaceResponsePlace *places = zeroed(count, sizeof *places);
    for (size_t i = 0; i < count; i++) {
        places[i] = (SpaceResponsePlace){space_impulse_step_joint(step, i),
                                         step->kernel.contacts[i].row_count};
    }
    const bool is_built =
        space_world_build(scenario, step->after, places, count, &step->world, step->response,
                          &step->hold, err) &&
        space_response_init(&scenario->linkage, step->after, places, count, step->there, err);
    free(places);
    return is_built;
}

bool space_impulse_step_init(const Scenario *scenario, SpaceImpulseStep *step, Err *err)
{
    step->scenario = scenario;
    step->driven = linkage_driven_body(&scenario->linkage);
    step->tick_s = scenario->run.step / (double)scenario->ode.gear;
    if (!init_kernel(step, err)) {
        return false;
    }
    make_arrays(step);
    space_start(&scenario->linkage, step->after);
    if (!build(step, err)) {
        return false;
    }
    make_room(step);
    step->whole = impulse_scope_whole(&scenario->linkage, step->place_count);
    return true;
}
