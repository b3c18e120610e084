// Keeps what a step changes, and undoes all of it.
//
// Bodies, the joints with play, the settings of ODE that single steps within it set aside, and what
// is remembered from step to step, which is forgotten. What ODE alone keeps, such as the time after
// which a body at rest is disabled, stays as it is.
#include "world/found.h"

#include "world/friction.h"
#include "world/pressing_row.h"
#include "world/response_cache.h"

#include <stdlib.h>
#include <string.h>

static void keep_joint(JpJoint *joint)
{
    JointFound *found = &joint->found;
    found->rotor = joint->rotor;
    found->force = joint->force;
    found->last = joint->coordinate.last;
    found->rub = joint->rub.found;
    for (size_t i = 0; i < joint->place_count; i++) {
        const Place *place = &joint->places[i];
        memcpy(found->places[i].sides, place->sides, sizeof place->sides);
        memcpy(found->places[i].inside, place->inside, sizeof place->inside);
        found->places[i].slid = place->slid;
    }
}

static void put_back_joint(JpJoint *joint)
{
    const JointFound *found = &joint->found;
    joint->rotor = found->rotor;
    joint->force = found->force;
    joint->coordinate.last = found->last;
    joint->rub.found = found->rub;
    if (joint->kind == PLAY_FRICTION) {
        friction_rest(joint);
    }
    for (size_t i = 0; i < joint->place_count; i++) {
        Place *place = &joint->places[i];
        memcpy(place->sides, found->places[i].sides, sizeof place->sides);
        memcpy(place->inside, found->places[i].inside, sizeof place->inside);
        place->slid = found->places[i].slid;
        place->row.contact = NULL;
        if (place->row.motor != NULL) {
            pressing_row_rest(place->row.motor);
        }
    }
}

void found_keep(JpWorld *world)
{
    WorldFound *found = &world->found;
    found->is_kept = false;
    found->last_step = world->last_step;
    found->flown = world->flown;
    dWorldGetGravity(world->id, found->gravity);
    found->erp = dWorldGetERP(world->id);
    found->stats = world->stats;
    found->pause = world->pause;
    bodies_find_all(&world->bodies);
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        keep_joint(joint);
    }
}

void found_put_back(JpWorld *world, WorldResponse *response)
{
    const WorldFound *found = &world->found;
    closing_put_back(&response->closing);
    dWorldSetGravity(world->id, found->gravity[0], found->gravity[1], found->gravity[2]);
    dWorldSetERP(world->id, found->erp);
    world->last_step = found->last_step;
    world->flown = found->flown;
    world->stats = found->stats;
    world->pause = found->pause;
    bodies_put_back_all(&world->bodies);
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        put_back_joint(joint);
    }
    free(world->settling);
    world->settling = NULL;
    response_cache_free(world->cache);
    world->cache = NULL;
    if (world->kernel != NULL) {
        kernel_finish(world->kernel);
    }
}
