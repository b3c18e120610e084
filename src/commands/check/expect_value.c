// Which number of a run does a limit of its case mean?
#include "commands/check/expect_value.h"

#include "measure/truth.h"

#include <float.h>
#include <math.h>

static double spikes(const SignalSpikes *found)
{
    return found->is_known ? (double)found->count : NAN;
}

static double error_number(const TrajectoryError *error, ExpectedNumber number)
{
    if (error == NULL || !error->is_known) {
        return NAN;
    }
    return number == EXPECTED_ERROR_MAX         ? error->max
           : number == EXPECTED_ERROR_OMEGA_MAX ? error->omega_max
           : number == EXPECTED_ERROR_OMEGA_RMS ? error->omega_rms
                                                : error->alpha_max;
}

bool expect_value_is_error(const Expectation *expectation)
{
    return expectation->number == EXPECTED_ERROR_MAX ||
           expectation->number == EXPECTED_ERROR_OMEGA_MAX ||
           expectation->number == EXPECTED_ERROR_OMEGA_RMS ||
           expectation->number == EXPECTED_ERROR_ALPHA_MAX;
}

bool expect_value_concerns(const Expectation *expectation, const Scenario *scenario,
                           BackendKind backend)
{
    if (expectation->backend != EXPECTATION_ANY_BACKEND) {
        return expectation->backend == (int)backend;
    }
    if (expect_value_is_error(expectation) && backend == truth_backend(scenario)) {
        return false;
    }
    return OPTIONS_BACKEND_HAS_PLAY[backend] || !scenario_has_clearance(scenario);
}

double expect_value_of(const Expectation *expectation, const Trajectory *run,
                       const TrajectoryError *error)
{
    const BodyExtremes *body = &run->bodies[expectation->member];
    const JointExtremes *joint = &run->joints[expectation->member];
    switch (expectation->number) {
    case EXPECTED_OMEGA_MAX:
        return body->omega_max.value;
    case EXPECTED_OMEGA_MIN:
        return body->omega_min.value;
    case EXPECTED_ALPHA_MAX:
        return body->alpha_max.value;
    case EXPECTED_ALPHA_MIN:
        return body->alpha_min.value;
    case EXPECTED_ALPHA_SPIKES:
        return spikes(&run->alpha_spikes[expectation->member]);
    case EXPECTED_FORCE_MAX:
        return joint->force_max.value;
    case EXPECTED_FORCE_SPIKES:
        return spikes(&run->force_spikes[expectation->member]);
    case EXPECTED_IMPACTS:
        return (double)joint->impacts;
    case EXPECTED_IMPULSE:
        return joint->impulse;
    case EXPECTED_PENETRATION_MAX:
        return joint->penetration_max.value;
    case EXPECTED_CONTACT_FRACTION:
        return joint->contact_time / run->duration_s;
    case EXPECTED_DRIVE_WORK:
        return run->energy.drive_work;
    case EXPECTED_DISSIPATED:
        return run->energy.dissipated;
    case EXPECTED_CHANGE:
        return run->energy.change;
    case EXPECTED_RESIDUAL:
        return run->energy.residual;
    case EXPECTED_STEPS:
        return (double)run->steps;
    case EXPECTED_EVALUATIONS:
        return (double)run->evaluations;
    default:
        return error_number(error, expectation->number);
    }
}

double expect_value_off(const Expectation *expectation, double value)
{
    const double low = expectation->low;
    const double high = expectation->high;
    const bool is_low = expectation->is_open ? !(value > low) : !(value >= low);
    const bool is_high = expectation->is_open ? !(value < high) : !(value <= high);
    return is_high ? fmax(value - high, DBL_MIN) : is_low ? fmin(value - low, -DBL_MIN) : 0.0;
}
