#include "mechanism.h"

#include "kept.h"
#include "model/kinematics.h"

#include <assert.h>
#include <stdio.h>

static void add_placed_body(Linkage *linkage, const char *name, double mass, double inertia,
                            Vec2 position, double angle)
{
    Body *body = &linkage->bodies[linkage->body_count++];
    snprintf(body->name, sizeof body->name, "%s", name);
    body->mass = mass;
    body->inertia = inertia;
    body->start = (Motion){.position = position, .angle = angle};
}

static void add_anchored_joint(Linkage *linkage, const char *name, int a, Vec2 anchor_a, int b,
                               Vec2 anchor_b)
{
    Joint *joint = &linkage->joints[linkage->joint_count++];
    *joint = (Joint){.body_a = a, .body_b = b, .anchor_a = anchor_a, .anchor_b = anchor_b};
    snprintf(joint->name, sizeof joint->name, "%s", name);
}

static void assemble(Scenario *scenario)
{
    Linkage *linkage = &scenario->linkage;
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(linkage, motions);
    Err err = {ERR_NONE, ""};
    const bool is_closed = kinematics_solve(linkage, linkage->driver.start, motions, &err);
    assert(is_closed);
    (void)is_closed;
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i].start = motions[i];
    }
}

Scenario mechanism_default(void)
{
    Scenario scenario = kept_default();
    scenario.run.step = 1e-6;
    scenario.run.backend_count = 2;
    scenario.run.backends[0] = BACKEND_ANALYTIC;
    scenario.run.backends[1] = BACKEND_ODE;
    scenario.ode.stepping = ODE_PLAIN;
    scenario.ode.map = ODE_MAP_TEXTBOOK;
    return scenario;
}

Scenario mechanism_paper(void)
{
    Scenario scenario = mechanism_default();
    scenario.has_fourbar = true;
    scenario.fourbar = (FourBar){
        .ground = {0.254, -5e-4, 5e-4},
        .crank = {0.108, -3e-4, 3e-4},
        .coupler = {0.2794, -5e-4, 5e-4},
        .follower = {0.2705, -5e-4, 5e-4},
        .assembly = ASSEMBLY_OPEN,
    };
    Linkage *linkage = &scenario.linkage;
    // guesses good enough for Newton's method to find the open assembly
    add_placed_body(linkage, "crank", 0.12, 173.92e-6, (Vec2){0.054, 0.0}, 0.0);
    add_placed_body(linkage, "coupler", 0.29, 2070.46e-6, (Vec2){0.19, 0.12}, 1.0);
    add_placed_body(linkage, "follower", 0.28, 1988.39e-6, (Vec2){0.27, 0.13}, 1.5);
    add_anchored_joint(linkage, "ground-crank", LINKAGE_GROUND, (Vec2){0.0, 0.0}, 0,
                       (Vec2){-0.054, 0.0});
    add_anchored_joint(linkage, "crank-coupler", 0, (Vec2){0.054, 0.0}, 1, (Vec2){-0.1397, 0.0});
    add_anchored_joint(linkage, "coupler-follower", 1, (Vec2){0.1397, 0.0}, 2,
                       (Vec2){0.13525, 0.0});
    add_anchored_joint(linkage, "follower-ground", 2, (Vec2){-0.13525, 0.0}, LINKAGE_GROUND,
                       (Vec2){0.254, 0.0});
    linkage->driver = (Driver){.is_present = true, .speed = 1000.0 * 2.0 * M_PI / 60.0};
    assemble(&scenario);
    return scenario;
}

void mechanism_loosen(Scenario *scenario, const char *joint)
{
    const int number = linkage_find_joint(&scenario->linkage, joint);
    assert(number >= 0);
    scenario->linkage.joints[number].kind = JOINT_CLEARANCE;
    scenario->linkage.joints[number].clearance = (Clearance){
        .hole_radius = 5.0075e-3,
        .pin_radius = 4.993e-3,
        .width = 13e-3,
    };
}

Scenario mechanism_loose(size_t joints)
{
    static const char *const JOINTS[] = {"crank-coupler", "coupler-follower", "follower-ground"};
    Scenario scenario = mechanism_paper();
    for (size_t i = 0; i < joints; i++) {
        mechanism_loosen(&scenario, JOINTS[i]);
    }
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.exponent = 1.5;
    scenario.run.revolutions = 0.2;
    return scenario;
}

Scenario mechanism_pin(double mass, double radial_clearance)
{
    Scenario scenario = mechanism_default();
    scenario.gravity = scenario_downward(0.0);
    Linkage *linkage = &scenario.linkage;
    add_placed_body(linkage, "pin", mass, 1e-6, (Vec2){0.0, 0.0}, 0.0);
    add_anchored_joint(linkage, "hole", LINKAGE_GROUND, (Vec2){0.0, 0.0}, 0, (Vec2){0.0, 0.0});
    linkage->joints[0].kind = JOINT_CLEARANCE;
    linkage->joints[0].clearance = (Clearance){
        .hole_radius = 5e-3 + radial_clearance,
        .pin_radius = 5e-3,
        .width = 10e-3,
    };
    scenario.run.backend_count = 1;
    scenario.run.backends[0] = BACKEND_ODE;
    return scenario;
}

Scenario mechanism_parallelogram(void)
{
    Scenario scenario = mechanism_default();
    Linkage *linkage = &scenario.linkage;
    add_placed_body(linkage, "first", 1.0, 0.1, (Vec2){0.0, 0.5}, 0.5 * M_PI);
    add_placed_body(linkage, "second", 1.0, 0.1, (Vec2){1.0, 0.5}, 0.5 * M_PI);
    add_placed_body(linkage, "third", 1.0, 0.1, (Vec2){2.0, 0.5}, 0.5 * M_PI);
    add_placed_body(linkage, "bar", 1.0, 0.1, (Vec2){1.0, 1.0}, 0.0);
    for (int i = 0; i < 3; i++) {
        char name[LINKAGE_NAME_SIZE];
        snprintf(name, sizeof name, "foot-%d", i);
        add_anchored_joint(linkage, name, LINKAGE_GROUND, (Vec2){i, 0.0}, i, (Vec2){-0.5, 0.0});
        snprintf(name, sizeof name, "head-%d", i);
        add_anchored_joint(linkage, name, i, (Vec2){0.5, 0.0}, 3, (Vec2){i - 1.0, 0.0});
    }
    linkage->driver = (Driver){.is_present = true, .speed = 1.0, .start = 0.5 * M_PI};
    return scenario;
}

Scenario mechanism_slidercrank(double offset, double line, SliderSide side)
{
    Scenario scenario = mechanism_default();
    scenario.has_slidercrank = true;
    scenario.slidercrank = (SliderCrank){0.05, 0.12, offset, line, side};
    const double sign = side == SLIDER_RIGHT ? 1.0 : -1.0;
    const Vec2 along = vec2_rotate(line, (Vec2){1.0, 0.0});
    const Vec2 start = vec2_scale(offset, vec2_perp(along));
    Linkage *linkage = &scenario.linkage;
    // guesses good enough for Newton's method to find the slider on its side
    const double crank = line + 0.4;
    const Vec2 pin = vec2_rotate(crank, (Vec2){0.05, 0.0});
    const Vec2 slider = vec2_add(start, vec2_scale(sign * 0.11, along));
    const Vec2 rod = vec2_sub(slider, pin);
    add_placed_body(linkage, "crank", 0.30, 1.0e-4, vec2_scale(0.5, pin), crank);
    add_placed_body(linkage, "rod", 0.21, 2.5e-4, vec2_scale(0.5, vec2_add(pin, slider)),
                    atan2(rod.y, rod.x));
    add_placed_body(linkage, "slider", 0.14, 1.0e-4, slider, line);
    add_anchored_joint(linkage, "ground-crank", LINKAGE_GROUND, (Vec2){0.0, 0.0}, 0,
                       (Vec2){-0.025, 0.0});
    add_anchored_joint(linkage, "crank-rod", 0, (Vec2){0.025, 0.0}, 1, (Vec2){-0.06, 0.0});
    add_anchored_joint(linkage, "rod-slider", 1, (Vec2){0.06, 0.0}, 2, (Vec2){0.0, 0.0});
    add_anchored_joint(linkage, "slider-guide", LINKAGE_GROUND, start, 2, (Vec2){0.0, 0.0});
    linkage->joints[3].kind = JOINT_PRISMATIC;
    linkage->joints[3].direction = line;
    linkage->joints[3].held_angle = line;
    linkage->driver =
        (Driver){.is_present = true, .speed = 5000.0 * 2.0 * M_PI / 60.0, .start = crank};
    assemble(&scenario);
    return scenario;
}

Linkage mechanism_chain(size_t count, double length, double mass)
{
    Linkage linkage = linkage_create((LinkageRoom){.bodies = count, .joints = count});
    const Vec2 half = {0.5 * length, 0.0};
    for (size_t i = 0; i < count; i++) {
        char name[LINKAGE_NAME_SIZE];
        snprintf(name, sizeof name, "link-%zu", i);
        add_placed_body(&linkage, name, mass, mass * length * length / 12.0,
                        (Vec2){length * ((double)i + 0.5), 0.0}, 0.0);
        snprintf(name, sizeof name, "pin-%zu", i);
        add_anchored_joint(&linkage, name, (int)i - 1, i > 0 ? half : (Vec2){0.0, 0.0}, (int)i,
                           vec2_scale(-1.0, half));
        linkage.joints[i].space.axis = (Vec3){0.0, 0.0, 1.0};
    }
    return linkage;
}
