// Holds loops of ideal joints and drives by rows of the driver's own.
#include "drivers/common/hold.h"

#include "base/dense.h"

#include <stdlib.h>
#include <string.h>

// of Newton's method from positions that are off by what a step makes: each squares the error
enum { HOLD_ROUNDS = 3 };

Hold hold_make(const Tree *tree)
{
    const DriverCase *of = tree->of;
    Hold hold = {.tree = tree, .rows = of->drive_count};
    hold.joints = driver_room(of->joint_count, sizeof *hold.joints);
    for (size_t i = 0; i < of->joint_count; i++) {
        if (tree->is_left[i]) {
            hold.joints[hold.loops++] = (int)i;
            hold.rows += 2;
        }
    }
    hold.jacobian = driver_room(hold.rows * tree->coordinates, sizeof *hold.jacobian);
    hold.columns = driver_room(hold.rows * tree->coordinates, sizeof *hold.columns);
    hold.matrix = driver_room(hold.rows * hold.rows, sizeof *hold.matrix);
    hold.right = driver_room(hold.rows, sizeof *hold.right);
    hold.rates = driver_room(tree->coordinates, sizeof *hold.rates);
    hold.motions = driver_room(of->body_count, sizeof *hold.motions);
    hold.bends = driver_room(of->body_count, sizeof *hold.bends);
    return hold;
}

void hold_finish(Hold *hold)
{
    free(hold->joints);
    free(hold->jacobian);
    free(hold->columns);
    free(hold->matrix);
    free(hold->right);
    free(hold->rates);
    free(hold->motions);
    free(hold->bends);
}

// The loop of a row; NULL of a drive's.
static const DriverJoint *loop_of(const Hold *hold, size_t row)
{
    return row < 2 * hold->loops ? &hold->tree->of->joints[hold->joints[row / 2]] : NULL;
}

static const DriverDrive *drive_of(const Hold *hold, size_t row)
{
    return &hold->tree->of->drives[row - 2 * hold->loops];
}

static Vec2 direction_of(size_t row)
{
    return row % 2 == 0 ? (Vec2){1.0, 0.0} : (Vec2){0.0, 1.0};
}

void hold_push(const Hold *hold, size_t row, const DriverMotion *motions, double value,
               DriverAction *actions)
{
    const DriverJoint *loop = loop_of(hold, row);
    if (loop == NULL) {
        actions[drive_of(hold, row)->body].moment += value;
        return;
    }
    for (int side = 0; side < 2; side++) {
        actions_add(motions, loop->bodies[side], loop->anchors[side],
                    vec2_scale(side == 0 ? -value : value, direction_of(row)), actions);
    }
}

void hold_place(Hold *hold, const DriverMotion *motions)
{
    const Tree *tree = hold->tree;
    memset(hold->jacobian, 0, hold->rows * tree->coordinates * sizeof *hold->jacobian);
    for (size_t row = 0; row < hold->rows; row++) {
        double *of = hold->jacobian + row * tree->coordinates;
        const DriverJoint *loop = loop_of(hold, row);
        if (loop == NULL) {
            tree_turn(tree, drive_of(hold, row)->body, 1.0, of);
            continue;
        }
        for (int side = 0; side < 2; side++) {
            tree_push(tree, motions, loop->bodies[side], loop->anchors[side],
                      vec2_scale(side == 0 ? -1.0 : 1.0, direction_of(row)), of);
        }
    }
}

static double dot(const double *a, const double *b, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Adds A f with J A f what stands on the right.
static void add_answer(Hold *hold, double *to)
{
    const size_t count = hold->tree->coordinates;
    for (size_t i = 0; i < hold->rows; i++) {
        for (size_t k = 0; k < hold->rows; k++) {
            hold->matrix[i * hold->rows + k] =
                dot(hold->jacobian + i * count, hold->columns + k * count, count);
        }
    }
    if (!dense_solve(hold->rows, hold->matrix, hold->right)) {
        driver_fail("the ideal joints and drives are redundant: give one joint of the loop some "
                    "play");
    }
    for (size_t k = 0; k < hold->rows; k++) {
        for (size_t i = 0; i < count; i++) {
            to[i] += hold->right[k] * hold->columns[k * count + i];
        }
    }
}

// What the rates alone accelerate a point of a body by.
static Vec2 bend_of(const Hold *hold, int body, Vec2 local)
{
    if (body == DRIVER_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const DriverMotion *motion = &hold->motions[body];
    return vec2_sub(hold->bends[body],
                    vec2_scale(motion->omega * motion->omega, vec2_rotate(motion->angle, local)));
}

void hold_accelerate(Hold *hold, const double *q, const double *v, double from_s, double time_s,
                     double *a)
{
    const size_t count = hold->tree->coordinates;
    if (hold->rows == 0) {
        return;
    }
    tree_motions(hold->tree, q, v, hold->motions);
    tree_bends(hold->tree, hold->motions, v, hold->bends);
    for (size_t row = 0; row < hold->rows; row++) {
        const DriverJoint *loop = loop_of(hold, row);
        double wanted = 0.0;
        if (loop == NULL) {
            wanted = drive_since(&drive_of(hold, row)->law, from_s, time_s).alpha;
        } else {
            wanted = -vec2_dot(direction_of(row),
                               vec2_sub(bend_of(hold, loop->bodies[1], loop->anchors[1]),
                                        bend_of(hold, loop->bodies[0], loop->anchors[0])));
        }
        hold->right[row] = wanted - dot(hold->jacobian + row * count, a, count);
    }
    add_answer(hold, a);
}

void hold_restrain(Hold *hold, double *a)
{
    const size_t count = hold->tree->coordinates;
    for (size_t row = 0; row < hold->rows; row++) {
        hold->right[row] = -dot(hold->jacobian + row * count, a, count);
    }
    if (hold->rows > 0) {
        add_answer(hold, a);
    }
}

// How far a row is off, m or rad.
static double opening_of(const Hold *hold, size_t row, double time_s)
{
    const DriverJoint *loop = loop_of(hold, row);
    if (loop == NULL) {
        const DriverDrive *drive = drive_of(hold, row);
        return hold->motions[drive->body].angle - drive_angle(&drive->law, time_s);
    }
    return vec2_dot(direction_of(row),
                    vec2_sub(driver_point(hold->motions, loop->bodies[1], loop->anchors[1]),
                             driver_point(hold->motions, loop->bodies[0], loop->anchors[0])));
}

void hold_settle(Hold *hold, double from_s, double time_s, double *q, double *v)
{
    const size_t count = hold->tree->coordinates;
    for (int round = 0; hold->rows > 0 && round < HOLD_ROUNDS; round++) {
        tree_motions(hold->tree, q, v, hold->motions);
        hold_place(hold, hold->motions);
        for (size_t row = 0; row < hold->rows; row++) {
            hold->right[row] = -opening_of(hold, row, time_s);
        }
        add_answer(hold, q);
    }
    for (size_t row = 0; row < hold->rows; row++) {
        const double wanted = loop_of(hold, row) == NULL
                                  ? drive_since(&drive_of(hold, row)->law, from_s, time_s).omega
                                  : 0.0;
        hold->right[row] = wanted - dot(hold->jacobian + row * count, v, count);
    }
    if (hold->rows > 0) {
        add_answer(hold, v);
    }
}
