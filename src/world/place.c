// Finds when a place touches where nothing presses.
//
// A line is at gap + v t + a t^2 / 2 from a side, in closed form. A pin's axis is at most |e| + |v|
// t + |a| t^2 / 2 off the hole's centre: it may be called near where it is not, which costs trials.
#include "world/place.h"

#include <math.h>

size_t place_side_count(const Place *place)
{
    return place->shape == PLACE_HOLE ? 1 : SIDE_COUNT;
}

SideMotion place_motion(const Place *place, size_t number, double earlier, double step)
{
    const Side *side = &place->sides[number];
    const double gap = side_gap(side, place->position);
    const double closing = -side->sign * place->rate;
    if (place->shape == PLACE_LINE) {
        return (SideMotion){
            .gap = gap,
            .gaps = {gap + closing * 0.5 * step, gap - closing * 0.5 * step},
            .closing = closing,
            .start_closing = -side->sign * place->rate_before,
            .earlier = 0.5 * step,
        };
    }
    const Vec3 start = place->offset;
    const double size = vec3_length(start);
    const Vec3 first = vec3_add(start, vec3_scale(earlier - 0.5 * step, place->velocity));
    const Vec3 end = vec3_add(start, vec3_scale(earlier + 0.5 * step, place->velocity));
    return (SideMotion){
        .gap = gap,
        .gaps = {place->clearance - vec3_length(first), place->clearance - vec3_length(end)},
        .closing = closing,
        .start_closing =
            size > 0.0 ? vec3_dot(start, place->velocity) / size : vec3_length(place->velocity),
        .earlier = 0.5 * step,
    };
}

// The first time after now at which gap + speed t + half bend t^2 is 0, coming from above; infinite
// where there is none.
static double first_touch(double gap, double speed, double half_bend)
{
    if (half_bend == 0.0) {
        return speed < 0.0 ? -gap / speed : INFINITY;
    }
    const double square = speed * speed - 4.0 * half_bend * gap;
    if (square < 0.0 || (speed >= 0.0 && half_bend > 0.0)) {
        return INFINITY;
    }
    // without a difference of almost equal numbers
    return speed < 0.0 ? -2.0 * gap / (speed - sqrt(square))
                       : (-speed - sqrt(square)) / (2.0 * half_bend);
}

static bool is_near_side(const Side *side, double position, double speed, double acceleration,
                         double duration)
{
    const double gap = side_gap(side, position);
    return side->state.is_touching || gap < 0.0 ||
           first_touch(gap, side->sign * speed, 0.5 * side->sign * acceleration) <= duration;
}

bool place_is_near(const Place *place, const double *speed, const double *acceleration,
                   double duration)
{
    const double *from = place->start;
    if (place->shape == PLACE_LINE) {
        return is_near_side(&place->sides[0], from[0], speed[0], acceleration[0], duration) ||
               is_near_side(&place->sides[1], from[0], speed[0], acceleration[0], duration);
    }
    const double reach = hypot(from[0], from[1]) +
                         duration * (hypot(speed[0], speed[1]) +
                                     0.5 * duration * hypot(acceleration[0], acceleration[1]));
    return place->sides[0].state.is_touching || reach >= place->clearance;
}
