// Finds the contact of a pin with a ring of convex staves by libccd directly, so that contacts of a
// micron are found: by its Minkowski portal refinement (MPR), or by GJK and expanding polytopes
// (EPA).
//
// A stave is a prism, its inner face one side of the polygon. Three things make the difference.
// Units: libccd compares lengths with absolute tolerances and with 2.2e-16; lengths are given in
// units of R / 5000 (1 um for a hole of 5 mm), tolerances in the same. Origin: differences of large
// coordinates lose digits; the origin is the pin's centre, the axes are the stave's, and the stave
// moves by the pin's small coordinates. Centres: portal refinement starts along the line between
// the two bodies' centres and measures the depth along what it finds there; the stave's centre is
// put on the normal of its face through the pin's centre.
//
// GJK and EPA need two things more. Where bodies hardly touch their answer is arbitrary: the stave
// is moved nearer by a margin, which is taken off the depth. And about once in 6,000 queries they
// send the pin out through the stave or along its axis, by millimetres: such an answer is known by
// its direction, and asked for again with twice the margin.
//
// Source: G. Snethen, XenoCollide, Game Programming Gems 7 (2008); libccd 2.1, mpr.c and ccd.c.
#include "ode/plane/collider.h"

#include <assert.h>
#include <ccd/ccd.h>
#include <ccd/vec3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STAVE_CORNERS = 8, ITERATIONS_MOST = 200, ATTEMPTS_MOST = 4 };

// units to the hole's radius
static const double UNITS = 5000.0;

// in units: smaller ones change no digit that rounding leaves
static const double TOLERANCE = 1e-6;

// in units: 100 times the band about touching in which EPA's answers are arbitrary
static const double MARGIN = 0.025;

// thickness of a stave, of the hole's radius
static const double STAVE_THICKNESS = 1.0;

typedef struct Stave {
    ccd_vec3_t corners[STAVE_CORNERS];
    ccd_vec3_t centre;
} Stave;

typedef struct Pin {
    double radius;
    double half_length;
} Pin;

typedef struct Staves {
    PolygonHole polygon;
    double unit; // m
    Stave stave; // for a pin in the hole's centre
    Pin pin;
} Staves;

static void stave_support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const Stave *stave = object;
    double most = -INFINITY;
    for (int i = 0; i < STAVE_CORNERS; i++) {
        const double along = ccdVec3Dot(&stave->corners[i], direction);
        if (along > most) {
            most = along;
            *point = stave->corners[i];
        }
    }
}

static void stave_centre(const void *object, ccd_vec3_t *centre)
{
    const Stave *stave = object;
    *centre = stave->centre;
}

static void pin_support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const Pin *pin = object;
    const double x = ccdVec3X(direction);
    const double y = ccdVec3Y(direction);
    const double across = sqrt(x * x + y * y);
    const double share = across > 0.0 ? pin->radius / across : 0.0;
    ccdVec3Set(point, share * x, share * y, copysign(pin->half_length, ccdVec3Z(direction)));
}

static void pin_centre(const void *object, ccd_vec3_t *centre)
{
    (void)object;
    ccdVec3Set(centre, 0.0, 0.0, 0.0);
}

static void *staves_open(const Scenario *scenario, int joint)
{
    Staves *staves = calloc(1, sizeof *staves);
    assert(staves != NULL);
    staves->polygon = polygon_hole_of_joint(scenario, joint);
    const PolygonHole *polygon = &staves->polygon;
    staves->unit = polygon->hole_radius / UNITS;
    const double inner = polygon->facets.inradius / staves->unit;
    const double outer = inner + STAVE_THICKNESS * UNITS;
    const double height = polygon->half_height / staves->unit;
    const double widening = tan(0.5 * polygon->facets.pitch);
    for (int i = 0; i < STAVE_CORNERS; i++) {
        const double x = (i & 1) != 0 ? outer : inner;
        ccdVec3Set(&staves->stave.corners[i], x, (i & 2) != 0 ? x * widening : -x * widening,
                   (i & 4) != 0 ? height : -height);
    }
    ccdVec3Set(&staves->stave.centre, 0.5 * (inner + outer), 0.0, 0.0);
    // shorter than the staves by their overhang
    staves->pin = (Pin){polygon->pin_radius / staves->unit, 0.9 * height};
    return staves;
}

static void staves_close(void *state)
{
    free(state);
}

typedef int Query(const void *stave, const void *pin, const ccd_t *ccd, ccd_real_t *depth,
                  ccd_vec3_t *direction, ccd_vec3_t *position);

static ccd_t settings(void)
{
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = stave_support;
    ccd.support2 = pin_support;
    ccd.center1 = stave_centre;
    ccd.center2 = pin_centre;
    ccd.max_iterations = ITERATIONS_MOST;
    ccd.mpr_tolerance = TOLERANCE;
    ccd.epa_tolerance = TOLERANCE;
    return ccd;
}

// The stave as the pin in the origin sees it, nearer by a margin. Its centre keeps the pin's y, 0:
// the ray between the centres is the face's normal.
static Stave seen_from_pin(const Staves *staves, const PolygonSide *side, double margin)
{
    const double x = side->pin.x / staves->unit + margin;
    const double y = side->pin.y / staves->unit;
    Stave stave = staves->stave;
    for (int i = 0; i < STAVE_CORNERS; i++) {
        stave.corners[i].v[0] -= x;
        stave.corners[i].v[1] -= y;
    }
    stave.centre.v[0] -= x;
    return stave;
}

// The pin gets free towards the hole's centre, along -x.
static bool is_sane(const ccd_vec3_t *direction)
{
    static const double COSINE_LEAST = 0.5;
    return -ccdVec3X(direction) > COSINE_LEAST;
}

static bool ask(const Staves *staves, const PolygonSide *side, Query *query, Collision *collision)
{
    const ccd_t ccd = settings();
    double margin = MARGIN;
    for (int attempt = 0; attempt < ATTEMPTS_MOST; attempt++, margin *= 2.0) {
        const Stave stave = seen_from_pin(staves, side, margin);
        ccd_real_t depth;
        ccd_vec3_t direction;
        ccd_vec3_t position;
        if (query(&stave, &staves->pin, &ccd, &depth, &direction, &position) != 0) {
            return false;
        }
        if (is_sane(&direction)) {
            *collision =
                polygon_hole_collision(&staves->polygon, side, (depth - margin) * staves->unit,
                                       (Vec2){ccdVec3X(&direction), ccdVec3Y(&direction)});
            return collision->depth > 0.0;
        }
    }
    return false;
}

static bool staves_find_mpr(void *state, dGeomID hole, dGeomID pin, Collision *collision)
{
    const Staves *staves = state;
    PolygonSide side;
    return polygon_hole_side(&staves->polygon, hole, pin, &side) &&
           ask(staves, &side, ccdMPRPenetration, collision);
}

static bool staves_find_gjk(void *state, dGeomID hole, dGeomID pin, Collision *collision)
{
    const Staves *staves = state;
    PolygonSide side;
    return polygon_hole_side(&staves->polygon, hole, pin, &side) &&
           ask(staves, &side, ccdGJKPenetration, collision);
}

const Collider collider_staves = {
    .check = facets_check,
    .open = staves_open,
    .find = staves_find_mpr,
    .close = staves_close,
};

const Collider collider_staves_gjk = {
    .check = facets_check,
    .open = staves_open,
    .find = staves_find_gjk,
    .close = staves_close,
};
