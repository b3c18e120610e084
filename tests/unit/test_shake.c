// Does shaking round every input anew, and leave everything else alone?
#include "kept.h"
#include "load_case.h"
#include "model/shake.h"
#include "run/spikes.h"

#include <string.h>

static double ulps_apart(double a, double b)
{
    return fabs(a - b) / (nextafter(fabs(a), INFINITY) - fabs(a));
}

static void each_number_moves_by_a_unit_in_the_last_place_at_most(void **state)
{
    (void)state;
    const Scenario still = load("cases/paper/impact-k66.yaml", NULL, 0);
    size_t moved = 0;
    for (unsigned seed = 1; seed <= 20; seed++) {
        Scenario shaken = kept_copy(&still);
        shake_inputs(&shaken, seed);
        const double *const pairs[][2] = {
            {&still.contact.stiffness, &shaken.contact.stiffness},
            {&still.contact.restitution, &shaken.contact.restitution},
            {&still.gravity.y, &shaken.gravity.y},
            {&still.run.step, &shaken.run.step},
            {&still.linkage.bodies[1].mass, &shaken.linkage.bodies[1].mass},
            {&still.linkage.joints[1].clearance.hole_radius,
             &shaken.linkage.joints[1].clearance.hole_radius},
        };
        for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
            assert_true(ulps_apart(*pairs[i][0], *pairs[i][1]) <= 1.0);
            moved += *pairs[i][0] != *pairs[i][1] ? 1 : 0;
        }
        // what chooses something, and zeros, stay
        assert_true(shaken.contact.exponent == 1.5);
        assert_true(shaken.contact.friction == 0.0 && shaken.linkage.driver.start == 0.0);
        assert_int_equal(shaken.run.samples, still.run.samples);
    }
    // two of three of 120 numbers move: 80, with a standard deviation of 5
    assert_in_range(moved, 60, 100);
}

static bool is_alike(const Scenario *one, const Scenario *other)
{
    Scenario shared = *other;
    const Linkage *linkage = &other->linkage;
    shared.linkage.bodies = one->linkage.bodies;
    shared.linkage.joints = one->linkage.joints;
    shared.linkage.springs = one->linkage.springs;
    shared.linkage.torsions = one->linkage.torsions;
    shared.linkage.bushings = one->linkage.bushings;
    shared.linkage.loads = one->linkage.loads;
    shared.linkage.further = one->linkage.further;
    shared.linkage.profiles = one->linkage.profiles;
    return memcmp(one, &shared, sizeof shared) == 0 &&
           memcmp(one->linkage.bodies, linkage->bodies,
                  linkage->body_count * sizeof *linkage->bodies) == 0 &&
           memcmp(one->linkage.joints, linkage->joints,
                  linkage->joint_count * sizeof *linkage->joints) == 0;
}

static void equal_seeds_shake_alike_and_others_do_not(void **state)
{
    (void)state;
    const Scenario still = load("cases/paper/impact-k66.yaml", NULL, 0);
    Scenario first = kept_copy(&still);
    Scenario second = kept_copy(&still);
    Scenario third = kept_copy(&still);
    shake_inputs(&first, 1);
    shake_inputs(&second, 1);
    shake_inputs(&third, 2);
    assert_true(is_alike(&first, &second));
    assert_false(is_alike(&first, &third));
}

// The points of a cam move by a unit in the last place at most, and the curve with them.
static void a_profile_is_shaken(void **state)
{
    (void)state;
    const Scenario still = load("cases/mechanisms/cam-roller.yaml", NULL, 0);
    Scenario shaken = kept_copy(&still);
    shake_inputs(&shaken, 3);
    const Profile *before = &still.linkage.profiles[0];
    const Profile *now = &shaken.linkage.profiles[0];
    int moved = 0;
    for (size_t i = 0; i < before->count; i++) {
        assert_true(ulps_apart(before->radii[i], now->radii[i]) <= 1.0);
        moved += before->radii[i] != now->radii[i] ? 1 : 0;
    }
    // two in three of 72
    assert_in_range(moved, 32, 64);
    assert_true(memcmp(before->slopes, now->slopes, sizeof now->slopes) != 0);
    assert_near(profile_at(now, 1.0).r, profile_at(before, 1.0).r, 1e-16);
}

static void a_perfect_bounce_gives_back_no_more_than_all(void **state)
{
    (void)state;
    Scenario scenario = load_with("cases/paper/impact-k66.yaml", "contact.restitution=1");
    for (unsigned seed = 1; seed <= 20; seed++) {
        Scenario shaken = kept_copy(&scenario);
        shake_inputs(&shaken, seed);
        assert_true(shaken.contact.restitution <= 1.0);
    }
}

// The parallelogram's four joints lie on one line twice a turn: rounding must not decide whether it
// gets past that.
static void a_linkage_at_a_change_point_has_no_scale_of_spikes_however_it_is_rounded(void **state)
{
    (void)state;
    const Scenario parallelogram = load("cases/literature/parallelogram.yaml", NULL, 0);
    const Scenario four_bar = load("cases/paper/impact-k66.yaml", NULL, 0);
    assert_false(spike_scale(&parallelogram).is_known);
    const double alpha = spike_scale(&four_bar).alpha;
    // of 6000 seeds eight got past the change point where pivots of 1e-9 were taken for free ones,
    // with accelerations of 6e9 rad/s^2; these three among them
    const unsigned seeds[] = {1, 2, 3, 5068, 5298, 5655};
    for (size_t i = 0; i < sizeof seeds / sizeof seeds[0]; i++) {
        Scenario shaken = kept_copy(&parallelogram);
        shake_inputs(&shaken, seeds[i]);
        assert_false(spike_scale(&shaken).is_known);
        // a linkage that goes round has a scale, and it stays
        shaken = kept_copy(&four_bar);
        shake_inputs(&shaken, seeds[i]);
        assert_true(spike_scale(&shaken).is_known);
        assert_close(spike_scale(&shaken).alpha, alpha, 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_number_moves_by_a_unit_in_the_last_place_at_most),
        cmocka_unit_test(equal_seeds_shake_alike_and_others_do_not),
        cmocka_unit_test(a_profile_is_shaken),
        cmocka_unit_test(a_perfect_bounce_gives_back_no_more_than_all),
        cmocka_unit_test(a_linkage_at_a_change_point_has_no_scale_of_spikes_however_it_is_rounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
