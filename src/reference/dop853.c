// Integrates smooth motion to rounding with few evaluations: explicit Runge-Kutta steps of order 8.
//
//     k_i = f(t + c_i h, y + h sum a_ij k_j),  y' = y + h sum b_j k_j
//     error = |h| e5^2 / sqrt(e5^2 + 0.01 e3^2)      e5, e3: root mean squares over the components
//     next step = 0.9 h error^-(1/8 - 0.2 b) error_before^b      b as STEADY
// Source: Hairer, Norsett, Wanner 1993, section II.10; the coefficients stand at the end of this
// file. The last line is theirs of section II.4 and of their DOP853, which leaves b at 0.
#include "reference/integrators.h"

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
            row->offsets[row->count] = i * width;
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
        const Pair *rates = (const Pair *)(first + row->offsets[j]);
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

static void evaluate_stage(Dop853 *integrator, int stage, const double *y)
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
    evaluate_stage(integrator, 0, integrator->y);
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
        evaluate_stage(integrator, stage, stage_state(integrator, stage));
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
        if (integrator->method != NULL && step < integrator->method_least) {
            integrator->method = NULL;
            step = fmin(step, integrator->otherwise);
        }
        integrator->step = step;
        if (!(step > integrator->shortest) || !(step > DBL_MIN)) {
            return false;
        }
    }
}

static void find_end_rates(Dop853 *integrator)
{
    if (!integrator->has_end_rates) {
        evaluate_stage(integrator, END_STAGE, integrator->next);
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
        evaluate_stage(integrator, stage, stage_state(integrator, stage));
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

// A vector, wherever in the memory it stands.
static void carry_vector(const Dop853 *integrator, double *vector, Carry *carry)
{
    CARRY_ARRAY(carry, vector, integrator->size);
}

void dop853_carry(Dop853 *integrator, Carry *carry)
{
    // which two of these there are trades places with every step
    double *const vectors[] = {
        integrator->fixed, integrator->grown, integrator->y,
        integrator->carry, integrator->next,  integrator->next_carry,
    };
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
        carry_vector(integrator, vectors[i], carry);
    }
    for (size_t i = 0; i < DOP853_STAGES; i++) {
        carry_vector(integrator, integrator->stages[i], carry);
    }
    for (size_t i = 0; i < DOP853_POLYNOMIAL; i++) {
        carry_vector(integrator, integrator->polynomial[i], carry);
    }
    CARRY(carry, integrator->time);
    CARRY(carry, integrator->shortest);
    CARRY(carry, integrator->step);
    CARRY(carry, integrator->tried);
    CARRY(carry, integrator->has_end_rates);
    CARRY(carry, integrator->is_filled);
    CARRY(carry, integrator->was_rejected);
    CARRY(carry, integrator->last_error);
    CARRY(carry, integrator->accepted);
    CARRY(carry, integrator->rejected);
    CARRY(carry, integrator->evaluations);
}

// Dense output: the motion within a step lies on the polynomial through it (dop853_fill), of degree
// 7 or that of another method.

typedef Dop853Pair Pair;

// Of two equations from one on.
static inline Pair polynomial_pair(const Dop853 *integrator, Pair s, Pair r, size_t i)
{
    Pair p[DOP853_POLYNOMIAL];
    for (int k = 0; k < DOP853_POLYNOMIAL; k++) {
        p[k] = *(const Pair *)(integrator->polynomial[k] + i);
    }
    const Pair high = p[4] + s * (p[5] + r * (p[6] + s * p[7]));
    return p[0] + s * (p[1] + r * (p[2] + s * (p[3] + r * high)));
}

// Of the first equations.
static void find_polynomial(const Dop853 *integrator, double share, size_t count, double *y)
{
    const Pair s = {share, share};
    const Pair r = {1.0 - share, 1.0 - share};
    size_t i = 0;
    for (; i + 1 < count; i += 2) {
        const Pair at = polynomial_pair(integrator, s, r, i);
        y[i] = at[0];
        y[i + 1] = at[1];
    }
    if (i < count) {
        y[i] = polynomial_pair(integrator, s, r, i)[0];
    }
}

void dop853_polynomial(const Dop853 *integrator, double share, double *y)
{
    find_polynomial(integrator, share, integrator->size, y);
}

// The share of the tried step that lies before a time, with the polynomial through it.
static double fill_share(Dop853 *integrator, double time)
{
    dop853_fill(integrator);
    // a step cut to nothing by an event at its start is a point
    const double tried = integrator->tried;
    return tried != 0.0 ? (time - integrator->time) / tried : 0.0;
}

void dop853_dense_all(Dop853 *integrator, double time, double *y)
{
    dop853_polynomial(integrator, fill_share(integrator, time), y);
}

const double *dop853_dense(Dop853 *integrator, double time)
{
    dop853_dense_all(integrator, time, integrator->at);
    return integrator->at;
}

const double *dop853_dense_some(Dop853 *integrator, double time, const size_t *numbers,
                                size_t count)
{
    const double share = fill_share(integrator, time);
    const Pair s = {share, share};
    const Pair r = {1.0 - share, 1.0 - share};
    for (size_t k = 0; k < count; k++) {
        const size_t other = numbers[k] % 2;
        const Pair at = polynomial_pair(integrator, s, r, numbers[k] - other);
        integrator->at[numbers[k]] = at[other];
    }
    return integrator->at;
}

double dop853_sketch(const Dop853 *integrator, size_t number, double share, double *slope)
{
    double *const *p = integrator->polynomial;
    double value = p[DOP853_POLYNOMIAL - 1][number];
    double by_share = 0.0;
    for (int k = DOP853_POLYNOMIAL - 2; k >= 0; k--) {
        const bool is_behind = k % 2 == 0;
        const double factor = is_behind ? share : 1.0 - share;
        by_share = factor * by_share + (is_behind ? value : -value);
        value = p[k][number] + factor * value;
    }
    *slope = by_share / integrator->tried;
    return value;
}

void dop853_dense_motion(Dop853 *integrator, double time, double *y)
{
    find_polynomial(integrator, fill_share(integrator, time), integrator->motion_size, y);
}

// The coefficients of Dormand and Prince's explicit Runge-Kutta pair of order 8 with Hairer's two
// error estimates (orders 5 and 3) and dense output of order 7.
//
// Stages 1 to 12 make the step, 13 is the derivative at its end, 14 to 16 are for dense output.
// Source: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed.,
// 1993, section II.10. The order conditions up to c^7 are a test.

// clang-format off
const double DOP853_NODE[DOP853_STAGES] = {
    0,
    0.526001519587677318785587544488e-01,
    0.789002279381515978178381316732e-01,
    0.118350341907227396726757197510e+00,
    0.281649658092772603273242802490e+00,
    0.333333333333333333333333333333e+00,
    0.25e+00,
    0.307692307692307692307692307692e+00,
    0.651282051282051282051282051282e+00,
    0.6e+00,
    0.857142857142857142857142857142e+00,
    1,
    1,
    0.1e+00,
    0.2e+00,
    0.777777777777777777777777777778e+00,
};

const double DOP853_COUPLING[DOP853_STAGES][DOP853_STAGES] = {
    {0},
    {[0] = 5.26001519587677318785587544488e-2},
    {[0] = 1.97250569845378994544595329183e-2, [1] = 5.91751709536136983633785987549e-2},
    {[0] = 2.95875854768068491816892993775e-2, [2] = 8.87627564304205475450678981324e-2},
    {[0] = 2.41365134159266685502369798665e-1, [2] = -8.84549479328286085344864962717e-1,
     [3] = 9.24834003261792003115737966543e-1},
    {[0] = 3.7037037037037037037037037037e-2, [3] = 1.70828608729473871279604482173e-1,
     [4] = 1.25467687566822425016691814123e-1},
    {[0] = 3.7109375e-2, [3] = 1.70252211019544039314978060272e-1,
     [4] = 6.02165389804559606850219397283e-2, [5] = -1.7578125e-2},
    {[0] = 3.70920001185047927108779319836e-2, [3] = 1.70383925712239993810214054705e-1,
     [4] = 1.07262030446373284651809199168e-1, [5] = -1.53194377486244017527936158236e-2,
     [6] = 8.27378916381402288758473766002e-3},
    {[0] = 6.24110958716075717114429577812e-1, [3] = -3.36089262944694129406857109825e0,
     [4] = -8.68219346841726006818189891453e-1, [5] = 2.75920996994467083049415600797e1,
     [6] = 2.01540675504778934086186788979e1, [7] = -4.34898841810699588477366255144e1},
    {[0] = 4.77662536438264365890433908527e-1, [3] = -2.48811461997166764192642586468e0,
     [4] = -5.90290826836842996371446475743e-1, [5] = 2.12300514481811942347288949897e1,
     [6] = 1.52792336328824235832596922938e1, [7] = -3.32882109689848629194453265587e1,
     [8] = -2.03312017085086261358222928593e-2},
    {[0] = -9.3714243008598732571704021658e-1, [3] = 5.18637242884406370830023853209e0,
     [4] = 1.09143734899672957818500254654e0, [5] = -8.14978701074692612513997267357e0,
     [6] = -1.85200656599969598641566180701e1, [7] = 2.27394870993505042818970056734e1,
     [8] = 2.49360555267965238987089396762e0, [9] = -3.0467644718982195003823669022e0},
    {[0] = 2.27331014751653820792359768449e0, [3] = -1.05344954667372501984066689879e1,
     [4] = -2.00087205822486249909675718444e0, [5] = -1.79589318631187989172765950534e1,
     [6] = 2.79488845294199600508499808837e1, [7] = -2.85899827713502369474065508674e0,
     [8] = -8.87285693353062954433549289258e0, [9] = 1.23605671757943030647266201528e1,
     [10] = 6.43392746015763530355970484046e-1},
    {[0] = 5.42937341165687622380535766363e-2, [5] = 4.45031289275240888144113950566e0,
     [6] = 1.89151789931450038304281599044e0, [7] = -5.8012039600105847814672114227e0,
     [8] = 3.1116436695781989440891606237e-1, [9] = -1.52160949662516078556178806805e-1,
     [10] = 2.01365400804030348374776537501e-1, [11] = 4.47106157277725905176885569043e-2},
    {[0] = 5.61675022830479523392909219681e-2, [6] = 2.53500210216624811088794765333e-1,
     [7] = -2.46239037470802489917441475441e-1, [8] = -1.24191423263816360469010140626e-1,
     [9] = 1.5329179827876569731206322685e-1, [10] = 8.20105229563468988491666602057e-3,
     [11] = 7.56789766054569976138603589584e-3, [12] = -8.298e-3},
    {[0] = 3.18346481635021405060768473261e-2, [5] = 2.83009096723667755288322961402e-2,
     [6] = 5.35419883074385676223797384372e-2, [7] = -5.49237485713909884646569340306e-2,
     [10] = -1.08347328697249322858509316994e-4, [11] = 3.82571090835658412954920192323e-4,
     [12] = -3.40465008687404560802977114492e-4, [13] = 1.41312443674632500278074618366e-1},
    {[0] = -4.28896301583791923408573538692e-1, [5] = -4.69762141536116384314449447206e0,
     [6] = 7.68342119606259904184240953878e0, [7] = 4.06898981839711007970213554331e0,
     [8] = 3.56727187455281109270669543021e-1, [12] = -1.39902416515901462129418009734e-3,
     [13] = 2.9475147891527723389556272149e0, [14] = -9.15095847217987001081870187138e0},
};

const double DOP853_ERROR_5[DOP853_STAGES] = {
    [0] = 0.1312004499419488073250102996e-01,
    [5] = -0.1225156446376204440720569753e+01,
    [6] = -0.4957589496572501915214079952e+00,
    [7] = 0.1664377182454986536961530415e+01,
    [8] = -0.3503288487499736816886487290e+00,
    [9] = 0.3341791187130174790297318841e+00,
    [10] = 0.8192320648511571246570742613e-01,
    [11] = -0.2235530786388629525884427845e-01,
};

const double DOP853_ERROR_3[DOP853_STAGES] = {
    [0] = -0.1898007540724076157147023289,
    [5] = 4.45031289275240888144113950566,
    [6] = 1.89151789931450038304281599044,
    [7] = -5.8012039600105847814672114227,
    [8] = -0.4226823213237919629324456792,
    [9] = -0.152160949662516078556178806805,
    [10] = 0.201365400804030348374776537501,
    [11] = 0.02265179219836082581180620396,
};

const double DOP853_DENSE[DOP853_DENSE_ROWS][DOP853_STAGES] = {
    {[0] = -0.84289382761090128651353491142e+01, [5] = 0.56671495351937776962531783590e+00,
     [6] = -0.30689499459498916912797304727e+01, [7] = 0.23846676565120698287728149680e+01,
     [8] = 0.21170345824450282767155149946e+01, [9] = -0.87139158377797299206789907490e+00,
     [10] = 0.22404374302607882758541771650e+01, [11] = 0.63157877876946881815570249290e+00,
     [12] = -0.88990336451333310820698117400e-01,
     [13] = 0.18148505520854727256656404962e+02,
     [14] = -0.91946323924783554000451984436e+01, [15] = -0.44360363875948939664310572000e+01},
    {[0] = 0.10427508642579134603413151009e+02, [5] = 0.24228349177525818288430175319e+03,
     [6] = 0.16520045171727028198505394887e+03, [7] = -0.37454675472269020279518312152e+03,
     [8] = -0.22113666853125306036270938578e+02, [9] = 0.77334326684722638389603898808e+01,
     [10] = -0.30674084731089398182061213626e+02,
     [11] = -0.93321305264302278729567221706e+01,
     [12] = 0.15697238121770843886131091075e+02,
     [13] = -0.31139403219565177677282850411e+02,
     [14] = -0.93529243588444783865713862664e+01, [15] = 0.35816841486394083752465898540e+02},
    {[0] = 0.19985053242002433820987653617e+02, [5] = -0.38703730874935176555105901742e+03,
     [6] = -0.18917813819516756882830838328e+03, [7] = 0.52780815920542364900561016686e+03,
     [8] = -0.11573902539959630126141871134e+02, [9] = 0.68812326946963000169666922661e+01,
     [10] = -0.10006050966910838403183860980e+01,
     [11] = 0.77771377980534432092869265740e+00,
     [12] = -0.27782057523535084065932004339e+01,
     [13] = -0.60196695231264120758267380846e+02,
     [14] = 0.84320405506677161018159903784e+02, [15] = 0.11992291136182789328035130030e+02},
    {[0] = -0.25693933462703749003312586129e+02, [5] = -0.15418974869023643374053993627e+03,
     [6] = -0.23152937917604549567536039109e+03, [7] = 0.35763911791061412378285349910e+03,
     [8] = 0.93405324183624310003907691704e+02, [9] = -0.37458323136451633156875139351e+02,
     [10] = 0.10409964950896230045147246184e+03, [11] = 0.29840293426660503123344363579e+02,
     [12] = -0.43533456590011143754432175058e+02,
     [13] = 0.96324553959188282948394950600e+02,
     [14] = -0.39177261675615439165231486172e+02, [15] = -0.14972683625798562581422125276e+03},
};
// clang-format on
