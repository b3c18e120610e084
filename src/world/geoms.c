// Finds the bodies of a caller's space, and makes the contacts of its geoms.
#include "world/geoms.h"

#include <string.h>

enum { CONTACTS_MOST = 16 }; // of two geoms: boxes have eight

static void touch(void *data, dGeomID first, dGeomID second)
{
    JpWorld *world = data;
    if (dGeomIsSpace(first) || dGeomIsSpace(second)) {
        dSpaceCollide2(first, second, data, touch);
        return;
    }
    const dBodyID bodies[2] = {dGeomGetBody(first), dGeomGetBody(second)};
    if (bodies[0] == bodies[1] ||
        (bodies[0] != NULL && bodies[1] != NULL &&
         dAreConnectedExcluding(bodies[0], bodies[1], dJointTypeContact))) {
        return;
    }
    dContact contacts[CONTACTS_MOST];
    memset(contacts, 0, sizeof contacts);
    const int count =
        dCollide(first, second, CONTACTS_MOST, &contacts[0].geom, (int)sizeof *contacts);
    for (int i = 0; i < count; i++) {
        contacts[i].surface = world->options.surface;
        const dJointID joint = dJointCreateContact(world->id, world->contacts, &contacts[i]);
        dJointAttach(joint, bodies[0], bodies[1]);
    }
}

void geoms_touch(JpWorld *world)
{
    if (world->options.space != NULL) {
        dSpaceCollide(world->options.space, world, touch);
    }
}

static size_t list_space(dSpaceID space, dWorldID world, dBodyID *bodies, size_t listed)
{
    const int count = dSpaceGetNumGeoms(space);
    for (int i = 0; i < count; i++) {
        const dGeomID geom = dSpaceGetGeom(space, i);
        if (dGeomIsSpace(geom)) {
            listed = list_space((dSpaceID)geom, world, bodies, listed);
            continue;
        }
        const dBodyID body = dGeomGetBody(geom);
        if (body != NULL && dBodyGetWorld(body) == world) {
            if (bodies != NULL) {
                bodies[listed] = body;
            }
            listed++;
        }
    }
    return listed;
}

size_t geoms_list(const JpWorld *world, dBodyID *bodies)
{
    const dSpaceID space = world->options.space;
    return space == NULL ? 0 : list_space(space, world->id, bodies, 0);
}
