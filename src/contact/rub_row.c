// Finds the row by which friction acts in a joint of ODE that is ideal but for it.
//
// T = mu R F is what sliding holds, F the joint's force in the step, extrapolated from those of the
// last two: second order. Of the law T tanh(w / w_s), with its value f and slope c at the step's
// start, the torque is
//     -f - c (w' - w) / 2     the row  J w' + (2/c) t = w  beside a torque -f    (at the mean)
//     -f - c (w' - w)         the row  J w' + (1/c) t = w                        (at the end)
// a step of Rosenbrock's kind: second order, and stable while the law does not bend within the
// step. Where friction would change the speed by more than w_s / 2 it is a row with a bound
// instead,
//     J w' + (w_s / T) t = 0,  |t| <= T
// Friction that sticks is a row with a bound that holds the bodies against each other,
//     J w' = 0,  |t| <= T g(w)
// without presliding; exact while it sticks and while it slides. A step in which the sliding turns
// round has the friction behind that all through; what it is short of, by the share s of the step
// before it,
//     2 s T g,   s = w / -(gain of the rate in the step before it)
// is given in the next step: second order.
#include "contact/rub_row.h"

#include "kernel/friction_law.h"

#include <math.h>

// 1: of w_s, by which friction may change the speed where its law is linearised
static const double RUB_ROW_STEEP = 0.5;

// 1: of the speed that friction changes in a step: what a row that holds may slip. Rows of loops
// that hold already would have no solution with none.
static const double RUB_ROW_SLIP = 1e-8;

// 1: of w_s: a slope below this share of T / w_s is none
static const double RUB_ROW_SLOPE_LEAST = 1e-9;

void rub_row_begin(RubRow *row, double rate)
{
    const double next =
        row->known > 1 ? 2.0 * row->pressing[0] - row->pressing[1] : row->pressing[0];
    row->rate = rate;
    row->torque = row->arm > 0.0 ? row->arm * fmax(next, 0.0) : row->steady;
    row->pushed = row->late;
    row->late = 0.0;
    row->has_row = false;
}

static void set_row(RubRow *row, double wanted, double softness, double most)
{
    row->has_row = true;
    row->wanted = wanted;
    row->softness = softness;
    row->most = most;
}

static void set_smooth(RubRow *row, double step_s, bool is_at_mean)
{
    const double speed = row->pair.speed;
    if (row->torque * row->mobility * step_s > RUB_ROW_STEEP * speed) {
        set_row(row, 0.0, speed / row->torque, row->torque);
        return;
    }
    const FrictionHold hold = friction_hold(row->rate, speed);
    const double slope = row->torque * hold.slope;
    row->pushed -= row->torque * hold.held;
    if (slope > RUB_ROW_SLOPE_LEAST * row->torque / speed) {
        set_row(row, row->rate, 1.0 / ((is_at_mean ? 0.5 : 1.0) * slope), INFINITY);
    }
}

void rub_row_set(RubRow *row, double step_s, bool is_at_mean)
{
    if (!(row->torque > 0.0)) {
        return;
    }
    if (row->pair.law == BRISTLE_REGULARIZED) {
        set_smooth(row, step_s, is_at_mean);
        return;
    }
    set_row(row, 0.0, RUB_ROW_SLIP * row->mobility * step_s,
            row->torque * bristle_left(&row->pair, row->rate));
}

// What a step is owed in which sliding that sticks has turned round.
void rub_row_end(RubRow *row, double end_rate)
{
    const double gained = end_rate - row->rate;
    const bool has_turned = row->rate * end_rate < 0.0 && row->gained * row->rate < 0.0;
    if (row->pair.law == BRISTLE_STICK && row->has_row && has_turned) {
        const double share = fmin(1.0, fabs(row->rate / row->gained));
        row->late = -2.0 * share * copysign(row->torque, row->rate);
    }
    row->gained = gained;
}

void rub_row_note(RubRow *row, double pressing)
{
    row->pressing[1] = row->pressing[0];
    row->pressing[0] = pressing;
    row->known = row->known < 2 ? row->known + 1 : 2; // more are not told apart
}
