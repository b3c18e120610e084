// Has the stiffness of a pin in its hole by the numbers of the paper's Tables II and III.
//
// Table II    F = k d, k = 2 a E*, a = 0.1 mm sqrt(F_ref / N): linear, at a reference force
// Table III   d = 3/4 (F / (E* sqrt(R)))^(2/3), R = 5 mm, hence F = E* sqrt(R) (4 d / 3)^1.5
//
// F_ref reference force, N; E* effective modulus, Pa; d penetration, m. The radii of pin and hole
// do not enter. Neither is a law of contact that physics knows: see docs/equations.md.
// Source: the paper's Eq. (7) and Tables II and III, as read in contact/penalty.
#include "contact/law.h"
#include "contact/penalty.h"

#include <math.h>

static void make_table_2(const ContactPair *pair, ForceLaw *law)
{
    const PenaltyReading reading = penalty_reading_of_tables();
    const double modulus = law_effective_modulus(pair);
    *law = force_law_power(penalty_stiffness(&reading, modulus, pair->reference_force), 1.0);
}

static void make_table_3(const ContactPair *pair, ForceLaw *law)
{
    const PenaltyReading reading = penalty_reading_of_tables();
    const double scale = law_effective_modulus(pair) * sqrt(reading.sphere_radius);
    *law = force_law_power(scale * 8.0 / (3.0 * sqrt(3.0)), 1.5); // (4/3)^1.5
}

const Law law_paper_table_2 = {.needs_force = true, .make = make_table_2};
const Law law_paper_table_3 = {.make = make_table_3};
