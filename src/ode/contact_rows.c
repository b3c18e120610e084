// What does a touching pin become inside ODE, and which force came of it?
//
// ODE's contact row, F >= 0, d penetration, v_out the separating speed after the step:
//     v_out + CFM F = (ERP / h) d
// IMPACT: (ERP, CFM) from the secant stiffness k and damping c of the force law at d, by the map
// chosen, anew each step; where omega h is beyond the map's limit, with omega^2 = (dF/dd) / m and m
// the linkage's effective mass along the normal, by the textbook's, and counted. POISSON: CFM = 1 /
// p and bounce e, the paper's Eq. (2) F = p dg/dt.
#include "ode/contact_rows.h"

#include "contact/law.h"
#include "contact/penalty.h"
#include "contact/pin_hole.h"

#include <string.h>

bool contact_rows_init(ContactRows *rows, const Scenario *scenario, World *world, bool is_staggered,
                       Err *err)
{
    memset(rows, 0, sizeof *rows);
    rows->scenario = scenario;
    rows->world = world;
    rows->is_staggered = is_staggered;
    if (scenario->contact.model == CONTACT_IMPACT && world->pair_count > 0) {
        rows->map = map_get(scenario->ode.map);
    }
    if (!response_init(&scenario->linkage, false, &rows->response, err)) {
        return false;
    }
    rows->penalty = scenario->contact.penalty > 0.0
                        ? scenario->contact.penalty
                        : penalty_estimate(scenario->linkage.driver.speed, &scenario->material);
    for (size_t i = 0; i < world->pair_count; i++) {
        const Joint *joint = &scenario->linkage.joints[world->pairs[i].joint];
        rows->rows[i].radial_clearance = linkage_radial_clearance(joint);
        if (!law_of_joint(scenario, joint, &rows->rows[i].law, err)) {
            return false;
        }
    }
    rows->group = dJointGroupCreate(0);
    return true;
}

void contact_rows_finish(ContactRows *rows)
{
    if (rows->group != NULL) {
        dJointGroupDestroy(rows->group);
    }
    memset(rows, 0, sizeof *rows);
}

// Centre of a geom and the velocity of its body there.
static void geom_centre(dGeomID geom, Vec2 *centre, Vec2 *velocity)
{
    const dReal *position = dGeomGetPosition(geom);
    const dBodyID body = dGeomGetBody(geom);
    *centre = (Vec2){position[0], position[1]};
    *velocity = (Vec2){0.0, 0.0};
    if (body != NULL) {
        const dReal *at = dBodyGetPosition(body);
        const dReal *speed = dBodyGetLinearVel(body);
        const double omega = dBodyGetAngularVel(body)[2];
        *velocity = (Vec2){speed[0] - omega * (position[1] - at[1]),
                           speed[1] + omega * (position[0] - at[0])};
    }
}

static PinHole pair_pose(const WorldPair *pair, double radial_clearance)
{
    Vec2 hole;
    Vec2 pin;
    Vec2 hole_velocity;
    Vec2 pin_velocity;
    geom_centre(pair->hole, &hole, &hole_velocity);
    geom_centre(pair->pin, &pin, &pin_velocity);
    return pin_hole_pose(hole, pin, vec2_sub(pin_velocity, hole_velocity), radial_clearance);
}

static dSurfaceParameters surface_of(const ContactRows *rows, ContactRow *row, double step_s)
{
    const ContactOptions *options = &rows->scenario->contact;
    // without friction mu 0 makes one row, along the normal; with it a second one, along the wall
    dSurfaceParameters surface = {.mode = dContactSoftERP | dContactSoftCFM, .mu = 0.0};
    if (options->friction > 0.0) {
        surface.mode |= dContactMu2 | dContactFDir1 | dContactApprox1;
        surface.mu = options->friction;
        surface.mu2 = 0.0;
    }
    if (options->model == CONTACT_POISSON) {
        surface.mode |= dContactBounce;
        surface.bounce = options->restitution;
        surface.bounce_vel = options->bounce_speed;
        surface.soft_erp = rows->scenario->ode.push_out;
        surface.soft_cfm = map_poisson_cfm(rows->penalty);
        return surface;
    }
    const double stiffness = force_law_secant(&row->law, row->depth);
    row->damping = force_law_damping(&row->law, row->depth, row->impact_speed);
    const MapContact contact = {
        .stiffness = stiffness,
        .damping = row->damping,
        .step = step_s,
        .mass = row->mass,
        .depth = row->depth,
        .closing = row->closing,
    };
    const Map *map = row->falls_back ? map_get(ODE_MAP_TEXTBOOK) : rows->map;
    const ErpCfm soft = map->convert(&contact);
    surface.soft_erp = soft.erp;
    surface.soft_cfm = soft.cfm;
    return surface;
}

static void make_row(ContactRows *rows, size_t number, const dContactGeom *geom, double step_s)
{
    ContactRow *row = &rows->rows[number];
    const dContact contact = {
        .surface = surface_of(rows, row, step_s),
        .geom = *geom,
        .fdir1 = {-row->normal.y, row->normal.x, 0.0, 0.0},
    };
    const dJointID joint = dJointCreateContact(rows->world->id, rows->group, &contact);
    const WorldPair *pair = &rows->world->pairs[number];
    dJointAttach(joint, dGeomGetBody(pair->hole), dGeomGetBody(pair->pin));
    dJointSetFeedback(joint, &row->feedback);
}

static bool check_depth(const ContactRows *rows, size_t number, Err *err)
{
    const ContactRow *row = &rows->rows[number];
    const Joint *joint = &rows->scenario->linkage.joints[rows->world->pairs[number].joint];
    // deeper than any law: the step was too coarse to catch the wall
    return law_check_depth(&row->law, joint, row->depth, 1.0, err);
}

// The effective mass along the normal of a row. It changes as slowly as the linkage turns.
static void find_mass(ContactRows *rows, size_t number)
{
    static const double SAME_NORMAL = 0.995; // the cosine of 6 degrees
    ContactRow *row = &rows->rows[number];
    const bool is_known = vec2_dot(row->mass_normal, row->normal) > SAME_NORMAL;
    if (is_known && !rows->map->needs_mass) {
        return;
    }
    Motion motions[LINKAGE_BODY_MAX];
    world_motions(rows->world, motions);
    if (response_place(&rows->response, motions)) {
        row->mass = response_mass(&rows->response, 2 * number, row->normal);
        row->mass_normal = row->normal;
    }
}

// Whether the row would not be stable under the map at this step.
static void check_stability(ContactRows *rows, size_t number, double step_s)
{
    ContactRow *row = &rows->rows[number];
    row->falls_back = false;
    if (rows->map == NULL || isinf(rows->map->stability_limit)) {
        return;
    }
    find_mass(rows, number);
    const double frequency = sqrt(force_law_tangent(&row->law, row->depth) / row->mass);
    row->falls_back = !(frequency * step_s < rows->map->stability_limit);
    rows->fallback_count += row->falls_back ? 1 : 0;
}

// The speed at which a pin that overlaps its wall for the first time came to it, m/s: as found now,
// or, where the steps before show it, its mean over the last step, taken on to the crossing by its
// change from step to step.
static double onset_speed(const ContactRows *rows, const ContactRow *row, const PinHole *pose,
                          double step_s)
{
    if (!rows->is_staggered || row->gaps_known == 0) {
        return pose->approach_speed;
    }
    const double mean = (row->gaps[0] - pose->gap) / step_s;
    if (row->gaps_known == 1 || !(mean > 0.0)) {
        return mean;
    }
    const double change = mean - (row->gaps[1] - row->gaps[0]) / step_s;
    // the mean stands in the middle of the last step
    return mean + change * (0.5 - pose->penetration / (mean * step_s));
}

// Keeps the gaps that a pin had while nothing acted on it.
static void note_gap(ContactRow *row, double gap)
{
    row->gaps_known = row->is_touching ? 0 : row->gaps_known + (row->gaps_known < 2 ? 1 : 0);
    row->gaps[1] = row->gaps[0];
    row->gaps[0] = gap;
}

bool contact_rows_make(ContactRows *rows, double step_s, JointState *states, double *approach,
                       Err *err)
{
    size_t row_count = 0;
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const WorldPair *pair = &rows->world->pairs[i];
        ContactRow *row = &rows->rows[i];
        dContactGeom geom;
        const bool was_touching = row->is_touching;
        row->is_touching = dCollide(pair->hole, pair->pin, 1, &geom, sizeof geom) > 0;
        const PinHole pose = pair_pose(pair, row->radial_clearance);
        states[pair->joint] = (JointState){
            .eccentricity = pose.eccentricity,
            .gap = pose.gap,
            .is_touching = row->is_touching,
        };
        if (!row->is_touching) {
            row->impact_speed = pose.approach_speed;
        } else if (!was_touching) {
            row->impact_speed = onset_speed(rows, row, &pose, step_s);
        }
        approach[pair->joint] = row->impact_speed;
        note_gap(row, pose.gap);
        if (!row->is_touching) {
            continue;
        }
        row->depth = geom.depth;
        row->normal = pose.normal;
        row->closing = pose.approach_speed;
        if (!check_depth(rows, i, err)) {
            return false;
        }
        check_stability(rows, i, step_s);
        make_row(rows, i, &geom, step_s);
        rows->row_count++;
        row_count += rows->scenario->contact.friction > 0.0 ? 2 : 1;
    }
    rows->most_rows = row_count > rows->most_rows ? row_count : rows->most_rows;
    return true;
}

// Work of the friction on the two bodies in the step, at the wall's point that the pin touched.
static double friction_work(const ContactRows *rows, size_t number, Vec2 force, double step_s)
{
    const ContactRow *row = &rows->rows[number];
    const WorldPair *pair = &rows->world->pairs[number];
    const Joint *joint = &rows->scenario->linkage.joints[pair->joint];
    const Vec2 tangent = vec2_perp(row->normal);
    const Vec2 outward = vec2_scale(-joint->clearance.hole_radius, row->normal);
    double sliding = 0.0;
    const dGeomID geoms[2] = {pair->hole, pair->pin};
    for (int i = 0; i < 2; i++) {
        Vec2 centre;
        Vec2 velocity;
        geom_centre(geoms[i], &centre, &velocity);
        const dBodyID body = dGeomGetBody(geoms[i]);
        const double omega = body != NULL ? dBodyGetAngularVel(body)[2] : 0.0;
        const Vec2 there = vec2_add(velocity, vec2_scale(omega, vec2_perp(outward)));
        sliding += (i == 0 ? -1.0 : 1.0) * vec2_dot(tangent, there);
    }
    return vec2_dot(tangent, force) * sliding * step_s;
}

// What a contact lost and stored in the step, by its law: the damper at the speed after the step,
// the spring at the depth after it. What the step itself gains or loses beyond that is ODE's error
// and stays in the residual. The velocity-level model has no spring: all its work is lost.
static void book_energy(ContactRows *rows, size_t number, Vec2 force, double step_s)
{
    ContactRow *row = &rows->rows[number];
    row->elastic = 0.0;
    row->dissipated = 0.0;
    row->friction = 0.0;
    if (!row->is_touching) {
        return;
    }
    const PinHole pose = pair_pose(&rows->world->pairs[number], row->radial_clearance);
    const double pressing = vec2_dot(row->normal, force);
    // of a staggered world the step stands in the middle between its two speeds, and its end
    // between two positions
    const double closing =
        rows->is_staggered ? 0.5 * (row->closing + pose.approach_speed) : pose.approach_speed;
    const double depth =
        rows->is_staggered ? 0.5 * (row->depth + pose.penetration) : pose.penetration;
    if (rows->scenario->contact.model == CONTACT_POISSON) {
        row->dissipated = pressing * 0.5 * (row->closing + pose.approach_speed) * step_s;
    } else {
        row->dissipated = pressing > 0.0 ? row->damping * closing * closing * step_s : 0.0;
        row->elastic = force_law_energy(&row->law, fmax(0.0, depth));
    }
    if (rows->scenario->contact.friction > 0.0) {
        row->friction = -friction_work(rows, number, force, step_s);
    }
}

void contact_rows_clear(ContactRows *rows, double step_s, JointState *states)
{
    bool any = false;
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const ContactRow *row = &rows->rows[i];
        JointState *state = &states[rows->world->pairs[i].joint];
        if (row->is_touching) {
            // ODE gives the force on the first body attached: the hole's, if it is no ground
            const double sign = dGeomGetBody(rows->world->pairs[i].hole) != NULL ? -1.0 : 1.0;
            state->force_on_b = (Vec2){sign * row->feedback.f1[0], sign * row->feedback.f1[1]};
            state->force = vec2_length(state->force_on_b);
            any = true;
        }
        book_energy(rows, i, state->force_on_b, step_s);
    }
    if (any) {
        dJointGroupEmpty(rows->group);
    }
}

void contact_rows_offsets(const ContactRows *rows, int body, Vec2 offsets[LINKAGE_JOINT_MAX])
{
    memset(offsets, 0, LINKAGE_JOINT_MAX * sizeof *offsets);
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const ContactRow *row = &rows->rows[i];
        const int number = rows->world->pairs[i].joint;
        const Joint *joint = &rows->scenario->linkage.joints[number];
        if (row->is_touching) {
            const double radius =
                joint->body_a == body ? joint->clearance.hole_radius : joint->clearance.pin_radius;
            offsets[number] = vec2_scale(-radius, row->normal);
        }
    }
}

ContactEnergy contact_rows_energy(const ContactRows *rows)
{
    ContactEnergy sum = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        sum.dissipated += rows->rows[i].dissipated;
        sum.friction += rows->rows[i].friction;
        sum.elastic += rows->rows[i].elastic;
    }
    return sum;
}
