// Makes a scenario of the entries of a case.
//
// presence -> values in SI -> checks that need several values -> linkage at its start.
#include "casefile/assemble.h"

#include "casefile/build.h"
#include "casefile/bushings.h"
#include "casefile/cam.h"
#include "casefile/check.h"
#include "casefile/closure.h"
#include "casefile/drives.h"
#include "casefile/joint_kind.h"
#include "casefile/limits.h"
#include "casefile/loads.h"
#include "casefile/profiles.h"
#include "casefile/slider.h"
#include "casefile/slot.h"
#include "casefile/store.h"
#include "casefile/teeth.h"
#include "casefile/unused.h"
#include "casefile/waves.h"
#include "model/common_period.h"
#include "model/joint_friction.h"
#include "model/space.h"

#include <string.h>

// 1: of a period, what rounding may leave
static const double PERIOD_ROUNDING = 1e-9;

// Notes which values a joint has of its own.
static void note_given(const Entries *entries, size_t number, Joint *joint)
{
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        if (row->flag > 0) {
            *(bool *)((char *)joint + row->flag) = entries_at(entries, row, number) != NULL;
        }
    }
}

// What follows from the keys that are given and not from their values.
static void store_presence(const Entries *entries, Scenario *scenario)
{
    Linkage *linkage = &scenario->linkage;
    const EntryNames *names = entries->names;
    *linkage = linkage_create((LinkageRoom){
        .bodies = names[SCHEMA_BODY].count,
        .joints = names[SCHEMA_JOINT].count,
        .springs = names[SCHEMA_SPRING].count,
        .torsions = names[SCHEMA_TORSION_SPRING].count,
        .bushings = names[SCHEMA_BUSHING].count,
        .loads = names[SCHEMA_LOAD_FAMILY].count,
        .further = names[SCHEMA_DRIVE].count,
        .profiles = profiles_count(entries),
    });
    linkage->body_count = names[SCHEMA_BODY].count;
    linkage->joint_count = names[SCHEMA_JOINT].count;
    scenario->point_count = names[SCHEMA_POINT].count;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint *joint = &linkage->joints[i];
        text_copy(joint->name, LINKAGE_NAME_SIZE, names[SCHEMA_JOINT].names[i]);
        joint->kind = joint_kind_find(entries, i);
        joint->stop.is_disc = entries_find(entries, "joints.*.discs", i) != NULL;
        note_given(entries, i, joint);
        joint->limits = limits_prepare(entries, i);
        joint->space.axis = (Vec3){0.0, 0.0, 1.0};
    }
    profiles_prepare(entries, scenario);
    for (size_t i = 0; i < linkage->body_count; i++) {
        text_copy(linkage->bodies[i].name, LINKAGE_NAME_SIZE, names[SCHEMA_BODY].names[i]);
    }
    for (size_t i = 0; i < scenario->point_count; i++) {
        text_copy(scenario->points[i].name, LINKAGE_NAME_SIZE, names[SCHEMA_POINT].names[i]);
    }
    linkage->spring_count = names[SCHEMA_SPRING].count;
    linkage->torsion_count = names[SCHEMA_TORSION_SPRING].count;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        text_copy(linkage->springs[i].name, LINKAGE_NAME_SIZE, names[SCHEMA_SPRING].names[i]);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        text_copy(linkage->torsions[i].name, LINKAGE_NAME_SIZE,
                  names[SCHEMA_TORSION_SPRING].names[i]);
    }
    bushings_prepare(entries, linkage);
    loads_prepare(entries, linkage);
    drives_prepare(entries, linkage);
    const bool has_torque =
        entries_blame(entries, "drive.torque drive.force drive.stall-torque", 0) != NULL;
    linkage->driver.is_present =
        entries->form != SCHEMA_LONG || (entries_group(entries, "drive", 0) != NULL && !has_torque);
    if (entries->form == SCHEMA_LONG) {
        // the closed form knows the short forms only
        scenario->run.backend_count = 2;
        scenario->run.backends[0] = BACKEND_REFERENCE;
        scenario->run.backends[1] = BACKEND_ODE;
    }
}

// Stepping and map where a case names neither, or only one of them: the other is its natural
// partner, so that `map: textbook` is ODE as its manual has it. A collider other than the exact one
// needs a contact row, and map impulse has none. A case that names a way of stepping or such a
// collider, or whose contact model has no order to choose a step by, has a given step.
static void store_partners(const Entries *entries, Scenario *scenario)
{
    OdeOptions *ode = &scenario->ode;
    const bool is_poisson = scenario->contact.model == CONTACT_POISSON;
    const bool has_step = entries_find(entries, "run.step", 0) != NULL;
    const bool has_stepping = entries_find(entries, "ode.stepping", 0) != NULL;
    const bool has_map = entries_find(entries, "ode.map", 0) != NULL;
    const bool is_faceted =
        scenario_has_clearance(scenario) && ode->collider != ODE_COLLIDER_PIN_HOLE;
    if (!has_map && (is_poisson || ode->stepping == ODE_PLAIN)) {
        ode->map = ODE_MAP_TEXTBOOK;
    } else if (!has_map && is_faceted) {
        ode->map = ODE_MAP_MIDPOINT;
    }
    const bool is_of_staggered = ode->map == ODE_MAP_IMPULSE || ode->map == ODE_MAP_MIDPOINT;
    if (!has_stepping && !is_of_staggered) {
        ode->stepping = ODE_PLAIN;
    }
    if (!has_step && (has_stepping || has_map || is_poisson || is_faceted)) {
        scenario->run.step = OPTIONS_GIVEN_STEP;
    }
}

// Lets a drive of which a stiffness or a damping is given follow its speed with these: no body is
// driven then, and the run has a duration, of so many turns of a constant speed or as it says. The
// samples of a turn are then those of the run.
static void soften_drive(const Entries *entries, Scenario *scenario)
{
    Linkage *linkage = &scenario->linkage;
    RunOptions *run = &scenario->run;
    if (entries_blame(entries, "drive.stiffness drive.damping", 0) != NULL) {
        if (run->is_report_from_in_turns) {
            run->report_from = scenario_report_from(scenario);
            run->is_report_from_in_turns = false;
        }
        if (drive_is_steady(&linkage->driver) && entries_find(entries, "run.duration", 0) == NULL) {
            run->duration = scenario_duration(scenario);
            run->samples = scenario_sample_count(scenario) - 1;
        }
        linkage->torque.followed = linkage->driver;
        linkage->torque.table = (TimeTable){.count = 1};
        linkage->driver.is_present = false;
    }
}

// Why a case that does not say how it starts is not settled: it says where its joints start, or
// there is no motion to settle or no time for it. NULL: it is.
static const char *reason_against(const Entries *entries, const Scenario *acting,
                                  const CommonPeriod *period)
{
    const RunOptions *run = &acting->run;
    const bool is_steady = drive_is_steady(&acting->linkage.driver);
    bool is_given = false;
    for (size_t i = 0; i < acting->linkage.joint_count; i++) {
        is_given = is_given || entries_find(entries, "joints.*.start", i) != NULL;
    }
    return period->period_s == 0.0                    ? period->why
           : acting->contact.model == CONTACT_POISSON ? "contacts of model poisson have no state"
           : is_given                                 ? "the case gives where a joint starts"
           : is_steady && run->revolutions < 1.0      ? "it runs for less than a revolution"
           : !is_steady && run->duration < (1.0 - PERIOD_ROUNDING) * period->period_s
               ? "it runs for less than a period"
               : NULL;
}

// How a case starts: settled, unless it says otherwise or something is against it. A drive of
// constant speed may have loads that take several revolutions: one shows a part of the motion.
static bool store_run_start(const Entries *entries, Scenario *scenario, Err *err)
{
    RunOptions *run = &scenario->run;
    const Entry *entry = entries_find(entries, "run.start", 0);
    run->is_start_given = entry != NULL;
    if (!scenario_has_clearance(scenario)) {
        return true;
    }
    Scenario acting = *scenario;
    soften_drive(entries, &acting);
    const CommonPeriod period = common_period_find(&acting.linkage);
    if (entry != NULL) {
        return run->start != START_SETTLED || !period.is_mismatch ||
               entries_refuse(entry, err,
                              "%s\nallowed: periods of which whole numbers up to 64 take the same "
                              "time; or run.start: centred",
                              period.why);
    }
    const char *reason = reason_against(entries, &acting, &period);
    if (reason != NULL) {
        scenario_start_as_written(scenario, reason);
    }
    return true;
}

// The line of a motor's torque over speed, and its rotor on the body that it turns.
static void complete_motor(const Entries *entries, Linkage *linkage)
{
    Torque *torque = &linkage->torque;
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i].inertia = linkage->bodies[i].own_inertia;
    }
    if (entries_find(entries, "drive.stall-torque", 0) != NULL && linkage->joint_count > 0) {
        int turned;
        int against;
        torque->table.count = 1;
        torque->slope = torque->no_load != 0.0 ? torque->table.values[0] / torque->no_load : 0.0;
        linkage_turning(linkage, torque->joint, &turned, &against);
        linkage->bodies[turned].inertia += torque->inertia;
    }
}

// Gives joints with friction the law of the contact, where they have none of their own; others hold
// none.
static void take_friction_laws(Scenario *scenario)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        Joint *joint = &scenario->linkage.joints[i];
        const bool has_friction =
            joint_friction_is(joint) ||
            (!joint_is_ideal(joint->kind) && scenario_friction(scenario, joint) > 0.0);
        if (has_friction && !joint->friction.has_law) {
            joint->friction.law = scenario->contact.friction_law;
        }
    }
}

// A soft drive of constant speed may have a duration: so many turns.
static void store_soft_length(const Entries *entries, Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    if (entries_blame(entries, "drive.stiffness drive.damping", 0) != NULL &&
        entries_find(entries, "run.duration", 0) != NULL && drive_is_steady(&linkage->driver) &&
        linkage->driver.speed != 0.0) {
        scenario->run.revolutions = scenario->run.duration / linkage_period(linkage);
    }
}

// Stores every value in the order of the schema, so that the same mistake is reported first
// wherever the keys stand.
static bool store_entries(const Entries *entries, Scenario *scenario, Err *err)
{
    store_presence(entries, scenario);
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        const size_t members = entries_family_size(entries, row);
        for (size_t index = 0; index < members; index++) {
            const Entry *entry = entries_at(entries, row, index);
            if (entry != NULL && !store_value(entries, entry, scenario, err)) {
                return false;
            }
        }
    }
    scenario->linkage.torque.joint = scenario->linkage.driver.joint;
    store_soft_length(entries, scenario);
    cam_complete(entries, &scenario->linkage);
    complete_motor(entries, &scenario->linkage);
    if (!waves_check_used(entries, err) || !teeth_join(entries, &scenario->linkage, err) ||
        !drives_complete(entries, &scenario->linkage, err) ||
        !loads_complete(entries, &scenario->linkage, err)) {
        return false;
    }
    store_partners(entries, scenario);
    if (!store_run_start(entries, scenario, err)) {
        return false;
    }
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const bool is_damped = scenario->linkage.joints[i].contact.gap_damping > 0.0;
        scenario->linkage.gap_damper_count += is_damped ? 1 : 0;
    }
    scenario->linkage.is_spatial = scenario->space == SCENARIO_SPATIAL;
    space_complete(&scenario->linkage);
    take_friction_laws(scenario);
    return true;
}

static bool build_long(const Entries *entries, Scenario *scenario, Err *err)
{
    if (scenario->linkage.is_spatial && !space_is_upright(&scenario->linkage)) {
        return build_spatial(entries, scenario, err);
    }
    return build_linkage(entries, scenario, err) &&
           limits_check_starts(entries, &scenario->linkage, err) &&
           slot_check_starts(entries, &scenario->linkage, err) &&
           closure_check_ideal(entries, scenario, err);
}

static bool build_form(const Entries *entries, Scenario *scenario, Err *err)
{
    switch (entries->form) {
    case SCHEMA_FOUR_BAR:
        return closure_check(entries, scenario, err) && build_fourbar(scenario, err) &&
               build_forces(entries, scenario);
    case SCHEMA_SLIDER_CRANK:
        return slider_check(entries, scenario, err) && slider_build(scenario, err) &&
               build_forces(entries, scenario);
    case SCHEMA_LONG:
    case SCHEMA_ALL: // these two are sets of forms
    case SCHEMA_SHORT:
        break;
    }
    return build_long(entries, scenario, err);
}

// What remains is wrong as a whole; it is shown at the drive, or at the top where there is none.
static bool build(const Entries *entries, Scenario *scenario, Err *err)
{
    Err own = {0};
    const bool is_built = build_form(entries, scenario, &own);
    if (is_built && scenario_check(scenario, &own)) {
        return true;
    }
    if (!is_built && own.kind != ERR_SOLVER) {
        *err = own; // it points at a line already
        return false;
    }
    static const char FORMAT[] = "the mechanism cannot be solved at its start: %s";
    const Entry *speed = entries_find(entries, "drive.speed", 0);
    return speed != NULL
               ? entries_refuse(speed, err, FORMAT, own.text)
               : entries_refuse_group(entries_group(entries, "", 0), err, FORMAT, own.text);
}

// Builds the bodies where the case puts them: a soft drive may follow an angle that is ahead of
// them from the start.
static bool build_behind(const Entries *entries, Scenario *scenario, Err *err)
{
    Driver *driver = &scenario->linkage.driver;
    const TimeTable written = driver->table;
    if (driver->has_angles && entries_blame(entries, "drive.stiffness drive.damping", 0) != NULL) {
        const double ahead = drive_angle(driver, 0.0) - driver->start;
        for (size_t i = 0; i < driver->table.count; i++) {
            driver->table.values[i] -= ahead;
        }
    }
    const bool is_built = build(entries, scenario, err);
    driver->table = written;
    return is_built;
}

bool assemble_scenario(const Entries *entries, Scenario *scenario, Err *err)
{
    Scenario built = scenario_default();
    if (!check_required(entries, err) || !store_entries(entries, &built, err) ||
        !check_values(entries, &built, err) || !closure_check_members(entries, &built, err) ||
        !build_behind(entries, &built, err) || !unused_check(entries, &built, err)) {
        scenario_free(&built);
        return false;
    }
    soften_drive(entries, &built);
    const Source *source = entries_group(entries, "", 0)->source;
    scenario_set_path(&built, source->name);
    unused_remember(entries, &built);
    *scenario = built;
    return true;
}
