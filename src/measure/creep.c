// Computes in what share of the time a joint's friction is not that of sliding.
#include "measure/creep.h"

#include "contact/law.h"
#include "contact/touch.h"

#include <math.h>

// of the loaded time: a joint that turns to and fro is slow for less than that at its reversals
static const double CREEP_NOTED = 0.05;

// A joint in one sample: whether it touches, and whether it slides anywhere faster than that, m/s.
static bool touches_at(const Trajectory *run, size_t sample, const Touch *places, size_t count,
                       double speed, bool *is_fast)
{
    const Motion *motions = trajectory_motion(run, sample, 0);
    bool touches = false;
    *is_fast = false;
    for (size_t i = 0; i < count; i++) {
        const TouchPose pose = touch_pose(&run->linkage, &places[i], motions);
        if (pose.gap < 0.0 && pose.has_normal) {
            touches = true;
            *is_fast =
                *is_fast || fabs(touch_sliding(&run->linkage, &places[i], &pose, motions)) > speed;
        }
    }
    return touches;
}

double creep_share(const Scenario *scenario, const Trajectory *run, size_t joint)
{
    const Joint *of = &run->linkage.joints[joint];
    const ContactOptions own = law_options(&scenario->contact, of);
    if (!trajectory_feels_play(run, of) || linkage_is_torsional(of) || run->linkage.is_spatial ||
        !(own.friction > 0.0) || own.friction_law != BRISTLE_REGULARIZED ||
        own.model != CONTACT_IMPACT) {
        return NAN;
    }
    Touch places[TOUCH_CORNERS];
    const size_t count = touch_places(&run->linkage, (int)joint, places);
    size_t loaded = 0;
    size_t slow = 0;
    for (size_t k = 0; k < run->sample_count; k++) {
        bool is_fast;
        if (touches_at(run, k, places, count, own.friction_speed, &is_fast)) {
            loaded++;
            slow += is_fast ? 0 : 1;
        }
    }
    return loaded > 0 ? (double)slow / (double)loaded : NAN;
}

int creep_worst(const Scenario *scenario, const Trajectory *run, double *most)
{
    int worst = -1;
    *most = CREEP_NOTED;
    for (size_t i = 0; i < run->joint_count; i++) {
        const double share = creep_share(scenario, run, i);
        if (share > *most) {
            *most = share;
            worst = (int)i;
        }
    }
    return worst;
}
