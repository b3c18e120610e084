// Measures the error of the program that --code writes.
//
// libjointplay steps a world that knows no more than ODE says: its ideal joints drift and its
// impacts fall otherwise between the steps than in a run of the case. So the world of the program
// is built with the same calls in a process of its own, and held against the reference at exactly
// the times that the program prints.
#include "commands/tune/tune_program.h"
#include "base/clock.h"
#include "base/err.h"
#include "base/zeroed.h"
#include "commands/tune/tune_bodies.h"
#include "commands/tune/tune_bushings.h"
#include "commands/tune/tune_export.h"
#include "commands/tune/tune_rubs.h"
#include "commands/tune/tune_world.h"
#include "contact/damping.h"
#include "contact/law.h"
#include "measure/child.h"
#include "model/coordinate.h"
#include "model/scenario.h"
#include "ode/engine.h"
#include "run/registry.h"
#include "world/contact.h"

#include <assert.h>
#include <jointplay/jointplay.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct LibraryWorld {
    const Scenario *scenario;
    dWorldID world;
    dBodyID *bodies;       // owned; by body
    dJointID *joints;      // owned; by joint, NULL where it is none of ODE's
    dJointID *dampers;     // owned; by spring, NULL where it has none
    TuneBushing *bushings; // owned
    JpWorld *play;
    size_t steps;
} LibraryWorld;

static void library_world_close(LibraryWorld *world);

// Builds a case as a user of libjointplay would.
//
// The same calls, in the same order and with the same numbers, as tune_world.c, _joints.c and
// _forces.c write into a program: what is measured here is what the program does.

static dBodyID tune_program_body_of(const LibraryWorld *world, int body)
{
    return body == LINKAGE_GROUND ? NULL : world->bodies[body];
}

static void tune_program_make_body(LibraryWorld *world, int number)
{
    const Linkage *linkage = &world->scenario->linkage;
    const Body *body = &linkage->bodies[number];
    const bool is_led = tune_bodies_is_led(linkage, number);
    const Motion *start = &body->start;
    const Vec2 at = is_led ? linkage->joints[linkage->driver.joint].anchor_a : start->position;
    const Vec2 speed = is_led ? (Vec2){0.0, 0.0} : start->velocity;
    const dBodyID made = dBodyCreate(world->world);
    dMass in_plane;
    dMassSetParameters(&in_plane, body->mass, 0, 0, 0, body->inertia, body->inertia, body->inertia,
                       0, 0, 0);
    dBodySetMass(made, &in_plane);
    dBodySetPosition(made, at.x, at.y, 0);
    const dQuaternion turn = {cos(0.5 * start->angle), 0, 0, sin(0.5 * start->angle)};
    dBodySetQuaternion(made, turn);
    dBodySetLinearVel(made, speed.x, speed.y, 0);
    dBodySetAngularVel(made, 0, 0, start->omega);
    dBodySetFiniteRotationMode(made, 1);
    world->bodies[number] = made;
}

static void tune_program_make_ideal(LibraryWorld *world, int number, const Motion *motions)
{
    const Linkage *linkage = &world->scenario->linkage;
    const Joint *joint = &linkage->joints[number];
    int turned;
    int against;
    if (!tune_world_is_ideal(linkage, number)) {
        return;
    }
    linkage_turning(linkage, number, &turned, &against);
    dJointID made;
    if (joint_slides(joint->kind)) {
        const Vec2 along =
            vec2_scale(coordinate_sense(joint), joint_rows_along(linkage, motions, number));
        made = dJointCreateSlider(world->world, 0);
        dJointAttach(made, tune_program_body_of(world, turned),
                     tune_program_body_of(world, against));
        dJointSetSliderAxis(made, along.x, along.y, 0);
    } else {
        const Vec2 at = linkage_point(motions, joint->body_a, joint->anchor_a);
        made = dJointCreateHinge(world->world, 0);
        dJointAttach(made, tune_program_body_of(world, turned),
                     tune_program_body_of(world, against));
        dJointSetHingeAnchor(made, at.x, at.y, 0);
        dJointSetHingeAxis(made, 0, 0, 1);
    }
    world->joints[number] = made;
}

// The distance joint whose row a spring's damper is.
static void make_damper(LibraryWorld *world, size_t number, const Motion *motions)
{
    const Spring *spring = &world->scenario->linkage.springs[number];
    const int bodies[2] = {spring->body_a, spring->body_b};
    const Vec2 ends[2] = {spring->anchor_a, spring->anchor_b};
    const int first = spring->body_a == LINKAGE_GROUND ? 1 : 0;
    const dJointID made = dJointCreateDBall(world->world, 0);
    dJointAttach(made, tune_program_body_of(world, bodies[first]),
                 tune_program_body_of(world, bodies[1 - first]));
    const Vec2 from = linkage_point(motions, bodies[first], ends[first]);
    const Vec2 to = linkage_point(motions, bodies[1 - first], ends[1 - first]);
    dJointSetDBallAnchor1(made, from.x, from.y, 0);
    dJointSetDBallAnchor2(made, to.x, to.y, 0);
    world->dampers[number] = made;
}

static void make_motors(LibraryWorld *world, const Motion *motions)
{
    const Linkage *linkage = &world->scenario->linkage;
    const Driver *driver = &linkage->driver;
    const int driven = linkage_driven_body(linkage);
    if (tune_bodies_is_led(linkage, driven)) {
        dBodySetKinematic(world->bodies[driven]);
    } else if (driver->is_present) {
        dJointSetHingeParam(world->joints[driver->joint], dParamFMax, dInfinity);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        if (tune_world_has_effect(linkage, spring) && spring->damping > 0.0) {
            dJointSetHingeParam(world->joints[spring->joint], dParamFMax, dInfinity);
            dJointSetHingeParam(world->joints[spring->joint], dParamCFM, 2.0 / spring->damping);
        }
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        if (linkage->springs[i].damping > 0.0) {
            make_damper(world, i, motions);
        }
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const Bushing *bushing = &linkage->bushings[i];
        world->bushings[i] =
            tune_bushing_make(world->world, bushing, tune_program_body_of(world, bushing->body_a),
                              tune_program_body_of(world, bushing->body_b));
    }
}

// A point of a body, NULL being the world, and its velocity.
static void tune_program_find_end(dBodyID body, Vec2 local, dVector3 at, dVector3 velocity)
{
    memset(velocity, 0, sizeof(dVector3));
    at[0] = local.x;
    at[1] = local.y;
    if (body != NULL) {
        dBodyGetRelPointPos(body, local.x, local.y, 0, at);
        dBodyGetRelPointVel(body, local.x, local.y, 0, velocity);
    }
}

static void pull(const LibraryWorld *world, size_t number)
{
    const Linkage *linkage = &world->scenario->linkage;
    const Spring *spring = &linkage->springs[number];
    const dBodyID a = tune_program_body_of(world, spring->body_a);
    const dBodyID b = tune_program_body_of(world, spring->body_b);
    dVector3 from;
    dVector3 to;
    dVector3 v;
    dVector3 w;
    tune_program_find_end(a, tune_bodies_local(linkage, spring->body_a, spring->anchor_a), from, v);
    tune_program_find_end(b, tune_bodies_local(linkage, spring->body_b, spring->anchor_b), to, w);
    const double distance = hypot(to[0] - from[0], to[1] - from[1]);
    const double x = (to[0] - from[0]) / distance;
    const double y = (to[1] - from[1]) / distance;
    const double force = spring->stiffness * (distance - spring->length);
    if (a != NULL) {
        dBodyAddForceAtPos(a, force * x, force * y, 0, from[0], from[1], 0);
    }
    if (b != NULL) {
        dBodyAddForceAtPos(b, -force * x, -force * y, 0, to[0], to[1], 0);
    }
    const dJointID row = world->dampers[number];
    if (row != NULL) {
        const double rate = x * (w[0] - v[0]) + y * (w[1] - v[1]);
        const double gain = fmax(1, 2 * fabs(rate) / distance);
        dJointSetDBallParam(row, dParamERP, gain * world->scenario->run.step);
        dJointSetDBallParam(row, dParamCFM, 2 / spring->damping);
        dJointSetDBallDistance(row, distance - rate / gain);
    }
}

// Springs and a torque, where the step evaluates forces.
static void tune_program_push(dWorldID pushed, void *data)
{
    (void)pushed;
    const LibraryWorld *world = data;
    const Linkage *linkage = &world->scenario->linkage;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        pull(world, i);
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        tune_bushing_push(linkage, &linkage->bushings[i], &world->bushings[i],
                          world->scenario->run.step);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        const dJointID joint = world->joints[spring->joint];
        if (tune_world_has_effect(linkage, spring) && spring->stiffness > 0.0) {
            const double angle = spring->angle - tune_world_angle_at_start(linkage, spring->joint);
            dJointAddHingeTorque(joint, spring->stiffness * (angle - dJointGetHingeAngle(joint)));
        }
    }
    const Torque *torque = &linkage->torque;
    if (torque->table.count > 0) {
        const double middle_s = ((double)world->steps + 0.5) * world->scenario->run.step;
        const double value = time_table_at(&torque->table, middle_s);
        const dJointID joint = world->joints[torque->joint];
        if (joint_has_angle(linkage->joints[torque->joint].kind)) {
            dJointAddHingeTorque(joint, value);
        } else {
            dJointAddSliderForce(joint, value);
        }
    }
}

// What is set before each step.
static void drive(const LibraryWorld *world)
{
    const Linkage *linkage = &world->scenario->linkage;
    const double end_s = ((double)world->steps + 1.0) * world->scenario->run.step;
    if (linkage->driver.table.count > 0) {
        dJointSetHingeParam(world->joints[linkage->driver.joint], dParamVel,
                            time_table_at(&linkage->driver.table, end_s));
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        const dJointID joint = world->joints[spring->joint];
        if (tune_world_has_effect(linkage, spring) && spring->damping > 0.0) {
            dJointSetHingeParam(joint, dParamVel, -dJointGetHingeAngleRate(joint));
        }
    }
}

// A coarse step is no failure: the search judges by the error of the whole run.
static bool accept(JpStatus status, const JpError *error, Err *err)
{
    return status <= JP_OK || err_set(err, ERR_SOLVER, "libjointplay: %s", error->text);
}

static bool tune_program_fill_contact(const Scenario *scenario, const Joint *joint,
                                      JpContact *contact, Err *err)
{
#define LIBRARY_DAMPING(name, ...) JP_DAMPING_##name,
    static const JpDamping DAMPINGS[] = {OPTIONS_DAMPING_LIST(LIBRARY_DAMPING)};
    const ContactOptions own = law_options(&scenario->contact, joint);
    ForceLaw law;
    if (!law_of_joint(scenario, joint, &law, err)) {
        return false;
    }
    contact_set_elastic(&law, contact);
    contact->damping = DAMPINGS[own.damping];
    contact->damper = law.viscous;
    contact->full_damping_depth = law.full_damping_depth;
    if (own.damping == DAMPING_DISSIPATION) {
        contact->dissipation = law_dissipation(&law);
        return true;
    } else if (damping_restores(own.damping)) {
        contact->restitution = own.restitution;
    }
    contact->speed_floor = law.impact_speed_floor;
    contact->resting_speed = law.resting_speed;
    return true;
}

// Hands on what the contacts of a joint carry at the start.
static bool begin_contacts(const Joint *joint, JpJoint *made, Err *err)
{
    for (size_t i = 0; i < JOINT_PLACES; i++) {
        const ContactState *state = &joint->contacts[i];
        const JpBegun begun = {
            .impact_speed = state->impact_speed,
            .age = state->age_s,
            .is_released = state->is_released,
            .is_resting = state->is_resting,
        };
        JpError error;
        if (state->is_touching && !accept(jp_joint_begun(made, i, &begun, &error), &error, err)) {
            return false;
        }
    }
    return true;
}

static bool make_pin(LibraryWorld *world, int number, Err *err)
{
    const Scenario *scenario = world->scenario;
    const Linkage *linkage = &scenario->linkage;
    const Joint *joint = &linkage->joints[number];
    const Vec2 hole = tune_bodies_local(linkage, joint->body_a, joint->anchor_a);
    const Vec2 centre = tune_bodies_local(linkage, joint->body_b, joint->anchor_b);
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = joint->clearance.hole_radius;
    pin.pin_radius = joint->clearance.pin_radius;
    pin.hole[0] = hole.x;
    pin.hole[1] = hole.y;
    pin.pin[0] = centre.x;
    pin.pin[1] = centre.y;
    const ContactOptions contact = law_options(&scenario->contact, joint);
    if (contact.friction > 0.0) {
        pin.friction = contact.friction;
        pin.friction_speed = contact.friction_speed;
        pin.friction_law =
            contact.friction_law == BRISTLE_STICK ? JP_FRICTION_STICK : JP_FRICTION_REGULARIZED;
        pin.presliding = contact.presliding;
        pin.breakaway_ratio = contact.breakaway_ratio;
        pin.presliding_damping = contact.presliding_damping;
        pin.presliding_mass = tune_bodies_bristle_mass(linkage, joint);
    }
    JpError error;
    JpJoint *made;
    return tune_program_fill_contact(scenario, joint, &pin.contact, err) &&
           accept(jp_pin_create(world->play, tune_program_body_of(world, joint->body_a),
                                tune_program_body_of(world, joint->body_b), &pin, &made, &error),
                  &error, err) &&
           begin_contacts(joint, made, err);
}

static bool make_limits(LibraryWorld *world, int number, const Motion *motions, Err *err)
{
    const Scenario *scenario = world->scenario;
    const Joint *joint = &scenario->linkage.joints[number];
    const double start = coordinate_position(&scenario->linkage, motions, number);
    JpError error;
    JpJoint *made;
    if (joint->limits.kind == LIMIT_BACKLASH) {
        JpBacklash backlash = jp_backlash_default();
        backlash.gap = joint->limits.backlash;
        backlash.offset = joint->limits.middle - start;
        return tune_program_fill_contact(scenario, joint, &backlash.tooth, err) &&
               accept(
                   jp_backlash_create(world->play, world->joints[number], &backlash, &made, &error),
                   &error, err) &&
               begin_contacts(joint, made, err);
    }
    JpStops stops = jp_stops_default();
    stops.low = joint->limits.low - start;
    stops.high = joint->limits.high - start;
    return tune_program_fill_contact(scenario, joint, &stops.contact, err) &&
           accept(jp_stops_create(world->play, world->joints[number], &stops, &made, &error),
                  &error, err) &&
           begin_contacts(joint, made, err);
}

static bool make_play(LibraryWorld *world, const Motion *motions, Err *err)
{
    const Scenario *scenario = world->scenario;
    const Linkage *linkage = &scenario->linkage;
    const bool is_impulse = scenario_integrates_contacts(scenario);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = is_impulse                            ? JP_STEPPING_IMPULSE
                       : scenario->ode.stepping == ODE_PLAIN ? JP_STEPPING_PLAIN
                                                             : JP_STEPPING_STAGGERED;
    if (scenario->ode.solver == ODE_QUICK && !is_impulse) {
        options.is_quick = true;
        dWorldSetQuickStepNumIterations(world->world, (int)scenario->ode.iterations);
        dWorldSetQuickStepW(world->world, scenario->ode.over_relaxation);
    }
    if (tune_world_pushes(linkage)) {
        options.collide = tune_program_push;
        options.collide_data = world;
    }
    JpError error;
    bool is_made =
        accept(jp_world_create(world->world, &options, &world->play, &error), &error, err);
    for (int i = 0; i < (int)linkage->joint_count && is_made; i++) {
        const Joint *joint = &linkage->joints[i];
        is_made = joint_has_hole(joint->kind)        ? make_pin(world, i, err)
                  : joint->limits.kind != LIMIT_NONE ? make_limits(world, i, motions, err)
                                                     : true;
    }
    for (int i = 0; i < (int)linkage->joint_count && is_made; i++) {
        JpFriction friction;
        JpJoint *made;
        is_made =
            !tune_rubs_find(scenario, i, &friction) ||
            accept(jp_friction_create(world->play, world->joints[i], &friction, &made, &error),
                   &error, err);
    }
    for (size_t i = 0; i < linkage->body_count && is_made; i++) {
        is_made = accept(jp_world_add_body(world->play, world->bodies[i], &error), &error, err);
    }
    return is_made;
}

// The world of a planar scenario that tune_world_lacks finds nothing wrong with, at its start.
// Fails with ERR_CASE where a law does not fit its joint, and with ERR_SOLVER where the library
// refuses; closed all the same.
static bool library_world_open(const Scenario *scenario, LibraryWorld *world, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    engine_start();
    engine_seed(0); // that of a process which has just begun
    *world = (LibraryWorld){
        .scenario = scenario,
        .world = dWorldCreate(),
        .bodies = zeroed(linkage->body_count, sizeof(dBodyID)),
        .joints = zeroed(linkage->joint_count, sizeof(dJointID)),
        .dampers = zeroed(linkage->spring_count, sizeof(dJointID)),
        .bushings = zeroed(linkage->bushing_count, sizeof(TuneBushing)),
    };
    dWorldSetGravity(world->world, 0.0 + scenario->gravity.x, 0.0 + scenario->gravity.y, 0);
    dWorldSetERP(world->world,
                 scenario->ode.stepping == ODE_PLAIN ? scenario->ode.erp : TUNE_WORLD_ERP);
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    for (int i = 0; i < (int)linkage->body_count; i++) {
        tune_program_make_body(world, i);
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        tune_program_make_ideal(world, i, motions);
    }
    make_motors(world, motions);
    const bool is_made = make_play(world, motions, err);
    free(motions);
    if (!is_made) {
        library_world_close(world);
    }
    return is_made;
}

// Steps by the scenario's step. Fails with ERR_SOLVER.
static bool library_world_step(LibraryWorld *world, Err *err)
{
    JpError error;
    drive(world);
    if (!accept(jp_world_step(world->play, world->scenario->run.step, &error), &error, err)) {
        return false;
    }
    world->steps++;
    return true;
}

// Where all bodies stand and how fast they move, without accelerations.
static void library_world_motions(const LibraryWorld *world, Motion *motions)
{
    const Linkage *linkage = &world->scenario->linkage;
    for (int i = 0; i < (int)linkage->body_count; i++) {
        const dReal *at = dBodyGetPosition(world->bodies[i]);
        const dReal *velocity = dBodyGetLinearVel(world->bodies[i]);
        const dReal *turn = dBodyGetQuaternion(world->bodies[i]);
        motions[i] = (Motion){
            .position = {at[0], at[1]},
            .angle = 2.0 * atan2(turn[3], turn[0]),
            .velocity = {velocity[0], velocity[1]},
            .omega = dBodyGetAngularVel(world->bodies[i])[2],
        };
        if (tune_bodies_is_led(linkage, i)) {
            // from its pivot to its centre
            const Vec2 arm =
                vec2_rotate(motions[i].angle, tune_bodies_local(linkage, i, (Vec2){0.0, 0.0}));
            motions[i].position = vec2_add(motions[i].position, arm);
            motions[i].velocity = vec2_scale(motions[i].omega, vec2_perp(arm));
        }
    }
}

static void library_world_close(LibraryWorld *world)
{
    jp_world_destroy(world->play);
    dWorldDestroy(world->world);
    free(world->bodies);
    free(world->joints);
    free(world->dampers);
    free(world->bushings);
    *world = (LibraryWorld){.scenario = NULL};
}

// shorter steps that are tried: a decade of the grid and a half
enum { SHORTER_MOST = 15 };

// the tolerance of the reference, over the case's: its samples are few, so that it costs little
static const double TIGHTER = 0.01;

static const RunWatch NOBODY = {NULL, NULL};

// The world as a solver for run_motion, which looks at the ends of steps alone.
typedef struct Stepping {
    LibraryWorld world;
    Motion *before; // owned; at the start of the last step
} Stepping;

static void close_world(void *state)
{
    Stepping *stepping = state;
    library_world_close(&stepping->world);
    free(stepping->before);
    free(stepping);
}

static bool open_world(const Scenario *scenario, void **state, Err *err)
{
    Stepping *stepping = calloc(1, sizeof *stepping);
    assert(stepping != NULL);
    if (!library_world_open(scenario, &stepping->world, err)) {
        free(stepping);
        return false;
    }
    stepping->before = calloc(scenario->linkage.body_count, sizeof *stepping->before);
    assert(stepping->before != NULL);
    *state = stepping;
    return true;
}

static bool tune_program_stride(void *state, double stop_s, double *end_s, Err *err)
{
    (void)stop_s;
    Stepping *stepping = state;
    library_world_motions(&stepping->world, stepping->before);
    if (!library_world_step(&stepping->world, err)) {
        return false;
    }
    *end_s = (double)stepping->world.steps * stepping->world.scenario->run.step;
    return true;
}

static void glance(const void *state, double time_s, Sample *sample)
{
    const Stepping *stepping = state;
    const Scenario *scenario = stepping->world.scenario;
    const double middle_s = ((double)stepping->world.steps - 0.5) * scenario->run.step;
    if (time_s < middle_s) {
        memcpy(sample->bodies, stepping->before,
               scenario->linkage.body_count * sizeof *sample->bodies);
    } else {
        library_world_motions(&stepping->world, sample->bodies);
    }
}

// Steps of ODE's world, trials included, and those that fell back to another way.
static SolverModel model_world(const void *state)
{
    const Stepping *stepping = state;
    JpWorldStats stats = {0};
    jp_world_stats(stepping->world.play, &stats, NULL);
    return (SolverModel){
        .label = "libjointplay",
        .step_s = stepping->world.scenario->run.step,
        .steps = stats.world_steps,
        .fallback_rows = stats.fallbacks,
    };
}

static const Solver LIBRARY = {
    .name = "libjointplay",
    .open = open_world,
    .stride = tune_program_stride,
    .glance = glance,
    .model = model_world,
    .close = close_world,
};

const Solver *tune_program_solver(void)
{
    return &LIBRARY;
}

// A setting with which the program could be written: its trial, and the case with it.
typedef struct Candidate {
    int trial;
    Scenario scenario;
} Candidate;

typedef struct Measuring {
    const TuneSearch *search;
    const Candidate *candidates; // the cheapest of the search first
    size_t count;
    bool may_shorten;
    bool is_begun;
    TuneProgram *program;
} Measuring;

// The error of the world against the reference at the times that the program prints.
static LadderRun tune_program_compare(const Tune *tune, const Scenario *printed,
                                      TuneProgram *program)
{
    LadderRun run = {.kind = LADDER_ERROR};
    const double started_s = clock_processor_s();
    Trajectory *own = run_motion(printed, &LIBRARY, NOBODY);
    program->processor_s = clock_processor_s() - started_s;
    Scenario finer = *printed;
    finer.reference.tolerance = TIGHTER * law_reference_tolerance(printed);
    Trajectory *truth = run_motion(&finer, registry_solver(BACKEND_REFERENCE), NOBODY);
    const Trajectory *failed = !own->is_complete ? own : truth;
    run.is_complete = own->is_complete && truth->is_complete;
    snprintf(run.message, sizeof run.message, "%.*s", LADDER_MESSAGE_SIZE - 1, failed->message);
    if (run.is_complete) {
        run.error =
            error_against(own, truth, tune->truth.is_limited ? tune->truth.horizon_s : INFINITY);
    }
    trajectory_destroy(truth);
    trajectory_destroy(own);
    return run;
}

// The program of a setting at a step; its error is NAN where it has none, for the reason there.
static TuneProgram tune_program_measure(const Measuring *measuring, const Candidate *candidate,
                                        double step_s)
{
    const Tune *tune = measuring->search->tune;
    TuneProgram program = {.is_run = true, .trial = candidate->trial, .step_s = step_s};
    Scenario printed = candidate->scenario;
    printed.run.step = step_s;
    printed.run.interval = tune_world_every(&printed) * step_s;
    program.steps = tune_world_steps(&printed);
    const LadderRun run = tune_program_compare(tune, &printed, &program);
    program.error = tune_error(tune, &run, program.reason);
    program.meets = program.error + tune->truth.uncertainty <= tune->target;
    return program;
}

// Whether a program is to be preferred to another: it meets the target for less, or comes nearer.
static bool is_better(const Tune *tune, const TuneProgram *program, const TuneProgram *than)
{
    if (program->meets != than->meets) {
        return program->meets;
    }
    if (program->meets) {
        return tune->cost == TUNE_STEPS ? program->steps < than->steps
                                        : program->processor_s < than->processor_s;
    }
    return !isnan(program->error) && !(program->error >= than->error);
}

// From coarse to fine, until two neighbours meet the target: an error that is small by luck is no
// basis for a program. `best` is what other settings come to; what costs more is left.
static TuneProgram search_steps(const Measuring *measuring, const Candidate *candidate,
                                const TuneProgram *best)
{
    const Tune *tune = measuring->search->tune;
    const double first_s = candidate->scenario.run.step;
    const TuneProgram first = tune_program_measure(measuring, candidate, first_s);
    TuneProgram found = first;
    TuneProgram last = first;
    int index = tune_index_below(first_s);
    index += tune_value(index) < first_s ? 0 : 1;
    for (int i = 0; i < SHORTER_MOST && measuring->may_shorten; i++, index++) {
        if (best->meets && !is_better(tune, &last, best) && last.processor_s > best->processor_s) {
            break;
        }
        const TuneProgram next = tune_program_measure(measuring, candidate, tune_value(index));
        if (last.meets && next.meets) {
            found = last;
            break;
        }
        last = next;
        found = is_better(tune, &next, &found) || next.meets ? next : found;
    }
    found.step_first_s = first_s;
    found.error_first = first.error;
    return found;
}

// In the child.
static void work(const void *context, void *result)
{
    const Measuring *measuring = context;
    TuneProgram *program = result;
    for (size_t i = 0; i < measuring->count; i++) {
        const TuneProgram own = search_steps(measuring, &measuring->candidates[i], program);
        if (i == 0 || is_better(measuring->search->tune, &own, program)) {
            *program = own;
        }
    }
}

static bool tune_program_next(void *owner, size_t *number, const void **context)
{
    Measuring *measuring = owner;
    const bool is_first = !measuring->is_begun;
    measuring->is_begun = true;
    *number = 0;
    *context = measuring;
    return is_first;
}

static bool tune_program_take(void *owner, size_t number, const void *result, const Child *child,
                              Err *err)
{
    (void)number;
    (void)err;
    const Measuring *measuring = owner;
    TuneProgram *program = measuring->program;
    if (child->end == CHILD_DONE) {
        *program = *(const TuneProgram *)result;
        return true;
    }
    char words[CHILD_TEXT_SIZE];
    child_describe(child, words);
    snprintf(program->reason, sizeof program->reason, "its process %s", words);
    return true;
}

static bool tune_program_wait(void *owner)
{
    const TuneSearch *search = ((const Measuring *)owner)->search;
    search->wait("running the program of --code", INFINITY, search->context);
    return true;
}

// Whether the library steps two cases in the same way: it chooses its rows' map by itself, and an
// impulse needs no solver of ODE's.
static bool is_stepped_alike(const Scenario *a, const Scenario *b)
{
    const bool is_impulse = scenario_integrates_contacts(a);
    return a->ode.stepping == b->ode.stepping && is_impulse == scenario_integrates_contacts(b) &&
           (is_impulse || a->ode.solver == b->ode.solver);
}

// The settings that a program can have, each way of stepping once. Fails with ERR_SOLVER where one
// that chooses its step finds none.
static bool list_candidates(const TuneReport *report, Candidate *candidates, size_t *count,
                            Err *err)
{
    int trials[SCHEME_MAX];
    const size_t trial_count = tune_export_trials(report, trials);
    *count = 0;
    for (size_t i = 0; i < trial_count; i++) {
        Candidate *candidate = &candidates[*count];
        candidate->trial = trials[i];
        if (!tune_export_scenario(report, trials[i], &candidate->scenario, err)) {
            return false;
        }
        bool is_new = true;
        for (size_t k = 0; k < *count; k++) {
            is_new = is_new && !is_stepped_alike(&candidates[k].scenario, &candidate->scenario);
        }
        *count += is_new ? 1 : 0;
    }
    return true;
}

static bool run_candidates(const TuneSearch *search, const TuneReport *report,
                           Candidate *candidates, Err *err)
{
    TuneProgram *program = &search->tune->program;
    Measuring measuring = {
        .search = search,
        .candidates = candidates,
        .may_shorten = tune_report_is_met(report) && search->tune->held_s == 0.0,
        .program = program,
    };
    if (!list_candidates(report, candidates, &measuring.count, err)) {
        return false;
    }
    if (measuring.count == 0) {
        return true;
    }
    *program = (TuneProgram){.is_run = true,
                             .trial = candidates[0].trial,
                             .step_first_s = candidates[0].scenario.run.step,
                             .step_s = candidates[0].scenario.run.step,
                             .error_first = NAN,
                             .error = NAN};
    const Pool pool = {
        .jobs = 1,
        .work = work,
        .result_size = sizeof(TuneProgram),
        .limits = {.time_s = (1 + SHORTER_MOST) * search->time_limit_s,
                   .memory_bytes = TASK_MEMORY_LIMIT},
        .next = tune_program_next,
        .take = tune_program_take,
        .wait = tune_program_wait,
        .owner = &measuring,
    };
    return pool_run(&pool, err);
}

bool tune_program_run(const TuneSearch *search, const TuneReport *report, Err *err)
{
    Candidate *candidates = zeroed(SCHEME_MAX, sizeof *candidates);
    const bool is_done = run_candidates(search, report, candidates, err);
    free(candidates);
    return is_done;
}
