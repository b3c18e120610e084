// Which ERP and CFM make ODE's contact row the spring and damper that was asked for, and what does
// the row deliver then?
//
// ODE's row, F >= 0      v_out + CFM F = (ERP / h) d
// textbook               ERP = h k / (h k + c), CFM = 1 / (h k + c): F = k (d - h v_out) - c v_out,
//                        implicit Euler, always stable, damping raised by h k
// corrected              ERP = h k / c, CFM = 1 / c: F = k d - c v_out, spring explicit and damper
//                        implicit; symplectic, no damping of its own, stable for omega h < 2
// inverse of textbook    kp = ERP / (h CFM), kd = (1 - ERP) / CFM
// Poisson                F = p d': CFM = 1 / p
// bounce with CFM        delivered e' = (e - r) / (1 + r), r = CFM m / h
//
// At c = 0 the corrected map has no finite CFM. A damper c = 1e-10 h k stands in: it changes the
// force by 1e-10 h v_out / d of itself.
//
// d penetration, m; v_out separating speed after the step, m/s; F force, N; h step, s; k stiffness,
// N/m; c damping, N s/m; m effective mass, kg; omega = sqrt(k / m), rad/s; p penalty, N s/m.
//
// Source: the ODE manual, "Joint error and the error reduction parameter" and "How to use ERP and
// CFM", for the textbook map; the rest follows from the row.
#include "contact/map.h"

#include <assert.h>
#include <math.h>

// small enough that the force is right to 1e-9 wherever the overlap is at least a tenth of the
// way gone in one step, large enough that the row's numbers lose no digits
static const double STAND_IN_SHARE = 1e-10;

// phases over which the delivered restitution is averaged, at the middles of equal intervals
enum { PHASE_COUNT = 16 };

// far beyond any contact that ends: 1e7 steps are seconds of wall time
enum { STEP_MAX = 10000000 };

static ErpCfm textbook(double stiffness, double damping, double step)
{
    assert(stiffness >= 0.0 && damping >= 0.0 && stiffness + damping > 0.0 && step > 0.0);
    const double sum = step * stiffness + damping;
    return (ErpCfm){.erp = step * stiffness / sum, .cfm = 1.0 / sum};
}

static ErpCfm corrected(double stiffness, double damping, double step)
{
    assert(stiffness >= 0.0 && damping >= 0.0 && stiffness + damping > 0.0 && step > 0.0);
    const double damper = fmax(damping, STAND_IN_SHARE * step * stiffness);
    return (ErpCfm){.erp = step * stiffness / damper, .cfm = 1.0 / damper};
}

void map_invert(ErpCfm row, double step, double *stiffness, double *damping)
{
    *stiffness = row.erp / (step * row.cfm);
    *damping = (1.0 - row.erp) / row.cfm;
}

double map_poisson_cfm(double penalty)
{
    return 1.0 / penalty;
}

double map_bounce_delivered(double restitution, double cfm, double mass, double step)
{
    const double r = cfm * mass / step;
    return (restitution - r) / (1.0 + r);
}

MapImpact map_impact(const Map *map, double mass, double stiffness, double damping, double step,
                     double speed, double first_overlap)
{
    const ErpCfm row = map->convert(stiffness, damping, step);
    MapImpact impact = {0};
    double depth = first_overlap * speed * step; // m
    double rate = speed;                         // closing speed, m/s
    while (depth >= 0.0 && impact.steps < STEP_MAX) {
        // the row, solved for the force; the wall never pulls
        const double wanted = (row.erp / step * depth + rate) / (row.cfm + step / mass);
        const double force = fmax(wanted, 0.0);
        rate -= step * force / mass;
        depth += step * rate;
        impact.force_max = fmax(impact.force_max, force);
        impact.penetration_max = fmax(impact.penetration_max, depth);
        impact.steps++;
    }
    impact.restitution = depth < 0.0 ? -rate / speed : 0.0;
    return impact;
}

double map_delivered_restitution(const Map *map, double mass, double stiffness, double damping,
                                 double step)
{
    double sum = 0.0;
    for (int i = 0; i < PHASE_COUNT; i++) {
        const double overlap = (i + 0.5) / PHASE_COUNT;
        // the spring is linear, so any speed gives the same
        sum += map_impact(map, mass, stiffness, damping, step, 1.0, overlap).restitution;
    }
    return sum / PHASE_COUNT;
}

static const Map MAPS[] = {
    [ODE_MAP_TEXTBOOK] = {"textbook", "implicit Euler: always stable, adds damping h k", INFINITY,
                          0.0, textbook},
    [ODE_MAP_CORRECTED] = {"corrected", "spring explicit, damper implicit: adds no damping", 2.0,
                           STAND_IN_SHARE, corrected},
};

const Map *map_get(OdeMap kind)
{
    return &MAPS[kind];
}
