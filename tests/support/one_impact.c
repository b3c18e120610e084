// What does one impact of a free pin give back in ODE, and what should it?
//
// Linear spring and damper, the force clamped at zero, zeta = c / (2 sqrt(k m)) < 1/2:
//     F_max = v sqrt(k m) exp(-zeta (3 acos(zeta) - pi) / sqrt(1 - zeta^2))
// F = K d^n (1 + chi u), u = d'/v: m v u du = -K d^n (1 + chi u) dd / v, so that on the way in
//     K d^(n+1) / (n + 1) = m v^2 ((1 - u) / chi - ln((1 + chi) / (1 + chi u)) / chi^2)
// and F is a function of u alone, whose largest value is looked for.
#include "one_impact.h"

#include "mechanism.h"

#include "contact/damping.h"
#include "measure/mapping_contact.h"

const double ONE_IMPACT_MASS = 0.1;
const double ONE_IMPACT_SPEED = 0.5;
const double ONE_IMPACT_CLEARANCE = 1e-3;
const double ONE_IMPACT_HERTZ = 6.6e10;

static const double LINEAR_STIFFNESS = 1e7; // N/m

enum { SEARCH_STEPS = 100 };

Scenario one_impact_pin(OdeMap map)
{
    Scenario scenario = mechanism_pin(ONE_IMPACT_MASS, ONE_IMPACT_CLEARANCE);
    scenario.ode.map = map;
    scenario.ode.stepping = map >= ODE_MAP_MIDPOINT ? ODE_STAGGERED : ODE_PLAIN;
    return scenario;
}

Scenario one_impact_linear(OdeMap map, double asked)
{
    Scenario scenario = one_impact_pin(map);
    scenario.contact.stiffness = LINEAR_STIFFNESS;
    scenario.contact.exponent = 1.0;
    scenario.contact.damping = DAMPING_VISCOUS;
    scenario.contact.viscous_coefficient =
        2.0 * damping_linear_ratio(asked) * sqrt(LINEAR_STIFFNESS * ONE_IMPACT_MASS);
    return scenario;
}

Scenario one_impact_hertz(OdeMap map, DampingKind damping, double asked)
{
    Scenario scenario = one_impact_pin(map);
    scenario.contact.stiffness = ONE_IMPACT_HERTZ;
    scenario.contact.exponent = 1.5;
    scenario.contact.damping = damping;
    scenario.contact.restitution = asked;
    return scenario;
}

static bool is_linear(const Scenario *scenario)
{
    return scenario->contact.exponent == 1.0;
}

double one_impact_duration(const Scenario *scenario)
{
    const double stiffness = scenario->contact.stiffness;
    if (is_linear(scenario)) {
        return M_PI * sqrt(ONE_IMPACT_MASS / stiffness);
    }
    const double depth = damping_depth_max(stiffness, 1.5, 0.0, ONE_IMPACT_MASS, ONE_IMPACT_SPEED);
    return 2.943275 * depth / ONE_IMPACT_SPEED;
}

static double linear_zeta(const Scenario *scenario)
{
    return 0.5 * scenario->contact.viscous_coefficient /
           sqrt(scenario->contact.stiffness * ONE_IMPACT_MASS);
}

static double hysteresis(const Scenario *scenario)
{
    return damping_factor(scenario->contact.damping, scenario->contact.restitution);
}

double one_impact_law_restitution(const Scenario *scenario)
{
    return is_linear(scenario) ? damping_linear_restitution(linear_zeta(scenario))
                               : damping_delivered(hysteresis(scenario));
}

// The force of a hysteretic law on the way in, at a speed relative to the first.
static double force_at_speed(const Scenario *scenario, double chi, double speed)
{
    const double stiffness = scenario->contact.stiffness;
    const double exponent = scenario->contact.exponent;
    const double taken = (1.0 - speed) / chi - log((1.0 + chi) / (1.0 + chi * speed)) / (chi * chi);
    const double power = (exponent + 1.0) / stiffness * ONE_IMPACT_MASS * ONE_IMPACT_SPEED *
                         ONE_IMPACT_SPEED * taken;
    return stiffness * pow(power, exponent / (exponent + 1.0)) * (1.0 + chi * speed);
}

double one_impact_law_force(const Scenario *scenario)
{
    if (is_linear(scenario)) {
        const double zeta = linear_zeta(scenario);
        const double phase = (3.0 * acos(zeta) - M_PI) / sqrt(1.0 - zeta * zeta);
        return ONE_IMPACT_SPEED * sqrt(scenario->contact.stiffness * ONE_IMPACT_MASS) *
               exp(-zeta * phase);
    }
    // the golden section: the force has one maximum between the first speed and none
    static const double GOLDEN = 0.61803398874989485;
    const double chi = hysteresis(scenario);
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < SEARCH_STEPS; i++) {
        const double lower = high - GOLDEN * (high - low);
        const double upper = low + GOLDEN * (high - low);
        if (force_at_speed(scenario, chi, lower) > force_at_speed(scenario, chi, upper)) {
            high = upper;
        } else {
            low = lower;
        }
    }
    return force_at_speed(scenario, chi, low);
}

OneImpact one_impact_run(Scenario scenario, double step_s)
{
    scenario.run.step = step_s;
    // three times as long as it lasts undamped: what is asked of the map may be wrong
    const ImpactDelivered delivered = impact_deliver(
        &scenario, 0, ONE_IMPACT_MASS, ONE_IMPACT_SPEED, 3.0 * one_impact_duration(&scenario));
    return (OneImpact){
        .restitution = delivered.figures.restitution.mean,
        .force_max = delivered.figures.force_max.mean,
        .is_single = delivered.is_measured,
        .fallback_rows = delivered.figures.fallbacks,
    };
}
