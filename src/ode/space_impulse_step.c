// How does a linkage in space move in ODE if its contacts are integrated within the step?
//
// The step of ode/plane/impulse_step.c, with rotations for angles: bodies turn by (h/2) omega up to
// mid-step and by (h/2) omega' from there. The rows of the contacts are frozen at mid-step
// (contact/pin_space_rows.h). Turning inertias are a torque in the step of the world
// (ode/space_world.c); what omega will be at its end is known but for an error of the order of h^2,
// as the contacts have been integrated by then and what is beside them changes slowly.
#include "ode/space_impulse_step.h"

#include "base/zeroed.h"
#include "ode/engine.h"
#include "ode/stepping.h"

#include <string.h>

// as in ode/plane/impulse_step.c
static const double NEAR = 0.02;
static const double SHORT = 0.1;

static size_t body_count(const SpaceImpulseStep *step)
{
    return step->scenario->linkage.body_count;
}

static const double *block_of(const void *context, size_t place, size_t other)
{
    return space_response_block(context, place, other);
}

KernelCoupling space_impulse_step_coupling(const SpaceResponse *response)
{
    return (KernelCoupling){
        .first_partner = response->first_partner,
        .partners = response->partners,
        .block = block_of,
        .context = response,
    };
}

// Where a stop is at the start of the step, and how fast its gap opens.
static void fill_stop(SpaceImpulseStep *step, size_t place)
{
    const Linkage *linkage = &step->scenario->linkage;
    const StopSpace *stop = space_impulse_step_stop(step, place);
    const size_t row = step->kernel.contacts[place].first_row;
    double *angle = &step->angles[stop->joint];
    *angle = space_coordinate_near(linkage, step->before, stop->joint, *angle);
    const SpaceRow opening = stop_space_row(stop, linkage, step->before);
    step->kernel.position[row] = stop_space_gap(stop, *angle);
    step->kernel.speed[row] = space_row_speed(&opening, step->before);
    step->kernel.position[row + 1] = step->kernel.speed[row + 1] = 0.0;
}

// Where the rows of play are at the start of the step, and how fast they go.
static void fill_rows(SpaceImpulseStep *step)
{
    Kernel *kernel = &step->kernel;
    for (size_t i = step->pin_count; i < step->place_count; i++) {
        fill_stop(step, i);
    }
    for (size_t i = 0; i < step->pin_count; i++) {
        const size_t row = kernel->contacts[i].first_row;
        pin_space_rows_state(&step->places[i], &step->rows[i], step->before, kernel->position + row,
                             kernel->speed + row);
    }
}

// Whether a pin touches or will have come near its wall at the end of a step of that length.
static bool is_near_wall(const SpaceImpulseStep *step, double width_s)
{
    const Linkage *linkage = &step->scenario->linkage;
    for (size_t i = step->pin_count; i < step->place_count; i++) {
        const StopSpace *stop = space_impulse_step_stop(step, i);
        const double gap =
            stop_space_gap(stop, space_coordinate_near(linkage, step->before, stop->joint,
                                                       step->angles[stop->joint]));
        const SpaceRow opening = stop_space_row(stop, linkage, step->before);
        const double moved = width_s * space_row_speed(&opening, step->before);
        const double play = coordinate_play(&linkage->joints[stop->joint]);
        const double limit = isfinite(play) ? NEAR * play : 0.0;
        if (step->kernel.contacts[i].state.is_touching || gap < limit || gap + moved < limit) {
            return true;
        }
    }
    for (size_t i = 0; i < step->pin_count; i++) {
        const PinSpacePose pose = pin_space_pose(&step->places[i], step->before);
        // the speed alone: what it may gain meanwhile is less than the margin
        const double limit = NEAR * step->places[i].clearance;
        const double moved = width_s * pose.approach_speed;
        if (step->kernel.contacts[i].state.is_touching || pose.gap < limit ||
            pose.gap - moved < limit) {
            return true;
        }
    }
    return false;
}

// Moves and turns a body by its speeds for a time.
static void coast(SpaceMotion *motion, Vec3 velocity, Vec3 omega, double span_s)
{
    const SpaceChange moved = {vec3_scale(span_s, velocity), vec3_scale(span_s, omega)};
    space_change(motion, &moved, NULL);
}

// The bodies at mid-step, with the speeds of its start.
static void find_middle(const SpaceImpulseStep *step, SpaceMotion *middle)
{
    const double half_s = 0.5 * step->width_s;
    for (size_t i = 0; i < body_count(step); i++) {
        middle[i] = step->before[i];
        coast(&middle[i], middle[i].velocity, middle[i].omega, half_s);
    }
    if (step->driven >= 0) {
        middle[step->driven] = space_driven(&step->scenario->linkage, step->start_s + half_s);
    }
}

// Freezes the rows and the linkage's response at mid-step, and finds how fast the rows move freely.
static bool place_linkage(SpaceImpulseStep *step, const SpaceMotion *middle)
{
    Kernel *kernel = &step->kernel;
    double *play_drift = step->play[0];
    double *ideal_drift = step->ideal[0];
    SpaceMotion *loose = step->motions;
    for (size_t i = 0; i < step->place_count; i++) {
        const KernelContact *joint = &kernel->contacts[i];
        const StopSpace *stop = space_impulse_step_stop(step, i);
        if (stop != NULL) {
            step->rows[i].count = PIN_SPACE_PLAIN_ROWS;
            step->rows[i].rows[0] = stop_space_row(stop, &step->scenario->linkage, middle);
            step->rows[i].rows[1] = (SpaceRow){.body = {LINKAGE_GROUND, LINKAGE_GROUND}};
        } else {
            pin_space_rows_place(&step->places[i], middle, &step->rows[i]);
        }
        memcpy(step->play_rows + joint->first_row, step->rows[i].rows,
               joint->row_count * sizeof *step->play_rows);
    }
    if (!space_response_place(step->response, middle, step->play_rows)) {
        return false;
    }
    memcpy(loose, middle, body_count(step) * sizeof *loose);
    space_response_loosen(step->response, step->scenario->gravity, loose);
    for (size_t i = 0; i < step->place_count; i++) {
        const StopSpace *stop = space_impulse_step_stop(step, i);
        double *drift = play_drift + kernel->contacts[i].first_row;
        if (stop != NULL) {
            drift[0] = stop_space_drift(stop, &step->scenario->linkage, loose);
            drift[1] = 0.0;
        } else {
            pin_space_rows_drift(&step->places[i], &step->rows[i], loose, drift);
        }
    }
    space_response_drift(step->response, loose, ideal_drift);
    const KernelCoupling coupling = space_impulse_step_coupling(step->response);
    if (step->islands != NULL) {
        // other rows may have been chosen
        step->islands->coupling = coupling;
    } else {
        kernel_fill(kernel, &coupling, NULL);
    }
    space_response_free(step->response, ideal_drift, play_drift, kernel->free);
    return true;
}

// Lets the contacts run through the step by themselves.
static bool run_kernel(SpaceImpulseStep *step, const SpaceMotion *middle, SpaceChange *pushed,
                       Err *err)
{
    Kernel *kernel = &step->kernel;
    if (!place_linkage(step, middle)) {
        return err_set(err, ERR_SOLVER,
                       "the ideal joints are redundant here: give one joint of the loop some play");
    }
    fill_rows(step);
    if (!(step->islands != NULL ? kernel_islands_run(step->islands, step->width_s)
                                : kernel_run(kernel, step->width_s))) {
        return err_set(err, ERR_SOLVER,
                       "contact sub-stepping exceeded 100000 steps in one step; reduce run.step");
    }
    if (step->islands != NULL) {
        kernel_islands_look(step->islands, step->width_s, &step->total);
    } else {
        kernel_at(kernel, kernel->node_count - 1, step->width_s, &step->total);
    }
    space_response_apply(step->response, step->total.impulse, pushed);
    return true;
}

// One step of the world under the contacts' mean force.
static bool step_world(SpaceImpulseStep *step, const SpaceMotion *middle, const SpaceChange *pushed,
                       Err *err)
{
    const double rate = 1.0 / step->width_s;
    SpaceChange *loads = step->changes[1];
    space_response_load(step->response, step->total.impulse, loads);
    for (size_t i = 0; i < body_count(step); i++) {
        SpaceMotion placed = middle[i];
        if (space_impulse_step_is_free(step, i)) {
            const dBodyID body = step->world.bodies[i];
            const Vec3 force = vec3_scale(rate, loads[i].move);
            const Vec3 rest = vec3_add(vec3_sub(step->free[i].turn, step->gyration[i]),
                                       vec3_scale(rate, pushed[i].turn));
            const Vec3 turning = space_world_gyration(step->response, i, &middle[i], rest,
                                                      step->width_s, &step->gyration[i]);
            const Vec3 torque = vec3_add(vec3_scale(rate, loads[i].turn), turning);
            dBodyAddForce(body, force.x, force.y, force.z);
            dBodyAddTorque(body, torque.x, torque.y, torque.z);
        } else {
            // the rows hold at the step's end: so must the speed in them
            placed.velocity = step->after[i].velocity;
            placed.omega = step->after[i].omega;
        }
        space_world_place(&step->world, i, &placed);
    }
    if (step->hold != NULL) {
        space_hold_push(step->hold, step->response, middle, step->width_s, &step->world);
    }
    const bool is_quick = step->scenario->ode.solver == ODE_QUICK;
    return engine_step(step->world.id, step->width_s, is_quick, err) &&
           space_world_check(&step->world, err);
}

// Adds changes to the free bodies' positions and speeds.
static void change_motions(SpaceImpulseStep *step, const SpaceChange *positions,
                           const SpaceChange *speeds)
{
    for (size_t i = 0; i < body_count(step); i++) {
        if (space_impulse_step_is_free(step, i)) {
            space_change(&step->after[i], &positions[i], speeds != NULL ? &speeds[i] : NULL);
        }
    }
}

// Puts the end back onto the ideal joints, in passes as in the plane (ode/plane/impulse_step.c).
static void put_back(SpaceImpulseStep *step)
{
    double *openings = step->ideal[0];
    double *rates = step->ideal[1];
    SpaceChange *positions = step->changes[1];
    SpaceChange *speeds = step->changes[2];
    space_response_openings(step->response, step->after, openings, rates);
    // the impulses that close the positions are of no interest
    space_response_close(step->response, openings, openings, positions);
    space_response_close(step->response, rates, step->closing, speeds);
    change_motions(step, positions, speeds);
    space_response_openings(step->response, step->after, openings, rates);
    space_response_close(step->response, rates, rates, speeds);
    memset(positions, 0, body_count(step) * sizeof *positions);
    change_motions(step, positions, speeds);
    for (size_t i = 0; i < step->response->ideal_rows; i++) {
        step->closing[i] += rates[i];
    }
}

static void find_end(SpaceImpulseStep *step, const SpaceMotion *middle)
{
    const double half_s = 0.5 * step->width_s;
    for (size_t i = 0; i < body_count(step); i++) {
        if (space_impulse_step_is_free(step, i)) {
            const SpaceMotion now = space_world_motion(&step->world, i);
            SpaceMotion *after = &step->after[i];
            *after = middle[i];
            after->velocity = now.velocity;
            after->omega = now.omega;
            coast(after, now.velocity, now.omega, half_s);
        }
    }
    SpaceChange *positions = step->changes[1];
    // when in the step the impulse came
    double *late = step->play[0];
    for (size_t i = 0; i < kernel_rows(&step->kernel); i++) {
        late[i] = step->total.moment[i] - half_s * step->total.impulse[i];
    }
    space_response_apply(step->response, late, positions);
    change_motions(step, positions, NULL);
    put_back(step);
}

// The mean acceleration of one part of a body's motion beside the contacts', and how it changes.
static void find_free(const SpaceImpulseStep *step, double width_before_s, Vec3 gained, Vec3 *free,
                      Vec3 *free_rate)
{
    const double apart_s = 0.5 * (step->width_s + width_before_s);
    if (step->width_s < SHORT * width_before_s) {
        *free = vec3_add(*free, vec3_scale(apart_s, *free_rate));
        return;
    }
    const Vec3 mean = vec3_scale(1.0 / step->width_s, gained);
    *free_rate = width_before_s > 0.0 ? vec3_scale(1.0 / apart_s, vec3_sub(mean, *free))
                                      : (Vec3){0.0, 0.0, 0.0};
    *free = mean;
}

// What is left of a move over the step, beyond the formula for inside.
static Vec3 rest_of(double width_s, Vec3 moved, Vec3 speed, Vec3 mean, Vec3 pushed)
{
    const Vec3 coasted = vec3_scale(width_s, vec3_add(speed, vec3_scale(0.5 * width_s, mean)));
    return vec3_sub(vec3_sub(moved, coasted), pushed);
}

// What the state inside the step is worked out from.
static void prepare_inside(SpaceImpulseStep *step, const SpaceChange *pushed, double width_before_s)
{
    const double width_s = step->width_s;
    SpaceChange *moved = step->changes[1];
    space_response_apply(step->response, step->total.moment, moved);
    for (size_t i = 0; i < body_count(step); i++) {
        const SpaceMotion *first = &step->before[i];
        const SpaceMotion *last = &step->after[i];
        SpaceChange *free = &step->free[i];
        const Vec3 gained = vec3_sub(last->velocity, first->velocity);
        const Vec3 spun = vec3_sub(last->omega, first->omega);
        find_free(step, width_before_s, vec3_sub(gained, pushed[i].move), &free->move,
                  &step->free_rate[i].move);
        find_free(step, width_before_s, vec3_sub(spun, pushed[i].turn), &free->turn,
                  &step->free_rate[i].turn);
        const Vec3 went = vec3_sub(last->position, first->position);
        const Vec3 turned = quat_turn_between(first->turn, last->turn);
        step->rest[i] = (SpaceChange){
            rest_of(width_s, went, first->velocity, free->move, moved[i].move),
            rest_of(width_s, turned, first->omega, free->turn, moved[i].turn),
        };
    }
}

// Sets the length of the next step, and what the drive does in it.
static void begin_step(SpaceImpulseStep *step)
{
    const Linkage *linkage = &step->scenario->linkage;
    const size_t gear = step->scenario->ode.gear;
    step->start_s = step->end_s;
    memcpy(step->before, step->after, body_count(step) * sizeof *step->before);
    if (step->driven >= 0) {
        step->before[step->driven] = space_driven(linkage, step->start_s);
    }
    const bool is_fine =
        gear > 1 && (step->count == 0 || is_near_wall(step, (double)gear * step->tick_s));
    step->tick += is_fine ? 1 : gear;
    step->end_s = stepping_end(step->scenario, step->start_s, (double)step->tick * step->tick_s,
                               step->tick_s);
    step->width_s = step->end_s - step->start_s;
    if (step->driven >= 0) {
        step->after[step->driven] = space_driven(linkage, step->end_s);
    }
}

bool space_impulse_step_take(SpaceImpulseStep *step, Err *err)
{
    const double width_before_s = step->width_s;
    SpaceMotion *const middle = step->middle;
    SpaceChange *pushed = step->changes[0]; // what the contacts change of the speeds
    begin_step(step);
    find_middle(step, middle);
    if (!run_kernel(step, middle, pushed, err) || !step_world(step, middle, pushed, err)) {
        return stepping_fail(step->scenario, step->start_s, step->count + 1, step->width_s, err);
    }
    find_end(step, middle);
    prepare_inside(step, pushed, width_before_s);
    step->count++;
    return true;
}
