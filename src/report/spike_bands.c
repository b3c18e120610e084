// How many spikes stand where the paper saw its own?
#include "report/spike_bands.h"

#include <math.h>

static const double SECTOR_DEG = 360.0 / SIGNAL_SECTOR_COUNT;

const size_t SPIKE_BANDS[SPIKE_BAND_COUNT] = {12, 29};

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

bool spike_bands_apply(const RunReport *report)
{
    return report->scenario->has_fourbar && scenario_has_clearance(report->scenario);
}

double spike_bands_first_deg(size_t band)
{
    return SECTOR_DEG * (double)SPIKE_BANDS[band];
}

double spike_bands_last_deg(size_t band)
{
    return SECTOR_DEG * (double)(SPIKE_BANDS[band] + 1);
}
