// Which closed form has a case?
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

bool closed_form_bodies(const Scenario *scenario, double crank_angle,
                        Motion motions[CLOSED_FORM_BODIES])
{
    const double speed = scenario->linkage.driver.speed;
    if (scenario->has_slidercrank) {
        return slidercrank_motion_bodies(&scenario->slidercrank, speed, crank_angle, motions);
    }
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario->fourbar);
    return fourbar_motion_bodies(&lengths, speed, crank_angle, motions);
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
