// Integrates a random case with the pair of Dormand and Prince of orders 5 and 4, steps of which
// end where a contact begins, ends, or has outlasted its impact.
//
// Between the ends of a step the offset across the play is the polynomial of order 5 with its
// values and two rates at both ends. It finds events and peaks; the step is then made anew, to the
// event, until the end has it.
// Sources: Dormand and Prince, J. Comput. Appl. Math. 6 (1980) 19; step control of Hairer, Norsett
// and Wanner, Solving Ordinary Differential Equations I, section II.4.
#include "settled_turn.h"

#include <math.h>
#include <string.h>

enum { STAGES = 7, PARTS = 6, BISECTIONS = 30, NEWTON = 8, COORDINATES = 2 };

static const double NODES[STAGES] = {0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0};
static const double WEIGHTS[STAGES][STAGES - 1] = {
    {0.0},
    {1.0 / 5.0},
    {3.0 / 40.0, 9.0 / 40.0},
    {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
    {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
    {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
    {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0},
};
static const double ERRORS[STAGES] = {
    71.0 / 57600.0,      0.0,          -71.0 / 16695.0, 71.0 / 1920.0,
    -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0,
};

// the program's defaults of contact.impact-speed-floor and contact.resting-speed, m/s or rad/s
static const double SPEED_FLOOR = 1e-3;
static const double RESTING_SPEED = 0.3;

// how near to an event a step ends, over the scale
static const double EVENT_DEPTH = 1e-13;
static const double EVENT_SPEED = 1e-11;

// of a period: no step is longer, so that none jumps over what the imposed motion does
static const double LONGEST = 1.0 / 40.0;
// of the play, that a pin crosses in a step
static const double CROSSED = 0.5;
// of a period: what is shorter is no step
static const double SHORTEST = 1e-15;

// step control: safety, and by what a step shrinks and grows at most
static const double SAFETY = 0.9;
static const double SHRINK = 0.2;
static const double GROW = 4.0;

// a run with more evaluations in a period is given up
static const size_t EVALUATIONS_MOST = 200000000;

// A step tried from the present state.
typedef struct Trial {
    double length;
    double y[MODEL_STATES];
    double rates[MODEL_STATES];
    ModelOffset offset;
    double error; // over the tolerance
} Trial;

typedef enum TurnEventKind { EVENT_NONE, EVENT_BEGIN, EVENT_END, EVENT_REST } TurnEventKind;

typedef struct TurnEvent {
    TurnEventKind kind;
    int contact;
    double share; // of the step
} TurnEvent;

static double length_of(const double vector[2])
{
    return sqrt(vector[0] * vector[0] + vector[1] * vector[1]);
}

static void begin_touch(const Turn *turn, ModelTouch *touch, double closing)
{
    *touch = (ModelTouch){.is_touching = true,
                          .rate = turn->model->hysteresis / fmax(closing, SPEED_FLOOR)};
}

static void refresh(Turn *turn)
{
    model_rates(turn->model, turn->time, turn->y, turn->touches, turn->rates, &turn->offset);
    turn->evaluations++;
}

Turn turn_start(const Model *model, TurnScale scale, double tolerance, const double *y)
{
    Turn turn = {.model = model, .scale = scale, .tolerance = tolerance};
    turn.step = 1e-4 * model->period;
    memcpy(turn.y, y, sizeof turn.y);
    refresh(&turn);
    for (int i = 0; i < model_contacts(model); i++) {
        double depth[3];
        model_depth(model, i, &turn.offset, depth);
        if (depth[0] > 0.0) {
            begin_touch(&turn, &turn.touches[i], depth[1]);
        }
    }
    refresh(&turn);
    return turn;
}

// The error of a step over what is tolerated: the largest of all coordinates and velocities.
static double error_of(const Turn *turn, double slopes[STAGES][MODEL_STATES], double h)
{
    const Model *model = turn->model;
    const int n = model->coordinates;
    double largest = 0.0;
    for (int i = 0; i < 2 * n; i++) {
        double error = 0.0;
        for (int k = 0; k < STAGES; k++) {
            error += ERRORS[k] * slopes[k][i];
        }
        const double unit = i < n ? turn->scale.length : turn->scale.speed;
        largest = fmax(largest, fabs(h * error) * model->reach[i % n] / unit);
    }
    return largest / turn->tolerance;
}

static void try_step(Turn *turn, double h, Trial *trial)
{
    const Model *model = turn->model;
    const int n = 2 * model->coordinates;
    double slopes[STAGES][MODEL_STATES];
    memcpy(slopes[0], turn->rates, sizeof slopes[0]);
    for (int k = 1; k < STAGES; k++) {
        for (int i = 0; i < n; i++) {
            double sum = 0.0;
            for (int j = 0; j < k; j++) {
                sum += WEIGHTS[k][j] * slopes[j][i];
            }
            trial->y[i] = turn->y[i] + h * sum;
        }
        model_rates(model, turn->time + NODES[k] * h, trial->y, turn->touches, slopes[k],
                    &trial->offset);
    }
    memcpy(trial->rates, slopes[STAGES - 1], sizeof trial->rates);
    turn->evaluations += STAGES - 1;
    trial->length = h;
    trial->error = error_of(turn, slopes, h);
}

// The offset's polynomials in a step.
typedef struct Path {
    double h;
    double terms[COORDINATES][6]; // of the share of the step
} Path;

static void path_make(const Turn *turn, const Trial *trial, Path *path)
{
    const double h = trial->length;
    path->h = h;
    for (int i = 0; i < turn->model->coordinates; i++) {
        const ModelOffset *from = &turn->offset;
        const ModelOffset *to = &trial->offset;
        const double d = to->x[i] - from->x[i] - h * (from->v[i] + 0.5 * h * from->a[i]);
        const double e = h * (to->v[i] - from->v[i] - h * from->a[i]);
        const double f = h * h * (to->a[i] - from->a[i]);
        double *c = path->terms[i];
        c[0] = from->x[i];
        c[1] = h * from->v[i];
        c[2] = 0.5 * h * h * from->a[i];
        c[3] = 10.0 * d - 4.0 * e + 0.5 * f;
        c[4] = -15.0 * d + 7.0 * e - f;
        c[5] = 6.0 * d - 3.0 * e + 0.5 * f;
    }
}

static void path_at(const Model *model, const Path *path, double s, int contact, double depth[3])
{
    ModelOffset offset = {.x = {0.0, 0.0}};
    for (int i = 0; i < model->coordinates; i++) {
        const double *c = path->terms[i];
        offset.x[i] = c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
        offset.v[i] =
            (c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * 5.0 * c[5])))) /
            path->h;
    }
    model_depth(model, contact, &offset, depth);
}

// The event that a contact with such a depth would have, if any.
static TurnEventKind event_of(const ModelTouch *touch, bool is_released, const double depth[3])
{
    if (!touch->is_touching) {
        return depth[0] > 0.0 ? EVENT_BEGIN : EVENT_NONE;
    }
    if (depth[0] < 0.0) {
        return EVENT_END;
    }
    return is_released && !touch->is_resting && depth[1] > 0.0 ? EVENT_REST : EVENT_NONE;
}

// Where between two shares of a step an event happens.
static double bisect(const Turn *turn, const Path *path, int contact, TurnEventKind kind,
                     double before, double behind)
{
    const ModelTouch *touch = &turn->touches[contact];
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = 0.5 * (before + behind);
        double depth[3];
        path_at(turn->model, path, middle, contact, depth);
        if (event_of(touch, kind == EVENT_REST, depth) == kind) {
            behind = middle;
        } else {
            before = middle;
        }
    }
    return behind;
}

// A share between two at which a contact that is apart comes nearest, if it comes nearer inside.
static double nearest(const double before[3], const double behind[3], double s, double t)
{
    if (before[1] > 0.0 && behind[1] < 0.0) {
        return s + (t - s) * before[1] / (before[1] - behind[1]);
    }
    return t;
}

// The first event of a contact in a step, in front of a known one.
static void find_event(const Turn *turn, const Path *path, int contact, TurnEvent *event)
{
    const ModelTouch *touch = &turn->touches[contact];
    bool is_released = touch->is_released;
    double s = 0.0;
    double last[3];
    path_at(turn->model, path, s, contact, last);
    for (int part = 1; part <= PARTS && s < event->share; part++) {
        double t = (double)part / PARTS;
        double depth[3];
        path_at(turn->model, path, t, contact, depth);
        if (!touch->is_touching && depth[0] <= 0.0) {
            const double top = nearest(last, depth, s, t);
            double inside[3];
            path_at(turn->model, path, top, contact, inside);
            if (inside[0] > 0.0) {
                t = top;
                memcpy(depth, inside, sizeof depth);
            }
        }
        const TurnEventKind kind = event_of(touch, is_released, depth);
        if (kind != EVENT_NONE) {
            const double share = bisect(turn, path, contact, kind, s, t);
            if (share < event->share || event->kind == EVENT_NONE) {
                *event = (TurnEvent){kind, contact, share};
            }
            return;
        }
        is_released = is_released || (touch->is_touching && depth[1] < 0.0);
        memcpy(last, depth, sizeof last);
        s = t;
    }
}

// Makes the step anew so that it ends at the event.
static void end_at(Turn *turn, const TurnEvent *event, Trial *trial)
{
    const bool is_rest = event->kind == EVENT_REST;
    const double near =
        is_rest ? EVENT_SPEED * turn->scale.speed : EVENT_DEPTH * turn->scale.length;
    const double whole = trial->length;
    double h = event->share * whole;
    for (int i = 0; i < NEWTON; i++) {
        try_step(turn, h, trial);
        double depth[3];
        model_depth(turn->model, event->contact, &trial->offset, depth);
        const double left = is_rest ? depth[1] : depth[0];
        const double rate = is_rest ? depth[2] : depth[1];
        if (fabs(left) <= near || rate == 0.0) {
            break;
        }
        h = fmin(fmax(h - left / rate, 0.5 * h), whole);
    }
}

static void apply(Turn *turn, const TurnEvent *event)
{
    ModelTouch *touch = &turn->touches[event->contact];
    double depth[3];
    model_depth(turn->model, event->contact, &turn->offset, depth);
    switch (event->kind) {
    case EVENT_BEGIN:
        begin_touch(turn, touch, depth[1]);
        break;
    case EVENT_END:
        *touch = (ModelTouch){.is_touching = false};
        break;
    case EVENT_REST:
        touch->is_resting = true;
        touch->rate = turn->model->hysteresis / RESTING_SPEED;
        break;
    case EVENT_NONE:
        break;
    }
}

static double force_at(const Turn *turn, const Path *path, double s, int contact)
{
    double depth[3];
    path_at(turn->model, path, s, contact, depth);
    return model_force(turn->model, &turn->touches[contact], depth[0], depth[1]);
}

// Takes the largest force in a step into account: the top of the parabola through three of its
// points, where the polynomial is asked.
static void take_peak(Turn *turn, const Path *path, int contact)
{
    double forces[PARTS + 1];
    int top = 0;
    for (int i = 0; i <= PARTS; i++) {
        forces[i] = force_at(turn, path, (double)i / PARTS, contact);
        top = forces[i] > forces[top] ? i : top;
    }
    turn->peak = fmax(turn->peak, forces[top]);
    if (top > 0 && top < PARTS) {
        const double bend = forces[top - 1] - 2.0 * forces[top] + forces[top + 1];
        const double aside = bend < 0.0 ? 0.5 * (forces[top - 1] - forces[top + 1]) / bend : 0.0;
        turn->peak = fmax(turn->peak, force_at(turn, path, (top + aside) / PARTS, contact));
    }
}

static void accept(Turn *turn, const Trial *trial)
{
    turn->time += trial->length;
    memcpy(turn->y, trial->y, sizeof turn->y);
    memcpy(turn->rates, trial->rates, sizeof turn->rates);
    turn->offset = trial->offset;
    turn->reached = fmax(turn->reached, length_of(turn->offset.x));
    turn->fastest = fmax(turn->fastest, length_of(turn->offset.v));
    for (int i = 0; i < model_contacts(turn->model); i++) {
        ModelTouch *touch = &turn->touches[i];
        double depth[3];
        model_depth(turn->model, i, &turn->offset, depth);
        touch->is_released = touch->is_released || (touch->is_touching && depth[1] < 0.0);
    }
}

static double step_limit(const Turn *turn, double left)
{
    double limit = fmin(left, LONGEST * turn->model->period);
    const double speed = length_of(turn->offset.v);
    if (turn->model->is_pin && !turn->touches[0].is_touching && speed > 0.0) {
        limit = fmin(limit, CROSSED * turn->model->clearance / speed);
    }
    return limit;
}

// One step, of at most the time that is left until it has to end.
static void make_step(Turn *turn, double left)
{
    const double limit = step_limit(turn, left);
    double h = fmin(turn->step, limit);
    // not a sliver of a step behind this one
    h = h < left && h > 0.9 * left ? left : h;
    Trial trial;
    for (;;) {
        try_step(turn, h, &trial);
        if (trial.error <= 1.0) {
            break;
        }
        h *= fmax(SHRINK, SAFETY * pow(trial.error, -0.2));
    }
    const double wish = h * fmin(GROW, SAFETY * pow(fmax(trial.error, 1e-10), -0.2));
    // a step cut short by its limit says nothing against longer ones
    turn->step =
        h < turn->step ? fmax(wish, trial.error < 0.5 && h == limit ? turn->step : wish) : wish;
    Path path;
    path_make(turn, &trial, &path);
    TurnEvent event = {.kind = EVENT_NONE, .share = 1.0};
    for (int i = 0; i < model_contacts(turn->model); i++) {
        find_event(turn, &path, i, &event);
    }
    if (event.kind != EVENT_NONE) {
        end_at(turn, &event, &trial);
        path_make(turn, &trial, &path);
    }
    for (int i = 0; i < model_contacts(turn->model); i++) {
        if (turn->touches[i].is_touching) {
            take_peak(turn, &path, i);
        }
    }
    accept(turn, &trial);
    if (event.kind != EVENT_NONE) {
        apply(turn, &event);
        refresh(turn);
    }
}

void turn_period(Turn *turn)
{
    const Model *model = turn->model;
    const size_t before = turn->evaluations;
    turn->peak = 0.0;
    turn->time = 0.0;
    for (size_t k = 0; k < model->stops && !turn->is_failed; k++) {
        while (model->stop_at[k] - turn->time > SHORTEST * model->period) {
            make_step(turn, model->stop_at[k] - turn->time);
            if (turn->evaluations - before > EVALUATIONS_MOST || !isfinite(turn->y[0])) {
                turn->is_failed = true;
                break;
            }
        }
        turn->time = model->stop_at[k];
        // the imposed acceleration may have a bend here
        refresh(turn);
    }
}
