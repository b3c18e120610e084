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

#include "reference/radau_newton.h"

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
        const size_t member = coupling->first_member[part] + number;
        if (member < coupling->first_member[part + 1]) {
            const size_t k = coupling->members[member] + behind;
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
        const size_t member = coupling->first_member[part] + number;
        if (member >= coupling->first_member[part + 1]) {
            continue;
        }
        const size_t column = coupling->members[member];
        const double moved = y[column + behind] - radau->kept[column + behind];
        y[column + behind] = radau->kept[column + behind];
        // those that it depends on depend on it
        const size_t *rows = coupling_columns(coupling, part);
        for (size_t k = 0; k < coupling_width(coupling, part); k++) {
            const size_t row = rows[k];
            const size_t place = coupling_place(coupling, coupling->part_of[row], column);
            by[coupling->first_value[row] + place] = (changed[row] - before[row]) / moved;
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

double radau_look(Radau *radau, Dop853 *integrator)
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
static double solve(Radau *radau, Dop853 *integrator, double step)
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
    for (int i = 0; i < 2; i++) {
        weigh_moved(radau, integrator, RADAU_LAST[i], integrator->errors[i]);
    }
    const double error =
        dop853_judge(integrator, integrator->errors[0], integrator->errors[1], 1.0);
    // a step that was hard to solve for is no reason for a longer one
    return error > 1.0 ? error : fmax(error, fmin(1.0, pow(effort, 8.0)));
}

static void fill(Dop853Method *method, Dop853 *integrator)
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
static double *take(double **left, size_t count)
{
    double *taken = *left;
    *left += count;
    return taken;
}

// Shares out the memory of the vectors.
static void take_vectors(Radau *radau, size_t size, size_t n, double *left)
{
    radau->nudge = take(&left, size);
    radau->y = take(&left, size);
    radau->changed = take(&left, size);
    radau->kept = take(&left, size);
    radau->start = take(&left, size);
    radau->change = take(&left, RADAU_STAGES * n);
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        radau->moved[i] = take(&left, size);
        radau->rates[i] = take(&left, size);
    }
}

Radau *radau_create(const Dop853 *integrator)
{
    const size_t n = freedoms_of(integrator);
    const size_t size = integrator->size;
    const size_t count = 5 * size + RADAU_STAGES * (n + 2 * size);
    Radau *radau = calloc(1, sizeof *radau);
    assert(radau != NULL);
    radau->method = (Dop853Method){.try_step = try_step, .fill = fill};
    radau->memory = calloc(count, sizeof *radau->memory);
    assert(radau->memory != NULL);
    const Coupling *coupling = integrator->coupling;
    radau->own_coupling = coupling == NULL ? coupling_create_full(n) : NULL;
    radau_newton_init(&radau->newton, coupling == NULL ? radau->own_coupling : coupling);
    take_vectors(radau, size, n, radau->memory);
    return radau;
}
