// Which rows of ODE hold pins along their walls in space?
//
// Those that ode/space_friction.c finds, for the direct solver. The velocity-level model has no law
// of motion to be solved for, and the quick solver bounds friction by what presses after all: there
// the first direction is that in which the pin slides, and both have ODE's own bound.
#include "ode/space_friction_rows.h"

#include "base/zeroed.h"
#include "ode/space_friction.h"

Vec3 space_friction_rows_sliding(const PinSpace *place, const SpaceMotion *motions, Vec3 point,
                                 Vec3 normal)
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
        .target = surface->soft_erp / step_s * contact->depth,
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

void space_friction_rows_add(SpaceContacts *contacts, const SpaceMotion *motions,
                             const SpaceMotion *seen, double step_s)
{
    const Scenario *scenario = contacts->scenario;
    SpaceFrictionRow *found = zeroed(contacts->count, sizeof *found);
    size_t *numbers = zeroed(contacts->count, sizeof *numbers);
    size_t count = 0;
    for (size_t i = 0; i < contacts->count; i++) {
        if (contacts->contacts[i].state.is_touching) {
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
