// What does an impact on a joint ask for, and what is ODE predicted to make of it?
//
// Asked is the law's own impact at the mass and speed of the joint's contacts; predicted, the same
// impact on ODE's row (contact/map_impact.h); delivered, a lone pin run in ODE (measure/impact.h).
//
// k = F(d)/d, dF/dd and c are those at the law's deepest point d of that impact: the row that ODE
// has there is the one whose ERP and CFM are shown. omega = sqrt((dF/dd) / m). Tc is the length of
// the same impact without damping. Of a damping that depends on the depth, the equivalent viscous
// damper is 2 zeta sqrt(k m), zeta the damping ratio of the same restitution.
#include "measure/mapping_contact.h"

#include "contact/damping.h"
#include "contact/law.h"
#include "contact/penalty.h"

#include <math.h>

// as many as a run of one impact may have: the maps are right long before
const double MAPPING_STEPS_MOST = 1e5;

Scenario mapping_scenario(const MappingContact *contact, OdeMap map, double step_s)
{
    Scenario scenario = contact->scenario;
    scenario.run.step = step_s;
    scenario.ode.map = map;
    if (map == ODE_MAP_IMPULSE) {
        scenario.ode.collider = ODE_COLLIDER_PIN_HOLE;
    }
    // maps of the mid-step belong to staggered stepping, and a contact needs one world
    if (map >= ODE_MAP_MIDPOINT || scenario.ode.stepping == ODE_EXTRAPOLATED) {
        scenario.ode.stepping = ODE_STAGGERED;
    }
    return scenario;
}

MapImpactCase mapping_case(const MappingContact *contact, OdeMap map, double step_s)
{
    MapImpactCase impact = contact->impact;
    const ContactOptions *options = &contact->scenario.contact;
    impact.step = step_s;
    // where the engine ends a run
    const Joint *at = &contact->scenario.linkage.joints[contact->joint.joint];
    impact.end = law_depth_max(&impact.law, law_touching_radius(at));
    if (mapping_contact_is_poisson(contact)) {
        impact.rows = (MapImpactRows){
            .cfm = map_poisson_cfm(options->penalty),
            .push_out = contact->scenario.ode.push_out,
            .restitution = scenario_restitution(&contact->scenario, at),
            .bounce_speed = options->bounce_speed,
        };
    } else {
        impact.rows = (MapImpactRows){.map = map_get(map)};
    }
    return impact;
}

ImpactFigures mapping_predict(const MappingContact *contact, OdeMap map, double step_s)
{
    if (map == ODE_MAP_IMPULSE) {
        return impact_figures_of(&contact->asked);
    }
    if (contact->asked.duration > MAPPING_STEPS_MOST * step_s) {
        return (ImpactFigures){.is_too_fine = true};
    }
    const MapImpactCase impact = mapping_case(contact, map, step_s);
    return impact_predict(&impact);
}

// The numbers of a law at the deepest point of its impact.
static void fill_deepest(MappingContact *contact)
{
    const ForceLaw *law = &contact->impact.law;
    const double depth = contact->asked.penetration_max;
    contact->secant = force_law_secant(law, depth);
    contact->tangent = force_law_tangent(law, depth);
    contact->damping = force_law_damping(law, depth, contact->impact.speed);
    const double ratio = damping_linear_ratio(fmin(contact->asked.restitution, 1.0));
    contact->equivalent = 2.0 * ratio * sqrt(contact->secant * contact->impact.mass);
}

const char *mapping_law_name(const Scenario *scenario, const Joint *joint)
{
    const ContactOptions own = law_options(&scenario->contact, joint);
    return own.stiffness > 0.0 ? "stiffness" : OPTIONS_LAWS[own.law];
}

// The law's own impact, with and without damping.
static bool ask(MappingContact *contact, const Joint *at, Err *err)
{
    const MapImpactCase *impact = &contact->impact;
    const double holds = law_depth_max(&impact->law, law_touching_radius(at)); // m
    MapImpactCase undamped = *impact;
    undamped.law.viscous = undamped.law.hysteresis = 0.0;
    contact->asked = map_impact_law(impact);
    contact->half_period_s = map_impact_law(&undamped).duration;
    if (!(contact->half_period_s > 0.0) || contact->asked.penetration_max > holds) {
        return err_set(err, ERR_SOLVER,
                       "%s: an impact of %.4g kg at %.4g m/s goes past the end of the law %s, "
                       "which holds to a depth of %.4g um",
                       at->name, impact->mass, impact->speed, contact->law_name, 1e6 * holds);
    }
    if (!contact->asked.is_ended || !(contact->asked.restitution > 0.0)) {
        const bool is_turning = linkage_is_torsional(at);
        return err_set(err, ERR_SOLVER,
                       "%s: after an impact of %.4g %s at %.4g %s the damping of the law %s keeps "
                       "the pin at the wall",
                       at->name, impact->mass, is_turning ? "kg m^2" : "kg", impact->speed,
                       is_turning ? "rad/s" : "m/s", contact->law_name);
    }
    return true;
}

bool mapping_contact_make(const Scenario *scenario, const MappingJoint *joint, double mass,
                          double speed, MappingContact *contact, Err *err)
{
    const Joint *at = &scenario->linkage.joints[joint->joint];
    MappingContact made = {.joint = *joint, .scenario = *scenario};
    made.law_name = mapping_law_name(scenario, at);
    made.impact.mass = mass;
    made.impact.speed = speed;
    if (mapping_contact_is_poisson(&made)) {
        // the model has no law: it asks for a restitution, and for no force and no depth
        ContactOptions *options = &made.scenario.contact;
        made.law_name = "poisson";
        if (!(options->penalty > 0.0)) {
            options->penalty =
                penalty_estimate(scenario->linkage.driver.speed, &scenario->material);
        }
        made.asked = (MapImpact){
            .restitution = scenario_restitution(&made.scenario, at),
            .force_max = NAN,
            .penetration_max = NAN,
            .duration = NAN,
            .is_ended = true,
        };
        made.half_period_s = made.secant = made.tangent = made.damping = made.equivalent = NAN;
        *contact = made;
        return true;
    }
    if (!law_of_joint(scenario, at, &made.impact.law, err)) {
        return false;
    }
    if (made.impact.law.family == FORCE_LAW_POWER) {
        // the law as it is, in whatever world the pin is run
        scenario_set_stiffness(&made.scenario, made.impact.law.stiffness, made.impact.law.exponent);
    }
    if (!ask(&made, at, err)) {
        return false;
    }
    fill_deepest(&made);
    *contact = made;
    return true;
}
