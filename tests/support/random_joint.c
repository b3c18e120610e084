// Which joints are drawn, and what does the engine say of them?
//
// mass M, length L, time T     K [N/m^n] goes with M L^(1-n) / T^2, a viscous damper with M / T,
//                              E with M / (L T^2), speeds with L / T
#include "random_joint.h"

#include "contact/damping.h"
#include "contact/law.h"
#include "kept.h"
#include "mechanism.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { KIND_COUNT = 4, TRIALS = 1000 };

// a play that holds so many of the longer of a step and a contact at the first speed
static const double ROOM = 20.0;

static double draw_between(unsigned short *state, double low, double high)
{
    return low + (high - low) * erand48(state);
}

static double draw_log(unsigned short *state, double low, double high)
{
    return low * pow(high / low, erand48(state));
}

static double length_of(const RandomJoint *joint)
{
    return ROOM * joint->contact.impact.speed * fmax(joint->step_s, joint->contact.asked.duration);
}

// The law of a stiffness, in a hole that leaves room.
static Scenario stiff_scenario(unsigned short *state, int number, double mass)
{
    static const DampingKind DAMPINGS[] = {DAMPING_LANKARANI_NIKRAVESH, DAMPING_FLORES,
                                           DAMPING_EXACT};
    Scenario scenario = mechanism_pin(mass, 1.0);
    ContactOptions *options = &scenario.contact;
    const int kind = number % KIND_COUNT;
    options->stiffness = draw_log(state, 1e3, 1e11);
    options->restitution = draw_between(state, 0.1, 1.0);
    options->exponent = kind == 0 ? 1.0 : kind == 1 ? 1.5 : draw_between(state, 1.05, 2.0);
    options->damping = kind == 0 ? DAMPING_VISCOUS : DAMPINGS[number / KIND_COUNT % 3];
    options->viscous_coefficient =
        2.0 * damping_linear_ratio(options->restitution) * sqrt(options->stiffness * mass);
    return scenario;
}

// A cylinder in its hole, whose play is part of the law.
static Scenario cylinder_scenario(unsigned short *state, int number, double mass)
{
    static const LawKind LAWS[] = {LAW_JOHNSON, LAW_RADZIMOVSKY, LAW_ESDU_78035,
                                   LAW_DUBOWSKY_FREUDENSTEIN};
    Scenario scenario = mechanism_pin(mass, 1.0);
    ContactOptions *options = &scenario.contact;
    options->law = LAWS[number / KIND_COUNT % 4];
    options->restitution = draw_between(state, 0.2, 1.0);
    options->damping = DAMPING_LANKARANI_NIKRAVESH;
    scenario.material.youngs_modulus = draw_log(state, 1e6, 1e12);
    Clearance *clearance = &scenario.linkage.joints[0].clearance;
    clearance->pin_radius = draw_log(state, 1e-4, 1.0);
    clearance->hole_radius = clearance->pin_radius * (1.0 + draw_log(state, 1e-4, 0.3));
    clearance->width = clearance->pin_radius * draw_log(state, 0.3, 30.0);
    return scenario;
}

static bool try_joint(unsigned short *state, int number, RandomJoint *drawn)
{
    const double mass = draw_log(state, 1e-6, 1e3);
    const double speed = draw_log(state, 1e-4, 10.0);
    const double steps_a_contact = draw_log(state, 0.6, 150.0);
    const double depths = draw_log(state, 1.1, 20.0); // of the law's own, to its end
    const bool is_cylinder = number % KIND_COUNT == KIND_COUNT - 1;
    const Scenario scenario =
        is_cylinder ? cylinder_scenario(state, number, mass) : stiff_scenario(state, number, mass);
    Scenario wide = kept_copy(&scenario);
    Clearance *clearance = &wide.linkage.joints[0].clearance;
    if (!is_cylinder) {
        clearance->pin_radius = 1e6; // no depth is too deep for it
        clearance->hole_radius = 2e6;
    }
    Err err = {ERR_NONE, ""};
    if (!mapping_contact_make(&wide, &(MappingJoint){.joint = 0}, mass, speed, &drawn->contact,
                              &err)) {
        return false; // past the end of the law: no impact to map
    }
    drawn->step_s = drawn->contact.half_period_s / steps_a_contact;
    clearance = &drawn->contact.scenario.linkage.joints[0].clearance;
    if (is_cylinder) {
        return length_of(drawn) < clearance->hole_radius - clearance->pin_radius;
    }
    const Joint unit = {.kind = JOINT_CLEARANCE, .clearance.pin_radius = 1.0};
    const double share = law_depth_max(&drawn->contact.impact.law, &unit); // of a radius
    clearance->pin_radius = depths * drawn->contact.asked.penetration_max / share;
    clearance->hole_radius = clearance->pin_radius + length_of(drawn);
    return true;
}

RandomJoint random_joint_draw(unsigned short state[3], int number)
{
    RandomJoint drawn;
    int trials = 0;
    while (!try_joint(state, number, &drawn)) {
        assert(trials++ < TRIALS);
    }
    return drawn;
}

RandomJoint random_joint_scaled(const RandomJoint *joint, double mass, double length, double time)
{
    const MapImpactCase *impact = &joint->contact.impact;
    Scenario scenario = kept_copy(&joint->contact.scenario);
    ContactOptions *options = &scenario.contact;
    Clearance *clearance = &scenario.linkage.joints[0].clearance;
    options->stiffness *= mass * pow(length, 1.0 - options->exponent) / (time * time);
    options->viscous_coefficient *= mass / time;
    options->impact_speed_floor *= length / time;
    scenario.material.youngs_modulus *= mass / (length * time * time);
    clearance->pin_radius *= length;
    clearance->hole_radius *= length;
    clearance->width *= length;
    RandomJoint scaled = {.step_s = joint->step_s * time};
    Err err = {ERR_NONE, ""};
    const bool is_made =
        mapping_contact_make(&scenario, &(MappingJoint){.joint = 0}, impact->mass * mass,
                             impact->speed * length / time, &scaled.contact, &err);
    assert(is_made);
    return scaled;
}

VerdictKind random_joint_predict(const RandomJoint *joint, OdeMap map, ImpactFigures *predicted)
{
    *predicted = mapping_predict(&joint->contact, map, joint->step_s);
    return verdict_judge(&joint->contact, map, joint->step_s, predicted);
}

VerdictKind random_joint_deliver(const RandomJoint *joint, OdeMap map,
                                 const ImpactFigures *predicted, ImpactDelivered *delivered)
{
    const MappingContact *contact = &joint->contact;
    const Scenario ready = mapping_scenario(contact, map, joint->step_s);
    *delivered = impact_deliver(&ready, 0, contact->impact.mass, contact->impact.speed,
                                fmax(predicted->duration.most, contact->asked.duration));
    if (!delivered->is_measured) {
        // where the law ends, or the pin
        const bool is_past_end = strstr(delivered->message, "no contact law holds") != NULL ||
                                 strstr(delivered->message, "which is all of it") != NULL;
        return is_past_end ? VERDICT_PAST_END : VERDICT_COUNT;
    }
    return verdict_judge(contact, map, joint->step_s, &delivered->figures);
}

static double apart(const ImpactSpread *a, const ImpactSpread *b)
{
    return fabs(a->mean / b->mean - 1.0);
}

double random_joint_difference(const ImpactFigures *a, const ImpactFigures *b)
{
    return fmax(
        apart(&a->restitution, &b->restitution),
        fmax(apart(&a->force_max, &b->force_max), apart(&a->penetration_max, &b->penetration_max)));
}
