// Vectors, matrices and rotations in space.
#pragma once

#include <math.h>

typedef struct Vec3 {
    double x;
    double y;
    double z;
} Vec3;

typedef struct Mat3 {
    Vec3 row[3];
} Mat3;

// A rotation: a quaternion of length 1.
typedef struct Quat {
    double w;
    double x;
    double y;
    double z;
} Quat;

static inline Vec3 vec3_add(Vec3 a, Vec3 b)
{
    return (Vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline Vec3 vec3_sub(Vec3 a, Vec3 b)
{
    return (Vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline Vec3 vec3_scale(double factor, Vec3 a)
{
    return (Vec3){factor * a.x, factor * a.y, factor * a.z};
}

static inline double vec3_dot(Vec3 a, Vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline Vec3 vec3_cross(Vec3 a, Vec3 b)
{
    return (Vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double vec3_length(Vec3 a)
{
    return sqrt(vec3_dot(a, a));
}

// The part of a vector at right angles to a unit vector.
static inline Vec3 vec3_across(Vec3 a, Vec3 unit)
{
    return vec3_sub(a, vec3_scale(vec3_dot(a, unit), unit));
}

// A unit vector at right angles to a unit vector: the world's axis x, or y where x is near to it,
// turned into its normal plane. Of z and all around it that is x.
static inline Vec3 vec3_normal_to(Vec3 unit)
{
    const Vec3 axis = fabs(unit.x) < 0.75 ? (Vec3){1.0, 0.0, 0.0} : (Vec3){0.0, 1.0, 0.0};
    const Vec3 across = vec3_across(axis, unit);
    return vec3_scale(1.0 / vec3_length(across), across);
}

static inline Vec3 mat3_apply(const Mat3 *m, Vec3 a)
{
    return (Vec3){vec3_dot(m->row[0], a), vec3_dot(m->row[1], a), vec3_dot(m->row[2], a)};
}

// The transposed matrix times a vector: of a rotation, back.
static inline Vec3 mat3_apply_back(const Mat3 *m, Vec3 a)
{
    return vec3_add(vec3_scale(a.x, m->row[0]),
                    vec3_add(vec3_scale(a.y, m->row[1]), vec3_scale(a.z, m->row[2])));
}

// The inverse of a matrix that has one.
static inline Mat3 mat3_inverse(const Mat3 *m)
{
    const Vec3 *r = m->row;
    const Vec3 a = vec3_cross(r[1], r[2]);
    const Vec3 b = vec3_cross(r[2], r[0]);
    const Vec3 c = vec3_cross(r[0], r[1]);
    const double scale = 1.0 / vec3_dot(r[0], a);
    // the columns of the inverse
    return (Mat3){{{scale * a.x, scale * b.x, scale * c.x},
                   {scale * a.y, scale * b.y, scale * c.y},
                   {scale * a.z, scale * b.z, scale * c.z}}};
}

static inline Quat quat_product(Quat a, Quat b)
{
    return (Quat){
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    };
}

static inline Quat quat_unit(Quat a)
{
    const double scale = 1.0 / sqrt(a.w * a.w + a.x * a.x + a.y * a.y + a.z * a.z);
    return (Quat){scale * a.w, scale * a.x, scale * a.y, scale * a.z};
}

// The rotation by a vector: about its direction, by its length, rad.
static inline Quat quat_of_turn(Vec3 turn)
{
    const double square = vec3_dot(turn, turn);
    double cosine;
    double share; // sin(angle / 2) / angle
    if (square < 1e-4) {
        // what is left of the series is below the last bit
        cosine = 1.0 - square * (1.0 / 8.0 - square * (1.0 / 384.0 - square / 46080.0));
        share = 0.5 - square * (1.0 / 48.0 - square / 3840.0);
    } else {
        const double angle = sqrt(square);
        cosine = cos(0.5 * angle);
        share = sin(0.5 * angle) / angle;
    }
    return (Quat){cosine, share * turn.x, share * turn.y, share * turn.z};
}

static inline Vec3 quat_turn_between(Quat from, Quat to)
{
    const Quat back = {from.w, -from.x, -from.y, -from.z};
    const Quat turn = quat_product(to, back);
    const double sine = sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
    // the angle over the sine of its half, which tends to 2
    const double sign = turn.w < 0.0 ? -1.0 : 1.0;
    const double scale = sine > 0.0 ? 2.0 * sign * atan2(sine, sign * turn.w) / sine : 2.0 * sign;
    return (Vec3){scale * turn.x, scale * turn.y, scale * turn.z};
}

static inline Mat3 quat_matrix(Quat q)
{
    return (Mat3){{
        {1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y - q.w * q.z),
         2.0 * (q.x * q.z + q.w * q.y)},
        {2.0 * (q.x * q.y + q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z),
         2.0 * (q.y * q.z - q.w * q.x)},
        {2.0 * (q.x * q.z - q.w * q.y), 2.0 * (q.y * q.z + q.w * q.x),
         1.0 - 2.0 * (q.x * q.x + q.y * q.y)},
    }};
}

static inline Vec3 quat_rotate(Quat q, Vec3 a)
{
    const Mat3 m = quat_matrix(q);
    return mat3_apply(&m, a);
}

static inline Vec3 quat_rotate_back(Quat q, Vec3 a)
{
    const Mat3 m = quat_matrix(q);
    return mat3_apply_back(&m, a);
}
