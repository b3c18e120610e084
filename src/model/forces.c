// Finds the forces that springs, dampers and the torque of a drive put on the bodies.
//
// Between points p_a and p_b, d = p_b - p_a, n = d / |d|:
//     tension  T = k (|d| - l) + c d|d|/dt,   force T n on body a, -T n on body b
// At a joint, angle phi of its turned body against the other:
//     moment  M = -k (phi - phi_0) - c dphi/dt  on the turned body, -M on the other
// Torque of the drive: M(t) on the turned body of its joint, -M(t) on the other. At a prismatic
// joint it is a force F(t) along the line on body b at its anchor, -F(t) on body a at that point.
//     energy  sum k (|d| - l)^2 / 2 + sum k (phi - phi_0)^2 / 2
#include "model/forces.h"

#include "model/joint_rows.h"

bool forces_any(const Linkage *linkage)
{
    return linkage->spring_count > 0 || linkage->torsion_count > 0 ||
           linkage->torque.table.count > 0;
}

bool forces_damp(const Linkage *linkage)
{
    bool is_damped = false;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        is_damped = is_damped || linkage->springs[i].damping > 0.0;
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        is_damped = is_damped || linkage->torsions[i].damping > 0.0;
    }
    return is_damped;
}

SpringLine forces_line(const Spring *spring, const Motion *motions)
{
    const Vec2 a = linkage_point(motions, spring->body_a, spring->anchor_a);
    const Vec2 b = linkage_point(motions, spring->body_b, spring->anchor_b);
    const Vec2 moving = vec2_sub(linkage_point_velocity(motions, spring->body_b, spring->anchor_b),
                                 linkage_point_velocity(motions, spring->body_a, spring->anchor_a));
    const Vec2 along = vec2_sub(b, a);
    SpringLine line = {.ends = {a, b}, .distance = vec2_length(along)};
    if (line.distance > 0.0) {
        line.direction = vec2_scale(1.0 / line.distance, along);
        line.rate = vec2_dot(line.direction, moving);
    }
    return line;
}

JointTurn forces_turn(const Linkage *linkage, int joint, const Motion *motions)
{
    int turned;
    int against;
    linkage_turning(linkage, joint, &turned, &against);
    JointTurn turn = {motions[turned].angle, motions[turned].omega};
    if (against != LINKAGE_GROUND) {
        turn.angle -= motions[against].angle;
        turn.rate -= motions[against].omega;
    }
    return turn;
}

static void add_force(int body, Vec2 point, Vec2 force, const Motion *motions, BodyLoad *loads)
{
    if (body == LINKAGE_GROUND) {
        return;
    }
    BodyLoad *load = &loads[body];
    load->force = vec2_add(load->force, force);
    load->moment += vec2_cross(vec2_sub(point, motions[body].position), force);
}

void forces_add_tension(const Spring *spring, const SpringLine *line, const Motion *motions,
                        double tension, BodyLoad *loads)
{
    const Vec2 force = vec2_scale(tension, line->direction);
    add_force(spring->body_a, line->ends[0], force, motions, loads);
    add_force(spring->body_b, line->ends[1], vec2_scale(-1.0, force), motions, loads);
}

void forces_add_moment(const Linkage *linkage, int joint, double moment, BodyLoad *loads)
{
    int turned;
    int against;
    linkage_turning(linkage, joint, &turned, &against);
    loads[turned].moment += moment;
    if (against != LINKAGE_GROUND) {
        loads[against].moment -= moment;
    }
}

void forces_add_springs(const Linkage *linkage, const Motion *motions, BodyLoad *loads)
{
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        const SpringLine line = forces_line(spring, motions);
        const double tension = spring->stiffness * (line.distance - spring->length);
        forces_add_tension(spring, &line, motions, tension, loads);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        const JointTurn turn = forces_turn(linkage, spring->joint, motions);
        forces_add_moment(linkage, spring->joint, -spring->stiffness * (turn.angle - spring->angle),
                          loads);
    }
}

void forces_add_dampers(const Linkage *linkage, const Motion *motions, BodyLoad *loads)
{
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        const SpringLine line = forces_line(spring, motions);
        forces_add_tension(spring, &line, motions, spring->damping * line.rate, loads);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        const JointTurn turn = forces_turn(linkage, spring->joint, motions);
        forces_add_moment(linkage, spring->joint, -spring->damping * turn.rate, loads);
    }
}

// The line of the prismatic joint that a force drives.
typedef struct DriveLine {
    int body_a;
    int body_b;
    Vec2 along;  // unit, of body b
    Vec2 point;  // anchor of body b, at which the force acts, m
    double way;  // m, of that point from the anchor of body a
    double rate; // m/s, of that point against the point of body a under it
} DriveLine;

static DriveLine drive_line(const Linkage *linkage, const Motion *motions)
{
    const int number = linkage->torque.joint;
    const Joint *joint = &linkage->joints[number];
    const JointGap gap = linkage_joint_gap(linkage, motions, number);
    const double omega = joint->body_a == LINKAGE_GROUND ? 0.0 : motions[joint->body_a].omega;
    const Vec2 along = joint_rows_along(linkage, motions, number);
    const Vec2 carried = vec2_scale(omega, vec2_perp(gap.position));
    return (DriveLine){
        .body_a = joint->body_a,
        .body_b = joint->body_b,
        .along = along,
        .point = linkage_point(motions, joint->body_b, joint->anchor_b),
        .way = vec2_dot(along, gap.position),
        .rate = vec2_dot(along, vec2_sub(gap.velocity, carried)),
    };
}

static bool is_force(const Linkage *linkage)
{
    return linkage->joints[linkage->torque.joint].kind == JOINT_PRISMATIC;
}

JointTurn forces_drive_turn(const Linkage *linkage, const Motion *motions)
{
    if (!is_force(linkage)) {
        return forces_turn(linkage, linkage->torque.joint, motions);
    }
    const DriveLine line = drive_line(linkage, motions);
    return (JointTurn){line.way, line.rate};
}

double forces_drive_rate(const Linkage *linkage, const Motion *motions)
{
    return forces_drive_turn(linkage, motions).rate;
}

void forces_add_torque(const Linkage *linkage, const Motion *motions, double torque,
                       BodyLoad *loads)
{
    if (linkage->torque.table.count == 0) {
        return;
    }
    if (is_force(linkage)) {
        const DriveLine line = drive_line(linkage, motions);
        const Vec2 force = vec2_scale(torque, line.along);
        add_force(line.body_a, line.point, vec2_scale(-1.0, force), motions, loads);
        add_force(line.body_b, line.point, force, motions, loads);
        return;
    }
    forces_add_moment(linkage, linkage->torque.joint, torque, loads);
}

void forces_loads(const Linkage *linkage, const Motion *motions, double time_s, BodyLoad *loads)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        loads[i] = (BodyLoad){{0.0, 0.0}, 0.0};
    }
    forces_add_springs(linkage, motions, loads);
    forces_add_dampers(linkage, motions, loads);
    forces_add_torque(linkage, motions, time_table_at(&linkage->torque.table, time_s), loads);
}

double forces_energy(const Linkage *linkage, const Motion *motions)
{
    double energy = 0.0;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        const double stretch = forces_line(spring, motions).distance - spring->length;
        energy += 0.5 * spring->stiffness * stretch * stretch;
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        const double turn = forces_turn(linkage, spring->joint, motions).angle - spring->angle;
        energy += 0.5 * spring->stiffness * turn * turn;
    }
    return energy;
}

double forces_damping_power(const Linkage *linkage, const Motion *motions)
{
    double power = 0.0;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const double rate = forces_line(&linkage->springs[i], motions).rate;
        power += linkage->springs[i].damping * rate * rate;
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const double rate = forces_turn(linkage, linkage->torsions[i].joint, motions).rate;
        power += linkage->torsions[i].damping * rate * rate;
    }
    return power;
}

double forces_torque_power(const Linkage *linkage, const Motion *motions, double time_s)
{
    const Torque *torque = &linkage->torque;
    return torque->table.count == 0
               ? 0.0
               : time_table_at(&torque->table, time_s) * forces_drive_rate(linkage, motions);
}

double forces_load_power(const BodyLoad *load, const Motion *motion)
{
    return vec2_dot(load->force, motion->velocity) + load->moment * motion->omega;
}
