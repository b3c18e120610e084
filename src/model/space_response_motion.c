// Moves the rows of a linkage in space as its bodies move (model/space_response.c: what acts in
// them).
//
// Accelerations of a row r = n . (v_b(B) - v_a(A)) along a direction of the world
//     r' = n . (a_b + alpha_b x B + omega_b x (omega_b x B) - likewise of a)
// with B, A the arms from the centres of mass; of a row s . (omega_b - omega_a), s fixed in body a,
//     r' = s . (alpha_b - alpha_a) + (omega_a x s) . (omega_b - omega_a)
#include "model/space_response.h"

void space_response_loosen(const SpaceResponse *response, Vec3 gravity, SpaceMotion *motions)
{
    const int driven = linkage_driven_body(response->linkage);
    for (size_t i = 0; i < response->linkage->body_count; i++) {
        SpaceMotion *motion = &motions[i];
        if ((int)i == driven) {
            continue;
        }
        const Mat3 *turn = &response->turns[i];
        const Vec3 omega = mat3_apply_back(turn, motion->omega);
        const Vec3 momentum = mat3_apply(&response->own_inertia[i], omega);
        const Vec3 alpha = mat3_apply(&response->own_inverse[i], vec3_cross(momentum, omega));
        motion->acceleration = gravity;
        motion->alpha = mat3_apply(turn, alpha);
    }
}

static Vec3 point_of(const SpaceResponse *response, const SpaceMotion *motions, const SpaceEnd *end)
{
    return end->body == LINKAGE_GROUND
               ? end->anchor
               : vec3_add(motions[end->body].position,
                          mat3_apply(&response->turns[end->body], end->anchor));
}

void space_response_drift(const SpaceResponse *response, const SpaceMotion *motions, double *drift)
{
    static const SpaceMotion STILL = {.turn = {1.0, 0.0, 0.0, 0.0}};
    for (size_t i = 0; i < response->ideal_rows; i++) {
        const SpaceEnd *ends = response->ends[response->joint_of[i]];
        const Vec3 along = response->direction_of[i];
        if (response->part_of[i] < SPACE_POINT_ROWS) {
            Vec3 parts[2];
            for (int side = 0; side < 2; side++) {
                parts[side] = space_acceleration_at(motions, ends[side].body,
                                                    point_of(response, motions, &ends[side]));
            }
            drift[i] = vec3_dot(along, vec3_sub(parts[1], parts[0]));
            continue;
        }
        const SpaceMotion *a = ends[0].body == LINKAGE_GROUND ? &STILL : &motions[ends[0].body];
        const SpaceMotion *b = ends[1].body == LINKAGE_GROUND ? &STILL : &motions[ends[1].body];
        drift[i] = vec3_dot(along, vec3_sub(b->alpha, a->alpha)) +
                   vec3_dot(vec3_cross(a->omega, along), vec3_sub(b->omega, a->omega));
    }
}

// The openings of a joint's point, and of its axis as a turn: at positions other than those where
// the response was placed.
typedef struct Opening {
    Vec3 point;
    Vec3 rate;
    Vec3 turn;
    Vec3 spin;
} Opening;

static Opening opening_of(const SpaceResponse *response, const SpaceMotion *motions, int joint)
{
    Vec3 points[2];
    Vec3 axes[2];
    Vec3 speeds[2];
    Vec3 omegas[2];
    for (int side = 0; side < 2; side++) {
        const SpaceEnd *end = &response->ends[joint][side];
        if (end->body == LINKAGE_GROUND) {
            points[side] = end->anchor;
            axes[side] = end->axis;
            speeds[side] = omegas[side] = (Vec3){0.0, 0.0, 0.0};
            continue;
        }
        const SpaceMotion *motion = &motions[end->body];
        const Mat3 turn = quat_matrix(motion->turn);
        const Vec3 arm = mat3_apply(&turn, end->anchor);
        points[side] = vec3_add(motion->position, arm);
        axes[side] = mat3_apply(&turn, end->axis);
        speeds[side] = vec3_add(motion->velocity, vec3_cross(motion->omega, arm));
        omegas[side] = motion->omega;
    }
    return (Opening){
        .point = vec3_sub(points[1], points[0]),
        .rate = vec3_sub(speeds[1], speeds[0]),
        .turn = vec3_cross(axes[0], axes[1]),
        .spin = vec3_across(vec3_sub(omegas[1], omegas[0]), axes[0]),
    };
}

void space_response_openings(const SpaceResponse *response, const SpaceMotion *motions,
                             double *openings, double *rates)
{
    Opening opening = {.point = {0.0, 0.0, 0.0}};
    for (size_t i = 0; i < response->ideal_rows; i++) {
        if (i == 0 || response->joint_of[i] != response->joint_of[i - 1]) {
            opening = opening_of(response, motions, response->joint_of[i]);
        }
        const bool is_point = response->part_of[i] < SPACE_POINT_ROWS;
        const Vec3 along = response->direction_of[i];
        openings[i] = vec3_dot(along, is_point ? opening.point : opening.turn);
        rates[i] = vec3_dot(along, is_point ? opening.rate : opening.spin);
    }
}

void space_change(SpaceMotion *motion, const SpaceChange *place, const SpaceChange *speed)
{
    if (place != NULL) {
        motion->position = vec3_add(motion->position, place->move);
        motion->turn = quat_unit(quat_product(quat_of_turn(place->turn), motion->turn));
    }
    if (speed != NULL) {
        motion->velocity = vec3_add(motion->velocity, speed->move);
        motion->omega = vec3_add(motion->omega, speed->turn);
    }
}
