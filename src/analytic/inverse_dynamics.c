// Which torque and which joint forces make a linkage move as it does?
//
//     J^T lambda = M qddot - Q,      J the constraint Jacobian with the driver's row
// lambda: the force on body b of each joint, then the torque on the driven body; M the masses and
// inertias, Q gravity. Source: Haug 1989, chapter 6 (Lagrange multipliers as reactions).
#include "analytic/inverse_dynamics.h"

#include "base/dense.h"
#include "model/kinematics.h"

bool inverse_dynamics_solve(const Linkage *linkage, const Motion *motions, double gravity,
                            Reactions *reactions, Err *err)
{
    bool include[LINKAGE_JOINT_MAX];
    for (size_t i = 0; i < linkage->joint_count; i++) {
        include[i] = true;
    }
    Jacobian jacobian;
    kinematics_jacobian(linkage, motions, include, true, &jacobian);
    const size_t n = jacobian.columns;
    if (jacobian.rows != n) {
        return err_set(err, ERR_SOLVER, "%zu reactions for %zu equations of motion", jacobian.rows,
                       n);
    }
    double transposed[KINEMATICS_COLUMN_MAX * KINEMATICS_COLUMN_MAX];
    double right[KINEMATICS_COLUMN_MAX];
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            transposed[j * n + i] = jacobian.entries[i * n + j];
        }
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        right[3 * i] = body->mass * motions[i].acceleration.x;
        right[3 * i + 1] = body->mass * (motions[i].acceleration.y + gravity);
        right[3 * i + 2] = body->inertia * motions[i].alpha;
    }
    if (!dense_solve(n, transposed, right)) {
        return err_set(err, ERR_SOLVER,
                       "the joint reactions are not determined: the mechanism is at a dead centre");
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        reactions->force_on_b[i] = (Vec2){right[2 * i], right[2 * i + 1]};
    }
    reactions->drive_torque = right[2 * linkage->joint_count];
    return true;
}

double inverse_dynamics_power(const Linkage *linkage, const Motion *motions, double gravity)
{
    double power = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        const Motion *motion = &motions[i];
        power += body->mass * vec2_dot(motion->velocity, motion->acceleration) +
                 body->inertia * motion->omega * motion->alpha +
                 body->mass * gravity * motion->velocity.y;
    }
    return power;
}
