// Which numbers does the paper print?
//
// Copied from its Tables I to III, VII and VIII digit by digit, slips included; what a slip must
// have meant stands in paper/typos.
//
// Source: "A New Approach for Estimation of Penalty Parameter with Tolerance Stack-Up".
#include "measure/printed.h"

#include <math.h>

const char *const PRINTED_PIN_NAMES[PRINTED_PIN_COUNT] = {"crank-coupler", "coupler-follower"};

const double PRINTED_HOLE_DIAMETER = 10.015e-3;
const double PRINTED_PIN_DIAMETER = 9.986e-3;
const double PRINTED_PIN_WIDTH = 13e-3;

// clang-format off
const PrintedTable PRINTED_TABLES[PRINTED_TABLE_COUNT] = {
    {
        .name = "Table I", .title = "tangential force on the pin", .unit = "N", .decimals = 2,
        .cells = {
            {0.01, 0.01},
            {0.04, 0.04},
            {0.09, 0.10},
            {0.17, 0.18},
            {0.26, 0.27},
            {0.38, 0.39},
            {0.52, 0.54},
            {0.67, 0.70},
            {0.85, 0.89},
            {1.05, 1.10},
            {1.27, 1.33},
            {1.51, 1.58},
            {1.78, 1.85},
            {2.06, 2.15},
            {2.37, 2.47},
        },
    },
    {
        .name = "Table II", .title = "penalty parameter", .unit = "N", .decimals = 2,
        .cells = {
            {97.33, 99.40},
            {194.67, 189.85},
            {292.00, 300.17},
            {389.33, 402.72},
            {486.66, 493.23},
            {584.00, 592.79},
            {681.33, 697.54},
            {778.66, 794.18},
            {875.99, 895.50},
            {973.33, 995.56},
            {1070.66, 1094.71},
            {1167.99, 1193.16},
            {1265.33, 1291.09},
            {1362.66, 1391.84},
            {1459.99, 1491.83},
        },
    },
    {
        .name = "Table III", .title = "mutual approach", .unit = "um", .decimals = 4,
        .cells = {
            {0.0090, 0.0093},
            {0.0227, 0.0219},
            {0.0390, 0.0404},
            {0.0572, 0.0598},
            {0.0770, 0.0784},
            {0.0982, 0.1002},
            {0.1206, 0.1244},
            {0.1441, 0.1479},
            {0.1686, 0.1736},
            {0.1940, 0.2000},
            {0.2203, 0.2269},
            {0.2474, 0.2546},
            {0.2753, 0.2828},
            {0.3039, 0.3126},
            {0.3332, 0.3429},
        },
    },
};

const PrintedExtremes PRINTED_EXTREMES[PRINTED_ROW_COUNT] = {
    [PRINTED_IDEAL_NOMINAL] = {"Ideal Nominal",
        {78.696, -42.201, 80.555, -43.819, 7574, -11970, 12484, -7512}},
    [PRINTED_IDEAL_STACKUP] = {"Ideal Stack-up",
        {78.442, -42.138, 80.289, -43.745, 7537, -11921, 12430, -7476}},
    [PRINTED_POISSON] = {"Stack-up, POISSON",
        {89.512, -42.677, 94.018, -43.905, 74069000, -9970500, 7120800, -7086500}},
    [PRINTED_IMPACT] = {"Stack-up, IMPACT",
        {134.502, -42.461, 146.082, -43.793, 1719800, -1490300, 1480000, -1383100}},
    [PRINTED_IDEAL_ANALYTICAL] = {"Ideal Analytical",
        {78.697, -42.199, 80.553, -43.818, 7573, -11970, 12485, -7511}},
};
// clang-format on

const char *const PRINTED_QUANTITY_NAMES[PRINTED_QUANTITY_COUNT] = {
    "coupler omega max", "coupler omega min", "follower omega max", "follower omega min",
    "coupler alpha max", "coupler alpha min", "follower alpha max", "follower alpha min",
};

double printed_speed_rpm(int row)
{
    return 100.0 * (row + 1);
}

int printed_decimals(int quantity)
{
    return quantity < PRINTED_QUANTITY_COUNT / 2 ? 3 : 0;
}

bool printed_agrees(double value, double printed, int decimals)
{
    const double scale = pow(10.0, decimals);
    return round(value * scale) == round(printed * scale);
}

double printed_alpha_max(PrintedPin pin)
{
    // the second half of a row: coupler alpha max, min, follower alpha max, min
    const double *alphas = &PRINTED_EXTREMES[PRINTED_IDEAL_NOMINAL].values[4 + 2 * pin];
    return fmax(fabs(alphas[0]), fabs(alphas[1]));
}
