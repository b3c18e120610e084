// What reference/hinged.c works with: a body, its hinge and what hangs on it in one place.
#pragma once

#include "reference/dynamics_state.h"
#include "reference/turned.h"

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
    double weight;  // N
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

// Solves for the second rates of the coordinates of bodies, of which parents stand before children;
// false where they are not determined.
bool hinged_bodies_solve(HingedBody *bodies, size_t count, double *rates);
