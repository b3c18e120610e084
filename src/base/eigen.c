// Finds eigenvalues and vectors of small dense matrices that need not be symmetric.
//
// Rows and columns are first scaled by powers of two until they are of one size (balancing; B. N.
// Parlett, C. Reinsch, Numer. Math. 13 (1969) 293), then plane rotations make the matrix one of
// Hessenberg, zero below the first subdiagonal. Shifted QR steps, A - s 1 = Q R and then
// A = R Q + s 1 in complex numbers, bring the last entry of that subdiagonal to zero, with the
// shift s the eigenvalue of the last two by two that is nearer to the last entry (J. H. Wilkinson,
// The algebraic eigenvalue problem, 1965). A vector is found by inverse iteration.
#include "base/eigen.h"

#include "base/zeroed.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { QR_STEPS = 60, QR_UNUSUAL = 10, BALANCE_PASSES = 20, INVERSE_STEPS = 3 };

// 1: of its neighbours on the diagonal, an entry below it that is zero to rounding
static const double SPLIT = 0x1p-52;

// 1: of the largest, how far above the real axis one is that is real but for rounding
static const double REAL = 0x1p-44;

// 1: how far beside the eigenvalue a vector is looked for, of the matrix's size
static const double BESIDE = 1e-13;

// Balances A in place. Eigenvalues stay what they are.
static void balance(size_t n, double complex *a)
{
    bool is_balanced = false;
    for (int pass = 0; !is_balanced && pass < BALANCE_PASSES; pass++) {
        is_balanced = true;
        for (size_t i = 0; i < n; i++) {
            double row = 0.0;
            double column = 0.0;
            for (size_t k = 0; k < n; k++) {
                row += k == i ? 0.0 : cabs(a[i * n + k]);
                column += k == i ? 0.0 : cabs(a[k * n + i]);
            }
            if (!(row > 0.0) || !(column > 0.0)) {
                continue;
            }
            const double factor = exp2(round(0.5 * log2(row / column)));
            if (factor == 1.0) {
                continue;
            }
            is_balanced = false;
            for (size_t k = 0; k < n; k++) {
                a[i * n + k] /= factor;
                a[k * n + i] *= factor;
            }
        }
    }
}

// The rotation that takes (x, y) to (r, 0): [c, s; -conj(s), c] with a real c.
static void rotation_of(double complex x, double complex y, double *c, double complex *s)
{
    const double size = hypot(cabs(x), cabs(y));
    if (cabs(y) == 0.0) {
        *c = 1.0;
        *s = 0.0;
    } else if (cabs(x) == 0.0) {
        *c = 0.0;
        *s = conj(y) / cabs(y);
    } else {
        *c = cabs(x) / size;
        *s = x / cabs(x) * conj(y) / size;
    }
}

// Turns rows i and k in the columns from a first one on.
static void turn_rows(size_t n, double complex *a, size_t i, size_t k, size_t first, double c,
                      double complex s)
{
    for (size_t j = first; j < n; j++) {
        const double complex x = a[i * n + j];
        const double complex y = a[k * n + j];
        a[i * n + j] = c * x + s * y;
        a[k * n + j] = c * y - conj(s) * x;
    }
}

// Turns columns i and k in the rows before one, by the inverse of the same.
static void turn_columns(size_t n, double complex *a, size_t i, size_t k, size_t end, double c,
                         double complex s)
{
    for (size_t j = 0; j < end; j++) {
        const double complex x = a[j * n + i];
        const double complex y = a[j * n + k];
        a[j * n + i] = c * x + conj(s) * y;
        a[j * n + k] = c * y - s * x;
    }
}

static void make_hessenberg(size_t n, double complex *a)
{
    for (size_t j = 0; j + 2 < n; j++) {
        for (size_t i = j + 2; i < n; i++) {
            double c;
            double complex s;
            rotation_of(a[(j + 1) * n + j], a[i * n + j], &c, &s);
            turn_rows(n, a, j + 1, i, 0, c, s);
            turn_columns(n, a, j + 1, i, n, c, s);
        }
    }
}

// The eigenvalue of the last two by two that is nearer to the last entry.
static double complex shift_of(size_t n, const double complex *a, size_t last)
{
    const double complex d = a[last * n + last];
    const double complex half = 0.5 * (a[(last - 1) * n + last - 1] - d);
    const double complex root =
        csqrt(half * half + a[(last - 1) * n + last] * a[last * n + last - 1]);
    const double complex one = half + root;
    const double complex other = half - root;
    return d + (cabs(one) < cabs(other) ? one : other);
}

// One QR step of the rows and columns from `first` to `last`, whose eigenvalues the rest has no
// part in. Rotations of rows come before those of columns that they share.
static void qr_step(size_t n, double complex *a, size_t first, size_t last, double complex shift)
{
    double c[2] = {1.0, 1.0};
    double complex s[2] = {0.0, 0.0};
    for (size_t i = first; i <= last; i++) {
        a[i * n + i] -= shift;
    }
    for (size_t i = first; i < last; i++) {
        c[0] = c[1];
        s[0] = s[1];
        rotation_of(a[i * n + i], a[(i + 1) * n + i], &c[1], &s[1]);
        turn_rows(n, a, i, i + 1, i, c[1], s[1]);
        if (i > first) {
            turn_columns(n, a, i - 1, i, i + 1, c[0], s[0]);
        }
    }
    turn_columns(n, a, last - 1, last, last + 1, c[1], s[1]);
    for (size_t i = first; i <= last; i++) {
        a[i * n + i] += shift;
    }
}

// Those that are real but for rounding are made so.
static void make_real(size_t n, double complex *values)
{
    double largest = 0.0;
    for (size_t i = 0; i < n; i++) {
        largest = fmax(largest, cabs(values[i]));
    }
    for (size_t i = 0; i < n; i++) {
        if (fabs(cimag(values[i])) <= REAL * largest) {
            values[i] = creal(values[i]);
        }
    }
}

static int compare_sizes(const void *left, const void *right)
{
    const double complex a = *(const double complex *)left;
    const double complex b = *(const double complex *)right;
    const double sizes = cabs(b) - cabs(a);
    // of a pair of conjugate ones sizes differ by rounding
    if (fabs(sizes) > 64.0 * DBL_EPSILON * cabs(a)) {
        return sizes > 0.0 ? 1 : -1;
    }
    return (cimag(a) < cimag(b)) - (cimag(a) > cimag(b));
}

bool eigen_values(size_t n, const double *a, double complex *values)
{
    double complex *own = zeroed(n * n + 1, sizeof *own);
    bool is_found = true;
    for (size_t i = 0; i < n * n; i++) {
        own[i] = a[i];
        is_found = is_found && isfinite(a[i]);
    }
    balance(is_found ? n : 0, own);
    make_hessenberg(is_found ? n : 0, own);
    size_t left = n;
    for (int step = 0; is_found && left > 0;) {
        size_t first = left - 1;
        while (first > 0 && cabs(own[first * n + first - 1]) >
                                SPLIT * (cabs(own[first * n + first]) +
                                         cabs(own[(first - 1) * n + first - 1]))) {
            first--;
        }
        if (first == left - 1) {
            left--;
            values[left] = own[left * n + left];
            step = 0;
            continue;
        }
        // a cycle of steps ends where one has another shift
        const bool is_unusual = step % QR_UNUSUAL == QR_UNUSUAL - 1;
        const double complex shift =
            is_unusual ? cabs(own[(left - 1) * n + left - 2]) : shift_of(n, own, left - 1);
        qr_step(n, own, first, left - 1, shift);
        is_found = ++step < QR_STEPS;
    }
    free(own);
    if (is_found) {
        make_real(n, values);
        qsort(values, n, sizeof *values, compare_sizes);
    }
    return is_found;
}

// Solves A x = b in place by elimination with pivots; one that is zero counts as the least.
static void solve_nearly_singular(size_t n, double complex *a, double least, double complex *b)
{
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++) {
            pivot = cabs(a[i * n + k]) > cabs(a[pivot * n + k]) ? i : pivot;
        }
        for (size_t j = 0; j < n && pivot != k; j++) {
            const double complex kept = a[k * n + j];
            a[k * n + j] = a[pivot * n + j];
            a[pivot * n + j] = kept;
        }
        const double complex kept = b[k];
        b[k] = b[pivot];
        b[pivot] = kept;
        if (cabs(a[k * n + k]) < least) {
            a[k * n + k] = least;
        }
        for (size_t i = k + 1; i < n; i++) {
            const double complex factor = a[i * n + k] / a[k * n + k];
            for (size_t j = k; j < n; j++) {
                a[i * n + j] -= factor * a[k * n + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = k + 1; j < n; j++) {
            b[k] -= a[k * n + j] * b[j];
        }
        b[k] /= a[k * n + k];
    }
}

// Makes a vector one of length 1; false where it has none.
static bool make_unit(size_t n, double complex *x)
{
    double square = 0.0;
    for (size_t i = 0; i < n; i++) {
        square += creal(x[i] * conj(x[i]));
    }
    for (size_t i = 0; i < n; i++) {
        x[i] /= sqrt(square);
    }
    return square > 0.0 && isfinite(square);
}

bool eigen_vector(size_t n, const double *a, double complex value, bool is_left, double complex *x)
{
    double size = 0.0;
    for (size_t i = 0; i < n * n; i++) {
        size = fmax(size, fabs(a[i]));
    }
    size = size > 0.0 ? size : 1.0;
    double complex *own = zeroed(n * n + 1, sizeof *own);
    bool is_found = true;
    for (size_t i = 0; i < n; i++) {
        x[i] = 1.0 + (double)i / (double)n; // at right angles to no vector but by chance
    }
    for (int step = 0; is_found && step < INVERSE_STEPS; step++) {
        for (size_t i = 0; i < n; i++) {
            for (size_t k = 0; k < n; k++) {
                own[i * n + k] = is_left ? a[k * n + i] : a[i * n + k];
            }
            own[i * n + i] -= value + BESIDE * size;
        }
        solve_nearly_singular(n, own, DBL_EPSILON * BESIDE * size, x);
        is_found = make_unit(n, x);
    }
    free(own);
    return is_found;
}
