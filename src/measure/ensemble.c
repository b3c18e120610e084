// Measures the distributions of a motion that cannot be predicted.
#include "measure/ensemble.h"
#include "base/clock.h"
#include "base/sorted.h"
#include "base/zeroed.h"
#include "model/perturb.h"

#include <string.h>

// what an engine's own error amounts to within the first impacts
const double ENSEMBLE_PERTURBATION = 1e-3;

typedef struct Draws {
    double values[ENSEMBLE_JOINT_MAX][ENSEMBLE_METRIC_COUNT][ENSEMBLE_MEMBERS];
} Draws;

static void take_member(const Trajectory *trajectory, size_t member, Draws *draws)
{
    for (size_t i = 0; i < trajectory->joint_count && i < ENSEMBLE_JOINT_MAX; i++) {
        const JointExtremes *joint = &trajectory->joints[i];
        draws->values[i][ENSEMBLE_FORCE_MAX][member] = joint->force_max.value;
        draws->values[i][ENSEMBLE_IMPULSE][member] = joint->impulse;
        draws->values[i][ENSEMBLE_IMPACTS][member] = (double)joint->impacts;
        draws->values[i][ENSEMBLE_PENETRATION_MAX][member] = joint->penetration_max.value;
        draws->values[i][ENSEMBLE_CONTACT_SHARE][member] = trajectory_contact_share(trajectory, i);
    }
}

static Distribution distribution_of(double *values, size_t count)
{
    sorted_make(values, count);
    Distribution made = {
        .low = values[0],
        .high = values[count - 1],
        .median = sorted_median(values, count),
    };
    for (size_t i = 0; i < count; i++) {
        made.mean += values[i] / (double)count;
    }
    double square = 0.0;
    for (size_t i = 0; i < count; i++) {
        square += (values[i] - made.mean) * (values[i] - made.mean);
    }
    made.deviation = count > 1 ? sqrt(square / (double)(count - 1)) : 0.0;
    return made;
}

// Runs the scenario from one start; the first of all says how fast the bodies move.
static Trajectory *run_member(const Scenario *scenario, const Solver *solver, RunWatch watch,
                              unsigned member, PerturbUnit *units)
{
    Scenario beside = scenario_copy(scenario);
    if (member > 0) {
        perturb_start(&beside, units, ENSEMBLE_PERTURBATION, member);
    }
    Trajectory *trajectory = run_scenario(&beside, solver, watch);
    if (member == 0) {
        perturb_units(trajectory, units);
    }
    scenario_free(&beside);
    return trajectory;
}

// One who watches all members as if they were one run.
typedef struct MembersWatch {
    RunWatch watch;
    unsigned done;   // members
    double before_s; // wall time of those
    double wall_s;   // of the one under way
} MembersWatch;

static void tell_of_member(double share, double wall_s, void *context)
{
    MembersWatch *members = context;
    members->wall_s = wall_s;
    members->watch.progress(((double)members->done + share) / ENSEMBLE_MEMBERS,
                            members->before_s + wall_s, members->watch.context);
}

void ensemble_run(const Scenario *scenario, const Solver *solver, double budget_s, RunWatch watch,
                  Ensemble *ensemble)
{
    const double began_s = clock_processor_s();
    MembersWatch members = {.watch = watch};
    const RunWatch of_member = {
        .progress = watch.progress != NULL ? tell_of_member : NULL,
        .context = &members,
    };
    Draws draws;
    PerturbUnit *units = zeroed(scenario->linkage.body_count, sizeof *units);
    memset(ensemble, 0, sizeof *ensemble);
    bool has_time = true;
    for (unsigned member = 0; member < ENSEMBLE_MEMBERS && has_time; member++) {
        Trajectory *trajectory = run_member(scenario, solver, of_member, member, units);
        members.done++;
        members.before_s += members.wall_s;
        members.wall_s = 0.0;
        if (trajectory->is_complete) {
            take_member(trajectory, ensemble->members++, &draws);
        } else if (ensemble->failed++ == 0) {
            memcpy(ensemble->message, trajectory->message, sizeof ensemble->message);
        }
        trajectory_destroy(trajectory);
        // a further one takes as long as those before
        const double spent_s = clock_processor_s() - began_s;
        has_time = budget_s == 0.0 || spent_s + spent_s / (member + 1) <= budget_s;
    }
    free(units);
    const size_t joints = ensemble_joint_count(&scenario->linkage);
    for (size_t i = 0; ensemble->members > 0 && i < joints; i++) {
        if (!linkage_has_play(&scenario->linkage.joints[i])) {
            continue;
        }
        for (int metric = 0; metric < ENSEMBLE_METRIC_COUNT; metric++) {
            ensemble->joints[i][metric] =
                distribution_of(draws.values[i][metric], ensemble->members);
        }
    }
}
