// Takes a step of a linkage in space in ODE whose contacts are integrated within the step.
//
// The scheme is kernel/step.c, with rotations for angles: bodies turn by (h/2) omega up to
// mid-step and by (h/2) omega' from there. The rows of the contacts are frozen at mid-step
// (contact/pin_space_rows.h). Turning inertias are a torque in the step of the world
// (ode/space/space_world.c); what omega will be at its end is known but for an error of the order
// of h^2, as the contacts have been integrated by then and what is beside them changes slowly.
#include "ode/space/space_impulse_step.h"

#include "base/zeroed.h"
#include "ode/engine.h"
#include "ode/stepping.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { COORDINATES = sizeof(SpaceChange) / sizeof(double) }; // of a body
static_assert(sizeof(SpaceChange) == 6 * sizeof(double), "a change is six numbers");

// Numbers by coordinate as changes of bodies.
static SpaceChange *by_body(double *numbers)
{
    return (SpaceChange *)numbers;
}

static const SpaceChange *change_of(const double *numbers, size_t body)
{
    return (const SpaceChange *)numbers + body;
}

void space_impulse_step_finish(SpaceImpulseStep *step)
{
    kernel_step_finish(&step->scheme);
    response_groups_finish(&step->groups);
    impulse_scope_finish(&step->whole);
    space_response_finish(step->response);
    space_response_finish(step->there);
    space_hold_free(step->hold);
    free(step->response);
    free(step->there);
    world_finish(&step->world);
    void *const arrays[] = {step->places, step->stops,   step->angles,     step->rows,
                            step->before, step->after,   step->gyration,   step->middle,
                            step->mean,   step->motions, step->changes[0], step->changes[1],
                            step->ideal,  step->play,    step->play_rows,  step->forces};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
}

static const double *block_of(const void *context, size_t place, size_t other)
{
    return space_response_block(context, place, other);
}

// How the places of a response move each other.
static KernelCoupling coupling_of(const SpaceResponse *response)
{
    return (KernelCoupling){
        .first_partner = response->first_partner,
        .partners = response->partners,
        .block = block_of,
        .context = response,
    };
}

static bool init_kernel(SpaceImpulseStep *step, Err *err)
{
    const Scenario *scenario = step->scenario;
    step->scheme.kernel = kernel_start(scenario->ode.contact_phase);
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
        kernel_add(&step->scheme.kernel, &added, rows);
    }
    for (size_t i = 0; i < stop_count; i++) {
        const StopSpace *stop = &step->stops[i];
        const Joint *joint = &scenario->linkage.joints[stop->joint];
        const KernelContact added = {.law = stop->law,
                                     .shape = KERNEL_LINE,
                                     .joint = stop->joint,
                                     .state = joint->contacts[stop_space_place(stop)]};
        kernel_add(&step->scheme.kernel, &added, PIN_SPACE_PLAIN_ROWS);
    }
    return true;
}

// Room for what the scheme knows, and for the mobilities that are not always zero, or for islands.
static void make_scheme(SpaceImpulseStep *step)
{
    const Linkage *linkage = &step->scenario->linkage;
    KernelStep *scheme = &step->scheme;
    kernel_step_make_room(scheme, COORDINATES * linkage->body_count,
                          SPACE_JOINT_ROWS * linkage->joint_count);
    scheme->coupling = coupling_of(step->response);
    if (step->place_count > IMPULSE_FEW_PLACES) {
        kernel_step_make_islands(scheme);
        space_response_groups_init(step->response, &step->groups);
        return;
    }
    size_t *places = zeroed(step->place_count, sizeof *places);
    for (size_t i = 0; i < step->place_count; i++) {
        places[i] = i;
    }
    kernel_make_room(&scheme->kernel,
                     kernel_coupling_reach(&scheme->coupling, &scheme->kernel, places));
    free(places);
}

static void make_arrays(SpaceImpulseStep *step)
{
    const size_t bodies = step->scenario->linkage.body_count;
    const size_t joints = step->scenario->linkage.joint_count;
    const size_t rows = kernel_rows(&step->scheme.kernel);
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
    step->gyration = zeroed(bodies, sizeof *step->gyration);
    step->middle = zeroed(bodies, sizeof *step->middle);
    step->mean = zeroed(joints, sizeof *step->mean);
    step->motions = zeroed(bodies, sizeof *step->motions);
    for (size_t i = 0; i < SPACE_IMPULSE_ROOMS; i++) {
        step->changes[i] = zeroed(bodies, sizeof *step->changes[i]);
    }
    step->play_rows = zeroed(rows, sizeof *step->play_rows);
    step->play = zeroed(rows, sizeof *step->play);
    step->ideal = zeroed(ideal, sizeof *step->ideal);
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
                                         step->scheme.kernel.contacts[i].row_count};
    }
    const bool is_built =
        space_world_build(scenario, step->after, places, count, &step->world, step->response,
                          &step->hold, err) &&
        space_response_init(&scenario->linkage, step->after, places, count, step->there, err);
    free(places);
    return is_built;
}

// as in ode/plane/impulse_step.c
static const double NEAR_WALL_SHARE = 0.02;

static size_t body_count(const SpaceImpulseStep *step)
{
    return step->scenario->linkage.body_count;
}

// Where a stop is at the start of the step, and how fast its gap opens.
static void fill_stop(SpaceImpulseStep *step, size_t place)
{
    const Linkage *linkage = &step->scenario->linkage;
    const StopSpace *stop = space_impulse_step_stop(step, place);
    const size_t row = step->scheme.kernel.contacts[place].first_row;
    double *angle = &step->angles[stop->joint];
    *angle = space_coordinate_near(linkage, step->before, stop->joint, *angle);
    const SpaceRow opening = stop_space_row(stop, linkage, step->before);
    step->scheme.kernel.position[row] = stop_space_gap(stop, *angle);
    step->scheme.kernel.speed[row] = space_row_speed(&opening, step->before);
    step->scheme.kernel.position[row + 1] = step->scheme.kernel.speed[row + 1] = 0.0;
}

// Where the rows of play are at the start of the step, and how fast they go.
static void fill_rows(SpaceImpulseStep *step)
{
    Kernel *kernel = &step->scheme.kernel;
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
        const double limit = isfinite(play) ? NEAR_WALL_SHARE * play : 0.0;
        if (step->scheme.kernel.contacts[i].state.is_touching || gap < limit ||
            gap + moved < limit) {
            return true;
        }
    }
    for (size_t i = 0; i < step->pin_count; i++) {
        const PinSpacePose pose = pin_space_pose(&step->places[i], step->before);
        // the speed alone: what it may gain meanwhile is less than the margin
        const double limit = NEAR_WALL_SHARE * step->places[i].clearance;
        const double moved = width_s * pose.approach_speed;
        if (step->scheme.kernel.contacts[i].state.is_touching || pose.gap < limit ||
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

// What the scheme asks of the bodies and of ODE.

static void space_find_middle(void *own, const double *beyond)
{
    SpaceImpulseStep *step = own;
    const double half_s = 0.5 * step->scheme.width_s;
    SpaceMotion *middle = step->middle;
    for (size_t i = 0; i < body_count(step); i++) {
        middle[i] = step->before[i];
        coast(&middle[i], middle[i].velocity, middle[i].omega, half_s);
        if (beyond != NULL && space_impulse_step_is_free(step, i)) {
            space_change(&middle[i], change_of(beyond, i), NULL);
        }
    }
    if (step->driven >= 0) {
        middle[step->driven] =
            space_driven(&step->scenario->linkage, step->scheme.start_s + half_s);
    }
}

// Freezes the rows and the linkage's response at mid-step.
static bool space_respond(void *own)
{
    SpaceImpulseStep *step = own;
    const Kernel *kernel = &step->scheme.kernel;
    for (size_t i = 0; i < step->place_count; i++) {
        const KernelContact *joint = &kernel->contacts[i];
        const StopSpace *stop = space_impulse_step_stop(step, i);
        if (stop != NULL) {
            step->rows[i].count = PIN_SPACE_PLAIN_ROWS;
            step->rows[i].rows[0] = stop_space_row(stop, &step->scenario->linkage, step->middle);
            step->rows[i].rows[1] = (SpaceRow){.body = {LINKAGE_GROUND, LINKAGE_GROUND}};
        } else {
            pin_space_rows_place(&step->places[i], step->middle, &step->rows[i]);
        }
        memcpy(step->play_rows + joint->first_row, step->rows[i].rows,
               joint->row_count * sizeof *step->play_rows);
    }
    if (!space_response_place(step->response, step->middle, step->play_rows)) {
        return err_set(step->err, ERR_SOLVER,
                       "the ideal joints are redundant here: give one joint of the loop some play");
    }
    step->scheme.coupling = coupling_of(step->response);
    fill_rows(step);
    return true;
}

static void space_accelerate(void *own, const double *gained)
{
    SpaceImpulseStep *step = own;
    Kernel *kernel = &step->scheme.kernel;
    SpaceMotion *loose = step->motions;
    for (size_t i = 0; i < body_count(step); i++) {
        loose[i] = step->middle[i];
        space_change(&loose[i], NULL, change_of(gained, i));
    }
    space_response_loosen(step->response, step->scenario->gravity, loose);
    for (size_t i = 0; i < step->place_count; i++) {
        const StopSpace *stop = space_impulse_step_stop(step, i);
        double *drift = step->play + kernel->contacts[i].first_row;
        if (stop != NULL) {
            drift[0] = stop_space_drift(stop, &step->scenario->linkage, loose);
            drift[1] = 0.0;
        } else {
            pin_space_rows_drift(&step->places[i], &step->rows[i], loose, drift);
        }
    }
    space_response_drift(step->response, loose, step->ideal);
    space_response_free(step->response, step->ideal, step->play, kernel->free);
}

static void space_push(void *own, double after_s, const double *impulses, double *speeds)
{
    (void)after_s; // the response is taken as constant
    const SpaceImpulseStep *step = own;
    space_response_apply(step->response, impulses, by_body(speeds));
}

// Puts the bodies of ODE's world to mid-step, the contacts' mean forces pushing them.
static void place_bodies(SpaceImpulseStep *step)
{
    const KernelStep *scheme = &step->scheme;
    const double rate = 1.0 / scheme->width_s;
    SpaceChange *loads = step->changes[0];
    space_response_load(step->response, scheme->total.impulse, loads);
    for (size_t i = 0; i < body_count(step); i++) {
        SpaceMotion placed = step->middle[i];
        if (space_impulse_step_is_free(step, i)) {
            const dBodyID body = step->world.bodies[i];
            const Vec3 force = vec3_scale(rate, loads[i].move);
            const Vec3 rest =
                vec3_add(vec3_sub(change_of(scheme->free, i)->turn, step->gyration[i]),
                         vec3_scale(rate, change_of(scheme->moved[0], i)->turn));
            const Vec3 turning = space_world_gyration(step->response, i, &placed, rest,
                                                      scheme->width_s, &step->gyration[i]);
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
}

static bool space_advance(void *own)
{
    SpaceImpulseStep *step = own;
    const double width_s = step->scheme.width_s;
    const double half_s = 0.5 * width_s;
    const bool is_quick = step->scenario->ode.solver == ODE_QUICK;
    place_bodies(step);
    if (step->hold != NULL) {
        space_hold_push(step->hold, step->response, step->middle, width_s, &step->world);
    }
    if (!engine_step(step->world.id, width_s, is_quick, step->err) ||
        !space_world_check(&step->world, step->err)) {
        return false;
    }
    for (size_t i = 0; i < body_count(step); i++) {
        if (space_impulse_step_is_free(step, i)) {
            const SpaceMotion now = space_world_motion(&step->world, i);
            SpaceMotion *after = &step->after[i];
            *after = step->before[i];
            coast(after, after->velocity, after->omega, half_s);
            after->velocity = now.velocity;
            after->omega = now.omega;
            coast(after, now.velocity, now.omega, half_s);
        }
    }
    return true;
}

static void space_shift(void *own, const double *positions, const double *speeds)
{
    SpaceImpulseStep *step = own;
    for (size_t i = 0; i < body_count(step); i++) {
        if (space_impulse_step_is_free(step, i)) {
            space_change(&step->after[i], change_of(positions, i), change_of(speeds, i));
        }
    }
}

static size_t space_find_openings(void *own, double *positions, double *rates)
{
    const SpaceImpulseStep *step = own;
    space_response_openings(step->response, step->after, positions, rates);
    return step->response->ideal_rows;
}

static void space_close_openings(void *own, const double *openings, double *impulses,
                                 double *changes)
{
    const SpaceImpulseStep *step = own;
    space_response_close(step->response, openings, impulses, by_body(changes));
}

static void space_compare(void *own, double *speeds, double *gained, double *moved)
{
    const SpaceImpulseStep *step = own;
    for (size_t i = 0; i < body_count(step); i++) {
        const SpaceMotion *first = &step->before[i];
        const SpaceMotion *last = &step->after[i];
        by_body(speeds)[i] = (SpaceChange){first->velocity, first->omega};
        by_body(gained)[i] = (SpaceChange){vec3_sub(last->velocity, first->velocity),
                                           vec3_sub(last->omega, first->omega)};
        by_body(moved)[i] = (SpaceChange){vec3_sub(last->position, first->position),
                                          quat_turn_between(first->turn, last->turn)};
    }
}

static const KernelAdapter ADAPTER = {
    .find_middle = space_find_middle,
    .respond = space_respond,
    .accelerate = space_accelerate,
    .push = space_push,
    .advance = space_advance,
    .shift = space_shift,
    .find_openings = space_find_openings,
    .close = space_close_openings,
    .compare = space_compare,
};

bool space_impulse_step_init(const Scenario *scenario, SpaceImpulseStep *step, Err *err)
{
    step->scenario = scenario;
    step->driven = linkage_driven_body(&scenario->linkage);
    step->scheme.adapter = &ADAPTER;
    step->scheme.own = step;
    step->ticks = impulse_ticks(scenario);
    if (!init_kernel(step, err)) {
        return false;
    }
    make_arrays(step);
    space_start(&scenario->linkage, step->after);
    if (!build(step, err)) {
        return false;
    }
    make_scheme(step);
    step->whole = impulse_scope_whole(&scenario->linkage, step->place_count);
    return true;
}

// Sets the length of the next step, and what the drive does in it.
static void begin_step(SpaceImpulseStep *step)
{
    const Linkage *linkage = &step->scenario->linkage;
    const size_t gear = step->scenario->ode.gear;
    kernel_step_begin(&step->scheme);
    memcpy(step->before, step->after, body_count(step) * sizeof *step->before);
    if (step->driven >= 0) {
        step->before[step->driven] = space_driven(linkage, step->scheme.start_s);
    }
    const double coarse_s = (double)gear * step->ticks.tick_s;
    const bool is_fine = gear > 1 && (step->scheme.count == 0 || is_near_wall(step, coarse_s));
    impulse_set_end(step->scenario, is_fine, &step->ticks, &step->scheme);
    if (step->driven >= 0) {
        step->after[step->driven] = space_driven(linkage, step->scheme.end_s);
    }
}

// The mean forces with which the joints and the drive held the bodies in a step.
//
// The ideal joints: F = (what ODE's rows did + what put the speeds back onto the joints) / h. ODE's
// rows stand at mid-step, the speeds are kept at the step's end.
// The drive, m (a - g) = F_drive + sum F_i of the driven body:
//     work = h P(mean forces, mid-step) - sum (h/2 P_c - Q_c) a_c
// with P_c and Q_c impulse and moment of a contact's row, a_c the acceleration along it of the
// driven body's point: the contact's force does not stand in the middle of the step.

// Mean forces of the ideal joints, and what they do to the driven body.
static void find_means(SpaceImpulseStep *step)
{
    const Linkage *linkage = &step->scenario->linkage;
    SpaceChange *sum = &step->on_driven;
    *sum = (SpaceChange){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!linkage_is_ideal(linkage, i)) {
            continue;
        }
        step->mean[i] = space_world_force(&step->world, i);
        if (step->driven >= 0 && (joint->body_a == step->driven || joint->body_b == step->driven)) {
            const SpaceChange load = space_world_load(&step->world, i, step->driven);
            sum->move = vec3_add(sum->move, load.move);
            sum->turn = vec3_add(sum->turn, load.turn);
        }
    }
    double *closing = step->ideal;
    for (size_t i = 0; i < step->response->ideal_rows; i++) {
        closing[i] = step->scheme.closing[i] / step->scheme.width_s;
    }
    space_response_add_forces(step->response, closing, step->mean);
    if (step->driven >= 0) {
        space_response_add_reactions(step->response, closing, step->driven, sum);
    }
}

// The same of a stop, whose axis turns with body a: against body b's own turning.
static double work_of_stop(const SpaceImpulseStep *step, size_t place)
{
    const Linkage *linkage = &step->scenario->linkage;
    const StopSpace *stop = space_impulse_step_stop(step, place);
    const Joint *joint = &linkage->joints[stop->joint];
    const size_t row = step->scheme.kernel.contacts[place].first_row;
    if (joint->body_b != step->driven || joint->body_a == LINKAGE_GROUND) {
        return 0.0;
    }
    const double early = 0.5 * step->scheme.width_s * step->scheme.total.impulse[row] -
                         step->scheme.total.moment[row];
    const Vec3 axis = step->rows[place].rows[0].angular[1];
    const Vec3 turning = vec3_cross(step->middle[joint->body_a].omega, axis);
    return -early * vec3_dot(turning, step->middle[step->driven].omega);
}

// What the contacts' force does beyond its mean, as the points of the driven body turn.
static double work_beyond(const SpaceImpulseStep *step, size_t place)
{
    if (place >= step->pin_count) {
        return work_of_stop(step, place);
    }
    const PinSpaceRows *rows = &step->rows[place];
    double work = 0.0;
    for (size_t k = 0; k < PIN_SPACE_PLAIN_ROWS; k++) {
        const size_t row = step->scheme.kernel.contacts[place].first_row + k;
        const SpaceRow *of = &rows->rows[k];
        const double early = 0.5 * step->scheme.width_s * step->scheme.total.impulse[row] -
                             step->scheme.total.moment[row];
        for (int side = 0; side < 2; side++) {
            if (of->body[side] == step->driven) {
                const Vec3 at = side == 0 ? rows->at_a : rows->at_b;
                const Vec3 turning = space_acceleration_at(step->middle, step->driven, at);
                work -= early * vec3_dot(of->linear[side], turning);
            }
        }
    }
    return work;
}

// The work of the drive: that of the mean forces at mid-step, and what is beyond.
static void find_drive_work(SpaceImpulseStep *step)
{
    step->drive_work = 0.0;
    if (step->driven < 0) {
        return;
    }
    const double rate = 1.0 / step->scheme.width_s;
    SpaceChange *loads = step->changes[0];
    space_response_load(step->response, step->scheme.total.impulse, loads);
    const SpaceChange *own = &loads[step->driven];
    const SpaceChange others = {
        vec3_add(step->on_driven.move, vec3_scale(rate, own->move)),
        vec3_add(step->on_driven.turn, vec3_scale(rate, own->turn)),
    };
    Vec3 force;
    step->drive_work =
        step->scheme.width_s *
        space_joints_drive(step->scenario, &step->middle[step->driven], &others, &force);
    for (size_t i = 0; i < step->place_count; i++) {
        step->drive_work += work_beyond(step, i);
    }
}

// Fills in the mean forces and the work of the drive for a step that has been taken.
static void space_impulse_means_find(SpaceImpulseStep *step)
{
    find_means(step);
    find_drive_work(step);
}

bool space_impulse_step_take(SpaceImpulseStep *step, Err *err)
{
    step->err = err;
    begin_step(step);
    if (!impulse_take_scheme(step->scenario, &step->scheme, err)) {
        return false;
    }
    space_impulse_means_find(step);
    return true;
}

// The state at a time inside a step.
//
// As ode/plane/impulse_inside.c has it; a body has turned since the start of the step by the vector
//     theta(t) = omega t + a t^2 / 2 + A Q(t)
// which is right to the order of the step, and ends where the step does.

// What impulses in the rows of play do to the speeds of an island's bodies.
static void push_scope(const SpaceImpulseStep *step, const ImpulseScope *scope,
                       const double *impulses, SpaceChange *changes)
{
    for (size_t n = 0; n < scope->body_count; n++) {
        changes[scope->bodies[n]] = (SpaceChange){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    }
    space_response_groups_apply(step->response, &step->groups, &scope->part, impulses, changes);
}

// What the contacts have done to the speeds and the positions of a scope's bodies up to a time.
static void push_bodies(const SpaceImpulseStep *step, const ImpulseScope *scope, double since_s,
                        const KernelSums *sums, SpaceChange *speeds, SpaceChange *places)
{
    if (scope->is_whole) {
        kernel_step_push(&step->scheme, since_s, sums, (double *)speeds, (double *)places);
        return;
    }
    push_scope(step, scope, sums->impulse, speeds);
    push_scope(step, scope, sums->moment, places);
}

// How the bodies move at a time within the step, from the contacts' sums up to then.
static void find_motions(const SpaceImpulseStep *step, const ImpulseScope *scope, double since_s,
                         const KernelSums *sums, SpaceMotion *motions)
{
    const KernelStep *scheme = &step->scheme;
    const KernelStepTime at = kernel_step_time(scheme, since_s);
    SpaceChange *speeds = step->changes[0];
    SpaceChange *places = step->changes[1];
    push_bodies(step, scope, since_s, sums, speeds, places);
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        const SpaceMotion *first = &step->before[i];
        const double *pushed = (const double *)&speeds[i];
        double *moved = (double *)&places[i];
        const SpaceChange going = {first->velocity, first->omega};
        SpaceChange now;
        for (size_t k = 0; k < COORDINATES; k++) {
            const size_t c = COORDINATES * i + k;
            const double speed = ((const double *)&going)[k];
            ((double *)&now)[k] = kernel_step_speed(scheme, c, at, speed, pushed[k]);
            moved[k] = kernel_step_way(scheme, c, at, speed, moved[k]);
        }
        motions[i] = *first;
        space_change(&motions[i], &places[i], NULL);
        motions[i].velocity = now.move;
        motions[i].omega = now.turn;
        motions[i].acceleration = motions[i].alpha = (Vec3){0.0, 0.0, 0.0};
    }
    if (scope->has_drive) {
        motions[step->driven] = space_driven(&step->scenario->linkage, scheme->start_s + since_s);
    }
}

// Takes the response where the bodies are, with the rows along the directions of mid-step.
static bool place_there(const SpaceImpulseStep *step, const SpaceMotion *motions)
{
    SpaceRow *rows = step->play_rows;
    for (size_t i = 0; i < step->place_count; i++) {
        const StopSpace *stop = space_impulse_step_stop(step, i);
        PinSpaceRows moved = step->rows[i];
        if (stop != NULL) {
            moved.rows[0] = stop_space_row(stop, &step->scenario->linkage, motions);
        } else {
            pin_space_rows_move(&step->places[i], motions, &moved);
        }
        memcpy(rows + step->scheme.kernel.contacts[i].first_row, moved.rows,
               moved.count * sizeof *rows);
    }
    return space_response_place(step->there, motions, rows);
}

// Fills in the accelerations: those beside the contacts', linear in time, and the contacts'. At a
// peak the response is taken where the bodies are; else, and of an island, at mid-step.
static void find_accelerations(const SpaceImpulseStep *step, const ImpulseScope *scope,
                               double since_s, bool is_peak, const KernelSums *sums,
                               SpaceMotion *motions)
{
    SpaceChange *rates = step->changes[0];
    const double off_middle_s = since_s - 0.5 * step->scheme.width_s;
    if (!scope->is_whole) {
        push_scope(step, scope, sums->force, rates);
    } else if (is_peak && place_there(step, motions)) {
        space_response_apply(step->there, sums->force, rates);
    } else {
        space_response_apply(step->response, sums->force, rates);
    }
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        if (space_impulse_step_is_free(step, i)) {
            SpaceChange beside;
            for (size_t k = 0; k < COORDINATES; k++) {
                ((double *)&beside)[k] =
                    kernel_step_beside(&step->scheme, COORDINATES * i + k, off_middle_s);
            }
            motions[i].acceleration = vec3_add(rates[i].move, beside.move);
            motions[i].alpha = vec3_add(rates[i].turn, beside.turn);
        }
    }
}

static Vec3 in_world(const PinSpaceRows *rows, Vec2 a)
{
    return vec3_add(vec3_scale(a.x, rows->across[0]), vec3_scale(a.y, rows->across[1]));
}

// The states of the joints with play, from the kernel.
static void find_pins(const SpaceImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                      const KernelSums *sums, SpaceJoints *joints)
{
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        if (i >= step->pin_count) {
            continue;
        }
        const PinSpace *place = &step->places[i];
        const PinSpaceRows *rows = &step->rows[i];
        JointState *plane = &joints->plane[place->joint];
        SpaceJointState *space = &joints->space[place->joint];
        const KernelPose pose =
            impulse_scope_pose(&step->scheme.kernel, step->scheme.islands, i, at, sums);
        Vec3 force = in_world(rows, pose.force);
        if (place->place == PIN_SPACE_COLLAR) {
            space_joints_press(joints, place, force, rows->across[0]);
            continue;
        }
        if (rows->count == PIN_SPACE_ROWS) {
            const double axial = sums->force[step->scheme.kernel.contacts[i].first_row + 4];
            force = vec3_add(force, vec3_scale(axial, rows->axis));
        }
        plane->is_touching = (place->place > 0 && plane->is_touching) || pose.is_touching;
        space->end_gaps[place->place] = pose.pose.gap;
        space->ends[place->place] = in_world(rows, pose.pose.eccentricity);
        space_joints_press(joints, place, force, rows->axis);
        if (place->place == 1) {
            // the middle of the pin's axis lies between its ends
            const Vec3 between = vec3_scale(0.5, vec3_add(space->ends[0], space->ends[1]));
            const Vec3 axial = vec3_scale(vec3_dot(space->offset, rows->axis), rows->axis);
            space->offset = vec3_add(between, axial);
            plane->eccentricity = (Vec2){space->offset.x, space->offset.y};
            plane->gap = fmin(space->end_gaps[0], space->end_gaps[1]);
        }
    }
}

// The states of limited joints: what presses at their ends, for what holds them beside is not told
// of them.
static void find_stops(const SpaceImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                       const KernelSums *sums, SpaceJoints *joints)
{
    const Linkage *linkage = &step->scenario->linkage;
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        const StopSpace *stop = space_impulse_step_stop(step, i);
        if (stop == NULL) {
            continue;
        }
        const KernelPose pose =
            impulse_scope_pose(&step->scheme.kernel, step->scheme.islands, i, at, sums);
        JointState *state = &joints->plane[stop->joint];
        if (i == step->pin_count || stop[-1].joint != stop->joint) {
            state->gap = INFINITY;
            state->force = 0.0;
            state->is_touching = false;
        }
        state->gap = fmin(state->gap, pose.pose.gap);
        state->is_touching = state->is_touching || pose.is_touching;
        state->force += pose.force.x;
        state->moment_on_b +=
            coordinate_sense(&linkage->joints[stop->joint]) * stop->sign * pose.force.x;
    }
}

// How the ideal joints of an island answer what its contacts do beyond their means.
static void add_answers(const SpaceImpulseStep *step, const ImpulseScope *scope,
                        const KernelSums *sums, Vec3 *forces)
{
    const SpaceResponse *response = step->response;
    const ResponseGroups *groups = &step->groups;
    double *beyond = step->play;
    for (size_t n = 0; n < scope->part.place_count; n++) {
        const KernelContact *joint = &step->scheme.kernel.contacts[scope->part.places[n]];
        for (size_t i = joint->first_row; i < joint->first_row + joint->row_count; i++) {
            beyond[i] = sums->force[i] - step->scheme.pressing[i];
        }
    }
    const double *all =
        space_response_groups_apply(response, groups, &scope->part, beyond, step->changes[0]);
    for (size_t n = 0; n < scope->part.group_count; n++) {
        const size_t group = scope->part.groups[n];
        for (size_t k = groups->first_node[group]; k < groups->first_node[group + 1]; k++) {
            const size_t *row = response->matrix.first_row + groups->nodes[k];
            for (size_t i = row[0]; i < row[1]; i++) {
                space_response_add_force(response, i, all[i], forces);
            }
        }
    }
}

// The force of the drive: what the ideal joints' answer and the contacts leave to it.
static void find_drive(const SpaceImpulseStep *step, const KernelSums *sums,
                       const double *reactions, const SpaceMotion *motions, SpaceJoints *joints)
{
    SpaceChange *loads = step->changes[0];
    space_response_load(step->response, sums->force, loads);
    SpaceChange *others = &loads[step->driven];
    others->move = vec3_add(others->move, step->on_driven.move);
    others->turn = vec3_add(others->turn, step->on_driven.turn);
    space_response_add_reactions(step->response, reactions, step->driven, others);
    Vec3 force;
    space_joints_drive(step->scenario, &motions[step->driven], others, &force);
    space_joints_hold(joints, (size_t)step->scenario->linkage.driver.joint, force);
}

// The forces of the ideal joints and of the drive: the means of the step, and how the joints answer
// what the contacts do beyond theirs. That of the drive hangs on all of them.
static void find_forces(const SpaceImpulseStep *step, const ImpulseScope *scope,
                        const KernelSums *sums, const SpaceMotion *motions, SpaceJoints *joints)
{
    const Linkage *linkage = &step->scenario->linkage;
    double *beyond = step->play;
    double *reactions = step->ideal;
    Vec3 *forces = step->forces;
    const bool is_of_all = scope->is_whole || scope->has_drive;
    if (is_of_all) {
        memcpy(forces, step->mean, linkage->joint_count * sizeof *forces);
        for (size_t i = 0; i < kernel_rows(&step->scheme.kernel); i++) {
            beyond[i] = sums->force[i] - step->scheme.pressing[i];
        }
        space_response_react(step->response, beyond, reactions);
        space_response_add_forces(step->response, reactions, forces);
    } else {
        for (size_t n = 0; n < scope->joint_count; n++) {
            forces[scope->joints[n]] = step->mean[scope->joints[n]];
        }
        add_answers(step, scope, sums, forces);
    }
    for (size_t n = 0; n < scope->joint_count; n++) {
        if (linkage_is_ideal(linkage, scope->joints[n])) {
            space_joints_hold(joints, scope->joints[n], forces[scope->joints[n]]);
        }
    }
    if (scope->has_drive) {
        find_drive(step, sums, reactions, motions, joints);
    }
}

void space_impulse_step_inside(const SpaceImpulseStep *step, const ImpulseScope *scope,
                               ImpulseTime at, const KernelSums *sums, SpaceMotion *motions,
                               SpaceJoints *joints)
{
    find_motions(step, scope, at.since_s, sums, motions);
    find_accelerations(step, scope, at.since_s, at.is_peak, sums, motions);
    for (size_t n = 0; n < scope->joint_count; n++) {
        space_joints_clear_one(joints, scope->joints[n]);
        // which of the angles that differ by turns
        joints->plane[scope->joints[n]].tilt = step->angles[scope->joints[n]];
        space_joints_place_one(step->response, motions, scope->joints[n], joints);
    }
    find_pins(step, scope, at, sums, joints);
    find_forces(step, scope, sums, motions, joints);
    find_stops(step, scope, at, sums, joints);
}
