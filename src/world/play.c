// Makes joints with play, takes them away, and reads their sides.
#include "world/play.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

JpJoint *play_add(JpWorld *world, PlayKind kind, const dBodyID bodies[2])
{
    JpJoint *joint = calloc(1, sizeof *joint);
    if (joint != NULL) {
        joint->world = world;
        joint->kind = kind;
        memcpy(joint->bodies, bodies, sizeof joint->bodies);
        joint->rotor.inertia = INFINITY;
        joint->number = world->joints != NULL ? world->joints->number + 1 : 1;
        joint->next = world->joints;
        world->joints = joint;
        world->found.is_kept = false;
    }
    return joint;
}

PlayName play_name(const JpJoint *joint)
{
    static const char *const KINDS[] = {
        [PLAY_STOPS] = "stops",
        [PLAY_BACKLASH] = "backlash",
        [PLAY_PIN] = "pin",
        [PLAY_FRICTION] = "friction",
    };
    PlayName name;
    snprintf(name.text, sizeof name.text, "joint %zu (%s)", joint->number, KINDS[joint->kind]);
    return name;
}

const char *play_unit(const JpJoint *joint)
{
    return joint->kind != PLAY_PIN && joint->coordinate.is_angle ? "rad" : "m";
}

JpStatus play_check_bodies(const JpJoint *joint, JpError *error)
{
    bool is_whole = true;
    for (int i = 0; i < 2; i++) {
        const dBodyID now = joint->kind != PLAY_PIN     ? dJointGetBody(joint->coordinate.joint, i)
                            : joint->watches[i] != NULL ? dJointGetBody(joint->watches[i], 0)
                                                        : NULL;
        is_whole = is_whole && now == joint->bodies[i];
    }
    return is_whole ? JP_OK
                    : refusal(error, JP_ERROR_WORLD,
                              "a body of %s was destroyed, or its joint in ODE was attached to "
                              "other bodies; destroy the joint with jp_joint_destroy",
                              play_name(joint).text);
}

double play_mass(const JpJoint *joint)
{
    double inverse = 0.0;
    for (int i = 0; i < 2; i++) {
        dMass mass;
        if (joint->bodies[i] != NULL && !dBodyIsKinematic(joint->bodies[i])) {
            dBodyGetMass(joint->bodies[i], &mass);
            inverse += 1.0 / mass.mass;
        }
    }
    return inverse > 0.0 ? 1.0 / inverse : 0.0;
}

JpStatus play_check_joint(const JpWorld *world, dJointID joint, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(refusal_of_null(joint, "the joint", error));
    const dJointType type = dJointGetType(joint);
    if (type != dJointTypeHinge && type != dJointTypeSlider) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the joint is of ODE's type %d; it must be a hinge or a slider", (int)type);
    }
    const dBodyID bodies[2] = {dJointGetBody(joint, 0), dJointGetBody(joint, 1)};
    if (bodies[0] == NULL && bodies[1] == NULL) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the joint is not attached to a body; attach it first");
    }
    for (int i = 0; i < 2; i++) {
        if (bodies[i] != NULL && dBodyGetWorld(bodies[i]) != world->id) {
            return refusal(error, JP_ERROR_ARGUMENT, "the joint is in another world");
        }
    }
    return JP_OK;
}

// Sums: one that overflows is as good as one that is infinite.
bool play_is_finite(const JpJoint *joint)
{
    double sum = joint->rotor.position + joint->rotor.speed + vec3_length(joint->force);
    for (size_t i = 0; i < joint->place_count; i++) {
        const Place *place = &joint->places[i];
        sum += place->slid;
        for (size_t k = 0; k < place_side_count(place); k++) {
            const Side *side = &place->sides[k];
            sum += side->force + side->force_max + side->depth_max + side->impulse + side->work +
                   side->state.impact_speed + side->state.bend;
        }
    }
    const RubFound *rub = &joint->rub.found;
    sum += rub->force + rub->slid + rub->row.pressing[0] + rub->row.gained + rub->row.late;
    return isfinite(sum);
}

bool play_is_side_finite(const JpSide *side)
{
    return isfinite(side->force + side->force_max + side->depth_max + side->impulse + side->work +
                    side->stored + side->impact_speed);
}

void jp_joint_destroy(JpJoint *joint)
{
    if (joint == NULL) {
        return;
    }
    JpJoint **at = &joint->world->joints;
    while (*at != joint) {
        at = &(*at)->next;
    }
    *at = joint->next;
    joint->world->found.is_kept = false;
    for (size_t i = 0; i < joint->place_count; i++) {
        if (joint->places[i].row.motor != NULL) {
            dJointDestroy(joint->places[i].row.motor);
        }
    }
    if (joint->kind == PLAY_FRICTION) {
        if (joint->coordinate.is_angle && joint->rub.motor != NULL) {
            dJointDestroy(joint->rub.motor);
        }
        if (dJointGetFeedback(joint->coordinate.joint) == &joint->rub.reaction) {
            dJointSetFeedback(joint->coordinate.joint, NULL);
        }
    }
    for (int i = 0; i < 2; i++) {
        if (joint->watches[i] != NULL) {
            dJointDestroy(joint->watches[i]);
        }
    }
    free(joint);
}

double play_mobility(const JpJoint *joint, const Place *place)
{
    return direction_mobility(&place->along) + 1.0 / joint->rotor.inertia;
}

double play_rate(const JpJoint *joint, const Place *place)
{
    return direction_rate(&place->along) - joint->rotor.speed;
}

JpSide play_side(const Side *side, double position)
{
    const double gap = isfinite(side->limit) ? side_gap(side, position) : INFINITY;
    return (JpSide){
        .gap = gap,
        .force = side->force,
        .force_max = side->force_max,
        .depth_max = side->depth_max,
        .impulse = side->impulse,
        .work = side->work,
        .stored = gap < 0.0 ? force_law_energy(&side->law, -gap) : 0.0,
        .impact_speed = side->state.impact_speed,
        .impacts = side->impacts,
        .is_touching = gap < 0.0,
    };
}
