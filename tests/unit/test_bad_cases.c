// Is each mistake told in the words, and at the place, that its row of tests/bad/cases.txt holds?
//
// Runs in the source root.
#include "casefile/casefile.h"

#include "bad_table.h"

// Whether a case is accepted; where it is not, nothing is changed.
static bool open_case(const char *path, Err *err)
{
    Scenario scenario = scenario_default();
    const Scenario before = scenario;
    if (casefile_load(path, NULL, 0, &scenario, err)) {
        scenario_free(&scenario);
        return true;
    }
    assert_memory_equal(&scenario, &before, sizeof scenario);
    return false;
}

int main(int argc, char **argv)
{
    return bad_table_run(argc, argv, "tests/bad/cases.txt", open_case);
}
