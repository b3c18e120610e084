// Builds a planar linkage in a three-dimensional engine with as few rows as it needs, steps it and
// reads it.
//
// Every centre of mass, anchor and force lies in the plane z = 0 and every axis along z. Then
// nothing in the equations reaches z, omega_x or omega_y: they stay zero to the last bit, and no
// row has to hold them. An ideal joint is a ball (3 rows, its z row idle), a driven body is
// kinematic (no rows), a prismatic joint has two rows (see Sliding below), and a joint with play is
// nothing but a contact row while it touches.
// Four hinges in a loop would be 20 rows on 18 freedoms, which ODE cannot solve with CFM 0.
#include "ode/plane/world.h"

#include "base/sparse_rank.h"
#include "base/zeroed.h"
#include "kernel/pin_hole.h"
#include "model/joint_nodes.h"
#include "model/joint_rows.h"
#include "model/scenario.h"
#include "ode/engine.h"
#include "ode/stepping.h"
#include "world/pressing_row.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static_assert(ODE_SOLVER_COUNT == 2, "a step is quick or direct, as whoever calls world_step and "
                                     "engine_step says by ODE_QUICK");

// Follows limited angles and teeth through whole turns.
//
// ODE knows angles in one turn; turns are counted from step to step. The row by which an end of an
// angle presses is world/pressing_row.c's, with body b of the joint first: then its rate is that of
// the coordinate (model/coordinate.h). Teeth and the ends of a slider are contacts
// (ode/plane/contact_rows.c).

// What the world knows of its bodies with limited angles, or teeth.
struct WorldEnds {
    const Linkage *linkage;
    const dBodyID *bodies; // of the world
    Motion *motions;       // of those bodies when last looked at; angles not wrapped; owned
    bool *is_followed;     // by body; owned
};

static bool has_angles(const Joint *joint)
{
    return joint->limits.kind != LIMIT_NONE && !joint_has_position(joint->kind);
}

static void follow(WorldEnds *ends, int body, const Motion *motions)
{
    if (body != LINKAGE_GROUND) {
        ends->is_followed[body] = true;
        ends->motions[body] = motions[body];
    }
}

static void ends_free(WorldEnds *ends)
{
    if (ends != NULL) {
        free(ends->motions);
        free(ends->is_followed);
        free(ends);
    }
}

// Makes the ends of a world whose bodies stand in the motions given; NULL where no joint limits an
// angle and there are no teeth. For ends_free.
static WorldEnds *ends_make(const Linkage *linkage, const dBodyID *bodies, const Motion *motions)
{
    WorldEnds *ends = zeroed(1, sizeof *ends);
    bool is_any = false;
    ends->linkage = linkage;
    ends->bodies = bodies;
    ends->motions = zeroed(linkage->body_count, sizeof *ends->motions);
    ends->is_followed = zeroed(linkage->body_count, sizeof *ends->is_followed);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (has_angles(joint)) {
            is_any = true;
            follow(ends, joint->body_a, motions);
            follow(ends, joint->body_b, motions);
        }
    }
    if (!is_any) {
        ends_free(ends);
        return NULL;
    }
    return ends;
}

// An angle of a body that is known in one turn, with the turns it has made; without ends, or of
// other bodies, the angle as it is.
static double count_turns(const WorldEnds *ends, size_t body, double angle)
{
    if (ends == NULL || !ends->is_followed[body]) {
        return angle;
    }
    const double last = ends->motions[body].angle;
    return last + remainder(angle - last, 2.0 * M_PI);
}

static void look_at(WorldEnds *ends, int body)
{
    if (body == LINKAGE_GROUND) {
        return;
    }
    const Snapshot now = snapshot_of(ends->bodies[body]);
    ends->motions[body] = (Motion){
        .position = now.position,
        .angle = count_turns(ends, (size_t)body, atan2(now.direction.y, now.direction.x)),
        .velocity = now.velocity,
        .omega = now.omega,
    };
}

// How the bodies of a joint move now; other bodies' motions are not up to date.
static const Motion *ends_look(WorldEnds *ends, int joint)
{
    const Joint *of = &ends->linkage->joints[joint];
    look_at(ends, of->body_a);
    look_at(ends, of->body_b);
    return ends->motions;
}

// The contact points of joints with play and of the ends of limited coordinates.

static void attach_geom(dGeomID geom, dBodyID body, Vec2 anchor)
{
    if (body == NULL) {
        dGeomSetPosition(geom, anchor.x, anchor.y, 0.0);
        return;
    }
    dGeomSetBody(geom, body);
    dGeomSetOffsetPosition(geom, anchor.x, anchor.y, 0.0);
}

static bool make_geoms(const Scenario *scenario, const Collider *collider, WorldPair *pair,
                       Err *err)
{
    const Joint *joint = &scenario->linkage.joints[pair->joint];
    const Clearance *clearance = &joint->clearance;
    pair->hole = hole_geom_create(clearance->hole_radius);
    pair->pin = dCreateCylinder(0, clearance->pin_radius, hole_geom_width(clearance));
    attach_geom(pair->hole, pair->bodies[0], joint->anchor_a);
    attach_geom(pair->pin, pair->bodies[1], joint->anchor_b);
    Err own = {0};
    if (collider->check != NULL && !collider->check(scenario, pair->joint, &own)) {
        return err_set(err, ERR_SOLVER, "%s; use collider pin-hole or staves", own.text);
    }
    pair->collision = collider->open(scenario, pair->joint);
    return true;
}

static void place_line_of(const Joint *joint, WorldPair *pair)
{
    const Touch *touch = &pair->touch;
    pair->line = (Vec2){cos(touch->direction), sin(touch->direction)};
    pair->facing = (Vec2){cos(touch->cam.facing), sin(touch->cam.facing)};
    pair->beside[0] = vec2_sub(touch->anchor_a, joint->anchor_a);
    pair->beside[1] = vec2_sub(touch->anchor_b, joint->anchor_b);
}

// Makes the place between two bodies. Fails with ERR_SOLVER where the collider cannot see such
// contacts; the pair is to be finished then too.
static bool pair_make(const Scenario *scenario, const Touch *touch, const dBodyID bodies[2],
                      const Collider *collider, WorldPair *pair, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[touch->joint];
    *pair = (WorldPair){
        .joint = touch->joint,
        .touch = *touch,
        .bodies = {bodies[0], bodies[1]},
    };
    if (touch->shape == TOUCH_HOLE) {
        // of two circles the bodies say all
        return scenario->ode.collider == ODE_COLLIDER_PIN_HOLE ||
               make_geoms(scenario, collider, pair, err);
    }
    if (scenario->ode.collider != ODE_COLLIDER_PIN_HOLE) {
        return err_set(err, ERR_SOLVER,
                       "collider %s is for pins in their holes only, and joint '%s' is %s; use "
                       "collider pin-hole",
                       OPTIONS_ODE_COLLIDERS[scenario->ode.collider], joint->name,
                       joint_words(joint->kind));
    }
    place_line_of(joint, pair);
    pair->is_corner = joint_has_guides(joint->kind);
    return true;
}

// Makes the place at an end of a limited coordinate.
static void pair_make_end(const Scenario *scenario, const Touch *touch, const dBodyID bodies[2],
                          dWorldID world, WorldEnds *ends, WorldPair *pair)
{
    *pair = (WorldPair){
        .joint = touch->joint,
        .touch = *touch,
        .bodies = {bodies[0], bodies[1]},
        .is_corner = true,
        .is_end = true,
        .ends = touch->shape == TOUCH_LINE ? NULL : ends,
    };
    place_line_of(&scenario->linkage.joints[touch->joint], pair);
    if (touch_is_torque(touch)) {
        pair->row = pressing_row_of_angle(world, (dBodyID[]){bodies[1], bodies[0]}, NULL);
        pressing_row_set_axis(pair->row, 0.0, 0.0, touch->sign);
    }
}

static void pair_finish(const Collider *collider, WorldPair *pair)
{
    if (pair->hole != NULL) {
        collider->close(pair->collision);
        dGeomDestroy(pair->hole);
        dGeomDestroy(pair->pin);
    }
}

// The velocity of a body's point, m/s; zero of the ground.
static Vec2 velocity_at(const Snapshot *body, Vec2 point)
{
    const Vec2 arm = vec2_sub(point, body->position);
    return (Vec2){body->velocity.x - body->omega * arm.y, body->velocity.y + body->omega * arm.x};
}

Vec2 pair_velocity(const WorldPair *pair, Vec2 point)
{
    const Snapshot a = snapshot_of(pair->bodies[0]);
    const Snapshot b = snapshot_of(pair->bodies[1]);
    return vec2_sub(velocity_at(&b, point), velocity_at(&a, point));
}

// Where a point given in a body's frame is.
static Vec2 point_of(const Snapshot *body, Vec2 local)
{
    return vec2_add(body->position, snapshot_turn(body, local));
}

static TouchPose hole_pose(const WorldPair *pair)
{
    const Snapshot a = snapshot_of(pair->bodies[0]);
    const Snapshot b = snapshot_of(pair->bodies[1]);
    const Vec2 hole = point_of(&a, pair->touch.anchor_a);
    const Vec2 pin = point_of(&b, pair->touch.anchor_b);
    const Vec2 velocity = vec2_sub(velocity_at(&b, pin), velocity_at(&a, hole));
    const PinHole pose = pin_hole_pose(hole, pin, velocity, pair->touch.clearance);
    return touch_pose_in_hole(&pose, velocity);
}

TouchPose pair_pose(const WorldPair *pair)
{
    if (pair->touch.shape == TOUCH_HOLE) {
        return hole_pose(pair);
    }
    if (pair->ends != NULL) {
        return touch_pose(pair->ends->linkage, &pair->touch, ends_look(pair->ends, pair->joint));
    }
    const Snapshot a = snapshot_of(pair->bodies[0]);
    const Snapshot b = snapshot_of(pair->bodies[1]);
    const Vec2 arm_a = snapshot_turn(&a, pair->touch.anchor_a);
    const Vec2 arm_b = snapshot_turn(&b, pair->touch.anchor_b);
    const Vec2 offset = vec2_sub(vec2_add(b.position, arm_b), vec2_add(a.position, arm_a));
    const Vec2 velocity = vec2_sub(snapshot_velocity(&b, arm_b), snapshot_velocity(&a, arm_a));
    const Vec2 line = snapshot_turn(&a, pair->line);
    return pair->touch.shape == TOUCH_CAM
               ? touch_pose_on_cam(&pair->touch, line, snapshot_turn(&b, pair->facing), offset,
                                   velocity, (const double[]){a.omega, b.omega})
               : touch_pose_of(&pair->touch, offset, velocity, line, a.omega);
}

// Where an anchor is.
static Vec2 anchor_of(const WorldPair *pair, int side)
{
    const Snapshot body = snapshot_of(pair->bodies[side]);
    return point_of(&body, side == 0 ? pair->touch.anchor_a : pair->touch.anchor_b);
}

Vec2 pair_centre(const WorldPair *pair)
{
    return anchor_of(pair, 0);
}

Vec2 pair_anchor_b(const WorldPair *pair)
{
    return anchor_of(pair, 1);
}

Vec2 pair_in_rows(const WorldPair *pair, Vec2 normal)
{
    switch (touch_rows(&pair->touch)) {
    case TOUCH_ROWS_AXES: {
        const Snapshot a = snapshot_of(pair->bodies[0]);
        const Vec2 across = snapshot_turn(&a, pair->line);
        return (Vec2){vec2_dot(across, normal), vec2_cross(across, normal)};
    }
    case TOUCH_ROWS_WORLD:
        return normal;
    case TOUCH_ROWS_LINE:
    case TOUCH_ROWS_COORDINATE:
        break;
    }
    return (Vec2){1.0, 0.0};
}

Vec2 pair_point(const WorldPair *pair, Vec2 normal)
{
    const Touch *touch = &pair->touch;
    switch (touch->shape) {
    case TOUCH_HOLE:
        return vec2_sub(pair_centre(pair), vec2_scale(touch->radius_a, normal));
    case TOUCH_DISC:
        return vec2_add(anchor_of(pair, 0), vec2_scale(touch->radius_a, normal));
    case TOUCH_RACK:
        return vec2_sub(anchor_of(pair, 1),
                        vec2_scale(touch->radius_b * touch->sign, vec2_perp(normal)));
    case TOUCH_TEETH:
    case TOUCH_CAM:
        return vec2_add(anchor_of(pair, 1), pair_pose(pair).from_b);
    case TOUCH_SLOT:
        return vec2_add(anchor_of(pair, 0),
                        vec2_sub(pair_pose(pair).middle, vec2_scale(touch->radius_a, normal)));
    case TOUCH_LINE:
    case TOUCH_TURN:
        break;
    }
    return vec2_sub(anchor_of(pair, 1), vec2_scale(touch->radius_b, normal));
}

void pair_arms(const WorldPair *pair, const TouchPose *pose, Vec2 arms[2], Vec2 *lever)
{
    touch_points(&pair->touch, pose, &arms[0], &arms[1]);
    *lever = (Vec2){0.0, 0.0};
    if (pair->is_corner) {
        const Snapshot a = snapshot_of(pair->bodies[0]);
        const Snapshot b = snapshot_of(pair->bodies[1]);
        const Vec2 to_corner = snapshot_turn(&b, pair->beside[1]);
        *lever = vec2_add(to_corner, arms[1]);
        arms[0] = vec2_add(vec2_sub(pose->offset, to_corner), snapshot_turn(&a, pair->beside[0]));
        arms[1] = (Vec2){0.0, 0.0};
    }
}

struct Sliding {
    int joint;      // number in the linkage
    dBodyID ids[2]; // of bodies a and b; NULL: the ground
    Vec2 anchors[2];
    Vec2 direction;  // unit, of the line on body a
    Vec2 held;       // unit: where body b's x axis points in body a's frame
    double reach;    // m, least length at which the row across the line is written
    double erp;      // 1
    dJointID across; // the row across the line
    dJointID turn;   // the row that keeps the angle
    dJointFeedback across_feedback;
    dJointFeedback turn_feedback;
    Vec2 offset; // m, from anchor a to anchor b when the rows were last set
};

// Makes a prismatic joint of two rows of ODE, and reads the force in them.
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

// The number of ODE's first body: not the ground.
static int first_of(const Sliding *sliding)
{
    return sliding->ids[0] != NULL ? 0 : 1;
}

// Makes the rows of a joint in a world whose bodies are given by number. ODE keeps pointers into
// the result: it must not be copied.
static void sliding_make(const Linkage *linkage, int joint, dWorldID world, const dBodyID *bodies,
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

// Before a step: brings the rows to where the bodies stand.
static void sliding_set(Sliding *sliding, double step_s)
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

// Fills in the force and the couple of the last step.
static void sliding_force(const Sliding *sliding, JointState *state)
{
    // ODE gives what acts on the first body
    const double sign = first_of(sliding) == 1 ? 1.0 : -1.0;
    const dReal *force = sliding->across_feedback.f1;
    state->force_on_b = (Vec2){sign * force[0], sign * force[1]};
    state->force = vec2_length(state->force_on_b);
    state->moment_on_b = sign * sliding->turn_feedback.t1[2];
}

// Finds out whether rows of the ideal joints follow from one another.
//
// Jacobian rows of a ball between bodies a and b, arm r from each centre to the anchor:
//     x: v_x - w_z r_y,   y: v_y + w_z r_x,   z: v_z + w_x r_y - w_y r_x      (b minus a)
// A prismatic joint has two (model/joint_rows.h). Each freedom of each body that can give way is an
// equation of the rows' forces; the rows are independent where no force is left open.

enum { BALL_ROWS = 3, BODY_FREEDOMS = 6 };

// rows that differ by less than this share are one row twice: rounding leaves 1e-15
static const double WORLD_INDEPENDENT = 1e-9;

// What the freedoms of one body are in the rows of an ideal joint.
static void fill_freedoms(const Linkage *linkage, const Motion *motions, int joint, int side,
                          double freedoms[BODY_FREEDOMS][BALL_ROWS])
{
    const Joint *of = &linkage->joints[joint];
    const JointEnd end = linkage_end(of, side);
    for (size_t i = 0; i < BODY_FREEDOMS * BALL_ROWS; i++) {
        freedoms[i / BALL_ROWS][i % BALL_ROWS] = 0.0;
    }
    JointRows rows;
    joint_rows_find(linkage, motions, joint, &rows);
    for (size_t k = 0; k < JOINT_ROWS; k++) {
        freedoms[0][k] = rows.rows[k].x[side];
        freedoms[1][k] = rows.rows[k].y[side];
        freedoms[5][k] = rows.rows[k].turn[side];
    }
    if (!joint_slides(of->kind)) {
        const double sign = side == 0 ? -1.0 : 1.0;
        const Vec2 arm = vec2_rotate(motions[end.body].angle, end.anchor);
        freedoms[2][2] = sign;
        freedoms[3][2] = sign * arm.y;
        freedoms[4][2] = -sign * arm.x;
    }
}

// The rows of a linkage, as nodes of a sparse matrix.
typedef struct Rows {
    const Linkage *linkage;
    const Motion *motions;
    int *joints;        // of a node
    size_t *first_node; // by body, of `nodes`
    size_t *nodes;
    Sparse sparse;
    double *squares; // by row
    double *equation;
} Rows;

static void start_rows(const Linkage *linkage, const Motion *motions, Rows *rows)
{
    size_t count = 0;
    size_t *sizes = zeroed(linkage->joint_count, sizeof *sizes);
    *rows = (Rows){.linkage = linkage, .motions = motions};
    rows->joints = zeroed(linkage->joint_count, sizeof *rows->joints);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_is_ideal(linkage, i)) {
            const bool slides = joint_slides(linkage->joints[i].kind);
            sizes[count] = slides ? (size_t)JOINT_ROWS : (size_t)BALL_ROWS;
            rows->joints[count++] = (int)i;
        }
    }
    rows->first_node = zeroed(linkage->body_count + 1, sizeof *rows->first_node);
    rows->nodes = zeroed(2 * count, sizeof *rows->nodes);
    joint_nodes_list(linkage, rows->joints, count, rows->first_node, rows->nodes);
    SparseLink *links;
    const size_t link_count = joint_nodes_link(linkage, rows->joints, count, &links);
    sparse_init(count, sizes, count, link_count, links, &rows->sparse);
    rows->squares = zeroed(rows->sparse.row_count, sizeof *rows->squares);
    rows->equation = zeroed(rows->sparse.row_count, sizeof *rows->equation);
    free(links);
    free(sizes);
}

static void finish_rows(Rows *rows)
{
    free(rows->joints);
    free(rows->first_node);
    free(rows->nodes);
    free(rows->squares);
    free(rows->equation);
    sparse_finish(&rows->sparse);
}

// Takes in the equation of one freedom of a body.
static void add_freedom(Rows *rows, size_t body, size_t freedom)
{
    size_t first = rows->sparse.count;
    for (size_t n = rows->first_node[body]; n < rows->first_node[body + 1]; n++) {
        const size_t node = rows->nodes[n];
        const int joint = rows->joints[node];
        const int side = linkage_end(&rows->linkage->joints[joint], 0).body == (int)body ? 0 : 1;
        const size_t row = rows->sparse.first_row[node];
        double freedoms[BODY_FREEDOMS][BALL_ROWS];
        fill_freedoms(rows->linkage, rows->motions, joint, side, freedoms);
        for (size_t k = 0; k < rows->sparse.first_row[node + 1] - row; k++) {
            const double entry = freedoms[freedom][k];
            rows->equation[row + k] = entry;
            rows->squares[row + k] += entry * entry;
        }
        first = rows->sparse.order[node] < first ? rows->sparse.order[node] : first;
    }
    if (first < rows->sparse.count) {
        sparse_rank_add(&rows->sparse, first, rows->equation);
    }
}

bool world_rows_check(const Scenario *scenario, const Motion *motions, size_t *row_count, Err *err)
{
    Rows rows;
    start_rows(&scenario->linkage, motions, &rows);
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        for (size_t k = 0; k < BODY_FREEDOMS; k++) {
            add_freedom(&rows, i, k);
        }
    }
    const size_t count = rows.sparse.row_count;
    const size_t rank =
        sparse_rank_find(&rows.sparse, rows.squares, WORLD_INDEPENDENT, rows.equation);
    finish_rows(&rows);
    if (rank != count) {
        return err_set(err, ERR_SOLVER,
                       "%zu of the %zu rows of the ideal joints follow from the others; ODE "
                       "cannot solve redundant rows: give one joint of the loop some play",
                       count - rank, count);
    }
    *row_count = count;
    return true;
}

static void make_bodies(const Scenario *scenario, const Motion *motions, World *world)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        const dBodyID made = dBodyCreate(world->id);
        // moments about x and y never enter; the one about z in all three entries is positive
        // definite
        dMass mass;
        dMassSetParameters(&mass, body->mass, 0, 0, 0, body->inertia, body->inertia, body->inertia,
                           0, 0, 0);
        dBodySetMass(made, &mass);
        // a rotation over a finite step, not its first order
        dBodySetFiniteRotationMode(made, 1);
        dBodySetGyroscopicMode(made, 0);
        world->bodies[i] = made;
        world_place(world, i, &motions[i]);
    }
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        dBodySetKinematic(world->bodies[linkage_drive_body(linkage, i)]);
    }
}

static void make_ball(const Scenario *scenario, const Motion *motions, size_t number, World *world)
{
    const OdeOptions *options = &scenario->ode;
    const Joint *joint = &scenario->linkage.joints[number];
    const dJointID ball = dJointCreateBall(world->id, 0);
    dJointAttach(ball, world_body(world, joint->body_a), world_body(world, joint->body_b));
    const Vec2 anchor = linkage_point(motions, joint->body_a, joint->anchor_a);
    dJointSetBallAnchor(ball, anchor.x, anchor.y, 0.0);
    dJointSetBallParam(ball, dParamERP, world_hold_erp(options));
    dJointSetBallParam(ball, dParamCFM, options->cfm);
    if (!scenario->run.is_lean) {
        dJointSetFeedback(ball, &world->feedback[number]);
    }
}

static void make_sliding(const Linkage *linkage, int number, const OdeOptions *options,
                         World *world)
{
    sliding_make(linkage, number, world->id, world->bodies, world_hold_erp(options), options->cfm,
                 &world->sliding[world->sliding_count++]);
}

static bool make_pairs(const Scenario *scenario, int number, World *world, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[number];
    Touch places[TOUCH_CORNERS];
    const size_t count = touch_places(&scenario->linkage, number, places);
    const dBodyID bodies[2] = {world_body(world, joint->body_a), world_body(world, joint->body_b)};
    for (size_t i = 0; i < count; i++) {
        WorldPair *pair = &world->pairs[world->pair_count++];
        if (joint->limits.kind != LIMIT_NONE) {
            pair_make_end(scenario, &places[i], bodies, world->id, world->ends, pair);
            continue;
        }
        if (!pair_make(scenario, &places[i], bodies, world->collider, pair, err)) {
            return false;
        }
    }
    return true;
}

void world_start(const Scenario *scenario, World *world)
{
    const OdeOptions *options = &scenario->ode;
    const Linkage *linkage = &scenario->linkage;
    memset(world, 0, sizeof *world);
    world->bodies = zeroed(linkage->body_count, sizeof *world->bodies);
    world->feedback = zeroed(linkage->joint_count, sizeof *world->feedback);
    engine_start();
    // the sequence is the process's, and nobody else draws from it
    if (options->solver == ODE_QUICK) {
        engine_seed(options->seed);
    }
    const dWorldID id = dWorldCreate();
    world->id = id;
    world->jobs = jobs_make(id);
    world->linkage = linkage;
    dWorldSetGravity(id, scenario->gravity.x, scenario->gravity.y, scenario->gravity.z);
    dWorldSetERP(id, world_hold_erp(options));
    dWorldSetCFM(id, options->cfm);
    dWorldSetAutoDisableFlag(id, 0);
    dWorldSetLinearDamping(id, 0.0);
    dWorldSetAngularDamping(id, 0.0);
    dWorldSetMaxAngularSpeed(id, dInfinity);
    dWorldSetContactSurfaceLayer(id, 0.0);
    dWorldSetContactMaxCorrectingVel(id, dInfinity);
    // room to step in as far as it is needed: ODE would take 64 KiB for each world
    const dWorldStepReserveInfo reserve = {sizeof reserve, dWORLDSTEP_RESERVEFACTOR_DEFAULT, 0};
    dWorldSetStepMemoryReservationPolicy(id, &reserve);
    dWorldSetQuickStepNumIterations(id, (int)options->iterations);
    dWorldSetQuickStepW(id, options->over_relaxation);
}

// Room for what only a world in the plane has: it may be one of many, each small.
static void make_pair_room(const Linkage *linkage, World *world)
{
    size_t pairs = 0;
    size_t slidings = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Touch places[TOUCH_CORNERS];
        const Joint *joint = &linkage->joints[i];
        pairs += linkage_has_play(joint) ? touch_places(linkage, (int)i, places) : 0;
        slidings += joint_is_ideal(joint->kind) && joint_slides(joint->kind) ? 1 : 0;
    }
    world->sliding = zeroed(slidings, sizeof *world->sliding);
    world->pairs = zeroed(pairs, sizeof *world->pairs);
}

bool world_build(const Scenario *scenario, const Motion *motions, World *world, Err *err)
{
    memset(world, 0, sizeof *world);
    size_t rows = 0;
    if (!world_rows_check(scenario, motions, &rows, err)) {
        return false;
    }
    world_start(scenario, world);
    world->constraint_rows = rows;
    world->collider = collider_get(scenario->ode.collider);
    world->hold = world_hold_make(scenario, WORLD_HOLD_ROWS);
    make_pair_room(&scenario->linkage, world);
    make_bodies(scenario, motions, world);
    world->ends = ends_make(&scenario->linkage, world->bodies, motions);
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const bool is_made = linkage_is_ideal(linkage, i) && world->hold == NULL;
        if (is_made && joint_slides(linkage->joints[i].kind)) {
            make_sliding(linkage, (int)i, &scenario->ode, world);
        } else if (is_made) {
            make_ball(scenario, motions, i, world);
        }
        if (linkage_has_play(&linkage->joints[i]) && !make_pairs(scenario, (int)i, world, err)) {
            return false;
        }
    }
    applied_make(linkage, world->id, world->bodies, motions, &world->applied);
    if (!scenario_integrates_contacts(scenario)) {
        rubbing_make(scenario, world->id, world->bodies, &world->rubbing);
    }
    world->applied.is_any = world->applied.is_any || world->rubbing.count > 0;
    return true;
}

void world_finish(World *world)
{
    for (size_t i = 0; i < world->pair_count; i++) {
        pair_finish(world->collider, &world->pairs[i]);
    }
    if (world->id != NULL) {
        dWorldDestroy(world->id);
    }
    jobs_free(world->jobs);
    free(world->bodies);
    free(world->feedback);
    free(world->sliding);
    free(world->pairs);
    rubbing_finish(&world->rubbing);
    applied_finish(&world->applied);
    world_hold_free(world->hold);
    ends_free(world->ends);
    memset(world, 0, sizeof *world);
}

void world_carry(World *world, Carry *carry)
{
    const size_t count = world->linkage->body_count;
    for (size_t i = 0; i < count; i++) {
        engine_carry_body(world->bodies[i], carry);
    }
    if (world->ends != NULL) {
        CARRY_ARRAY(carry, world->ends->motions, count);
    }
    if (!world->linkage->is_spatial) {
        applied_carry(&world->applied, carry);
        rubbing_carry(&world->rubbing, carry);
    }
}

bool world_step(World *world, double step_s, bool is_quick, Err *err)
{
    for (size_t i = 0; i < world->sliding_count; i++) {
        sliding_set(&world->sliding[i], step_s);
    }
    if (world->hold != NULL) {
        world_motions(world, world_hold_motions(world->hold));
        if (!world_hold_push(world->hold, world->bodies, step_s, err)) {
            return false;
        }
    }
    return engine_step(world->id, step_s, is_quick, err);
}

void world_offsets(const World *world, int body, Vec2 *offsets)
{
    for (size_t i = 0; i < world->sliding_count; i++) {
        const int joint = world->sliding[i].joint;
        if (world->linkage->joints[joint].body_a == body) {
            offsets[joint] = world->sliding[i].offset;
        }
    }
    if (world->hold != NULL) {
        world_hold_offsets(world->hold, body, offsets);
    }
}

bool world_check(const World *world, Err *err)
{
    const Linkage *linkage = world->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const dReal *velocity = dBodyGetLinearVel(world->bodies[i]);
        const dReal *omega = dBodyGetAngularVel(world->bodies[i]);
        if (!isfinite(velocity[0] + velocity[1] + omega[2])) {
            return err_set(err, ERR_SOLVER, "the velocity of the %s is no longer finite",
                           linkage->bodies[i].name);
        }
        const bool is_off = velocity[2] != 0.0 || omega[0] != 0.0 || omega[1] != 0.0;
        // in space that is rounding, which ends where the body is put back
        if (is_off && !linkage->is_spatial) {
            return err_set(err, ERR_SOLVER, "the %s has left the plane", linkage->bodies[i].name);
        }
    }
    return true;
}

void world_joint_forces(const World *world, JointState *joints)
{
    const Linkage *linkage = world->linkage;
    if (world->hold != NULL) {
        world_hold_forces(world->hold, joints);
        return;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint_is_ideal(joint->kind) && joint_pivots(joint->kind)) {
            // ODE gives the force on the first body attached: a, if it is no ground
            const double sign = joint->body_a != LINKAGE_GROUND ? -1.0 : 1.0;
            const dReal *force = world->feedback[i].f1;
            joints[i].force_on_b = (Vec2){sign * force[0], sign * force[1]};
            joints[i].force = vec2_length(joints[i].force_on_b);
        }
    }
    for (size_t i = 0; i < world->sliding_count; i++) {
        sliding_force(&world->sliding[i], &joints[world->sliding[i].joint]);
    }
}

void world_place(World *world, size_t body, const Motion *motion)
{
    const dBodyID id = world->bodies[body];
    const dQuaternion turn = {cos(0.5 * motion->angle), 0.0, 0.0, sin(0.5 * motion->angle)};
    const Linkage *linkage = world->linkage;
    const double height = linkage->is_spatial ? linkage->bodies[body].space.height : 0.0;
    dBodySetPosition(id, motion->position.x, motion->position.y, height);
    dBodySetQuaternion(id, turn);
    dBodySetLinearVel(id, motion->velocity.x, motion->velocity.y, 0.0);
    dBodySetAngularVel(id, 0.0, 0.0, motion->omega);
}

void world_place_driven(World *world, double placed_s, double speed_s, long direction)
{
    for (size_t i = 0; i < linkage_drive_count(world->linkage); i++) {
        Motion motion = stepping_driven(world->linkage, i, placed_s);
        const Motion moving = stepping_driven(world->linkage, i, speed_s);
        motion.velocity = vec2_scale((double)direction, moving.velocity);
        motion.omega = (double)direction * moving.omega;
        world_place(world, (size_t)linkage_drive_body(world->linkage, i), &motion);
    }
}

Snapshot world_snapshot(const World *world, size_t body)
{
    return snapshot_of(world->bodies[body]);
}

void world_motions(const World *world, Motion *motions)
{
    for (size_t i = 0; i < world->linkage->body_count; i++) {
        const Snapshot now = world_snapshot(world, i);
        motions[i] = (Motion){
            .position = now.position,
            .angle = atan2(now.direction.y, now.direction.x),
            .velocity = now.velocity,
            .omega = now.omega,
        };
    }
}

double world_count_turns(const World *world, size_t body, double angle)
{
    return count_turns(world->ends, body, angle);
}
