// Gauss collocation on [0, 1] in quadruple precision: nodes, weights, integrals of the polynomial
// through values at the nodes.
#pragma once

#include <quadmath.h>

enum { QUAD_GAUSS_NODES = 20 };

typedef struct QuadGauss {
    __float128 node[QUAD_GAUSS_NODES];
    __float128 weight[QUAD_GAUSS_NODES]; // their sum is 1
    // [m][j]: Legendre coefficient m of the polynomial through values v_j is sum_j of v_j times it
    __float128 legendre[QUAD_GAUSS_NODES][QUAD_GAUSS_NODES];
    // [i][j]: the integral from 0 to node i is sum_j of v_j times it
    __float128 integral[QUAD_GAUSS_NODES][QUAD_GAUSS_NODES];
    // the same in the precision that is enough for small corrections
    long double short_integral[QUAD_GAUSS_NODES][QUAD_GAUSS_NODES];
} QuadGauss;

// Computes everything above.
void quad_gauss_init(QuadGauss *gauss);

// The weights with which values at the nodes make the integral from 0 to x, 0 <= x <= 1.
void quad_gauss_weights(const QuadGauss *gauss, __float128 x, __float128 *weights);
