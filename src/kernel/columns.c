// Computes what impulses in rows do to coordinates within a step.
//
// A is linear in time, s = t - h/2:
//     v(t) = .. + A P + A' (s P - Q),   q(t) = .. + A Q + A' (s Q - 2 R),   Q' = P, R' = Q
// A world's own step under the mean force P/h has A P at its end; what is left are
//     v' += A' ((h/2) P - Q),   q' += A (Q - (h/2) P) + A' ((h/2) Q - 2 R)
#include "kernel/columns.h"

#include <math.h>

// of the free accelerations, what impulses may change them by: their own change, which comes of the
// second power of speeds, is then known to as much
static const double CALM = 0.1;

static void push_constant(const KernelColumns *of, const double *impulse, const double *moment,
                          double *speeds, double *positions)
{
    for (size_t row = 0; row < of->rows; row++) {
        const double *column = of->columns + row * of->coordinates;
        const double pushed = impulse[row];
        const double moved = moment[row];
        // most rows of many have none
        for (size_t i = 0; (pushed != 0.0 || moved != 0.0) && i < of->coordinates; i++) {
            speeds[i] += pushed * column[i];
            positions[i] += moved * column[i];
        }
    }
}

void kernel_columns_push(const KernelColumns *of, double off_middle_s, const double *impulse,
                         const double *moment, double *speeds, double *positions)
{
    if (of->rates == NULL) {
        push_constant(of, impulse, moment, speeds, positions);
        return;
    }
    for (size_t row = 0; row < of->rows; row++) {
        const double *column = of->columns + row * of->coordinates;
        const double *rate = of->rates + row * of->coordinates;
        const double pushed = impulse[row];
        const double moved = moment[row];
        const double turned = off_middle_s * pushed - moved;
        const double carried = off_middle_s * moved - 2.0 * moment[of->rows + row];
        for (size_t i = 0; i < of->coordinates; i++) {
            speeds[i] += pushed * column[i] + turned * rate[i];
            positions[i] += moved * column[i] + carried * rate[i];
        }
    }
}

void kernel_columns_turn(const KernelColumns *of, double width_s, const double *impulse,
                         const double *moment, double *speeds)
{
    for (size_t row = 0; of->rates != NULL && row < of->rows; row++) {
        const double turned = 0.5 * width_s * impulse[row] - moment[row];
        for (size_t i = 0; i < of->coordinates; i++) {
            speeds[i] += turned * of->rates[row * of->coordinates + i];
        }
    }
}

KernelShares kernel_columns_shares(const double *times_s, size_t known, double time_s)
{
    KernelShares shares = {.value = {0.0}};
    for (size_t i = 0; i < known; i++) {
        double value = 1.0;
        double rate = 0.0;
        for (size_t k = 0; k < known; k++) {
            if (k != i) {
                // of a product of (t - t_k) / (t_i - t_k)
                const double apart_s = times_s[i] - times_s[k];
                rate = rate * (time_s - times_s[k]) / apart_s + value / apart_s;
                value *= (time_s - times_s[k]) / apart_s;
            }
        }
        shares.value[i] = value;
        shares.rate[i] = rate;
    }
    return shares;
}

bool kernel_columns_free_after(size_t rows, const double *drift, const double *impulse,
                               const double *free, double *free_after)
{
    double size = 0.0;
    double pushed = 0.0;
    for (size_t i = 0; i < rows; i++) {
        double change = 0.0;
        for (size_t k = 0; impulse != NULL && k < rows; k++) {
            change += 2.0 * drift[i * rows + k] * impulse[k];
        }
        free_after[i] = free[i] + change;
        size = fmax(size, fabs(free[i]));
        pushed = fmax(pushed, fabs(change));
    }
    return pushed <= CALM * size;
}
