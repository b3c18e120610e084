// Steps one impact on ODE's contact row, and on the law that the row stands for.
//
// ODE's row, F >= 0      F = ((ERP / h) d + d') / (CFM + h / m)
// then                   d'_new = d' - h F / m, d_new = d + h d'_new
// with bounce            e d' stands in place of (ERP / h) d where it is larger
// the law                m d'' = -max(0, F_el(d) (1 + chi d'/v) + c(d) d'), d(0) = 0, d'(0) = v
//
// The law is integrated by the classic Runge-Kutta method of order 4. At the onset F_el goes with
// d^n, n >= 1, so that the first step is wrong by (dt / T)^(n+2) of the whole, and all others by
// (dt / T)^4: with 4000 steps both are below 1e-9. Where a viscous damper lets go, the force has a
// kink, which costs (dt / T)^2, some 1e-7.
//
// d penetration, m; d' closing speed, m/s; F force, N; h step, s; m effective mass, kg; e
// restitution, 1; chi hysteresis factor, 1; c viscous coefficient, N s/m; v speed at the onset,
// m/s.
#include "contact/map_impact.h"

#include "base/root.h"
#include "contact/law_row.h"

#include <assert.h>
#include <float.h>
#include <math.h>

// far beyond any contact that means something: some milliseconds of wall time
enum { STEP_MAX = 1000000 };

// steps of the law in the time that the pin would need for its deepest point at its first speed;
// the contact lasts about three times as long
static const double LAW_STEPS = 1500.0;

// of the deepest point: no force shows there
static const double FIRST_DEPTH = 1e-12;

// the shortest time constant of the damper, m / c, is taken in this many steps: RK4 is stable from
// 0.4
static const double DAMPER_STEPS = 50.0;

ForceLaw map_impact_linear(double stiffness, double damping)
{
    // a spring of nothing is a damper alone
    ForceLaw law = force_law_power(fmax(stiffness, DBL_MIN), 1.0);
    law.viscous = damping;
    return law;
}

double map_impact_phase(int number)
{
    return (number + 0.5) / MAP_IMPACT_PHASES;
}

// fmax of a value and a number, without the call: the loop below is what a search spends its time
// in.
static double larger(double value, double number)
{
    return value > number ? value : number;
}

// ODE's row at a depth and closing speed: what the pin is to leave with, and the CFM.
typedef struct Row {
    double speed;   // m/s
    double cfm;     // m/(N s)
    double omega_h; // 1; 0 of rows that are not made by a map
    bool falls_back;
} Row;

static Row poisson_row(const MapImpactCase *impact, double depth, double closing)
{
    const MapImpactRows *rows = &impact->rows;
    const double push = rows->push_out / impact->step * depth;
    const double bounce = closing > rows->bounce_speed ? rows->restitution * closing : 0.0;
    return (Row){.speed = larger(push, bounce), .cfm = rows->cfm};
}

static Row map_row_of(const MapImpactCase *impact, double depth, double closing)
{
    const LawRow at = {.depth = depth,
                       .closing = closing,
                       .impact_speed = impact->speed,
                       .share = 1.0,
                       .mass = impact->mass};
    const MapContact contact = law_row_contact(&impact->law, &at, impact->step);
    const double omega_h =
        sqrt(force_law_tangent(&impact->law, depth) / impact->mass) * impact->step;
    const Map *map = impact->rows.map;
    const bool falls_back = !(omega_h < map->stability_limit);
    if (!map_contact_is_sound(&contact)) {
        return (Row){.speed = NAN, .cfm = NAN}; // out of a double's range: the impact never ends
    }
    const ErpCfm soft = law_row_soft(map, falls_back, &contact);
    return (Row){soft.erp / impact->step * depth, soft.cfm, omega_h, falls_back};
}

MapImpact map_impact(const MapImpactCase *impact, double first_overlap)
{
    MapImpact result = {0};
    double depth = fmax(first_overlap * impact->speed * impact->step, DBL_MIN); // m
    double closing = impact->speed;                                             // m/s
    const double end = impact->end > 0.0 ? impact->end : INFINITY;
    const size_t step_most = impact->step_most > 0 ? impact->step_most : STEP_MAX;
    while (depth > 0.0 && depth <= end && result.steps < step_most) {
        const Row row = impact->rows.map != NULL ? map_row_of(impact, depth, closing)
                                                 : poisson_row(impact, depth, closing);
        // the row, solved for the force; the wall never pulls
        const double wanted = (row.speed + closing) / (row.cfm + impact->step / impact->mass);
        if (isnan(wanted)) {
            return (MapImpact){.steps = result.steps};
        }
        const double force = larger(wanted, 0.0);
        result.force_max = larger(force, result.force_max);
        result.penetration_max = larger(depth, result.penetration_max);
        result.fallbacks += row.falls_back ? 1 : 0;
        if (row.omega_h > result.omega_h_max) {
            result.omega_h_max = row.omega_h;
            result.omega_h_depth = depth;
        }
        result.steps++;
        closing -= impact->step * force / impact->mass;
        depth += impact->step * closing;
    }
    result.is_ended = depth <= 0.0;
    result.is_past_end = !result.is_ended && !(depth <= end);
    result.penetration_max = result.is_past_end ? depth : result.penetration_max;
    result.restitution = result.is_ended ? -closing / impact->speed : 0.0;
    result.duration = (double)result.steps * impact->step;
    return result;
}

static double missing_energy(double depth, void *context)
{
    const MapImpactCase *impact = context;
    return force_law_energy(&impact->law, depth) -
           0.5 * impact->mass * impact->speed * impact->speed;
}

enum { DOUBLINGS = 200 }; // of a depth, until it takes up the energy

double map_impact_depth(const MapImpactCase *impact)
{
    const ForceLaw *law = &impact->law;
    if (law->family == FORCE_LAW_POWER) {
        const double order = law->exponent + 1.0;
        const double energy = 0.5 * impact->mass * impact->speed * impact->speed;
        return pow(order * energy / law->stiffness, 1.0 / order);
    }
    MapImpactCase sought = *impact;
    double depth = NAN;
    double most = force_law_depth_limit(law);
    if (!isfinite(most)) {
        most = law->conforming.play;
        for (int i = 0; i < DOUBLINGS && missing_energy(most, &sought) < 0.0; i++) {
            most *= 2.0;
        }
    }
    root_find(missing_energy, &sought, 0.0, most, 0.0, &depth);
    return depth;
}

// Depth and closing speed, and their rates, which have the same shape.
typedef struct State {
    double depth;
    double closing;
} State;

static double law_force(const MapImpactCase *impact, State at)
{
    return force_law_force(&impact->law, at.depth, at.closing, impact->speed);
}

static State law_rates(const MapImpactCase *impact, State at)
{
    return (State){at.closing, -law_force(impact, at) / impact->mass};
}

static State moved(State from, double time, State rates)
{
    return (State){from.depth + time * rates.depth, from.closing + time * rates.closing};
}

static State law_step(const MapImpactCase *impact, State from, double time)
{
    const State k1 = law_rates(impact, from);
    const State k2 = law_rates(impact, moved(from, 0.5 * time, k1));
    const State k3 = law_rates(impact, moved(from, 0.5 * time, k2));
    const State k4 = law_rates(impact, moved(from, time, k3));
    return (State){
        from.depth + time / 6.0 * (k1.depth + 2.0 * (k2.depth + k3.depth) + k4.depth),
        from.closing + time / 6.0 * (k1.closing + 2.0 * (k2.closing + k3.closing) + k4.closing),
    };
}

// The largest of three values at equal distances, by the parabola through them.
static double parabola_top(double before, double middle, double after)
{
    const double bend = before - 2.0 * middle + after;
    const double slope = 0.5 * (after - before);
    return bend < 0.0 && fabs(slope) <= -bend ? middle - 0.5 * slope * slope / bend
                                              : fmax(before, fmax(middle, after));
}

MapImpact map_impact_law(const MapImpactCase *impact)
{
    MapImpact result = {0};
    const double deepest = map_impact_depth(impact);
    if (!(deepest > 0.0 && isfinite(deepest))) {
        return result;
    }
    const double damper = force_law_damping(&impact->law, deepest, impact->speed);
    const double time =
        fmin(deepest / impact->speed / LAW_STEPS, impact->mass / (DAMPER_STEPS * damper));
    if (!(time >= DBL_MIN)) {
        return result; // no clock tells such an impact's steps apart
    }
    // just inside the wall, where a viscous damper presses at once
    State now = {FIRST_DEPTH * deepest, impact->speed};
    State before = now;
    double forces[3] = {0.0, 0.0, law_force(impact, now)};
    double depths[3] = {0.0, 0.0, 0.0};
    result.force_max = forces[2];
    while ((now.depth > 0.0 || result.steps == 0) && result.steps < STEP_MAX) {
        before = now;
        now = law_step(impact, now, time);
        result.steps++;
        forces[0] = forces[1], forces[1] = forces[2], forces[2] = law_force(impact, now);
        depths[0] = depths[1], depths[1] = depths[2], depths[2] = now.depth;
        if (result.steps > 1) {
            result.force_max =
                fmax(result.force_max, parabola_top(forces[0], forces[1], forces[2]));
            result.penetration_max =
                fmax(result.penetration_max, parabola_top(depths[0], depths[1], depths[2]));
        }
    }
    // the last step ended outside: the wall was passed where its line crosses it
    const double outside = now.depth / (now.depth - before.depth);
    result.is_ended = now.depth <= 0.0;
    result.duration = ((double)result.steps - outside) * time;
    result.restitution = result.is_ended ? -now.closing / impact->speed : 0.0;
    result.steps = 0;
    return result;
}

double map_delivered_restitution(const Map *map, double mass, double stiffness, double damping,
                                 double step)
{
    // the spring is linear, so any speed gives the same
    const MapImpactCase impact = {
        .law = map_impact_linear(stiffness, damping),
        .mass = mass,
        .speed = 1.0,
        .step = step,
        .rows = {.map = map},
    };
    double sum = 0.0;
    for (int i = 0; i < MAP_IMPACT_PHASES; i++) {
        sum += map_impact(&impact, map_impact_phase(i)).restitution;
    }
    return sum / MAP_IMPACT_PHASES;
}
