// Has what a caller's world holds besides ODE's.
#include "world/fault.h"
#include "world/listing.h"
#include "world/response_cache.h"
#include "world/threads.h"

#include <math.h>
#include <stdlib.h>

JpWorldOptions jp_world_options_default(void)
{
    return (JpWorldOptions){
        .stepping = JP_STEPPING_STAGGERED,
        .surface = {.mode = dContactApprox1, .mu = 0.5},
    };
}

// What a world has of ODE. Returns false where that has no memory.
static bool make_groups(JpWorld *world)
{
    Fault fault;
    fault_begin(&fault);
    if (setjmp(fault.left) == 0) {
        world->rows = dJointGroupCreate(0);
        world->contacts = dJointGroupCreate(0);
        threads_begin(world);
        fault_end(&fault);
        return true;
    }
    fault_end(&fault);
    return false;
}

// Gives all back that a world has, whether it was made or not.
static void finish_world(JpWorld *world)
{
    if (world->rows != NULL) {
        dJointGroupDestroy(world->rows);
    }
    if (world->contacts != NULL) {
        dJointGroupDestroy(world->contacts);
    }
    threads_end(world);
    fault_release();
    free(world);
}

JpStatus jp_world_create(dWorldID id, const JpWorldOptions *options, JpWorld **created,
                         JpError *error)
{
    REFUSAL_TRY(refusal_of_null(id, "the world", error));
    REFUSAL_TRY(refusal_of_null(created, "the pointer for the world", error));
    const JpWorldOptions chosen = options != NULL ? *options : jp_world_options_default();
    if ((unsigned)chosen.stepping > JP_STEPPING_IMPULSE) {
        return refusal(error, JP_ERROR_ARGUMENT, "the stepping is %d, which is no JpStepping",
                       (int)chosen.stepping);
    }
    if (chosen.stepping == JP_STEPPING_IMPULSE && chosen.is_quick) {
        return refusal(
            error, JP_ERROR_ARGUMENT,
            "JP_STEPPING_IMPULSE compares steps of the world with each other, which those "
            "of dWorldQuickStep are too rough for; set is_quick to false");
    }
    JpWorld *world = calloc(1, sizeof *world);
    if (world == NULL) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for a world");
    }
    world->id = id;
    world->options = chosen;
    world->work_most = JP_WORK_DEFAULT;
    fault_hold();
    if (!make_groups(world)) {
        finish_world(world);
        return refusal(error, JP_ERROR_MEMORY, "ODE has no memory for a world's joints");
    }
    *created = world;
    return refusal_none(error);
}

void jp_world_destroy(JpWorld *world)
{
    if (world == NULL) {
        return;
    }
    while (world->joints != NULL) {
        jp_joint_destroy(world->joints);
    }
    bodies_finish(&world->bodies);
    response_cache_free(world->cache);
    if (world->kernel != NULL) {
        kernel_finish(world->kernel);
    }
    free(world->kernel);
    finish_world(world);
}

static JpStatus check_body(const JpWorld *world, dBodyID body, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(refusal_of_null(body, "the body", error));
    return dBodyGetWorld(body) == world->id
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT, "the body is in another world");
}

JpStatus jp_world_add_body(JpWorld *world, dBodyID body, JpError *error)
{
    REFUSAL_TRY(check_body(world, body, error));
    BodyRecord *record = bodies_add(&world->bodies, body);
    if (record == NULL) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for a body");
    }
    record->is_added = true;
    world->found.is_kept = false;
    return refusal_none(error);
}

JpStatus jp_world_add_all(JpWorld *world, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    world->found.is_kept = false;
    return listing_add_all(world, error);
}

JpStatus jp_world_remove_body(JpWorld *world, dBodyID body, JpError *error)
{
    REFUSAL_TRY(check_body(world, body, error));
    BodyRecord *record = bodies_find(&world->bodies, body);
    if (record == NULL || !record->is_added) {
        return refusal(error, JP_ERROR_ARGUMENT, "the body was not added");
    }
    world->found.is_kept = false;
    record->is_added = false; // and is forgotten by the next gathering, unless joints lead to it
    return refusal_none(error);
}

JpStatus jp_world_set_work_limit(JpWorld *world, double work, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(refusal_of_positive(work, "the limit of work", error));
    world->work_most = work;
    return refusal_none(error);
}

JpStatus jp_world_stats(const JpWorld *world, JpWorldStats *stats, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(refusal_of_null(stats, "the counts", error));
    *stats = world->stats;
    return refusal_none(error);
}
