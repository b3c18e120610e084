// Finds where a function of one variable crosses zero, and where it is smallest.
//
// Brent's two methods: interpolation wherever it gets on faster than halving or golden sections
// would, those otherwise. Both do the operations of the two brent methods of GSL 2.7.1 in their
// order, and gave the same values to the last bit.
// Source: Brent, Algorithms for Minimization without Derivatives, 1973, chapters 4 and 5.
#include "base/root.h"

#include <float.h>
#include <math.h>

// bisection alone would need about 1100 halvings from the widest bracket of doubles to the last
// bit; Brent's method never needs more than a small multiple of that and in practice below 20
enum { ROOT_ITERATION_MAX = 4000 };

// (3 - sqrt 5) / 2, to the digits that GSL has of it
static const double GOLDEN = 0.3819660;

typedef struct Point {
    double x;
    double f;
} Point;

// A bracket of a root: it lies between b, the best point, and c; a is the point before b.
typedef struct Bracket {
    Point a, b, c;
    double step;   // the last change of b
    double former; // the one before
} Bracket;

static bool have_one_sign(double a, double b)
{
    return (a < 0.0 && b < 0.0) || (a > 0.0 && b > 0.0);
}

// Puts the smaller value into b, with the root between b and c. Returns whether a equals c.
static bool order(Bracket *bracket)
{
    bool is_linear = false;
    if (have_one_sign(bracket->b.f, bracket->c.f)) {
        is_linear = true;
        bracket->c = bracket->a;
        bracket->step = bracket->former = bracket->b.x - bracket->a.x;
    }
    if (fabs(bracket->c.f) < fabs(bracket->b.f)) {
        is_linear = true;
        bracket->a = bracket->b;
        bracket->b = bracket->c;
        bracket->c = bracket->a;
    }
    return is_linear;
}

// Chooses the next change of b: by inverse interpolation through two or three points, or half of
// the way to c, m, where that promises more.
static void choose_step(Bracket *bracket, bool is_linear, double m, double tolerance)
{
    const Point a = bracket->a;
    const Point b = bracket->b;
    const Point c = bracket->c;
    if (!(fabs(bracket->former) < tolerance || fabs(a.f) <= fabs(b.f))) {
        const double s = b.f / a.f;
        double p = 2.0 * m * s;
        double q = 1.0 - s;
        if (!is_linear) {
            const double r = b.f / c.f;
            q = a.f / c.f;
            p = s * (2.0 * m * q * (q - r) - (b.x - a.x) * (r - 1.0));
            q = (q - 1.0) * (r - 1.0) * (s - 1.0);
        }
        if (p > 0.0) {
            q = -q;
        } else {
            p = -p;
        }
        if (2.0 * p < fmin(3.0 * m * q - fabs(tolerance * q), fabs(bracket->former * q))) {
            bracket->former = bracket->step;
            bracket->step = p / q;
            return;
        }
    }
    bracket->step = bracket->former = m;
}

bool root_find(RootFunction f, void *context, double low, double high, double x_tolerance,
               double *x)
{
    const double at_low = f(low, context);
    const double at_high = f(high, context);
    if (at_low == 0.0 || at_high == 0.0) {
        *x = at_low == 0.0 ? low : high;
        return true;
    }
    if (!isfinite(at_low) || !isfinite(at_high) || (at_low > 0.0) == (at_high > 0.0)) {
        return false;
    }
    Bracket bracket = {.a = {low, at_low}, .b = {high, at_high}, .c = {high, at_high}};
    bracket.step = bracket.former = high - low;
    for (int i = 0; i < ROOT_ITERATION_MAX; i++) {
        const bool is_linear = order(&bracket);
        const double tolerance = 0.5 * DBL_EPSILON * fabs(bracket.b.x);
        const double m = 0.5 * (bracket.c.x - bracket.b.x);
        if (bracket.b.f == 0.0 || fabs(m) <= tolerance) {
            *x = bracket.b.x;
            return true;
        }
        choose_step(&bracket, is_linear, m, tolerance);
        bracket.a = bracket.b;
        bracket.b.x +=
            fabs(bracket.step) > tolerance ? bracket.step : (m > 0.0 ? tolerance : -tolerance);
        bracket.b.f = f(bracket.b.x, context);
        if (!isfinite(bracket.b.f)) {
            return false;
        }
        const double b = bracket.b.x;
        const double c = have_one_sign(bracket.b.f, bracket.c.f) ? bracket.a.x : bracket.c.x;
        const double last_bit = 2.0 * DBL_EPSILON * fmax(fabs(b), fabs(c));
        if (fabs(c - b) <= fmax(x_tolerance, last_bit)) {
            *x = b;
            return true;
        }
    }
    return false;
}

// A minimum at z, the best point, between two others; w and v were the best before.
typedef struct Valley {
    double left, right;
    Point z, w, v;
    double step;   // the last change of z
    double former; // the one before
} Valley;

// Where to look next: at the bottom of the parabola through z, w and v, or in the larger part of
// the interval where that would not get on.
static double next_point(Valley *valley)
{
    const Point z = valley->z;
    const double below = z.x - valley->left;
    const double above = valley->right - z.x;
    const double middle = 0.5 * (valley->left + valley->right);
    const double tolerance = sqrt(DBL_EPSILON) * fabs(z.x);
    double former = valley->step;
    double step = valley->former;
    double p = 0.0;
    double q = 0.0;
    double r = 0.0;
    if (fabs(former) > tolerance) {
        r = (z.x - valley->w.x) * (z.f - valley->v.f);
        q = (z.x - valley->v.x) * (z.f - valley->w.f);
        p = (z.x - valley->v.x) * q - (z.x - valley->w.x) * r;
        q = 2.0 * (q - r);
        if (q > 0.0) {
            p = -p;
        } else {
            q = -q;
        }
        r = former;
        former = step;
    }
    if (fabs(p) < fabs(0.5 * q * r) && p < q * below && p < q * above) {
        step = p / q;
        const double x = z.x + step;
        if (x - valley->left < 2.0 * tolerance || valley->right - x < 2.0 * tolerance) {
            step = z.x < middle ? tolerance : -tolerance;
        }
    } else {
        former = z.x < middle ? above : -below;
        step = GOLDEN * former;
    }
    valley->former = former;
    valley->step = step;
    if (fabs(step) >= tolerance) {
        return z.x + step;
    }
    return z.x + (step > 0.0 ? tolerance : -tolerance);
}

// Takes a new point into the interval and among the best three.
static void take_point(Valley *valley, Point u)
{
    const Point z = valley->z;
    if (u.f <= z.f) {
        *(u.x < z.x ? &valley->right : &valley->left) = z.x;
        valley->v = valley->w;
        valley->w = z;
        valley->z = u;
        return;
    }
    *(u.x < z.x ? &valley->left : &valley->right) = u.x;
    if (u.f <= valley->w.f || valley->w.x == z.x) {
        valley->v = valley->w;
        valley->w = u;
    } else if (u.f <= valley->v.f || valley->v.x == z.x || valley->v.x == valley->w.x) {
        valley->v = u;
    }
}

static bool are_alike(const Valley *one, const Valley *other)
{
    return one->left == other->left && one->right == other->right && one->z.x == other->z.x &&
           one->w.x == other->w.x && one->v.x == other->v.x && one->step == other->step &&
           one->former == other->former;
}

bool root_minimum(RootFunction f, void *context, double low, double middle, double high, double *x)
{
    // a minimum's position is known to the root of the rounding only
    const double width = sqrt(DBL_EPSILON) * (high - low);
    const double at_low = f(low, context);
    const double at_high = f(high, context);
    Valley valley = {.left = low, .right = high, .z = {middle, f(middle, context)}};
    if (!(low < middle && middle < high && isfinite(at_low) && isfinite(at_high) &&
          valley.z.f < at_low && valley.z.f < at_high)) {
        return false;
    }
    const double start = low + GOLDEN * (high - low);
    valley.v = valley.w = (Point){start, f(start, context)};
    if (!isfinite(valley.v.f)) {
        return false;
    }
    bool is_moving = true;
    for (int i = 0; i < ROOT_ITERATION_MAX && is_moving && valley.right - valley.left > width;
         i++) {
        const Valley before = valley;
        const double next = next_point(&valley);
        const Point u = {next, f(next, context)};
        if (!isfinite(u.f)) {
            break;
        }
        take_point(&valley, u);
        // the step at which values differ by rounding alone may be wider than the width: what has
        // changed nothing would be done again and again
        is_moving = !are_alike(&before, &valley);
    }
    *x = valley.z.x;
    return true;
}
