// Which contact of one run is which of the reference's?
//
//     |t_i - s_k| < min(gap(t_i) / 2, gap(s_k) / 2, reach),
//     gap(t) = distance to the next onset of its run
// makes t_i and s_k each other's nearest, so that the pairs are the same in whatever order.
#include "measure/spike_match.h"

// contacts a twentieth of a turn apart are different contacts
static const double REACH = 0.05;

// Whether there is a contact to speak of: what has no force or impulse cannot be divided by.
static bool is_contact(const Spike *spike)
{
    return spike->force_max > 0.0 && spike->impulse > 0.0;
}

// The distance in time to the nearest other contact that was kept; infinite for one alone.
static double gap(const JointExtremes *joint, size_t spike)
{
    double nearest = INFINITY;
    for (size_t i = 0; i < joint->spike_count; i++) {
        if (i != spike && is_contact(&joint->spikes[i])) {
            const double distance = joint->spikes[i].onset_s - joint->spikes[spike].onset_s;
            nearest = fmin(nearest, fabs(distance));
        }
    }
    return nearest;
}

// The number of the other run's spike that answers to one of this run's, or -1.
static int find_partner(const JointExtremes *own, size_t spike, const JointExtremes *other,
                        double reach_s)
{
    const double limit = fmin(0.5 * gap(own, spike), reach_s);
    for (size_t i = 0; i < other->spike_count; i++) {
        const double distance = fabs(other->spikes[i].onset_s - own->spikes[spike].onset_s);
        if (is_contact(&other->spikes[i]) && distance < fmin(limit, 0.5 * gap(other, i))) {
            return (int)i;
        }
    }
    return -1;
}

// The contacts up to the horizon that no spike of the other run answers to, before or behind it.
static size_t count_alone(const JointExtremes *own, const JointExtremes *other, double horizon_s,
                          double reach_s)
{
    size_t count = 0;
    for (size_t i = 0; i < own->spike_count; i++) {
        const bool counts = is_contact(&own->spikes[i]) && own->spikes[i].onset_s <= horizon_s;
        count += counts && find_partner(own, i, other, reach_s) < 0 ? 1 : 0;
    }
    return count;
}

double spike_match_reach(const Scenario *scenario)
{
    const double run_s = scenario_duration(scenario);
    const double period_s = linkage_period(&scenario->linkage);
    return REACH * (period_s > 0.0 ? fmin(period_s, run_s) : run_s);
}

SpikeMatch spike_match(const Trajectory *trajectory, const Trajectory *reference, size_t joint,
                       double horizon_s, double reach_s)
{
    const JointExtremes *run = &trajectory->joints[joint];
    const JointExtremes *truth = &reference->joints[joint];
    SpikeMatch match = {0};
    for (size_t k = 0; k < truth->spike_count; k++) {
        const Spike *other = &truth->spikes[k];
        const bool is_early = is_contact(other) && other->onset_s <= horizon_s;
        const int partner = is_early ? find_partner(truth, k, run, reach_s) : -1;
        if (partner < 0 || run->spikes[partner].onset_s > horizon_s) {
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
    match.missed = count_alone(truth, run, horizon_s, reach_s);
    match.extra = count_alone(run, truth, horizon_s, reach_s);
    return match;
}
