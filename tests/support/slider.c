#include "slider.h"

#include "kept.h"
#include "model/joint_rows.h"

#include <assert.h>
#include <stdio.h>

const SliderSizes SLIDER_FLORES = {
    .crank = 0.153,
    .rod = 0.306,
    .masses = {0.038, 0.038, 0.076},
    .inertias = {7.4e-5, 5.9e-4, 2.7e-6},
};

const SliderSizes SLIDER_USUAL = {
    .crank = 0.05,
    .rod = 0.12,
    .masses = {0.30, 0.21, 0.14},
    .inertias = {1.0e-4, 2.5e-4, 1.0e-4},
};

static Body body(const char *name, double mass, double inertia, Motion start)
{
    Body made = {.mass = mass, .inertia = inertia, .start = start};
    snprintf(made.name, sizeof made.name, "%s", name);
    return made;
}

static Joint joint(const char *name, JointKind kind, JointEnd a, JointEnd b)
{
    Joint made = {
        .kind = kind,
        .body_a = a.body,
        .body_b = b.body,
        .anchor_a = a.anchor,
        .anchor_b = b.anchor,
    };
    snprintf(made.name, sizeof made.name, "%s", name);
    return made;
}

static JointEnd at(int body_number, double x, double y)
{
    return (JointEnd){body_number, {x, y}};
}

Scenario slider_crank(const SliderSizes *sizes, double crank_omega)
{
    Scenario scenario = kept_default();
    scenario.gravity = scenario_downward(9.81);
    scenario.run.backend_count = 1;
    scenario.run.backends[0] = BACKEND_REFERENCE;
    Linkage *linkage = &scenario.linkage;
    const double r = sizes->crank;
    const double l = sizes->rod;
    // level: pin and middle of the rod go straight up
    const Motion starts[] = {
        {.position = {0.5 * r, 0.0},
         .velocity = {0.0, 0.5 * r * crank_omega},
         .omega = crank_omega},
        {.position = {r + 0.5 * l, 0.0},
         .velocity = {0.0, 0.5 * r * crank_omega},
         .omega = -r / l * crank_omega},
        {.position = {r + l, 0.0}},
    };
    static const char *const NAMES[] = {"crank", "rod", "slider"};
    linkage->body_count = 3;
    for (int i = 0; i < 3; i++) {
        linkage->bodies[i] = body(NAMES[i], sizes->masses[i], sizes->inertias[i], starts[i]);
    }
    linkage->joint_count = 4;
    linkage->joints[SLIDER_CRANK] =
        joint("ground-crank", JOINT_REVOLUTE, at(LINKAGE_GROUND, 0.0, 0.0), at(0, -0.5 * r, 0.0));
    linkage->joints[SLIDER_PIN] =
        joint("crank-rod", JOINT_REVOLUTE, at(0, 0.5 * r, 0.0), at(1, -0.5 * l, 0.0));
    linkage->joints[SLIDER_WRIST] =
        joint("rod-slider", JOINT_REVOLUTE, at(1, 0.5 * l, 0.0), at(2, 0.0, 0.0));
    linkage->joints[SLIDER_GUIDE] =
        joint("slider-guide", JOINT_PRISMATIC, at(LINKAGE_GROUND, 0.0, 0.0), at(2, 0.0, 0.0));
    return scenario;
}

Scenario slider_driven(const SliderSizes *sizes, double speed)
{
    Scenario scenario = slider_crank(sizes, speed);
    scenario.linkage.driver =
        (Driver){.is_present = true, .joint = SLIDER_CRANK, .speed = speed, .start = 0.0};
    return scenario;
}

void slider_loosen_guide(Scenario *scenario, double opening, double height, double length)
{
    Joint *guide = &scenario->linkage.joints[SLIDER_GUIDE];
    guide->kind = JOINT_GUIDE;
    guide->guide = (Guide){.opening = opening, .height = height, .length = length};
}

Scenario slider_flores_loose(double stiffness)
{
    Scenario scenario = slider_crank(&SLIDER_FLORES, 150.0);
    slider_loosen_guide(&scenario, 0.052, 0.050, 0.100);
    scenario.contact.stiffness = stiffness;
    scenario.contact.exponent = 1.0;
    scenario.contact.damping = DAMPING_EXACT;
    scenario.contact.restitution = 0.4;
    return scenario;
}

void slider_loosen_wrist(Scenario *scenario, double hole_radius, double play)
{
    Joint *wrist = &scenario->linkage.joints[SLIDER_WRIST];
    wrist->kind = JOINT_CLEARANCE;
    wrist->clearance =
        (Clearance){.hole_radius = hole_radius, .pin_radius = hole_radius - play, .width = 0.01};
}

Scenario slider_lever(double speed)
{
    Scenario scenario = kept_default();
    scenario.gravity = scenario_downward(9.81);
    scenario.run.backend_count = 1;
    scenario.run.backends[0] = BACKEND_REFERENCE;
    Linkage *linkage = &scenario.linkage;
    // level, the pin at (0.35, 0): it goes straight up, and the lever turns with it
    const double omega = 0.1 * speed / 0.35;
    const Motion crank = {.position = {0.3, 0.0}, .velocity = {0.0, 0.05 * speed}, .omega = speed};
    const Motion lever = {.position = {0.2, 0.0}, .velocity = {0.0, 0.2 * omega}, .omega = omega};
    const Motion block = {
        .position = {0.36, 0.0}, .velocity = {0.0, 0.1 * speed + 0.01 * omega}, .omega = omega};
    linkage->body_count = 3;
    linkage->bodies[0] = body("crank", 0.1, 1e-4, crank);
    linkage->bodies[1] = body("lever", 0.3, 4e-3, lever);
    linkage->bodies[2] = body("block", 0.05, 2e-5, block);
    linkage->joint_count = 4;
    linkage->joints[0] =
        joint("crank", JOINT_REVOLUTE, at(LINKAGE_GROUND, 0.25, 0.0), at(0, -0.05, 0.0));
    linkage->joints[1] =
        joint("lever", JOINT_REVOLUTE, at(LINKAGE_GROUND, 0.0, 0.0), at(1, -0.2, 0.0));
    linkage->joints[2] = joint("pin", JOINT_REVOLUTE, at(0, 0.05, 0.0), at(2, -0.01, 0.0));
    // the lever's line goes through its pivot and the pin, the anchor of the block is off its
    // centre
    linkage->joints[3] = joint("slide", JOINT_PRISMATIC, at(1, 0.05, 0.0), at(2, 0.02, 0.0));
    linkage->driver = (Driver){.is_present = true, .joint = 0, .speed = speed, .start = 0.0};
    return scenario;
}

double slider_unbalanced(const Scenario *scenario, const Motion *motions, const JointState *states)
{
    const Linkage *linkage = &scenario->linkage;
    double worst = 0.0;
    for (int i = 0; i < (int)linkage->body_count; i++) {
        const Body *of = &linkage->bodies[i];
        Vec2 force = vec2_scale(of->mass, scenario_gravity(scenario));
        double moment = 0.0;
        for (size_t j = 0; j < linkage->joint_count; j++) {
            const Joint *held = &linkage->joints[j];
            if (held->body_a != i && held->body_b != i) {
                continue;
            }
            const double sign = held->body_b == i ? 1.0 : -1.0;
            // the force acts at the anchor on body b, whichever body it is on
            const Vec2 arm =
                vec2_sub(linkage_point(motions, held->body_b, held->anchor_b), motions[i].position);
            const Vec2 push = vec2_scale(sign, states[j].force_on_b);
            force = vec2_add(force, push);
            moment += vec2_cross(arm, push) + sign * states[j].moment_on_b;
        }
        const Vec2 left = vec2_sub(vec2_scale(of->mass, motions[i].acceleration), force);
        worst = fmax(worst, vec2_length(left));
        if (i != linkage_driven_body(linkage)) {
            worst = fmax(worst, fabs(of->inertia * motions[i].alpha - moment));
        }
    }
    return worst;
}
