// Adds up what wears a pin and its hole.
//
// With the force F of the hole on the pin, its part T along the wall, the speed v at which the pin
// slides on the wall, the width w over which they touch and the diameter d of the pin, over the n
// revolutions of the reported time t:
//     friction work     1/n integral |T v| dt
//     sliding distance  1/n integral |v| dt         while they touch
//     mean pressure     mean of F / (w d)           while they touch
//     p v               1/t integral F |v| / (w d) dt
// Archard's wear volume is proportional to the integral of F |v|: its share in each sector of the
// wall, by where the pin presses, tells where the hole wears. Integrals are trapezoidal sums over
// the samples: what an impact between two of them adds is not in them.
#include "measure/wear.h"

#include "contact/touch.h"

#include <math.h>

bool wear_has(const Linkage *linkage, const Joint *joint)
{
    return !linkage->is_spatial && linkage_has_play(joint) && joint_has_hole(joint->kind);
}

// of the force: a part along the wall below this share is rounding, and no friction
static const double WEAR_ROUNDING = 1e-9;

// What a joint does at a sample.
typedef struct WearInstant {
    bool touches;
    double force;   // N
    double tangent; // N, its part along the wall
    double speed;   // m/s
    double angle;   // rad, where it presses, from the x axis of the body with the hole
} WearInstant;

static WearInstant instant_of(const Trajectory *run, size_t sample, size_t joint,
                              const Touch *place)
{
    const Joint *of = &run->linkage.joints[joint];
    const Motion *motions = trajectory_motion(run, sample, 0);
    const JointState *state = trajectory_state(run, sample, joint);
    const TouchPose pose = touch_pose(&run->linkage, place, motions);
    WearInstant instant = {.touches = state->is_touching && pose.has_normal};
    if (instant.touches) {
        const double turned = of->body_a == LINKAGE_GROUND ? 0.0 : motions[of->body_a].angle;
        const Vec2 at = vec2_rotate(-turned, state->eccentricity);
        instant.force = state->force;
        instant.tangent = vec2_dot(vec2_perp(pose.normal), state->force_on_b);
        instant.speed = fabs(touch_sliding(&run->linkage, place, &pose, motions));
        instant.angle = atan2(at.y, at.x);
    }
    return instant;
}

static size_t sector_of(double angle)
{
    const double turn = angle / (2.0 * M_PI);
    const size_t sector = (size_t)((turn - floor(turn)) * WEAR_SECTORS);
    return sector < WEAR_SECTORS ? sector : 0;
}

// The sums, s times what they add up.
typedef struct WearSums {
    double time;
    double contact;
    double force;
    double distance;
    double work;
    double force_distance;
} WearSums;

static void add_instant(const WearInstant *instant, double weight_s, WearSums *sums, Wear *wear)
{
    sums->time += weight_s;
    if (!instant->touches) {
        return;
    }
    const double worn = weight_s * instant->force * instant->speed;
    sums->contact += weight_s;
    sums->force += weight_s * instant->force;
    sums->distance += weight_s * instant->speed;
    sums->work += weight_s * fabs(instant->tangent) * instant->speed;
    sums->force_distance += worn;
    wear->sectors[sector_of(instant->angle)] += worn;
}

static double revolutions(const Trajectory *run)
{
    return drive_is_steady(&run->linkage.driver)
               ? (run->duration_s - run->report_from_s) / linkage_period(&run->linkage)
               : 1.0;
}

// Makes the sums of sectors shares, and finds the most worn.
static void share_sectors(double all, Wear *wear)
{
    size_t most = 0;
    for (size_t i = 0; i < WEAR_SECTORS; i++) {
        wear->sectors[i] = all > 0.0 ? wear->sectors[i] / all : 0.0;
        most = wear->sectors[i] > wear->sectors[most] ? i : most;
    }
    wear->angle = all > 0.0 ? 2.0 * M_PI * ((double)most + 0.5) / WEAR_SECTORS : NAN;
    wear->share = all > 0.0 ? wear->sectors[most] : NAN;
}

Wear wear_of(const Trajectory *run, size_t joint)
{
    const Joint *of = &run->linkage.joints[joint];
    Wear wear = {.is_known = false};
    Touch places[TOUCH_CORNERS];
    if (!wear_has(&run->linkage, of) || !trajectory_feels_play(run, of) || run->sample_count < 2 ||
        touch_places(&run->linkage, (int)joint, places) == 0) {
        return wear;
    }
    WearSums sums = {0};
    for (size_t k = 0; k < run->sample_count; k++) {
        if (run->times[k] < run->report_from_s) {
            continue;
        }
        const bool is_end = k == 0 || k + 1 == run->sample_count;
        const double step_s = k > 0 ? run->times[k] - run->times[k - 1] : run->times[1];
        const WearInstant instant = instant_of(run, k, joint, &places[0]);
        add_instant(&instant, is_end ? 0.5 * step_s : step_s, &sums, &wear);
    }
    if (!(sums.contact > 0.0)) {
        return wear;
    }
    const double area = of->clearance.width * 2.0 * of->clearance.pin_radius;
    const double turns = revolutions(run);
    wear.is_known = true;
    wear.friction_work = sums.work > WEAR_ROUNDING * sums.force_distance ? sums.work / turns : NAN;
    wear.distance = sums.distance / turns;
    wear.pressure = area > 0.0 ? sums.force / sums.contact / area : NAN;
    wear.pressure_speed = area > 0.0 ? sums.force_distance / sums.time / area : NAN;
    share_sectors(sums.force_distance, &wear);
    return wear;
}
