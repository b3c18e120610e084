// Finds where the teeth of a pair of gears stand and how their flanks come nearer.
#include "base/mesh.h"

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
    const double turning = vec2_cross(offset, velocity) / vec2_dot(offset, offset);
    return mesh_distance(gear) * turning - gear->radius_a * omega_a - gear->radius_b * omega_b;
}

// e of the formulas.
static double outwards(const Gear *gear)
{
    const double external = gear->radius_a * gear->radius_b > 0.0 ? 1.0 : -1.0;
    return gear->pressure_angle == 0.0 ? 0.0 : external;
}

// The sine of the working pressure angle from its cosine; 0 nearer than the base circles let the
// gears come.
static double sine_of(double cosine)
{
    return sqrt(fmax(0.0, (1.0 - cosine) * (1.0 + cosine)));
}

// Makes a flank stand out by what a table has over the angle of the first gear, times a factor.
static void stand_out(const Profile *table, double factor, double share, double turned,
                      MeshFlank *flank)
{
    if (table == NULL) {
        return;
    }
    const ProfileAt at = profile_at(table, turned);
    const double slope = factor * share * at.r1;
    flank->stands_out += factor * at.r;
    flank->bend += factor * share * share * at.r2;
    flank->arms[0] += flank->sign * slope;
    flank->arms[1] -= flank->sign * slope;
    flank->from_b = vec2_sub(flank->from_b, vec2_scale(slope, vec2_perp(flank->normal)));
}

MeshFlank mesh_flank(const Mesh *mesh, double sign, Vec2 offset, double angle_a, double angle_b)
{
    const Gear *gear = mesh->gear;
    const double slant = gear->pressure_angle == 0.0 ? 1.0 : cos(gear->pressure_angle);
    const double pitch = mesh_distance(gear);
    const double distance = vec2_length(offset);
    const double e = outwards(gear);
    const Vec2 outward = vec2_scale(1.0 / distance, offset);
    MeshFlank flank = {
        .sign = sign,
        .offset = offset,
        .slant = slant,
        .arms = {slant * gear->radius_a, slant * gear->radius_b},
        .cosine = e == 0.0 ? 1.0 : pitch * slant / distance,
    };
    flank.sine = e == 0.0 ? 0.0 : e * sine_of(flank.cosine);
    flank.normal = vec2_add(vec2_scale(sign * flank.cosine, vec2_perp(outward)),
                            vec2_scale(flank.sine, outward));
    flank.from_b = vec2_scale(-gear->radius_b / pitch, offset);
    const double share = gear->radius_b / pitch;
    const double turned = share * (angle_a - angle_b) - gear->zero;
    stand_out(mesh->error, sign, share, turned, &flank);
    stand_out(mesh->relief, -1.0, share, turned, &flank);
    return flank;
}

double mesh_rate(const MeshFlank *flank, Vec2 velocity, double omega_a, double omega_b)
{
    return vec2_dot(flank->normal, velocity) -
           flank->sign * (flank->arms[0] * omega_a + flank->arms[1] * omega_b);
}

double mesh_bend(const MeshFlank *flank, Vec2 velocity, double omega_a, double omega_b)
{
    const double distance = vec2_length(flank->offset);
    const double parting = vec2_dot(flank->offset, velocity) / distance;
    const double turning = vec2_cross(flank->offset, velocity) / (distance * distance);
    const double turned = omega_a - omega_b;
    double bend = -2.0 * flank->sign * flank->cosine * turning * parting;
    if (flank->sine != 0.0) {
        bend += flank->sine * distance * turning * turning +
                flank->cosine * flank->cosine * parting * parting / (distance * flank->sine);
    }
    return bend - flank->bend * turned * turned;
}

// By how much the flanks are further from each other, m along the line of action, with the centres
// so much further apart than the pitch circles have them, with its digits.
static double spread_of(const Gear *gear, double slant, double apart)
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
    const double base = pitch * slant;
    if (fabs(apart) > NEAR * (pitch - base)) {
        const double alpha = gear->pressure_angle;
        const double working = acos(fmin(1.0, base / (pitch + apart)));
        return e * base * ((tan(working) - working) - (tan(alpha) - alpha));
    }
    // it grows by sin alpha_w with the distance
    double mean = 0.0;
    for (int i = 0; i < 5; i++) {
        mean += WEIGHTS[i] * sine_of(base / (pitch + 0.5 * apart * (1.0 + NODES[i])));
    }
    return e * mean * apart;
}

double mesh_gap(const Gear *gear, const MeshFlank *flank, double beyond, double apart)
{
    return flank->slant * beyond - flank->stands_out + spread_of(gear, flank->slant, apart);
}
