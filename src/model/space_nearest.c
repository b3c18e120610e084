// Finds the speeds in space that are nearest to given ones.
//
// With J the independent rows of the joints, M the masses and inertias of the bodies that can move
// and r = J v the rates at which the joints open: v' = v - M^-1 J' D^-1 r, D = J M^-1 J'.
#include "model/space_nearest.h"

#include "base/zeroed.h"
#include "model/space_response.h"

// of the largest speed: what rounding and a case's digits leave
static const double ALLOWED = 1e-9;

// what rounding has left after the first is gone after the second
enum { PASSES = 2 };

static bool body_gives_way(const Linkage *linkage, int body)
{
    return body != LINKAGE_GROUND && body != linkage_driven_body(linkage);
}

static bool choose(const Linkage *linkage, const SpaceMotion *motions, const bool *is_asked,
                   unsigned *chosen)
{
    space_rows_choose(linkage, motions, is_asked, chosen);
    return true;
}

// Takes out what opens the rows.
static void correct(SpaceResponse *response, SpaceMotion *motions)
{
    const Linkage *linkage = response->linkage;
    double *speeds = zeroed(response->ideal_rows, sizeof *speeds);
    double *impulses = zeroed(response->ideal_rows, sizeof *impulses);
    SpaceChange *changes = zeroed(linkage->body_count, sizeof *changes);
    for (size_t i = 0; i < response->ideal_rows; i++) {
        speeds[i] = space_row_speed(&response->rows[i].row, motions);
    }
    space_response_close(response, speeds, impulses, changes);
    for (size_t i = 0; i < linkage->body_count; i++) {
        space_change(&motions[i], NULL, &changes[i]);
    }
    free(changes);
    free(impulses);
    free(speeds);
}

// The driven body keeps its speeds.
static void keep_joints(const Linkage *linkage, bool with_play, SpaceMotion *motions)
{
    bool *is_asked = zeroed(linkage->joint_count, sizeof *is_asked);
    SpaceResponse response = {.linkage = NULL};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const bool has_play = joint_has_hole(linkage->joints[i].kind);
        is_asked[i] = has_play ? with_play : linkage_is_ideal(linkage, i);
    }
    space_response_init_joints(linkage, motions, is_asked, choose, &response);
    for (int pass = 0; pass < PASSES && space_response_place(&response, motions, NULL); pass++) {
        correct(&response, motions);
    }
    space_response_finish(&response);
    free(is_asked);
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
    SpaceMotion *motions = zeroed(linkage->body_count, sizeof *motions);
    space_start(linkage, motions);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const SpeedChange *change = &changes[i];
        const bool is_free = body_gives_way(linkage, (int)i);
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
    free(motions);
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
