// How does a planar mechanism with play accelerate, to thirty digits?
//
// Maximal coordinates q = (x, y, phi) of each body, ideal joints by Lagrange multipliers:
//     M q'' = Q + J^T lambda,   J q'' = gamma
// M is diagonal, so the multipliers follow from (J M^-1 J^T) lambda = gamma - J M^-1 Q
// (quad_rows.c). The driven body is no unknown: its motion enters gamma as that of a moving anchor.
// Contact: e = centre of the circle on body b less that on body a or a point of its line,
//     hole   d = |e| - c,   u = e / |e|       disc   d = c - |e|,   u = -e / |e|
//     line   d = c - m e,   u = -m,  m the line's normal, which turns with body a
//     d' the rate of d; force on body b  -F u - mu F tanh(v_t / v_s) perp u,
//     F = F_el(d) (1 + chi d'/v0) + c d'
// where they touch: of a hole the wall's point, of discs that of body a's, of a line the nearest
// point of body b's circle; v_t the relative speed of the two bodies' material there along perp u.
// d, m; F, N; c, N s/m; v0 closing speed at the onset, m/s. F_el: quad_law.h.
#include "quad_mechanism.h"

#include "model/kinematics.h"
#include "quad_rows.h"

#include <assert.h>

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

// From a point of the world to the centre of mass that it turns about.
static QuadVec seen_from(const Quad *position, int body, QuadVec point)
{
    return body == LINKAGE_GROUND
               ? point
               : (QuadVec){point.x - position[3 * body], point.y - position[3 * body + 1]};
}

static QuadVec beside(QuadVec point, Quad distance, QuadVec along)
{
    return (QuadVec){point.x + distance * along.x, point.y + distance * along.y};
}

QuadGap quad_problem_gap(const QuadProblem *problem, size_t joint_index, const Quad *position,
                         const Quad *velocity)
{
    const QuadJoint *joint = &problem->joints[joint_index];
    const QuadVec arm_a = quad_arm(position, joint->body_a, joint->anchor_a);
    const QuadVec arm_b = quad_arm(position, joint->body_b, joint->anchor_b);
    const QuadVec a = quad_point(position, joint->body_a, arm_a);
    const QuadVec b = quad_point(position, joint->body_b, arm_b);
    const QuadVec moving = quad_difference(quad_point_velocity(velocity, joint->body_b, arm_b),
                                           quad_point_velocity(velocity, joint->body_a, arm_a));
    const QuadVec e = quad_difference(b, a);
    const Quad size = sqrtq(quad_dot(e, e));
    const Quad outside = joint->shape == QUAD_HOLE ? 1 : -1;
    QuadGap gap;
    QuadVec touching;
    if (joint->shape == QUAD_LINE) {
        const QuadVec m = quad_along(position, joint->body_a, joint->direction);
        gap.outward = (QuadVec){-m.x, -m.y};
        gap.penetration = joint->clearance - quad_dot(m, e);
        gap.rate = -quad_dot(m, moving) -
                   quad_omega(velocity, joint->body_a) * quad_dot((QuadVec){-m.y, m.x}, e);
        touching = beside(b, joint->radius_b, gap.outward);
    } else {
        const Quad over = size > 0 ? outside / size : 0;
        gap.outward = (QuadVec){over * e.x, over * e.y};
        gap.penetration = outside * (size - joint->clearance);
        gap.rate = quad_dot(gap.outward, moving);
        touching = beside(a, outside * joint->radius_a, gap.outward);
    }
    gap.arm_a = seen_from(position, joint->body_a, touching);
    gap.arm_b = seen_from(position, joint->body_b, touching);
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
    quad_push(problem, joint->body_b, gap.arm_b, (QuadVec){-force * u.x, -force * u.y},
              acceleration);
    quad_push(problem, joint->body_a, gap.arm_a, (QuadVec){force * u.x, force * u.y}, acceleration);
    if (problem->friction == 0) {
        return;
    }
    const QuadVec velocity_a = quad_point_velocity(velocity, joint->body_a, gap.arm_a);
    const QuadVec velocity_b = quad_point_velocity(velocity, joint->body_b, gap.arm_b);
    const QuadVec tangent = {-u.y, u.x};
    const Quad slip = quad_dot(tangent, quad_difference(velocity_b, velocity_a));
    const Quad drag = -problem->friction * force * tanhq(slip / problem->friction_speed);
    const QuadVec on_b = {drag * tangent.x, drag * tangent.y};
    quad_push(problem, joint->body_b, gap.arm_b, on_b, acceleration);
    quad_push(problem, joint->body_a, gap.arm_a, (QuadVec){-on_b.x, -on_b.y}, acceleration);
}

void quad_problem_accelerate(const QuadProblem *problem, const QuadContacts *contacts,
                             const Quad *position, const Quad *velocity, Quad *acceleration)
{
    // without the ideal joints
    for (size_t i = 0; i < problem->body_count; i++) {
        acceleration[3 * i] = problem->gravity.x;
        acceleration[3 * i + 1] = problem->gravity.y;
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
    Quad bias[QUAD_ROW_MAX];
    quad_rows_of(problem, &rows, acceleration, right);
    quad_rows_bias(problem, &rows, position, velocity, bias);
    for (size_t i = 0; i < 2 * rows.joint_count; i++) {
        right[i] = -right[i] - bias[i];
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
                      ((v[0] * v[0] + v[1] * v[1]) / 2 - problem->gravity.x * position[3 * i] -
                       problem->gravity.y * position[3 * i + 1]);
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
        .held = QUAD_HELD_ALWAYS,
        .is_sliding = joint->kind == JOINT_PRISMATIC || joint->kind == JOINT_GUIDE,
        .body_a = joint->body_a,
        .body_b = joint->body_b,
        .anchor_a = {joint->anchor_a.x, joint->anchor_a.y},
        .anchor_b = {joint->anchor_b.x, joint->anchor_b.y},
        .direction = joint->direction,
        .held_angle = joint->held_angle,
    };
    if (joint->kind == JOINT_CLEARANCE) {
        made.held = QUAD_HELD_AT_START;
        made.has_play = true;
        made.radius_a = joint->clearance.hole_radius;
        made.radius_b = joint->clearance.pin_radius;
        made.clearance = made.radius_a - made.radius_b;
        made.law = quad_law(scenario, joint);
        made.start = (QuadVec){joint->clearance.start.x, joint->clearance.start.y};
    } else if (joint->kind == JOINT_GUIDE) {
        made.held = QUAD_HELD_AT_START;
        made.start = (QuadVec){joint->guide.start.x, joint->guide.start.y};
    } else if (joint->kind == JOINT_STOP) {
        made.held = QUAD_HELD_NEVER;
        made.has_play = true;
        made.shape = joint->stop.is_disc ? QUAD_DISC : QUAD_LINE;
        made.radius_a = joint->stop.is_disc ? joint->stop.radius_a : 0;
        made.radius_b = joint->stop.radius_b;
        made.clearance = made.radius_a + made.radius_b;
        made.law = quad_law(scenario, joint);
    }
    return made;
}

// The corners of a block between its guides, or of a sleeve at its rod.
static void add_corners(const Scenario *scenario, const Joint *joint, QuadProblem *problem)
{
    const Guide *guide = &joint->guide;
    const Quad across = (Quad)joint->direction + acosq(0);
    const Quad own = (Quad)joint->direction - joint->held_angle;
    const bool is_sleeve = guide->height > guide->opening;
    for (int i = 0; i < 4; i++) {
        const Quad side = i < 2 ? 0.5 : -0.5;
        const Quad end = i % 2 == 0 ? 0.5 : -0.5;
        const Quad height = side * guide->height;
        const Quad length = end * guide->length;
        assert(problem->joint_count < KINEMATICS_JOINT_MAX);
        problem->joints[problem->joint_count++] = (QuadJoint){
            .held = QUAD_HELD_NEVER,
            .has_play = true,
            .shape = QUAD_LINE,
            .body_a = joint->body_a,
            .body_b = joint->body_b,
            .anchor_a = {joint->anchor_a.x + side * guide->opening * cosq(across),
                         joint->anchor_a.y + side * guide->opening * sinq(across)},
            .anchor_b = {joint->anchor_b.x + length * cosq(own) - height * sinq(own),
                         joint->anchor_b.y + length * sinq(own) + height * cosq(own)},
            // a block is pushed towards the middle line, a sleeve away from it
            .direction = (side > 0) == is_sleeve ? across : across + acosq(-1),
            .law = quad_law(scenario, joint),
        };
    }
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
        .gravity = {scenario->gravity.x, scenario->gravity.y},
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
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_GUIDE) {
            add_corners(scenario, &linkage->joints[i], &problem);
        }
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
