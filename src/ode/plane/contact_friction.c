// Makes a row of ODE follow the friction law mu N tanh(v / v_s).
//
// ODE knows a force along the wall that is bounded by a share of what presses (dContactApprox1),
// and one that is proportional to a speed (dContactSlip1, dContactMotion1). Its direct solver sets
// the bounds once, by what would press without friction, N0; but friction changes what presses.
// With N and F along and across the walls, W the linkage's mobility, u and v the speeds along and
// across, a their accelerations while nothing acts, e = (ERP / h) d:
//     u' = u + h (a + W_nn N + W_nt F),     u' + CFM N = e,     N >= 0
//     v' = v + h (a + W_tn N + W_tt F),     F = -mu N tanh(w / v_s)
//     w = theta v' + (1 - theta) v
// is what the step is to solve. It is solved here first, row by row in turns, once without F, which
// gives N0, and once with it. ODE's bound is then mu N / N0.
//
// The force of the row is linear in the speed: the tangent of the law at the w that was found, so
// that ODE comes to the same force. theta is 1/2, the midpoint rule, but where friction stops the
// pin within the step it is as large as keeps the speed from changing sign.
#include "ode/plane/contact_friction.h"

#include "base/zeroed.h"
#include "kernel/friction_law.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SWEEPS_MAX = 50, ROOT_STEPS_MAX = 50 };

static const double CONVERGED = 1e-7; // of the largest force: the step's own error is larger
static const double FLAT = 1e-9;      // slope of tanh, below which the row is at its bound
static const double SATURATED = 12.0; // tanh of it is 1 less 1e-10

enum { BLOCK = 4 }; // of two rows with two forces each

// One row's part in a step.
typedef struct Share {
    size_t row_count;                     // of the place in the response
    double along[RESPONSE_ROWS_A_JOINT];  // a unit of speed along the normal, by those rows
    double across[RESPONSE_ROWS_A_JOINT]; // likewise along the wall
    double asked;                         // m/s: what the forces must change along the normal
    double drift;                         // m/s: v' if no contact pressed
    double theta;
    double mean; // m/s: w
    // the rows that move this one, itself among them, in order, and how: h W of their two forces
    // and this row's two speeds, s/kg
    size_t partner_count;
    const size_t *partners;
    const double *changes;
    const double *own; // those of the row itself
} Share;

struct FrictionWork {
    Share *shares;
    size_t *partners; // of all rows
    double *changes;
    size_t *share_of; // of a place: its row and 1, or 0
    double *forces;
    double *alone;
    double *free;
};

// The equations of a step: of each row what presses, then what acts along the wall.
typedef struct System {
    const FrictionRow *rows;
    Share *shares;
    size_t count;   // of rows
    double *forces; // N: N and F of each row in turn
} System;

FrictionWork *contact_friction_work(const Response *response)
{
    const size_t count = response->place_count;
    const size_t blocks = response->first_partner[count];
    FrictionWork *work = zeroed(1, sizeof *work);
    work->shares = zeroed(count, sizeof *work->shares);
    work->partners = zeroed(blocks, sizeof *work->partners);
    work->changes = zeroed(BLOCK * blocks, sizeof *work->changes);
    work->share_of = zeroed(count, sizeof *work->share_of);
    work->forces = zeroed(2 * count, sizeof *work->forces);
    work->alone = zeroed(count, sizeof *work->alone);
    work->free = zeroed(response_play_rows(response), sizeof *work->free);
    return work;
}

void contact_friction_free(FrictionWork *work)
{
    if (work != NULL) {
        free(work->shares);
        free(work->partners);
        free(work->changes);
        free(work->share_of);
        free(work->forces);
        free(work->alone);
        free(work->free);
        free(work);
    }
}

double contact_friction_sliding(const FrictionRow *row)
{
    const Vec2 point = pair_point(row->pair, row->normal);
    return vec2_dot(vec2_perp(row->normal), pair_velocity(row->pair, point));
}

static double dot_rows(const Share *share, const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < share->row_count; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// What the rows of a place make of the speeds along and across the wall.
static void share_rows(const FrictionRow *row, Share *share)
{
    const Touch *touch = &row->pair->touch;
    if (touch_is_scalar(touch)) {
        // which are its rows
        share->row_count = 2;
        share->along[0] = share->across[1] = 1.0;
        return;
    }
    const Vec2 normal = pair_in_rows(row->pair, row->normal);
    const Vec2 tangent = vec2_perp(normal);
    const Vec2 arm = vec2_sub(pair_point(row->pair, row->normal), pair_anchor_b(row->pair));
    const double pin_arm = vec2_dot(row->normal, arm);
    const double radius = touch->shape == TOUCH_HOLE   ? touch->radius_a
                          : touch->shape == TOUCH_SLOT ? -pin_arm // about the pin's centre as well
                                                       : -touch->radius_a;
    *share = (Share){
        .row_count = RESPONSE_ROWS_A_JOINT,
        .along = {normal.x, normal.y, 0.0, 0.0},
        .across = {tangent.x, tangent.y, radius, pin_arm},
    };
}

static Share start_share(const FrictionRow *row, const double *free, double step_s)
{
    Share share = {.row_count = 0};
    share_rows(row, &share);
    share.theta = 0.5;
    const double *rates = free + row->first_row;
    share.asked = row->target + row->closing - step_s * dot_rows(&share, share.along, rates);
    share.drift = row->sliding + step_s * dot_rows(&share, share.across, rates);
    return share;
}

// Solves for the friction of a row, given what presses. `drift` is v' without it. The law asks for
// more than the force at one end of the bracket and for less at the other.
static double find_force(const System *system, size_t row, double drift)
{
    Share *share = &system->shares[row];
    const double speed = system->rows[row].friction_speed;
    const double mobility = share->own[3];
    if (system->rows[row].pair->is_end) {
        return 0.0;
    }
    const double most = system->rows[row].friction * system->forces[2 * row];
    const double stiffness = mobility * most / speed;
    share->theta = stiffness > 2.0 ? 1.0 - 1.0 / stiffness : 0.5;
    const double before = (1.0 - share->theta) * system->rows[row].sliding;
    double low = -most;
    double high = most;
    share->mean = share->theta * drift + before;
    if (fabs(share->mean) - share->theta * mobility * most > SATURATED * speed) {
        return copysign(most, -share->mean);
    }
    double force = fmax(low, fmin(system->forces[2 * row + 1], high));
    for (int i = 0; i < ROOT_STEPS_MAX; i++) {
        share->mean = share->theta * (drift + mobility * force) + before;
        const double held = friction_hold(share->mean, speed).held;
        const double missing = force + most * held;
        *(missing > 0.0 ? &high : &low) = force;
        double next = force - missing / (1.0 + share->theta * stiffness * (1.0 - held * held));
        if (!(next > low && next < high)) {
            next = 0.5 * (low + high);
        }
        if (fabs(next - force) <= CONVERGED * most) {
            return next;
        }
        force = next;
    }
    return force;
}

// What the forces of all unknowns but one change that one's speed by, m/s.
static double changed_by_others(const System *system, size_t unknown)
{
    const Share *share = &system->shares[unknown / 2];
    double sum = 0.0;
    for (size_t n = 0; n < share->partner_count; n++) {
        for (size_t k = 0; k < 2; k++) {
            const size_t other = 2 * share->partners[n] + k;
            const double change = share->changes[BLOCK * n + 2 * (unknown % 2) + k];
            sum += other == unknown ? 0.0 : change * system->forces[other];
        }
    }
    return sum;
}

// Solves for what presses and, with friction, for what holds, in turns until nothing changes.
static void solve_forces(System *system, bool has_friction)
{
    double change = INFINITY;
    double largest = 0.0;
    for (int sweep = 0; sweep < SWEEPS_MAX && change > CONVERGED * largest; sweep++) {
        change = 0.0;
        for (size_t i = 0; i < system->count; i++) {
            const Share *share = &system->shares[i];
            double *forces = &system->forces[2 * i];
            const double before[] = {forces[0], forces[1]};
            const double own = share->own[0] + system->rows[i].cfm;
            forces[0] = fmax(0.0, (share->asked - changed_by_others(system, 2 * i)) / own);
            if (has_friction) {
                forces[1] =
                    find_force(system, i, share->drift + changed_by_others(system, 2 * i + 1));
            }
            change = fmax(change, fmax(fabs(forces[0] - before[0]), fabs(forces[1] - before[1])));
            largest = fmax(largest, forces[0]);
        }
    }
}

// Fills in how the two forces of one row change the two speeds of another.
static void fill_change(const System *system, const Response *response, double step_s, size_t to,
                        size_t from, double *change)
{
    const Share *shares[2] = {&system->shares[to], &system->shares[from]};
    for (size_t i = 0; i < 2; i++) {
        for (size_t k = 0; k < 2; k++) {
            const double mobility = response_between(response, system->rows[from].first_row,
                                                     k == 0 ? shares[1]->along : shares[1]->across,
                                                     system->rows[to].first_row,
                                                     i == 0 ? shares[0]->along : shares[0]->across);
            change[2 * i + k] = step_s * mobility;
        }
    }
}

// Lists the rows that move each row, and how much.
static void fill_changes(System *system, const Response *response, double step_s,
                         FrictionWork *work)
{
    size_t block = 0;
    memset(work->share_of, 0, response->place_count * sizeof *work->share_of);
    for (size_t i = 0; i < system->count; i++) {
        work->share_of[response_place_at(response, system->rows[i].first_row)] = i + 1;
    }
    for (size_t i = 0; i < system->count; i++) {
        Share *share = &system->shares[i];
        const size_t place = response_place_at(response, system->rows[i].first_row);
        share->partners = work->partners + block;
        share->changes = work->changes + BLOCK * block;
        share->partner_count = 0;
        for (size_t n = response->first_partner[place]; n < response->first_partner[place + 1];
             n++) {
            const size_t other = work->share_of[response->partners[n]];
            if (other > 0) {
                double *change = work->changes + BLOCK * block;
                fill_change(system, response, step_s, i, other - 1, change);
                share->own = other - 1 == i ? change : share->own;
                work->partners[block++] = other - 1;
                share->partner_count++;
            }
        }
    }
}

// The tangent of the law at the speed that was found.
static void linearise_force(const System *system, size_t number, FrictionRow *row)
{
    const Share *share = &system->shares[number];
    const double speed = row->friction_speed;
    const double most = row->friction * system->forces[2 * number];
    const double held = friction_hold(share->mean, speed).held;
    const double slope = 1.0 - held * held;
    if (slope > FLAT && most > 0.0) {
        const double reach = speed / (share->theta * slope);
        const double before = (1.0 - share->theta) * row->sliding;
        row->slip = reach / most;
        row->surface = (share->mean - before) / share->theta - held * reach;
    }
}

void contact_friction_find(const Response *response, const Motion *motions, Vec2 gravity,
                           const BodyLoad *loads, double step_s, FrictionWork *work,
                           FrictionRow *rows, size_t count)
{
    System system = {rows, work->shares, count, work->forces};
    response_free(response, motions, gravity, loads, work->free);
    for (size_t i = 0; i < count; i++) {
        rows[i].sliding = contact_friction_sliding(&rows[i]);
        system.shares[i] = start_share(&rows[i], work->free, step_s);
        system.forces[2 * i] = system.forces[2 * i + 1] = 0.0;
    }
    fill_changes(&system, response, step_s, work);
    solve_forces(&system, false);
    for (size_t i = 0; i < count; i++) {
        work->alone[i] = system.forces[2 * i];
    }
    solve_forces(&system, true);
    for (size_t i = 0; i < count; i++) {
        const double pressing = system.forces[2 * i];
        rows[i].bound =
            work->alone[i] > 0.0 ? rows[i].friction * pressing / work->alone[i] : rows[i].friction;
        rows[i].slip = INFINITY;
        linearise_force(&system, i, &rows[i]);
    }
}
