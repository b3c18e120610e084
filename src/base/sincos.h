// Sine and cosine of an angle that may have gone round many times, in long double.
//
// The library takes a thousand instructions to bring such an angle to the first eighth of a turn,
// whatever its size. Quarters of a turn are taken off here in two parts (Cody and Waite 1980): the
// first has so few digits that its multiples are exact. What is left is a / 16 + r, |r| <= 1/32:
//     sin = sin(a/16) cos r + cos(a/16) sin r,  cos = cos(a/16) cos r - sin(a/16) sin r
// with the first factors from a table and series that leave out r^11 / 11! and r^10 / 10!, below
// 3e-22; in a fifth of the library's time.
#pragma once

#include <math.h>

// Beyond so many quarters the multiples are no longer exact; they are left to the library.
static const long double SINCOS_QUARTERS_MOST = 0x1p22L;

// Sine and cosine of sixteenths, from 128-bit arithmetic, rounded.
// clang-format off
static const long double SINCOS_SIXTEENTHS[][2] = {
    {0x0p+0L, 0x8p-3L},
    {0xf.fd557776a76d5a6p-8L, 0xf.f800aaa4fa69a65p-4L},
    {0xf.f5577743771ae5p-7L, 0xf.e00aa93eade9b6dp-4L},
    {0xb.ee0817dd795a8adp-6L, 0xf.b835efcf670dd2dp-4L},
    {0xf.d5776a798abb5d4p-6L, 0xf.80aa4fbef750ba8p-4L},
    {0x9.d6894bb4e9ec004p-5L, 0xf.399f500c9e9fd38p-4L},
    {0xb.b8812abb2109e91p-5L, 0xe.e35bf5ccac89053p-4L},
    {0xd.8ec182990b0b4a4p-5L, 0xe.7e367d2956cfb17p-4L},
    {0xf.57743a2582f7f44p-5L, 0xe.0a94032dbea7ceep-4L},
    {0x8.8868625b4e1dbb2p-4L, 0xd.88e820b1526311ep-4L},
    {0x9.5c8ef544210ec0cp-4L, 0xc.f9b476c897c25c6p-4L},
    {0xa.2759c0e79c35582p-4L, 0xc.5d882d2ee48030cp-4L},
    {0xa.e7fe0b5fc786b2ep-4L, 0xb.b4ff632a908f73fp-4L},
    {0xb.9dbb406f52bbedep-4L, 0xb.00c2937ab1efa8ep-4L},
};
// clang-format on

// Of an angle of at most an eighth of a turn, and a little more, to either side.
static inline void sincos_of_rest(long double angle, long double *sine, long double *cosine)
{
    const long double size = fabsl(angle);
    const int number = (int)(16.0L * size + 0.5L);
    const long double r = size - (long double)number * 0x1p-4L; // exact
    const long double e = r * r;
    const long double third =
        1.0L / 6.0L - e * (1.0L / 120.0L - e * (1.0L / 5040.0L - e / 362880.0L));
    const long double s = r - r * e * third;
    // 1 - cos r
    const long double c = e * (0.5L - e * (1.0L / 24.0L - e * (1.0L / 720.0L - e / 40320.0L)));
    const long double *at = SINCOS_SIXTEENTHS[number];
    const long double found = at[0] + (at[1] * s - at[0] * c);
    *sine = angle < 0.0L ? -found : found;
    *cosine = at[1] - (at[0] * s + at[1] * c);
}

static inline void sincos_find(long double angle, long double *sine, long double *cosine)
{
    // pi / 2, its first 41 bits and the next 64
    const long double high = 0x1.921fb54442p+0L;
    const long double low = 0x1.a308d313198a2e03707344a4p-41L;
    const long double quarters = rintl(angle * 0x1.45f306dc9c882a54p-1L); // 2 / pi
    if (!(fabsl(quarters) < SINCOS_QUARTERS_MOST)) {
        *sine = sinl(angle);
        *cosine = cosl(angle);
        return;
    }
    long double s;
    long double c;
    sincos_of_rest((angle - quarters * high) - quarters * low, &s, &c);
    switch ((long)quarters & 3) {
    case 0:
        *sine = s;
        *cosine = c;
        break;
    case 1:
        *sine = c;
        *cosine = -s;
        break;
    case 2:
        *sine = -s;
        *cosine = -c;
        break;
    default:
        *sine = -c;
        *cosine = s;
        break;
    }
}
