// Finds where the teeth of a pair of gears stand and how their flanks come nearer.
#include "model/mesh.h"

#include <math.h>

double mesh_position(const Gear *gear, Vec2 offset, double angle_a, double angle_b, double near)
{
    const double psi = atan2(offset.y, offset.x);
    const double position = -(gear->radius_a * (angle_a - psi) + gear->radius_b * (angle_b - psi));
    return near + remainder(position - near, 2.0 * M_PI * mesh_distance(gear));
}

double mesh_position_rate(const Gear *gear, Vec2 offset, Vec2 velocity, double omega_a,
                          double omega_b)
{
    const double psi = vec2_cross(offset, velocity) / vec2_dot(offset, offset);
    return mesh_distance(gear) * psi - gear->radius_a * omega_a - gear->radius_b * omega_b;
}

double mesh_slant(const Gear *gear)
{
    return gear->pressure_angle == 0.0 ? 1.0 : cos(gear->pressure_angle);
}

// e of the formulas.
static double outwards(const Gear *gear)
{
    const double external = gear->radius_a * gear->radius_b > 0.0 ? 1.0 : -1.0;
    return gear->pressure_angle == 0.0 ? 0.0 : external;
}

// The sine of the working pressure angle at a distance of the centres, from its cosine; 0 nearer
// than the base circles let the gears come.
static double sine_of(double cosine)
{
    return sqrt(fmax(0.0, (1.0 - cosine) * (1.0 + cosine)));
}

double mesh_spread(const Gear *gear, double apart)
{
    // Gauss's rule of five points
    static const double NODES[] = {-0.9061798459386640, -0.5384693101056831, 0.0,
                                   0.5384693101056831, 0.9061798459386640};
    static const double WEIGHTS[] = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                     0.2393143352496832, 0.1184634425280945};
    // of the way to where base circles would not let the gears come: up to there the rule is right
    // to 1e-16
    static const double NEAR = 0.1;
    const double e = outwards(gear);
    if (e == 0.0) {
        return 0.0;
    }
    const double pitch = mesh_distance(gear);
    const double base = pitch * mesh_slant(gear);
    if (fabs(apart) > NEAR * (pitch - base)) {
        const double alpha = gear->pressure_angle;
        const double working = acos(fmin(1.0, base / (pitch + apart)));
        return e * base * ((tan(working) - working) - (tan(alpha) - alpha));
    }
    // the spread grows by sin alpha_w with the distance
    double mean = 0.0;
    for (int i = 0; i < 5; i++) {
        mean += WEIGHTS[i] * sine_of(base / (pitch + 0.5 * apart * (1.0 + NODES[i])));
    }
    return e * mean * apart;
}

Vec2 mesh_normal(const Gear *gear, double sign, Vec2 offset)
{
    const double distance = vec2_length(offset);
    const Vec2 outward = vec2_scale(1.0 / distance, offset);
    const double e = outwards(gear);
    const double cosine = e == 0.0 ? 1.0 : mesh_distance(gear) * mesh_slant(gear) / distance;
    return vec2_add(vec2_scale(sign * cosine, vec2_perp(outward)),
                    vec2_scale(e * sine_of(cosine), outward));
}

double mesh_gap_rate(const Gear *gear, double sign, Vec2 offset, Vec2 velocity, double omega_a,
                     double omega_b)
{
    return vec2_dot(mesh_normal(gear, sign, offset), velocity) -
           sign * mesh_slant(gear) * (gear->radius_a * omega_a + gear->radius_b * omega_b);
}

double mesh_bend(const Gear *gear, double sign, Vec2 offset, Vec2 velocity)
{
    const double distance = vec2_length(offset);
    const double e = outwards(gear);
    const double cosine = e == 0.0 ? 1.0 : mesh_distance(gear) * mesh_slant(gear) / distance;
    const double sine = sine_of(cosine);
    const double parting = vec2_dot(offset, velocity) / distance;
    const double turning = vec2_cross(offset, velocity) / (distance * distance);
    const double tangential = -2.0 * sign * cosine * turning * parting;
    return e == 0.0 ? tangential
                    : tangential + e * (sine * distance * turning * turning +
                                        cosine * cosine * parting * parting / (distance * sine));
}
