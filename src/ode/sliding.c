// How does a prismatic joint become two rows of ODE, and which force comes of them?
//
// ODE's slider joint has five rows. Three of them reach nothing that moves in the plane, and follow
// from one another where sliders come together in a loop with a driven body, which ODE cannot solve
// with CFM 0. Its distance joint and its angular motor have one row each:
//     distance   J v' + CFM F = (ERP / h) (target - distance),  J along the line between two points
//     motor      w_1' - w_2' + CFM M = target
// The distance is between the anchor on body b and a point of body a beside it, at the length L
// across the line: with g the first row of model/joint_rows.h and target L - g this is
//     g_rate' + CFM F = -(ERP / h) g.
// The motor's target is -(ERP / h) times the tilt. Force and couple are those of the rows: the
// force goes through the anchor on body b.
#include "ode/sliding.h"

#include "ode/snapshot.h"

// The number of ODE's first body: not the ground.
static int first_of(const Sliding *sliding)
{
    return sliding->ids[0] != NULL ? 0 : 1;
}

void sliding_make(const Linkage *linkage, int joint, dWorldID world, const dBodyID *bodies,
                  double erp, double cfm, Sliding *sliding)
{
    const Joint *data = &linkage->joints[joint];
    *sliding = (Sliding){
        .joint = joint,
        .anchors = {data->anchor_a, data->anchor_b},
        .direction = {cos(data->direction), sin(data->direction)},
        .held = {cos(data->held_angle), sin(data->held_angle)},
        .erp = erp,
    };
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(data, side).body;
        sliding->ids[side] = body == LINKAGE_GROUND ? NULL : bodies[body];
        sliding->reach = body == LINKAGE_GROUND
                             ? sliding->reach
                             : fmax(sliding->reach, linkage_reach(linkage, body));
    }
    const int first = first_of(sliding);
    sliding->across = dJointCreateDBall(world, 0);
    dJointAttach(sliding->across, sliding->ids[first], sliding->ids[1 - first]);
    dJointSetDBallParam(sliding->across, dParamERP, erp);
    dJointSetDBallParam(sliding->across, dParamCFM, cfm);
    dJointSetFeedback(sliding->across, &sliding->across_feedback);
    sliding->turn = dJointCreateAMotor(world, 0);
    dJointAttach(sliding->turn, sliding->ids[first], sliding->ids[1 - first]);
    dJointSetAMotorMode(sliding->turn, dAMotorUser);
    dJointSetAMotorNumAxes(sliding->turn, 1);
    dJointSetAMotorAxis(sliding->turn, 0, 0, 0.0, 0.0, 1.0);
    dJointSetAMotorParam(sliding->turn, dParamFMax, dInfinity);
    dJointSetAMotorParam(sliding->turn, dParamCFM, cfm);
    dJointSetFeedback(sliding->turn, &sliding->turn_feedback);
}

static void set_across(Sliding *sliding, const Vec2 *points, Vec2 normal)
{
    const double open = vec2_dot(normal, sliding->offset);
    const double length = sliding->reach + fabs(open); // so that the target is never negative
    const Vec2 beside = vec2_sub(points[1], vec2_scale(length, normal));
    const Vec2 ends[2] = {beside, points[1]};
    const int first = first_of(sliding);
    dJointSetDBallAnchor1(sliding->across, ends[first].x, ends[first].y, 0.0);
    dJointSetDBallAnchor2(sliding->across, ends[1 - first].x, ends[1 - first].y, 0.0);
    dJointSetDBallDistance(sliding->across, length - open);
}

static void set_turn(Sliding *sliding, const Snapshot *sides, double step_s)
{
    const Vec2 square = snapshot_turn(&sides[0], sliding->held);
    const double tilt =
        atan2(vec2_cross(square, sides[1].direction), vec2_dot(square, sides[1].direction));
    // of the first body against the second
    const double sign = first_of(sliding) == 1 ? 1.0 : -1.0;
    dJointSetAMotorParam(sliding->turn, dParamVel, -sign * sliding->erp / step_s * tilt);
}

void sliding_set(Sliding *sliding, double step_s)
{
    Snapshot sides[2];
    Vec2 points[2];
    for (int side = 0; side < 2; side++) {
        sides[side] = snapshot_of(sliding->ids[side]);
        points[side] =
            vec2_add(sides[side].position, snapshot_turn(&sides[side], sliding->anchors[side]));
    }
    sliding->offset = vec2_sub(points[1], points[0]);
    set_across(sliding, points, vec2_perp(snapshot_turn(&sides[0], sliding->direction)));
    set_turn(sliding, sides, step_s);
}

void sliding_force(const Sliding *sliding, JointState *state)
{
    // ODE gives what acts on the first body
    const double sign = first_of(sliding) == 1 ? 1.0 : -1.0;
    const dReal *force = sliding->across_feedback.f1;
    state->force_on_b = (Vec2){sign * force[0], sign * force[1]};
    state->force = vec2_length(state->force_on_b);
    state->moment_on_b = sign * sliding->turn_feedback.t1[2];
}
