// Which bodies are joined where, and is that a linkage at all?
#include "model/linkage.h"

#include <stdio.h>
#include <string.h>

double linkage_radial_clearance(const Joint *joint)
{
    switch (joint->kind) {
    case JOINT_CLEARANCE:
        return joint->clearance.hole_radius - joint->clearance.pin_radius;
    case JOINT_GUIDE:
        return 0.5 * fabs(joint->guide.opening - joint->guide.height);
    default:
        return 0.0;
    }
}

double linkage_guide_gap(const Guide *guide, double offset, double tilt)
{
    const double end = 0.5 * guide->length * fabs(sin(tilt));
    const double side = 0.5 * guide->height * cos(tilt);
    return guide->height > guide->opening ? side - end - fabs(offset) - 0.5 * guide->opening
                                          : 0.5 * guide->opening - fabs(offset) - side - end;
}

// h cos t + l sin t = opening of a block, h cos t - l sin t = opening of a sleeve.
double linkage_guide_tilt(const Guide *guide)
{
    const double diagonal = hypot(guide->length, guide->height);
    if (!(guide->opening < diagonal)) {
        return M_PI;
    }
    return fabs(atan2(guide->length, guide->height) - acos(guide->opening / diagonal));
}

bool linkage_is_ideal(const Linkage *linkage, size_t joint)
{
    return linkage_kind_is_ideal(linkage->joints[joint].kind) &&
           !(linkage->driver.is_present && linkage->driver.joint == (int)joint);
}

void linkage_turning(const Linkage *linkage, int joint, int *turned, int *against)
{
    const Joint *of = &linkage->joints[joint];
    const bool is_b = of->body_b != LINKAGE_GROUND;
    *turned = is_b ? of->body_b : of->body_a;
    *against = is_b ? of->body_a : of->body_b;
}

int linkage_driven_body(const Linkage *linkage)
{
    return linkage->driver.is_present ? linkage->joints[linkage->driver.joint].body_b
                                      : LINKAGE_GROUND;
}

double linkage_crank_angle(const Linkage *linkage, double time_s)
{
    const Driver *driver = &linkage->driver;
    return driver->is_present ? drive_angle(driver, time_s) : 0.0;
}

void linkage_describe_instant(const Linkage *linkage, double time_s,
                              char text[LINKAGE_INSTANT_SIZE])
{
    const int length = snprintf(text, LINKAGE_INSTANT_SIZE, "at %.9g ms", 1e3 * time_s);
    if (linkage->driver.is_present) {
        snprintf(text + length, LINKAGE_INSTANT_SIZE - (size_t)length, ", crank angle %.6g deg",
                 linkage_crank_angle(linkage, time_s) * 180.0 / M_PI);
    }
}

double linkage_period(const Linkage *linkage)
{
    return drive_is_steady(&linkage->driver) ? 2.0 * M_PI / fabs(linkage->driver.speed) : 0.0;
}

// How far a body goes beyond its anchor in a joint that slides or stops, m.
static double size_beyond(const Joint *joint, int side)
{
    if (joint->kind == JOINT_GUIDE && side == 1) {
        return 0.5 * hypot(joint->guide.height, joint->guide.length);
    }
    if (joint->kind == JOINT_STOP) {
        return side == 0 ? joint->stop.radius_a : joint->stop.radius_b;
    }
    return 0.0;
}

double linkage_reach(const Linkage *linkage, int body)
{
    const Body *own = &linkage->bodies[body];
    double reach = sqrt(own->inertia / own->mass);
    for (size_t i = 0; i < 2 * linkage->joint_count; i++) {
        const JointEnd end = linkage_end(&linkage->joints[i / 2], i % 2);
        const double above =
            linkage->is_spatial ? linkage->joints[i / 2].space.height - own->space.height : 0.0;
        const double length = hypot(vec2_length(end.anchor), above);
        const double beyond = size_beyond(&linkage->joints[i / 2], i % 2);
        reach = end.body == body ? fmax(reach, length + beyond) : reach;
    }
    return reach;
}

bool linkage_slides(const Linkage *linkage, int body)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool is_its = joint->body_a == body || joint->body_b == body;
        if (is_its && joint->kind != JOINT_REVOLUTE && joint->kind != JOINT_CLEARANCE) {
            return true;
        }
    }
    return false;
}

int linkage_find_body(const Linkage *linkage, const char *name)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (strcmp(linkage->bodies[i].name, name) == 0) {
            return (int)i;
        }
    }
    return -1;
}

int linkage_find_joint(const Linkage *linkage, const char *name)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (strcmp(linkage->joints[i].name, name) == 0) {
            return (int)i;
        }
    }
    return -1;
}

void linkage_start(const Linkage *linkage, Motion *motions)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i] = linkage->bodies[i].start;
    }
}

Vec2 linkage_point(const Motion *motions, int body, Vec2 local)
{
    if (body == LINKAGE_GROUND) {
        return local;
    }
    return vec2_add(motions[body].position, vec2_rotate(motions[body].angle, local));
}

Vec2 linkage_point_velocity(const Motion *motions, int body, Vec2 local)
{
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Motion *motion = &motions[body];
    const Vec2 arm = vec2_rotate(motion->angle, local);
    return vec2_add(motion->velocity, vec2_scale(motion->omega, vec2_perp(arm)));
}

JointGap linkage_joint_gap(const Linkage *linkage, const Motion *motions, int joint)
{
    JointGap gap = {{0.0, 0.0}, {0.0, 0.0}};
    for (int side = 1; side >= 0; side--) {
        const JointEnd end = linkage_end(&linkage->joints[joint], side);
        const double sign = side == 1 ? 1.0 : -1.0;
        if (end.body == LINKAGE_GROUND) {
            gap.position = vec2_add(gap.position, vec2_scale(sign, end.anchor));
            continue;
        }
        const Motion *motion = &motions[end.body];
        const Vec2 arm = vec2_rotate(motion->angle, end.anchor);
        const Vec2 velocity = vec2_add(motion->velocity, vec2_scale(motion->omega, vec2_perp(arm)));
        gap.position = vec2_add(gap.position, vec2_scale(sign, vec2_add(motion->position, arm)));
        gap.velocity = vec2_add(gap.velocity, vec2_scale(sign, velocity));
    }
    return gap;
}

static bool check_bodies(const Linkage *linkage, Err *err)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        if (!(body->mass > 0.0) || !isfinite(body->mass)) {
            return err_set(err, ERR_CASE, "body '%s': mass %g kg, allowed: above 0", body->name,
                           body->mass);
        }
        if (!(body->inertia > 0.0) || !isfinite(body->inertia)) {
            return err_set(err, ERR_CASE, "body '%s': inertia %g kg m^2, allowed: above 0",
                           body->name, body->inertia);
        }
        if (linkage_find_body(linkage, body->name) != (int)i) {
            return err_set(err, ERR_CASE, "two bodies are named '%s'", body->name);
        }
    }
    return true;
}

static bool check_pin(const Joint *joint, Err *err)
{
    const Clearance *clearance = &joint->clearance;
    if (!(clearance->pin_radius > 0.0) || !(clearance->hole_radius > clearance->pin_radius)) {
        return err_set(err, ERR_CASE,
                       "joint '%s': pin radius %.9g m and hole radius %.9g m, allowed: a pin above "
                       "0 and smaller than its hole",
                       joint->name, clearance->pin_radius, clearance->hole_radius);
    }
    if (!(vec2_length(clearance->start) <= linkage_radial_clearance(joint))) {
        return err_set(err, ERR_CASE,
                       "joint '%s': start eccentricity %.9g m, allowed: up to the radial "
                       "clearance %.9g m",
                       joint->name, vec2_length(clearance->start), linkage_radial_clearance(joint));
    }
    return true;
}

static bool check_guide(const Joint *joint, Err *err)
{
    const Guide *guide = &joint->guide;
    if (!(guide->opening > 0.0) || !(guide->height > 0.0) || guide->opening == guide->height ||
        !(guide->length > 0.0) || !isfinite(guide->opening + guide->height + guide->length)) {
        return err_set(err, ERR_CASE,
                       "joint '%s': guide %.9g m, block %.9g m and its length %.9g m, allowed: all "
                       "above 0, and a block that is not as high as the guide is wide",
                       joint->name, guide->opening, guide->height, guide->length);
    }
    const double gap = linkage_guide_gap(guide, guide->start.x, guide->start.y);
    if (!(gap >= -LINKAGE_SEATED * linkage_radial_clearance(joint))) {
        return err_set(err, ERR_CASE, "joint '%s': the block starts %.9g m inside the metal",
                       joint->name, -gap);
    }
    return true;
}

static bool check_stop(const Joint *joint, Err *err)
{
    const Stop *stop = &joint->stop;
    const double size = stop->radius_b + (stop->is_disc ? stop->radius_a : 0.0);
    return (stop->radius_a >= 0.0 && stop->radius_b >= 0.0 && isfinite(size) &&
            (!stop->is_disc || size > 0.0)) ||
           err_set(err, ERR_CASE,
                   "joint '%s': discs of radius %.9g m and %.9g m, allowed: 0 or more, and one of "
                   "two discs above 0",
                   joint->name, stop->radius_a, stop->radius_b);
}

static bool check_own_contact(const Joint *joint, Err *err)
{
    const JointContact *own = &joint->contact;
    const bool is_stiffness =
        own->stiffness == 0.0 || (own->stiffness > 0.0 && own->exponent > 0.0);
    return (is_stiffness && own->restitution >= 0.0 && own->restitution <= 1.0) ||
           err_set(err, ERR_CASE,
                   "joint '%s': stiffness %g and restitution %g of its own, allowed: above 0, and "
                   "0 to 1",
                   joint->name, own->stiffness, own->restitution);
}

static bool check_joint(const Linkage *linkage, size_t number, Err *err)
{
    const Joint *joint = &linkage->joints[number];
    const int count = (int)linkage->body_count;
    if (linkage_find_joint(linkage, joint->name) != (int)number) {
        return err_set(err, ERR_CASE, "two joints are named '%s'", joint->name);
    }
    if (joint->body_a < LINKAGE_GROUND || joint->body_a >= count ||
        joint->body_b < LINKAGE_GROUND || joint->body_b >= count ||
        joint->body_a == joint->body_b) {
        return err_set(err, ERR_CASE, "joint '%s' must join two different bodies of the linkage",
                       joint->name);
    }
    if (!isfinite(joint->direction + joint->held_angle)) {
        return err_set(err, ERR_CASE, "joint '%s': its direction is no number", joint->name);
    }
    if (linkage->is_spatial && joint->kind != JOINT_REVOLUTE && joint->kind != JOINT_CLEARANCE) {
        return err_set(err, ERR_CASE, "joint '%s': guides and stops are for the plane",
                       joint->name);
    }
    switch (joint->kind) {
    case JOINT_CLEARANCE:
        return check_pin(joint, err) && check_own_contact(joint, err);
    case JOINT_GUIDE:
        return check_guide(joint, err) && check_own_contact(joint, err);
    case JOINT_STOP:
        return check_stop(joint, err) && check_own_contact(joint, err);
    default:
        return true;
    }
}

static bool check_driver(const Linkage *linkage, Err *err)
{
    const Driver *driver = &linkage->driver;
    if (!driver->is_present) {
        return true;
    }
    if (driver->joint < 0 || driver->joint >= (int)linkage->joint_count) {
        return err_set(err, ERR_CASE, "the driver's joint does not exist");
    }
    const Joint *joint = &linkage->joints[driver->joint];
    if (joint->kind != JOINT_REVOLUTE || joint->body_a != LINKAGE_GROUND) {
        return err_set(err, ERR_CASE,
                       "the driver turns a body about joint '%s', which must be an ideal joint "
                       "with the ground",
                       joint->name);
    }
    if (!(driver->speed != 0.0) || !isfinite(driver->speed) || !isfinite(driver->start)) {
        return err_set(err, ERR_CASE, "drive speed %g rad/s, allowed: any speed but 0",
                       driver->speed);
    }
    if (driver->speeds.count > 0 && driver->speed != time_table_largest(&driver->speeds)) {
        return err_set(err, ERR_CASE, "drive speed %g rad/s is not the largest of its table",
                       driver->speed);
    }
    return time_table_is_ordered(&driver->speeds) ||
           err_set(err, ERR_CASE, "the times of a speed must increase");
}

static bool check_springs(const Linkage *linkage, Err *err)
{
    const int count = (int)linkage->body_count;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        if (spring->body_a < LINKAGE_GROUND || spring->body_a >= count ||
            spring->body_b < LINKAGE_GROUND || spring->body_b >= count ||
            spring->body_a == spring->body_b) {
            return err_set(err, ERR_CASE,
                           "spring '%s' must join two different bodies of the linkage",
                           spring->name);
        }
        if (!isfinite(spring->stiffness + spring->length) || !(spring->damping >= 0.0)) {
            return err_set(err, ERR_CASE, "spring '%s' has a number that is out of range",
                           spring->name);
        }
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        if (spring->joint < 0 || spring->joint >= (int)linkage->joint_count ||
            !isfinite(spring->stiffness + spring->angle) || !(spring->damping >= 0.0)) {
            return err_set(err, ERR_CASE, "torsion spring '%s' needs a joint and finite numbers",
                           spring->name);
        }
    }
    return true;
}

static bool check_torque(const Linkage *linkage, Err *err)
{
    const Torque *torque = &linkage->torque;
    if (torque->table.count > 0 &&
        (torque->joint < 0 || torque->joint >= (int)linkage->joint_count)) {
        return err_set(err, ERR_CASE, "the joint of the torque does not exist");
    }
    return time_table_is_ordered(&torque->table) ||
           err_set(err, ERR_CASE, "the times of a torque must increase");
}

bool linkage_check(const Linkage *linkage, Err *err)
{
    if (linkage->body_count == 0) {
        return err_set(err, ERR_CASE, "no bodies, allowed: 1 or more");
    }
    if (linkage->is_spatial &&
        (linkage->body_count > SPACE_BODY_MAX || linkage->joint_count > SPACE_JOINT_MAX)) {
        return err_set(err, ERR_CASE,
                       "%zu bodies and %zu joints in space, allowed: 1 to %d and 0 to %d; in the "
                       "plane there may be any number",
                       linkage->body_count, linkage->joint_count, SPACE_BODY_MAX, SPACE_JOINT_MAX);
    }
    if (!check_bodies(linkage, err)) {
        return false;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (!check_joint(linkage, i, err)) {
            return false;
        }
    }
    return check_springs(linkage, err) && check_driver(linkage, err) && check_torque(linkage, err);
}

double linkage_kinetic_energy(const Linkage *linkage, const Motion *motions)
{
    double energy = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Motion *motion = &motions[i];
        energy += 0.5 * linkage->bodies[i].mass * vec2_dot(motion->velocity, motion->velocity) +
                  0.5 * linkage->bodies[i].inertia * motion->omega * motion->omega;
    }
    return energy;
}

double linkage_potential_energy(const Linkage *linkage, const Motion *motions, double gravity)
{
    double energy = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        energy += linkage->bodies[i].mass * gravity * motions[i].position.y;
    }
    return energy;
}
