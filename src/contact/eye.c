// Solves the contact of a round pin in the hole of an eye.
//
// All lengths are in radii of the hole but for the approach d, which like the displacements is in
// plays; pressures in E* play / radius. Where pin and hole touch, at angles |t| < a from the load,
//     int K(t - s) p(s) ds = (1 + d) cos t - 1,  p(a) = 0,  f = int p(t) cos t dt
// The kernel K sums what a pressure cos(n t) does to the wall and to the pin, harmonic by harmonic:
// the pin and a plate with a hole give
//     2 n / (n^2 - 1) + D / (n^2 - 1),  n >= 2,  D = (k_a - 1) / (4 G_a) - (k_b - 1) / (4 G_b)
// with G shear moduli, k = 3 - 4 nu, and in closed form, as sums over n of that times cos(n t),
//     -2 cos t ln|2 sin(t/2)| - 1 - cos(t) / 2  and  1/2 + cos(t) / 4 - (pi - |t|) sin|t| / 2
// The rest, that the eye ends and is clamped there and the harmonics 0 and 1, falls off with the
// powers of its outer radius. Displacements are those of Michell's stress functions.
//
// With x = sin(t/2) / sin(a/2) = cos(phi) the pressure is q(x) / sqrt(1 - x^2) dx, q even and a
// polynomial in cos(2 k phi); logarithm and sign of x - x' act on each of these by themselves. What
// is left of the kernel is smooth: sums over the nodes do. So the solution gains digits with each
// node.
//
// Sources: J. R. Barber, Elasticity (2002), tables 8.1 and 9.1, for the stress functions;
// A. Persson, thesis, Chalmers (1964), for the problem in an infinite plate.
#include "contact/eye.h"

#include "base/dense.h"
#include "base/root.h"
#include "kernel/conforming.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

enum {
    NODES = 32,
    HARMONICS = 400, // at most: the thinnest eye has 330 that count
};

// what is as good as an infinite eye, in radii of the hole
static const double OUTER_MOST = 1e3;

// what is left of harmonics is no more than this
static const double SMALL = 1e-16;

// What depends on neither the eye nor the angle: what acts on values of even or odd functions at
// the nodes.
typedef struct Nodes {
    double phi[NODES];
    double log_even[NODES][NODES]; // int ln|x - x'| f(x') / sqrt(1 - x'^2) dx'
    double log_odd[NODES][NODES];
    double sign_even[NODES][NODES]; // likewise of the sign of x - x'
    double sign_odd[NODES][NODES];
    double end[NODES]; // the value at x = 1 of an even function
} Nodes;

// What is left of the harmonics beyond closed forms, and D.
typedef struct Influence {
    double harmonics[HARMONICS];
    size_t count;
    double difference;
} Influence;

// What a logarithm and a sign make of cos(k phi).
static double log_of(size_t k)
{
    return k == 0 ? -PI * log(2.0) : -PI / (double)k;
}

static double sign_of(size_t k, double phi)
{
    return k == 0 ? PI - 2.0 * phi : -2.0 * sin((double)k * phi) / (double)k;
}

static void fill_pair(Nodes *nodes, size_t i, size_t j)
{
    const double here = nodes->phi[i];
    const double there = nodes->phi[j];
    double sums[4] = {0.0};
    for (size_t k = 0; k < NODES; k++) {
        const size_t even = 2 * k;
        const size_t odd = 2 * k + 1;
        const double part = (k == 0 ? 1.0 : 2.0) / NODES * cos((double)even * there);
        const double odd_part = 2.0 / NODES * cos((double)odd * there);
        sums[0] += part * log_of(even) * cos((double)even * here);
        sums[1] += odd_part * log_of(odd) * cos((double)odd * here);
        sums[2] += part * sign_of(even, here);
        sums[3] += odd_part * sign_of(odd, here);
    }
    nodes->log_even[i][j] = sums[0];
    nodes->log_odd[i][j] = sums[1];
    nodes->sign_even[i][j] = sums[2];
    nodes->sign_odd[i][j] = sums[3];
}

static void fill_nodes(Nodes *nodes)
{
    for (size_t i = 0; i < NODES; i++) {
        nodes->phi[i] = PI * (2.0 * (double)i + 1.0) / (4.0 * NODES);
    }
    for (size_t j = 0; j < NODES; j++) {
        nodes->end[j] = 0.0;
        for (size_t k = 0; k < NODES; k++) {
            nodes->end[j] += (k == 0 ? 1.0 : 2.0) / NODES * cos(2.0 * (double)k * nodes->phi[j]);
        }
        for (size_t i = 0; i < NODES; i++) {
            fill_pair(nodes, i, j);
        }
    }
}

// A ring under one of its four stress functions of a harmonic at a radius: along and across the
// radius the tractions and 2 G times the displacements. What grows outward is 1 at the outside.
typedef struct Ring {
    double pull;
    double shear;
    double out;
    double along;
} Ring;

static Ring ring_at(double n, int function, double k, double r, double outer)
{
    const double growing = pow(r / outer, n);
    const double falling = pow(r, -n);
    switch (function) {
    case 0: // r^n cos(n t), or r^2 of n = 0, and a translation of n = 1
        return n == 0.0 ? (Ring){2.0, 0.0, (k - 1.0) * r, 0.0}
               : n == 1.0
                   ? (Ring){0.0, 0.0, 1.0, -1.0}
                   : (Ring){-n * (n - 1.0) / (r * r) * growing, n * (n - 1.0) / (r * r) * growing,
                            -n / r * growing, n / r * growing};
    case 1: // r^(n + 2) cos(n t), or ln r of n = 0
        return n == 0.0 ? (Ring){1.0 / (r * r), 0.0, -1.0 / r, 0.0}
                        : (Ring){-(n + 1.0) * (n - 2.0) * growing, n * (n + 1.0) * growing,
                                 (k - n - 1.0) * r * growing, (k + n + 1.0) * r * growing};
    case 2: // r^-n cos(n t)
        return (Ring){-n * (n + 1.0) * falling / (r * r), -n * (n + 1.0) * falling / (r * r),
                      n * falling / r, n * falling / r};
    default: // r^(2 - n) cos(n t), or what carries a force of n = 1
        return n == 1.0
                   ? (Ring){-0.5 * (3.0 + k) / r, 0.5 * (k - 1.0) / r, 1.0 - k * log(r), k * log(r)}
                   : (Ring){-(n + 2.0) * (n - 1.0) * falling, -n * (n - 1.0) * falling,
                            (k + n - 1.0) * falling * r, -(k - n + 1.0) * falling * r};
    }
}

// How far the hole's wall moves out under a pressure cos(n t), times 2 G.
static double ring_moves(size_t harmonic, double k, double outer)
{
    const double n = (double)harmonic;
    const size_t count = harmonic == 0 ? 2 : 4;
    double matrix[16];
    double b[4] = {-1.0, 0.0, 0.0, 0.0};
    double out[4];
    for (size_t j = 0; j < count; j++) {
        const Ring inside = ring_at(n, (int)j, k, 1.0, outer);
        const Ring outside = ring_at(n, (int)j, k, outer, outer);
        const double rows[2][4] = {{inside.pull, outside.out},
                                   {inside.pull, inside.shear, outside.out, outside.along}};
        for (size_t i = 0; i < count; i++) {
            matrix[i * count + j] = rows[count == 4][i];
        }
        out[j] = inside.out;
    }
    if (!dense_solve(count, matrix, b)) {
        return NAN;
    }
    double moved = 0.0;
    for (size_t j = 0; j < count; j++) {
        moved += b[j] * out[j];
    }
    return moved;
}

// How far that pressure moves the pin's surface in, seen from its centre, times 2 G. Of n = 1 a
// force over the whole section holds it.
static double pin_moves(size_t harmonic, double k)
{
    const double n = (double)harmonic;
    return harmonic == 0   ? 0.5 * (k - 1.0)
           : harmonic == 1 ? 0.25 * (k - 1.0)
                           : 0.5 * (n * (k + 1.0) - (k - 1.0)) / (n * n - 1.0);
}

static bool fill_influence(const Eye *eye, Influence *influence)
{
    const double hole = eye->hole_share / (1.0 - eye->hole_ratio); // 1 / (2 G), in 1 / E*
    const double pin = (1.0 - eye->hole_share) / (1.0 - eye->pin_ratio);
    const double hole_k = 3.0 - 4.0 * eye->hole_ratio;
    const double pin_k = 3.0 - 4.0 * eye->pin_ratio;
    influence->difference = 0.5 * (hole * (hole_k - 1.0) - pin * (pin_k - 1.0));
    for (size_t n = 0; n < HARMONICS; n++) {
        const double own = (double)(n * n) - 1.0;
        const double closed = n < 2 ? 0.0 : (2.0 * (double)n + influence->difference) / own;
        const double whole = hole * ring_moves(n, hole_k, eye->outer) + pin * pin_moves(n, pin_k);
        influence->harmonics[n] = whole - closed;
        influence->count = n + 1;
        if (!isfinite(whole)) {
            return false;
        }
        if (n > 2 && (double)(n * n) * pow(eye->outer, -2.0 * (double)n) < SMALL) {
            break;
        }
    }
    return true;
}

// A contact up to an angle, node by node.
typedef struct Patch {
    double half; // sin(a / 2)
    double x[NODES];
    double angle[NODES];
    double cosine[NODES];
    double sine[NODES];
    double root[NODES]; // cos(t / 2)
    const Nodes *nodes;
    const Influence *influence;
} Patch;

static void fill_patch(const Nodes *nodes, const Influence *influence, double half_angle,
                       Patch *patch)
{
    patch->half = sin(0.5 * half_angle);
    patch->nodes = nodes;
    patch->influence = influence;
    for (size_t i = 0; i < NODES; i++) {
        patch->x[i] = cos(nodes->phi[i]);
        patch->angle[i] = 2.0 * asin(patch->half * patch->x[i]);
        patch->cosine[i] = cos(patch->angle[i]);
        patch->sine[i] = sin(patch->angle[i]);
        patch->root[i] = cos(0.5 * patch->angle[i]);
    }
}

// int ln|2 sin((t - s) / 2)| .. over even and odd functions: with ln|x - x'| what is left is smooth
static double log_even(const Patch *patch, size_t i, size_t j)
{
    return patch->nodes->log_even[i][j] + PI / NODES * log(2.0 * patch->half);
}

static double log_odd(const Patch *patch, size_t i, size_t j)
{
    const double sum = patch->x[i] + patch->x[j];
    const double mixed = patch->x[i] * patch->root[j] + patch->x[j] * patch->root[i];
    return patch->nodes->log_odd[i][j] + PI / NODES * log(sum / mixed);
}

// A times the sum of both closed forms and the harmonics, for what is even.
static double kernel_between(const Patch *patch, size_t i, size_t j)
{
    const Influence *influence = patch->influence;
    const double weight = PI / NODES;
    const double both = patch->cosine[i] * patch->cosine[j];
    const double across = patch->sine[i] * patch->sine[j];
    const double log_part = both * log_even(patch, i, j) + across * log_odd(patch, i, j);
    const double apart = patch->angle[i] - patch->angle[j];
    const double together = patch->angle[i] + patch->angle[j];
    const double bent = 0.25 * (apart * sin(apart) + together * sin(together));
    const double kink = 0.5 * PI *
                        (patch->sine[i] * patch->cosine[j] * patch->nodes->sign_even[i][j] -
                         patch->cosine[i] * patch->sine[j] * patch->nodes->sign_odd[i][j]);
    return -2.0 * log_part - weight * (1.0 + 0.5 * both) +
           influence->difference * (weight * (0.5 + 0.25 * both + bent) - kink);
}

// Adds what is left of the harmonics: cos(n t) cos(n s), cosines by their recurrence.
static void add_harmonics(const Patch *patch, double *matrix, size_t columns)
{
    const Influence *influence = patch->influence;
    double now[NODES];
    double before[NODES];
    for (size_t i = 0; i < NODES; i++) {
        now[i] = 1.0;
        before[i] = patch->cosine[i];
    }
    for (size_t n = 0; n < influence->count; n++) {
        const double weight = PI / NODES * influence->harmonics[n] * (n == 0 ? 0.5 : 1.0);
        for (size_t i = 0; i < NODES; i++) {
            for (size_t j = 0; j < NODES; j++) {
                matrix[i * columns + j] += weight * now[i] * now[j];
            }
        }
        for (size_t i = 0; i < NODES; i++) {
            const double next = 2.0 * patch->cosine[i] * now[i] - before[i];
            before[i] = now[i];
            now[i] = next;
        }
    }
}

static bool press_on(const Patch *patch, EyePress *press)
{
    enum { UNKNOWNS = NODES + 1 }; // q at the nodes, and d
    double matrix[UNKNOWNS * UNKNOWNS] = {0.0};
    double q[UNKNOWNS];
    for (size_t i = 0; i < NODES; i++) {
        for (size_t j = 0; j < NODES; j++) {
            matrix[i * UNKNOWNS + j] = kernel_between(patch, i, j);
        }
    }
    add_harmonics(patch, matrix, UNKNOWNS);
    for (size_t i = 0; i < NODES; i++) {
        const double depth = patch->half * patch->x[i]; // of 1 - cos t
        matrix[i * UNKNOWNS + NODES] = -PI * patch->cosine[i];
        matrix[NODES * UNKNOWNS + i] = patch->nodes->end[i];
        q[i] = -2.0 * PI * depth * depth;
    }
    q[NODES] = 0.0;
    if (!dense_solve(UNKNOWNS, matrix, q)) {
        *press = (EyePress){NAN, NAN, NAN};
        return false;
    }
    press->force = 0.0;
    for (size_t i = 0; i < NODES; i++) {
        press->force += PI / NODES * q[i] * patch->cosine[i];
    }
    press->approach = q[NODES];
    const double middle = sqrt(1.0 - patch->x[NODES - 1] * patch->x[NODES - 1]);
    press->pressure = q[NODES - 1] * patch->root[NODES - 1] / (2.0 * patch->half * middle);
    return press->approach > 0.0 && press->force > 0.0;
}

static bool is_sound(const Eye *eye)
{
    return eye->outer >= EYE_LEAST && eye->hole_share >= 0.0 && eye->hole_share <= 1.0 &&
           fabs(eye->hole_ratio) < 1.0 && fabs(eye->pin_ratio) < 1.0;
}

static bool prepare(const Eye *eye, Nodes *nodes, Influence *influence)
{
    Eye own = *eye;
    own.outer = fmin(own.outer, OUTER_MOST);
    fill_nodes(nodes);
    return is_sound(eye) && fill_influence(&own, influence);
}

bool eye_press(const Eye *eye, double half_angle, EyePress *press)
{
    Nodes nodes;
    Influence influence;
    Patch patch;
    if (!prepare(eye, &nodes, &influence)) {
        return false;
    }
    fill_patch(&nodes, &influence, half_angle, &patch);
    return press_on(&patch, press);
}

// A search for the angle at which an approach is reached.
typedef struct Search {
    const Nodes *nodes;
    const Influence *influence;
    double approach; // that is sought
    EyePress press;
} Search;

// What is missing, as a share: beyond the widest contact the approach passes infinity.
static double missing(double log_angle, void *context)
{
    Search *search = context;
    Patch patch;
    fill_patch(search->nodes, search->influence, exp(log_angle), &patch);
    press_on(&patch, &search->press);
    return 1.0 - search->approach / search->press.approach;
}

// The angle of an approach, from one that is below it; both as logarithms.
static bool find_angle(Search *search, double *log_angle)
{
    static const double STRIDE = 0.3;
    const double most = log(PI) - 1e-3;
    double low = *log_angle;
    double high = low;
    do {
        low = high;
        high = fmin(high + STRIDE, most);
    } while (missing(high, search) < 0.0 && search->press.approach > 0.0 && high < most);
    return root_find(missing, search, low, high, 1e-13, log_angle) &&
           isfinite(missing(*log_angle, search));
}

// Polynomial coefficients of the Chebyshev series through values at its nodes.
static void fit(const double *values, double *series)
{
    enum { TERMS = CONFORMING_TERMS };
    double older[TERMS] = {1.0}; // T_0, T_1 .. by powers
    double old[TERMS] = {0.0, 1.0};
    memset(series, 0, TERMS * sizeof *series);
    for (size_t k = 0; k < TERMS; k++) {
        double weight = 0.0;
        for (size_t i = 0; i < TERMS; i++) {
            weight += (k == 0 ? 1.0 : 2.0) / TERMS * values[i] *
                      cos(PI * (double)k * ((double)i + 0.5) / TERMS);
        }
        double next[TERMS];
        for (size_t i = 0; i < TERMS; i++) {
            series[i] += weight * older[i];
            next[i] = 2.0 * (i > 0 ? old[i - 1] : 0.0) - older[i];
        }
        memcpy(older, old, sizeof older);
        memcpy(old, next, sizeof old);
    }
}

// Whether force and slope are above 0 at all depths: a thin eye that cannot be compressed is so
// stiff beside its pin that the series is not right enough.
static bool is_rising(const double *series)
{
    Conforming law = {.stiffness = 1.0, .play = 1.0};
    memcpy(law.series, series, sizeof law.series);
    for (double depth = 1e-9; depth < 1e9; depth *= 1.1) {
        double force;
        double slope;
        conforming_both(&law, depth, &force, &slope);
        if (!(force > 0.0) || !(slope > 0.0)) {
            return false;
        }
    }
    return true;
}

bool eye_series(const Eye *eye, double *series)
{
    Nodes nodes;
    Influence influence;
    if (!prepare(eye, &nodes, &influence)) {
        return false;
    }
    double values[CONFORMING_TERMS];
    double log_angle = log(1e-6);
    for (size_t node = 0; node < CONFORMING_TERMS; node++) { // from x = 1, the least approach
        const double x = cos(PI * ((double)node + 0.5) / CONFORMING_TERMS);
        Search search = {.nodes = &nodes, .influence = &influence, .approach = conforming_depth(x)};
        if (!find_angle(&search, &log_angle)) {
            return false;
        }
        values[node] = PI * search.press.approach / search.press.force;
    }
    fit(values, series);
    return is_rising(series);
}
