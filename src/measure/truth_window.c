// Up to when is a truth sure enough?
//
// Its uncertainty U belongs to its horizon T and was less before. How it grew shows in the distance
// to a run of the reference at another tolerance, d(t), the largest so far:
//     U(t) = U d(t) / d(T)
#include "measure/truth_window.h"

#include "model/distance.h"
#include "run/registry.h"

#include <math.h>

// of the other run's tolerance to the truth's
static const double OTHER = 1e2;

static TruthWindow shorten(const Trajectory *truth, const Trajectory *other, TruthWindow whole,
                           double most)
{
    DistanceScale scales[LINKAGE_BODY_MAX];
    distance_scales(truth, scales);
    double largest = 0.0;
    for (size_t k = 0; k < truth->sample_count && truth->times[k] <= whole.until_s; k++) {
        largest = fmax(largest, distance_at(other, truth, k, scales));
    }
    TruthWindow window = {0.0, 0.0};
    double so_far = 0.0;
    for (size_t k = 0; largest > 0.0 && k < truth->sample_count; k++) {
        so_far = fmax(so_far, distance_at(other, truth, k, scales));
        const double uncertainty = whole.uncertainty * so_far / largest;
        if (truth->times[k] > whole.until_s || !(uncertainty <= most)) {
            break;
        }
        window = (TruthWindow){truth->times[k], uncertainty};
    }
    return window;
}

TruthWindow truth_window_find(const Scenario *scenario, const Truth *truth, double most,
                              RunWatch watch)
{
    const double duration_s = scenario_duration(scenario);
    const TruthWindow whole = {
        .until_s = truth->is_limited ? fmin(truth->horizon_s, duration_s) : duration_s,
        .uncertainty = truth->uncertainty,
    };
    if (truth->uncertainty <= most) {
        return whole;
    }
    if (!isfinite(truth->uncertainty)) {
        return (TruthWindow){0.0, 0.0};
    }
    Scenario other = *scenario;
    other.reference.tolerance *= OTHER;
    Trajectory *run = run_scenario(&other, registry_solver(BACKEND_REFERENCE), watch);
    const TruthWindow window =
        run->is_complete ? shorten(truth->trajectory, run, whole, most) : (TruthWindow){0.0, 0.0};
    trajectory_destroy(run);
    return window;
}
