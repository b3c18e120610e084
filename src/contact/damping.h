// Damping factors of contact laws, what they deliver, and the closed forms of a single impact.
#pragma once

#include "model/options.h"

// One hysteretic damping law: F = F_el (1 + chi d'/v0).
typedef struct Damping {
    const char *name;    // as in a case
    const char *summary; // one line for people
    const char *source;  // where the formula stands
    // chi, 1, for the restitution asked for, 0 < e <= 1. Every law gives 0 at e = 1.
    double (*factor)(double restitution);
} Damping;

// The law of one kind. DAMPING_NONE and DAMPING_VISCOUS are there too: their factor is 0.
const Damping *damping_get(DampingKind kind);

// chi, 1, of one kind for a restitution 0 < e <= 1.
double damping_factor(DampingKind kind, double restitution);

// The restitution that F = K d^n (1 + chi d'/v0) really delivers, whatever n, K, mass and speed;
// 1 for chi = 0. chi >= 0.
double damping_delivered(double chi);

// The deepest penetration, m, of one impact of an effective mass, kg, at a speed, m/s, on
// F = K d^n (1 + chi d'/v0), K in N/m^n; chi = 0 is the undamped contact.
double damping_depth_max(double stiffness, double exponent, double chi, double mass, double speed);

// The restitution of a linear spring and damper whose force is clamped at zero, from the damping
// ratio zeta = c / (2 sqrt(k m)) >= 0, and its inverse for 0 < e <= 1.
double damping_linear_restitution(double zeta);
double damping_linear_ratio(double restitution);
