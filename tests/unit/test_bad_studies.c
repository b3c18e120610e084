// Is each mistake in a study file told in the words, and at the place, that
// tests/bad_study/NAME.expected holds?
//
// Runs in the source root. One test a file; a .yaml without its .expected is a failure.
#include "commands/study/spec.h"

#include "bad_files.h"

static void check_message(void **state)
{
    const char *path = *state;
    static const Spec EMPTY;
    Spec spec;
    Err err = {0};
    assert_false(spec_read(path, &spec, &err));
    bad_files_check(path, &err);
    assert_memory_equal(&spec, &EMPTY, sizeof spec);
}

int main(int argc, char **argv)
{
    return bad_files_run(argc, argv, "tests/bad_study/*.yaml", check_message);
}
