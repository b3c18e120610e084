// Which mass does a pin in space meet at a place of its hole?
//
// Two ends of one hole that press together share the mass m of the linkage: an end i that presses
// with F_i has
//     1 / m_i = W_ii + sum_j max(0, W_ij) min(1, F_j / F_i)
// with W_ij the mobility between the normals of places i and j, so that both ends of a pin that is
// not tilted oscillate as one contact of the whole law on m. For a map's limit of stability it is
// the stiffest motion of the two that counts, at most 1 / m_i = sum_j |W_ij| k_j / k_i.
#include "ode/space_contact_mass.h"

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
        places |= contacts->contacts[i].state.is_touching ? 1U << contacts->places[i].place : 0;
    }
    return places;
}

// Whether the masses of a place are to be brought up to date: they change as slowly as the linkage
// turns, or when another place of the joint comes to touch.
static bool needs_mass(const SpaceContacts *contacts, size_t number)
{
    static const double SAME_NORMAL = 0.995; // the cosine of 6 degrees
    const SpaceContact *contact = &contacts->contacts[number];
    return contact->state.is_touching &&
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
        if (contact->state.is_touching) {
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
    const double force = force_law_elastic(law, contact->depth);
    const double stiffness = force_law_tangent(law, contact->depth);
    double together = mobility_between(contacts, number, number);
    double stiffest = 0.0;
    const size_t end = end_of_joint(contacts, number);
    for (size_t k = first_of_joint(contacts, number); k < end; k++) {
        const SpaceContact *other = &contacts->contacts[k];
        const ForceLaw *of = &contacts->places[k].law;
        if (!other->state.is_touching) {
            continue;
        }
        const double between = mobility_between(contacts, number, k);
        const double share = force_law_elastic(of, other->depth) / force;
        together += k == number ? 0.0 : fmax(0.0, between) * fmin(1.0, share);
        stiffest += fabs(between) * force_law_tangent(of, other->depth) / stiffness;
    }
    contact->mass = 1.0 / together;
    contact->stiff_mass = 1.0 / stiffest;
    contact->mass_normal = contact->pose.normal;
    contact->mass_places = touching_places(contacts, number);
}

void space_contact_mass_find(SpaceContacts *contacts, const SpaceMotion *motions)
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
            if (contacts->contacts[k].state.is_touching) {
                find_mass(contacts, k);
            }
        }
    }
}
