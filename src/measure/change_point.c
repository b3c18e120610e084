// Whether a motion passes a change point of its ideal joints about a time.
//
// At a change point the rows of the constraint Jacobian depend on one another. How close a position
// is to one is told by the least pivot of its elimination, as a share of the largest; how small
// that is anyway, by lengths and units, by its median over the run.
#include "measure/change_point.h"

#include "model/kinematics.h"

#include <math.h>
#include <stdlib.h>

enum { TYPICAL = 65, HALVINGS = 30 };

static const double WINDOW = 0.01; // of the run
// of the typical pivot: a change point between two samples 2 degrees apart leaves .02 at one of
// them
static const double IS_CLOSE = 0.02;
static const double LEAST_SHARE = 1e-12;

// The largest share of the largest pivot that all independent pivots exceed.
static double least_pivot(const Trajectory *run, size_t sample)
{
    const Motion *motions = run->motions + sample * run->body_count;
    size_t rows = 0;
    double low = log(LEAST_SHARE), high = 0.0;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        const size_t rank = kinematics_rank(&run->linkage, motions, NULL, true, exp(middle), &rows);
        *(rank == rows ? &low : &high) = middle;
    }
    return exp(low);
}

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double typical_pivot(const Trajectory *run)
{
    double pivots[TYPICAL];
    for (size_t i = 0; i < TYPICAL; i++) {
        pivots[i] = least_pivot(run, i * (run->sample_count - 1) / (TYPICAL - 1));
    }
    qsort(pivots, TYPICAL, sizeof *pivots, compare_numbers);
    return pivots[TYPICAL / 2];
}

static bool has_ideal_joints_alone(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (!linkage_kind_is_ideal(linkage->joints[i].kind)) {
            return false;
        }
    }
    return true;
}

bool change_point_is_near(const Trajectory *truth, double time_s)
{
    if (truth->space_motions != NULL || !kinematics_is_small(&truth->linkage) ||
        !has_ideal_joints_alone(&truth->linkage) || truth->sample_count < 2) {
        return false;
    }
    const double typical = typical_pivot(truth);
    const double window_s = WINDOW * truth->times[truth->sample_count - 1];
    for (size_t i = 0; i < truth->sample_count; i++) {
        if (fabs(truth->times[i] - time_s) <= window_s &&
            least_pivot(truth, i) < IS_CLOSE * typical) {
            return true;
        }
    }
    return false;
}
