// What does a step with contacts integrated inside it need, and of which size?
#include "ode/impulse_step.h"

#include "base/zeroed.h"
#include "contact/law.h"

#include <stdlib.h>

static void make_arrays(ImpulseStep *step)
{
    const size_t bodies = step->scenario->linkage.body_count;
    const size_t joints = step->scenario->linkage.joint_count;
    ImpulseWork *work = step->work = zeroed(1, sizeof *step->work);
    touch_response(&step->scenario->linkage, step->places, step->place_count,
                   law_has_friction(step->scenario), &work->there);
    step->before = zeroed(bodies, sizeof *step->before);
    step->middle = zeroed(bodies, sizeof *step->middle);
    step->after = zeroed(bodies, sizeof *step->after);
    step->free = zeroed(3 * bodies, sizeof *step->free);
    step->free_rate = zeroed(3 * bodies, sizeof *step->free_rate);
    step->ahead = zeroed(3 * bodies, sizeof *step->ahead);
    step->rest = zeroed(3 * bodies, sizeof *step->rest);
    step->closing = zeroed(step->response.ideal_rows, sizeof *step->closing);
    step->mean = zeroed(joints, sizeof *step->mean);
    for (size_t i = 0; i < joints; i++) {
        const Joint *joint = &step->scenario->linkage.joints[i];
        step->mean[i].is_touching = !linkage_has_play(joint);
        step->has_coordinates = step->has_coordinates || joint->kind == JOINT_PRISMATIC ||
                                joint->limits.kind != LIMIT_NONE;
    }
    work->motions = zeroed(bodies, sizeof *work->motions);
    work->loads = zeroed(bodies, sizeof *work->loads);
    work->offsets = zeroed(joints, sizeof *work->offsets);
    work->joints = zeroed(joints, sizeof *work->joints);
    const size_t rows = kernel_rows(&step->kernel);
    step->pressing = zeroed(rows, sizeof *step->pressing);
    step->has_few_rows =
        step->islands == NULL && rows <= IMPULSE_FEW_ROWS && !step->scenario->ode.is_frozen;
    if (step->has_few_rows) {
        kernel_make_drift(&step->kernel);
        step->drift = response_drift_create(&step->response);
        step->columns[0] = step->drift.columns;
        step->curves = impulse_curves_create(step->place_count, rows, bodies, step->driven);
    }
    for (size_t i = 1; step->has_few_rows && i < IMPULSE_COLUMNS; i++) {
        step->columns[i] = zeroed(3 * bodies * rows, sizeof *step->columns[i]);
    }
    for (size_t i = 0; i < 2; i++) {
        step->moved[i] = zeroed(3 * bodies, sizeof *step->moved[i]);
        work->rows[i] = zeroed(step->response.row_count, sizeof *work->rows[i]);
        work->changes[i] = zeroed(3 * bodies, sizeof *work->changes[i]);
    }
}

static void free_arrays(ImpulseStep *step)
{
    ImpulseWork *work = step->work;
    free(step->before);
    free(step->middle);
    free(step->after);
    free(step->free);
    free(step->free_rate);
    free(step->ahead);
    free(step->rest);
    free(step->closing);
    for (size_t i = 1; i < IMPULSE_COLUMNS; i++) {
        free(step->columns[i]); // the first one is the drift's
    }
    response_drift_finish(&step->drift);
    free(step->moved[0]);
    free(step->moved[1]);
    free(step->mean);
    free(step->pressing);
    impulse_curves_finish(&step->curves);
    for (size_t i = 0; work != NULL && i < 2; i++) {
        free(work->rows[i]);
        free(work->changes[i]);
    }
    if (work != NULL) {
        response_finish(&work->there);
        free(work->motions);
        free(work->loads);
        free(work->offsets);
        free(work->joints);
    }
    free(work);
}

void impulse_step_finish(ImpulseStep *step)
{
    kernel_islands_destroy(step->islands);
    response_groups_finish(&step->groups);
    impulse_scope_finish(&step->whole);
    kernel_finish(&step->kernel);
    kernel_sums_free(&step->total);
    response_finish(&step->response);
    world_finish(&step->world);
    free_arrays(step);
    free(step->places);
}

// Of what is a coordinate by itself the rows are those of a line.
static KernelShape kernel_shape_of(TouchShape shape)
{
    switch (shape) {
    case TOUCH_HOLE:
        return KERNEL_HOLE;
    case TOUCH_DISC:
        return KERNEL_DISC;
    case TOUCH_LINE:
    case TOUCH_TURN:
    case TOUCH_TEETH:
        break;
    }
    return KERNEL_LINE;
}

// What a kernel is given of a place.
static KernelContact joint_of(const ImpulseStep *step, const Touch *place)
{
    // a disc outside is a hole of negative size
    const KernelShape shape = kernel_shape_of(place->shape);
    const double sign = shape == KERNEL_DISC ? -1.0 : 1.0;
    const bool is_line = shape == KERNEL_LINE;
    const bool has_corners = step->scenario->linkage.joints[place->joint].kind == JOINT_GUIDE;
    return (KernelContact){
        .law = place->law,
        .shape = shape,
        .radial_clearance = is_line ? 0.0 : sign * place->clearance,
        .hole_radius = is_line ? 0.0 : sign * place->radius_a,
        .joint = place->joint,
        .state = step->scenario->linkage.joints[place->joint].contacts[place->place],
        .siblings = {has_corners ? -place->place : 0,
                     has_corners ? TOUCH_CORNERS - 1 - place->place : 0},
    };
}

static const double *block_of(const void *context, size_t place, size_t other)
{
    return response_block(context, place, other);
}

KernelCoupling impulse_step_coupling(const Response *response)
{
    return (KernelCoupling){
        .first_partner = response->first_partner,
        .partners = response->partners,
        .block = block_of,
        .context = response,
    };
}

static bool init_kernel(ImpulseStep *step, Err *err)
{
    const Scenario *scenario = step->scenario;
    step->kernel = kernel_start(scenario->ode.contact_phase);
    if (!touch_list(scenario, &step->places, &step->place_count, err)) {
        return false;
    }
    const bool has_friction = law_has_friction(scenario);
    touch_response(&scenario->linkage, step->places, step->place_count, has_friction,
                   &step->response);
    for (size_t i = 0; i < step->place_count; i++) {
        const KernelContact added = joint_of(step, &step->places[i]);
        const size_t rows = response_place_rows(&step->response.places[i]);
        kernel_add(&step->kernel, &added, rows);
    }
    const size_t rows = kernel_rows(&step->kernel);
    step->total = kernel_sums(rows);
    if (step->place_count <= IMPULSE_FEW_PLACES) {
        kernel_make_room(&step->kernel, rows);
        return true;
    }
    const KernelCoupling coupling = impulse_step_coupling(&step->response);
    kernel_make_rows(&step->kernel);
    step->islands = kernel_islands_create(&step->kernel, &coupling);
    response_groups_init(&step->response, &step->groups);
    return true;
}

bool impulse_step_init(const Scenario *scenario, ImpulseStep *step, Err *err)
{
    step->scenario = scenario;
    step->driven = linkage_driven_body(&scenario->linkage);
    step->tick_s = scenario->run.step / (double)scenario->ode.gear;
    if (!init_kernel(step, err)) {
        return false;
    }
    make_arrays(step);
    if (step->driven >= 0) {
        step->arm = stepping_arm(&scenario->linkage, 0.0);
    }
    step->whole = impulse_scope_whole(&scenario->linkage, step->place_count);
    linkage_start(&scenario->linkage, step->after);
    if (!world_build(scenario, step->after, &step->world, err)) {
        return false;
    }
    // where a step of the world leaves the bodies is not asked for: the cheapest turn will do
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        dBodySetFiniteRotationMode(step->world.bodies[i], 0);
    }
    return true;
}
