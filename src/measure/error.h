// Measures how far a trajectory is from another that is taken as the truth.
//
// In the rates of model/distance.h: every body's angular velocity and velocity, and in joints with
// play those of the pin relative to its hole. Beside it: how far the forces of contacts are off,
// and the peaks of forces and accelerations.
#pragma once

#include "model/distance.h"
#include "model/trajectory.h"

// Errors below this multiple of the reference's uncertainty are dominated by it.
static const double ERROR_CLEAR_OF_TRUTH = 10.0;

// Two rates that are both within the largest of the reference differ by at most twice that: an
// impact at another time does it. What is further off is faster than the true motion ever is.
static const double ERROR_UNSTABLE = 2.0;

// The least a force or an acceleration is measured in, of the largest of its kind in the mechanism:
// a joint that an impact met between two samples has no force at any of them.
static const double ERROR_FORCE_FLOOR = 1e-3;

// times the energy that a run began with and was given: a step too long by far leaves a share or a
// multiple of it, and a motion that runs away powers of it
static const double ERROR_ENERGY_RUNAWAY = 1e3;

// More energy than there is in the true motion comes from nowhere but the solver.
static const double ERROR_ENERGY_LOST = 1.0;

typedef struct TrajectoryError {
    bool is_known;       // false: there was no reference, or the two have no samples in common
    const char *against; // name of the reference's backend: lives as long as it
    double max;          // 1: largest |rate - rate_ref| over all rates and samples, each over the
                         // rate's own largest |rate_ref| (or the floor of model/distance.h)
    double max_time_s;
    double max_in_horizon;       // 1: as max, up to the horizon; NAN without a sample in it
    char in[DISTANCE_NAME_SIZE]; // which rate that is: distance_name; of max without a horizon
    bool is_floor;               // whether it is measured in the floor
    double omega_max;            // 1: as max, of the bodies' angular velocities alone
    double omega_max_in_horizon;
    double
        omega_rms; // 1: root of the mean square of these of bodies that are not driven, whole run
    double alpha_max;     // 1: as omega_max, of the angular accelerations
    double angle_max_rad; // largest |angle - angle_ref|
    double energy_lost;   // 1: |residual of the energy| over the largest energy of the reference
    // As max and max_in_horizon, of what error_of_joint and error_of_body measure: the largest of
    // all joints with play, of all bodies that are not driven. NAN where there are none.
    double force_max;
    double force_max_in_horizon;
    char force_in[LINKAGE_NAME_SIZE]; // the joint, or the body, of the larger error of the two
    double peak_force_max;
    double peak_force_max_in_horizon;
    char peak_force_in[LINKAGE_NAME_SIZE];
    double peak_alpha_max;
    double peak_alpha_max_in_horizon;
    char peak_alpha_in[LINKAGE_NAME_SIZE];
} TrajectoryError;

// How far the contact force of one joint is off.
typedef struct JointError {
    double force_max;            // 1: largest |F - F_ref| at the samples over the largest |F_ref|
    double force_max_in_horizon; // 1: as that, up to the horizon; NAN without a sample in it
    double peak_max;             // 1: largest difference of two peaks, see error_of_joint
    double peak_max_in_horizon;  // 1: of contacts that end in the horizon
    size_t missed;               // contacts of the reference within the horizon that overlap none
    size_t extra;                // contacts of the run that overlap none of the reference
} JointError;

// How far the largest and the smallest angular acceleration of a body are off.
typedef struct BodyError {
    double peak_max; // 1: of both extremes of all steps, over the larger of the reference
    double peak_max_in_horizon; // 1: where the horizon ends before the run, of the samples in it
} BodyError;

// The largest energy that a run's balance is about, J: the work of the drive, what was lost, or the
// largest kinetic energy. Over whole turns the work may be next to nothing, and what goes to and
// fro is what a solver has to get right. At least the floor of a mechanism at rest.
double error_energy(const Trajectory *run);

// Both trajectories must be of the same scenario: same bodies, same sample times. The horizon, s,
// is the time up to which trajectories may be compared; INFINITY where nothing limits it.
TrajectoryError error_against(const Trajectory *trajectory, const Trajectory *reference,
                              double horizon_s);

// Whether the forces of a joint's contacts can be compared: both runs let its play happen.
bool error_has_forces(const Trajectory *trajectory, const Trajectory *reference, size_t joint);

// The errors of the forces of a joint for which that holds. Contacts of the two runs that overlap
// in time, directly or through others, are one; their largest forces are compared, over the largest
// force of the joint in the reference. A contact that overlaps none of the other run's is off by
// all of its force; where the other run has more contacts than are kept, by what it exceeds the
// weakest of them.
JointError error_of_joint(const Trajectory *trajectory, const Trajectory *reference, size_t joint,
                          double horizon_s);

// The errors of the extremes of a body's angular acceleration about z.
BodyError error_of_body(const Trajectory *trajectory, const Trajectory *reference, size_t body,
                        double horizon_s);

// The forces of the joints with play at one sample: error_of_joint sample by sample.
typedef struct ForceMeasure {
    size_t count;   // of joints; 0 where the reference let no play happen
    size_t *joints; // owned, like the next
    double *scales; // N or N m, in which their forces are measured
} ForceMeasure;

// For error_forces_finish.
ForceMeasure error_forces(const Trajectory *reference);
void error_forces_finish(ForceMeasure *measure);

// The largest relative difference of any of the forces at a sample. NAN where one is not finite.
double error_forces_apart(const ForceMeasure *measure, const Trajectory *trajectory,
                          const Trajectory *reference, size_t sample);

// The larger of peak_force_max and peak_alpha_max of two runs, in the horizon: 1.
double error_of_peaks(const Trajectory *trajectory, const Trajectory *reference, double horizon_s);

// The error in the horizon where there is one, else that of the whole run.
static inline double error_of_run(const TrajectoryError *error, bool is_limited)
{
    return is_limited ? error->max_in_horizon : error->max;
}

// The same of what a tolerance is of. NAN where the run has none of it.
double error_of_kind(const TrajectoryError *error, ToleranceOf kind, bool is_limited);

// Why a run has no meaningful error though it came to its end, or NULL.
const char *error_is_unstable(const TrajectoryError *error, bool is_limited);

// Makes a run that has more energy from nowhere than there is in the reference one that failed,
// with its message and no error. Returns whether it did.
bool error_fail_unstable(Trajectory *run, const Trajectory *reference, TrajectoryError *error);

// The same of a run that there is no reference for: where what came from nowhere is a thousand
// times the energy that it began with and was given, and the largest of all its energies.
bool error_fail_runaway(const Scenario *scenario, Trajectory *run);

// The same measure sample by sample: writes the largest distance at each sample, in scales that are
// mostly those of the reference, into an array of the trajectories' length. Returns false, the
// array untouched, where the two cannot be compared.
bool error_series(const Trajectory *trajectory, const Trajectory *reference,
                  const DistanceMeasure *measure, double *distance);

// Matches the contacts of one run with those of another, and measures the differences.

typedef struct SpikePair {
    size_t spike;           // number among the run's spikes of the joint
    size_t reference_spike; // likewise, of the reference
    double onset_delay_s;   // the run's onset less the reference's
    double force_error;     // 1: the run's largest force over the reference's, less 1
    double impulse_error;   // 1: of the impulse, likewise
} SpikePair;

typedef struct SpikeMatch {
    size_t pair_count;
    SpikePair pairs[TRAJECTORY_SPIKE_MAX]; // in the order of the reference's spikes
    size_t missed;                         // spikes of the reference that nothing answers to
    size_t extra;                          // spikes of the run that answer to none
} SpikeMatch;

// Pairs the kept spikes of one joint by their onsets: a pair is nearer to each other than half the
// distance to the next spike of either run, so that no spike can belong to two, and nearer than
// the reach, s. Left out are spikes that begin after the horizon, s, with their partners, and
// spikes without force or impulse. Both trajectories must be complete and of the same scenario.
SpikeMatch spike_match(const Trajectory *trajectory, const Trajectory *reference, size_t joint,
                       double horizon_s, double reach_s);

// The reach of a scenario, s: a small part of a turn of its driver, or of the run where that is
// shorter or there is no driver.
double spike_match_reach(const Scenario *scenario);

// Whether a motion passes a change point of its ideal joints about a time.

// Whether the ideal joints of a small mechanism in the plane come close to a change point, where
// their constraints depend on one another, within a hundredth of the run before or after a time, s.
// An ODE step that opens the joints by little may there go on along the other branch, at any step.
bool change_point_is_near(const Trajectory *truth, double time_s);
