// What does an impact on a flank or stop of a joint's coordinate give back in ODE?
//
// The law is integrated by itself (contact/map_impact.h), with the inertia of the coordinate: of a
// hinge, beside its body's centre, I + m r^2; of gears 1 / (r_a^2 / I_a + r_b^2 / I_b), of a rack
// 1 / (1 / m + r^2 / I).
#include "limited_joint.h"

#include "contact/law.h"
#include "contact/map_impact.h"
#include "run/registry.h"
#include "run/run.h"

#include <stdio.h>

static const double RADII[2] = {0.02, 0.05}; // m, of the gears
static const double ARM = 0.1;               // m, of a hinge

static const double GEAR_DEPTH = 5e-4; // m: no law of theirs holds as deep as their teeth

static const double TURN = 0.05; // rad

// In [0, 1).
static double share(uint64_t *random)
{
    return 0.5 + 0.5 * lcg_draw(random);
}

// How long the contact lasts without damping, s.
static double contact_of(const LimitedImpact *impact)
{
    return M_PI * sqrt(impact->inertia / impact->stiffness);
}

LimitedImpact limited_impact_draw(uint64_t *random, LimitedKind kind, double fewest, double ratio,
                                  double least)
{
    LimitedImpact impact = {
        .kind = kind,
        .is_high = share(random) < 0.5,
        .inertia = pow(10.0, -5.0 + 6.0 * share(random)),
        .stiffness = pow(10.0, 2.0 + 6.0 * share(random)),
        .restitution = least + (1.0 - least) * share(random),
    };
    impact.step = contact_of(&impact) / (fewest * pow(ratio, share(random)));
    // some degrees a step: what turns further is another linkage at its end
    impact.speed = fmin(0.1 + 5.0 * share(random), TURN / impact.step);
    if (kind >= LIMITED_GEARS) {
        impact.speed = fmin(impact.speed, GEAR_DEPTH * M_PI / contact_of(&impact));
    }
    impact.flight = (3.0 + share(random)) * impact.step * impact.speed;
    return impact;
}

static Body *add_limited_body(Linkage *linkage, const char *name, double mass, double inertia)
{
    Body *body = &linkage->bodies[linkage->body_count++];
    snprintf(body->name, sizeof body->name, "%s", name);
    body->mass = mass;
    body->inertia = inertia;
    return body;
}

static Joint *add_limited_joint(Linkage *linkage, const char *name, JointKind kind, int a, int b)
{
    Joint *joint = &linkage->joints[linkage->joint_count++];
    *joint = (Joint){.kind = kind, .body_a = a, .body_b = b};
    snprintf(joint->name, sizeof joint->name, "%s", name);
    return joint;
}

// Two gears on the ground, of which the first turns.
static Joint *add_gears(const LimitedImpact *impact, double speed, Linkage *linkage)
{
    static const char *const NAMES[] = {"pinion", "wheel"};
    for (int i = 0; i < 2; i++) {
        const double inertia = 2.0 * impact->inertia * RADII[i] * RADII[i];
        Body *body = add_limited_body(linkage, NAMES[i], 0.1, inertia);
        body->start.position.x = i == 0 ? 0.0 : RADII[0] + RADII[1];
        Joint *pivot = add_limited_joint(linkage, NAMES[i], JOINT_REVOLUTE, LINKAGE_GROUND, i);
        pivot->anchor_a = body->start.position;
    }
    // q' = -r_a w_a
    linkage->bodies[0].start.omega = -speed / RADII[0];
    Joint *gears = add_limited_joint(linkage, "teeth", JOINT_GEAR, 0, 1);
    gears->gear = (Gear){
        .pivots = {0, 1},
        .teeth = {20.0, 50.0},
        .radius_a = RADII[0],
        .radius_b = RADII[1],
    };
    return gears;
}

// A rack that slides towards the right and down, and its pinion, which is to the right of that and
// stands.
static Joint *add_rack(const LimitedImpact *impact, double speed, Linkage *linkage)
{
    const double along = -0.6;
    Body *rack = add_limited_body(linkage, "rack", 2.0 * impact->inertia, impact->inertia);
    // q' = -v
    rack->start.velocity = vec2_rotate(along, (Vec2){-speed, 0.0});
    Body *pinion =
        add_limited_body(linkage, "pinion", 0.1, 2.0 * impact->inertia * RADII[0] * RADII[0]);
    pinion->start.position = vec2_rotate(along, (Vec2){0.03, -RADII[0]});
    Joint *line = add_limited_joint(linkage, "line", JOINT_PRISMATIC, LINKAGE_GROUND, 0);
    line->direction = along;
    Joint *pivot = add_limited_joint(linkage, "pivot", JOINT_REVOLUTE, LINKAGE_GROUND, 1);
    pivot->anchor_a = pinion->start.position;
    Joint *mesh = add_limited_joint(linkage, "mesh", JOINT_RACK, 0, 1);
    mesh->direction = along;
    mesh->anchor_a = vec2_rotate(along, (Vec2){0.03, 0.0});
    mesh->gear = (Gear){.pivots = {0, 1}, .radius_a = INFINITY, .radius_b = -RADII[0]};
    return mesh;
}

static Joint *add_hinge(const LimitedImpact *impact, double speed, Linkage *linkage)
{
    const double mass = 0.5 * impact->inertia / (ARM * ARM);
    Body *body = add_limited_body(linkage, "arm", mass, 0.5 * impact->inertia);
    body->start = (Motion){.position = {ARM, 0.0}, .velocity = {0.0, ARM * speed}, .omega = speed};
    Joint *hinge = add_limited_joint(linkage, "hinge", JOINT_REVOLUTE, LINKAGE_GROUND, 0);
    hinge->anchor_b.x = -ARM;
    return hinge;
}

static Joint *add_slider(const LimitedImpact *impact, double speed, Linkage *linkage)
{
    Body *body = add_limited_body(linkage, "block", impact->inertia, impact->inertia);
    Joint *slider = add_limited_joint(linkage, "slider", JOINT_PRISMATIC, LINKAGE_GROUND, 0);
    slider->direction = 0.7;
    body->start.velocity = vec2_rotate(slider->direction, (Vec2){speed, 0.0});
    return slider;
}

static Limits limits_of(const LimitedImpact *impact)
{
    const bool is_stop = impact->kind == LIMITED_HINGE_STOP || impact->kind == LIMITED_SLIDER_STOP;
    if (is_stop) {
        return (Limits){
            .kind = LIMIT_STOPS,
            .low = impact->is_high ? -INFINITY : -impact->flight,
            .high = impact->is_high ? impact->flight : INFINITY,
        };
    }
    // the other flank is too far away to be met
    const double backlash = 4.0 * impact->flight + 6.0 * contact_of(impact) * impact->speed;
    const double middle = impact->flight - 0.5 * backlash;
    return (Limits){
        .kind = LIMIT_BACKLASH,
        .backlash = backlash,
        .middle = impact->is_high ? middle : -middle,
    };
}

Scenario limited_impact_scenario(const LimitedImpact *impact, OdeStepping stepping, OdeMap map,
                                 OdeSolver solver)
{
    Scenario scenario = scenario_default();
    Linkage *linkage = &scenario.linkage;
    const double speed = impact->is_high ? impact->speed : -impact->speed;
    *linkage = linkage_create((LinkageRoom){.bodies = 2, .joints = 3});
    Joint *joint = impact->kind <= LIMITED_HINGE_BACKLASH    ? add_hinge(impact, speed, linkage)
                   : impact->kind <= LIMITED_SLIDER_BACKLASH ? add_slider(impact, speed, linkage)
                   : impact->kind == LIMITED_GEARS           ? add_gears(impact, speed, linkage)
                                                             : add_rack(impact, speed, linkage);
    joint->limits = limits_of(impact);
    joint->contact = (JointContact){
        .stiffness = impact->stiffness,
        .exponent = 1.0,
        .has_restitution = true,
        .restitution = impact->restitution,
    };
    scenario.gravity = scenario_downward(0.0);
    scenario.contact.damping = DAMPING_EXACT;
    scenario.contact.impact_speed_floor = 1e-6;
    scenario.ode.stepping = stepping;
    scenario.ode.map = map;
    scenario.ode.solver = solver;
    scenario.run.step = impact->step;
    scenario.run.duration =
        impact->flight / impact->speed + 4.0 * contact_of(impact) + 4.0 * impact->step;
    scenario.run.samples = 2;
    return scenario;
}

// The speed of the coordinate in the last sample.
static double speed_after(const LimitedImpact *impact, const Scenario *scenario,
                          const Trajectory *run)
{
    const Motion *motions = trajectory_motion(run, run->sample_count - 1, 0);
    const int joint = (int)scenario->linkage.joint_count - 1;
    return coordinate_rate(&scenario->linkage, motions, joint) * (impact->is_high ? -1.0 : 1.0);
}

LimitedOff limited_impact_run(const LimitedImpact *impact, OdeStepping stepping, OdeMap map,
                              OdeSolver solver)
{
    Scenario scenario = limited_impact_scenario(impact, stepping, map, solver);
    const size_t number = scenario.linkage.joint_count - 1;
    LimitedOff off = {NAN, NAN, NAN};
    ForceLaw law;
    Err err = {ERR_NONE, ""};
    Trajectory *run = run_scenario(&scenario, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
    const JointExtremes *joint = &run->joints[number];
    if (law_of_joint(&scenario, &scenario.linkage.joints[number], &law, &err) && run->is_complete &&
        joint->impacts == 1) {
        const MapImpact asked = map_impact_law(
            &(MapImpactCase){.law = law, .mass = impact->inertia, .speed = impact->speed});
        const double after = speed_after(impact, &scenario, run);
        off.restitution = fabs(after / impact->speed / asked.restitution - 1.0);
        off.force = fabs(joint->force_max.value / asked.force_max - 1.0);
        off.depth = fabs(joint->penetration_max.value / asked.penetration_max - 1.0);
    }
    trajectory_destroy(run);
    scenario_free(&scenario);
    return off;
}

static double worse(double a, double b)
{
    return isnan(a) || a >= b ? a : b;
}

LimitedOff limited_worse(LimitedOff a, LimitedOff b)
{
    return (LimitedOff){
        .restitution = worse(a.restitution, b.restitution),
        .force = worse(a.force, b.force),
        .depth = worse(a.depth, b.depth),
    };
}
