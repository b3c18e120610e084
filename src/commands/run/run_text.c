// What was run, how was it modelled, and what came out?
#include "base/zeroed.h"
#include "commands/run/run_report.h"
#include "contact/law.h"
#include "contact/penalty.h"
#include "model/kinematics.h"
#include "model/space_rows.h"
#include "write/alike.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static size_t mobility(const Linkage *linkage, bool ideal_only)
{
    if (linkage->is_spatial) {
        SpaceMotion *motions = zeroed(linkage->body_count, sizeof *motions);
        space_start(linkage, motions);
        const size_t freedoms = space_rows_mobility(linkage, motions, ideal_only);
        free(motions);
        return freedoms;
    }
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    const size_t freedoms = kinematics_mobility(linkage, motions, ideal_only);
    free(motions);
    return freedoms;
}

static void write_freedoms(const Linkage *linkage, bool has_play, Text *text)
{
    const size_t closed = mobility(linkage, false);
    const size_t open = has_play ? mobility(linkage, true) : closed;
    text_append(text, "  mechanism   %zu %s%s, %zu joint%s, mobility %zu", linkage->body_count,
                linkage->body_count == 1 ? "body" : "bodies",
                linkage->is_spatial ? " in space" : "", linkage->joint_count,
                linkage->joint_count == 1 ? "" : "s", closed);
    if (open != closed) {
        text_append(text, " (%zu with the play open)", open);
    }
}

// How far a pin in space can tilt and slide.
static void write_room(const Joint *joint, Text *text)
{
    const double limit =
        asin(fmin(1.0, 2.0 * linkage_radial_clearance(joint) / joint->clearance.width));
    text_append(text, "\n              width %.7g mm: tilts up to %.4g mrad, ",
                joint->clearance.width * UNITS_MM, limit * UNITS_MRAD);
    if (joint->space.axial_clearance > 0.0) {
        text_append(text, "slides up to %.4g um each way", joint->space.axial_clearance * UNITS_UM);
    } else {
        text_append(text, "slides freely");
    }
}

static void write_pin(const Joint *joint, bool is_spatial, Text *text)
{
    text_append(text, "hole %.7g mm, pin %.7g mm, radial clearance %.4g um",
                2.0 * joint->clearance.hole_radius * UNITS_MM,
                2.0 * joint->clearance.pin_radius * UNITS_MM,
                linkage_radial_clearance(joint) * UNITS_UM);
    if (is_spatial) {
        write_room(joint, text);
    }
}

static void write_guide(const Joint *joint, Text *text)
{
    const Guide *guide = &joint->guide;
    const bool is_sleeve = guide->height > guide->opening;
    text_append(text, "%s %.7g mm, length %.7g mm, %s %.7g mm:\n", is_sleeve ? "sleeve" : "block",
                guide->height * UNITS_MM, guide->length * UNITS_MM, is_sleeve ? "rod" : "guide",
                guide->opening * UNITS_MM);
    text_append(text, "              %.4g um either way, tilts up to %.4g mrad",
                linkage_radial_clearance(joint) * UNITS_UM, linkage_guide_tilt(guide) * UNITS_MRAD);
}

static void write_stop(const Joint *joint, Text *text)
{
    const Stop *stop = &joint->stop;
    if (stop->radius_b > 0.0) {
        text_append(text, "disc of %.7g mm", 2.0 * stop->radius_b * UNITS_MM);
    } else {
        text_append(text, "point");
    }
    if (stop->is_disc) {
        text_append(text, " against a disc of %.7g mm", 2.0 * stop->radius_a * UNITS_MM);
    } else {
        text_append(text, " against a line");
    }
}

// What limits a coordinate: in degrees of a pivot, mm of a slider, and um of teeth.
static void write_limits(const Joint *joint, Text *text)
{
    const Limits *limits = &joint->limits;
    const bool is_turning = linkage_is_torsional(joint);
    const double scale = is_turning ? UNITS_DEG : UNITS_MM;
    const char *unit = is_turning ? "deg" : "mm";
    if (joint->kind == JOINT_GEAR) {
        text_append(text, "%.6g and %.6g teeth, pitch radii %.6g and %.6g mm,\n",
                    joint->gear.teeth[0], joint->gear.teeth[1], joint->gear.radius_a * UNITS_MM,
                    joint->gear.radius_b * UNITS_MM);
        text_append(text, "              backlash %.4g um, %.4g deg of the second",
                    limits->backlash * UNITS_UM,
                    limits->backlash / fabs(joint->gear.radius_b) * UNITS_DEG);
    } else if (limits->kind == LIMIT_BACKLASH) {
        text_append(text, "%.6g %s", limits->backlash * scale, unit);
    } else {
        if (isfinite(limits->low)) {
            text_append(text, "low %.6g %s%s", limits->low * scale, unit,
                        isfinite(limits->high) ? ", " : "");
        }
        if (isfinite(limits->high)) {
            text_append(text, "high %.6g %s", limits->high * scale, unit);
        }
    }
}

// The word for the play of a joint; NULL where it has none.
static const char *play_word(const Joint *joint)
{
    if (joint->limits.kind != LIMIT_NONE) {
        return joint->kind == JOINT_GEAR              ? "gears"
               : joint->limits.kind == LIMIT_BACKLASH ? "backlash"
                                                      : "stops";
    }
    switch (joint->kind) {
    case JOINT_CLEARANCE:
    case JOINT_GUIDE:
        return "play";
    case JOINT_STOP:
        return "stop";
    default:
        return NULL;
    }
}

// What play it is, of a joint that has some.
static void write_joint(const Joint *joint, bool is_spatial, Text *text)
{
    if (joint->limits.kind != LIMIT_NONE) {
        write_limits(joint, text);
    } else if (joint->kind == JOINT_CLEARANCE) {
        write_pin(joint, is_spatial, text);
    } else if (joint->kind == JOINT_GUIDE) {
        write_guide(joint, text);
    } else {
        write_stop(joint, text);
    }
}

// The play of all joints for which there is the same word.
static void write_play(const Linkage *linkage, const char *word, size_t width, Text *text)
{
    char lead[32];
    snprintf(lead, sizeof lead, "  %-12s", word);
    Alike *alike = alike_start();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const char *own = play_word(&linkage->joints[i]);
        if (own == NULL || strcmp(own, word) != 0) {
            continue;
        }
        Text said;
        text_init(&said);
        write_joint(&linkage->joints[i], linkage->is_spatial, &said);
        alike_add(alike, linkage->joints[i].name, said.data);
        text_finish(&said);
    }
    alike_end(alike, lead, ": ", width, text);
}

static void write_mechanism(const RunReport *report, size_t width, Text *text)
{
    static const char *const WORDS[] = {"play", "gears", "backlash", "stops", "stop"};
    const Scenario *scenario = report->scenario;
    write_freedoms(&scenario->linkage, scenario_has_clearance(scenario), text);
    if (scenario->has_fourbar) {
        text_append(text, ", %s", FOURBAR_GRASHOF_NAMES[fourbar_grashof(&scenario->fourbar)]);
    }
    if (scenario->has_slidercrank) {
        text_append(text, ", slider-crank");
    }
    if (report->summary != NULL) {
        text_append(text, ", transmission angle %.4g to %.4g deg",
                    report->summary->transmission_low * UNITS_DEG,
                    report->summary->transmission_high * UNITS_DEG);
    }
    text_append(text, "\n");
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++) {
        write_play(&scenario->linkage, WORDS[i], width, text);
    }
}

static void write_speeds(const Driver *driver, Text *text)
{
    const TimeTable *speeds = &driver->speeds;
    const size_t last = speeds->count - 1;
    text_append(text, "  drive       from %.6g rpm to %.6g rpm by %zu points over time\n",
                speeds->values[0] * UNITS_RPM, speeds->values[last] * UNITS_RPM, speeds->count);
    text_append(text, "              largest %.6g rpm, %.6g rad/s, from %.4g deg\n",
                driver->speed * UNITS_RPM, driver->speed, driver->start * UNITS_DEG);
}

static void write_drive(const Scenario *scenario, Text *text)
{
    const Driver *driver = &scenario->linkage.driver;
    const bool is_steady = drive_is_steady(driver);
    if (is_steady) {
        text_append(text, "  drive       %.6g rpm %s, %.6g rad/s, from %.4g deg\n",
                    fabs(driver->speed) * UNITS_RPM,
                    driver->speed < 0.0 ? "clockwise" : "counter-clockwise", fabs(driver->speed),
                    driver->start * UNITS_DEG);
    } else if (driver->is_present) {
        write_speeds(driver, text);
    }
    text_append(text, "  run         ");
    if (is_steady) {
        text_append(text, "%.6g revolution%s, ", scenario->run.revolutions,
                    scenario->run.revolutions == 1.0 ? "" : "s");
    }
    text_append(text, "%.6g ms, %zu samples\n", scenario_duration(scenario) * UNITS_MS,
                scenario_sample_count(scenario));
    if (scenario->run.report_from > 0.0) {
        text_append(text, "  reported    extremes, contacts and spikes from %.6g ms on\n",
                    scenario_report_from(scenario) * UNITS_MS);
    }
}

static void write_damping(const ContactOptions *contact, bool is_turning, Text *text)
{
    text_append(text, ", damping %s", OPTIONS_DAMPINGS[contact->damping]);
    if (contact->damping == DAMPING_VISCOUS) {
        text_append(text, " %.4g %s", contact->viscous_coefficient,
                    is_turning ? "N m s/rad" : "N s/m");
    } else if (contact->damping != DAMPING_NONE) {
        text_append(text, ", restitution %.4g", contact->restitution);
    }
}

static void write_impact_law(const Scenario *scenario, const Joint *joint, Text *text)
{
    const ContactOptions own = law_options(&scenario->contact, joint);
    const bool is_turning = linkage_is_torsional(joint);
    ForceLaw law;
    Err err = {0};
    text_append(text, "%s", own.stiffness > 0.0 ? "given stiffness" : OPTIONS_LAWS[own.law]);
    if (!law_build(&own, &scenario->material, &joint->clearance, scenario->linkage.driver.speed,
                   &law, &err)) {
        text_append(text, " (%s)", err.text);
    } else if (law.family == FORCE_LAW_POWER) {
        text_append(text, ", K = %.4g %s", law.stiffness, is_turning ? "N m/rad" : "N/m");
        if (law.exponent != 1.0) {
            text_append(text, "^%.4g", law.exponent);
        }
    } else {
        text_append(text, ", d = A F (B - ln F) with A = %.4g m/N, B = %.4g", law.compliance,
                    law.offset);
    }
    write_damping(&own, is_turning, text);
}

static void write_penalty(const Scenario *scenario, const Joint *joint, Text *text)
{
    const bool is_given = scenario->contact.penalty > 0.0;
    text_append(text, "poisson, p = %.4g N s/m (%s), restitution %.4g",
                is_given ? scenario->contact.penalty
                         : penalty_estimate(scenario->linkage.driver.speed, &scenario->material),
                is_given ? "given" : "the paper's estimate", scenario_restitution(scenario, joint));
}

// The coefficient of all joints with play, or of each where one has its own.
static void write_friction(const Scenario *scenario, size_t width, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    bool has_own = false;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        has_own = has_own || linkage->joints[i].contact.has_friction;
    }
    if (!law_has_friction(scenario)) {
        return;
    }
    if (!has_own) {
        text_append(text, "  friction    coefficient %.4g\n", scenario->contact.friction);
        return;
    }
    Alike *alike = alike_start();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_has_play(joint) && !linkage_is_torsional(joint)) {
            char said[40];
            snprintf(said, sizeof said, "coefficient %.4g",
                     law_options(&scenario->contact, joint).friction);
            alike_add(alike, joint->name, said);
        }
    }
    alike_end(alike, "  friction    ", ": ", width, text);
}

static void write_contact(const Scenario *scenario, size_t width, Text *text)
{
    Alike *alike = alike_start();
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (!linkage_has_play(joint)) {
            continue;
        }
        Text said;
        text_init(&said);
        if (scenario->contact.model == CONTACT_IMPACT) {
            write_impact_law(scenario, joint, &said);
        } else {
            write_penalty(scenario, joint, &said);
        }
        alike_add(alike, joint->name, said.data);
        text_finish(&said);
    }
    alike_end(alike, "  contact     ", ": ", width, text);
    write_friction(scenario, width, text);
}

// Why the tolerance asked for is not held to the end.
static const char *why_held_only_so_far(const RunReport *report, const Trajectory *run)
{
    if (!run->is_short) {
        return "the reference is too uncertain";
    }
    return run_report_leaves_branch(report, run) ? "its joints pass a change point there"
                                                 : "run.most-steps is too small";
}

// What does not hold that a reader of the run would take for granted.
static void write_doubts(const RunReport *report, size_t number, const Style *style, Text *text)
{
    const Trajectory *run = report->runs[number];
    const TrajectoryError *error = &report->errors[number];
    if (!run->is_complete) {
        return;
    }
    if (run->trials > 0 && (run->is_short || run->estimate_is_cut)) {
        text_append(text, "              %sheld up to %.4g of %.4g ms only: %s%s\n", style->failure,
                    run->estimate_s * UNITS_MS, run->duration_s * UNITS_MS,
                    why_held_only_so_far(report, run), style->end);
    }
    const bool has_truth = run_report_has_truth(report);
    const double said = error_of_run(error, has_truth && report->truth->is_limited);
    const double uncertainty = has_truth ? report->truth->uncertainty : 0.0;
    // of a solver whose steps are all there is to its error; energy goes with the square of speed,
    // and is off by twice as much
    if (run->step_s > 0.0 && error->is_known && error->energy_lost > 2.0 * (said + uncertainty)) {
        text_append(text,
                    "              %sits energy is off by %.2g of the largest, its error in speed "
                    "is %.2g%s\n",
                    style->failure, error->energy_lost, said, style->end);
    }
}

static void write_models(const RunReport *report, const Style *style, Text *text)
{
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        text_append(text, "  %-10s  %s", run->backend, run->label);
        if (run->step_s > 0.0) {
            text_append(text, ", step %.6g us", run->step_s * UNITS_US);
        }
        if (run->constraint_rows > 0) {
            text_append(text, ", %zu constraint rows", run->constraint_rows);
        }
        if (run->contact_rows > 0) {
            text_append(text, ", at most %zu contact row%s", run->contact_rows,
                        run->contact_rows == 1 ? "" : "s");
        }
        if (!run->is_complete) {
            text_append(text, ", %sFAILED%s: %s", style->failure, style->end, run->message);
        }
        text_append(text, "\n");
        write_doubts(report, i, style, text);
    }
}

void run_text_write(const void *of, const Style *style, Text *text)
{
    const RunReport *report = of;
    const Scenario *scenario = report->scenario;
    section_title(scenario->title, scenario_path(scenario), style, text);
    write_mechanism(report, style->width, text);
    run_loads_write(report, style->width, text);
    write_drive(scenario, text);
    write_contact(scenario, style->width, text);
    write_models(report, style, text);
    // what was asked comes first, how far it can be believed beside it, and theory last
    run_truth_errors(report, style, text);
    run_tables_extremes(report, style, text);
    run_turns_write(report, style, text);
    run_slides_motion(report, style, text);
    run_tables_contacts(report, style, text);
    run_tables_pins(report, style, text);
    run_slides_blocks(report, style, text);
    run_tables_spikes(report, RUN_TEXT_SPIKES, style, text);
    spike_tables_write(report, RUN_TEXT_SPIKES, style, text);
    run_truth_matches(report, style, text);
    run_truth_ensembles(report, style, text);
    run_truth_energy(report, style, text);
    run_tables_cost(report, style, text);
    analytic_text_kinematics(report, style, text);
    analytic_text_forces(report, style, text);
    analytic_text_stackup(report, style, text);
}
