// How is a contact integrated whose damping takes up the closing speed in no time?
//
// A damper c on a mass m has the time constant m / c; explicit steps longer than some 2.8 of it are
// unstable, however smooth the motion is once the pin has all but stopped. Radau IIA of order 5
// (contact/encounter_stages.c) is stable at any length and leaves nothing of what has died away:
// its steps are as long as the error allows, which the embedded formula of order 3 estimates:
//     (1 - h g f_P - h^2 g^2 f_Q) e_P = r_P + h g f_Q r_Q,   e_Q = r_Q + h g e_P
//     r_y = g (h y' + ((-13 - 7 s) Z_1 + (-13 + 7 s) Z_2 - Z_3) / 3),   s = sqrt 6
// with y' and the derivatives at the start of the step, Z_i the change of y = P, Q up to stage i,
// and g the real eigenvalue of the coefficients.
//
// Source: Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996), IV.8.
#include "contact/encounter_stiff.h"

#include "contact/encounter_error.h"
#include "contact/encounter_stages.h"

#include <math.h>
#include <string.h>

// clang-format off
#define ROOT_6 2.449489742783178098
static const double EMBEDDED[ENCOUNTER_STAGES] = {(-13.0 - 7.0 * ROOT_6) / 3.0, (-13.0 + 7.0 * ROOT_6) / 3.0, -1.0 / 3.0};
static const double EIGENVALUE = 0.27488882959568;
// clang-format on

// of what is stable: where the damping stops the pin, explicit steps have to follow that
static const double SETTLES = 0.01;

static const double SAFETY = 0.9; // of the step that would have just the error allowed
static const double SHRINK_MOST = 0.1;
static const double GROW_MOST = 6.0;

void encounter_stiff_finish(Encounter *encounter)
{
    encounter_stages_destroy(encounter->stages);
    encounter->stages = NULL;
}

bool encounter_stiff_is_needed(const Encounter *encounter, const EncounterPoint *point,
                               double explicit_s, double frictionless_s)
{
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const EncounterJoint *joint = &encounter->joints[i];
        if (!joint->is_touching || (joint->law.hysteresis == 0.0 && joint->law.viscous == 0.0)) {
            continue;
        }
        const PinHole pose = *encounter_point_pose(encounter, point, i);
        const double width_s = joint->is_overdamped ? frictionless_s : explicit_s;
        // as deep as the step leads
        const double depth = fmax(pose.penetration, 0.0) + width_s * fmax(pose.approach_speed, 0.0);
        const double decays = encounter_force_decay(encounter, i, pose.normal, depth) * width_s;
        if (decays > (joint->is_overdamped ? SETTLES : 1.0) * encounter->stable) {
            return true;
        }
    }
    return false;
}

// Factors the matrix of the estimate, in place of Newton's.
static bool factor_estimate(EncounterStages *stages, double hg)
{
    const Banded *by_impulse = &stages->by_impulse[ENCOUNTER_STAGES];
    const Banded *by_moment = &stages->by_moment[ENCOUNTER_STAGES];
    banded_shape(&stages->matrix, by_impulse->count, by_impulse->reach);
    for (size_t i = 0; i < stages->count; i++) {
        for (size_t k = banded_first(by_impulse, i); k < banded_end(by_impulse, i); k++) {
            *banded_entry(&stages->matrix, i, k) = (i == k ? 1.0 : 0.0) -
                                                   hg * *banded_entry(by_impulse, i, k) -
                                                   hg * hg * *banded_entry(by_moment, i, k);
        }
    }
    return banded_factor(&stages->matrix);
}

// Writes the errors of impulses and moments, with the rates of both at the start of the step:
// forces and impulses.
static void find_errors(const Encounter *encounter, const EncounterStages *stages,
                        const EncounterPoint *from, double hg, const double *force,
                        const double *rate, double *impulse, double *moment)
{
    const size_t n = stages->count;
    double *position = encounter->work->positions;
    double *sum = encounter->work->speeds;
    for (size_t i = 0; i < n; i++) {
        const size_t row = stages->row_of[i];
        sum[i] = hg * force[row];
        position[i] = hg * rate[row];
        for (size_t s = 0; s < ENCOUNTER_STAGES; s++) {
            sum[i] += EIGENVALUE * EMBEDDED[s] * stages->moved[s][row];
            position[i] += EIGENVALUE * EMBEDDED[s] * (stages->moment[s][row] - from->moment[row]);
        }
    }
    for (size_t i = 0; i < n; i++) {
        const Banded *by_moment = &stages->by_moment[ENCOUNTER_STAGES];
        for (size_t k = banded_first(by_moment, i); k < banded_end(by_moment, i); k++) {
            sum[i] += hg * *banded_entry(by_moment, i, k) * position[k];
        }
    }
    banded_substitute(&stages->matrix, sum);
    for (size_t i = 0; i < n; i++) {
        impulse[stages->row_of[i]] = sum[i];
        moment[stages->row_of[i]] = position[i] + hg * sum[i];
    }
}

// The error over what is allowed. What is beside the motion at the start, and dies away in the
// step, is in the first estimate; with the rates where it has died away, in the second, it is not.
static double estimate_error(Encounter *encounter, EncounterStages *stages,
                             const EncounterPoint *from, double width_s)
{
    const double hg = EIGENVALUE * width_s;
    const double *moved = stages->moved[ENCOUNTER_STAGES - 1];
    const size_t rows = encounter_rows(encounter);
    double *impulse = encounter->work->errors[0];
    double *moment = encounter->work->errors[1];
    memset(impulse, 0, rows * sizeof *impulse);
    memset(moment, 0, rows * sizeof *moment);
    if (!factor_estimate(stages, hg)) {
        return INFINITY;
    }
    find_errors(encounter, stages, from, hg, from->force, from->impulse, impulse, moment);
    const double first = encounter_error_share(encounter, from, width_s, moved, impulse, moment);
    if (first <= 1.0) {
        return first;
    }
    double powers[2];
    double *force = encounter->work->errors[2];
    double *rate = encounter->work->errors[3];
    double *sum = encounter->work->errors[4];
    for (size_t i = 0; i < rows; i++) {
        rate[i] = from->impulse[i] + impulse[i];
        sum[i] = from->moment[i] + moment[i];
        sum[rows + i] = from->moment[rows + i];
    }
    encounter_force_find(encounter, from->time_s, rate, sum, force, powers);
    find_errors(encounter, stages, from, hg, force, rate, impulse, moment);
    return encounter_error_share(encounter, from, width_s, moved, impulse, moment);
}

double encounter_stiff_step(Encounter *encounter, const EncounterPoint *from, double width_s,
                            EncounterPoint *to)
{
    if (encounter->stages == NULL) {
        encounter_stages_create(encounter);
    }
    EncounterStages *stages = encounter->stages;
    const bool is_solved = encounter_stages_solve(encounter, stages, from, width_s);
    encounter_point_begin(encounter, to, from->time_s + width_s);
    const size_t rows = encounter_rows(encounter);
    memcpy(to->impulse, stages->impulse[ENCOUNTER_STAGES - 1], rows * sizeof *to->impulse);
    memcpy(to->moment, stages->moment[ENCOUNTER_STAGES - 1], 2 * rows * sizeof *to->moment);
    for (size_t i = 0; i < 2; i++) {
        double sum = 0.0;
        for (size_t s = 0; s < ENCOUNTER_STAGES; s++) {
            sum += ENCOUNTER_COUPLING[ENCOUNTER_STAGES - 1][s] * stages->powers[s][i];
        }
        to->losses[i] = from->losses[i] + width_s * sum;
    }
    return is_solved ? estimate_error(encounter, stages, from, width_s) : INFINITY;
}

double encounter_stiff_next(double width_s, double error)
{
    return width_s * fmin(GROW_MOST, fmax(SHRINK_MOST, SAFETY * pow(error, -0.25)));
}

void encounter_stiff_settled(const Encounter *encounter, double *force)
{
    // the parabola through the stages' forces
    const EncounterStages *stages = encounter->stages;
    for (size_t i = 0; i < stages->count; i++) {
        const size_t row = stages->row_of[i];
        force[row] = 0.0;
        for (size_t s = 0; s < ENCOUNTER_STAGES; s++) {
            double weight = 1.0;
            for (size_t k = 0; k < ENCOUNTER_STAGES; k++) {
                weight *=
                    k == s ? 1.0 : ENCOUNTER_NODE[k] / (ENCOUNTER_NODE[k] - ENCOUNTER_NODE[s]);
            }
            force[row] += weight * stages->forces[s][row];
        }
    }
}
