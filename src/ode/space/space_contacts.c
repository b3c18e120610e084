// Makes rows of ODE of the pins that touch their holes in space, and reads the forces that came of
// them.
//
// Each place (contact/pin_space.h) that touches is one contact of ODE, with the place's own part of
// the joint's law, by the map chosen, as in ode/plane/contact_rows.c.
#include "ode/space/space_contacts.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "contact/penalty.h"
#include "ode/space/space_friction.h"
#include "ode/space/space_world.h"
#include "ode/step_contact.h"
#include "world/pressing_row.h"

#include <string.h>

// What a pin does at one of its places.
struct SpaceContact {
    StepContact at;
    PinSpacePose pose;
    Vec3 point;     // m, where the force acts
    Vec3 hole_axis; // unit, of a collar
    Vec3 mass_normal;
    unsigned mass_places; // the joint's places that touched then, one bit each
    Vec3 sliding;         // m/s, along the wall before the step, where there is friction
    Vec3 force;           // N, on the pin in the step
    dContact contact;     // as ODE is given it
    dJointFeedback feedback;
};

// The effective mass that a pin in space meets at a place of its hole.
//
// Two ends of one hole that press together share the mass m of the linkage: an end i that presses
// with F_i has
//     1 / m_i = W_ii + sum_j max(0, W_ij) min(1, F_j / F_i)
// with W_ij the mobility between the normals of places i and j, so that both ends of a pin that is
// not tilted oscillate as one contact of the whole law on m. For a map's limit of stability it is
// the stiffest motion of the two that counts, at most 1 / m_i = sum_j |W_ij| k_j / k_i.

// The places of a place's joint: [first, end).
static size_t first_of_joint(const SpaceContacts *contacts, size_t number)
{
    return number - (size_t)contacts->places[number].place;
}

static size_t end_of_joint(const SpaceContacts *contacts, size_t number)
{
    const int joint = contacts->places[number].joint;
    size_t end = number + 1;
    while (end < contacts->count && contacts->places[end].joint == joint) {
        end++;
    }
    return end;
}

// The joint's places that touch, one bit each.
static unsigned touching_places(const SpaceContacts *contacts, size_t number)
{
    unsigned places = 0;
    const size_t end = end_of_joint(contacts, number);
    for (size_t i = first_of_joint(contacts, number); i < end; i++) {
        places |= contacts->contacts[i].at.state.is_touching ? 1U << contacts->places[i].place : 0;
    }
    return places;
}

// Whether the masses of a place are to be brought up to date: they change as slowly as the linkage
// turns, or when another place of the joint comes to touch.
static bool needs_mass(const SpaceContacts *contacts, size_t number)
{
    static const double SAME_NORMAL = 0.995; // the cosine of 6 degrees
    const SpaceContact *contact = &contacts->contacts[number];
    return contact->at.state.is_touching &&
           (contacts->map->needs_mass ||
            contact->mass_places != touching_places(contacts, number) ||
            !(vec3_dot(contact->mass_normal, contact->pose.normal) > SAME_NORMAL));
}

// Takes the response with the normals of all places that touch.
static bool place_normals(SpaceContacts *contacts, const SpaceMotion *motions)
{
    for (size_t i = 0; i < space_response_play_rows(contacts->response); i++) {
        contacts->rows[i] = (SpaceRow){.body = {LINKAGE_GROUND, LINKAGE_GROUND}};
    }
    for (size_t i = 0; i < contacts->count; i++) {
        const PinSpace *place = &contacts->places[i];
        const SpaceContact *contact = &contacts->contacts[i];
        for (size_t k = 0; k < SPACE_CONTACT_ROWS; k++) {
            contacts->rows[SPACE_CONTACT_ROWS * i + k].body[0] = place->hole.body;
            contacts->rows[SPACE_CONTACT_ROWS * i + k].body[1] = place->pin.body;
        }
        if (contact->at.state.is_touching) {
            contacts->rows[SPACE_CONTACT_ROWS * i] =
                space_row_along(motions, place->hole.body, contact->pose.at_a, place->pin.body,
                                contact->pose.at_b, contact->pose.normal);
        }
    }
    return space_response_place(contacts->response, motions, contacts->rows);
}

// The mobility between the normals of two places of one joint.
static double mobility_between(const SpaceContacts *contacts, size_t a, size_t b)
{
    const double *block = space_response_block(contacts->response, a > b ? a : b, a > b ? b : a);
    return block != NULL ? block[0] : 0.0;
}

// The masses that a place that touches meets along its normal.
static void find_mass(SpaceContacts *contacts, size_t number)
{
    SpaceContact *contact = &contacts->contacts[number];
    const ForceLaw *law = &contacts->places[number].law;
    const double force = force_law_elastic(law, contact->at.found.depth);
    const double stiffness = force_law_tangent(law, contact->at.found.depth);
    double together = mobility_between(contacts, number, number);
    double stiffest = 0.0;
    const size_t end = end_of_joint(contacts, number);
    for (size_t k = first_of_joint(contacts, number); k < end; k++) {
        const SpaceContact *other = &contacts->contacts[k];
        const ForceLaw *of = &contacts->places[k].law;
        if (!other->at.state.is_touching) {
            continue;
        }
        const double between = mobility_between(contacts, number, k);
        const double share = force_law_elastic(of, other->at.found.depth) / force;
        together += k == number ? 0.0 : fmax(0.0, between) * fmin(1.0, share);
        stiffest += fabs(between) * force_law_tangent(of, other->at.found.depth) / stiffness;
    }
    contact->at.mass = 1.0 / together;
    contact->at.stiff_mass = 1.0 / stiffest;
    contact->mass_normal = contact->pose.normal;
    contact->mass_places = touching_places(contacts, number);
}

// Brings the masses of all places that touch up to date, at the motions given: they change as
// slowly as the linkage turns, or when another place of a joint comes to touch.
static void space_contact_mass_find(SpaceContacts *contacts, const SpaceMotion *motions)
{
    bool is_placed = false;
    for (size_t i = 0; i < contacts->count; i++) {
        if (!needs_mass(contacts, i)) {
            continue;
        }
        if (!is_placed && !place_normals(contacts, motions)) {
            return;
        }
        is_placed = true;
        const size_t end = end_of_joint(contacts, i);
        for (size_t k = first_of_joint(contacts, i); k < end; k++) {
            if (contacts->contacts[k].at.state.is_touching) {
                find_mass(contacts, k);
            }
        }
    }
}

// The rows of ODE that hold pins along their walls.
//
// Those that ode/space/space_friction.c finds, for the direct solver. The velocity-level model has
// no law of motion to be solved for, and the quick solver bounds friction by what presses after
// all: there the first direction is that in which the pin slides, and both have ODE's own bound.

// How the pin moves along the wall that it touches at a place, m/s.
static Vec3 space_friction_rows_sliding(const PinSpace *place, const SpaceMotion *motions,
                                        Vec3 point, Vec3 normal)
{
    return vec3_across(vec3_sub(space_velocity_at(motions, place->pin.body, point),
                                space_velocity_at(motions, place->hole.body, point)),
                       normal);
}

// What friction takes from a contact.
static SpaceFrictionRow friction_row(SpaceContacts *contacts, size_t number,
                                     const SpaceMotion *motions, double step_s)
{
    SpaceContact *contact = &contacts->contacts[number];
    const PinSpace *place = &contacts->places[number];
    const Vec3 normal = contact->pose.normal;
    const dSurfaceParameters *surface = &contact->contact.surface;
    const bool is_end = place->place != PIN_SPACE_COLLAR;
    const Vec3 axis = is_end ? space_direction(motions, place->pin.body, place->pin.axis)
                             : vec3_normal_to(normal);
    const Vec3 side = vec3_cross(axis, normal);
    contact->sliding = space_friction_rows_sliding(place, motions, contact->point, normal);
    const double speed = vec3_length(contact->sliding);
    return (SpaceFrictionRow){
        .body = {place->hole.body, place->pin.body},
        .point = contact->point,
        .normal = normal,
        .side = side,
        .has_friction = is_end && place->law.friction > 0.0,
        .target = surface->soft_erp / step_s * contact->at.found.depth,
        .cfm = surface->soft_cfm,
        .sliding = contact->sliding,
        .along = speed > 0.0 ? vec3_scale(1.0 / speed, contact->sliding) : side,
        .friction = place->law.friction,
        .friction_speed = place->law.friction_speed,
        .bound = place->law.friction,
        .slip = {INFINITY, INFINITY},
    };
}

// Gives a contact its rows along the wall.
static void add_friction(SpaceContact *contact, const SpaceFrictionRow *row)
{
    dSurfaceParameters *surface = &contact->contact.surface;
    // ODE's first row is the speed of the first body attached: the hole's, if it is no ground; its
    // second direction changes its sign with the normal, and is the same for both
    const double sign = row->body[0] != LINKAGE_GROUND ? -1.0 : 1.0;
    surface->mode |= dContactMu2 | dContactFDir1 | dContactApprox1;
    surface->mu = surface->mu2 = row->bound;
    contact->contact.fdir1[0] = row->along.x;
    contact->contact.fdir1[1] = row->along.y;
    contact->contact.fdir1[2] = row->along.z;
    if (isfinite(row->slip[0])) {
        surface->mode |= dContactSlip1 | dContactMotion1;
        surface->slip1 = row->slip[0];
        surface->motion1 = sign * row->surface[0];
    }
    if (isfinite(row->slip[1])) {
        surface->mode |= dContactSlip2 | dContactMotion2;
        surface->slip2 = row->slip[1];
        surface->motion2 = row->surface[1];
    }
}

// Gives all contacts of the step that touch at an end of a hole their rows along the wall, from the
// motions before the step and as its rows will see them.
static void space_friction_rows_add(SpaceContacts *contacts, const SpaceMotion *motions,
                                    const SpaceMotion *seen, double step_s)
{
    const Scenario *scenario = contacts->scenario;
    SpaceFrictionRow *found = zeroed(contacts->count, sizeof *found);
    size_t *numbers = zeroed(contacts->count, sizeof *numbers);
    size_t count = 0;
    for (size_t i = 0; i < contacts->count; i++) {
        if (contacts->contacts[i].at.state.is_touching) {
            found[count] = friction_row(contacts, i, motions, step_s);
            numbers[count++] = i;
        }
    }
    if (scenario->contact.model == CONTACT_IMPACT && scenario->ode.solver == ODE_DIRECT &&
        count > 0) {
        const SpaceFrictionStep step = {seen, step_s, dWorldGetERP(contacts->world->id)};
        space_friction_find(contacts->response, &step, numbers, found, count);
    }
    for (size_t i = 0; i < count; i++) {
        if (found[i].has_friction) {
            add_friction(&contacts->contacts[numbers[i]], &found[i]);
        }
    }
    free(numbers);
    free(found);
}

bool space_contacts_list(SpaceContacts *contacts, const Scenario *scenario, Err *err)
{
    const size_t bodies = scenario->linkage.body_count;
    memset(contacts, 0, sizeof *contacts);
    contacts->scenario = scenario;
    contacts->places = pin_space_list(scenario, &contacts->count, err);
    contacts->contacts = zeroed(contacts->count, sizeof *contacts->contacts);
    contacts->motions = zeroed(bodies, sizeof *contacts->motions);
    for (size_t i = 0; i < contacts->count; i++) {
        const PinSpace *place = &contacts->places[i];
        contacts->contacts[i].at.law = place->law;
        contacts->contacts[i].at.state =
            scenario->linkage.joints[place->joint].contacts[place->place];
    }
    return contacts->places != NULL;
}

void space_contacts_init(SpaceContacts *contacts, World *world, SpaceResponse *response,
                         bool is_staggered)
{
    const Scenario *scenario = contacts->scenario;
    contacts->world = world;
    contacts->response = response;
    contacts->rows = zeroed(space_response_play_rows(response), sizeof *contacts->rows);
    contacts->is_staggered = is_staggered;
    contacts->has_friction = law_has_friction(scenario);
    contacts->group = dJointGroupCreate(0);
    contacts->penalty = scenario->contact.penalty > 0.0
                            ? scenario->contact.penalty
                            : penalty_estimate(scenario->linkage.driver.speed, &scenario->material);
    if (contacts->count > 0 && scenario->contact.model == CONTACT_IMPACT) {
        contacts->map = map_get(scenario->ode.map);
    }
}

SpaceResponsePlace *space_contacts_response_places(const SpaceContacts *contacts, size_t room)
{
    SpaceResponsePlace *places = zeroed(room, sizeof *places);
    for (size_t i = 0; i < contacts->count; i++) {
        places[i] = (SpaceResponsePlace){contacts->places[i].joint, SPACE_CONTACT_ROWS};
    }
    return places;
}

void space_contacts_finish(SpaceContacts *contacts)
{
    if (contacts->group != NULL) {
        dJointGroupDestroy(contacts->group);
    }
    contacts->group = NULL;
    free(contacts->places);
    free(contacts->contacts);
    free(contacts->rows);
    free(contacts->motions);
}

static void find_contact(SpaceContacts *contacts, size_t number, const SpaceMotion *motions,
                         double step_s)
{
    const PinSpace *place = &contacts->places[number];
    SpaceContact *contact = &contacts->contacts[number];
    contact->pose = pin_space_pose(place, motions);
    const StepFound found = {
        .touches = contact->pose.gap < 0.0,
        .gap = contact->pose.gap,
        .inside = -contact->pose.gap,
        .depth = -contact->pose.gap,
        .share = 1.0,
        .closing = contact->pose.approach_speed,
    };
    step_contact_find(&contact->at, &found, (StepKind){step_s, contacts->is_staggered});
    const Clearance *clearance = &contacts->scenario->linkage.joints[place->joint].clearance;
    contact->point = contact->pose.at_a;
    if (place->place == PIN_SPACE_COLLAR) {
        contact->hole_axis = space_direction(motions, place->hole.body, place->hole.axis);
    } else {
        contact->point =
            vec3_sub(contact->pose.at_a, vec3_scale(clearance->hole_radius, contact->pose.normal));
    }
}

// Whether a map's limit of stability is to be watched.
static bool has_limit(const SpaceContacts *contacts)
{
    return contacts->map != NULL && !isinf(contacts->map->stability_limit);
}

static dSurfaceParameters surface_of(SpaceContacts *contacts, size_t number, double step_s)
{
    const ContactOptions *options = &contacts->scenario->contact;
    const PinSpace *place = &contacts->places[number];
    SpaceContact *contact = &contacts->contacts[number];
    dSurfaceParameters surface = {.mode = dContactSoftERP | dContactSoftCFM, .mu = 0.0};
    if (options->model == CONTACT_POISSON) {
        const bool is_end = place->place != PIN_SPACE_COLLAR;
        surface.mode |= dContactBounce;
        surface.bounce = scenario_restitution(contacts->scenario,
                                              &contacts->scenario->linkage.joints[place->joint]);
        surface.bounce_vel = options->bounce_speed;
        surface.soft_erp = contacts->scenario->ode.push_out;
        surface.soft_cfm =
            map_poisson_cfm(contacts->penalty / (is_end ? (double)PIN_SPACE_ENDS : 1.0));
        return surface;
    }
    const ErpCfm soft = step_contact_soft(&contact->at, contacts->map, step_s);
    contacts->fallback_count += contact->at.falls_back ? 1 : 0;
    surface.soft_erp = soft.erp;
    surface.soft_cfm = soft.cfm;
    return surface;
}

// A contact as ODE wants it: its normal is that of the force on the hole.
static void fill_contact(SpaceContacts *contacts, size_t number, double step_s)
{
    SpaceContact *contact = &contacts->contacts[number];
    const Vec3 normal = contact->pose.normal;
    contact->contact = (dContact){
        .surface = surface_of(contacts, number, step_s),
        .geom = {.pos = {contact->point.x, contact->point.y, contact->point.z},
                 .normal = {-normal.x, -normal.y, -normal.z},
                 .depth = contact->at.found.depth},
    };
}

// Makes the joints of all contacts. Returns their rows.
static size_t make_joints(SpaceContacts *contacts)
{
    size_t rows = 0;
    for (size_t i = 0; i < contacts->count; i++) {
        SpaceContact *contact = &contacts->contacts[i];
        const PinSpace *place = &contacts->places[i];
        if (contact->at.state.is_touching) {
            const dBodyID bodies[2] = {world_body(contacts->world, place->hole.body),
                                       world_body(contacts->world, place->pin.body)};
            pressing_row_of_way(contacts->world->id, contacts->group, &contact->contact, bodies,
                                &contact->feedback);
            rows += (contact->contact.surface.mode & dContactFDir1) != 0 ? 3 : 1;
        }
    }
    return rows;
}

bool space_contacts_make(SpaceContacts *contacts, const SpaceMotion *motions,
                         const SpaceMotion *seen, double step_s, double *approach, Err *err)
{
    const Linkage *linkage = &contacts->scenario->linkage;
    for (size_t i = 0; i < contacts->count; i++) {
        find_contact(contacts, i, motions, step_s);
    }
    if (has_limit(contacts)) {
        space_contact_mass_find(contacts, motions);
    }
    for (size_t i = 0; i < contacts->count; i++) {
        SpaceContact *contact = &contacts->contacts[i];
        const PinSpace *place = &contacts->places[i];
        if (place->place == 0 || (place->place == 1 && contact->at.state.is_touching)) {
            approach[place->joint] = contact->at.state.impact_speed;
        }
        if (!contact->at.state.is_touching) {
            continue;
        }
        if (!law_check_depth(&place->law, &linkage->joints[place->joint], contact->at.found.depth,
                             1.0, err)) {
            return false;
        }
        fill_contact(contacts, i, step_s);
    }
    if (contacts->has_friction) {
        space_friction_rows_add(contacts, motions, seen, step_s);
    }
    const size_t rows = make_joints(contacts);
    contacts->most_rows = rows > contacts->most_rows ? rows : contacts->most_rows;
    return true;
}

// What a contact lost and stored in the step.
static void book_energy(SpaceContacts *contacts, size_t number, const SpaceMotion *motions,
                        double step_s)
{
    SpaceContact *contact = &contacts->contacts[number];
    contact->at.elastic = contact->at.dissipated = contact->at.friction = 0.0;
    if (!contact->at.state.is_touching) {
        return;
    }
    const PinSpace *place = &contacts->places[number];
    const PinSpacePose after = pin_space_pose(place, motions);
    if (place->law.friction > 0.0 && place->place != PIN_SPACE_COLLAR) {
        const Vec3 moved = vec3_sub(after.at_a, contact->pose.at_a);
        const Vec3 sliding = space_friction_rows_sliding(
            place, motions, vec3_add(contact->point, moved), contact->pose.normal);
        const Vec3 mean_sliding =
            contacts->is_staggered ? vec3_scale(0.5, vec3_add(contact->sliding, sliding)) : sliding;
        contact->at.friction = -step_s * vec3_dot(contact->force, mean_sliding);
    }
    const StepAfter stood = {
        .pressing = vec3_dot(contact->pose.normal, contact->force),
        .depth = -after.gap,
        .closing = after.approach_speed,
    };
    step_contact_book(&contact->at, contacts->scenario->contact.model, stood,
                      (StepKind){step_s, contacts->is_staggered});
}

void space_contacts_clear(SpaceContacts *contacts, double step_s, SpaceJoints *joints)
{
    SpaceMotion *motions = contacts->motions;
    bool any = false;
    for (size_t i = 0; i < contacts->count; i++) {
        any = any || contacts->contacts[i].at.state.is_touching;
    }
    for (size_t i = 0; any && i < contacts->scenario->linkage.body_count; i++) {
        motions[i] = space_world_motion(contacts->world, i);
    }
    for (size_t i = 0; i < contacts->count; i++) {
        const PinSpace *place = &contacts->places[i];
        SpaceContact *contact = &contacts->contacts[i];
        contact->force = (Vec3){0.0, 0.0, 0.0};
        if (contact->at.state.is_touching) {
            const dBodyID bodies[2] = {world_body(contacts->world, place->hole.body),
                                       world_body(contacts->world, place->pin.body)};
            contact->force = vec3_scale(-1.0, pressing_row_force(&contact->feedback, bodies));
            space_joints_press(joints, place, contact->force, contact->hole_axis);
        }
        book_energy(contacts, i, motions, step_s);
    }
    if (any) {
        dJointGroupEmpty(contacts->group);
    }
}

void space_contacts_load(const SpaceContacts *contacts, int body, Vec3 centre, SpaceChange *load)
{
    for (size_t i = 0; i < contacts->count && body != LINKAGE_GROUND; i++) {
        const SpaceContact *contact = &contacts->contacts[i];
        const PinSpace *place = &contacts->places[i];
        if (contact->at.state.is_touching &&
            (place->hole.body == body || place->pin.body == body)) {
            const double sign = place->pin.body == body ? 1.0 : -1.0;
            const Vec3 force = vec3_scale(sign, contact->force);
            load->move = vec3_add(load->move, force);
            load->turn = vec3_add(load->turn, vec3_cross(vec3_sub(contact->point, centre), force));
        }
    }
}

void space_contacts_impulses(const SpaceContacts *contacts, double step_s, double *impulses)
{
    for (size_t i = 0; i < contacts->count; i++) {
        const PinSpace *place = &contacts->places[i];
        if (place->place == 0) {
            impulses[place->joint] = 0.0;
        }
        if (place->place != PIN_SPACE_COLLAR) {
            impulses[place->joint] += step_s * vec3_length(contacts->contacts[i].force);
        }
    }
}

ContactEnergy space_contacts_energy(const SpaceContacts *contacts)
{
    ContactEnergy sum = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < contacts->count; i++) {
        step_contact_add_energy(&contacts->contacts[i].at, &sum);
    }
    return sum;
}

void space_contacts_states(const SpaceContacts *contacts, ContactState (*states)[JOINT_PLACES])
{
    for (size_t i = 0; i < contacts->count; i++) {
        const PinSpace *place = &contacts->places[i];
        states[place->joint][place->place] = contacts->contacts[i].at.state;
    }
}

void space_contacts_carry(SpaceContacts *contacts, Carry *carry)
{
    for (size_t i = 0; i < contacts->count; i++) {
        SpaceContact *contact = &contacts->contacts[i];
        // of all that is in a contact the geoms alone are another world's
        const dContactGeom own = contact->contact.geom;
        CARRY(carry, *contact);
        contact->contact.geom.g1 = own.g1;
        contact->contact.geom.g2 = own.g2;
    }
    CARRY(carry, contacts->most_rows);
    CARRY(carry, contacts->fallback_count);
}
