// How is smooth motion integrated to rounding with as few evaluations as possible?
//
//     k_i = f(t + c_i h, y + h sum a_ij k_j),  y' = y + h sum b_j k_j
//     error = |h| e5^2 / sqrt(e5^2 + 0.01 e3^2)      e5, e3: root mean squares over the components
//     next step = 0.9 h error^-(1/8 - 0.2 b) error_before^b      b as STEADY
// Source: Hairer, Norsett, Wanner 1993, section II.10; see reference/dop853_table.c. The last line
// is theirs of section II.4 and of their DOP853, which leaves b at 0.
#include "reference/dop853.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEP_STAGES = 12, END_STAGE = 12, FIRST_DENSE_STAGE = 13, BLOCK = 4 };

// Where rows of weights stand behind those of the stages.
enum {
    ROW_ERROR_5 = DOP853_STAGES,
    ROW_ERROR_3,
    ROW_DENSE,
    ROW_END = ROW_DENSE + DOP853_DENSE_ROWS,
};
static_assert((int)ROW_END == (int)DOP853_ROWS, "there is room for all rows");

// Hairer's choices: steps aim at 0.9 of what the error would allow and change by at most these
static const double SAFETY = 0.9;
static const double SHRINK_MOST = 0.333;
static const double GROW_MOST = 6.0;

// b: an error that grows from step to step lets the next one be shorter. Measured on contacts, at
// 0.02 a tenth of the steps that were refused are not, and at 0.08 all steps are too short.
static const double STEADY = 0.02;

// a step with a smaller share of the error allowed says no more than one with this
static const double ERROR_LEAST = 1e-4;

typedef Dop853Pair Pair;

typedef struct Block {
    Pair first;
    Pair second;
} Block;

// A number of equations, rounded up to whole blocks.
static size_t padded(size_t size)
{
    return (size + BLOCK - 1) / BLOCK * BLOCK;
}

// Keeps the weights that are not zero, of stages so wide.
static void set_row(const double *weights, size_t width, Dop853Row *row)
{
    for (size_t i = 0; i < DOP853_STAGES; i++) {
        if (weights[i] != 0.0) {
            row->places[row->count] = i * width;
            row->weights[row->count++] = (Pair){weights[i], weights[i]};
        }
    }
}

static void set_rows(Dop853 *integrator, size_t width)
{
    for (int i = 0; i < DOP853_STAGES; i++) {
        set_row(DOP853_COUPLING[i], width, &integrator->rows[i]);
    }
    set_row(DOP853_ERROR_5, width, &integrator->rows[ROW_ERROR_5]);
    set_row(DOP853_ERROR_3, width, &integrator->rows[ROW_ERROR_3]);
    for (int i = 0; i < DOP853_DENSE_ROWS; i++) {
        set_row(DOP853_DENSE[i], width, &integrator->rows[ROW_DENSE + i]);
    }
}

void dop853_init(Dop853 *integrator, size_t size, size_t motion_size)
{
    *integrator = (Dop853){.size = size, .motion_size = motion_size};
    double **const vectors[] = {
        &integrator->fixed,  &integrator->grown,      &integrator->y,         &integrator->carry,
        &integrator->next,   &integrator->next_carry, &integrator->at,        &integrator->stage_y,
        &integrator->change, &integrator->errors[0],  &integrator->errors[1],
    };
    enum { VECTORS = sizeof vectors / sizeof *vectors };
    const size_t width = padded(size);
    integrator->memory =
        calloc((VECTORS + DOP853_STAGES + DOP853_POLYNOMIAL) * width, sizeof *integrator->memory);
    assert(integrator->memory != NULL);
    double *free_from = integrator->memory;
    for (size_t i = 0; i < VECTORS; i++, free_from += width) {
        *vectors[i] = free_from;
    }
    for (size_t i = 0; i < DOP853_STAGES; i++, free_from += width) {
        integrator->stages[i] = free_from;
    }
    for (size_t i = 0; i < DOP853_POLYNOMIAL; i++, free_from += width) {
        integrator->polynomial[i] = free_from;
    }
    integrator->end_rates = integrator->stages[END_STAGE];
    set_rows(integrator, width);
}

void dop853_finish(Dop853 *integrator)
{
    free(integrator->memory);
    integrator->memory = NULL;
}

// A weighted sum of the stages, from one block of equations on.
static inline Block add_up(const Dop853 *integrator, const Dop853Row *row, size_t block)
{
    Block total = {{0.0, 0.0}, {0.0, 0.0}};
    const double *first = integrator->stages[0] + block;
    for (size_t j = 0; j < row->count; j++) {
        const Pair weight = row->weights[j];
        const Pair *rates = (const Pair *)(first + row->places[j]);
        total.first += weight * rates[0];
        total.second += weight * rates[1];
    }
    return total;
}

// Factor times a weighted sum of the stages; what lies beyond the last equation is zero.
static void sum_stages(const Dop853 *integrator, int row, double factor, double *sum)
{
    for (size_t block = 0; block < integrator->size; block += BLOCK) {
        const Block total = add_up(integrator, &integrator->rows[row], block);
        Pair *to = (Pair *)(sum + block);
        to[0] = factor * total.first;
        to[1] = factor * total.second;
    }
}

// The motion at the nodes of one stage; the sums count for no rate.
static const double *stage_state(Dop853 *integrator, int stage)
{
    for (size_t block = 0; block < integrator->motion_size; block += BLOCK) {
        const Block total = add_up(integrator, &integrator->rows[stage], block);
        const Pair *from = (const Pair *)(integrator->y + block);
        Pair *to = (Pair *)(integrator->stage_y + block);
        to[0] = from[0] + integrator->tried * total.first;
        to[1] = from[1] + integrator->tried * total.second;
    }
    return integrator->stage_y;
}

// The sum of many small steps would lose more by rounding than any of them is wrong by: what is
// lost of the end is kept.
void dop853_end(Dop853 *integrator, const double *change)
{
    for (size_t i = 0; i < integrator->size; i++) {
        const double y = integrator->y[i];
        const double moved = integrator->carry[i] + change[i];
        const double sum = y + moved;
        const double added = sum - y;
        integrator->next[i] = sum;
        integrator->next_carry[i] = (y - (sum - added)) + (moved - added);
    }
}

static void evaluate(Dop853 *integrator, int stage, const double *y)
{
    const double time = integrator->time + DOP853_NODE[stage] * integrator->tried;
    integrator->rates(time, y, integrator->stages[stage], integrator->context);
    integrator->evaluations++;
}

void dop853_start(Dop853 *integrator, double time, const double *y)
{
    integrator->time = time;
    memmove(integrator->y, y, integrator->size * sizeof *y);
    integrator->tried = 0.0;
    integrator->last_error = ERROR_LEAST;
    evaluate(integrator, 0, integrator->y);
}

// Error over allowed error of some of the equations. The two estimates of one group belong
// together: an equation with a large third-order estimate would hide the others' errors.
static double group_ratio(const Dop853 *integrator, const double *high, const double *low,
                          double factor, size_t first, size_t last)
{
    double fifth = 0.0;
    double third = 0.0;
    size_t count = 0;
    for (size_t i = first; i < last; i++) {
        const double allowed =
            integrator->fixed[i] + integrator->grown[i] * fabs(integrator->tried);
        if (allowed > 0.0) {
            fifth += (high[i] / allowed) * (high[i] / allowed);
            third += (low[i] / allowed) * (low[i] / allowed);
            count++;
        }
    }
    const double below = fifth + 0.01 * third;
    return below > 0.0 ? factor * fifth / sqrt(below * (double)count) : below;
}

double dop853_judge(const Dop853 *integrator, const double *high, const double *low, double factor)
{
    const size_t motion_size = integrator->motion_size;
    const double motion = group_ratio(integrator, high, low, factor, 0, motion_size);
    const double sums = group_ratio(integrator, high, low, factor, motion_size, integrator->size);
    // not fmax: a NaN must show
    return motion >= sums ? motion : (sums > motion ? sums : motion + sums);
}

double dop853_try(Dop853 *integrator, double step)
{
    integrator->has_end_rates = false;
    integrator->is_filled = false;
    if (integrator->method != NULL) {
        return integrator->method->try_step(integrator->method, integrator, step);
    }
    integrator->tried = step;
    for (int stage = 1; stage < STEP_STAGES; stage++) {
        evaluate(integrator, stage, stage_state(integrator, stage));
    }
    double *e5 = integrator->errors[0];
    double *e3 = integrator->errors[1];
    sum_stages(integrator, END_STAGE, step, integrator->change);
    sum_stages(integrator, ROW_ERROR_5, 1.0, e5);
    sum_stages(integrator, ROW_ERROR_3, 1.0, e3);
    dop853_end(integrator, integrator->change);
    return dop853_judge(integrator, e5, e3, fabs(step));
}

// The share by which the step may grow that follows one with this error.
static double growth_after(Dop853 *integrator, double error)
{
    const double before = integrator->last_error;
    integrator->last_error = fmax(error, ERROR_LEAST);
    const double most = integrator->was_rejected ? 1.0 : GROW_MOST;
    const double wanted =
        SAFETY * pow(fmax(error, 1e-30), 0.2 * STEADY - 1.0 / 8.0) * pow(before, STEADY);
    return fmin(most, fmax(SHRINK_MOST, wanted));
}

bool dop853_attempt(Dop853 *integrator, double longest)
{
    double step = fmin(integrator->step, longest);
    for (;;) {
        const double error = dop853_try(integrator, step);
        if (error <= 1.0) {
            const double suggested = step * growth_after(integrator, error);
            // a step cut short by the caller says nothing against longer ones
            integrator->step =
                step < integrator->step ? fmax(integrator->step, suggested) : suggested;
            integrator->was_rejected = false;
            return true;
        }
        integrator->rejected++;
        integrator->was_rejected = true;
        // not a number where the state is none
        step *= error > 1.0 ? fmax(SHRINK_MOST, SAFETY * pow(error, -1.0 / 8.0)) : SHRINK_MOST;
        integrator->step = step;
        if (!(step > integrator->shortest) || !(step > DBL_MIN)) {
            return false;
        }
    }
}

static void find_end_rates(Dop853 *integrator)
{
    if (!integrator->has_end_rates) {
        evaluate(integrator, END_STAGE, integrator->next);
        integrator->has_end_rates = true;
    }
}

void dop853_fill(Dop853 *integrator)
{
    if (integrator->is_filled) {
        return;
    }
    integrator->is_filled = true;
    find_end_rates(integrator);
    if (integrator->method != NULL) {
        integrator->method->fill(integrator->method, integrator);
        return;
    }
    for (int stage = FIRST_DENSE_STAGE; stage < DOP853_STAGES; stage++) {
        evaluate(integrator, stage, stage_state(integrator, stage));
    }
    const double h = integrator->tried;
    double *const *p = integrator->polynomial;
    for (size_t i = 0; i < integrator->size; i++) {
        const double change = integrator->next[i] - integrator->y[i];
        p[0][i] = integrator->y[i];
        p[1][i] = change;
        p[2][i] = h * integrator->stages[0][i] - change;
        p[3][i] = change - h * integrator->stages[END_STAGE][i] - p[2][i];
    }
    for (int row = 0; row < DOP853_DENSE_ROWS; row++) {
        sum_stages(integrator, ROW_DENSE + row, h, p[4 + row]);
    }
}

void dop853_shift(Dop853 *integrator, double by)
{
    find_end_rates(integrator);
    const double *first = integrator->end_rates;
    double *y = integrator->at;
    double *last = integrator->errors[0];
    for (size_t i = 0; i < integrator->size; i++) {
        y[i] = integrator->next[i] + by * first[i];
    }
    integrator->rates(integrator->time + integrator->tried + by, y, last, integrator->context);
    integrator->evaluations++;
    for (size_t i = 0; i < integrator->size; i++) {
        integrator->change[i] += 0.5 * by * (first[i] + last[i]);
    }
    dop853_end(integrator, integrator->change);
    integrator->tried += by;
    integrator->has_end_rates = false;
    integrator->is_filled = false;
}

static void swap(double **a, double **b)
{
    double *kept = *a;
    *a = *b;
    *b = kept;
}

void dop853_accept(Dop853 *integrator)
{
    find_end_rates(integrator);
    integrator->time += integrator->tried;
    swap(&integrator->y, &integrator->next);
    swap(&integrator->carry, &integrator->next_carry);
    memcpy(integrator->stages[0], integrator->end_rates, integrator->size * sizeof(double));
    integrator->accepted++;
}
