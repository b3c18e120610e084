// Is each mistake told in the words, and at the place, that tests/bad/NAME.expected holds?
//
// Runs in the source root. One test a file; a .yaml without its .expected is a failure.
#include "casefile/casefile.h"

#include "bad_files.h"

static void check_message(void **state)
{
    const char *path = *state;
    Scenario scenario = scenario_default();
    const Scenario before = scenario;
    Err err = {0};
    assert_false(casefile_load(path, NULL, 0, &scenario, &err));
    bad_files_check(path, &err);
    assert_memory_equal(&scenario, &before, sizeof scenario);
}

int main(int argc, char **argv)
{
    return bad_files_run(argc, argv, "tests/bad/*.yaml", check_message);
}
