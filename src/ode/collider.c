// Which colliders are there?
#include "ode/collider.h"

#include <assert.h>

#define MEMBER_COLLIDER(id, word, collider) &collider,

const Collider *collider_get(OdeCollider kind)
{
    static const Collider *const COLLIDERS[] = {OPTIONS_ODE_COLLIDER_LIST(MEMBER_COLLIDER)};
    assert(kind < ODE_COLLIDER_COUNT);
    return COLLIDERS[kind];
}
