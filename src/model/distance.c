// Measures how far two motions of one linkage are apart, in numbers that mean the same for all
// rates.
//
//     d = max over rates |r - r_ref| / max(max over t |r_ref|, f)
//     f = F of a velocity, F / reach of an angular rate
//     F = max(1e-6 V, floor)    with the floor of a mechanism at rest: model/scale.h
//     V = max over bodies and t (|v| + |omega| reach), the speed of the fastest point
//
// The relative velocity in a joint is that of the pin's middle P against the point of the hole's
// body that is there: v_b + omega_b x (P - x_b) - v_a - omega_a x (P - x_a). A tilt rate is omega_b
// - omega_a, in space without its part along the hole's axis.
#include "model/distance.h"

#include "base/zeroed.h"
#include "model/coordinate.h"
#include "model/space_coordinate.h"

#include <stdio.h>

enum { LEAST_SAMPLES = 2000 }; // fewer steps of a horizon would say little

static double size_of(Vec3 v)
{
    return v.y == 0.0 && v.z == 0.0 ? fabs(v.x) : vec3_length(v);
}

static bool is_tilting(const Linkage *linkage, const Joint *joint)
{
    return joint_has_guides(joint->kind) || (linkage->is_spatial && joint_has_hole(joint->kind));
}

// The reach of the body that a joint turns.
static double turned_reach(const Linkage *linkage, size_t joint, const double *reaches)
{
    int turned;
    int against;
    linkage_turning(linkage, (int)joint, &turned, &against);
    return reaches[turned];
}

static void add_rate(DistanceMeasure *measure, DistanceKind kind, size_t number, double reach)
{
    measure->rates[measure->count++] =
        (DistanceRate){.kind = kind, .number = (int)number, .reach = reach};
}

DistanceMeasure distance_rates(const Linkage *linkage)
{
    DistanceMeasure measure = {.linkage = linkage};
    const size_t most = 2 * (linkage->body_count + linkage->joint_count);
    measure.rates = zeroed(most, sizeof *measure.rates);
    double *reaches = zeroed(linkage->body_count, sizeof *reaches);
    linkage_reaches(linkage, reaches);
    for (size_t i = 0; i < linkage->body_count; i++) {
        add_rate(&measure, DISTANCE_TURNING, i, reaches[i]);
        add_rate(&measure, DISTANCE_MOVING, i, 0.0);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const double reach = turned_reach(linkage, i, reaches);
        if (linkage_has_play(joint)) {
            add_rate(&measure, DISTANCE_PLAY, i, linkage_is_torsional(joint) ? reach : 0.0);
        }
        if (is_tilting(linkage, joint)) {
            add_rate(&measure, DISTANCE_TILT, i, reach);
        }
    }
    free(reaches);
    return measure;
}

// The angular velocity of body b of a joint less that of body a.
static Vec3 relative_turning(const Joint *joint, DistanceMotion motion)
{
    Vec3 turning = {0.0, 0.0, 0.0};
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(joint, side).body;
        const double sign = side == 0 ? -1.0 : 1.0;
        if (body != LINKAGE_GROUND && motion.spatial != NULL) {
            turning = vec3_add(turning, vec3_scale(sign, motion.spatial[body].omega));
        } else if (body != LINKAGE_GROUND) {
            turning.x += sign * motion.planar[body].omega;
        }
    }
    return turning;
}

static Vec2 moving_at(const Motion *motions, int body, Vec2 point)
{
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Motion *motion = &motions[body];
    const Vec2 arm = vec2_sub(point, motion->position);
    return vec2_add(motion->velocity, vec2_scale(motion->omega, vec2_perp(arm)));
}

static Vec3 play_value(const Linkage *linkage, int number, DistanceMotion motion)
{
    const Joint *joint = &linkage->joints[number];
    if (motion.spatial != NULL) {
        if (linkage_is_torsional(joint)) {
            return (Vec3){space_coordinate_rate(linkage, motion.spatial, number), 0.0, 0.0};
        }
        const SpaceEnd pin = space_end(linkage, (size_t)number, 1);
        const Vec3 point = space_point(motion.spatial, pin.body, pin.anchor);
        return vec3_sub(space_velocity_at(motion.spatial, joint->body_b, point),
                        space_velocity_at(motion.spatial, joint->body_a, point));
    }
    if (joint->limits.kind != LIMIT_NONE) {
        return (Vec3){coordinate_rate(linkage, motion.planar, number), 0.0, 0.0};
    }
    const Vec2 point = linkage_point(motion.planar, joint->body_b, joint->anchor_b);
    const Vec2 velocity = vec2_sub(moving_at(motion.planar, joint->body_b, point),
                                   moving_at(motion.planar, joint->body_a, point));
    return (Vec3){velocity.x, velocity.y, 0.0};
}

static Vec3 tilt_value(const Linkage *linkage, int number, DistanceMotion motion)
{
    const Vec3 turning = relative_turning(&linkage->joints[number], motion);
    if (motion.spatial == NULL) {
        return turning;
    }
    const SpaceEnd hole = space_end(linkage, (size_t)number, 0);
    return vec3_across(turning, space_direction(motion.spatial, hole.body, hole.axis));
}

Vec3 distance_value(const Linkage *linkage, const DistanceRate *rate, DistanceMotion motion)
{
    switch (rate->kind) {
    case DISTANCE_TURNING:
        return motion.spatial != NULL ? motion.spatial[rate->number].omega
                                      : (Vec3){motion.planar[rate->number].omega, 0.0, 0.0};
    case DISTANCE_MOVING: {
        const Vec2 planar = motion.planar[rate->number].velocity;
        return motion.spatial != NULL ? motion.spatial[rate->number].velocity
                                      : (Vec3){planar.x, planar.y, 0.0};
    }
    case DISTANCE_PLAY:
        return play_value(linkage, rate->number, motion);
    default:
        return tilt_value(linkage, rate->number, motion);
    }
}

int distance_components(const Linkage *linkage, const DistanceRate *rate)
{
    const bool is_scalar =
        rate->kind == DISTANCE_PLAY && linkage->joints[rate->number].limits.kind != LIMIT_NONE;
    const bool is_angular = rate->kind == DISTANCE_TURNING || rate->kind == DISTANCE_TILT;
    return is_scalar ? 1 : linkage->is_spatial ? 3 : is_angular ? 1 : 2;
}

// The speed of the fastest point of all bodies, m/s.
static double fastest_point(const DistanceMeasure *measure, const Trajectory *reference)
{
    double fastest = 0.0;
    for (size_t k = 0; k < reference->sample_count; k++) {
        const DistanceMotion motion = distance_motion_at(reference, k);
        for (size_t i = 0; i + 1 < 2 * reference->body_count; i += 2) {
            const DistanceRate *rates = &measure->rates[i];
            const double turning = size_of(distance_value(measure->linkage, &rates[0], motion));
            const double moving = size_of(distance_value(measure->linkage, &rates[1], motion));
            fastest = fmax(fastest, moving + turning * rates[0].reach);
        }
    }
    return fastest;
}

DistanceMeasure distance_measure(const Trajectory *reference)
{
    DistanceMeasure measure = distance_rates(&reference->linkage);
    const double floor =
        fmax(DISTANCE_FLOOR * fastest_point(&measure, reference), reference->floor.speed);
    for (size_t i = 0; i < measure.count; i++) {
        DistanceRate *rate = &measure.rates[i];
        for (size_t k = 0; k < reference->sample_count; k++) {
            const DistanceMotion motion = distance_motion_at(reference, k);
            const double size = size_of(distance_value(measure.linkage, rate, motion));
            rate->largest = size > rate->largest ? size : rate->largest;
        }
        rate->scale = fmax(rate->largest, rate->reach > 0.0 ? floor / rate->reach : floor);
    }
    return measure;
}

void distance_finish(DistanceMeasure *measure)
{
    free(measure->rates);
    *measure = (DistanceMeasure){.rates = NULL};
}

double distance_between(const DistanceRate *rate, Vec3 a, Vec3 b)
{
    return size_of(vec3_sub(a, b)) / rate->scale;
}

double distance_apart(const DistanceMeasure *measure, DistanceMotion a, DistanceMotion b,
                      size_t *which)
{
    double largest = 0.0;
    for (size_t i = 0; i < measure->count; i++) {
        const DistanceRate *rate = &measure->rates[i];
        const double apart = distance_between(rate, distance_value(measure->linkage, rate, a),
                                              distance_value(measure->linkage, rate, b));
        // a number that is not finite is no small one
        if (!(apart <= largest)) {
            largest = apart;
            if (which != NULL) {
                *which = i;
            }
            if (isnan(apart)) {
                return apart;
            }
        }
    }
    return largest;
}

void distance_name(const Linkage *linkage, const DistanceRate *rate, char name[DISTANCE_NAME_SIZE])
{
    const bool is_of_body = rate->kind == DISTANCE_TURNING || rate->kind == DISTANCE_MOVING;
    const char *of =
        is_of_body ? linkage->bodies[rate->number].name : linkage->joints[rate->number].name;
    const Joint *joint = is_of_body ? NULL : &linkage->joints[rate->number];
    const char *what = rate->kind == DISTANCE_TURNING     ? "omega of"
                       : rate->kind == DISTANCE_MOVING    ? "velocity of"
                       : rate->kind == DISTANCE_TILT      ? "tilt rate in"
                       : joint->limits.kind != LIMIT_NONE ? "coordinate rate of"
                       : joint_has_hole(joint->kind)      ? "pin velocity in"
                                                          : "relative velocity in";
    snprintf(name, DISTANCE_NAME_SIZE, "%s %s", what, of);
}

Scenario distance_grid(const Scenario *scenario)
{
    Scenario fine = *scenario;
    const size_t count = scenario_sample_count(scenario) - 1;
    if (count < LEAST_SAMPLES) {
        fine.run.samples *= (LEAST_SAMPLES + count - 1) / count;
    }
    return fine;
}
