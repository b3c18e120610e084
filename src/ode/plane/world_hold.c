// Finds the forces that keep the ideal joints of a world closed, in time proportional to the
// joints.
//
// What ODE's direct solver finds for the same rows, with CFM 0. J the rows, phi what they are open,
// v and f the bodies' speeds and what acts on them before the step:
//     J v' = -(ERP / h) phi,   v' = v + h M^-1 (f + J' lambda)
//     D lambda h = -(J (v + h M^-1 f) + (ERP / h) phi),   D = J M^-1 J'
// ODE factors D as a dense matrix, island by island, so that a chain of n joints takes n^3; here it
// is sparse (model/response.h). The forces are then put on bodies that have no joints in ODE.
#include "ode/plane/world_hold.h"

#include "base/zeroed.h"
#include "model/forces.h"
#include "model/joint_friction.h"
#include "model/joint_rows.h"
#include "model/response.h"

struct WorldHold {
    const Linkage *linkage;
    Response response;
    Vec2 gravity; // m/s^2
    double erp;
    double step_s;    // of the last step
    Motion *motions;  // before it, by body
    Motion *loose;    // with the speeds behind it if nothing held the joints
    double *openings; // by ideal row
    double *impulses; // N s, likewise
    double *loads;    // of the impulses, three a body
};

double world_hold_erp(const OdeOptions *options)
{
    // staggered worlds carry a joint's error of a step off in the next one: a linearised SHAKE
    return options->stepping == ODE_PLAIN ? options->erp : 1.0;
}

bool world_hold_is_alone(const Scenario *scenario)
{
    const bool has_contacts =
        scenario_has_clearance(scenario) && !scenario_integrates_contacts(scenario);
    return scenario->ode.solver == ODE_DIRECT && scenario->ode.cfm == 0.0 && !has_contacts &&
           !forces_damp(&scenario->linkage) && joint_friction_first(&scenario->linkage) < 0;
}

WorldHold *world_hold_make(const Scenario *scenario, size_t most_rows)
{
    const Linkage *linkage = &scenario->linkage;
    if (!world_hold_is_alone(scenario)) {
        return NULL;
    }
    WorldHold *hold = zeroed(1, sizeof *hold);
    response_init_places(linkage, NULL, 0, &hold->response);
    hold->linkage = linkage;
    hold->gravity = scenario_gravity(scenario);
    hold->erp = world_hold_erp(&scenario->ode);
    hold->motions = zeroed(linkage->body_count, sizeof *hold->motions);
    hold->loose = zeroed(linkage->body_count, sizeof *hold->loose);
    hold->openings = zeroed(hold->response.ideal_rows, sizeof *hold->openings);
    hold->impulses = zeroed(hold->response.ideal_rows, sizeof *hold->impulses);
    hold->loads = zeroed(3 * linkage->body_count, sizeof *hold->loads);
    if (hold->response.largest_group <= most_rows) {
        world_hold_free(hold);
        return NULL;
    }
    return hold;
}

void world_hold_free(WorldHold *hold)
{
    if (hold != NULL) {
        response_finish(&hold->response);
        free(hold->motions);
        free(hold->loose);
        free(hold->openings);
        free(hold->impulses);
        free(hold->loads);
        free(hold);
    }
}

Motion *world_hold_motions(WorldHold *hold)
{
    return hold->motions;
}

// The speeds behind the step if nothing held the joints.
static void loosen(WorldHold *hold, const dBodyID *bodies, double step_s)
{
    for (size_t i = 0; i < hold->linkage->body_count; i++) {
        const Body *body = &hold->linkage->bodies[i];
        Motion *motion = &hold->loose[i];
        *motion = hold->motions[i];
        if (linkage_is_driven(hold->linkage, (int)i)) {
            continue;
        }
        const dReal *force = dBodyGetForce(bodies[i]);
        const dReal *torque = dBodyGetTorque(bodies[i]);
        motion->velocity.x += step_s * force[0] / body->mass + step_s * hold->gravity.x;
        motion->velocity.y += step_s * (force[1] / body->mass + hold->gravity.y);
        motion->omega += step_s * torque[2] / body->inertia;
    }
}

bool world_hold_push(WorldHold *hold, const dBodyID *bodies, double step_s, Err *err)
{
    Response *response = &hold->response;
    if (!response_place(response, hold->motions)) {
        return err_set(err, ERR_SOLVER,
                       "the ideal joints are redundant here: give one joint of the loop some play");
    }
    loosen(hold, bodies, step_s);
    response_openings(response, hold->loose, hold->openings, hold->impulses);
    for (size_t row = 0; row < response->ideal_rows; row++) {
        const bool is_tilt =
            row % 2 == 1 && joint_slides(hold->linkage->joints[response->joint_of[row]].kind);
        // ODE's angles are known in one turn
        const double opening =
            is_tilt ? remainder(hold->openings[row], 2.0 * M_PI) : hold->openings[row];
        hold->impulses[row] = -(hold->impulses[row] + hold->erp / step_s * opening);
    }
    response_solve(response, hold->impulses);
    response_hold(response, hold->impulses, hold->loads);
    hold->step_s = step_s;
    for (size_t i = 0; i < hold->linkage->body_count; i++) {
        if (!linkage_is_driven(hold->linkage, (int)i)) {
            const double *load = hold->loads + 3 * i;
            dBodyAddForce(bodies[i], load[0] / step_s, load[1] / step_s, 0.0);
            dBodyAddTorque(bodies[i], 0.0, 0.0, load[2] / step_s);
        }
    }
    return true;
}

void world_hold_forces(const WorldHold *hold, JointState *joints)
{
    const Response *response = &hold->response;
    for (size_t row = 0; row < response->ideal_rows; row += JOINT_ROWS) {
        const int number = response->joint_of[row];
        JointState *joint = &joints[number];
        const double forces[2] = {hold->impulses[row] / hold->step_s,
                                  hold->impulses[row + 1] / hold->step_s};
        joint->force_on_b = (Vec2){forces[0], forces[1]};
        if (joint_slides(hold->linkage->joints[number].kind)) {
            const Vec2 across = vec2_perp(joint_rows_along(hold->linkage, hold->motions, number));
            joint->force_on_b = vec2_scale(forces[0], across);
            joint->moment_on_b = forces[1];
        }
        joint->force = vec2_length(joint->force_on_b);
    }
}

void world_hold_offsets(const WorldHold *hold, int body, Vec2 *offsets)
{
    for (int i = 0; i < (int)hold->linkage->joint_count; i++) {
        const Joint *joint = &hold->linkage->joints[i];
        if (joint_has_position(joint->kind) && joint->body_a == body) {
            offsets[i] = linkage_joint_gap(hold->linkage, hold->motions, i).position;
        }
    }
}
