// Makes a start that lies beside another, at a distance.
//
// Each body draws a change of its velocity and its omega, each of the size of the body's own
// largest; the nearest change w that ideal joints and driver allow (in the norm w' M w of kinetic
// energy) is taken, and multiplied so that
//     max over bodies max(|w_omega| reach, |w_v|) / V  =  size,  V = max over t (|v| + |omega|
//     reach)
// Draws are along directions that the geometry gives, not along the axes of a frame: turned with
// its mechanism a scenario draws the same changes, turned.
#include "model/perturb.h"

#include "base/lcg.h"
#include "base/zeroed.h"
#include "model/space_nearest.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// of what was drawn: what rounding leaves where joints and driver allow nothing
static const double ALLOWED = 1e-8;

// of the body's reach: two points that make a direction
static const double APART = 1e-6;

// of the fastest body's speed: below it lies no motion to speak of
static const double SLOWEST = 1e-3;

// A perturbation is stretched so far that its end, DISTANCE_GROWTH times the size, is still small.
static const double STRETCH_MOST = 1e3;

void perturb_units(const Trajectory *reference, PerturbUnit *units)
{
    double fastest = 0.0;
    for (size_t i = 0; i < reference->body_count; i++) {
        units[i].moving = 0.0;
        for (size_t k = 0; k < reference->sample_count; k++) {
            const Motion *motion = trajectory_motion(reference, k, i);
            double moving = vec2_length(motion->velocity);
            double turning = fabs(motion->omega);
            if (reference->space_motions != NULL) {
                const SpaceMotion *spatial = trajectory_space_motion(reference, k, i);
                moving = vec3_length(spatial->velocity);
                turning = vec3_length(spatial->omega);
            }
            units[i].moving = fmax(units[i].moving, moving + turning * reference->reach[i]);
        }
        fastest = fmax(fastest, units[i].moving);
    }
    for (size_t i = 0; i < reference->body_count; i++) {
        units[i].moving = fmax(units[i].moving, fmax(SLOWEST * fastest, reference->floor.speed));
        units[i].turning = units[i].moving / reference->reach[i];
    }
}

// What is left of changes that joints and driver allow.
static void allow_change(const Linkage *linkage, const Motion *motions, SpeedChange *changes)
{
    if (linkage->is_spatial) {
        space_nearest_change(linkage, changes);
    } else {
        nearest_change(linkage, motions, changes);
    }
}

static double change_size(const Linkage *linkage, const PerturbUnit *units,
                          const SpeedChange *changes)
{
    double size = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (!linkage_is_driven(linkage, (int)i)) {
            const PerturbUnit unit = units[i];
            size = fmax(size, vec2_length(changes[i].velocity) / unit.moving);
            size = fmax(size, fabs(changes[i].omega) / unit.turning);
            if (linkage->is_spatial) {
                size = fmax(size, fabs(changes[i].velocity_z) / unit.moving);
                size = fmax(size, hypot(changes[i].omega_x, changes[i].omega_y) / unit.turning);
            }
        }
    }
    return size;
}

// A direction that turns with the mechanism: from a body's centre to the first joint that is not
// there, or of its velocity, or of gravity. Without any, all directions are the same.
static Vec2 own_direction(const Scenario *scenario, const Motion *motions, size_t body)
{
    const Linkage *linkage = &scenario->linkage;
    const Vec2 centre = motions[body].position;
    const double reach = linkage_reach(linkage, (int)body);
    for (size_t i = 0; i < 2 * linkage->joint_count; i++) {
        const JointEnd end = linkage_end(&linkage->joints[i / 2], (int)(i % 2));
        const Vec2 arm = vec2_sub(linkage_point(motions, end.body, end.anchor), centre);
        const double length = vec2_length(arm);
        if (length > APART * reach) {
            return vec2_scale(1.0 / length, arm);
        }
    }
    const double speed = vec2_length(motions[body].velocity);
    if (speed > 0.0) {
        return vec2_scale(1.0 / speed, motions[body].velocity);
    }
    const Vec2 gravity = scenario_gravity(scenario);
    const double pull = vec2_length(gravity);
    return pull > 0.0 ? vec2_scale(1.0 / pull, gravity) : (Vec2){0.0, -1.0};
}

static void draw_changes(const Scenario *scenario, const PerturbUnit *units, const Motion *motions,
                         unsigned member, SpeedChange *changes)
{
    const Linkage *linkage = &scenario->linkage;
    uint64_t seed = lcg_stirred(member);
    for (size_t i = 0; i < linkage->body_count; i++) {
        changes[i] = (SpeedChange){.omega = 0.0};
        if (!linkage_is_driven(linkage, (int)i)) {
            const PerturbUnit unit = units[i];
            const Vec2 along = vec2_scale(unit.moving, own_direction(scenario, motions, i));
            const double ahead = lcg_draw(&seed);
            const double aside = lcg_draw(&seed);
            changes[i].velocity =
                vec2_add(vec2_scale(ahead, along), vec2_scale(aside, vec2_perp(along)));
            changes[i].omega = unit.turning * lcg_draw(&seed);
            if (linkage->is_spatial) {
                changes[i].velocity_z = unit.moving * lcg_draw(&seed);
                changes[i].omega_x = unit.turning * lcg_draw(&seed);
                changes[i].omega_y = unit.turning * lcg_draw(&seed);
            }
        }
    }
}

bool perturb_start(Scenario *scenario, const PerturbUnit *units, double size, unsigned member)
{
    Linkage *linkage = &scenario->linkage;
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    SpeedChange *changes = zeroed(linkage->body_count, sizeof *changes);
    linkage_start(linkage, motions);
    draw_changes(scenario, units, motions, member, changes);
    const double drawn = change_size(linkage, units, changes);
    allow_change(linkage, motions, changes);
    const double allowed = change_size(linkage, units, changes);
    const bool is_free = allowed > ALLOWED * drawn;
    if (is_free) {
        perturb_along(scenario, changes, size / allowed);
    }
    free(changes);
    free(motions);
    return is_free;
}

void perturb_along(Scenario *scenario, const SpeedChange *changes, double factor)
{
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        Motion *start = &scenario->linkage.bodies[i].start;
        start->velocity = vec2_add(start->velocity, vec2_scale(factor, changes[i].velocity));
        start->omega += factor * changes[i].omega;
        BodySpace *space = &scenario->linkage.bodies[i].space;
        space->velocity_z += factor * changes[i].velocity_z;
        space->omega_x += factor * changes[i].omega_x;
        space->omega_y += factor * changes[i].omega_y;
    }
}

static void add_multiple(const Linkage *linkage, double factor, const SpeedChange *from,
                         SpeedChange *to)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        to[i].velocity = vec2_add(to[i].velocity, vec2_scale(factor, from[i].velocity));
        to[i].omega += factor * from[i].omega;
        to[i].velocity_z += factor * from[i].velocity_z;
        to[i].omega_x += factor * from[i].omega_x;
        to[i].omega_y += factor * from[i].omega_y;
    }
}

// One rate of a body, the three of the plane first.
static double *rate_of(SpeedChange *change, int rate)
{
    double *const rates[] = {&change->velocity.x, &change->velocity.y, &change->omega,
                             &change->velocity_z, &change->omega_x,    &change->omega_y};
    return rates[rate];
}

// What joints and driver allow of each single rate of each body. Returns the freedoms: the trace of
// that projection.
static size_t allow_each(const Linkage *linkage, const PerturbUnit *units, PerturbBasis *each)
{
    Motion motions[PERTURB_BODY_MAX];
    linkage_start(linkage, motions);
    const int rates = linkage->is_spatial ? 6 : 3;
    double trace = 0.0;
    each->count = 0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const PerturbUnit unit = units[i];
        for (int rate = 0; rate < rates && !linkage_is_driven(linkage, (int)i); rate++) {
            SpeedChange *changes = each->changes[each->count++];
            for (size_t k = 0; k < linkage->body_count; k++) {
                changes[k] = (SpeedChange){.omega = 0.0};
            }
            double *own = rate_of(&changes[i], rate);
            const bool is_turning = rate == 2 || rate > 3;
            const double asked = is_turning ? unit.turning : unit.moving;
            *own = asked;
            allow_change(linkage, motions, changes);
            trace += *own / asked;
        }
    }
    return (size_t)lround(fmax(trace, 0.0));
}

// The groups of bodies that no joint connects but through the ground or the driven body, each
// by a number.
static void find_groups(const Linkage *linkage, size_t *groups)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        groups[i] = i;
    }
    for (size_t pass = 0; pass < linkage->body_count; pass++) {
        for (size_t i = 0; i < linkage->joint_count; i++) {
            const int a = linkage->joints[i].body_a;
            const int b = linkage->joints[i].body_b;
            if (a != LINKAGE_GROUND && b != LINKAGE_GROUND && !linkage_is_driven(linkage, a) &&
                !linkage_is_driven(linkage, b)) {
                const size_t lower = groups[a] < groups[b] ? groups[a] : groups[b];
                groups[a] = groups[b] = lower;
            }
        }
    }
}

// The group that changes are in; false where they are in several.
static bool group_of(const Linkage *linkage, const size_t *groups, const SpeedChange *changes,
                     size_t *group)
{
    bool is_found = false;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const SpeedChange *change = &changes[i];
        const bool is_moved = vec2_length(change->velocity) > 0.0 || change->omega != 0.0 ||
                              change->velocity_z != 0.0 || change->omega_x != 0.0 ||
                              change->omega_y != 0.0;
        if (is_moved && is_found && groups[i] != *group) {
            return false;
        }
        *group = is_moved ? groups[i] : *group;
        is_found = is_found || is_moved;
    }
    return is_found;
}

// Adds directions in groups that do not touch one another up: the first of each group to one, the
// second of each to another.
static void merge_groups(const Linkage *linkage, PerturbBasis *basis, PerturbBasis *merged)
{
    size_t groups[PERTURB_BODY_MAX];
    size_t counts[PERTURB_BODY_MAX] = {0};
    size_t group = 0;
    find_groups(linkage, groups);
    merged->count = 0;
    for (size_t i = 0; i < basis->count; i++) {
        if (!group_of(linkage, groups, basis->changes[i], &group)) {
            return;
        }
        SpeedChange *sum = merged->changes[counts[group]++];
        if (counts[group] > merged->count) {
            memset(sum, 0, sizeof merged->changes[0]);
            merged->count = counts[group];
        }
        add_multiple(linkage, 1.0, basis->changes[i], sum);
    }
    *basis = *merged;
}

// The rates of changes, each over its scale, one after the other: three numbers a rate.
static void rates_of(const Scenario *scenario, const DistanceMeasure *measure,
                     const SpeedChange *changes, double *rates)
{
    const Linkage *linkage = &scenario->linkage;
    Motion planar[PERTURB_BODY_MAX];
    SpaceMotion spatial[PERTURB_BODY_MAX];
    linkage_start(linkage, planar);
    if (linkage->is_spatial) {
        space_start(linkage, spatial);
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        const SpeedChange *change = &changes[i];
        planar[i].velocity = change->velocity;
        planar[i].omega = change->omega;
        spatial[i].velocity = (Vec3){change->velocity.x, change->velocity.y, change->velocity_z};
        spatial[i].omega = (Vec3){change->omega_x, change->omega_y, change->omega};
    }
    const DistanceMotion motion = {planar, linkage->is_spatial ? spatial : NULL};
    for (size_t i = 0; i < measure->count; i++) {
        const DistanceRate *rate = &measure->rates[i];
        const Vec3 value = distance_value(linkage, rate, motion);
        rates[3 * i] = value.x / rate->scale;
        rates[3 * i + 1] = value.y / rate->scale;
        rates[3 * i + 2] = value.z / rate->scale;
    }
}

static double product(size_t count, const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Makes orthonormal changes of those that are left, the longest first, until there are so many.
static void find_basis(const Scenario *scenario, const DistanceMeasure *measure, size_t freedoms,
                       PerturbBasis *left, PerturbBasis *basis)
{
    const Linkage *linkage = &scenario->linkage;
    const size_t width = 3 * measure->count;
    double *rates = zeroed(left->count * width + width, sizeof *rates);
    double *own = rates + left->count * width;
    for (size_t i = 0; i < left->count; i++) {
        rates_of(scenario, measure, left->changes[i], rates + i * width);
    }
    for (basis->count = 0; basis->count < freedoms; basis->count++) {
        size_t longest = 0;
        double square = 0.0;
        for (size_t i = 0; i < left->count; i++) {
            const double *of = rates + i * width;
            const double found = product(width, of, of);
            if (found > square) {
                square = found;
                longest = i;
            }
        }
        if (!(square > 0.0)) {
            break;
        }
        SpeedChange *next = basis->changes[basis->count];
        memset(next, 0, sizeof basis->changes[0]);
        add_multiple(linkage, 1.0 / sqrt(square), left->changes[longest], next);
        rates_of(scenario, measure, next, own);
        for (size_t i = 0; i < left->count; i++) {
            double *of = rates + i * width;
            const double share = product(width, own, of);
            add_multiple(linkage, -share, next, left->changes[i]);
            for (size_t k = 0; k < width; k++) {
                of[k] -= share * own[k];
            }
        }
    }
    free(rates);
}

void perturb_basis(const Scenario *scenario, const DistanceMeasure *measure,
                   const PerturbUnit *units, PerturbBasis *basis)
{
    const Linkage *linkage = &scenario->linkage;
    assert(linkage->body_count <= PERTURB_BODY_MAX);
    PerturbBasis *left = malloc(sizeof *left);
    assert(left != NULL);
    const size_t freedoms = allow_each(linkage, units, left);
    find_basis(scenario, measure, freedoms, left, basis);
    merge_groups(linkage, basis, left);
    free(left);
    for (size_t i = 0; i < basis->count; i++) {
        const double size = change_size(linkage, units, basis->changes[i]);
        basis->stretch[i] = fmax(1.0, fmin(STRETCH_MOST, 1.0 / size));
    }
}
