// The contact laws in quadruple precision, made from a joint's sizes and material.
//
// Written apart from src/contact: only the case's data, the two fitted numbers of the paper's table
// (contact/penalty.h) and the series of an eye (contact/eye.h, which has a truth of its own,
// tests/support/eye_truth.h) come from the program.
#pragma once

#include "kernel/conforming.h"
#include "model/scenario.h"

#include <quadmath.h>

typedef __float128 Quad;

// F = K d^n, or d = A F (B - ln F), d the depth, m, and F the force, N.
typedef struct QuadLaw {
    bool is_logarithmic;
    bool is_conforming; // F = K d / W: kernel/conforming.h
    Conforming conforming;
    Quad stiffness;  // K, N/m^n
    Quad exponent;   // n, 1
    Quad compliance; // A, m/N
    Quad offset;     // B, 1
    Quad log_scale;  // B + ln(A / (m/N)), 1
    Quad viscous;    // c, N s/m: c d' is added to F
} QuadLaw;

// The law of a joint with play.
QuadLaw quad_law(const Scenario *scenario, const Joint *joint);

// The factor chi, 1, of the case's damping.
Quad quad_law_hysteresis(const ContactOptions *contact);

// Elastic force, N, and energy, J, at a depth, m; 0 outside the metal.
Quad quad_law_force(const QuadLaw *law, Quad depth);
Quad quad_law_energy(const QuadLaw *law, Quad depth);
