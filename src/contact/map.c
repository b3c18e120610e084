// Which ERP and CFM make ODE's contact row the spring and damper that was asked for, and what does
// the row deliver then?
//
// ODE's row, F >= 0      v_out + CFM F = (ERP / h) d
// textbook               ERP = h k / (h k + c), CFM = 1 / (h k + c): F = k (d - h v_out) - c v_out,
//                        implicit Euler, always stable, damping raised by h k
// corrected              ERP = h k / c, CFM = 1 / c: F = k d - c v_out, spring explicit and damper
//                        implicit; symplectic, no damping of its own, stable for omega h < 2
// midpoint               CFM = 2 / c, ERP = h F0 / (c d / 2), F0 = k d + (c / 2) d': F = k d - (c /
// 2)
//                        (v_out - d'), damper on the mean of the old and the new speed; second
//                        order where d stands at mid-step; stable for omega h < 2
// exact                  CFM = h a / (m (1 - a)), ERP = b h / (1 - a), with a = exp(-2 z omega h)
// and
//                        b h = 1 + a - 2 exp(-z omega h) cos(omega_d h): then d and d' follow
//                        d'_new = a d' - b d, d_new = d + h d'_new, of determinant a and of the
//                        trace of the continuous oscillator; for omega h < pi
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
#include <float.h>
#include <math.h>

// small enough that the force is right to 1e-9 wherever the overlap is at least a tenth of the
// way gone in one step, large enough that the row's numbers lose no digits
static const double STAND_IN_SHARE = 1e-10;

// phases over which the delivered restitution is averaged, at the middles of equal intervals
enum { PHASE_COUNT = 16 };

// far beyond any contact that ends: 1e7 steps are seconds of wall time
enum { STEP_MAX = 10000000 };

static void check_contact(const MapContact *contact)
{
    assert(contact->stiffness >= 0.0 && contact->damping >= 0.0 && contact->step > 0.0);
    assert(contact->stiffness + contact->damping > 0.0);
}

static ErpCfm textbook(const MapContact *contact)
{
    check_contact(contact);
    const double sum = contact->step * contact->stiffness + contact->damping;
    return (ErpCfm){.erp = contact->step * contact->stiffness / sum, .cfm = 1.0 / sum};
}

// The damper, or what stands in for one.
static double damper_of(const MapContact *contact)
{
    check_contact(contact);
    return fmax(contact->damping, STAND_IN_SHARE * contact->step * contact->stiffness);
}

static ErpCfm corrected(const MapContact *contact)
{
    const double damper = damper_of(contact);
    return (ErpCfm){.erp = contact->step * contact->stiffness / damper, .cfm = 1.0 / damper};
}

static ErpCfm midpoint(const MapContact *contact)
{
    assert(contact->depth > 0.0);
    const double half = 0.5 * damper_of(contact);
    const double force = contact->stiffness * contact->depth + half * contact->closing;
    return (ErpCfm){.erp = contact->step * force / (half * contact->depth), .cfm = 1.0 / half};
}

static ErpCfm exact(const MapContact *contact)
{
    assert(contact->mass > 0.0);
    const double h = contact->step;
    const double decay = damper_of(contact) * h / (2.0 * contact->mass); // zeta omega h
    const double square = contact->stiffness * h * h / contact->mass - decay * decay;
    const double alpha = exp(-2.0 * decay);
    const double lost = -expm1(-2.0 * decay);
    // 1 + a - 2 e^-x cos y = (1 - e^-x)^2 + 4 e^-x sin^2(y/2), which loses no digits
    const double half_turn = square >= 0.0 ? sin(0.5 * sqrt(square)) : sinh(0.5 * sqrt(-square));
    const double swing = copysign(4.0 * exp(-decay) * half_turn * half_turn, square);
    const double beta = expm1(-decay) * expm1(-decay) + swing;
    return (ErpCfm){.erp = beta / lost, .cfm = h * alpha / (contact->mass * lost)};
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
    MapContact contact = {.stiffness = stiffness, .damping = damping, .step = step, .mass = mass};
    MapImpact impact = {0};
    double depth = first_overlap * speed * step; // m
    double rate = speed;                         // closing speed, m/s
    while (depth >= 0.0 && impact.steps < STEP_MAX) {
        contact.depth = fmax(depth, DBL_MIN);
        contact.closing = rate;
        const ErpCfm row = map->convert(&contact);
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
                          0.0, false, textbook},
    [ODE_MAP_CORRECTED] = {"corrected", "spring explicit, damper implicit: adds no damping", 2.0,
                           STAND_IN_SHARE, false, corrected},
    [ODE_MAP_MIDPOINT] = {"midpoint", "damper on the mean of old and new speed: second order", 2.0,
                          STAND_IN_SHARE, false, midpoint},
    [ODE_MAP_EXACT] = {"exact", "frequency and decay of the continuous oscillator, for its mass",
                       M_PI, STAND_IN_SHARE, true, exact},
};

const Map *map_get(OdeMap kind)
{
    assert(kind < ODE_MAP_IMPULSE);
    return &MAPS[kind];
}
