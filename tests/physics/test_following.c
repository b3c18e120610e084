// Does a run that starts in the motion of its neighbour come to a motion of its own?
//
// Where there is one motion at each speed, as with a resting speed, a chain of speeds from below
// and one from above come to the same, which is that of a case that is settled by itself. The
// control is the law that remembers its impacts: it has many motions, and the two chains keep to
// their own. What is followed may be a speed, or sizes that the start has to be fitted to.
#include "load_case.h"

#include "kept.h"

#include "run/settle.h"

static const char *const CASE = "cases/paper/impact-k66.yaml";
static const RunWatch NOBODY = {.progress = NULL};

enum { LINKS = 4 };

// Settles a case along values of a key, each from the one before; the largest force at the last, N.
static double force_along(const char *law, const char *const *values, int count, bool *are_followed)
{
    Scenario before = {.point_count = 0};
    double force = 0.0;
    *are_followed = true;
    for (int i = 0; i < count; i++) {
        const char *overrides[] = {law, values[i], "run.start=settled"};
        Scenario scenario = load(CASE, overrides, 3);
        if (i == 0) {
            settle_scenario(&scenario, NOBODY);
        } else {
            *are_followed = *are_followed && settle_follow(&scenario, &before, NOBODY);
        }
        kept_settled(&scenario);
        assert_true(scenario.settled.motion_count > 0);
        force = 0.0;
        for (size_t k = 0; k < scenario.linkage.joint_count; k++) {
            force = fmax(force, scenario.settled.motions[0].joints[k].force.headline);
        }
        before = scenario;
    }
    return force;
}

static double force_alone(const char *law, const char *value)
{
    bool are_followed;
    return force_along(law, &value, 1, &are_followed);
}

static const char *const UP[LINKS] = {"drive.speed=900 rpm", "drive.speed=940 rpm",
                                      "drive.speed=980 rpm", "drive.speed=1000 rpm"};
static const char *const DOWN[LINKS] = {"drive.speed=1100 rpm", "drive.speed=1060 rpm",
                                        "drive.speed=1020 rpm", "drive.speed=1000 rpm"};

// The forces at one value, come to from below and from above.
static void force_both_ways(const char *law, double *up, double *down)
{
    bool is_up;
    bool is_down;
    *up = force_along(law, UP, LINKS, &is_up);
    *down = force_along(law, DOWN, LINKS, &is_down);
    assert_true(is_up && is_down);
}

static void one_motion_is_come_to_from_both_sides(void **state)
{
    (void)state;
    static const char LAW[] = "contact.resting-speed=50 mm/s";
    double up;
    double down;
    force_both_ways(LAW, &up, &down);
    assert_close(up, down, 1e-6);
    assert_close(up, force_alone(LAW, "drive.speed=1000 rpm"), 1e-6);
    // at another speed the force is another
    assert_true(fabs(force_alone(LAW, "drive.speed=980 rpm") / up - 1.0) > 1e-2);
}

static void a_law_with_a_memory_keeps_to_where_it_came_from(void **state)
{
    (void)state;
    static const char LAW[] = "contact.resting-speed=none";
    double up;
    double down;
    force_both_ways(LAW, &up, &down);
    print_message("# %.1f N from below, %.1f N from above\n", up, down);
    assert_true(fabs(up / down - 1.0) > 1e-3);
}

static void a_start_is_fitted_to_other_sizes(void **state)
{
    (void)state;
    static const char LAW[] = "contact.resting-speed=50 mm/s";
    static const char *const LENGTHS[LINKS] = {
        "four-bar.coupler.length=279.0 mm", "four-bar.coupler.length=279.2 mm",
        "four-bar.coupler.length=279.3 mm", "four-bar.coupler.length=279.4 mm"};
    static const char *const MASSES[LINKS] = {
        "four-bar.coupler.mass=0.20 kg", "four-bar.coupler.mass=0.23 kg",
        "four-bar.coupler.mass=0.26 kg", "four-bar.coupler.mass=0.29 kg"};
    bool are_followed;
    const double by_length = force_along(LAW, LENGTHS, LINKS, &are_followed);
    assert_true(are_followed);
    assert_close(by_length, force_alone(LAW, LENGTHS[LINKS - 1]), 1e-6);
    const double by_mass = force_along(LAW, MASSES, LINKS, &are_followed);
    assert_true(are_followed);
    assert_close(by_mass, force_alone(LAW, MASSES[LINKS - 1]), 1e-6);
    assert_true(fabs(force_alone(LAW, MASSES[LINKS - 2]) / by_mass - 1.0) > 1e-2);
}

// In less play than the neighbour's, and in more, a pin stands as far along its way to the wall.
static void a_start_is_fitted_to_other_play(void **state)
{
    (void)state;
    static const char LAW[] = "contact.resting-speed=50 mm/s";
    const char *const plays[LINKS] = {
        "joints.crank-coupler.hole=10.05 mm", "joints.crank-coupler.hole=10.02 mm",
        "joints.crank-coupler.hole=10.035 mm", "joints.crank-coupler.hole=10.029 mm"};
    bool are_followed;
    const double force = force_along(LAW, plays, LINKS, &are_followed);
    assert_true(are_followed);
    assert_close(force, force_alone(LAW, plays[LINKS - 1]), 1e-6);
    assert_true(fabs(force_alone(LAW, plays[LINKS - 2]) / force - 1.0) > 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_motion_is_come_to_from_both_sides),
        cmocka_unit_test(a_law_with_a_memory_keeps_to_where_it_came_from),
        cmocka_unit_test(a_start_is_fitted_to_other_sizes),
        cmocka_unit_test(a_start_is_fitted_to_other_play),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
