// Finds which bodies follow from which.
//
// n bodies with j joints on one another and on bodies that are determined have 3n unknowns and 2j
// equations: the smallest sets with 3n = 2j are groups (2 bodies with 3 joints: a dyad, 4 with 6).
// Source: L. V. Assur, in J. J. Uicker, G. R. Pennock, J. E. Shigley, Theory of Machines and
// Mechanisms, 4th ed., Oxford 2011. Sets of more than four bodies are not searched for: what is
// left then is one group.
#include "model/groups.h"

enum { SEARCHED_MOST = 4 };

// A linkage whose bodies are determined one after the other.
typedef struct Search {
    const Linkage *linkage;
    bool is_known[KINEMATICS_BODY_MAX];  // determined already
    bool is_chosen[KINEMATICS_BODY_MAX]; // in the set that is looked at
} Search;

static bool is_body_in(const bool *bodies, int body)
{
    return body != LINKAGE_GROUND && bodies[body];
}

static bool is_placed(const Search *search, int body)
{
    return body == LINKAGE_GROUND || search->is_known[body] || search->is_chosen[body];
}

// Whether the joints of the chosen bodies make one piece of them: two pieces, of which one has a
// joint too few and the other one too many, are no group.
static bool is_connected(const Search *search, const Group *group)
{
    const Linkage *linkage = search->linkage;
    bool is_reached[KINEMATICS_BODY_MAX] = {false};
    size_t count = 1;
    is_reached[group->bodies[0]] = true;
    for (bool is_growing = true; is_growing;) {
        is_growing = false;
        for (size_t i = 0; i < group->joint_count; i++) {
            const Joint *joint = &linkage->joints[group->joints[i]];
            const bool is_inside = is_body_in(search->is_chosen, joint->body_a) &&
                                   is_body_in(search->is_chosen, joint->body_b);
            if (is_inside && is_reached[joint->body_a] != is_reached[joint->body_b]) {
                is_reached[joint->body_a] = is_reached[joint->body_b] = true;
                is_growing = true;
                count++;
            }
        }
    }
    return count == group->body_count;
}

// Fills the group with the chosen bodies and the joints that hold them; whether it is one.
static bool make_group(const Search *search, Group *group)
{
    const Linkage *linkage = search->linkage;
    *group = (Group){.body_count = 0};
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (search->is_chosen[i]) {
            group->bodies[group->body_count++] = (int)i;
        }
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool is_its = is_body_in(search->is_chosen, joint->body_a) ||
                            is_body_in(search->is_chosen, joint->body_b);
        if (is_its && is_placed(search, joint->body_a) && is_placed(search, joint->body_b)) {
            group->joints[group->joint_count++] = (int)i;
        }
    }
    return group->body_count > 0 && 3 * group->body_count == 2 * group->joint_count &&
           is_connected(search, group);
}

// Chooses some more bodies from one on, in every way, until they make a group.
static bool choose_bodies(Search *search, size_t from, size_t more, Group *group)
{
    if (more == 0) {
        return make_group(search, group);
    }
    for (size_t i = from; i < search->linkage->body_count; i++) {
        if (search->is_known[i]) {
            continue;
        }
        search->is_chosen[i] = true;
        const bool is_found = choose_bodies(search, i + 1, more - 1, group);
        search->is_chosen[i] = false;
        if (is_found) {
            return true;
        }
    }
    return false;
}

// The smallest group that follows now; where there is no small one all that is left.
static bool find_group(Search *search, Group *group)
{
    for (size_t count = 2; count <= SEARCHED_MOST; count += 2) {
        if (choose_bodies(search, 0, count, group)) {
            return true;
        }
    }
    for (size_t i = 0; i < search->linkage->body_count; i++) {
        search->is_chosen[i] = !search->is_known[i];
    }
    return make_group(search, group);
}

void groups_find(const Linkage *linkage, Groups *groups)
{
    Search search = {.linkage = linkage};
    groups->count = 0;
    search.is_known[linkage_driven_body(linkage)] = true;
    while (groups->count < KINEMATICS_BODY_MAX / 2) {
        Group *group = &groups->groups[groups->count];
        if (!find_group(&search, group)) {
            return;
        }
        groups->count++;
        for (size_t i = 0; i < group->body_count; i++) {
            search.is_known[group->bodies[i]] = true;
        }
    }
}
