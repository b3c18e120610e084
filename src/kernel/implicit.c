// Takes implicit local steps, where the damping of a contact would make explicit ones unstable.
//
// A damper c on a mass m has the time constant m / c; explicit steps longer than some 2.8 of it are
// unstable, however smooth the motion is once the pin has all but stopped. Radau IIA of order 5 is
// stable at any length and leaves nothing of what has died away. With three stages for
// P' = f(t, P, Q), Q' = P it is
//     Z_i = h sum a_ij f_j,   P_i = P + Z_i,   Q_i = Q + c_i h P + h sum a_ij Z_j
// solved by Newton's method on the Z of the rows that touch, with the derivatives at all stages:
//     dZ_i - h sum_k [a_ik f_P,k + h sum_j a_ij a_jk f_Q,j] dZ_k = h sum a_ij f_j - Z_i
// A force that ends at the wall, and never pulls, has no slope beyond either, from which Newton's
// method would come back far too deep. So the equations are solved first with a force that goes on
// smoothly, and again with the true one where that is left.
//
// Steps are as long as the error allows, which the embedded formula of order 3 estimates:
//     (1 - h g f_P - h^2 g^2 f_Q) e_P = r_P + h g f_Q r_Q,   e_Q = r_Q + h g e_P
//     r_y = g (h y' + ((-13 - 7 s) Z_1 + (-13 + 7 s) Z_2 - Z_3) / 3),   s = sqrt 6
// with y' and the derivatives at the start of the step, Z_i the change of y = P, Q up to stage i,
// and g the real eigenvalue of the coefficients.
//
// The error that is allowed is the fourth power of the phase, as an explicit step of that phase has
// on a spring:
//     along the normal    of the depth and of what the pin closes in the step
//     along the wall      of that, and of the way that it slides in the step
// for an error of position, and of speed times the length of the step. So a depth that has hardly
// begun to grow is followed as well as a deep one: the damping of what comes next depends on it.
//
// Source: Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996), IV.5 and
// IV.8.
#include "kernel/internal.h"

#include "base/banded.h"
#include "base/zeroed.h"

#include <math.h>
#include <string.h>

enum { STAGES = 3 };

typedef struct ImplicitStages {
    size_t count;          // rows that touch
    size_t *row_of;        // owned, as are all arrays
    double *from_depth;    // m, below which a smooth force is linear; by contact
    double *moved[STAGES]; // N s: the impulses since the start, by row
    double *impulse[STAGES];
    double *moment[STAGES];
    double powers[STAGES][2];
    // forces by row, and their derivatives by impulses and moments between rows that touch: at the
    // stages, and last at the start of the step, where the damper may pull
    double *forces[STAGES + 1];
    Banded by_impulse[STAGES + 1];
    Banded by_moment[STAGES + 1];
    Banded matrix;  // Newton's, or that of an estimate
    double *change; // by unknown: what Newton's method changes
    double *changes[2];
} ImplicitStages;

static const double DEPTH_ROUNDINGS = 8.0 * 0x1p-52; // of what a depth is the difference of

// By how much impulses move the rows of a contact.
static void move_rows(const Kernel *kernel, size_t contact, const double *impulse, double *moved)
{
    const size_t first = kernel->contacts[contact].first_row;
    const size_t own = kernel->contacts[contact].row_count;
    for (size_t i = 0; i < own; i++) {
        const double *mobility = kernel_mobility(kernel, first + i, 0);
        const KernelSpan span = kernel_span(kernel, first + i);
        moved[i] = 0.0;
        for (size_t k = span.first; k < span.end; k++) {
            moved[i] += mobility[k] * impulse[k];
        }
    }
}

// The size of what rows do along the wall, turns at the wall included.
static double along_wall(const Kernel *kernel, size_t contact, Vec2 tangent, const double *rows)
{
    const KernelContact *of = &kernel->contacts[contact];
    double sum = fabs(tangent.x * rows[0] + tangent.y * rows[1]);
    for (size_t i = KERNEL_ROWS_PLAIN; i < of->row_count; i++) {
        sum += (i == KERNEL_ROW_AXIAL ? 1.0 : fabs(of->hole_radius)) * fabs(rows[i]);
    }
    return sum;
}

double kernel_depth_rounding(const Kernel *kernel, size_t contact, double time_s)
{
    const KernelContact *of = &kernel->contacts[contact];
    if (of->shape != KERNEL_LINE) {
        return DEPTH_ROUNDINGS * (fabs(of->radial_clearance) + of->half_length);
    }
    return DEPTH_ROUNDINGS *
           (fabs(kernel->position[of->first_row]) + time_s * fabs(kernel->speed[of->first_row]));
}

static double share_of_contact(const Kernel *kernel, size_t contact, const KernelPoint *from,
                               double width_s, const double *moved, const double *impulse,
                               const double *moment)
{
    const size_t first = kernel->contacts[contact].first_row;
    const size_t own = kernel->contacts[contact].row_count;
    const double square = kernel->stiff_phase * kernel->stiff_phase;
    const double rounding = kernel_depth_rounding(kernel, contact, from->time_s + width_s);
    const PinHole pose =
        kernel_motion_pose(kernel, contact, from->time_s, from->impulse, from->moment);
    const Vec2 tangent = vec2_perp(pose.normal);
    double speeds[KERNEL_ROWS_MOST];
    double changes[KERNEL_ROWS_MOST];
    double errors[2][KERNEL_ROWS_MOST];
    for (size_t i = 0; i < own; i++) {
        speeds[i] =
            kernel_motion_speed(kernel, first + i, from->time_s, from->impulse, from->moment);
    }
    move_rows(kernel, contact, moved, changes);
    move_rows(kernel, contact, impulse, errors[0]);
    move_rows(kernel, contact, moment, errors[1]);
    const double depth = fabs(pose.penetration) + width_s * fabs(pose.approach_speed);
    const double slid = width_s * (along_wall(kernel, contact, tangent, speeds) +
                                   along_wall(kernel, contact, tangent, changes));
    const double across = square * square * depth + rounding;
    const double along = across + square * square * slid;
    double worst = 0.0;
    for (size_t i = 0; i < 2; i++) {
        const double span = i == 0 ? width_s : 1.0;
        const double astray = fabs(pose.normal.x * errors[i][0] + pose.normal.y * errors[i][1]);
        const double share =
            span * fmax(astray / across, along_wall(kernel, contact, tangent, errors[i]) / along);
        worst = share <= worst ? worst : share; // a NaN must show
    }
    return worst;
}

// Errors of the impulses, N s, and of their integrals, N s^2, at the end of a step, by row, over
// what is allowed; `moved` are the impulses in the step. Infinite or NaN where they are.
static double error_share(const Kernel *kernel, const KernelPoint *from, double width_s,
                          const double *moved, const double *impulse, const double *moment)
{
    double worst = 0.0;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        if (kernel->contacts[i].state.is_touching) {
            const double share = share_of_contact(kernel, i, from, width_s, moved, impulse, moment);
            worst = share <= worst ? worst : share;
        }
    }
    return worst;
}

enum {
    NEWTON_MOST = 12,
    DENSE_ROWS_MOST =
        64, // rows up to which the equations are solved stage by stage, as one dense matrix
};

// clang-format off
#define ROOT_6 2.449489742783178098
static const double STAGE_TIME[STAGES] = {(4.0 - ROOT_6) / 10.0, (4.0 + ROOT_6) / 10.0, 1.0};
static const double STAGE_WEIGHT[STAGES][STAGES] = {
    {(88.0 - 7.0 * ROOT_6) / 360.0, (296.0 - 169.0 * ROOT_6) / 1800.0, (-2.0 + 3.0 * ROOT_6) / 225.0},
    {(296.0 + 169.0 * ROOT_6) / 1800.0, (88.0 + 7.0 * ROOT_6) / 360.0, (-2.0 - 3.0 * ROOT_6) / 225.0},
    {(16.0 - ROOT_6) / 36.0, (16.0 + ROOT_6) / 36.0, 1.0 / 9.0},
};
// clang-format on

// of the error that is allowed: what is left after that change is about its square
static const double NEWTON_LEFT_MOST = 1e-2;

static const double LINEAR_DEPTH_SHARE =
    0.5; // of the depth at the start, a smooth force goes on linearly

// Gives the kernel its stages.
static void create_stages(Kernel *kernel)
{
    const size_t rows = kernel_rows(kernel);
    ImplicitStages *stages = kernel->stages = zeroed(1, sizeof *stages);
    stages->row_of = zeroed(rows, sizeof *stages->row_of);
    stages->from_depth = zeroed(kernel->contact_count, sizeof *stages->from_depth);
    for (size_t i = 0; i < STAGES; i++) {
        stages->moved[i] = zeroed(rows, sizeof *stages->moved[i]);
        stages->impulse[i] = zeroed(rows, sizeof *stages->impulse[i]);
        stages->moment[i] = zeroed(2 * rows, sizeof *stages->moment[i]);
    }
    for (size_t i = 0; i <= STAGES; i++) {
        stages->forces[i] = zeroed(rows, sizeof *stages->forces[i]);
    }
    stages->change = zeroed(STAGES * rows, sizeof *stages->change);
    for (size_t i = 0; i < 2; i++) {
        stages->changes[i] = zeroed(rows, sizeof *stages->changes[i]);
    }
}

static void destroy_stages(ImplicitStages *stages)
{
    if (stages == NULL) {
        return;
    }
    free(stages->row_of);
    free(stages->from_depth);
    for (size_t i = 0; i < STAGES; i++) {
        free(stages->moved[i]);
        free(stages->impulse[i]);
        free(stages->moment[i]);
    }
    for (size_t i = 0; i <= STAGES; i++) {
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
static size_t unknown(const ImplicitStages *stages, size_t stage, size_t row)
{
    return stages->count <= DENSE_ROWS_MOST ? stage * stages->count + row : row * STAGES + stage;
}

static void list_rows(const Kernel *kernel, ImplicitStages *stages, const KernelPoint *from)
{
    stages->count = 0;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const PinHole pose =
            kernel_motion_pose(kernel, i, from->time_s, from->impulse, from->moment);
        stages->from_depth[i] = LINEAR_DEPTH_SHARE * fmax(pose.penetration, 0.0);
    }
    for (size_t i = 0; i < kernel_rows(kernel); i++) {
        if (kernel->contacts[kernel->contact_of[i]].state.is_touching) {
            stages->row_of[stages->count++] = i;
        }
    }
}

static void shape_slopes(const Kernel *kernel, ImplicitStages *stages, size_t which)
{
    // rows of one contact differ in what is in their reach
    const size_t most = stages->count <= DENSE_ROWS_MOST ? stages->count : kernel->reach;
    banded_shape(&stages->by_impulse[which], stages->count, most + KERNEL_ROWS_MOST);
    banded_shape(&stages->by_moment[which], stages->count, most + KERNEL_ROWS_MOST);
}

// The derivatives of one of a contact's rows: of the contact whose rows begin with `first`.
static void differentiate_row(const Kernel *kernel, ImplicitStages *stages, size_t which,
                              size_t first, size_t own_row, const KernelSlopes *slopes)
{
    const Banded *by_moment = &stages->by_moment[which];
    const Banded *by_impulse = &stages->by_impulse[which];
    const size_t row = stages->row_of[first];
    const size_t own = kernel->contacts[kernel->contact_of[row]].row_count;
    for (size_t k = banded_first(by_moment, first + own_row);
         k < banded_end(by_moment, first + own_row); k++) {
        double moment = 0.0;
        double impulse = 0.0;
        for (size_t m = 0; m < own; m++) {
            const KernelSpan span = kernel_span(kernel, row + m);
            if (stages->row_of[k] < span.first || stages->row_of[k] >= span.end) {
                continue;
            }
            const double mobility = *kernel_mobility(kernel, row + m, stages->row_of[k]);
            moment += m < 2 ? slopes->by_position[own_row][m] * mobility : 0.0;
            impulse += slopes->by_speed[own_row][m] * mobility;
        }
        *banded_entry(by_moment, first + own_row, k) = moment;
        *banded_entry(by_impulse, first + own_row, k) = impulse;
    }
}

// Forces and their derivatives by impulses and moments at a stage, or at the start of the step.
static void differentiate(const Kernel *kernel, ImplicitStages *stages, size_t which, double time_s,
                          const double *impulse, const double *moment, bool is_smooth)
{
    const size_t n = stages->count;
    shape_slopes(kernel, stages, which);
    for (size_t first = 0, own; first < n; first += own) {
        const size_t row = stages->row_of[first];
        const size_t contact = (size_t)kernel->contact_of[row];
        own = kernel->contacts[contact].row_count;
        KernelSlopes slopes;
        kernel_slopes_find(kernel, contact, time_s, impulse, moment,
                           is_smooth ? stages->from_depth[contact] : 0.0, &slopes);
        memcpy(stages->forces[which] + row, slopes.force, own * sizeof *slopes.force);
        for (size_t i = 0; i < own; i++) {
            differentiate_row(kernel, stages, which, first, i, &slopes);
        }
    }
}

// Impulses and moments at a stage, from what all stages have moved.
static void find_stage(const Kernel *kernel, ImplicitStages *stages, const KernelPoint *from,
                       double width_s, size_t stage)
{
    const size_t rows = kernel_rows(kernel);
    for (size_t i = 0; i < rows; i++) {
        double sum = STAGE_TIME[stage] * from->impulse[i];
        for (size_t j = 0; j < STAGES; j++) {
            sum += STAGE_WEIGHT[stage][j] * stages->moved[j][i];
        }
        stages->impulse[stage][i] = from->impulse[i] + stages->moved[stage][i];
        stages->moment[stage][i] = from->moment[i] + width_s * sum;
        // what the impulses have been on the way is known well enough
        const double since_s = STAGE_TIME[stage] * width_s;
        const double bend = from->impulse[i] / 2.0 + stages->moved[stage][i] / 6.0;
        stages->moment[stage][rows + i] =
            from->moment[rows + i] + since_s * (from->moment[i] + since_s * bend);
    }
}

static void evaluate_stages(Kernel *kernel, ImplicitStages *stages, const KernelPoint *from,
                            double width_s, bool is_smooth)
{
    for (size_t i = 0; i < STAGES; i++) {
        find_stage(kernel, stages, from, width_s, i);
        differentiate(kernel, stages, i, from->time_s + STAGE_TIME[i] * width_s, stages->impulse[i],
                      stages->moment[i], is_smooth);
        kernel->evaluations++;
        kernel_count_work(kernel);
    }
}

// Factors Newton's matrix with the derivatives at the stages, or for all of them those at the
// start.
static bool factor_stages(ImplicitStages *stages, double width_s, bool from_start)
{
    const size_t n = stages->count;
    const Banded *shape = &stages->by_impulse[from_start ? STAGES : 0];
    banded_shape(&stages->matrix, STAGES * n, STAGES * (shape->reach + 1));
    for (size_t s = 0; s < STAGES; s++) {
        for (size_t q = 0; q < STAGES; q++) {
            const Banded *by_impulse = &stages->by_impulse[from_start ? STAGES : q];
            for (size_t i = 0; i < n; i++) {
                const size_t row = unknown(stages, s, i);
                for (size_t k = banded_first(shape, i); k < banded_end(shape, i); k++) {
                    const double own = s == q && i == k ? 1.0 : 0.0;
                    double twice = 0.0;
                    for (size_t j = 0; j < STAGES; j++) {
                        twice += STAGE_WEIGHT[s][j] * STAGE_WEIGHT[j][q] *
                                 *banded_entry(&stages->by_moment[from_start ? STAGES : j], i, k);
                    }
                    *banded_entry(&stages->matrix, row, unknown(stages, q, k)) =
                        own - width_s * (STAGE_WEIGHT[s][q] * *banded_entry(by_impulse, i, k) +
                                         width_s * twice);
                }
            }
        }
    }
    return banded_factor(&stages->matrix);
}

// Counts what it takes to make and to factor Newton's matrix: of a full one count^3 / 3.
static void count_factor(Kernel *kernel, const ImplicitStages *stages)
{
    const double count = (double)stages->matrix.count;
    const double reach = fmin(count, 2.0 * (double)stages->matrix.reach + 1.0);
    kernel->work_done += count * reach * (reach / 3.0 + STAGES);
}

// Newton's next change of what the stages have moved. Returns the largest over what is allowed.
static double correct_stages(const Kernel *kernel, ImplicitStages *stages, const KernelPoint *from,
                             double width_s)
{
    const size_t n = stages->count;
    double *change = stages->change;
    for (size_t s = 0; s < STAGES; s++) {
        for (size_t i = 0; i < n; i++) {
            const size_t row = stages->row_of[i];
            double sum = 0.0;
            for (size_t j = 0; j < STAGES; j++) {
                sum += STAGE_WEIGHT[s][j] * stages->forces[j][row];
            }
            change[unknown(stages, s, i)] = width_s * sum - stages->moved[s][row];
        }
    }
    banded_substitute(&stages->matrix, change);
    double largest = 0.0;
    for (size_t s = 0; s < STAGES; s++) {
        double *impulse = stages->changes[0];
        double *moment = stages->changes[1];
        memset(impulse, 0, kernel->row_count * sizeof *impulse);
        memset(moment, 0, kernel->row_count * sizeof *moment);
        for (size_t i = 0; i < n; i++) {
            const size_t row = stages->row_of[i];
            stages->moved[s][row] += change[unknown(stages, s, i)];
            impulse[row] = change[unknown(stages, s, i)];
            moment[row] = width_s * change[unknown(stages, s, i)];
        }
        const double size =
            error_share(kernel, from, width_s, stages->moved[STAGES - 1], impulse, moment);
        largest = size <= largest ? largest : size;
    }
    return largest;
}

// The forces of a contact at a stage by the derivatives at the start, where nothing but the free
// motion goes on.
static void extend_forces(const Kernel *kernel, ImplicitStages *stages, const KernelPoint *from,
                          double after_s, size_t stage, size_t contact)
{
    const size_t row = kernel->contacts[contact].first_row;
    const size_t own = kernel->contacts[contact].row_count;
    const double *free = kernel->free + row;
    KernelSlopes slopes;
    kernel_slopes_find(kernel, contact, from->time_s, from->impulse, from->moment,
                       stages->from_depth[contact], &slopes);
    const PinHole before =
        kernel_motion_pose(kernel, contact, from->time_s, from->impulse, from->moment);
    const PinHole after = kernel_motion_pose(kernel, contact, from->time_s + after_s,
                                             stages->impulse[stage], stages->moment[stage]);
    const Vec2 moved = vec2_sub(after.eccentricity, before.eccentricity);
    for (size_t i = 0; i < own; i++) {
        double force = slopes.force[i] + slopes.by_position[i][0] * moved.x +
                       slopes.by_position[i][1] * moved.y;
        for (size_t k = 0; k < own; k++) {
            force += slopes.by_speed[i][k] * after_s * free[k];
            if (kernel->input != NULL) {
                // by turns, for what others add is known at one time only
                const double later =
                    kernel_input_at(kernel, from->time_s + after_s)->speed[row + k];
                force += slopes.by_speed[i][k] *
                         (later - kernel_input_at(kernel, from->time_s)->speed[row + k]);
            }
        }
        stages->forces[stage][row + i] = force;
    }
}

// The stages to begin with: of the motion made linear at the start, so that what is about to die
// away there has done so.
static bool guess_stages(const Kernel *kernel, ImplicitStages *stages, const KernelPoint *from,
                         double width_s)
{
    for (size_t s = 0; s < STAGES; s++) {
        memset(stages->moved[s], 0, kernel->row_count * sizeof *stages->moved[s]);
    }
    differentiate(kernel, stages, STAGES, from->time_s, from->impulse, from->moment, true);
    for (size_t s = 0; s < STAGES; s++) {
        find_stage(kernel, stages, from, width_s, s);
        for (size_t i = 0; i < kernel->contact_count; i++) {
            if (kernel->contacts[i].state.is_touching) {
                extend_forces(kernel, stages, from, STAGE_TIME[s] * width_s, s, i);
            }
        }
    }
    if (!factor_stages(stages, width_s, true)) {
        return false;
    }
    correct_stages(kernel, stages, from, width_s);
    return true;
}

// Newton's method with smooth forces or with those that never pull.
static bool iterate_stages(Kernel *kernel, ImplicitStages *stages, const KernelPoint *from,
                           double width_s, bool is_smooth)
{
    for (int i = 0; i < NEWTON_MOST; i++) {
        evaluate_stages(kernel, stages, from, width_s, is_smooth);
        count_factor(kernel, stages);
        if (!factor_stages(stages, width_s, false)) {
            return false;
        }
        const double size = correct_stages(kernel, stages, from, width_s);
        if (size <= NEWTON_LEFT_MOST) {
            return true;
        }
        if (!(size < INFINITY)) {
            return false;
        }
    }
    return false;
}

// Whether the forces of a contact at the stages are where the smooth ones are right.
static bool is_contact_pressing(const Kernel *kernel, const ImplicitStages *stages,
                                const KernelPoint *from, double width_s, size_t contact)
{
    const size_t row = kernel->contacts[contact].first_row;
    for (size_t s = 0; s < STAGES; s++) {
        const PinHole pose =
            kernel_motion_pose(kernel, contact, from->time_s + STAGE_TIME[s] * width_s,
                               stages->impulse[s], stages->moment[s]);
        const double along =
            pose.normal.x * stages->forces[s][row] + pose.normal.y * stages->forces[s][row + 1];
        if (!(along >= 0.0 && pose.penetration >= stages->from_depth[contact])) {
            return false;
        }
    }
    return true;
}

static bool is_pressing(const Kernel *kernel, const ImplicitStages *stages, const KernelPoint *from,
                        double width_s)
{
    for (size_t i = 0; i < kernel->contact_count; i++) {
        if (kernel->contacts[i].state.is_touching &&
            !is_contact_pressing(kernel, stages, from, width_s, i)) {
            return false;
        }
    }
    return true;
}

// Solves for the stages of a step of a length, s, from a completed point. Returns false where
// Newton's method does not get there.
static bool solve_stages(Kernel *kernel, ImplicitStages *stages, const KernelPoint *from,
                         double width_s)
{
    list_rows(kernel, stages, from);
    const bool is_solved = guess_stages(kernel, stages, from, width_s) &&
                           ((iterate_stages(kernel, stages, from, width_s, true) &&
                             is_pressing(kernel, stages, from, width_s)) ||
                            iterate_stages(kernel, stages, from, width_s, false));
    for (size_t i = 0; is_solved && i < STAGES; i++) {
        find_stage(kernel, stages, from, width_s, i);
        kernel_force_find(kernel, from->time_s + STAGE_TIME[i] * width_s, stages->impulse[i],
                          stages->moment[i], stages->forces[i], stages->powers[i]);
    }
    return is_solved;
}

// clang-format off
static const double EMBEDDED[STAGES] = {(-13.0 - 7.0 * ROOT_6) / 3.0, (-13.0 + 7.0 * ROOT_6) / 3.0, -1.0 / 3.0};
static const double EIGENVALUE = 0.27488882959568;
// clang-format on

// of what is stable: where the damping stops the pin, explicit steps have to follow that
static const double OVERDAMPED_SHARE = 0.01;

static const double IMPLICIT_SAFETY = 0.9; // of the step that would have just the error allowed
static const double SHRINK_MOST = 0.1;
static const double GROW_MOST = 6.0;

void kernel_implicit_finish(Kernel *kernel)
{
    destroy_stages(kernel->stages);
    kernel->stages = NULL;
}

bool kernel_implicit_is_needed(const Kernel *kernel, const KernelPoint *point, double explicit_s,
                               double frictionless_s)
{
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        if (!contact->state.is_touching ||
            (contact->law.hysteresis == 0.0 && contact->law.viscous == 0.0)) {
            continue;
        }
        const PinHole pose = *kernel_point_pose(kernel, point, i);
        const double width_s = contact->is_overdamped ? frictionless_s : explicit_s;
        // as deep as the step leads
        const double depth = fmax(pose.penetration, 0.0) + width_s * fmax(pose.approach_speed, 0.0);
        const double decays = kernel_force_decay(kernel, i, pose.normal, depth) * width_s;
        if (decays > (contact->is_overdamped ? OVERDAMPED_SHARE : 1.0) * kernel->stable) {
            return true;
        }
    }
    return false;
}

// Factors the matrix of the estimate, in place of Newton's.
static bool factor_estimate(ImplicitStages *stages, double hg)
{
    const Banded *by_impulse = &stages->by_impulse[STAGES];
    const Banded *by_moment = &stages->by_moment[STAGES];
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
static void find_errors(const Kernel *kernel, const ImplicitStages *stages, const KernelPoint *from,
                        double hg, const double *force, const double *rate, double *impulse,
                        double *moment)
{
    const size_t n = stages->count;
    double *position = kernel->work->positions;
    double *sum = kernel->work->speeds;
    for (size_t i = 0; i < n; i++) {
        const size_t row = stages->row_of[i];
        sum[i] = hg * force[row];
        position[i] = hg * rate[row];
        for (size_t s = 0; s < STAGES; s++) {
            sum[i] += EIGENVALUE * EMBEDDED[s] * stages->moved[s][row];
            position[i] += EIGENVALUE * EMBEDDED[s] * (stages->moment[s][row] - from->moment[row]);
        }
    }
    for (size_t i = 0; i < n; i++) {
        const Banded *by_moment = &stages->by_moment[STAGES];
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
static double estimate_error(Kernel *kernel, ImplicitStages *stages, const KernelPoint *from,
                             double width_s)
{
    const double hg = EIGENVALUE * width_s;
    const double *moved = stages->moved[STAGES - 1];
    const size_t rows = kernel_rows(kernel);
    double *impulse = kernel->work->errors[0];
    double *moment = kernel->work->errors[1];
    memset(impulse, 0, rows * sizeof *impulse);
    memset(moment, 0, rows * sizeof *moment);
    if (!factor_estimate(stages, hg)) {
        return INFINITY;
    }
    find_errors(kernel, stages, from, hg, from->force, from->impulse, impulse, moment);
    const double first = error_share(kernel, from, width_s, moved, impulse, moment);
    if (first <= 1.0) {
        return first;
    }
    double powers[2];
    double *force = kernel->work->errors[2];
    double *rate = kernel->work->errors[3];
    double *sum = kernel->work->errors[4];
    for (size_t i = 0; i < rows; i++) {
        rate[i] = from->impulse[i] + impulse[i];
        sum[i] = from->moment[i] + moment[i];
        sum[rows + i] = from->moment[rows + i];
    }
    kernel_force_find(kernel, from->time_s, rate, sum, force, powers);
    find_errors(kernel, stages, from, hg, force, rate, impulse, moment);
    return error_share(kernel, from, width_s, moved, impulse, moment);
}

double kernel_implicit_step(Kernel *kernel, const KernelPoint *from, double width_s,
                            KernelPoint *to)
{
    if (kernel->stages == NULL) {
        create_stages(kernel);
    }
    ImplicitStages *stages = kernel->stages;
    const bool is_solved = solve_stages(kernel, stages, from, width_s);
    kernel_point_begin(kernel, to, from->time_s + width_s);
    const size_t rows = kernel_rows(kernel);
    memcpy(to->impulse, stages->impulse[STAGES - 1], rows * sizeof *to->impulse);
    memcpy(to->moment, stages->moment[STAGES - 1], 2 * rows * sizeof *to->moment);
    for (size_t i = 0; i < 2; i++) {
        double sum = 0.0;
        for (size_t s = 0; s < STAGES; s++) {
            sum += STAGE_WEIGHT[STAGES - 1][s] * stages->powers[s][i];
        }
        to->losses[i] = from->losses[i] + width_s * sum;
    }
    return is_solved ? estimate_error(kernel, stages, from, width_s) : INFINITY;
}

double kernel_implicit_next(double width_s, double error)
{
    return width_s * fmin(GROW_MOST, fmax(SHRINK_MOST, IMPLICIT_SAFETY * pow(error, -0.25)));
}

void kernel_implicit_settled(const Kernel *kernel, double *force)
{
    // the parabola through the stages' forces
    const ImplicitStages *stages = kernel->stages;
    for (size_t i = 0; i < stages->count; i++) {
        const size_t row = stages->row_of[i];
        force[row] = 0.0;
        for (size_t s = 0; s < STAGES; s++) {
            double weight = 1.0;
            for (size_t k = 0; k < STAGES; k++) {
                weight *= k == s ? 1.0 : STAGE_TIME[k] / (STAGE_TIME[k] - STAGE_TIME[s]);
            }
            force[row] += weight * stages->forces[s][row];
        }
    }
}
