// Finds what a finite turn moves, and how fast.
//
// With e = |s|^2 the coefficients are power series in e:
//     c = sum (-e)^k / (2k+1)!,  a = sum (-e)^k / (2k+2)!,  b = sum (-e)^k / (2k+3)!
// The rate of omega at a steady s' is, with p = s x s' and e' = 2 s . s',
//     (da/de e') p + (db/de e') s x p + b s' x p
#include "reference/space/turn.h"

#include <math.h>

// c, a, b and the slopes of the last two by e.
typedef struct Shares {
    double c;
    double a;
    double b;
    double a_slope;
    double b_slope;
} Shares;

static Shares shares_of(double e)
{
    // from here on the closed forms lose less than a digit; below, the series ends within TERMS
    const double large = 3.0;
    enum { TERMS = 14 };
    if (e > large) {
        const double angle = sqrt(e);
        const double c = sin(angle) / angle;
        const double half = sin(0.5 * angle);
        const double a = 2.0 * half * half / e;
        const double b = (1.0 - c) / e;
        const double c_slope = 0.5 * (cos(angle) - c) / e;
        return (Shares){c, a, b, (0.5 * c - a) / e, (-c_slope - b) / e};
    }
    Shares sum = {0.0, 0.0, 0.0, 0.0, 0.0};
    // (-e)^k / (2k+1)!, and the same with k for one e: of the slope
    double term = 1.0;
    double slope = 0.0;
    for (int k = 0; k < TERMS && (k < 2 || fabs(slope) > 1e-20); k++) {
        const double second = 1.0 / (2.0 * k + 2.0);
        const double third = second / (2.0 * k + 3.0);
        sum.c += term;
        sum.a += term * second;
        sum.b += term * third;
        sum.a_slope += slope * second;
        sum.b_slope += slope * third;
        slope = -(k + 1.0) * term * third;
        term *= -e * third;
    }
    return sum;
}

// Adds factor [s] and square [s]^2 to a matrix.
static void add_cross(Vec3 s, double factor, double square, Mat3 *m)
{
    const double e = vec3_dot(s, s);
    const Vec3 f = vec3_scale(factor, s);
    const Vec3 g = vec3_scale(square, s);
    const double diagonal = -square * e;
    m->row[0].x += g.x * s.x + diagonal;
    m->row[0].y += g.x * s.y - f.z;
    m->row[0].z += g.x * s.z + f.y;
    m->row[1].x += g.y * s.x + f.z;
    m->row[1].y += g.y * s.y + diagonal;
    m->row[1].z += g.y * s.z - f.x;
    m->row[2].x += g.z * s.x - f.y;
    m->row[2].y += g.z * s.y + f.x;
    m->row[2].z += g.z * s.z + diagonal;
}

void turn_by_vector(Vec3 s, Vec3 rate, Turn *turn)
{
    const Shares shares = shares_of(vec3_dot(s, s));
    turn->moved = (Mat3){{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};
    add_cross(s, shares.c, shares.a, &turn->moved);
    // the columns of T are the rows of its transpose, in which [s] has the other sign
    Mat3 columns = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
    add_cross(s, -shares.a, shares.b, &columns);
    turn->omega = mat3_apply_back(&columns, rate);
    for (int i = 0; i < 3; i++) {
        turn->rate[i] = columns.row[i];
    }
    const Vec3 across = vec3_cross(s, rate);
    const double growth = 2.0 * vec3_dot(s, rate);
    turn->bias = vec3_add(vec3_scale(growth * shares.a_slope, across),
                          vec3_add(vec3_scale(growth * shares.b_slope, vec3_cross(s, across)),
                                   vec3_scale(shares.b, vec3_cross(rate, across))));
}

Mat3 turn_about(Vec3 unit, double angle)
{
    // the series up to 0.01 leaves out terms below 3e-21
    const double small = 0.01;
    const double e = angle * angle;
    double s =
        angle * (1.0 - e * (1.0 / 6.0) * (1.0 - e * (1.0 / 20.0) * (1.0 - e * (1.0 / 42.0))));
    double r = 0.5 * e * (1.0 - e * (1.0 / 12.0) * (1.0 - e * (1.0 / 30.0)));
    if (!(fabs(angle) <= small)) {
        s = sin(angle);
        r = 2.0 * sin(0.5 * angle) * sin(0.5 * angle);
    }
    Mat3 moved = {{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};
    add_cross(unit, s, r, &moved);
    return moved;
}
