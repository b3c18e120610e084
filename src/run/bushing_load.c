// Finds the largest forces and deflections of bushings at the samples of a run.
#include "run/bushing_load.h"

#include "model/bushing.h"

#include <math.h>

static void raise_to(Extreme *extreme, double value, const Trajectory *run, size_t sample)
{
    if (fabs(value) > extreme->value) {
        *extreme = (Extreme){fabs(value), run->times[sample], run->crank_angles[sample]};
    }
}

static double pull_of(const Bushing *bushing, const BushingPose *pose, size_t row)
{
    return bushing_pull(bushing, pose, row) + bushing_drag(bushing, pose, row);
}

double bushing_force_at(const Trajectory *run, size_t sample, size_t number)
{
    const Bushing *bushing = &run->linkage.bushings[number];
    const BushingPose pose = bushing_pose(bushing, trajectory_motion(run, sample, 0));
    return hypot(pull_of(bushing, &pose, 0), pull_of(bushing, &pose, 1));
}

BushingExtremes bushing_extremes(const Trajectory *run, size_t number)
{
    const Bushing *bushing = &run->linkage.bushings[number];
    const Extreme none = {.value = 0.0, .time_s = 0.0, .crank_rad = NAN};
    BushingExtremes extremes = {none, none, none, none};
    for (size_t k = 0; k < run->sample_count; k++) {
        if (run->times[k] < run->report_from_s) {
            continue;
        }
        const BushingPose pose = bushing_pose(bushing, trajectory_motion(run, k, 0));
        double pulls[BUSHING_ROWS];
        for (size_t row = 0; row < BUSHING_ROWS; row++) {
            pulls[row] = pull_of(bushing, &pose, row);
        }
        raise_to(&extremes.force, hypot(pulls[0], pulls[1]), run, k);
        raise_to(&extremes.torque, pulls[2], run, k);
        raise_to(&extremes.deflection, hypot(pose.deflection[0], pose.deflection[1]), run, k);
        raise_to(&extremes.angle, pose.deflection[2], run, k);
    }
    return extremes;
}
