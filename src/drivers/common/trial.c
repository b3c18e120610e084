// Steps an engine with contacts integrated within its steps, by trials.
//
// q and v are the coordinates of the tree and their rates; u the rows of the contacts, J their
// Jacobian; G(q, v, f) the engine's accelerations under forces f in the rows, with loops and drives
// held (drivers/common/hold.h), F = J G + J' v those of the rows. A step h:
//     q_m = q + h/2 v + h^2/8 (a + A P/h)                      a, P, A of the step before
//     v_m = v + h/2 a + 3/8 h^2 a' + 7/48 h^3 a''              behind a step as long as this one
//     A = G(q_m, v_m, 1) - G(q_m, v_m, 0),  W = J A;  or as the engine responds
//     2 S = (F(v_m + e A) - F(v_m)) / e,    B = (G(v_m + e A) - G(v_m)) / e,   W' = S + S'
//     P, Q, R                                       the kernel's impulses, and their integrals
//     a + B Q/h + A P/h = G(q_m, v_m + A Q/h + B R/h, P/h)
//     v' = v + h a + h^3/24 a'' + B Q + B' (h/2 Q - R) + A P + A' (h/2 P - Q)
//     q' = q + h v + h^2/2 a - h^3/12 a' + h^4/48 a'' + B R + A Q + A' (h/2 Q - 2 R)
// J' v of a pin is known; of other places it is the difference of J v a little before and behind,
// as the rates v go there.
//
// Accelerations are of second degree in the velocities, and B of first: a step in which impulses
// change the velocities much, within_is_rough, is taken in parts.
#include "drivers/common/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// of the velocities: what they are changed by for S
static const double NUDGE = 1e-4;

// A step of a trial, s, in which joints that are open by a rounding are closed by accelerations of
// that over its square; and rad that the fastest body may turn in it: Bullet stops at pi / 2.
static const double TRIAL_S = 1e-4;
static const double TRIAL_PHASE = 0.1;

// rad, by which the fastest body turns between the two: the square of it is the error
static const double BEND_PHASE = 3e-5;

// rad, likewise between the two places at which responses are compared
static const double TURN_PHASE = 2e-5;

// parts into which a step is divided in which impulses change the velocities much
enum { PARTS = 4 };

// of a step: times that are nearer to each other are one
static const double TIME_ROUNDING = 1e-9;

typedef struct Trial {
    Within in;
    Hold hold;
    Rubs rubs;
    const Tree *tree;
    const TrialEngine *engine;
    DriverRun *run;
    double *other;         // by coordinate; owned, as all arrays
    double *changed;       // by coordinate
    double *later;         // likewise
    double *held;          // by row of the hold, without forces in the rows; and with one
    double *reactions[2];  // of joints that rub, without these; and with one
    DriverMotion *motions; // by body
    DriverMotion *tried;   // of a trial
    DriverAction *actions; // by body
    bool has_walls;        // whether any place is no point
    Carry carry;           // what a step that is to be divided has changed
    double start_s;        // of the step under way
    double end_s;
} Trial;

// to += scale from
static void add(double *to, const double *from, double scale, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        to[i] += scale * from[i];
    }
}

static double dot(const double *a, const double *b, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Lets a row of a place act on its bodies.
static void push_place(const Trial *trial, size_t i, size_t row, double value)
{
    const DriverPlace *place = &trial->in.of->places[i];
    const PlaceRow of = place_row(place, trial->tried, row);
    for (int side = 0; side < 2; side++) {
        if (place->bodies[side] != DRIVER_GROUND) {
            DriverAction *action = &trial->actions[place->bodies[side]];
            action->force = vec2_add(action->force, vec2_scale(value, of.along[side]));
            action->moment += value * of.turn[side];
        }
    }
}

// Asks the engine, with what acts and what has been added to that.
static void ask(Trial *trial, const double *q, const double *v, double *a)
{
    trial->engine->accelerate(trial->engine->engine, q, v, trial->actions, a);
    trial->run->steps += trial->engine->respond == NULL ? 1 : 0;
}

// Puts the bodies there where something acts on them, or is to, and finds what acts.
static void begin_trial(Trial *trial, const double *q, const double *v, bool is_pushed)
{
    if (!is_pushed && !actions_any(trial->in.of)) {
        memset(trial->actions, 0, trial->in.of->body_count * sizeof *trial->actions);
        return;
    }
    tree_motions(trial->tree, q, v, trial->tried);
    actions_find(trial->in.of, trial->tried, trial->start_s, trial->end_s, trial->actions);
}

static double middle_of(const Trial *trial)
{
    return 0.5 * (trial->start_s + trial->end_s);
}

// The engine's accelerations under forces in the rows; NULL: none. What is held is held.
static void evaluate(Trial *trial, const double *q, const double *v, const double *forces,
                     double scale, double *a)
{
    begin_trial(trial, q, v, forces != NULL);
    for (size_t i = 0; forces != NULL && i < trial->in.kernel.contact_count; i++) {
        const KernelContact *contact = &trial->in.kernel.contacts[i];
        for (size_t k = 0; k < contact->row_count; k++) {
            push_place(trial, i, k, scale * forces[contact->first_row + k]);
        }
    }
    ask(trial, q, v, a);
    hold_accelerate(&trial->hold, q, v, trial->start_s, middle_of(trial), a);
}

// The reactions of joints that rub where the engine has just been asked.
static void react(Trial *trial, const double *q, const double *v, const double *a,
                  double *reactions)
{
    const Tree *tree = trial->tree;
    if (trial->rubs.count == 0) {
        return;
    }
    tree_motions(tree, q, v, trial->tried);
    tree_bends(tree, trial->tried, v, tree->bends);
    rubs_react(&trial->rubs,
               &(RubsInstant){.q = q,
                              .a = a,
                              .motions = trial->tried,
                              .bends = tree->bends,
                              .gravity = tree->of->gravity,
                              .actions = trial->actions,
                              .held = trial->hold.right},
               reactions);
}

// What a unit force in a row adds to them, which does `column` to the accelerations there, and so
// much to what holds.
static void answer(Trial *trial, const double *q, const double *column, const double *held,
                   size_t row, double *answers)
{
    const size_t contact = (size_t)trial->in.kernel.contact_of[row];
    memset(trial->actions, 0, trial->in.of->body_count * sizeof *trial->actions);
    tree_motions(trial->tree, q, column, trial->tried);
    push_place(trial, contact, row - trial->in.kernel.contacts[contact].first_row, 1.0);
    rubs_react(
        &trial->rubs,
        &(RubsInstant){
            .q = q, .a = column, .motions = trial->tried, .actions = trial->actions, .held = held},
        trial->reactions[1]);
    rubs_take(&trial->rubs, row, trial->reactions[1], answers);
}

// What the rows that hold do to the accelerations, at the middle or at the start of a step.
static void find_holding(Trial *trial, const double *q, const double *v)
{
    Hold *hold = &trial->hold;
    const size_t count = trial->in.count;
    if (hold->rows == 0) {
        return;
    }
    tree_motions(trial->tree, q, v, trial->motions);
    hold_place(hold, trial->motions);
    if (trial->engine->respond != NULL) {
        trial->engine->respond(trial->engine->engine, q, hold->rows, hold->jacobian, hold->columns);
        return;
    }
    begin_trial(trial, q, v, true);
    ask(trial, q, v, trial->other);
    const double size = 1.0 + sqrt(dot(trial->other, trial->other, count));
    for (size_t k = 0; k < hold->rows; k++) {
        double *column = hold->columns + k * count;
        begin_trial(trial, q, v, true);
        hold_push(hold, k, trial->tried, size, trial->actions);
        ask(trial, q, v, column);
        for (size_t i = 0; i < count; i++) {
            column[i] = (column[i] - trial->other[i]) / size;
        }
    }
}

// J at the positions of the motions.
static void find_jacobian(Trial *trial)
{
    const Within *in = &trial->in;
    memset(in->jacobian, 0, in->rows * in->count * sizeof *in->jacobian);
    for (size_t i = 0; i < in->kernel.contact_count; i++) {
        const DriverPlace *place = &in->of->places[i];
        const KernelContact *contact = &in->kernel.contacts[i];
        PlaceRow first[KERNEL_ROW_TURN];
        place_rows(place, trial->motions, first);
        for (size_t k = 0; k < contact->row_count; k++) {
            const PlaceRow row =
                k < KERNEL_ROW_TURN ? first[k] : place_row(place, trial->motions, k);
            double *to = in->jacobian + (contact->first_row + k) * in->count;
            for (int side = 0; side < 2; side++) {
                tree_push(trial->tree, trial->motions, place->bodies[side], (Vec2){0.0, 0.0},
                          row.along[side], to);
                tree_turn(trial->tree, place->bodies[side], row.turn[side], to);
            }
        }
    }
}

// What the velocities alone accelerate a point of a body by.
static Vec2 bend_of(const Trial *trial, int body, Vec2 local)
{
    if (body == DRIVER_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const DriverMotion *motion = &trial->motions[body];
    const Vec2 arm = vec2_rotate(motion->angle, local);
    return vec2_sub(trial->tree->bends[body], vec2_scale(motion->omega * motion->omega, arm));
}

// Adds J' v of the pins.
static void add_bends_of_points(Trial *trial, double *rows)
{
    for (size_t i = 0; i < trial->in.kernel.contact_count; i++) {
        const DriverPlace *place = &trial->in.of->places[i];
        if (place_is_point(place)) {
            const Vec2 bend = vec2_sub(bend_of(trial, place->bodies[1], place->anchors[1]),
                                       bend_of(trial, place->bodies[0], place->anchors[0]));
            double *own = rows + trial->in.kernel.contacts[i].first_row;
            own[0] = bend.x + own[0];
            own[1] = bend.y + own[1];
        }
    }
}

// Adds the rates of all other rows a little later, times a factor.
static void add_rates_at(Trial *trial, const double *v, double since_s, double factor, double *rows)
{
    const Within *in = &trial->in;
    memcpy(trial->other, in->q_middle, in->count * sizeof *trial->other);
    add(trial->other, v, since_s, in->count);
    tree_motions(trial->tree, trial->other, v, trial->tried);
    for (size_t i = 0; i < in->kernel.contact_count; i++) {
        const DriverPlace *place = &in->of->places[i];
        for (size_t k = 0; !place_is_point(place) && k < KERNEL_ROW_TURN; k++) {
            const PlaceRow row = place_row(place, trial->tried, k);
            rows[in->kernel.contacts[i].first_row + k] +=
                factor * place_rate(place, &row, trial->tried);
        }
    }
}

// How long before and behind is a little, s.
static double little_of(const Trial *trial)
{
    double fastest = 0.0;
    for (size_t i = 0; i < trial->in.of->body_count; i++) {
        fastest = fmax(fastest, fabs(trial->motions[i].omega));
    }
    const double step_s = trial->in.of->step_s;
    return fastest * step_s > BEND_PHASE ? BEND_PHASE / fastest : step_s;
}

// u'' = J a + J' v at the middle's positions and velocities like those there.
static void find_row_accelerations(Trial *trial, const double *v, const double *a, double *rows)
{
    tree_motions(trial->tree, trial->in.q_middle, v, trial->motions);
    tree_bends(trial->tree, trial->motions, v, trial->tree->bends);
    for (size_t i = 0; i < trial->in.rows; i++) {
        rows[i] = dot(trial->in.jacobian + i * trial->in.count, a, trial->in.count);
    }
    add_bends_of_points(trial, rows);
    if (trial->has_walls) {
        const double little_s = little_of(trial);
        add_rates_at(trial, v, little_s, 0.5 / little_s, rows);
        add_rates_at(trial, v, -little_s, -0.5 / little_s, rows);
    }
}

// The same by a trial with a force in each row: one that does as much as all that acts.
static void try_rows(Trial *trial, const double *q, const double *v, const double *free,
                     double *columns, double *answers)
{
    Within *in = &trial->in;
    Hold *hold = &trial->hold;
    memcpy(trial->held, hold->right, hold->rows * sizeof *trial->held);
    const double size = 1.0 + sqrt(dot(free, free, in->count));
    for (size_t k = 0; k < in->rows; k++) {
        double *column = columns + k * in->count;
        memset(in->work, 0, in->rows * sizeof *in->work);
        in->work[k] = 1.0;
        evaluate(trial, q, v, in->work, size, column);
        for (size_t i = 0; i < in->count; i++) {
            column[i] = (column[i] - free[i]) / size;
        }
        for (size_t i = 0; i < hold->rows; i++) {
            hold->right[i] = (hold->right[i] - trial->held[i]) / size;
        }
        if (answers != NULL) {
            answer(trial, q, column, hold->right, k, answers);
        }
    }
}

// Writes what unit forces in the rows do to the accelerations, where the bodies of `motions` and
// the Jacobian are; `free` is what they are without. And what they do to the reactions of joints
// that rub; NULL: that is not wanted.
static void find_columns(Trial *trial, const double *q, const double *v, const double *free,
                         double *columns, double *answers)
{
    Within *in = &trial->in;
    if (trial->engine->respond == NULL) {
        try_rows(trial, q, v, free, columns, answers);
        return;
    }
    trial->engine->respond(trial->engine->engine, q, in->rows, in->jacobian, columns);
    for (size_t k = 0; k < in->rows; k++) {
        double *column = columns + k * in->count;
        hold_restrain(&trial->hold, column);
        if (answers != NULL) {
            answer(trial, q, column, trial->hold.right, k, answers);
        }
    }
}

// The accelerations that trials of single rows are compared with; none where the engine responds.
static void compare_with(Trial *trial, const double *q, const double *v)
{
    if (trial->engine->respond == NULL) {
        evaluate(trial, q, v, NULL, 0.0, trial->changed);
    }
}

// A and W.
static void find_response(Trial *trial)
{
    Within *in = &trial->in;
    find_columns(trial, in->q_middle, in->v_middle, in->free, in->response,
                 trial->rubs.count > 0 ? trial->rubs.answers : NULL);
    for (size_t i = 0; i < in->rows; i++) {
        for (size_t k = 0; k < in->rows; k++) {
            *kernel_mobility(&in->kernel, i, k) =
                dot(in->jacobian + i * in->count, in->response + k * in->count, in->count);
        }
    }
}

// A', from A where the bodies are a little later at the mean rates of the step, which have been
// found for the accelerations. It matters where contacts have pushed alone.
static void find_rate(Trial *trial)
{
    Within *in = &trial->in;
    const size_t count = in->count;
    memset(in->rate, 0, in->rows * count * sizeof *in->rate);
    if (!within_has_pushed(in)) {
        return;
    }
    const double later_s = TURN_PHASE / BEND_PHASE * little_of(trial);
    double *q = trial->later;
    double *v = in->nudged;
    memcpy(q, in->q_middle, count * sizeof *q);
    add(q, v, later_s, count);
    hold_settle(&trial->hold, trial->start_s, middle_of(trial) + later_s, q, v);
    tree_motions(trial->tree, q, v, trial->motions);
    hold_place(&trial->hold, trial->motions);
    find_jacobian(trial);
    compare_with(trial, q, v);
    find_columns(trial, q, v, trial->changed, in->rate, NULL);
    for (size_t i = 0; i < in->rows * count; i++) {
        in->rate[i] = (in->rate[i] - in->response[i]) / later_s;
    }
}

// How the answers of joints that rub change, from what they are a little later at the middle's
// rates, before what is at mid-step is found: 1/s of them, in `turning`, less those at mid-step.
static void begin_turning(Trial *trial)
{
    Within *in = &trial->in;
    Rubs *rubs = &trial->rubs;
    if (rubs->count == 0) {
        return;
    }
    tree_motions(trial->tree, in->q_middle, in->v_middle, trial->motions);
    const double later_s = TURN_PHASE / BEND_PHASE * little_of(trial);
    double *q = trial->later;
    memcpy(q, in->q_middle, in->count * sizeof *q);
    add(q, in->v_middle, later_s, in->count);
    find_holding(trial, q, in->v_middle);
    tree_motions(trial->tree, q, in->v_middle, trial->motions);
    hold_place(&trial->hold, trial->motions);
    find_jacobian(trial);
    compare_with(trial, q, in->v_middle);
    find_columns(trial, q, in->v_middle, trial->changed, in->rate, rubs->turning);
    rubs->later_s = later_s;
}

static void end_turning(Rubs *rubs)
{
    for (size_t i = 0; i < 2 * rubs->count * rubs->rows; i++) {
        rubs->turning[i] = (rubs->turning[i] - rubs->answers[i]) / rubs->later_s;
    }
}

// What the impulse of a row adds to the reactions, at velocities that it has changed.
static void react_late(Trial *trial, size_t row, double nudge)
{
    double *found = trial->reactions[1];
    react(trial, trial->in.q_middle, trial->in.nudged, trial->changed, found);
    for (size_t i = 0; i < 2 * trial->rubs.count; i++) {
        found[i] = (found[i] - trial->reactions[0][i]) / nudge;
    }
    rubs_take(&trial->rubs, row, found, trial->rubs.late);
}

// S and B, by a velocity that is a little different for each row.
static void find_drift(Trial *trial)
{
    const size_t count = trial->in.count;
    const double speed = sqrt(dot(trial->in.v_middle, trial->in.v_middle, count));
    for (size_t k = 0; k < trial->in.rows; k++) {
        const double *response = trial->in.response + k * count;
        const double size = sqrt(dot(response, response, count));
        if (!(size > 0.0)) {
            continue; // a turn of the ground: nothing follows it
        }
        const double nudge = NUDGE * (speed > 0.0 ? speed : 1.0) / size;
        memcpy(trial->in.nudged, trial->in.v_middle, count * sizeof *trial->in.nudged);
        add(trial->in.nudged, response, nudge, count);
        evaluate(trial, trial->in.q_middle, trial->in.nudged, NULL, 0.0, trial->changed);
        if (trial->rubs.count > 0) {
            react_late(trial, k, nudge);
        }
        find_row_accelerations(trial, trial->in.nudged, trial->changed, trial->in.work);
        for (size_t i = 0; i < count; i++) {
            trial->in.bend[k * count + i] = (trial->changed[i] - trial->in.free[i]) / nudge;
        }
        for (size_t i = 0; i < trial->in.rows; i++) {
            trial->in.drift[i * trial->in.rows + k] =
                (trial->in.work[i] - trial->in.kernel.free[i]) / (2.0 * nudge);
        }
    }
}

// The engine at mid-step under the contacts' mean force.
static void find_accelerations(Trial *trial, double step_s)
{
    Within *in = &trial->in;
    const double per_s = 1.0 / step_s;
    memcpy(in->nudged, in->v_middle, in->count * sizeof *in->nudged);
    within_add_rows(in, in->response, in->sums.moment, per_s, in->nudged);
    within_add_rows(in, in->bend, in->sums.moment + in->rows, per_s, in->nudged);
    evaluate(trial, in->q_middle, in->nudged, in->sums.impulse, per_s, trial->other);
    within_take_accelerations(in, trial->other, step_s);
    find_rate(trial);
}

// Integrates the contacts over a step.
static void integrate(Trial *trial, double step_s)
{
    Within *in = &trial->in;
    within_find_middle(in, step_s);
    begin_turning(trial);
    find_holding(trial, in->q_middle, in->v_middle);
    hold_settle(&trial->hold, trial->start_s, middle_of(trial), in->q_middle, in->v_middle);
    within_keep_free(in);
    tree_motions(trial->tree, in->q_middle, in->v_middle, trial->motions);
    hold_place(&trial->hold, trial->motions);
    find_jacobian(trial);
    evaluate(trial, in->q_middle, in->v_middle, NULL, 0.0, in->free);
    react(trial, in->q_middle, in->v_middle, in->free, trial->reactions[0]);
    find_response(trial);
    end_turning(&trial->rubs);
    find_row_accelerations(trial, in->v_middle, in->free, in->kernel.free);
    find_drift(trial);
    within_find_free_rate(in, step_s);
    tree_motions(trial->tree, in->q, in->v, trial->motions);
    within_find_rows(in, trial->motions);
    rubs_fill(&trial->rubs, trial->reactions[0], in->known > 0 ? within_apart(in, step_s) : 0.0);
    within_integrate(in, step_s);
}

// Finds the end of such a step.
static void end_step(Trial *trial, double step_s)
{
    Within *in = &trial->in;
    rubs_keep(&trial->rubs, in->sums.impulse);
    find_accelerations(trial, step_s);
    within_find_end(in, step_s);
    hold_settle(&trial->hold, trial->start_s, trial->end_s, in->q_next, in->v_next);
}

// The bodies at a time in the step that has been taken.
static void read_inside(void *adapter, double since_s, const KernelSums *sums,
                        DriverMotion *motions)
{
    Trial *trial = adapter;
    Within *in = &trial->in;
    within_find_inside(in, since_s, trial->end_s - trial->start_s, sums, in->nudged, trial->other);
    hold_settle(&trial->hold, trial->start_s, trial->start_s + since_s, in->nudged, trial->other);
    tree_motions(trial->tree, in->nudged, trial->other, motions);
}

static Trial make(const Tree *tree, const TrialEngine *engine, DriverRun *run)
{
    const DriverCase *of = tree->of;
    Trial trial = {.hold = hold_make(tree),
                   .tree = tree,
                   .engine = engine,
                   .run = run,
                   .other = driver_room(tree->coordinates, sizeof *trial.other),
                   .changed = driver_room(tree->coordinates, sizeof *trial.changed),
                   .later = driver_room(tree->coordinates, sizeof *trial.later),
                   .motions = driver_room(of->body_count, sizeof *trial.motions),
                   .tried = driver_room(of->body_count, sizeof *trial.tried),
                   .actions = driver_room(of->body_count, sizeof *trial.actions)};
    for (size_t i = 0; i < of->place_count + of->rub_count; i++) {
        trial.has_walls = trial.has_walls || !place_is_point(&of->places[i]);
    }
    trial.held = driver_room(trial.hold.rows, sizeof *trial.held);
    for (int i = 0; i < 2; i++) {
        trial.reactions[i] = driver_room(2 * of->rub_count, sizeof(double));
    }
    within_open(of, tree->coordinates, &trial.in);
    return trial;
}

// The next time at which accelerations jump: at a kink of a drive, or where a load over time does.
static double next_jump(const DriverCase *of, double time_s)
{
    double next_s = INFINITY;
    for (size_t i = 0; i < of->drive_count; i++) {
        next_s = fmin(next_s, drive_next_kink(&of->drives[i].law, time_s));
    }
    for (size_t i = 0; i < of->load_count; i++) {
        const DriverLoad *load = &of->loads[i];
        if (load->table.shape == LOAD_STEPS && load->over_joint < 0 && load->rate != 0.0) {
            const double sign = load->rate < 0.0 ? -1.0 : 1.0;
            const double at =
                load_table_next(&load->table, load->shift + load->rate * time_s, sign);
            next_s = fmin(next_s, (at - load->shift) / load->rate);
        }
    }
    return next_s;
}

// Starts the scheme where a step begins.
static void start_scheme(Trial *trial)
{
    Within *in = &trial->in;
    within_start(in);
    trial->end_s = trial->start_s;
    find_holding(trial, in->q, in->v);
    evaluate(trial, in->q, in->v, NULL, 0.0, in->a);
}

// Takes the step up to a time; returns false, and leaves all as it was, where it is one of those
// that may be divided, and is to be.
static bool take_step(Trial *trial, double end_s, bool may_be_divided)
{
    const double step_s = end_s - trial->start_s;
    trial->end_s = end_s;
    trial->run->steps += trial->engine->respond != NULL ? 1 : 0;
    if (may_be_divided) {
        carry_begin(&trial->carry, false);
        within_carry(&trial->in, &trial->carry);
    }
    integrate(trial, step_s);
    if (may_be_divided && within_is_rough(&trial->in, step_s)) {
        carry_begin(&trial->carry, true);
        within_carry(&trial->in, &trial->carry);
        return false;
    }
    end_step(trial, step_s);
    return true;
}

// Looks at a step that has been taken, and goes on.
static void leave_step(Trial *trial, WithinStep *step)
{
    step->start_s = trial->start_s;
    step->step_s = trial->end_s - trial->start_s;
    within_look(step, trial->run);
    within_go_on(&trial->in, step->step_s);
    trial->start_s = trial->end_s;
}

static void go_to(Trial *trial, WithinStep *step, double end_s)
{
    const double start_s = trial->start_s;
    if (take_step(trial, end_s, true)) {
        leave_step(trial, step);
        return;
    }
    for (int i = 1; i <= PARTS; i++) {
        const double share = (double)i / PARTS;
        take_step(trial, i < PARTS ? start_s + share * (end_s - start_s) : end_s, false);
        leave_step(trial, step);
    }
}

void trial_run(const Tree *tree, const TrialEngine *engine, DriverRun *run)
{
    Trial trial = make(tree, engine, run);
    trial.rubs = rubs_make(tree, &trial.hold, &trial.in.kernel);
    const double step_s = tree->of->step_s;
    KernelSums sums = kernel_sums(trial.in.rows);
    WithinStep step = {.kernel = &trial.in.kernel,
                       .states = places_start(tree->of),
                       .motions = read_inside,
                       .adapter = &trial,
                       .room = driver_room(tree->of->body_count, sizeof(DriverMotion)),
                       .sums = &sums};
    size_t tick = 0;
    bool is_jump = true;
    driver_run_begin(run);
    tree_start(tree, trial.in.v);
    while (!driver_run_is_full(run)) {
        if (is_jump) {
            start_scheme(&trial);
        }
        const double tick_s = step_s * (double)(tick + 1);
        const double jump_s = next_jump(tree->of, trial.start_s);
        is_jump = jump_s < tick_s + TIME_ROUNDING * step_s;
        const double end_s = is_jump ? jump_s : tick_s;
        tick += end_s > tick_s - TIME_ROUNDING * step_s ? 1 : 0;
        go_to(&trial, &step, end_s);
    }
    driver_run_write(run);
}

// Engines whose coordinates are those of bodies.

double trial_step(const DriverCase *of)
{
    double fastest = 0.0;
    for (size_t i = 0; i < of->body_count; i++) {
        fastest = fmax(fastest, fabs(of->bodies[i].start.omega));
    }
    return fastest > 0.0 ? fmin(TRIAL_S, TRIAL_PHASE / fastest) : TRIAL_S;
}

void trial_place(const Tree *tree, const double *q, const double *v, const DriverAction *given,
                 DriverMotion *motions, DriverAction *actions)
{
    tree_motions(tree, q, v, motions);
    tree_bends(tree, motions, v, tree->bends);
    for (size_t i = 0; i < tree->of->body_count; i++) {
        actions[i] = given[i];
        actions[i].force =
            vec2_sub(given[i].force, vec2_scale(tree->of->bodies[i].mass, tree->bends[i]));
    }
}

static Vec2 gained(const DriverMotion *before, const DriverMotion *after, double step_s)
{
    return vec2_scale(1.0 / step_s, vec2_sub(after->velocity, before->velocity));
}

void trial_read(const Tree *tree, const DriverMotion *before, const DriverMotion *after,
                double step_s, double *a)
{
    for (size_t i = 0; i < tree->of->body_count; i++) {
        const TreeBody *body = &tree->bodies[i];
        const bool has_parent = body->parent != DRIVER_GROUND;
        const double turning = (after[i].omega - before[i].omega) / step_s;
        const double carried =
            has_parent ? (after[body->parent].omega - before[body->parent].omega) / step_s : 0.0;
        const Vec2 going = gained(&before[i], &after[i], step_s);
        double *own = a + body->first;
        if (body->kind == TREE_FREE) {
            own[0] = going.x;
            own[1] = going.y;
            own[2] = turning;
        } else if (body->kind == TREE_TURNS) {
            own[0] = turning - carried;
        } else {
            Vec2 held = {0.0, 0.0};
            Vec2 from = {0.0, 0.0};
            if (has_parent) {
                held = gained(&before[body->parent], &after[body->parent], step_s);
                from = before[body->parent].position;
            }
            const Vec2 arm = vec2_sub(before[i].position, from);
            const Vec2 moved = vec2_add(held, vec2_scale(carried, vec2_perp(arm)));
            own[0] = vec2_dot(vec2_rotate(before[i].angle, body->axis), vec2_sub(going, moved));
        }
    }
}
