// How does a planar mechanism with play accelerate, to thirty digits?
//
// Maximal coordinates q = (x, y, phi) of each body, ideal joints by Lagrange multipliers:
//     M q'' = Q + J^T lambda,   J q'' = gamma
// M is diagonal, so the multipliers follow from (J M^-1 J^T) lambda = gamma - J M^-1 Q. A joint's
// two rows are Phi = r_b + s_b - r_a - s_a, s the anchor's arm in the world; a body's part in them
// is +-[1 | perp s], perp (x, y) = (-y, x), and its part in gamma is +-omega^2 s.
// The driven body is no unknown: its motion enters gamma as that of a moving anchor.
// Contact: e = pin centre - hole centre, u = e / |e|, d = |e| - clearance, d' = u . e',
//     force on the pin  -F u - mu F tanh(v_t / v_s) perp u,  F = F_el(d) (1 + chi d'/v0) + c d'
// at the wall point, hole centre + hole radius u; v_t the relative speed of the two bodies'
// material there along perp u. d, m; F, N; c, N s/m; v0 closing speed at the onset, m/s.
// F_el: quad_law.h.
#include "quad_mechanism.h"

#include "quad_rows.h"

void quad_problem_drive(const QuadProblem *problem, Quad time, Quad *position, Quad *velocity)
{
    if (problem->driver_joint < 0) {
        return;
    }
    const int body = problem->driven_body;
    const QuadJoint *joint = &problem->joints[problem->driver_joint];
    position[3 * body + 2] = problem->drive_start + problem->drive_speed * time;
    const QuadVec arm = quad_arm(position, body, joint->anchor_b);
    position[3 * body] = joint->anchor_a.x - arm.x;
    position[3 * body + 1] = joint->anchor_a.y - arm.y;
    velocity[3 * body + 2] = problem->drive_speed;
    velocity[3 * body] = problem->drive_speed * arm.y;
    velocity[3 * body + 1] = -problem->drive_speed * arm.x;
}

QuadGap quad_problem_gap(const QuadProblem *problem, size_t joint_index, const Quad *position,
                         const Quad *velocity)
{
    const QuadJoint *joint = &problem->joints[joint_index];
    QuadGap gap;
    gap.hole_arm = quad_arm(position, joint->body_a, joint->anchor_a);
    gap.pin_arm = quad_arm(position, joint->body_b, joint->anchor_b);
    const QuadVec hole = quad_point(position, joint->body_a, gap.hole_arm);
    const QuadVec pin = quad_point(position, joint->body_b, gap.pin_arm);
    const QuadVec hole_velocity = quad_point_velocity(velocity, joint->body_a, gap.hole_arm);
    const QuadVec pin_velocity = quad_point_velocity(velocity, joint->body_b, gap.pin_arm);
    const QuadVec e = {pin.x - hole.x, pin.y - hole.y};
    const Quad size = sqrtq(quad_dot(e, e));
    gap.penetration = size - joint->clearance;
    gap.outward = size > 0 ? (QuadVec){e.x / size, e.y / size} : (QuadVec){0, 0};
    gap.rate = quad_dot(
        gap.outward, (QuadVec){pin_velocity.x - hole_velocity.x, pin_velocity.y - hole_velocity.y});
    return gap;
}

Quad quad_problem_margin(const QuadProblem *problem, const QuadContacts *contacts, size_t joint,
                         const QuadGap *gap)
{
    const QuadLaw *law = &problem->joints[joint].law;
    return law->viscous > 0 ? gap->rate + quad_law_force(law, gap->penetration) / law->viscous
                            : 1 + problem->hysteresis * gap->rate / contacts->speed[joint];
}

// What presses, N.
static Quad contact_force(const QuadProblem *problem, const QuadContacts *contacts, size_t joint,
                          const QuadGap *gap)
{
    const QuadLaw *law = &problem->joints[joint].law;
    return quad_law_force(law, gap->penetration) *
               (1 + problem->hysteresis * gap->rate / contacts->speed[joint]) +
           law->viscous * gap->rate;
}

static void add_contact(const QuadProblem *problem, const QuadContacts *contacts, size_t index,
                        const Quad *position, const Quad *velocity, Quad *acceleration)
{
    const QuadJoint *joint = &problem->joints[index];
    const QuadGap gap = quad_problem_gap(problem, index, position, velocity);
    const QuadVec u = gap.outward;
    const Quad force = contact_force(problem, contacts, index, &gap);
    quad_push(problem, joint->body_b, gap.pin_arm, (QuadVec){-force * u.x, -force * u.y},
              acceleration);
    quad_push(problem, joint->body_a, gap.hole_arm, (QuadVec){force * u.x, force * u.y},
              acceleration);
    if (problem->friction == 0) {
        return;
    }
    // the wall point, seen from either body
    const QuadVec wall = {joint->hole_radius * u.x, joint->hole_radius * u.y};
    const Quad short_of = joint->hole_radius - (joint->clearance + gap.penetration);
    const QuadVec arm_a = {gap.hole_arm.x + wall.x, gap.hole_arm.y + wall.y};
    const QuadVec arm_b = {gap.pin_arm.x + short_of * u.x, gap.pin_arm.y + short_of * u.y};
    const QuadVec velocity_a = quad_point_velocity(velocity, joint->body_a, arm_a);
    const QuadVec velocity_b = quad_point_velocity(velocity, joint->body_b, arm_b);
    const QuadVec tangent = {-u.y, u.x};
    const Quad slip =
        quad_dot(tangent, (QuadVec){velocity_b.x - velocity_a.x, velocity_b.y - velocity_a.y});
    const Quad drag = -problem->friction * force * tanhq(slip / problem->friction_speed);
    const QuadVec on_pin = {drag * tangent.x, drag * tangent.y};
    quad_push(problem, joint->body_b, arm_b, on_pin, acceleration);
    quad_push(problem, joint->body_a, arm_a, (QuadVec){-on_pin.x, -on_pin.y}, acceleration);
}

void quad_problem_accelerate(const QuadProblem *problem, const QuadContacts *contacts,
                             const Quad *position, const Quad *velocity, Quad *acceleration)
{
    // without the ideal joints
    for (size_t i = 0; i < problem->body_count; i++) {
        acceleration[3 * i] = 0;
        acceleration[3 * i + 1] = -problem->gravity;
        acceleration[3 * i + 2] = 0;
    }
    if (problem->driver_joint >= 0) {
        const int body = problem->driven_body;
        const QuadJoint *joint = &problem->joints[problem->driver_joint];
        const Quad square = problem->drive_speed * problem->drive_speed;
        acceleration[3 * body] = square * (joint->anchor_a.x - position[3 * body]);
        acceleration[3 * body + 1] = square * (joint->anchor_a.y - position[3 * body + 1]);
    }
    for (size_t i = 0; i < problem->joint_count; i++) {
        if (contacts->mode[i] == QUAD_PRESSED) {
            add_contact(problem, contacts, i, position, velocity, acceleration);
        }
    }
    // and with them
    const QuadRows rows = quad_rows_make(problem, position, false);
    Quad right[QUAD_ROW_MAX];
    for (size_t i = 0; i < rows.joint_count; i++) {
        const QuadJoint *joint = &problem->joints[rows.joints[i]];
        const QuadVec a =
            quad_point_acceleration(acceleration, velocity, joint->body_a, rows.arm[i][0]);
        const QuadVec b =
            quad_point_acceleration(acceleration, velocity, joint->body_b, rows.arm[i][1]);
        right[2 * i] = a.x - b.x;
        right[2 * i + 1] = a.y - b.y;
    }
    quad_rows_apply(problem, &rows, right, acceleration);
}

Quad quad_problem_project(const QuadProblem *problem, Quad *position, Quad *velocity)
{
    return quad_rows_project(problem, false, position, velocity);
}

Quad quad_problem_energy(const QuadProblem *problem, const QuadContacts *contacts,
                         const Quad *position, const Quad *velocity)
{
    Quad energy = 0;
    for (size_t i = 0; i < problem->body_count; i++) {
        if ((int)i != problem->driven_body) {
            const Quad *v = velocity + 3 * i;
            energy += problem->bodies[i].mass *
                      ((v[0] * v[0] + v[1] * v[1]) / 2 + problem->gravity * position[3 * i + 1]);
            energy += problem->bodies[i].inertia * v[2] * v[2] / 2;
        }
    }
    for (size_t i = 0; i < problem->joint_count; i++) {
        if (contacts->mode[i] != QUAD_FREE) {
            const Quad depth = quad_problem_gap(problem, i, position, velocity).penetration;
            energy += quad_law_energy(&problem->joints[i].law, depth);
        }
    }
    return energy;
}

static QuadJoint joint_from(const Scenario *scenario, const Joint *joint)
{
    QuadJoint made = {
        .has_play = joint->kind == JOINT_CLEARANCE,
        .body_a = joint->body_a,
        .body_b = joint->body_b,
        .anchor_a = {joint->anchor_a.x, joint->anchor_a.y},
        .anchor_b = {joint->anchor_b.x, joint->anchor_b.y},
    };
    if (made.has_play) {
        made.hole_radius = joint->clearance.hole_radius;
        made.clearance = (Quad)joint->clearance.hole_radius - (Quad)joint->clearance.pin_radius;
        made.law = quad_law(scenario, joint);
        made.start = (QuadVec){joint->clearance.start.x, joint->clearance.start.y};
    }
    return made;
}

QuadProblem quad_problem(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    const ContactOptions *contact = &scenario->contact;
    QuadProblem problem = {
        .body_count = linkage->body_count,
        .joint_count = linkage->joint_count,
        .driver_joint = linkage->driver.is_present ? linkage->driver.joint : -1,
        .driven_body = linkage_driven_body(linkage),
        .drive_speed = linkage->driver.speed,
        .drive_start = linkage->driver.start,
        .gravity = scenario->gravity,
        .hysteresis = quad_law_hysteresis(contact),
        .impact_speed_floor = contact->impact_speed_floor,
        .impact_speed_share = 1,
        .friction = contact->friction,
        .friction_speed = contact->friction_speed,
    };
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        problem.bodies[i] = (QuadBody){body->mass, body->inertia};
        problem.start_position[3 * i] = body->start.position.x;
        problem.start_position[3 * i + 1] = body->start.position.y;
        problem.start_position[3 * i + 2] = body->start.angle;
        problem.start_velocity[3 * i] = body->start.velocity.x;
        problem.start_velocity[3 * i + 1] = body->start.velocity.y;
        problem.start_velocity[3 * i + 2] = body->start.omega;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        problem.joints[i] = joint_from(scenario, &linkage->joints[i]);
    }
    if (problem.driver_joint >= 0) {
        quad_problem_drive(&problem, 0, problem.start_position, problem.start_velocity);
    }
    // the case's own speeds are the start: only what would open an ideal joint is taken from them
    Quad spare[QUAD_COORDINATE_MAX] = {0};
    quad_rows_project(&problem, problem.driver_joint >= 0, problem.start_position, spare);
    quad_rows_project(&problem, false, problem.start_position, problem.start_velocity);
    return problem;
}
