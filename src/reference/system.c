// What do all equations of motion with contacts share?
#include "reference/system.h"

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
