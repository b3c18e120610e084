// How are the equations of an implicit step solved?
//
// Radau IIA of order 5 with three stages for P' = f(t, P, Q), Q' = P:
//     Z_i = h sum a_ij f_j,   P_i = P + Z_i,   Q_i = Q + c_i h P + h sum a_ij Z_j
// by Newton's method on the Z of the rows that touch, with the derivatives at all stages:
//     dZ_i - h sum_k [a_ik f_P,k + h sum_j a_ij a_jk f_Q,j] dZ_k = h sum a_ij f_j - Z_i
// A force that ends at the wall, and never pulls, has no slope beyond either, from which Newton's
// method would come back far too deep. So the equations are solved first with a force that goes on
// smoothly, and again with the true one where that is left.
//
// Source: Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996), IV.5 and
// IV.8.
#include "contact/encounter_stages.h"

#include "base/zeroed.h"
#include "contact/encounter_error.h"
#include "contact/encounter_slopes.h"

#include <math.h>
#include <string.h>

enum {
    NEWTON_MOST = 12,
    DENSE = 64, // rows up to which the equations are solved stage by stage, as one dense matrix
};

// clang-format off
#define ROOT_6 2.449489742783178098
const double ENCOUNTER_NODE[ENCOUNTER_STAGES] = {(4.0 - ROOT_6) / 10.0, (4.0 + ROOT_6) / 10.0, 1.0};
const double ENCOUNTER_COUPLING[ENCOUNTER_STAGES][ENCOUNTER_STAGES] = {
    {(88.0 - 7.0 * ROOT_6) / 360.0, (296.0 - 169.0 * ROOT_6) / 1800.0, (-2.0 + 3.0 * ROOT_6) / 225.0},
    {(296.0 + 169.0 * ROOT_6) / 1800.0, (88.0 + 7.0 * ROOT_6) / 360.0, (-2.0 - 3.0 * ROOT_6) / 225.0},
    {(16.0 - ROOT_6) / 36.0, (16.0 + ROOT_6) / 36.0, 1.0 / 9.0},
};
// clang-format on

// of the error that is allowed: what is left after that change is about its square
static const double SOLVED = 1e-2;

static const double FROM_DEPTH = 0.5; // of the depth at the start, a smooth force goes on linearly

void encounter_stages_create(Encounter *encounter)
{
    const size_t rows = encounter_rows(encounter);
    EncounterStages *stages = encounter->stages = zeroed(1, sizeof *stages);
    stages->row_of = zeroed(rows, sizeof *stages->row_of);
    stages->from_depth = zeroed(encounter->joint_count, sizeof *stages->from_depth);
    for (size_t i = 0; i < ENCOUNTER_STAGES; i++) {
        stages->moved[i] = zeroed(rows, sizeof *stages->moved[i]);
        stages->impulse[i] = zeroed(rows, sizeof *stages->impulse[i]);
        stages->moment[i] = zeroed(2 * rows, sizeof *stages->moment[i]);
    }
    for (size_t i = 0; i <= ENCOUNTER_STAGES; i++) {
        stages->forces[i] = zeroed(rows, sizeof *stages->forces[i]);
    }
    stages->change = zeroed(ENCOUNTER_STAGES * rows, sizeof *stages->change);
    for (size_t i = 0; i < 2; i++) {
        stages->changes[i] = zeroed(rows, sizeof *stages->changes[i]);
    }
}

void encounter_stages_destroy(EncounterStages *stages)
{
    if (stages == NULL) {
        return;
    }
    free(stages->row_of);
    free(stages->from_depth);
    for (size_t i = 0; i < ENCOUNTER_STAGES; i++) {
        free(stages->moved[i]);
        free(stages->impulse[i]);
        free(stages->moment[i]);
    }
    for (size_t i = 0; i <= ENCOUNTER_STAGES; i++) {
        free(stages->forces[i]);
        banded_finish(&stages->by_impulse[i]);
        banded_finish(&stages->by_moment[i]);
    }
    banded_finish(&stages->matrix);
    free(stages->change);
    free(stages->changes[0]);
    free(stages->changes[1]);
    free(stages);
}

// The number of an unknown: of few rows stage by stage, of many all stages of a row together.
static size_t unknown(const EncounterStages *stages, size_t stage, size_t row)
{
    return stages->count <= DENSE ? stage * stages->count + row : row * ENCOUNTER_STAGES + stage;
}

static void list_rows(const Encounter *encounter, EncounterStages *stages,
                      const EncounterPoint *from)
{
    stages->count = 0;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const PinHole pose =
            encounter_motion_pose(encounter, i, from->time_s, from->impulse, from->moment);
        stages->from_depth[i] = FROM_DEPTH * fmax(pose.penetration, 0.0);
    }
    for (size_t i = 0; i < encounter_rows(encounter); i++) {
        if (encounter->joints[encounter->joint_of[i]].is_touching) {
            stages->row_of[stages->count++] = i;
        }
    }
}

static void shape_slopes(const Encounter *encounter, EncounterStages *stages, size_t which)
{
    // rows of one joint differ in what is in their reach
    const size_t most = stages->count <= DENSE ? stages->count : encounter->reach;
    banded_shape(&stages->by_impulse[which], stages->count, most + ENCOUNTER_ROWS_MOST);
    banded_shape(&stages->by_moment[which], stages->count, most + ENCOUNTER_ROWS_MOST);
}

// The derivatives of one of a joint's rows: of the joint whose rows begin with `first`.
static void differentiate_row(const Encounter *encounter, EncounterStages *stages, size_t which,
                              size_t first, size_t own_row, const EncounterSlopes *slopes)
{
    const Banded *by_moment = &stages->by_moment[which];
    const Banded *by_impulse = &stages->by_impulse[which];
    const size_t row = stages->row_of[first];
    const size_t own = encounter->joints[encounter->joint_of[row]].row_count;
    for (size_t k = banded_first(by_moment, first + own_row);
         k < banded_end(by_moment, first + own_row); k++) {
        double moment = 0.0;
        double impulse = 0.0;
        for (size_t m = 0; m < own; m++) {
            const EncounterSpan span = encounter_span(encounter, row + m);
            if (stages->row_of[k] < span.first || stages->row_of[k] >= span.end) {
                continue;
            }
            const double mobility = *encounter_mobility(encounter, row + m, stages->row_of[k]);
            moment += m < 2 ? slopes->by_place[own_row][m] * mobility : 0.0;
            impulse += slopes->by_speed[own_row][m] * mobility;
        }
        *banded_entry(by_moment, first + own_row, k) = moment;
        *banded_entry(by_impulse, first + own_row, k) = impulse;
    }
}

// Forces and their derivatives by impulses and moments at a stage, or at the start of the step.
static void differentiate(const Encounter *encounter, EncounterStages *stages, size_t which,
                          double time_s, const double *impulse, const double *moment,
                          bool is_smooth)
{
    const size_t n = stages->count;
    shape_slopes(encounter, stages, which);
    for (size_t first = 0, own; first < n; first += own) {
        const size_t row = stages->row_of[first];
        const size_t joint = (size_t)encounter->joint_of[row];
        own = encounter->joints[joint].row_count;
        EncounterSlopes slopes;
        encounter_slopes_find(encounter, joint, time_s, impulse, moment,
                              is_smooth ? stages->from_depth[joint] : 0.0, &slopes);
        memcpy(stages->forces[which] + row, slopes.force, own * sizeof *slopes.force);
        for (size_t i = 0; i < own; i++) {
            differentiate_row(encounter, stages, which, first, i, &slopes);
        }
    }
}

// Impulses and moments at a stage, from what all stages have moved.
static void find_stage(const Encounter *encounter, EncounterStages *stages,
                       const EncounterPoint *from, double width_s, size_t stage)
{
    const size_t rows = encounter_rows(encounter);
    for (size_t i = 0; i < rows; i++) {
        double sum = ENCOUNTER_NODE[stage] * from->impulse[i];
        for (size_t j = 0; j < ENCOUNTER_STAGES; j++) {
            sum += ENCOUNTER_COUPLING[stage][j] * stages->moved[j][i];
        }
        stages->impulse[stage][i] = from->impulse[i] + stages->moved[stage][i];
        stages->moment[stage][i] = from->moment[i] + width_s * sum;
        // what the impulses have been on the way is known well enough
        const double since_s = ENCOUNTER_NODE[stage] * width_s;
        const double bend = from->impulse[i] / 2.0 + stages->moved[stage][i] / 6.0;
        stages->moment[stage][rows + i] =
            from->moment[rows + i] + since_s * (from->moment[i] + since_s * bend);
    }
}

static void evaluate_stages(Encounter *encounter, EncounterStages *stages,
                            const EncounterPoint *from, double width_s, bool is_smooth)
{
    for (size_t i = 0; i < ENCOUNTER_STAGES; i++) {
        find_stage(encounter, stages, from, width_s, i);
        differentiate(encounter, stages, i, from->time_s + ENCOUNTER_NODE[i] * width_s,
                      stages->impulse[i], stages->moment[i], is_smooth);
        encounter->evaluations++;
        encounter_count_work(encounter);
    }
}

// Factors Newton's matrix with the derivatives at the stages, or for all of them those at the
// start.
static bool factor_stages(EncounterStages *stages, double width_s, bool from_start)
{
    const size_t n = stages->count;
    const Banded *shape = &stages->by_impulse[from_start ? ENCOUNTER_STAGES : 0];
    banded_shape(&stages->matrix, ENCOUNTER_STAGES * n, ENCOUNTER_STAGES * (shape->reach + 1));
    for (size_t s = 0; s < ENCOUNTER_STAGES; s++) {
        for (size_t q = 0; q < ENCOUNTER_STAGES; q++) {
            const Banded *by_impulse = &stages->by_impulse[from_start ? ENCOUNTER_STAGES : q];
            for (size_t i = 0; i < n; i++) {
                const size_t row = unknown(stages, s, i);
                for (size_t k = banded_first(shape, i); k < banded_end(shape, i); k++) {
                    const double own = s == q && i == k ? 1.0 : 0.0;
                    double twice = 0.0;
                    for (size_t j = 0; j < ENCOUNTER_STAGES; j++) {
                        twice += ENCOUNTER_COUPLING[s][j] * ENCOUNTER_COUPLING[j][q] *
                                 *banded_entry(
                                     &stages->by_moment[from_start ? ENCOUNTER_STAGES : j], i, k);
                    }
                    *banded_entry(&stages->matrix, row, unknown(stages, q, k)) =
                        own -
                        width_s * (ENCOUNTER_COUPLING[s][q] * *banded_entry(by_impulse, i, k) +
                                   width_s * twice);
                }
            }
        }
    }
    return banded_factor(&stages->matrix);
}

// Counts what it takes to make and to factor Newton's matrix: of a full one count^3 / 3.
static void count_factor(Encounter *encounter, const EncounterStages *stages)
{
    const double count = (double)stages->matrix.count;
    const double reach = fmin(count, 2.0 * (double)stages->matrix.reach + 1.0);
    encounter->work_done += count * reach * (reach / 3.0 + ENCOUNTER_STAGES);
}

// Newton's next change of what the stages have moved. Returns the largest over what is allowed.
static double correct_stages(const Encounter *encounter, EncounterStages *stages,
                             const EncounterPoint *from, double width_s)
{
    const size_t n = stages->count;
    double *change = stages->change;
    for (size_t s = 0; s < ENCOUNTER_STAGES; s++) {
        for (size_t i = 0; i < n; i++) {
            const size_t row = stages->row_of[i];
            double sum = 0.0;
            for (size_t j = 0; j < ENCOUNTER_STAGES; j++) {
                sum += ENCOUNTER_COUPLING[s][j] * stages->forces[j][row];
            }
            change[unknown(stages, s, i)] = width_s * sum - stages->moved[s][row];
        }
    }
    banded_substitute(&stages->matrix, change);
    double largest = 0.0;
    for (size_t s = 0; s < ENCOUNTER_STAGES; s++) {
        double *impulse = stages->changes[0];
        double *moment = stages->changes[1];
        memset(impulse, 0, encounter->row_count * sizeof *impulse);
        memset(moment, 0, encounter->row_count * sizeof *moment);
        for (size_t i = 0; i < n; i++) {
            const size_t row = stages->row_of[i];
            stages->moved[s][row] += change[unknown(stages, s, i)];
            impulse[row] = change[unknown(stages, s, i)];
            moment[row] = width_s * change[unknown(stages, s, i)];
        }
        const double size = encounter_error_share(
            encounter, from, width_s, stages->moved[ENCOUNTER_STAGES - 1], impulse, moment);
        largest = size <= largest ? largest : size;
    }
    return largest;
}

// The forces of a joint at a stage by the derivatives at the start, where nothing but the free
// motion goes on.
static void extend_forces(const Encounter *encounter, EncounterStages *stages,
                          const EncounterPoint *from, double after_s, size_t stage, size_t joint)
{
    const size_t row = encounter->joints[joint].first_row;
    const size_t own = encounter->joints[joint].row_count;
    const double *free = encounter->free + row;
    EncounterSlopes slopes;
    encounter_slopes_find(encounter, joint, from->time_s, from->impulse, from->moment,
                          stages->from_depth[joint], &slopes);
    const PinHole before =
        encounter_motion_pose(encounter, joint, from->time_s, from->impulse, from->moment);
    const PinHole after = encounter_motion_pose(encounter, joint, from->time_s + after_s,
                                                stages->impulse[stage], stages->moment[stage]);
    const Vec2 moved = vec2_sub(after.eccentricity, before.eccentricity);
    for (size_t i = 0; i < own; i++) {
        double force =
            slopes.force[i] + slopes.by_place[i][0] * moved.x + slopes.by_place[i][1] * moved.y;
        for (size_t k = 0; k < own; k++) {
            force += slopes.by_speed[i][k] * after_s * free[k];
            if (encounter->input != NULL) {
                // by turns, for what others add is known at one time only
                const double later =
                    encounter_input_at(encounter, from->time_s + after_s)->speed[row + k];
                force += slopes.by_speed[i][k] *
                         (later - encounter_input_at(encounter, from->time_s)->speed[row + k]);
            }
        }
        stages->forces[stage][row + i] = force;
    }
}

// The stages to begin with: of the motion made linear at the start, so that what is about to die
// away there has done so.
static bool guess_stages(const Encounter *encounter, EncounterStages *stages,
                         const EncounterPoint *from, double width_s)
{
    for (size_t s = 0; s < ENCOUNTER_STAGES; s++) {
        memset(stages->moved[s], 0, encounter->row_count * sizeof *stages->moved[s]);
    }
    differentiate(encounter, stages, ENCOUNTER_STAGES, from->time_s, from->impulse, from->moment,
                  true);
    for (size_t s = 0; s < ENCOUNTER_STAGES; s++) {
        find_stage(encounter, stages, from, width_s, s);
        for (size_t i = 0; i < encounter->joint_count; i++) {
            if (encounter->joints[i].is_touching) {
                extend_forces(encounter, stages, from, ENCOUNTER_NODE[s] * width_s, s, i);
            }
        }
    }
    if (!factor_stages(stages, width_s, true)) {
        return false;
    }
    correct_stages(encounter, stages, from, width_s);
    return true;
}

// Newton's method with smooth forces or with those that never pull.
static bool iterate_stages(Encounter *encounter, EncounterStages *stages,
                           const EncounterPoint *from, double width_s, bool is_smooth)
{
    for (int i = 0; i < NEWTON_MOST; i++) {
        evaluate_stages(encounter, stages, from, width_s, is_smooth);
        count_factor(encounter, stages);
        if (!factor_stages(stages, width_s, false)) {
            return false;
        }
        const double size = correct_stages(encounter, stages, from, width_s);
        if (size <= SOLVED) {
            return true;
        }
        if (!(size < INFINITY)) {
            return false;
        }
    }
    return false;
}

// Whether the forces of a joint at the stages are where the smooth ones are right.
static bool is_joint_pressing(const Encounter *encounter, const EncounterStages *stages,
                              const EncounterPoint *from, double width_s, size_t joint)
{
    const size_t row = encounter->joints[joint].first_row;
    for (size_t s = 0; s < ENCOUNTER_STAGES; s++) {
        const PinHole pose =
            encounter_motion_pose(encounter, joint, from->time_s + ENCOUNTER_NODE[s] * width_s,
                                  stages->impulse[s], stages->moment[s]);
        const double along =
            pose.normal.x * stages->forces[s][row] + pose.normal.y * stages->forces[s][row + 1];
        if (!(along >= 0.0 && pose.penetration >= stages->from_depth[joint])) {
            return false;
        }
    }
    return true;
}

static bool is_pressing(const Encounter *encounter, const EncounterStages *stages,
                        const EncounterPoint *from, double width_s)
{
    for (size_t i = 0; i < encounter->joint_count; i++) {
        if (encounter->joints[i].is_touching &&
            !is_joint_pressing(encounter, stages, from, width_s, i)) {
            return false;
        }
    }
    return true;
}

bool encounter_stages_solve(Encounter *encounter, EncounterStages *stages,
                            const EncounterPoint *from, double width_s)
{
    list_rows(encounter, stages, from);
    const bool is_solved = guess_stages(encounter, stages, from, width_s) &&
                           ((iterate_stages(encounter, stages, from, width_s, true) &&
                             is_pressing(encounter, stages, from, width_s)) ||
                            iterate_stages(encounter, stages, from, width_s, false));
    for (size_t i = 0; is_solved && i < ENCOUNTER_STAGES; i++) {
        find_stage(encounter, stages, from, width_s, i);
        encounter_force_find(encounter, from->time_s + ENCOUNTER_NODE[i] * width_s,
                             stages->impulse[i], stages->moment[i], stages->forces[i],
                             stages->powers[i]);
    }
    return is_solved;
}
