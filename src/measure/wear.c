// Makes means of what has worn a pin and its hole.
//
// With the sums of run/wearing.c over the reported time t of n revolutions, the width w over which
// they touch and the diameter d of the pin:
//     friction work     1/n integral -T . v dt
//     sliding distance  1/n integral |v| dt         while they touch
//     mean pressure     mean of F / (w d)           while they touch
//     p v               1/t integral F |v| / (w d) dt
// Archard's wear volume is proportional to the integral of F |v|: its share in each sector of the
// wall, by where the pin presses, tells where the hole wears.
#include "measure/wear.h"

#include <math.h>

bool wear_has(const Joint *joint)
{
    return linkage_has_play(joint) && joint_has_hole(joint->kind);
}

// of the force: a part along the wall below this share is rounding, and no friction
static const double WEAR_ROUNDING = 1e-9;

static double revolutions(const Trajectory *run, double time_s)
{
    return drive_is_steady(&run->linkage.driver) ? time_s / linkage_period(&run->linkage) : 1.0;
}

// Makes the sums of sectors shares, and finds the most worn.
static void share_sectors(const JointWear *sums, Wear *wear)
{
    size_t most = 0;
    for (size_t i = 0; i < WEAR_SECTORS; i++) {
        wear->sectors[i] = sums->worn > 0.0 ? sums->sectors[i] / sums->worn : 0.0;
        most = wear->sectors[i] > wear->sectors[most] ? i : most;
    }
    wear->angle = sums->worn > 0.0 ? 2.0 * M_PI * ((double)most + 0.5) / WEAR_SECTORS : NAN;
    wear->share = sums->worn > 0.0 ? wear->sectors[most] : NAN;
}

Wear wear_of(const Trajectory *run, size_t joint)
{
    const Joint *of = &run->linkage.joints[joint];
    Wear wear = {.is_known = false};
    if (run->wear == NULL || !wear_has(of) || !trajectory_feels_play(run, of) ||
        !(run->wear[joint].contact > 0.0)) {
        return wear;
    }
    const JointWear *sums = &run->wear[joint];
    const double area = of->clearance.width * 2.0 * of->clearance.pin_radius;
    const double time_s = run->duration_s - run->report_from_s;
    const double turns = revolutions(run, time_s);
    wear.is_known = true;
    wear.friction_work = sums->friction > WEAR_ROUNDING * sums->worn ? sums->friction / turns : NAN;
    wear.distance = sums->distance / turns;
    wear.pressure = area > 0.0 ? sums->force / sums->contact / area : NAN;
    wear.pressure_speed = area > 0.0 ? sums->worn / time_s / area : NAN;
    share_sectors(sums, &wear);
    return wear;
}
