// With which mass does a place that touches meet the linkage?
//
// W the mobility along the normals (model/response.h). One place alone: 1 / W_ii. Corners of a
// block that press together share the linkage: corner i that presses with F_i has
//     1 / m_i = sum over k of W_ik F_k / F_i             how fast it gives way to all of them
//     1 / m_i = sum over k of |W_ik| k_k / k_i           the stiffest motion at most (Gershgorin)
// the second for the limits of stability, k_i the slope of its law. In the first no corner counts
// for more than this one, nor one that pushes this one in.
#include "ode/contact_mass.h"

#include <math.h>

const Motion *contact_mass_place(ContactMass *mass)
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
    const bool is_scalar = touch_is_scalar(&mass->world->pairs[number].touch);
    const Vec2 normal = rows[number].normal;
    along[0] = is_scalar ? 1.0 : normal.x;
    along[1] = is_scalar ? 0.0 : normal.y;
    along[2] = along[3] = 0.0;
}

// The masses of a corner beside the others of its block.
static void share_mass(const ContactMass *mass, ContactRow *rows, size_t number)
{
    const int joint = mass->world->pairs[number].joint;
    ContactRow *row = &rows[number];
    const double force = force_law_elastic(&row->law, row->depth);
    const double slope = force_law_tangent(&row->law, row->depth);
    double own[RESPONSE_ROWS_A_JOINT];
    double together = 0.0;
    double stiffest = 0.0;
    set_along(mass, rows, number, own);
    for (size_t i = 0; i < mass->world->pair_count; i++) {
        const ContactRow *other = &rows[i];
        if (mass->world->pairs[i].joint != joint || !other->state.is_touching) {
            continue;
        }
        double along[RESPONSE_ROWS_A_JOINT];
        set_along(mass, rows, i, along);
        const double between =
            response_between(&mass->response, response_first_row(&mass->response, i), along,
                             response_first_row(&mass->response, number), own);
        const double share = force_law_elastic(&other->law, other->depth) / force;
        together += i == number ? between : fmax(0.0, between) * fmin(1.0, share);
        stiffest += fabs(between) * force_law_tangent(&other->law, other->depth) / slope;
    }
    row->mass = 1.0 / together;
    row->stiff_mass = 1.0 / stiffest;
}

void contact_mass_find(ContactMass *mass, ContactRow *rows, size_t number, bool is_exact)
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
    const Vec2 along = is_scalar ? (Vec2){1.0, 0.0} : row->normal;
    row->mass = response_mass(&mass->response, response_first_row(&mass->response, number), along);
    row->stiff_mass = row->mass;
    row->mass_normal = row->normal;
}
