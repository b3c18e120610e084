// Finds when the torque of a soft drive reaches its limit, or leaves it.
//
// Within a step it is either M, by the drive's stiffness and damping, or a limit +-L, so that the
// rates are smooth. Margins that are not negative while that holds:
//     by itself    L - |M|
//     at a limit   side M - L      side +1 or -1
// Where one is used up the drive changes over. M does not jump, nor does its rate: what follows has
// a margin that grows. A step is looked at in some points, and where the margin has its least value
// between them, there too, by golden section: M may pass its limit and come back.
#include "reference/stepper.h"

#include "base/root.h"

#include <float.h>
#include <math.h>

enum { POINTS = 8, SECTIONS = 40 };

static const double GOLDEN = 0.61803398874989485;

// 1: of the terms of the torque, what their sum leaves uncertain
static const double TORQUE_ROUNDING = 8.0 * DBL_EPSILON;

// Where a drive is looked at in a tried step.
typedef struct Search {
    const System *system;
    Dop853 *integrator;
} Search;

static double margin_of(const System *system, const DriveTorque *torque)
{
    const double limit = system->scenario->linkage.torque.limit;
    const double margin = system->side == 0 ? limit - fabs(torque->unlimited)
                                            : system->side * torque->unlimited - limit;
    // beyond rounding alone
    return margin + TORQUE_ROUNDING * (torque->terms + limit);
}

static DriveTorque torque_at(const Search *search, double time)
{
    const Dop853 *integrator = search->integrator;
    const bool is_end = time == integrator->time + integrator->tried;
    const double *y = is_end ? integrator->next : dop853_dense(search->integrator, time);
    return search->system->kind->torque(search->system, time, y);
}

static double margin_at(double time, void *context)
{
    const Search *search = context;
    const DriveTorque torque = torque_at(search, time);
    return margin_of(search->system, &torque);
}

// The time of the least margin between two, between which one lies that has less than both.
static double least_between(Search *search, double first, double last)
{
    double low = last - GOLDEN * (last - first);
    double high = first + GOLDEN * (last - first);
    double at_low = margin_at(low, search);
    double at_high = margin_at(high, search);
    for (int i = 0; i < SECTIONS && at_low > 0.0 && at_high > 0.0; i++) {
        if (at_low < at_high) {
            last = high;
            high = low;
            at_high = at_low;
            low = last - GOLDEN * (last - first);
            at_low = margin_at(low, search);
        } else {
            first = low;
            low = high;
            at_low = at_high;
            high = first + GOLDEN * (last - first);
            at_high = margin_at(high, search);
        }
    }
    return at_low < at_high ? low : high;
}

// The time of a point, or of the least margin where that lies beside the point: between its
// neighbours, or, by the slope of a parabola through three, in the first or the last part.
static double dip_near(Search *search, const double *times, const double *margins, int i)
{
    const double *m = margins;
    const bool is_within = i < POINTS && m[i] < m[i - 1] && m[i] <= m[i + 1];
    const bool is_first = i == 1 && m[1] >= m[0] && 4.0 * m[1] - 3.0 * m[0] - m[2] < 0.0;
    const bool is_last =
        i == POINTS && m[i] <= m[i - 1] && 3.0 * m[i] - 4.0 * m[i - 1] + m[i - 2] > 0.0;
    if (!(m[i] > 0.0) || !(is_within || is_first || is_last)) {
        return times[i];
    }
    return least_between(search, times[i - 1], times[is_within ? i + 1 : i]);
}

// Which side holds once the present margin is used up.
static int side_after(const Search *search, double time)
{
    return search->system->side != 0 ? 0 : torque_at(search, time).unlimited > 0.0 ? 1 : -1;
}

bool drive_limit_find(const System *system, Dop853 *integrator, Event *event)
{
    Search search = {system, integrator};
    double times[POINTS + 1];
    double margins[POINTS + 1];
    for (int i = 0; i <= POINTS; i++) {
        times[i] = i == POINTS ? integrator->time + integrator->tried
                               : integrator->time + integrator->tried * i / POINTS;
        margins[i] = margin_at(times[i], &search);
    }
    for (int i = 1; i <= POINTS; i++) {
        const double beyond = dip_near(&search, times, margins, i);
        if (margin_at(beyond, &search) >= 0.0) {
            continue;
        }
        // the start is the end of the step before, whose event has just brought the margin to zero
        double time = times[i - 1];
        if (margins[i - 1] > 0.0) {
            root_find(margin_at, &search, times[i - 1], beyond, 0.0, &time);
        }
        *event = (Event){.time = time,
                         .mode = CONTACT_APART,
                         .is_drive = true,
                         .side = side_after(&search, beyond)};
        return true;
    }
    return false;
}

void drive_limit_start(System *system, const double *y)
{
    const double limit = system->scenario->linkage.torque.limit;
    if (system->kind->torque == NULL || limit == 0.0) {
        return;
    }
    const double torque = system->kind->torque(system, 0.0, y).unlimited;
    system->side = torque > limit ? 1 : torque < -limit ? -1 : 0;
}
