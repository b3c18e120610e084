// Finds the forces that springs, bushings, dampers and the torque of a drive put on the bodies.
//
// Between points p_a and p_b, d = p_b - p_a, n = d / |d|:
//     tension  T = k (|d| - l) + c d|d|/dt,   force T n on body a, -T n on body b
// At a joint, angle phi of its turned body against the other:
//     moment  M = -k (phi - phi_0) - c dphi/dt  on the turned body, -M on the other
// Bushings: model/bushing.c. Torque of the drive: M on the turned body of its joint, -M on the
// other. At a prismatic joint it is a force F along the line on body b at its anchor, -F on body a
// at that point. Of a motor or a soft drive (Torque) what the rate takes, slope times it, counts as
// a damper's, for the solvers, and as the drive's, for the energy. Of a drive with a limit all of
// it is the drive's, and forces_loads has what is left of it.
//     energy  sum k (|d| - l)^2 / 2 + sum k (phi - phi_0)^2 / 2
#include "model/forces.h"

#include "model/joint_rows.h"

bool forces_any(const Linkage *linkage)
{
    return linkage->spring_count > 0 || linkage->torsion_count > 0 || linkage->bushing_count > 0 ||
           linkage->gap_damper_count > 0 || linkage->torque.table.count > 0 ||
           linkage->load_count > 0;
}

bool forces_damp(const Linkage *linkage)
{
    bool is_damped = linkage->torque.slope > 0.0 || linkage->gap_damper_count > 0;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        is_damped = is_damped || linkage->springs[i].damping > 0.0;
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        is_damped = is_damped || linkage->torsions[i].damping > 0.0;
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        is_damped = is_damped || bushing_damps(&linkage->bushings[i]);
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

void forces_add_at(int body, Vec2 point, Vec2 force, const Motion *motions, BodyLoad *loads)
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
    forces_add_at(spring->body_a, line->ends[0], force, motions, loads);
    forces_add_at(spring->body_b, line->ends[1], vec2_scale(-1.0, force), motions, loads);
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

void forces_add_row(const Bushing *bushing, const BushingPose *pose, size_t row, double pull,
                    const Motion *motions, BodyLoad *loads)
{
    if (row < 2) {
        const Vec2 force = vec2_scale(pull, pose->axes[row]);
        forces_add_at(bushing->body_a, pose->point, force, motions, loads);
        forces_add_at(bushing->body_b, pose->point, vec2_scale(-1.0, force), motions, loads);
        return;
    }
    if (bushing->body_a != LINKAGE_GROUND) {
        loads[bushing->body_a].moment += pull;
    }
    if (bushing->body_b != LINKAGE_GROUND) {
        loads[bushing->body_b].moment -= pull;
    }
}

void forces_add_drag(const Joint *joint, const GapDampingRow *row, double drag, BodyLoad *loads)
{
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(joint, side).body;
        if (body != LINKAGE_GROUND) {
            BodyLoad *load = &loads[body];
            load->force.x -= drag * row->row.x[side];
            load->force.y -= drag * row->row.y[side];
            load->moment -= drag * row->row.turn[side];
        }
    }
}

static void add_gap_dampers(const Linkage *linkage, const Motion *motions, BodyLoad *loads)
{
    for (size_t i = 0; linkage->gap_damper_count > 0 && i < linkage->joint_count; i++) {
        GapDampingRow rows[GAP_DAMPING_ROWS];
        const size_t count = gap_damping_rows(linkage, motions, (int)i, rows);
        for (size_t k = 0; k < count; k++) {
            const double drag = rows[k].damping * rows[k].rate;
            forces_add_drag(&linkage->joints[i], &rows[k], drag, loads);
        }
    }
}

// Adds what all rows of the bushings do, their springs or their dampers.
static void add_bushings(const Linkage *linkage, const Motion *motions,
                         double (*pull)(const Bushing *, const BushingPose *, size_t),
                         BodyLoad *loads)
{
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const Bushing *bushing = &linkage->bushings[i];
        const BushingPose pose = bushing_pose(bushing, motions);
        for (size_t row = 0; row < BUSHING_ROWS; row++) {
            forces_add_row(bushing, &pose, row, pull(bushing, &pose, row), motions, loads);
        }
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
    add_bushings(linkage, motions, bushing_pull, loads);
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
    add_bushings(linkage, motions, bushing_drag, loads);
    add_gap_dampers(linkage, motions, loads);
    if (linkage->torque.slope > 0.0 && linkage->torque.limit == 0.0) {
        const double rate = forces_drive_rate(linkage, motions);
        forces_add_moment(linkage, linkage->torque.joint, -linkage->torque.slope * rate, loads);
    }
}

// The line of a prismatic joint or of guides.
typedef struct JointLine {
    int body_a;
    int body_b;
    Vec2 along;  // unit, of body b
    Vec2 point;  // anchor of body b, at which a force acts, m
    double way;  // m, of that point from the anchor of body a
    double rate; // m/s, of that point against the point of body a under it
} JointLine;

static JointLine joint_line(const Linkage *linkage, int number, const Motion *motions)
{
    const Joint *joint = &linkage->joints[number];
    const JointGap gap = linkage_joint_gap(linkage, motions, number);
    const double omega = joint->body_a == LINKAGE_GROUND ? 0.0 : motions[joint->body_a].omega;
    const Vec2 along = joint_rows_along(linkage, motions, number);
    const Vec2 carried = vec2_scale(omega, vec2_perp(gap.position));
    return (JointLine){
        .body_a = joint->body_a,
        .body_b = joint->body_b,
        .along = along,
        .point = linkage_point(motions, joint->body_b, joint->anchor_b),
        .way = vec2_dot(along, gap.position),
        .rate = vec2_dot(along, vec2_sub(gap.velocity, carried)),
    };
}

bool forces_is_along_line(const Linkage *linkage, int joint)
{
    return joint_slides(linkage->joints[joint].kind);
}

JointTurn forces_coordinate(const Linkage *linkage, int joint, const Motion *motions)
{
    if (!forces_is_along_line(linkage, joint)) {
        return forces_turn(linkage, joint, motions);
    }
    const JointLine line = joint_line(linkage, joint, motions);
    return (JointTurn){line.way, line.rate};
}

void forces_add_along(const Linkage *linkage, int joint, double value, const Motion *motions,
                      BodyLoad *loads)
{
    if (!forces_is_along_line(linkage, joint)) {
        forces_add_moment(linkage, joint, value, loads);
        return;
    }
    const JointLine line = joint_line(linkage, joint, motions);
    const Vec2 force = vec2_scale(value, line.along);
    forces_add_at(line.body_a, line.point, vec2_scale(-1.0, force), motions, loads);
    forces_add_at(line.body_b, line.point, force, motions, loads);
}

JointTurn forces_drive_turn(const Linkage *linkage, const Motion *motions)
{
    return forces_coordinate(linkage, linkage->torque.joint, motions);
}

double forces_drive_rate(const Linkage *linkage, const Motion *motions)
{
    return forces_drive_turn(linkage, motions).rate;
}

double forces_followed(const Linkage *linkage, const Motion *motions, double time_s)
{
    const Torque *torque = &linkage->torque;
    if (!torque->followed.is_present) {
        return 0.0;
    }
    const DriveState to = drive_at(&torque->followed, time_s);
    const double angle = forces_drive_turn(linkage, motions).angle;
    return torque->stiffness * (to.angle - angle) + torque->slope * to.omega;
}

void forces_add_torque(const Linkage *linkage, const Motion *motions, double torque,
                       BodyLoad *loads)
{
    if (linkage->torque.table.count > 0) {
        forces_add_along(linkage, linkage->torque.joint, torque, motions, loads);
    }
}

void forces_loads(const Linkage *linkage, const Motion *motions, double time_s, BodyLoad *loads)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        loads[i] = (BodyLoad){{0.0, 0.0}, 0.0};
    }
    forces_add_springs(linkage, motions, loads);
    forces_add_dampers(linkage, motions, loads);
    if (linkage->torque.limit > 0.0) {
        forces_add_torque(linkage, motions, forces_drive_torque(linkage, motions, time_s), loads);
        return;
    }
    forces_add_torque(linkage, motions,
                      time_table_at(&linkage->torque.table, time_s) +
                          forces_followed(linkage, motions, time_s),
                      loads);
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
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const BushingPose pose = bushing_pose(&linkage->bushings[i], motions);
        energy += bushing_energy(&linkage->bushings[i], &pose);
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
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const BushingPose pose = bushing_pose(&linkage->bushings[i], motions);
        power += bushing_power(&linkage->bushings[i], &pose);
    }
    for (size_t i = 0; linkage->gap_damper_count > 0 && i < linkage->joint_count; i++) {
        GapDampingRow rows[GAP_DAMPING_ROWS];
        const size_t count = gap_damping_rows(linkage, motions, (int)i, rows);
        for (size_t k = 0; k < count; k++) {
            power += rows[k].damping * rows[k].rate * rows[k].rate;
        }
    }
    return power;
}

double forces_within_limit(const Torque *torque, double unlimited)
{
    return torque->limit == 0.0 ? unlimited : fmin(fmax(unlimited, -torque->limit), torque->limit);
}

double forces_drive_torque(const Linkage *linkage, const Motion *motions, double time_s)
{
    return forces_within_limit(&linkage->torque, forces_drive_unlimited(linkage, motions, time_s));
}

double forces_drive_unlimited(const Linkage *linkage, const Motion *motions, double time_s)
{
    const Torque *torque = &linkage->torque;
    const double rate = torque->slope > 0.0 ? forces_drive_rate(linkage, motions) : 0.0;
    return time_table_at(&torque->table, time_s) + forces_followed(linkage, motions, time_s) -
           torque->slope * rate;
}

double forces_torque_power(const Linkage *linkage, const Motion *motions, double time_s)
{
    return linkage->torque.table.count == 0 ? 0.0
                                            : forces_drive_torque(linkage, motions, time_s) *
                                                  forces_drive_rate(linkage, motions);
}

double forces_load_power(const BodyLoad *load, const Motion *motion)
{
    return vec2_dot(load->force, motion->velocity) + load->moment * motion->omega;
}
