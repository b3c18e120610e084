// Differentiates the accelerations by coordinates and rates where bodies press on one another.
//
//     dA = M^-1 (G^T df + s dg),   de = G dq,  dv = G du
// G: how the circle's centre on body b moves against the circle's on body a, or against the point
// of body a's line under it, by each coordinate; s: the arms of friction about these points; e
// offset of the centres, v velocity, M the mass matrix with the loops' rows. Of the force on body b
//     f = N n - g t,   N = F_el(d) (1 + chi d'/v0) + c d',   g = mu N tanh((t v - s u) / v_s)
// with d the depth, d' = -n v and t at right angles to n:
//     dn = +-t (t de) / |e|,   dN = (1 + chi d'/v0) k dd + (chi F_el / v0 + c) dd'
// + of discs, - of a pin in its hole; a line's normal turns as slowly as the mechanism moves.
//
// A limited angle or teeth push along a coordinate q with steady shares w of the bodies' turns (of
// teeth and of the ways of their bodies along what they push), and hold no friction:
// dA = -M^-1 w ((1 + chi d'/v0) k w dq + (chi F_el / v0 + c) w du).
#include "reference/plane/dynamics.h"

#include "kernel/friction_law.h"
#include "reference/plane/articulated.h"
#include "reference/plane/tree.h"

#include <math.h>

// A pressing contact and what its force changes with.
typedef struct SlopesPressing {
    const Touch *touch;
    const ForceLaw *law;
    ContactForce force;
    Vec2 velocity;    // m/s, v
    double bend;      // m, +-|e| over which n turns; infinite of a line
    double stiffness; // N/m, dN by depth
    double damping;   // N s/m, dN by closing speed
    double grip;      // 1, g / (mu N)
    Vec2 *centre;     // G, by coordinate: of the parts that the contact couples, like all
    double *arms;     // m, s; 0 without friction
    Vec2 beside;      // m, from the circle's centre to where a flat on body b touches
    int pair;         // of the tree; in a slot that of the wall that is met
    const CouplingJoint *parts;
} SlopesPressing;

// What small changes make of it.
typedef struct SlopesChange {
    Vec2 force;      // N
    double friction; // N, g
} SlopesChange;

// The arm of friction about the centre of the circle on body b, or on body a about that of its own
// circle or the point of its line, m. A slot's end is a hole, its straight walls are lines.
static double friction_arm(const Touch *touch, const TouchPose *pose, bool is_at_line, int side)
{
    const double pin_arm = touch->radius_a - touch->clearance + pose->gap; // of a slot
    switch (touch->shape) {
    case TOUCH_SLOT:
        return side == 1 ? pin_arm : is_at_line ? -pin_arm : -touch->radius_a;
    case TOUCH_HOLE:
        return side == 0 ? -touch->radius_a : touch->radius_a - vec2_length(pose->offset);
    case TOUCH_DISC:
        return side == 0 ? touch->radius_a : vec2_length(pose->offset) - touch->radius_a;
    case TOUCH_LINE:
    case TOUCH_CAM:
    case TOUCH_TURN:
    case TOUCH_TEETH:
    case TOUCH_RACK:
        break;
    }
    return side == 0 ? -touch->radius_b : touch->radius_b;
}

// Arms of friction, and how it grips at a state of the tree.
static void find_friction(const Dynamics *dynamics, const TreeState *state,
                          SlopesPressing *pressing)
{
    const Tree *tree = &dynamics->tree;
    const int pair = pressing->pair;
    const bool is_at_line = tree->measures[pair] == TREE_LINE;
    const TouchPose *pose = &pressing->force.pose;
    double sliding = vec2_dot(vec2_perp(pose->normal), pressing->velocity);
    for (int side = 0; side < 2; side++) {
        const int body = tree->end_bodies[2 * pair + side];
        const double arm = friction_arm(pressing->touch, pose, is_at_line, side);
        if (body != LINKAGE_GROUND) {
            sliding -= arm * state->motions[body].omega;
        }
        if (body != LINKAGE_GROUND && tree->angle_column[body] >= 0) {
            pressing->arms[tree->angle_column[body]] += arm;
        }
    }
    pressing->grip = friction_hold(sliding, pressing->law->friction_speed).held;
}

// Zeroes what is found for each coordinate of some parts.
static void slopes_clear(const Dynamics *dynamics, const CouplingJoint *parts)
{
    const Coupling *coupling = dynamics->system.coupling;
    for (size_t i = 0; i < parts->count; i++) {
        const size_t part = parts->parts[i];
        for (size_t k = coupling->first_coordinate[part]; k < coupling->first_coordinate[part + 1];
             k++) {
            dynamics->room.row[coupling->coordinates[k]] = (Vec2){0.0, 0.0};
            dynamics->room.arms[coupling->coordinates[k]] = 0.0;
        }
    }
}

// At a cam: against the point of body a where the gap is measured.
static void meet_cam(const Tree *tree, const TreeState *state, const PlaneSite *site,
                     const TouchPose *pose, SlopesPressing *pressing)
{
    const CamPose cam = dynamics_cam(tree, state, site);
    const int *bodies = tree->end_bodies + 2 * site->pair;
    const Vec2 from_a = vec2_add(pose->offset, cam.measured);
    const Vec2 turned_b = vec2_scale(tree_omega(state, bodies[1]), vec2_perp(cam.measured));
    const Vec2 turned_a = vec2_scale(tree_omega(state, bodies[0]), vec2_perp(from_a));
    pressing->beside = cam.measured;
    pressing->bend = site->touch.cam.is_flat ? INFINITY : 1.0 / cam.curvature;
    pressing->velocity = vec2_add(pose->velocity, vec2_sub(turned_b, turned_a));
}

// At a line, of which the pair of the tree has the normal: against the point of body a under the
// circle's centre.
static void meet_line(const Tree *tree, const TreeState *state, SlopesPressing *pressing)
{
    const double omega = tree_omega(state, tree->end_bodies[2 * pressing->pair]);
    const Vec2 offset = tree_pair_gap(tree, state, pressing->pair);
    pressing->velocity = vec2_sub(tree_pair_velocity(tree, state, pressing->pair),
                                  vec2_scale(omega, vec2_perp(offset)));
}

// In a slot: at one of its straight walls, or in the hole at one of its ends.
static void meet_slot(const Tree *tree, const TreeState *state, const PlaneSite *site,
                      const Contact *contact, SlopesPressing *pressing)
{
    const ContactWall wall = dynamics_wall(tree, state, site, contact).wall;
    pressing->pair = dynamics_contact_pair(tree, site, wall);
    if (pressing->pair == site->pair) {
        meet_line(tree, state, pressing);
        return;
    }
    pressing->velocity = tree_pair_velocity(tree, state, pressing->pair);
    pressing->bend = -vec2_length(tree_pair_gap(tree, state, pressing->pair));
}

// How each coordinate moves where the gap is measured on body b against body a there.
static void find_row(const Tree *tree, const TreeState *state, SlopesPressing *pressing)
{
    if (pressing->touch->cam.profile == NULL) {
        loops_pair_row(tree, state, pressing->pair, pressing->centre);
        return;
    }
    const int end = 2 * pressing->pair;
    const Vec2 under = vec2_add(tree_pair_gap(tree, state, pressing->pair), pressing->beside);
    tree_point_row(tree, state, tree->end_bodies[end], vec2_add(state->arms[end], under), -1.0,
                   pressing->centre);
    tree_point_row(tree, state, tree->end_bodies[end + 1],
                   vec2_add(state->arms[end + 1], pressing->beside), 1.0, pressing->centre);
}

static SlopesPressing slopes_resolve(const Dynamics *dynamics, const TreeState *state,
                                     const double *y, size_t number)
{
    const Contact *contact = &dynamics->system.contacts[number];
    const PlaneSite *site = &dynamics->sites[number];
    SlopesPressing pressing = {
        .touch = &site->touch,
        .law = &contact->law,
        .bend = INFINITY,
        .centre = dynamics->room.row,
        .arms = dynamics->room.arms,
        .pair = site->pair,
        .parts = &dynamics->system.coupling->joints[contact->joint],
    };
    slopes_clear(dynamics, pressing.parts);
    dynamics_contact_find(dynamics, number, state, y, &pressing.force);
    const TouchPose *pose = &pressing.force.pose;
    pressing.velocity = pose->velocity;
    switch (site->touch.shape) {
    case TOUCH_CAM:
        meet_cam(&dynamics->tree, state, site, pose, &pressing);
        break;
    case TOUCH_LINE:
        meet_line(&dynamics->tree, state, &pressing);
        break;
    case TOUCH_SLOT:
        meet_slot(&dynamics->tree, state, site, contact, &pressing);
        break;
    case TOUCH_DISC:
        pressing.bend = vec2_length(pose->offset);
        break;
    case TOUCH_HOLE:
    case TOUCH_TURN: // slopes_add_turn_slopes has these
    case TOUCH_TEETH:
    case TOUCH_RACK:
        pressing.bend = -vec2_length(pose->offset);
        break;
    }
    pressing.stiffness = press_stiffness(contact, &pressing.force.press);
    pressing.damping = press_damping(contact, &pressing.force.press);
    find_row(&dynamics->tree, state, &pressing);
    if (contact->law.friction > 0.0) {
        find_friction(dynamics, state, &pressing);
    }
    return pressing;
}

// With small changes of e and v, and of the sliding speed by what bodies turn, s du.
static SlopesChange slopes_change_force(const SlopesPressing *pressing, Vec2 moved, Vec2 faster,
                                        double rolled)
{
    const Vec2 normal = pressing->force.pose.normal;
    const Vec2 tangent = vec2_perp(normal);
    const Vec2 velocity = pressing->velocity;
    const double turned = vec2_dot(tangent, moved) / pressing->bend;
    const double deeper = -vec2_dot(normal, moved);
    const double closing = -vec2_dot(normal, faster) - turned * vec2_dot(tangent, velocity);
    const double pressed = pressing->stiffness * deeper + pressing->damping * closing;
    double resisted = 0.0; // N, the friction itself
    double friction = 0.0;
    if (pressing->law->friction > 0.0) {
        const double grip = pressing->grip;
        const double slid =
            vec2_dot(tangent, faster) - turned * vec2_dot(normal, velocity) - rolled;
        const double gripped = (1.0 - grip * grip) * slid / pressing->law->friction_speed;
        resisted = pressing->law->friction * pressing->force.press.normal * grip;
        friction =
            pressing->law->friction * (pressed * grip + pressing->force.press.normal * gripped);
    }
    // n turns towards t, and t away from n
    const double across = pressed + resisted * turned;
    const double along = pressing->force.press.normal * turned - friction;
    return (SlopesChange){vec2_add(vec2_scale(across, normal), vec2_scale(along, tangent)),
                          friction};
}

// Adds to a column of the rows of the parts what the change does to their accelerations.
static void slopes_add_column(const Coupling *coupling, const CouplingJoint *parts,
                              double *const *pushed, SlopesChange change, size_t column,
                              double *values)
{
    for (size_t k = 0; k < parts->count; k++) {
        const size_t part = parts->parts[k];
        const size_t index = coupling_column_index(coupling, part, column);
        for (size_t m = coupling->first_coordinate[part]; m < coupling->first_coordinate[part + 1];
             m++) {
            const size_t i = coupling->coordinates[m];
            values[coupling->first_value[i] + index] += pushed[0][i] * change.force.x +
                                                        pushed[1][i] * change.force.y +
                                                        pushed[2][i] * change.friction;
        }
    }
}

// Solves for what the loads push of some parts.
static void slopes_solve_parts(const Dynamics *dynamics, const CouplingJoint *parts,
                               const Loads *loads, double *pushed)
{
    for (size_t i = 0; i < parts->count; i++) {
        articulated_solve_part(dynamics->articulated, parts->parts[i], loads->pushes, pushed);
    }
}

// The accelerations that unit forces cause: on the circle's centre on body b along x and along y
// and the other way on body a, and by friction's arms.
static void slopes_find_pushed(const Dynamics *dynamics, const TreeState *state,
                               const SlopesPressing *pressing)
{
    const Tree *tree = &dynamics->tree;
    const DynamicsRoom *room = &dynamics->room;
    Loads loads = {.pushes = room->zeros};
    const int end = 2 * pressing->pair;
    // a line is pushed at its point under the circle's centre
    const Vec2 none = {0.0, 0.0};
    const Vec2 at = pressing->beside;
    const bool is_line = tree->measures[pressing->pair] == TREE_LINE;
    const Vec2 under = is_line ? vec2_add(tree_pair_gap(tree, state, pressing->pair), at) : none;
    const bool has_friction = pressing->law->friction > 0.0;
    // without friction what its arms push stays zero
    for (int way = 0; way < (has_friction ? DYNAMICS_PUSHED : 2); way++) {
        const Vec2 force = {way == 0 ? 1.0 : 0.0, way == 1 ? 1.0 : 0.0};
        if (way < 2) {
            dynamics_load_end(tree, state, end + 1, at, force, &loads);
            dynamics_load_end(tree, state, end, under, vec2_scale(-1.0, force), &loads);
        } else {
            for (int side = 0; side < 2; side++) {
                const double arm =
                    friction_arm(pressing->touch, &pressing->force.pose, is_line, side);
                dynamics_load_couple(tree, state, tree->end_bodies[end + side], arm, &loads);
            }
        }
        slopes_solve_parts(dynamics, pressing->parts, &loads, room->pushed[way]);
        for (int side = 0; side < 2; side++) {
            const int body = tree->end_bodies[end + side];
            if (body != LINKAGE_GROUND) {
                loads.pushes[body] = (ArticulatedPush){none, 0.0};
            }
        }
    }
}

// What the coordinate does to a contact.
static void slopes_add_columns(const Dynamics *dynamics, const SlopesPressing *pressing,
                               size_t coordinate, double *by_position, double *by_rate)
{
    static const Vec2 NONE = {0.0, 0.0};
    const Coupling *coupling = dynamics->system.coupling;
    double *const *pushed = dynamics->room.pushed;
    const Vec2 centre = pressing->centre[coordinate];
    const double arm = pressing->arms[coordinate];
    const bool moves = centre.x != 0.0 || centre.y != 0.0;
    if (moves) {
        slopes_add_column(coupling, pressing->parts, pushed,
                          slopes_change_force(pressing, centre, NONE, 0.0), coordinate,
                          by_position);
    }
    if (moves || arm != 0.0) {
        slopes_add_column(coupling, pressing->parts, pushed,
                          slopes_change_force(pressing, NONE, centre, arm), coordinate, by_rate);
    }
}

static void slopes_add_slopes(const Dynamics *dynamics, const SlopesPressing *pressing,
                              double *by_position, double *by_rate)
{
    const Coupling *coupling = dynamics->system.coupling;
    for (size_t i = 0; i < pressing->parts->count; i++) {
        const size_t part = pressing->parts->parts[i];
        for (size_t k = coupling->first_coordinate[part]; k < coupling->first_coordinate[part + 1];
             k++) {
            slopes_add_columns(dynamics, pressing, coupling->coordinates[k], by_position, by_rate);
        }
    }
}

// A coordinate that turns a body, its share in what presses, and what that changes with.
typedef struct TurnColumn {
    size_t column;
    double share;
    double stiffness;
    double damping;
} TurnColumn;

static void slopes_add_turn_column(const Dynamics *dynamics, const CouplingJoint *parts,
                                   const TurnColumn *of, double *by_position, double *by_rate)
{
    const Coupling *coupling = dynamics->system.coupling;
    for (size_t k = 0; k < parts->count; k++) {
        const size_t part = parts->parts[k];
        const size_t index = coupling_column_index(coupling, part, of->column);
        for (size_t m = coupling->first_coordinate[part]; m < coupling->first_coordinate[part + 1];
             m++) {
            const size_t i = coupling->coordinates[m];
            const double share = of->share * dynamics->room.pushed[0][i];
            by_position[coupling->first_value[i] + index] -= share * of->stiffness;
            by_rate[coupling->first_value[i] + index] -= share * of->damping;
        }
    }
}

// What the way along the push of teeth adds to the loads of a unit force along it, and to how each
// coordinate moves its own: by the turns of bodies alone until then. A rack is pushed at its point
// under the pinion's centre, a gear at its own centre.
static void slopes_add_way(const Dynamics *dynamics, const TreeState *state, int joint, Vec2 along,
                           const CouplingJoint *parts, Loads *loads)
{
    const Tree *tree = &dynamics->tree;
    const Coupling *coupling = dynamics->system.coupling;
    const Vec2 under =
        tree->measures[joint] == TREE_LINE ? tree_pair_gap(tree, state, joint) : (Vec2){0.0, 0.0};
    dynamics_load_end(tree, state, 2 * joint + 1, (Vec2){0.0, 0.0}, along, loads);
    dynamics_load_end(tree, state, 2 * joint, under, vec2_scale(-1.0, along), loads);
    loops_pair_row(tree, state, joint, dynamics->room.row);
    for (size_t i = 0; i < parts->count; i++) {
        const size_t part = parts->parts[i];
        for (size_t k = coupling->first_coordinate[part]; k < coupling->first_coordinate[part + 1];
             k++) {
            const size_t column = coupling->coordinates[k];
            dynamics->room.arms[column] += vec2_dot(along, dynamics->room.row[column]);
        }
    }
}

// The same of a contact at an end of an angle or of teeth.
static void slopes_add_turn_slopes(const Dynamics *dynamics, const TreeState *state,
                                   const double *y, size_t number, double *by_position,
                                   double *by_rate)
{
    const Tree *tree = &dynamics->tree;
    const Contact *contact = &dynamics->system.contacts[number];
    const Coupling *coupling = dynamics->system.coupling;
    const CouplingJoint *coupled = &coupling->joints[contact->joint];
    TreeCoordinatePart parts[TREE_COORDINATE_PARTS];
    ContactForce force;
    Loads loads = {.pushes = dynamics->room.zeros};
    dynamics_contact_find(dynamics, number, state, y, &force);
    const Joint *joint = &tree->linkage->joints[contact->joint];
    tree_coordinate_parts(joint, parts);
    if (joint_has_mesh(joint->kind)) {
        const MeshFlank flank = dynamics_flank(tree, state, &dynamics->sites[number]);
        parts[0].share = -flank.arms[0];
        parts[1].share = -flank.arms[1];
    }
    slopes_clear(dynamics, coupled);
    for (int i = 0; i < TREE_COORDINATE_PARTS; i++) {
        const int body = parts[i].body;
        dynamics_load_couple(tree, state, body, parts[i].share, &loads);
        if (body != LINKAGE_GROUND && tree->angle_column[body] >= 0) {
            dynamics->room.arms[tree->angle_column[body]] += parts[i].share;
        }
    }
    if (joint_has_teeth(joint->kind)) {
        const double sign = dynamics->sites[number].touch.sign;
        slopes_add_way(dynamics, state, contact->joint, vec2_scale(sign, force.pose.normal),
                       coupled, &loads);
    }
    slopes_solve_parts(dynamics, coupled, &loads, dynamics->room.pushed[0]);
    const double stiffness = press_stiffness(contact, &force.press);
    const double damping = press_damping(contact, &force.press);
    for (int part = 0; part < TREE_COORDINATE_PARTS; part++) {
        if (parts[part].body != LINKAGE_GROUND) {
            loads.pushes[parts[part].body] = (ArticulatedPush){{0.0, 0.0}, 0.0};
        }
    }
    for (size_t i = 0; i < coupled->count; i++) {
        const size_t part = coupled->parts[i];
        for (size_t k = coupling->first_coordinate[part]; k < coupling->first_coordinate[part + 1];
             k++) {
            const size_t column = coupling->coordinates[k];
            const TurnColumn of = {column, dynamics->room.arms[column], stiffness, damping};
            if (of.share != 0.0) {
                slopes_add_turn_column(dynamics, coupled, &of, by_position, by_rate);
            }
        }
    }
}

void dynamics_slopes(double since_s, const double *y, double *by_position, double *by_rate,
                     void *context)
{
    const Dynamics *dynamics = context;
    const Tree *tree = &dynamics->tree;
    const size_t n = tree->coordinate_count;
    TreeState *state = &dynamics->room.state->tree;
    tree_evaluate(tree, since_s, y, y + n, state);
    const double start = articulated_factor(dynamics->articulated, state) ? 0.0 : NAN;
    for (size_t i = 0; i < coupling_value_count(dynamics->system.coupling); i++) {
        by_position[i] = by_rate[i] = start;
    }
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        if (dynamics->system.contacts[i].mode != CONTACT_PRESSING) {
            continue;
        }
        if (dynamics_contact_is_turn(&dynamics->sites[i])) {
            slopes_add_turn_slopes(dynamics, state, y, i, by_position, by_rate);
        } else {
            const SlopesPressing pressing = slopes_resolve(dynamics, state, y, i);
            slopes_find_pushed(dynamics, state, &pressing);
            slopes_add_slopes(dynamics, &pressing, by_position, by_rate);
        }
    }
}
