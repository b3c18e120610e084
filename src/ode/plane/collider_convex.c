// Finds the contact of a pin with a ring of staves through ODE.
//
// A stave is a dConvex, the pin a dCylinder; dCollide hands both to libccd in metres, in the
// world's coordinates, with an absolute tolerance of 1e-6 m that no program can change. All staves
// of a ring are alike: one geom is put where the stave stands that faces the pin. A whole ring in a
// space would answer the same and ask for nearly all N staves, because the pin's box meets their
// boxes.
#include "ode/plane/collider.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum { CONVEX_CORNERS = 8, CONVEX_FACES = 6 };

// thickness of a stave, of the hole's radius
static const double CONVEX_THICKNESS = 1.0;

// corner i: inner or outer, right or left, low or high by its bits; each face counter-clockwise
// from outside, its number of corners first
static const unsigned FACES[] = {4, 0, 4, 6, 2, 4, 1, 3, 7, 5, 4, 2, 6, 7, 3,
                                 4, 0, 1, 5, 4, 4, 4, 5, 7, 6, 4, 0, 2, 3, 1};

typedef struct Convex {
    PolygonHole polygon;
    double reach; // m, from the hole's centre to the stave's own origin
    // ODE keeps pointers to these: normal and distance of each face, corners, faces
    dReal planes[4 * CONVEX_FACES];
    dReal corners[3 * CONVEX_CORNERS];
    unsigned faces[sizeof FACES / sizeof FACES[0]];
    dGeomID geom;
} Convex;

static void set_plane(Convex *convex, int face, double x, double y, double z)
{
    // through the first corner of the face
    const dReal *corner = &convex->corners[(size_t)3 * FACES[5 * face + 1]];
    dReal *plane = &convex->planes[4 * face];
    plane[0] = x;
    plane[1] = y;
    plane[2] = z;
    plane[3] = x * corner[0] + y * corner[1] + z * corner[2];
}

// The stave about the middle of its own thickness, its inner face towards -x.
static void make_stave(Convex *convex)
{
    const PolygonHole *polygon = &convex->polygon;
    const double inner = polygon->facets.inradius;
    const double outer = inner + CONVEX_THICKNESS * polygon->hole_radius;
    const double half = 0.5 * polygon->facets.pitch;
    convex->reach = 0.5 * (inner + outer);
    for (int i = 0; i < CONVEX_CORNERS; i++) {
        const double x = (i & 1) != 0 ? outer : inner;
        dReal *corner = &convex->corners[3 * i];
        corner[0] = x - convex->reach;
        corner[1] = (i & 2) != 0 ? x * tan(half) : -x * tan(half);
        corner[2] = (i & 4) != 0 ? polygon->half_height : -polygon->half_height;
    }
    set_plane(convex, 0, -1.0, 0.0, 0.0);
    set_plane(convex, 1, 1.0, 0.0, 0.0);
    set_plane(convex, 2, -sin(half), cos(half), 0.0);
    set_plane(convex, 3, -sin(half), -cos(half), 0.0);
    set_plane(convex, 4, 0.0, 0.0, 1.0);
    set_plane(convex, 5, 0.0, 0.0, -1.0);
}

static void *convex_open(const Scenario *scenario, int joint)
{
    Convex *convex = calloc(1, sizeof *convex);
    assert(convex != NULL);
    convex->polygon = polygon_hole_of_joint(scenario, joint);
    make_stave(convex);
    for (size_t i = 0; i < sizeof FACES / sizeof FACES[0]; i++) {
        convex->faces[i] = FACES[i];
    }
    convex->geom = dCreateConvex(0, convex->planes, CONVEX_FACES, convex->corners, CONVEX_CORNERS,
                                 convex->faces);
    return convex;
}

static bool convex_find(void *state, dGeomID hole, dGeomID pin, Collision *collision)
{
    const Convex *convex = state;
    PolygonSide side;
    if (!polygon_hole_side(&convex->polygon, hole, pin, &side)) {
        return false;
    }
    const dReal *centre = dGeomGetPosition(hole);
    const Vec2 x = side.outward;
    const dMatrix3 rotation = {x.x, -x.y, 0.0, 0.0, x.y, x.x, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    dGeomSetPosition(convex->geom, centre[0] + convex->reach * x.x, centre[1] + convex->reach * x.y,
                     0.0);
    dGeomSetRotation(convex->geom, rotation);
    dContactGeom geom;
    if (dCollide(convex->geom, pin, 1, &geom, sizeof geom) == 0) {
        return false;
    }
    *collision = polygon_hole_contact(&geom, hole, pin);
    return collision->depth > 0.0;
}

static void convex_close(void *state)
{
    Convex *convex = state;
    if (convex != NULL) {
        dGeomDestroy(convex->geom);
        free(convex);
    }
}

const Collider collider_convex = {
    .check = facets_check,
    .open = convex_open,
    .find = convex_find,
    .close = convex_close,
};
