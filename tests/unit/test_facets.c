// Does the polygon that stands for a hole follow from play and depth as it is said to?
#include "close.h"

#include "contact/facets.h"
#include "mechanism.h"

#include <string.h>

static const double RADIUS = 5e-3;

// The paper's mechanism with that radial play.
static Scenario with_play(double play)
{
    Scenario scenario = mechanism_loose(1);
    for (size_t i = 0; i < scenario.linkage.joint_count; i++) {
        Clearance *clearance = &scenario.linkage.joints[i].clearance;
        if (scenario.linkage.joints[i].kind == JOINT_CLEARANCE) {
            clearance->pin_radius = clearance->hole_radius - play;
        }
    }
    return scenario;
}

static int joint_of(const Scenario *scenario)
{
    int joint = 0;
    while (scenario->linkage.joints[joint].kind != JOINT_CLEARANCE) {
        joint++;
    }
    return joint;
}

static void the_sagitta_is_the_circles_distance_from_the_polygon(void **state)
{
    (void)state;
    for (size_t count = 8; count <= 4096; count *= 8) {
        const double half = M_PI / (double)count;
        const Facets outside = facets_polygon(ODE_CIRCUMSCRIBED, count, RADIUS);
        const Facets inside = facets_polygon(ODE_INSCRIBED, count, RADIUS);
        assert_near(outside.inradius, RADIUS, 0.0);
        assert_near(inside.inradius + inside.sagitta, RADIUS, 1e-17);
        // its corners beyond the circle
        assert_near(RADIUS / cos(half) - RADIUS, outside.sagitta, 1e-17);
        const double rule = 0.5 * RADIUS * half * half;
        assert_near(inside.sagitta / rule, 1.0, half * half / 12.0 + 1e-12);
    }
}

static void one_facet_fewer_would_be_too_few(void **state)
{
    (void)state;
    static const double SAGITTAS[] = {1e-4, 1e-6, 1e-8, 1e-10};
    for (size_t i = 0; i < sizeof SAGITTAS / sizeof *SAGITTAS; i++) {
        const size_t count = facets_needed(RADIUS, SAGITTAS[i]);
        assert_true(facets_polygon(ODE_INSCRIBED, count, RADIUS).sagitta <= SAGITTAS[i]);
        assert_true(facets_polygon(ODE_INSCRIBED, count - 1, RADIUS).sagitta > SAGITTAS[i]);
    }
    assert_int_equal(facets_needed(RADIUS, RADIUS), FACETS_LEAST);
}

// Truth: an undamped Hertzian impact at v^2 = 2 g (2c) is (5 m v^2 / 4K)^(2/5) deep.
static void the_depth_is_that_of_a_fall_through_the_play(void **state)
{
    (void)state;
    const double mass = 0.3;
    const double play = 40e-6;
    const double stiffness = 6.6e10;
    Scenario scenario = mechanism_pin(mass, play);
    scenario.gravity = scenario_downward(9.80665);
    scenario.contact.stiffness = stiffness;
    scenario.contact.exponent = 1.5;
    const double square = -4.0 * scenario.gravity.y * play;
    const double depth = pow(1.25 * mass * square / stiffness, 0.4);
    const int joint = joint_of(&scenario);
    assert_near(facets_expected_depth(&scenario, joint) / depth, 1.0, 1e-4);
    // nothing falls: the play alone counts
    scenario.gravity = scenario_downward(0.0);
    assert_near(facets_expected_depth(&scenario, joint), 0.0, 0.0);
    assert_int_equal(
        facets_of_joint(&scenario, joint).count,
        facets_needed(scenario.linkage.joints[joint].clearance.hole_radius,
                      0.01 * linkage_radial_clearance(&scenario.linkage.joints[joint])));
}

// A collider is refused where it cannot see the contacts, and only there.
static void what_cannot_be_resolved_is_refused(void **state)
{
    (void)state;
    static const struct {
        OdeCollider collider;
        double play;
        bool is_refused;
    } CASES[] = {
        {ODE_COLLIDER_PIN_HOLE, 1e-9, false},  {ODE_COLLIDER_STAVES, 2.5e-6, false},
        {ODE_COLLIDER_STAVES, 2e-11, true},    {ODE_COLLIDER_STAVES_GJK, 2.5e-6, false},
        {ODE_COLLIDER_STAVES_GJK, 5e-9, true}, {ODE_COLLIDER_CONVEX, 14.5e-6, false},
        {ODE_COLLIDER_CONVEX, 2.5e-6, true},   {ODE_COLLIDER_TRIMESH, 2.5e-6, false},
        {ODE_COLLIDER_TRIMESH, 4e-9, true},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        Scenario scenario = with_play(CASES[i].play);
        scenario.ode.collider = CASES[i].collider;
        scenario.ode.facets = 64;
        Err err = {0};
        assert_int_equal(facets_check(&scenario, joint_of(&scenario), &err), !CASES[i].is_refused);
        assert_int_equal(err.kind, CASES[i].is_refused ? ERR_CASE : ERR_NONE);
        assert_true(!CASES[i].is_refused || strstr(err.text, "resolves") != NULL);
    }
}

static void a_pin_must_fit_into_its_polygon(void **state)
{
    (void)state;
    Scenario scenario = with_play(14.5e-6);
    scenario.ode.collider = ODE_COLLIDER_TRIMESH;
    scenario.ode.facets = 32;
    Err err = {0};
    // the corners outside: there is room for any number of sides
    assert_true(facets_check(&scenario, joint_of(&scenario), &err));
    scenario.ode.polygon = ODE_INSCRIBED;
    assert_false(facets_check(&scenario, joint_of(&scenario), &err));
    assert_non_null(strstr(err.text, "does not fit"));
    err = (Err){0};
    scenario.ode.facets = 64;
    assert_true(facets_check(&scenario, joint_of(&scenario), &err));
}

static void more_facets_than_there_can_be_are_refused(void **state)
{
    (void)state;
    Scenario scenario = with_play(2e-9);
    scenario.ode.collider = ODE_COLLIDER_STAVES;
    Err err = {0};
    assert_false(facets_check(&scenario, joint_of(&scenario), &err));
    assert_non_null(strstr(err.text, "at most 16384"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_sagitta_is_the_circles_distance_from_the_polygon),
        cmocka_unit_test(one_facet_fewer_would_be_too_few),
        cmocka_unit_test(the_depth_is_that_of_a_fall_through_the_play),
        cmocka_unit_test(what_cannot_be_resolved_is_refused),
        cmocka_unit_test(a_pin_must_fit_into_its_polygon),
        cmocka_unit_test(more_facets_than_there_can_be_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
