#include "sliders.h"

#include "mechanism.h"
#include "model/kinematics.h"

#include <stdio.h>
#include <string.h>

static const Vec2 NOWHERE = {0.0, 0.0};
static const double CRANK = 0.05;          // m, of all mechanisms
static const double ROD = 0.12;            // m
static const double PIVOT = -0.13;         // m, x of the rocker's pivot
static const double BEAD_START = 0.1;      // m from the arm's axis
static const Vec2 CORNER = {0.012, 0.005}; // m, of the slider, where its joint is seen from

static Body *add_body(Scenario *scenario, const char *name, double mass, double inertia)
{
    Body *body = &scenario->linkage.bodies[scenario->linkage.body_count++];
    snprintf(body->name, sizeof body->name, "%s", name);
    body->mass = mass;
    body->inertia = inertia;
    return body;
}

static Joint *add_joint(Scenario *scenario, JointKind kind, int a, Vec2 anchor_a, int b,
                        Vec2 anchor_b)
{
    Joint *joint = &scenario->linkage.joints[scenario->linkage.joint_count++];
    *joint =
        (Joint){.kind = kind, .body_a = a, .body_b = b, .anchor_a = anchor_a, .anchor_b = anchor_b};
    snprintf(joint->name, sizeof joint->name, "joint %zu", scenario->linkage.joint_count - 1);
    return joint;
}

static Sliders begin(double speed, double start)
{
    Sliders made = {.scenario = mechanism_default()};
    made.scenario.ode.stepping = ODE_STAGGERED;
    made.scenario.linkage.driver =
        (Driver){.is_present = speed != 0.0, .joint = 0, .speed = speed, .start = start};
    made.scenario.run.samples = 360;
    return made;
}

static Sliders end(Sliders made, void (*motion)(const Scenario *, double, Motion *))
{
    Motion motions[KINEMATICS_BODY_MAX] = {{.angle = 0.0}};
    made.motion = motion;
    motion(&made.scenario, 0.0, motions);
    for (size_t i = 0; i < made.scenario.linkage.body_count; i++) {
        made.scenario.linkage.bodies[i].start = motions[i];
    }
    return made;
}

static Motion crank_at(const Scenario *scenario, double time_s)
{
    const Driver *driver = &scenario->linkage.driver;
    return (Motion){.angle = driver->start + driver->speed * time_s, .omega = driver->speed};
}

// The end of a crank and its velocity and acceleration.
static Motion crank_pin(const Motion *crank)
{
    const double square = crank->omega * crank->omega;
    const Vec2 arm = vec2_rotate(crank->angle, (Vec2){CRANK, 0.0});
    return (Motion){
        .position = arm,
        .velocity = vec2_scale(crank->omega, vec2_perp(arm)),
        .acceleration = vec2_scale(-square, arm),
    };
}

static void crank_motion(const Scenario *scenario, double time_s, Motion *motions)
{
    const Motion crank = crank_at(scenario, time_s);
    const Motion pin = crank_pin(&crank);
    const double phi = -asin(pin.position.y / ROD);
    const double c = cos(phi);
    const double s = sin(phi);
    const double omega = -pin.velocity.y / (ROD * c);
    const double alpha = (ROD * s * omega * omega - pin.acceleration.y) / (ROD * c);
    const Vec2 half = {0.5 * ROD * c, 0.5 * ROD * s};
    const Vec2 half_v = vec2_scale(omega, vec2_perp(half));
    const Vec2 half_a =
        vec2_add(vec2_scale(alpha, vec2_perp(half)), vec2_scale(-omega * omega, half));
    motions[0] = crank;
    motions[1] = (Motion){
        .position = vec2_add(pin.position, half),
        .angle = phi,
        .velocity = vec2_add(pin.velocity, half_v),
        .omega = omega,
        .acceleration = vec2_add(pin.acceleration, half_a),
        .alpha = alpha,
    };
    motions[2] = (Motion){
        .position = {pin.position.x + 2.0 * half.x, 0.0},
        .velocity = {pin.velocity.x + 2.0 * half_v.x, 0.0},
        .acceleration = {pin.acceleration.x + 2.0 * half_a.x, 0.0},
    };
}

Sliders sliders_crank(bool guide_is_ground)
{
    Sliders made = begin(5000.0 * M_PI / 30.0, 0.0);
    Scenario *scenario = &made.scenario;
    add_body(scenario, "crank", 0.3, 1.0e-4);
    add_body(scenario, "rod", 0.21, 2.5e-4);
    add_body(scenario, "slider", 0.14, 1.0e-5);
    add_joint(scenario, JOINT_REVOLUTE, LINKAGE_GROUND, NOWHERE, 0, NOWHERE);
    add_joint(scenario, JOINT_REVOLUTE, 0, (Vec2){CRANK, 0.0}, 1, (Vec2){-0.5 * ROD, 0.0});
    add_joint(scenario, JOINT_REVOLUTE, 1, (Vec2){0.5 * ROD, 0.0}, 2, NOWHERE);
    const Vec2 on_ground = {0.03, CORNER.y};
    if (guide_is_ground) {
        add_joint(scenario, JOINT_PRISMATIC, LINKAGE_GROUND, on_ground, 2, CORNER);
    } else {
        // the line is the slider's own, and runs the other way
        add_joint(scenario, JOINT_PRISMATIC, 2, CORNER, LINKAGE_GROUND, on_ground)->direction =
            M_PI;
    }
    return end(made, crank_motion);
}

void sliders_crank_guide(const Scenario *scenario, double time_s, double *force, double *couple)
{
    const Linkage *linkage = &scenario->linkage;
    Motion motions[SLIDERS_BODY_MAX];
    crank_motion(scenario, time_s, motions);
    const Motion *rod = &motions[1];
    const Vec2 along = vec2_rotate(rod->angle, (Vec2){1.0, 0.0});
    const Vec2 weighed =
        vec2_scale(linkage->bodies[1].mass, vec2_add(rod->acceleration, scenario_upward(scenario)));
    // F on the slider from the rod: its x by Newton, its y by the rod's moments about the middle,
    // I alpha = -(L / 2) along x (m (a + g) + 2 F)
    const double x = linkage->bodies[2].mass * motions[2].acceleration.x;
    const double across =
        -0.5 * (2.0 * linkage->bodies[1].inertia * rod->alpha / ROD + vec2_cross(along, weighed));
    const double y = (across + along.y * x) / along.x;
    *force = linkage->bodies[2].mass * scenario_upward(scenario).y - y;
    // the slider does not turn: what acts on it has no moment about its centre
    const double lever = linkage->joints[3].body_b == 2 ? CORNER.x : 0.03 - motions[2].position.x;
    *couple = -lever * *force;
}

static void yoke_motion(const Scenario *scenario, double time_s, Motion *motions)
{
    motions[0] = crank_at(scenario, time_s);
    motions[1] = crank_pin(&motions[0]);
    motions[2] = motions[1];
    motions[2].position.y = motions[2].velocity.y = motions[2].acceleration.y = 0.0;
}

Sliders sliders_yoke(void)
{
    Sliders made = begin(100.0, 0.3);
    Scenario *scenario = &made.scenario;
    add_body(scenario, "crank", 0.3, 1.0e-4);
    add_body(scenario, "block", 0.05, 1.0e-5);
    add_body(scenario, "yoke", 0.2, 1.0e-4);
    add_joint(scenario, JOINT_REVOLUTE, LINKAGE_GROUND, NOWHERE, 0, NOWHERE);
    add_joint(scenario, JOINT_REVOLUTE, 0, (Vec2){CRANK, 0.0}, 1, NOWHERE);
    add_joint(scenario, JOINT_PRISMATIC, 2, NOWHERE, 1, NOWHERE)->direction = 0.5 * M_PI;
    add_joint(scenario, JOINT_PRISMATIC, LINKAGE_GROUND, NOWHERE, 2, NOWHERE);
    return end(made, yoke_motion);
}

static void quick_return_motion(const Scenario *scenario, double time_s, Motion *motions)
{
    motions[0] = crank_at(scenario, time_s);
    const Motion pin = crank_pin(&motions[0]);
    const Vec2 lever = {pin.position.x - PIVOT, pin.position.y};
    const double square = vec2_dot(lever, lever);
    const double omega = vec2_cross(lever, pin.velocity) / square;
    const double alpha = vec2_cross(lever, pin.acceleration) / square -
                         2.0 * omega * vec2_dot(lever, pin.velocity) / square;
    const double angle = atan2(lever.y, lever.x);
    motions[1] = pin;
    motions[1].angle = angle;
    motions[1].omega = omega;
    motions[1].alpha = alpha;
    motions[2] = (Motion){.position = {PIVOT, 0.0}, .angle = angle, .omega = omega, .alpha = alpha};
}

Sliders sliders_quick_return(void)
{
    Sliders made = begin(100.0, 0.3);
    Scenario *scenario = &made.scenario;
    add_body(scenario, "crank", 0.3, 1.0e-4);
    add_body(scenario, "block", 0.05, 1.0e-5);
    add_body(scenario, "rocker", 0.2, 1.0e-3);
    add_joint(scenario, JOINT_REVOLUTE, LINKAGE_GROUND, NOWHERE, 0, NOWHERE);
    add_joint(scenario, JOINT_REVOLUTE, 0, (Vec2){CRANK, 0.0}, 1, NOWHERE);
    add_joint(scenario, JOINT_PRISMATIC, 2, NOWHERE, 1, NOWHERE);
    add_joint(scenario, JOINT_REVOLUTE, LINKAGE_GROUND, (Vec2){PIVOT, 0.0}, 2, NOWHERE);
    return end(made, quick_return_motion);
}

static void bead_motion(const Scenario *scenario, double time_s, Motion *motions)
{
    motions[0] = crank_at(scenario, time_s);
    const double omega = motions[0].omega;
    const double r = BEAD_START * cosh(omega * time_s);
    const double rate = BEAD_START * omega * sinh(omega * time_s);
    const Vec2 along = vec2_rotate(motions[0].angle, (Vec2){1.0, 0.0});
    motions[1] = (Motion){
        .position = vec2_scale(r, along),
        .angle = motions[0].angle,
        .velocity = vec2_add(vec2_scale(rate, along), vec2_scale(r * omega, vec2_perp(along))),
        .omega = omega,
        .acceleration = vec2_scale(2.0 * rate * omega, vec2_perp(along)),
    };
}

Sliders sliders_bead(void)
{
    Sliders made = begin(10.0, 0.3);
    Scenario *scenario = &made.scenario;
    scenario->gravity = scenario_downward(0.0);
    scenario->run.revolutions = 0.25;
    add_body(scenario, "arm", 0.3, 1.0e-2);
    add_body(scenario, "bead", 0.05, 1.0e-5);
    add_joint(scenario, JOINT_REVOLUTE, LINKAGE_GROUND, NOWHERE, 0, NOWHERE);
    add_joint(scenario, JOINT_PRISMATIC, 0, (Vec2){0.02, 0.001}, 1, (Vec2){0.0, 0.001});
    return end(made, bead_motion);
}

static void trammel_motion(const Scenario *scenario, double time_s, Motion *motions)
{
    const double omega = 20.0;
    const double angle = 0.4 + omega * time_s;
    const Vec2 half = vec2_rotate(angle, (Vec2){0.5 * ROD, 0.0});
    const double square = omega * omega;
    (void)scenario;
    // the rod's ends: (L cos, 0) on one line, (0, L sin) on the other
    motions[0] = (Motion){
        .position = half,
        .angle = -angle,
        .velocity = vec2_scale(omega, vec2_perp(half)),
        .omega = -omega,
        .acceleration = vec2_scale(-square, half),
    };
    motions[1] = (Motion){
        .position = {2.0 * half.x, 0.0},
        .velocity = {-2.0 * omega * half.y, 0.0},
        .acceleration = {-2.0 * square * half.x, 0.0},
    };
    motions[2] = (Motion){
        .position = {0.0, 2.0 * half.y},
        .velocity = {0.0, 2.0 * omega * half.x},
        .acceleration = {0.0, -2.0 * square * half.y},
    };
}

Sliders sliders_trammel(void)
{
    Sliders made = begin(0.0, 0.0);
    Scenario *scenario = &made.scenario;
    scenario->gravity = scenario_downward(0.0);
    scenario->run.duration = 0.5;
    // equal sliders keep the sum of their energies at any angle as the rod turns steadily
    add_body(scenario, "rod", 0.2, 1.0e-4);
    add_body(scenario, "level", 0.05, 1.0e-5);
    add_body(scenario, "upright", 0.05, 1.0e-5);
    add_joint(scenario, JOINT_PRISMATIC, LINKAGE_GROUND, NOWHERE, 1, NOWHERE);
    add_joint(scenario, JOINT_PRISMATIC, LINKAGE_GROUND, NOWHERE, 2, NOWHERE)->direction =
        0.5 * M_PI;
    add_joint(scenario, JOINT_REVOLUTE, 1, NOWHERE, 0, (Vec2){0.5 * ROD, 0.0});
    add_joint(scenario, JOINT_REVOLUTE, 2, NOWHERE, 0, (Vec2){-0.5 * ROD, 0.0});
    return end(made, trammel_motion);
}
