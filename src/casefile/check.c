// Checks that the values of a case fit together.
#include "casefile/check.h"

#include "base/zeroed.h"
#include "casefile/build.h"
#include "casefile/check_forces.h"
#include "casefile/check_friction.h"
#include "casefile/check_joints.h"
#include "casefile/check_space.h"
#include "casefile/drives.h"
#include "casefile/fit.h"
#include "casefile/joint_kind.h"
#include "casefile/keys.h"
#include "casefile/target.h"
#include "contact/damping.h"
#include "contact/facets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A run of 1e9 steps takes some twenty minutes at 1.3 us a step; more is a slip of the pen.
static const double STEPS_MAX = 1e9;
// 1e7 samples of a four-bar fill some 4 GB.
static const double SAMPLES_MAX = 1e7;

// The innermost group above the row that the case gives; the document itself is the outermost.
static const EntryGroup *group_above(const Entries *entries, const SchemaRow *row, size_t index)
{
    char path[SCHEMA_PATH_SIZE];
    text_copy(path, sizeof path, row->path);
    for (char *dot = strrchr(path, '.'); dot != NULL; dot = strrchr(path, '.')) {
        *dot = '\0';
        const size_t group_index = strchr(path, '*') != NULL ? index : 0;
        const EntryGroup *group = entries_group(entries, path, group_index);
        if (group != NULL) {
            return group;
        }
    }
    return entries_group(entries, "", 0);
}

static bool refuse_missing(const Entries *entries, const SchemaRow *row, size_t index, Err *err)
{
    const EntryGroup *group = group_above(entries, row, index);
    char path[SCHEMA_PATH_SIZE];
    schema_path(row, entries_name(entries, row, index), path);
    Text allowed;
    text_init(&allowed);
    if (row->rivalry == SCHEMA_STOPPING) {
        const bool is_slot = entries_find(entries, "joints.*.slot", index) != NULL;
        const bool is_stop = entries_find(entries, "joints.*.radius", index) != NULL || is_slot;
        text_append(&allowed, "%s%s",
                    is_slot ? "the direction across the slot, such as 90 deg"
                            : "normal of a line or slot, discs, or profile of a cam",
                    is_stop ? ""
                            : ", of a stop; hole and pin of a pin in a hole; at of a pivot without "
                              "play");
    } else if (row->rivalry == SCHEMA_SIZES || row->excused_by != NULL) {
        text_append(&allowed, "hole and pin, or radial-clearance");
    } else {
        target_describe(entries, row, &allowed);
    }
    entries_refuse_group(group, err, "%s is missing\nallowed: %s", path, allowed.data);
    text_finish(&allowed);
    return false;
}

// Whether a required key of a member is required in this case; the kinds are those of all joints.
static bool is_wanted(const Entries *entries, const JointKind *kinds, const SchemaRow *row,
                      size_t index)
{
    if (!schema_is_of_form(row, entries->form)) {
        return false;
    }
    if (row->family == SCHEMA_JOINT && !schema_is_of_kind(row, kinds[index])) {
        return false;
    }
    if (row->excused_by != NULL && entries_find(entries, row->excused_by, index) != NULL) {
        return false;
    }
    const Entry *hole = entries_find(entries, "joints.*.hole", index);
    if (row->family == SCHEMA_JOINT && strcmp(row->path, "joints.*.pin") == 0 && hole != NULL &&
        hole->node->kind == NODE_SCALAR && fit_is_of_both(hole->node->text)) {
        return false;
    }
    const bool is_drive = strncmp(row->path, "drive.", strlen("drive.")) == 0;
    return !is_drive || entries->form != SCHEMA_LONG || entries_group(entries, "drive", 0) != NULL;
}

static bool check_members(const Entries *entries, const JointKind *kinds, Err *err)
{
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        const size_t members = row->is_required ? entries_family_size(entries, row) : 0;
        for (size_t index = 0; index < members; index++) {
            // most keys that are required are given
            if (entries_at(entries, row, index) == NULL && is_wanted(entries, kinds, row, index) &&
                !entries_have_rival(entries, row, index)) {
                return refuse_missing(entries, row, index, err);
            }
        }
    }
    return true;
}

bool check_required(const Entries *entries, Err *err)
{
    if (!joint_kind_check(entries, err)) {
        return false;
    }
    // the kind of a joint is found from its keys: once, and not for each row of the schema
    const size_t joints = entries->names[SCHEMA_JOINT].count;
    JointKind *kinds = zeroed(joints + 1, sizeof *kinds);
    for (size_t i = 0; i < joints; i++) {
        kinds[i] = joint_kind_find(entries, i);
    }
    const bool is_complete = check_members(entries, kinds, err);
    free(kinds);
    return is_complete;
}

static bool check_contact(const Entries *entries, const Scenario *scenario, Err *err)
{
    const ContactOptions *contact = &scenario->contact;
    if (contact->model == CONTACT_POISSON && contact->penalty == 0.0 &&
        !scenario->linkage.driver.is_present) {
        return entries_refuse(entries_find(entries, "contact.model", 0), err,
                              "the paper's estimate of the penalty needs the speed of a "
                              "drive\nallowed: impact, or contact.penalty such as 973.33 N s/mm");
    }
    const Entry *damping = entries_blame(entries, "contact.restitution contact.damping", 0);
    if (damping == NULL || contact->model != CONTACT_IMPACT) {
        return true;
    }
    const bool is_step = contact->damping == DAMPING_STEP;
    if ((contact->damping == DAMPING_VISCOUS || is_step) && contact->viscous_coefficient == 0.0) {
        return entries_refuse(entries_find(entries, "contact.damping", 0), err,
                              "damping %s needs contact.viscous-coefficient\nallowed: another "
                              "damping, or contact.viscous-coefficient such as 100 N s/m",
                              OPTIONS_DAMPINGS[contact->damping]);
    }
    if (is_step && contact->full_damping_depth == 0.0) {
        return entries_refuse(entries_find(entries, "contact.damping", 0), err,
                              "damping step needs contact.full-damping-depth\nallowed: another "
                              "damping, or contact.full-damping-depth such as 0.1 mm");
    }
    if (contact->restitution == 0.0 && !isfinite(damping_factor(contact->damping, 0.0))) {
        return entries_refuse(entries_blame(entries, "contact.restitution contact.damping", 0), err,
                              "damping %s has no finite factor at restitution 0\nallowed: above 0 "
                              "and up to 1, or another damping",
                              OPTIONS_DAMPINGS[contact->damping]);
    }
    return true;
}

static bool check_steps(const Entries *entries, const RunOptions *run, double duration,
                        bool is_turning, Err *err)
{
    const Entry *entry =
        entries_blame(entries, "run.step run.revolutions run.duration drive.speed", 0);
    if (run->step == 0.0) {
        return true; // chosen as the run goes
    }
    const double steps = duration / run->step;
    if (!(steps <= STEPS_MAX)) {
        return entries_refuse(entry, err,
                              "the run of %.4g s takes %.3g steps of %.3g s\n"
                              "allowed: at most %g steps: here a step of %.3g s or more, or %s",
                              duration, steps, run->step, STEPS_MAX, duration / STEPS_MAX,
                              is_turning ? "fewer revolutions" : "a shorter run");
    }
    return run->step <= duration || entries_refuse(entry, err,
                                                   "the step (%.3g s) is longer than the run\n"
                                                   "allowed: a step of %.3g s or less",
                                                   run->step, duration);
}

static bool check_samples(const Entries *entries, const RunOptions *run, Err *err)
{
    const double samples = run->revolutions * (double)run->samples;
    if (samples <= SAMPLES_MAX && samples >= 1.0) {
        return true;
    }
    // the defaults alone are sane, so that one of the two is given
    return entries_refuse(entries_blame(entries, "run.samples run.revolutions", 0), err,
                          "the run holds %.3g samples (%g revolutions with %zu each)\n"
                          "allowed: 1 to %g samples in the whole run",
                          samples, run->revolutions, run->samples, SAMPLES_MAX);
}

// Why a run is not counted in revolutions.
static const char *no_revolutions(const Entries *entries)
{
    return entries_find(entries, "drive.force", 0) != NULL
               ? "with a force the drive makes no given number of revolutions"
           : entries_blame(entries, "drive.torque drive.stall-torque", 0) != NULL
               ? "with a torque the drive makes no given number of revolutions"
           : entries_group(entries, "drives", 0) != NULL
               ? "with several drives a run is not counted in the revolutions of one"
           : entries_blame(entries, "drive.stiffness drive.damping", 0) != NULL
               ? "a soft drive that holds an angle, or whose speed changes, makes no given number "
                 "of "
                 "revolutions"
           : entries_blame(entries, "drive.speed drive.angle", 0) != NULL
               ? "a run with a drive of changing speed is not counted in revolutions"
               : "without a drive there are no revolutions";
}

// A drive of constant speed counts a run in its revolutions; else it is counted in seconds. A soft
// one of constant speed takes either.
static bool check_length(const Entries *entries, bool is_turning, bool is_soft, Err *err)
{
    const Entry *turns = entries_find(entries, "run.revolutions", 0);
    if (is_turning && is_soft) {
        return turns == NULL || entries_find(entries, "run.duration", 0) == NULL ||
               entries_refuse(entries_blame(entries, "run.revolutions run.duration", 0), err,
                              "the length of the run is given twice\nallowed: revolutions of the "
                              "soft drive, or a duration");
    }
    const Entry *wrong = entries_find(entries, is_turning ? "run.duration" : "run.revolutions", 0);
    if (wrong == NULL) {
        return true;
    }
    return is_turning
               ? entries_refuse(wrong, err,
                                "the duration of a run with a drive of constant speed follows from "
                                "its revolutions\n"
                                "allowed: revolutions of the drive, such as revolutions: 1")
               : entries_refuse(wrong, err, "%s\nallowed: a duration, such as duration: 60 ms",
                                no_revolutions(entries));
}

// What is reported begins before the run ends.
static bool check_report(const Entries *entries, const Scenario *scenario, bool is_turning,
                         Err *err)
{
    const RunOptions *run = &scenario->run;
    const Entry *own = entries_find(entries, "run.report-from", 0);
    if (own == NULL) {
        return true;
    }
    if (run->is_report_from_in_turns && !is_turning) {
        return entries_refuse(own, err, "%s\nallowed: a time, such as 60 ms",
                              no_revolutions(entries));
    }
    if (scenario_reports_any(scenario)) {
        return true;
    }
    const Entry *entry = entries_blame(entries, "run.report-from run.revolutions run.duration", 0);
    char turns[64] = "";
    if (is_turning) {
        snprintf(turns, sizeof turns, "%g revolution%s or ", run->revolutions,
                 run->revolutions == 1.0 ? "" : "s");
    }
    return entries_refuse(entry, err,
                          "run.report-from (%.40s) is not before the end of the run\n"
                          "allowed: less than the run, %s%.4g s",
                          own->node->text, turns, scenario_duration(scenario));
}

static bool check_backends(const Entries *entries, const RunOptions *run, Err *err)
{
    for (size_t i = 0; entries->form == SCHEMA_LONG && i < run->backend_count; i++) {
        if (run->backends[i] == BACKEND_ANALYTIC) {
            return entries_refuse(entries_find(entries, "run.backends", 0), err,
                                  "the analytic backend is for four-bars and slider-cranks only, "
                                  "in a case with four-bar or slider-crank\nallowed: reference, "
                                  "ode");
        }
    }
    return true;
}

// Whether the collider can see contacts as small as those of each joint with play.
static bool check_collider(const Entries *entries, const Scenario *scenario, Err *err)
{
    const OdeOptions *ode = &scenario->ode;
    const Entry *entry = entries_find(entries, "ode.collider", 0);
    if (entry == NULL || ode->collider == ODE_COLLIDER_PIN_HOLE) {
        return true;
    }
    if (scenario->linkage.is_spatial && scenario_has_clearance(scenario)) {
        return entries_refuse(entries_blame(entries, "space ode.collider", 0), err,
                              "in space the contact of pin and hole is found by collider pin-hole "
                              "alone\n"
                              "allowed: collider: pin-hole, or space: planar");
    }
    const bool is_impulse = scenario->contact.model == CONTACT_IMPACT &&
                            (ode->map == ODE_MAP_IMPULSE || scenario->run.step == 0.0);
    if (scenario_has_clearance(scenario) && is_impulse) {
        return entries_refuse(
            entries_blame(entries, "ode.map run.step ode.collider", 0), err,
            "%s uses the exact circle and not collider %s\n"
            "allowed: collider: pin-hole, or a step and another map, such as map: midpoint",
            scenario->run.step == 0.0 ? "step auto" : "map impulse",
            OPTIONS_ODE_COLLIDERS[ode->collider]);
    }
    for (int i = 0; i < (int)scenario->linkage.joint_count; i++) {
        Err own = {0};
        const Joint *joint = &scenario->linkage.joints[i];
        if (linkage_has_play(joint) && !joint_has_hole(joint->kind)) {
            return entries_refuse(entries_blame(entries, "ode.collider", 0), err,
                                  "collider %s is for pins in their holes only, and '%s' is %s\n"
                                  "allowed: pin-hole",
                                  OPTIONS_ODE_COLLIDERS[ode->collider], joint->name,
                                  !joint_is_ideal(joint->kind)           ? joint_words(joint->kind)
                                  : joint->limits.kind == LIMIT_BACKLASH ? "a joint with backlash"
                                                                         : "a stop");
        }
        if (joint_has_hole(joint->kind) && !facets_check(scenario, i, &own)) {
            return entries_refuse(entries_blame(entries, "ode.facets ode.collider", 0), err,
                                  "%s\nallowed: pin-hole, which is exact, or staves", own.text);
        }
    }
    return true;
}

// Steppings and maps that not every case can have.
static bool check_stepping(const Entries *entries, const Scenario *scenario, Err *err)
{
    const OdeOptions *ode = &scenario->ode;
    const bool has_play = scenario_has_clearance(scenario);
    const bool is_impact = has_play && scenario->contact.model == CONTACT_IMPACT;
    if (scenario->run.step == 0.0) {
        const Entry *entry = entries_blame(entries, "run.step contact.model", 0);
        return !has_play || is_impact ||
               entries_refuse(entry, err,
                              "a step can only be chosen for the impact model\nallowed: a step "
                              "such as 1 us, or contact.model: impact");
    }
    const bool is_general = OPTIONS_ODE_STEPPING_IS_GENERAL[ode->stepping];
    const char *word = OPTIONS_ODE_STEPPINGS[ode->stepping];
    if (has_play && !is_general) {
        return entries_refuse(entries_find(entries, "ode.stepping", 0), err,
                              "%s stepping is for ideal joints: contacts are not "
                              "smooth\nallowed: plain, staggered",
                              word);
    }
    if (scenario->linkage.is_spatial && !is_general) {
        return entries_refuse(entries_blame(entries, "space ode.stepping", 0), err,
                              "%s stepping is for linkages in the plane\nallowed: "
                              "stepping: plain or staggered, or space: planar",
                              word);
    }
    if (scenario->linkage.torque.limit > 0.0 && !is_general) {
        return entries_refuse(entries_blame(entries, "ode.stepping drive.torque-limit", 0), err,
                              "%s stepping is for smooth forces: a torque has a corner at its "
                              "limit\nallowed: plain, staggered",
                              word);
    }
    if (!drive_is_smooth(&scenario->linkage.driver) && !is_general) {
        return entries_refuse(entries_blame(entries, "ode.stepping drive.speed drive.angle", 0),
                              err,
                              "%s stepping is for drives of constant speed or by a sinusoid: "
                              "points over time have kinks\nallowed: plain, staggered",
                              word);
    }
    if (is_impact && ode->map == ODE_MAP_IMPULSE && ode->stepping != ODE_STAGGERED) {
        return entries_refuse(
            entries_blame(entries, "ode.map ode.stepping", 0), err,
            "map impulse needs stepping staggered\nallowed: stepping: staggered, or another map");
    }
    return true;
}

static bool check_tolerance(const Entries *entries, const Scenario *scenario, Err *err)
{
    return scenario->run.tolerance_of != TOLERANCE_OF_FORCES || scenario_has_clearance(scenario) ||
           entries_refuse(entries_find(entries, "run.tolerance-of", 0), err,
                          "no joint has play, and no contact a force\nallowed: motion, peaks");
}

static bool check_run(const Entries *entries, const Scenario *scenario, Err *err)
{
    const bool is_driven = scenario->linkage.driver.is_present;
    const bool is_soft = entries_blame(entries, "drive.stiffness drive.damping", 0) != NULL;
    if (is_driven && !is_soft && scenario->linkage.driver.speed == 0.0) {
        return entries_refuse(entries_blame(entries, "drive.speed drive.angle", 0), err,
                              "the crank does not turn\nallowed: any speed but 0, or angles that "
                              "differ");
    }
    const bool has_duration = entries_find(entries, "run.duration", 0) != NULL;
    const bool is_steady = drive_is_steady(&scenario->linkage.driver);
    const bool is_turning = is_steady && !(is_soft && has_duration);
    return check_length(entries, is_steady, is_soft, err) &&
           check_report(entries, scenario, is_turning, err) &&
           check_backends(entries, &scenario->run, err) && check_stepping(entries, scenario, err) &&
           check_tolerance(entries, scenario, err) &&
           check_steps(entries, &scenario->run, scenario_duration(scenario), is_turning, err) &&
           (!is_turning || check_samples(entries, &scenario->run, err));
}

// Speeds at the start are the drive's where it determines them.
static bool check_speeds(const Entries *entries, const Linkage *linkage, Err *err)
{
    const Entry *entry = entries_speed(entries, linkage->body_count);
    return entry == NULL || !build_is_determined(linkage) ||
           entries_refuse(
               entry, err,
               "the drive determines how body '%s' moves\nallowed: no velocity and no spin",
               linkage->bodies[entry->index].name);
}

bool check_values(const Entries *entries, const Scenario *scenario, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    const EntryGroup *bodies = entries_group(entries, "bodies", 0);
    if (linkage->body_count == 0) {
        return entries_refuse_group(bodies, err,
                                    "a case needs a body\nallowed: pin: {mass: 0.1 kg, inertia: 2 "
                                    "kg mm^2, at: [0 mm, 0 mm]}");
    }
    return check_joints(entries, scenario, err) && check_space(entries, scenario, err) &&
           check_friction(entries, scenario, err) && check_friction(entries, scenario, err) &&
           check_forces(entries, scenario, err) && drives_check(entries, linkage, err) &&
           check_speeds(entries, linkage, err) && check_contact(entries, scenario, err) &&
           check_run(entries, scenario, err) && check_collider(entries, scenario, err);
}
