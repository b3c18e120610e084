// In which columns of a series does a rate stand?
#include "write/rate_columns.h"

#include <stdio.h>

static const char *const AXES[] = {"x", "y", "z"};

// Of an angular velocity in space the part about z is the one that the plane has, without a letter.
static void name_of_turning(const char *body, int component, bool is_spatial,
                            char name[RATE_COLUMN_SIZE])
{
    if (is_spatial && component < 2) {
        snprintf(name, RATE_COLUMN_SIZE, "%s_omega_%s_rad_s", body, AXES[component]);
    } else {
        snprintf(name, RATE_COLUMN_SIZE, "%s_omega_rad_s", body);
    }
}

int rate_columns(const Linkage *linkage, const DistanceRate *rate,
                 char names[RATE_COLUMNS_MOST][RATE_COLUMN_SIZE])
{
    const bool is_of_body = rate->kind == DISTANCE_TURNING || rate->kind == DISTANCE_MOVING;
    const char *of =
        is_of_body ? linkage->bodies[rate->number].name : linkage->joints[rate->number].name;
    const int count = distance_components(linkage, rate);
    for (int i = 0; i < count; i++) {
        if (rate->kind == DISTANCE_TURNING) {
            name_of_turning(of, i, linkage->is_spatial, names[i]);
        } else if (rate->kind == DISTANCE_TILT && count == 1) {
            snprintf(names[i], RATE_COLUMN_SIZE, "%s_tilt_rate_rad_s", of);
        } else if (rate->kind == DISTANCE_TILT) {
            snprintf(names[i], RATE_COLUMN_SIZE, "%s_tilt_rate_%s_rad_s", of, AXES[i]);
        } else if (count == 1) {
            snprintf(names[i], RATE_COLUMN_SIZE, "%s_rate_%s", of,
                     rate->reach > 0.0 ? "rad_s" : "m_s");
        } else {
            snprintf(names[i], RATE_COLUMN_SIZE, "%s_v%s_m_s", of, AXES[i]);
        }
    }
    return count;
}
