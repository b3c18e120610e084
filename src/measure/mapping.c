// Which ERP, CFM and step for a joint, and what do they deliver?
//
// Asked is the law's own impact at the mass and speed of the joint's contacts; predicted, the same
// impact on ODE's row (contact/map_impact.h); delivered, a lone pin run in ODE (compare/impact.h).
//
// k = F(d)/d, dF/dd and c are those at the law's deepest point d of that impact: the row that ODE
// has there is the one whose ERP and CFM are shown. omega = sqrt((dF/dd) / m). Tc is the length of
// the same impact without damping. Of a damping that depends on the depth, the equivalent viscous
// damper is 2 zeta sqrt(k m), zeta the damping ratio of the same restitution.
#include "measure/mapping.h"

#include "base/text.h"
#include "contact/damping.h"
#include "contact/law.h"
#include "contact/penalty.h"
#include "measure/held.h"
#include "measure/mapping_verdict.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// as many as a run of one impact may have: the maps are right long before
const double MAPPING_STEPS_MOST = 1e5;

static bool is_poisson(const MappingContact *contact)
{
    return contact->scenario.contact.model == CONTACT_POISSON;
}

Scenario mapping_scenario(const MappingContact *contact, OdeMap map, double step_s)
{
    Scenario scenario = contact->scenario;
    scenario.run.step = step_s;
    scenario.ode.map = map;
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
    impact.end = law_depth_max(
        &impact.law, contact->scenario.linkage.joints[contact->joint.joint].clearance.pin_radius);
    if (is_poisson(contact)) {
        impact.rows = (MapImpactRows){
            .cfm = map_poisson_cfm(options->penalty),
            .push_out = contact->scenario.ode.push_out,
            .restitution = options->restitution,
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

static const char *law_name(const Scenario *scenario)
{
    return scenario->contact.stiffness > 0.0 ? "stiffness" : OPTIONS_LAWS[scenario->contact.law];
}

// The law's own impact, with and without damping.
static bool ask(MappingContact *contact, const Joint *at, Err *err)
{
    const MapImpactCase *impact = &contact->impact;
    const double holds = law_depth_max(&impact->law, at->clearance.pin_radius); // m
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
        return err_set(err, ERR_SOLVER,
                       "%s: after an impact of %.4g kg at %.4g m/s the damping of the law %s keeps "
                       "the pin at the wall",
                       at->name, impact->mass, impact->speed, contact->law_name);
    }
    return true;
}

bool mapping_contact_make(const Scenario *scenario, const MappingJoint *joint, double mass,
                          double speed, MappingContact *contact, Err *err)
{
    const Joint *at = &scenario->linkage.joints[joint->joint];
    MappingContact made = {.joint = *joint, .scenario = *scenario};
    made.law_name = law_name(scenario);
    made.impact.mass = mass;
    made.impact.speed = speed;
    if (is_poisson(&made)) {
        // the model has no law: it asks for a restitution, and for no force and no depth
        ContactOptions *options = &made.scenario.contact;
        made.law_name = "poisson";
        if (!(options->penalty > 0.0)) {
            options->penalty =
                penalty_estimate(scenario->linkage.driver.speed, &scenario->material);
        }
        made.asked = (MapImpact){.restitution = options->restitution, .is_ended = true};
        *contact = made;
        return true;
    }
    if (!law_of_joint(scenario, at, &made.impact.law, err)) {
        return false;
    }
    if (made.impact.law.family == FORCE_LAW_POWER) {
        // the law as it is, in whatever world the pin is run
        made.scenario.contact.stiffness = made.impact.law.stiffness;
        made.scenario.contact.exponent = made.impact.law.exponent;
    }
    if (!ask(&made, at, err)) {
        return false;
    }
    fill_deepest(&made);
    *contact = made;
    return true;
}

// The steps for the hardest of the run's contacts: the lightest mass at the largest speed, which
// need not have met.
static void find_hardest(const MappingContact *contact, double *steps)
{
    const MappingJoint *joint = &contact->joint;
    MappingContact *hardest = malloc(sizeof *hardest);
    assert(hardest != NULL);
    Err ignored = {ERR_NONE, ""}; // such an impact may be beyond the law
    if (joint->onsets > 0 && !is_poisson(contact) &&
        mapping_contact_make(&contact->scenario, joint, joint->mass_least,
                             fmax(joint->speed_most, contact->impact.law.impact_speed_floor),
                             hardest, &ignored)) {
        verdict_find_steps(hardest);
        memcpy(steps, hardest->largest_s, sizeof hardest->largest_s);
    }
    free(hardest);
}

static double choose(MappingSource source, double given, double median, double most)
{
    return source == MAPPING_GIVEN || source == MAPPING_USUAL ? given
           : source == MAPPING_MOST                           ? most
                                                              : median;
}

// The contact of a joint under a law, or why there is none.
static void add_contact(Mapping *mapping, const Scenario *scenario, const MappingJoint *joint,
                        double mass, double speed, MappingSource speed_source)
{
    MappingContact *contact = &mapping->contacts[mapping->contact_count++];
    Err lack = {ERR_NONE, ""};
    if (!mapping_contact_make(scenario, joint, mass, speed, contact, &lack)) {
        *contact = (MappingContact){
            .joint = *joint,
            .law_name = law_name(scenario),
            .scenario = *scenario,
            .impact = {.mass = mass, .speed = speed},
            .lack_kind = lack.kind,
        };
        text_copy(contact->lack, sizeof contact->lack, lack.text);
    }
    contact->speed_source = speed_source;
}

// The contacts of one joint, a law each.
static bool add_joint(Mapping *mapping, const MappingJoint *joint, Err *err)
{
    const MappingSettings *settings = &mapping->settings;
    const double mass =
        choose(settings->mass_source, settings->mass, joint->mass_median, joint->mass_most);
    double speed =
        choose(settings->speed_source, settings->speed, joint->speed_median, joint->speed_most);
    MappingSource speed_source = settings->speed_source;
    const double floor = mapping->scenario->contact.impact_speed_floor;
    if (speed > 0.0 && speed < floor && speed_source != MAPPING_GIVEN &&
        speed_source != MAPPING_USUAL) {
        // a pin that lays itself on the wall: no impact, but the wall is the same
        speed = floor;
        speed_source = MAPPING_FLOOR;
    }
    if (!(speed > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "%s: no contact of the case's run begins with a closing speed; give one, "
                       "such as --speed '0.1 m/s'",
                       mapping->scenario->linkage.joints[joint->joint].name);
    }
    const bool is_poisson_case = mapping->scenario->contact.model == CONTACT_POISSON;
    const size_t count = settings->law_count == 0 || is_poisson_case ? 1 : settings->law_count;
    for (size_t i = 0; i < count; i++) {
        Scenario scenario = *mapping->scenario;
        if (settings->law_count > 0 && !is_poisson_case) {
            scenario.contact.stiffness = 0.0;
            scenario.contact.law = settings->laws[i];
        }
        if (mapping->contact_count == MAPPING_CONTACT_MAX) {
            return err_set(err, ERR_USAGE, "more than %d joints and laws; choose some with --laws",
                           MAPPING_CONTACT_MAX);
        }
        add_contact(mapping, &scenario, joint, mass, speed, speed_source);
    }
    return true;
}

static bool needs_run(const MappingSettings *settings)
{
    return settings->mass_source != MAPPING_GIVEN ||
           (settings->speed_source != MAPPING_GIVEN && settings->speed_source != MAPPING_USUAL);
}

static bool make_contacts(Mapping *mapping, MappingWatch watch, Err *err)
{
    const MappingSettings *settings = &mapping->settings;
    const Linkage *linkage = &mapping->scenario->linkage;
    MappingJoint joints[LINKAGE_JOINT_MAX] = {0};
    size_t count = 0;
    if (needs_run(settings)) {
        if (!mapping_joint_measure(mapping->scenario, watch.run, joints, &count, err)) {
            err_prefix(err, "the run that masses and speeds are taken from (--mass and --speed "
                            "given together need none)");
            return false;
        }
    } else {
        for (size_t i = 0; i < linkage->joint_count; i++) {
            if (linkage->joints[i].kind == JOINT_CLEARANCE) {
                joints[count++].joint = (int)i;
            }
        }
    }
    mapping->contacts = calloc(MAPPING_CONTACT_MAX, sizeof *mapping->contacts);
    assert(mapping->contacts != NULL);
    for (size_t i = 0; i < count; i++) {
        if (!add_joint(mapping, &joints[i], err)) {
            return false;
        }
    }
    for (size_t i = 0; i < mapping->contact_count; i++) {
        if (mapping->contacts[i].lack[0] == '\0') {
            return true;
        }
    }
    return err_set(err, mapping->contacts[0].lack_kind, "%s", mapping->contacts[0].lack);
}

static void fill_soft(const MappingContact *contact, MappingRow *row)
{
    const ContactOptions *options = &contact->scenario.contact;
    if (is_poisson(contact)) {
        row->soft = map_row(contact->scenario.ode.push_out, map_poisson_cfm(options->penalty));
    } else if (row->map != ODE_MAP_IMPULSE) {
        const MapContact at = {
            .stiffness = contact->secant,
            .damping = contact->damping,
            .step = row->step_s,
            .mass = contact->impact.mass,
            .depth = contact->asked.penetration_max,
        };
        row->soft = map_get(row->map)->convert(&at);
    }
}

static void fill_row(const MappingContact *contact, MappingRow *row)
{
    row->steps_a_contact = contact->half_period_s / row->step_s;
    row->omega_h = sqrt(contact->tangent / contact->impact.mass) * row->step_s;
    fill_soft(contact, row);
    row->predicted = mapping_predict(contact, row->map, row->step_s);
    row->verdict = verdict_judge(contact, row->map, row->step_s, &row->predicted);
    verdict_describe(contact, row);
    if (!row->predicted.is_ended && !row->predicted.is_past_end) {
        snprintf(row->delivered.message, ERR_TEXT_SIZE,
                 row->predicted.is_too_fine ? "it would take more than %.0e steps"
                                            : "the contact would not end",
                 MAPPING_STEPS_MOST);
        return;
    }
    const Scenario scenario = mapping_scenario(contact, row->map, row->step_s);
    row->delivered = impact_deliver(&scenario, contact->joint.joint, contact->impact.mass,
                                    contact->impact.speed, row->predicted.duration.most);
}

// The world steps of the rows: those of a contact, once a phase.
static double count_steps(const Mapping *mapping, size_t map_count)
{
    const MappingSettings *settings = &mapping->settings;
    double steps = 0.0;
    for (size_t i = 0; i < mapping->contact_count; i++) {
        for (size_t k = 0; k < settings->step_count; k++) {
            const double of_one = mapping->contacts[i].asked.duration / settings->steps[k];
            // what is too fine is not run
            steps += of_one <= MAPPING_STEPS_MOST
                         ? (double)map_count * MAP_IMPACT_PHASES * ceil(of_one)
                         : 0.0;
        }
    }
    return steps;
}

static void make_rows(Mapping *mapping, MappingWatch watch)
{
    const MappingSettings *settings = &mapping->settings;
    // rows of POISSON contacts know no map
    const bool has_maps = mapping->scenario->contact.model == CONTACT_IMPACT;
    const size_t map_count = has_maps ? settings->map_count : 1;
    const size_t total = mapping->contact_count * map_count * settings->step_count;
    mapping->rows = calloc(total + 1, sizeof *mapping->rows);
    assert(mapping->rows != NULL);
    if (watch.plan != NULL) {
        watch.plan(count_steps(mapping, map_count), watch.context);
    }
    for (size_t i = 0; i < mapping->contact_count; i++) {
        MappingContact *contact = &mapping->contacts[i];
        if (contact->lack[0] != '\0') {
            continue;
        }
        verdict_find_steps(contact);
        find_hardest(contact, contact->hardest_s);
        contact->first_row = mapping->row_count;
        contact->row_count = map_count * settings->step_count;
        for (size_t k = 0; k < contact->row_count; k++) {
            if (watch.row != NULL) {
                watch.row(mapping->row_count, total, watch.context);
            }
            MappingRow *row = &mapping->rows[mapping->row_count++];
            row->map = has_maps ? settings->maps[k / settings->step_count] : ODE_MAP_TEXTBOOK;
            row->step_s = settings->steps[k % settings->step_count];
            fill_row(contact, row);
        }
        if (settings->is_held && has_maps) {
            contact->held = malloc(sizeof *contact->held);
            assert(contact->held != NULL);
            held_find(contact, settings->steps[0], contact->held);
        }
    }
}

bool mapping_make(const Scenario *scenario, const MappingSettings *settings, MappingWatch watch,
                  Mapping *mapping, Err *err)
{
    *mapping = (Mapping){.scenario = scenario, .settings = *settings};
    if (!scenario_has_clearance(scenario)) {
        return err_set(err, ERR_CASE,
                       "no joint of %s has play, so there is no contact to map; give one its "
                       "sizes, such as joints.crank-coupler.radial-clearance=20 um",
                       scenario->path[0] != '\0' ? scenario->path : "the case");
    }
    if (!make_contacts(mapping, watch, err)) {
        return false;
    }
    make_rows(mapping, watch);
    return true;
}

void mapping_finish(Mapping *mapping)
{
    for (size_t i = 0; i < mapping->contact_count; i++) {
        free(mapping->contacts[i].held);
    }
    free(mapping->contacts);
    free(mapping->rows);
    memset(mapping, 0, sizeof *mapping);
}
