// What does a touching pin become inside ODE, and which force came of it?
//
// ODE's contact row, F >= 0, d penetration, v_out the separating speed after the step:
//     v_out + CFM F = (ERP / h) d
// IMPACT: (ERP, CFM) from the secant stiffness k and damping c of the force law at d, by the map
// chosen, anew each step; where omega h is beyond the map's limit, with omega^2 = (dF/dd) / m and m
// the linkage's effective mass along the normal (ode/contact_mass.c), by the textbook's, and
// counted. POISSON: CFM = 1 / p and bounce e, the paper's Eq. (2) F = p dg/dt.
#include "ode/contact_rows.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "contact/law_row.h"
#include "contact/penalty.h"
#include "world/pressing_row.h"

#include <stdlib.h>
#include <string.h>

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

static dSurfaceParameters impact_surface(const ContactRows *rows, ContactRow *row, double step_s)
{
    const LawRow at = {
        .depth = row->depth,
        .closing = row->closing,
        .impact_speed = row->state.damping_speed,
        .share = row->share,
        .mass = row->mass,
    };
    const MapContact contact = law_row_contact(&row->law, &at, step_s);
    const ErpCfm soft = law_row_soft(rows->map, row->falls_back, &contact);
    row->damping = contact.damping;
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
    row->law = place->law;
    row->state = rows->scenario->linkage.joints[place->joint].contacts[place->place];
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
        states[place->joint][place->place] = rows->rows[i].state;
    }
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

FrictionRow contact_rows_friction(const ContactRows *rows, size_t number)
{
    const ContactRow *row = &rows->rows[number];
    const WorldPair *pair = &rows->world->pairs[number];
    return (FrictionRow){
        .pair = pair,
        .first_row = response_first_row(&rows->mass.response, number),
        .normal = row->normal,
        .closing = row->closing,
        .cfm = row->contact.surface.soft_cfm,
        .friction = row->law.friction,
        .friction_speed = row->law.friction_speed,
        .bound = row->law.friction,
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
        if (rows->rows[i].state.is_touching) {
            found[count] = contact_rows_friction(rows, i);
            found[count].target =
                rows->rows[i].contact.surface.soft_erp / step_s * rows->rows[i].depth;
            numbers[count++] = i;
        }
    }
    const bool is_solved =
        options->model == CONTACT_IMPACT && rows->scenario->ode.solver == ODE_DIRECT && count > 0;
    const Motion *motions = is_solved ? contact_mass_place(&rows->mass) : NULL;
    if (motions != NULL) {
        const Applied *applied = &rows->world->applied;
        contact_friction_find(&rows->mass.response, motions, rows->scenario->gravity,
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
        const double speed = surface->soft_erp / step_s * row->depth;
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
        if (rows->rows[i].state.is_touching) {
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
    return law_check_depth(&row->law, joint, row->depth, 1.0, err);
}

// Whether the row would not be stable under the map at this step.
static void check_stability(ContactRows *rows, size_t number, double step_s)
{
    ContactRow *row = &rows->rows[number];
    row->falls_back = false;
    if (rows->map == NULL || isinf(rows->map->stability_limit)) {
        return;
    }
    contact_mass_find(&rows->mass, rows->rows, number, rows->map->needs_mass);
    const double slope = force_law_tangent(&row->law, row->depth);
    row->falls_back = !law_row_is_stable(rows->map, slope / row->stiff_mass, step_s);
    rows->fallback_count += row->falls_back ? 1 : 0;
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
    contact->geom.depth = row->depth;
    contact->fdir1[0] = -row->normal.y;
    contact->fdir1[1] = row->normal.x;
}

bool contact_rows_is_first(const ContactRows *rows, size_t number)
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
    contact_row_find(row, rows->world, pair, rows->is_staggered, step_s, is_first ? state : &place);
    if (is_first) {
        approach[pair->joint] =
            pair->is_corner && !row->state.is_touching ? 0.0 : row->state.impact_speed;
        return;
    }
    state->gap = fmin(state->gap, place.gap);
    state->is_touching = state->is_touching || row->state.is_touching;
    if (row->state.is_touching) {
        approach[pair->joint] = fmax(approach[pair->joint], row->state.impact_speed);
    }
}

bool contact_rows_make(ContactRows *rows, double step_s, JointState *states, double *approach,
                       Err *err)
{
    const size_t count = rows->world->pair_count;
    rows->mass.is_placed = false;
    for (size_t i = 0; i < count; i++) {
        find_row(rows, i, step_s, states, approach);
        if (rows->rows[i].state.is_touching && !check_depth(rows, i, err)) {
            return false;
        }
    }
    for (size_t i = 0; i < count; i++) {
        if (rows->rows[i].state.is_touching) {
            check_stability(rows, i, step_s);
            write_contact(rows, i, step_s);
        }
    }
    make_contact_rows(rows, step_s);
    return true;
}
