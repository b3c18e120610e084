// The elastic force of a pin in the hole of an eye (contact/eye.h), as force laws have it.
//
//     F = k d / W,  k = pi E* L,  W = c_0 + c_1 x + c_2 x^2 ..
//     x linear in ln(1 + ln(1 + play / d)), from -1 at 30 plays to 1 at 1e-8
// d approach, m; L width, m. With less depth W grows as ln(1 / d), as it does for cylinders; with
// much, pin and hole touch over a fixed angle, and it is constant.
#pragma once

enum { CONFORMING_TERMS = 24 }; // leaves 5e-6 of a force, 4e-5 where nu is 0.45

typedef struct Conforming {
    double stiffness;                // k, N/m
    double play;                     // m
    double series[CONFORMING_TERMS]; // c
} Conforming;

// x = CONFORMING_SCALE ln(1 + ln(1 + play / d)) - CONFORMING_SHIFT
static const double CONFORMING_SCALE = 0.6816458780101551;
static const double CONFORMING_SHIFT = 1.02199242256881;

// Force, N, and slope, N/m, at a penetration above 0, m.
void conforming_both(const Conforming *law, double penetration, double *force, double *slope);

// The spring that gives the force there, F / d, N/m; 0 at no penetration.
double conforming_secant(const Conforming *law, double penetration);

// Where a force, N, above 0 is reached, m.
double conforming_penetration(const Conforming *law, double force);

// What is stored at a penetration above 0, J.
double conforming_energy(const Conforming *law, double penetration);

// The penetration, in plays, that an x stands for.
double conforming_depth(double x);
