// Is a number of a run the same wherever it is named, and none where a solver does not tell it?
#include "measure/number_values.h"

#include "complete_run.h"
#include "mechanism.h"

#include <stdio.h>

// What a number is called in one place, the two words together.
typedef struct Name {
    const char *first;
    char last[128];
} Name;

static bool is_same(const Name *a, const Name *b)
{
    return strcmp(a->first, b->first) == 0 && strcmp(a->last, b->last) == 0;
}

// How many pairs of numbers that stand in a place have one name there.
static size_t count_doubles(unsigned place, Name (*name)(const Number *))
{
    size_t doubles = 0;
    for (NumberId a = 0; a < NUMBER_COUNT; a++) {
        for (NumberId b = a + 1; b < NUMBER_COUNT; b++) {
            const Name one = name(&NUMBERS[a]);
            const Name other = name(&NUMBERS[b]);
            doubles += (NUMBERS[a].places & NUMBERS[b].places & place) != 0 && is_same(&one, &other)
                           ? 1
                           : 0;
        }
    }
    return doubles;
}

static Name path_of(const Number *number)
{
    const NumberOwnerRow *owner = &NUMBER_OWNERS[number->owner];
    Name name = {.first = owner->path};
    snprintf(name.last, sizeof name.last, "%s%s", owner->before, number->name);
    return name;
}

static Name column_of(const Number *number)
{
    static const char *const MEMBERS[] = {
        [NUMBER_OF_WHOLE] = "", [NUMBER_OF_BODIES] = "body", [NUMBER_OF_JOINTS] = "joint"};
    Name name = {.first = MEMBERS[number_members(number)]};
    snprintf(name.last, sizeof name.last, "%s", number->columns[NUMBER_PUSHED]);
    return name;
}

static Name kind_of(const Number *number)
{
    Name name = {.first = ""};
    snprintf(name.last, sizeof name.last, "%d", (int)number->kind);
    return name;
}

static void no_two_numbers_have_one_name(void **state)
{
    (void)state;
    assert_int_equal(count_doubles(NUMBER_EXPECT, path_of), 0);
    assert_int_equal(count_doubles(NUMBER_STUDY, column_of), 0);
    // the control: what many share
    assert_true(count_doubles(NUMBER_STUDY, kind_of) > 0);
}

// Of a run by a backend how many of its numbers that every complete run has are not finite.
static size_t count_lacking(const Scenario *scenario, const Trajectory *run, unsigned without)
{
    const NumberSource source = {.scenario = scenario, .run = run};
    size_t lacking = 0;
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const Number *number = &NUMBERS[id];
        const bool is_of_run =
            number->owner != NUMBER_OWNER_ERROR && number->owner != NUMBER_OWNER_TRUTH;
        for (size_t i = 0; i < number_member_count(number->owner, &scenario->linkage); i++) {
            if (is_of_run && (number->traits & (NUMBER_LACKED | without)) == 0 &&
                number_is_of(number, &scenario->linkage, i)) {
                lacking += isfinite(number_find(id, &source, i).value) ? 0 : 1;
            }
        }
    }
    return lacking;
}

static void every_backend_has_what_every_run_has(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_loose(1);
    Trajectory *exact = complete_run(&scenario, BACKEND_ANALYTIC);
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    // a closed form has no play, and none of its numbers; the control: they are lacking
    assert_int_equal(count_lacking(&scenario, exact, NUMBER_PLAY), 0);
    assert_true(count_lacking(&scenario, exact, 0) > 0);
    assert_int_equal(count_lacking(&scenario, ode, 0), 0);
    // a run that failed has none
    exact->is_complete = false;
    const NumberSource source = {.scenario = &scenario, .run = exact};
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        assert_true(isnan(number_find(id, &source, 1).value));
    }
    trajectory_destroy(exact);
    trajectory_destroy(ode);
}

// What a solver does not count is no number, and not 0.
static void what_is_not_counted_is_not_zero(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_loose(1);
    Trajectory *run = complete_run(&scenario, BACKEND_ANALYTIC);
    NumberSource source = {.scenario = &scenario, .run = run};
    assert_true(isnan(number_find(NUMBER_COST_EVALUATIONS, &source, 0).value));
    assert_true(isnan(number_find(NUMBER_RUN_IMPACTS, &source, 0).value));
    assert_true(isnan(number_find(NUMBER_COST_STEP, &source, 0).value));
    run->evaluations = 7; // the control
    assert_true(number_find(NUMBER_COST_EVALUATIONS, &source, 0).value == 7.0);
    trajectory_destroy(run);
}

// The reactions of ideal joints are those at the samples, which the series has: the largest of
// every step is no smaller, and not by much.
static void ideal_joints_have_their_largest_reaction(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_loose(1);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const NumberSource source = {.scenario = &scenario, .run = run};
    const NumberSource sampled = {.scenario = &scenario, .run = run, .is_at_samples = true};
    for (size_t i = 0; i < run->joint_count; i++) {
        if (linkage_has_play(&run->linkage.joints[i])) {
            continue;
        }
        double largest = 0.0;
        for (size_t k = 0; k < run->sample_count; k++) {
            const Vec2 force = trajectory_state(run, k, i)->force_on_b;
            largest = fmax(largest, hypot(force.x, force.y));
        }
        const double at_samples = number_find(NUMBER_JOINT_FORCE_MAX, &sampled, i).value;
        const double of_steps = number_find(NUMBER_JOINT_FORCE_MAX, &source, i).value;
        assert_true(largest > 0.0);
        assert_true(fabs(at_samples - largest) <= 1e-12 * largest);
        assert_true(of_steps >= largest * (1.0 - 1e-12));
    }
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_two_numbers_have_one_name),
        cmocka_unit_test(every_backend_has_what_every_run_has),
        cmocka_unit_test(what_is_not_counted_is_not_zero),
        cmocka_unit_test(ideal_joints_have_their_largest_reaction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
