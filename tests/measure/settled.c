// Does a mechanism settle to one motion, whatever its start?
//
//     settled STARTS MOST TOLERANCE CASE [KEY=VALUE...]
//
// Turns the case from as many starts, the first as written and the others with other speeds, until
// each repeats or MOST revolutions are over, and prints of each the revolutions it took, its period
// and the largest force of each joint with play over the last period.
#include "casefile/casefile.h"
#include "model/perturb.h"
#include "run/settle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double SIZES[] = {0.01, 0.05, 0.2};

static int print_error(const Err *err)
{
    fprintf(stderr, "settled: %s\n", err->text);
    return 1;
}

static void print_peaks(const Settling *settling)
{
    const Linkage *linkage = &settling->scenario.linkage;
    const size_t last = settling->count;
    const size_t period = settling->period > 0 ? settling->period : (last < 10 ? last : 10);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (!linkage_has_play(&linkage->joints[i])) {
            continue;
        }
        double peak = 0.0;
        double impacts = 0.0;
        for (size_t k = last - period; k < last; k++) {
            peak = fmax(peak, settling->revolutions[k].force_max[i]);
            impacts += (double)settling->revolutions[k].impacts[i];
        }
        printf("  %s first %.6g settled %.9g impacts %.2g", linkage->joints[i].name,
               settling->revolutions[0].force_max[i], peak, impacts / (double)period);
    }
}

int main(int argc, char **argv)
{
    if (argc < 5) {
        return 2;
    }
    const unsigned starts = (unsigned)atoi(argv[1]);
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    if (!casefile_load(argv[4], (const char *const *)argv + 5, (size_t)argc - 5, &scenario, &err)) {
        return print_error(&err);
    }
    PerturbUnit *units = calloc(scenario.linkage.body_count, sizeof *units);
    for (size_t i = 0; units != NULL && i < scenario.linkage.body_count; i++) {
        const double reach = linkage_reach(&scenario.linkage, (int)i);
        units[i] = (PerturbUnit){fabs(scenario.linkage.driver.speed) * reach,
                                 fabs(scenario.linkage.driver.speed)};
    }
    for (unsigned k = 0; k < starts; k++) {
        Settling settling = settling_start(&scenario);
        if (k > 0) {
            perturb_start(&settling.scenario, units, SIZES[k % 3], k);
        }
        const bool is_run = settling_run(&settling, atof(argv[3]), (size_t)atoi(argv[2]), &err);
        printf("start %u: %zu revolutions, %zu evaluations, ", k, settling.count,
               settling.evaluations);
        printf("period %zu, change %.2g, left %.2g", settling.period, settling.change,
               settling.left);
        print_peaks(&settling);
        printf("%s\n", is_run ? "" : err.text);
        settling_finish(&settling);
    }
    scenario_free(&scenario);
    free(units);
    return 0;
}
