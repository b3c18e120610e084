// Writes how the start of a scenario was found.
#include "write/settled.h"

#include "write/json_value.h"
#include "write/table.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// What the motion is told by: a revolution, or a period of a drive whose speed repeats or of loads.
static const char *turn_word(const Scenario *scenario)
{
    const bool is_steady = drive_is_steady(&scenario->linkage.driver);
    return is_steady && scenario_settling_turns(scenario) == 1.0 ? "revolution" : "period";
}

// Around the force of a motion that does not repeat.
static const char *some_word(const SettledMotion *motion)
{
    return motion->period == 0 ? "some " : "";
}

static const char *median_word(const SettledMotion *motion)
{
    return motion->period == 0 ? " in the median" : "";
}

static void append_joint(const Scenario *scenario, size_t number, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    const Joint *joint = &scenario->linkage.joints[number];
    const char *unit = joint_units(joint)->force;
    const SettledMotion *motion = &settled->motions[0];
    const SettledJoint *did = &motion->joints[number];
    text_append(text, "              ");
    text_append_shown(text, joint->name);
    text_append(text, ": %.5g %s", did->force.headline, unit);
    if (motion->period == 0) {
        text_append(text, " in the median %s, %.4g to %.4g in 5 to 95 %%", turn_word(scenario),
                    did->force.low, did->force.high);
    }
    text_append(text, "\n");
    if (settled->halved.joints != NULL && settled->doubled.joints != NULL) {
        const SettledMotion *half = &settled->halved;
        const SettledMotion *twice = &settled->doubled;
        text_append(text, "                with half the damping %s%.4g %s%s, ", some_word(half),
                    half->joints[number].force.headline, unit, median_word(half));
        text_append(text, "with twice as much %s%.4g%s\n", some_word(twice),
                    twice->joints[number].force.headline, median_word(twice));
    }
    text_append(text, "                from the assumed start %.5g %s, not counted\n",
                settled->first[number], unit);
}

static void append_period(const Scenario *scenario, const SettledMotion *motion, Text *text)
{
    if (motion->period == 0) {
        text_append(text, "does not repeat");
    } else if (motion->period == 1) {
        text_append(text, "repeats every %s", turn_word(scenario));
    } else {
        text_append(text, "repeats every %zu %ss", motion->period, turn_word(scenario));
    }
}

// Another motion that starts have come to.
static void append_other(const Scenario *scenario, const SettledMotion *motion, Text *text)
{
    text_append(text, "              %zu of %zu starts come to another, which ", motion->starts,
                scenario->settled.starts);
    append_period(scenario, motion, text);
    text_append(text, ":");
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (linkage_has_play(joint)) {
            text_append(text, " ");
            text_append_shown(text, joint->name);
            text_append(text, " %.5g %s", motion->joints[i].force.headline,
                        joint_units(joint)->force);
        }
    }
    text_append(text, "\n");
}

// What becomes of a small change of the state.
static void append_growth(const Scenario *scenario, Text *text)
{
    const SettledGrowth *growth = &scenario->settled.growth;
    if (!scenario->settled.has_growth || isnan(growth->factor)) {
        return;
    }
    text_append(text, "              a small change of the state %s %.3g times itself each %s\n",
                growth->is_at_most ? "is gone, or less than" : "becomes", growth->factor,
                turn_word(scenario));
}

void settled_text(const Scenario *scenario, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    if (scenario->run.centred_because != NULL) {
        text_append(text, "  start       as written: %s\n", scenario->run.centred_because);
    }
    if (settled->motion_count == 0) {
        return;
    }
    text_append(text, "  start       settled: ");
    append_period(scenario, &settled->motions[0], text);
    text_append(text, ", found in %zu from %zu of %zu start%s\n", settled->revolutions,
                settled->motions[0].starts, settled->starts, settled->starts > 1 ? "s" : "");
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (linkage_has_play(&scenario->linkage.joints[i])) {
            append_joint(scenario, i, text);
        }
    }
    append_growth(scenario, text);
    for (size_t i = 1; i < settled->motion_count; i++) {
        append_other(scenario, &settled->motions[i], text);
    }
}

// The first screen.

enum { SHOWN_JOINTS = 2 }; // of a line, those of the largest forces

// The numbers of the joints with play whose forces are the largest; returns how many.
static size_t largest_joints(const Scenario *scenario, size_t numbers[SHOWN_JOINTS])
{
    const SettledJoint *joints = scenario->settled.motions[0].joints;
    size_t count = 0;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (!linkage_has_play(&scenario->linkage.joints[i])) {
            continue;
        }
        size_t at = count;
        while (at > 0 && joints[i].force.headline > joints[numbers[at - 1]].force.headline) {
            at--;
        }
        if (at < SHOWN_JOINTS) {
            const size_t kept = count < SHOWN_JOINTS ? count : SHOWN_JOINTS - 1;
            memmove(numbers + at + 1, numbers + at, (kept - at) * sizeof *numbers);
            numbers[at] = i;
            count = kept + 1;
        }
    }
    return count;
}

static void append_force(const Scenario *scenario, size_t number, double force, Text *text)
{
    units_append(text, force, joint_units(&scenario->linkage.joints[number])->force);
}

// "crank-coupler 2.36 kN, rod-slider 1.12 kN" of one motion.
static void append_forces(const Scenario *scenario, const SettledMotion *motion, Text *text)
{
    size_t numbers[SHOWN_JOINTS];
    const size_t count = largest_joints(scenario, numbers);
    for (size_t i = 0; i < count; i++) {
        const SettledJoint *did = &motion->joints[numbers[i]];
        text_append(text, "%s", i > 0 ? ", " : "");
        text_append_shown(text, scenario->linkage.joints[numbers[i]].name);
        text_append(text, " ");
        append_force(scenario, numbers[i], did->force.headline, text);
        if (motion->period == 0) {
            text_append(text, " (");
            append_force(scenario, numbers[i], did->force.low, text);
            text_append(text, " to ");
            append_force(scenario, numbers[i], did->force.high, text);
            text_append(text, ")");
        }
    }
}

// How long a run shows all of a motion that repeats, where this one does not.
static void append_length(const Scenario *scenario, size_t period, Text *text)
{
    const double whole_s = (double)period * scenario_settling_period(scenario);
    if (whole_s <= (1.0 + 1e-9) * scenario_duration(scenario)) {
        return;
    }
    if (drive_is_steady(&scenario->linkage.driver)) {
        text_append(text, " (run.revolutions: %.6g shows all)",
                    (double)period * scenario_settling_turns(scenario));
    } else {
        text_append(text, " (run.duration: %.6g s shows all)", whole_s);
    }
}

// What the run shows, and how it was found.
static void append_motion(const Scenario *scenario, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    const SettledMotion *motion = &settled->motions[0];
    Text line;
    text_init(&line);
    text_append(&line, "  Settled motion, ");
    if (motion->period == 0) {
        text_append(&line,
                    "which does not repeat in %zu %ss; largest force of a %s, median (5 to 95 "
                    "%%): ",
                    settled->revolutions, turn_word(scenario), turn_word(scenario));
        append_forces(scenario, motion, &line);
    } else {
        text_append(&line, "which ");
        append_period(scenario, motion, &line);
        append_length(scenario, motion->period, &line);
    }
    text_append(&line, "; %zu of %zu starts come to it.", motion->starts, settled->starts);
    screen_sentence(&line, text);
}

// The force of a joint with other damping; of a motion that does not repeat one of few revolutions.
static void append_damped(const Scenario *scenario, size_t number, const SettledMotion *motion,
                          Text *text)
{
    text_append(text, "%s", some_word(motion));
    append_force(scenario, number, motion->joints[number].force.headline, text);
    text_append(text, "%s", median_word(motion));
}

// What the case as it is written says of its first revolution, and other damping of the settled
// one.
static void append_beside(const Scenario *scenario, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    size_t numbers[SHOWN_JOINTS];
    if (largest_joints(scenario, numbers) == 0) {
        return;
    }
    Text line;
    text_init(&line);
    text_append(&line, "  From the assumed start: ");
    text_append_shown(&line, scenario->linkage.joints[numbers[0]].name);
    text_append(&line, " ");
    append_force(scenario, numbers[0], settled->first[numbers[0]], &line);
    text_append(&line, ", not counted.");
    if (settled->halved.joints != NULL && settled->doubled.joints != NULL) {
        text_append(&line, " With half the damping: ");
        append_damped(scenario, numbers[0], &settled->halved, &line);
        text_append(&line, ", with twice as much: ");
        append_damped(scenario, numbers[0], &settled->doubled, &line);
        text_append(&line, ".");
    }
    screen_sentence(&line, text);
}

void settled_sentences(const Scenario *scenario, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    if (scenario->run.centred_because != NULL) {
        Text line;
        text_init(&line);
        text_append(&line, "  Starts as written, and the first impacts count: %s.",
                    scenario->run.centred_because);
        screen_sentence(&line, text);
    }
    if (settled->motion_count == 0) {
        return;
    }
    append_motion(scenario, text);
    if (settled->motion_count > 1) {
        Text line;
        text_init(&line);
        text_append(&line, "  %zu of %zu starts come to %s: ", settled->motions[1].starts,
                    settled->starts,
                    settled->motion_count > 2 ? "others, the next" : "another motion");
        append_forces(scenario, &settled->motions[1], &line);
        text_append(&line, ".");
        screen_sentence(&line, text);
    }
    append_beside(scenario, text);
}

void settled_lines(const Scenario *scenario, Text *text)
{
    const size_t start = text->length;
    settled_sentences(scenario, text);
    text_fold_behind(text, start, STYLE_WIDTH);
}

static void set_force(json_t *of, const Joint *joint, const char *name, double value)
{
    char key[64];
    const bool is_turn = linkage_is_torsional(joint);
    snprintf(key, sizeof key, "%s_%s_%s", is_turn ? "torque" : "force", name,
             is_turn ? "N_m" : "N");
    json_value_set(of, key, value);
}

// The angular velocities at the ends of the revolutions of a motion, by body.
static json_t *sections_json(const Scenario *scenario, const SettledMotion *motion)
{
    const Linkage *linkage = &scenario->linkage;
    json_t *bodies = json_object();
    for (size_t i = 0; i < linkage->body_count; i++) {
        json_t *values = json_array();
        for (size_t k = 0; k < motion->section_count; k++) {
            json_array_append_new(values,
                                  json_value_real(motion->sections[k * linkage->body_count + i]));
        }
        json_object_set_new(bodies, linkage->bodies[i].name, values);
    }
    json_t *object = json_object();
    json_object_set_new(object, "bodies", bodies);
    return object;
}

static json_t *motion_json(const Scenario *scenario, const SettledMotion *motion)
{
    json_t *joints = json_array();
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (!linkage_has_play(joint)) {
            continue;
        }
        const SettledJoint *did = &motion->joints[i];
        json_t *of = json_object();
        json_object_set_new(of, "name", json_value_text(joint->name));
        set_force(of, joint, "max", did->force.headline);
        set_force(of, joint, "max_low", did->force.low);
        set_force(of, joint, "max_high", did->force.high);
        set_force(of, joint, "max_from_start", scenario->settled.first[i]);
        json_value_set(of, "impacts_per_revolution", did->impacts.mean);
        json_array_append_new(joints, of);
    }
    json_t *found = json_object();
    json_object_set_new(found, "starts", json_integer((json_int_t)motion->starts));
    json_object_set_new(found, "period", json_integer((json_int_t)motion->period));
    json_value_set(found, "change", motion->change);
    json_object_set_new(found, "joints", joints);
    if (motion->section_count > 0) {
        json_object_set_new(found, "section_omega_rad_s", sections_json(scenario, motion));
    }
    return found;
}

void settled_json(json_t *object, const Scenario *scenario)
{
    const SettledStart *settled = &scenario->settled;
    if (scenario->run.centred_because != NULL) {
        json_object_set_new(object, "starts_as_written_because",
                            json_string(scenario->run.centred_because));
    }
    if (settled->motion_count == 0) {
        return;
    }
    json_t *found = motion_json(scenario, &settled->motions[0]);
    json_object_set_new(found, "revolutions", json_integer((json_int_t)settled->revolutions));
    json_object_set_new(found, "starts_tried", json_integer((json_int_t)settled->starts));
    if (settled->has_growth) {
        json_value_set(found, "growth_per_revolution", settled->growth.factor);
        json_object_set_new(found, "growth_is_at_most", json_boolean(settled->growth.is_at_most));
    }
    json_t *others = json_array();
    for (size_t i = 1; i < settled->motion_count; i++) {
        json_array_append_new(others, motion_json(scenario, &settled->motions[i]));
    }
    json_object_set_new(found, "other_motions", others);
    if (settled->halved.joints != NULL) {
        json_object_set_new(found, "half_damping", motion_json(scenario, &settled->halved));
    }
    if (settled->doubled.joints != NULL) {
        json_object_set_new(found, "double_damping", motion_json(scenario, &settled->doubled));
    }
    json_object_set_new(object, "settled", found);
}
