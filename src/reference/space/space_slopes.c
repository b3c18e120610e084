// Differentiates the accelerations by coordinates and rates where pins in space press.
//
//     dA = M^-1 (G_P' df_n + G_W' df_t),   de = G_P dq across the pin,  dw = G_P du,  ds = G_W du
// G_P, G_W: how the pin's point moves against the hole's by each coordinate, where the normal force
// acts and where friction does; M the mass matrix with the loops' rows; s the sliding velocity. Of
// the force on the pin, n = e / |e| outwards,
//     f_n = -N n,   f_t = -mu N h s,   h = tanh(|s| / v_s) / |s|
// with  dn = (de - n dd) / |e|,  dd = n de,  dN = (1 + chi d'/v0) k dd + (chi F_el / v0 + c) dd',
// dd' = n dw + dn w,  dh = ((1 - tanh^2) / v_s - h) / |s| d|s|,
// and s stays across n.
#include "reference/space/space_dynamics.h"

#include "base/zeroed.h"
#include "kernel/friction_law.h"

#include <math.h>
#include <string.h>

// A pressing site and what its force changes with.
typedef struct SpaceSlopesPressing {
    const Contact *contact;
    const SpaceForce *force;
    double stiffness;   // N/m, dN by depth
    double damping;     // N s/m, dN by closing speed
    Vec3 sliding;       // m/s, s
    double share;       // s/m, h
    double share_slope; // s^2/m^2, dh by |s|
    Vec3 *centre;       // G_P, by coordinate: of the parts that the contact couples, like all
    Vec3 *wall;         // G_W
    const CouplingJoint *parts;
} SpaceSlopesPressing;

static void find_points(const SpaceDynamics *dynamics, const SpaceTreeState *state,
                        const PinSpace *site, Vec3 arm_a, Vec3 arm_b, Vec3 *row)
{
    const Coupling *coupling = dynamics->system.coupling;
    const CouplingJoint *parts = &coupling->joints[site->joint];
    for (size_t i = 0; i < parts->count; i++) {
        const size_t part = parts->parts[i];
        for (size_t k = coupling->first_coordinate[part]; k < coupling->first_coordinate[part + 1];
             k++) {
            row[coupling->coordinates[k]] = (Vec3){0.0, 0.0, 0.0};
        }
    }
    space_tree_point_row(&dynamics->tree, state, site->hole.body, arm_a, -1.0, row);
    space_tree_point_row(&dynamics->tree, state, site->pin.body, arm_b, 1.0, row);
}

static void space_slopes_resolve(const SpaceDynamics *dynamics, const SpaceState *state,
                                 size_t number, SpaceSlopesPressing *pressing)
{
    const PinSpace *site = &dynamics->contacts[number].site;
    const SpaceForce *force = &state->forces[number];
    const Contact *contact = &dynamics->system.contacts[number];
    pressing->contact = contact;
    pressing->force = force;
    pressing->stiffness = press_stiffness(contact, &force->press);
    pressing->damping = press_damping(contact, &force->press);
    pressing->parts = &dynamics->system.coupling->joints[site->joint];
    find_points(dynamics, &state->tree, site, force->from_a, force->from_b, pressing->centre);
    find_points(dynamics, &state->tree, site, force->force_a, force->force_b, pressing->wall);
    pressing->share = pressing->share_slope = 0.0;
    if (pressing->contact->law.friction > 0.0 && !contact->is_collar) {
        pressing->sliding = vec3_across(
            vec3_sub(space_tree_velocity(&state->tree, site->pin.body, force->force_b),
                     space_tree_velocity(&state->tree, site->hole.body, force->force_a)),
            force->outward);
        const double speed = vec3_length(pressing->sliding);
        const FrictionGrip grip = friction_grip(speed, contact->law.friction_speed);
        pressing->share = grip.share;
        pressing->share_slope = grip.bend * speed;
    }
}

// What small changes make of the force on the pin: across its wall, and in friction.
typedef struct SpaceSlopesChange {
    Vec3 normal;
    Vec3 friction;
} SpaceSlopesChange;

// By a move of the pin's point, a change of its velocity and one of the sliding velocity.
static SpaceSlopesChange space_slopes_change_force(const SpaceSlopesPressing *pressing, Vec3 moved,
                                                   Vec3 faster, Vec3 slid)
{
    const SpaceForce *force = pressing->force;
    const Vec3 outward = force->outward;
    const Vec3 none = {0.0, 0.0, 0.0};
    const Vec3 aside = vec3_across(vec3_across(moved, force->axis), outward);
    const Vec3 turned = pressing->contact->is_collar ? none : vec3_scale(1.0 / force->size, aside);
    const double closing = vec3_dot(outward, faster) + vec3_dot(turned, force->relative);
    const double pressed =
        pressing->stiffness * vec3_dot(outward, moved) + pressing->damping * closing;
    const double normal = force->press.normal;
    SpaceSlopesChange change = {
        .normal = vec3_sub(vec3_scale(-pressed, outward), vec3_scale(normal, turned)),
    };
    if (pressing->share > 0.0) {
        const double friction = pressing->contact->law.friction;
        // the wall turns: so does what slides along it
        const Vec3 swung = vec3_add(vec3_scale(force->press.closing, turned),
                                    vec3_scale(vec3_dot(pressing->sliding, turned), outward));
        const Vec3 across = vec3_sub(vec3_across(slid, outward), swung);
        const double speed = vec3_length(pressing->sliding);
        const double quicker = speed > 0.0 ? vec3_dot(pressing->sliding, across) / speed : 0.0;
        const double held = pressed * pressing->share + normal * pressing->share_slope * quicker;
        change.friction =
            vec3_scale(-friction, vec3_add(vec3_scale(held, pressing->sliding),
                                           vec3_scale(normal * pressing->share, across)));
    }
    return change;
}

// Accelerations by a force on the pin along x, y and z: at the points of the normal force, then at
// those of friction. Each is a vector of all equations.
enum { PUSHES = 6 };

typedef struct Pushed {
    size_t count; // 3 without friction
    double *by[PUSHES];
} Pushed;

// Adds to a column of the rows of the parts what the change does to their accelerations.
static void space_slopes_add_column(const Coupling *coupling, const CouplingJoint *parts,
                                    const Pushed *pushed, SpaceSlopesChange change, size_t column,
                                    double *values)
{
    const double forces[PUSHES] = {change.normal.x,   change.normal.y,   change.normal.z,
                                   change.friction.x, change.friction.y, change.friction.z};
    for (size_t p = 0; p < parts->count; p++) {
        const size_t part = parts->parts[p];
        const size_t index = coupling_column_index(coupling, part, column);
        for (size_t m = coupling->first_coordinate[part]; m < coupling->first_coordinate[part + 1];
             m++) {
            const size_t i = coupling->coordinates[m];
            for (size_t k = 0; k < pushed->count; k++) {
                values[coupling->first_value[i] + index] += pushed->by[k][i] * forces[k];
            }
        }
    }
}

// Solves for what bodies of some parts are pushed by.
static void space_slopes_solve_parts(const SpaceDynamics *dynamics, const CouplingJoint *parts,
                                     const SpaceState *state, double *pushed)
{
    for (size_t i = 0; i < parts->count; i++) {
        space_articulated_solve_part(dynamics->loops->articulated, parts->parts[i], &state->tree,
                                     dynamics->pushes, pushed);
    }
}

static void set_push(const SpaceDynamics *dynamics, int body, Vec3 arm, Vec3 force)
{
    if (body != LINKAGE_GROUND) {
        dynamics->pushes[body] = (SpacePush){force, vec3_cross(arm, force)};
    }
}

static void space_slopes_find_pushed(const SpaceDynamics *dynamics, const SpaceState *state,
                                     size_t number, const SpaceSlopesPressing *pressing,
                                     Pushed *pushed)
{
    static const Vec3 AXES[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    static const Vec3 NONE = {0.0, 0.0, 0.0};
    const PinSpace *site = &dynamics->contacts[number].site;
    const SpaceForce *force = pressing->force;
    pushed->count = pressing->share > 0.0 ? PUSHES : 3;
    for (size_t k = 0; k < pushed->count; k++) {
        const Vec3 along = AXES[k % 3];
        set_push(dynamics, site->pin.body, k < 3 ? force->from_b : force->force_b, along);
        set_push(dynamics, site->hole.body, k < 3 ? force->from_a : force->force_a,
                 vec3_scale(-1.0, along));
        space_slopes_solve_parts(dynamics, pressing->parts, state, pushed->by[k]);
    }
    set_push(dynamics, site->pin.body, NONE, NONE);
    set_push(dynamics, site->hole.body, NONE, NONE);
}

// What a coordinate does to a contact.
static void space_slopes_add_columns(const Coupling *coupling, const SpaceSlopesPressing *pressing,
                                     const Pushed *pushed, size_t coordinate, double *by_position,
                                     double *by_rate)
{
    static const Vec3 NONE = {0.0, 0.0, 0.0};
    const Vec3 centre = pressing->centre[coordinate];
    const Vec3 wall = pressing->wall[coordinate];
    if (vec3_dot(centre, centre) + vec3_dot(wall, wall) > 0.0) {
        space_slopes_add_column(coupling, pressing->parts, pushed,
                                space_slopes_change_force(pressing, centre, NONE, NONE), coordinate,
                                by_position);
        space_slopes_add_column(coupling, pressing->parts, pushed,
                                space_slopes_change_force(pressing, NONE, centre, wall), coordinate,
                                by_rate);
    }
}

static void space_slopes_add_slopes(const SpaceDynamics *dynamics,
                                    const SpaceSlopesPressing *pressing, const Pushed *pushed,
                                    double *by_position, double *by_rate)
{
    const Coupling *coupling = dynamics->system.coupling;
    for (size_t i = 0; i < pressing->parts->count; i++) {
        const size_t part = pressing->parts->parts[i];
        for (size_t k = coupling->first_coordinate[part]; k < coupling->first_coordinate[part + 1];
             k++) {
            space_slopes_add_columns(coupling, pressing, pushed, coupling->coordinates[k],
                                     by_position, by_rate);
        }
    }
}

// What an end of a limited angle depends on, and pushes.
typedef struct TurnColumns {
    const CouplingJoint *parts;
    const double *row;    // by coordinate: how its rate changes the angle's
    const double *pushed; // by coordinate: what a torque accelerates
    double stiffness;
    double damping;
} TurnColumns;

static void space_slopes_add_turn_column(const Coupling *coupling, const TurnColumns *of,
                                         size_t column, double *by_position, double *by_rate)
{
    const double moved = of->row[column];
    for (size_t p = 0; moved != 0.0 && p < of->parts->count; p++) {
        const size_t part = of->parts->parts[p];
        const size_t index = coupling_column_index(coupling, part, column);
        for (size_t m = coupling->first_coordinate[part]; m < coupling->first_coordinate[part + 1];
             m++) {
            const size_t i = coupling->coordinates[m];
            const size_t value = coupling->first_value[i] + index;
            by_position[value] -= of->stiffness * moved * of->pushed[i];
            by_rate[value] -= of->damping * moved * of->pushed[i];
        }
    }
}

// The same of an end of a limited angle: its torque pushes along the row of the angle.
static void space_slopes_add_turn_slopes(const SpaceDynamics *dynamics, const SpaceState *state,
                                         size_t number, double *row, double *pushed,
                                         double *by_position, double *by_rate)
{
    const SpaceTree *tree = &dynamics->tree;
    const Coupling *coupling = dynamics->system.coupling;
    const SpaceContact *at = &dynamics->contacts[number];
    const Contact *contact = &dynamics->system.contacts[number];
    const Press *press = &state->forces[number].press;
    const Vec3 axis = space_tree_axis(tree, &state->tree, 2 * at->site.joint);
    const int bodies[2] = {at->site.hole.body, at->site.pin.body};
    const CouplingJoint *parts = &coupling->joints[at->site.joint];
    for (size_t i = 0; i < parts->count; i++) {
        const size_t part = parts->parts[i];
        for (size_t k = coupling->first_coordinate[part]; k < coupling->first_coordinate[part + 1];
             k++) {
            row[coupling->coordinates[k]] = 0.0;
        }
    }
    for (int side = 0; side < 2; side++) {
        const Vec3 along = vec3_scale(side == 0 ? -1.0 : 1.0, axis);
        space_tree_turn_row(tree, &state->tree, bodies[side], along, row);
        if (bodies[side] != LINKAGE_GROUND) {
            dynamics->pushes[bodies[side]].moment = along;
        }
    }
    space_slopes_solve_parts(dynamics, parts, state, pushed);
    const double stiffness = press_stiffness(contact, press);
    const double damping = press_damping(contact, press);
    const TurnColumns of = {parts, row, pushed, stiffness, damping};
    for (size_t i = 0; i < parts->count; i++) {
        const size_t part = parts->parts[i];
        for (size_t k = coupling->first_coordinate[part]; k < coupling->first_coordinate[part + 1];
             k++) {
            space_slopes_add_turn_column(coupling, &of, coupling->coordinates[k], by_position,
                                         by_rate);
        }
    }
    for (int side = 0; side < 2; side++) {
        if (bodies[side] != LINKAGE_GROUND) {
            dynamics->pushes[bodies[side]].moment = (Vec3){0.0, 0.0, 0.0};
        }
    }
}

void space_slopes(double since_s, const double *y, double *by_position, double *by_rate,
                  void *context)
{
    const SpaceDynamics *dynamics = context;
    const size_t n = dynamics->tree.coordinate_count;
    const size_t width = n + SPACE_JOINT_ROWS * dynamics->loops->count;
    SpaceState *state = dynamics->scratch;
    Pushed pushed = {.count = 0};
    double *room = zeroed(PUSHES * width, sizeof *room);
    Vec3 *points = zeroed(2 * n, sizeof *points);
    SpaceSlopesPressing pressing = {.centre = points, .wall = points + n};
    for (size_t i = 0; i < PUSHES; i++) {
        pushed.by[i] = room + i * width;
    }
    const double start = space_dynamics_factor(dynamics, since_s, y, state) ? 0.0 : NAN;
    for (size_t i = 0; i < coupling_value_count(dynamics->system.coupling); i++) {
        by_position[i] = by_rate[i] = start;
    }
    memset(dynamics->pushes, 0, dynamics->tree.linkage->body_count * sizeof *dynamics->pushes);
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        if (dynamics->system.contacts[i].mode != CONTACT_PRESSING) {
            continue;
        }
        if (dynamics->contacts[i].is_turn) {
            space_slopes_add_turn_slopes(dynamics, state, i, pushed.by[1], pushed.by[0],
                                         by_position, by_rate);
        } else {
            space_slopes_resolve(dynamics, state, i, &pressing);
            space_slopes_find_pushed(dynamics, state, i, &pressing, &pushed);
            space_slopes_add_slopes(dynamics, &pressing, &pushed, by_position, by_rate);
        }
    }
    free(points);
    free(room);
}
