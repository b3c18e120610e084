// Takes a step of a planar linkage in ODE whose contacts are integrated within the step.
//
// The scheme is kernel/step.c, over x, y and the angle of each body; the response is that of the
// linkage (model/response.h), the world's own step dWorldStep, the driven body at its speed of
// t + h. Of few rows what pushes do changes in the step (model/response_drift.h).
#include "ode/plane/impulse_step.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "kernel/friction_answer.h"
#include "model/joint_rows.h"
#include "model/loads.h"
#include "ode/space/space_world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t body_count(const ImpulseStep *step)
{
    return step->scenario->linkage.body_count;
}

// Adds changes, three a body, to the free bodies' positions and speeds; NULL for none.
static void change_motions(const ImpulseStep *step, const double *positions, const double *speeds,
                           Motion *motions)
{
    for (size_t i = 0; i < body_count(step); i++) {
        if (!impulse_step_is_free(step, i)) {
            continue;
        }
        Motion *motion = &motions[i];
        const double *moved = positions + 3 * i;
        motion->position = vec2_add(motion->position, (Vec2){moved[0], moved[1]});
        motion->angle += moved[2];
        if (speeds != NULL) {
            const double *speed = speeds + 3 * i;
            motion->velocity = vec2_add(motion->velocity, (Vec2){speed[0], speed[1]});
            motion->omega += speed[2];
        }
    }
}

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
    step->mean = zeroed(joints, sizeof *step->mean);
    step->hold = zeroed(joints, sizeof *step->hold);
    step->hold_rate = zeroed(joints, sizeof *step->hold_rate);
    for (size_t i = 0; i < joints; i++) {
        const Joint *joint = &step->scenario->linkage.joints[i];
        step->mean[i].is_touching = !linkage_has_play(joint);
        step->has_coordinates = step->has_coordinates || joint_has_position(joint->kind) ||
                                joint->limits.kind != LIMIT_NONE;
    }
    work->motions = zeroed(bodies, sizeof *work->motions);
    work->loads = zeroed(bodies, sizeof *work->loads);
    work->offsets = zeroed(joints, sizeof *work->offsets);
    work->joints = zeroed(joints, sizeof *work->joints);
    for (size_t i = 0; i < 2; i++) {
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
    response_drift_finish(&step->drift);
    impulse_rubs_finish(&step->rubs);
    free(step->mean);
    free(step->hold);
    free(step->hold_rate);
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
    kernel_step_finish(&step->scheme);
    response_groups_finish(&step->groups);
    impulse_scope_finish(&step->whole);
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
    case TOUCH_SLOT:
        return KERNEL_SLOT;
    case TOUCH_LINE:
    case TOUCH_CAM:
    case TOUCH_TURN:
    case TOUCH_TEETH:
    case TOUCH_RACK:
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
    const bool has_corners = joint_has_guides(step->scenario->linkage.joints[place->joint].kind);
    return (KernelContact){
        .law = place->law,
        .shape = shape,
        .radial_clearance = is_line ? 0.0 : sign * place->clearance,
        .hole_radius = is_line ? 0.0 : sign * place->radius_a,
        .half_length = place->half_length,
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

// How the places of a response move each other.
static KernelCoupling coupling_of(const Response *response)
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
    step->scheme.kernel = kernel_start(scenario->ode.contact_phase);
    if (!touch_list(scenario, &step->places, &step->place_count, err)) {
        return false;
    }
    step->touch_count = step->place_count;
    step->place_count += impulse_rubs_list(scenario, step->places + step->touch_count);
    const bool has_friction = law_has_friction(scenario);
    touch_response(&scenario->linkage, step->places, step->place_count, has_friction,
                   &step->response);
    for (size_t i = 0; i < step->place_count; i++) {
        const Touch *place = &step->places[i];
        const KernelContact added =
            i < step->touch_count ? joint_of(step, place) : impulse_rubs_contact(scenario, place);
        const size_t rows = response_place_rows(&step->response.places[i]);
        kernel_add(&step->scheme.kernel, &added, rows);
    }
    impulse_rubs_make(scenario, &step->response, step->touch_count, step->places,
                      &step->scheme.kernel, &step->rubs);
    return true;
}

// Room for what the scheme knows, and for how pushes change where rows are few.
static void make_scheme(ImpulseStep *step)
{
    KernelStep *scheme = &step->scheme;
    const size_t rows = kernel_rows(&scheme->kernel);
    kernel_step_make_room(scheme, 3 * body_count(step), step->response.ideal_rows);
    scheme->coupling = coupling_of(&step->response);
    if (step->touch_count > IMPULSE_FEW_PLACES && step->rubs.count == 0) {
        kernel_step_make_islands(scheme);
        response_groups_init(&step->response, &step->groups);
        return;
    }
    kernel_make_room(&scheme->kernel, rows);
    if (rows <= IMPULSE_FEW_ROWS && !step->scenario->ode.is_frozen) {
        step->drift = response_drift_create(&step->response);
        if (step->rubs.count > 0) {
            response_drift_want_late(&step->response, &step->drift);
        }
        step->curves = impulse_curves_create(&step->scenario->linkage, step->place_count, rows);
        kernel_step_make_drift(scheme, step->drift.rates, step->drift.drift);
    }
}

// Where the driven bodies stand at a time, from which they are soon worked out at others.
static void set_arms(ImpulseStep *step, double time_s)
{
    const Linkage *linkage = &step->scenario->linkage;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        step->arms[i] = stepping_arm(linkage, i, time_s);
    }
}

void impulse_step_place_driven(const ImpulseStep *step, double time_s, Motion *motions)
{
    const Linkage *linkage = &step->scenario->linkage;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        motions[linkage_drive_body(linkage, i)] =
            stepping_driven_since(linkage, i, &step->arms[i], step->scheme.start_s, time_s);
    }
}

// Springs, dampers and a torque in a step whose contacts are integrated.
//
// Dampers feel the mean speed in the step. With P the contacts' impulse and Q its integral it is
// not that of start and end but differs by A (Q - (h/2) P) / h. And the end's is not that of the
// world's step, which their rows know, but has been put back on the ideal joints: by about as much
// as in the step before.

// Of a step: springs, dampers and torque push the bodies, which move as given at mid-step.
static void push_loads(ImpulseStep *step)
{
    if (!step->world.applied.is_any) {
        return;
    }
    Motion *motions = step->work->motions;
    memcpy(motions, step->middle, body_count(step) * sizeof *motions);
    for (size_t i = 0; i < linkage_drive_count(&step->scenario->linkage); i++) {
        // the others have the speeds of the start already
        const int body = linkage_drive_body(&step->scenario->linkage, i);
        motions[body].velocity = step->before[body].velocity;
    }
    applied_push_at(&step->world.applied, motions, step->scheme.start_s, step->scheme.width_s,
                    APPLIED_AT_MEAN, 1);
}

// Once the contacts are integrated: what the dampers feel beside the speeds of start and end.
static void push_late(ImpulseStep *step)
{
    if (!forces_damp(&step->scenario->linkage)) {
        return;
    }
    const KernelStep *scheme = &step->scheme;
    const double half_s = 0.5 * scheme->width_s;
    double *late = step->work->rows[0];
    double *beyond = step->work->changes[0];
    Motion *motions = step->work->motions;
    for (size_t i = 0; i < kernel_rows(&scheme->kernel); i++) {
        late[i] = scheme->total.moment[i] / scheme->width_s - 0.5 * scheme->total.impulse[i];
    }
    response_apply(&step->response, late, beyond);
    for (size_t i = 0; i < 3 * body_count(step); i++) {
        beyond[i] += half_s * scheme->closed[i];
    }
    for (size_t i = 0; i < body_count(step); i++) {
        motions[i] = step->middle[i];
        motions[i].velocity = (Vec2){beyond[3 * i], beyond[3 * i + 1]};
        motions[i].omega = beyond[3 * i + 2];
    }
    applied_push_late(&step->world.applied, motions);
}

// a pin this close to the wall at the end of a coarse step, of its play, is taken to be there
static const double NEAR_WALL_SHARE = 0.02;

// The same gap in the axes of a slot, at the start of the step.
static void put_in_slot(const ImpulseStep *step, const Touch *place, JointGap *gap)
{
    const Linkage *linkage = &step->scenario->linkage;
    const int body = linkage->joints[place->joint].body_a;
    const double omega = body == LINKAGE_GROUND ? 0.0 : step->before[body].omega;
    const TouchSlot slot = touch_in_slot(gap->position, gap->velocity,
                                         touch_across(linkage, place, step->before), omega);
    gap->position = slot.position;
    gap->velocity = slot.rate;
}

// Where the rows of play are at the start of the step, and how fast they go.
static void fill_rows(ImpulseStep *step)
{
    Kernel *kernel = &step->scheme.kernel;
    const Linkage *linkage = &step->scenario->linkage;
    for (size_t i = 0; i < step->place_count; i++) {
        const Touch *place = &step->places[i];
        const Joint *joint = &linkage->joints[place->joint];
        double *position = kernel->position + kernel->contacts[i].first_row;
        double *speed = kernel->speed + kernel->contacts[i].first_row;
        if (touch_is_scalar(place)) {
            const TouchPose pose = touch_pose(linkage, place, step->before);
            position[0] = i < step->touch_count ? pose.gap : IMPULSE_RUB_GAP;
            position[1] = 0.0;
            speed[0] = -pose.approach_speed;
            speed[1] = touch_sliding(linkage, place, &pose, step->before);
            continue;
        }
        JointGap gap = linkage_joint_gap(linkage, step->before, place->joint);
        if (touch_has_walls(place)) {
            put_in_slot(step, place, &gap);
        }
        position[0] = gap.position.x;
        position[1] = gap.position.y;
        speed[0] = gap.velocity.x;
        speed[1] = gap.velocity.y;
        if (kernel->contacts[i].row_count == RESPONSE_ROWS_A_JOINT) {
            const int bodies[2] = {joint->body_a, joint->body_b};
            for (size_t k = 0; k < 2; k++) {
                speed[2 + k] = bodies[k] == LINKAGE_GROUND ? 0.0 : step->before[bodies[k]].omega;
            }
        }
    }
}

// The gap of a place at a position in its first two rows.
static double gap_at(const KernelContact *joint, Vec2 position)
{
    switch (joint->shape) {
    case KERNEL_LINE:
        return position.x;
    case KERNEL_HOLE:
        return joint->radial_clearance - vec2_length(position);
    case KERNEL_SLOT:
        return pin_slot_pose(position, (Vec2){0.0, 0.0}, joint->half_length,
                             joint->radial_clearance)
            .gap;
    case KERNEL_DISC:
        break;
    }
    return joint->radial_clearance + vec2_length(position);
}

// Whether a place touches or will have come near its wall at the end of a step of that length.
static bool is_near_wall(const ImpulseStep *step, double width_s)
{
    const Kernel *kernel = &step->scheme.kernel;
    for (size_t i = 0; i < step->touch_count; i++) {
        const KernelContact *joint = &kernel->contacts[i];
        const size_t row = joint->first_row;
        // the free acceleration of the step before will do
        const Vec2 now = {kernel->position[row], kernel->position[row + 1]};
        const Vec2 moved = {
            width_s * (kernel->speed[row] + 0.5 * width_s * kernel->free[row]),
            width_s * (kernel->speed[row + 1] + 0.5 * width_s * kernel->free[row + 1]),
        };
        const double play =
            joint->shape == KERNEL_SLOT
                ? joint->radial_clearance
                : linkage_radial_clearance(&step->scenario->linkage.joints[joint->joint]);
        const double near = NEAR_WALL_SHARE * play;
        if (joint->state.is_touching || gap_at(joint, now) < near ||
            gap_at(joint, vec2_add(now, moved)) < near) {
            return true;
        }
    }
    return false;
}

// What the scheme asks of the bodies and of ODE.

// Fails as the ideal joints are redundant somewhere.
static bool refuse_joints(const ImpulseStep *step)
{
    return err_set(step->err, ERR_SOLVER,
                   "the ideal joints are redundant here: give one joint of the loop some play");
}

static bool plane_find_start(void *own, double *accelerations)
{
    ImpulseStep *step = own;
    const Linkage *linkage = &step->scenario->linkage;
    const Vec2 gravity = scenario_gravity(step->scenario);
    const double start_s = step->scheme.start_s;
    BodyLoad *loads = step->work->loads;
    if (!response_place(&step->response, step->before)) {
        return refuse_joints(step);
    }
    loads_of_all(linkage, step->before, start_s, start_s, loads);
    response_accelerate(&step->response, step->before, gravity, loads, accelerations);
    response_free(&step->response, step->before, gravity, loads, step->scheme.kernel.free);
    return true;
}

static void plane_find_middle(void *own, const double *beyond)
{
    ImpulseStep *step = own;
    const double half_s = 0.5 * step->scheme.width_s;
    Motion *middle = step->middle;
    for (size_t i = 0; i < body_count(step); i++) {
        const Motion *motion = &step->before[i];
        middle[i] = *motion;
        middle[i].position = vec2_add(motion->position, vec2_scale(half_s, motion->velocity));
        middle[i].angle = motion->angle + half_s * motion->omega;
    }
    set_arms(step, step->scheme.start_s + half_s);
    impulse_step_place_driven(step, step->scheme.start_s + half_s, middle);
    if (beyond != NULL) {
        change_motions(step, beyond, NULL, middle);
    }
    push_loads(step);
}

static bool plane_respond(void *own)
{
    ImpulseStep *step = own;
    KernelStep *scheme = &step->scheme;
    if (!response_place(&step->response, step->middle)) {
        return refuse_joints(step);
    }
    if (step->rubs.count > 0) {
        impulse_rubs_keep(&step->rubs, &scheme->kernel,
                          scheme->has_drift && scheme->steady > 0 ? scheme->total.impulse : NULL);
    }
    if (step->scheme.has_drift) {
        response_drift_columns(&step->response, step->scheme.columns[0], &step->drift);
        response_drift_find(&step->response, step->middle, 0.5 * step->scheme.width_s,
                            &step->drift);
    }
    if (step->rubs.count > 0) {
        const int failed = impulse_rubs_respond(
            &step->rubs, &step->response, scheme->has_drift ? &step->drift : NULL, &scheme->kernel);
        if (failed >= 0) {
            return friction_answer_refuse(step->scenario->linkage.joints[failed].name, step->err);
        }
        if (scheme->has_drift && forces_damp(&step->scenario->linkage)) {
            impulse_rubs_damp(&step->rubs, &step->response, step->middle, &scheme->kernel);
        }
    }
    return true;
}

// What springs, dampers and torque do in the middle of the step, where the bodies move as given:
// the dampers of a step feel the speeds of its start, and their rows in ODE make up for it.
static const BodyLoad *loads_at_middle(const ImpulseStep *step, const Motion *motions)
{
    const Applied *applied = &step->world.applied;
    BodyLoad *loads = step->work->loads;
    if (!applied->is_any || !forces_damp(applied->linkage)) {
        return applied->is_any ? applied->loads : NULL;
    }
    memset(loads, 0, body_count(step) * sizeof *loads);
    forces_add_dampers(applied->linkage, applied->motions, loads);
    for (size_t i = 0; i < body_count(step); i++) {
        loads[i].force = vec2_sub(applied->loads[i].force, loads[i].force);
        loads[i].moment = applied->loads[i].moment - loads[i].moment;
    }
    forces_add_dampers(applied->linkage, motions, loads);
    return loads;
}

static void plane_accelerate(void *own, const double *gained)
{
    ImpulseStep *step = own;
    Motion *motions = step->work->motions;
    const Applied *applied = &step->world.applied;
    for (size_t i = 0; i < body_count(step); i++) {
        motions[i] = step->middle[i];
        if (impulse_step_is_free(step, i)) {
            motions[i].velocity.x += gained[3 * i];
            motions[i].velocity.y += gained[3 * i + 1];
            motions[i].omega += gained[3 * i + 2];
        }
    }
    const BodyLoad *loads = applied->is_any ? applied->loads : NULL;
    const Vec2 gravity = scenario_gravity(step->scenario);
    KernelStep *scheme = &step->scheme;
    response_free(&step->response, motions, gravity, loads, scheme->kernel.free);
    const bool is_known = scheme->has_drift && scheme->steady > 0 && scheme->is_calm;
    const double since_s = is_known ? scheme->middles_s[0] - scheme->middles_s[1] : 0.0;
    if (step->rubs.count > 0) {
        impulse_rubs_react(&step->rubs, &step->response, motions, gravity,
                           loads_at_middle(step, motions), since_s, &scheme->kernel);
    }
}

static void plane_push(void *own, double after_s, const double *impulses, double *speeds)
{
    const ImpulseStep *step = own;
    if (after_s != 0.0 && impulse_step_has_curves(step)) {
        impulse_curves_press(&step->curves, after_s, impulses, speeds);
    } else {
        response_apply(&step->response, impulses, speeds);
    }
}

// Puts the bodies of ODE's world to mid-step, the contacts' mean forces pushing them.
static void place_bodies(ImpulseStep *step)
{
    const double width_s = step->scheme.width_s;
    double *loads = step->work->changes[0];
    response_load(&step->response, step->scheme.total.impulse, loads);
    for (size_t i = 0; i < body_count(step); i++) {
        Motion placed = step->middle[i];
        if (impulse_step_is_free(step, i)) {
            const dBodyID body = step->world.bodies[i];
            dBodyAddForce(body, loads[3 * i] / width_s, loads[3 * i + 1] / width_s, 0.0);
            dBodyAddTorque(body, 0.0, 0.0, loads[3 * i + 2] / width_s);
        } else {
            // the rows hold at the step's end: so must the speed in them
            placed.velocity = step->after[i].velocity;
        }
        world_place(&step->world, i, &placed);
    }
}

static bool plane_advance(void *own)
{
    ImpulseStep *step = own;
    const double width_s = step->scheme.width_s;
    const double half_s = 0.5 * width_s;
    push_late(step);
    place_bodies(step);
    if (!world_step(&step->world, width_s, step->scenario->ode.solver == ODE_QUICK, step->err) ||
        !world_check(&step->world, step->err)) {
        return false;
    }
    for (size_t i = 0; i < body_count(step); i++) {
        if (impulse_step_is_free(step, i)) {
            const Snapshot now = world_snapshot(&step->world, i);
            Motion *after = &step->after[i];
            after->velocity = now.velocity;
            after->omega = now.omega;
            const Motion *before = &step->before[i];
            const Vec2 moved = vec2_scale(half_s, before->velocity);
            after->position =
                vec2_add(vec2_add(before->position, moved), vec2_scale(half_s, now.velocity));
            after->angle = before->angle + half_s * before->omega + half_s * now.omega;
        }
    }
    return true;
}

static void plane_shift(void *own, const double *positions, const double *speeds)
{
    ImpulseStep *step = own;
    change_motions(step, positions, speeds, step->after);
}

static size_t plane_find_openings(void *own, double *positions, double *rates)
{
    const ImpulseStep *step = own;
    response_openings(&step->response, step->after, positions, rates);
    return step->response.ideal_rows;
}

static void plane_close_openings(void *own, const double *openings, double *impulses,
                                 double *changes)
{
    const ImpulseStep *step = own;
    response_close(&step->response, openings, impulses, changes);
}

static void plane_compare(void *own, double *speeds, double *gained, double *moved)
{
    const ImpulseStep *step = own;
    for (size_t i = 0; i < body_count(step); i++) {
        const Motion *first = &step->before[i];
        const Motion *last = &step->after[i];
        const double v[3] = {first->velocity.x, first->velocity.y, first->omega};
        const double w[3] = {last->velocity.x, last->velocity.y, last->omega};
        const double q[3] = {first->position.x, first->position.y, first->angle};
        const double p[3] = {last->position.x, last->position.y, last->angle};
        for (size_t k = 0; k < 3; k++) {
            speeds[3 * i + k] = v[k];
            gained[3 * i + k] = w[k] - v[k];
            moved[3 * i + k] = p[k] - q[k];
        }
    }
}

static const KernelAdapter ADAPTER = {
    .find_start = plane_find_start,
    .find_middle = plane_find_middle,
    .respond = plane_respond,
    .accelerate = plane_accelerate,
    .push = plane_push,
    .advance = plane_advance,
    .shift = plane_shift,
    .find_openings = plane_find_openings,
    .close = plane_close_openings,
    .compare = plane_compare,
};

// Of few rows, once there have been steps enough: the curves that the state inside is read from.
static void find_curves(ImpulseStep *step)
{
    step->curves.width_s = step->scheme.width_s;
    for (size_t i = 0; i < body_count(step); i++) {
        impulse_curves_set_body(&step->curves, i, &step->before[i], step->scheme.free + 3 * i,
                                step->scheme.free_rate + 3 * i, step->scheme.rest + 3 * i);
    }
    impulse_curves_set_columns(&step->curves, step->scheme.columns, step->scheme.middles_s,
                               step->drift.rates);
    impulse_curves_set_places(&step->curves, &step->scheme.kernel);
}

void impulse_step_add_sliding(const Linkage *linkage, int joint, const double *values,
                              const Motion *motions, JointState *state)
{
    const Vec2 across = vec2_perp(joint_rows_along(linkage, motions, joint));
    state->force_on_b = vec2_add(state->force_on_b, vec2_scale(values[0], across));
    state->moment_on_b += values[1];
}

// The mean forces of the ideal joints: those of the step of the world, whose rows stand at
// mid-step, and those that put the speeds back onto the joints.
static void find_means(ImpulseStep *step, const Motion *middle)
{
    const Response *response = &step->response;
    world_joint_forces(&step->world, step->mean);
    for (size_t row = 0; row < response->ideal_rows; row += 2) {
        const double rate = 1.0 / step->scheme.width_s;
        const double closing[2] = {rate * step->scheme.closing[row],
                                   rate * step->scheme.closing[row + 1]};
        impulse_step_add_ideal(step, row, closing, middle, &step->mean[response->joint_of[row]]);
    }
}

// How the forces of the ideal joints change in the step, beside what answers the contacts: as since
// the step before. Impulses change them too, by the speeds; where these were large nothing is
// known.
static void find_hold_rates(ImpulseStep *step, const Motion *middle)
{
    const Response *response = &step->response;
    const KernelStep *scheme = &step->scheme;
    const bool is_known = scheme->steady > 0 && scheme->is_calm;
    const double apart_s = scheme->middles_s[0] - scheme->middles_s[1];
    double *answers = step->work->rows[0];
    response_react(response, scheme->pressing, answers);
    for (size_t row = 0; row < response->ideal_rows; row += 2) {
        const int joint = response->joint_of[row];
        JointState answer = {.force = 0.0};
        impulse_step_add_ideal(step, row, answers + row, middle, &answer);
        const JointState *mean = &step->mean[joint];
        const ImpulseHold now = {vec2_sub(mean->force_on_b, answer.force_on_b),
                                 mean->moment_on_b - answer.moment_on_b};
        const ImpulseHold before = step->hold[joint];
        const double share = is_known ? 1.0 / apart_s : 0.0;
        step->hold_rate[joint] = (ImpulseHold){
            vec2_scale(share, vec2_sub(now.force, before.force)),
            share * (now.moment - before.moment),
        };
        step->hold[joint] = now;
    }
}

bool impulse_step_init(const Scenario *scenario, const Scenario *spatial, ImpulseStep *step,
                       Err *err)
{
    step->scenario = scenario;
    step->scheme.adapter = &ADAPTER;
    step->scheme.own = step;
    step->ticks = impulse_ticks(scenario);
    if (!init_kernel(step, err)) {
        return false;
    }
    make_arrays(step);
    make_scheme(step);
    set_arms(step, 0.0);
    step->whole = impulse_scope_whole(&scenario->linkage, step->place_count);
    linkage_start(&scenario->linkage, step->after);
    const bool is_built =
        spatial != NULL ? space_world_build_flat(spatial, scenario, step->after, &step->world, err)
                        : world_build(scenario, step->after, &step->world, err);
    if (!is_built) {
        return false;
    }
    // where a step of the world leaves the bodies is not asked for: the cheapest turn will do
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        dBodySetFiniteRotationMode(step->world.bodies[i], 0);
    }
    return true;
}

// Where the bodies and rows are as the step begins, and what the drive does until it ends.
static void begin_step(ImpulseStep *step)
{
    const OdeOptions *options = &step->scenario->ode;
    kernel_step_begin(&step->scheme);
    memcpy(step->before, step->after, body_count(step) * sizeof *step->before);
    impulse_step_place_driven(step, step->scheme.start_s, step->before);
    fill_rows(step);
    const double coarse_s = (double)options->gear * step->ticks.tick_s;
    const bool is_fine =
        options->gear > 1 && (step->scheme.count == 0 || is_near_wall(step, coarse_s));
    impulse_set_end(step->scenario, is_fine, &step->ticks, &step->scheme);
    impulse_step_place_driven(step, step->scheme.end_s, step->after);
}

bool impulse_step_take(ImpulseStep *step, Err *err)
{
    step->err = err;
    begin_step(step);
    if (!impulse_take_scheme(step->scenario, &step->scheme, err)) {
        return false;
    }
    find_means(step, step->middle);
    if (step->scheme.has_drift) {
        find_hold_rates(step, step->middle);
    }
    impulse_step_find_work(step, step->middle);
    if (impulse_step_has_curves(step)) {
        find_curves(step);
    }
    return true;
}
