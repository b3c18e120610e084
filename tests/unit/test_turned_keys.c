// Do keys of what turns end in its units, and no others change?
#include "write/json_value.h"

#include "close.h"
#include <stdlib.h>

static void a_unit_becomes_that_of_what_turns(void **state)
{
    (void)state;
    static const char *const KEYS[][2] = {
        {"force_max_N", "force_max_N_m"},
        {"impulse_N_s", "impulse_N_m_s"},
        {"penetration_max_m", "penetration_max_rad"},
        {"speed_m_s", "speed_rad_s"},
        {"mass_kg", "mass_kg_m2"},
        {"inverse_mass_1_kg", "inverse_mass_1_kg_m2"},
        {"stiffness_N_m", "stiffness_N_m_rad"},
        {"damping_N_s_m", "damping_N_m_s_rad"},
        {"cfm_m_N_s", "cfm_rad_N_m_s"},
        // the controls: no unit of the kind
        {"step_s", "step_s"},
        {"erp", "erp"},
        {"m", "m"},
        {"_m", "_m"},
    };
    for (size_t i = 0; i < sizeof KEYS / sizeof *KEYS; i++) {
        char turned[TURNED_KEY_SIZE];
        turned_key(KEYS[i][0], turned);
        assert_string_equal(turned, KEYS[i][1]);
    }
}

static void all_objects_of_a_value_have_such_keys_in_their_order(void **state)
{
    (void)state;
    json_t *value =
        torsional_keys(json_pack("{s:f, s:[{s:f, s:s}], s:{s:n}}", "mass_kg", 2.0, "rows",
                                 "force_max_N", 3.0, "word", "force_N", "asked", "depth_m"));
    char *text = json_dumps(value, JSON_COMPACT);
    assert_string_equal(text, "{\"mass_kg_m2\":2.0,\"rows\":[{\"force_max_N_m\":3.0,\"word\":"
                              "\"force_N\"}],\"asked\":{\"depth_rad\":null}}");
    free(text);
    json_decref(value);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_unit_becomes_that_of_what_turns),
        cmocka_unit_test(all_objects_of_a_value_have_such_keys_in_their_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
