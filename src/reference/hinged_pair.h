// A driven body, a body on a hinge of the ground, one on a hinge of that, and a pin in a hole
// between the last and the driven one: the commonest mechanism, a four-bar with play in one pin.
#pragma once

#include "reference/hinged_bodies.h"

// An end of a pair that touches.
typedef struct HingedEnd {
    HingedBody *body; // NULL: the ground
    bool is_driven;   // whether that is the driven one
    const Vec2 *base; // m, from the centre to the end, at the base
    Vec2 arm;
} HingedEnd;

typedef struct HingedPin {
    const Contact *contact;
    const Vec2 *gap; // m, from the hole's centre to the pin's, at the base
    HingedEnd ends[2];
} HingedPin;

struct Hinged {
    const Dynamics *dynamics;
    HingedBody *driven; // or NULL
    HingedBody *bodies; // that are free, parents before children
    size_t count;
    size_t pin_count;
    HingedPin *pins;
    // of a steady drive: of any such mechanism, of a pair (reference/hinged_pair.c) or of a lone
    // body (reference/hinged_lone.c)
    bool (*rates)(const Hinged *hinged, double since_s, const double *y, double *rates);
    bool (*evaluate)(const Hinged *hinged, double since_s, const double *y, DynamicsState *state,
                     double *rates);
};

// Whether a mechanism is such a pair of bodies.
bool hinged_pair_is(const Hinged *hinged);

// As hinged_rates, of a steady drive, to the last bit.
bool hinged_pair_rates(const Hinged *hinged, double since_s, const double *y, double *rates);

// As hinged_evaluate, likewise.
bool hinged_pair_evaluate(const Hinged *hinged, double since_s, const double *y,
                          DynamicsState *state, double *rates);
