// How much do accelerations and forces vary without any play?
//
// The linkage is closed at angles of the crank a degree apart, and the forces follow from the
// equations of motion (analytic/inverse_dynamics.c). Between two of the angles a curve with a swing
// in 30 degrees rises by half a percent of itself at most.
#include "run/spike_scale.h"

#include "analytic/closed_form.h"
#include "analytic/inverse_dynamics.h"
#include "base/dense.h"
#include "model/kinematics.h"
#include "model/space.h"

#include <math.h>

enum { ANGLES = 360 };

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

static bool move_to(const Scenario *scenario, double crank_rad, Motion *motions)
{
    if (scenario_has_closed_form(scenario)) {
        return closed_form_bodies(scenario, crank_rad, motions);
    }
    Err unused = {ERR_NONE, ""};
    return kinematics_solve(&scenario->linkage, crank_rad, motions, &unused) &&
           moves_freely(&scenario->linkage, motions);
}

SpikeScale spike_scale(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    SpikeScale scale = {.is_known = linkage->driver.is_present && space_has_plane(linkage)};
    scale.alpha = linkage->driver.speed * linkage->driver.speed;
    double least[LINKAGE_BODY_MAX] = {0.0};
    double most[LINKAGE_BODY_MAX] = {0.0};
    Motion motions[LINKAGE_BODY_MAX];
    linkage_start(linkage, motions);
    for (int k = 0; scale.is_known && k < ANGLES; k++) {
        Err unused = {ERR_NONE, ""};
        Reactions reactions;
        const double crank_rad = linkage->driver.start + 2.0 * M_PI * k / ANGLES;
        scale.is_known =
            move_to(scenario, crank_rad, motions) &&
            inverse_dynamics_solve(linkage, motions, scenario->gravity, &reactions, &unused);
        for (size_t i = 0; scale.is_known && i < linkage->body_count; i++) {
            least[i] = fmin(least[i], motions[i].alpha);
            most[i] = fmax(most[i], motions[i].alpha);
            scale.alpha = fmax(scale.alpha, most[i] - least[i]);
        }
        for (size_t i = 0; scale.is_known && i < linkage->joint_count; i++) {
            scale.force = fmax(scale.force, vec2_length(reactions.force_on_b[i]));
        }
    }
    scale.is_known = scale.is_known && scale.force > 0.0;
    return scale;
}
