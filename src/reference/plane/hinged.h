// Mechanisms of hinges and pins in holes: their bodies, each with its hinge and what hangs on it in
// one place, and the evaluations of the two commonest of them.
#pragma once

#include "reference/plane/dynamics.h"
#include "reference/plane/tree.h"

typedef struct HingedBody HingedBody;
struct HingedBody {
    HingedBody *parent;     // body that it hangs on; NULL: the ground, or nothing
    HingedBody *eliminated; // the same, NULL where that is the driven body, which is known
    bool is_floating;
    bool has_children;
    size_t column;          // its angle
    const Vec2 *own_base;   // m, from the centre to its hinge, at the base
    const Vec2 *outer_base; // from the parent's centre to that
    double mass;
    double inertia; // kg m^2, about the hinge, or the centre
    Vec2 weight;    // N
    // at an instant
    TurnedBy turn; // since the base
    double omega;
    Vec2 arm;   // from the centre to its hinge
    Vec2 outer; // from the parent's centre to that
    Vec2 moved; // of the centre since the base
    Vec2 velocity;
    Vec2 bias;  // acceleration of the centre with all rates steady
    Vec2 force; // N, at the centre
    double moment;
    // of the elimination, as in ArticulatedLink
    ArticulatedGathered gathered;
    double own_moment; // N m, about the hinge
    double inverse;
    Vec2 share;
    Vec2 lever;
    Vec2 motion;
    double spin;
    Vec2 acceleration; // of the centre
};

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
    // of a steady drive: of any such mechanism, or of a four-bar or a single body
    // (reference/plane/hinged_pair.c)
    bool (*rates)(const Hinged *hinged, double since_s, const double *y, double *rates);
    bool (*evaluate)(const Hinged *hinged, double since_s, const double *y, DynamicsState *state,
                     double *rates);
};

// Whether a mechanism is a four-bar with play in one pin: a driven body, a body on a hinge of the
// ground, one on a hinge of that, and a pin in a hole between the last and the driven one.
bool hinged_pair_is(const Hinged *hinged);

// As hinged_rates, of a steady drive, to the last bit.
bool hinged_pair_rates(const Hinged *hinged, double since_s, const double *y, double *rates);

// As hinged_evaluate, likewise.
bool hinged_pair_evaluate(const Hinged *hinged, double since_s, const double *y,
                          DynamicsState *state, double *rates);

// Whether a mechanism is a body on no hinge whose pin is in a hole of the ground, or whose hole is
// about a pin there: what drops, bounces and rolls.
bool hinged_single_is(const Hinged *hinged);

// As hinged_rates, to the last bit.
bool hinged_single_rates(const Hinged *hinged, double since_s, const double *y, double *rates);
