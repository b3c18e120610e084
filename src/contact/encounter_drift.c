// How do rows move whose mobility and free acceleration change while they do?
//
// By the impulses P, their integrals Q, and theirs, R (contact/encounter_run.c), W' = S + S^T:
//     u'' = g + g' (t - h/2) + 2 S P + (W + (t - h/2) W') f
//     u'  = u0' + g t + g' t (t - h) / 2 + (W + (t - h/2) W') P + (S - S^T) Q
//     u   = u0 + u0' t + g t^2 / 2 + g' t^2 (t/6 - h/4) + (W + (t - h/2) W') Q - 2 S^T R
#include "contact/encounter_drift.h"

#include "base/zeroed.h"

#include <assert.h>
#include <math.h>

void encounter_make_drift(Encounter *encounter)
{
    const size_t rows = encounter->row_count;
    assert(encounter->pitch == rows);
    encounter->drift = zeroed(rows * rows, sizeof *encounter->drift);
    encounter->mobility_rate = zeroed(rows * rows, sizeof *encounter->mobility_rate);
    encounter->free_rate = zeroed(rows, sizeof *encounter->free_rate);
}

// The share of the mobility of one joint's first two rows that it changes by in half the step.
static double share_changed(const Encounter *encounter, const EncounterJoint *joint,
                            const double *drift)
{
    const size_t rows = encounter->row_count;
    double size = 0.0;
    double change = 0.0;
    for (size_t i = joint->first_row; i < joint->first_row + 2; i++) {
        for (size_t k = joint->first_row; k < joint->first_row + 2; k++) {
            size = fmax(size, fabs(*encounter_mobility(encounter, i, k)));
            change = fmax(change, fabs(drift[i * rows + k] + drift[k * rows + i]));
        }
    }
    return size > 0.0 ? encounter->middle_s * change / size : 0.0;
}

// How much of a drift is let in: all of it in steps that are of use. With W linear in time the
// square of its change is missing, by which it stays positive: without, a contact of frequency w
// that changes by a share r in half the step grows by up to exp(w h r).
static double drift_share(const Encounter *encounter, const double *drift)
{
    double most = 1.0;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const EncounterJoint *joint = &encounter->joints[i];
        const double changed = share_changed(encounter, joint, drift);
        const double growth = 2.0 * encounter->middle_s * joint->frequency * changed;
        most = fmax(most, fmax(2.0 * changed, growth));
    }
    return 1.0 / most;
}

void encounter_set_drift(Encounter *encounter, const double *drift, double duration)
{
    const size_t rows = encounter->row_count;
    encounter->middle_s = 0.5 * duration;
    const double share = drift_share(encounter, drift);
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; k < rows; k++) {
            encounter->drift[i * rows + k] = share * drift[i * rows + k];
            encounter->mobility_rate[i * rows + k] =
                share * (drift[i * rows + k] + drift[k * rows + i]);
        }
    }
}

void encounter_drift_add_all(const Encounter *encounter, size_t row, double time_s,
                             const double *impulse, const double *moment, double *positions,
                             double *speeds)
{
    const size_t rows = encounter->row_count;
    const double *drift = encounter->drift + row * rows;
    const double *rate = encounter->mobility_rate + row * rows;
    const double since_s = time_s - encounter->middle_s;
    const double pushed = since_s * impulse[row] + moment[row];
    const double moved = since_s * moment[row];
    for (size_t i = 0; i < rows; i++) {
        speeds[i] += pushed * rate[i] - 2.0 * moment[row] * drift[i];
        positions[i] += moved * rate[i] - 2.0 * moment[rows + row] * drift[i];
    }
}

void encounter_drift_bend_all(const Encounter *encounter, double time_s, double *positions,
                              double *speeds)
{
    for (size_t i = 0; i < encounter->row_count; i++) {
        const double bend = 0.5 * time_s * encounter->free_rate[i];
        speeds[i] += bend * (time_s - 2.0 * encounter->middle_s);
        positions[i] += bend * time_s * (time_s / 3.0 - encounter->middle_s);
    }
}
