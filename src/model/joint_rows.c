// Makes the rows by which two bodies are held in a joint.
//
// d from anchor a to anchor b, t the line's direction on body a, n = perp t; rows, their rates, and
// the rates' own rates without accelerations:
//                 row                     rate
//     revolute    d                       d'
//     prismatic   n . d                   n . d' - w_a t . d
//                 phi_b - phi_a - held    w_b - w_a
// and the rates of these, d'', n . d'' - 2 w_a t . d' - w_a^2 n . d, and 0.
// The rate of the first prismatic row is the velocity across the line of body b's anchor against
// the point of body a under it. Source: E. J. Haug, Computer Aided Kinematics and Dynamics of
// Mechanical Systems, 1989, section 3.3.
#include "model/joint_rows.h"

// How the two ends of a joint stand and move; those on the ground do not.
typedef struct Ends {
    Vec2 arm[2];      // m, from the body's centre (the world's origin) to the anchor
    Vec2 point[2];    // m
    Vec2 velocity[2]; // m/s
    double angle[2];  // rad
    double omega[2];  // rad/s
} Ends;

static void find_ends(const Linkage *linkage, const Motion *motions, int joint, Ends *ends)
{
    for (int side = 0; side < 2; side++) {
        const JointEnd end = linkage_end(&linkage->joints[joint], side);
        const bool is_ground = end.body == LINKAGE_GROUND;
        const Motion motion = is_ground ? (Motion){.omega = 0.0} : motions[end.body];
        ends->arm[side] = is_ground ? end.anchor : vec2_rotate(motion.angle, end.anchor);
        ends->point[side] = vec2_add(motion.position, ends->arm[side]);
        ends->velocity[side] =
            vec2_add(motion.velocity, vec2_scale(motion.omega, vec2_perp(ends->arm[side])));
        ends->angle[side] = motion.angle;
        ends->omega[side] = motion.omega;
    }
}

size_t joint_rows_total(const Linkage *linkage)
{
    size_t total = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        total += joint_rows_count(linkage->joints[i].kind);
    }
    return total;
}

double joint_rows_size(const Linkage *linkage, int joint, Vec2 rows)
{
    const Joint *of = &linkage->joints[joint];
    if (!joint_rows_is_angle(of->kind, 1)) {
        return vec2_length(rows);
    }
    double reach = 0.0;
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(of, side).body;
        reach = body == LINKAGE_GROUND ? reach : fmax(reach, linkage_reach(linkage, body));
    }
    return hypot(rows.x, reach * rows.y);
}

Vec2 joint_rows_start(const Joint *joint)
{
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        return joint->clearance.start;
    case JOINT_TOUCHES_GUIDES:
        return joint->guide.start;
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_DISC:
    case JOINT_TOUCHES_TEETH:
        break;
    }
    return (Vec2){0.0, 0.0};
}

void joint_rows_set_start(Joint *joint, Vec2 rows)
{
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        joint->clearance.start = rows;
        break;
    case JOINT_TOUCHES_GUIDES:
        joint->guide.start = rows;
        break;
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_DISC:
    case JOINT_TOUCHES_TEETH:
        break;
    }
}

// From the anchor on body a to that on body b, its rate, and the rate's without accelerations.
typedef struct Distance {
    Vec2 position;
    Vec2 velocity;
    Vec2 bias;
} Distance;

static Distance distance_of(const Ends *ends)
{
    return (Distance){
        .position = vec2_sub(ends->point[1], ends->point[0]),
        .velocity = vec2_sub(ends->velocity[1], ends->velocity[0]),
        .bias = vec2_sub(vec2_scale(ends->omega[0] * ends->omega[0], ends->arm[0]),
                         vec2_scale(ends->omega[1] * ends->omega[1], ends->arm[1])),
    };
}

static void find_revolute(const Ends *ends, JointRows *rows)
{
    const Distance d = distance_of(ends);
    *rows = (JointRows){
        .rows = {{.x = {-1.0, 1.0}, .turn = {ends->arm[0].y, -ends->arm[1].y}},
                 {.y = {-1.0, 1.0}, .turn = {-ends->arm[0].x, ends->arm[1].x}}},
        .position = {d.position.x, d.position.y},
        .rate = {d.velocity.x, d.velocity.y},
        .bias = {d.bias.x, d.bias.y},
    };
}

static void find_prismatic(const Joint *joint, const Ends *ends, JointRows *rows)
{
    const Distance d = distance_of(ends);
    const double omega = ends->omega[0];
    const Vec2 t = vec2_rotate(ends->angle[0] + joint->direction, (Vec2){1.0, 0.0});
    const Vec2 n = vec2_perp(t);
    // of body a the point under body b's anchor counts
    const Vec2 lever = vec2_add(ends->arm[0], d.position);
    *rows = (JointRows){
        .rows = {{.x = {-n.x, n.x},
                  .y = {-n.y, n.y},
                  .turn = {-vec2_cross(lever, n), vec2_cross(ends->arm[1], n)}},
                 {.turn = {-1.0, 1.0}}},
        .position = {vec2_dot(n, d.position), ends->angle[1] - ends->angle[0] - joint->held_angle},
        .rate = {vec2_dot(n, d.velocity) - omega * vec2_dot(t, d.position), ends->omega[1] - omega},
        .bias = {vec2_dot(n, d.bias) - 2.0 * omega * vec2_dot(t, d.velocity) -
                     omega * omega * vec2_dot(n, d.position),
                 0.0},
    };
}

void joint_rows_find(const Linkage *linkage, const Motion *motions, int joint, JointRows *rows)
{
    const Joint *of = &linkage->joints[joint];
    Ends ends;
    find_ends(linkage, motions, joint, &ends);
    switch (joint_held_by(of->kind)) {
    case JOINT_HOLDS_LINE:
        find_prismatic(of, &ends, rows);
        break;
    case JOINT_HOLDS_POINT:
    case JOINT_HOLDS_NOTHING: // the distance of its anchors
        find_revolute(&ends, rows);
        break;
    }
}

Vec2 joint_rows_along(const Linkage *linkage, const Motion *motions, int joint)
{
    const Joint *of = &linkage->joints[joint];
    const double angle = of->body_a == LINKAGE_GROUND ? 0.0 : motions[of->body_a].angle;
    return vec2_rotate(angle + of->direction, (Vec2){1.0, 0.0});
}
