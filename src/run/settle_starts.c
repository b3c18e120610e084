// Settles a mechanism from several starts, and says to which motions they come.
//
// Once the first has settled, the others are turned side by side. One has come to its motion where
// the sections and forces of one period agree, whichever revolution is its first; it then need not
// go on until it repeats to all digits by itself.
#include "run/settle.h"

#include "base/side_by_side.h"
#include "base/sorted.h"
#include "base/zeroed.h"
#include "model/nearest.h"
#include "model/perturb.h"
#include "run/pressed.h"
#include "run/settle_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Of sections and forces: a motion that still changes by less repeats. A peak then has the five
// digits that a drawing takes, and two more.
static const double SETTLE_TOLERANCE = 1e-7;

// of the largest forces of the revolutions: those below 5 % and above 95 % of them
static const double FEW = 0.05;

// The start of one scenario becomes that of another of the same linkage.
static void take_start(const Linkage *from, Linkage *to)
{
    memcpy(to->bodies, from->bodies, to->body_count * sizeof *to->bodies);
    memcpy(to->joints, from->joints, to->joint_count * sizeof *to->joints);
    memcpy(to->torsions, from->torsions, to->torsion_count * sizeof *to->torsions);
    memcpy(to->loads, from->loads, to->load_count * sizeof *to->loads);
    to->driver.start = from->driver.start;
}

// One of several starts on its way.
typedef struct Start {
    Settling settling;
    bool is_made;    // whether there is such a start
    bool is_settled; // false: `err` says why
    Err err;
    size_t motion; // the number of that which it came to
} Start;

static void start_run(size_t index, bool is_callers, void *context)
{
    Start *start = (Start *)context + index;
    if (start->is_made) {
        start->settling.is_callers = is_callers;
        const size_t most = start->settling.scenario.run.settle_most;
        start->is_settled = settling_run(&start->settling, SETTLE_TOLERANCE, most, &start->err);
    }
}

// The first by itself, and then the others, which may come to its motion.
static void starts_run(Start *starts, size_t count, RunWatch watch)
{
    TurnWatch all = turn_watch_begin(watch);
    for (size_t i = 0; i < count; i++) {
        starts[i].settling.watch = &all;
        all.most += starts[i].is_made ? starts[i].settling.scenario.run.settle_most : 0;
    }
    start_run(0, true, starts);
    const Start *first = &starts[0];
    for (size_t i = 1; i < count; i++) {
        starts[i].settling.is_quick = true;
        starts[i].settling.known =
            first->is_settled && first->settling.period > 0 ? &first->settling : NULL;
    }
    side_by_side_run(count - 1, side_by_side_processors(), start_run, starts + 1);
}

static void starts_finish(Start *starts, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (starts[i].is_made) {
            settling_finish(&starts[i].settling);
        }
    }
    free(starts);
}

// Of the drive's speed at the bodies' reach: by how much the third start and those after it differ
// from that as written.
static const double START_SIZES[] = {0.05, 0.2, 0.01};
enum { START_SIZE_COUNT = sizeof START_SIZES / sizeof *START_SIZES };

bool settle_change_start(Scenario *scenario, double size, unsigned member)
{
    const Linkage *linkage = &scenario->linkage;
    PerturbUnit *units = zeroed(linkage->body_count, sizeof *units);
    const double omega = fabs(linkage->driver.speed);
    for (size_t i = 0; i < linkage->body_count; i++) {
        units[i] = (PerturbUnit){omega * linkage_reach(linkage, (int)i), omega};
    }
    const bool is_changed = perturb_start(scenario, units, size, member);
    free(units);
    return is_changed;
}

static bool start_perturbed(Scenario *scenario, size_t number)
{
    return settle_change_start(scenario, START_SIZES[number % START_SIZE_COUNT],
                               (unsigned)number + 1);
}

// The starts that a motion is looked for from: as written, pressed, and with other velocities.
static Start *starts_create(const Scenario *scenario, size_t count)
{
    Start *starts = zeroed(count, sizeof *starts);
    for (size_t i = 0; i < count; i++) {
        starts[i].settling = settling_start(scenario);
        starts[i].is_made = true;
        Scenario *own = &starts[i].settling.scenario;
        Err err = {ERR_NONE, ""};
        const bool has_own =
            i == 0 || (i == 1 && pressed_start(own, &err)) || start_perturbed(own, i);
        if (!has_own) {
            settling_finish(&starts[i].settling);
            starts[i].is_made = false;
        }
    }
    return starts;
}

// Whether two starts have come to one motion. All that do not repeat count as one.
static bool is_same_motion(const Settling *a, const Settling *b)
{
    return a->period == b->period &&
           (a->period == 0 || settling_apart(a, b, a->period) <= SETTLE_SAME_MOTION);
}

// Numbers the motions in the order of the starts; returns how many there are.
static size_t starts_number(Start *starts, size_t count)
{
    size_t motions = 0;
    for (size_t i = 0; i < count; i++) {
        if (!starts[i].is_settled) {
            continue;
        }
        size_t k = 0;
        while (k < i && !(starts[k].is_settled &&
                          is_same_motion(&starts[k].settling, &starts[i].settling))) {
            k++;
        }
        starts[i].motion = k < i ? starts[k].motion : motions++;
    }
    return motions;
}

// What a joint does in a motion, over all starts that have come to it.
static SettledJoint sum_up(const Start *starts, size_t count, size_t motion, size_t joint)
{
    size_t room = 0;
    for (size_t i = 0; i < count; i++) {
        room += starts[i].is_settled ? starts[i].settling.count : 0;
    }
    double *forces = zeroed(room, sizeof *forces);
    SettledJoint found = {0};
    size_t many = 0;
    size_t period = 0;
    for (size_t i = 0; i < count; i++) {
        const Settling *settling = &starts[i].settling;
        if (!starts[i].is_settled || starts[i].motion != motion || (period > 0 && many > 0)) {
            continue;
        }
        period = settling->period;
        const size_t added = settling_forces(settling, joint, forces + many);
        for (size_t k = 0; k < added; k++) {
            found.impacts += (double)settling->revolutions[settling->count - 1 - k].impacts[joint];
        }
        many += added;
    }
    sorted_make(forces, many);
    const double most = (double)(many - 1);
    found.impacts /= (double)many;
    found.force = period > 0 ? forces[many - 1] : sorted_median(forces, many);
    found.low = period > 0 ? found.force : forces[(size_t)(FEW * most)];
    found.high = period > 0 ? found.force : forces[(size_t)ceil((1.0 - FEW) * most)];
    free(forces);
    return found;
}

// The angular velocities at the ends of the revolutions that count, of the first start that came to
// the motion.
static void add_sections(const Settling *settling, SettledMotion *motion)
{
    const Linkage *linkage = &settling->scenario.linkage;
    const size_t counted = settling_counted(settling);
    motion->section_count = counted < SETTLE_PERIOD_MAX ? counted : SETTLE_PERIOD_MAX;
    motion->sections =
        zeroed(motion->section_count * linkage->body_count, sizeof *motion->sections);
    for (size_t k = 0; k < motion->section_count; k++) {
        const size_t number = settling->count - motion->section_count + k;
        for (size_t i = 0; i < linkage->body_count; i++) {
            // the last of the rates is that about z, times the reach
            const double *rates = settling->revolutions[number].section + SETTLE_RATES * i;
            const double reach = linkage_reach(linkage, (int)i);
            motion->sections[k * linkage->body_count + i] =
                reach > 0.0 ? rates[SETTLE_RATES - 1] / reach : 0.0;
        }
    }
}

static SettledMotion describe_motion(const Start *starts, size_t count, size_t motion)
{
    SettledMotion found = {0};
    const Linkage *linkage = NULL;
    for (size_t i = 0; i < count; i++) {
        if (starts[i].is_settled && starts[i].motion == motion) {
            if (found.starts == 0) {
                found.period = starts[i].settling.period;
                found.change = starts[i].settling.change;
                add_sections(&starts[i].settling, &found);
            }
            found.starts++;
            linkage = &starts[i].settling.scenario.linkage;
        }
    }
    found.joints = zeroed(linkage->joint_count, sizeof *found.joints);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        found.joints[i] = sum_up(starts, count, motion, i);
    }
    return found;
}

SettledMotion settling_motion(const Settling *settling)
{
    const Start alone = {.settling = *settling, .is_settled = true};
    return describe_motion(&alone, 1, 0);
}

// The first start of those that came to the motion of most starts.
static size_t chosen_start(const Start *starts, size_t count, size_t motions)
{
    size_t chosen = 0;
    size_t most = 0;
    for (size_t motion = 0; motion < motions; motion++) {
        size_t came = 0;
        size_t first = count;
        for (size_t i = 0; i < count; i++) {
            if (starts[i].is_settled && starts[i].motion == motion) {
                first = first < count ? first : i;
                came++;
            }
        }
        if (came > most) {
            most = came;
            chosen = first;
        }
    }
    return chosen;
}

// Puts what the starts have come to into the scenario.
static void take_starts(Start *starts, size_t count, Scenario *scenario)
{
    SettledStart *settled = &scenario->settled;
    const size_t motions = starts_number(starts, count);
    if (motions == 0) {
        snprintf(settled->message, sizeof settled->message, "revolution %zu: %.1900s",
                 starts[0].settling.count, starts[0].err.text);
        if (!scenario->run.is_start_given) {
            scenario->run.start = START_CENTRED;
            scenario->run.centred_because = "it fails before its motion has settled";
        }
        return;
    }
    const size_t chosen = chosen_start(starts, count, motions);
    const Settling *settling = &starts[chosen].settling;
    take_start(&settling->scenario.linkage, &scenario->linkage);
    settled->revolutions = settling->count;
    settled->motion_count = motions;
    settled->motions = zeroed(motions, sizeof *settled->motions);
    settled->motions[0] = describe_motion(starts, count, starts[chosen].motion);
    for (size_t motion = 0, at = 1; motion < motions; motion++) {
        if (motion != starts[chosen].motion) {
            settled->motions[at++] = describe_motion(starts, count, motion);
        }
    }
    for (size_t i = 0; i < motions; i++) {
        settled->starts += settled->motions[i].starts;
    }
    settled->first = zeroed(scenario->linkage.joint_count, sizeof *settled->first);
    if (starts[0].settling.count > 0) {
        memcpy(settled->first, starts[0].settling.revolutions[0].force_max,
               scenario->linkage.joint_count * sizeof *settled->first);
    }
}

void settle_scenario(Scenario *scenario, RunWatch watch)
{
    SettledStart *settled = &scenario->settled;
    if (!scenario_lacks_start(scenario)) {
        return;
    }
    if (scenario->run.start == START_PRESSED) {
        Err err = {ERR_NONE, ""};
        settled->is_pressed = pressed_start(scenario, &err);
        snprintf(settled->message, sizeof settled->message, "%s", err.text);
        return;
    }
    const size_t count = scenario->run.settle_starts;
    Start *starts = starts_create(scenario, count);
    starts_run(starts, count, watch);
    take_starts(starts, count, scenario);
    starts_finish(starts, count);
}

// Whether a start can be handed from one linkage to the other: both have the same bodies and
// joints, and nothing counts whole turns.
static bool can_follow(const Scenario *scenario, const Scenario *neighbour)
{
    const Linkage *own = &scenario->linkage;
    const Linkage *other = &neighbour->linkage;
    bool can = neighbour->settled.motion_count > 0 && scenario->run.start == START_SETTLED &&
               !own->is_spatial && !other->is_spatial && own->torsion_count == 0 &&
               own->body_count == other->body_count && own->joint_count == other->joint_count;
    for (size_t i = 0; can && i < own->joint_count; i++) {
        can = own->joints[i].kind == other->joints[i].kind &&
              own->joints[i].limits.kind == LIMIT_NONE && own->joints[i].kind != JOINT_GEAR;
    }
    return can;
}

// A distance within some play as one within another: in the free part by its share of the play, in
// the wall by its depth.
static double in_other_play(double distance, double play, double other_play)
{
    return distance <= play ? distance * other_play / play : other_play + distance - play;
}

// Where a pin or block stands in its play, and what its contacts carry.
static void follow_joint(const Joint *from, Joint *to)
{
    if (!linkage_has_play(to)) {
        return;
    }
    const double play = linkage_radial_clearance(from);
    const double own_play = linkage_radial_clearance(to);
    memcpy(to->contacts, from->contacts, sizeof to->contacts);
    if (to->kind == JOINT_CLEARANCE) {
        const Vec2 at = from->clearance.start;
        const double distance = vec2_length(at);
        to->clearance.start =
            distance > 0.0 ? vec2_scale(in_other_play(distance, play, own_play) / distance, at)
                           : at;
    } else if (to->kind == JOINT_GUIDE) {
        const Vec2 at = from->guide.start;
        to->guide.start = (Vec2){copysign(in_other_play(fabs(at.x), play, own_play), at.x), at.y};
    }
}

// How much faster the drive turns than the neighbour's.
static double drive_ratio(const Scenario *scenario, const Scenario *neighbour)
{
    const Driver *own = &scenario->linkage.driver;
    const Driver *other = &neighbour->linkage.driver;
    return drive_is_steady(own) && drive_is_steady(other) ? own->speed / other->speed : 1.0;
}

// The neighbour's start with the scenario's own sizes: positions moved as little as these need, and
// speeds in proportion to the drive's. False where there is none.
static bool start_as_neighbour(const Scenario *neighbour, Scenario *scenario)
{
    Linkage *linkage = &scenario->linkage;
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(&neighbour->linkage, motions);
    const double ratio = drive_ratio(scenario, neighbour);
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i].velocity = vec2_scale(ratio, motions[i].velocity);
        motions[i].omega *= ratio;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        follow_joint(&neighbour->linkage.joints[i], &linkage->joints[i]);
    }
    const bool is_placed = nearest_positions(linkage, motions);
    if (is_placed) {
        nearest_speeds(linkage, false, motions);
        for (size_t i = 0; i < linkage->body_count; i++) {
            linkage->bodies[i].start = motions[i];
        }
    }
    free(motions);
    return is_placed;
}

bool settle_follow(Scenario *scenario, const Scenario *neighbour, RunWatch watch)
{
    Start *start = zeroed(1, sizeof *start);
    bool is_followed = scenario_lacks_start(scenario) && can_follow(scenario, neighbour);
    if (is_followed) {
        *start = (Start){.settling = settling_start(scenario), .is_made = true};
        is_followed = start_as_neighbour(neighbour, &start->settling.scenario);
    }
    if (is_followed) {
        starts_run(start, 1, watch);
        is_followed = start->is_settled;
    }
    if (is_followed) {
        take_starts(start, 1, scenario);
        scenario->settled.is_followed = true;
    }
    starts_finish(start, 1);
    if (!is_followed) {
        settle_scenario(scenario, watch);
    }
    return is_followed;
}
