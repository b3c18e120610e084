// What does a four-bar do in one turn, and which forces does that take?
//
// The follower's two limits stand where crank a and coupler b lie in one line, |P| = b +- a:
//     cos(angle of P) = ((b +- a)^2 + g^2 - c^2) / (2 g (b +- a))
// The crank points along P when stretched (+), against it when folded (-).
#include "analytic/summary.h"

#include "analytic/fourbar_motion.h"
#include "analytic/inverse_dynamics.h"
#include "base/root.h"

#include <math.h>

// a degree encloses every extreme; Brent's method then finds it to rounding
enum { SUMMARY_STEPS = 360 };

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
    FourBarLengths lengths;
    int joint;   // -1: the drive torque
    double sign; // -1: upside down, so that its minima are the maxima
    Err *err;
} Curve;

// Motion and reactions at a crank angle; false with the reason where the loop does not close.
static bool evaluate(const Curve *curve, double crank, Motion motions[3], Reactions *reactions)
{
    const Linkage *linkage = &curve->scenario->linkage;
    if (!fourbar_motion_bodies(&curve->lengths, linkage->driver.speed, crank, motions)) {
        return err_set(curve->err, ERR_SOLVER,
                       "the four-bar does not close at a crank angle of %.6g deg",
                       crank * 180.0 / M_PI);
    }
    return inverse_dynamics_solve(linkage, motions, curve->scenario->gravity, reactions,
                                  curve->err);
}

static double curve_value(double crank, void *context)
{
    const Curve *curve = context;
    Motion motions[3];
    Reactions reactions;
    if (!evaluate(curve, crank, motions, &reactions)) {
        return NAN;
    }
    return curve->sign * (curve->joint < 0 ? reactions.drive_torque
                                           : vec2_length(reactions.force_on_b[curve->joint]));
}

// The lowest point of the curve over a turn from the driver's start, as the driver reaches it.
static Extreme lowest(Curve *curve)
{
    const Driver *driver = &curve->scenario->linkage.driver;
    const double width = copysign(2.0 * M_PI / SUMMARY_STEPS, driver->speed);
    double crank = driver->start;
    double value = curve_value(crank, curve);
    for (int i = 1; i < SUMMARY_STEPS; i++) {
        const double here = curve_value(driver->start + width * i, curve);
        if (here < value) {
            value = here;
            crank = driver->start + width * i;
        }
    }
    if (root_minimum(curve_value, curve, crank - fabs(width), crank, crank + fabs(width), &crank)) {
        value = curve_value(crank, curve);
    }
    return (Extreme){curve->sign * value, (crank - driver->start) / driver->speed, crank};
}

static void find_extremes(const Scenario *scenario, AnalyticSummary *summary, Err *err)
{
    Curve curve = {scenario, fourbar_motion_nominal(&scenario->fourbar), -1, 1.0, err};
    summary->torque_min = lowest(&curve);
    curve.sign = -1.0;
    summary->torque_max = lowest(&curve);
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        curve.joint = (int)i;
        curve.sign = 1.0;
        summary->reaction_min[i] = lowest(&curve);
        curve.sign = -1.0;
        summary->reaction_max[i] = lowest(&curve);
    }
}

// How well drive power and the bodies' change of energy agree over a turn.
static double power_residual(const Scenario *scenario, Err *err)
{
    const Curve curve = {scenario, fourbar_motion_nominal(&scenario->fourbar), -1, 1.0, err};
    double power_max = 0.0;
    double residual_max = 0.0;
    for (int i = 0; i < SUMMARY_STEPS; i++) {
        Motion motions[3];
        Reactions reactions;
        if (!evaluate(&curve, 2.0 * M_PI * i / SUMMARY_STEPS, motions, &reactions)) {
            return NAN;
        }
        const double drive = reactions.drive_torque * scenario->linkage.driver.speed;
        const double power = inverse_dynamics_power(&scenario->linkage, motions, scenario->gravity);
        power_max = fmax(power_max, fabs(drive));
        residual_max = fmax(residual_max, fabs(drive - power));
    }
    return power_max > 0.0 ? residual_max / power_max : residual_max;
}

bool summary_compute(const Scenario *scenario, AnalyticSummary *summary, Err *err)
{
    if (!scenario->has_fourbar || !fourbar_crank_turns(&scenario->fourbar)) {
        return err_set(err, ERR_SOLVER, "%s",
                       scenario->has_fourbar ? "the crank does not turn fully"
                                             : "the closed form is for four-bars only");
    }
    AnalyticSummary made = {
        .grashof = fourbar_grashof(&scenario->fourbar),
    };
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario->fourbar);
    const double speed = scenario->linkage.driver.speed;
    const FourBarExtreme transmission =
        fourbar_motion_extreme(&lengths, speed, FOURBAR_TRANSMISSION, 0.0, 2.0 * M_PI);
    made.transmission_low = transmission.low;
    made.transmission_high = transmission.high;
    made.transmission_low_crank = transmission.low_angle;
    made.transmission_high_crank = transmission.high_angle;
    const FourBarExtreme swing =
        fourbar_motion_extreme(&lengths, speed, FOURBAR_FOLLOWER_ANGLE, 0.0, 2.0 * M_PI);
    made.follower_low = swing.low;
    made.follower_high = swing.high;
    find_extremes(scenario, &made, err);
    made.power_residual = power_residual(scenario, err);
    if (err->kind != ERR_NONE) {
        return false;
    }
    follower_limits(&lengths, &made);
    *summary = made;
    return true;
}
