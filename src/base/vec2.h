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

static inline double vec2_length(Vec2 a)
{
    return hypot(a.x, a.y);
}
