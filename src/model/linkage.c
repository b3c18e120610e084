// Has the bodies of a linkage and the joints between them.
#include "model/linkage.h"

#include <stdio.h>
#include <string.h>

double linkage_radial_clearance(const Joint *joint)
{
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        return joint->clearance.hole_radius - joint->clearance.pin_radius;
    case JOINT_TOUCHES_GUIDES:
        return 0.5 * fabs(joint->guide.opening - joint->guide.height);
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_DISC:
    case JOINT_TOUCHES_TEETH:
        break;
    }
    return 0.0;
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
    return joint_is_ideal(linkage->joints[joint].kind) &&
           linkage_drive_of_joint(linkage, joint) < 0;
}

int linkage_drive_of_joint(const Linkage *linkage, size_t joint)
{
    const size_t count = linkage_drive_count(linkage);
    for (size_t i = 0; i < count; i++) {
        if (linkage_drive(linkage, i)->joint == (int)joint) {
            return (int)i;
        }
    }
    return -1;
}

void linkage_drives_since(const Linkage *linkage, double from_s, double time_s,
                          DriveState states[LINKAGE_DRIVE_MAX])
{
    const size_t count = linkage_drive_count(linkage);
    for (size_t i = 0; i < count; i++) {
        states[i] = drive_since(linkage_drive(linkage, i), from_s, time_s);
    }
}

double linkage_next_kink(const Linkage *linkage, double time_s)
{
    double next_s = INFINITY;
    const size_t count = linkage_drive_count(linkage);
    for (size_t i = 0; i < count; i++) {
        next_s = fmin(next_s, drive_next_kink(linkage_drive(linkage, i), time_s));
    }
    return next_s;
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
    const Driver *driver = &linkage->driver;
    if (drive_is_steady(driver)) {
        return 2.0 * M_PI / fabs(driver->speed);
    }
    // of several drives what all of them have in common
    double period_s = drive_period(driver);
    for (size_t i = 0; i < linkage->further_count; i++) {
        period_s = drive_period(&linkage->further[i]) == period_s ? period_s : 0.0;
    }
    return driver->table.count > 0 ? period_s : 0.0;
}

// How far a body goes beyond its anchor in a joint that slides or stops, m.
static double size_beyond(const Joint *joint, int side)
{
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_GUIDES:
        return side == 1 ? 0.5 * hypot(joint->guide.height, joint->guide.length) : 0.0;
    case JOINT_TOUCHES_DISC:
        return side == 0 ? joint->stop.radius_a + 0.5 * joint->stop.slot : joint->stop.radius_b;
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_HOLE:
    case JOINT_TOUCHES_TEETH:
        break;
    }
    return 0.0;
}

static double radius_of_gyration(const Body *body)
{
    return sqrt(body->inertia / body->mass);
}

// How far the body at one side of a joint goes there from its centre, m.
static double reach_at(const Linkage *linkage, const Joint *joint, int side)
{
    const JointEnd end = linkage_end(joint, side);
    const double above =
        linkage->is_spatial ? joint->space.height - linkage->bodies[end.body].space.height : 0.0;
    return hypot(vec2_length(end.anchor), above) + size_beyond(joint, side);
}

double linkage_reach(const Linkage *linkage, int body)
{
    double reach = radius_of_gyration(&linkage->bodies[body]);
    for (size_t i = 0; i < 2 * linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i / 2];
        if (linkage_end(joint, i % 2).body == body) {
            reach = fmax(reach, reach_at(linkage, joint, i % 2));
        }
    }
    return reach;
}

void linkage_reaches(const Linkage *linkage, double *reaches)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        reaches[i] = radius_of_gyration(&linkage->bodies[i]);
    }
    for (size_t i = 0; i < 2 * linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i / 2];
        const int body = linkage_end(joint, i % 2).body;
        if (body != LINKAGE_GROUND) {
            reaches[body] = fmax(reaches[body], reach_at(linkage, joint, i % 2));
        }
    }
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

double linkage_potential_energy(const Linkage *linkage, const Motion *motions, Vec2 gravity)
{
    double energy = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        energy -= vec2_dot(vec2_scale(linkage->bodies[i].mass, gravity), motions[i].position);
    }
    return energy;
}
