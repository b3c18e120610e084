// With what force does a wall press at a depth, to thirty digits?
//
//     spheres    K = 4/3 E* sqrt(R1 R2 / (R1 - R2)), n = 3/2            E* = E / (2 (1 - nu^2))
//     cylinders  d = A F (B - ln F),  A = 1 / (pi L E*)
//                Johnson                B = ln(4 dR / A) - 1
//                ESDU 78035             B = ln(4 dR / A) + 1
//                Radzimovsky            B = ln(16 dR E* L / 2.15^2) + 2/3
//                Dubowsky-Freudenstein  B = ln(L^2 dR / (R1 R2 A)) + 1
// The cylinders' law is inverted by Newton's method: with y = B - ln F it reads
//     y - ln y = B + ln A - ln d,   y > 1,   F = d / (A y)
// and each round doubles the digits that a double begins with.
// The exact damping factor solves chi (1 + e) = ln((1 + chi) / (1 - chi e)).
//
// R1, R2 radii of hole and pin, dR their difference, L width, m; E* Pa; e restitution, 1.
// Sources: as in src/contact.
#include "quad_law.h"

#include "contact/law.h"
#include "contact/penalty.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { ROUGH_ROUNDS = 8, FINE_ROUNDS = 2, HALVINGS = 130 };

// y > 1 with y - ln y = level.
static Quad branch(Quad level)
{
    const double rough_level = (double)level;
    double rough = rough_level + log(rough_level) + 0.5 / rough_level;
    for (int round = 0; round < ROUGH_ROUNDS; round++) {
        rough -= (rough - log(rough) - rough_level) / (1.0 - 1.0 / rough);
    }
    Quad y = rough;
    for (int round = 0; round < FINE_ROUNDS; round++) {
        y -= (y - logq(y) - level) / (1 - 1 / y);
    }
    return y;
}

static Quad quad_conforming_force(const Conforming *law, Quad depth)
{
    const Quad z = log1pq(law->play / depth);
    Quad x = CONFORMING_SCALE * log1pq(z) - CONFORMING_SHIFT;
    x = x > 1 ? 1 : x;
    Quad width = 0;
    for (int i = CONFORMING_TERMS - 1; i >= 0; i--) {
        width = width * x + law->series[i];
    }
    return law->stiffness * depth / width;
}

// By Simpson's rule in the fourth root of the depth.
static Quad quad_conforming_energy(const Conforming *law, Quad depth)
{
    enum { PARTS = 4000 };
    Quad sum = 0;
    for (int i = 1; i <= PARTS; i++) {
        const Quad root = (Quad)i / PARTS;
        const Quad cube = root * root * root;
        const Quad weight = i == PARTS ? 1 : i % 2 == 1 ? 4 : 2;
        sum += weight * 4 * cube * depth * quad_conforming_force(law, cube * root * depth);
    }
    return sum / (3 * PARTS);
}

Quad quad_law_force(const QuadLaw *law, Quad depth)
{
    if (!(depth > 0)) {
        return 0;
    }
    if (law->is_conforming) {
        return quad_conforming_force(&law->conforming, depth);
    }
    if (law->is_logarithmic) {
        return depth / (law->compliance * branch(law->log_scale - logq(depth)));
    }
    // half-integer exponents from whole powers and one root
    const int twice = (int)(2 * law->exponent);
    if ((Quad)twice != 2 * law->exponent) {
        return law->stiffness * powq(depth, law->exponent);
    }
    Quad power = twice % 2 == 1 ? sqrtq(depth) : (Quad)1;
    for (int i = 0; i < twice / 2; i++) {
        power *= depth;
    }
    return law->stiffness * power;
}

Quad quad_law_energy(const QuadLaw *law, Quad depth)
{
    if (law->is_conforming && depth > 0) {
        return quad_conforming_energy(&law->conforming, depth);
    }
    const Quad force = quad_law_force(law, depth);
    if (!law->is_logarithmic || !(depth > 0)) {
        return force * depth / (law->exponent + 1);
    }
    const Quad y = depth / (law->compliance * force);
    return law->compliance * force * force * (2 * y - 1) / 4;
}

static QuadLaw power_law(Quad stiffness, Quad exponent)
{
    return (QuadLaw){.stiffness = stiffness, .exponent = exponent};
}

static QuadLaw logarithmic_law(Quad compliance, Quad offset)
{
    return (QuadLaw){
        .is_logarithmic = true,
        .compliance = compliance,
        .offset = offset,
        .log_scale = offset + logq(compliance),
    };
}

static QuadLaw conforming_law(const Scenario *scenario, const Joint *joint)
{
    const ContactPair pair = law_pair(&joint->clearance, &scenario->material, 0.0);
    ForceLaw law;
    Err err = {ERR_NONE, ""};
    if (!law_make(LAW_ELASTIC, &pair, &law, &err)) {
        fprintf(stderr, "%s\n", err.text);
        abort();
    }
    return (QuadLaw){.is_conforming = true, .conforming = law.conforming};
}

// The law that the case names, without damping.
static QuadLaw named_law(const Scenario *scenario, const Joint *joint)
{
    const Quad hole = joint->clearance.hole_radius;
    const Quad pin = joint->clearance.pin_radius;
    const Quad play = hole - pin;
    const Quad width = joint->clearance.width;
    const Quad ratio = scenario->material.poisson_ratio;
    const Quad modulus = (Quad)scenario->material.youngs_modulus / (2 * (1 - ratio * ratio));
    const Quad a = 1 / (acosq(-1) * width * modulus);
    const Quad width_factor = (Quad)215 / 100; // of Radzimovsky's contact width
    switch (law_chosen(scenario->contact.law, joint->clearance.width)) {
    case LAW_ELASTIC:
        return conforming_law(scenario, joint);
    case LAW_HERTZ_SOCKET:
        return power_law(4 * modulus * sqrtq(hole * pin / play) / 3, 1.5);
    case LAW_JOHNSON:
        return logarithmic_law(a, logq(4 * play / a) - 1);
    case LAW_RADZIMOVSKY:
        return logarithmic_law(
            a, logq(16 * play * modulus * width / (width_factor * width_factor)) + (Quad)2 / 3);
    case LAW_ESDU_78035:
        return logarithmic_law(a, logq(4 * play / a) + 1);
    case LAW_DUBOWSKY_FREUDENSTEIN:
        return logarithmic_law(a, logq(width * width * play / (hole * pin * a)) + 1);
    case LAW_PAPER_TABLE_2:
        // k = 2 E* 0.1 mm sqrt(F / N), at the paper's force
        return power_law(2 * modulus / 10000 *
                             sqrtq(penalty_reference_force(scenario->linkage.driver.speed)),
                         1);
    case LAW_PAPER_TABLE_3:
        return power_law(modulus * sqrtq((Quad)5 / 1000) * powq((Quad)4 / 3, 1.5), 1.5);
    default:
        fprintf(stderr, "tests/truth/quad_law.c lacks the law %s: add it to named_law\n",
                OPTIONS_LAWS[scenario->contact.law]);
        abort();
    }
}

QuadLaw quad_law(const Scenario *scenario, const Joint *joint)
{
    const ContactOptions *contact = &scenario->contact;
    const bool is_given = contact->stiffness > 0.0;
    QuadLaw law = joint->contact.stiffness > 0.0
                      ? power_law(joint->contact.stiffness, joint->contact.exponent)
                  : is_given ? power_law(contact->stiffness, contact->exponent)
                             : named_law(scenario, joint);
    law.viscous = contact->damping == DAMPING_VISCOUS ? contact->viscous_coefficient : 0.0;
    return law;
}

// By halving: the residual is negative below the root and positive above it, up to its pole 1/e.
static Quad exact_factor(Quad e)
{
    if (e == 1) {
        return 0;
    }
    Quad low = 0;
    Quad high = 1 / e;
    for (int i = 0; i < HALVINGS; i++) {
        const Quad chi = (low + high) / 2;
        const Quad residual = log1pq(chi) - log1pq(-chi * e) - chi * (1 + e);
        *(residual < 0 ? &low : &high) = chi;
    }
    return (low + high) / 2;
}

Quad quad_law_hysteresis(const ContactOptions *contact)
{
    const Quad e = contact->restitution;
    switch (contact->damping) {
    case DAMPING_LANKARANI_NIKRAVESH:
        return 3 * (1 - e * e) / 4;
    case DAMPING_HUNT_CROSSLEY:
        return 3 * (1 - e) / 2;
    case DAMPING_FLORES:
        return 8 * (1 - e) / (5 * e);
    case DAMPING_GONTHIER:
        return (1 - e * e) / e;
    case DAMPING_HU_GUO:
        return 3 * (1 - e) / (2 * e);
    case DAMPING_EXACT:
        return exact_factor(e);
    default:
        return 0;
    }
}
