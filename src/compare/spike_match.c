// Which contact of one run is which of the reference's?
//
//     |t_i - s_k| < min(gap(t_i), gap(s_k)) / 2,    gap(t) = distance to the next onset of its run
// makes t_i and s_k each other's nearest, so that the pairs are the same in whatever order.
#include "compare/spike_match.h"

// The distance in time to the nearest other spike that was kept; infinite for one alone.
static double gap(const JointExtremes *joint, size_t spike)
{
    double nearest = INFINITY;
    for (size_t i = 0; i < joint->spike_count; i++) {
        if (i != spike) {
            const double distance = joint->spikes[i].onset_s - joint->spikes[spike].onset_s;
            nearest = fmin(nearest, fabs(distance));
        }
    }
    return nearest;
}

// The number of the run's spike that answers to one of the reference's, or -1.
static int find_partner(const JointExtremes *run, const JointExtremes *reference, size_t spike)
{
    const double half = 0.5 * gap(reference, spike);
    for (size_t i = 0; i < run->spike_count; i++) {
        const double distance = fabs(run->spikes[i].onset_s - reference->spikes[spike].onset_s);
        if (distance < fmin(half, 0.5 * gap(run, i))) {
            return (int)i;
        }
    }
    return -1;
}

static size_t count_until(const JointExtremes *joint, double horizon_s)
{
    size_t count = 0;
    for (size_t i = 0; i < joint->spike_count; i++) {
        count += joint->spikes[i].onset_s <= horizon_s ? 1 : 0;
    }
    return count;
}

SpikeMatch spike_match(const Trajectory *trajectory, const Trajectory *reference, size_t joint,
                       double horizon_s)
{
    const JointExtremes *run = &trajectory->joints[joint];
    const JointExtremes *truth = &reference->joints[joint];
    SpikeMatch match = {0};
    for (size_t k = 0; k < truth->spike_count; k++) {
        const Spike *other = &truth->spikes[k];
        const int partner = find_partner(run, truth, k);
        const bool is_early = other->onset_s <= horizon_s;
        if (partner < 0 || !is_early || run->spikes[partner].onset_s > horizon_s) {
            continue;
        }
        const Spike *spike = &run->spikes[partner];
        match.pairs[match.pair_count++] = (SpikePair){
            .spike = (size_t)partner,
            .reference_spike = k,
            .onset_delay_s = spike->onset_s - other->onset_s,
            .force_error = spike->force_max / other->force_max - 1.0,
            .impulse_error = spike->impulse / other->impulse - 1.0,
        };
    }
    match.missed = count_until(truth, horizon_s) - match.pair_count;
    match.extra = count_until(run, horizon_s) - match.pair_count;
    return match;
}
