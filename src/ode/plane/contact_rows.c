// Looks for the contacts of the joints with play before each step, makes a row of ODE of each, and
// reads the forces that came of them.
//
// ODE's contact row, F >= 0, d penetration, v_out the separating speed after the step:
//     v_out + CFM F = (ERP / h) d
// IMPACT: (ERP, CFM) from the secant stiffness k and damping c of the force law at d, by the map
// chosen, anew each step; where omega h is beyond the map's limit, with omega^2 = (dF/dd) / m and m
// the linkage's effective mass along the normal (contact_mass_find), by the textbook's, and
// counted. POISSON: CFM = 1 / p and bounce e, the paper's Eq. (2) F = p dg/dt.
#include "ode/plane/contact_rows.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "contact/overlap.h"
#include "contact/penalty.h"
#include "kernel/force_law.h"
#include "model/response.h"
#include "ode/plane/world.h"
#include "ode/step_contact.h"
#include "world/pressing_row.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The contact at one point of a joint with play; of a pin in its hole as the world's collider finds
// it.
struct ContactRow {
    StepContact at;
    Vec2 mass_normal;
    double excess;  // m, by how much its depth is more than the exact penetration
    Vec2 normal;    // of the row: unit, direction of the force on body b
    Vec2 point;     // m, in the world, where the force acts
    Vec2 arms[2];   // m, from the joint's anchors on bodies a and b to where its force is said to
                    // act (ode/plane/world.h)
    Vec2 lever;     // m, from there to the point
    double faster;  // m/s, by how much its closing speed is more than the exact penetration's
    double sliding; // m/s, along the wall before the step, where there is friction
    dSurfaceParameters surface; // of CONTACT_POISSON, without friction
    dContact contact;           // as ODE is given it
    dJointFeedback feedback;
};

// The effective mass with which a contact point that touches meets the linkage.
//
// W the mobility along the normals (model/response.h). One place alone: 1 / W_ii. Corners of a
// block that press together share the linkage: corner i that presses with F_i has
//     1 / m_i = sum over k of W_ik F_k / F_i             how fast it gives way to all of them
//     1 / m_i = sum over k of |W_ik| k_k / k_i           the stiffest motion at most (Gershgorin)
// the second for the limits of stability, k_i the slope of its law. In the first no corner counts
// for more than this one, nor one that pushes this one in.

// Brings the response to where the bodies are in this step, and says how they move; NULL where
// ideal joints are redundant there.
static const Motion *contact_mass_place(ContactMass *mass)
{
    if (!mass->is_placed) {
        world_motions(mass->world, mass->motions);
        mass->is_placed = response_place(&mass->response, mass->motions);
    }
    return mass->is_placed ? mass->motions : NULL;
}

// What a unit along the normal is in the rows of a place.
static void set_along(const ContactMass *mass, const ContactRow *rows, size_t number,
                      double along[RESPONSE_ROWS_A_JOINT])
{
    const Vec2 normal = pair_in_rows(&mass->world->pairs[number], rows[number].normal);
    along[0] = normal.x;
    along[1] = normal.y;
    along[2] = along[3] = 0.0;
}

// The masses of a corner beside the others of its block.
static void share_mass(const ContactMass *mass, ContactRow *rows, size_t number)
{
    const int joint = mass->world->pairs[number].joint;
    ContactRow *row = &rows[number];
    const double force = force_law_elastic(&row->at.law, row->at.found.depth);
    const double slope = force_law_tangent(&row->at.law, row->at.found.depth);
    double own[RESPONSE_ROWS_A_JOINT];
    double together = 0.0;
    double stiffest = 0.0;
    set_along(mass, rows, number, own);
    for (size_t i = 0; i < mass->world->pair_count; i++) {
        const ContactRow *other = &rows[i];
        if (mass->world->pairs[i].joint != joint || !other->at.state.is_touching) {
            continue;
        }
        double along[RESPONSE_ROWS_A_JOINT];
        set_along(mass, rows, i, along);
        const double between =
            response_between(&mass->response, response_first_row(&mass->response, i), along,
                             response_first_row(&mass->response, number), own);
        const double share = force_law_elastic(&other->at.law, other->at.found.depth) / force;
        together += i == number ? between : fmax(0.0, between) * fmin(1.0, share);
        stiffest +=
            fabs(between) * force_law_tangent(&other->at.law, other->at.found.depth) / slope;
    }
    row->at.mass = 1.0 / together;
    row->at.stiff_mass = 1.0 / stiffest;
}

// Brings the masses of a row that touches up to date, all rows of the step having been found: each
// time where they have to be exact, else where they may have changed.
static void contact_mass_find(ContactMass *mass, ContactRow *rows, size_t number, bool is_exact)
{
    // of a pin alone the mass changes as slowly as the linkage turns, and its normal with it
    static const double SAME_NORMAL = 0.995; // the cosine of 6 degrees
    ContactRow *row = &rows[number];
    const WorldPair *pair = &mass->world->pairs[number];
    const bool is_scalar = touch_is_scalar(&pair->touch);
    const bool is_known = !is_scalar && vec2_dot(row->mass_normal, row->normal) > SAME_NORMAL;
    if ((is_known && !is_exact) || contact_mass_place(mass) == NULL) {
        return;
    }
    if (pair->is_corner) {
        share_mass(mass, rows, number);
        return;
    }
    const Vec2 along = pair_in_rows(pair, row->normal);
    row->at.mass =
        response_mass(&mass->response, response_first_row(&mass->response, number), along);
    row->at.stiff_mass = row->at.mass;
    row->mass_normal = row->normal;
}

// The contact at one point: depth, normal, and the speed at which it began.
//
// Depth, normal and point of a pin's contact are the collider's, with whatever is wrong with them.
// Where the pin is (gap, eccentricity) is known exactly from the bodies, and so is the rate of any
// depth. Of all other places everything is.

// Of a place whose bodies say all.
static bool find_exactly(const WorldPair *pair, const TouchPose *pose, ContactRow *row,
                         StepFound *found)
{
    if (!(found->depth > 0.0) || !pose->has_normal) {
        return false;
    }
    row->normal = pose->normal;
    row->point = pair_point(pair, pose->normal);
    pair_arms(pair, pose, row->arms, &row->lever);
    return true;
}

// Of a pin in its hole, as two circles: the points where its force acts are the circles' own.
static bool find_in_hole(const WorldPair *pair, const TouchPose *pose, ContactRow *row,
                         StepFound *found)
{
    if (!(pose->gap < 0.0)) {
        return false;
    }
    found->depth = -pose->gap;
    row->normal = pose->normal;
    row->arms[0] = vec2_scale(-pair->touch.radius_a, pose->normal);
    row->arms[1] = vec2_scale(-pair->touch.radius_b, pose->normal);
    row->point = vec2_add(pair_centre(pair), row->arms[0]);
    return true;
}

// The contact of a pair.
static bool find_collision(const World *world, const WorldPair *pair, const TouchPose *pose,
                           ContactRow *row, StepFound *found)
{
    if (pair->hole == NULL) {
        return pair->touch.shape == TOUCH_HOLE ? find_in_hole(pair, pose, row, found)
                                               : find_exactly(pair, pose, row, found);
    }
    Collision collision;
    if (!world->collider->find(pair->collision, pair->hole, pair->pin, &collision)) {
        return false;
    }
    found->depth = found->inside = collision.depth;
    row->normal = collision.normal;
    row->arms[0] = collision.arm_hole;
    row->arms[1] = collision.arm_pin;
    row->point = vec2_add(pair_centre(pair), collision.arm_hole);
    // of a polygon's side the circles' penetration and its rate are not the row's
    found->closing = -vec2_dot(row->normal, pose->velocity);
    return true;
}

// What an end does in the step. Other places do what they do at mid-step: their forces grow gently.
static Overlap end_overlap(const ContactRow *row, const WorldPair *pair, const TouchPose *pose,
                           StepKind step)
{
    return step.is_staggered && pair->is_end
               ? overlap_find(&row->at.law, pose->gap, pose->approach_speed, step.step_s)
               : (Overlap){.depth = -pose->gap, .share = 1.0};
}

// Looks for the contact of a pair, and notes how it is, or that there is none. Fills in the state
// of this place: eccentricity (the pose's offset), gap, and whether it touches.
static void contact_row_find(ContactRow *row, const World *world, const WorldPair *pair,
                             StepKind step, JointState *state)
{
    const TouchPose pose = pair_pose(pair);
    const Overlap overlap = end_overlap(row, pair, &pose, step);
    StepFound found = {
        .gap = pose.gap,
        .inside = -pose.gap,
        .depth = overlap.depth,
        .share = overlap.share,
        .closing = pose.approach_speed,
        .onset_s = overlap.onset,
    };
    found.touches = find_collision(world, pair, &pose, row, &found);
    row->excess = pair->hole == NULL ? 0.0 : found.depth + pose.gap;
    row->faster = found.closing - pose.approach_speed;
    step_contact_find(&row->at, &found, step);
    *state = (JointState){
        .eccentricity = pose.offset,
        .gap = pose.gap,
        .is_touching = found.touches,
    };
}

// Of the velocity-level model, always the same.
static dSurfaceParameters poisson_surface(const ContactRows *rows, size_t number)
{
    const ContactOptions *options = &rows->scenario->contact;
    const int joint = rows->world->pairs[number].joint;
    return (dSurfaceParameters){
        .mode = dContactSoftERP | dContactSoftCFM | dContactBounce,
        .mu = 0.0, // makes one row, along the normal
        .bounce = scenario_restitution(rows->scenario, &rows->scenario->linkage.joints[joint]),
        .bounce_vel = options->bounce_speed,
        .soft_erp = rows->scenario->ode.push_out,
        .soft_cfm = map_poisson_cfm(rows->penalty),
    };
}

static dSurfaceParameters impact_surface(ContactRows *rows, ContactRow *row, double step_s)
{
    const ErpCfm soft = step_contact_soft(&row->at, rows->map, step_s);
    rows->fallback_count += row->at.falls_back ? 1 : 0;
    return (dSurfaceParameters){
        .mode = dContactSoftERP | dContactSoftCFM,
        .mu = 0.0,
        .soft_erp = soft.erp,
        .soft_cfm = soft.cfm,
    };
}

// What of a place's contacts does not change.
static void init_row(ContactRows *rows, size_t number, const Touch *place)
{
    ContactRow *row = &rows->rows[number];
    const WorldPair *pair = &rows->world->pairs[number];
    row->at.law = place->law;
    row->at.state = rows->scenario->linkage.joints[place->joint].contacts[place->place];
    row->surface = rows->map == NULL ? poisson_surface(rows, number) : row->surface;
    row->contact.geom = (dContactGeom){.g1 = pair->hole, .g2 = pair->pin, .side1 = -1, .side2 = -1};
    if (pair->row != NULL) {
        dJointSetFeedback(pair->row, &row->feedback);
    }
}

bool contact_rows_init(ContactRows *rows, const Scenario *scenario, World *world, bool is_staggered,
                       Err *err)
{
    memset(rows, 0, sizeof *rows);
    rows->scenario = scenario;
    rows->world = world;
    rows->mass.world = world;
    rows->is_staggered = is_staggered;
    if (scenario->contact.model == CONTACT_IMPACT && world->pair_count > 0) {
        rows->map = map_get(scenario->ode.map);
    }
    Touch *places;
    size_t count;
    if (!touch_list(scenario, &places, &count, err)) {
        return false;
    }
    const bool has_friction = law_has_friction(scenario);
    rows->rows = zeroed(count, sizeof *rows->rows);
    rows->friction = zeroed(count, sizeof *rows->friction);
    rows->numbers = zeroed(count, sizeof *rows->numbers);
    rows->mass.motions = zeroed(scenario->linkage.body_count, sizeof *rows->mass.motions);
    touch_response(&scenario->linkage, places, count, has_friction, &rows->mass.response);
    rows->work = has_friction ? contact_friction_work(&rows->mass.response) : NULL;
    rows->penalty = scenario->contact.penalty > 0.0
                        ? scenario->contact.penalty
                        : penalty_estimate(scenario->linkage.driver.speed, &scenario->material);
    for (size_t i = 0; i < world->pair_count; i++) {
        init_row(rows, i, &places[i]);
    }
    free(places);
    rows->group = dJointGroupCreate(0);
    return true;
}

void contact_rows_states(const ContactRows *rows, ContactState (*states)[JOINT_PLACES])
{
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const Touch *place = &rows->world->pairs[i].touch;
        states[place->joint][place->place] = rows->rows[i].at.state;
    }
}

void contact_rows_carry(ContactRows *rows, Carry *carry)
{
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        ContactRow *row = &rows->rows[i];
        // of all that is in a row the geoms alone are another world's
        const dContactGeom own = row->contact.geom;
        CARRY(carry, *row);
        row->contact.geom.g1 = own.g1;
        row->contact.geom.g2 = own.g2;
    }
    CARRY(carry, rows->most_rows);
    CARRY(carry, rows->row_count);
    CARRY(carry, rows->fallback_count);
}

void contact_rows_finish(ContactRows *rows)
{
    if (rows->group != NULL) {
        dJointGroupDestroy(rows->group);
    }
    free(rows->rows);
    free(rows->friction);
    free(rows->numbers);
    free(rows->mass.motions);
    contact_friction_free(rows->work);
    response_finish(&rows->mass.response);
    memset(rows, 0, sizeof *rows);
}

// What friction takes from a row along the normal.
static FrictionRow contact_rows_friction(const ContactRows *rows, size_t number)
{
    const ContactRow *row = &rows->rows[number];
    const WorldPair *pair = &rows->world->pairs[number];
    return (FrictionRow){
        .pair = pair,
        .first_row = response_first_row(&rows->mass.response, number),
        .normal = row->normal,
        .closing = row->at.found.closing,
        .cfm = row->contact.surface.soft_cfm,
        .friction = row->at.law.friction,
        .friction_speed = row->at.law.friction_speed,
        .bound = row->at.law.friction,
        .slip = INFINITY,
    };
}

// Gives a surface the row along the wall that it lacks without friction.
static void add_friction(ContactRow *row, const FrictionRow *friction)
{
    dSurfaceParameters *surface = &row->contact.surface;
    surface->mode |= dContactMu2 | dContactFDir1 | dContactApprox1;
    surface->mu = friction->bound;
    surface->mu2 = 0.0;
    row->sliding = friction->sliding;
    if (isfinite(friction->slip)) {
        // ODE's row is the speed of the first body attached: the hole's, if it is no ground
        const double sign = friction->pair->bodies[0] != NULL ? -1.0 : 1.0;
        surface->mode |= dContactSlip1 | dContactMotion1;
        surface->slip1 = friction->slip;
        surface->motion1 = sign * friction->surface;
    }
}

// Friction of all rows of the step. What the velocity-level model presses with has no law of
// motion to be solved for, and the quick solver bounds friction by what presses after all.
static void find_friction(ContactRows *rows, double step_s)
{
    const ContactOptions *options = &rows->scenario->contact;
    FrictionRow *found = rows->friction;
    size_t *numbers = rows->numbers;
    size_t count = 0;
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        if (rows->rows[i].at.state.is_touching) {
            found[count] = contact_rows_friction(rows, i);
            found[count].target =
                rows->rows[i].contact.surface.soft_erp / step_s * rows->rows[i].at.found.depth;
            numbers[count++] = i;
        }
    }
    const bool is_solved =
        options->model == CONTACT_IMPACT && rows->scenario->ode.solver == ODE_DIRECT && count > 0;
    const Motion *motions = is_solved ? contact_mass_place(&rows->mass) : NULL;
    if (motions != NULL) {
        const Applied *applied = &rows->world->applied;
        contact_friction_find(&rows->mass.response, motions, scenario_gravity(rows->scenario),
                              applied->is_any ? applied->loads : NULL, step_s, rows->work, found,
                              count);
    }
    for (size_t i = 0; i < count; i++) {
        if (!found[i].pair->is_end) {
            add_friction(&rows->rows[numbers[i]], &found[i]);
        }
    }
}

static void make_row(ContactRows *rows, size_t number, double step_s)
{
    ContactRow *row = &rows->rows[number];
    const dJointID own = rows->world->pairs[number].row;
    if (own != NULL) {
        const dSurfaceParameters *surface = &row->contact.surface;
        const double speed = surface->soft_erp / step_s * row->at.found.depth;
        pressing_row_press(own, surface->soft_cfm, speed, step_s);
        return;
    }
    pressing_row_of_way(rows->world->id, rows->group, &row->contact,
                        rows->world->pairs[number].bodies, &row->feedback);
}

// Makes the rows of all places that touch.
static void make_contact_rows(ContactRows *rows, double step_s)
{
    const bool has_friction = rows->work != NULL;
    size_t row_count = 0;
    if (has_friction) {
        find_friction(rows, step_s);
    }
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        if (rows->rows[i].at.state.is_touching) {
            make_row(rows, i, step_s);
            rows->row_count++;
            row_count += has_friction && !rows->world->pairs[i].is_end ? 2 : 1;
        }
    }
    rows->most_rows = row_count > rows->most_rows ? row_count : rows->most_rows;
}

static bool check_depth(const ContactRows *rows, size_t number, Err *err)
{
    const ContactRow *row = &rows->rows[number];
    const Joint *joint = &rows->scenario->linkage.joints[rows->world->pairs[number].joint];
    // deeper than any law: the step was too coarse to catch the wall
    return law_check_depth(&row->at.law, joint, row->at.found.depth, 1.0, err);
}

// Finds the masses that a place meets, where its map has a limit to its stability.
static void find_masses(ContactRows *rows, size_t number)
{
    if (rows->map != NULL && !isinf(rows->map->stability_limit)) {
        contact_mass_find(&rows->mass, rows->rows, number, rows->map->needs_mass);
    }
}

// What ODE is to know of a contact; its normal is that of the force on body a.
static void write_contact(ContactRows *rows, size_t number, double step_s)
{
    ContactRow *row = &rows->rows[number];
    dContact *contact = &row->contact;
    contact->surface = rows->map == NULL ? row->surface : impact_surface(rows, row, step_s);
    contact->geom.pos[0] = row->point.x;
    contact->geom.pos[1] = row->point.y;
    contact->geom.normal[0] = -row->normal.x;
    contact->geom.normal[1] = -row->normal.y;
    contact->geom.depth = row->at.found.depth;
    contact->fdir1[0] = -row->normal.y;
    contact->fdir1[1] = row->normal.x;
}

// Whether a pair is the first of its joint's.
static bool contact_rows_is_first(const ContactRows *rows, size_t number)
{
    const WorldPair *pairs = rows->world->pairs;
    return number == 0 || pairs[number - 1].joint != pairs[number].joint;
}

// Looks for the contact at a place and adds it to the state of its joint.
static void find_row(ContactRows *rows, size_t number, double step_s, JointState *states,
                     double *approach)
{
    const WorldPair *pair = &rows->world->pairs[number];
    ContactRow *row = &rows->rows[number];
    JointState *state = &states[pair->joint];
    const bool is_first = contact_rows_is_first(rows, number);
    JointState place;
    contact_row_find(row, rows->world, pair, (StepKind){step_s, rows->is_staggered},
                     is_first ? state : &place);
    if (is_first) {
        approach[pair->joint] =
            pair->is_corner && !row->at.state.is_touching ? 0.0 : row->at.state.impact_speed;
        return;
    }
    state->gap = fmin(state->gap, place.gap);
    state->is_touching = state->is_touching || row->at.state.is_touching;
    if (row->at.state.is_touching) {
        approach[pair->joint] = fmax(approach[pair->joint], row->at.state.impact_speed);
    }
}

bool contact_rows_make(ContactRows *rows, double step_s, JointState *states, double *approach,
                       Err *err)
{
    const size_t count = rows->world->pair_count;
    rows->mass.is_placed = false;
    for (size_t i = 0; i < count; i++) {
        find_row(rows, i, step_s, states, approach);
        if (rows->rows[i].at.state.is_touching && !check_depth(rows, i, err)) {
            return false;
        }
    }
    for (size_t i = 0; i < count; i++) {
        if (rows->rows[i].at.state.is_touching) {
            find_masses(rows, i);
            write_contact(rows, i, step_s);
        }
    }
    make_contact_rows(rows, step_s);
    return true;
}

// The forces and energies of the rows of a step.

// Work lost to friction in the step: the force on the pin along the wall, against how far the pin
// slid. Of a staggered world that is the mean of the speeds before and after the step.
static double friction_work(const ContactRows *rows, size_t number, Vec2 force, double step_s)
{
    const ContactRow *row = &rows->rows[number];
    const FrictionRow friction = contact_rows_friction(rows, number);
    const double after = contact_friction_sliding(&friction);
    const double sliding = rows->is_staggered ? 0.5 * (row->sliding + after) : after;
    return -vec2_dot(vec2_perp(row->normal), force) * sliding * step_s;
}

// What a contact lost and stored in the step.
static void book_energy(ContactRows *rows, size_t number, Vec2 force, double step_s)
{
    ContactRow *row = &rows->rows[number];
    row->at.elastic = row->at.dissipated = row->at.friction = 0.0;
    if (!row->at.state.is_touching) {
        return;
    }
    const WorldPair *pair = &rows->world->pairs[number];
    const TouchPose pose = pair_pose(pair);
    // a polygon's side stays what it is within a step
    const StepAfter after = {
        .pressing = pair->row != NULL ? row->at.pressing : vec2_dot(row->normal, force),
        .depth = row->excess - pose.gap,
        .closing = pose.approach_speed + row->faster,
    };
    step_contact_book(&row->at, rows->scenario->contact.model, after,
                      (StepKind){step_s, rows->is_staggered});
    if (row->at.law.friction > 0.0) {
        row->at.friction = friction_work(rows, number, force, step_s);
    }
}

// The force of a row on body b, as ODE has it; none at a turn.
static Vec2 row_force(const ContactRows *rows, size_t number)
{
    const ContactRow *row = &rows->rows[number];
    const WorldPair *pair = &rows->world->pairs[number];
    if (!row->at.state.is_touching || pair->row != NULL) {
        return (Vec2){0.0, 0.0};
    }
    const Vec3 on_a = pressing_row_force(&row->feedback, pair->bodies);
    return (Vec2){-on_a.x, -on_a.y};
}

// Adds what a corner or an end does to what its joint does.
static void add_corner(const ContactRow *row, const WorldPair *pair, const Joint *joint, Vec2 force,
                       JointState *state)
{
    state->force_on_b = vec2_add(state->force_on_b, force);
    state->force += row->at.pressing;
    state->moment_on_b += vec2_cross(row->lever, force);
    if (pair->row != NULL) {
        state->moment_on_b += coordinate_sense(joint) * pair->touch.sign * row->at.pressing;
    }
}

// The torque of a row of an angle, which does nothing from then on.
static double take_torque(const ContactRow *row, const WorldPair *pair)
{
    pressing_row_rest(pair->row);
    return pair->touch.sign * row->feedback.t1[2];
}

// Reads what a row of the step did, with its force on body b.
static void read_row(ContactRows *rows, size_t number, Vec2 force, double step_s, JointState *state)
{
    ContactRow *row = &rows->rows[number];
    const WorldPair *pair = &rows->world->pairs[number];
    row->at.pressing = pair->row != NULL ? take_torque(row, pair) : vec2_length(force);
    if (pair->is_corner) {
        const Joint *joint = &rows->scenario->linkage.joints[pair->joint];
        add_corner(row, pair, joint, force, state);
    } else {
        state->force_on_b = force;
        state->force = row->at.pressing;
    }
    if (pair->is_end) {
        // whose largest values alone are asked for: contact_rows_peaks
        contact_peaks_note_step(&row->at.peaks, row->at.pressing, fmax(row->at.found.inside, 0.0),
                                row->at.found.share, step_s);
    }
}

void contact_rows_clear(ContactRows *rows, double step_s, JointState *states)
{
    bool any = false;
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const WorldPair *pair = &rows->world->pairs[i];
        if (pair->is_end && contact_rows_is_first(rows, i)) {
            // what holds the joint beside its coordinate is not told of it
            states[pair->joint].force = 0.0;
        }
        const Vec2 force = row_force(rows, i);
        if (rows->rows[i].at.state.is_touching) {
            read_row(rows, i, force, step_s, &states[pair->joint]);
            any = true;
        }
        if (!rows->scenario->run.is_lean) {
            book_energy(rows, i, force, step_s);
        }
    }
    if (any) {
        dJointGroupEmpty(rows->group);
    }
}

// By joint, from the anchor on a body to where the joint's force is said to act, m: of a pin or
// stop at the contact, of a block or a prismatic joint at the anchor on body b. Zero for a joint
// with play that has no row in this step.
static void find_offsets(const ContactRows *rows, int body, Vec2 *offsets)
{
    memset(offsets, 0, rows->scenario->linkage.joint_count * sizeof *offsets);
    world_offsets(rows->world, body, offsets);
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const ContactRow *row = &rows->rows[i];
        const int number = rows->world->pairs[i].joint;
        const Joint *joint = &rows->scenario->linkage.joints[number];
        if (row->at.state.is_touching) {
            offsets[number] = row->arms[joint->body_a == body ? 0 : 1];
        }
    }
}

double contact_rows_drive_power(const ContactRows *rows, double time_s, Vec2 *offsets,
                                JointState *joints)
{
    const Linkage *linkage = &rows->scenario->linkage;
    double power = 0.0;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const int body = linkage_drive_body(linkage, i);
        const Motion driven = stepping_driven(linkage, i, time_s);
        const BodyLoad load = applied_on(&rows->world->applied, body);
        find_offsets(rows, body, offsets);
        power += stepping_drive(rows->scenario, i, &driven, &load, offsets, joints);
    }
    return power;
}

ContactEnergy contact_rows_energy(const ContactRows *rows)
{
    ContactEnergy sum = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        step_contact_add_energy(&rows->rows[i].at, &sum);
    }
    return sum;
}

void contact_rows_peaks(const ContactRows *rows, JointPeak *peaks)
{
    for (size_t i = 0; i < rows->scenario->linkage.joint_count; i++) {
        peaks[i] = (JointPeak){.force = 0.0};
    }
    for (size_t i = 0; i < rows->world->pair_count; i++) {
        const WorldPair *pair = &rows->world->pairs[i];
        if (pair->is_end) {
            step_contact_raise(&rows->rows[i].at, &peaks[pair->joint]);
        }
    }
}
