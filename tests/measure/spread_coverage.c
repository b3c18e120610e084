// Does the range over the inputs cover what it is said to cover?
//
// spread_coverage CASE.yaml DRAWS [KEY=VALUE...]
// Finds the range of the case as `run` does, and makes so many other draws by brute force. Prints
// the share of these within the range, and of all groups of as many draws as `run` makes the mean
// share and how many of them cover 90 %: 0.949 and 0.905 is what independent draws have to give.
// The last line is the same of groups of ten, which cover less: the control.
#include "base/clock.h"
#include "base/zeroed.h"
#include "casefile/input.h"
#include "run/settle.h"
#include "run/spread.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const RunWatch NOBODY = {.progress = NULL};
static const double COVERED = 0.9;

enum { CONTROL_DRAWS = 10 };

static double share_within(const double *forces, size_t count, double low, double high)
{
    size_t within = 0;
    for (size_t i = 0; i < count; i++) {
        within += forces[i] >= low && forces[i] <= high ? 1 : 0;
    }
    return (double)within / (double)count;
}

// Groups of a size among the draws, each held against all others.
static void print_groups(const double *forces, size_t count, size_t size)
{
    size_t groups = 0;
    size_t covering = 0;
    double mean = 0.0;
    for (size_t from = 0; from + size <= count; from += size) {
        double low = INFINITY;
        double high = -INFINITY;
        for (size_t i = from; i < from + size; i++) {
            low = fmin(low, forces[i]);
            high = fmax(high, forces[i]);
        }
        // those of the group are within it
        const double within = share_within(forces, count, low, high) * (double)count;
        const double share = (within - (double)size) / (double)(count - size);
        mean += share;
        covering += share >= COVERED ? 1 : 0;
        groups++;
    }
    printf("  groups of %zu: mean share %.3f, %zu of %zu cover %.2f\n", size, mean / (double)groups,
           covering, groups, COVERED);
}

static void print_spread(const Spread *spread)
{
    const Linkage *linkage = &spread->scenario->linkage;
    const SettledMotion *motion = &spread->scenario->settled.motions[0];
    const SpreadRange *range = &spread->ranges[spread->joint];
    const SpreadRange *forms = &spread->form_ranges[spread->joint];
    printf(
        "  %s %.1f (%.1f to %.1f; forms %.1f to %.1f), period %zu, %zu motions, %zu of %zu draws, "
        "%zu without, %.2f s\n",
        linkage->joints[spread->joint].name, motion->joints[spread->joint].force.headline,
        range->low, range->high, forms->low, forms->high, motion->period, spread->motion_count,
        spread->draw_count, spread->asked, spread->without, spread->spent_s);
    for (size_t i = 0; i < spread->inputs.count; i++) {
        const SpreadInput *input = &spread->inputs.inputs[i];
        printf("  %-32s %.6g %.4g/%.4g %s, rank %.2f\n", input->key, input->nominal, input->lower,
               input->upper, input->unit, spread->ranks[i]);
    }
    for (size_t i = 0; i < spread->form_count; i++) {
        const SpreadAnswer *answer = &spread->forms[i].answers[0];
        printf("  %-32s %.1f period %zu\n", spread->forms[i].name,
               answer->is_there ? answer->forces[spread->joint] : NAN, answer->period);
    }
    if (spread->touch.is_there) {
        printf("  touch: %s at %.6g, %.1f N, impacts %.3g to %.3g\n",
               spread->inputs.inputs[spread->touch.input].key, spread->touch.at,
               spread->touch.force, spread->touch.was_impacts, spread->touch.impacts);
    }
}

static void judge(const SpreadCase *of, const Scenario *scenario, size_t draws)
{
    Spread spread =
        spread_find(of, scenario,
                    &(SpreadOptions){
                        .draws = SPREAD_DRAWS, .has_forms = true, .budget_s = scenario->run.budget},
                    NOBODY);
    if (!spread.is_there) {
        printf("  nothing settles\n");
        return;
    }
    print_spread(&spread);
    if (draws == 0) {
        spread_free(&spread);
        return;
    }
    Spread brute =
        spread_find(of, scenario, &(SpreadOptions){.draws = draws, .first = 1000000}, NOBODY);
    double *forces = zeroed(draws, sizeof *forces);
    size_t count = 0;
    for (size_t i = 0; i < draws; i++) {
        for (size_t m = 0; m < brute.motion_count && m < 1; m++) {
            const SpreadAnswer *answer = &brute.draws[i].answers[m];
            if (answer->is_there) {
                forces[count++] = answer->forces[brute.joint];
            }
        }
    }
    const SpreadRange *range = &spread.ranges[spread.joint];
    if (count > SPREAD_DRAWS) {
        printf("  of %zu draws by brute force %.3f are within the range (%.1f s)\n", count,
               share_within(forces, count, range->low, range->high), brute.spent_s);
        print_groups(forces, count, SPREAD_DRAWS);
        print_groups(forces, count, CONTROL_DRAWS);
    }
    free(forces);
    spread_free(&brute);
    spread_free(&spread);
}

int main(int argc, char **argv)
{
    Err err = {ERR_NONE, ""};
    char *text;
    size_t size;
    if (argc < 3) {
        fprintf(stderr, "usage: spread_coverage CASE.yaml DRAWS [KEY=VALUE...]\n");
        return 2;
    }
    if (!input_read("case", argv[1], &text, &size, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return 1;
    }
    const SpreadCase of = {argv[1], text, size, (const char *const *)argv + 3, (size_t)argc - 3};
    Scenario scenario;
    if (!casefile_load_text(of.name, of.text, of.size, of.overrides, of.override_count, &scenario,
                            &err)) {
        fprintf(stderr, "%s\n", err.text);
        return 1;
    }
    printf("%s\n", argv[1]);
    settle_scenario(&scenario, NOBODY);
    const size_t draws = strtoul(argv[2], NULL, 10);
    judge(&of, &scenario, draws);
    scenario_free(&scenario);
    free(text);
    return 0;
}
