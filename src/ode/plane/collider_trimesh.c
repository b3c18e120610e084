// Finds the contact of a pin with a hole that is a mesh of triangles.
//
// Two triangles a facet, their normals towards the axis. ODE asks every triangle that the pin's box
// meets, in single precision inside its tree of boxes and for the vertices, and returns contacts of
// all that it overlaps, in no order: the deepest counts. Debian's ODE has OPCODE built in.
#include "ode/plane/collider.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// at most that many contacts a facet were seen, in the half of the wall that a pin can reach
enum { CONTACTS_A_FACET = 4, CONTACTS_LEAST = 64, CONTACTS_MOST = 65535 };

typedef struct Trimesh {
    PolygonHole polygon;
    dReal *vertices;      // three each, two a corner of the polygon; kept by ODE
    dTriIndex *triangles; // likewise
    dTriMeshDataID data;
    dGeomID geom;
    int contact_room;
    dContactGeom *contacts;
} Trimesh;

static void make_mesh(Trimesh *trimesh)
{
    const PolygonHole *polygon = &trimesh->polygon;
    const size_t count = polygon->facets.count;
    const double corner_radius = polygon->facets.inradius / cos(0.5 * polygon->facets.pitch);
    for (size_t i = 0; i < count; i++) {
        const double angle = ((double)i + 0.5) * polygon->facets.pitch;
        for (size_t k = 0; k < 2; k++) {
            dReal *vertex = &trimesh->vertices[3 * (2 * i + k)];
            vertex[0] = corner_radius * cos(angle);
            vertex[1] = corner_radius * sin(angle);
            vertex[2] = k == 0 ? -polygon->half_height : polygon->half_height;
        }
        const dTriIndex here = (dTriIndex)(2 * i);
        const dTriIndex next = (dTriIndex)(2 * ((i + 1) % count));
        dTriIndex *triangles = &trimesh->triangles[6 * i];
        triangles[0] = here;
        triangles[1] = here + 1;
        triangles[2] = next;
        triangles[3] = next;
        triangles[4] = here + 1;
        triangles[5] = next + 1;
    }
}

static void *trimesh_open(const Scenario *scenario, int joint)
{
    Trimesh *trimesh = calloc(1, sizeof *trimesh);
    assert(trimesh != NULL);
    trimesh->polygon = polygon_hole_of_joint(scenario, joint);
    const size_t count = trimesh->polygon.facets.count;
    trimesh->vertices = calloc(6 * count, sizeof *trimesh->vertices);
    trimesh->triangles = calloc(6 * count, sizeof *trimesh->triangles);
    const size_t room = CONTACTS_A_FACET * count + CONTACTS_LEAST;
    trimesh->contact_room = room < CONTACTS_MOST ? (int)room : CONTACTS_MOST;
    trimesh->contacts = calloc((size_t)trimesh->contact_room, sizeof *trimesh->contacts);
    assert(trimesh->vertices != NULL && trimesh->triangles != NULL && trimesh->contacts != NULL);
    make_mesh(trimesh);
    trimesh->data = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(trimesh->data, trimesh->vertices, 3 * sizeof(dReal),
                                (int)(2 * count), trimesh->triangles, (int)(6 * count),
                                3 * sizeof(dTriIndex));
    trimesh->geom = dCreateTriMesh(0, trimesh->data, NULL, NULL, NULL);
    return trimesh;
}

static bool trimesh_find(void *state, dGeomID hole, dGeomID pin, Collision *collision)
{
    const Trimesh *trimesh = state;
    PolygonSide side;
    if (!polygon_hole_side(&trimesh->polygon, hole, pin, &side)) {
        return false;
    }
    const dReal *centre = dGeomGetPosition(hole);
    dGeomSetPosition(trimesh->geom, centre[0], centre[1], centre[2]);
    dGeomSetRotation(trimesh->geom, dGeomGetRotation(hole));
    const int count = dCollide(trimesh->geom, pin, trimesh->contact_room, trimesh->contacts,
                               sizeof *trimesh->contacts);
    const dContactGeom *deepest = NULL;
    for (int i = 0; i < count; i++) {
        if (deepest == NULL || trimesh->contacts[i].depth > deepest->depth) {
            deepest = &trimesh->contacts[i];
        }
    }
    if (deepest == NULL || !(deepest->depth > 0.0)) {
        return false;
    }
    *collision = polygon_hole_contact(deepest, hole, pin);
    return true;
}

static void trimesh_close(void *state)
{
    Trimesh *trimesh = state;
    if (trimesh != NULL) {
        dGeomDestroy(trimesh->geom);
        dGeomTriMeshDataDestroy(trimesh->data);
        free(trimesh->vertices);
        free(trimesh->triangles);
        free(trimesh->contacts);
        free(trimesh);
    }
}

const Collider collider_trimesh = {
    .check = facets_check,
    .open = trimesh_open,
    .find = trimesh_find,
    .close = trimesh_close,
};
