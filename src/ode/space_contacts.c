// What does a pin that touches its hole in space become inside ODE, and which force came of it?
//
// Each place (contact/pin_space.h) that touches is one contact of ODE, with the place's own part of
// the joint's law, by the map chosen, as in ode/plane/contact_rows.c.
#include "ode/space_contacts.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "contact/penalty.h"
#include "ode/space_contact_mass.h"
#include "ode/space_friction_rows.h"
#include "ode/space_world.h"
#include "world/pressing_row.h"

#include <string.h>

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
        contacts->contacts[i].state = scenario->linkage.joints[place->joint].contacts[place->place];
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
    const bool was_touching = contact->state.is_touching;
    contact->pose = pin_space_pose(place, motions);
    contact->depth = -contact->pose.gap;
    contact->state.is_touching = contact->pose.gap < 0.0;
    if (!contact->state.is_touching) {
        contact->state.impact_speed = contact->pose.approach_speed;
    } else if (was_touching) {
        contact->state.age_s += step_s;
    } else {
        const PinSpacePose *pose = &contact->pose;
        contact->state.age_s = 0.0;
        contact->state.impact_speed = contacts->is_staggered
                                          ? onset_speed(&contact->onset, pose->approach_speed,
                                                        pose->gap, contact->depth, step_s)
                                          : pose->approach_speed;
    }
    onset_note(&contact->onset, contact->state.is_touching, contact->pose.gap);
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

// Whether the row would not be stable under the map at this step.
static void check_stability(SpaceContacts *contacts, size_t number, double step_s)
{
    SpaceContact *contact = &contacts->contacts[number];
    contact->falls_back = false;
    if (!has_limit(contacts)) {
        return;
    }
    const double slope = force_law_tangent(&contacts->places[number].law, contact->depth);
    contact->falls_back = !law_row_is_stable(contacts->map, slope / contact->stiff_mass, step_s);
    contacts->fallback_count += contact->falls_back ? 1 : 0;
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
    const LawRow at = {
        .depth = contact->depth,
        .closing = contact->pose.approach_speed,
        .impact_speed = contact->state.impact_speed,
        .share = 1.0,
        .mass = contact->mass,
    };
    const MapContact row = law_row_contact(&place->law, &at, step_s);
    const ErpCfm soft = law_row_soft(contacts->map, contact->falls_back, &row);
    contact->damping = row.damping;
    surface.soft_erp = soft.erp;
    surface.soft_cfm = soft.cfm;
    return surface;
}

static dBodyID body_of(const World *world, int body)
{
    return body == LINKAGE_GROUND ? 0 : world->bodies[body];
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
                 .depth = contact->depth},
    };
}

// Makes the joints of all contacts. Returns their rows.
static size_t make_joints(SpaceContacts *contacts)
{
    size_t rows = 0;
    for (size_t i = 0; i < contacts->count; i++) {
        SpaceContact *contact = &contacts->contacts[i];
        const PinSpace *place = &contacts->places[i];
        if (contact->state.is_touching) {
            const dBodyID bodies[2] = {body_of(contacts->world, place->hole.body),
                                       body_of(contacts->world, place->pin.body)};
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
        if (place->place == 0 || (place->place == 1 && contact->state.is_touching)) {
            approach[place->joint] = contact->state.impact_speed;
        }
        if (!contact->state.is_touching) {
            continue;
        }
        if (!law_check_depth(&place->law, &linkage->joints[place->joint], contact->depth, 1.0,
                             err)) {
            return false;
        }
        check_stability(contacts, i, step_s);
        fill_contact(contacts, i, step_s);
    }
    if (contacts->has_friction) {
        space_friction_rows_add(contacts, motions, seen, step_s);
    }
    const size_t rows = make_joints(contacts);
    contacts->most_rows = rows > contacts->most_rows ? rows : contacts->most_rows;
    return true;
}

// What a contact lost and stored in the step, by its law; as in ode/plane/contact_rows.c.
static void book_energy(SpaceContacts *contacts, size_t number, const SpaceMotion *motions,
                        double step_s)
{
    SpaceContact *contact = &contacts->contacts[number];
    contact->elastic = contact->dissipated = contact->friction = 0.0;
    if (!contact->state.is_touching) {
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
        contact->friction = -step_s * vec3_dot(contact->force, mean_sliding);
    }
    const double before = contact->pose.approach_speed;
    const double mean = 0.5 * (before + after.approach_speed);
    const double pressing = vec3_dot(contact->pose.normal, contact->force);
    if (contacts->scenario->contact.model == CONTACT_POISSON) {
        contact->dissipated = pressing * mean * step_s;
        return;
    }
    const double closing = contacts->is_staggered ? mean : after.approach_speed;
    const double depth = contacts->is_staggered ? 0.5 * (contact->depth - after.gap) : -after.gap;
    contact->dissipated = pressing > 0.0 ? contact->damping * closing * closing * step_s : 0.0;
    contact->elastic = force_law_energy(&place->law, fmax(0.0, depth));
}

void space_contacts_clear(SpaceContacts *contacts, double step_s, SpaceJoints *joints)
{
    SpaceMotion *motions = contacts->motions;
    bool any = false;
    for (size_t i = 0; i < contacts->count; i++) {
        any = any || contacts->contacts[i].state.is_touching;
    }
    for (size_t i = 0; any && i < contacts->scenario->linkage.body_count; i++) {
        motions[i] = space_world_motion(contacts->world, i);
    }
    for (size_t i = 0; i < contacts->count; i++) {
        const PinSpace *place = &contacts->places[i];
        SpaceContact *contact = &contacts->contacts[i];
        contact->force = (Vec3){0.0, 0.0, 0.0};
        if (contact->state.is_touching) {
            const dBodyID bodies[2] = {body_of(contacts->world, place->hole.body),
                                       body_of(contacts->world, place->pin.body)};
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
        if (contact->state.is_touching && (place->hole.body == body || place->pin.body == body)) {
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
        sum.dissipated += contacts->contacts[i].dissipated;
        sum.friction += contacts->contacts[i].friction;
        sum.elastic += contacts->contacts[i].elastic;
    }
    return sum;
}
