// What the table and the pictures of colliders are made of.
#pragma once

#include "base/text.h"
#include "model/options.h"

enum { COLLIDERS_POINT_MAX = 512 };

// One run of the paper's mechanism, or one set of poses.
typedef struct ColliderPoint {
    OdeCollider collider;
    OdePolygon polygon;
    size_t facets;
    double step_s;
    double error;       // 1, of omega against the reference, up to its horizon
    double processor_s; // of the whole run
} ColliderPoint;

typedef struct ColliderPoints {
    size_t count;
    ColliderPoint points[COLLIDERS_POINT_MAX];
} ColliderPoints;

// The error of the run over the number of facets, by collider and polygon.
void colliders_plot_facets(const ColliderPoints *points, Text *svg);

// Processor time against error, by collider, over steps.
void colliders_plot_cost(const ColliderPoints *points, Text *svg);
