// Implements what all equations of motion with contacts share: the coordinates that each contact
// depends on, and the limit of its depth.
#include "reference/system.h"

#include "base/zeroed.h"
#include "contact/law.h"

SystemState *system_state_create(const System *system)
{
    return system->kind->state_create(system);
}

bool system_check_depth(const System *system, const SystemState *state, double share, Err *err)
{
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        const Joint *joint = &system->scenario->linkage.joints[contact->joint];
        if (!law_check_depth(&contact->law, joint, state->contacts[i].depth, share, err)) {
            return false;
        }
    }
    return true;
}

// A contact that hangs on more coordinates takes them all: lists of long chains would fill a
// square.
enum { NEEDS_MOST = 32 };

void system_find_needs(System *system)
{
    const size_t n = system->coordinate_count;
    size_t *found = zeroed(2 * n, sizeof *found);
    system->need_firsts = zeroed(system->contact_count + 1, sizeof *system->need_firsts);
    system->needs = zeroed(2 * NEEDS_MOST * system->contact_count, sizeof *system->needs);
    size_t used = 0;
    for (size_t i = 0; i < system->contact_count; i++) {
        const size_t count = system->kind->needs(system, i, found);
        for (size_t k = 0; k < count && count <= NEEDS_MOST; k++) {
            system->needs[used++] = found[k];
            system->needs[used++] = n + found[k];
        }
        system->need_firsts[i + 1] = used;
    }
    free(found);
}

void system_free_needs(System *system)
{
    free(system->need_firsts);
    free(system->needs);
}

// The integrator's vector at a time in the tried step, as far as a contact depends on it.
static const double *needed_at(const System *system, Dop853 *integrator, size_t contact,
                               double time)
{
    const size_t first = system->need_firsts[contact];
    const size_t count = system->need_firsts[contact + 1] - first;
    if (time == integrator->time) {
        return integrator->y;
    }
    return count > 0 ? dop853_dense_some(integrator, time, system->needs + first, count)
                     : dop853_dense(integrator, time);
}

Press system_press(const System *system, Dop853 *integrator, size_t contact, double time)
{
    return system->kind->press(system, contact, time, needed_at(system, integrator, contact, time));
}

WallPlace system_wall(const System *system, Dop853 *integrator, size_t contact, double time)
{
    return system->kind->wall(system, contact, time, needed_at(system, integrator, contact, time));
}

void system_find_places(System *system, const double *y)
{
    for (size_t i = 0; i < system->contact_count; i++) {
        Contact *contact = &system->contacts[i];
        if (contact->mode == CONTACT_APART) {
            continue;
        }
        if (contact->has_walls) {
            contact->wall = system->kind->wall(system, i, 0.0, y).wall;
        }
        contact->is_growing =
            system->kind->press(system, i, 0.0, y).depth < contact->law.full_damping_depth;
    }
}

void system_take_contacts(System *system)
{
    for (size_t i = 0; i < system->contact_count; i++) {
        Contact *contact = &system->contacts[i];
        const Joint *joint = &system->scenario->linkage.joints[contact->joint];
        const ContactState *state = &joint->contacts[contact->place];
        if (state->is_touching) {
            contact_begin(contact, -state->age_s, state->impact_speed);
            contact->mode = state->is_slack ? CONTACT_SLACK : CONTACT_PRESSING;
            contact->is_released = state->is_released;
            if (state->is_resting) {
                contact_rest(contact);
            }
        }
    }
}

void system_give_contacts(const System *system, double time_s, ContactState (*states)[JOINT_PLACES])
{
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        ContactState *state = &states[contact->joint][contact->place];
        *state = (ContactState){.is_touching = contact->mode != CONTACT_APART};
        if (state->is_touching) {
            *state = contact_state_begun(contact->impact_speed);
            state->is_slack = contact->mode == CONTACT_SLACK;
            state->is_released = contact->is_released;
            state->age_s = time_s - contact->onset_s;
            if (contact->is_resting) {
                contact_state_rest(state, contact->law.resting_speed);
            }
        }
    }
}

void system_carry(System *system, Carry *carry)
{
    for (size_t i = 0; i < system->contact_count; i++) {
        Contact *contact = &system->contacts[i];
        CARRY(carry, contact->mode);
        CARRY(carry, contact->wall);
        CARRY(carry, contact->onset_s);
        CARRY(carry, contact->impact_speed);
        CARRY(carry, contact->damping_rate);
        CARRY(carry, contact->is_growing);
        CARRY(carry, contact->is_released);
        CARRY(carry, contact->is_resting);
    }
    for (size_t i = 0; i < system->bristle_count; i++) {
        CARRY(carry, system->bristles[i].mode);
        CARRY(carry, system->bristles[i].face);
        CARRY(carry, system->bristles[i].pair.damping);
    }
    CARRY(carry, system->side);
    CARRY(carry, system->is_astray);
    CARRY(carry, system->torn);
    system->kind->carry(system, carry);
}
