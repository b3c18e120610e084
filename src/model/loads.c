// Finds what loads do to the bodies.
//
// A force F n acts at the point p of a body, with n fixed in the world or in the body; a torque on
// the body alone. Along the coordinate of a joint it acts on body b at its anchor, along the line
// of body a, and the other way on body a at that point; at a pivot it is a torque on the turned
// body, and the other way on the other (linkage_turning).
//     power F n . v(p),  M omega,  F times the rate of the coordinate
#include "model/loads.h"

#include <float.h>
#include <math.h>

bool load_is_force(const Linkage *linkage, const Load *load)
{
    return load->kind == LOAD_FORCE ||
           (load->kind == LOAD_ALONG && forces_is_along_line(linkage, load->joint));
}

bool load_is_timed(const Linkage *linkage, const Load *load)
{
    return load->table.count <= 1 || load->over == LOAD_OVER_TIME ||
           (load->over == LOAD_OVER_CRANK && drive_is_steady(&linkage->driver));
}

// The argument of a load that is timed is linear in time: at time zero, and how fast it grows.
typedef struct Clock {
    double start;
    double rate;
} Clock;

static Clock clock_of(const Linkage *linkage, const Load *load)
{
    const Driver *driver = &linkage->driver;
    return load->over == LOAD_OVER_TIME ? (Clock){load->shift, 1.0}
                                        : (Clock){driver->start + load->shift, driver->speed};
}

// 1: a point that is nearer than this has been reached
static const double REACHED = 16.0 * DBL_EPSILON;

// The argument from a time on, beyond a point that rounding alone keeps from being reached.
static double argument_from(const Clock *clock, double from_s)
{
    const double at = clock->start + clock->rate * from_s;
    return at + copysign(REACHED * (fabs(at) + fabs(clock->start)), clock->rate);
}

// The argument of one that is not.
static double argument_of(const Linkage *linkage, const Load *load, const Motion *motions,
                          double time_s)
{
    if (load->over == LOAD_OVER_CRANK) {
        return load->shift + (linkage->driver.is_present
                                  ? drive_angle(&linkage->driver, time_s)
                                  : forces_turn(linkage, linkage->torque.joint, motions).angle);
    }
    return forces_coordinate(linkage, load->joint, motions).angle;
}

double load_value(const Linkage *linkage, const Load *load, const Motion *motions, double time_s,
                  double from_s)
{
    if (!load_is_timed(linkage, load)) {
        const double at = argument_of(linkage, load, motions, time_s);
        const LoadPiece piece = load_table_piece(&load->table, at, 1.0);
        return load_piece_at(&piece, at);
    }
    const Clock clock = clock_of(linkage, load);
    return load_table_value(&load->table, argument_from(&clock, from_s), clock.rate,
                            clock.start + clock.rate * time_s);
}

// How fast the argument of such a load grows.
static double argument_rate(const Linkage *linkage, const Load *load, const Motion *motions,
                            double time_s)
{
    if (load->over == LOAD_OVER_CRANK) {
        return linkage->driver.is_present
                   ? drive_at(&linkage->driver, time_s).omega
                   : forces_turn(linkage, linkage->torque.joint, motions).rate;
    }
    return forces_coordinate(linkage, load->joint, motions).rate;
}

// Of a load that is not timed: its value at the motions, or where its slope jumps within what is
// passed from one time to the other, its mean over that, as far as speeds tell; but not where whole
// periods are passed. A smooth load is as right at the middle.
static double mean_passed(const Linkage *linkage, const Load *load, const Motion *motions,
                          double from_s, double to_s)
{
    const double time_s = 0.5 * (from_s + to_s);
    const double at = argument_of(linkage, load, motions, time_s);
    const double half = 0.5 * (to_s - from_s) * fabs(argument_rate(linkage, load, motions, time_s));
    const bool is_short =
        isfinite(half) && (load->table.period == 0.0 || 2.0 * half < load->table.period);
    if (load->table.shape != LOAD_SMOOTH && is_short &&
        load_table_next(&load->table, at - half, 1.0) < at + half) {
        return load_table_mean(&load->table, at - half, at + half);
    }
    return load_value(linkage, load, motions, time_s, from_s);
}

double load_mean(const Linkage *linkage, const Load *load, const Motion *motions, double from_s,
                 double to_s)
{
    if (load->table.count <= 1 && !wave_exists(&load->table.wave)) {
        return load_value(linkage, load, motions, 0.5 * (from_s + to_s), from_s);
    }
    if (!load_is_timed(linkage, load)) {
        return mean_passed(linkage, load, motions, from_s, to_s);
    }
    const Clock clock = clock_of(linkage, load);
    return load_table_mean(&load->table, clock.start + clock.rate * from_s,
                           clock.start + clock.rate * to_s);
}

// The direction of a force on a body, in the world.
static Vec2 direction_of(const Load *load, const Motion *motions)
{
    const double turned = load->frame == LOAD_IN_BODY ? motions[load->body].angle : 0.0;
    return (Vec2){cos(load->direction + turned), sin(load->direction + turned)};
}

void load_add(const Linkage *linkage, const Load *load, double value, const Motion *motions,
              BodyLoad *loads)
{
    switch (load->kind) {
    case LOAD_FORCE:
        forces_add_at(load->body, linkage_point(motions, load->body, load->anchor),
                      vec2_scale(value, direction_of(load, motions)), motions, loads);
        break;
    case LOAD_TORQUE:
        loads[load->body].moment += value;
        break;
    case LOAD_ALONG:
        forces_add_along(linkage, load->joint, value, motions, loads);
        break;
    }
}

double load_rate(const Linkage *linkage, const Load *load, const Motion *motions)
{
    switch (load->kind) {
    case LOAD_FORCE:
        return vec2_dot(direction_of(load, motions),
                        linkage_point_velocity(motions, load->body, load->anchor));
    case LOAD_TORQUE:
        return motions[load->body].omega;
    case LOAD_ALONG:
        break;
    }
    return forces_coordinate(linkage, load->joint, motions).rate;
}

// How far what it pushes has gone along it from one motion of the bodies to another, m or rad, with
// the motion in the middle.
static double load_way(const Linkage *linkage, const Load *load, const Motion *from,
                       const Motion *middle, const Motion *to)
{
    switch (load->kind) {
    case LOAD_FORCE:
        return vec2_dot(direction_of(load, middle),
                        vec2_sub(linkage_point(to, load->body, load->anchor),
                                 linkage_point(from, load->body, load->anchor)));
    case LOAD_TORQUE:
        return to[load->body].angle - from[load->body].angle;
    case LOAD_ALONG:
        break;
    }
    return forces_coordinate(linkage, load->joint, to).angle -
           forces_coordinate(linkage, load->joint, from).angle;
}

void loads_add(const Linkage *linkage, const Motion *motions, double time_s, double from_s,
               BodyLoad *loads)
{
    for (size_t i = 0; i < linkage->load_count; i++) {
        const Load *load = &linkage->loads[i];
        load_add(linkage, load, load_value(linkage, load, motions, time_s, from_s), motions, loads);
    }
}

double loads_power(const Linkage *linkage, const Motion *motions, double time_s, double from_s)
{
    double power = 0.0;
    for (size_t i = 0; i < linkage->load_count; i++) {
        const Load *load = &linkage->loads[i];
        power +=
            load_value(linkage, load, motions, time_s, from_s) * load_rate(linkage, load, motions);
    }
    return power;
}

void loads_of_all(const Linkage *linkage, const Motion *motions, double time_s, double from_s,
                  BodyLoad *loads)
{
    forces_loads(linkage, motions, time_s, loads);
    loads_add(linkage, motions, time_s, from_s, loads);
}

double loads_work(const Linkage *linkage, const double *values, const Motion *from,
                  const Motion *middle, const Motion *to)
{
    double work = 0.0;
    for (size_t i = 0; i < linkage->load_count; i++) {
        work += values[i] * load_way(linkage, &linkage->loads[i], from, middle, to);
    }
    return work;
}

// Whether it bends at times that are known.
static bool has_bends(const Linkage *linkage, const Load *load)
{
    return load->table.count > 1 && load_is_timed(linkage, load);
}

bool load_jumps(const Linkage *linkage, const Load *load)
{
    return load->table.shape == LOAD_STEPS && has_bends(linkage, load);
}

// The first point after a time, of the loads that count.
static double next_point(const Linkage *linkage, double time_s,
                         bool (*counts)(const Linkage *linkage, const Load *load))
{
    double next_s = INFINITY;
    for (size_t i = 0; i < linkage->load_count; i++) {
        const Load *load = &linkage->loads[i];
        if (counts(linkage, load)) {
            const Clock clock = clock_of(linkage, load);
            const double next =
                load_table_next(&load->table, argument_from(&clock, time_s), clock.rate);
            next_s = fmin(next_s, (next - clock.start) / clock.rate);
        }
    }
    return next_s;
}

double loads_next_bend(const Linkage *linkage, double time_s)
{
    return next_point(linkage, time_s, has_bends);
}

double loads_shortest_wave(const Linkage *linkage)
{
    double shortest_s = INFINITY;
    for (size_t i = 0; i < linkage->load_count; i++) {
        shortest_s = fmin(shortest_s, wave_period(&linkage->loads[i].table.wave));
    }
    return shortest_s;
}

double loads_next_jump(const Linkage *linkage, double time_s)
{
    return next_point(linkage, time_s, load_jumps);
}
