// Gives ERP, CFM and step for each joint with play, and what they deliver.
//
// Each joint with play under each law is a contact (measure/mapping_contact.h); each map and step
// of it is a row: predicted, judged, and run in ODE as a single pin (measure/mapping_contact.h).
#include "measure/mapping.h"
#include "base/call.h"
#include "base/text.h"
#include "contact/law.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The steps for the hardest of the run's contacts: the lightest mass at the largest speed, which
// need not have met.
static void find_hardest(const MappingContact *contact, double *steps)
{
    const MappingJoint *joint = &contact->joint;
    MappingContact *hardest = malloc(sizeof *hardest);
    assert(hardest != NULL);
    Err ignored = {ERR_NONE, ""}; // such an impact may be beyond the law
    if (joint->onsets > 0 && !mapping_contact_is_poisson(contact) &&
        mapping_contact_make(&contact->scenario, joint, joint->mass_least,
                             fmax(joint->speed_most, contact->impact.law.impact_speed_floor),
                             hardest, &ignored)) {
        verdict_find_steps(hardest);
        memcpy(steps, hardest->largest_s, sizeof hardest->largest_s);
    }
    free(hardest);
}

static double mapping_choose(MappingSource source, double given, double median, double most)
{
    return source == MAPPING_GIVEN || source == MAPPING_USUAL ? given
           : source == MAPPING_MOST                           ? most
                                                              : median;
}

// Whether laws are asked for in place of the case's own.
static bool has_laws(const Mapping *mapping)
{
    return mapping->settings.law_count > 0 && mapping->scenario->contact.model != CONTACT_POISSON;
}

// Makes a contact of a joint whose pin closes in at some speed. Limits of a pivot have a stiffness
// of their own, which no law replaces.
static bool mapping_make_contact(const Mapping *mapping, const Scenario *scenario,
                                 const MappingJoint *joint, double mass, double speed,
                                 MappingContact *contact, Err *lack)
{
    const Joint *at = &scenario->linkage.joints[joint->joint];
    const bool is_torsional = linkage_is_torsional(at);
    if (is_torsional && has_laws(mapping)) {
        return err_set(lack, ERR_USAGE,
                       "its stiffness is its own: the law %s is for a pin in its hole",
                       OPTIONS_LAWS[law_chosen(scenario->contact.law, at->clearance.width)]);
    }
    return speed > 0.0 ? mapping_contact_make(scenario, joint, mass, speed, contact, lack)
                       : err_set(lack, ERR_USAGE,
                                 "no contact of the case's run begins with a closing speed; give "
                                 "one, such as --speed '0.1 %s'",
                                 is_torsional ? "rad/s" : "m/s");
}

// The contact of a joint under a law, or why there is none.
static void mapping_add_contact(Mapping *mapping, const Scenario *scenario,
                                const MappingJoint *joint, double mass, double speed,
                                MappingSource speed_source)
{
    MappingContact *contact = &mapping->contacts[mapping->contact_count++];
    const Joint *at = &scenario->linkage.joints[joint->joint];
    Err lack = {ERR_NONE, ""};
    if (!mapping_make_contact(mapping, scenario, joint, mass, speed, contact, &lack)) {
        *contact = (MappingContact){
            .joint = *joint,
            .law_name = has_laws(mapping)
                            ? OPTIONS_LAWS[law_chosen(scenario->contact.law, at->clearance.width)]
                            : mapping_law_name(scenario, at),
            .scenario = *scenario,
            .impact = {.mass = mass, .speed = speed},
            .lack_kind = lack.kind,
        };
        text_copy(contact->lack, sizeof contact->lack, lack.text);
    }
    contact->mass_source = mapping->settings.mass_source;
    contact->speed_source = speed_source;
}

static size_t law_count(const Mapping *mapping)
{
    return has_laws(mapping) ? mapping->settings.law_count : 1;
}

// The contacts of one joint, a law each.
static void mapping_add_joint(Mapping *mapping, const MappingJoint *joint)
{
    const MappingSettings *settings = &mapping->settings;
    const double mass =
        mapping_choose(settings->mass_source, settings->mass, joint->mass_median, joint->mass_most);
    double speed = mapping_choose(settings->speed_source, settings->speed, joint->speed_median,
                                  joint->speed_most);
    MappingSource speed_source = settings->speed_source;
    const double floor = mapping->scenario->contact.impact_speed_floor;
    if (speed > 0.0 && speed < floor && speed_source != MAPPING_GIVEN &&
        speed_source != MAPPING_USUAL) {
        // a pin that lays itself on the wall: no impact, but the wall is the same
        speed = floor;
        speed_source = MAPPING_FLOOR;
    }
    for (size_t i = 0; i < law_count(mapping); i++) {
        Scenario scenario = *mapping->scenario;
        if (has_laws(mapping)) {
            scenario_set_stiffness(&scenario, 0.0, scenario.contact.exponent);
            scenario.contact.law = settings->laws[i];
        }
        mapping_add_contact(mapping, &scenario, joint, mass, speed, speed_source);
    }
}

static bool needs_run(const MappingSettings *settings)
{
    return settings->mass_source != MAPPING_GIVEN ||
           (settings->speed_source != MAPPING_GIVEN && settings->speed_source != MAPPING_USUAL);
}

// The joints with play, measured in a run where masses or speeds come from there; the caller frees
// them.
static bool mapping_find_joints(const Mapping *mapping, MappingWatch watch, MappingJoint **joints,
                                size_t *count, Err *err)
{
    if (!needs_run(&mapping->settings)) {
        *joints = mapping_joint_list(mapping->scenario, count);
        return true;
    }
    if (!mapping_joint_measure(mapping->scenario, watch.run, joints, count, err)) {
        err_prefix(err, "the run that provides masses and speeds (--mass and --speed "
                        "given together need none)");
        return false;
    }
    return true;
}

static bool make_contacts(Mapping *mapping, MappingWatch watch, Err *err)
{
    MappingJoint *joints = NULL;
    size_t count = 0;
    if (!mapping_find_joints(mapping, watch, &joints, &count, err)) {
        return false;
    }
    const size_t room = count * law_count(mapping);
    mapping->contacts = calloc(room + 1, sizeof *mapping->contacts);
    assert(mapping->contacts != NULL);
    for (size_t i = 0; i < count; i++) {
        mapping_add_joint(mapping, &joints[i]);
    }
    free(joints);
    for (size_t i = 0; i < mapping->contact_count; i++) {
        if (mapping->contacts[i].lack[0] == '\0') {
            return true;
        }
    }
    const MappingContact *first = &mapping->contacts[0];
    return first->lack_kind == ERR_USAGE
               ? err_set(err, ERR_USAGE, "%s: %s",
                         mapping->scenario->linkage.joints[first->joint.joint].name, first->lack)
               : err_set(err, first->lack_kind, "%s", first->lack);
}

static void fill_soft(const MappingContact *contact, MappingRow *row)
{
    row->soft = (ErpCfm){NAN, NAN, NAN};
    row->stability_limit = NAN;
    const ContactOptions *options = &contact->scenario.contact;
    if (mapping_contact_is_poisson(contact)) {
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
        row->stability_limit = map_get(row->map)->stability_limit;
    }
}

static void mapping_fill_row(const MappingContact *contact, MappingRow *row)
{
    const Scenario scenario = mapping_scenario(contact, row->map, row->step_s);
    row->contact = contact;
    row->map_name = mapping_contact_is_poisson(contact) ? "poisson" : OPTIONS_ODE_MAPS[row->map];
    row->stepping = scenario.ode.stepping;
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

static void mapping_make_rows(Mapping *mapping, MappingWatch watch)
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
            if (call_is_cancelled()) {
                text_copy(row->delivered.message, sizeof row->delivered.message, CALL_CANCELLED);
                continue;
            }
            mapping_fill_row(contact, row);
        }
        if (settings->is_held && has_maps) {
            contact->held = malloc(sizeof *contact->held);
            assert(contact->held != NULL);
            constants_find(contact, settings->steps[0], contact->held);
        }
    }
}

// The name of the first pin that is not the drive's.
static const char *pin_that_could_have_play(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_pivots(linkage->joints[i].kind) && linkage_is_ideal(linkage, i)) {
            return linkage->joints[i].name;
        }
    }
    return "pin";
}

bool mapping_make(const Scenario *scenario, const MappingSettings *settings, MappingWatch watch,
                  Mapping *mapping, Err *err)
{
    *mapping = (Mapping){.scenario = scenario, .settings = *settings};
    if (!scenario_has_clearance(scenario)) {
        return err_set(err, ERR_CASE,
                       "no joint of %s has play, so there is no contact to map; give one its "
                       "sizes, such as joints.%s.radial-clearance=20 um",
                       scenario_path(scenario)[0] != '\0' ? scenario_path(scenario) : "the case",
                       pin_that_could_have_play(&scenario->linkage));
    }
    if (!make_contacts(mapping, watch, err)) {
        return false;
    }
    mapping_make_rows(mapping, watch);
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
