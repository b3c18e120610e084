// Has the stiffness of a pin in its hole, both taken as cylinders.
//
// Each of the four laws has the form d = A F (B - ln F), F in N:
//   Johnson     d = F / (pi L E*) [ln(4 pi L E* dR / F) - 1]
//   Radzimovsky d = F / (pi L E*) [2/3 + ln(4 Ri / b) + ln(4 Rj / b)], b = 2.15 sqrt(F R / (E* L))
//               so the radii leave only dR: [2/3 + ln(16 dR E* L / (2.15^2 F))]
//   ESDU 78035  d = F s / L [ln(4 L dR / (F s)) + 1]
//   Dubowsky-   d = F s / L [ln(L^3 dR / (F Ri Rj s)) + 1]
//   Freudenstein
//
// L width, m; E* effective modulus, Pa; Ri, Rj radii of hole and pin, m; dR = Ri - Rj,
// R = Ri Rj / dR, m; s = s1 + s2 = 1 / (pi E*), 1/Pa.
//
// All are plane-strain halves pressed without friction; their logarithms differ by constants.
// Sources: Johnson, Contact Mechanics (1985), sec. 5.6; Radzimovsky, Univ. of Illinois Bull. 408
// (1953); ESDU Item 78035 (1978); Dubowsky and Freudenstein, J. Eng. Ind. 93 (1971) 305.
#include "contact/law.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

// A = 1 / (pi L E*) = s / L, m/N: the same for all four
static double compliance(const ContactPair *pair)
{
    return 1.0 / (PI * pair->width * law_effective_modulus(pair));
}

static double clearance(const ContactPair *pair)
{
    return pair->hole_radius - pair->pin_radius;
}

static void make_johnson(const ContactPair *pair, ForceLaw *law)
{
    const double a = compliance(pair);
    *law = force_law_logarithmic(a, log(4.0 * clearance(pair) / a) - 1.0);
}

static void make_radzimovsky(const ContactPair *pair, ForceLaw *law)
{
    const double e_star = law_effective_modulus(pair);
    const double scale = 16.0 * clearance(pair) * e_star * pair->width / (2.15 * 2.15);
    *law = force_law_logarithmic(compliance(pair), 2.0 / 3.0 + log(scale));
}

static void make_esdu_78035(const ContactPair *pair, ForceLaw *law)
{
    const double a = compliance(pair);
    *law = force_law_logarithmic(a, log(4.0 * clearance(pair) / a) + 1.0);
}

static void make_dubowsky_freudenstein(const ContactPair *pair, ForceLaw *law)
{
    const double a = compliance(pair);
    const double area = pair->hole_radius * pair->pin_radius;
    const double scale = pair->width * pair->width * clearance(pair) / (area * a);
    *law = force_law_logarithmic(a, log(scale) + 1.0);
}

const Law law_johnson = {.needs_width = true, .make = make_johnson};
const Law law_radzimovsky = {.needs_width = true, .make = make_radzimovsky};
const Law law_esdu_78035 = {.needs_width = true, .make = make_esdu_78035};
const Law law_dubowsky_freudenstein = {.needs_width = true, .make = make_dubowsky_freudenstein};
