// Sine and cosine of an angle that may have gone round many times, in long double.
//
// The library takes a thousand instructions to bring such an angle to the first eighth of a turn,
// whatever its size. Quarters of a turn are taken off here in two parts (Cody and Waite 1980): the
// first has so few digits that its multiples are exact.
#pragma once

#include <math.h>

// Beyond so many quarters the multiples are no longer exact; they are left to the library.
static const long double SINCOS_QUARTERS_MOST = 0x1p22L;

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
    const long double rest = (angle - quarters * high) - quarters * low;
    const long double s = sinl(rest);
    const long double c = cosl(rest);
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
