// Does `jointplay study slurm` write scripts that can be run, and refuse what could not be?
#include "program.h"

#include <sys/stat.h>

static void write_study(const Program *program, const char *name)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream,
            "title: Six runs\n"
            "case: %s/paper/ideal-nominal.yaml\n"
            "vary:\n"
            "  drive.speed: [300 rpm, 600 rpm, 900 rpm]\n"
            "  run.step: [100 us, 50 us]\n",
            getenv("JOINTPLAY_CASES"));
    fclose(stream);
}

static void read_file(Program *program, const char *name, char *target)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    program_read(path, target);
}

static void three_scripts_that_can_be_run_are_written(void **state)
{
    Program *program = *state;
    static const char *const NAMES[] = {"six.array.sh", "six.gather.sh", "six.submit.sh"};
    write_study(program, "six.yaml");
    program_run(program, "study slurm six.yaml --shards 3 --cpus 4 --time 1-6 --mem 8G");
    assert_int_equal(program->status, 0);
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
        char path[PROGRAM_PATH_SIZE];
        struct stat status;
        program_path(program, NAMES[i], path);
        assert_int_equal(stat(path, &status), 0);
        assert_true((status.st_mode & S_IXUSR) != 0);
        assert_says(program->errors, NAMES[i]);
    }
    // what is to be typed, and nothing else
    assert_says(program->output, "/six.submit.sh\n");
    assert_int_equal(program->output[0], '/');
    read_file(program, "six.array.sh", program->output);
    assert_says(program->output, "\n#SBATCH --array=1-3\n");
    assert_says(program->output, "\n#SBATCH --time=1-6\n");
}

// The folder of the scripts is that of the stores, wherever the study stands and whoever begins.
static void scripts_go_where_they_are_asked_to(void **state)
{
    Program *program = *state;
    write_study(program, "it's six.yaml");
    program_run(program, "study slurm \"it's six.yaml\" --shards 2 --out 'a b/c' --quiet");
    assert_int_equal(program->status, 0);
    assert_string_equal(program->errors, "");
    read_file(program, "a b/c/it's six.array.sh", program->output);
    assert_says(program->output, "/a b/c'\n");
    assert_says(program->output, "/it'\"'\"'s six.yaml'\n");
    assert_says(program->output, "#SBATCH --job-name=it_s_six\n");
}

static void a_dry_run_prints_the_scripts_and_writes_nothing(void **state)
{
    Program *program = *state;
    write_study(program, "six.yaml");
    program_run(program, "study slurm six.yaml --shards 6 --dry-run");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "==> six.array.sh <==\n#!/bin/bash\n");
    assert_says(program->output, "==> six.gather.sh <==\n#!/bin/bash\n");
    assert_says(program->output, "==> six.submit.sh <==\n#!/bin/bash\n");
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "six.array.sh", path);
    assert_int_equal(access(path, F_OK), -1);
}

static void numbers_of_shards_that_make_no_sense_are_refused(void **state)
{
    Program *program = *state;
    write_study(program, "six.yaml");
    program_fails_usage(program, "study slurm six.yaml", "--shards N");
    program_fails_usage(program, "study slurm six.yaml --shards 0", "from 2 to 10000");
    program_fails_usage(program, "study slurm six.yaml --shards 1", "from 2 to 10000");
    program_fails_usage(program, "study slurm six.yaml --shards -3", "from 2 to 10000");
    program_fails_usage(program, "study slurm six.yaml --shards 2.5", "from 2 to 10000");
    program_fails_usage(program, "study slurm six.yaml --shards 7", "the study has 6 runs");
}

static void what_slurm_would_not_take_is_refused(void **state)
{
    Program *program = *state;
    write_study(program, "six.yaml");
    program_fails_usage(program, "study slurm six.yaml --shards 2 --time soon", "DAYS-HOURS");
    program_fails_usage(program, "study slurm six.yaml --shards 2 --time 3", "5 minutes and more");
    program_fails_usage(program, "study slurm six.yaml --shards 2 --mem 4GB", "--mem is 4GB");
    program_fails_usage(program, "study slurm six.yaml --shards 2 --cpus 0", "from 1 to");
    program_fails_usage(program, "study slurm six.yaml --shards 2 --account 'a b'", "--account is");
    program_fails_usage(program, "study slurm six.yaml --shards 2 --partition ''",
                        "--partition is");
    program_fails_usage(program, "study slurm six.yaml --shards 2 --requeues 1001", "0 to 1000");
    program_fails_usage(program, "study slurm six.yaml --shrads 2", "did you mean '--shards'?");
    program_fails_usage(program, "study slurm --shards 2", "no study given");
    program_fails_usage(program, "study slurm six.yaml six.yaml --shards 2",
                        "slurm takes one study");
}

static void a_study_that_cannot_be_read_leaves_no_scripts(void **state)
{
    Program *program = *state;
    program_run(program, "study slurm none.yaml --shards 2 --out there");
    assert_int_equal(program->status, 5);
    // a case in place of a study is a wrong command
    program_fails_usage(program,
                        "study slurm $cases/paper/ideal-nominal.yaml --shards 2 --out there",
                        "jointplay run ");
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "there", path);
    assert_int_equal(access(path, F_OK), -1);
    write_study(program, "six.yaml");
    program_run(program, "study slurm six.yaml --shards 2 --out six.yaml/there");
    assert_int_equal(program->status, 5);
}

static void the_help_tells_its_options(void **state)
{
    Program *program = *state;
    program_run(program, "study slurm --help");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "--shards=N");
    assert_says(program->output, "--requeues=N");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(three_scripts_that_can_be_run_are_written, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(scripts_go_where_they_are_asked_to, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_dry_run_prints_the_scripts_and_writes_nothing,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(numbers_of_shards_that_make_no_sense_are_refused,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(what_slurm_would_not_take_is_refused, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_study_that_cannot_be_read_leaves_no_scripts,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(the_help_tells_its_options, program_set_up,
                                        program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
