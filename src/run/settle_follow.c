// Settles a mechanism from the settled start of a neighbour: the scenario of another value of a
// key.
#include "base/zeroed.h"
#include "model/nearest.h"
#include "model/space.h"
#include "run/settle_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Revolutions from a neighbour's motion that does not repeat: its state is forgotten within one
enum { BRIEF_TURNS = 2 };

// 1: largest forces of one motion that was found twice, each repeating to no more than that
static const double SAME_FORCES = 1e-3;

// Whether a start can be handed from one linkage to the other: both have the same bodies and
// joints, and nothing counts whole turns.
static bool can_follow(const Scenario *scenario, const Scenario *neighbour)
{
    const Linkage *own = &scenario->linkage;
    const Linkage *other = &neighbour->linkage;
    bool can = neighbour->settled.motion_count > 0 && scenario->run.start == START_SETTLED &&
               !own->is_spatial && !other->is_spatial && own->torsion_count == 0 &&
               own->bushing_count == 0 && own->body_count == other->body_count &&
               own->joint_count == other->joint_count;
    for (size_t i = 0; can && i < own->joint_count; i++) {
        can = own->joints[i].kind == other->joints[i].kind &&
              own->joints[i].limits.kind == LIMIT_NONE && !joint_has_teeth(own->joints[i].kind);
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
    switch (joint_touches(to->kind)) {
    case JOINT_TOUCHES_HOLE: {
        const Vec2 at = from->clearance.start;
        const double distance = vec2_length(at);
        to->clearance.start =
            distance > 0.0 ? vec2_scale(in_other_play(distance, play, own_play) / distance, at)
                           : at;
        break;
    }
    case JOINT_TOUCHES_GUIDES: {
        const Vec2 at = from->guide.start;
        to->guide.start = (Vec2){copysign(in_other_play(fabs(at.x), play, own_play), at.x), at.y};
        break;
    }
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_DISC:
    case JOINT_TOUCHES_TEETH:
        break;
    }
}

// How much faster the drive turns than the neighbour's.
static double drive_ratio(const Linkage *own, const Linkage *other)
{
    return drive_is_steady(&own->driver) && drive_is_steady(&other->driver)
               ? own->driver.speed / other->driver.speed
               : 1.0;
}

// The neighbour's start with the linkage's own sizes: positions moved as little as these need, and
// speeds in proportion to the drive's. False where there is none.
static bool start_as_neighbour(const Linkage *neighbour, Linkage *linkage)
{
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(neighbour, motions);
    const double ratio = drive_ratio(linkage, neighbour);
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i].velocity = vec2_scale(ratio, motions[i].velocity);
        motions[i].omega *= ratio;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        follow_joint(&neighbour->joints[i], &linkage->joints[i]);
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

// The same in space, where every place is as the neighbour's.
static void start_as_neighbour_in_space(const Linkage *neighbour, Linkage *linkage)
{
    SpaceMotion *motions = zeroed(linkage->body_count, sizeof *motions);
    space_start(neighbour, motions);
    const double ratio = drive_ratio(linkage, neighbour);
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i].velocity = vec3_scale(ratio, motions[i].velocity);
        motions[i].omega = vec3_scale(ratio, motions[i].omega);
        space_set_place(&motions[i], &linkage->bodies[i]);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        follow_joint(&neighbour->joints[i], &linkage->joints[i]);
    }
    free(motions);
}

// By how much a number that counts turns has moved since the start as written; 0 of an end that a
// joint does not have.
static double moved(double now, double written)
{
    return isfinite(now) ? now - written : 0.0;
}

// What joints, springs, loads and drives have counted since the start as written.
static void follow_counts(const Linkage *written, const Linkage *settled, Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *from = &written->joints[i];
        const Joint *now = &settled->joints[i];
        Joint *joint = &linkage->joints[i];
        joint->held_angle += now->held_angle - from->held_angle;
        joint->gear.zero += now->gear.zero - from->gear.zero;
        joint->limits.middle += moved(now->limits.middle, from->limits.middle);
        joint->limits.low += moved(now->limits.low, from->limits.low);
        joint->limits.high += moved(now->limits.high, from->limits.high);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        linkage->torsions[i].angle += settled->torsions[i].angle - written->torsions[i].angle;
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        linkage->bushings[i].angle += settled->bushings[i].angle - written->bushings[i].angle;
    }
    for (size_t i = 0; i < linkage->load_count; i++) {
        linkage->loads[i].shift = settled->loads[i].shift;
    }
    linkage->driver.start += settled->driver.start - written->driver.start;
    for (size_t i = 0; i < linkage->further_count; i++) {
        linkage->further[i].start += settled->further[i].start - written->further[i].start;
    }
    linkage->torque.followed.start +=
        settled->torque.followed.start - written->torque.followed.start;
}

static bool has_same_parts(const Linkage *a, const Linkage *b)
{
    bool has = a->is_spatial == b->is_spatial && a->body_count == b->body_count &&
               a->joint_count == b->joint_count && a->torsion_count == b->torsion_count &&
               a->bushing_count == b->bushing_count && a->load_count == b->load_count &&
               a->further_count == b->further_count;
    for (size_t i = 0; has && i < a->joint_count; i++) {
        has = a->joints[i].kind == b->joints[i].kind;
    }
    return has;
}

bool settle_lend(const Linkage *written, const Linkage *settled, Scenario *scenario)
{
    if (!has_same_parts(written, settled) || !has_same_parts(settled, &scenario->linkage)) {
        return false;
    }
    Linkage lent = linkage_copy(&scenario->linkage);
    follow_counts(written, settled, &lent);
    bool is_placed = true;
    if (lent.is_spatial) {
        start_as_neighbour_in_space(settled, &lent);
    } else {
        is_placed = start_as_neighbour(settled, &lent);
    }
    Linkage unused = is_placed ? scenario->linkage : lent;
    scenario->linkage = is_placed ? lent : scenario->linkage;
    linkage_free(&unused);
    return is_placed;
}

// Turns a scenario from the neighbour's start; brief, for so few revolutions that one that does not
// repeat has begun to do what it does, and no more.
static bool search_from(Scenario *scenario, const Scenario *neighbour, bool is_brief,
                        RunWatch watch)
{
    Scenario first = scenario_copy(scenario);
    const RunOptions asked = scenario->run;
    if (is_brief) {
        scenario->run.settle_least = scenario->run.settle_most = BRIEF_TURNS;
    }
    const bool is_found = start_as_neighbour(&neighbour->linkage, &first.linkage) &&
                          settle_search(scenario, &first, 1, watch);
    scenario->run.settle_least = asked.settle_least;
    scenario->run.settle_most = asked.settle_most;
    scenario_free(&first);
    return is_found;
}

bool settle_follow(Scenario *scenario, const Scenario *neighbour, RunWatch watch)
{
    const bool is_followed = scenario_lacks_start(scenario) && settle_dissipates(scenario) &&
                             can_follow(scenario, neighbour) &&
                             search_from(scenario, neighbour, false, watch);
    if (is_followed) {
        scenario->settled.is_followed = true;
    } else {
        settle_scenario(scenario, watch);
    }
    return is_followed;
}

bool settle_beside_neighbour(Scenario *scenario, const Scenario *neighbour, RunWatch watch)
{
    if (!scenario_lacks_start(scenario) || !settle_dissipates(scenario) ||
        !can_follow(scenario, neighbour)) {
        return false;
    }
    const bool is_brief = neighbour->settled.motions[0].period == 0;
    if (is_brief && isfinite(neighbour->settled.width)) {
        return false;
    }
    const bool is_followed = search_from(scenario, neighbour, is_brief, watch);
    scenario->settled.is_followed = is_followed;
    scenario->settled.is_brief =
        is_followed && is_brief && scenario->settled.motions[0].period == 0;
    return is_followed;
}

bool settle_is_clear(const Scenario *scenario)
{
    const SettledStart *settled = &scenario->settled;
    return settled->motion_count == 1 ||
           (settled->motion_count > 1 && settled->motions[0].period == 0);
}

bool settle_is_same(const Scenario *a, const Scenario *b, double *apart)
{
    const Linkage *linkage = &a->linkage;
    const SettledMotion *motion = &a->settled.motions[0];
    const SettledMotion *other = &b->settled.motions[0];
    *apart = NAN;
    if (!settle_is_clear(a) || !settle_is_clear(b) || motion->period != other->period) {
        return false;
    }
    if (motion->period == 0) {
        return !settle_motions_differ(motion, other, linkage);
    }
    *apart = 0.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const double force = motion->joints[i].force.headline;
        const double by = fabs(force - other->joints[i].force.headline);
        *apart =
            by > 0.0 ? fmax(*apart, by / fmax(force, other->joints[i].force.headline)) : *apart;
    }
    return *apart <= SAME_FORCES;
}

void settle_take(Scenario *scenario, const Scenario *settled)
{
    settle_take_start(&settled->linkage, &scenario->linkage);
    settled_start_free(&scenario->settled);
    scenario->settled = settled_start_copy(&settled->settled, &settled->linkage);
    scenario->run.start = settled->run.start;
    memcpy(scenario->run.centred_because, settled->run.centred_because,
           sizeof scenario->run.centred_because);
}
