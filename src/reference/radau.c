// Integrates motion whose contacts are damped so strongly that explicit steps get nowhere.
//
//     u_i = u_0 + h sum a_ij A(t_j, q_j, u_j),   q_i = q_0 + h sum a_ij u_j
// by Newton's method for z_i = u_i - u_0, with derivatives D = dA/du, S = dA/dq at each stage:
//     (1 - h a D - h^2 a S a) dz = h sum a_ij A_j - z_i
//     error = b7^2 / sqrt(b7^2 + 0.01 b6^2),   b_k: Legendre coefficients of the step's polynomial
// q coordinates, u their rates, A accelerations, a the couplings.
//
// L-stable: what a strong damper has made die away does not come back, whatever the step.
// Source: Hairer and Wanner 1996, sections IV.5 and IV.8; the coefficients
// stand at the end of this file.
#include "reference/integrators.h"

#include "base/dense.h"
#include "base/room.h"
#include "base/zeroed.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// of Newton's method, and after how many its matrix is made anew
enum { ITERATIONS = 12, RENEWAL = 4 };

enum { POWERS = 8 }; // by which the largest rate of decay is found: some hundredths suffice

// of the error allowed: what Newton's method may leave
static const double SOLVED = 0.01;
// it has come to rounding where it moves the stages less than allowed and hardly less than before
static const double STALLED = 0.3;
// from one iteration to the next; from one to the one after that it may well fall
static const double DIVERGED = 4.0;
// a step longer than the one before by more than this factor starts from no polynomial
static const double FURTHEST = 3.0;

// evaluations of the stages for which the next step may be as long
static const double EASY = 9.0;
// over what is allowed: a step that was not solved for is tried again at half its length
static const double FAILED = 110.0;

static size_t freedoms_of(const Dop853 *integrator)
{
    return integrator->motion_size / 2;
}

void radau_destroy(Radau *radau)
{
    if (radau != NULL) {
        radau_newton_finish(&radau->newton);
        coupling_destroy(radau->own_coupling);
        free(radau->memory);
        free(radau);
    }
}

// The largest rate of decay: the largest eigenvalue of minus the derivatives by the rates, by
// powers of these. All are real and not negative, as far as dampers go, so that it lies between the
// mean of all and their sum.
static double largest_decay(const Radau *radau, const double *by_rate)
{
    const Coupling *coupling = radau->newton.coupling;
    const size_t n = coupling->count;
    double *from = radau->change;
    double *to = radau->change + n;
    double sum = 0.0;
    double grown = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum -= coupling_entry(coupling, by_rate, i, i);
        from[i] = 1.0;
    }
    for (int power = 0; power < POWERS && sum > 0.0; power++) {
        double square = 0.0;
        coupling_multiply(coupling, by_rate, from, to);
        for (size_t i = 0; i < n; i++) {
            to[i] = -to[i];
            square += to[i] * to[i];
        }
        grown = sqrt(square);
        for (size_t i = 0; i < n && grown > 0.0; i++) {
            from[i] = to[i] / grown;
        }
    }
    return fmin(sum, fmax(grown, sum / (double)n));
}

// Moves a coordinate or rate of each part of a colour that has so many, and keeps where it was.
// Returns whether one has.
static bool nudge(const Radau *radau, size_t colour, size_t number, size_t behind, double *y)
{
    const Coupling *coupling = radau->newton.coupling;
    bool has_any = false;
    for (size_t i = coupling->first_coloured[colour]; i < coupling->first_coloured[colour + 1];
         i++) {
        const size_t part = coupling->coloured[i];
        const size_t entry = coupling->first_coordinate[part] + number;
        if (entry < coupling->first_coordinate[part + 1]) {
            const size_t k = coupling->coordinates[entry] + behind;
            radau->kept[k] = y[k];
            y[k] += radau->nudge[k];
            has_any = true;
        }
    }
    return has_any;
}

// Takes these back, and writes how they changed the accelerations.
static void take_differences(const Radau *radau, size_t colour, size_t number, size_t behind,
                             const double *rates, double *y, double *by)
{
    const Coupling *coupling = radau->newton.coupling;
    const double *changed = radau->changed + coupling->count;
    const double *before = rates + coupling->count;
    for (size_t i = coupling->first_coloured[colour]; i < coupling->first_coloured[colour + 1];
         i++) {
        const size_t part = coupling->coloured[i];
        const size_t entry = coupling->first_coordinate[part] + number;
        if (entry >= coupling->first_coordinate[part + 1]) {
            continue;
        }
        const size_t column = coupling->coordinates[entry];
        const double moved = y[column + behind] - radau->kept[column + behind];
        y[column + behind] = radau->kept[column + behind];
        // those that it depends on depend on it
        const size_t *rows = coupling_columns(coupling, part);
        for (size_t k = 0; k < coupling_width(coupling, part); k++) {
            const size_t row = rows[k];
            const size_t index = coupling_column_index(coupling, coupling->part_of[row], column);
            by[coupling->first_value[row] + index] = (changed[row] - before[row]) / moved;
        }
    }
}

// Derivatives of the accelerations by the coordinates, or by their rates, which are so far behind
// them, at a state whose rates are known.
static void differentiate(const Radau *radau, Dop853 *integrator, double time, double *y,
                          const double *rates, size_t behind, double *by)
{
    const Coupling *coupling = radau->newton.coupling;
    for (size_t colour = 0; colour < coupling->colour_count; colour++) {
        for (size_t number = 0; nudge(radau, colour, number, behind, y); number++) {
            integrator->rates(time, y, radau->changed, integrator->context);
            integrator->evaluations++;
            take_differences(radau, colour, number, behind, rates, y, by);
        }
    }
}

double radau_find_decay(Radau *radau, Dop853 *integrator)
{
    memcpy(radau->y, integrator->y, integrator->size * sizeof *radau->y);
    differentiate(radau, integrator, integrator->time, radau->y, integrator->stages[0],
                  freedoms_of(integrator), radau->newton.by_rate[0]);
    radau->decay = largest_decay(radau, radau->newton.by_rate[0]);
    radau->before_s = 0.0;
    return radau->decay;
}

// The state at a stage, its coordinates from the rates of all stages.
static void find_stage(Radau *radau, const Dop853 *integrator, double step, size_t stage, double *y)
{
    const size_t n = freedoms_of(integrator);
    double *moved = radau->moved[stage];
    memcpy(y, integrator->y, integrator->size * sizeof *y);
    for (size_t k = 0; k < n; k++) {
        double sum = 0.0;
        for (size_t j = 0; j < RADAU_STAGES; j++) {
            sum += RADAU_COUPLING[stage][j] * radau->moved[j][n + k];
        }
        moved[k] = step * (RADAU_NODE[stage] * integrator->y[n + k] + sum);
        y[k] += moved[k];
        y[n + k] += moved[n + k];
    }
}

// The derivatives at a stage whose rates are known.
static void find_slopes(Radau *radau, Dop853 *integrator, double time, double *y, size_t stage)
{
    double *by_position = radau->newton.by_position[stage];
    double *by_rate = radau->newton.by_rate[stage];
    if (integrator->slopes == NULL) {
        const double *rates = radau->rates[stage];
        differentiate(radau, integrator, time, y, rates, 0, by_position);
        differentiate(radau, integrator, time, y, rates, freedoms_of(integrator), by_rate);
        return;
    }
    integrator->slopes(time, y, by_position, by_rate, integrator->context);
    integrator->evaluations++;
}

// The rates at all stages, with their derivatives where they are asked for.
static void evaluate_stages(Radau *radau, Dop853 *integrator, double step, bool with_derivatives)
{
    double *y = radau->y;
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        const double time = integrator->time + RADAU_NODE[i] * step;
        find_stage(radau, integrator, step, i, y);
        integrator->rates(time, y, radau->rates[i], integrator->context);
        integrator->evaluations++;
        if (with_derivatives) {
            find_slopes(radau, integrator, time, y, i);
        }
    }
    if (with_derivatives) {
        radau->decay = largest_decay(radau, radau->newton.by_rate[RADAU_STAGES - 1]);
    }
}

// The rates at the stages to begin with: from the polynomial of the step before, which goes on, or
// of a longer one from here; else with the accelerations at the start.
static void guess(Radau *radau, const Dop853 *integrator, double step)
{
    const size_t n = freedoms_of(integrator);
    const double origin = radau->filled == integrator->accepted ? 0.0 : 1.0;
    const bool is_known = step < FURTHEST * radau->before_s;
    const double share = is_known ? step / radau->before_s : 0.0;
    double *start = radau->start;
    double *y = radau->y;
    dop853_polynomial(integrator, origin, start);
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        dop853_polynomial(integrator, origin + RADAU_NODE[i] * share, y);
        for (size_t k = n; k < 2 * n; k++) {
            const double steady = RADAU_NODE[i] * step * integrator->stages[0][k];
            radau->moved[i][k] = is_known ? y[k] - start[k] : steady;
        }
    }
}

// How far Newton's method moves the stages' rates next, over what is allowed.
static double correct(const Radau *radau, const Dop853 *integrator, double step, double *change)
{
    const size_t n = freedoms_of(integrator);
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        for (size_t k = 0; k < n; k++) {
            double sum = 0.0;
            for (size_t j = 0; j < RADAU_STAGES; j++) {
                sum += RADAU_COUPLING[i][j] * radau->rates[j][n + k];
            }
            change[i * n + k] = step * sum - radau->moved[i][n + k];
        }
    }
    radau_newton_solve(&radau->newton, change);
    double largest = 0.0;
    for (size_t i = 0; i < RADAU_STAGES * n; i++) {
        const double share = fabs(change[i]) / integrator->fixed[n + i % n];
        largest = share <= largest ? largest : share; // a NaN must show
    }
    return largest;
}

// Solves for the stages. Returns how many times they were evaluated, INFINITY where Newton's method
// gets nowhere.
static double radau_solve(Radau *radau, Dop853 *integrator, double step)
{
    const size_t n = freedoms_of(integrator);
    double *change = radau->change;
    double before = INFINITY;
    guess(radau, integrator, step);
    for (int iteration = 0; iteration < ITERATIONS; iteration++) {
        const bool is_new = iteration % RENEWAL == 0;
        evaluate_stages(radau, integrator, step, is_new);
        if (is_new && !radau_newton_factor(&radau->newton, step)) {
            return INFINITY;
        }
        const double size = correct(radau, integrator, step, change);
        if (size <= SOLVED || (size <= 1.0 && size > STALLED * before)) {
            return iteration + 1;
        }
        if (!(size < DIVERGED * before)) {
            return INFINITY;
        }
        before = size;
        for (size_t i = 0; i < RADAU_STAGES * n; i++) {
            radau->moved[i / n][n + i % n] += change[i];
        }
    }
    return INFINITY;
}

static void weigh_moved(const Radau *radau, const Dop853 *integrator, const double *weights,
                        double *sum)
{
    for (size_t k = 0; k < integrator->size; k++) {
        sum[k] = 0.0;
        for (size_t i = 0; i < RADAU_STAGES; i++) {
            sum[k] += weights[i] * radau->moved[i][k];
        }
    }
}

static double try_step(Dop853Method *method, Dop853 *integrator, double step)
{
    Radau *radau = (Radau *)method;
    integrator->tried = step;
    const double effort = radau_solve(radau, integrator, step) / EASY;
    if (!(effort < INFINITY)) {
        for (size_t k = 0; k < integrator->size; k++) {
            integrator->next[k] = NAN;
        }
        return FAILED;
    }
    for (size_t k = integrator->motion_size; k < integrator->size; k++) {
        for (size_t i = 0; i < RADAU_STAGES; i++) {
            radau->moved[i][k] = 0.0;
            for (size_t j = 0; j < RADAU_STAGES; j++) {
                radau->moved[i][k] += step * RADAU_COUPLING[i][j] * radau->rates[j][k];
            }
        }
    }
    dop853_end(integrator, radau->moved[RADAU_STAGES - 1]);
    for (int i = 0; i < 2; i++) {
        weigh_moved(radau, integrator, RADAU_LAST[i], integrator->errors[i]);
    }
    const double error =
        dop853_judge(integrator, integrator->errors[0], integrator->errors[1], 1.0);
    // a step that was hard to solve for is no reason for a longer one
    return error > 1.0 ? error : fmax(error, fmin(1.0, pow(effort, 8.0)));
}

static void radau_fill(Dop853Method *method, Dop853 *integrator)
{
    Radau *radau = (Radau *)method;
    double *const *p = integrator->polynomial;
    memcpy(p[0], integrator->y, integrator->size * sizeof *p[0]);
    memcpy(p[1], radau->moved[RADAU_STAGES - 1], integrator->size * sizeof *p[1]);
    for (size_t row = 0; row < RADAU_DENSE_ROWS; row++) {
        weigh_moved(radau, integrator, RADAU_DENSE[row], p[2 + row]);
    }
    radau->before_s = integrator->tried;
    radau->filled = integrator->accepted;
}

// The next so many of the doubles that are left.
static double *radau_take(double **left, size_t count)
{
    double *taken = *left;
    *left += count;
    return taken;
}

// Shares out the memory of the vectors.
static void take_vectors(Radau *radau, size_t size, size_t n, double *left)
{
    radau->nudge = radau_take(&left, size);
    radau->y = radau_take(&left, size);
    radau->changed = radau_take(&left, size);
    radau->kept = radau_take(&left, size);
    radau->start = radau_take(&left, size);
    radau->change = radau_take(&left, RADAU_STAGES * n);
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        radau->moved[i] = radau_take(&left, size);
        radau->rates[i] = radau_take(&left, size);
    }
}

Radau *radau_create(const Dop853 *integrator)
{
    const size_t n = freedoms_of(integrator);
    const size_t size = integrator->size;
    const size_t count = 5 * size + RADAU_STAGES * (n + 2 * size);
    Radau *radau = calloc(1, sizeof *radau);
    assert(radau != NULL);
    radau->method = (Dop853Method){.try_step = try_step, .fill = radau_fill};
    radau->memory = calloc(count, sizeof *radau->memory);
    assert(radau->memory != NULL);
    const Coupling *coupling = integrator->coupling;
    radau->own_coupling = coupling == NULL ? coupling_create_full(n) : NULL;
    radau_newton_init(&radau->newton, coupling == NULL ? radau->own_coupling : coupling);
    take_vectors(radau, size, n, radau->memory);
    return radau;
}

void radau_carry(Radau *radau, Carry *carry)
{
    CARRY_ARRAY(carry, radau->nudge, 2 * radau->newton.coupling->count);
    CARRY(carry, radau->decay);
    CARRY(carry, radau->before_s);
    CARRY(carry, radau->filled);
}

// The linear equations of Newton's method for all stages of an implicit step, in separate blocks.
//
//     (1 - h a D - h^2 a S a) dz = r
// a the couplings, D and S the derivatives of the accelerations by rates and coordinates at each
// stage. Coordinates that never depend on one another make blocks of their own.

void radau_newton_init(RadauNewton *newton, const Coupling *coupling)
{
    const size_t count = coupling->count;
    const size_t values = coupling_value_count(coupling);
    *newton = (RadauNewton){.coupling = coupling, .count = count};
    newton->by_position[0] = zeroed(2 * RADAU_STAGES * values, sizeof(double));
    newton->own = zeroed(RADAU_STAGES * count, sizeof *newton->own);
    newton->blocks = zeroed(count, sizeof *newton->blocks);
    newton->coordinates = zeroed(count, sizeof *newton->coordinates);
    newton->index_in_block = zeroed(count, sizeof *newton->index_in_block);
    newton->is_taken = zeroed(count, sizeof *newton->is_taken);
    newton->pivots = zeroed(RADAU_STAGES * count, sizeof *newton->pivots);
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        newton->by_position[i] = newton->by_position[0] + i * values;
        newton->by_rate[i] = newton->by_position[0] + (RADAU_STAGES + i) * values;
    }
}

void radau_newton_finish(RadauNewton *newton)
{
    free(newton->by_position[0]);
    free(newton->own);
    free(newton->blocks);
    free(newton->coordinates);
    free(newton->index_in_block);
    free(newton->is_taken);
    free(newton->matrix);
    free(newton->pivots);
}

// Whether an entry of the derivatives is other than zero at any stage.
static bool has_derivative(const RadauNewton *newton, size_t value)
{
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        if (newton->by_position[i][value] != 0.0 || newton->by_rate[i][value] != 0.0) {
            return true;
        }
    }
    return false;
}

// Whether one of two coordinates depends on the other, of which `b` is the column at an entry of
// the rows of the part of `a`.
static bool are_coupled(const RadauNewton *newton, size_t a, size_t entry, size_t b)
{
    const Coupling *coupling = newton->coupling;
    return has_derivative(newton, coupling->first_value[a] + entry) ||
           has_derivative(newton, coupling->first_value[b] +
                                      coupling_column_index(coupling, coupling->part_of[b], a));
}

// The unknowns of a block, how far from the diagonal these equations reach, and how many values
// its matrix has.
static size_t width_of(const RadauBlock *block)
{
    return RADAU_STAGES * block->size;
}

static size_t reach_of(const RadauBlock *block)
{
    return RADAU_STAGES * (block->reach + 1);
}

static size_t newton_size_of(const RadauBlock *block)
{
    const size_t width = width_of(block);
    return block->is_banded ? banded_size(width, reach_of(block)) : width * width;
}

// Sorts the coordinates into blocks: each takes in, one after the other, all that its coordinates
// are coupled with, so that those which depend on each other are near to each other; or may be
// coupled with, where derivatives are not asked.
static void find_blocks(RadauNewton *newton, bool has_derivatives)
{
    const Coupling *coupling = newton->coupling;
    const size_t n = coupling->count;
    bool *is_taken = newton->is_taken;
    memset(is_taken, 0, n * sizeof *is_taken);
    size_t count = 0;
    newton->block_count = 0;
    for (size_t first = 0; first < n; first++) {
        if (is_taken[first]) {
            continue;
        }
        const size_t start = count;
        RadauBlock *block = &newton->blocks[newton->block_count++];
        block->reach = 0;
        is_taken[first] = true;
        newton->index_in_block[first] = 0;
        newton->coordinates[count++] = first;
        for (size_t at = start; at < count; at++) {
            const size_t part = coupling->part_of[newton->coordinates[at]];
            const size_t *columns = coupling_columns(coupling, part);
            for (size_t i = 0; i < coupling_width(coupling, part); i++) {
                const size_t k = columns[i];
                if (is_taken[k] && newton->index_in_block[k] + start <= at) {
                    continue;
                }
                if (has_derivatives && !are_coupled(newton, newton->coordinates[at], i, k)) {
                    continue;
                }
                if (!is_taken[k]) {
                    is_taken[k] = true;
                    newton->index_in_block[k] = count - start;
                    newton->coordinates[count++] = k;
                }
                const size_t apart = newton->index_in_block[k] + start - at;
                block->reach = apart > block->reach ? apart : block->reach;
            }
        }
        block->size = count - start;
        block->is_banded = 2 * reach_of(block) + 1 < width_of(block);
    }
}

// Instructions, counted on a row of 24 four-bars with play in all joints: of an evaluation of the
// accelerations and of an explicit step for each coordinate, of the derivatives and of filling
// Newton's matrix at all stages for each of their values, and of factoring it and solving for each
// multiplication.
static const double EVALUATION_WORK = 130.0;
static const double EXPLICIT_WORK = 2600.0;
static const double SLOPES_WORK = 280.0;
static const double FILL_WORK = 3500.0;
static const double FACTOR_WORK = 3.4;
static const double SOLVE_WORK = 9.0;

enum { USUAL_ITERATIONS = 4 }; // of Newton's method, with one matrix

double radau_step_cost(Radau *radau)
{
    RadauNewton *newton = &radau->newton;
    const double n = (double)newton->count;
    const double values = (double)coupling_value_count(newton->coupling);
    double work = (RADAU_STAGES * SLOPES_WORK + FILL_WORK) * values;
    find_blocks(newton, false);
    for (size_t i = 0; i < newton->block_count; i++) {
        const RadauBlock *block = &newton->blocks[i];
        const double width = (double)width_of(block);
        const double reach = (double)reach_of(block);
        const double factored =
            block->is_banded ? 2.0 * width * reach * reach : width * width * width / 3.0;
        const double solved = width * (block->is_banded ? 3.0 * reach : width);
        work += FACTOR_WORK * factored + USUAL_ITERATIONS * SOLVE_WORK * solved;
    }
    work += USUAL_ITERATIONS * RADAU_STAGES * EVALUATION_WORK * n;
    return work / (EXPLICIT_WORK * n);
}

// How the equation of one coordinate at a stage depends on the rate of another at another stage.
typedef struct Weights {
    double rate;                    // s, of the derivative by rates at the other stage
    double positions[RADAU_STAGES]; // s^2, of those by coordinates at all stages
} Weights;

static Weights weights_of(double step, size_t stage, size_t other)
{
    Weights weights = {.rate = step * RADAU_COUPLING[stage][other]};
    for (size_t k = 0; k < RADAU_STAGES; k++) {
        weights.positions[k] = RADAU_COUPLING[stage][k] * RADAU_COUPLING[k][other];
    }
    return weights;
}

static double entry(const RadauNewton *newton, size_t at, const Weights *weights, double step,
                    size_t other, bool is_own)
{
    double twice = 0.0;
    for (size_t k = 0; k < RADAU_STAGES; k++) {
        twice += weights->positions[k] * newton->by_position[k][at];
    }
    return (is_own ? 1.0 : 0.0) - weights->rate * newton->by_rate[other][at] - step * step * twice;
}

// A matrix of a block, dense, the unknowns stage by stage; or banded, coordinate by coordinate.
typedef struct Matrix {
    double *dense; // NULL: banded
    const Banded *banded;
    size_t size; // of the block
} Matrix;

static double *matrix_entry(const Matrix *matrix, size_t stage, size_t row, size_t other,
                            size_t column)
{
    if (matrix->dense == NULL) {
        return banded_entry(matrix->banded, RADAU_STAGES * row + stage,
                            RADAU_STAGES * column + other);
    }
    const size_t m = matrix->size;
    return &matrix->dense[(stage * m + row) * RADAU_STAGES * m + other * m + column];
}

// What fills a matrix: of each stage by each other.
typedef struct Filling {
    double step;
    Weights weights[RADAU_STAGES][RADAU_STAGES];
} Filling;

static Filling filling_of(double step)
{
    Filling filling = {.step = step};
    for (size_t stage = 0; stage < RADAU_STAGES; stage++) {
        for (size_t other = 0; other < RADAU_STAGES; other++) {
            filling.weights[stage][other] = weights_of(step, stage, other);
        }
    }
    return filling;
}

// What a row of a block has of one of its columns, by the value of the derivatives there.
static void fill_entries(const RadauNewton *newton, const Filling *filling, size_t row,
                         size_t column, size_t value, const Matrix *matrix)
{
    for (size_t stage = 0; stage < RADAU_STAGES; stage++) {
        for (size_t other = 0; other < RADAU_STAGES; other++) {
            *matrix_entry(matrix, stage, row, other, column) =
                entry(newton, value, &filling->weights[stage][other], filling->step, other,
                      stage == other && row == column);
        }
    }
}

// Fills Newton's matrix of a block, which is all zeros.
static void newton_fill(const RadauNewton *newton, const size_t *coordinates,
                        const Filling *filling, const Matrix *matrix)
{
    const Coupling *coupling = newton->coupling;
    for (size_t row = 0; row < matrix->size; row++) {
        const size_t part = coupling->part_of[coordinates[row]];
        const size_t *columns = coupling_columns(coupling, part);
        const size_t first = coupling->first_value[coordinates[row]];
        for (size_t i = 0; i < coupling_width(coupling, part); i++) {
            const size_t column = newton->index_in_block[columns[i]];
            // others are those of other blocks, zeros
            if (column < matrix->size && coordinates[column] == columns[i]) {
                fill_entries(newton, filling, row, column, first + i, matrix);
            }
        }
    }
}

// Makes room for the blocks: one for all, because which blocks there are differs from step to step.
static void newton_make_room(RadauNewton *newton)
{
    size_t room = 0;
    for (size_t i = 0; i < newton->block_count; i++) {
        room += newton_size_of(&newton->blocks[i]);
    }
    newton->matrix = room_grow(newton->matrix, &newton->room, room, sizeof *newton->matrix);
}

bool radau_newton_factor(RadauNewton *newton, double step)
{
    const Filling filling = filling_of(step);
    find_blocks(newton, true);
    newton_make_room(newton);
    const size_t *coordinates = newton->coordinates;
    double *matrix = newton->matrix;
    size_t *pivots = newton->pivots;
    for (size_t i = 0; i < newton->block_count; i++) {
        RadauBlock *block = &newton->blocks[i];
        const size_t width = width_of(block);
        if (block->is_banded) {
            banded_shape_in(&block->banded, width, reach_of(block), matrix, pivots);
            newton_fill(newton, coordinates, &filling,
                        &(Matrix){NULL, &block->banded, block->size});
            if (!banded_factor(&block->banded)) {
                return false;
            }
        } else {
            memset(matrix, 0, width * width * sizeof *matrix);
            newton_fill(newton, coordinates, &filling, &(Matrix){matrix, NULL, block->size});
            if (!dense_factor(width, matrix, pivots)) {
                return false;
            }
        }
        matrix += newton_size_of(block);
        pivots += width;
        coordinates += block->size;
    }
    return true;
}

void radau_newton_solve(const RadauNewton *newton, double *change)
{
    const size_t n = newton->count;
    const size_t *coordinates = newton->coordinates;
    const double *matrix = newton->matrix;
    const size_t *pivots = newton->pivots;
    double *own = newton->own;
    for (size_t i = 0; i < newton->block_count; i++) {
        const RadauBlock *block = &newton->blocks[i];
        const size_t m = block->size;
        const size_t width = width_of(block);
        // strides of stages and of coordinates
        const size_t by_stage = block->is_banded ? 1 : m;
        const size_t by_coordinate = block->is_banded ? RADAU_STAGES : 1;
        for (size_t k = 0; k < width; k++) {
            own[k / m * by_stage + k % m * by_coordinate] = change[k / m * n + coordinates[k % m]];
        }
        if (block->is_banded) {
            banded_substitute(&block->banded, own);
        } else {
            dense_substitute(width, matrix, pivots, own);
        }
        matrix += newton_size_of(block);
        pivots += width;
        for (size_t k = 0; k < width; k++) {
            change[k / m * n + coordinates[k % m]] = own[k / m * by_stage + k % m * by_coordinate];
        }
        coordinates += m;
    }
}

// The coefficients of the Radau IIA method of order 13, of its dense output and of its error
// estimate.
//
// Nodes: the zeros of P_7(2 c - 1) - P_6(2 c - 1), P the Legendre polynomials. The couplings
// integrate every polynomial of degree 6 from 0 to each node. All others belong to the polynomial
// of degree 7 through the start and the seven stages: its last two coefficients in P_k(2 s - 1),
// and those of the form in which reference/integrators.h keeps it. Worked out in 60 digits; a test
// repeats the conditions. Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II,
// 2nd ed., 1996, IV.5.

// clang-format off
const double RADAU_NODE[RADAU_STAGES] = {
    2.931642715978489197205e-2,
    0.14807859966848429185,
    0.3369846902811542990971,
    0.5586715187715501320814,
    0.7692338620300545009169,
    0.9269456713197411148519,
    1.0,
};

const double RADAU_COUPLING[RADAU_STAGES][RADAU_STAGES] = {
    {3.754626499392133133369e-2, -1.403933455646040153763e-2, 1.035278960074230093676e-2,
     -8.158322540275011909205e-3, 6.388413879534684943756e-3, -4.602326779148655499352e-3,
     1.828942561470643704036e-3},
    {8.014759651561896779522e-2, 8.106206398589153667958e-2, -2.123799212071103493709e-2,
     1.400029123881711898374e-2, -1.02341857300901638292e-2, 7.153465151364590498062e-3,
     -2.812639372406723340343e-3},
    {7.206384694188190211336e-2, 0.1710683549838866194244, 0.1096145640400721092332,
     -2.461987172898405386232e-2, 1.47603770439508170732e-2, -9.575259396791400556329e-3,
     3.67267839713830567157e-3},
    {7.570512581982442042464e-2, 0.1540901551421711446463, 0.2271077366732023864113,
     0.1174781870370247819879, -2.381082715304417358205e-2, 1.270998553366120563361e-2,
     -4.608844281289633440336e-3},
    {7.391234216319184654081e-2, 0.1613556076159424321862, 0.2068672415521041978196,
     0.2370071153426942347622, 0.1030867935338134466241, -1.885413915258044884005e-2,
     5.858900974888791823978e-3},
    {7.470556205979623017229e-2, 0.1583072238724687006585, 0.2141534232672000311087,
     0.2198778470318600399875, 0.1987521216806352698018, 6.926550160550913323097e-2,
     -8.116008197728290107881e-3},
    {7.449423555601031793325e-2, 0.1591021157336507408724, 0.2123518895029778041992,
     0.2235549145072832347497, 0.190474936822115576903, 0.1196137446126562028935,
     2.040816326530612244898e-2},
};

const double RADAU_LAST[2][RADAU_STAGES] = {
    {0.7970321092805208905987, -0.5182768760982382305014, 0.3969108617453963437588,
     -0.316288826124967112631, 0.2488053568015006567213, -0.1796111970327839765178,
     7.142857142857142857143e-2},
    {-0.7102436123992302234612, 0.2332213667578418012039, 9.988556385131215126048e-2,
     -0.3400312496470841905464, 0.462069949364325771582, -0.4387795689475734733041,
     0.1938775510204081632653},
};

const double RADAU_DENSE[RADAU_DENSE_ROWS][RADAU_STAGES] = {
    {54.37443689412861451458, -7.000024004259186512041, 2.355661091987557192256,
     -1.132289066106134386384, 0.6468913267673587118673, -0.3875333853753523774248,
     -0.8571428571428571428571},
    {-65.86989209924527979527, 15.51709642731581113882, -10.73669239395238179644,
     11.16573071805653537733, -15.7412852697585252525, 34.80789976044098318519,
     -23.14285714285714285714},
    {-689.3601185745331214174, 273.2117016359412399768, -95.344630190006171069,
     41.15739165296936046923, -14.46854307145503798998, -16.6243728814876985411,
     15.42857142857142857143},
    {887.5385123272719472507, -452.1068571857452727983, 273.1119080851969593487,
     -248.0596262249683993327, 295.5827953816290552845, -303.4953038119557183243,
     141.4285714285714285714},
    {2023.972197382262574745, -1104.859662268822627853, 588.8047777564876981255,
     -228.5627509565377732099, -2.640941261886008113466e-3, 97.21950759930058562837,
     -56.57142857142857142857},
    {-2735.414199050747696535, 1778.726238769153607081, -1362.19807751020025178,
     1085.503251260887130549, -853.8999845427502538674, 616.4256282165146074093,
     -245.1428571428571428571},
};
// clang-format on
