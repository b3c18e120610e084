// The friction of a sliding pair that can hold: a bristle, which bends with the sliding until the
// friction is used up.
//
// Of what presses on the pair, times the coefficient of sliding friction, P, it holds s P:
//     r = mu_s / mu_k,   g(v) = 1 + (r - 1) exp(-(v / v_s)^2)
//     stick:  s = r z / D + d z', no more than +-g(v);   z' = v,  |z| <= D
//     LuGre:  s = r z / D + d z';                        z' = v - r |v| z / (D g(v))
// z the bend, D the presliding (the bend at which friction is used up), v the sliding speed, d the
// bristle's damping. At rest stick holds what is below r P without creep; LuGre creeps.
//
// The law of stick has corners: it sticks, it yields (s is g(v), and the bristle still bends), it
// slides (the bend stays at D). In each of these modes everything is smooth, and goes on smoothly
// beyond its end.
//
// Sources: Dahl 1968; Canudas de Wit, Olsson, Astrom and Lischinsky, IEEE Trans. Automatic Control
// 40 (1995) 419; Dupont, Hayward, Armstrong and Altpeter, likewise 47 (2002) 787 (elasto-plastic).
#pragma once

#include "kernel/friction_law.h"

#include <math.h>
#include <stdbool.h>

typedef enum BristleLaw {
    BRISTLE_REGULARIZED, // s = tanh(v / v_s): no bristle
    BRISTLE_STICK,
    BRISTLE_LUGRE,
} BristleLaw;

typedef enum BristleMode {
    BRISTLE_STICKING,
    BRISTLE_YIELDING_FORTH, // v > 0
    BRISTLE_YIELDING_BACK,
    BRISTLE_SLIDING_FORTH,
    BRISTLE_SLIDING_BACK,
} BristleMode;

// Lengths are angles, rad, of a pair that turns.
typedef struct BristlePair {
    BristleLaw law;
    double ratio;   // 1, r
    double limit;   // m, D
    double speed;   // m/s, v_s
    double damping; // s/m, d
    double zeta;    // 1, of a contact: the damping ratio; d follows what presses (bristle_pressed)
    double mass;    // kg, of a contact: what moves on the bristle
} BristlePair;

// What it holds, 1, and how fast it bends, m/s.
typedef struct BristleHold {
    double share;
    double bending;
} BristleHold;

// g: what is left of the friction at a sliding speed.
static inline double bristle_left(const BristlePair *pair, double speed)
{
    const double over = speed / pair->speed;
    return pair->ratio == 1.0 ? 1.0 : 1.0 + (pair->ratio - 1.0) * exp(-over * over);
}

// The way in which a mode slides: 1, -1, or 0 where it sticks.
static inline double bristle_way(BristleMode mode)
{
    switch (mode) {
    case BRISTLE_YIELDING_FORTH:
    case BRISTLE_SLIDING_FORTH:
        return 1.0;
    case BRISTLE_YIELDING_BACK:
    case BRISTLE_SLIDING_BACK:
        return -1.0;
    case BRISTLE_STICKING:
        break;
    }
    return 0.0;
}

static inline bool bristle_slides(BristleMode mode)
{
    return mode == BRISTLE_SLIDING_FORTH || mode == BRISTLE_SLIDING_BACK;
}

// What the bristle of the law of stick would hold if friction were not used up.
static inline double bristle_bent(const BristlePair *pair, double bend, double speed)
{
    return pair->ratio * bend / pair->limit + pair->damping * speed;
}

// In a mode, which of LuGre's law says the way of the sliding alone.
static inline BristleHold bristle_hold(const BristlePair *pair, BristleMode mode, double bend,
                                       double speed)
{
    const double way = bristle_way(mode);
    BristleHold hold = {0.0, 0.0};
    switch (pair->law) {
    case BRISTLE_REGULARIZED:
        hold.share = friction_hold(speed, pair->speed).held;
        break;
    case BRISTLE_STICK:
        hold.share = way == 0.0 ? bristle_bent(pair, bend, speed) : way * bristle_left(pair, speed);
        hold.bending = bristle_slides(mode) ? 0.0 : speed;
        break;
    case BRISTLE_LUGRE:
        hold.bending =
            speed - pair->ratio * way * speed * bend / (pair->limit * bristle_left(pair, speed));
        hold.share = pair->ratio * bend / pair->limit + pair->damping * hold.bending;
        break;
    }
    return hold;
}

// How far a mode is from its end, 1, negative beyond, and the mode that follows there. A mode may
// end in two ways; `which` is 0 or 1. Returns INFINITY where there is no such end.
static inline double bristle_margin(const BristlePair *pair, BristleMode mode, int which,
                                    double bend, double speed, BristleMode *next)
{
    const double way = bristle_way(mode);
    if (pair->law == BRISTLE_REGULARIZED) {
        return INFINITY;
    }
    if (pair->law == BRISTLE_LUGRE) {
        *next = way > 0.0 ? BRISTLE_SLIDING_BACK : BRISTLE_SLIDING_FORTH;
        return which == 0 ? way * speed / pair->speed : INFINITY;
    }
    if (mode == BRISTLE_STICKING) {
        const double bent = bristle_bent(pair, bend, speed);
        *next = which == 0 ? BRISTLE_YIELDING_FORTH : BRISTLE_YIELDING_BACK;
        return bristle_left(pair, speed) - (which == 0 ? bent : -bent);
    }
    if (bristle_slides(mode)) {
        *next = BRISTLE_STICKING;
        return which == 0 ? way * speed / pair->speed : INFINITY;
    }
    if (which == 0) {
        *next = BRISTLE_STICKING;
        return way * bristle_bent(pair, bend, speed) - bristle_left(pair, speed);
    }
    *next = mode == BRISTLE_YIELDING_FORTH ? BRISTLE_SLIDING_FORTH : BRISTLE_SLIDING_BACK;
    return 1.0 - way * bend / pair->limit;
}

// The mode at a bend and a speed of which no mode is known.
static inline BristleMode bristle_begin(const BristlePair *pair, double bend, double speed)
{
    if (pair->law == BRISTLE_LUGRE) {
        return speed < 0.0 ? BRISTLE_SLIDING_BACK : BRISTLE_SLIDING_FORTH;
    }
    const double bent = bristle_bent(pair, bend, speed);
    if (pair->law == BRISTLE_REGULARIZED || fabs(bent) < bristle_left(pair, speed)) {
        return BRISTLE_STICKING;
    }
    return bent > 0.0 ? BRISTLE_YIELDING_FORTH : BRISTLE_YIELDING_BACK;
}

// Likewise, of stick, the damping that makes a mass on the bristle damped by a ratio: d P is
// 2 zeta sqrt(k m), k = r P / D. 0 where nothing presses, or nothing moves.
static inline double bristle_damping(const BristlePair *pair, double ratio, double pressing,
                                     double mass)
{
    return pressing > 0.0 ? 2.0 * ratio * sqrt(pair->ratio * mass / (pair->limit * pressing)) : 0.0;
}

// Of an ideal joint, how its sliding accelerates under its own friction, 1/kg or 1/(kg m^2), over
// how the two bodies alone would: below this nothing moves on its bristle, which has no damping.
// Driven mechanisms have none at all, and others come near it at a dead centre, where joints turn
// back and begin to stick: the mass there would be any, and the damping with it.
static const double BRISTLE_MOBILITY = 1e-5;

// The pair of a contact where its friction is up to so much, N: mu times what presses.
static inline BristlePair bristle_pressed(const BristlePair *pair, double pressing)
{
    BristlePair pressed = *pair;
    pressed.damping = bristle_damping(pair, pair->zeta, pressing, pair->mass);
    return pressed;
}

// The mode in which a contact that sticks begins: its bristle is straight, and damped without
// bound, for nothing presses yet.
static inline BristleMode bristle_onset(double speed)
{
    return speed > 0.0   ? BRISTLE_YIELDING_FORTH
           : speed < 0.0 ? BRISTLE_YIELDING_BACK
                         : BRISTLE_STICKING;
}

// The shortest time in which friction changes what slides, s, if all of it would accelerate that by
// so much, m/s^2, that it is up to so much, N; of the law of stick.
static inline double bristle_time(const BristlePair *pair, BristleMode mode, double pressing,
                                  double most)
{
    if (bristle_slides(mode)) {
        return INFINITY;
    }
    const double damping = bristle_damping(pair, pair->zeta, pressing, pair->mass);
    return 1.0 / fmax(most * damping, sqrt(most * pair->ratio / pair->limit));
}
