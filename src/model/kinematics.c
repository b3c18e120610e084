// Finds where the bodies of a linkage with ideal joints are, and how fast they move.
//
// For a joint between bodies a and b with anchors s_a, s_b (body frames), R(phi) the rotation:
//     Phi = r_b + R(phi_b) s_b - r_a - R(phi_a) s_a = 0          two rows a joint
//     Phi_drive = phi_crank - (start + speed t) = 0               one row a drive
// Positions by Newton's method on Phi = 0; velocities from J qdot = -dPhi/dt; accelerations from
//     J qddot = gamma,   gamma = sum over bodies of  +-omega^2 R s   (the centripetal terms).
// Of a prismatic joint Phi and gamma are those of model/joint_rows.c, a stop has none.
// q = (x, y, phi) per body; J = dPhi/dq. Source: E. J. Haug, Computer Aided Kinematics and Dynamics
// of Mechanical Systems, 1989, chapter 3.
#include "model/kinematics.h"

#include "base/dense.h"
#include "base/zeroed.h"
#include "model/joint_rows.h"
#include "model/joint_system.h"

#include <string.h>

// Newton doubles the number of right digits: from 1e-2 of a length to rounding takes about 5
enum { ITERATION_MAX = 50 };

// of the linkage's size: rounding leaves some 1e-16, a closed linkage is a thousand times above it
static const double CLOSED = 1e-13;

// pivots of a linkage that moves freely are above 1e-3 of the largest; below this it is stuck
static const double LOOP_INDEPENDENT = 1e-9;

// The rows of a pivot, two from the first: x and y of its second anchor against its first.
static void add_pivot(const Linkage *linkage, const Motion *motions, size_t joint, double *first,
                      size_t columns)
{
    for (int side = 0; side < 2; side++) {
        const JointEnd end = linkage_end(&linkage->joints[joint], side);
        if (end.body == LINKAGE_GROUND) {
            continue;
        }
        const double sign = side == 0 ? -1.0 : 1.0;
        const Vec2 arm = vec2_rotate(motions[end.body].angle, end.anchor);
        double *x_row = first + 3 * end.body;
        double *y_row = x_row + columns;
        x_row[0] = sign;
        x_row[2] = -sign * arm.y;
        y_row[1] = sign;
        y_row[2] = sign * arm.x;
    }
}

// The rows of any joint that has some.
static void add_joint(const Linkage *linkage, const Motion *motions, size_t joint, double *first,
                      size_t columns)
{
    JointRows rows;
    joint_rows_find(linkage, motions, (int)joint, &rows);
    for (size_t i = 0; i < JOINT_ROWS; i++) {
        for (int side = 0; side < 2; side++) {
            const int body = linkage_end(&linkage->joints[joint], side).body;
            if (body != LINKAGE_GROUND) {
                double *entries = first + i * columns + 3 * body;
                entries[0] = rows.rows[i].x[side];
                entries[1] = rows.rows[i].y[side];
                entries[2] = rows.rows[i].turn[side];
            }
        }
    }
}

void kinematics_jacobian(const Linkage *linkage, const Motion *motions, const bool *include,
                         bool with_driver, Jacobian *jacobian)
{
    jacobian->rows = 0;
    jacobian->columns = 3 * linkage->body_count;
    const size_t row_most = 2 * linkage->joint_count + linkage_drive_count(linkage);
    memset(jacobian->entries, 0, row_most * jacobian->columns * sizeof *jacobian->entries);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const JointKind kind = linkage->joints[i].kind;
        if (joint_rows_count(kind) == 0 || (include != NULL && !include[i])) {
            continue;
        }
        double *first = jacobian->entries + jacobian->rows * jacobian->columns;
        if (joint_rows_is_angle(kind, 1)) {
            add_joint(linkage, motions, i, first, jacobian->columns);
        } else {
            add_pivot(linkage, motions, i, first, jacobian->columns);
        }
        jacobian->rows += 2;
    }
    for (size_t i = 0; with_driver && i < linkage_drive_count(linkage); i++) {
        const size_t column = 3 * (size_t)linkage_drive_body(linkage, i) + 2;
        jacobian->entries[jacobian->rows * jacobian->columns + column] = 1.0;
        jacobian->rows++;
    }
}

void kinematics_move(const Linkage *linkage, const double *change, Motion *motions)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i].position.x += change[3 * i];
        motions[i].position.y += change[3 * i + 1];
        motions[i].angle += change[3 * i + 2];
    }
}

size_t kinematics_mobility(const Linkage *linkage, const Motion *motions, bool ideal_only)
{
    bool *include = zeroed(linkage->joint_count, sizeof *include);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        include[i] = !ideal_only || linkage_kind_is_ideal(linkage->joints[i].kind);
    }
    size_t rows;
    const size_t rank = kinematics_rank(linkage, motions, include, false, LOOP_INDEPENDENT, &rows);
    free(include);
    return 3 * linkage->body_count - rank;
}

size_t kinematics_rank(const Linkage *linkage, const Motion *motions, const bool *include,
                       bool with_driver, double independent, size_t *rows)
{
    if (kinematics_is_small(linkage)) {
        Jacobian jacobian;
        kinematics_jacobian(linkage, motions, include, with_driver, &jacobian);
        *rows = jacobian.rows;
        return dense_rank(jacobian.rows, jacobian.columns, jacobian.entries, independent);
    }
    JointSystem system;
    joint_system_init(linkage, motions, include, with_driver, &system);
    *rows = system.row_count;
    const size_t rank = joint_system_rank(&system);
    joint_system_finish(&system);
    return rank;
}

Vec2 kinematics_opening(const Linkage *linkage, const Motion *motions, int joint)
{
    const JointKind kind = linkage->joints[joint].kind;
    if (!joint_rows_is_angle(kind, 1)) {
        return joint_rows_count(kind) == 0 ? (Vec2){0.0, 0.0}
                                           : linkage_joint_gap(linkage, motions, joint).position;
    }
    JointRows rows;
    joint_rows_find(linkage, motions, joint, &rows);
    return (Vec2){rows.position[0], rows.position[1]};
}

double kinematics_closure_error(const Linkage *linkage, const Motion *motions)
{
    double largest = 0.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Vec2 opening = kinematics_opening(linkage, motions, (int)i);
        largest = fmax(largest, joint_rows_size(linkage, (int)i, opening));
    }
    return largest;
}

// The same of a large mechanism. The rows are as many as the unknowns: the least change that they
// ask for is the only one.
static bool solve_large(const Linkage *linkage, const Motion *motions, double *right)
{
    JointSystem system;
    joint_system_init(linkage, motions, NULL, true, &system);
    const size_t columns = 3 * linkage->body_count;
    const bool is_determined =
        system.row_count == columns && joint_system_rank(&system) == system.row_count;
    if (is_determined) {
        double *change = zeroed(columns, sizeof *change);
        joint_system_least_change(&system, right, change);
        memcpy(right, change, columns * sizeof *right);
        free(change);
    }
    joint_system_finish(&system);
    return is_determined;
}

// Solves J u = right hand side for every joint and the driver; u has three entries a body.
static bool solve_rows(const Linkage *linkage, const Motion *motions, double *right)
{
    if (!kinematics_is_small(linkage)) {
        return solve_large(linkage, motions, right);
    }
    Jacobian jacobian;
    kinematics_jacobian(linkage, motions, NULL, true, &jacobian);
    return jacobian.rows == jacobian.columns &&
           dense_solve(jacobian.columns, jacobian.entries, right);
}

// The largest distance of an anchor from its body's centre, or from the world's origin, m.
static double linkage_size(const Linkage *linkage)
{
    double size = 0.0;
    for (size_t i = 0; i < 2 * linkage->joint_count; i++) {
        size = fmax(size, vec2_length(linkage_end(&linkage->joints[i / 2], i % 2).anchor));
    }
    return size;
}

// Room for what the rows of the joints and the drive say, and for what the bodies do.
static double *create_rows(const Linkage *linkage)
{
    return zeroed(joint_rows_total(linkage) + linkage_drive_count(linkage), sizeof(double));
}

static bool newton(const Linkage *linkage, const DriveState *drives, double *residual,
                   Motion *motions)
{
    const size_t drive_count = linkage_drive_count(linkage);
    const double size = linkage_size(linkage);
    for (int iteration = 0; iteration < ITERATION_MAX; iteration++) {
        double *row = residual;
        for (size_t i = 0; i < linkage->joint_count; i++) {
            if (joint_rows_count(linkage->joints[i].kind) > 0) {
                const Vec2 opening = kinematics_opening(linkage, motions, (int)i);
                *row++ = -opening.x;
                *row++ = -opening.y;
            }
        }
        double turn = 0.0; // the largest that a drive misses
        for (size_t i = 0; i < drive_count; i++) {
            row[i] = drives[i].angle - motions[linkage_drive_body(linkage, i)].angle;
            turn = fmax(turn, fabs(row[i]));
        }
        if (turn <= CLOSED && kinematics_closure_error(linkage, motions) <= CLOSED * size) {
            return true;
        }
        if (!solve_rows(linkage, motions, residual)) {
            return false;
        }
        kinematics_move(linkage, residual, motions);
    }
    return false;
}

static bool solve_velocities(const Linkage *linkage, const DriveState *drives, Motion *motions)
{
    double *rates = create_rows(linkage);
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        rates[joint_rows_total(linkage) + i] = drives[i].omega;
    }
    const bool is_solved = solve_rows(linkage, motions, rates);
    for (size_t i = 0; is_solved && i < linkage->body_count; i++) {
        motions[i].velocity = (Vec2){rates[3 * i], rates[3 * i + 1]};
        motions[i].omega = rates[3 * i + 2];
    }
    free(rates);
    return is_solved;
}

static Vec2 centripetal(const Motion *motions, int body, Vec2 local)
{
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const double omega = motions[body].omega;
    return vec2_scale(omega * omega, vec2_rotate(motions[body].angle, local));
}

// What the accelerations of a joint's bodies have to make up for.
static Vec2 joint_gamma(const Linkage *linkage, const Motion *motions, int number)
{
    const Joint *joint = &linkage->joints[number];
    if (joint_rows_is_angle(joint->kind, 1)) {
        JointRows rows;
        joint_rows_find(linkage, motions, number, &rows);
        return (Vec2){-rows.bias[0], -rows.bias[1]};
    }
    return vec2_sub(centripetal(motions, joint->body_b, joint->anchor_b),
                    centripetal(motions, joint->body_a, joint->anchor_a));
}

static bool solve_accelerations(const Linkage *linkage, const DriveState *drives, Motion *motions)
{
    double *rates = create_rows(linkage);
    double *row = rates;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_rows_count(linkage->joints[i].kind) > 0) {
            const Vec2 gamma = joint_gamma(linkage, motions, (int)i);
            *row++ = gamma.x;
            *row++ = gamma.y;
        }
    }
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        *row++ = drives[i].alpha;
    }
    const bool is_solved = solve_rows(linkage, motions, rates);
    for (size_t i = 0; is_solved && i < linkage->body_count; i++) {
        motions[i].acceleration = (Vec2){rates[3 * i], rates[3 * i + 1]};
        motions[i].alpha = rates[3 * i + 2];
    }
    free(rates);
    return is_solved;
}

static bool solve_all(const Linkage *linkage, const DriveState *drives, Motion *motions, Err *err)
{
    double *residual = create_rows(linkage);
    const bool is_closed = newton(linkage, drives, residual, motions);
    free(residual);
    if (!is_closed) {
        return err_set(err, ERR_SOLVER, "the linkage does not close at a crank angle of %.6g deg",
                       drives[0].angle * 180.0 / M_PI);
    }
    return (solve_velocities(linkage, drives, motions) &&
            solve_accelerations(linkage, drives, motions)) ||
           err_set(err, ERR_SOLVER,
                   "the linkage is at a dead centre at a crank angle of %.6g deg: its "
                   "velocities are not determined",
                   drives[0].angle * 180.0 / M_PI);
}

bool kinematics_solve(const Linkage *linkage, double crank_angle, Motion *motions, Err *err)
{
    DriveState drives[LINKAGE_DRIVE_MAX] = {{.angle = crank_angle, .omega = linkage->driver.speed}};
    for (size_t i = 1; i < linkage_drive_count(linkage); i++) {
        drives[i] = drive_at(linkage_drive(linkage, i), 0.0);
    }
    return kinematics_solve_driven(linkage, drives, motions, err);
}

bool kinematics_is_determined(const Linkage *linkage)
{
    return linkage->driver.is_present &&
           joint_rows_total(linkage) + linkage_drive_count(linkage) == 3 * linkage->body_count;
}

bool kinematics_solve_driven(const Linkage *linkage, const DriveState *drives, Motion *motions,
                             Err *err)
{
    if (!kinematics_is_determined(linkage)) {
        return err_set(err, ERR_SOLVER,
                       "the drives alone do not determine the motion of this linkage: %zu "
                       "bodies, %zu joints, %zu drives",
                       linkage->body_count, linkage->joint_count, linkage_drive_count(linkage));
    }
    Motion *solved = zeroed(linkage->body_count, sizeof *solved);
    memcpy(solved, motions, linkage->body_count * sizeof *motions);
    const bool is_solved = solve_all(linkage, drives, solved, err);
    if (is_solved) {
        memcpy(motions, solved, linkage->body_count * sizeof *motions);
    }
    free(solved);
    return is_solved;
}
