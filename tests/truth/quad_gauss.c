// With what weights do values at Gauss's nodes make an integral?
//
// Nodes: the roots of Legendre's polynomial P_N(2 x - 1), by Newton's method from the usual
// cosines. With xi = 2 x - 1, w_j = 1 / ((1 - xi_j^2) P_N'(xi_j)^2) on [0, 1]; the polynomial
// through values v_j has the coefficients c_m = (2 m + 1) sum_j w_j P_m(xi_j) v_j, and
//     integral of P_m(2 u - 1) du from 0 to x = (P_{m+1}(xi) - P_{m-1}(xi)) / (2 (2 m + 1)).
#include "quad_gauss.h"

#include <math.h>

enum { NEWTON_COUNT = 8 };

// P_0 to P_N at xi.
static void legendre_values(__float128 xi, __float128 *values)
{
    values[0] = 1;
    values[1] = xi;
    for (int m = 1; m < QUAD_GAUSS_NODES; m++) {
        values[m + 1] = ((2 * m + 1) * xi * values[m] - m * values[m - 1]) / (m + 1);
    }
}

void quad_gauss_weights(const QuadGauss *gauss, __float128 x, __float128 *weights)
{
    __float128 values[QUAD_GAUSS_NODES + 1];
    legendre_values(2 * x - 1, values);
    __float128 integrals[QUAD_GAUSS_NODES];
    integrals[0] = x;
    for (int m = 1; m < QUAD_GAUSS_NODES; m++) {
        integrals[m] = (values[m + 1] - values[m - 1]) / (2 * (2 * m + 1));
    }
    for (int j = 0; j < QUAD_GAUSS_NODES; j++) {
        weights[j] = 0;
        for (int m = 0; m < QUAD_GAUSS_NODES; m++) {
            weights[j] += integrals[m] * gauss->legendre[m][j];
        }
    }
}

void quad_gauss_init(QuadGauss *gauss)
{
    const int n = QUAD_GAUSS_NODES;
    __float128 values[QUAD_GAUSS_NODES + 1];
    for (int j = 0; j < n; j++) {
        __float128 xi = cos(M_PI * (n - j - 0.25) / (n + 0.5));
        __float128 slope = 1;
        for (int count = 0; count < NEWTON_COUNT; count++) {
            legendre_values(xi, values);
            slope = n * (values[n - 1] - xi * values[n]) / (1 - xi * xi);
            xi -= values[n] / slope;
        }
        legendre_values(xi, values);
        slope = n * (values[n - 1] - xi * values[n]) / (1 - xi * xi);
        gauss->node[j] = (1 + xi) / 2;
        gauss->weight[j] = 1 / ((1 - xi * xi) * slope * slope);
        for (int m = 0; m < n; m++) {
            gauss->legendre[m][j] = (2 * m + 1) * gauss->weight[j] * values[m];
        }
    }
    for (int i = 0; i < n; i++) {
        quad_gauss_weights(gauss, gauss->node[i], gauss->integral[i]);
        for (int j = 0; j < n; j++) {
            gauss->short_integral[i][j] = (long double)gauss->integral[i][j];
        }
    }
}
