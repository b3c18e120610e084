// Which forces in the ideal joints make the bodies move as they do?
//
// Newton and Euler of all bodies that are not driven, J the rows of the ideal joints:
//     M (a - g) - f = J' lambda,   so that   D lambda = J (a - g - M^-1 f),   D = J M^-1 J'
// f: springs, dampers, torque. a holds the angular accelerations too. J a is the bodies' part alone
// and without centripetal terms: this is a balance of forces, and says nothing of whether the
// joints stay closed. lambda is the force on body b of each revolute joint; of a prismatic joint
// the force across its line and the couple.
#include "ode/ideal_forces.h"

#include "model/joint_rows.h"

// One row of J (a - g - M^-1 f).
static double row_acceleration(const ResponseRow *row, const Linkage *linkage,
                               const Motion *motions, double gravity, const BodyLoad *loads)
{
    double sum = 0.0;
    for (int end = 0; end < 2; end++) {
        if (row->body[end] != LINKAGE_GROUND) {
            const Motion *motion = &motions[row->body[end]];
            const Body *body = &linkage->bodies[row->body[end]];
            const BodyLoad *load = &loads[row->body[end]];
            sum += row->x[end] * (motion->acceleration.x - load->force.x / body->mass) +
                   row->y[end] * (motion->acceleration.y + gravity - load->force.y / body->mass) +
                   row->turn[end] * (motion->alpha - load->moment / body->inertia);
        }
    }
    return sum;
}

static void set_force(const Linkage *linkage, const Motion *motions, int number,
                      const double *lambda, JointState *joint)
{
    joint->force_on_b = (Vec2){lambda[0], lambda[1]};
    joint->moment_on_b = 0.0;
    if (linkage->joints[number].kind == JOINT_PRISMATIC) {
        const Vec2 across = vec2_perp(joint_rows_along(linkage, motions, number));
        joint->force_on_b = vec2_scale(lambda[0], across);
        joint->moment_on_b = lambda[1];
    }
    joint->force = vec2_length(joint->force_on_b);
}

bool ideal_forces_solve(const Scenario *scenario, const Motion *motions, const BodyLoad *loads,
                        Response *response, double *lambda, JointState *joints)
{
    if (!response_place(response, motions)) {
        return false;
    }
    const size_t count = response->ideal_rows;
    for (size_t i = 0; i < count; i++) {
        lambda[i] = row_acceleration(&response->rows[i], &scenario->linkage, motions,
                                     scenario->gravity, loads);
    }
    response_solve(response, lambda);
    for (size_t i = 0; i < count; i += JOINT_ROWS) {
        const int number = response->joint_of[i];
        set_force(&scenario->linkage, motions, number, lambda + i, &joints[number]);
    }
    return true;
}
