// The contact of a round pin in the round hole of an eye, both elastic: the force over the
// approach, by plane strain, without friction.
//
// The eye is a ring, clamped on its outer circle; the pin's load is spread evenly over its section,
// as its neighbouring sections and its inertia bring it in. The approach is how far the pin's
// centre has come towards the clamped circle since pin and hole began to touch. The play is taken
// as small against the radius, strains as small: then, with L the width,
//     force = E* L play f(approach / play),  1 / E* = (1 - nu_a^2) / E_a + (1 - nu_b^2) / E_b
#pragma once

#include <stdbool.h>

// the thinnest eye, in radii of the hole
static const double EYE_LEAST = 1.2;

// What f depends on.
typedef struct Eye {
    double outer;      // 1, its outer radius over that of the hole, above 1
    double hole_share; // 1, of 1 / E*, what the eye's material has of it: 1/2 of one material
    double hole_ratio; // 1, Poisson's ratio of the eye
    double pin_ratio;  // 1, and of the pin
} Eye;

// How pin and hole press on each other.
typedef struct EyePress {
    double approach; // 1, over the play
    double force;    // 1, f
    double pressure; // 1, in the middle of the contact, times radius / (E* play)
} EyePress;

// Finds how they press where they touch over an angle, rad, to both sides of the load. Returns
// false where no force has them touch so far: what touches has an end, however hard they press.
bool eye_press(const Eye *eye, double half_angle, EyePress *press);

// Finds W = pi (approach / play) / f as a polynomial, as force laws have it: c_0 + c_1 x + ... with
// x as in kernel/force_law.h. Returns false where the eye is not one that the solution holds for.
bool eye_series(const Eye *eye, double *series);
