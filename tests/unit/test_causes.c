// From which joints with play does a force reach a body of a four-bar?
#include "run/tracer.h"

#include "mechanism.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { CRANK, COUPLER, FOLLOWER };
enum { CRANK_PIN = 1, COUPLER_PIN, FOOT };

static void assert_joints(const Causes *causes, size_t body, size_t count, const int *joints)
{
    assert_int_equal(causes_count(causes, body), count);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(causes_joint(causes, body, i), joints[i]);
    }
}

static void forces_go_through_ideal_joints(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    mechanism_loosen(&scenario, "follower-ground");
    Causes causes = causes_find(&scenario.linkage);
    const int both[] = {CRANK_PIN, FOOT};
    assert_joints(&causes, COUPLER, 2, both);
    assert_joints(&causes, FOLLOWER, 2, both);
    causes_finish(&causes);
    linkage_free(&scenario.linkage);
}

static void they_stop_where_there_is_play(void **state)
{
    (void)state;
    Scenario scenario = mechanism_loose(3);
    Causes causes = causes_find(&scenario.linkage);
    assert_joints(&causes, COUPLER, 2, (const int[]){CRANK_PIN, COUPLER_PIN});
    assert_joints(&causes, FOLLOWER, 2, (const int[]){COUPLER_PIN, FOOT});
    causes_finish(&causes);
    linkage_free(&scenario.linkage);
}

// What presses on the driven body changes how nothing else moves.
static void they_do_not_go_through_the_driven_body(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    Causes causes = causes_find(&scenario.linkage);
    assert_joints(&causes, CRANK, 0, NULL);
    assert_joints(&causes, FOLLOWER, 1, (const int[]){CRANK_PIN});
    causes_finish(&causes);
    linkage_free(&scenario.linkage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_go_through_ideal_joints),
        cmocka_unit_test(they_stop_where_there_is_play),
        cmocka_unit_test(they_do_not_go_through_the_driven_body),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
