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

// Finds cosine and sine of the angle of each body, once for all its anchors.
static void find_turns(const Linkage *linkage, const Motion *motions, Vec2 *turns)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        turns[i] = (Vec2){cos(motions[i].angle), sin(motions[i].angle)};
    }
}

// An arm of a body in the world, as vec2_rotate has it.
static Vec2 turn_arm(const Vec2 *turns, int body, Vec2 arm)
{
    const Vec2 by = turns[body];
    return (Vec2){by.x * arm.x - by.y * arm.y, by.y * arm.x + by.x * arm.y};
}

// The rows of a pivot, two from the first: x and y of its second anchor against its first.
static void add_pivot(const Linkage *linkage, const Vec2 *turns, size_t joint, double *first,
                      size_t columns)
{
    for (int side = 0; side < 2; side++) {
        const JointEnd end = linkage_end(&linkage->joints[joint], side);
        if (end.body == LINKAGE_GROUND) {
            continue;
        }
        const double sign = side == 0 ? -1.0 : 1.0;
        const Vec2 arm = turn_arm(turns, end.body, end.anchor);
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

static void find_jacobian(const Linkage *linkage, const Motion *motions, const Vec2 *turns,
                          const bool *include, bool with_driver, Jacobian *jacobian)
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
            add_pivot(linkage, turns, i, first, jacobian->columns);
        }
        jacobian->rows += 2;
    }
    for (size_t i = 0; with_driver && i < linkage_drive_count(linkage); i++) {
        const size_t column = 3 * (size_t)linkage_drive_body(linkage, i) + 2;
        jacobian->entries[jacobian->rows * jacobian->columns + column] = 1.0;
        jacobian->rows++;
    }
}

void kinematics_jacobian(const Linkage *linkage, const Motion *motions, const bool *include,
                         bool with_driver, Jacobian *jacobian)
{
    Vec2 turns[KINEMATICS_BODY_MAX];
    assert(kinematics_is_small(linkage));
    find_turns(linkage, motions, turns);
    find_jacobian(linkage, motions, turns, include, with_driver, jacobian);
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
        include[i] = !ideal_only || joint_is_ideal(linkage->joints[i].kind);
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

// The opening of a pivot, as linkage_joint_gap has it.
static Vec2 pivot_opening(const Linkage *linkage, const Motion *motions, const Vec2 *turns,
                          size_t joint)
{
    Vec2 opening = {0.0, 0.0};
    for (int side = 1; side >= 0; side--) {
        const JointEnd end = linkage_end(&linkage->joints[joint], side);
        const Vec2 at =
            end.body == LINKAGE_GROUND
                ? end.anchor
                : vec2_add(motions[end.body].position, turn_arm(turns, end.body, end.anchor));
        opening = vec2_add(opening, vec2_scale(side == 1 ? 1.0 : -1.0, at));
    }
    return opening;
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

// Of each iteration and of what follows: the rows of one state of the bodies.
typedef struct Solving {
    const Linkage *linkage;
    Motion *motions;
    double *right;
    Vec2 *turns;
    void *memory;      // of the three above, of a large mechanism; owned, NULL of a small one
    Jacobian jacobian; // of a small mechanism, as all below
    size_t pivots[KINEMATICS_COLUMN_MAX];
    double small_right[KINEMATICS_ROW_MAX];
    Vec2 small_turns[KINEMATICS_BODY_MAX];
    Motion small_motions[KINEMATICS_BODY_MAX];
} Solving;

// Begins where the bodies are; for solving_finish. It stays where it is.
static void solving_start(Solving *solving, const Linkage *linkage, const Motion *motions)
{
    const size_t bodies = linkage->body_count;
    const size_t rows = joint_rows_total(linkage) + linkage_drive_count(linkage);
    solving->linkage = linkage;
    solving->right = solving->small_right;
    solving->turns = solving->small_turns;
    solving->motions = solving->small_motions;
    solving->memory = NULL;
    if (!kinematics_is_small(linkage)) {
        solving->memory =
            zeroed(1, bodies * (sizeof(Motion) + sizeof(Vec2)) + rows * sizeof *solving->right);
        solving->motions = solving->memory;
        solving->turns = (Vec2 *)(solving->motions + bodies);
        solving->right = (double *)(solving->turns + bodies);
    }
    memcpy(solving->motions, motions, bodies * sizeof *motions);
}

static void solving_finish(Solving *solving)
{
    free(solving->memory);
}

// Solves J u = right hand side for every joint and the driver; u has three entries a body.
static bool solve_rows(Solving *solving)
{
    const Linkage *linkage = solving->linkage;
    if (!kinematics_is_small(linkage)) {
        return solve_large(linkage, solving->motions, solving->right);
    }
    Jacobian *jacobian = &solving->jacobian;
    find_jacobian(linkage, solving->motions, solving->turns, NULL, true, jacobian);
    return jacobian->rows == jacobian->columns &&
           dense_solve(jacobian->columns, jacobian->entries, solving->right);
}

// The same where more than one right hand side follows for one place of the bodies. Of a large
// mechanism each is solved by itself, and nothing is found out here.
static bool split_rows(Solving *solving)
{
    const Linkage *linkage = solving->linkage;
    if (!kinematics_is_small(linkage)) {
        return true;
    }
    Jacobian *jacobian = &solving->jacobian;
    find_jacobian(linkage, solving->motions, solving->turns, NULL, true, jacobian);
    return jacobian->rows == jacobian->columns &&
           dense_split(jacobian->columns, jacobian->entries, solving->pivots);
}

static bool solve_split(Solving *solving)
{
    if (!kinematics_is_small(solving->linkage)) {
        return solve_large(solving->linkage, solving->motions, solving->right);
    }
    dense_solve_split(solving->jacobian.columns, solving->jacobian.entries, solving->pivots,
                      solving->right);
    return true;
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

// Writes what the joints lack to be closed; returns the largest, m.
static double find_residual(Solving *solving)
{
    const Linkage *linkage = solving->linkage;
    double *row = solving->right;
    double largest = 0.0;
    find_turns(linkage, solving->motions, solving->turns);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const JointKind kind = linkage->joints[i].kind;
        if (joint_rows_count(kind) == 0) {
            continue;
        }
        const Vec2 opening = joint_rows_is_angle(kind, 1)
                                 ? kinematics_opening(linkage, solving->motions, (int)i)
                                 : pivot_opening(linkage, solving->motions, solving->turns, i);
        largest = fmax(largest, joint_rows_size(linkage, (int)i, opening));
        *row++ = -opening.x;
        *row++ = -opening.y;
    }
    return largest;
}

static bool newton(Solving *solving, const DriveState *drives)
{
    const Linkage *linkage = solving->linkage;
    const size_t drive_count = linkage_drive_count(linkage);
    const double size = linkage_size(linkage);
    double *rows = solving->right + joint_rows_total(linkage); // of the drives
    for (int iteration = 0; iteration < ITERATION_MAX; iteration++) {
        const double opening = find_residual(solving);
        double turn = 0.0; // the largest that a drive misses
        for (size_t i = 0; i < drive_count; i++) {
            rows[i] = drives[i].angle - solving->motions[linkage_drive_body(linkage, i)].angle;
            turn = fmax(turn, fabs(rows[i]));
        }
        if (turn <= CLOSED && opening <= CLOSED * size) {
            return true;
        }
        if (!solve_rows(solving)) {
            return false;
        }
        kinematics_move(linkage, solving->right, solving->motions);
    }
    return false;
}

static bool solve_velocities(Solving *solving, const DriveState *drives)
{
    const Linkage *linkage = solving->linkage;
    const size_t total = joint_rows_total(linkage);
    double *rates = solving->right;
    memset(rates, 0, total * sizeof *rates);
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        rates[total + i] = drives[i].omega;
    }
    const bool is_solved = solve_split(solving);
    for (size_t i = 0; is_solved && i < linkage->body_count; i++) {
        Motion *motion = &solving->motions[i];
        motion->velocity = (Vec2){rates[3 * i], rates[3 * i + 1]};
        motion->omega = rates[3 * i + 2];
    }
    return is_solved;
}

static Vec2 centripetal(const Solving *solving, int body, Vec2 local)
{
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const double omega = solving->motions[body].omega;
    return vec2_scale(omega * omega, turn_arm(solving->turns, body, local));
}

// What the accelerations of a joint's bodies have to make up for.
static Vec2 joint_gamma(const Solving *solving, int number)
{
    const Joint *joint = &solving->linkage->joints[number];
    if (joint_rows_is_angle(joint->kind, 1)) {
        JointRows rows;
        joint_rows_find(solving->linkage, solving->motions, number, &rows);
        return (Vec2){-rows.bias[0], -rows.bias[1]};
    }
    return vec2_sub(centripetal(solving, joint->body_b, joint->anchor_b),
                    centripetal(solving, joint->body_a, joint->anchor_a));
}

static bool solve_accelerations(Solving *solving, const DriveState *drives)
{
    const Linkage *linkage = solving->linkage;
    double *rates = solving->right;
    double *row = rates;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_rows_count(linkage->joints[i].kind) > 0) {
            const Vec2 gamma = joint_gamma(solving, (int)i);
            *row++ = gamma.x;
            *row++ = gamma.y;
        }
    }
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        *row++ = drives[i].alpha;
    }
    const bool is_solved = solve_split(solving);
    for (size_t i = 0; is_solved && i < linkage->body_count; i++) {
        Motion *motion = &solving->motions[i];
        motion->acceleration = (Vec2){rates[3 * i], rates[3 * i + 1]};
        motion->alpha = rates[3 * i + 2];
    }
    return is_solved;
}

// The angle is that of the first drive.
static bool solve_all(Solving *solving, const DriveState *drives, bool is_motion, Err *err)
{
    const double degrees = drives[0].angle * 180.0 / M_PI;
    if (!newton(solving, drives)) {
        return err_set(err, ERR_SOLVER, "the linkage does not close at a crank angle of %.6g deg",
                       degrees);
    }
    return (split_rows(solving) && (!is_motion || (solve_velocities(solving, drives) &&
                                                   solve_accelerations(solving, drives)))) ||
           err_set(err, ERR_SOLVER,
                   "the linkage is at a dead centre at a crank angle of %.6g deg: its "
                   "velocities are not determined",
                   degrees);
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

// Without a motion asked for, positions alone change.
static bool solve_driven(const Linkage *linkage, const DriveState *drives, bool is_motion,
                         Motion *motions, Err *err)
{
    if (!kinematics_is_determined(linkage)) {
        return err_set(err, ERR_SOLVER,
                       "the drives alone do not determine the motion of this linkage: %zu "
                       "bodies, %zu joints, %zu drives",
                       linkage->body_count, linkage->joint_count, linkage_drive_count(linkage));
    }
    Solving solving;
    solving_start(&solving, linkage, motions);
    const bool is_solved = solve_all(&solving, drives, is_motion, err);
    if (is_solved) {
        memcpy(motions, solving.motions, linkage->body_count * sizeof *motions);
    }
    solving_finish(&solving);
    return is_solved;
}

bool kinematics_solve_driven(const Linkage *linkage, const DriveState *drives, Motion *motions,
                             Err *err)
{
    return solve_driven(linkage, drives, true, motions, err);
}

bool kinematics_place_driven(const Linkage *linkage, const DriveState *drives, Motion *motions,
                             Err *err)
{
    return solve_driven(linkage, drives, false, motions, err);
}
