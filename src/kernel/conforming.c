// Has the elastic force of a pin in the hole of an eye.
//
// With s = d / play and z = ln(1 + 1/s), t = ln(1 + z):
//     dF/dd = k / W (1 + W'(x) dx/dt / ((1 + z) (1 + s) W))
// The energy is k d^2 times the integral of u / W(u d) over u from 0 to 1, by Gauss's rule in the
// cube root of u, which takes the logarithm at u = 0 away: right to 1e-7 above 1e-4 plays, and to
// 1e-6 below.
#include "kernel/conforming.h"

#include <math.h>
#include <stdbool.h>

// W and its slope over x.
typedef struct Width {
    double value;
    double slope;
} Width;

static Width width_at(const double *series, double x)
{
    Width width = {series[CONFORMING_TERMS - 1], 0.0};
    for (int i = CONFORMING_TERMS - 2; i >= 0; i--) {
        width.slope = width.slope * x + width.value;
        width.value = width.value * x + series[i];
    }
    return width;
}

// What a penetration stands for; beyond the least one nothing changes any more.
typedef struct Place {
    double s;
    double z;
    double x;
    bool is_least;
} Place;

static Place place_of(const Conforming *law, double penetration)
{
    const double s = penetration / law->play;
    const double z = log1p(1.0 / s);
    const double x = CONFORMING_SCALE * log1p(z) - CONFORMING_SHIFT;
    return (Place){s, z, fmin(x, 1.0), x > 1.0};
}

double conforming_depth(double x)
{
    return 1.0 / expm1(expm1((x + CONFORMING_SHIFT) / CONFORMING_SCALE));
}

void conforming_both(const Conforming *law, double penetration, double *force, double *slope)
{
    const Place at = place_of(law, penetration);
    const Width width = width_at(law->series, at.x);
    const double secant = law->stiffness / width.value;
    const double turn =
        at.is_least ? 0.0
                    : width.slope * CONFORMING_SCALE / ((1.0 + at.z) * (1.0 + at.s) * width.value);
    *force = secant * penetration;
    *slope = secant * (1.0 + turn);
}

double conforming_secant(const Conforming *law, double penetration)
{
    if (penetration <= 0.0) {
        return 0.0;
    }
    double width = 0.0;
    const double x = place_of(law, penetration).x;
    for (int i = CONFORMING_TERMS - 1; i >= 0; i--) {
        width = width * x + law->series[i];
    }
    return law->stiffness / width;
}

double conforming_penetration(const Conforming *law, double force)
{
    enum { STEPS = 60 };
    // from above, by Newton's method: there F grows almost as its slope has it
    double depth = force * width_at(law->series, 1.0).value / law->stiffness;
    for (int i = 0; i < STEPS; i++) {
        double found;
        double slope;
        conforming_both(law, depth, &found, &slope);
        const double change = (found - force) / slope;
        depth = fmax(depth - change, 0.5 * depth);
        if (!(fabs(change) > 1e-15 * depth)) {
            break;
        }
    }
    return depth;
}

double conforming_energy(const Conforming *law, double penetration)
{
    static const double NODES[] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                   0.8650633666889845, 0.9739065285171717};
    static const double WEIGHTS[] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                     0.1494513491505806, 0.0666713443086881};
    double sum = 0.0;
    for (int i = 0; i < 20; i++) { // half of them below 1/2, half above
        const double place = 1.0 + (i % 2 == 0 ? 1.0 : -1.0) * NODES[i / 4];
        const double root = 0.25 * place + (i / 2 % 2 == 0 ? 0.0 : 0.5);
        const double share = root * root * root;
        sum += 0.75 * WEIGHTS[i / 4] * root * root * share *
               conforming_secant(law, share * penetration);
    }
    return sum * penetration * penetration;
}
