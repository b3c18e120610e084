// Makes two rows of ODE follow the friction law mu N tanh(|v| / v_s) against v.
//
// As in ode/plane/contact_friction.c, the step is solved here first, and ODE's rows are then made
// to come to the same forces. With N what presses, F the force along the wall, a vector, W the
// mobility:
//     u' = u + h (a + W_nn N + W_nt F),     u' + CFM N = (ERP / h) d,     N >= 0
//     v' = v + h (a + W_tn N + W_tt F),     F = -mu N tanh(|w| / v_s) w / |w|
//     w = theta v' + (1 - theta) v
// Of one place, the others given: w (1 + theta phi W_tt h) = b, phi = mu N tanh(|w| / v_s) / |w|,
// has one solution, as |w| of the left side grows with the |w| in phi.
// ODE's first direction is that of w, with the slope of the law there; along the second one w is
// zero, and the law's slope is phi. A pyramid with the bound mu N in both directions would hold
// with up to sqrt 2 mu N, in a direction that depends on the choice of the two.
//
// The ideal joints hold as in ODE, J v' = -(ERP / h) opening, which is part of a.
#include "ode/space/space_friction.h"

#include "base/zeroed.h"
#include "kernel/friction_law.h"

#include <math.h>

enum { SWEEPS_MAX = 50, ROOT_STEPS_MAX = 60, PARTS = 3 };

static const double CONVERGED = 1e-7; // of the largest force: the step's own error is larger
static const double FLAT = 1e-9;      // slope of tanh, below which the row is at its bound

typedef struct Share {
    double free[PARTS];   // m/s: speeds after the step if nothing pressed: normal, side, other
    double before[PARTS]; // m/s: of the two along the wall, before it
    double theta;
    double mean[PARTS]; // m/s: w, of the two along the wall
} Share;

// The equations of a step: of each place what presses, then what acts along the wall.
typedef struct System {
    const SpaceFrictionRow *rows;
    size_t count;
    const SpaceResponse *response; // placed: W
    const size_t *places;          // of each its number there
    size_t *index_of;              // by number there: which of these it is, or `count`; owned
    double step_s;
    Share *shares;  // by place; owned, as the next one
    double *forces; // N
} System;

static Vec3 direction(const SpaceFrictionRow *row, int part)
{
    return part == 0 ? row->normal : part == 1 ? row->side : vec3_cross(row->normal, row->side);
}

// h W between two places, a row of the first from one of the second.
static double at(const System *system, size_t row, size_t column)
{
    const size_t to = system->places[row / PARTS];
    const size_t from = system->places[column / PARTS];
    const size_t i = row % PARTS;
    const size_t k = column % PARTS;
    const double *block = to > from ? space_response_block(system->response, to, from)
                                    : space_response_block(system->response, from, to);
    const double between = block == NULL ? 0.0
                           : to > from   ? block[i * PARTS + k]
                                         : block[k * PARTS + i];
    return system->step_s * between;
}

// How the speeds of all rows would be after the step if nothing pressed.
static void find_free_speeds(System *system, SpaceResponse *response, const SpaceFrictionStep *step,
                             const SpaceRow *play_rows)
{
    const size_t bodies = response->linkage->body_count;
    const size_t play = space_response_play_rows(response);
    double *ideal = zeroed(3 * response->ideal_rows, sizeof *ideal);
    double *openings = ideal + response->ideal_rows;
    double *rates = openings + response->ideal_rows;
    double *play_drift = zeroed(2 * play, sizeof *play_drift);
    double *free_rates = play_drift + play;
    SpaceMotion *pushed = zeroed(bodies, sizeof *pushed);
    for (size_t i = 0; i < bodies; i++) {
        pushed[i] = step->motions[i];
        pushed[i].velocity = step->motions[i].acceleration;
        pushed[i].omega = step->motions[i].alpha;
    }
    space_response_openings(response, step->motions, openings, rates);
    for (size_t i = 0; i < response->ideal_rows; i++) {
        const SpaceRow *row = &response->rows[i].row;
        const double late =
            space_row_speed(row, step->motions) + step->erp / step->step_s * openings[i];
        ideal[i] = space_row_speed(row, pushed) + late / step->step_s;
    }
    for (size_t i = 0; i < play; i++) {
        play_drift[i] = space_row_speed(&play_rows[i], pushed);
    }
    space_response_free(response, ideal, play_drift, free_rates);
    for (size_t i = 0; i < PARTS * system->count; i++) {
        const size_t row = PARTS * system->places[i / PARTS] + i % PARTS;
        system->shares[i / PARTS].free[i % PARTS] =
            space_row_speed(&play_rows[row], step->motions) + step->step_s * free_rates[row];
    }
    free(pushed);
    free(play_drift);
    free(ideal);
}

static bool start_system(System *system, SpaceResponse *response, const SpaceFrictionStep *step)
{
    const size_t play = space_response_play_rows(response);
    SpaceRow *play_rows = zeroed(play, sizeof *play_rows);
    for (size_t i = 0; i < play; i++) {
        play_rows[i].body[0] = play_rows[i].body[1] = LINKAGE_GROUND;
    }
    for (size_t i = 0; i < PARTS * system->count; i++) {
        const SpaceFrictionRow *row = &system->rows[i / PARTS];
        const Vec3 along = direction(row, (int)(i % PARTS));
        play_rows[PARTS * system->places[i / PARTS] + i % PARTS] = space_row_along(
            step->motions, row->body[0], row->point, row->body[1], row->point, along);
        system->shares[i / PARTS].before[i % PARTS] = vec3_dot(row->sliding, along);
    }
    const bool is_placed = space_response_place(response, step->motions, play_rows);
    if (is_placed) {
        find_free_speeds(system, response, step, play_rows);
    }
    free(play_rows);
    return is_placed;
}

// The speed along a row after the step from all forces but those of some rows of its own place.
static double speed_by_others(const System *system, size_t unknown, size_t from, size_t to)
{
    const size_t place = unknown / PARTS;
    double sum = system->shares[place].free[unknown % PARTS];
    const SpaceResponse *response = system->response;
    const size_t own = system->places[place];
    for (size_t n = response->first_partner[own]; n < response->first_partner[own + 1]; n++) {
        const size_t other = system->index_of[response->partners[n]];
        for (size_t k = PARTS * other; other < system->count && k < PARTS * (other + 1); k++) {
            if (k < from || k >= to) {
                sum += at(system, unknown, k) * system->forces[k];
            }
        }
    }
    return sum;
}

// w for a given theta phi: of (1 + K M) w = b.
static double solve_mean(double factor, const double m[3], const double b[2], double w[2])
{
    const double xx = 1.0 + factor * m[0];
    const double xy = factor * m[1];
    const double yy = 1.0 + factor * m[2];
    const double determinant = xx * yy - xy * xy;
    w[0] = (yy * b[0] - xy * b[1]) / determinant;
    w[1] = (xx * b[1] - xy * b[0]) / determinant;
    return sqrt(w[0] * w[0] + w[1] * w[1]);
}

// phi: what holds at a sliding speed, for each unit of it.
static double hold_at(double most, double speed, double size)
{
    return most * friction_grip(size, speed).share;
}

// Solves (1 + theta phi M) w = b for w, whose size phi depends on, by the Illinois method.
static void find_sliding(double most, double speed, double theta, const double m[3],
                         const double b[2], double w[2])
{
    double low = 0.0;
    double high = hypot(b[0], b[1]);
    const double within = CONVERGED * (1e-3 * speed + high);
    double size = high;
    double missing = solve_mean(theta * hold_at(most, speed, high), m, b, w) - high;
    double at_high = missing;
    double at_low = solve_mean(theta * hold_at(most, speed, low), m, b, w);
    int side = 0;
    for (int i = 0; i < ROOT_STEPS_MAX && high - low > within; i++) {
        size = (low * at_high - high * at_low) / (at_high - at_low);
        missing = solve_mean(theta * hold_at(most, speed, size), m, b, w) - size;
        if (fabs(missing) <= 1e-3 * within) {
            return;
        }
        if (missing > 0.0) {
            low = size;
            at_low = missing;
            at_high *= side == 1 ? 0.5 : 1.0;
            side = 1;
        } else {
            high = size;
            at_high = missing;
            at_low *= side == -1 ? 0.5 : 1.0;
            side = -1;
        }
    }
    solve_mean(theta * hold_at(most, speed, size), m, b, w);
}

// Solves for what holds a place, given what presses there and all other places.
static void find_hold(System *system, size_t place)
{
    Share *share = &system->shares[place];
    const size_t first = PARTS * place + 1;
    const double speed = system->rows[place].friction_speed;
    const double most = system->rows[place].friction * system->forces[PARTS * place];
    const double m[3] = {at(system, first, first), at(system, first, first + 1),
                         at(system, first + 1, first + 1)};
    const double stiffness = fmax(m[0], m[2]) * most / speed;
    share->theta = stiffness > 2.0 ? 1.0 - 1.0 / stiffness : 0.5;
    double b[2];
    for (size_t i = 0; i < 2; i++) {
        b[i] = share->theta * speed_by_others(system, first + i, first, first + 2) +
               (1.0 - share->theta) * share->before[1 + i];
    }
    double w[2];
    find_sliding(most, speed, share->theta, m, b, w);
    const double held = hold_at(most, speed, hypot(w[0], w[1]));
    for (size_t i = 0; i < 2; i++) {
        share->mean[1 + i] = w[i];
        system->forces[first + i] = -held * w[i];
    }
}

// Solves for what presses and, with friction, for what holds, in turns until nothing changes.
static void solve_forces(System *system, bool has_friction)
{
    double change = INFINITY;
    double largest = 0.0;
    for (int sweep = 0; sweep < SWEEPS_MAX && change > CONVERGED * largest; sweep++) {
        change = 0.0;
        for (size_t i = 0; i < system->count; i++) {
            double *forces = &system->forces[PARTS * i];
            const double before[PARTS] = {forces[0], forces[1], forces[2]};
            const double own = at(system, PARTS * i, PARTS * i) + system->rows[i].cfm;
            const double speed = speed_by_others(system, PARTS * i, PARTS * i, PARTS * i + 1);
            forces[0] = fmax(0.0, (system->rows[i].target - speed) / own);
            if (has_friction && system->rows[i].has_friction) {
                find_hold(system, i);
            }
            for (int k = 0; k < PARTS; k++) {
                change = fmax(change, fabs(forces[k] - before[k]));
            }
            largest = fmax(largest, forces[0]);
        }
    }
}

// The rows of a place that come to the forces found.
static void make_rows(const System *system, size_t place, double alone, SpaceFrictionRow *row)
{
    const Share *share = &system->shares[place];
    const double *w = share->mean + 1;
    const double speed = row->friction_speed;
    const double pressing = system->forces[PARTS * place];
    const double most = row->friction * pressing;
    const double size = hypot(w[0], w[1]);
    if (!row->has_friction || !(most > 0.0)) {
        return;
    }
    if (size > 0.0) {
        row->along = vec3_scale(1.0 / size, vec3_add(vec3_scale(w[0], direction(row, 1)),
                                                     vec3_scale(w[1], direction(row, 2))));
    }
    row->bound = alone > 0.0 ? row->friction * pressing / alone : row->bound;
    const Vec3 across = vec3_cross(row->normal, row->along);
    const double before[2] = {(1.0 - share->theta) * vec3_dot(row->sliding, row->along),
                              (1.0 - share->theta) * vec3_dot(row->sliding, across)};
    const double held = friction_hold(size, speed).held;
    const double slope = 1.0 - held * held;
    if (slope > FLAT) {
        const double reach = speed / (share->theta * slope);
        row->slip[0] = reach / most;
        row->surface[0] = (size - before[0]) / share->theta - held * reach;
    }
    row->slip[1] = 1.0 / (share->theta * hold_at(most, speed, size));
    row->surface[1] = -before[1] / share->theta;
}

// Solves without friction and with it, and fills in the rows.
static void find_rows(System *system, double *alone, SpaceFrictionRow *rows)
{
    solve_forces(system, false);
    for (size_t i = 0; i < system->count; i++) {
        alone[i] = system->forces[PARTS * i];
    }
    solve_forces(system, true);
    for (size_t i = 0; i < system->count; i++) {
        make_rows(system, i, alone[i], &rows[i]);
    }
}

bool space_friction_find(SpaceResponse *response, const SpaceFrictionStep *step,
                         const size_t *places, SpaceFrictionRow *rows, size_t count)
{
    System system = {
        .rows = rows,
        .count = count,
        .response = response,
        .places = places,
        .index_of = zeroed(response->place_count, sizeof *system.index_of),
        .step_s = step->step_s,
        .shares = zeroed(count, sizeof *system.shares),
        .forces = zeroed(PARTS * count, sizeof *system.forces),
    };
    double *alone = zeroed(count, sizeof *alone);
    for (size_t i = 0; i < response->place_count; i++) {
        system.index_of[i] = count;
    }
    for (size_t i = 0; i < count; i++) {
        system.index_of[places[i]] = i;
    }
    const bool is_started = start_system(&system, response, step);
    if (is_started) {
        find_rows(&system, alone, rows);
    }
    free(alone);
    free(system.index_of);
    free(system.shares);
    free(system.forces);
    return is_started;
}
