// Finds where rod and slider stand at a crank angle and how they move, in closed form.
//
// Along the slider's line t and its normal n, with a crank, b rod, e offset, w the crank's speed
// and p its angle from the line; the rod from crank pin to slider is (c, s):
//     s = e - a sin p,  c = +- sqrt((b - s)(b + s))        + slider to the right, - to the left
//     x = a cos p + c
//     w3 = -a w cos p / c,           al3 = (a w^2 sin p + w3^2 s) / c
//     x' = -a w sin p - w3 s,        x'' = -a w^2 cos p - al3 s - w3^2 c
// from differentiating a (cos p, sin p) + (c, s) = (x, e) twice at constant w. Lengths m, angles
// rad. Source: R. L. Norton, Design of Machinery, sections 4.7, 6.7, 7.3.
#include "analytic/slidercrank_motion.h"

#include <math.h>

typedef struct SliderLoop {
    Vec2 crank; // from its pivot to its pin, along t and n, m
    Vec2 rod;   // from the crank pin to the slider
    double position;
    double velocity;
    double acceleration;
    double omega3;
    double alpha3;
} SliderLoop;

static SliderLoop close_slider_loop(const SliderCrank *mechanism, double speed, double crank_angle)
{
    const double b = mechanism->rod;
    SliderLoop loop = {
        .crank = vec2_rotate(crank_angle - mechanism->line, (Vec2){mechanism->crank, 0.0})};
    const double s = mechanism->offset - loop.crank.y;
    const double c =
        copysign(sqrt((b - s) * (b + s)), mechanism->side == SLIDER_RIGHT ? 1.0 : -1.0);
    loop.rod = (Vec2){c, s};
    loop.position = loop.crank.x + c;
    loop.omega3 = -speed * loop.crank.x / c;
    loop.alpha3 = (speed * speed * loop.crank.y + loop.omega3 * loop.omega3 * s) / c;
    loop.velocity = -speed * loop.crank.y - loop.omega3 * s;
    loop.acceleration =
        -speed * speed * loop.crank.x - loop.alpha3 * s - loop.omega3 * loop.omega3 * c;
    return loop;
}

// From along and across the line into the world.
static Vec2 to_world(const SliderCrank *mechanism, Vec2 local)
{
    return vec2_rotate(mechanism->line, local);
}

bool slidercrank_motion_bodies(const SliderCrank *mechanism, double speed, double crank_angle,
                               Motion motions[3])
{
    const SliderLoop loop = close_slider_loop(mechanism, speed, crank_angle);
    if (!isfinite(loop.alpha3)) {
        return false;
    }
    const double square = speed * speed;
    const Vec2 crank = to_world(mechanism, vec2_scale(0.5, loop.crank));
    motions[0] = (Motion){
        .position = crank,
        .angle = crank_angle,
        .velocity = vec2_scale(speed, vec2_perp(crank)),
        .omega = speed,
        .acceleration = vec2_scale(-square, crank),
    };
    // mid-rod lies between crank pin and slider, and so do its velocity and acceleration
    const Vec2 pin_velocity = vec2_scale(speed, vec2_perp(loop.crank));
    const Vec2 pin_acceleration = vec2_scale(-square, loop.crank);
    const Vec2 slider_velocity = {loop.velocity, 0.0};
    const Vec2 slider_acceleration = {loop.acceleration, 0.0};
    const Vec2 middle = vec2_add(loop.crank, vec2_scale(0.5, loop.rod));
    motions[1] = (Motion){
        .position = to_world(mechanism, middle),
        .angle = atan2(loop.rod.y, loop.rod.x) + mechanism->line,
        .velocity = to_world(mechanism, vec2_scale(0.5, vec2_add(pin_velocity, slider_velocity))),
        .omega = loop.omega3,
        .acceleration =
            to_world(mechanism, vec2_scale(0.5, vec2_add(pin_acceleration, slider_acceleration))),
        .alpha = loop.alpha3,
    };
    motions[2] = (Motion){
        .position = to_world(mechanism, (Vec2){loop.position, mechanism->offset}),
        .angle = mechanism->line,
        .velocity = to_world(mechanism, slider_velocity),
        .acceleration = to_world(mechanism, slider_acceleration),
    };
    return true;
}

double slidercrank_motion_quantity(const SliderCrank *mechanism, double speed,
                                   SliderCrankQuantity quantity, double crank_angle)
{
    const SliderLoop loop = close_slider_loop(mechanism, speed, crank_angle);
    switch (quantity) {
    case SLIDERCRANK_ROD_OMEGA:
        return loop.omega3;
    case SLIDERCRANK_ROD_ALPHA:
        return loop.alpha3;
    case SLIDERCRANK_POSITION:
        return loop.position;
    case SLIDERCRANK_VELOCITY:
        return loop.velocity;
    case SLIDERCRANK_ACCELERATION:
        return loop.acceleration;
    default:
        return atan2(fabs(loop.rod.x), fabs(loop.rod.y));
    }
}

typedef struct SliderCurve {
    const SliderCrank *mechanism;
    double speed;
    SliderCrankQuantity quantity;
} SliderCurve;

static double slider_value(double crank_angle, void *context)
{
    const SliderCurve *curve = context;
    return slidercrank_motion_quantity(curve->mechanism, curve->speed, curve->quantity,
                                       crank_angle);
}

CurveExtreme slidercrank_motion_extreme(const SliderCrank *mechanism, double speed,
                                        SliderCrankQuantity quantity, double first_angle,
                                        double last_angle)
{
    SliderCurve curve = {mechanism, speed, quantity};
    return curve_extreme(slider_value, &curve, first_angle, last_angle);
}
