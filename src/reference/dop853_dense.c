// Where is the motion within a step?
//
// On the polynomial through it (dop853_fill), of degree 7 or that of another method.
#include "reference/dop853.h"

typedef Dop853Pair Pair;

// Of two equations from one on.
static inline Pair polynomial_pair(const Dop853 *integrator, Pair s, Pair r, size_t i)
{
    Pair p[DOP853_POLYNOMIAL];
    for (int k = 0; k < DOP853_POLYNOMIAL; k++) {
        p[k] = *(const Pair *)(integrator->polynomial[k] + i);
    }
    const Pair high = p[4] + s * (p[5] + r * (p[6] + s * p[7]));
    return p[0] + s * (p[1] + r * (p[2] + s * (p[3] + r * high)));
}

// Of the first equations.
static void find_polynomial(const Dop853 *integrator, double share, size_t count, double *y)
{
    const Pair s = {share, share};
    const Pair r = {1.0 - share, 1.0 - share};
    size_t i = 0;
    for (; i + 1 < count; i += 2) {
        const Pair at = polynomial_pair(integrator, s, r, i);
        y[i] = at[0];
        y[i + 1] = at[1];
    }
    if (i < count) {
        y[i] = polynomial_pair(integrator, s, r, i)[0];
    }
}

void dop853_polynomial(const Dop853 *integrator, double share, double *y)
{
    find_polynomial(integrator, share, integrator->size, y);
}

// The share of the tried step that lies before a time, with the polynomial through it.
static double fill_share(Dop853 *integrator, double time)
{
    dop853_fill(integrator);
    // a step cut to nothing by an event at its start is a point
    const double tried = integrator->tried;
    return tried != 0.0 ? (time - integrator->time) / tried : 0.0;
}

void dop853_dense_all(Dop853 *integrator, double time, double *y)
{
    dop853_polynomial(integrator, fill_share(integrator, time), y);
}

const double *dop853_dense(Dop853 *integrator, double time)
{
    dop853_dense_all(integrator, time, integrator->at);
    return integrator->at;
}

const double *dop853_dense_some(Dop853 *integrator, double time, const size_t *numbers,
                                size_t count)
{
    const double share = fill_share(integrator, time);
    const Pair s = {share, share};
    const Pair r = {1.0 - share, 1.0 - share};
    for (size_t k = 0; k < count; k++) {
        const size_t other = numbers[k] % 2;
        const Pair at = polynomial_pair(integrator, s, r, numbers[k] - other);
        integrator->at[numbers[k]] = at[other];
    }
    return integrator->at;
}

void dop853_dense_motion(Dop853 *integrator, double time, double *y)
{
    find_polynomial(integrator, fill_share(integrator, time), integrator->motion_size, y);
}
