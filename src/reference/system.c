// What do all equations of motion with contacts share?
#include "reference/system.h"

#include "contact/law.h"

#include <assert.h>
#include <stdlib.h>

SystemState *system_state_create(const System *system)
{
    SystemState *state = calloc(1, system->kind->state_size);
    assert(state != NULL);
    return state;
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
