// In which turn is a body?
#include "run/turning.h"

#include "base/zeroed.h"

#include <math.h>

static const double SAME_TURN = 3.0; // rad, less than half a turn

Turning turning_start(const Linkage *linkage)
{
    const size_t count = linkage->body_count;
    Turning turning = {
        .linkage = linkage,
        .told_s = zeroed(count, sizeof *turning.told_s),
        .angle = zeroed(count, sizeof *turning.angle),
        .omega = zeroed(count, sizeof *turning.omega),
    };
    for (size_t i = 0; i < count; i++) {
        turning.angle[i] = linkage->bodies[i].start.angle;
        turning.omega[i] = linkage->bodies[i].start.omega;
    }
    return turning;
}

void turning_finish(Turning *turning)
{
    free(turning->told_s);
    free(turning->angle);
    free(turning->omega);
}

void turning_add(Turning *turning, const StepRecord *record)
{
    const size_t count = solver_body_count(record->part, turning->linkage);
    for (size_t k = 0; k < count; k++) {
        const size_t i = solver_body(record->part, k);
        const double width_s = record->end_s - turning->told_s[i];
        turning->angle[i] += 0.5 * width_s * (turning->omega[i] + record->omega[k]);
        turning->omega[i] = record->omega[k];
        turning->told_s[i] = record->end_s;
    }
}

void turning_unwrap(const Turning *turning, const SolverPart *part, Sample *sample)
{
    const int driven = linkage_driven_body(turning->linkage);
    const size_t count = solver_body_count(part, turning->linkage);
    for (size_t k = 0; k < count; k++) {
        const size_t i = solver_body(part, k);
        if ((int)i == driven) {
            continue;
        }
        const double ahead = turning->omega[i] * (turning->told_s[i] - sample->time_s);
        double *angle = &sample->bodies[i].angle;
        const double apart = turning->angle[i] - ahead - *angle;
        // hardly ever is it another turn than that of the solver
        if (!(fabs(apart) < SAME_TURN)) {
            *angle += 2.0 * M_PI * round(apart / (2.0 * M_PI));
        }
    }
}
