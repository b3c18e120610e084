// How the arms of a body change when it turns by an angle d since the base: an arm s by
//     sin d perp s - (1 - cos d) s
#pragma once

#include "base/vec2.h"

typedef struct TurnedBy {
    double sine;
    double short_of_one; // 1 - cos d
} TurnedBy;

// By a series while d is small: steps are short. Up to 0.01 the first terms left out, d^9 / 9! and
// d^8 / 8!, are below 3e-21; up to 0.06, of flights, d^13 / 13! and d^12 / 12!, are below 5e-24.
static inline TurnedBy turned_by(double d)
{
    const double small = 0.01;
    const double moderate = 0.06;
    const double e = d * d;
    double sine = 1.0 - e * (1.0 / 42.0);
    double cosine = 1.0 - e * (1.0 / 30.0);
    if (!(fabs(d) <= small)) {
        if (!(fabs(d) <= moderate)) {
            return (TurnedBy){sin(d), 2.0 * sin(0.5 * d) * sin(0.5 * d)};
        }
        sine = 1.0 - e * (1.0 / 42.0) * (1.0 - e * (1.0 / 72.0) * (1.0 - e * (1.0 / 110.0)));
        cosine = 1.0 - e * (1.0 / 30.0) * (1.0 - e * (1.0 / 56.0) * (1.0 - e * (1.0 / 90.0)));
    }
    return (TurnedBy){
        .sine = d * (1.0 - e * (1.0 / 6.0) * (1.0 - e * (1.0 / 20.0) * sine)),
        .short_of_one = 0.5 * e * (1.0 - e * (1.0 / 12.0) * cosine),
    };
}

// The change of an arm.
static inline Vec2 turned_arm(const TurnedBy *by, Vec2 arm)
{
    const double s = by->sine;
    const double r = by->short_of_one;
    return (Vec2){-s * arm.y - r * arm.x, s * arm.x - r * arm.y};
}
