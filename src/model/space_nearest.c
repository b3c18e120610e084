// Which speeds in space are nearest to given ones?
//
// With J the independent rows of the joints, M the masses and inertias of the bodies that can move
// and r = J v the rates at which the joints open: v' = v - M^-1 J' D^-1 r, D = J M^-1 J'.
#include "model/space_nearest.h"

#include "base/dense.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// of the largest speed: what rounding and a case's digits leave
static const double ALLOWED = 1e-9;

// what rounding has left after the first is gone after the second
enum { PASSES = 2 };

typedef struct Solution {
    size_t count;
    SpaceRow rows[SPACE_COLUMN_MAX];
    Mat3 inverse[SPACE_BODY_MAX]; // of the inertias in the world
    double matrix[SPACE_COLUMN_MAX * SPACE_COLUMN_MAX];
    double right[SPACE_COLUMN_MAX];
} Solution;

static bool gives_way(const Linkage *linkage, int body)
{
    return body != LINKAGE_GROUND && body != linkage_driven_body(linkage);
}

// J M^-1 J' of two rows.
static double coupling(const Linkage *linkage, const Solution *solution, const SpaceRow *a,
                       const SpaceRow *b)
{
    double sum = 0.0;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            const int body = a->body[i];
            if (body == b->body[k] && gives_way(linkage, body)) {
                sum += vec3_dot(a->linear[i], b->linear[k]) / linkage->bodies[body].mass +
                       vec3_dot(a->angular[i], mat3_apply(&solution->inverse[body], b->angular[k]));
            }
        }
    }
    return sum;
}

static void find_rows(const Linkage *linkage, const SpaceMotion *motions, bool with_play,
                      Solution *solution)
{
    bool is_asked[SPACE_JOINT_MAX];
    unsigned chosen[SPACE_JOINT_MAX];
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const bool has_play = linkage->joints[i].kind == JOINT_CLEARANCE;
        is_asked[i] = has_play ? with_play : linkage_is_ideal(linkage, i);
    }
    space_rows_choose(linkage, motions, is_asked, chosen);
    solution->count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        SpaceRow rows[SPACE_JOINT_ROWS];
        if (chosen[i] != 0) {
            space_rows_of_joint(linkage, motions, i, rows);
        }
        for (int k = 0; k < SPACE_JOINT_ROWS; k++) {
            if ((chosen[i] >> k & 1U) != 0) {
                solution->rows[solution->count++] = rows[k];
            }
        }
    }
}

// Takes out what opens the rows.
static void correct(const Linkage *linkage, Solution *solution, SpaceMotion *motions)
{
    const size_t n = solution->count;
    for (size_t i = 0; i < n; i++) {
        solution->right[i] = space_row_speed(&solution->rows[i], motions);
        for (size_t k = 0; k < n; k++) {
            solution->matrix[i * n + k] =
                coupling(linkage, solution, &solution->rows[i], &solution->rows[k]);
        }
    }
    if (!dense_solve(n, solution->matrix, solution->right)) {
        return;
    }
    for (size_t i = 0; i < n; i++) {
        const SpaceRow *row = &solution->rows[i];
        for (int side = 0; side < 2; side++) {
            const int body = row->body[side];
            if (gives_way(linkage, body)) {
                SpaceMotion *motion = &motions[body];
                const double push = -solution->right[i];
                motion->velocity =
                    vec3_add(motion->velocity,
                             vec3_scale(push / linkage->bodies[body].mass, row->linear[side]));
                motion->omega = vec3_add(
                    motion->omega,
                    vec3_scale(push, mat3_apply(&solution->inverse[body], row->angular[side])));
            }
        }
    }
}

// The driven body keeps its speeds.
static void keep_joints(const Linkage *linkage, bool with_play, SpaceMotion *motions)
{
    Solution *solution = malloc(sizeof *solution);
    assert(solution != NULL);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Mat3 inertia = space_world_inertia(&linkage->bodies[i], motions[i].turn);
        solution->inverse[i] = mat3_inverse(&inertia);
    }
    find_rows(linkage, motions, with_play, solution);
    for (int pass = 0; pass < PASSES; pass++) {
        correct(linkage, solution, motions);
    }
    free(solution);
}

void space_nearest_speeds(const Linkage *linkage, bool with_play, SpaceMotion *motions)
{
    const int driven = linkage_driven_body(linkage);
    if (driven != LINKAGE_GROUND) {
        const SpaceMotion given = space_driven(linkage, 0.0);
        motions[driven].velocity = given.velocity;
        motions[driven].omega = given.omega;
    }
    keep_joints(linkage, with_play, motions);
}

void space_nearest_change(const Linkage *linkage, SpeedChange *changes)
{
    SpaceMotion motions[SPACE_BODY_MAX];
    space_start(linkage, motions);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const SpeedChange *change = &changes[i];
        const bool is_free = gives_way(linkage, (int)i);
        const Vec3 velocity = {change->velocity.x, change->velocity.y, change->velocity_z};
        const Vec3 omega = {change->omega_x, change->omega_y, change->omega};
        motions[i].velocity = is_free ? velocity : (Vec3){0.0, 0.0, 0.0};
        motions[i].omega = is_free ? omega : (Vec3){0.0, 0.0, 0.0};
    }
    keep_joints(linkage, false, motions);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Vec3 velocity = motions[i].velocity;
        const Vec3 omega = motions[i].omega;
        changes[i] = (SpeedChange){{velocity.x, velocity.y}, omega.z, velocity.z, omega.x, omega.y};
    }
}

bool space_nearest_check(const Linkage *linkage, const SpaceMotion *motions, int *joint)
{
    double largest = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const double reach = linkage_reach(linkage, (int)i);
        largest =
            fmax(largest, vec3_length(motions[i].velocity) + reach * vec3_length(motions[i].omega));
    }
    double worst = ALLOWED * largest;
    bool is_good = true;
    const int driven = linkage_driven_body(linkage);
    if (driven != LINKAGE_GROUND) {
        const SpaceMotion given = space_driven(linkage, 0.0);
        const Vec3 off = vec3_sub(motions[driven].velocity, given.velocity);
        const Vec3 turning = vec3_sub(motions[driven].omega, given.omega);
        if (vec3_length(off) + linkage_reach(linkage, driven) * vec3_length(turning) > worst) {
            *joint = -1;
            return false;
        }
    }
    const double reach = linkage_reach(linkage, 0); // what turns of an axis are weighed by
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (!linkage_is_ideal(linkage, i)) {
            continue;
        }
        SpaceRow rows[SPACE_JOINT_ROWS];
        space_rows_of_joint(linkage, motions, i, rows);
        for (int k = 0; k < SPACE_JOINT_ROWS; k++) {
            const double unit = k < SPACE_POINT_ROWS ? 1.0 : reach;
            const double speed = unit * fabs(space_row_speed(&rows[k], motions));
            if (speed > worst) {
                worst = speed;
                *joint = (int)i;
                is_good = false;
            }
        }
    }
    return is_good;
}
