// Says in words how the start of a scenario was found.
#include "write/settled.h"

#include "write/table.h"
#include "write/units.h"

#include <math.h>
#include <string.h>

// What the motion is told by: a revolution, or a period of a drive whose speed repeats or of loads.
static const char *turn_word(const Scenario *scenario)
{
    const bool is_steady = drive_is_steady(&scenario->linkage.driver);
    return is_steady && scenario_settling_turns(scenario) == 1.0 ? "revolution" : "period";
}

static const char *joint_force_unit(const Scenario *scenario, size_t number)
{
    return joint_units(&scenario->linkage.joints[number])->force;
}

static void append_force(const Scenario *scenario, size_t number, double force, Text *text)
{
    units_append(text, force, joint_force_unit(scenario, number));
}

// "11 to 59 %", or "at least 79 %" where all starts come to it.
static void append_share(const SettledMotion *motion, Text *text)
{
    if (motion->share_high >= 1.0) {
        text_append(text, "at least %.0f %%", motion->share_low * UNITS_PERCENT);
    } else {
        text_append(text, "%.0f to %.0f %%", motion->share_low * UNITS_PERCENT,
                    motion->share_high * UNITS_PERCENT);
    }
}

// "10 of 16 starts (35 to 85 % of all, 95 % sure)"; what they do follows.
static void append_starts(const SettledStart *settled, const SettledMotion *motion, Text *text)
{
    text_append(text, "%zu of %zu starts (", motion->starts, settled->starts);
    append_share(motion, text);
    text_append(text, ")");
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

// "; 16 of 16 starts come to it (95 % sure: at least 79 % of all do)."
static void append_share_of_all(const SettledStart *settled, const SettledMotion *motion,
                                Text *text)
{
    if (settled->starts <= 1) {
        text_append(text, "found from one start.");
        return;
    }
    // starts do not come to one motion where none repeats
    text_append(text, "%zu of %zu starts %s (95 %% sure: ", motion->starts, settled->starts,
                motion->period > 0 ? "come to it" : "move so");
    append_share(motion, text);
    text_append(text, " of all do).");
}

// "Does not repeat in 200 revolutions of each of 16 starts; ..."
static void append_watched(const Scenario *scenario, const SettledMotion *motion, Text *text)
{
    text_append(text, "Does not repeat in %zu %ss", motion->watched, turn_word(scenario));
    if (motion->starts > 1) {
        text_append(text, " of each of %zu starts", motion->starts);
    }
    text_append(text, "; a longer transient cannot be ruled out.");
}

// What of the search the budget did not allow; nothing where it is complete.
static void append_budget(const Scenario *scenario, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    const size_t undecided =
        settled->tried > settled->starts ? settled->tried - settled->starts : 0;
    if (settled->is_spent) {
        text_append(text, " run.settle-budget (%.4g s) ended the search%s",
                    scenario->run.settle_budget, undecided > 0 ? " by then;" : ".");
    }
    if (undecided > 0) {
        text_append(text, " %zu of %zu %s undecided", undecided, settled->tried,
                    undecided > 1 ? "are" : "is");
        if (!settled->is_spent) {
            text_append(text, " within run.settle-budget (%.4g s)", scenario->run.settle_budget);
        }
        text_append(text, ".");
    }
}

// All that is known.

// The largest force of a revolution of a motion that does not repeat.
static void append_spread(const Scenario *scenario, size_t number, const SettledMotion *motion,
                          Text *text)
{
    const SettledNumber *force = &motion->joints[number].force;
    const char *unit = joint_force_unit(scenario, number);
    text_append(text, "95 %% below ");
    units_append_interval(text, force->headline, force->low, force->high, unit);
    text_append(text, ", median ");
    units_append_interval(text, force->median, force->median_low, force->median_high, unit);
    text_append(text, ", most ");
    units_append(text, force->largest, unit);
}

static void append_joint(const Scenario *scenario, size_t number, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    const Joint *joint = &scenario->linkage.joints[number];
    const char *unit = joint_units(joint)->force;
    const SettledMotion *motion = &settled->motions[0];
    text_append(text, "              ");
    text_append_shown(text, joint->name);
    if (motion->period == 0) {
        text_append(text, ": largest of a %s, of %zu\n                ", turn_word(scenario),
                    motion->counted);
        append_spread(scenario, number, motion, text);
        text_append(text, "\n");
    } else {
        text_append(text, ": %.5g %s\n", motion->joints[number].force.headline, unit);
    }
    text_append(text, "                first %s from the assumed start, not counted: %.5g %s\n",
                turn_word(scenario), settled->first[number], unit);
}

// Another motion that starts have come to.
static void append_other(const Scenario *scenario, const SettledMotion *motion, Text *text)
{
    text_append(text, "              ");
    append_starts(&scenario->settled, motion, text);
    text_append(text, " come to another, which ");
    append_period(scenario, motion, text);
    text_append(text, ":\n");
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (!linkage_has_play(joint)) {
            continue;
        }
        text_append(text, "                ");
        text_append_shown(text, joint->name);
        text_append(text, " ");
        if (motion->period == 0) {
            append_spread(scenario, i, motion, text);
        } else {
            text_append(text, "%.5g %s", motion->joints[i].force.headline,
                        joint_units(joint)->force);
        }
        text_append(text, "\n");
    }
}

// What becomes of a small change of the state.
static void append_growth(const Scenario *scenario, Text *text)
{
    const SettledGrowth *growth = &scenario->settled.growth;
    const Linkage *linkage = &scenario->linkage;
    if (!scenario->settled.has_growth || isnan(growth->factor)) {
        return;
    }
    text_append(text, "              a small change becomes %s%.3g of itself each %s",
                growth->is_at_most ? "less than " : "", growth->factor, turn_word(scenario));
    if (growth->multiplier_count > 0 && !growth->is_at_most && linkage->body_count > 1) {
        text_append(text, ",\n              most of it in the motion of %s",
                    linkage->bodies[growth->body].name);
    }
    text_append(text, "\n");
}

static void append_search(const Scenario *scenario, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    const SettledMotion *motion = &settled->motions[0];
    text_append(text, "  start       settled: ");
    if (motion->period == 0) {
        append_watched(scenario, motion, text);
        text_append(text, " ");
    } else {
        append_period(scenario, motion, text);
        text_append(text, ", found in %zu; ", settled->revolutions);
    }
    append_share_of_all(settled, motion, text);
    append_budget(scenario, text);
    text_append(text, "\n");
}

void settled_text(const Scenario *scenario, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    if (scenario->run.centred_because[0] != '\0') {
        text_append(text, "  start       as written: %s\n", scenario->run.centred_because);
    }
    if (settled->motion_count == 0) {
        return;
    }
    append_search(scenario, text);
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

// "crank-coupler 2.36 kN, rod-slider 1.12 kN" of one motion; of one that does not repeat the 95 %
// quantiles.
static void append_forces(const Scenario *scenario, const SettledMotion *motion, Text *text)
{
    size_t numbers[SHOWN_JOINTS];
    const size_t count = largest_joints(scenario, numbers);
    for (size_t i = 0; i < count; i++) {
        const SettledNumber *force = &motion->joints[numbers[i]].force;
        text_append(text, "%s", i > 0 ? ", " : "");
        text_append_shown(text, scenario->linkage.joints[numbers[i]].name);
        text_append(text, " ");
        units_append_interval(text, force->headline, force->low, force->high,
                              joint_force_unit(scenario, numbers[i]));
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
        text_append(text, " (pictures of all: run.revolutions: %.6g)",
                    (double)period * scenario_settling_turns(scenario));
    } else {
        text_append(text, " (pictures of all: run.duration: %.6g s)", whole_s);
    }
}

// Of a motion that does not repeat, where no table has its numbers.
static void append_random_forces(const Scenario *scenario, Text *text)
{
    const SettledMotion *motion = &scenario->settled.motions[0];
    Text line;
    text_init(&line);
    text_append(&line,
                "  Largest force of a %s, 95 %% quantile (its interval): ", turn_word(scenario));
    append_forces(scenario, motion, &line);
    text_append(&line, ".");
    screen_sentence(&line, text);
}

// What the run shows, and how it was found.
static void append_motion(const Scenario *scenario, bool is_below_table, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    const SettledMotion *motion = &settled->motions[0];
    Text line;
    text_init(&line);
    if (motion->period == 0) {
        text_append(&line, "  ");
        append_watched(scenario, motion, &line);
        text_append(&line, " ");
    } else {
        text_append(&line, "  Settled motion, which ");
        append_period(scenario, motion, &line);
        if (is_below_table && motion->period > 1) {
            text_append(&line, ", all of which the table is of");
        }
        append_length(scenario, motion->period, &line);
        text_append(&line, "; ");
    }
    append_share_of_all(settled, motion, &line);
    append_budget(scenario, &line);
    screen_sentence(&line, text);
    if (motion->period == 0 && !is_below_table) {
        append_random_forces(scenario, text);
    }
}

// What the case as it is written says of its first revolution.
static void append_first(const Scenario *scenario, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    size_t numbers[SHOWN_JOINTS];
    if (largest_joints(scenario, numbers) == 0) {
        return;
    }
    Text line;
    text_init(&line);
    text_append(&line, "  First %s from the assumed start, not counted: ", turn_word(scenario));
    text_append_shown(&line, scenario->linkage.joints[numbers[0]].name);
    text_append(&line, " ");
    append_force(scenario, numbers[0], settled->first[numbers[0]], &line);
    text_append(&line, ".");
    screen_sentence(&line, text);
}

void settled_louder(const Scenario *scenario, const char *where, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    size_t number;
    size_t joint;
    if (!settled_is_louder(settled, &scenario->linkage, &number, &joint)) {
        return;
    }
    const SettledMotion *motion = &settled->motions[number];
    const SettledNumber *force = &motion->joints[joint].force;
    const double shown = settled->motions[0].joints[joint].force.headline;
    Text line;
    text_init(&line);
    text_append(&line, "  Louder: ");
    append_starts(settled, motion, &line);
    text_append(&line, " come to another motion: ");
    text_append_shown(&line, scenario->linkage.joints[joint].name);
    text_append(&line, " ");
    units_append_interval(&line, force->headline, force->low, force->high,
                          joint_force_unit(scenario, joint));
    if (shown > 0.0) {
        text_append(&line, ", %.2g times the ", force->headline / shown);
        append_force(scenario, joint, shown, &line);
        text_append(&line, " %s.", where);
    } else {
        text_append(&line, ", and none %s.", where);
    }
    screen_sentence(&line, text);
}

void settled_sentences(const Scenario *scenario, bool is_below_table, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    if (scenario->run.centred_because[0] != '\0') {
        Text line;
        text_init(&line);
        text_append(&line, "  Starts as written, and the first impacts count: %s.",
                    scenario->run.centred_because);
        screen_sentence(&line, text);
    }
    if (settled->motion_count == 0) {
        return;
    }
    append_motion(scenario, is_below_table, text);
    if (settled->motion_count > 1) {
        Text line;
        text_init(&line);
        text_append(&line, "  ");
        append_starts(settled, &settled->motions[1], &line);
        text_append(&line, " come to %s: ",
                    settled->motion_count > 2 ? "others, the next" : "another motion");
        append_forces(scenario, &settled->motions[1], &line);
        text_append(&line, ".");
        screen_sentence(&line, text);
    }
    append_first(scenario, text);
}

void settled_lines(const Scenario *scenario, Text *text)
{
    const size_t start = text->length;
    settled_louder(scenario, "of the motion here", text);
    settled_sentences(scenario, false, text);
    text_fold_behind(text, start, STYLE_WIDTH);
}
