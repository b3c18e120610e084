// Makes the row of a side, for an angle and for a way.
//
// An angle has a row of its own (world/pressing_row.c).
// A way: a contact at a depth of 0 whose dContactMotionN is the row's speed. A world may limit that
// speed (dWorldSetContactMaxCorrectingVel). Then F - F0 is the row's force, F0 = (speed - limit) /
// CFM what is put on from outside: the same row, for F of at least F0.
// Friction is the contact's own, within a pyramid of mu times the row's force; ODE's slip leads it
// to the law mu N tanh(v / v_s) at slow sliding, N that of the step before.
#include "world/row.h"

#include "world/pressing_row.h"

#include <math.h>
#include <string.h>

// so that rounding does not reach the limit
static const double LIMIT_SHARE = 0.999;

// Friction of a pin at its wall, in the contact's two directions.
static void add_friction(Place *place, const Side *side, dContact *contact)
{
    dSurfaceParameters *surface = &contact->surface;
    surface->mode |= dContactFDir1 | dContactMu2 | dContactApprox1 | dContactSlip1 | dContactSlip2;
    surface->mu = place->friction;
    surface->mu2 = place->slides_along ? place->friction : 0.0;
    const double most = place->friction * side->force;
    surface->slip1 = surface->slip2 = most > 0.0 ? place->friction_speed / most : 0.0;
    for (int i = 0; i < 2; i++) {
        place->sliding_before[i] = direction_rate(&place->slide[i]);
    }
    for (int i = 0; i < 3; i++) {
        contact->fdir1[i] = place->slide[0].axis[i];
    }
}

static void make_contact(JpJoint *joint, Place *place, const Side *side, double cfm, double speed)
{
    PlaceRow *row = &place->row;
    const dWorldID world = joint->world->id;
    const double limit = LIMIT_SHARE * dWorldGetContactMaxCorrectingVel(world);
    if (speed > limit) {
        row->pushed = (speed - limit) / cfm;
        direction_push(&place->along, side->sign * row->pushed);
    }
    dContact contact;
    memset(&contact, 0, sizeof contact);
    contact.surface.mode = dContactSoftERP | dContactSoftCFM | dContactMotionN;
    contact.surface.soft_cfm = cfm;
    contact.surface.motionN = fmin(speed, limit);
    contact.geom.pos[0] = place->point.x;
    contact.geom.pos[1] = place->point.y;
    contact.geom.pos[2] = place->point.z;
    if (place->friction > 0.0) {
        add_friction(place, side, &contact);
    }
    // ODE turns the normal where the first body is the world, and so does its feedback
    const double first = joint->bodies[0] != NULL ? 1.0 : -1.0;
    for (int i = 0; i < 3; i++) {
        contact.geom.normal[i] = first * row->axis[i];
    }
    row->contact =
        pressing_row_of_way(world, joint->world->rows, &contact, joint->bodies, &row->feedback);
}

void row_make(JpJoint *joint, Place *place, const Side *side, double cfm, double speed, double step)
{
    PlaceRow *row = &place->row;
    memset(&row->feedback, 0, sizeof row->feedback);
    row->pushed = 0.0;
    const double sign = joint->bodies[0] != NULL ? side->sign : -side->sign;
    for (int i = 0; i < 3; i++) {
        row->axis[i] = sign * place->along.axis[i];
    }
    if (row->motor != NULL) {
        pressing_row_set_axis(row->motor, row->axis[0], row->axis[1], row->axis[2]);
        pressing_row_press(row->motor, cfm, speed, step);
    } else {
        make_contact(joint, place, side, cfm, speed);
    }
}

Vec3 row_force(const JpJoint *joint, const Place *place)
{
    const double first = joint->bodies[0] != NULL ? 1.0 : -1.0;
    const dReal *axis = place->row.axis;
    const Vec3 pushed = vec3_scale(first * place->row.pushed, (Vec3){axis[0], axis[1], axis[2]});
    return vec3_add(pressing_row_force(&place->row.feedback, joint->bodies), pushed);
}

double row_slid(const Place *place, Vec3 force, double step)
{
    double taken = 0.0;
    for (int i = 0; place->friction > 0.0 && i < 2; i++) {
        const Direction *slide = &place->slide[i];
        const double mean = 0.5 * (place->sliding_before[i] + direction_rate(slide));
        taken -= step * mean *
                 (force.x * slide->axis[0] + force.y * slide->axis[1] + force.z * slide->axis[2]);
    }
    return taken;
}

double row_take(Place *place)
{
    PlaceRow *row = &place->row;
    const dReal *found = row->motor != NULL ? row->feedback.t1 : row->feedback.f1;
    if (row->motor != NULL) {
        pressing_row_rest(row->motor);
    }
    row->contact = NULL;
    // rows press or do nothing, but for rounding
    return fmax(dCalcVectorDot3(row->axis, found) + row->pushed, 0.0);
}
