// Damping factors of contact laws, what they deliver, and the closed forms of a single impact.
#pragma once

#include "model/options.h"

// chi, 1, of one kind of hysteretic damping, F = F_el (1 + chi d'/v0), for the restitution asked
// for, 0 <= e <= 1; 0 of those that ask for none (damping_restores). Every law gives 0 at e = 1;
// some are infinite at 0.
double damping_factor(DampingKind kind, double restitution);

// Whether a restitution says how much a damping takes.
static inline bool damping_restores(DampingKind kind)
{
    return kind != DAMPING_NONE && kind != DAMPING_VISCOUS && kind != DAMPING_STEP;
}

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
