// How does the linkage move in ODE if its contacts are integrated within the step?
//
// A step from t to t + h, positions q and speeds v both known at t:
//     q_m = q + (h/2) v                               positions at mid-step
//     W, g at q_m                                     the linkage as its joints with play feel it
//     P, Q = impulse of the contacts and its integral over the step, by kernel/run.c
//     v' from dWorldStep at q_m under the mean force P / h, the driven body at its speed of t + h
//     q' = q_m + (h/2) v' + A (Q - (h/2) P)           A P = what P does to the speeds
//     and where A' is known (ode/impulse_columns.c), R the integral of Q
//     v' += A' ((h/2) P - Q),   q' += A' ((h/2) Q - 2 R)
//     q', v' put back on the ideal joints along the rows at mid-step
// The last term of q' stands for when in the step the impulse came. The correction along the rows
// at mid-step, not at the end, leaves the step symmetric in time to the order that matters: the
// method is of second order in h, whatever the contacts do within a step.
//
// Inside a step    v(t) = v + a_f t + A P(t),  q(t) = q + v t + a_f t^2 / 2 + A Q(t)
// with a_f, the acceleration beside the contacts', such that v(h) = v'. See docs/stepping.md.
#include "ode/impulse_step.h"

#include "model/joint_rows.h"
#include "ode/stepping.h"

#include <string.h>

// a pin this close to the wall at the end of a coarse step, of its play, is taken to be there
static const double NEAR = 0.02;

// a last step that is shorter than this share of the others tells no accelerations: rounding and
// the corrections would stand in them
static const double SHORT = 0.1;

static size_t body_count(const ImpulseStep *step)
{
    return step->scenario->linkage.body_count;
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
        const JointGap gap = linkage_joint_gap(linkage, step->before, place->joint);
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
    return joint->shape == KERNEL_LINE   ? position.x
           : joint->shape == KERNEL_HOLE ? joint->radial_clearance - vec2_length(position)
                                         : joint->radial_clearance + vec2_length(position);
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
        const double near =
            NEAR * linkage_radial_clearance(&step->scenario->linkage.joints[joint->joint]);
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

// Adds changes, three a body, to the free bodies' positions and speeds.
void impulse_step_change_motions(const ImpulseStep *step, const double *positions,
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

// Where the step ends: on the ticks, but not beyond the run, nor beyond a kink of the drive's
// speed.
static void set_end(ImpulseStep *step, size_t ticks)
{
    const double rounding_s = STEPPING_ROUNDING * step->tick_s;
    const double kink_s = drive_next_kink(&step->scenario->linkage.driver, step->start_s);
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
    if (step->driven >= 0) {
        step->before[step->driven] = stepping_driven_since(&step->scenario->linkage, &step->arm,
                                                           step->start_s, step->start_s);
    }
    fill_rows(step);
    const double coarse_s = (double)options->gear * step->tick_s;
    const size_t ticks =
        options->gear > 1 && (step->count == 0 || is_near_wall(step, coarse_s)) ? 1 : options->gear;
    set_end(step, ticks);
    step->width_s = step->end_s - step->start_s;
    if (step->driven >= 0) {
        step->after[step->driven] =
            stepping_driven_since(&step->scenario->linkage, &step->arm, step->start_s, step->end_s);
    }
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
