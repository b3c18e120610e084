// The paper's printed numbers, and its estimate recomputed cell by cell.
//
// Table I     F = kappa max|alpha| (rpm / 1000)^2, N, to two decimals
// Table II    P = 2 E* (0.1 mm sqrt(F_used / N)) (0.042 mm), N, to two decimals
// Table III   delta = 3/4 (F_used / (E* sqrt(5 mm)))^(2/3), micron, to four decimals
//
// F_used is the force behind Tables II and III, and not always that of Table I as printed: see
// force_used. alpha in rad/s^2 at 1000 rpm, E* effective modulus; formulas in contact/penalty.
//
// Source: "A New Approach for Estimation of Penalty Parameter with Tolerance Stack-Up".
#include "measure/estimate.h"

#include <math.h>
#include <stdio.h>

// The numbers that the paper prints.
//
// Copied from its Tables I to III, VII and VIII digit by digit, slips included; what a slip must
// have meant stands in paper/typos.
//
// Source: "A New Approach for Estimation of Penalty Parameter with Tolerance Stack-Up".

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

const PrintedColumn PRINTED_COLUMNS[PRINTED_QUANTITY_COUNT] = {
    {"coupler", NUMBER_BODY_OMEGA_MAX, 3},  {"coupler", NUMBER_BODY_OMEGA_MIN, 3},
    {"follower", NUMBER_BODY_OMEGA_MAX, 3}, {"follower", NUMBER_BODY_OMEGA_MIN, 3},
    {"coupler", NUMBER_BODY_ALPHA_MAX, 0},  {"coupler", NUMBER_BODY_ALPHA_MIN, 0},
    {"follower", NUMBER_BODY_ALPHA_MAX, 0}, {"follower", NUMBER_BODY_ALPHA_MIN, 0},
};

void printed_column_key(size_t column, char key[PRINTED_WORDS_SIZE])
{
    const PrintedColumn *of = &PRINTED_COLUMNS[column];
    snprintf(key, PRINTED_WORDS_SIZE, "%s_%s", of->body, NUMBERS[of->number].keys[NUMBER_PUSHED]);
}

void printed_column_title(size_t column, char title[PRINTED_WORDS_SIZE])
{
    const PrintedColumn *of = &PRINTED_COLUMNS[column];
    snprintf(title, PRINTED_WORDS_SIZE, "%s %s", of->body,
             NUMBERS[of->number].titles[NUMBER_PUSHED]);
}

double printed_speed_rpm(int row)
{
    return 100.0 * (row + 1);
}

bool printed_agrees(double value, double printed, int decimals)
{
    const double scale = pow(10.0, decimals);
    return round(value * scale) == round(printed * scale);
}

// Largest |alpha| of coupler and follower at 1000 rpm, rad/s^2: Table VIII, "Ideal Nominal".
static double printed_alpha_max(PrintedPin pin)
{
    // the second half of a row: coupler alpha max, min, follower alpha max, min
    const double *alphas = &PRINTED_EXTREMES[PRINTED_IDEAL_NOMINAL].values[4 + 2 * pin];
    return fmax(fabs(alphas[0]), fabs(alphas[1]));
}

static const double RAD_PER_S_PER_RPM = 3.14159265358979323846 / 30.0;
static const double UM_PER_M = 1e6;

enum { TABLE_FORCE, TABLE_PENALTY, TABLE_APPROACH };

EstimateInputs estimate_inputs_printed(void)
{
    const MaterialOptions steel = material_options_default();
    return (EstimateInputs){
        .reading = penalty_reading_of_tables(),
        .alpha_max = {printed_alpha_max(PRINTED_CRANK_COUPLER),
                      printed_alpha_max(PRINTED_COUPLER_FOLLOWER)},
        .effective_modulus = penalty_effective_modulus(&steel),
    };
}

static double round_to(double value, int decimals)
{
    const double scale = pow(10.0, decimals);
    return round(value * scale) / scale;
}

// The force the paper went on with, N. For the crank-coupler pin the full one; for the
// coupler-follower pin the one printed in Table I, except in the first row, where 0.01 N would
// have left one digit. This is the noise in its second column.
static double force_used(PrintedPin pin, int row, double force)
{
    if (pin == PRINTED_CRANK_COUPLER || row == 0) {
        return force;
    }
    return round_to(force, PRINTED_TABLES[TABLE_FORCE].decimals);
}

static void fill_cell(EstimateTable *table, const PrintedTable *printed, int row, int pin,
                      double value)
{
    EstimateCell *cell = &table->cells[row][pin];
    cell->printed = printed->cells[row][pin];
    cell->value = value;
    cell->rounded = round_to(value, printed->decimals);
    cell->is_as_printed = printed_agrees(value, cell->printed, printed->decimals);
    table->cell_count++;
    table->as_printed += cell->is_as_printed ? 1 : 0;
    table->difference_max = fmax(table->difference_max, fabs(cell->rounded - cell->printed));
}

void estimate_compute(const EstimateInputs *inputs, EstimateTable tables[PRINTED_TABLE_COUNT])
{
    const PenaltyReading *reading = &inputs->reading;
    const double modulus = inputs->effective_modulus;
    for (int i = 0; i < PRINTED_TABLE_COUNT; i++) {
        tables[i] = (EstimateTable){0};
    }
    for (int row = 0; row < PRINTED_SPEED_COUNT; row++) {
        const double speed = printed_speed_rpm(row) * RAD_PER_S_PER_RPM;
        for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
            const double force = penalty_force(reading, inputs->alpha_max[pin], speed);
            const double used = force_used((PrintedPin)pin, row, force);
            const double penalty = penalty_printed(reading, modulus, used);
            const double approach = penalty_approach(reading, modulus, used) * UM_PER_M;
            fill_cell(&tables[TABLE_FORCE], &PRINTED_TABLES[TABLE_FORCE], row, pin, force);
            fill_cell(&tables[TABLE_PENALTY], &PRINTED_TABLES[TABLE_PENALTY], row, pin, penalty);
            fill_cell(&tables[TABLE_APPROACH], &PRINTED_TABLES[TABLE_APPROACH], row, pin, approach);
        }
    }
}
