// Chooses the closed form that a case has.
#include "analytic/closed_form.h"

#include "analytic/fourbar_motion.h"
#include "analytic/slidercrank_motion.h"

const char *closed_form_name(const Scenario *scenario)
{
    return scenario->has_slidercrank ? "slider-crank" : "four-bar";
}

bool closed_form_turns(const Scenario *scenario)
{
    return scenario->has_slidercrank ? slidercrank_turns(&scenario->slidercrank)
                                     : fourbar_crank_turns(&scenario->fourbar);
}

static bool bodies_at(const Scenario *scenario, double speed, double crank_angle,
                      Motion motions[CLOSED_FORM_BODIES])
{
    if (scenario->has_slidercrank) {
        return slidercrank_motion_bodies(&scenario->slidercrank, speed, crank_angle, motions);
    }
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario->fourbar);
    return fourbar_motion_bodies(&lengths, speed, crank_angle, motions);
}

bool closed_form_bodies(const Scenario *scenario, double crank_angle,
                        Motion motions[CLOSED_FORM_BODIES])
{
    return bodies_at(scenario, scenario->linkage.driver.speed, crank_angle, motions);
}

// With k the velocities at a speed of 1 and k' the accelerations there:
//     v = k omega,   a = k' omega^2 + k alpha
bool closed_form_driven(const Scenario *scenario, const DriveState *drive,
                        Motion motions[CLOSED_FORM_BODIES])
{
    if (!bodies_at(scenario, 1.0, drive->angle, motions)) {
        return false;
    }
    const double square = drive->omega * drive->omega;
    for (size_t i = 0; i < CLOSED_FORM_BODIES; i++) {
        Motion *motion = &motions[i];
        motion->acceleration = vec2_add(vec2_scale(square, motion->acceleration),
                                        vec2_scale(drive->alpha, motion->velocity));
        motion->alpha = square * motion->alpha + drive->alpha * motion->omega;
        motion->velocity = vec2_scale(drive->omega, motion->velocity);
        motion->omega *= drive->omega;
    }
    return true;
}

static void slidercrank_extremes(const Scenario *scenario, size_t body, double first_angle,
                                 double last_angle, CurveExtreme *omega, CurveExtreme *alpha)
{
    if (body > 1) {
        // a slider does not turn
        *omega = (CurveExtreme){.low_angle = first_angle, .high_angle = first_angle};
        *alpha = *omega;
        return;
    }
    const double speed = scenario->linkage.driver.speed;
    *omega = slidercrank_motion_extreme(&scenario->slidercrank, speed, SLIDERCRANK_ROD_OMEGA,
                                        first_angle, last_angle);
    *alpha = slidercrank_motion_extreme(&scenario->slidercrank, speed, SLIDERCRANK_ROD_ALPHA,
                                        first_angle, last_angle);
}

void closed_form_extremes(const Scenario *scenario, size_t body, double first_angle,
                          double last_angle, CurveExtreme *omega, CurveExtreme *alpha)
{
    if (scenario->has_slidercrank) {
        slidercrank_extremes(scenario, body, first_angle, last_angle, omega, alpha);
        return;
    }
    const double speed = scenario->linkage.driver.speed;
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario->fourbar);
    *omega = fourbar_motion_extreme(&lengths, speed,
                                    body == 1 ? FOURBAR_COUPLER_OMEGA : FOURBAR_FOLLOWER_OMEGA,
                                    first_angle, last_angle);
    *alpha = fourbar_motion_extreme(&lengths, speed,
                                    body == 1 ? FOURBAR_COUPLER_ALPHA : FOURBAR_FOLLOWER_ALPHA,
                                    first_angle, last_angle);
}
