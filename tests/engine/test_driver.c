// Can a program in any language run a case by the driver protocol, and does one that misbehaves
// harm nothing but its own run?
//
// The program is toy_driver.py, which integrates the angles of an ideal four-bar. The truth is the
// closed form; what the driver is told to do wrong must be said, and nothing may hang.
#include "engine/driver.h"

#include "close.h"
#include "load_case.h"

#include "base/clock.h"
#include "measure/error.h"
#include "run/registry.h"
#include "run/run.h"

#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

// s: within which a run that goes wrong has ended; a driver alone takes .2 s, a busy machine some
static const double SOON_S = 20.0;

static const RunWatch NOBODY = {NULL, NULL};

static EngineDriver toy(void)
{
    char given[ENGINE_PATH_SIZE];
    EngineDriver driver;
    Err err = {0};
    snprintf(given, sizeof given, "toy=%s", getenv("JOINTPLAY_TOY_DRIVER"));
    if (!engine_given(given, &driver, &err)) {
        fail_msg("%s", err.text);
    }
    return driver;
}

static Scenario ideal(double step_s)
{
    Scenario scenario = load("cases/paper/ideal-nominal.yaml", NULL, 0);
    scenario.run.step = step_s;
    scenario.run.samples = 90;
    return scenario;
}

static void fault(const char *name)
{
    setenv("JOINTPLAY_TOY_FAULT", name, 1);
}

static double error_of_way(const EngineDriver *driver, const char *way, double step_s)
{
    Scenario scenario = ideal(step_s);
    Trajectory *run = engine_run(driver, way, &scenario, SOON_S, NULL);
    Trajectory *truth = run_scenario(&scenario, registry_solver(BACKEND_ANALYTIC), NOBODY);
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    const TrajectoryError error = error_against(run, truth, INFINITY);
    assert_true(error.is_known && run->wall_s > 0.0);
    assert_int_equal(run->steps, lround(scenario_duration(&scenario) / step_s));
    trajectory_destroy(run);
    trajectory_destroy(truth);
    return error.max;
}

static void a_driver_says_what_it_is(void **state)
{
    (void)state;
    const EngineDriver driver = toy();
    assert_string_equal(driver.engine, "Toy");
    assert_string_equal(driver.version, "1.0");
    assert_string_equal(driver.precision, "double");
    assert_int_equal(driver.way_count, 2);
    assert_string_equal(driver.ways[1], "midpoint");
}

// Euler's method is of order 1, the midpoint rule of order 2: at a fifth of the step their errors
// are a fifth and a 25th. An order that is off by .2 is off by 1.4 in these ratios.
static void its_methods_have_their_orders(void **state)
{
    (void)state;
    const EngineDriver driver = toy();
    const double euler = error_of_way(&driver, "euler", 200e-6);
    const double midpoint = error_of_way(&driver, "midpoint", 200e-6);
    assert_near(log(euler / error_of_way(&driver, "euler", 40e-6)) / log(5.0), 1.0, 0.2);
    assert_near(log(midpoint / error_of_way(&driver, "midpoint", 40e-6)) / log(5.0), 2.0, 0.2);
    assert_true(midpoint < 0.05 * euler);
}

static void what_goes_wrong_is_a_failed_run_with_its_reason(void **state)
{
    (void)state;
    static const char *const FAULTS[][2] = {
        {"nan", "wrong at its 'bodies'"},
        {"fast", "its line 'sample' has as 'bodies[1][3]' 1e308, which has to be a number of at "
                 "most 1e+15"},
        {"far", "is suddenly 1e+06 m away"},
        {"faster", "its line 'sample' of 0.03 s has as 'bodies[1]' one that goes at 1e+14 m/s"},
        {"turned", "has suddenly turned by"},
        {"apart", "is suddenly 0.36"},
        {"drive", "its drive is"},
        {"starts-over", "its drive is"},
        {"abort", "ended by signal 6"},
        {"killed", "ended by signal 9"},
        {"exit", "ended with exit status 1: out of luck"},
        {"garbage", "is no JSON object: '\\x1b[31mgarbage'"},
        {"half", "ended in the middle of a line"},
        {"failed", "toy midpoint: the engine warned: bad number"},
        {"short", "done after 90 of 91 samples"},
        {"other-times", "its sample 0 is of 0.06 s"},
        {"child", "ended after 0 of 91 samples"},
        {"no-end", "ended after 91 of 91 samples"},
        {"goes-on", "goes on after it said that it is done"},
        {"lingers", "closed its output and went on"},
    };
    const EngineDriver driver = toy();
    Scenario scenario = ideal(600e-6);
    for (size_t i = 0; i < sizeof FAULTS / sizeof *FAULTS; i++) {
        fault(FAULTS[i][0]);
        const double began_s = clock_now_s();
        Trajectory *run = engine_run(&driver, "midpoint", &scenario, SOON_S, NULL);
        if (run->is_complete || strstr(run->message, FAULTS[i][1]) == NULL) {
            fail_msg("%s: '%s' does not say '%s'", FAULTS[i][0], run->message, FAULTS[i][1]);
        }
        assert_true(clock_now_s() - began_s < SOON_S);
        trajectory_destroy(run);
    }
    // the control: without a fault there is none
    fault("");
    Trajectory *run = engine_run(&driver, "midpoint", &scenario, SOON_S, NULL);
    assert_true(run->is_complete);
    trajectory_destroy(run);
}

static void totals_that_cannot_be_are_refused_by_their_names(void **state)
{
    (void)state;
    static const char *const LIES[][2] = {
        {"steps=1e300", "its 'steps' are 1e+300"},
        {"steps=0", "its 'steps' are 0"},
        {"steps=2.5", "its 'steps' are 2.5"},
        {"steps=1e15", "which have to be a whole number from 1 to "},
        {"wall_s=1e300", "its 'wall_s' is 1e+300"},
        {"wall_s=-1", "its 'wall_s' is -1"},
        {"force=-5", "its largest force is -5, which has to be 0 or more"},
        {"depth=-1e300", "'joints[0][1]' -1e300, which has to be a number of at most 1e+15"},
        {"depth=-1e-9", "its deepest penetration is -1e-09"},
        {"contacts=0.5",
         "its contacts begun is 0.5, which has to be a whole number of at most 1000 a step"},
        {"depth=9", "and not above the longest reach of a body"},
        {"settings=5", "has no 'settings', which has to be a text"},
        {"wall_s=1e3", "that it took as a whole"},
        {"wall_s=1e-12", "1 ns to a step"},
        {"contacts=-1", "its contacts begun is -1"},
        {"contacts=9e14", "its contacts begun is 9e+14"},
        {"contacts=1e16", "'joints[0][2]' 1e16, which has"},
    };
    const EngineDriver driver = toy();
    Scenario scenario = ideal(600e-6);
    for (size_t i = 0; i < sizeof LIES / sizeof *LIES; i++) {
        setenv("JOINTPLAY_TOY_LIE", LIES[i][0], 1);
        Trajectory *run = engine_run(&driver, "midpoint", &scenario, SOON_S, NULL);
        if (run->is_complete || strstr(run->message, LIES[i][1]) == NULL) {
            fail_msg("%s: '%s' does not say '%s'", LIES[i][0], run->message, LIES[i][1]);
        }
        trajectory_destroy(run);
    }
    // what would be obeyed by a terminal is text
    setenv("JOINTPLAY_TOY_LIE", "settings=\"a\\nb\\u001b[31m\"", 1);
    EngineSaid said;
    Trajectory *run = engine_run(&driver, "midpoint", &scenario, SOON_S, &said);
    assert_true(run->is_complete);
    assert_string_equal(said.settings, "a\\nb\\x1b[31m");
    trajectory_destroy(run);
    unsetenv("JOINTPLAY_TOY_LIE");
}

static void one_that_hangs_is_ended(void **state)
{
    (void)state;
    const EngineDriver driver = toy();
    Scenario scenario = ideal(600e-6);
    fault("hang");
    const double began_s = clock_now_s();
    Trajectory *run = engine_run(&driver, "midpoint", &scenario, 1.0, NULL);
    assert_false(run->is_complete);
    assert_non_null(strstr(run->message, "took longer than its limit of 1 s"));
    assert_true(clock_now_s() - began_s < SOON_S);
    fault("");
    trajectory_destroy(run);
}

static void what_is_no_driver_is_refused(void **state)
{
    (void)state;
    static const char *const GIVEN[][2] = {
        {"toy", "--driver takes NAME=PROGRAM"},
        {"ode=/bin/true", "none of our own backends"},
        {"Toy=/bin/true", "lower-case letters"},
        {"toy=", "--driver takes NAME=PROGRAM"},
        {"toy=/bin/true", "the driver 'toy' (/bin/true): said nothing"},
        {"toy=/bin/cat",
         "the driver 'toy' (/bin/cat): its line 'jointplay-driver' has no 'engine'"},
        {"toy=/no/such", "/no/such cannot be run: No such file or directory"},
        {"toy=/bin", "cannot be run: Permission denied"},
    };
    for (size_t i = 0; i < sizeof GIVEN / sizeof *GIVEN; i++) {
        EngineDriver driver;
        Err err = {0};
        assert_false(engine_given(GIVEN[i][0], &driver, &err));
        if (strstr(err.text, GIVEN[i][1]) == NULL) {
            fail_msg("%s: '%s' does not say '%s'", GIVEN[i][0], err.text, GIVEN[i][1]);
        }
    }
    EngineDriver driver;
    Err err = {0};
    fault("other-protocol");
    char given[ENGINE_PATH_SIZE];
    snprintf(given, sizeof given, "toy=%s", getenv("JOINTPLAY_TOY_DRIVER"));
    assert_false(engine_given(given, &driver, &err));
    assert_non_null(strstr(err.text, "its first line is not of protocol 1 to 3"));
    fault("");
}

static void a_name_without_a_driver_says_which_there_are(void **state)
{
    (void)state;
    EngineDriver driver;
    Err err = {0};
    setenv("JOINTPLAY_DRIVERS", "/no/such/folder", 1);
    assert_false(engine_find("mujoco", &driver, &err));
    assert_int_equal(err.kind, ERR_USAGE);
    assert_string_equal(err.text, "there is no driver for 'mujoco' here: there is ode alone; "
                                  "build jointplay where the engine is installed ('./bootstrap "
                                  "packages engines' does that), or --driver mujoco=PROGRAM names "
                                  "one");
    // a folder with one in it
    char folder[] = "/tmp/jointplay-drivers-XXXXXX";
    char link[sizeof folder + 32];
    assert_non_null(mkdtemp(folder));
    snprintf(link, sizeof link, "%s/jointplay-toy", folder);
    assert_int_equal(symlink(getenv("JOINTPLAY_TOY_DRIVER"), link), 0);
    setenv("JOINTPLAY_DRIVERS", folder, 1);
    err = (Err){0};
    assert_false(engine_find("../toy", &driver, &err));
    assert_non_null(strstr(err.text, "there are ode, toy; --driver NAME=PROGRAM names one"));
    err = (Err){0};
    assert_true(engine_find("toy", &driver, &err));
    assert_string_equal(driver.program, link);
    unlink(link);
    rmdir(folder);
    unsetenv("JOINTPLAY_DRIVERS");
}

// What drivers are not told of is refused by name, before any program is started.
static void what_cannot_be_told_is_refused_by_name(void **state)
{
    (void)state;
    static const char *const CASES[][2] = {
        {"cases/mechanisms/compressor.yaml", ""},
        {"cases/mechanisms/slider-crank-guide.yaml", ""},
        {"cases/mechanisms/gear-pair.yaml", ""},
        {"cases/mechanisms/friction-circle.yaml", ""},
        {"cases/literature/lugre.yaml", "does not take LuGre's friction "},
        {"cases/space/bennett.yaml", "does not take a mechanism in space"},
        {"cases/paper/stackup-poisson.yaml", "does not take contact.model: poisson"},
        {"cases/paper/impact-k66.yaml", ""},
        {"cases/mechanisms/slider-crank.yaml", ""},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        Scenario scenario = load(CASES[i][0], NULL, 0);
        Err err = {0};
        const bool is_right = engine_check("mujoco", &scenario, &err);
        if (is_right != (CASES[i][1][0] == '\0') || strstr(err.text, CASES[i][1]) == NULL) {
            fail_msg("%s: '%s' is not '%s'", CASES[i][0], err.text, CASES[i][1]);
        }
    }
    // what has a word is refused where the driver does not say that it takes it, by the host
    static const char *const LACKS[][2] = {
        {"cases/mechanisms/slider-crank-guide.yaml",
         "a block between guides (joint 'slider-guide')"},
        {"cases/mechanisms/stop-rebound.yaml", "limits of a joint (joint 'hinge')"},
        {"cases/mechanisms/bouncing-ball.yaml", "stops (joint "},
        {"cases/mechanisms/cam-roller.yaml", "cams (joint 'ride')"},
        {"cases/mechanisms/pin-slot.yaml", "a pin in a slot (joint "},
        {"cases/mechanisms/planetary-gear.yaml", "gears (joint 'outer')"},
        {"cases/mechanisms/rack-and-pinion.yaml", "a drive whose speed changes over time"},
        {"cases/mechanisms/five-bar.yaml", "several drives"},
        {"cases/mechanisms/servo-arm.yaml", "a soft drive with a torque limit"},
        {"cases/mechanisms/shaken-lever.yaml", "a load that is a sinusoid"},
        {"cases/mechanisms/friction-circle.yaml",
         "friction of an ideal joint that holds (joint 'left-pin')"},
    };
    EngineDriver newer = toy();
    newer.protocol = ENGINE_PROTOCOL;
    for (size_t i = 0; i < sizeof LACKS / sizeof *LACKS; i++) {
        const Scenario scenario = load_with(LACKS[i][0], "run.start=centred");
        EngineSaid said;
        Trajectory *refused = engine_run(&newer, "midpoint", &scenario, SOON_S, &said);
        if (!said.is_refused || strstr(refused->message, LACKS[i][1]) == NULL) {
            fail_msg("%s: '%s' is not '%s'", LACKS[i][0], refused->message, LACKS[i][1]);
        }
        trajectory_destroy(refused);
    }
    // a driver that does not take what the protocol has says so itself
    const EngineDriver driver = toy();
    Scenario scenario = load_with("cases/paper/impact-k66.yaml", "run.start=centred");
    Trajectory *run = engine_run(&driver, "midpoint", &scenario, SOON_S, NULL);
    assert_string_equal(run->message,
                        "toy midpoint: does not take the pin-in-hole 'crank-coupler'");
    trajectory_destroy(run);
    // one of protocol 1 is not given what that has no words for
    static const char *const NEEDS[][2] = {
        {"cases/mechanisms/run-up.yaml", "springs ('return')"},
        {"cases/hard/rotor-on-a-spring.yaml", "torsion springs ('spring')"},
        {"cases/mechanisms/compressor.yaml", "loads ('gas')"},
    };
    for (size_t i = 0; i < sizeof NEEDS / sizeof *NEEDS; i++) {
        char message[160];
        scenario = load(NEEDS[i][0], NULL, 0);
        run = engine_run(&driver, "midpoint", &scenario, SOON_S, NULL);
        snprintf(
            message, sizeof message,
            "toy midpoint: toy cannot run this case: its driver does not take %s, which protocol "
            "2 for drivers has and its 1 has not",
            NEEDS[i][1]);
        assert_string_equal(run->message, message);
        trajectory_destroy(run);
    }
}

// A driver is asked whether it takes a case before there is a start; the reason is its own.
static void what_a_driver_does_not_take_is_known_before_a_run(void **state)
{
    (void)state;
    const EngineDriver driver = toy();
    static const char *const WAYS[] = {"euler", "midpoint"};
    Scenario scenario;
    Err err = {0};
    assert_true(casefile_load("cases/paper/impact-k66.yaml", NULL, 0, &scenario, &err));
    assert_true(scenario_lacks_start(&scenario));
    assert_false(engine_takes(&driver, WAYS, 2, &scenario, SOON_S, &err));
    assert_int_equal(err.kind, ERR_CASE);
    assert_string_equal(err.text, "toy cannot run this case: its driver does not take the "
                                  "pin-in-hole 'crank-coupler'");
    err = (Err){0};
    assert_false(engine_takes(&driver, WAYS, 1, &scenario, SOON_S, &err));
    assert_non_null(strstr(err.text, "toy/euler cannot run this case"));
    scenario_free(&scenario);
    // the controls: a case that it takes, and a fault that a run has to show
    scenario = ideal(1e-4);
    scenario.run.step = 0.0;
    assert_true(engine_takes(&driver, WAYS, 2, &scenario, SOON_S, &err));
    fault("abort");
    assert_true(engine_takes(&driver, WAYS, 2, &scenario, SOON_S, &err));
    fault("");
}

// A pipe that every process of a driver holds open.
typedef struct Family {
    int ours;
    int theirs;
} Family;

static Family family_start(const char *named)
{
    int ends[2];
    char number[16];
    assert_int_equal(pipe(ends), 0);
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    snprintf(number, sizeof number, "%d", ends[1]);
    setenv("JOINTPLAY_TOY_PIPE", number, 1);
    fault(named);
    return (Family){.ours = ends[0], .theirs = ends[1]};
}

// Reads what comes next of the pipe, for a while: how many bytes; 0 where nobody holds it any more,
// -1 where somebody does and says nothing.
static ssize_t family_read(const Family *family)
{
    char said[8];
    struct pollfd watched = {.fd = family->ours, .events = POLLIN};
    return poll(&watched, 1, (int)(1e3 * SOON_S)) == 1 ? read(family->ours, said, sizeof said) : -1;
}

// Whether all three of the family were there, and none is left.
static void family_finish(Family *family, size_t met, const char *how)
{
    close(family->theirs);
    ssize_t count;
    while ((count = family_read(family)) > 0) {
        met += (size_t)count;
    }
    if (count != 0 || met != 3) {
        fail_msg("%s: of %zu processes of a driver some are left", how, met);
    }
    close(family->ours);
    unsetenv("JOINTPLAY_TOY_PIPE");
    fault("");
}

// The toy as a shell starts it that stays above it.
static EngineDriver wrapped_toy(char path[])
{
    EngineDriver driver = toy();
    const int file = mkstemp(path);
    dprintf(file, "#!/bin/sh\n'%s'\nexit $?\n", driver.program);
    fchmod(file, 0700);
    close(file);
    snprintf(driver.program, sizeof driver.program, "%s", path);
    return driver;
}

// A process that runs a case by a driver and ends by a signal meanwhile.
static void run_and_end_by(const EngineDriver *driver, int number)
{
    Scenario scenario = ideal(600e-6);
    Family family = family_start("family-hangs");
    const pid_t program = fork();
    if (program == 0) {
        prctl(PR_SET_DUMPABLE, 0);
        signal(number, SIG_DFL);
        trajectory_destroy(engine_run(driver, "midpoint", &scenario, SOON_S, NULL));
        _exit(0);
    }
    size_t met = 0;
    for (ssize_t count; met < 3 && (count = family_read(&family)) > 0;) {
        met += (size_t)count;
    }
    int status;
    kill(program, number);
    assert_int_equal(waitpid(program, &status, 0), program);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == number);
    family_finish(&family, met, strsignal(number));
}

// However the program ends: what the driver has started ends as well, in sessions of their own too.
static void no_process_of_a_driver_outlives_the_program(void **state)
{
    (void)state;
    static const int SIGNALS[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGKILL};
    char path[] = "/tmp/jointplay-wrapped-XXXXXX";
    const EngineDriver driver = wrapped_toy(path);
    for (size_t i = 0; i < sizeof SIGNALS / sizeof *SIGNALS; i++) {
        run_and_end_by(&driver, SIGNALS[i]);
    }
    unlink(path);
}

// Nor does one outlive the run: not where it ends as it should, nor where it takes too long.
static void no_process_of_a_driver_outlives_the_run(void **state)
{
    (void)state;
    char path[] = "/tmp/jointplay-wrapped-XXXXXX";
    const EngineDriver driver = wrapped_toy(path);
    Scenario scenario = ideal(600e-6);
    Family family = family_start("family");
    Trajectory *run = engine_run(&driver, "midpoint", &scenario, SOON_S, NULL);
    assert_true(run->is_complete);
    trajectory_destroy(run);
    family_finish(&family, 0, "done");
    family = family_start("family-hangs");
    run = engine_run(&driver, "midpoint", &scenario, 3.0, NULL);
    assert_non_null(strstr(run->message, "took longer than its limit of 3 s"));
    trajectory_destroy(run);
    family_finish(&family, 0, "time limit");
    unlink(path);
}

// Starts a process that after a while kills what the parent has started besides.
static pid_t start_killer(pid_t parent)
{
    const useconds_t wait_us = (useconds_t)(rand() % 80000);
    const pid_t killer = fork();
    if (killer == 0) {
        char path[64];
        int process;
        usleep(wait_us);
        snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)parent, (int)parent);
        FILE *children = fopen(path, "r");
        while (children != NULL && fscanf(children, "%d", &process) == 1) {
            if (process != (int)getpid()) {
                kill(process, SIGKILL);
            }
        }
        _exit(0);
    }
    return killer;
}

// Kills at random moments of a conversation: the caller sees each end, and goes on.
static void a_hundred_kills_leave_nothing_hanging(void **state)
{
    (void)state;
    const EngineDriver driver = toy();
    Scenario scenario = ideal(1e-3);
    scenario.run.samples = 20;
    srand(1);
    size_t failed = 0;
    for (int i = 0; i < 100; i++) {
        const pid_t killer = start_killer(getpid());
        Trajectory *run = engine_run(&driver, "midpoint", &scenario, SOON_S, NULL);
        const bool is_told = run->is_complete || strstr(run->message, "signal 9") != NULL ||
                             strstr(run->message, "ended") != NULL;
        if (!is_told) {
            fail_msg("%s", run->message);
        }
        failed += run->is_complete ? 0 : 1;
        trajectory_destroy(run);
        waitpid(killer, NULL, 0);
    }
    // the control: some of them were hit
    assert_true(failed > 0);
    // and there is no process left that nobody waits for
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_driver_says_what_it_is),
        cmocka_unit_test(its_methods_have_their_orders),
        cmocka_unit_test(what_goes_wrong_is_a_failed_run_with_its_reason),
        cmocka_unit_test(totals_that_cannot_be_are_refused_by_their_names),
        cmocka_unit_test(one_that_hangs_is_ended),
        cmocka_unit_test(what_is_no_driver_is_refused),
        cmocka_unit_test(a_name_without_a_driver_says_which_there_are),
        cmocka_unit_test(what_cannot_be_told_is_refused_by_name),
        cmocka_unit_test(what_a_driver_does_not_take_is_known_before_a_run),
        cmocka_unit_test(no_process_of_a_driver_outlives_the_program),
        cmocka_unit_test(no_process_of_a_driver_outlives_the_run),
        cmocka_unit_test(a_hundred_kills_leave_nothing_hanging),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
