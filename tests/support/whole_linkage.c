#include "whole_linkage.h"

#include "base/dense.h"
#include "model/kinematics.h"

#include <assert.h>
#include <string.h>

enum { SIZE_LIMIT = WHOLE_COLUMN_MAX + RESPONSE_ROW_MAX };

// Adds the rows of a joint: its opening rate, and the turns of its two bodies where they count.
static void add_rows(WholeLinkage *whole, size_t joint, bool with_turns)
{
    const Joint *data = &whole->linkage->joints[joint];
    const int still = whole->with_driven ? LINKAGE_GROUND : linkage_driven_body(whole->linkage);
    for (size_t column = 0; column < whole->columns; column++) {
        const size_t body = column / 3;
        Motion unit[KINEMATICS_BODY_MAX];
        for (size_t i = 0; i < whole->linkage->body_count; i++) {
            unit[i] = whole->motions[i];
            unit[i].velocity = (Vec2){0.0, 0.0};
            unit[i].omega = 0.0;
        }
        if (column % 3 == 2) {
            unit[body].omega = 1.0;
        } else {
            unit[body].velocity = (Vec2){column % 3 == 0 ? 1.0 : 0.0, column % 3 == 1 ? 1.0 : 0.0};
        }
        if ((int)body == still) {
            continue;
        }
        const Vec2 rate = vec2_sub(linkage_point_velocity(unit, data->body_b, data->anchor_b),
                                   linkage_point_velocity(unit, data->body_a, data->anchor_a));
        whole->jacobian[whole->row_count][column] = rate.x;
        whole->jacobian[whole->row_count + 1][column] = rate.y;
        for (size_t end = 0; with_turns && end < 2; end++) {
            const int turned = end == 0 ? data->body_a : data->body_b;
            whole->jacobian[whole->row_count + 2 + end][column] =
                (int)body == turned ? unit[body].omega : 0.0;
        }
    }
    whole->row_count += with_turns ? 4 : 2;
}

WholeLinkage whole_build(const Linkage *linkage, const Motion *motions, bool with_turns,
                         bool with_driven)
{
    WholeLinkage whole = {
        .linkage = linkage,
        .motions = motions,
        .with_turns = with_turns,
        .with_driven = with_driven,
        .columns = 3 * linkage->body_count,
    };
    const int driven = linkage->driver.is_present ? linkage->driver.joint : -1;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_REVOLUTE && (int)i != driven) {
            add_rows(&whole, i, false);
        }
    }
    whole.ideal_rows = whole.row_count;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_CLEARANCE) {
            add_rows(&whole, i, with_turns);
        }
    }
    return whole;
}

static double inertia_of(const WholeLinkage *whole, size_t column)
{
    const Body *body = &whole->linkage->bodies[column / 3];
    return column % 3 == 2 ? body->inertia : body->mass;
}

void whole_solve(const WholeLinkage *whole, const double *loads, const double *rates,
                 double *values, double *reactions)
{
    double matrix[SIZE_LIMIT * SIZE_LIMIT] = {0.0};
    double sides[SIZE_LIMIT];
    const size_t columns = whole->columns;
    const size_t size = columns + whole->ideal_rows;
    for (size_t i = 0; i < columns; i++) {
        const bool is_driven = (int)(i / 3) == linkage_driven_body(whole->linkage);
        matrix[i * size + i] = is_driven ? 1.0 : inertia_of(whole, i);
        sides[i] = loads[i];
    }
    for (size_t row = 0; row < whole->ideal_rows; row++) {
        for (size_t i = 0; i < columns; i++) {
            matrix[(columns + row) * size + i] = whole->jacobian[row][i];
            matrix[i * size + columns + row] = -whole->jacobian[row][i];
        }
        sides[columns + row] = rates[row];
    }
    const bool is_solved = dense_solve(size, matrix, sides);
    assert(is_solved);
    (void)is_solved;
    memcpy(values, sides, columns * sizeof *values);
    memcpy(reactions, sides + columns, whole->ideal_rows * sizeof *reactions);
}

double whole_rate(const WholeLinkage *whole, size_t row, const double *values)
{
    double rate = 0.0;
    for (size_t i = 0; i < whole->columns; i++) {
        rate += whole->jacobian[row][i] * values[i];
    }
    return rate;
}

void whole_load(const WholeLinkage *whole, const double *impulses, double *loads)
{
    memset(loads, 0, whole->columns * sizeof *loads);
    for (size_t row = whole->ideal_rows; row < whole->row_count; row++) {
        for (size_t i = 0; i < whole->columns; i++) {
            loads[i] += whole->jacobian[row][i] * impulses[row - whole->ideal_rows];
        }
    }
}

// The rows' rates at the bodies' velocities, the driven one's too, a moment before or later.
static void rates_after(const WholeLinkage *whole, double time_s, double *rates)
{
    Motion moved[KINEMATICS_BODY_MAX];
    double values[WHOLE_COLUMN_MAX];
    for (size_t i = 0; i < whole->linkage->body_count; i++) {
        const Motion *motion = &whole->motions[i];
        moved[i] = *motion;
        moved[i].position = vec2_add(motion->position, vec2_scale(time_s, motion->velocity));
        moved[i].angle += time_s * motion->omega;
        values[3 * i] = motion->velocity.x;
        values[3 * i + 1] = motion->velocity.y;
        values[3 * i + 2] = motion->omega;
    }
    const WholeLinkage later = whole_build(whole->linkage, moved, whole->with_turns, true);
    for (size_t row = 0; row < later.row_count; row++) {
        rates[row] = whole_rate(&later, row, values);
    }
}

void whole_given(const WholeLinkage *whole, double *accelerations)
{
    // central differences: the error is (omega t)^2 / 6 = 2e-9 of dJ/dt v, and of rounding 1e-9
    static const double MOMENT_S = 1e-6;
    const int driven = linkage_driven_body(whole->linkage);
    const Motion *motion = &whole->motions[driven];
    const WholeLinkage full = whole_build(whole->linkage, whole->motions, whole->with_turns, true);
    double own[WHOLE_COLUMN_MAX] = {0.0};
    double before[RESPONSE_ROW_MAX];
    double behind[RESPONSE_ROW_MAX];
    own[3 * driven] = motion->acceleration.x;
    own[3 * driven + 1] = motion->acceleration.y;
    rates_after(whole, -MOMENT_S, before);
    rates_after(whole, MOMENT_S, behind);
    for (size_t row = 0; row < whole->row_count; row++) {
        accelerations[row] = (behind[row] - before[row]) / (2.0 * MOMENT_S);
        accelerations[row] += whole_rate(&full, row, own);
    }
}
