// How does a mechanism move over one step while no contact begins or ends?
//
// Gauss collocation with N nodes, order 2 N at the step's end. With A the integrals of the
// polynomial through values at the nodes, and t' = dt/dx:
//     v_i = v_0 + sum_j A_ij t'_j a(q_j, v_j),   q_i = q_0 + sum_j A_ij t'_j v_j
// solved by substitution, the velocities first: each round gains (omega h)^2 / (2 round)^2.
// d^(3/2) is not smooth in t where contact begins and ends; in the root of the time from there it
// is. So t is laid over x as the map says, and a t' is analytic in x up to both ends; its last
// two Legendre coefficients measure the error of the polynomials.
#include "quad_step.h"

#include <math.h>
#include <string.h>

enum {
    N = QUAD_GAUSS_NODES,
    ROUND_MAX = 40,    // a step that needs more is too long
    ROUND_TRUSTED = 6, // from here on each round must be better than the one before
};

// m/s: corrections below this carry 19 digits, and 29 digits of the whole are kept
static const double SMALL = 1e-10;
// share of the tolerance at which substitution may end; the next round would gain as much again
static const double SETTLED = 1e-4;
// m/s: substitution that makes such corrections runs away
static const double RUNAWAY = 1e6;

void quad_step_init(QuadStep *step, const QuadProblem *problem, Quad tolerance)
{
    memset(step, 0, sizeof *step);
    step->problem = problem;
    step->size = 3 * problem->body_count;
    step->tolerance = tolerance;
    quad_gauss_init(&step->gauss);
    for (size_t i = 0; i < problem->body_count; i++) {
        step->lever[3 * i] = 1;
        step->lever[3 * i + 1] = 1;
        step->lever[3 * i + 2] = sqrtq(problem->bodies[i].inertia / problem->bodies[i].mass);
    }
}

Quad quad_step_time(const QuadStep *step, Quad x)
{
    switch (step->map) {
    case QUAD_MAP_ONSET:
        return step->start_s + step->length_s * x * x;
    case QUAD_MAP_END:
        return step->start_s + step->length_s * x * (2 - x);
    default:
        return step->start_s + step->length_s * x;
    }
}

Quad quad_step_place(const QuadStep *step, Quad time_s)
{
    const Quad share = fminq((time_s - step->start_s) / step->length_s, 1);
    switch (step->map) {
    case QUAD_MAP_ONSET:
        return sqrtq(share);
    case QUAD_MAP_END:
        return 1 - sqrtq(1 - share);
    default:
        return share;
    }
}

static Quad rate_at(const QuadStep *step, Quad x)
{
    switch (step->map) {
    case QUAD_MAP_ONSET:
        return 2 * step->length_s * x;
    case QUAD_MAP_END:
        return 2 * step->length_s * (1 - x);
    default:
        return step->length_s;
    }
}

// Start value plus the integral of rates at the nodes, one row of coordinates a node.
static void integrate(const QuadStep *step, const Quad *weights, const Quad *start,
                      const Quad *rates, Quad *result)
{
    for (size_t c = 0; c < step->size; c++) {
        result[c] = start[c];
    }
    for (int j = 0; j < N; j++) {
        const Quad weight = weights[j] * step->rate[j];
        for (size_t c = 0; c < step->size; c++) {
            result[c] += weight * rates[j * QUAD_COORDINATE_MAX + c];
        }
    }
}

static void state_from(const QuadStep *step, const Quad *weights, Quad x, Quad *position,
                       Quad *velocity)
{
    integrate(step, weights, step->start_velocity, step->acceleration[0], velocity);
    integrate(step, weights, step->start_position, step->velocity[0], position);
    quad_problem_drive(step->problem, quad_step_time(step, x), position, velocity);
}

void quad_step_state(const QuadStep *step, Quad x, Quad *position, Quad *velocity)
{
    Quad weights[N];
    quad_gauss_weights(&step->gauss, x, weights);
    state_from(step, weights, x, position, velocity);
}

static void accelerate(QuadStep *step, const Quad *position, const Quad *velocity,
                       Quad *acceleration)
{
    quad_problem_accelerate(step->problem, &step->contacts, position, velocity, acceleration);
    step->evaluations++;
}

// The first guess: accelerations as at the start.
static void guess(QuadStep *step)
{
    QuadCoordinates a;
    accelerate(step, step->start_position, step->start_velocity, a);
    for (int i = 0; i < N; i++) {
        const Quad x = step->gauss.node[i];
        const Quad passed = quad_step_time(step, x) - step->start_s;
        step->rate[i] = rate_at(step, x);
        for (size_t c = 0; c < step->size; c++) {
            const Quad v = step->start_velocity[c];
            step->acceleration[i][c] = a[c];
            step->velocity[i][c] = v + passed * a[c];
            step->position[i][c] = step->start_position[c] + passed * (v + passed * a[c] / 2);
        }
        quad_problem_drive(step->problem, quad_step_time(step, x), step->position[i],
                           step->velocity[i]);
    }
}

// Velocities and positions from the accelerations at the nodes, with all digits.
static void rebuild(QuadStep *step)
{
    for (int i = 0; i < N; i++) {
        integrate(step, step->gauss.integral[i], step->start_velocity, step->acceleration[0],
                  step->velocity[i]);
    }
    for (int i = 0; i < N; i++) {
        integrate(step, step->gauss.integral[i], step->start_position, step->velocity[0],
                  step->position[i]);
        quad_problem_drive(step->problem, quad_step_time(step, step->gauss.node[i]),
                           step->position[i], step->velocity[i]);
    }
}

// The larger of two sizes; not fmaxq, which would hide one that is no number, such as a force
// beyond the end of its law at a first guess.
static Quad larger(Quad largest, Quad size)
{
    return size <= largest || isnanq(largest) ? largest : size;
}

// One round of substitution; returns the largest correction of a velocity, m/s. The corrections
// need fewer digits than what they correct.
static Quad substitute(QuadStep *step)
{
    long double gain[N][QUAD_COORDINATE_MAX];
    long double shift[N][QUAD_COORDINATE_MAX];
    for (int i = 0; i < N; i++) {
        QuadCoordinates a;
        accelerate(step, step->position[i], step->velocity[i], a);
        for (size_t c = 0; c < step->size; c++) {
            gain[i][c] = (long double)(step->rate[i] * (a[c] - step->acceleration[i][c]));
            step->acceleration[i][c] = a[c];
        }
    }
    Quad largest = 0;
    for (int i = 0; i < N; i++) {
        for (size_t c = 0; c < step->size; c++) {
            long double sum = 0.0L;
            for (int j = 0; j < N; j++) {
                sum += step->gauss.short_integral[i][j] * gain[j][c];
            }
            step->velocity[i][c] += sum;
            shift[i][c] = sum * (long double)step->rate[i];
            largest = larger(largest, fabsq(sum * step->lever[c]));
        }
    }
    for (int i = 0; i < N; i++) {
        for (size_t c = 0; c < step->size; c++) {
            long double sum = 0.0L;
            for (int j = 0; j < N; j++) {
                sum += step->gauss.short_integral[i][j] * shift[j][c];
            }
            step->position[i][c] += sum;
        }
        quad_problem_drive(step->problem, quad_step_time(step, step->gauss.node[i]),
                           step->position[i], step->velocity[i]);
    }
    return largest;
}

static Quad tail_of(const QuadStep *step)
{
    Quad largest = 0;
    for (int m = N - 2; m < N; m++) {
        for (size_t c = 0; c < step->size; c++) {
            Quad sum = 0;
            for (int j = 0; j < N; j++) {
                sum += step->gauss.legendre[m][j] * step->rate[j] * step->acceleration[j][c];
            }
            largest = larger(largest, fabsq(sum) * step->lever[c]);
        }
    }
    return largest;
}

bool quad_step_solve(QuadStep *step, QuadMap map, Quad length_s)
{
    step->map = map;
    step->length_s = length_s;
    step->solves++;
    guess(step);
    Quad before = INFINITY;
    bool is_rebuilt = false;
    for (int round = 0; round < ROUND_MAX; round++) {
        const Quad largest = substitute(step);
        if (!(largest < RUNAWAY) || (round > ROUND_TRUSTED && largest > before)) {
            return false;
        }
        before = largest;
        if (!is_rebuilt && largest < SMALL) {
            rebuild(step);
            is_rebuilt = true;
        } else if (is_rebuilt && largest <= SETTLED * step->tolerance) {
            state_from(step, step->gauss.weight, 1, step->end_position, step->end_velocity);
            step->tail = tail_of(step);
            return true;
        }
    }
    return false;
}
