// The paper's estimate of the penalty parameter, each reading of it by its name.
//
// SI inside. The paper computes in mm, N and s; where a number's value depends on that, it says so.
#pragma once

#include "model/options.h"

// Where the paper's numbers hide: the constants that reproduce its tables.
typedef struct PenaltyReading {
    double force_lever;   // kappa, kg m: F = kappa max|alpha| (fitted; the paper does not say)
    double alpha_at_1000; // rad/s^2: max|alpha| of the coupler at 1000 rpm, Table VIII
    double radius_scale;  // m/N^(1/2): a = radius_scale sqrt(F), 0.1 mm (unexplained)
    double clearance;     // m: C of Eq. (9), 42 micron (Table IV says 29)
    double exponent;      // 1: e of Eq. (9), 1 in Table II (the text says 1.5)
    double sphere_radius; // m: of the mutual approach in Table III, the pin's 5 mm
} PenaltyReading;

// The reading that reproduces every cell of the paper's Tables I to III.
PenaltyReading penalty_reading_of_tables(void);

// E* = E / (2 (1 - nu^2)), Pa: both bodies of the same material.
double penalty_effective_modulus(const MaterialOptions *material);

// Tangential force on the pin, N, from the largest |alpha|, rad/s^2, at 1000 rpm, and the driver's
// speed, rad/s: kappa max|alpha| (rpm / 1000)^2. The speed's sign does not matter.
double penalty_force(const PenaltyReading *reading, double alpha_at_1000, double speed);

// Contact radius a, m, at a force, N.
double penalty_contact_radius(const PenaltyReading *reading, double force);

// K_c = 2 a E*, N/m, Eq. (7).
double penalty_stiffness(const PenaltyReading *reading, double effective_modulus, double force);

// P = K_c C^e, Eq. (9), as the paper prints it: K_c in N/mm and C in mm, so N for e = 1.
double penalty_printed(const PenaltyReading *reading, double effective_modulus, double force);

// The printed P read as the velocity-level penalty of Eq. (2) in the paper's units, N s/mm, and
// given in SI: N s/m.
double penalty_velocity_level(double printed);

// Mutual approach, m, at a force, N, as in Table III: 3/4 (F / (E* sqrt(R)))^(2/3), Hertz's
// sphere on a plane with the 3/4 left outside the power.
double penalty_approach(const PenaltyReading *reading, double effective_modulus, double force);

// The force, N, of the paper's crank-coupler pin at a driver's speed, rad/s. Speed 0 stands for
// 1000 rpm.
double penalty_reference_force(double speed);

// The penalty, N s/m, where a case asks for the Poisson model and gives none: the paper's reading
// for its crank-coupler pin at the driver's speed, rad/s, in the case's material. Speed 0 stands
// for 1000 rpm.
double penalty_estimate(double speed, const MaterialOptions *material);
