// Does a long run say how far it has come, without leaving anything behind on a terminal?
#define _GNU_SOURCE // pseudo-terminals

#include "cli/progress.h"

#include "cli/long_work.h"
#include "cli/output.h"

#include "close.h"

#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { OUTPUT_SIZE = 4096 };

// Standard error led elsewhere for a while, and what arrived there.
typedef struct Listener {
    int kept;
    int reading_end;
    char output[OUTPUT_SIZE];
} Listener;

static void listen_from(Listener *listener, int writing_end, int reading_end)
{
    fflush(stderr);
    listener->kept = dup(STDERR_FILENO);
    listener->reading_end = reading_end;
    dup2(writing_end, STDERR_FILENO);
    close(writing_end);
}

static void listen_on_pipe(Listener *listener)
{
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    listen_from(listener, ends[1], ends[0]);
}

// False where the machine has no terminals to give.
static bool listen_on_terminal(Listener *listener)
{
    const int reading_end = posix_openpt(O_RDWR | O_NOCTTY);
    if (reading_end < 0 || grantpt(reading_end) != 0 || unlockpt(reading_end) != 0) {
        return false;
    }
    const int writing_end = open(ptsname(reading_end), O_RDWR | O_NOCTTY);
    if (writing_end < 0) {
        close(reading_end);
        return false;
    }
    listen_from(listener, writing_end, reading_end);
    return true;
}

static void stop_listening(Listener *listener)
{
    // a mark at the end, so that reading never waits
    fputs("#", stderr);
    fflush(stderr);
    size_t length = 0;
    while (length == 0 || listener->output[length - 1] != '#') {
        const ssize_t count =
            read(listener->reading_end, listener->output + length, OUTPUT_SIZE - 1 - length);
        assert_true(count > 0);
        length += (size_t)count;
    }
    listener->output[length - 1] = '\0';
    dup2(listener->kept, STDERR_FILENO);
    close(listener->kept);
    close(listener->reading_end);
}

static void a_terminal_sees_one_line_that_goes_away(void **state)
{
    (void)state;
    Listener listener;
    Progress progress;
    listen_on_pipe(&listener);
    progress_begin(&progress, false);
    const RunWatch watch = progress_watch(&progress, "ode");
    progress.line.is_terminal = true;
    watch.progress(0.25, 1.9, watch.context);
    watch.progress(0.50, 2.5, watch.context);
    watch.progress(0.51, 2.6, watch.context);
    watch.progress(0.75, 3.0, watch.context);
    progress_end(&progress);
    progress_end(&progress);
    stop_listening(&listener);
    assert_string_equal(listener.output,
                        "\rode: 50 %, 2.5 s\x1b[K\rode: 75 %, 3.0 s\x1b[K\r\x1b[K");
}

static void a_log_gets_a_line_every_ten_seconds(void **state)
{
    (void)state;
    Listener listener;
    Progress progress;
    listen_on_pipe(&listener);
    progress_begin(&progress, false);
    const RunWatch watch = progress_watch(&progress, "ode");
    for (int i = 0; i <= 25; i++) {
        watch.progress(i / 25.0, i, watch.context);
    }
    progress_end(&progress);
    stop_listening(&listener);
    assert_string_equal(listener.output,
                        "ode: 40 %, 10 s, some 15 s left\node: 80 %, 20 s, some 5 s left\n");
}

// Runs of nine seconds one after another, in one phase or in several, are not silent for 36.
static void time_goes_on_from_run_to_run(void **state)
{
    (void)state;
    for (int is_quiet = 0; is_quiet < 2; is_quiet++) {
        Listener listener;
        Progress progress;
        listen_on_pipe(&listener);
        progress_begin(&progress, is_quiet != 0);
        RunWatch watch = progress_watch(&progress, "reference");
        for (int run = 0; run < 4; run++) {
            watch = run == 2 ? progress_watch(&progress, "ode") : watch;
            for (int i = 1; i <= 9; i++) {
                watch.progress(i / 9.0, i, watch.context);
            }
        }
        progress_end(&progress);
        stop_listening(&listener);
        assert_string_equal(listener.output,
                            is_quiet ? "jointplay: warning: ode goes on for longer than 15 s"
                                       ", with the runs before it\n"
                                     : "reference: 11 %, 1 s\node: 22 %, 2 s\node: 33 %, 3 s\n");
    }
}

static void who_wants_quiet_is_told_of_long_work_alone(void **state)
{
    (void)state;
    Listener listener;
    Progress progress;
    listen_on_pipe(&listener);
    progress_begin(&progress, true);
    const RunWatch quick = progress_watch(&progress, "quick");
    for (int i = 1; i <= 14; i++) {
        quick.progress(i / 14.0, i, quick.context);
    }
    // with two seconds left a warning is of no use
    progress_begin(&progress, true);
    const RunWatch nearly = progress_watch(&progress, "quickly over");
    for (int i = 1; i <= 17; i++) {
        nearly.progress(i / 17.0, i, nearly.context);
    }
    progress_begin(&progress, true);
    const RunWatch slow = progress_watch(&progress, "slow");
    for (int i = 1; i <= 30; i++) {
        slow.progress(i / 3600.0, i, slow.context);
    }
    // without a pace, and of what is made of many parts
    progress_begin(&progress, true);
    const RunWatch stuck = progress_watch(&progress, "stuck");
    for (int i = 1; i <= 30; i++) {
        stuck.progress(0.0, i, stuck.context);
    }
    progress_end(&progress);
    stop_listening(&listener);
    assert_non_null(strstr(listener.output, "warning: stuck goes on for longer than 15 s"));
    *strstr(listener.output, "jointplay: warning: stuck") = '\0';
    assert_null(strstr(listener.output, "quick"));
    const char *warning =
        strstr(listener.output, "warning: slow, at its present pace, takes about 60 min");
    assert_non_null(warning);
    // once
    assert_null(strstr(warning + 1, "warning"));
}

// After 20 s of trials one begins that takes 10 s: what it has done by then is no pace of all.
static void a_trial_is_judged_by_its_own_pace(void **state)
{
    (void)state;
    for (int is_slow = 0; is_slow < 2; is_slow++) {
        Listener listener;
        Progress progress;
        listen_on_pipe(&listener);
        progress_begin(&progress, true);
        const ChosenWatch watch = progress_watch_trials(&progress, "ode");
        for (size_t trial = 1; trial <= 3; trial++) {
            watch.begin(trial, 1e-6, watch.run.context);
            for (int i = 1; i <= 20; i++) {
                const double share = i / (is_slow == 1 && trial == 3 ? 200.0 : 20.0);
                watch.run.progress(share, 10.0 * (double)(trial - 1) + 0.5 * i, watch.run.context);
            }
        }
        progress_end(&progress);
        stop_listening(&listener);
        const char *warning =
            strstr(listener.output, "ode, trial 3, step 1 us, at its present pace, takes about");
        // control: a trial that is slow itself
        if (is_slow == 1) {
            assert_non_null(warning);
            assert_non_null(strstr(warning, "takes about 100 s"));
        } else {
            assert_null(strstr(listener.output, "pace"));
        }
    }
}

// The line of every command whose work is done in processes of its own.
static void who_wants_quiet_gets_one_line_of_long_work(void **state)
{
    (void)state;
    Listener listener;
    listen_on_pipe(&listener);
    StatusLine line = status_line_start(true);
    for (int i = 1; i <= 60; i++) {
        if (status_line_is_due(&line, 0.5 * i, INFINITY)) {
            char words[32];
            snprintf(words, sizeof words, "searching, %.0f s", 0.5 * i);
            status_line_show(&line, words);
        }
    }
    status_line_end(&line);
    // control: what is short stays silent
    StatusLine brief = status_line_start(true);
    assert_false(status_line_is_due(&brief, 14.9, INFINITY));
    // and what is over soon; the control has more left
    assert_false(status_line_is_due(&brief, 16.0, 2.0));
    assert_true(status_line_is_due(&brief, 16.0, 20.0));
    stop_listening(&listener);
    assert_string_equal(listener.output, "jointplay: warning: long work: searching, 15 s\n");
}

static void a_run_that_was_announced_is_not_warned_of_again(void **state)
{
    (void)state;
    Listener listener;
    Progress progress;
    listen_on_pipe(&listener);
    assert_true(long_work_warn("ode", 3600.0, true));
    assert_false(long_work_warn("ode", 19.0, true));
    progress_begin(&progress, true);
    const RunWatch watch = progress_watch(&progress, "ode");
    progress.is_warned = true;
    for (int i = 1; i <= 30; i++) {
        watch.progress(i / 3600.0, i, watch.context);
    }
    progress_end(&progress);
    stop_listening(&listener);
    assert_string_equal(listener.output, "jointplay: warning: ode takes about 60 min\n");
}

static void colours_are_for_terminals_that_want_them(void **state)
{
    (void)state;
    Listener listener;
    if (!listen_on_terminal(&listener)) {
        print_message("# no terminal to be had here\n");
        return;
    }
    setenv("TERM", "xterm", 1);
    unsetenv("NO_COLOR");
    const Style wanted = output_style(stderr, false);
    setenv("NO_COLOR", "", 1);
    const Style empty = output_style(stderr, false);
    setenv("NO_COLOR", "1", 1);
    const Style refused = output_style(stderr, false);
    unsetenv("NO_COLOR");
    setenv("TERM", "dumb", 1);
    const Style dumb = output_style(stderr, false);
    stop_listening(&listener);
    assert_true(wanted.heading[0] == '\x1b');
    assert_true(empty.heading[0] == '\x1b');
    assert_string_equal(refused.heading, "");
    assert_string_equal(dumb.heading, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_terminal_sees_one_line_that_goes_away),
        cmocka_unit_test(a_log_gets_a_line_every_ten_seconds),
        cmocka_unit_test(time_goes_on_from_run_to_run),
        cmocka_unit_test(who_wants_quiet_is_told_of_long_work_alone),
        cmocka_unit_test(a_trial_is_judged_by_its_own_pace),
        cmocka_unit_test(who_wants_quiet_gets_one_line_of_long_work),
        cmocka_unit_test(a_run_that_was_announced_is_not_warned_of_again),
        cmocka_unit_test(colours_are_for_terminals_that_want_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
