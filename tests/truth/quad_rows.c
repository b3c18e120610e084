// How do the ideal joints of a mechanism hold its bodies?
//
// Coordinates q = (x, y, phi) of each body, diagonal masses M. With s the anchor's arm in the
// world, m, d = r_b + s_b - r_a - s_a, t the direction on body a of the line that body b slides on
// and n = perp t, perp (x, y) = (-y, x), a joint's two rows and the rates of their rates are
//     revolute   d                     w_a^2 s_a - w_b^2 s_b + J q''
//     sliding    n d                   n (w_a^2 s_a - w_b^2 s_b) - 2 w_a t d' - w_a^2 n d + J q''
//                phi_b - phi_a - held  J q''
// with J = dPhi/dq. A right hand side b is
// met by the change M^-1 J^T lambda of the coordinates, (J M^-1 J^T) lambda = b: with b = -Phi
// it closes the joints (again and again, as Newton's method), with b = -J q' it rids the
// velocities of what would open them. The change is the smallest one in the norm of M.
// J M^-1 J^T is positive definite where no row is redundant; it is solved as L D L^T.
#include "quad_rows.h"

#include <string.h>

// Newton's method doubles the digits: from 1e-2 m to 33 digits takes six
enum { PROJECTION_MAX = 12 };

// m: the last bits of lengths of a metre
static const double CLOSED = 1e-33;

Quad quad_dot(QuadVec a, QuadVec b)
{
    return a.x * b.x + a.y * b.y;
}

QuadVec quad_difference(QuadVec a, QuadVec b)
{
    return (QuadVec){a.x - b.x, a.y - b.y};
}

QuadVec quad_arm(const Quad *position, int body, QuadVec local)
{
    if (body == LINKAGE_GROUND) {
        return local;
    }
    Quad sine = 0;
    Quad cosine = 0;
    sincosq(position[3 * body + 2], &sine, &cosine);
    return (QuadVec){cosine * local.x - sine * local.y, sine * local.x + cosine * local.y};
}

QuadVec quad_point(const Quad *position, int body, QuadVec arm)
{
    if (body == LINKAGE_GROUND) {
        return arm;
    }
    return (QuadVec){position[3 * body] + arm.x, position[3 * body + 1] + arm.y};
}

QuadVec quad_point_velocity(const Quad *velocity, int body, QuadVec arm)
{
    if (body == LINKAGE_GROUND) {
        return (QuadVec){0, 0};
    }
    const Quad omega = velocity[3 * body + 2];
    return (QuadVec){velocity[3 * body] - omega * arm.y, velocity[3 * body + 1] + omega * arm.x};
}

QuadVec quad_along(const Quad *position, int body, Quad direction)
{
    const Quad angle = body == LINKAGE_GROUND ? direction : position[3 * body + 2] + direction;
    return (QuadVec){cosq(angle), sinq(angle)};
}

Quad quad_omega(const Quad *velocity, int body)
{
    return body == LINKAGE_GROUND ? 0 : velocity[3 * body + 2];
}

static bool is_free(const QuadProblem *problem, int body)
{
    return body != LINKAGE_GROUND && body != problem->driven_body;
}

void quad_push(const QuadProblem *problem, int body, QuadVec arm, QuadVec force, Quad *coordinates)
{
    if (is_free(problem, body)) {
        const QuadBody *moved = &problem->bodies[body];
        coordinates[3 * body] += force.x / moved->mass;
        coordinates[3 * body + 1] += force.y / moved->mass;
        coordinates[3 * body + 2] += (arm.x * force.y - arm.y * force.x) / moved->inertia;
    }
}

// What two sides of rows on one body give to J M^-1 J^T.
static Quad product(const QuadProblem *problem, int body, const QuadRow *first,
                    const QuadRow *second)
{
    return (first->x * second->x + first->y * second->y) / problem->bodies[body].mass +
           first->turn * second->turn / problem->bodies[body].inertia;
}

static QuadVec perp(QuadVec a)
{
    return (QuadVec){-a.y, a.x};
}

static Quad cross(QuadVec a, QuadVec b)
{
    return a.x * b.y - a.y * b.x;
}

// From the anchor on body a to that on body b.
static QuadVec distance_of(const QuadJoint *joint, const Quad *position)
{
    const QuadVec a = quad_arm(position, joint->body_a, joint->anchor_a);
    const QuadVec b = quad_arm(position, joint->body_b, joint->anchor_b);
    return quad_difference(quad_point(position, joint->body_b, b),
                           quad_point(position, joint->body_a, a));
}

static void make_rows(const QuadJoint *joint, const Quad *position, QuadRow rows[2][2])
{
    const QuadVec a = quad_arm(position, joint->body_a, joint->anchor_a);
    const QuadVec b = quad_arm(position, joint->body_b, joint->anchor_b);
    if (!joint->is_sliding) {
        rows[0][0] = (QuadRow){-1, 0, a.y};
        rows[0][1] = (QuadRow){1, 0, -b.y};
        rows[1][0] = (QuadRow){0, -1, -a.x};
        rows[1][1] = (QuadRow){0, 1, b.x};
        return;
    }
    const QuadVec n = perp(quad_along(position, joint->body_a, joint->direction));
    const QuadVec d = distance_of(joint, position);
    rows[0][0] = (QuadRow){-n.x, -n.y, -cross((QuadVec){a.x + d.x, a.y + d.y}, n)};
    rows[0][1] = (QuadRow){n.x, n.y, cross(b, n)};
    rows[1][0] = (QuadRow){0, 0, -1};
    rows[1][1] = (QuadRow){0, 0, 1};
}

// The rows' values.
static void values_of(const QuadJoint *joint, const Quad *position, Quad values[2])
{
    const QuadVec d = distance_of(joint, position);
    values[0] = d.x;
    values[1] = d.y;
    if (joint->is_sliding) {
        const Quad a = joint->body_a == LINKAGE_GROUND ? 0 : position[3 * joint->body_a + 2];
        const Quad b = joint->body_b == LINKAGE_GROUND ? 0 : position[3 * joint->body_b + 2];
        values[0] = quad_dot(perp(quad_along(position, joint->body_a, joint->direction)), d);
        values[1] = b - a - joint->held_angle;
    }
}

static void factorise(QuadRows *rows)
{
    const size_t n = 2 * rows->joint_count;
    for (size_t k = 0; k < n; k++) {
        for (size_t i = k + 1; i < n; i++) {
            const Quad share = rows->factor[i][k] / rows->factor[k][k];
            for (size_t j = k + 1; j <= i; j++) {
                rows->factor[i][j] -= share * rows->factor[j][k];
            }
        }
        for (size_t i = k + 1; i < n; i++) {
            rows->factor[i][k] /= rows->factor[k][k];
        }
    }
}

QuadRows quad_rows_make(const QuadProblem *problem, const Quad *position, bool with_play)
{
    QuadRows rows;
    rows.joint_count = 0;
    for (size_t k = 0; k < problem->joint_count; k++) {
        const QuadJoint *joint = &problem->joints[k];
        const bool is_held =
            joint->held == QUAD_HELD_ALWAYS || (with_play && joint->held == QUAD_HELD_AT_START);
        if ((int)k != problem->driver_joint && is_held) {
            const size_t row = rows.joint_count++;
            rows.joints[row] = k;
            make_rows(joint, position, rows.row + 2 * row);
        }
    }
    for (size_t i = 0; i < 2 * rows.joint_count; i++) {
        memset(rows.factor[i], 0, 2 * rows.joint_count * sizeof rows.factor[i][0]);
    }
    // the lower triangle: every pair of rows whose joints share a free body
    for (size_t i = 0; i < 2 * rows.joint_count; i++) {
        const QuadJoint *first = &problem->joints[rows.joints[i / 2]];
        const int firsts[2] = {first->body_a, first->body_b};
        for (size_t j = 0; j <= i; j++) {
            const QuadJoint *second = &problem->joints[rows.joints[j / 2]];
            const int seconds[2] = {second->body_a, second->body_b};
            for (int s = 0; s < 2; s++) {
                for (int t = 0; t < 2; t++) {
                    if (firsts[s] == seconds[t] && is_free(problem, firsts[s])) {
                        rows.factor[i][j] +=
                            product(problem, firsts[s], &rows.row[i][s], &rows.row[j][t]);
                    }
                }
            }
        }
    }
    factorise(&rows);
    return rows;
}

void quad_rows_apply(const QuadProblem *problem, const QuadRows *rows, Quad *right,
                     Quad *coordinates)
{
    const size_t n = 2 * rows->joint_count;
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < i; k++) {
            right[i] -= rows->factor[i][k] * right[k];
        }
    }
    for (size_t i = n; i-- > 0;) {
        right[i] /= rows->factor[i][i];
        for (size_t k = i + 1; k < n; k++) {
            right[i] -= rows->factor[k][i] * right[k];
        }
    }
    for (size_t i = 0; i < n; i++) {
        const QuadJoint *joint = &problem->joints[rows->joints[i / 2]];
        const int bodies[2] = {joint->body_a, joint->body_b};
        for (int side = 0; side < 2; side++) {
            const int body = bodies[side];
            const QuadRow *row = &rows->row[i][side];
            if (is_free(problem, body)) {
                const QuadBody *moved = &problem->bodies[body];
                coordinates[3 * body] += row->x * right[i] / moved->mass;
                coordinates[3 * body + 1] += row->y * right[i] / moved->mass;
                coordinates[3 * body + 2] += row->turn * right[i] / moved->inertia;
            }
        }
    }
}

void quad_rows_of(const QuadProblem *problem, const QuadRows *rows, const Quad *coordinates,
                  Quad *values)
{
    for (size_t i = 0; i < 2 * rows->joint_count; i++) {
        const QuadJoint *joint = &problem->joints[rows->joints[i / 2]];
        const int bodies[2] = {joint->body_a, joint->body_b};
        values[i] = 0;
        for (int side = 0; side < 2; side++) {
            const QuadRow *row = &rows->row[i][side];
            if (bodies[side] != LINKAGE_GROUND) {
                const Quad *of = coordinates + 3 * bodies[side];
                values[i] += row->x * of[0] + row->y * of[1] + row->turn * of[2];
            }
        }
    }
}

void quad_rows_bias(const QuadProblem *problem, const QuadRows *rows, const Quad *position,
                    const Quad *velocity, Quad *values)
{
    for (size_t i = 0; i < rows->joint_count; i++) {
        const QuadJoint *joint = &problem->joints[rows->joints[i]];
        const QuadVec a = quad_arm(position, joint->body_a, joint->anchor_a);
        const QuadVec b = quad_arm(position, joint->body_b, joint->anchor_b);
        const Quad omega_a = quad_omega(velocity, joint->body_a);
        const Quad omega_b = quad_omega(velocity, joint->body_b);
        const QuadVec second = {omega_a * omega_a * a.x - omega_b * omega_b * b.x,
                                omega_a * omega_a * a.y - omega_b * omega_b * b.y};
        values[2 * i] = second.x;
        values[2 * i + 1] = second.y;
        if (joint->is_sliding) {
            const QuadVec t = quad_along(position, joint->body_a, joint->direction);
            const QuadVec moving = quad_difference(quad_point_velocity(velocity, joint->body_b, b),
                                                   quad_point_velocity(velocity, joint->body_a, a));
            values[2 * i] = quad_dot(perp(t), second) - 2 * omega_a * quad_dot(t, moving) -
                            omega_a * omega_a * quad_dot(perp(t), distance_of(joint, position));
            values[2 * i + 1] = 0;
        }
    }
}

Quad quad_rows_project(const QuadProblem *problem, bool with_play, Quad *position, Quad *velocity)
{
    Quad open = 0;
    Quad right[QUAD_ROW_MAX];
    for (int count = 0; count < PROJECTION_MAX; count++) {
        const QuadRows rows = quad_rows_make(problem, position, with_play);
        Quad largest = 0;
        for (size_t i = 0; i < rows.joint_count; i++) {
            const QuadJoint *joint = &problem->joints[rows.joints[i]];
            Quad values[2];
            values_of(joint, position, values);
            right[2 * i] = joint->start.x - values[0];
            right[2 * i + 1] = joint->start.y - values[1];
            largest = fmaxq(largest, hypotq(right[2 * i], right[2 * i + 1]));
        }
        open = count == 0 ? largest : open;
        if (largest < CLOSED) {
            break;
        }
        quad_rows_apply(problem, &rows, right, position);
    }
    const QuadRows rows = quad_rows_make(problem, position, with_play);
    quad_rows_of(problem, &rows, velocity, right);
    for (size_t i = 0; i < 2 * rows.joint_count; i++) {
        right[i] = -right[i];
    }
    quad_rows_apply(problem, &rows, right, velocity);
    return open;
}
