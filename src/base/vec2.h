// Vectors of the plane.
#pragma once

#include <math.h>

typedef struct Vec2 {
    double x;
    double y;
} Vec2;

static inline Vec2 vec2_add(Vec2 a, Vec2 b)
{
    return (Vec2){a.x + b.x, a.y + b.y};
}

static inline Vec2 vec2_sub(Vec2 a, Vec2 b)
{
    return (Vec2){a.x - b.x, a.y - b.y};
}

static inline Vec2 vec2_scale(double factor, Vec2 a)
{
    return (Vec2){factor * a.x, factor * a.y};
}

static inline double vec2_dot(Vec2 a, Vec2 b)
{
    return a.x * b.x + a.y * b.y;
}

// The z component of the cross product a x b.
static inline double vec2_cross(Vec2 a, Vec2 b)
{
    return a.x * b.y - a.y * b.x;
}

// The vector turned by a quarter turn counter-clockwise: z x a.
static inline Vec2 vec2_perp(Vec2 a)
{
    return (Vec2){-a.y, a.x};
}

static inline Vec2 vec2_rotate(double angle_rad, Vec2 a)
{
    const double c = cos(angle_rad);
    const double s = sin(angle_rad);
    return (Vec2){c * a.x - s * a.y, s * a.x + c * a.y};
}

// The same without sine and cosine, to rounding, where the angle is small; else by them.
static inline Vec2 vec2_rotate_slightly(double angle_rad, Vec2 a)
{
    // the first terms that are left out are 3e-19 and 1e-21 there
    static const double SLIGHT = 0.0625;
    if (!(fabs(angle_rad) <= SLIGHT)) {
        return vec2_rotate(angle_rad, a);
    }
    const double x = angle_rad * angle_rad;
    const double c = x * (1.0 / 2.0 - x * (1.0 / 24.0 - x * (1.0 / 720.0 - x / 40320.0)));
    const double s =
        angle_rad * (1.0 - x * (1.0 / 6.0 - x * (1.0 / 120.0 - x * (1.0 / 5040.0 - x / 362880.0))));
    // with 1 - cosine, which keeps what is left of it
    return (Vec2){a.x - (c * a.x + s * a.y), a.y - (c * a.y - s * a.x)};
}

static inline double vec2_length(Vec2 a)
{
    const double square = vec2_dot(a, a);
    // the plain root is exact but for squares near the ends of double's range
    return square > 1e-280 && square < 1e280 ? sqrt(square) : hypot(a.x, a.y);
}
