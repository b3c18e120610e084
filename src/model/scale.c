// Finds which speeds are large and which are rounding, in a scenario that may start at rest.
//
//     V = max(|v| + |w| reach at the start, |w_drive| span, min(sqrt(2 g reach), g T), sqrt(2 E /
//     m)) A = max(V max |w|, g),   of a body  turning = V / reach,  speeding = A / reach
// reach: of a body's furthest joint from its centre; span: of the driven body's furthest point from
// its pivot; T: period of the drive, in which gravity alone makes no more than g T; E: stored in
// springs at the start, and what a torque gives in one radian, a force along the largest reach; m:
// of all bodies. At rest the least that anything is measured in is REST V, REST A, REST m A.
#include "model/scale.h"

#include "base/zeroed.h"
#include "model/joint_friction.h"
#include "model/loads.h"

// How far the body of a drive reaches from its pivot, m.
static double driven_span(const Linkage *linkage, size_t drive)
{
    const int driven = linkage_drive_body(linkage, drive);
    const Vec2 pivot = linkage->joints[linkage_drive(linkage, drive)->joint].anchor_b;
    double span = 0.0;
    for (size_t i = 0; i < 2 * linkage->joint_count; i++) {
        const JointEnd end = linkage_end(&linkage->joints[i / 2], i % 2);
        span = end.body == driven ? fmax(span, vec2_length(vec2_sub(end.anchor, pivot))) : span;
    }
    return span > 0.0 ? span : linkage_reach(linkage, driven);
}

// The speed that springs and torque alone give the bodies from rest, m/s; with the largest reach.
static double pushed_speed(const Linkage *linkage, double reach)
{
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    double energy = forces_energy(linkage, motions);
    free(motions);
    double mass = 0.0;
    double largest = fabs(time_table_largest(&linkage->torque.table));
    for (size_t i = 0; i < linkage->body_count; i++) {
        mass += linkage->bodies[i].mass;
    }
    // a force works along a line
    const Torque *torque = &linkage->torque;
    if (torque->table.count > 0 && joint_has_position(linkage->joints[torque->joint].kind)) {
        largest *= reach;
    }
    for (size_t i = 0; i < linkage->load_count; i++) {
        const Load *load = &linkage->loads[i];
        const bool is_force = load_is_force(linkage, load);
        largest += load_table_largest(&load->table) * (is_force ? reach : 1.0);
    }
    return sqrt(2.0 * (energy + largest) / mass);
}

static void set_bodies(const Linkage *linkage, SpeedScale *scale)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        const double reach = scale->reaches[i];
        scale->turning[i] = scale->moving / reach;
        scale->speeding[i] = scale->changing / reach;
    }
}

SpeedScale scale_speeds(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    const double gravity = vec3_length(scenario->gravity);
    SpeedScale scale = {
        .turning = zeroed(linkage->body_count, sizeof *scale.turning),
        .speeding = zeroed(linkage->body_count, sizeof *scale.speeding),
        .reaches = zeroed(linkage->body_count, sizeof *scale.reaches),
    };
    linkage_reaches(linkage, scale.reaches);
    double largest = 0.0;
    double turning = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Motion *start = &linkage->bodies[i].start;
        const BodySpace *space = &linkage->bodies[i].space; // 0 in the plane
        const double reach = scale.reaches[i];
        const double omega = hypot(start->omega, hypot(space->omega_x, space->omega_y));
        const double speed = hypot(vec2_length(start->velocity), space->velocity_z);
        largest = fmax(largest, reach);
        turning = fmax(turning, omega);
        scale.moving = fmax(scale.moving, speed + omega * reach);
    }
    double fall = sqrt(2.0 * gravity * largest);
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const double speed = fabs(linkage_drive(linkage, i)->speed);
        turning = fmax(turning, speed);
        scale.moving = fmax(scale.moving, speed * driven_span(linkage, i));
        fall = fmin(fall, gravity * (2.0 * M_PI / speed));
    }
    scale.moving = fmax(scale.moving, fall);
    scale.moving = fmax(scale.moving, forces_any(linkage) ? pushed_speed(linkage, largest) : 0.0);
    scale.moving = scale.moving > 0.0 ? scale.moving : 1.0;
    scale.changing = fmax(scale.moving * turning, gravity);
    scale.changing = scale.changing > 0.0 ? scale.changing : scale.moving * scale.moving / largest;
    set_bodies(linkage, &scale);
    return scale;
}

void scale_free(SpeedScale *scale)
{
    free(scale->turning);
    free(scale->speeding);
    free(scale->reaches);
    *scale = (SpeedScale){.turning = NULL};
}

// A step of 1 us leaves 1e-10 m/s where positions of 1 m are rounded; a pendulum that is released
// 1e-6 rad from its equilibrium has 1e-6 of the speed of a fall.
static const double REST = 1e-7;

// A pin that a stiff contact holds shivers by the rounding of its depth and what the reference
// allows itself: 1e-10 of the speed of that fall.
static const double REST_PRESSED = 1e-5;

// 1, of the energy of that fall: the square of a speed, and above what sums of energies round off
static const double REST_ENERGY = 1e-12;

// Rounding of the sums that make up a potential energy, of the largest of them.
static const double POTENTIAL_ROUNDING = 64.0 * 0x1p-53;

// Potential energy of the bodies without regard to signs, J, and their mass, kg.
static double potential_size(const Scenario *scenario, double *mass)
{
    double size = 0.0;
    *mass = 0.0;
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        const Body *body = &scenario->linkage.bodies[i];
        const Vec2 position = body->start.position;
        *mass += body->mass;
        size += body->mass *
                (fabs(scenario->gravity.x * position.x) + fabs(scenario->gravity.y * position.y) +
                 fabs(scenario->gravity.z * body->space.height));
    }
    return size;
}

static bool has_play(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            return true;
        }
    }
    return false;
}

// Takes the speed of the drives and its change, m/s and m/s^2. False where none moves.
static bool take_drives(const Linkage *linkage, double *moving, double *changing)
{
    double driven = 0.0;
    double fastest = 0.0;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const double speed = fabs(linkage_drive(linkage, i)->speed);
        fastest = fmax(fastest, speed);
        driven = fmax(driven, speed * driven_span(linkage, i));
    }
    *moving = driven > 0.0 ? driven : *moving;
    *changing = driven > 0.0 ? driven * fastest : *changing;
    return driven > 0.0;
}

ScaleFloor scale_floor(const Scenario *scenario)
{
    SpeedScale scale = scale_speeds(scenario);
    double mass;
    double reach = 0.0;
    const double potential = potential_size(scenario, &mass);
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        reach = fmax(reach, scale.reaches[i]);
    }
    double moving = scale.moving;
    double changing = scale.changing;
    const bool is_driven = take_drives(&scenario->linkage, &moving, &changing);
    // a bristle that holds is pressed like a contact
    const bool is_pressed = !is_driven && (has_play(&scenario->linkage) ||
                                           joint_friction_first(&scenario->linkage) >= 0);
    const ScaleFloor floor = {
        .speed = (is_pressed ? REST_PRESSED : REST) * moving,
        .acceleration = REST * changing,
        .force = REST * mass * scale.changing,
        .torque = REST * mass * scale.changing * reach,
        .energy = REST_ENERGY * 0.5 * mass * moving * moving + POTENTIAL_ROUNDING * potential,
    };
    scale_free(&scale);
    return floor;
}

void scale_carry(const Linkage *linkage, SpeedScale *scale, Carry *carry)
{
    CARRY(carry, scale->moving);
    CARRY(carry, scale->changing);
    CARRY_ARRAY(carry, scale->turning, linkage->body_count);
    CARRY_ARRAY(carry, scale->speeding, linkage->body_count);
}

bool scale_raise(const Linkage *linkage, double moving, SpeedScale *scale)
{
    if (!(moving > scale->moving)) {
        return false;
    }
    scale->moving = moving;
    set_bodies(linkage, scale);
    return true;
}
