// Sums up what wears the pins of a run, from inside its steps.
//
// With the force F of the hole on the pin, its part T along the wall and the velocity v at which
// the pin slides on the wall, over the reported time in which they touch:
//     contact   integral dt            distance  integral |v| dt      worn  integral F |v| dt
//     force     integral F dt          friction  integral -T . v dt
// A contact begins and ends with a step, however short it is. Over a step from 0 to 1 of the length
// h the solver knows the integral J of the force; the speed, which friction alone changes, is taken
// as a line, and so is what friction takes of it, r = -T . v / F:
//     distance  h (v_0 + v_1) / 2
//     worn      J (v_0 + v_1) / 2 + h (F_1 - F_0) (v_1 - v_0) / 12
//     friction  J (r_0 + r_1) / 2 + h (F_1 - F_0) (r_1 - r_0) / 12
// J is the record's, but in space of solvers that do not sum it up end by end: there Simpson's rule
// finds it from the force in the middle. Where no friction acts but in these pins, what it took of
// all together is the solver's own sum. A step whose values are means over it counts with these.
//
// In space a pin presses at both ends of its hole, each of which has its own F, v and place on the
// wall. There |F| = N sqrt(1 + r^2) with T = r N, r = mu tanh(|v| / v_s) (kernel/friction_law.h).
// Collars are not told of: they press along the axis.
#include "run/wearing.h"

#include "base/zeroed.h"
#include "contact/pin_space.h"
#include "contact/touch.h"
#include "kernel/friction_law.h"
#include "model/joint_friction.h"

#include <math.h>
#include <stdlib.h>

// the most by which the sum of friction over the pins may be off the solver's, to be put right
static const double WEARING_OFF_MOST = 0.05;

// One place of the wall at an instant.
typedef struct WornPlace {
    double force;          // N
    double speed;          // m/s
    double friction_power; // W
    double angle;          // rad, where it is pressed
} WornPlace;

// The places of a joint at the end of its last record.
typedef struct WornJoint {
    bool is_known;
    WornPlace places[PIN_SPACE_ENDS]; // in the plane the first alone
} WornJoint;

struct Wearing {
    const Scenario *scenario;
    const Solver *solver;
    const void *state;
    JointWear *wear;   // of the trajectory, by joint
    bool *has_place;   // by joint: whether it is a pin in a hole; owned, as all that follow
    Touch *places;     // by joint, in the plane
    PinSpace *ends;    // of all pins, joint by joint, in space
    size_t *first_end; // by joint
    WornJoint *last;   // by joint
    double (*middle)[PIN_SPACE_ENDS]; // N, by joint, in the middle of its last step
    double *recorded_s;               // by joint, the end of its last record
    bool is_all;                      // whether friction acts nowhere else
    double friction;                  // J, that it took in all
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

// Whether no friction acts but in the pins.
static bool rubs_alone(const Wearing *wearing)
{
    const Linkage *linkage = &wearing->scenario->linkage;
    bool is_all = true;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        is_all = is_all &&
                 (wearing->has_place[i] || (!linkage_has_play(joint) && !joint_friction_is(joint)));
    }
    return is_all;
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
        .last = zeroed(joints, sizeof *wearing->last),
        .middle = zeroed(joints, sizeof *wearing->middle),
        .recorded_s = zeroed(joints, sizeof *wearing->recorded_s),
        .sample = sample_create(&scenario->linkage),
    };
    if (!find_pins(wearing)) {
        wearing_finish(wearing);
        return NULL;
    }
    trajectory->wear = zeroed(joints, sizeof *trajectory->wear);
    wearing->wear = trajectory->wear;
    wearing->is_all = rubs_alone(wearing);
    return wearing;
}

// Makes what friction took in all pins together what the solver has summed up.
static void put_friction_right(Wearing *wearing)
{
    double sum = 0.0;
    for (size_t i = 0; wearing->wear != NULL && i < wearing->scenario->linkage.joint_count; i++) {
        sum += wearing->wear[i].friction;
    }
    if (!wearing->is_all || !(fabs(wearing->friction - sum) <= WEARING_OFF_MOST * sum)) {
        return;
    }
    for (size_t i = 0; sum > 0.0 && i < wearing->scenario->linkage.joint_count; i++) {
        wearing->wear[i].friction *= wearing->friction / sum;
    }
}

void wearing_finish(Wearing *wearing)
{
    if (wearing == NULL) {
        return;
    }
    put_friction_right(wearing);
    free(wearing->has_place);
    free(wearing->places);
    free(wearing->ends);
    free(wearing->first_end);
    free(wearing->last);
    free(wearing->middle);
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

// Writes the places of a pin as the sample has them, or of a step of means as the record has.
static WornJoint places_of(const Wearing *wearing, const StepRecord *step, size_t index)
{
    const size_t joint = solver_joint(step->part, index);
    WornJoint worn = {.is_known = false};
    if (wearing->ends == NULL) {
        const TouchPose pose = touch_pose(&wearing->scenario->linkage, &wearing->places[joint],
                                          wearing->sample.bodies);
        worn.is_known = pose.has_normal;
        if (pose.has_normal) {
            worn.places[0] = place_in_plane(wearing, joint, &pose, &step->joints[index]);
        }
        return worn;
    }
    for (size_t i = 0; i < PIN_SPACE_ENDS; i++) {
        const PinSpace *end = &wearing->ends[wearing->first_end[joint] + i];
        const PinSpacePose pose = pin_space_pose(end, wearing->sample.space_bodies);
        if (pose.has_normal) {
            worn.is_known = true;
            worn.places[i] =
                place_at_end(wearing, end, &pose, step->space_joints[index].end_forces[i]);
        }
    }
    return worn;
}

static double power_share(const WornPlace *place, const WornPlace *other)
{
    return place->force > 0.0   ? place->friction_power / place->force
           : other->force > 0.0 ? other->friction_power / other->force
                                : 0.0;
}

// Adds a place of a joint over a part of a step: the integral of its force there, and its share of
// the joint's sliding distance.
static void add_place(JointWear *wear, const WornPlace *first, const WornPlace *last,
                      double width_s, double impulse, double share)
{
    const double change = width_s * (last->force - first->force) / 12.0;
    const double ratios[2] = {power_share(first, last), power_share(last, first)};
    const double worn =
        0.5 * impulse * (first->speed + last->speed) + change * (last->speed - first->speed);
    wear->force += impulse;
    wear->distance += 0.5 * share * width_s * (first->speed + last->speed);
    wear->friction += 0.5 * impulse * (ratios[0] + ratios[1]) + change * (ratios[1] - ratios[0]);
    wear->worn += worn;
    wear->sectors[sector_of(first->angle)] += 0.5 * worn;
    wear->sectors[sector_of(last->angle)] += 0.5 * worn;
}

// Whether forces are looked up in the middle of a step.
static bool has_middle(const Wearing *wearing, const StepRecord *step)
{
    return wearing->ends != NULL && !step->is_mean && wearing->solver->observe_end == NULL;
}

// Adds a joint from the end of its last record on, or what is left of that time from `start_s` on.
// Of both ends of a pin in space each has its part of the impulse.
static void add_joint(Wearing *wearing, const StepRecord *step, size_t index, double start_s)
{
    const size_t joint = solver_joint(step->part, index);
    const double whole_s = step->end_s - wearing->recorded_s[joint];
    const double width_s = step->end_s - start_s;
    const WornJoint now = places_of(wearing, step, index);
    WornJoint *last = &wearing->last[joint];
    const size_t count = wearing->ends != NULL ? PIN_SPACE_ENDS : 1;
    double forces = 0.0;
    if (step->is_mean || !last->is_known) {
        *last = now;
        for (size_t i = 0; i < count && !step->is_mean; i++) {
            last->places[i].force = 0.0; // where it begins to touch
        }
    }
    for (size_t i = 0; i < count; i++) {
        forces += now.places[i].force + last->places[i].force;
    }
    if (now.is_known && width_s > 0.0 && forces > 0.0) {
        wearing->wear[joint].contact += width_s;
        for (size_t i = 0; i < count; i++) {
            const double ends = now.places[i].force + last->places[i].force;
            const double impulse = has_middle(wearing, step)
                                       ? (ends + 4.0 * wearing->middle[joint][i]) * width_s / 6.0
                                       : ends / forces * step->impulse[index] * width_s / whole_s;
            add_place(&wearing->wear[joint], &last->places[i], &now.places[i], width_s, impulse,
                      ends / forces);
        }
    }
    *last = now;
}

// Looks at joints of a record where its values are, one or all (NULL), and before that at their
// forces in the middle of the time since `start_s` where these are needed.
static void look(Wearing *wearing, const StepRecord *step, const SolverSome *some, double start_s)
{
    const Solver *solver = wearing->solver;
    Sample *sample = &wearing->sample;
    if (has_middle(wearing, step)) {
        const size_t count =
            some != NULL ? 1 : solver_joint_count(step->part, &wearing->scenario->linkage);
        solver_look(solver, wearing->state, 0.5 * (start_s + step->end_s), step->part, some,
                    sample);
        for (size_t k = 0; k < count; k++) {
            const size_t joint = solver_joint(step->part, some != NULL ? some->joints[0] : k);
            for (size_t i = 0; i < PIN_SPACE_ENDS; i++) {
                wearing->middle[joint][i] = sample->space_joints[joint].end_forces[i];
            }
        }
    }
    if (solver->observe_end != NULL && some == NULL && step->part == NULL && !step->is_mean) {
        solver->observe_end(wearing->state, sample);
    } else {
        solver_look(solver, wearing->state, step->is_mean ? step->joint_s : step->end_s, step->part,
                    some, sample);
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

// Looks at one joint of a record alone.
static void look_at_one(Wearing *wearing, const StepRecord *step, size_t index, double start_s)
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
    look(wearing, step, &one, start_s);
}

// Takes in a joint of a record, by its place there; `is_seen` says whether its bodies have been
// looked at.
static void take_joint(Wearing *wearing, const StepRecord *step, size_t index, bool *is_seen)
{
    const size_t joint = solver_joint(step->part, index);
    const double start_s =
        fmax(wearing->recorded_s[joint], scenario_report_from(wearing->scenario));
    if (!wearing->has_place[joint] || !step->joints[index].is_touching) {
        wearing->last[joint].is_known = false;
    } else if (step->end_s >= start_s) {
        if (step->changed != NULL) {
            look_at_one(wearing, step, index, start_s);
        } else if (!*is_seen) {
            look(wearing, step, NULL, start_s);
            *is_seen = true;
        }
        add_joint(wearing, step, index, start_s);
    }
    wearing->recorded_s[joint] = step->end_s;
}

void wearing_add(Wearing *wearing, const StepRecord *step)
{
    if (wearing == NULL) {
        return;
    }
    const double from_s = scenario_report_from(wearing->scenario);
    const double width_s = step->end_s - step->start_s;
    const double share =
        width_s > 0.0 ? (step->end_s - fmax(step->start_s, from_s)) / width_s : 1.0;
    const size_t count = step->changed != NULL
                             ? step->changed->joint_count
                             : solver_joint_count(step->part, &wearing->scenario->linkage);
    bool is_seen = false;
    wearing->friction += step->end_s >= from_s ? share * step->friction : 0.0;
    for (size_t n = 0; n < count; n++) {
        take_joint(wearing, step, step->changed != NULL ? step->changed->joints[n] : n, &is_seen);
    }
}
