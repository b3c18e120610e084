// Counts what rows of ODE take: n of them that hang together about n^3, by dWorldStep.
#include "world/work.h"

#include "base/union_find.h"

#include <stdlib.h>

// of a body: moved, read and put back
static const double BODY_WORK = 200.0;

double work_of_step(const JpWorld *world)
{
    return BODY_WORK * (double)world->bodies.moving;
}

static size_t touching_rows(const JpJoint *joint)
{
    size_t count = 0;
    for (size_t i = 0; i < joint->place_count; i++) {
        const Place *place = &joint->places[i];
        for (size_t k = 0; k < place_side_count(place); k++) {
            count += !place->sides[k].state.is_touching ? 0 : place->friction > 0.0 ? 3 : 1;
        }
    }
    return count;
}

static size_t number_of(const JpWorld *world, dBodyID body)
{
    return (size_t)(bodies_find(&world->bodies, body) - world->bodies.records);
}

// Joins the bodies that joints of ODE and our pins connect; the world connects nothing.
static void join_bodies(const JpWorld *world, size_t *parents)
{
    union_find_start(parents, world->bodies.count);
    for (size_t i = 0; i < world->bodies.count; i++) {
        const dBodyID body = world->bodies.records[i].id;
        for (int k = 0; k < dBodyGetNumJoints(body); k++) {
            const dJointID joint = dBodyGetJoint(body, k);
            for (int end = 0; end < 2; end++) {
                const dBodyID other = dJointGetBody(joint, end);
                if (other != NULL && bodies_find(&world->bodies, other) != NULL) {
                    union_find_join(parents, i, number_of(world, other));
                }
            }
        }
    }
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        if (joint->bodies[0] != NULL && joint->bodies[1] != NULL && touching_rows(joint) > 0) {
            union_find_join(parents, number_of(world, joint->bodies[0]),
                            number_of(world, joint->bodies[1]));
        }
    }
}

double work_of_rows(const JpWorld *world)
{
    const size_t count = world->bodies.count;
    double work = 0.0;
    double all = 0.0;
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        all += (double)touching_rows(joint);
    }
    // where even one island of all is within the limit, there is no need to look closer
    const bool is_little = world->options.is_quick || all * all * all <= world->work_most;
    // without memory for that, they count as one island
    size_t *parents = is_little ? NULL : malloc((2 * count + 1) * sizeof *parents);
    if (parents == NULL) {
        return world->options.is_quick ? all : all * all * all;
    }
    size_t *rows = parents + count;
    join_bodies(world, parents);
    for (size_t i = 0; i < count; i++) {
        rows[i] = 0;
    }
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        const dBodyID body = joint->bodies[joint->bodies[0] != NULL ? 0 : 1];
        rows[union_find_root(parents, number_of(world, body))] += touching_rows(joint);
    }
    for (size_t i = 0; i < count; i++) {
        const double own = (double)rows[i];
        work += own * own * own;
    }
    free(parents);
    return work;
}
