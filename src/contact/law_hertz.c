// Has the stiffness of a pin in its hole, both taken as spheres.
//
// F = K d^1.5,  K = 4 / (3 pi (s1 + s2)) sqrt(R1 R2 / (R1 - R2)),  s = (1 - nu^2) / (pi E)
// which is K = 4/3 E* sqrt(R) with E* = 1 / (pi (s1 + s2)) = E / (2 (1 - nu^2)).
//
// R1, R2 radii of hole and pin, m; the minus makes the outer sphere a socket. K in N/m^1.5.
// Source: the paper's Eq. (3) to (5), after Goldsmith, Impact (1960).
#include "contact/law.h"

#include <math.h>

static void make_hertz_socket(const ContactPair *pair, ForceLaw *law)
{
    const double difference = pair->hole_radius - pair->pin_radius;
    const double radius = pair->hole_radius * pair->pin_radius / difference;
    *law = force_law_power(4.0 / 3.0 * law_effective_modulus(pair) * sqrt(radius), 1.5);
}

const Law law_hertz_socket = {.make = make_hertz_socket};
