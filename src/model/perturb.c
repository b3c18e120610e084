// Which start lies beside a start without opening any ideal joint?
//
//     dv = w - J^T (J J^T)^-1 J w,     w random, J the rows of the ideal joints and the driver
#include "model/perturb.h"

#include "base/dense.h"
#include "model/kinematics.h"

#include <stdint.h>

// A number in [-1, 1): Knuth's 64-bit linear congruential generator, whose high bits are good
// enough for a handful of draws.
static double draw(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

// Takes out of w what the rows forbid.
static bool project(const Jacobian *jacobian, double *w)
{
    double square[KINEMATICS_ROW_MAX * KINEMATICS_ROW_MAX];
    double right[KINEMATICS_ROW_MAX];
    const size_t rows = jacobian->rows;
    const size_t columns = jacobian->columns;
    for (size_t i = 0; i < rows; i++) {
        const double *row = jacobian->entries + i * columns;
        right[i] = 0.0;
        for (size_t j = 0; j < columns; j++) {
            right[i] += row[j] * w[j];
        }
        for (size_t k = 0; k < rows; k++) {
            double sum = 0.0;
            for (size_t j = 0; j < columns; j++) {
                sum += row[j] * jacobian->entries[k * columns + j];
            }
            square[i * rows + k] = sum;
        }
    }
    if (!dense_solve(rows, square, right)) {
        return false;
    }
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            w[j] -= right[i] * jacobian->entries[i * columns + j];
        }
    }
    return true;
}

void perturb_start(Scenario *scenario, double relative, unsigned member)
{
    Linkage *linkage = &scenario->linkage;
    Motion motions[LINKAGE_BODY_MAX];
    bool include[LINKAGE_JOINT_MAX];
    double moving = 0.0;
    double turning = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i] = linkage->bodies[i].start;
        moving = fmax(moving, vec2_length(motions[i].velocity));
        turning = fmax(turning, fabs(motions[i].omega));
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        include[i] = linkage->joints[i].kind == JOINT_REVOLUTE;
    }
    Jacobian jacobian;
    kinematics_jacobian(linkage, motions, include, true, &jacobian);
    // the driven joint's rows and the driver's row hold the driven body altogether
    uint64_t seed = member;
    double w[KINEMATICS_COLUMN_MAX];
    for (size_t i = 0; i < linkage->body_count; i++) {
        w[3 * i] = relative * moving * draw(&seed);
        w[3 * i + 1] = relative * moving * draw(&seed);
        w[3 * i + 2] = relative * turning * draw(&seed);
    }
    if (!scenario_has_clearance(scenario) || !project(&jacobian, w)) {
        return;
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        Motion *start = &linkage->bodies[i].start;
        if ((int)i != linkage_driven_body(linkage)) {
            start->velocity = vec2_add(start->velocity, (Vec2){w[3 * i], w[3 * i + 1]});
            start->omega += w[3 * i + 2];
        }
    }
}
