// A pair of gears: where their teeth stand, wherever the gears' centres are.
//
// With d from centre a to centre b, D = |d|, u = d / D, t = perp u, psi the angle of u, r the pitch
// radii, R = r_a + r_b, alpha the pressure angle and phi how the bodies are turned, what the pitch
// circle of body b has come round against that of body a is
//     q = -(r_a (phi_a - psi) + r_b (phi_b - psi))
// Teeth are involutes of the base circles r cos alpha, which touch along a common tangent of these,
// at the working pressure angle cos alpha_w = R cos alpha / D. Of a flank with sign s, at c from
// the middle of the gap, with e 1 of external gears and -1 where one is internal:
//     g  = cos alpha (s q - c) - y + e R cos alpha (inv alpha_w - inv alpha),   inv z = tan z - z
//     n  = s cos alpha_w t + e sin alpha_w u                                of the force on body b
//     g' = -s (m_a w_a + m_b w_b) + n . d'
//     g'' = -s (m_a w_a' + m_b w_b') - y'' (w_a - w_b)^2 + n . d'' - 2 s cos alpha_w psi' D'
//           + e (sin alpha_w D psi'^2 + cos^2 alpha_w D'^2 / (D sin alpha_w))
//     m_a = r_a cos alpha + s y',  m_b = r_b cos alpha - s y'
// so that gears which come apart gain backlash and push each other further apart. y = s x - z is
// how far the flank stands out, x the transmission error and z the relief of both flanks, over
// phi_a - phi_b, by which it has its derivatives above: a share r_b / R of that is the angle of
// gear a against the line of the centres. It moves the force by -y' perp n, so that no force but
// that of the flank does its work. Without a pressure angle e is 0, alpha_w too, and D must not
// change. psi is known up to whole turns, and q is the one next to the middle of the gap. Source:
// involute gearing, Litvin and Fuentes, Gear Geometry and Applied Theory, 2004, chapter 10.
#pragma once

#include "base/profile.h"
#include "base/vec2.h"

#include <stdbool.h>
#include <stddef.h>

// A pair of gears. Their pitch circles touch on the line of their centres while these are as far
// from each other as the case places them; of an internal gear and its pinion one radius is
// negative, and both together are that distance.
//
// Of a rack body a is the rack and body b the pinion. The pitch line goes through the anchor on the
// rack, along its direction; the pinion's radius is the distance of its centre from the line,
// negative to the right of it.
typedef struct Gear {
    int pivots[2];          // numbers of the joints about which body a (a rack: on which it slides)
                            // and body b turn
    double teeth[2];        // of gears, or in their ratio; of an internal gear negative
    double radius_a;        // m, of the pitch circles; set where bodies are placed; of a rack
                            // infinite
    double radius_b;        // m
    double pressure_angle;  // rad, of gears, where the pitch circles touch; 0: they push along
                            // the pitch circles' tangent
    size_t error;           // of gears: which of the linkage's profiles is the transmission error,
                            // counted from 1; 0: none
    size_t relief;          // and which the relief of both flanks
    size_t repeats;         // how often they come in a turn of the first gear; 0: once
    double zero;            // rad: what their angle counts from
    bool is_backlash_angle; // until then: whether the backlash is an angle of body b, rad
    bool is_start_angle;    // likewise where it starts
} Gear;

// What a pair of gears is made of.
typedef struct Mesh {
    const Gear *gear;
    // over the angle of the first gear, as often as they repeat; NULL: none
    const Profile *error;
    const Profile *relief;
} Mesh;

// A flank: all that follows from where the gears are.
typedef struct MeshFlank {
    double sign;       // s above
    Vec2 offset;       // d, m
    Vec2 normal;       // n, unit
    Vec2 from_b;       // m, from centre b to where the line of action meets that of the centres
    double slant;      // cos alpha: of a way along the pitch circles that along the line of action
    double arms[2];    // m_a and m_b, m
    double stands_out; // y, m
    double bend;       // y'', m/rad^2
    double cosine;     // cos alpha_w
    double sine;       // e sin alpha_w; 0 without a pressure angle
} MeshFlank;

// With the angles of both bodies, rad, beyond whole turns.
MeshFlank mesh_flank(const Mesh *mesh, double sign, Vec2 offset, double angle_a, double angle_b);

// g' above, m/s: of velocities and speeds of turning, or of what else the gap's first derivative
// applies to.
double mesh_rate(const MeshFlank *flank, Vec2 velocity, double omega_a, double omega_b);

// What g'' has beside that of the accelerations, m/s^2.
double mesh_bend(const MeshFlank *flank, Vec2 velocity, double omega_a, double omega_b);

// g above, m, with s q - c and how much further apart the centres are than R, m.
double mesh_gap(const Gear *gear, const MeshFlank *flank, double beyond, double apart);

// How far the gears have come round, q, m, next to a value; and its rate, m/s.
double mesh_position(const Gear *gear, Vec2 offset, double angle_a, double angle_b, double near);
double mesh_position_rate(const Gear *gear, Vec2 offset, Vec2 velocity, double omega_a,
                          double omega_b);

// R above, m.
static inline double mesh_distance(const Gear *gear)
{
    return gear->radius_a + gear->radius_b;
}
