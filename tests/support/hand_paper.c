// Integrates the paper's four-bar with play in its crank pin as a double pendulum.
//
// Follower (angle y_0 from its pivot G to the coupler pin) and coupler (y_1 from crank pin to
// coupler pin) hang from one another; the crank turns at w. With u = (cos, sin) of an angle:
//
//     coupler pin  B = G + c u_0,   crank pin of the coupler  P = B - b u_1,   of the crank  A
//     [ I_f + m_f c^2 / 4 + m_c c^2    -k cos(y_0 - y_1) ] y''  =  [ Q_0 + k sin(y_0 - y_1) w_1^2 ]
//     [ -k cos(y_0 - y_1)            I_c + m_c b^2 / 4   ]         [ Q_1 - k sin(y_0 - y_1) w_0^2 ]
//     k = m_c b c / 2,  Q_0 = -(m_f / 2 + m_c) c g cos y_0 + c F . u_0',  Q_1 = m_c b g cos y_1 / 2
//     - b F . u_1'
//
// with the contact's force F = -N e / |e| on P, e = P - A, of N = K d^1.5 (1 + chi d'/v_0) at the
// depth d = |e| - play. What the contact does changes where a margin of it turns negative; the step
// ends there. The integrator is the method of order 8 by Dormand and Prince with its dense output
// of order 7 (Hairer, Norsett, Wanner 1993, section II.10); of the program only its table of
// coefficients is used.
#include "hand_paper.h"

#include "reference/integrators.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { SIZE = 4, STAGES = 12, END = 12, DENSE_FIRST = 13, POLYNOMIAL = 8, MARGINS = 3 };
enum { CHECKS = 4, HALVINGS = 60, LANDINGS = 4, STEPS_MOST = 1000000 };

// m, kg, kg m^2, rad/s: of the case
static const double GROUND = 0.254, CRANK = 0.108, COUPLER = 0.2794, FOLLOWER = 0.2705;
static const double COUPLER_MASS = 0.29, FOLLOWER_MASS = 0.28;
static const double COUPLER_INERTIA = 2070.46e-6, FOLLOWER_INERTIA = 1988.39e-6;
static const double GRAVITY = 9.80665, SPEED = 1000.0 * 2.0 * M_PI / 60.0, PLAY = 14.5e-6;
static const double STIFFNESS = 6.6e10, HYSTERESIS = 0.75 * (1.0 - 0.9 * 0.9);
static const double SPEED_FLOOR = 1e-3, RESTING_SPEED = 0.3; // m/s, v_0: at least, and when resting

typedef enum Mode { APART, PRESSING, SLACK } Mode;

typedef struct Hand {
    Mode mode;
    bool is_released,
        is_resting;    // it has moved out since it began; and back in: v_0 is that of rest
    double damping;    // s/m, chi / v_0
    double time;       // s, of y
    double y[SIZE];    // rad, rad/s: angles of follower and coupler, their speeds
    double next[SIZE]; // at the end of a step
    double rates[DOP853_STAGES][SIZE];
    double polynomial[POLYNOMIAL][SIZE];
    size_t evaluations;
} Hand;

// What the crank pin does.
typedef struct Pin {
    Vec2 e;       // m
    double depth; // m
    double speed; // m/s, rate of that
    double rise;  // 1 + chi d'/v_0
    double force; // N
} Pin;

static Pin find(Hand *hand, double time, const double *y, double *rates)
{
    const double c0 = cos(y[0]), s0 = sin(y[0]), c1 = cos(y[1]), s1 = sin(y[1]);
    const double ca = cos(SPEED * time), sa = sin(SPEED * time);
    Pin pin = {.e = {GROUND + FOLLOWER * c0 - COUPLER * c1 - CRANK * ca,
                     FOLLOWER * s0 - COUPLER * s1 - CRANK * sa}};
    const double vx = -FOLLOWER * s0 * y[2] + COUPLER * s1 * y[3] + CRANK * sa * SPEED;
    const double vy = FOLLOWER * c0 * y[2] - COUPLER * c1 * y[3] - CRANK * ca * SPEED;
    const double e = sqrt(pin.e.x * pin.e.x + pin.e.y * pin.e.y);
    pin.depth = e - PLAY;
    pin.speed = e > 0.0 ? (pin.e.x * vx + pin.e.y * vy) / e : sqrt(vx * vx + vy * vy);
    pin.rise = 1.0 + hand->damping * pin.speed;
    // odd below zero depth, so that a step beyond the end of a contact stays smooth
    pin.force =
        hand->mode == PRESSING ? STIFFNESS * pin.depth * sqrt(fabs(pin.depth)) * pin.rise : 0.0;
    if (rates == NULL) {
        return pin;
    }
    const double fx = e > 0.0 ? -pin.force * pin.e.x / e : 0.0;
    const double fy = e > 0.0 ? -pin.force * pin.e.y / e : 0.0;
    static const double k = 0.5 * COUPLER_MASS * COUPLER * FOLLOWER;
    static const double m00 = FOLLOWER_INERTIA + 0.25 * FOLLOWER_MASS * FOLLOWER * FOLLOWER +
                              COUPLER_MASS * FOLLOWER * FOLLOWER;
    static const double m11 = COUPLER_INERTIA + 0.25 * COUPLER_MASS * COUPLER * COUPLER;
    const double m01 = -k * (c0 * c1 + s0 * s1), sine = k * (s0 * c1 - c0 * s1);
    const double q0 = -(0.5 * FOLLOWER_MASS + COUPLER_MASS) * FOLLOWER * GRAVITY * c0 +
                      FOLLOWER * (fy * c0 - fx * s0) + sine * y[3] * y[3];
    const double q1 = 0.5 * COUPLER_MASS * COUPLER * GRAVITY * c1 - COUPLER * (fy * c1 - fx * s1) -
                      sine * y[2] * y[2];
    const double determinant = m00 * m11 - m01 * m01;
    rates[0] = y[2];
    rates[1] = y[3];
    rates[2] = (m11 * q0 - m01 * q1) / determinant;
    rates[3] = (m00 * q1 - m01 * q0) / determinant;
    hand->evaluations++;
    return pin;
}

static void sum(const Hand *hand, const double *weights, int count, double factor, double *total)
{
    double own[SIZE] = {0.0};
    for (int j = 0; j < count; j++) {
        if (weights[j] != 0.0) {
            for (int i = 0; i < SIZE; i++) {
                own[i] += weights[j] * hand->rates[j][i];
            }
        }
    }
    for (int i = 0; i < SIZE; i++) {
        total[i] = factor * own[i];
    }
}

static void evaluate(Hand *hand, int stage, double h)
{
    double at[SIZE];
    sum(hand, DOP853_COUPLING[stage], stage < END ? stage : END + 4, h, at);
    for (int i = 0; i < SIZE; i++) {
        at[i] += hand->y[i];
    }
    find(hand, hand->time + DOP853_NODE[stage] * h, at, hand->rates[stage]);
}

// Tries a step from y with its rates known; returns its error over the tolerance.
static double try_step(Hand *hand, double h, double tolerance)
{
    // an error of a speed, and what it makes of an angle in the step
    const double scales[SIZE] = {SPEED * h, SPEED * h, SPEED, SPEED};
    double e5[SIZE], e3[SIZE], fifth = 0.0, third = 0.0;
    for (int stage = 1; stage < STAGES; stage++) {
        evaluate(hand, stage, h);
    }
    sum(hand, DOP853_COUPLING[END], STAGES, h, hand->next);
    sum(hand, DOP853_ERROR_5, STAGES, h / tolerance, e5);
    sum(hand, DOP853_ERROR_3, STAGES, h / tolerance, e3);
    for (int i = 0; i < SIZE; i++) {
        hand->next[i] += hand->y[i];
        fifth += e5[i] / scales[i] * (e5[i] / scales[i]);
        third += e3[i] / scales[i] * (e3[i] / scales[i]);
    }
    const double below = fifth + 0.01 * third;
    return below == 0.0 ? 0.0 : fifth / sqrt(SIZE * below); // no number where the motion is none
}

// Writes the rates at the end of a step.
static Pin end_step(Hand *hand, double h)
{
    return find(hand, hand->time + h, hand->next, hand->rates[END]);
}

// The polynomial through a step that has these.
static void fill(Hand *hand, double h)
{
    for (int stage = DENSE_FIRST; stage < DOP853_STAGES; stage++) {
        evaluate(hand, stage, h);
    }
    double(*p)[SIZE] = hand->polynomial;
    for (int i = 0; i < SIZE; i++) {
        p[0][i] = hand->y[i];
        p[1][i] = hand->next[i] - hand->y[i];
        p[2][i] = h * hand->rates[0][i] - p[1][i];
        p[3][i] = p[1][i] - h * hand->rates[END][i] - p[2][i];
    }
    for (int row = 0; row < DOP853_DENSE_ROWS; row++) {
        sum(hand, DOP853_DENSE[row], DOP853_STAGES, h, p[4 + row]);
    }
}

static void inside(const Hand *hand, double s, double *y)
{
    const double r = 1.0 - s;
    for (int i = 0; i < SIZE; i++) {
        double value = 0.0;
        for (int k = POLYNOMIAL - 1; k >= 0; k--) {
            value = hand->polynomial[k][i] + (k % 2 == 0 ? s : r) * value;
        }
        y[i] = value;
    }
}

// Positive as long as the contact stays what it is; INFINITY where it has no such margin.
static double margin_of(const Hand *hand, const Pin *pin, int which)
{
    static const double NONE = INFINITY;
    switch (which) {
    case 0:
        return hand->mode == APART ? -pin->depth : pin->depth;
    case 1:
        return hand->mode == APART ? NONE : hand->mode == PRESSING ? pin->rise : -pin->rise;
    default:
        return hand->mode == PRESSING && hand->is_released && !hand->is_resting ? -pin->speed
                                                                                : NONE;
    }
}

static double margin_at(Hand *hand, double h, double s, int which)
{
    double y[SIZE];
    inside(hand, s, y);
    const Pin pin = find(hand, hand->time + s * h, y, NULL);
    return margin_of(hand, &pin, which);
}

// Whether a margin is used up at the end of a step, or may be before: a pin that is free comes and
// goes, what presses is followed closely by the steps' errors.
static bool may_have_event(const Hand *hand, const Pin *end)
{
    bool may = hand->mode == APART;
    for (int which = 0; which < MARGINS; which++) {
        may = may || margin_of(hand, end, which) < 0.0;
    }
    return may;
}

// The share of the step at which a margin turns negative between two others.
static double find_share(Hand *hand, double h, int which, double low, double high)
{
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        // where the step began with an event its margin is zero but for rounding
        *(margin_at(hand, h, middle, which) >= 0.0 ? &low : &high) = middle;
    }
    return high;
}

// The first margin that turns negative in a step, and at which share of it: -1 where none does.
static int find_event(Hand *hand, double h, double *share)
{
    int first = -1;
    *share = INFINITY;
    for (int which = 0; which < MARGINS; which++) {
        for (int k = 1; k <= CHECKS && (double)(k - 1) / CHECKS < *share; k++) {
            const double high = (double)k / CHECKS;
            if (margin_at(hand, h, high, which) < 0.0) {
                const double at = find_share(hand, h, which, high - 1.0 / CHECKS, high);
                first = at < *share ? which : first;
                *share = fmin(*share, at);
                break;
            }
        }
    }
    return first;
}

// Ends the step at an event, where the depth is zero to rounding; returns its length.
static double land(Hand *hand, double h, int which, double tolerance)
{
    try_step(hand, h, tolerance);
    Pin end = end_step(hand, h);
    for (int i = 0; which == 0 && i < LANDINGS; i++) {
        h -= end.depth / end.speed;
        try_step(hand, h, tolerance);
        end = end_step(hand, h);
    }
    fill(hand, h);
    return h;
}

static void change_mode(Hand *hand, int which)
{
    const Pin pin = find(hand, hand->time, hand->y, NULL);
    if (which == 0 && hand->mode == APART) {
        hand->mode = PRESSING;
        hand->damping = HYSTERESIS / fmax(pin.speed, SPEED_FLOOR);
        hand->is_released = hand->is_resting = false;
    } else if (which == 0) {
        hand->mode = APART;
    } else if (which == 1) {
        hand->mode = hand->mode == PRESSING ? SLACK : PRESSING;
    } else {
        hand->is_resting = true;
        hand->damping = HYSTERESIS / RESTING_SPEED;
    }
}

static void take_samples(Hand *hand, double h, double interval_s, size_t count, size_t *taken,
                         HandPaperSample *samples)
{
    double rates[SIZE], y[SIZE];
    for (; *taken < count && (double)*taken * interval_s <= hand->time + h; ++*taken) {
        const double time = (double)*taken * interval_s;
        inside(hand, (time - hand->time) / h, y);
        const Pin pin = find(hand, time, y, rates);
        samples[*taken] =
            (HandPaperSample){{y[1], y[0]}, {y[3], y[2]}, {rates[3], rates[2]}, pin.e, pin.force};
    }
}

// Where the links stand with the pin in the middle of its hole, and move with it there.
static void start(Hand *hand)
{
    const double distance = GROUND - CRANK; // of the coupler's pins' pivots, on the line of ground
    const double along = 0.5 * (distance + (COUPLER * COUPLER - FOLLOWER * FOLLOWER) / distance);
    const double across = sqrt(COUPLER * COUPLER - along * along);
    hand->y[0] = atan2(across, along - distance);
    hand->y[1] = atan2(across, along);
    // c w_0 u_0' - b w_1 u_1' = (0, crank's speed)
    const double sine = sin(hand->y[0] - hand->y[1]);
    hand->y[2] = CRANK * SPEED * sin(hand->y[1]) / (FOLLOWER * -sine);
    hand->y[3] = CRANK * SPEED * sin(hand->y[0]) / (COUPLER * -sine);
    find(hand, 0.0, hand->y, hand->rates[0]);
}

size_t hand_paper_run(double tolerance, size_t intervals, HandPaperSample *samples)
{
    Hand hand = {.mode = APART};
    const double end_s = 2.0 * M_PI / SPEED;
    const double interval_s = end_s / (double)intervals;
    size_t taken = 0;
    double step = interval_s;
    start(&hand);
    for (size_t steps = 0; taken <= intervals; steps++) {
        double h = step;
        const double error = try_step(&hand, h, tolerance);
        // where the error is no number the step is much too long
        const double growth = 0.9 * pow(fmax(error, 1e-30), -1.0 / 8.0);
        step = isfinite(error) ? h * fmin(6.0, fmax(0.333, growth)) : 0.333 * h;
        if (steps == STEPS_MOST) {
            return 0;
        }
        if (!(error <= 1.0)) {
            continue;
        }
        const Pin end = end_step(&hand, h);
        const bool is_free = !may_have_event(&hand, &end);
        double share;
        if (!is_free || (double)taken * interval_s <= hand.time + h) {
            fill(&hand, h);
        }
        const int event = is_free ? -1 : find_event(&hand, h, &share);
        if (event >= 0) {
            h = land(&hand, share * h, event, tolerance);
        }
        take_samples(&hand, h, interval_s, intervals + 1, &taken, samples);
        hand.time += h;
        memcpy(hand.y, hand.next, sizeof hand.y);
        hand.is_released = hand.is_released || (hand.mode == PRESSING && end.speed < 0.0);
        if (event >= 0) {
            change_mode(&hand, event);
            find(&hand, hand.time, hand.y, hand.rates[0]);
        } else {
            memcpy(hand.rates[0], hand.rates[END], sizeof hand.rates[0]);
        }
    }
    return hand.evaluations;
}
