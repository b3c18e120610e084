// Does a long comparison say how far it has come, without leaving anything behind on a terminal?
#include "commands/compare/compare.h"

#include "close.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { OUTPUT_SIZE = 4096 };

static int kept;
static int reading_end;

static void listen(void)
{
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    fflush(stderr);
    kept = dup(STDERR_FILENO);
    dup2(ends[1], STDERR_FILENO);
    close(ends[1]);
    reading_end = ends[0];
}

static void stop_listening(char output[OUTPUT_SIZE])
{
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    const ssize_t count = read(reading_end, output, OUTPUT_SIZE - 1);
    output[count > 0 ? count : 0] = '\0';
    close(reading_end);
}

// Two points at 10 and 5 us, the first of which took 2 s.
static Ladder *make_ladder(void)
{
    static const Scheme SCHEME = {.name = "direct/plain", .backend = BACKEND_ODE};
    static const double STEPS[2] = {1e-5, 5e-6};
    Ladder *ladder = ladder_create(&SCHEME, 1, STEPS, 2, 5);
    const LadderRun run = {.is_complete = true, .wall_s = 2.0};
    assert_true(ladder_add(ladder, &run));
    return ladder;
}

static void a_log_gets_runs_and_the_time_left(void **state)
{
    (void)state;
    char output[OUTPUT_SIZE];
    Ladder *ladder = make_ladder();
    listen();
    CompareProgress progress = compare_progress_start(ladder, 1, false);
    compare_progress_show(&progress, "error runs");
    progress.line.started_s -= 100.0;
    compare_progress_show(&progress, "error runs");
    compare_progress_show(&progress, "error runs");
    compare_progress_end(&progress);
    stop_listening(output);
    // what is left: 4 s of error run, then five times 2 and 4 s
    assert_string_equal(output, "error runs: 1 of 12 runs, 100 s, some 34 s left\n");
    ladder_destroy(ladder);
}

// Before the fine steps begin, and with what would take less.
static void long_work_is_announced_once_the_pace_is_known(void **state)
{
    (void)state;
    static const Scheme SCHEME = {.name = "direct/plain", .backend = BACKEND_ODE};
    static const double STEPS[4] = {1e-5, 5e-6, 1e-6, 1e-8};
    for (int is_long = 0; is_long < 2; is_long++) {
        char output[OUTPUT_SIZE];
        Ladder *ladder = ladder_create(&SCHEME, 1, STEPS, 4, 5);
        listen();
        CompareProgress progress = compare_progress_start(ladder, 1, false);
        compare_progress_show(&progress, "error runs");
        const LadderRun run = {.is_complete = true, .wall_s = is_long == 1 ? 1.0 : 1e-3};
        assert_true(ladder_add(ladder, &run));
        compare_progress_show(&progress, "error runs");
        compare_progress_show(&progress, "error runs");
        // something to read, so that reading does not wait
        fputs("#", stderr);
        stop_listening(output);
        // 1, 2, 10 and 1000 s, six times less the first
        assert_string_equal(
            output, is_long == 0
                        ? "#"
                        : "jointplay: warning: the 23 runs left take about 101 min; --steps "
                          "'10 us, 5 us' take about 18 s, fewer --schemes less as well\n#");
        ladder_destroy(ladder);
    }
}

static void a_terminal_sees_one_line_that_goes_away(void **state)
{
    (void)state;
    char output[OUTPUT_SIZE];
    Ladder *ladder = make_ladder();
    listen();
    CompareProgress progress = compare_progress_start(ladder, 1, false);
    progress.line.is_terminal = true;
    progress.line.started_s -= 10.0;
    compare_progress_show(&progress, "timing runs");
    compare_progress_end(&progress);
    compare_progress_end(&progress);
    stop_listening(output);
    assert_string_equal(output, "\rtiming runs: 1 of 12 runs, 10 s, some 34 s left\x1b[K\r\x1b[K");
    ladder_destroy(ladder);
}

static void who_wants_quiet_is_warned_of_long_work_once(void **state)
{
    (void)state;
    char output[OUTPUT_SIZE];
    Ladder *ladder = make_ladder();
    ladder->points[0].run.wall_s = 1.0; // what is left need not be announced
    listen();
    CompareProgress progress = compare_progress_start(ladder, 1, true);
    progress.line.started_s -= 14.0;
    compare_progress_show(&progress, "short ones");
    progress.line.started_s -= 86.0;
    compare_progress_show(&progress, "error runs");
    compare_progress_show(&progress, "error runs");
    // something to read, so that reading does not wait
    fputs("#", stderr);
    stop_listening(output);
    static const char WARNING[] = "jointplay: warning: long work: error runs: ";
    assert_int_equal(strncmp(output, WARNING, sizeof WARNING - 1), 0);
    assert_null(strstr(output + 1, "jointplay"));
    ladder_destroy(ladder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_log_gets_runs_and_the_time_left),
        cmocka_unit_test(long_work_is_announced_once_the_pace_is_known),
        cmocka_unit_test(a_terminal_sees_one_line_that_goes_away),
        cmocka_unit_test(who_wants_quiet_is_warned_of_long_work_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
