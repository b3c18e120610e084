// How many spikes stand where the paper saw its own?
#include "commands/run/run_report.h"

#include <math.h>

static const double SECTOR_DEG = 360.0 / SIGNAL_SECTOR_COUNT;

const size_t SPIKE_BANDS[SPIKE_BAND_COUNT] = {12, 29};

// The paper's mechanism, m: Tables VI and IV.
static const double PAPER_GROUND = 0.254;
static const double PAPER_CRANK = 0.108;
static const double PAPER_COUPLER = 0.2794;
static const double PAPER_FOLLOWER = 0.2705;
static const double PAPER_CLEARANCE = 14.5e-6;
static const double SAME = 1e-6; // relative: above rounding, below any tolerance of a length
enum { PAPER_JOINT = 1 };        // crank-coupler

static bool is_inside(size_t sector)
{
    for (size_t i = 0; i < SPIKE_BAND_COUNT; i++) {
        if (SPIKE_BANDS[i] == sector) {
            return true;
        }
    }
    return false;
}

SpikeBandSums spike_bands_sums(const SignalSpikes *spikes)
{
    SpikeBandSums sums = {0};
    for (size_t i = 0; i < SIGNAL_SECTOR_COUNT; i++) {
        SignalSector *sum = is_inside(i) ? &sums.inside : &sums.outside;
        sum->count += spikes->sectors[i].count;
        sum->largest = fmax(sum->largest, spikes->sectors[i].largest);
    }
    return sums;
}

static bool is_near(double value, double wanted)
{
    return fabs(value - wanted) <= SAME * wanted;
}

// Whether the only play is that of Table IV in the joint between crank and coupler.
static bool has_papers_play(const Linkage *linkage)
{
    bool is_so = false;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_has_play(joint)) {
            is_so = i == PAPER_JOINT && is_near(linkage_radial_clearance(joint), PAPER_CLEARANCE);
            if (!is_so) {
                break;
            }
        }
    }
    return is_so;
}

bool spike_bands_apply(const RunReport *report)
{
    const FourBar *fourbar = &report->scenario->fourbar;
    return report->scenario->has_fourbar && is_near(fourbar->ground.nominal, PAPER_GROUND) &&
           is_near(fourbar->crank.nominal, PAPER_CRANK) &&
           is_near(fourbar->coupler.nominal, PAPER_COUPLER) &&
           is_near(fourbar->follower.nominal, PAPER_FOLLOWER) &&
           has_papers_play(&report->scenario->linkage);
}

double spike_bands_first_deg(size_t band)
{
    return SECTOR_DEG * (double)SPIKE_BANDS[band];
}

double spike_bands_last_deg(size_t band)
{
    return SECTOR_DEG * (double)(SPIKE_BANDS[band] + 1);
}
