// Estimates the penalty parameter by the paper's method at a driver's speed.
//
// E* = E / (2 (1 - nu^2))                      effective modulus, Pa
// F = kappa max|alpha| (rpm / 1000)^2          tangential force on the pin, N (Table I)
// a = 0.1 mm sqrt(F / N)                       contact radius, m (behind Table II)
// K_c = 2 a E*                                 contact stiffness, N/m, Eq. (7)
// P = K_c C^e, C = 0.042 mm, e = 1             penalty parameter, N, Eq. (9) and Table II
// p = P read in N s/mm                         penalty of F = p d', N s/m, Eq. (2)
// delta = 3/4 (F / (E* sqrt(5 mm)))^(2/3)      mutual approach, m (Table III)
//
// kappa = 8.78376e-5 kg m is fitted: the paper gives no derivation. Its tables leave it between
// 8.783754e-5 and 8.783770e-5; the nearest is the pin's I_zz = 0.83 kg mm^2 over a lever of
// 9.449 mm. alpha is the largest angular acceleration of the coupler at 1000 rpm, rad/s^2 (Table
// VIII). a goes with F^(1/2) here and with F^(1/3) in Table III: the two tables do not come from
// one contact law.
//
// Source: "A New Approach for Estimation of Penalty Parameter with Tolerance Stack-Up".
#include "contact/penalty.h"

#include <math.h>

static const double PI = 3.14159265358979323846;
static const double M_PER_MM = 1e-3;
static const double SPEED_AT_1000_RPM = 1000.0 / 30.0; // in units of pi rad/s

PenaltyReading penalty_reading_of_tables(void)
{
    return (PenaltyReading){
        .force_lever = 8.78376e-5,
        .alpha_at_1000 = 11970.0,
        .radius_scale = 0.1e-3,
        .clearance = 42e-6,
        .exponent = 1.0,
        .sphere_radius = 5e-3,
    };
}

double penalty_effective_modulus(const MaterialOptions *material)
{
    const double nu = material->poisson_ratio;
    return material->youngs_modulus / (2.0 * (1.0 - nu * nu));
}

double penalty_force(const PenaltyReading *reading, double alpha_at_1000, double speed)
{
    const double ratio = speed / (SPEED_AT_1000_RPM * PI);
    return reading->force_lever * fabs(alpha_at_1000) * ratio * ratio;
}

double penalty_contact_radius(const PenaltyReading *reading, double force)
{
    return reading->radius_scale * sqrt(force);
}

double penalty_stiffness(const PenaltyReading *reading, double effective_modulus, double force)
{
    return 2.0 * penalty_contact_radius(reading, force) * effective_modulus;
}

double penalty_printed(const PenaltyReading *reading, double effective_modulus, double force)
{
    const double stiffness = penalty_stiffness(reading, effective_modulus, force) * M_PER_MM;
    return stiffness * pow(reading->clearance / M_PER_MM, reading->exponent);
}

double penalty_velocity_level(double printed)
{
    return printed / M_PER_MM;
}

double penalty_approach(const PenaltyReading *reading, double effective_modulus, double force)
{
    const double hertz = force / (effective_modulus * sqrt(reading->sphere_radius));
    return 0.75 * cbrt(hertz * hertz);
}

double penalty_reference_force(double speed)
{
    const PenaltyReading reading = penalty_reading_of_tables();
    // without a drive the paper's own speed stands in, 1000 rpm
    const double paper_speed = 1000.0 * 2.0 * M_PI / 60.0;
    return penalty_force(&reading, reading.alpha_at_1000, speed != 0.0 ? speed : paper_speed);
}

double penalty_estimate(double speed, const MaterialOptions *material)
{
    const PenaltyReading reading = penalty_reading_of_tables();
    const double force = penalty_reference_force(speed);
    const double modulus = penalty_effective_modulus(material);
    return penalty_velocity_level(penalty_printed(&reading, modulus, force));
}
