// How do the ideal joints of a mechanism hold its bodies?
//
// Coordinates q = (x, y, phi) of each body, diagonal masses M. A joint's two rows are
//     Phi = r_b + s_b - r_a - s_a,   s the anchor's arm in the world, m
// and a body's part in J = dPhi/dq is +-[1 | perp s], perp (x, y) = (-y, x). A right hand side b is
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

QuadVec quad_point_acceleration(const Quad *acceleration, const Quad *velocity, int body,
                                QuadVec arm)
{
    if (body == LINKAGE_GROUND) {
        return (QuadVec){0, 0};
    }
    const Quad alpha = acceleration[3 * body + 2];
    const Quad square = velocity[3 * body + 2] * velocity[3 * body + 2];
    return (QuadVec){acceleration[3 * body] - alpha * arm.y - square * arm.x,
                     acceleration[3 * body + 1] + alpha * arm.x - square * arm.y};
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

// Adds to the block (i, j) of J M^-1 J^T what one body gives, whose arms are s and t.
static void add_block(const QuadProblem *problem, QuadRows *rows, size_t i, size_t j, int body,
                      QuadVec s, QuadVec t, bool is_same_side)
{
    const Quad sign = is_same_side ? 1 : -1;
    const Quad light = sign / problem->bodies[body].mass;
    const Quad turning = sign / problem->bodies[body].inertia;
    rows->factor[2 * i][2 * j] += light + turning * s.y * t.y;
    rows->factor[2 * i][2 * j + 1] -= turning * s.y * t.x;
    rows->factor[2 * i + 1][2 * j] -= turning * s.x * t.y;
    rows->factor[2 * i + 1][2 * j + 1] += light + turning * s.x * t.x;
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
        if ((int)k != problem->driver_joint && (with_play || !joint->has_play)) {
            const size_t row = rows.joint_count++;
            rows.joints[row] = k;
            rows.arm[row][0] = quad_arm(position, joint->body_a, joint->anchor_a);
            rows.arm[row][1] = quad_arm(position, joint->body_b, joint->anchor_b);
        }
    }
    for (size_t i = 0; i < 2 * rows.joint_count; i++) {
        memset(rows.factor[i], 0, 2 * rows.joint_count * sizeof rows.factor[i][0]);
    }
    // the lower triangle of blocks: every pair of joints that share a free body
    for (size_t i = 0; i < rows.joint_count; i++) {
        const QuadJoint *first = &problem->joints[rows.joints[i]];
        const int firsts[2] = {first->body_a, first->body_b};
        for (size_t j = 0; j <= i; j++) {
            const QuadJoint *second = &problem->joints[rows.joints[j]];
            const int seconds[2] = {second->body_a, second->body_b};
            for (int s = 0; s < 2; s++) {
                for (int t = 0; t < 2; t++) {
                    if (firsts[s] == seconds[t] && is_free(problem, firsts[s])) {
                        add_block(problem, &rows, i, j, firsts[s], rows.arm[i][s], rows.arm[j][t],
                                  s == t);
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
    for (size_t i = 0; i < rows->joint_count; i++) {
        const QuadJoint *joint = &problem->joints[rows->joints[i]];
        const int bodies[2] = {joint->body_a, joint->body_b};
        for (int side = 0; side < 2; side++) {
            const int body = bodies[side];
            const Quad sign = side == 0 ? -1 : 1;
            quad_push(problem, body, rows->arm[i][side],
                      (QuadVec){sign * right[2 * i], sign * right[2 * i + 1]}, coordinates);
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
            const QuadVec a = quad_point(position, joint->body_a, rows.arm[i][0]);
            const QuadVec b = quad_point(position, joint->body_b, rows.arm[i][1]);
            right[2 * i] = a.x + joint->start.x - b.x;
            right[2 * i + 1] = a.y + joint->start.y - b.y;
            largest = fmaxq(largest, hypotq(right[2 * i], right[2 * i + 1]));
        }
        open = count == 0 ? largest : open;
        if (largest < CLOSED) {
            break;
        }
        quad_rows_apply(problem, &rows, right, position);
    }
    const QuadRows rows = quad_rows_make(problem, position, with_play);
    for (size_t i = 0; i < rows.joint_count; i++) {
        const QuadJoint *joint = &problem->joints[rows.joints[i]];
        const QuadVec a = quad_point_velocity(velocity, joint->body_a, rows.arm[i][0]);
        const QuadVec b = quad_point_velocity(velocity, joint->body_b, rows.arm[i][1]);
        right[2 * i] = a.x - b.x;
        right[2 * i + 1] = a.y - b.y;
    }
    quad_rows_apply(problem, &rows, right, velocity);
    return open;
}
