// cases/paper/impact-k66.yaml in numbers. The crank is a body without dynamics whose origin is its
// pivot, so that its angular velocity is all that there is to it.
#include "hand_four_bar.h"

#include <math.h>
#include <string.h>

static const double GROUND = 0.254; // m, as are the three links' lengths
static const double LENGTHS[HAND_BODIES] = {0.108, 0.2794, 0.2705};
static const double MASSES[HAND_BODIES] = {0.12, 0.29, 0.28};                    // kg
static const double INERTIAS[HAND_BODIES] = {173.92e-6, 2070.46e-6, 1988.39e-6}; // kg m^2

static dBodyID make_link(dWorldID world, int link, const HandMotion *motion)
{
    dMass mass;
    const double inertia = INERTIAS[link];
    dMassSetParameters(&mass, MASSES[link], 0, 0, 0, inertia, inertia, inertia, 0, 0, 0);
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &mass);
    const dQuaternion turn = {cos(0.5 * motion->angle), 0.0, 0.0, sin(0.5 * motion->angle)};
    dBodySetQuaternion(body, turn);
    dBodySetAngularVel(body, 0, 0, motion->omega);
    if (link == 0) {
        dBodySetKinematic(body);
    } else {
        dBodySetPosition(body, motion->position[0], motion->position[1], 0);
        dBodySetLinearVel(body, motion->velocity[0], motion->velocity[1], 0);
    }
    return body;
}

static void make_hinge(dWorldID world, dBodyID first, dBodyID second, const dReal *anchor)
{
    const dJointID hinge = dJointCreateHinge(world, 0);
    dJointAttach(hinge, first, second);
    dJointSetHingeAnchor(hinge, anchor[0], anchor[1], 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
}

static JpPinInHole pin_of(const HandOptions *options)
{
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = options->hole_radius;
    pin.pin_radius = pin.hole_radius - 14.5e-6;
    pin.hole[0] = LENGTHS[0];
    pin.pin[0] = -0.5 * LENGTHS[1];
    pin.contact.stiffness = 6.6e10;
    pin.contact.exponent = 1.5;
    pin.contact.damping = JP_DAMPING_LANKARANI_NIKRAVESH;
    pin.contact.restitution = 0.9;
    pin.contact.speed_floor = options->speed_floor;
    pin.contact.resting_speed = options->resting_speed;
    pin.friction = options->friction;
    pin.friction_speed = options->friction_speed;
    return pin;
}

bool hand_four_bar_make(const HandOptions *options, const HandMotion start[HAND_BODIES],
                        HandFourBar *made, JpError *error)
{
    *made = (HandFourBar){.world = dWorldCreate()};
    dWorldSetGravity(made->world, 0, -9.80665, 0);
    dWorldSetERP(made->world, options->erp);
    for (int i = 0; i < HAND_BODIES; i++) {
        made->bodies[i] = make_link(made->world, i, &start[i]);
    }
    dVector3 end;
    dBodyGetRelPointPos(made->bodies[1], 0.5 * LENGTHS[1], 0, 0, end);
    make_hinge(made->world, made->bodies[1], made->bodies[2], end);
    make_hinge(made->world, made->bodies[2], 0, (dVector3){GROUND, 0, 0});
    const JpPinInHole pin = pin_of(options);
    JpWorldOptions chosen = jp_world_options_default();
    chosen.stepping = options->stepping;
    return jp_world_create(made->world, &chosen, &made->play, error) == JP_OK &&
           jp_pin_create(made->play, made->bodies[0], made->bodies[1], &pin, &made->pin, error) ==
               JP_OK;
}

void hand_four_bar_destroy(HandFourBar *made)
{
    jp_world_destroy(made->play);
    dWorldDestroy(made->world);
}

HandOptions hand_four_bar_options(const Scenario *scenario, JpStepping stepping, double erp)
{
    return (HandOptions){
        .stepping = stepping,
        .hole_radius = scenario->linkage.joints[1].clearance.hole_radius,
        .friction = scenario->contact.friction,
        .friction_speed = scenario->contact.friction_speed,
        .speed_floor = scenario->contact.impact_speed_floor,
        .resting_speed = scenario->contact.resting_speed,
        .erp = erp,
    };
}

void hand_four_bar_start(const Trajectory *truth, HandMotion start[HAND_BODIES])
{
    for (size_t i = 0; i < HAND_BODIES; i++) {
        const Motion *motion = trajectory_motion(truth, 0, i);
        start[i] = (HandMotion){
            .position = {motion->position.x, motion->position.y},
            .angle = motion->angle,
            .velocity = {motion->velocity.x, motion->velocity.y},
            .omega = motion->omega,
        };
    }
}

static double error_of(const Trajectory *truth, size_t sample, const double omega[HAND_BODIES])
{
    double largest = 0.0;
    for (size_t i = 1; i < HAND_BODIES; i++) {
        double scale = 0.0;
        for (size_t k = 0; k < truth->sample_count; k++) {
            scale = fmax(scale, fabs(trajectory_motion(truth, k, i)->omega));
        }
        largest =
            fmax(largest, fabs(omega[i] - trajectory_motion(truth, sample, i)->omega) / scale);
    }
    return largest;
}

double hand_four_bar_error(const HandFourBar *bar, const Trajectory *truth, size_t sample)
{
    double omega[HAND_BODIES];
    for (size_t i = 0; i < HAND_BODIES; i++) {
        omega[i] = dBodyGetAngularVel(bar->bodies[i])[2];
    }
    return error_of(truth, sample, omega);
}

double hand_four_bar_run_error(const Trajectory *run, const Trajectory *truth)
{
    double largest = 0.0;
    for (size_t k = 0; k < truth->sample_count; k++) {
        double omega[HAND_BODIES];
        for (size_t i = 0; i < HAND_BODIES; i++) {
            omega[i] = trajectory_motion(run, k, i)->omega;
        }
        largest = fmax(largest, error_of(truth, k, omega));
    }
    return largest;
}
