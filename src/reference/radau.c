// How is motion integrated whose contacts are damped so strongly that explicit steps get nowhere?
//
//     u_i = u_0 + h sum a_ij A(t_j, q_j, u_j),   q_i = q_0 + h sum a_ij u_j
// by Newton's method for z_i = u_i - u_0, with derivatives D = dA/du, S = dA/dq at each stage:
//     (1 - h a D - h^2 a S a) dz = h sum a_ij A_j - z_i
//     error = b7^2 / sqrt(b7^2 + 0.01 b6^2),   b_k: Legendre coefficients of the step's polynomial
// q coordinates, u their rates, A accelerations, a the couplings.
//
// L-stable: what a strong damper has made die away does not come back, whatever the step.
// Source: Hairer and Wanner 1996, sections IV.5 and IV.8; see reference/radau_table.c.
#include "reference/radau.h"

#include "base/dense.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// of Newton's method, and after how many its matrix is made anew
enum { ITERATIONS = 12, RENEWAL = 4 };

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
        free(radau->matrix);
        free(radau->pivots);
        free(radau);
    }
}

// Derivatives of the accelerations at a state whose rates are known, by the coordinates too where
// they are asked for. Returns the sum of all rates of decay.
static double differentiate(const Radau *radau, Dop853 *integrator, double time, double *y,
                            const double *rates, double *by_position, double *by_rate)
{
    const size_t n = freedoms_of(integrator);
    double changed[DOP853_SIZE_MAX];
    double decay = 0.0;
    for (size_t k = by_position != NULL ? 0 : n; k < 2 * n; k++) {
        const double kept = y[k];
        y[k] += radau->nudge[k];
        const double moved = y[k] - kept;
        integrator->rates(time, y, changed, integrator->context);
        integrator->evaluations++;
        y[k] = kept;
        double *column = k < n ? by_position + k : by_rate + (k - n);
        for (size_t i = 0; i < n; i++) {
            column[i * n] = (changed[n + i] - rates[n + i]) / moved;
        }
        decay -= k < n ? 0.0 : column[(k - n) * n];
    }
    return decay;
}

double radau_look(Radau *radau, Dop853 *integrator)
{
    double y[DOP853_SIZE_MAX];
    memcpy(y, integrator->y, sizeof y);
    radau->decay = differentiate(radau, integrator, integrator->time, y, integrator->stages[0],
                                 NULL, radau->by_rate[0]);
    radau->before_s = 0.0;
    return radau->decay;
}

// The state at a stage, its coordinates from the rates of all stages.
static void find_stage(Radau *radau, const Dop853 *integrator, double step, size_t stage, double *y)
{
    const size_t n = freedoms_of(integrator);
    double *moved = radau->moved[stage];
    memcpy(y, integrator->y, sizeof radau->moved[stage]);
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

// The derivatives at a stage whose rates are known. Returns the sum of all rates of decay.
static double find_slopes(Radau *radau, Dop853 *integrator, double time, double *y, size_t stage)
{
    const size_t n = freedoms_of(integrator);
    double *by_position = radau->by_position[stage];
    double *by_rate = radau->by_rate[stage];
    if (integrator->slopes == NULL) {
        return differentiate(radau, integrator, time, y, radau->rates[stage], by_position, by_rate);
    }
    integrator->slopes(time, y, by_position, by_rate, integrator->context);
    integrator->evaluations++;
    double decay = 0.0;
    for (size_t i = 0; i < n; i++) {
        decay -= by_rate[i * n + i];
    }
    return decay;
}

// The rates at all stages, with their derivatives where they are asked for.
static void evaluate_stages(Radau *radau, Dop853 *integrator, double step, bool with_derivatives)
{
    double y[DOP853_SIZE_MAX];
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        const double time = integrator->time + RADAU_NODE[i] * step;
        find_stage(radau, integrator, step, i, y);
        integrator->rates(time, y, radau->rates[i], integrator->context);
        integrator->evaluations++;
        if (with_derivatives) {
            radau->decay = find_slopes(radau, integrator, time, y, i);
        }
    }
}

// Whether one of two coordinates feels the other at any stage.
static bool are_coupled(const Radau *radau, size_t n, size_t a, size_t b)
{
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        const double *place = radau->by_position[i];
        const double *rate = radau->by_rate[i];
        if (place[a * n + b] != 0.0 || place[b * n + a] != 0.0 || rate[a * n + b] != 0.0 ||
            rate[b * n + a] != 0.0) {
            return true;
        }
    }
    return false;
}

// Sorts the coordinates into blocks: each takes in, one after the other, all that its members feel.
static void find_blocks(Radau *radau, size_t n)
{
    bool is_taken[RADAU_FREEDOM_MAX] = {false};
    size_t count = 0;
    radau->block_count = 0;
    for (size_t first = 0; first < n; first++) {
        if (is_taken[first]) {
            continue;
        }
        const size_t start = count;
        is_taken[first] = true;
        radau->members[count++] = first;
        for (size_t at = start; at < count; at++) {
            for (size_t k = 0; k < n; k++) {
                if (!is_taken[k] && are_coupled(radau, n, radau->members[at], k)) {
                    is_taken[k] = true;
                    radau->members[count++] = k;
                }
            }
        }
        radau->sizes[radau->block_count++] = count - start;
    }
}

// One part of Newton's matrix of a block of m coordinates: how the equation of a stage depends on
// the rates of another.
static void fill_part(const Radau *radau, size_t n, const size_t *members, size_t m, double step,
                      size_t stage, size_t other, double *matrix)
{
    const size_t width = RADAU_STAGES * m;
    double weights[RADAU_STAGES];
    for (size_t k = 0; k < RADAU_STAGES; k++) {
        weights[k] = RADAU_COUPLING[stage][k] * RADAU_COUPLING[k][other];
    }
    for (size_t row = 0; row < m; row++) {
        for (size_t column = 0; column < m; column++) {
            const size_t at = members[row] * n + members[column];
            double twice = 0.0;
            for (size_t k = 0; k < RADAU_STAGES; k++) {
                twice += weights[k] * radau->by_position[k][at];
            }
            const double own = stage == other && row == column ? 1.0 : 0.0;
            matrix[(stage * m + row) * width + other * m + column] =
                own - step * RADAU_COUPLING[stage][other] * radau->by_rate[other][at] -
                step * step * twice;
        }
    }
}

static bool factor(Radau *radau, const Dop853 *integrator, double step)
{
    const size_t n = freedoms_of(integrator);
    if (radau->matrix == NULL) {
        const size_t width = RADAU_STAGES * n;
        radau->matrix = malloc(width * width * sizeof *radau->matrix);
        radau->pivots = malloc(width * sizeof *radau->pivots);
        assert(radau->matrix != NULL && radau->pivots != NULL);
    }
    find_blocks(radau, n);
    const size_t *members = radau->members;
    double *matrix = radau->matrix;
    size_t *pivots = radau->pivots;
    for (size_t block = 0; block < radau->block_count; block++) {
        const size_t m = radau->sizes[block];
        const size_t width = RADAU_STAGES * m;
        for (size_t i = 0; i < RADAU_STAGES; i++) {
            for (size_t j = 0; j < RADAU_STAGES; j++) {
                fill_part(radau, n, members, m, step, i, j, matrix);
            }
        }
        if (!dense_factor(width, matrix, pivots)) {
            return false;
        }
        members += m;
        matrix += width * width;
        pivots += width;
    }
    return true;
}

// Solves Newton's equations in place, by stages and coordinates.
static void substitute(const Radau *radau, size_t n, double *change)
{
    const size_t *members = radau->members;
    const double *matrix = radau->matrix;
    const size_t *pivots = radau->pivots;
    double own[RADAU_STAGES * RADAU_FREEDOM_MAX];
    for (size_t block = 0; block < radau->block_count; block++) {
        const size_t m = radau->sizes[block];
        const size_t width = RADAU_STAGES * m;
        for (size_t i = 0; i < width; i++) {
            own[i] = change[i / m * n + members[i % m]];
        }
        dense_substitute(width, matrix, pivots, own);
        for (size_t i = 0; i < width; i++) {
            change[i / m * n + members[i % m]] = own[i];
        }
        members += m;
        matrix += width * width;
        pivots += width;
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
    double start[DOP853_SIZE_MAX];
    double y[DOP853_SIZE_MAX];
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
    substitute(radau, n, change);
    double largest = 0.0;
    for (size_t i = 0; i < RADAU_STAGES * n; i++) {
        const double share = fabs(change[i]) / integrator->fixed[n + i % n];
        largest = share <= largest ? largest : share; // a NaN must show
    }
    return largest;
}

// Solves for the stages. Returns how many times they were evaluated, INFINITY where Newton's method
// gets nowhere.
static double solve(Radau *radau, Dop853 *integrator, double step)
{
    const size_t n = freedoms_of(integrator);
    double change[RADAU_STAGES * RADAU_FREEDOM_MAX];
    double before = INFINITY;
    guess(radau, integrator, step);
    for (int iteration = 0; iteration < ITERATIONS; iteration++) {
        const bool is_new = iteration % RENEWAL == 0;
        evaluate_stages(radau, integrator, step, is_new);
        if (is_new && !factor(radau, integrator, step)) {
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
    const double effort = solve(radau, integrator, step) / EASY;
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
    double last[2][DOP853_SIZE_MAX];
    for (int i = 0; i < 2; i++) {
        weigh_moved(radau, integrator, RADAU_LAST[i], last[i]);
    }
    const double error = dop853_judge(integrator, last[0], last[1], 1.0);
    // a step that was hard to solve for is no reason for a longer one
    return error > 1.0 ? error : fmax(error, fmin(1.0, pow(effort, 8.0)));
}

static void fill(Dop853Method *method, Dop853 *integrator)
{
    Radau *radau = (Radau *)method;
    double(*p)[DOP853_SIZE_MAX] = integrator->polynomial;
    memcpy(p[0], integrator->y, sizeof p[0]);
    memcpy(p[1], radau->moved[RADAU_STAGES - 1], sizeof p[1]);
    for (size_t row = 0; row < RADAU_DENSE_ROWS; row++) {
        weigh_moved(radau, integrator, RADAU_DENSE[row], p[2 + row]);
    }
    radau->before_s = integrator->tried;
    radau->filled = integrator->accepted;
}

Radau *radau_create(void)
{
    Radau *radau = calloc(1, sizeof *radau);
    assert(radau != NULL);
    radau->method = (Dop853Method){.try_step = try_step, .fill = fill};
    return radau;
}
