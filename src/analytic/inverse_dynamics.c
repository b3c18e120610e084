// Finds the torque and the joint forces that make a linkage move as it does.
//
//     J^T lambda = M qddot - Q,      J the constraint Jacobian with the drives' rows
// lambda: of a pin the force on body b, of a prismatic joint the force on body b across the line
// and the couple (model/joint_rows.h), then the torque of each drive; M the masses and
// inertias, Q gravity, springs, dampers and loads. Source: Haug 1989, chapter 6 (Lagrange
// multipliers as reactions).
#include "analytic/inverse_dynamics.h"

#include "base/dense.h"
#include "model/forces.h"
#include "model/joint_rows.h"
#include "model/kinematics.h"
#include "model/loads.h"

// Takes the multipliers of a joint's rows for what acts on its body b.
static void set_reaction(const Linkage *linkage, const Motion *motions, int joint,
                         const double lambda[JOINT_ROWS], Reactions *reactions)
{
    const JointKind kind = linkage->joints[joint].kind;
    const bool is_guided = joint_rows_is_angle(kind, 1);
    const Vec2 across =
        is_guided ? vec2_perp(joint_rows_along(linkage, motions, joint)) : (Vec2){0.0, 0.0};
    reactions->force_on_b[joint] =
        is_guided ? vec2_scale(lambda[0], across) : (Vec2){lambda[0], lambda[1]};
    reactions->moment_on_b[joint] = is_guided ? lambda[1] : 0.0;
}

bool inverse_dynamics_solve(const Linkage *linkage, const Motion *motions, Vec2 gravity,
                            InverseTime time, Reactions *reactions, Err *err)
{
    if (!kinematics_is_small(linkage)) {
        return err_set(err, ERR_SOLVER,
                       "reactions of more than %d bodies or %d joints are not found",
                       KINEMATICS_BODY_MAX, KINEMATICS_JOINT_MAX);
    }
    bool include[KINEMATICS_JOINT_MAX];
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
    BodyLoad loads[KINEMATICS_BODY_MAX] = {0};
    forces_add_springs(linkage, motions, loads);
    forces_add_dampers(linkage, motions, loads);
    loads_add(linkage, motions, time.time_s, time.from_s, loads);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        right[3 * i] = body->mass * (motions[i].acceleration.x - gravity.x) - loads[i].force.x;
        right[3 * i + 1] = body->mass * (motions[i].acceleration.y - gravity.y) - loads[i].force.y;
        right[3 * i + 2] = body->inertia * motions[i].alpha - loads[i].moment;
    }
    if (!dense_solve(n, transposed, right)) {
        return err_set(err, ERR_SOLVER,
                       "the joint reactions are not determined: the mechanism is at a dead centre");
    }
    size_t row = 0;
    *reactions = (Reactions){.drive_torques = {0.0}};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const size_t count = joint_rows_count(linkage->joints[i].kind);
        if (count > 0) {
            set_reaction(linkage, motions, (int)i, &right[row], reactions);
        }
        row += count;
    }
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        reactions->drive_torques[i] = right[row + i];
    }
    return true;
}

double inverse_dynamics_power(const Linkage *linkage, const Motion *motions, Vec2 gravity,
                              InverseTime time)
{
    BodyLoad loads[KINEMATICS_BODY_MAX] = {0};
    double power = -loads_power(linkage, motions, time.time_s, time.from_s);
    forces_add_springs(linkage, motions, loads);
    forces_add_dampers(linkage, motions, loads);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        const Motion *motion = &motions[i];
        power += body->mass * vec2_dot(motion->velocity, motion->acceleration) +
                 body->inertia * motion->omega * motion->alpha -
                 vec2_dot(vec2_scale(body->mass, gravity), motion->velocity) -
                 forces_load_power(&loads[i], motion);
    }
    return power;
}
