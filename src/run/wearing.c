// Sums up what wears the pins of a run, from inside its steps.
//
// With the force F of the hole on the pin, its part T along the wall and the velocity v at which
// the pin slides on the wall, over the reported time in which they touch:
//     contact   integral dt            distance  integral |v| dt      worn  integral F |v| dt
//     force     integral F dt          friction  integral -T . v dt
// A contact begins and ends with a step, however short it is, and in between the solver's states
// are smooth: Gauss's rule of five nodes, exact up to degree 9, takes each step. A step whose
// values are means over it counts with these.
// In space a pin presses at both ends of its hole, each of which has its own F, v and place on the
// wall. There |F| = N sqrt(1 + r^2) with T = r N, r = mu tanh(|v| / v_s) (kernel/friction_law.h).
// Collars are not told of: they press along the axis.
#include "run/wearing.h"

#include "base/zeroed.h"
#include "contact/pin_space.h"
#include "contact/touch.h"
#include "kernel/friction_law.h"

#include <math.h>
#include <stdlib.h>

enum { GAUSS_NODES = 5 };

// of half a step from its middle, and the weights of half its width; Abramowitz and Stegun,
// Handbook of Mathematical Functions, 1964, table 25.4
static const double GAUSS_AT[GAUSS_NODES] = {-0.906179845938663993, -0.538469310105683091, 0.0,
                                             0.538469310105683091, 0.906179845938663993};
static const double GAUSS_WEIGHTS[GAUSS_NODES] = {0.236926885056189088, 0.478628670499366468,
                                                  0.568888888888888889, 0.478628670499366468,
                                                  0.236926885056189088};

// One place of the wall at an instant.
typedef struct WornPlace {
    double force;          // N
    double speed;          // m/s
    double friction_power; // W
    double angle;          // rad, where it is pressed
} WornPlace;

// The joints of a record that one look is for.
typedef struct WearingScope {
    const StepRecord *step;
    const SolverSome *some; // NULL: all
} WearingScope;

struct Wearing {
    const Scenario *scenario;
    const Solver *solver;
    const void *state;
    JointWear *wear;    // of the trajectory, by joint
    bool *has_place;    // by joint: whether it is a pin in a hole; owned, as all that follow
    Touch *places;      // by joint, in the plane
    PinSpace *ends;     // of all pins, joint by joint, in space
    size_t *first_end;  // by joint
    bool *was_touching; // by joint, in its last record
    double *recorded_s; // by joint, the end of that
    Sample sample;
};

// Finds the places of all pins; false where there is none.
static bool find_pins(Wearing *wearing)
{
    const Linkage *linkage = &wearing->scenario->linkage;
    size_t count = 0;
    Err unused = {0};
    if (linkage->is_spatial) {
        wearing->ends = pin_space_list(wearing->scenario, &count, &unused);
        for (size_t i = count; wearing->ends != NULL && i-- > 0;) {
            wearing->first_end[wearing->ends[i].joint] = i;
            wearing->has_place[wearing->ends[i].joint] = true;
        }
        return wearing->ends != NULL && count > 0;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        Touch places[TOUCH_CORNERS];
        if (linkage_has_play(joint) && joint_has_hole(joint->kind) &&
            touch_places(linkage, (int)i, places) > 0) {
            wearing->places[i] = places[0];
            wearing->has_place[i] = true;
            count++;
        }
    }
    return count > 0;
}

Wearing *wearing_start(const Scenario *scenario, const Solver *solver, const void *state,
                       Trajectory *trajectory)
{
    const size_t joints = scenario->linkage.joint_count;
    if (solver->is_ideal) {
        return NULL;
    }
    Wearing *wearing = zeroed(1, sizeof *wearing);
    *wearing = (Wearing){
        .scenario = scenario,
        .solver = solver,
        .state = state,
        .has_place = zeroed(joints, sizeof *wearing->has_place),
        .places = zeroed(joints, sizeof *wearing->places),
        .first_end = zeroed(joints, sizeof *wearing->first_end),
        .was_touching = zeroed(joints, sizeof *wearing->was_touching),
        .recorded_s = zeroed(joints, sizeof *wearing->recorded_s),
        .sample = sample_create(&scenario->linkage),
    };
    if (!find_pins(wearing)) {
        wearing_finish(wearing);
        return NULL;
    }
    trajectory->wear = zeroed(joints, sizeof *trajectory->wear);
    wearing->wear = trajectory->wear;
    return wearing;
}

void wearing_finish(Wearing *wearing)
{
    if (wearing == NULL) {
        return;
    }
    free(wearing->has_place);
    free(wearing->places);
    free(wearing->ends);
    free(wearing->first_end);
    free(wearing->was_touching);
    free(wearing->recorded_s);
    sample_free(&wearing->sample);
    free(wearing);
}

static WornPlace place_in_plane(const Wearing *wearing, size_t joint, const TouchPose *pose,
                                const JointState *state)
{
    const Linkage *linkage = &wearing->scenario->linkage;
    const Motion *motions = wearing->sample.bodies;
    const int hole = linkage->joints[joint].body_a;
    const double turned = hole == LINKAGE_GROUND ? 0.0 : motions[hole].angle;
    const Vec2 at = vec2_rotate(-turned, state->eccentricity);
    const double sliding = touch_sliding(linkage, &wearing->places[joint], pose, motions);
    const double along = vec2_dot(vec2_perp(pose->normal), state->force_on_b);
    return (WornPlace){
        .force = state->force,
        .speed = fabs(sliding),
        .friction_power = -along * sliding,
        .angle = atan2(at.y, at.x),
    };
}

// Where on the wall a hole is pressed: about its axis, from its body's x axis on, or where it lies
// along that from the y axis.
static double angle_in_hole(const PinSpace *end, const SpaceMotion *motions, Vec3 outwards)
{
    const Vec3 axis = space_direction(motions, end->hole.body, end->hole.axis);
    const Vec3 zero = space_direction(motions, end->hole.body, vec3_normal_to(end->hole.axis));
    return atan2(vec3_dot(outwards, vec3_cross(axis, zero)), vec3_dot(outwards, zero));
}

static WornPlace place_at_end(const Wearing *wearing, const PinSpace *end, const PinSpacePose *pose,
                              double force)
{
    const SpaceMotion *motions = wearing->sample.space_bodies;
    const double radius = wearing->scenario->linkage.joints[end->joint].clearance.hole_radius;
    // the points of both bodies at the wall
    const Vec3 at = vec3_sub(pose->at_a, vec3_scale(radius, pose->normal));
    const Vec3 relative = vec3_sub(space_velocity_at(motions, end->pin.body, at),
                                   space_velocity_at(motions, end->hole.body, at));
    const double speed = vec3_length(vec3_across(relative, pose->normal));
    const double held = end->law.friction > 0.0
                            ? end->law.friction * friction_hold(speed, end->law.friction_speed).held
                            : 0.0;
    return (WornPlace){
        .force = force,
        .speed = speed,
        .friction_power = held / sqrt(1.0 + held * held) * force * speed,
        .angle = angle_in_hole(end, motions, vec3_scale(-1.0, pose->normal)),
    };
}

static size_t sector_of(double angle)
{
    const double turn = angle / (2.0 * M_PI);
    const size_t sector = (size_t)((turn - floor(turn)) * WEAR_SECTORS);
    return sector < WEAR_SECTORS ? sector : 0;
}

// Adds a place of a joint, of whose sliding distance it has a share.
static void add_place(JointWear *wear, const WornPlace *place, double weight_s, double share)
{
    const double worn = weight_s * place->force * place->speed;
    wear->force += weight_s * place->force;
    wear->distance += share * weight_s * place->speed;
    wear->friction += weight_s * place->friction_power;
    wear->worn += worn;
    wear->sectors[sector_of(place->angle)] += worn;
}

static void add_in_plane(Wearing *wearing, size_t joint, const JointState *state, double weight_s)
{
    const TouchPose pose =
        touch_pose(&wearing->scenario->linkage, &wearing->places[joint], wearing->sample.bodies);
    if (state->is_touching && pose.has_normal) {
        const WornPlace place = place_in_plane(wearing, joint, &pose, state);
        wearing->wear[joint].contact += weight_s;
        add_place(&wearing->wear[joint], &place, weight_s, 1.0);
    }
}

// Both ends of a pin in space; how far it slides is the mean of those that press, by their forces.
static void add_in_space(Wearing *wearing, size_t joint, bool is_touching,
                         const SpaceJointState *state, double weight_s)
{
    const double force = state->end_forces[0] + state->end_forces[1];
    if (!is_touching || !(force > 0.0)) {
        return;
    }
    wearing->wear[joint].contact += weight_s;
    for (size_t i = 0; i < PIN_SPACE_ENDS; i++) {
        const PinSpace *end = &wearing->ends[wearing->first_end[joint] + i];
        const PinSpacePose pose = pin_space_pose(end, wearing->sample.space_bodies);
        if (state->end_forces[i] > 0.0 && pose.has_normal) {
            const WornPlace place = place_at_end(wearing, end, &pose, state->end_forces[i]);
            add_place(&wearing->wear[joint], &place, weight_s, state->end_forces[i] / force);
        }
    }
}

// The place of a body in a record; of one that is not in it the number of its bodies.
static size_t body_in(const SolverPart *part, const Linkage *linkage, int body)
{
    const size_t count = solver_body_count(part, linkage);
    size_t k = 0;
    while (k < count && solver_body(part, k) != (size_t)body) {
        k++;
    }
    return k;
}

// Adds a joint of a record, by its place there, as the last look has it or, of a step of means, as
// the record has.
static void add_joint(Wearing *wearing, const StepRecord *step, size_t index, double weight_s)
{
    const size_t joint = solver_joint(step->part, index);
    const Sample *sample = &wearing->sample;
    const JointState *state = step->is_mean ? &step->joints[index] : &sample->joints[joint];
    if (wearing->ends == NULL) {
        add_in_plane(wearing, joint, state, weight_s);
        return;
    }
    add_in_space(wearing, joint, state->is_touching,
                 step->is_mean ? &step->space_joints[index] : &sample->space_joints[joint],
                 weight_s);
}

static bool is_worn(const Wearing *wearing, const StepRecord *step, size_t index)
{
    const size_t joint = solver_joint(step->part, index);
    return wearing->has_place[joint] &&
           (step->joints[index].is_touching || wearing->was_touching[joint]);
}

// Looks into a step from one time to another, at joints of the record: one, or all (NULL).
static void look_into(Wearing *wearing, const StepRecord *step, const SolverSome *some,
                      double start_s, double end_s)
{
    const size_t count =
        some != NULL ? 1 : solver_joint_count(step->part, &wearing->scenario->linkage);
    const double half_s = 0.5 * (end_s - start_s);
    const size_t nodes = step->is_mean ? 1 : GAUSS_NODES;
    for (size_t n = 0; n < nodes; n++) {
        const double time_s =
            step->is_mean ? step->joint_s : start_s + half_s * (1.0 + GAUSS_AT[n]);
        const double weight_s = step->is_mean ? 2.0 * half_s : half_s * GAUSS_WEIGHTS[n];
        solver_look(wearing->solver, wearing->state, time_s, step->part, some, &wearing->sample);
        for (size_t k = 0; k < count; k++) {
            const size_t index = some != NULL ? some->joints[0] : k;
            if (is_worn(wearing, step, index)) {
                add_joint(wearing, step, index, weight_s);
            }
        }
    }
}

// A joint that has changed in a record, from when it was in one last.
static void add_one(Wearing *wearing, const StepRecord *step, size_t index, double start_s)
{
    const Linkage *linkage = &wearing->scenario->linkage;
    const Joint *joint = &linkage->joints[solver_joint(step->part, index)];
    const int bodies[2] = {joint->body_a, joint->body_b};
    size_t places[2];
    SolverSome one = {.joint_count = 1, .bodies = places, .joints = &index};
    for (size_t side = 0; side < 2; side++) {
        if (bodies[side] != LINKAGE_GROUND) {
            places[one.body_count++] = body_in(step->part, linkage, bodies[side]);
        }
    }
    look_into(wearing, step, &one, start_s, step->end_s);
}

static bool is_any_worn(const Wearing *wearing, const StepRecord *step)
{
    const size_t count = solver_joint_count(step->part, &wearing->scenario->linkage);
    bool is_any = false;
    for (size_t k = 0; k < count && !is_any; k++) {
        is_any = is_worn(wearing, step, k);
    }
    return is_any;
}

static void note(Wearing *wearing, const StepRecord *step, size_t index)
{
    const size_t joint = solver_joint(step->part, index);
    wearing->was_touching[joint] = step->joints[index].is_touching;
    wearing->recorded_s[joint] = step->end_s;
}

void wearing_add(Wearing *wearing, const StepRecord *step)
{
    if (wearing == NULL) {
        return;
    }
    const double from_s = scenario_report_from(wearing->scenario);
    if (step->changed == NULL) {
        const double start_s = fmax(step->start_s, from_s);
        if (step->end_s > start_s && is_any_worn(wearing, step)) {
            look_into(wearing, step, NULL, start_s, step->end_s);
        }
        for (size_t k = 0; k < solver_joint_count(step->part, &wearing->scenario->linkage); k++) {
            note(wearing, step, k);
        }
        return;
    }
    for (size_t n = 0; n < step->changed->joint_count; n++) {
        const size_t index = step->changed->joints[n];
        const double start_s = fmax(wearing->recorded_s[solver_joint(step->part, index)], from_s);
        if (step->end_s > start_s && is_worn(wearing, step, index)) {
            add_one(wearing, step, index, start_s);
        }
        note(wearing, step, index);
    }
}
