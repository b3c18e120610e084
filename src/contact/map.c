// Which ERP and CFM make ODE's contact row the spring and damper that was asked for, and which
// spring and damper is an ERP and a CFM?
//
// clang-format off
// ODE's row, F >= 0   v_out + CFM F = (ERP / h) d
// textbook            ERP = h k / (h k + c),  CFM = 1 / (h k + c):  F = k (d - h v_out) - c v_out
//                     implicit Euler, always stable, damping raised by h k
// corrected           ERP = h k / c,  CFM = 1 / c:  F = k d - c v_out
//                     spring explicit and damper implicit; symplectic, no damping of its own,
//                     stable for omega h < 2
// midpoint            CFM = 2 / c,  ERP = h F0 / (c d / 2),  F0 = k d + (c / 2) d':
//                     F = k d - (c / 2) (v_out - d')
//                     damper on the mean of the old and the new speed; second order where d stands
//                     at mid-step; stable for omega h < 2
// exact               CFM = h a / (m (1 - a)),  ERP = b h / (1 - a),  a = exp(-2 z omega h),
//                     b h = 1 + a - 2 exp(-z omega h) cos(omega_d h): then d and d' follow
//                     d'_new = a d' - b d,  d_new = d + h d'_new, of determinant a and of the trace
//                     of the continuous oscillator; for omega h < pi
// inverses  textbook  kp = ERP / (h CFM),  kd = (1 - ERP) / CFM
//          corrected  kp likewise,  kd = 1 / CFM
//           midpoint  kd = 2 / CFM,  kp = ERP / (h CFM) - (kd / 2) d' / d
//              exact  a = r / (1 + r),  r = CFM m / h,  z omega h = ln(1 + 1 / r) / 2,
//                     sin^2(omega_d h / 2) = (b h - (1 - e^-zoh)^2) / (4 e^-zoh),  zoh = z omega h
// Poisson             F = p d':  CFM = 1 / p
// bounce with CFM     delivered e' = (e - r) / (1 + r),  r = CFM m / h
// clang-format on
//
// 1 - ERP = c / (h k + c) is kept beside ERP: from ERP as a double alone, kd would be wrong by up
// to eps/2 (h k + c) / c of itself, eps = 2.2e-16.
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

ErpCfm map_row(double erp, double cfm)
{
    return (ErpCfm){.erp = erp, .cfm = cfm, .rest = 1.0 - erp};
}

bool map_contact_is_sound(const MapContact *contact)
{
    const double sum = contact->stiffness + contact->damping;
    return contact->stiffness >= 0.0 && contact->damping >= 0.0 && contact->step > 0.0 &&
           sum > 0.0 && isfinite(sum);
}

static void check_contact(const MapContact *contact)
{
    assert(map_contact_is_sound(contact));
}

static ErpCfm convert_textbook(const MapContact *contact)
{
    check_contact(contact);
    const double sum = contact->step * contact->stiffness + contact->damping;
    return (ErpCfm){
        .erp = contact->step * contact->stiffness / sum,
        .cfm = 1.0 / sum,
        .rest = contact->damping / sum,
    };
}

// The damper, or what stands in for one.
static double damper_of(const MapContact *contact)
{
    check_contact(contact);
    return fmax(contact->damping, STAND_IN_SHARE * contact->step * contact->stiffness);
}

static ErpCfm convert_corrected(const MapContact *contact)
{
    const double damper = damper_of(contact);
    return map_row(contact->step * contact->stiffness / damper, 1.0 / damper);
}

static ErpCfm convert_midpoint(const MapContact *contact)
{
    assert(contact->depth > 0.0);
    const double half = 0.5 * damper_of(contact);
    const double force = contact->stiffness * contact->depth + half * contact->closing;
    return map_row(contact->step * force / (half * contact->depth), 1.0 / half);
}

static ErpCfm convert_exact(const MapContact *contact)
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
    return map_row(beta / lost, h * alpha / (contact->mass * lost));
}

// Whether a spring and a damper are such; if so, the contact gets them.
static bool take_pair(MapContact *contact, double stiffness, double damping)
{
    if (!(stiffness >= 0.0 && isfinite(stiffness) && damping >= 0.0 && isfinite(damping))) {
        return false;
    }
    contact->stiffness = stiffness;
    contact->damping = damping;
    return true;
}

static bool invert_textbook(ErpCfm row, MapContact *contact)
{
    return take_pair(contact, row.erp / (contact->step * row.cfm), row.rest / row.cfm);
}

static bool invert_corrected(ErpCfm row, MapContact *contact)
{
    return take_pair(contact, row.erp / (contact->step * row.cfm), 1.0 / row.cfm);
}

static bool invert_midpoint(ErpCfm row, MapContact *contact)
{
    assert(contact->depth > 0.0);
    const double half = 1.0 / row.cfm;
    const double spring = row.erp * half / contact->step; // F0 / d
    return take_pair(contact, spring - half * contact->closing / contact->depth, 2.0 * half);
}

static bool invert_exact(ErpCfm row, MapContact *contact)
{
    assert(contact->mass > 0.0);
    const double h = contact->step;
    const double r = row.cfm * contact->mass / h; // a / (1 - a)
    const double decay = 0.5 * log1p(1.0 / r);
    const double fade = expm1(-decay);
    // beta h less (1 - e^-x)^2 is 4 e^-x sin^2(y/2), and with it y^2 is known
    const double swing = row.erp / (1.0 + r) - fade * fade;
    const double half_turn = 0.5 * sqrt(fabs(swing)) * exp(0.5 * decay);
    if (swing > 0.0 && half_turn > 1.0) {
        return false; // no oscillator turns by more than half in a step
    }
    const double turn = 2.0 * (swing >= 0.0 ? asin(half_turn) : asinh(half_turn));
    const double square = decay * decay + copysign(turn * turn, swing); // (omega h)^2
    return take_pair(contact, contact->mass * square / (h * h), 2.0 * contact->mass * decay / h);
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

static const Map textbook_map = {INFINITY, 0.0, false, convert_textbook, invert_textbook};
static const Map corrected_map = {2.0, STAND_IN_SHARE, false, convert_corrected, invert_corrected};
static const Map midpoint_map = {2.0, STAND_IN_SHARE, false, convert_midpoint, invert_midpoint};
static const Map exact_map = {M_PI, STAND_IN_SHARE, true, convert_exact, invert_exact};

const Map *map_get(OdeMap kind)
{
#define MAP_ROW(name, word, row) &row,
    static const Map *const MAPS[] = {OPTIONS_ODE_ROW_MAP_LIST(MAP_ROW)};
    assert(kind < ODE_MAP_IMPULSE);
    return MAPS[kind];
}
