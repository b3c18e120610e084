// Finds the accelerations of a linkage with play in the plane.
//
//     M qdd = sum over bodies B^T (F - m a_bias) + moments + J^T lambda,   J qdd = gamma
// B: velocity of each centre by each coordinate (reference/plane/tree.h), M = sum m B^T B + I; J,
// gamma: the joints that close loops. Solved body by body: reference/plane/articulated.h. The
// contacts' forces: see below; those of springs, dampers and torques: model/forces.c.
#include "reference/plane/dynamics.h"
#include "model/loads.h"

#include "base/mesh.h"
#include "base/zeroed.h"
#include "contact/law.h"
#include "kernel/friction_law.h"
#include "kernel/pin_hole.h"
#include "model/coordinate.h"
#include "model/forces.h"
#include "reference/plane/articulated.h"
#include "reference/plane/tree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Contact forces: the force with which two bodies press on one another where they touch.
//
// Where: contact/touch.h, with distances that keep their digits (reference/plane/tree.h). Along the
// normal n as its law has it (reference/system.h), never below zero (that is the slack mode), and
// against the sliding speed v_t of the two bodies at the touching point, across the normal:
//     mu N tanh(v_t / v_s)
// tanh makes Coulomb's law smooth. The second rate of the gap of two circles, d from centre to
// centre, v its rate, + of discs and - of a pin in its hole:
//     n . d'' +- (v across n)^2 / |d|

// Adds what friction does to a contact that presses.
static void dynamics_add_friction(const Dynamics *dynamics, size_t number, const TreeState *state,
                                  const double *y, ContactForce *force)
{
    const ForceLaw *law = &dynamics->system.contacts[number].law;
    const int end = 2 * dynamics->sites[number].pair;
    const Vec2 tangent = vec2_perp(force->pose.normal);
    Vec2 from_a;
    Vec2 from_b;
    dynamics_contact_points(&dynamics->sites[number], &force->pose, &from_a, &from_b);
    const Vec2 sliding =
        vec2_sub(dynamics_contact_velocity(&dynamics->tree, state, end + 1, from_b),
                 dynamics_contact_velocity(&dynamics->tree, state, end, from_a));
    const double speed = vec2_dot(tangent, sliding);
    double held = friction_hold(speed, law->friction_speed).held;
    force->sliding = speed;
    if (dynamics->bristle_of[number] >= 0) {
        const size_t bristle = (size_t)dynamics->bristle_of[number];
        const BristlePair pair = dynamics_contact_bristle(dynamics, number, force->press.normal);
        const BristleHold hold =
            bristle_hold(&pair, dynamics->system.bristles[bristle].mode,
                         y[system_bristle_index(&dynamics->system, bristle)], speed);
        held = hold.share;
        force->bending = hold.bending;
    }
    const double friction = law->friction * force->press.normal * held;
    force->force = vec2_sub(force->force, vec2_scale(friction, tangent));
    force->press.friction_power = friction * speed;
}

static TouchPose pose_in_hole(const Contact *contact, const Tree *tree, const TreeState *state,
                              int pair)
{
    const Vec2 velocity = tree_pair_velocity(tree, state, pair);
    const PinHole pin = pin_hole_pose((Vec2){0.0, 0.0}, tree_pair_gap(tree, state, pair), velocity,
                                      contact->clearance);
    return touch_pose_in_hole(&pin, velocity);
}

// The unit vector in which a flat faces a cam, in the world.
static Vec2 facing_of(const Tree *tree, const TreeState *state, const PlaneSite *site)
{
    const int body = tree->end_bodies[2 * site->pair + 1];
    const double angle = body == LINKAGE_GROUND ? 0.0 : state->motions[body].angle;
    return vec2_rotate(angle + site->touch.cam.facing, (Vec2){1.0, 0.0});
}

CamPose dynamics_cam(const Tree *tree, const TreeState *state, const PlaneSite *site)
{
    const Cam *cam = &site->touch.cam;
    return cam_pose(cam, tree_normal(tree, state, site->pair),
                    cam->is_flat ? facing_of(tree, state, site) : (Vec2){1.0, 0.0},
                    tree_pair_gap(tree, state, site->pair));
}

static TouchPose pose_on_cam(const Tree *tree, const TreeState *state, const PlaneSite *site)
{
    const Vec2 offset = tree_pair_gap(tree, state, site->pair);
    const Vec2 velocity = tree_pair_velocity(tree, state, site->pair);
    const CamPose pose = dynamics_cam(tree, state, site);
    const int *bodies = tree->end_bodies + 2 * site->pair;
    return (TouchPose){
        .offset = offset,
        .velocity = velocity,
        .gap = pose.gap,
        .has_normal = true,
        .normal = pose.normal,
        .approach_speed = -cam_rate(&pose, offset, velocity, tree_omega(state, bodies[0]),
                                    tree_omega(state, bodies[1])),
        .from_b = pose.from_b,
    };
}

// The second rate of the gap there, after tree_accelerate.
static double second_on_cam(const Tree *tree, const TreeState *state, const PlaneSite *site)
{
    const int *bodies = tree->end_bodies + 2 * site->pair;
    const double omegas[2] = {tree_omega(state, bodies[0]), tree_omega(state, bodies[1])};
    const Vec2 offset = tree_pair_gap(tree, state, site->pair);
    const Vec2 velocity = tree_pair_velocity(tree, state, site->pair);
    const CamPose pose = dynamics_cam(tree, state, site);
    const Vec2 from_b = pose.measured;
    const Vec2 from_a = vec2_add(offset, from_b);
    const Vec2 turned_b = vec2_sub(vec2_scale(tree_alpha(state, bodies[1]), vec2_perp(from_b)),
                                   vec2_scale(omegas[1] * omegas[1], from_b));
    const Vec2 turned_a = vec2_sub(vec2_scale(tree_alpha(state, bodies[0]), vec2_perp(from_a)),
                                   vec2_scale(omegas[0] * omegas[0], from_a));
    const Vec2 relative =
        vec2_add(tree_pair_acceleration(tree, state, site->pair), vec2_sub(turned_b, turned_a));
    const double sliding = cam_sliding(&pose, offset, velocity, omegas[0], omegas[1]);
    return vec2_dot(pose.normal, relative) +
           cam_bend(&site->touch.cam, &pose, omegas[0], omegas[1], sliding);
}

// A pin in a slot: which of its walls it meets, and how. The straight ones are lines, with the
// digits of the way since the base; the ends are holes.

int dynamics_contact_pair(const Tree *tree, const PlaneSite *site, ContactWall wall)
{
    switch (wall) {
    case WALL_LOW:
        return tree->corners[site->touch.joint];
    case WALL_HIGH:
        return tree->corners[site->touch.joint] + 1;
    case WALL_NEAREST:
    case WALL_BEHIND:
    case WALL_AHEAD:
        break;
    }
    return site->pair;
}

WallPlace dynamics_wall(const Tree *tree, const TreeState *state, const PlaneSite *site,
                        const Contact *contact)
{
    const double half = site->touch.half_length;
    const Vec2 across = tree_normal(tree, state, site->pair);
    const Vec2 offset = tree_pair_gap(tree, state, site->pair);
    const TouchSlot slot =
        touch_in_slot(offset, tree_pair_velocity(tree, state, site->pair), across,
                      tree_omega(state, tree->end_bodies[2 * site->pair]));
    const double ahead = slot.position.y;
    const ContactWall end = ahead > 0.0 ? WALL_HIGH : WALL_LOW;
    const ContactWall side =
        tree_distance(tree, state, site->pair) > 0.0 ? WALL_AHEAD : WALL_BEHIND;
    const double outward = ahead > 0.0 ? slot.rate.y : -slot.rate.y;
    WallPlace place = {.wall = contact->wall};
    if (place.wall == WALL_NEAREST) {
        place.wall = fabs(ahead) > half ? end : side;
    }
    switch (place.wall) {
    case WALL_LOW:
        place.next = side;
        place.within = -ahead - half;
        place.leaving = slot.rate.y;
        break;
    case WALL_HIGH:
        place.next = side;
        place.within = ahead - half;
        place.leaving = -slot.rate.y;
        break;
    case WALL_NEAREST:
    case WALL_BEHIND:
    case WALL_AHEAD:
        place.next = end;
        place.within = half - fabs(ahead);
        place.leaving = outward;
        break;
    }
    return place;
}

static TouchPose pose_in_slot(const Contact *contact, const Tree *tree, const TreeState *state,
                              const PlaneSite *site)
{
    const Vec2 across = tree_normal(tree, state, site->pair);
    const Vec2 along = vec2_perp(across);
    const ContactWall wall = dynamics_wall(tree, state, site, contact).wall;
    const int pair = dynamics_contact_pair(tree, site, wall);
    TouchPose pose = {
        .offset = tree_pair_gap(tree, state, site->pair),
        .velocity = tree_pair_velocity(tree, state, site->pair),
        .has_normal = true,
    };
    if (pair != site->pair) {
        const TouchPose end = pose_in_hole(contact, tree, state, pair);
        pose.gap = end.gap;
        pose.has_normal = end.has_normal;
        pose.normal = end.normal;
        pose.approach_speed = end.approach_speed;
        pose.middle = vec2_sub(pose.offset, end.offset);
        return pose;
    }
    const double side = wall == WALL_AHEAD ? 1.0 : -1.0;
    pose.gap = contact->clearance - side * tree_distance(tree, state, pair);
    pose.normal = vec2_scale(-side, across);
    pose.approach_speed = side * tree_line_rate(tree, state, pair);
    pose.middle = vec2_scale(vec2_dot(along, pose.offset), along);
    return pose;
}

// A point or disc on body b against a line of body a, or a disc against a disc. The gap has the
// digits of the way since the base.
static TouchPose pose_outside(const Tree *tree, const TreeState *state, const PlaneSite *site)
{
    const int pair = site->pair;
    const bool is_line = site->touch.shape == TOUCH_LINE;
    const Vec2 line = is_line ? tree_normal(tree, state, pair) : (Vec2){0.0, 0.0};
    TouchPose pose = touch_pose_of(&site->touch, tree_pair_gap(tree, state, pair),
                                   tree_pair_velocity(tree, state, pair), line,
                                   tree_omega(state, tree->end_bodies[2 * pair]));
    pose.gap = tree_distance(tree, state, pair);
    return pose;
}

static double angle_of(const TreeState *state, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : state->motions[body].angle;
}

MeshFlank dynamics_flank(const Tree *tree, const TreeState *state, const PlaneSite *site)
{
    const int *bodies = tree->end_bodies + 2 * site->pair;
    const Mesh mesh = coordinate_mesh(tree->linkage, &tree->linkage->joints[site->touch.joint]);
    return mesh_flank(&mesh, site->touch.sign, tree_pair_gap(tree, state, site->pair),
                      angle_of(state, bodies[0]), angle_of(state, bodies[1]));
}

static TouchPose pose_of_flank(const Tree *tree, const TreeState *state, const PlaneSite *site)
{
    const int joint = site->touch.joint;
    const int *bodies = tree->end_bodies + 2 * site->pair;
    const Gear *gear = &tree->linkage->joints[joint].gear;
    const MeshFlank flank = dynamics_flank(tree, state, site);
    const Vec2 velocity = tree_pair_velocity(tree, state, site->pair);
    const double beyond = site->touch.sign * tree_coordinate(tree, state, joint) - site->end;
    // without a pressure angle the centres stay as far apart as they are
    const bool may_part = gear->pressure_angle > 0.0;
    return (TouchPose){
        .offset = flank.offset,
        .velocity = velocity,
        .gap =
            mesh_gap(gear, &flank, beyond, may_part ? tree_distance(tree, state, site->pair) : 0.0),
        .has_normal = true,
        .normal = flank.normal,
        .approach_speed = -mesh_rate(&flank, velocity, tree_omega(state, bodies[0]),
                                     tree_omega(state, bodies[1])),
        .from_b = flank.from_b,
    };
}

// The second rate of its gap.
static double second_of_flank(const Tree *tree, const TreeState *state, const PlaneSite *site)
{
    const int *bodies = tree->end_bodies + 2 * site->pair;
    const MeshFlank flank = dynamics_flank(tree, state, site);
    return mesh_rate(&flank, tree_pair_acceleration(tree, state, site->pair),
                     tree_alpha(state, bodies[0]), tree_alpha(state, bodies[1])) +
           mesh_bend(&flank, tree_pair_velocity(tree, state, site->pair),
                     tree_omega(state, bodies[0]), tree_omega(state, bodies[1]));
}

// An end of an angle, or a flank of a rack.
static TouchPose pose_of_end(const Tree *tree, const TreeState *state, const PlaneSite *site)
{
    const int joint = site->touch.joint;
    const double sign = site->touch.sign;
    const Vec2 offset = tree_pair_gap(tree, state, site->pair);
    TouchPose pose = {
        .offset = offset,
        .velocity = tree_pair_velocity(tree, state, site->pair),
        .gap = sign * tree_coordinate(tree, state, joint) - site->end,
        .has_normal = true,
        .approach_speed = -sign * tree_coordinate_rate(tree, state, joint),
    };
    switch (site->touch.shape) {
    case TOUCH_RACK:
        pose.normal = vec2_scale(sign, tree_normal(tree, state, site->pair));
        break;
    case TOUCH_TURN:
    case TOUCH_TEETH: // pose_of_flank has it
    case TOUCH_HOLE:  // which are no ends
    case TOUCH_DISC:
    case TOUCH_LINE:
    case TOUCH_CAM:
    case TOUCH_SLOT:
        break;
    }
    return pose;
}

static TouchPose pose_of(const Contact *contact, const Tree *tree, const TreeState *state,
                         const PlaneSite *site)
{
    switch (site->touch.shape) {
    case TOUCH_HOLE:
        return pose_in_hole(contact, tree, state, site->pair);
    case TOUCH_TEETH:
        return pose_of_flank(tree, state, site);
    case TOUCH_TURN:
    case TOUCH_RACK:
        return pose_of_end(tree, state, site);
    case TOUCH_CAM:
        return pose_on_cam(tree, state, site);
    case TOUCH_SLOT:
        return pose_in_slot(contact, tree, state, site);
    case TOUCH_DISC:
    case TOUCH_LINE:
        break;
    }
    return pose_outside(tree, state, site);
}

// The second rate of the gap between two circles, of which the pair of the tree has the centres.
static double second_of_circles(const Tree *tree, const TreeState *state, int pair,
                                const TouchPose *pose, bool is_inside)
{
    const double across = vec2_cross(pose->normal, pose->velocity);
    const double turning = across * across / sqrt(vec2_dot(pose->offset, pose->offset));
    return vec2_dot(pose->normal, tree_pair_acceleration(tree, state, pair)) +
           (is_inside ? -turning : turning);
}

static double second_in_slot(const Dynamics *dynamics, size_t number, const TreeState *state,
                             const TouchPose *pose)
{
    const Tree *tree = &dynamics->tree;
    const PlaneSite *site = &dynamics->sites[number];
    const ContactWall wall =
        dynamics_wall(tree, state, site, &dynamics->system.contacts[number]).wall;
    const int pair = dynamics_contact_pair(tree, site, wall);
    if (pair != site->pair) {
        const TouchPose end = {
            .offset = tree_pair_gap(tree, state, pair),
            .velocity = tree_pair_velocity(tree, state, pair),
            .normal = pose->normal,
        };
        return second_of_circles(tree, state, pair, &end, true);
    }
    return (wall == WALL_AHEAD ? -1.0 : 1.0) * tree_line_second(tree, state, pair);
}

double dynamics_contact_second(const Dynamics *dynamics, size_t number, const TreeState *state,
                               const TouchPose *pose)
{
    const PlaneSite *site = &dynamics->sites[number];
    bool is_inside = false;
    switch (site->touch.shape) {
    case TOUCH_LINE:
        return tree_line_second(&dynamics->tree, state, site->pair);
    case TOUCH_CAM:
        return second_on_cam(&dynamics->tree, state, site);
    case TOUCH_SLOT:
        return second_in_slot(dynamics, number, state, pose);
    case TOUCH_TEETH:
        return second_of_flank(&dynamics->tree, state, site);
    case TOUCH_TURN:
    case TOUCH_RACK:
        return site->touch.sign * tree_coordinate_second(&dynamics->tree, state, site->touch.joint);
    case TOUCH_HOLE:
        is_inside = true;
        break;
    case TOUCH_DISC:
        break;
    }
    return second_of_circles(&dynamics->tree, state, site->pair, pose, is_inside);
}

void dynamics_contact_find(const Dynamics *dynamics, size_t number, const TreeState *state,
                           const double *y, ContactForce *force)
{
    const Contact *contact = &dynamics->system.contacts[number];
    const PlaneSite *site = &dynamics->sites[number];
    force->pose = pose_of(contact, &dynamics->tree, state, site);
    force->press = press_find(contact, -force->pose.gap, force->pose.approach_speed);
    force->force = (Vec2){0.0, 0.0};
    force->couple = 0.0;
    force->sliding = force->bending = 0.0;
    if (contact->mode != CONTACT_PRESSING) {
        return;
    }
    force->force = vec2_scale(force->press.normal, force->pose.normal);
    if (touch_is_torque(&site->touch)) {
        const Joint *joint = &dynamics->tree.linkage->joints[contact->joint];
        force->couple = site->touch.sign * coordinate_sense(joint) * force->press.normal;
    }
    if (contact->law.friction > 0.0 && !dynamics_contact_is_turn(site)) {
        dynamics_add_friction(dynamics, number, state, y, force);
    }
}

// Reactions: the forces with which the ideal joints hold their bodies.
//
// Of joints that close loops the multipliers' negatives. Of those that bodies hang on, children
// before parents, what the body's own equations leave over:
//     force  m a - F,   couple about the anchor  I al - M - s x force
// F, M: the other forces on the body and their moment about its centre; s from the centre to the
// anchor. A prismatic joint's force acts where the anchor on body b is, on both bodies.

// Where the force of a joint acts on one of its sides: from the end to the anchor on body b.
static Vec2 beside(const Tree *tree, const TreeState *state, int end)
{
    const bool is_on_line = tree->measures[end / 2] == TREE_LINE;
    return is_on_line && end % 2 == 0 ? tree_pair_gap(tree, state, end / 2) : (Vec2){0.0, 0.0};
}

// The joint's force and couple on its body b, on its bodies.
static void load_joint(const Tree *tree, int joint, Loads *loads, DynamicsState *state)
{
    for (int side = 0; side < 2; side++) {
        const double sign = side == 0 ? -1.0 : 1.0;
        const int end = 2 * joint + side;
        dynamics_load_end(tree, &state->tree, end, beside(tree, &state->tree, end),
                          vec2_scale(sign, state->reactions[joint]), loads);
        if (tree->measures[joint] == TREE_LINE) {
            dynamics_load_couple(tree, &state->tree, tree->end_bodies[end],
                                 sign * state->couples[joint], loads);
        }
    }
}

static void find_loops(const Tree *tree, const double *solved, Loads *loads, DynamicsState *state)
{
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        const int joint = tree->loops[loop];
        const double *lambda = solved + tree->coordinate_count + 2 * loop;
        state->reactions[joint] = (Vec2){-lambda[0], -lambda[1]};
        state->couples[joint] = 0.0;
        if (tree->measures[joint] == TREE_LINE) {
            const Vec2 normal = tree_normal(tree, &state->tree, joint);
            state->reactions[joint] = vec2_scale(-lambda[0], normal);
            state->couples[joint] = -lambda[1];
        }
        load_joint(tree, joint, loads, state);
    }
}

// What a body that hangs needs of its joint beyond its other forces, on the body: the force, and
// the couple where that force acts.
static void find_held(const Tree *tree, const TreeNode *node, const Loads *loads,
                      DynamicsState *state)
{
    const Body *body = &tree->linkage->bodies[node->body];
    const Motion *motion = &state->tree.motions[node->body];
    const Vec2 reaction =
        vec2_sub(vec2_scale(body->mass, motion->acceleration), loads->pushes[node->body].force);
    const double sign = node->own_end % 2 == 1 ? 1.0 : -1.0;
    state->reactions[node->joint] = sign > 0.0 ? reaction : vec2_scale(-1.0, reaction);
    state->couples[node->joint] = 0.0;
    if (node->is_sliding) {
        const Vec2 arm =
            vec2_add(state->tree.arms[node->own_end], beside(tree, &state->tree, node->own_end));
        const double moment = body->inertia * motion->alpha - loads->pushes[node->body].moment;
        state->couples[node->joint] = sign * (moment - vec2_cross(arm, reaction));
    }
}

// Fills in the reactions of the joints that bodies hang on.
static void find_tree(const Tree *tree, Loads *loads, DynamicsState *state)
{
    for (size_t i = tree->node_count; i-- > 0;) {
        const TreeNode *node = &tree->nodes[i];
        if (node->joint >= 0) {
            find_held(tree, node, loads, state);
            const double sign = node->own_end % 2 == 1 ? -1.0 : 1.0;
            dynamics_load_end(tree, &state->tree, node->parent_end,
                              beside(tree, &state->tree, node->parent_end),
                              vec2_scale(sign, state->reactions[node->joint]), loads);
            if (node->is_sliding) {
                dynamics_load_couple(tree, &state->tree, node->parent,
                                     sign * state->couples[node->joint], loads);
            }
        }
    }
}

// Fills in the accelerations of the bodies from what the equations were solved for, then the
// reactions of the ideal joints but the drive's; adds those to the loads.
static void dynamics_reactions_find(const Dynamics *dynamics, const double *solved, Loads *loads,
                                    DynamicsState *state)
{
    tree_accelerate(&dynamics->tree, solved, &state->tree);
    find_loops(&dynamics->tree, solved, loads, state);
    find_tree(&dynamics->tree, loads, state);
}

// What the coordinates of the tree are.
static void dynamics_list_coordinates(Dynamics *dynamics)
{
    const Tree *tree = &dynamics->tree;
    SystemCoordinate *coordinates = dynamics->system.coordinates;
    dynamics->system.coordinate_count = tree->coordinate_count;
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const Body *body = &tree->linkage->bodies[node->body];
        SystemCoordinate *own = &coordinates[node->column];
        if (node->is_sliding) {
            *own = (SystemCoordinate){-1, 1.0, body->mass};
            continue;
        }
        *own = (SystemCoordinate){
            .turning = node->body,
            .reach = dynamics->reach[node->body],
            .inertia = body->inertia,
        };
        if (node->joint < 0) {
            own[-1] = own[-2] = (SystemCoordinate){-1, 1.0, body->mass};
        } else {
            const Vec2 arm = tree->anchors[node->own_end];
            own->inertia += body->mass * vec2_dot(arm, arm);
        }
    }
}

// All arrays, from a layout that counts or has the memory.
static void dynamics_lay(Dynamics *dynamics, size_t contact_most, MemoryLayout *layout)
{
    const Linkage *linkage = dynamics->tree.linkage;
    const size_t bodies = linkage->body_count;
    const size_t n = dynamics->tree.coordinate_count;
    const size_t rows = 2 * dynamics->tree.loop_count;
    System *system = &dynamics->system;
    DynamicsRoom *room = &dynamics->room;
    system->coordinates = layout_take(layout, n, sizeof *system->coordinates);
    system->contacts = layout_take(layout, contact_most, sizeof *system->contacts);
    system->bristles =
        layout_take(layout, linkage->joint_count + contact_most, sizeof *system->bristles);
    dynamics->bristle_of = layout_take(layout, contact_most, sizeof *dynamics->bristle_of);
    dynamics->sites = layout_take(layout, contact_most, sizeof *dynamics->sites);
    dynamics->reach = layout_take(layout, bodies, sizeof *dynamics->reach);
    dynamics->weights = layout_take(layout, bodies, sizeof *dynamics->weights);
    room->loads.pushes = layout_take(layout, bodies, sizeof *room->loads.pushes);
    room->zeros = layout_take(layout, bodies, sizeof *room->zeros);
    room->added = layout_take(layout, bodies, sizeof *room->added);
    room->sides = layout_take(layout, rows, sizeof *room->sides);
    room->solved = layout_take(layout, n + rows, sizeof *room->solved);
    room->closed =
        layout_take(layout, 2 * n + linkage->joint_count + contact_most, sizeof *room->closed);
    room->row = layout_take(layout, n, sizeof *room->row);
    room->arms = layout_take(layout, n, sizeof *room->arms);
    for (int i = 0; i < DYNAMICS_PUSHED; i++) {
        room->pushed[i] = layout_take(layout, n + rows, sizeof *room->pushed[i]);
    }
}

static void dynamics_make_room(Dynamics *dynamics)
{
    const Linkage *linkage = dynamics->tree.linkage;
    const size_t contact_most = TOUCH_CORNERS * linkage->joint_count;
    MemoryLayout layout = {NULL, 0};
    dynamics_lay(dynamics, contact_most, &layout);
    dynamics->memory = calloc(1, layout.used + 1);
    assert(dynamics->memory != NULL);
    dynamics_lay(dynamics, contact_most, &(MemoryLayout){dynamics->memory, 0});
}

static Coupling *dynamics_couple(const Dynamics *dynamics)
{
    const Tree *tree = &dynamics->tree;
    const ArticulatedParts *parts = &dynamics->articulated->parts;
    CouplingBody *bodies = zeroed(tree->node_count, sizeof *bodies);
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const size_t before = node->joint < 0 ? 2 : 0; // a floating body's x and y
        bodies[i] =
            (CouplingBody){node->body, parts->of_node[i], node->column - before, 1 + before};
    }
    Coupling *coupling = coupling_create(tree->linkage, parts->count, tree->node_count, bodies);
    free(bodies);
    return coupling;
}

bool dynamics_init(const Scenario *scenario, Dynamics *dynamics, Err *err)
{
    *dynamics = (Dynamics){.system = {.scenario = scenario,
                                      .tolerance = law_reference_tolerance(scenario),
                                      .torn = -1}};
    const Linkage *linkage = &scenario->linkage;
    Tree *tree = &dynamics->tree;
    dynamics->has_forces = forces_any(linkage);
    dynamics->system.has_loads = linkage->load_count > 0;
    tree_build(linkage, tree);
    dynamics_make_room(dynamics);
    linkage_reaches(linkage, dynamics->reach);
    for (size_t i = 0; i < linkage->body_count; i++) {
        dynamics->weights[i] = vec2_scale(linkage->bodies[i].mass, scenario_gravity(scenario));
    }
    dynamics_list_coordinates(dynamics);
    dynamics->may_branch = tree->loop_count > 0 && tree->coordinate_count > 2 * tree->loop_count;
    if (!dynamics_list_sites(scenario, dynamics, err)) {
        dynamics_finish(dynamics);
        return false;
    }
    rub_list(scenario, dynamics);
    dynamics->rub = dynamics->rub_count > 0 ? rub_create(dynamics) : NULL;
    dynamics->articulated = articulated_create(tree, tree->loop_count, tree->loops);
    dynamics->system.coupling = dynamics_couple(dynamics);
    dynamics->hinged = hinged_create(dynamics);
    dynamics->room.state = dynamics_state_create(dynamics);
    return true;
}

void dynamics_finish(Dynamics *dynamics)
{
    free(dynamics->room.state);
    rub_destroy(dynamics->rub);
    hinged_destroy(dynamics->hinged);
    coupling_destroy(dynamics->system.coupling);
    articulated_destroy(dynamics->articulated);
    free(dynamics->memory);
    tree_finish(&dynamics->tree);
}

static void dynamics_lay_state(const Dynamics *dynamics, MemoryLayout *layout, DynamicsState *state)
{
    const size_t contacts = dynamics->system.contact_count;
    const size_t joints = dynamics->tree.linkage->joint_count;
    layout_take(layout, 1, sizeof *state);
    state->shared.contacts = layout_take(layout, contacts, sizeof *state->shared.contacts);
    tree_state_lay(&dynamics->tree, layout, &state->tree);
    state->contacts = layout_take(layout, contacts, sizeof *state->contacts);
    state->reactions = layout_take(layout, joints, sizeof *state->reactions);
    state->couples = layout_take(layout, joints, sizeof *state->couples);
    state->rubs = layout_take(layout, dynamics->rub_count, sizeof *state->rubs);
}

DynamicsState *dynamics_state_create(const Dynamics *dynamics)
{
    DynamicsState counted;
    MemoryLayout layout = {NULL, 0};
    dynamics_lay_state(dynamics, &layout, &counted);
    DynamicsState *state = calloc(1, layout.used);
    assert(state != NULL);
    dynamics_lay_state(dynamics, &(MemoryLayout){(char *)state, 0}, state);
    return state;
}

LoopsRoom dynamics_loops(const Dynamics *dynamics)
{
    const DynamicsRoom *room = &dynamics->room;
    return (LoopsRoom){
        .tree = &dynamics->tree,
        .loop_count = dynamics->tree.loop_count,
        .loops = dynamics->tree.loops,
        .articulated = dynamics->articulated,
        .state = &room->state->tree,
        .pushes = room->zeros,
        .sides = room->sides,
        .solved = room->solved,
    };
}

static void load_contact(const Dynamics *dynamics, size_t number, const TreeState *state,
                         const ContactForce *force, Loads *loads)
{
    const int end = 2 * dynamics->sites[number].pair;
    Vec2 from_a;
    Vec2 from_b;
    if (force->couple != 0.0) {
        const Tree *tree = &dynamics->tree;
        dynamics_load_couple(tree, state, tree->end_bodies[end + 1], force->couple, loads);
        dynamics_load_couple(tree, state, tree->end_bodies[end], -force->couple, loads);
        return;
    }
    dynamics_contact_points(&dynamics->sites[number], &force->pose, &from_a, &from_b);
    dynamics_load_end(&dynamics->tree, state, end + 1, from_b, force->force, loads);
    dynamics_load_end(&dynamics->tree, state, end, from_a, vec2_scale(-1.0, force->force), loads);
}

// Gravity, and nothing else yet.
static void dynamics_start_loads(const Dynamics *dynamics, Loads *loads)
{
    const Tree *tree = &dynamics->tree;
    for (size_t i = 0; i < tree->node_count; i++) {
        const int body = tree->nodes[i].body;
        loads->pushes[body] = (ArticulatedPush){dynamics->weights[body], 0.0};
    }
    loads->driven_power = 0.0;
    for (size_t i = 0; i < tree->drive_count; i++) {
        loads->driven_forces[i] = (Vec2){0.0, 0.0};
    }
}

// The torque of a drive with a limit, on the side where it is through the step.
static double sided_torque(const System *system, const Motion *motions, double time_s)
{
    const Linkage *linkage = &system->scenario->linkage;
    return system->side != 0 ? system->side * linkage->torque.limit
                             : forces_drive_unlimited(linkage, motions, time_s);
}

// Adds springs, dampers, a torque and loads; fills in their powers.
static void load_forces(const Dynamics *dynamics, double since_s, DynamicsState *state,
                        Loads *loads)
{
    state->drive_power = 0.0;
    state->damping_power = 0.0;
    state->load_power = 0.0;
    if (!dynamics->has_forces) {
        return;
    }
    const Tree *tree = &dynamics->tree;
    const Linkage *linkage = tree->linkage;
    const Motion *motions = state->tree.motions;
    const double time_s = tree_time(tree, since_s);
    BodyLoad *added = dynamics->room.added;
    const double from_s = tree_from(tree);
    loads_of_all(linkage, motions, time_s, from_s, added);
    if (linkage->torque.limit > 0.0) {
        const double torque = sided_torque(&dynamics->system, motions, time_s) -
                              forces_drive_torque(linkage, motions, time_s);
        forces_add_torque(linkage, motions, torque, added);
    }
    for (int i = 0; i < (int)linkage->body_count; i++) {
        const int drive = tree_drive_of(tree, i);
        if (drive >= 0) {
            loads->driven_power += forces_load_power(&added[i], &motions[i]);
            loads->driven_forces[drive] = vec2_add(loads->driven_forces[drive], added[i].force);
        } else {
            ArticulatedPush *push = &loads->pushes[i];
            push->force = vec2_add(push->force, added[i].force);
            push->moment += added[i].moment;
        }
    }
    state->drive_power = forces_torque_power(linkage, motions, time_s);
    if (linkage->torque.limit > 0.0) {
        state->drive_power =
            sided_torque(&dynamics->system, motions, time_s) * forces_drive_rate(linkage, motions);
    }
    state->damping_power = forces_damping_power(linkage, motions);
    state->load_power = loads_power(linkage, motions, time_s, from_s);
}

// Solves for the coordinates' second rates (and the loops' multipliers behind them), into the room;
// where loops have just been closed at these coordinates, by the elimination that closed them.
static bool dynamics_find_rates(const Dynamics *dynamics, double since_s, const double *y,
                                bool are_closed, DynamicsState *state, Loads *loads)
{
    const Tree *tree = &dynamics->tree;
    const DynamicsRoom *room = &dynamics->room;
    tree_evaluate(tree, since_s, y, y + tree->coordinate_count, &state->tree);
    dynamics_start_loads(dynamics, loads);
    load_forces(dynamics, since_s, state, loads);
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        dynamics_contact_find(dynamics, i, &state->tree, y, &state->contacts[i]);
        if (dynamics->system.contacts[i].mode == CONTACT_PRESSING) {
            load_contact(dynamics, i, &state->tree, &state->contacts[i], loads);
        }
    }
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        const Vec2 bias = loops_bias(tree, &state->tree, loop);
        room->sides[2 * loop] = -bias.x;
        room->sides[2 * loop + 1] = -bias.y;
    }
    if (dynamics->rub != NULL) {
        return rub_solve(dynamics, y, are_closed, state, loads);
    }
    return (are_closed ? articulated_accelerate_again : articulated_accelerate)(
        dynamics->articulated, &state->tree, loads->pushes, room->sides, room->solved);
}

// Power of the drives and forces of the driven joints, from the driven bodies' own equations.
static inline void dynamics_find_drives(const Dynamics *dynamics, const Loads *loads,
                                        DynamicsState *state)
{
    const Tree *tree = &dynamics->tree;
    const Vec2 upward = scenario_upward(dynamics->system.scenario);
    if (tree->drive_count > 0) {
        state->drive_power = -loads->driven_power;
    }
    for (size_t i = 0; i < tree->drive_count; i++) {
        const Body *driven = &tree->linkage->bodies[tree->drives[i].body];
        const Motion *motion = &state->tree.motions[tree->drives[i].body];
        const Vec2 needed = vec2_scale(driven->mass, vec2_add(motion->acceleration, upward));
        state->drive_power += vec2_dot(needed, motion->velocity);
        if (motion->alpha != 0.0) {
            state->drive_power += driven->inertia * motion->alpha * motion->omega;
        }
        state->reactions[tree->drives[i].driver->joint] = vec2_sub(needed, loads->driven_forces[i]);
    }
}

bool dynamics_solve(const Dynamics *dynamics, bool again, const DynamicsState *state,
                    const Loads *loads)
{
    const DynamicsRoom *room = &dynamics->room;
    // trees without loops are not factored apart
    return (again && !dynamics->articulated->is_plain ? articulated_accelerate_again
                                                      : articulated_accelerate)(
        dynamics->articulated, &state->tree, loads->pushes, room->sides, room->solved);
}

bool dynamics_react(const Dynamics *dynamics, bool again, DynamicsState *state, Loads *loads)
{
    if (!dynamics_solve(dynamics, again, state, loads)) {
        return false;
    }
    dynamics_reactions_find(dynamics, dynamics->room.solved, loads, state);
    dynamics_find_drives(dynamics, loads, state);
    return true;
}

static void dynamics_fill_sums(const Dynamics *dynamics, const DynamicsState *state, double *sums)
{
    sums[SYSTEM_DRIVE_WORK] = state->drive_power;
    sums[SYSTEM_DISSIPATED] = state->damping_power;
    sums[SYSTEM_FRICTION] = 0.0;
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        const Vec2 force = state->contacts[i].force;
        sums[SYSTEM_DISSIPATED] += state->contacts[i].press.damping_power;
        sums[SYSTEM_FRICTION] += state->contacts[i].press.friction_power;
        sums[SYSTEM_IMPULSES + i] = sqrt(vec2_dot(force, force)) + fabs(state->contacts[i].couple);
    }
    for (size_t i = 0; i < dynamics->rub_count; i++) {
        sums[SYSTEM_FRICTION] += state->rubs[i].friction * state->rubs[i].speed;
    }
    if (dynamics->system.has_loads) {
        sums[system_load_sum(&dynamics->system)] = state->load_power;
    }
}

// Rates of the integrator's vector, from a state whose equations are solved.
static void dynamics_fill_rates(const Dynamics *dynamics, const DynamicsState *state,
                                const double *y, double *rates)
{
    const size_t n = dynamics->tree.coordinate_count;
    for (size_t i = 0; i < n; i++) {
        rates[i] = y[n + i];
        rates[n + i] = dynamics->room.solved[i];
    }
    for (size_t i = 0; i < dynamics->system.bristle_count; i++) {
        const int contact = dynamics->system.bristles[i].contact;
        rates[system_bristle_index(&dynamics->system, i)] =
            contact >= 0 ? state->contacts[contact].bending : state->rubs[i].bending;
    }
    dynamics_fill_sums(dynamics, state, rates + system_sum_index(&dynamics->system, 0));
}

bool dynamics_evaluate(const Dynamics *dynamics, double since_s, const double *y,
                       DynamicsState *state, double *rates)
{
    if (dynamics->hinged != NULL && tree_is_steady(&dynamics->tree)) {
        return hinged_evaluate(dynamics->hinged, since_s, y, state, rates);
    }
    Loads loads = dynamics->room.loads;
    if (!dynamics_find_rates(dynamics, since_s, y, false, state, &loads)) {
        return false;
    }
    dynamics_reactions_find(dynamics, dynamics->room.solved, &loads, state);
    dynamics_find_drives(dynamics, &loads, state);
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        state->shared.contacts[i] = state->contacts[i].press;
    }
    if (rates != NULL) {
        dynamics_fill_rates(dynamics, state, y, rates);
    }
    return true;
}

ContactForce dynamics_contact(const Dynamics *dynamics, size_t contact, double since_s,
                              const double *y)
{
    const Tree *tree = &dynamics->tree;
    TreeState *state = &dynamics->room.state->tree;
    const double *u = y + tree->coordinate_count;
    tree_evaluate_pair(tree, dynamics->sites[contact].pair, since_s, y, u, state);
    ContactForce force;
    dynamics_contact_find(dynamics, contact, state, y, &force);
    return force;
}

WallPlace dynamics_contact_wall(const Dynamics *dynamics, size_t contact, double since_s,
                                const double *y)
{
    const Tree *tree = &dynamics->tree;
    TreeState *state = &dynamics->room.state->tree;
    const PlaneSite *site = &dynamics->sites[contact];
    tree_evaluate_pair(tree, site->pair, since_s, y, y + tree->coordinate_count, state);
    return dynamics_wall(tree, state, site, &dynamics->system.contacts[contact]);
}

size_t dynamics_contact_needs(const System *system, size_t contact, size_t *coordinates)
{
    const Dynamics *dynamics = (const Dynamics *)system;
    return tree_pair_coordinates(&dynamics->tree, dynamics->sites[contact].pair, coordinates);
}

// The rates of any mechanism; apart from the shorter way, so that this sets up nothing for it.
__attribute__((noinline)) static void find_all_rates(const Dynamics *dynamics, double since_s,
                                                     const double *y, double *rates)
{
    const Tree *tree = &dynamics->tree;
    const size_t n = tree->coordinate_count;
    DynamicsState *state = dynamics->room.state;
    Loads loads = dynamics->room.loads;
    const double *solved = dynamics->room.solved;
    if (dynamics->is_near_branch) {
        // with loops open by the error of a stage, the accelerations are wrong by that over the
        // distance from a change point
        double *closed = dynamics->room.closed;
        const LoopsRoom room = dynamics_loops(dynamics);
        memcpy(closed, y, (2 * n + dynamics->system.bristle_count) * sizeof *y);
        loops_project(&room, since_s, closed, closed + n);
        y = closed;
    }
    if (!dynamics_find_rates(dynamics, since_s, y, dynamics->is_near_branch, state, &loads)) {
        for (size_t i = 0; i < system_size(&dynamics->system); i++) {
            rates[i] = NAN;
        }
        return;
    }
    // the drives' power needs the reactions only where driven bodies carry ideal joints
    if (tree->is_driven_hung_on) {
        dynamics_reactions_find(dynamics, solved, &loads, state);
    }
    dynamics_find_drives(dynamics, &loads, state);
    dynamics_fill_rates(dynamics, state, y, rates);
}

void dynamics_rates(double since_s, const double *y, double *rates, void *context)
{
    const Dynamics *dynamics = context;
    if (dynamics->hinged == NULL || !hinged_rates(dynamics->hinged, since_s, y, rates)) {
        find_all_rates(dynamics, since_s, y, rates);
    }
}
