// Do the scripts for Slurm say what was asked for, whatever the names, and is what Slurm would not
// take refused?
#include "commands/study/study_slurm.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

// names that would do harm in a shell that took them as they are
static const char *const NASTY[] = {
    "plain", "two words", "it's", "\"quoted\"", "$(false)", "`false`",   "a\\b", "-n",
    "*",     "a\nb",      "%a",   "''",         "!x",       "a;b&c|d>e", "~",    "",
};

static const SlurmJob JOB = {
    .program = "/opt/it's here/jointplay",
    .study = "/home/me/my studies/50 %.yaml",
    .folder = "/scratch/me & co",
    .stem = "50 %",
    .shards = 7,
    .cpus = 3,
    .requeues = 4,
};

static void every_script_is_one_to_bash(void **state)
{
    (void)state;
    for (size_t name = 0; name < sizeof NASTY / sizeof *NASTY; name++) {
        SlurmJob job = JOB;
        job.program = job.study = job.folder = job.stem = NASTY[name];
        for (size_t i = 0; i < SLURM_SCRIPT_COUNT; i++) {
            Text text;
            text_init(&text);
            slurm_write(&job, (SlurmScript)i, &text);
            FILE *shell = popen("bash -n", "w");
            assert_non_null(shell);
            fputs(text.data, shell);
            assert_int_equal(pclose(shell), 0);
            text_finish(&text);
        }
    }
}

static void assert_line(const Text *text, const char *line)
{
    char whole[256];
    snprintf(whole, sizeof whole, "\n%s\n", line);
    if (strstr(text->data, whole) == NULL) {
        fail_msg("no line '%s' in\n%s", line, text->data);
    }
}

static void what_was_asked_for_stands_in_the_array(void **state)
{
    (void)state;
    SlurmJob job = JOB;
    job.time = "1-12:00";
    job.memory = "4G";
    job.partition = "long,short";
    job.account = "p_joints";
    Text text;
    text_init(&text);
    slurm_write(&job, SLURM_ARRAY, &text);
    assert_line(&text, "#SBATCH --array=1-7");
    assert_line(&text, "#SBATCH --cpus-per-task=3");
    assert_line(&text, "#SBATCH --time=1-12:00");
    assert_line(&text, "#SBATCH --mem=4G");
    assert_line(&text, "#SBATCH --partition=long,short");
    assert_line(&text, "#SBATCH --account=p_joints");
    assert_line(&text, "#SBATCH --requeue");
    assert_line(&text, "requeues=4");
    // Slurm reads % in a file name as the start of a number of its own
    assert_line(&text, "#SBATCH --output=50__.%a-of-7.log");
    assert_line(&text, "program='/opt/it'\"'\"'s here/jointplay'");
    assert_line(&text, "study='/home/me/my studies/50 %.yaml'");
    text_finish(&text);
}

static void what_was_not_asked_for_is_left_to_slurm(void **state)
{
    (void)state;
    static const char *const OPTIONS[] = {"--time", "--mem", "--partition", "--account"};
    Text text;
    text_init(&text);
    slurm_write(&JOB, SLURM_ARRAY, &text);
    slurm_write(&JOB, SLURM_GATHER, &text);
    for (size_t i = 0; i < sizeof OPTIONS / sizeof *OPTIONS; i++) {
        assert_null(strstr(text.data, OPTIONS[i]));
    }
    text_finish(&text);
}

// Options stand before the first command, or Slurm does not see them.
static void options_stand_before_the_first_command(void **state)
{
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        Text text;
        text_init(&text);
        slurm_write(&JOB, (SlurmScript)i, &text);
        const char *command = strstr(text.data, "\nset -u\n");
        assert_non_null(command);
        assert_null(strstr(command, "\n#SBATCH"));
        text_finish(&text);
    }
}

static bool time_is_taken(const char *time, Err *err)
{
    SlurmJob job = JOB;
    job.time = time;
    *err = (Err){0};
    return slurm_check(&job, err);
}

static void times_are_those_that_slurm_takes(void **state)
{
    (void)state;
    static const char *const RIGHT[] = {"5",   "90",   "5:00",   "90:30",   "0:05:00",    "4:00:00",
                                        "1-0", "1-12", "0-0:05", "2-12:30", "7-00:00:00", "300:0"};
    static const char *const WRONG[] = {
        "",   "x",  "1h",  "4:00:00:00", "-5",   "1-",       "1--2", ":5",        "5:",  "1-2-3",
        "5 ", " 5", "1.5", "1e3",        "-1-2", "12345678", "1-:5", "unlimited", "0x10"};
    Err err;
    for (size_t i = 0; i < sizeof RIGHT / sizeof *RIGHT; i++) {
        if (!time_is_taken(RIGHT[i], &err)) {
            fail_msg("%s", err.text);
        }
    }
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        assert_false(time_is_taken(WRONG[i], &err));
        assert_int_equal(err.kind, ERR_USAGE);
        assert_non_null(strstr(err.text, "DAYS-HOURS"));
    }
}

static void a_time_too_short_to_be_warned_of_is_refused(void **state)
{
    (void)state;
    static const char *const SHORT[] = {"1", "4:59", "0:04:59", "0-0:04"};
    Err err;
    for (size_t i = 0; i < sizeof SHORT / sizeof *SHORT; i++) {
        assert_false(time_is_taken(SHORT[i], &err));
        assert_non_null(strstr(err.text, "5 minutes and more"));
    }
}

static void names_and_sizes_that_slurm_would_misread_are_refused(void **state)
{
    (void)state;
    static const char *const SIZES[] = {"", "0", "000", "4GB", "1.5G", "-1", "G", "4 G", "4g "};
    static const char *const NAMES[] = {"",    "a b", "a'b",    "$x", "a\nb",
                                        "a;b", "-",   "a,,b\n", "--x"};
    for (size_t i = 0; i < sizeof SIZES / sizeof *SIZES; i++) {
        SlurmJob job = JOB;
        Err err = {0};
        job.memory = SIZES[i];
        assert_false(slurm_check(&job, &err));
        assert_int_equal(err.kind, ERR_USAGE);
    }
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
        SlurmJob job = JOB;
        Err err = {0};
        job.partition = NAMES[i];
        assert_false(slurm_check(&job, &err));
        job.partition = NULL;
        job.account = NAMES[i];
        err = (Err){0};
        assert_false(slurm_check(&job, &err));
        assert_int_equal(err.kind, ERR_USAGE);
    }
    SlurmJob job = JOB;
    Err err = {0};
    job.partition = "long,short-2";
    job.account = "proj_1.a";
    job.memory = "500";
    assert_true(slurm_check(&job, &err));
    job.account = "one,two";
    assert_false(slurm_check(&job, &err));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_script_is_one_to_bash),
        cmocka_unit_test(what_was_asked_for_stands_in_the_array),
        cmocka_unit_test(what_was_not_asked_for_is_left_to_slurm),
        cmocka_unit_test(options_stand_before_the_first_command),
        cmocka_unit_test(times_are_those_that_slurm_takes),
        cmocka_unit_test(a_time_too_short_to_be_warned_of_is_refused),
        cmocka_unit_test(names_and_sizes_that_slurm_would_misread_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
