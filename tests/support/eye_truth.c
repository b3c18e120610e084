// Solves the contact of a pin in an eye by panels and by integration over the radius.
//
// Displacements f cos(n t) along and g sin(n t) across the radius, dilatation D cos(n t), rotation
// R sin(n t) / 2, under a force b per volume along t = 0:
//     f' = D - f/r - n g/r,                 g' = R - g/r - n f/r
//     (l + 2 m) D' = m n R / r - b,         m R' = (l + 2 m) n D / r + b
// with Lame's l and m. The pin is a ring, too, whose hole has a ten-thousandth of its radius and
// is free: it changes the rest by 1e-8.
#include "eye_truth.h"

#include "base/dense.h"
#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 3000, STATES = 4, HARMONICS = 120 };

static const double PI = 3.14159265358979323846;
static const double BORE = 1e-4; // of the pin

typedef struct Solid {
    double n;
    double lame;
    double shear;
    double load; // b
} Solid;

// A material with (1 - nu^2) / E = 1.
static Solid solid_of(size_t n, double poisson_ratio)
{
    const double modulus = 1.0 - poisson_ratio * poisson_ratio;
    return (Solid){
        .n = (double)n,
        .lame = modulus * poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio)),
        .shear = modulus / (2.0 * (1.0 + poisson_ratio)),
    };
}

// Rates of f, g, D, R over ln r.
static void rates(const Solid *solid, double r, const double y[STATES], double out[STATES])
{
    const double stiff = solid->lame + 2.0 * solid->shear;
    out[0] = r * y[2] - y[0] - solid->n * y[1];
    out[1] = r * y[3] - y[1] - solid->n * y[0];
    out[2] = (solid->shear * solid->n * y[3] - r * solid->load) / stiff;
    out[3] = (stiff * solid->n * y[2] + r * solid->load) / solid->shear;
}

static void integrate(const Solid *solid, double from, double to, double y[STATES])
{
    const double step = log(to / from) / STEPS;
    for (int i = 0; i < STEPS; i++) {
        const double at = log(from) + i * step;
        double k[4][STATES];
        double trial[STATES];
        static const double SHARES[4] = {0.0, 0.5, 0.5, 1.0};
        for (int stage = 0; stage < 4; stage++) {
            for (int j = 0; j < STATES; j++) {
                trial[j] = y[j] + (stage > 0 ? SHARES[stage] * step * k[stage - 1][j] : 0.0);
            }
            rates(solid, exp(at + SHARES[stage] * step), trial, k[stage]);
        }
        for (int j = 0; j < STATES; j++) {
            y[j] += step / 6.0 * (k[0][j] + 2.0 * (k[1][j] + k[2][j]) + k[3][j]);
        }
    }
}

// Tractions on a circle: along and across the radius.
static void tractions(const Solid *solid, double r, const double y[STATES], double out[2])
{
    const double strain = y[2] - y[0] / r - solid->n * y[1] / r;
    out[0] = solid->lame * y[2] + 2.0 * solid->shear * strain;
    out[1] = solid->shear * (y[3] - 2.0 * y[1] / r - 2.0 * solid->n * y[0] / r);
}

// From two motions under no load and one under it: that one of their sums which has the tractions
// -1 and 0 on the circle of radius 1.
static double combine(const Solid *solid, double ends[3][STATES])
{
    double pulled[3][2];
    for (int i = 0; i < 3; i++) {
        tractions(solid, 1.0, ends[i], pulled[i]);
    }
    if (solid->n == 0.0) {
        return (-1.0 - pulled[2][0]) / pulled[0][0] * ends[0][0] + ends[2][0];
    }
    double matrix[4] = {pulled[0][0], pulled[1][0], pulled[0][1], pulled[1][1]};
    double b[2] = {-1.0 - pulled[2][0], -pulled[2][1]};
    if (!dense_solve(2, matrix, b)) {
        return NAN;
    }
    return b[0] * ends[0][0] + b[1] * ends[1][0] + ends[2][0];
}

double eye_truth_ring(size_t n, double poisson_ratio, double outer)
{
    const Solid solid = solid_of(n, poisson_ratio);
    double ends[3][STATES] = {{0.0, 0.0, 1.0, 0.0}, {0.0, 0.0, 0.0, 1.0}};
    for (int i = 0; i < 2; i++) {
        integrate(&solid, outer, 1.0, ends[i]);
    }
    return combine(&solid, ends);
}

// Starts a motion from the edge of the bore, which is free: f and g say how it moves.
static void start_free(const Solid *solid, double y[STATES])
{
    const double stiff = solid->lame + 2.0 * solid->shear;
    y[2] = 2.0 * solid->shear * (y[0] + solid->n * y[1]) / BORE / stiff;
    y[3] = 2.0 * (y[1] + solid->n * y[0]) / BORE;
}

double eye_truth_pin(size_t n, double poisson_ratio)
{
    Solid solid = solid_of(n, poisson_ratio);
    double ends[3][STATES] = {{1.0, 0.0}, {0.0, 1.0}};
    if (n == 1) {
        // held by a force over the section; without turning, and the centre stays
        double y[STATES] = {1.0, 1.0};
        double held[STATES] = {0.0};
        double first[2];
        double second[2];
        start_free(&solid, y);
        integrate(&solid, BORE, 1.0, y);
        tractions(&solid, 1.0, y, first);
        solid.load = 1.0; // a pressure cos(t) has a resultant of pi, the section an area of pi
        integrate(&solid, BORE, 1.0, held);
        tractions(&solid, 1.0, held, second);
        return -(held[0] + (-1.0 - second[0]) / first[0] * y[0]);
    }
    for (int i = 0; i < 2; i++) {
        start_free(&solid, ends[i]);
        integrate(&solid, BORE, 1.0, ends[i]);
    }
    return -combine(&solid, ends);
}

// What both bodies do under a harmonic.
static double whole(const Eye *eye, size_t n)
{
    return eye->hole_share * eye_truth_ring(n, eye->hole_ratio, eye->outer) +
           (1.0 - eye->hole_share) * eye_truth_pin(n, eye->pin_ratio);
}

// What a half plane lacks of an infinite plate with a hole, and of a pin, under harmonics: D.
static double difference(const Eye *eye)
{
    return eye->hole_share * (1.0 - 2.0 * eye->hole_ratio) / (1.0 - eye->hole_ratio) -
           (1.0 - eye->hole_share) * (1.0 - 2.0 * eye->pin_ratio) / (1.0 - eye->pin_ratio);
}

typedef struct Panels {
    size_t count;
    double *edges; // count + 1
    double rest[HARMONICS];
    size_t rest_count;
    double difference;
} Panels;

static void find_rest(const Eye *eye, Panels *panels)
{
    panels->difference = difference(eye);
    panels->rest_count = 0;
    for (size_t n = 0; n < HARMONICS; n++) {
        const double own = (double)(n * n) - 1.0;
        const double rest =
            whole(eye, n) - (n < 2 ? 0.0 : (2.0 * (double)n + panels->difference) / own);
        panels->rest[panels->rest_count++] = rest;
        if (n > 4 && (double)(n * n) * pow(eye->outer, -2.0 * (double)n) < 1e-10) {
            break;
        }
    }
}

// The smooth part of the kernel at an angle between pressure and place, and what of the rest stays
// smooth once ln|u| is taken out of it.
static double smooth_kernel(const Panels *panels, double u)
{
    const double size = fabs(u);
    const double half = sin(0.5 * u);
    const double chord = size > 1e-8 ? log(2.0 * fabs(half) / size) : 0.0;
    const double beside = size > 1e-12 ? 4.0 * half * half * log(size) : 0.0;
    return -2.0 * cos(u) * chord + beside - 1.0 - 0.5 * cos(u) +
           panels->difference * (0.5 + 0.25 * cos(u) - 0.5 * (PI - size) * sin(size));
}

static double log_integral(double u)
{
    return u == 0.0 ? 0.0 : u * log(fabs(u)) - u;
}

// The kernel's integral over angles from `low` to `high` about a place at 0.
static double kernel_integral(const Panels *panels, double low, double high)
{
    static const double AT[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
    static const double WEIGHT[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    if (low < 0.0 && high > 0.0) {
        return kernel_integral(panels, low, 0.0) + kernel_integral(panels, 0.0, high);
    }
    double sum = -2.0 * (log_integral(high) - log_integral(low));
    for (int i = 0; i < 3; i++) {
        const double u = 0.5 * (low + high + AT[i] * (high - low));
        sum += 0.5 * WEIGHT[i] * (high - low) * smooth_kernel(panels, u);
    }
    return sum;
}

// What a pressure of 1 on a panel and on its mirror image moves at a place.
static double influence(const Panels *panels, double place, size_t panel)
{
    const double low = panels->edges[panel];
    const double high = panels->edges[panel + 1];
    double sum = kernel_integral(panels, low - place, high - place) +
                 kernel_integral(panels, low + place, high + place);
    for (size_t n = 0; n < panels->rest_count; n++) {
        const double reach = n == 0 ? 0.5 * (high - low)
                                    : (sin((double)n * high) - sin((double)n * low)) / (double)n;
        sum += 2.0 * panels->rest[n] * reach * cos((double)n * place);
    }
    return sum / PI;
}

double eye_truth_force(const Eye *eye, double approach, double widest, size_t count,
                       double *touching)
{
    Panels panels = {.count = count, .edges = zeroed(count + 1, sizeof(double))};
    find_rest(eye, &panels);
    for (size_t i = 0; i <= count; i++) {
        panels.edges[i] = widest * sin(0.5 * PI * (double)i / (double)count);
    }
    double *whole_matrix = zeroed(count * count, sizeof *whole_matrix);
    double *matrix = zeroed(count * count, sizeof *matrix);
    double *pressures = zeroed(count, sizeof *pressures);
    for (size_t i = 0; i < count; i++) {
        const double place = 0.5 * (panels.edges[i] + panels.edges[i + 1]);
        for (size_t j = 0; j < count; j++) {
            whole_matrix[i * count + j] = influence(&panels, place, j);
        }
    }
    size_t pressing = count;
    for (size_t before = 0; pressing != before;) {
        before = pressing;
        for (size_t i = 0; i < pressing; i++) {
            const double place = 0.5 * (panels.edges[i] + panels.edges[i + 1]);
            const double half = sin(0.5 * place);
            memcpy(matrix + i * pressing, whole_matrix + i * count, pressing * sizeof *matrix);
            pressures[i] = approach * cos(place) - 2.0 * half * half;
        }
        if (!dense_solve(pressing, matrix, pressures)) {
            break;
        }
        while (pressing > 1 && pressures[pressing - 1] < 0.0) {
            pressing--;
        }
    }
    double force = 0.0;
    for (size_t i = 0; i < pressing; i++) {
        force += 2.0 * pressures[i] * (sin(panels.edges[i + 1]) - sin(panels.edges[i]));
    }
    *touching = panels.edges[pressing];
    free(whole_matrix);
    free(matrix);
    free(pressures);
    free(panels.edges);
    return force;
}
