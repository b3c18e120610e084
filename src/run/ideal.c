// Finds how large accelerations, forces and the drive's torque are without any play.
//
// The linkage is closed at angles of the crank a degree apart, and the forces follow from the
// equations of motion (analytic/inverse_dynamics.c). Between two of the angles a curve with a swing
// in 30 degrees rises by half a percent of itself at most.
#include "run/ideal.h"

#include "analytic/closed_form.h"
#include "analytic/inverse_dynamics.h"
#include "base/dense.h"
#include "base/zeroed.h"
#include "model/kinematics.h"
#include "model/space.h"

#include <math.h>
#include <stdlib.h>

enum { ANGLES = 360, POSES_MAX = 100 * ANGLES };

// of the largest pivot: a linkage that moves freely has none below 1e-3; at a change point, where a
// joint is found to the root of rounding alone, they are some 1e-8, now more and now less
static const double MOVES_FREELY = 1e-6;

// Whether the linkage is clear of every dead centre, whichever way its numbers are rounded.
static bool moves_freely(const Linkage *linkage, const Motion *motions)
{
    Jacobian jacobian;
    kinematics_jacobian(linkage, motions, NULL, true, &jacobian);
    return dense_rank(jacobian.rows, jacobian.columns, jacobian.entries, MOVES_FREELY) ==
           jacobian.columns;
}

static bool move_to(const Scenario *scenario, const DriveState *drives, Motion *motions)
{
    const bool is_steady = drive_is_steady(&scenario->linkage.driver);
    if (scenario_has_closed_form(scenario)) {
        return is_steady ? closed_form_bodies(scenario, drives->angle, motions)
                         : closed_form_driven(scenario, drives, motions);
    }
    Err unused = {ERR_NONE, ""};
    return kinematics_solve_driven(&scenario->linkage, drives, motions, &unused) &&
           moves_freely(&scenario->linkage, motions);
}

// How many poses are looked at: of a turn, or of what a speed over time turns at most.
static int pose_count(const Scenario *scenario)
{
    const Driver *driver = &scenario->linkage.driver;
    const double turns = fabs(driver->speed) * scenario_duration(scenario) / (2.0 * M_PI);
    return drive_is_steady(driver) ? ANGLES
                                   : (int)fmin(fmax(ANGLES, ceil(ANGLES * turns)), POSES_MAX);
}

static void pose(const Scenario *scenario, int number, int count,
                 DriveState drives[LINKAGE_DRIVE_MAX])
{
    const Driver *driver = &scenario->linkage.driver;
    if (drive_is_steady(driver)) {
        drives[0] = (DriveState){.angle = driver->start + 2.0 * M_PI * number / ANGLES,
                                 .omega = driver->speed};
        return;
    }
    const double time_s = scenario_duration(scenario) * number / count;
    linkage_drives_since(&scenario->linkage, time_s, time_s, drives);
}

// Takes one pose; `least` and `most` are the accelerations so far, by body.
static void take_pose(const Linkage *linkage, const Motion *motions, const Reactions *reactions,
                      double *least, double *most, IdealSizes *sizes)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        least[i] = fmin(least[i], motions[i].alpha);
        most[i] = fmax(most[i], motions[i].alpha);
        sizes->alpha_max[i] = fmax(-least[i], most[i]);
        sizes->alpha_range[i] = most[i] - least[i];
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        sizes->force_max[i] = fmax(sizes->force_max[i], vec2_length(reactions->force_on_b[i]));
    }
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        sizes->torque_max[i] = fmax(sizes->torque_max[i], fabs(reactions->drive_torques[i]));
    }
}

static InverseTime pose_time(const Scenario *scenario, const DriveState *drive, int number,
                             int count)
{
    const Driver *driver = &scenario->linkage.driver;
    const double time_s = drive_is_steady(driver) ? (drive->angle - driver->start) / driver->speed
                                                  : scenario_duration(scenario) * number / count;
    return (InverseTime){time_s, time_s};
}

IdealSizes ideal_sizes(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    IdealSizes sizes = {
        // the joints' forces are those in the plane
        .is_known = linkage->driver.is_present && space_has_plane(linkage) &&
                    scenario->gravity.z == 0.0 && kinematics_is_small(linkage),
        .alpha_max = zeroed(linkage->body_count, sizeof *sizes.alpha_max),
        .alpha_range = zeroed(linkage->body_count, sizeof *sizes.alpha_range),
        .force_max = zeroed(linkage->joint_count, sizeof *sizes.force_max),
    };
    double *least = zeroed(linkage->body_count, sizeof *least);
    double *most = zeroed(linkage->body_count, sizeof *most);
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    const int count = sizes.is_known ? pose_count(scenario) : 0;
    for (int k = 0; sizes.is_known && k < count; k++) {
        Err unused = {ERR_NONE, ""};
        Reactions reactions;
        DriveState drives[LINKAGE_DRIVE_MAX];
        pose(scenario, k, count, drives);
        sizes.is_known =
            move_to(scenario, drives, motions) &&
            inverse_dynamics_solve(linkage, motions, scenario_gravity(scenario),
                                   pose_time(scenario, drives, k, count), &reactions, &unused);
        if (sizes.is_known) {
            take_pose(linkage, motions, &reactions, least, most, &sizes);
        }
    }
    free(motions);
    free(most);
    free(least);
    return sizes;
}

void ideal_sizes_free(IdealSizes *sizes)
{
    free(sizes->alpha_max);
    free(sizes->alpha_range);
    free(sizes->force_max);
    *sizes = (IdealSizes){0};
}
