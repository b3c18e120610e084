// Is each mistake in a study file told in the words, and at the place, that its row of
// tests/bad/studies.txt holds?
//
// Runs in the source root.
#include "commands/study/spec.h"

#include "bad_table.h"

// Whether a study is accepted; where it is not, nothing is changed.
static bool open_study(const char *path, Err *err)
{
    static const Spec EMPTY;
    Spec spec;
    if (spec_read(path, &spec, err)) {
        spec_finish(&spec);
        return true;
    }
    assert_memory_equal(&spec, &EMPTY, sizeof spec);
    return false;
}

int main(int argc, char **argv)
{
    return bad_table_run(argc, argv, "tests/bad/studies.txt", open_study);
}
