// A pair of gears: where their teeth stand, wherever the gears' centres are.
//
// With d from centre a to centre b, D = |d|, u = d / D, t = perp u, psi the angle of u, r the pitch
// radii, R = r_a + r_b, alpha the pressure angle and phi how the bodies are turned, what the pitch
// circle of body b has come round against that of body a is
//     q = -(r_a (phi_a - psi) + r_b (phi_b - psi))
// Teeth are involutes of the base circles r cos alpha, which touch along a common tangent of these,
// at the working pressure angle cos alpha_w = R cos alpha / D. Of a flank with sign s, at c from
// the middle of the gap, with e 1 of external gears and -1 where one is internal:
//     g  = cos alpha (s q - c) + e R cos alpha (inv alpha_w - inv alpha),   inv x = tan x - x
//     n  = s cos alpha_w t + e sin alpha_w u                                of the force on body b
//     g' = -s cos alpha (r_a w_a + r_b w_b) + n . d'
//     g'' = -s cos alpha (r_a w_a' + r_b w_b') + n . d''
//           - 2 s cos alpha_w psi' D' + e (sin alpha_w D psi'^2 + cos^2 alpha_w D'^2
//                                          / (D sin alpha_w))
// so that gears which come apart gain backlash and push each other further apart. Without a
// pressure angle e is 0, alpha_w too, and D must not change. psi is known up to whole turns, and q
// is the one next to the middle of the gap. Source: involute gearing, Litvin and Fuentes, Gear
// Geometry and Applied Theory, 2004, chapter 10.
#pragma once

#include "model/linkage.h"

// How far the gears have come round, m, next to a value.
double mesh_position(const Gear *gear, Vec2 offset, double angle_a, double angle_b, double near);

// The rate of that, m/s.
double mesh_position_rate(const Gear *gear, Vec2 offset, Vec2 velocity, double omega_a,
                          double omega_b);

// How far apart the centres are when the pitch circles touch, m: R above.
static inline double mesh_distance(const Gear *gear)
{
    return gear->radius_a + gear->radius_b;
}

// cos alpha: what of a way along the pitch circles a flank goes along the line of action.
double mesh_slant(const Gear *gear);

// By how much the flanks are further from each other, m along the line of action, with the centres
// further apart than that by so much, m; with its digits.
double mesh_spread(const Gear *gear, double apart);

// n above, of unit length, with the offset d.
Vec2 mesh_normal(const Gear *gear, double sign, Vec2 offset);

// g' above, m/s.
double mesh_gap_rate(const Gear *gear, double sign, Vec2 offset, Vec2 velocity, double omega_a,
                     double omega_b);

// What g'' has beside n . d'' and the bodies' turning, m/s^2.
double mesh_bend(const Gear *gear, double sign, Vec2 offset, Vec2 velocity);
