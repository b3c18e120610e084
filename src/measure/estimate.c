// Do the formulas of the penalty estimate give the cells that the paper prints?
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
