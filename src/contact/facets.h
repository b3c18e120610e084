// The polygon that stands for a round hole in a collider that knows flat faces only: how many sides
// it needs, what it then gets wrong, and whether the collider can see contacts that small at all.
#pragma once

#include "base/err.h"
#include "model/scenario.h"

enum {
    FACETS_LEAST = 8,
    FACETS_MOST = 16384, // ODE returns at most 65535 contacts, up to four a facet of a mesh
};

// A regular polygon around the centre of a hole; the normal of the first side is along x.
typedef struct Facets {
    size_t count;
    double pitch;    // rad, from one side to the next
    double inradius; // m, from the centre to the middle of a side
    double sagitta;  // m, between the circle and the polygon where they are furthest apart
} Facets;

// The polygon with that many sides of a hole.
Facets facets_polygon(OdePolygon polygon, size_t count, double hole_radius);

// The number of sides with a sagitta of at most that, m.
size_t facets_needed(double hole_radius, double sagitta);

// The smallest depth, m, that a collider is sure to notice in a hole of that radius, m. Where it
// notices a contact, depth and the side's own depth differ by no more.
double facets_resolution(OdeCollider collider, double hole_radius);

// The depth to be expected of a joint's contacts, m: of an undamped impact of the linkage's
// effective mass after a fall through the whole play, at the start. 0 where no law says it.
double facets_expected_depth(const Scenario *scenario, int joint);

// Whether a collider can do with a joint with play: ODE_COLLIDER_PIN_HOLE always. Fails with
// ERR_CASE where it cannot resolve the play or the depth to be expected, where more sides would be
// needed than FACETS_MOST, and where the pin does not fit into the polygon.
bool facets_check(const Scenario *scenario, int joint, Err *err);

// The polygon of a joint with play, by the scenario's options.
Facets facets_of_joint(const Scenario *scenario, int joint);
