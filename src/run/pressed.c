// Puts each pin where the reaction of an ideal joint would hold it.
//
// With R the reaction on body b of the ideal joint at time zero, the wall presses the pin along R,
// so it lies on the far side: eccentricity e = -c R / |R|, c the radial clearance. A block lies on
// the guide that R pushes it away from.
#include "run/pressed.h"

#include "analytic/inverse_dynamics.h"
#include "base/zeroed.h"
#include "casefile/build.h"

#include <math.h>
#include <stdlib.h>

static void press_joint(const Joint *joint, const Motion *motions, Vec2 reaction, Joint *pressed)
{
    const double clearance = linkage_radial_clearance(joint);
    const double size = vec2_length(reaction);
    if (!(size > 0.0)) {
        return;
    }
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        pressed->clearance.start = vec2_scale(-clearance / size, reaction);
        break;
    case JOINT_TOUCHES_GUIDES: {
        const double angle = joint->body_a == LINKAGE_GROUND ? 0.0 : motions[joint->body_a].angle;
        const Vec2 across = vec2_perp(vec2_rotate(angle + joint->direction, (Vec2){1.0, 0.0}));
        pressed->guide.start = (Vec2){-copysign(clearance, vec2_dot(reaction, across)), 0.0};
        break;
    }
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_DISC:
    case JOINT_TOUCHES_TEETH:
        break;
    }
}

bool pressed_start(Scenario *scenario, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    if (linkage->is_spatial || !build_is_determined(linkage) ||
        linkage->joint_count > KINEMATICS_JOINT_MAX) {
        return err_set(err, ERR_SOLVER,
                       "pins are pressed in the plane, where drive and ideal joints determine the "
                       "motion; allowed here: run.start: settled or centred");
    }
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    Reactions *reactions = zeroed(1, sizeof *reactions);
    Linkage pressed = linkage_copy(linkage);
    bool is_good = inverse_dynamics_solve(linkage, motions, scenario_gravity(scenario),
                                          (InverseTime){0.0, 0.0}, reactions, err);
    if (is_good) {
        for (size_t i = 0; i < linkage->joint_count; i++) {
            press_joint(&linkage->joints[i], motions, reactions->force_on_b[i], &pressed.joints[i]);
        }
        is_good = build_start(&pressed, motions, err);
    }
    if (is_good) {
        linkage_free(&scenario->linkage);
        scenario->linkage = pressed;
    } else {
        linkage_free(&pressed);
    }
    free(reactions);
    free(motions);
    return is_good;
}
