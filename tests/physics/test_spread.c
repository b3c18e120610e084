// Is the range over the inputs what it is said to be?
//
// Draws and forms are found at a loose tolerance from the settled motion of the case. The truth of
// one is the same case with its numbers, read and settled by itself at the tolerance of a settled
// motion; that of the coverage is the binomial distribution (Wilks 1941), held against many more
// draws. The controls: another form's force, groups of ten draws, and a case without a touch
// nearby.
#define _GNU_SOURCE // sched_setaffinity
#include "base/zeroed.h"
#include "casefile/input.h"
#include "close.h"
#include "run/settle.h"
#include "run/spread.h"
#include "write/spread.h"

#include <sched.h>
#include <stdio.h>
#include <string.h>

static const RunWatch NOBODY = {.progress = NULL};
static const char *const PAPER = "cases/paper/impact-k66.yaml";
static const char *const COMPRESSOR = "cases/mechanisms/compressor.yaml";
static const char *const STACKUP = "cases/paper/stackup-impact.yaml";

// Three digits are shown at the most.
static const double SHOWN = 2e-3;

// A case and its settled motion.
typedef struct Settled {
    char *text;
    size_t size;
    const char *overrides[4];
    size_t count;
    SpreadCase of;
    Scenario scenario;
} Settled;

static void settled_make(const char *path, const char *override, const char *second,
                         Settled *settled)
{
    Err err = {0};
    *settled = (Settled){.overrides = {override, second}};
    settled->count = override == NULL ? 0 : second == NULL ? 1 : 2;
    if (!input_read("case", path, &settled->text, &settled->size, &err)) {
        fail_msg("%s", err.text);
    }
    settled->of =
        (SpreadCase){path, settled->text, settled->size, settled->overrides, settled->count};
    if (!casefile_load_text(path, settled->text, settled->size, settled->overrides, settled->count,
                            &settled->scenario, &err)) {
        fail_msg("%s", err.text);
    }
    settle_scenario(&settled->scenario, NOBODY);
    assert_true(settled->scenario.settled.motion_count > 0);
}

static void settled_finish(Settled *settled)
{
    scenario_free(&settled->scenario);
    free(settled->text);
}

static Spread spread_of(const Settled *settled, size_t draws, unsigned first, bool has_forms)
{
    const SpreadOptions options = {.draws = draws, .first = first, .has_forms = has_forms};
    return spread_find(&settled->of, &settled->scenario, &options, NOBODY);
}

// The largest force of the pin of a case that is settled by itself, N.
static double truth_of(const char *path, const char *override, const char *second, double scale)
{
    Settled settled;
    settled_make(path, override, second, &settled);
    double force = 0.0;
    if (scale != 1.0) {
        Settling settling = settling_start(&settled.scenario);
        Err err = {0};
        settling.scenario.contact.damping_scale *= scale;
        assert_true(settling_run(&settling, 1e-7, 60, &err));
        assert_true(settling.period > 0);
        for (size_t k = settling.count - settling.period; k < settling.count; k++) {
            for (size_t i = 0; i < settling.scenario.linkage.joint_count; i++) {
                const size_t number = settle_joint_number(i, SETTLE_FORCE);
                force = fmax(force, settling.revolutions[k].numbers[number]);
            }
        }
        settling_finish(&settling);
    } else {
        for (size_t i = 0; i < settled.scenario.linkage.joint_count; i++) {
            force = fmax(force, settled.scenario.settled.motions[0].joints[i].force.headline);
        }
    }
    settled_finish(&settled);
    return force;
}

static const SpreadAnswer *form_of(const Spread *spread, const char *name)
{
    for (size_t i = 0; i < spread->form_count; i++) {
        if (strcmp(spread->forms[i].name, name) == 0) {
            assert_true(spread->forms[i].answers[0].is_there);
            return &spread->forms[i].answers[0];
        }
    }
    fail_msg("no form %s", name);
    return NULL;
}

static void forms_have_the_digits_shown(void **state)
{
    (void)state;
    Settled settled;
    settled_make(STACKUP, NULL, NULL, &settled);
    Spread spread = spread_of(&settled, 2, 0, true);
    const size_t joint = spread.joint;
    const double twice = form_of(&spread, "twice the damping")->forces[joint];
    const double law = form_of(&spread, "law esdu-78035")->forces[joint];
    const double truth = truth_of(STACKUP, NULL, NULL, 2.0);
    assert_close(twice, truth, SHOWN);
    assert_close(law, truth_of(STACKUP, "contact.law=esdu-78035", NULL, 1.0), SHOWN);
    // another form is no truth of it
    assert_true(fabs(law / truth - 1.0) > 10.0 * SHOWN);
    assert_true(spread.form_ranges[joint].low <= law);
    assert_true(spread.form_ranges[joint].high >= twice);
    spread_free(&spread);
    settled_finish(&settled);
}

// Each of some draws is the case with its numbers.
static void draws_are_the_case_with_their_numbers(void **state)
{
    (void)state;
    enum { DRAWS = 6 };
    static const char *const LIMITS = "drive.speed=1450 +- 150 rpm";
    static const char *const PLAY = "joints.rod-slider.radial-clearance=40 um +10/-20 um";
    Settled settled;
    settled_make(COMPRESSOR, LIMITS, PLAY, &settled);
    Spread spread = spread_of(&settled, DRAWS, 0, false);
    assert_int_equal(spread.draw_count, DRAWS);
    const double nominal = settled.scenario.settled.motions[0].joints[spread.joint].force.headline;
    size_t judged = 0;
    size_t off = 0;
    for (size_t i = 0; i < DRAWS; i++) {
        const SpreadAnswer *answer = &spread.draws[i].answers[0];
        const char *overrides[16];
        char texts[16][256];
        for (size_t k = 0; k < spread.inputs.count; k++) {
            const SpreadInput *input = &spread.inputs.inputs[k];
            assert_true(spread.draws[i].values[k] >= input->nominal + input->lower);
            assert_true(spread.draws[i].values[k] <= input->nominal + input->upper);
            snprintf(texts[k], sizeof texts[k], "%s=%.17g %s", input->key,
                     spread.draws[i].values[k], input->unit);
            overrides[k] = texts[k];
        }
        Scenario scenario;
        Err err = {0};
        if (!casefile_load(COMPRESSOR, overrides, spread.inputs.count, &scenario, &err)) {
            fail_msg("%s", err.text);
        }
        settle_scenario(&scenario, NOBODY);
        const SettledMotion *motion = &scenario.settled.motions[0];
        if (scenario.settled.motion_count == 1 && motion->period > 0 && answer->period > 0) {
            assert_close(answer->forces[spread.joint], motion->joints[spread.joint].force.headline,
                         SHOWN);
            // the case itself is no truth of it
            off += fabs(answer->forces[spread.joint] / nominal - 1.0) > 2.0 * SHOWN ? 1 : 0;
            judged++;
        }
        scenario_free(&scenario);
    }
    assert_int_equal(judged, DRAWS);
    assert_true(off >= DRAWS / 2);
    spread_free(&spread);
    settled_finish(&settled);
}

// The mean share that groups of draws leave within their range, of all the others.
static double covered_by(const double *forces, size_t count, size_t size, size_t *covering)
{
    double mean = 0.0;
    size_t groups = 0;
    *covering = 0;
    for (size_t from = 0; from + size <= count; from += size) {
        double low = INFINITY;
        double high = -INFINITY;
        size_t within = 0;
        for (size_t i = from; i < from + size; i++) {
            low = fmin(low, forces[i]);
            high = fmax(high, forces[i]);
        }
        for (size_t i = 0; i < count; i++) {
            within += forces[i] >= low && forces[i] <= high ? 1 : 0;
        }
        const double share = (double)(within - size) / (double)(count - size);
        mean += share;
        *covering += share >= 0.9 ? 1 : 0;
        groups++;
    }
    return mean / (double)groups;
}

// Of n independent draws the mean share is (n - 1) / (n + 1), with a variance of 2 (n - 1) over
// (n + 1)^2 (n + 2), whatever the distribution; here that of a force that jumps.
static void the_range_covers_what_is_claimed(void **state)
{
    (void)state;
    enum { DRAWS = 12 * SPREAD_DRAWS, GROUPS = 12, CONTROL = 10 };
    Settled settled;
    settled_make(PAPER, NULL, NULL, &settled);
    Spread spread = spread_of(&settled, DRAWS, 1000, false);
    assert_int_equal(spread.draw_count, DRAWS);
    double *forces = zeroed(DRAWS, sizeof *forces);
    for (size_t i = 0; i < DRAWS; i++) {
        forces[i] = spread.draws[i].answers[0].forces[spread.joint];
    }
    const double n = SPREAD_DRAWS;
    const double claimed = (n - 1.0) / (n + 1.0);
    const double error = sqrt(2.0 * (n - 1.0) / ((n + 1.0) * (n + 1.0) * (n + 2.0)) / GROUPS);
    size_t covering;
    const double share = covered_by(forces, DRAWS, SPREAD_DRAWS, &covering);
    assert_near(share, claimed, 3.0 * error);
    // 0.905 of them: fewer than 8 of 12 have a probability of 0.004
    assert_near(spread_confidence(SPREAD_DRAWS), 0.9047, 1e-4);
    assert_true(covering >= 8);
    assert_true(covered_by(forces, DRAWS, CONTROL, &covering) < claimed - 3.0 * error);
    free(forces);
    spread_free(&spread);
    settled_finish(&settled);
}

static bool finds_touch(const char *override, double *at)
{
    Settled settled;
    settled_make(PAPER, override, NULL, &settled);
    Spread spread = spread_of(&settled, SPREAD_DRAWS, 0, true);
    const bool is_there = spread.touch.is_there;
    if (is_there) {
        const SpreadInput *input = &spread.inputs.inputs[spread.touch.input];
        *at = spread.touch.at / input->nominal - 1.0;
        assert_true(spread.touch.force < 2200.0);
        assert_near(spread.touch.impacts, 2.0, 1e-12);
    }
    spread_free(&spread);
    settled_finish(&settled);
    return is_there;
}

// A second touch begins between restitutions of .907 and .908 (2381 N before, 2109 N after, each
// settled by itself). Far below none does.
static void a_touch_nearby_is_said(void **state)
{
    (void)state;
    double at = 0.0;
    assert_true(finds_touch("contact.restitution=0.900", &at));
    assert_near(at, 0.0083, 5e-4);
    assert_true(finds_touch("contact.restitution=0.906", &at));
    assert_true(fabs(at) < 0.01);
    assert_false(finds_touch("contact.restitution=0.82", &at));
}

// One processor and all of them come to the same bits.
static void processors_change_no_number(void **state)
{
    (void)state;
    enum { DRAWS = 8 };
    cpu_set_t before;
    cpu_set_t one;
    Settled settled;
    settled_make(PAPER, NULL, NULL, &settled);
    assert_int_equal(sched_getaffinity(0, sizeof before, &before), 0);
    Spread many = spread_of(&settled, DRAWS, 0, true);
    CPU_ZERO(&one);
    for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; i++) {
        if (CPU_ISSET(i, &before)) {
            CPU_SET(i, &one);
        }
    }
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    Spread single = spread_of(&settled, DRAWS, 0, true);
    assert_int_equal(sched_setaffinity(0, sizeof before, &before), 0);
    const size_t joints = settled.scenario.linkage.joint_count;
    assert_memory_equal(many.ranges, single.ranges, joints * sizeof *many.ranges);
    assert_memory_equal(many.form_ranges, single.form_ranges, joints * sizeof *many.form_ranges);
    assert_memory_equal(many.ranks, single.ranks, many.inputs.count * sizeof *many.ranks);
    assert_memory_equal(&many.touch.at, &single.touch.at, sizeof many.touch.at);
    spread_free(&many);
    spread_free(&single);
    settled_finish(&settled);
}

// A budget that is spent leaves draws out, and says how many were made.
static void a_budget_ends_the_draws(void **state)
{
    (void)state;
    Settled settled;
    settled_make(PAPER, NULL, NULL, &settled);
    const SpreadOptions options = {.draws = 2000, .budget_s = 0.2};
    Spread spread = spread_find(&settled.of, &settled.scenario, &options, NOBODY);
    assert_true(spread.is_spent);
    assert_true(spread.draw_count > 1 && spread.draw_count < 2000);
    spread_free(&spread);
    settled_finish(&settled);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forms_have_the_digits_shown),
        cmocka_unit_test(draws_are_the_case_with_their_numbers),
        cmocka_unit_test(the_range_covers_what_is_claimed),
        cmocka_unit_test(a_touch_nearby_is_said),
        cmocka_unit_test(processors_change_no_number),
        cmocka_unit_test(a_budget_ends_the_draws),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
