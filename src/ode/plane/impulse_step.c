// Takes a step of a planar linkage in ODE whose contacts are integrated within the step.
//
// A step from t to t + h, positions q and speeds v both known at t:
//     q_m = q + (h/2) v                               positions at mid-step
//     W, g at q_m                                     the linkage as its joints with play feel it
//     P, Q = impulse of the contacts and its integral over the step, by kernel/run.c
//     v' from dWorldStep at q_m under the mean force P / h, the driven body at its speed of t + h
//     q' = q_m + (h/2) v' + A (Q - (h/2) P)           A P = what P does to the speeds
//     and where A' is known (impulse_step_find_columns), R the integral of Q
//     v' += A' ((h/2) P - Q),   q' += A' ((h/2) Q - 2 R)
//     q', v' put back on the ideal joints along the rows at mid-step
// The last term of q' stands for when in the step the impulse came. The correction along the rows
// at mid-step, not at the end, leaves the step symmetric in time to the order that matters: the
// method is of second order in h, whatever the contacts do within a step.
//
// Inside a step    v(t) = v + a_f t + A P(t),  q(t) = q + v t + a_f t^2 / 2 + A Q(t)
// with a_f, the acceleration beside the contacts', such that v(h) = v'. See docs/stepping.md.
#include "ode/plane/impulse_step.h"

#include "base/zeroed.h"
#include "contact/law.h"
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

// Adds changes, three a body, to the free bodies' positions and speeds.
static void impulse_step_change_motions(const ImpulseStep *step, const double *positions,
                                        const double *speeds, Motion *motions)
{
    for (size_t i = 0; i < body_count(step); i++) {
        if (impulse_step_is_free(step, i)) {
            Motion *motion = &motions[i];
            const double *moved = positions + 3 * i;
            const double *speed = speeds + 3 * i;
            motion->position = vec2_add(motion->position, (Vec2){moved[0], moved[1]});
            motion->angle += moved[2];
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
    step->free = zeroed(3 * bodies, sizeof *step->free);
    step->free_rate = zeroed(3 * bodies, sizeof *step->free_rate);
    step->ahead = zeroed(3 * bodies, sizeof *step->ahead);
    step->rest = zeroed(3 * bodies, sizeof *step->rest);
    step->closing = zeroed(step->response.ideal_rows, sizeof *step->closing);
    step->mean = zeroed(joints, sizeof *step->mean);
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
    const size_t rows = kernel_rows(&step->kernel);
    step->pressing = zeroed(rows, sizeof *step->pressing);
    step->has_few_rows =
        step->islands == NULL && rows <= IMPULSE_FEW_ROWS && !step->scenario->ode.is_frozen;
    if (step->has_few_rows) {
        kernel_make_drift(&step->kernel);
        step->drift = response_drift_create(&step->response);
        step->columns[0] = step->drift.columns;
        step->curves = impulse_curves_create(&step->scenario->linkage, step->place_count, rows);
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
static KernelCoupling impulse_step_coupling(const Response *response)
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
            stepping_driven_since(linkage, i, &step->arms[i], step->start_s, time_s);
    }
}

bool impulse_step_init(const Scenario *scenario, const Scenario *spatial, ImpulseStep *step,
                       Err *err)
{
    step->scenario = scenario;
    step->tick_s = scenario->run.step / (double)scenario->ode.gear;
    if (!init_kernel(step, err)) {
        return false;
    }
    make_arrays(step);
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

// What the impulses of the contacts do to all bodies within a step.
//
// Of few rows A, what 1 N s in each does to all speeds, is linear in time (model/response_drift.h),
// s = t - h/2:
//     v(t) = .. + A P + A' (s P - Q),   q(t) = .. + A Q + A' (s Q - 2 R),   Q' = P, R' = Q
// with P and Q the contacts' impulse and its integral up to t. Of many it is taken as constant.

// Of few rows: finds what 1 N s in each does, and how that changes, from the response at mid-step,
// where the bodies are as given.
static void impulse_step_find_columns(ImpulseStep *step, const Motion *middle)
{
    double *oldest = step->columns[IMPULSE_COLUMNS - 1];
    memmove(step->columns + 1, step->columns, (IMPULSE_COLUMNS - 1) * sizeof *step->columns);
    memmove(step->middles_s + 1, step->middles_s, (IMPULSE_COLUMNS - 1) * sizeof *step->middles_s);
    step->columns[0] = step->drift.columns = oldest;
    step->middles_s[0] = step->start_s + 0.5 * step->width_s;
    response_drift_columns(&step->response, &step->drift);
    response_drift_find(&step->response, middle, 0.5 * step->width_s, &step->drift);
}

void impulse_step_push_bodies(const ImpulseStep *step, double since_s, const KernelSums *sums,
                              double *speeds, double *positions)
{
    if (!step->has_few_rows) {
        response_apply(&step->response, sums->impulse, speeds);
        response_apply(&step->response, sums->moment, positions);
        return;
    }
    const size_t count = 3 * step->scenario->linkage.body_count;
    const size_t rows = kernel_rows(&step->kernel);
    const double off_s = since_s - 0.5 * step->width_s;
    memset(speeds, 0, count * sizeof *speeds);
    memset(positions, 0, count * sizeof *positions);
    for (size_t row = 0; row < rows; row++) {
        const double *column = step->drift.columns + row * count;
        const double *rate = step->drift.rates + row * count;
        const double pushed = sums->impulse[row];
        const double moved = sums->moment[row];
        const double turned = off_s * pushed - moved;
        const double carried = off_s * moved - 2.0 * sums->moment[rows + row];
        for (size_t i = 0; i < count; i++) {
            speeds[i] += pushed * column[i] + turned * rate[i];
            positions[i] += moved * column[i] + carried * rate[i];
        }
    }
}

// Writes what the turning of the rows does in the whole step to the speeds of all bodies, three
// each.
static void impulse_step_turn_bodies(const ImpulseStep *step, double *speeds)
{
    const size_t count = 3 * step->scenario->linkage.body_count;
    memset(speeds, 0, count * sizeof *speeds);
    for (size_t row = 0; step->has_few_rows && row < kernel_rows(&step->kernel); row++) {
        const double turned =
            0.5 * step->width_s * step->total.impulse[row] - step->total.moment[row];
        for (size_t i = 0; i < count; i++) {
            speeds[i] += turned * step->drift.rates[row * count + i];
        }
    }
}

// Writes what forces in the rows of play do to the speeds of all bodies, per second, at a time
// since the step's start: as the curves have it, or else as in the last step whose response is
// known.
static void impulse_step_press_bodies(const ImpulseStep *step, double since_s, const double *forces,
                                      double *rates)
{
    if (impulse_step_has_curves(step)) {
        const double time_s = step->start_s + since_s;
        impulse_curves_press(&step->curves, time_s - step->middles_s[0], forces, rates);
    } else {
        response_apply(&step->response, forces, rates);
    }
}

// Springs, dampers and a torque in a step whose contacts are integrated.
//
// Dampers feel the mean speed in the step. With P the contacts' impulse and Q its integral it is
// not that of start and end but differs by A (Q - (h/2) P) / h.

// Of a step: springs, dampers and torque push the bodies, which move as given at mid-step; and once
// the contacts are integrated, what the dampers feel of when in the step their impulse came.
static void impulse_step_push(ImpulseStep *step, const Motion *middle)
{
    if (!step->world.applied.is_any) {
        return;
    }
    Motion *motions = step->work->motions;
    memcpy(motions, middle, step->scenario->linkage.body_count * sizeof *motions);
    for (size_t i = 0; i < linkage_drive_count(&step->scenario->linkage); i++) {
        // the others have the speeds of the start already
        const int body = linkage_drive_body(&step->scenario->linkage, i);
        motions[body].velocity = step->before[body].velocity;
    }
    applied_push_at(&step->world.applied, motions, step->start_s, step->width_s, APPLIED_AT_MEAN,
                    1);
}

static void impulse_step_push_late(ImpulseStep *step, const Motion *middle)
{
    const Linkage *linkage = &step->scenario->linkage;
    if (!forces_damp(linkage)) {
        return;
    }
    double *late = step->work->rows[0];
    double *moved = step->work->changes[0];
    Motion *motions = step->work->motions;
    BodyLoad *loads = step->work->loads;
    memset(loads, 0, linkage->body_count * sizeof *loads);
    for (size_t i = 0; i < kernel_rows(&step->kernel); i++) {
        late[i] = step->total.moment[i] / step->width_s - 0.5 * step->total.impulse[i];
    }
    response_apply(&step->response, late, moved);
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
        motions[i] = middle[i];
        motions[i].velocity = (Vec2){moved[3 * i], moved[3 * i + 1]};
        motions[i].omega = moved[3 * i + 2];
    }
    forces_add_dampers(linkage, motions, loads);
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
        dBodyAddForce(step->world.bodies[i], loads[i].force.x, loads[i].force.y, 0.0);
        dBodyAddTorque(step->world.bodies[i], 0.0, 0.0, loads[i].moment);
    }
}

// The bodies and accelerations at mid-step, predicted from the steps before.
//
// Of few rows the step is taken with what turns in it (impulse_step_find_columns). All of this is
// right to one order more than a step without it, and has no part in it where nothing is known yet:
// a_f, the acceleration beside the contacts', is that of the step before, P_1 / h the mean force in
// it, g the rows' free acceleration at mid-step, at the speeds v + (h/2) a_f:
//     q_m = q + (h/2) v + (h^2/8) (a_f + A P_1 / h)
//     g' = (g - g_1 - 2 S_1 P_1) / h                  what is left is no work of the contacts

// of the free accelerations, what impulses may change them by: their own change, which comes of the
// second power of speeds, is then known to as much
static const double CALM = 0.1;

// Sets what the accelerations beside the contacts' will be at mid-step: those of the step before.
static void impulse_step_look_ahead(ImpulseStep *step)
{
    const bool is_known = step->has_few_rows && step->steady > 0;
    for (size_t i = 0; i < 3 * step->scenario->linkage.body_count; i++) {
        step->ahead[i] = is_known ? step->free[i] : 0.0;
    }
}

// Adds to the bodies at mid-step what their accelerations have moved them by then, the contacts
// pressing as they did in the mean of the step before: at its end an impact may have been under
// way.
static void move_middle(const ImpulseStep *step, double width_before_s, Motion *middle)
{
    const double share = 0.125 * step->width_s * step->width_s;
    double *mean = step->work->rows[0];
    double *pressed = step->work->changes[0];
    double *speeds = step->work->changes[1];
    for (size_t i = 0; i < kernel_rows(&step->kernel); i++) {
        mean[i] = step->total.impulse[i] / width_before_s;
    }
    impulse_step_press_bodies(step, 0.0, mean, pressed);
    for (size_t i = 0; i < 3 * step->scenario->linkage.body_count; i++) {
        pressed[i] = share * (pressed[i] + step->ahead[i]);
    }
    memset(speeds, 0, 3 * step->scenario->linkage.body_count * sizeof *speeds);
    impulse_step_change_motions(step, pressed, speeds, middle);
}

// The bodies at mid-step, with the speeds of its start.
static void impulse_step_find_middle(ImpulseStep *step, double width_before_s, Motion *middle)
{
    const double half_s = 0.5 * step->width_s;
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
        const Motion *motion = &step->before[i];
        middle[i] = *motion;
        middle[i].position = vec2_add(motion->position, vec2_scale(half_s, motion->velocity));
        middle[i].angle = motion->angle + half_s * motion->omega;
    }
    set_arms(step, step->start_s + half_s);
    impulse_step_place_driven(step, step->start_s + half_s, middle);
    if (step->has_few_rows && step->steady > 0) {
        move_middle(step, width_before_s, middle);
    }
}

// The free accelerations of the rows of play at mid-step, where the contacts have not changed the
// speeds.
static void impulse_step_find_free(ImpulseStep *step, const Motion *middle)
{
    Motion *motions = step->work->motions;
    const double half_s = 0.5 * step->width_s;
    const Applied *applied = &step->world.applied;
    memcpy(motions, middle, step->scenario->linkage.body_count * sizeof *motions);
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
        const double *ahead = step->ahead + 3 * i;
        motions[i].velocity.x += half_s * ahead[0];
        motions[i].velocity.y += half_s * ahead[1];
        motions[i].omega += half_s * ahead[2];
    }
    response_free(&step->response, motions, scenario_gravity(step->scenario),
                  applied->is_any ? applied->loads : NULL, step->kernel.free);
}

// Lets what the rows of play feel change in the step: their mobility with the bodies, the free
// acceleration beside that as it did from the middle of the step before, when the contacts changed
// it by 2 S P.
static void impulse_step_set_drift(ImpulseStep *step, const double *free_before)
{
    Kernel *kernel = &step->kernel;
    const bool is_known = step->steady > 1 && step->is_calm;
    const double apart_s = step->middles_s[0] - step->middles_s[1];
    for (size_t i = 0; i < kernel_rows(kernel); i++) {
        kernel->free_rate[i] = is_known ? (kernel->free[i] - free_before[i]) / apart_s : 0.0;
    }
    kernel_set_drift(kernel, step->drift.drift, step->width_s);
}

// The free accelerations in the step before, with what its contacts did to them; whether that was
// so little that they say how these change by themselves.
static void impulse_step_keep_free(ImpulseStep *step, double *free_before)
{
    const size_t rows = kernel_rows(&step->kernel);
    double size = 0.0;
    double pushed = 0.0;
    for (size_t i = 0; i < rows; i++) {
        double change = 0.0;
        for (size_t k = 0; k < rows; k++) {
            change += 2.0 * step->drift.drift[i * rows + k] * step->total.impulse[k];
        }
        free_before[i] = step->kernel.free[i] + change;
        size = fmax(size, fabs(step->kernel.free[i]));
        pushed = fmax(pushed, fabs(change));
    }
    step->is_calm = pushed <= CALM * size;
}

// a pin this close to the wall at the end of a coarse step, of its play, is taken to be there
static const double NEAR_WALL_SHARE = 0.02;

// a last step that is shorter than this share of the others tells no accelerations: rounding and
// the corrections would stand in them
static const double SHORT = 0.1;

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
    Kernel *kernel = &step->kernel;
    const Linkage *linkage = &step->scenario->linkage;
    for (size_t i = 0; i < step->place_count; i++) {
        const Touch *place = &step->places[i];
        const Joint *joint = &linkage->joints[place->joint];
        double *position = kernel->position + kernel->contacts[i].first_row;
        double *speed = kernel->speed + kernel->contacts[i].first_row;
        if (touch_is_scalar(place)) {
            const TouchPose pose = touch_pose(linkage, place, step->before);
            position[0] = pose.gap;
            position[1] = 0.0;
            speed[0] = -pose.approach_speed;
            speed[1] = touch_sliding(linkage, place, &pose, step->before);
            continue;
        }
        JointGap gap = linkage_joint_gap(linkage, step->before, place->joint);
        if (place->shape == TOUCH_SLOT) {
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
    const Kernel *kernel = &step->kernel;
    for (size_t i = 0; i < step->place_count; i++) {
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

// Lets the contacts run through the step by themselves.
static bool run_kernel(ImpulseStep *step, const Motion *middle, Err *err)
{
    Kernel *kernel = &step->kernel;
    if (!response_place(&step->response, middle)) {
        return err_set(err, ERR_SOLVER,
                       "the ideal joints are redundant here: give one joint of the loop some play");
    }
    double *free_before = step->work->rows[1];
    if (step->has_few_rows) {
        impulse_step_keep_free(step, free_before);
        impulse_step_find_columns(step, middle);
    }
    impulse_step_find_free(step, middle);
    bool is_run;
    if (step->islands != NULL) {
        is_run = kernel_islands_run(step->islands, step->width_s);
    } else {
        const KernelCoupling coupling = impulse_step_coupling(&step->response);
        kernel_fill(kernel, &coupling, NULL);
        if (step->has_few_rows) {
            impulse_step_set_drift(step, free_before);
        }
        is_run = kernel_run(kernel, step->width_s);
    }
    if (!is_run) {
        return err_set(err, ERR_SOLVER,
                       "contact sub-stepping exceeded 100000 steps in one step; reduce run.step");
    }
    if (step->islands != NULL) {
        kernel_islands_look(step->islands, step->width_s, &step->total);
    } else {
        kernel_at(kernel, kernel->node_count - 1, step->width_s, &step->total);
    }
    return true;
}

// One step of the world under the contacts' mean force.
static bool step_world(ImpulseStep *step, const Motion *middle, Err *err)
{
    const double width_s = step->width_s;
    double *loads = step->work->changes[0];
    impulse_step_push_late(step, middle);
    response_load(&step->response, step->total.impulse, loads);
    for (size_t i = 0; i < body_count(step); i++) {
        Motion placed = middle[i];
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
    return world_step(&step->world, width_s, step->scenario->ode.solver == ODE_QUICK, err) &&
           world_check(&step->world, err);
}

// Puts the end back onto the ideal joints. The rows are those of mid-step: one pass leaves speeds
// across the joints that fall as h^2, and with them an error that comes and goes with the length of
// the step; a second one leaves h^3.
static void put_back(ImpulseStep *step)
{
    double *openings = step->work->rows[0];
    double *rates = step->work->rows[1];
    double *positions = step->work->changes[0];
    double *speeds = step->work->changes[1];
    response_openings(&step->response, step->after, openings, rates);
    // the impulses that close the positions are of no interest
    response_close(&step->response, openings, openings, positions);
    response_close(&step->response, rates, step->closing, speeds);
    impulse_step_change_motions(step, positions, speeds, step->after);
    response_openings(&step->response, step->after, openings, rates);
    response_close(&step->response, rates, rates, speeds);
    memset(positions, 0, 3 * body_count(step) * sizeof *positions);
    impulse_step_change_motions(step, positions, speeds, step->after);
    for (size_t i = 0; i < step->response.ideal_rows; i++) {
        step->closing[i] += rates[i];
    }
}

// Places and speeds at the end of the step.
static void find_end(ImpulseStep *step)
{
    const double half_s = 0.5 * step->width_s;
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
    // when in the step the impulse came
    double *positions = step->work->changes[0];
    double *speeds = step->work->changes[1];
    const double cube = step->width_s * step->width_s * step->width_s / 12.0;
    impulse_step_push_bodies(step, step->width_s, &step->total, step->moved[0], step->moved[1]);
    // the world's step has the impulse along the rows of mid-step
    impulse_step_turn_bodies(step, speeds);
    for (size_t i = 0; i < 3 * body_count(step); i++) {
        positions[i] = step->moved[1][i] - half_s * (step->moved[0][i] - speeds[i]);
        if (step->has_few_rows && step->is_calm) {
            // accelerations that change beside the contacts'
            positions[i] -= cube * step->free_rate[i];
        }
    }
    impulse_step_change_motions(step, positions, speeds, step->after);
    put_back(step);
}

// What the state inside the step is worked out from.
static void prepare_inside(ImpulseStep *step, double width_before_s)
{
    const double width_s = step->width_s;
    const double *speeds = step->moved[0];
    const double *positions = step->moved[1];
    for (size_t i = 0; i < body_count(step); i++) {
        const Motion *first = &step->before[i];
        const Motion *last = &step->after[i];
        const double v[3] = {first->velocity.x, first->velocity.y, first->omega};
        const double w[3] = {last->velocity.x, last->velocity.y, last->omega};
        const double q[3] = {first->position.x, first->position.y, first->angle};
        const double p[3] = {last->position.x, last->position.y, last->angle};
        for (size_t k = 0; k < 3; k++) {
            const size_t n = 3 * i + k;
            double mean = (w[k] - v[k] - speeds[n]) / width_s;
            const double apart_s = 0.5 * (width_s + width_before_s);
            if (width_s < SHORT * width_before_s) {
                mean = step->free[n] + apart_s * step->free_rate[n];
            } else {
                const double change = mean - step->free[n];
                step->free_rate[n] = width_before_s > 0.0 ? change / apart_s : 0.0;
            }
            step->free[n] = mean;
            const double bent =
                step->has_few_rows ? width_s * width_s * width_s / 12.0 * step->free_rate[n] : 0.0;
            step->rest[n] =
                p[k] - q[k] - width_s * (v[k] + 0.5 * width_s * mean) - positions[n] + bent;
        }
    }
    for (size_t i = 0; i < kernel_rows(&step->kernel); i++) {
        step->pressing[i] = step->total.impulse[i] / width_s;
    }
}

// Of few rows, once there have been steps enough: the curves that the state inside is read from.
static void find_curves(ImpulseStep *step)
{
    step->curves.width_s = step->width_s;
    for (size_t i = 0; i < body_count(step); i++) {
        impulse_curves_set_body(&step->curves, i, &step->before[i], step->free + 3 * i,
                                step->free_rate + 3 * i, step->rest + 3 * i);
    }
    impulse_curves_set_columns(&step->curves, step->columns, step->middles_s, step->drift.rates);
    impulse_curves_set_places(&step->curves, &step->kernel);
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
        const double rate = 1.0 / step->width_s;
        const double closing[2] = {rate * step->closing[row], rate * step->closing[row + 1]};
        impulse_step_add_ideal(step, row, closing, middle, &step->mean[response->joint_of[row]]);
    }
}

// Where the step ends: on the ticks, but not beyond the run, nor beyond a kink of the drive's speed
// or a jump of a load.
static void set_end(ImpulseStep *step, size_t ticks)
{
    const double rounding_s = STEPPING_ROUNDING * step->tick_s;
    const Linkage *linkage = &step->scenario->linkage;
    const double kink_s =
        fmin(linkage_next_kink(linkage, step->start_s), loads_next_jump(linkage, step->start_s));
    step->tick += ticks;
    step->end_s = stepping_end(step->scenario, step->start_s, (double)step->tick * step->tick_s,
                               step->tick_s);
    step->is_kink = kink_s < step->end_s + rounding_s;
    if (step->is_kink) {
        step->end_s = kink_s;
        step->tick = (size_t)floor((kink_s + rounding_s) / step->tick_s);
    }
}

bool impulse_step_take(ImpulseStep *step, Err *err)
{
    const OdeOptions *options = &step->scenario->ode;
    // accelerations before a kink say nothing of those after it
    const double width_before_s = step->is_kink ? 0.0 : step->width_s;
    step->steady = step->count == 0 || step->is_kink ? 0 : step->steady + 1;
    Motion *middle = step->middle;
    step->start_s = step->end_s;
    memcpy(step->before, step->after, body_count(step) * sizeof *step->before);
    impulse_step_place_driven(step, step->start_s, step->before);
    fill_rows(step);
    const double coarse_s = (double)options->gear * step->tick_s;
    const size_t ticks =
        options->gear > 1 && (step->count == 0 || is_near_wall(step, coarse_s)) ? 1 : options->gear;
    set_end(step, ticks);
    step->width_s = step->end_s - step->start_s;
    impulse_step_place_driven(step, step->end_s, step->after);
    impulse_step_look_ahead(step);
    impulse_step_find_middle(step, width_before_s, middle);
    impulse_step_push(step, middle);
    if (!run_kernel(step, middle, err) || !step_world(step, middle, err)) {
        return stepping_fail(step->scenario, step->start_s, step->count + 1, step->width_s, err);
    }
    find_end(step);
    prepare_inside(step, width_before_s);
    find_means(step, middle);
    impulse_step_find_work(step, middle);
    step->count++;
    if (impulse_step_has_curves(step)) {
        find_curves(step);
    }
    return true;
}
