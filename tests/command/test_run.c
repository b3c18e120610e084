// Does `jointplay run` print, write and end as it should?
#include "program.h"

#include <math.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>

static void a_bad_case_ends_with_status_3_before_anything_runs(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "bad.yaml", path);
    FILE *stream = fopen(path, "w");
    fputs("title: bad\nfour-bar: {ground: {length: 254}}\n", stream);
    fclose(stream);
    program_run(program, "run $cases/paper/ideal-nominal.yaml bad.yaml --out out");
    assert_int_equal(program->status, 3);
    assert_string_equal(program->output, "");
    assert_says(program->errors, "bad.yaml:2:");
    program_path(program, "out", path);
    assert_int_equal(access(path, F_OK), -1);
}

// Starts a run whose engine takes some minutes, by itself.
static pid_t start_long_run(const Program *program)
{
    const pid_t process = fork();
    if (process == 0) {
        char word[PROGRAM_PATH_SIZE];
        snprintf(word, sizeof word, "%s/paper/impact-k66.yaml", getenv("JOINTPLAY_CASES"));
        if (chdir(program->folder) == 0 && freopen(".output", "w", stdout) != NULL &&
            freopen(".errors", "w", stderr) != NULL) {
            execl(getenv("JOINTPLAY_PROGRAM"), "jointplay", "run", word, "--set",
                  "run.backends=[ode, reference]", "--set", "ode.map=textbook", "--set",
                  "ode.stepping=plain", "--set", "run.step=0.01 us", (char *)NULL);
        }
        _exit(127);
    }
    return process;
}

// Into a file as on a screen: the table and how sure it is, before the engine, which is named first
// among the backends, has come far.
static void the_answer_is_there_before_the_engines(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_path(program, ".output", path);
    const pid_t process = start_long_run(program);
    const struct timespec pause = {0, 20000000};
    int ended = 0;
    program->output[0] = '\0';
    for (int i = 0; strstr(program->output, "Assumed:") == NULL; i++) {
        assert_true(i < 3000); // a minute
        nanosleep(&pause, NULL);
        if (access(path, R_OK) == 0) {
            program_read(path, program->output);
        }
    }
    assert_int_equal(waitpid(process, &ended, WNOHANG), 0); // it goes on
    kill(process, SIGKILL);
    waitpid(process, &ended, 0);
    assert_says(program->output, "crank-coupler");
    assert_says(program->output, "The reference is right to");
    assert_null(strstr(program->output, "off by"));
    assert_null(strstr(program->output, "Time:"));
}

static void a_missing_case_ends_with_status_5(void **state)
{
    Program *program = *state;
    program_run(program, "run nowhere.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "nowhere.yaml");
    assert_string_equal(program->output, "");
}

static void a_run_prints_extremes_error_and_cost(void **state)
{
    Program *program = *state;
    program_run(program, "run --full $cases/paper/ideal-nominal.yaml");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "transmission angle 30.74 to 82.32 deg");
    assert_says(program->output, "coupler   analytic    42.2008     237.6   -78.6973       5.0");
    assert_says(program->output, "Error at the samples");
    assert_says(program->output, "simulated/wall");
    assert_null(strchr(program->output, '\x1b'));
    assert_string_equal(program->errors, "");
}

static double number_of(const json_t *run, const char *group, const char *name, const char *key)
{
    const json_t *object = json_object_get(json_object_get(run, group), name);
    return json_number_value(json_object_get(object, key));
}

static void json_of_one_case_is_one_object(void **state)
{
    Program *program = *state;
    program_run(program, "run --json $cases/paper/ideal-nominal.yaml");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *settings = json_object_get(root, "settings");
    assert_near(json_number_value(json_object_get(settings, "run.step")), 1e-5, 1e-18);
    const json_t *backends = json_object_get(settings, "run.backends");
    assert_int_equal(json_array_size(backends), 2);
    assert_string_equal(json_string_value(json_array_get(backends, 1)), "ode");
    const json_t *units = json_object_get(root, "setting_units");
    assert_string_equal(json_string_value(json_object_get(units, "ode.cfm")), "s/kg");
    const json_t *runs = json_object_get(root, "runs");
    assert_int_equal(json_array_size(runs), 2);
    const json_t *analytic = json_array_get(runs, 0);
    // the paper's Table VII and VIII, ideal nominal, as continuous extremes
    assert_near(number_of(analytic, "bodies", "coupler", "omega_min_rad_s"), -78.6973, 1e-4);
    assert_near(number_of(analytic, "bodies", "follower", "alpha_max_rad_s2"), 12485.5, 0.1);
    // the drive's power is what the energy changes by
    const json_t *forces = json_object_get(root, "inverse_dynamics");
    const json_t *residual = json_object_get(forces, "power_residual");
    assert_true(json_is_number(residual) && json_number_value(residual) <= 1e-10);
    const json_t *ode = json_array_get(runs, 1);
    assert_string_equal(json_string_value(json_object_get(ode, "status")), "ok");
    const json_t *error = json_object_get(ode, "error");
    // first order at a step of 10 us: some 8e-4, and surely not exact
    assert_true(json_number_value(json_object_get(error, "omega_max")) < 2e-3);
    assert_true(json_number_value(json_object_get(error, "omega_max")) > 1e-6);
    json_decref(root);
}

static void json_of_several_cases_is_a_list_of_them(void **state)
{
    Program *program = *state;
    program_run(program, "run $cases/paper/ideal-nominal.yaml --json --backend analytic "
                         "$cases/paper/ideal-nominal.yaml");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *cases = json_object_get(root, "cases");
    assert_int_equal(json_array_size(cases), 2);
    const json_t *runs = json_object_get(json_array_get(cases, 1), "runs");
    assert_int_equal(json_array_size(runs), 1);
    json_decref(root);
}

static void settings_of_the_command_line_replace_those_of_the_case(void **state)
{
    Program *program = *state;
    program_run(program, "run --json --step '20 us' --set drive.speed='500 rpm' --backend ode "
                         "$cases/paper/ideal-nominal.yaml --set 'run.samples=100'");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *settings = json_object_get(root, "settings");
    assert_near(json_number_value(json_object_get(settings, "run.step")), 2e-5, 1e-18);
    assert_close(json_number_value(json_object_get(settings, "drive.speed")),
                 500.0 * 2.0 * M_PI / 60.0, 1e-12);
    const json_t *run = json_array_get(json_object_get(root, "runs"), 0);
    assert_string_equal(json_string_value(json_object_get(run, "backend")), "ode");
    assert_near(json_number_value(json_object_get(run, "step_s")), 2e-5, 1e-18);
    assert_true(json_is_null(json_object_get(run, "error")));
    json_decref(root);
}

// The length of a vector among the settings of a run, by its key.
static double setting_length(const json_t *root, const char *key, size_t count)
{
    const json_t *list = json_object_get(json_object_get(root, "settings"), key);
    assert_int_equal(json_array_size(list), count);
    double square = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double part = json_number_value(json_array_get(list, i));
        square += part * part;
    }
    return sqrt(square);
}

static void a_direction_among_the_settings_is_a_list_and_a_tolerated_length_is_not(void **state)
{
    Program *program = *state;
    program_run(program, "run -q --json --uncertified --backend reference "
                         "$cases/space/bennett.yaml");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    assert_near(setting_length(root, "joints.ground-crank.axis", 3), 1.0, 1e-12);
    json_decref(root);
    program_run(program, "run -q --json --uncertified --backend reference --set run.start=centred "
                         "$cases/paper/stackup-impact.yaml");
    assert_int_equal(program->status, 0);
    root = program_json(program);
    const json_t *length =
        json_object_get(json_object_get(root, "settings"), "four-bar.crank.length");
    assert_near(json_number_value(json_object_get(length, "nominal")), 0.108, 1e-15);
    assert_near(json_number_value(json_object_get(length, "upper")), 0.3e-3, 1e-15);
    json_decref(root);
}

static size_t count_lines(const char *text)
{
    size_t lines = 0;
    for (; *text != '\0'; text++) {
        lines += *text == '\n' ? 1 : 0;
    }
    return lines;
}

static void a_series_holds_a_row_a_sample(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    static char content[PROGRAM_OUTPUT_SIZE];
    program_run(program, "run $cases/paper/ideal-nominal.yaml --series s.csv --set run.samples=50 "
                         "--backend analytic");
    assert_int_equal(program->status, 0);
    assert_says(program->errors, "wrote s.csv");
    program_path(program, "s.csv", path);
    program_read(path, content);
    assert_int_equal(strncmp(content, "time_s,crank_deg,crank_angle_rad,crank_omega_rad_s,", 51),
                     0);
    assert_int_equal(count_lines(content), 52);
    program_run(program, "run $cases/paper/ideal-nominal.yaml --series t.csv --set run.samples=50");
    program_path(program, "t-ode.csv", path);
    assert_int_equal(access(path, F_OK), 0);
    program_path(program, "t-analytic.csv", path);
    assert_int_equal(access(path, F_OK), 0);
}

// The number in a cell of a table's row, both counted from 0, which may be empty.
static double table_number(const char *table, size_t row, size_t column)
{
    for (; row > 0; row--) {
        table = strchr(table, '\n') + 1;
    }
    for (; column > 0; column--) {
        table = strchr(table, ',') + 1;
    }
    return strtod(table, NULL);
}

static void every_contact_has_a_row(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    static char content[PROGRAM_OUTPUT_SIZE];
    // a pin falls through its clearance of .1 mm onto the lowest point of the hole, and goes on
    // bouncing: more contacts than the twelve that JSON lists
    program_run(program, "run $cases/literature/pin-in-hole-drop.yaml --contacts c.csv --json "
                         "--backend reference --uncertified --set 'run.duration=85 ms'");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    json_t *hole = json_object_get(
        json_object_get(json_array_get(json_object_get(root, "runs"), 0), "joints"), "hole");
    const double impacts = json_number_value(json_object_get(hole, "impacts"));
    const double force_max = json_number_value(json_object_get(hole, "force_max_N"));
    program_path(program, "c.csv", path);
    program_read(path, content);
    static const char HEAD[] = "joint,onset_s,duration_s,peak_s,force_max_N,impulse_N_s,"
                               "approach_speed_m_s,penetration_max_m,wall_deg\nhole,";
    assert_int_equal(strncmp(content, HEAD, sizeof HEAD - 1), 0);
    const size_t rows = count_lines(content) - 1;
    assert_true(rows > 12);
    assert_true((double)rows == impacts);
    const double clearance = 1e-4;
    const double gravity = 9.80665;
    assert_near(table_number(content, 1, 1), sqrt(2.0 * clearance / gravity), 1e-9);
    assert_near(table_number(content, 1, 6), sqrt(2.0 * clearance * gravity), 1e-9);
    assert_near(table_number(content, 1, 8), -90.0, 1e-6);
    assert_true(table_number(content, 1, 4) == force_max);
    for (size_t row = 2; row <= rows; row++) {
        assert_true(table_number(content, row, 1) > table_number(content, row - 1, 1));
    }
    json_decref(root);
}

static void a_folder_gets_all_there_is_to_know(void **state)
{
    Program *program = *state;
    static const char *const NAMES[] = {"ideal-nominal.json", "ideal-nominal.txt",
                                        "ideal-nominal.svg", "ideal-nominal-ode.csv",
                                        "ideal-nominal-analytic.csv"};
    program_run(program, "run -q $cases/paper/ideal-nominal.yaml --out a/b --set run.samples=90");
    assert_int_equal(program->status, 0);
    assert_string_equal(program->errors, "");
    for (int i = 0; i < 5; i++) {
        char name[128];
        char path[PROGRAM_PATH_SIZE];
        struct stat status;
        snprintf(name, sizeof name, "a/b/%s", NAMES[i]);
        program_path(program, name, path);
        assert_int_equal(stat(path, &status), 0);
        assert_true(status.st_size > 1000);
    }
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "a/b/ideal-nominal.json", path);
    json_t *root = json_load_file(path, 0, NULL);
    assert_non_null(root);
    json_decref(root);
}

static void two_cases_of_one_name_do_not_share_a_folder(void **state)
{
    Program *program = *state;
    program_fails_usage(program,
                        "run --out o $cases/paper/ideal-nominal.yaml "
                        "$cases/../cases/paper/ideal-nominal.yaml",
                        "would write the same files");
}

static void a_failed_solver_ends_with_status_4_after_the_others_are_told(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_run(program, "run --full $cases/paper/stackup-impact.yaml --set run.step=1ms "
                         "--set run.start=centred --backend analytic,ode --set "
                         "contact.stiffness='1e11 N/m^1.5' --out out");
    assert_int_equal(program->status, 4);
    assert_says(program->output, "coupler   analytic    42.2008");
    assert_says(program->output, "ode       failed      -");
    assert_says(program->errors, "1 of 2 runs failed: ");
    program_path(program, "out/stackup-impact-analytic.csv", path);
    assert_int_equal(access(path, F_OK), 0);
    program_path(program, "out/stackup-impact-ode.csv", path);
    assert_int_equal(access(path, F_OK), -1);
}

static void json_of_a_failed_run_holds_no_number(void **state)
{
    Program *program = *state;
    program_run(program, "run $cases/paper/stackup-impact.yaml --set run.step=1ms "
                         "--set run.start=centred --backend analytic,ode --set "
                         "contact.stiffness='1e11 N/m^1.5' --json");
    assert_int_equal(program->status, 4);
    json_t *root = program_json(program);
    json_t *run = json_array_get(json_object_get(root, "runs"), 1);
    assert_string_equal(json_string_value(json_object_get(run, "status")), "failed");
    assert_true(strlen(json_string_value(json_object_get(run, "message"))) > 0);
    assert_null(json_object_get(run, "bodies"));
    assert_null(json_object_get(run, "steps"));
    json_decref(root);
}

// The heights in a picture, pixels, at which a line passes one that stands at an x: where it
// crosses it, and where it starts on it.
static size_t heights_at(const char *path, double x, double *heights, size_t room)
{
    size_t count = 0;
    double before[2] = {0.0, 0.0};
    for (const char *at = path; strchr("MLHV", *at) != NULL && *at != '\0';) {
        char *end = (char *)at + 1;
        double here[2] = {before[0], before[1]};
        here[0] = *at == 'V' ? here[0] : strtod(end, &end);
        here[1] = *at == 'H' ? here[1] : strtod(end, &end);
        const bool is_start = *at == 'M' && here[0] == x;
        const bool crosses = *at != 'M' && (before[0] - x) * (here[0] - x) <= 0.0 &&
                             before[0] != x && here[0] != before[0];
        if ((is_start || crosses) && count < room) {
            const double share = is_start ? 1.0 : (x - before[0]) / (here[0] - before[0]);
            heights[count++] = before[1] + share * (here[1] - before[1]);
        }
        memcpy(before, here, sizeof before);
        at = end;
    }
    return count;
}

// The next line of a panel, from what it begins with.
static const char *next_line(const char *from)
{
    static const char LINE[] = "<path class=\"line\" d=\"";
    const char *found = strstr(from, LINE);
    assert_non_null(found);
    return found + sizeof LINE - 1;
}

static void backlash_under_a_torque_that_turns_back_is_a_loop(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_run(program, "run $cases/mechanisms/servo-backlash.yaml --set run.backends=[reference] "
                         "--plot servo.svg --quiet");
    assert_int_equal(program->status, 0);
    program_path(program, "servo.svg", path);
    program_read(path, program->output);
    const char *panel = strstr(program->output, "Angle over torque");
    assert_non_null(panel);
    const char *low = next_line(panel);
    const char *high = next_line(low);
    const char *loop = next_line(high);
    double flanks[2];
    double loads[64];
    double ends[2];
    char *end;
    const double left = strtod(low + 1, &end);
    flanks[0] = strtod(end, &end);
    const double right = strtod(end + 1, &end);
    flanks[1] = strtod(strchr(high, ' '), NULL);
    // without torque it starts in the middle of the gap, and comes back at one flank, and at the
    // other; 1 N m is a whole gap and 0.34/0.31 of half of it beyond that
    assert_int_equal(heights_at(loop, 0.5 * (left + right), loads, 64), 3);
    assert_true(fabs(loads[0] - 0.5 * (flanks[0] + flanks[1])) < 0.2);
    assert_true(fabs(loads[1] - flanks[1]) < 1.0);
    assert_true(fabs(loads[2] - flanks[0]) < 1.0);
    assert_int_equal(heights_at(loop, left + (right - left) / 12.0, ends, 2), 1);
    const double beyond = 0.34 / 0.62 * (flanks[0] - flanks[1]);
    assert_true(fabs(ends[0] - flanks[0] - beyond) < 1.5);
    // the control: nothing drives this one
    program_run(program, "run $cases/mechanisms/stop-rebound.yaml --set run.backends=[reference] "
                         "--plot stop.svg --quiet");
    program_path(program, "stop.svg", path);
    program_read(path, program->output);
    assert_null(strstr(program->output, "over torque"));
}

static void a_full_disk_ends_with_status_5(void **state)
{
    Program *program = *state;
    program_run(program, "run $cases/paper/ideal-nominal.yaml >/dev/full");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "cannot write standard output: No space left on device");
    program_run(program, "run $cases/paper/ideal-nominal.yaml --series /dev/full");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "cannot write /dev/full: No space left on device");
    program_run(program, "run $cases/paper/ideal-nominal.yaml --plot /dev/full");
    assert_int_equal(program->status, 5);
}

static void nothing_half_written_stays_behind(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    // what cannot be written is told before anything runs
    static const char *const TARGETS[] = {"--plot nowhere/p.svg", "--contacts nowhere/c.csv",
                                          "--series nowhere/s.csv",
                                          "--series s.csv --plot nowhere/p.svg"};
    for (int i = 0; i < 3; i++) {
        char words[256];
        snprintf(words, sizeof words, "run $cases/paper/ideal-nominal.yaml %s", TARGETS[i]);
        program_run(program, words);
        assert_int_equal(program->status, 5);
        assert_string_equal(program->output, "");
        assert_says(program->errors, "cannot write nowhere/");
        assert_says(program->errors, "No such file or directory");
    }
    // a folder's name that a file has
    program_path(program, "taken", path);
    fclose(fopen(path, "w"));
    program_run(program, "run $cases/paper/ideal-nominal.yaml --out taken");
    assert_int_equal(program->status, 5);
    assert_string_equal(program->output, "");
    assert_says(program->errors, "cannot make the folder taken");
    // a limit on the size of files, as a full disk: the file is begun, and gone again
    char command[PROGRAM_PATH_SIZE * 2];
    snprintf(command, sizeof command,
             "cd '%s' && trap '' XFSZ && ulimit -f 40 && \"$JOINTPLAY_PROGRAM\" run -q "
             "\"$JOINTPLAY_CASES/paper/ideal-nominal.yaml\" --series s.csv >/dev/null 2>.errors; "
             "test $? -eq 5 && test \"$(ls)\" = taken",
             program->folder);
    assert_int_equal(system(command), 0);
}

// Runs the linkage with some of its words replaced and asks for a warning, or for silence.
static void expect_doubt(Program *program, const char *from, const char *to, const char *said)
{
    static const char CASE[] =
        "bodies:\n"
        "  arm:   {mass: 100 g, inertia: 15 kg mm^2,   at: [0 mm, 20 mm]}\n"
        "  link:  {mass: 200 g, inertia: 430 kg mm^2,  at: [80 mm, 40 mm]}\n"
        "  lever: {mass: 400 g, inertia: 1200 kg mm^2, at: [160 mm, 20 mm]}\n"
        "joints:\n"
        "  motor: {between: [ground, arm], at: [0 mm, 0 mm]}\n"
        "  first: {between: [arm, link], at: [0 mm, 40 mm]}\n"
        "  second: {between: [link, lever], at: [160 mm, 40 mm], hole: 10.06 mm, pin: 10 mm,\n"
        "           width: 12 mm}\n"
        "  pivot: {between: [ground, lever], at: [160 mm, -40 mm]}\n"
        "drive: {joint: motor, speed: 300 rpm}\n"
        "gravity: 9.81 m/s^2\n"
        "run: {revolutions: 0.06, samples: 200, start: centred, backends: [reference]}\n";
    const char *found = strstr(CASE, from);
    assert_non_null(found);
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "doubt.yaml", path);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "%.*s%s%s", (int)(found - CASE), CASE, to, found + strlen(from));
    fclose(file);
    program_run(program, "run doubt.yaml --uncertified");
    assert_int_equal(program->status, 0);
    if (said == NULL) {
        assert_string_equal(program->errors, "");
    } else {
        assert_says(program->errors, said);
    }
}

static void what_nobody_can_have_meant_is_warned_of(void **state)
{
    Program *program = *state;
    expect_doubt(program, "gravity", "gravity", NULL);
    expect_doubt(program, "  pivot: {between: [ground, lever], at: [160 mm, -40 mm]}\n", "",
                 "the mechanism can move in 3 ways (play not counted), of which 1 is driven and 0 "
                 "held");
    expect_doubt(program, "[80 mm, 40 mm]", "[80 cm, 40 mm]",
                 "the centre of mass of 'link' is 0.64 m from its nearest joint, 4 times the "
                 "distance of its joints");
    expect_doubt(program, "400 g", "400 kg",
                 "the mass of 'lever' is 400 kg, that of the bodies it is joined to 0.2 kg, "
                 "a ratio of 2e+03");
    expect_doubt(program, "9.81", "-9.81", "gravity is 9.81 m/s^2 along +y, which is upward");
    expect_doubt(program, "samples: 200", "samples: 19",
                 "the drive's torque is taken at samples, and run.samples is 19");
    // the controls: a lever of 40 kg, a counterweight, gravity to the side, and a pendulum on what
    // is driven, which a pivot would not hold
    expect_doubt(program, "400 g", "40 kg", NULL);
    expect_doubt(program, "at: [0 mm, 20 mm]", "at: [0 mm, -40 mm]", NULL);
    expect_doubt(program, "9.81 m/s^2", "[9.81 m/s^2, 0 m/s^2]", NULL);
    expect_doubt(program, "gravity:",
                 "springs: {hold: {between: [ground, lever], at-a: [260 mm, 40 mm],\n"
                 "  at-b: [160 mm, 40 mm], stiffness: 1 N/mm}}\ngravity:",
                 NULL);
    program_run(program, "run $cases/space/overhung-pin.yaml --uncertified --backend reference");
    assert_string_equal(program->errors, "");
    program_run(program, "run $cases/mechanisms/pendulum.yaml --set space=spatial "
                         "--uncertified --backend reference");
    assert_says(program->errors, "nothing can tilt in this case");
}

static void settings_without_effect_are_said_a_line_each(void **state)
{
    Program *program = *state;
    program_run(program, "run $cases/paper/ideal-nominal.yaml --set contact.law=johnson "
                         "--set ode.seed=4 --set run.samples=90 --backend analytic --step 5us");
    assert_int_equal(program->status, 0);
    assert_string_equal(
        program->errors,
        "jointplay: warning: run.step of the command line has no effect here; it would with ode "
        "or another engine "
        "among run.backends\n"
        "jointplay: warning: contact.law of the command line has no effect here; it would with a "
        "joint with play\n"
        "jointplay: warning: ode.seed of the command line has no effect here; it would with ode "
        "among run.backends\n");
    // a key of the file has its line
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "kept.yaml", path);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("bodies: {pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}}\n"
          "joints: {hinge: {between: [ground, pin], at: [0 mm, 0 mm]}}\n"
          "run: {duration: 1 ms, samples: 10}\n"
          "ode:\n  erp: 0.3\n",
          file);
    fclose(file);
    program_run(program, "run kept.yaml --step '10 us'");
    assert_string_equal(program->errors, "jointplay: warning: kept.yaml:5: ode.erp has no effect "
                                         "here; it would with ode.stepping: plain\n");
    program_run(program, "run kept.yaml --backend reference");
    assert_string_equal(program->errors, "");
    program_run(program, "run -q $cases/paper/ideal-nominal.yaml --set contact.law=johnson");
    assert_int_equal(program->status, 0);
    assert_string_equal(program->errors, "");
    // the control: with play the law matters
    program_run(program, "run $cases/paper/stackup-impact.yaml --set contact.law=johnson "
                         "--set contact.damping=none --set run.start=centred --backend ode "
                         "--step 5us");
    assert_null(strstr(program->errors, "has no effect"));
}

static void a_stack_up_that_fails_says_so(void **state)
{
    Program *program = *state;
    program_run(program, "run --full $cases/paper/ideal-stackup.yaml --backend analytic "
                         "--set four-bar.follower.length='270.5 +- 200 mm' --set run.samples=90");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "\n  no tolerance stack-up: within its tolerances the crank does "
                                 "not always turn fully\n");
}

static void a_reader_that_goes_away_is_no_crash(void **state)
{
    Program *program = *state;
    char command[PROGRAM_PATH_SIZE * 2];
    snprintf(command, sizeof command,
             "cd '%s' && (\"$JOINTPLAY_PROGRAM\" run \"$JOINTPLAY_CASES/paper/ideal-nominal.yaml\" "
             "2>.errors; echo $? >.status) | true; sleep 0.3; cat .status >.output",
             program->folder);
    assert_int_equal(system(command), 0);
    char path[PROGRAM_PATH_SIZE];
    program_path(program, ".output", path);
    program_read(path, program->output);
    // the reader may have been fast enough to leave before, or not
    assert_true(strcmp(program->output, "5\n") == 0 || strcmp(program->output, "0\n") == 0);
    program_path(program, ".errors", path);
    program_read(path, program->errors);
    assert_string_equal(program->errors, "");
}

static void the_same_command_twice_prints_the_same_hash(void **state)
{
    Program *program = *state;
    char hashes[2][32];
    for (int i = 0; i < 2; i++) {
        program_run(program, "run --json $cases/paper/stackup-impact.yaml --backend ode "
                             "--set run.start=centred");
        json_t *root = program_json(program);
        const json_t *run = json_array_get(json_object_get(root, "runs"), 0);
        snprintf(hashes[i], sizeof hashes[i], "%s",
                 json_string_value(json_object_get(run, "hash")));
        json_decref(root);
    }
    assert_int_equal(strlen(hashes[0]), 16);
    assert_string_equal(hashes[0], hashes[1]);
}

// Bennett's follower turns about an axis that leans: about z alone it is slower.
static void rotation_in_space_is_that_of_the_whole_vector(void **state)
{
    Program *program = *state;
    static const char RUN[] = "run --full -q --uncertified --backend reference ";
    char words[PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "%s$cases/space/bennett.yaml --plot b.svg", RUN);
    program_run(program, words);
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Extremes of the motion about z");
    const char *about_z = strstr(program->output, "follower  reference");
    const char *whole = strstr(program->output, "Rotation in space, at the samples");
    assert_non_null(about_z);
    assert_non_null(whole);
    whole = strstr(whole, "follower  reference");
    assert_non_null(whole);
    about_z += strlen("follower  reference");
    whole += strlen("follower  reference");
    assert_true(strtod(whole, NULL) > 1.01 * strtod(about_z, NULL));
    // the control: with all axes along z there is nothing more to say
    snprintf(words, sizeof words, "%s$cases/space/offset-coupler.yaml", RUN);
    program_run(program, words);
    assert_int_equal(program->status, 0);
    assert_null(strstr(program->output, "Rotation in space"));
}

#define COMMAND_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        COMMAND_TEST(rotation_in_space_is_that_of_the_whole_vector),
        COMMAND_TEST(a_bad_case_ends_with_status_3_before_anything_runs),
        COMMAND_TEST(a_missing_case_ends_with_status_5),
        COMMAND_TEST(a_run_prints_extremes_error_and_cost),
        COMMAND_TEST(the_answer_is_there_before_the_engines),
        COMMAND_TEST(json_of_one_case_is_one_object),
        COMMAND_TEST(json_of_several_cases_is_a_list_of_them),
        COMMAND_TEST(settings_of_the_command_line_replace_those_of_the_case),
        COMMAND_TEST(a_direction_among_the_settings_is_a_list_and_a_tolerated_length_is_not),
        COMMAND_TEST(a_series_holds_a_row_a_sample),
        COMMAND_TEST(every_contact_has_a_row),
        COMMAND_TEST(a_folder_gets_all_there_is_to_know),
        COMMAND_TEST(two_cases_of_one_name_do_not_share_a_folder),
        COMMAND_TEST(a_failed_solver_ends_with_status_4_after_the_others_are_told),
        COMMAND_TEST(json_of_a_failed_run_holds_no_number),
        COMMAND_TEST(backlash_under_a_torque_that_turns_back_is_a_loop),
        COMMAND_TEST(a_full_disk_ends_with_status_5),
        COMMAND_TEST(nothing_half_written_stays_behind),
        COMMAND_TEST(what_nobody_can_have_meant_is_warned_of),
        COMMAND_TEST(settings_without_effect_are_said_a_line_each),
        COMMAND_TEST(a_stack_up_that_fails_says_so),
        COMMAND_TEST(a_reader_that_goes_away_is_no_crash),
        COMMAND_TEST(the_same_command_twice_prints_the_same_hash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
