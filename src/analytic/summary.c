// Sums up what a four-bar or slider-crank does in one turn, with the forces that it takes.
//
// The follower's two limits stand where crank a and coupler b lie in one line, |P| = b +- a:
//     cos(angle of P) = ((b +- a)^2 + g^2 - c^2) / (2 g (b +- a))
// and those of a slider, e the offset of its line, likewise:
//     sin(angle of P from the line) = e / (b +- a)
// The crank points along P when stretched (+), against it when folded (-).
#include "analytic/summary.h"

#include "analytic/closed_form.h"
#include "analytic/fourbar_motion.h"
#include "analytic/inverse_dynamics.h"
#include "analytic/slidercrank_motion.h"
#include "base/root.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// a degree encloses every extreme; Brent's method then finds it to rounding
enum { SUMMARY_STEPS = 360 };

static const double OVERLAP = M_PI / 180.0; // rad, two of the steps of curve_extreme

static double wrapped(double angle)
{
    const double turn = 2.0 * M_PI;
    const double rest = fmod(angle, turn);
    return rest < 0.0 ? rest + turn : rest;
}

static void follower_limits(const FourBarLengths *lengths, AnalyticSummary *summary)
{
    const double side = lengths->assembly == ASSEMBLY_OPEN ? 1.0 : -1.0;
    const double reach[2] = {lengths->coupler + lengths->crank, lengths->coupler - lengths->crank};
    double crank[2];
    for (int i = 0; i < 2; i++) {
        const double cosine = (reach[i] * reach[i] + lengths->ground * lengths->ground -
                               lengths->follower * lengths->follower) /
                              (2.0 * lengths->ground * reach[i]);
        crank[i] = side * acos(cosine);
    }
    summary->limit_extended = wrapped(crank[0]);
    summary->limit_folded = wrapped(crank[1] + M_PI);
    summary->has_limits = isfinite(summary->limit_extended) && isfinite(summary->limit_folded);
}

// One force quantity as a curve over the crank angle: the torque, or the force in one joint.
typedef struct Curve {
    const Scenario *scenario;
    int joint;   // -1: the drive torque
    double sign; // -1: upside down, so that its minima are the maxima
    Err *err;
} Curve;

// When the drive stands at an angle, beginning at time zero with its first.
static InverseTime time_of(const Linkage *linkage, double crank)
{
    const double time_s = (crank - linkage->driver.start) / linkage->driver.speed;
    return (InverseTime){time_s, time_s};
}

// Motion and reactions at a crank angle; false with the reason where the loop does not close.
static bool evaluate(const Curve *curve, double crank, Motion motions[CLOSED_FORM_BODIES],
                     Reactions *reactions)
{
    const Linkage *linkage = &curve->scenario->linkage;
    if (!closed_form_bodies(curve->scenario, crank, motions)) {
        return err_set(curve->err, ERR_SOLVER, "the %s does not close at a crank angle of %.6g deg",
                       closed_form_name(curve->scenario), crank * 180.0 / M_PI);
    }
    return inverse_dynamics_solve(linkage, motions, scenario_gravity(curve->scenario),
                                  time_of(linkage, crank), reactions, curve->err);
}

static double curve_value(double crank, void *context)
{
    const Curve *curve = context;
    Motion motions[CLOSED_FORM_BODIES];
    Reactions reactions;
    if (!evaluate(curve, crank, motions, &reactions)) {
        return NAN;
    }
    return curve->sign * (curve->joint < 0 ? reactions.drive_torques[0]
                                           : vec2_length(reactions.force_on_b[curve->joint]));
}

static double turn_angle(const Linkage *linkage, int number)
{
    const Driver *driver = &linkage->driver;
    return driver->start + copysign(2.0 * M_PI / SUMMARY_STEPS, driver->speed) * number;
}

// The torque and the joints' forces at every angle of a turn from the driver's start, as the driver
// reaches them, one row an angle: the torque first.
static double *sample_turn(const Curve *curve)
{
    const Linkage *linkage = &curve->scenario->linkage;
    const size_t columns = 1 + linkage->joint_count;
    double *samples = malloc(SUMMARY_STEPS * columns * sizeof *samples);
    assert(samples != NULL);
    for (int i = 0; i < SUMMARY_STEPS; i++) {
        Motion motions[CLOSED_FORM_BODIES];
        Reactions reactions;
        const bool is_known = evaluate(curve, turn_angle(linkage, i), motions, &reactions);
        double *row = samples + (size_t)i * columns;
        row[0] = is_known ? reactions.drive_torques[0] : NAN;
        for (size_t k = 0; k < linkage->joint_count; k++) {
            row[1 + k] = is_known ? vec2_length(reactions.force_on_b[k]) : NAN;
        }
    }
    return samples;
}

// The lowest point of the curve over a turn.
static Extreme lowest(Curve *curve, const double *samples)
{
    const Linkage *linkage = &curve->scenario->linkage;
    const Driver *driver = &linkage->driver;
    const size_t columns = 1 + linkage->joint_count;
    const double *column = samples + (curve->joint + 1);
    const double width = 2.0 * M_PI / SUMMARY_STEPS;
    int found = 0;
    for (int i = 1; i < SUMMARY_STEPS; i++) {
        found =
            curve->sign * column[i * columns] < curve->sign * column[found * columns] ? i : found;
    }
    double value = curve->sign * column[found * columns];
    double crank = turn_angle(linkage, found);
    if (root_minimum(curve_value, curve, crank - width, crank, crank + width, &crank)) {
        value = curve_value(crank, curve);
    }
    return (Extreme){curve->sign * value, (crank - driver->start) / driver->speed, crank};
}

static void find_extremes(const Scenario *scenario, AnalyticSummary *summary, Err *err)
{
    Curve curve = {scenario, -1, 1.0, err};
    double *samples = sample_turn(&curve);
    summary->torque_min = lowest(&curve, samples);
    curve.sign = -1.0;
    summary->torque_max = lowest(&curve, samples);
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        curve.joint = (int)i;
        curve.sign = 1.0;
        summary->reaction_min[i] = lowest(&curve, samples);
        curve.sign = -1.0;
        summary->reaction_max[i] = lowest(&curve, samples);
    }
    free(samples);
}

// How well drive power and the bodies' change of energy agree over a turn.
static double power_residual(const Scenario *scenario, Err *err)
{
    const Curve curve = {scenario, -1, 1.0, err};
    double power_max = 0.0;
    double residual_max = 0.0;
    for (int i = 0; i < SUMMARY_STEPS; i++) {
        Motion motions[CLOSED_FORM_BODIES];
        Reactions reactions;
        const double crank = 2.0 * M_PI * i / SUMMARY_STEPS;
        if (!evaluate(&curve, crank, motions, &reactions)) {
            return NAN;
        }
        const double drive = reactions.drive_torques[0] * scenario->linkage.driver.speed;
        const double power =
            inverse_dynamics_power(&scenario->linkage, motions, scenario_gravity(scenario),
                                   time_of(&scenario->linkage, crank));
        power_max = fmax(power_max, fabs(drive));
        residual_max = fmax(residual_max, fabs(drive - power));
    }
    return power_max > 0.0 ? residual_max / power_max : residual_max;
}

static void set_transmission(CurveExtreme angle, AnalyticSummary *summary)
{
    summary->transmission_low = angle.low;
    summary->transmission_high = angle.high;
    summary->transmission_low_crank = angle.low_angle;
    summary->transmission_high_crank = angle.high_angle;
}

static void summarize_fourbar(const Scenario *scenario, AnalyticSummary *summary)
{
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario->fourbar);
    const double speed = scenario->linkage.driver.speed;
    summary->grashof = fourbar_grashof(&scenario->fourbar);
    const CurveExtreme transmission =
        fourbar_motion_extreme(&lengths, speed, FOURBAR_TRANSMISSION, 0.0, 2.0 * M_PI);
    set_transmission(transmission, summary);
    const CurveExtreme swing =
        fourbar_motion_extreme(&lengths, speed, FOURBAR_FOLLOWER_ANGLE, 0.0, 2.0 * M_PI);
    summary->follower_low = swing.low;
    summary->follower_high = swing.high;
    follower_limits(&lengths, summary);
}

static void slider_limits(const SliderCrank *mechanism, AnalyticSummary *summary)
{
    const double stretched = asin(mechanism->offset / (mechanism->rod + mechanism->crank));
    const double folded = asin(mechanism->offset / (mechanism->rod - mechanism->crank));
    const bool is_right = mechanism->side == SLIDER_RIGHT;
    const double line = mechanism->line;
    summary->limit_extended = wrapped(line + (is_right ? stretched : M_PI - stretched));
    summary->limit_folded = wrapped(line + (is_right ? M_PI + folded : -folded));
    summary->has_limits = true;
}

static void summarize_slidercrank(const Scenario *scenario, AnalyticSummary *summary)
{
    const SliderCrank *mechanism = &scenario->slidercrank;
    const double speed = scenario->linkage.driver.speed;
    CurveExtreme found[SLIDERCRANK_QUANTITY_COUNT];
    for (int i = 0; i < SLIDERCRANK_QUANTITY_COUNT; i++) {
        // a little more than a turn: what is extreme at its ends lies within as well
        found[i] = slidercrank_motion_extreme(mechanism, speed, (SliderCrankQuantity)i, -OVERLAP,
                                              2.0 * M_PI);
    }
    set_transmission(found[SLIDERCRANK_TRANSMISSION], summary);
    summary->slide = found[SLIDERCRANK_POSITION];
    summary->velocity = found[SLIDERCRANK_VELOCITY];
    summary->acceleration = found[SLIDERCRANK_ACCELERATION];
    slider_limits(mechanism, summary);
}

bool summary_compute(const Scenario *scenario, AnalyticSummary *summary, Err *err)
{
    if (!scenario_has_closed_form(scenario) || !closed_form_turns(scenario)) {
        return err_set(err, ERR_SOLVER, "%s",
                       scenario_has_closed_form(scenario)
                           ? "the crank does not turn fully"
                           : "the closed form is for four-bars and slider-cranks only");
    }
    if (!drive_is_steady(&scenario->linkage.driver)) {
        return err_set(err, ERR_SOLVER,
                       "the speed of the drive changes: there is no turn at one speed");
    }
    AnalyticSummary made = {.has_limits = false};
    if (scenario->has_slidercrank) {
        summarize_slidercrank(scenario, &made);
    } else {
        summarize_fourbar(scenario, &made);
    }
    find_extremes(scenario, &made, err);
    made.power_residual = power_residual(scenario, err);
    if (err->kind != ERR_NONE) {
        return false;
    }
    *summary = made;
    return true;
}
