// Finite turns since a base, without loss of digits while they are small.
//
// A turn by the vector s, about its direction by its length, is the matrix
//     R = 1 + c [s] + a [s]^2,        [s] x = s x x
// and turns with  omega = T s',  T = 1 + a [s] + b [s]^2,  c = sin|s| / |s|,
// a = (1 - cos|s|) / |s|^2,  b = (1 - c) / |s|^2.
#pragma once

#include "base/vec3.h"

typedef struct Turn {
    Mat3 moved;   // R - 1
    Vec3 rate[3]; // columns of T
    Vec3 omega;   // rad/s, T s'
    Vec3 bias;    // rad/s^2, the rate of omega while s' is steady
} Turn;

// Everything of a turn by a vector, rad, that changes at a rate, rad/s.
void turn_by_vector(Vec3 s, Vec3 rate, Turn *turn);

// R - 1 of a turn about a unit vector by an angle, rad.
Mat3 turn_about(Vec3 unit, double angle);
