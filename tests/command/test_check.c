// Does `jointplay check` see what moved, name it, and never pass what it could not look at?
#include "program.h"

#include <signal.h>

// A pin that bounces in its hole: some milliseconds of work.
static const char CASE[] =
    "title: A pin\n"
    "bodies:\n  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}\n"
    "joints:\n  hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 20.2 mm, pin: 20 mm, "
    "width: 15 mm}\n"
    "gravity: 9.80665 m/s^2\n"
    "contact: {stiffness: 6.6e10 N/m^1.5, damping: lankarani-nikravesh, restitution: 0.9}\n"
    "run: {duration: 12 ms, samples: 100, step: 5 us, backends: [reference, ode]}\n"
    "ode: {stepping: plain, map: textbook}\n";

// The paper's crank-rocker at a step at which ODE leaves the range of its law.
static const char FAILS[] =
    "title: Too coarse a step\n"
    "four-bar:\n  ground: {length: 254 mm}\n"
    "  crank: {length: 108 mm, mass: 0.12 kg, inertia: 173.92 kg mm^2}\n"
    "  coupler: {length: 279.4 mm, mass: 0.29 kg, inertia: 2070.46 kg mm^2}\n"
    "  follower: {length: 270.5 mm, mass: 0.28 kg, inertia: 1988.39 kg mm^2}\n"
    "joints:\n  crank-coupler: {hole: 10.015 mm, pin: 9.986 mm, width: 13 mm}\n"
    "drive: {speed: 1000 rpm}\n"
    "contact: {stiffness: 1e11 N/m^1.5, damping: lankarani-nikravesh, restitution: 0.9}\n"
    "run: {revolutions: 1, samples: 3600, step: 1 ms, backends: [reference, ode]}\n"
    "ode: {stepping: plain, map: textbook}\n";

static void write_file(const Program *program, const char *name, const char *text)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs(text, stream);
    fclose(stream);
}

static void read_file(const Program *program, const char *name, char *target)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    program_read(path, target);
}

// A folder with a case and its baseline.
static int set_up(void **state)
{
    if (program_set_up(state) != 0) {
        return -1;
    }
    Program *program = *state;
    write_file(program, "pin.yaml", CASE);
    program_run(program, "check --bless --baselines b pin.yaml");
    return program->status;
}

static void a_case_that_has_not_changed_is_within(void **state)
{
    Program *program = *state;
    // made by the set-up: of a first baseline nothing has moved, and nothing was unreadable
    assert_says(program->output, "  new baseline: ");
    assert_says(program->output, "1 case: 1 new, 0 replaced, 0 unchanged");
    assert_true(strstr(program->output, "could not be read") == NULL);
    assert_true(strstr(program->output, "moved") == NULL);
    program_run(program, "check --baselines b");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "pin.yaml");
    assert_says(program->output, "1 case: 1 within, 0 out");
    assert_string_equal(program->errors, "");
    program_run(program, "check --baselines b pin.yaml --quick --all");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "ode/hole/force_max_N");
    assert_says(program->output, "left out");
    assert_says(program->output, "quick: no ensembles, no orders");
}

static void another_machine_is_no_difference(void **state)
{
    Program *program = *state;
    for (int seed = 1; seed <= 5; seed++) {
        char words[PROGRAM_PATH_SIZE];
        snprintf(words, sizeof words, "check --baselines b --quick --shake %d --all", seed);
        program_run(program, words);
        assert_int_equal(program->status, 0);
        assert_says(program->output, "left out");
    }
}

// A name that begins as strtod's infinity does is a name.
static void a_name_is_no_number(void **state)
{
    Program *program = *state;
    char named[sizeof CASE + 64];
    const char *pin = strstr(CASE, "pin: {mass");
    snprintf(named, sizeof named, "%.*sinfeed%s", (int)(pin - CASE), CASE, pin + 3);
    char *between = strstr(named, "[ground, pin]");
    memmove(between + 16, between + 13, strlen(between + 13) + 1);
    memcpy(between, "[ground, infeed]", 16);
    write_file(program, "infeed.yaml", named);
    program_run(program, "check --bless --baselines c infeed.yaml");
    assert_int_equal(program->status, 0);
    program_run(program, "check --baselines c infeed.yaml");
    assert_int_equal(program->status, 0);
}

static void what_moved_is_named_with_status_1(void **state)
{
    Program *program = *state;
    program_run(program, "check --baselines b --set contact.restitution=0.89");
    assert_int_equal(program->status, 1);
    assert_says(program->errors, "1 of 1 cases differ from their baselines; pin.yaml: setting "
                                 "contact.restitution was 0.9, is 0.89");
    assert_says(program->output, "ode/hole/impulse_N_s");
    assert_says(program->output, "1 case: 0 within, 1 out");
    program_run(program, "check --baselines b --json --quick --set contact.restitution=0.89");
    assert_int_equal(program->status, 1);
    json_t *root = program_json(program);
    const json_t *item = json_array_get(json_object_get(root, "cases"), 0);
    assert_string_equal(json_string_value(json_object_get(item, "status")), "out");
    const json_t *worst = json_array_get(json_object_get(item, "metrics"), 0);
    assert_string_equal(json_string_value(json_object_get(worst, "verdict")), "setting");
    json_decref(root);
}

static void a_number_edited_in_the_file_is_named(void **state)
{
    Program *program = *state;
    static char text[PROGRAM_OUTPUT_SIZE];
    read_file(program, "b/pin.json", text);
    char *line = strstr(text, "\"ode/hole/force_max_N\": {\"value\": ");
    assert_non_null(line);
    // the digit behind the third: 1 in 1000 or more
    char *digit = line + strlen("\"ode/hole/force_max_N\": {\"value\": ") + 4;
    *digit = *digit == '9' ? '8' : (char)(*digit + 1);
    write_file(program, "b/pin.json", text);
    program_run(program, "check --baselines b --quick");
    assert_int_equal(program->status, 1);
    assert_says(program->errors, "pin.yaml: ode/hole/force_max_N was ");
    assert_says(program->errors, ", allowed ");
    // and blessing says what it moved back
    program_run(program, "check --baselines b --bless");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "ode/hole/force_max_N");
    assert_says(program->output, "  replaced: 1 of ");
    assert_says(program->output, " numbers moved");
    assert_says(program->output, "1 case: 0 new, 1 replaced, 0 unchanged");
    program_run(program, "check --baselines b --quick");
    assert_int_equal(program->status, 0);
}

static void a_baseline_says_what_it_is_to_the_one_before(void **state)
{
    Program *program = *state;
    program_run(program, "check --baselines b --bless");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "  unchanged: ");
    assert_says(program->output, "1 case: 0 new, 0 replaced, 1 unchanged");
    write_file(program, "b/pin.json", "{\n  \"format\": \"jointplay baseline 2\",\n  \"case\": ");
    program_run(program, "check --baselines b --bless --json pin.yaml");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *item = json_array_get(json_object_get(root, "cases"), 0);
    assert_string_equal(json_string_value(json_object_get(item, "change")), "unreadable");
    assert_true(json_integer_value(json_object_get(item, "numbers")) > 10);
    json_decref(root);
}

// A word of which strtod makes no number although a digit stands in it.
static void a_name_of_dashes_and_a_digit_ends(void **state)
{
    Program *program = *state;
    char named[sizeof CASE + 64];
    const char *pin = strstr(CASE, "pin: {mass");
    snprintf(named, sizeof named, "%.*s--2%s", (int)(pin - CASE), CASE, pin + 3);
    memcpy(strstr(named, "[ground, pin]"), "[ground, --2]", 13);
    write_file(program, "dashes.yaml", named);
    program_run(program, "check --bless --baselines c dashes.yaml");
    assert_int_equal(program->status, 0);
    program_run(program, "check --baselines c --quick dashes.yaml");
    assert_int_equal(program->status, 0);
}

// The number of --jobs is often written for another machine.
static void more_jobs_than_processors_are_allowed(void **state)
{
    Program *program = *state;
    program_run(program, "check --baselines b --quick --jobs 256");
    assert_int_equal(program->status, 0);
    assert_string_equal(program->errors, "");
    program_fails_usage(program, "check --jobs 257", "--jobs is 257; allowed: a whole number");
}

// Starts the program by itself, making a baseline with one process at a time.
static pid_t start_blessing(const Program *program)
{
    const pid_t process = fork();
    if (process == 0) {
        const char *path = getenv("JOINTPLAY_PROGRAM");
        if (chdir(program->folder) != 0 || freopen(".output", "w", stdout) == NULL ||
            freopen(".errors", "w", stderr) == NULL) {
            _exit(99);
        }
        signal(SIGINT, SIG_DFL);
        execl(path, path, "check", "--bless", "--baselines", "c", "slow.yaml", "--jobs", "1",
              (char *)NULL);
        _exit(99);
    }
    return process;
}

// Lines of the file of kept starts: its key, the plan, then a start each.
static size_t count_lines(const Program *program)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "c/slow.json.partial", path);
    FILE *stream = fopen(path, "r");
    size_t lines = 0;
    for (int c = EOF; stream != NULL && (c = getc(stream)) != EOF;) {
        lines += c == '\n' ? 1 : 0;
    }
    if (stream != NULL) {
        fclose(stream);
    }
    return lines;
}

// Ends the making of a baseline by a signal as soon as two more starts are kept.
static int stop_blessing(const Program *program, int number)
{
    int status = 0;
    const size_t before = count_lines(program);
    const pid_t process = start_blessing(program);
    while (count_lines(program) < (before < 2 ? 4 : before + 2) &&
           waitpid(process, &status, WNOHANG) == 0) {
        usleep(5000);
    }
    kill(process, number);
    waitpid(process, &status, 0);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

static void a_baseline_that_was_stopped_goes_on_where_it_stood(void **state)
{
    Program *program = *state;
    static char first[PROGRAM_OUTPUT_SIZE];
    static char second[PROGRAM_OUTPUT_SIZE];
    char path[PROGRAM_PATH_SIZE];
    char slow[sizeof CASE + 16];
    const char *step = strstr(CASE, "step: 5 us");
    snprintf(slow, sizeof slow, "%.*sstep: 0.5 us%s", (int)(step - CASE), CASE, step + 10);
    write_file(program, "slow.yaml", slow);

    // killed without a word, and told to stop
    assert_int_equal(stop_blessing(program, SIGKILL), SIGKILL);
    assert_int_equal(stop_blessing(program, SIGINT), SIGINT);
    program_path(program, ".errors", path);
    program_read(path, program->errors);
    assert_says(program->errors, "slow.yaml: 2 measured starts are kept in c/slow.json.partial: "
                                 "going on from there");
    program_path(program, ".output", path);
    program_read(path, program->output);
    assert_says(program->output, "no new baseline: stopped; ");
    assert_says(program->output, " measured starts are kept in c/slow.json.partial, and the same "
                                 "command goes on from there");
    program_path(program, "c/slow.json", path);
    assert_int_equal(access(path, F_OK), -1);

    // what was kept is not measured again, and the baseline is that of nobody who was stopped
    program_run(program, "check --bless --baselines c slow.yaml");
    assert_int_equal(program->status, 0);
    assert_says(program->errors, " measured starts are kept in c/slow.json.partial: going on");
    assert_int_equal(count_lines(program), 0);
    read_file(program, "c/slow.json", first);
    program_run(program, "check --bless --baselines d slow.yaml -q");
    assert_int_equal(program->status, 0);
    read_file(program, "d/slow.json", second);
    assert_string_equal(first, second);

    // starts of another state of the case are none of this one
    assert_int_equal(stop_blessing(program, SIGKILL), SIGKILL);
    write_file(program, "slow.yaml", CASE);
    program_run(program, "check --bless --baselines c slow.yaml");
    assert_int_equal(program->status, 0);
    assert_true(strstr(program->errors, "going on") == NULL);
    assert_says(program->output, "1 setting changed");
}

// At 80 columns every number that is out says what it was, is and may be, and every setting is
// named.
static void what_moved_says_was_and_is(void **state)
{
    Program *program = *state;
    program_run(program, "check --baselines b --quick --set contact.restitution=0.89 "
                         "--set 'run.step=49 us' --junit out.xml");
    assert_int_equal(program->status, 1);
    assert_says(program->errors, "setting contact.restitution was 0.9, is 0.89; setting run.step");
    assert_says(program->output, "baseline              now     difference        allowed\n");
    assert_true(strstr(program->output, "bands off") == NULL);
    char xml[PROGRAM_OUTPUT_SIZE];
    read_file(program, "out.xml", xml);
    assert_says(xml, "ode/cost/steps");
    assert_true(strstr(xml, "constraint_rows") == NULL);
    // bands of one's own, which settings do not share
    program_run(program, "check --baselines b --quick --rel 100%");
    assert_int_equal(program->status, 0);
    program_run(program, "check --baselines b --quick --rel 0.5 --set 'run.step=49.9 us' --all");
    assert_int_equal(program->status, 1);
    assert_says(program->errors, "setting run.step was");
    program_fails_usage(program, "check --rel 0", "--rel is 0; allowed: a share such as 1%");
    program_fails_usage(program, "check --bless --rel 1% pin.yaml", "goes with neither --bless");
}

// In a wrong folder, or with a forgotten --baselines, nothing else is checked in its place.
static void the_programs_own_baselines_are_for_those_who_ask(void **state)
{
    Program *program = *state;
    program_run(program, "check --quick");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "no baselines to compare with: /");
    assert_says(program->errors, "/results/baseline is not there; --baselines names");
    program_run(program, "check --quick ideal-nominal");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "there is no baseline results/baseline/ideal-nominal.json of your "
                                 "own for ");
    program_run(program, "check --quick --shipped ideal-nominal");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "1 case: 1 within");
    // the same beside baselines of one's own
    program_run(program, "check --bless pin.yaml -q");
    assert_int_equal(program->status, 0);
    program_run(program, "check --quick --shipped ideal-nominal");
    assert_int_equal(program->status, 0);
    program_run(program, "check --quick --shipped pin.yaml");
    assert_int_equal(program->status, 5);
    program_fails_usage(program, "check --shipped --baselines b",
                        "it does not go with --baselines");
    program_fails_usage(program, "check --shipped --bless pin.yaml", "it does not go with --bless");
}

static void what_cannot_be_checked_never_passes(void **state)
{
    Program *program = *state;
    write_file(program, "other.yaml", CASE);
    program_run(program, "check --baselines b other.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "there is no baseline b/other.json");
    program_run(program, "check --baselines nowhere");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "/nowhere is not there; --baselines names another folder");
    program_run(program, "check --baselines .");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "/. has no file that ends in .json");

    // of another case
    assert_int_equal(system("true"), 0);
    char words[2 * PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "mkdir '%s/far' && cp '%s/pin.yaml' '%s/far/'", program->folder,
             program->folder, program->folder);
    assert_int_equal(system(words), 0);
    program_run(program, "check --baselines b far/pin.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "is of another case: of ../pin.yaml");
    program_run(program, "check --baselines b far/pin.yaml pin.yaml");
    assert_int_equal(program->status, 2);
    assert_says(program->errors, "would both have the baseline");

    // whose case is gone
    snprintf(words, sizeof words, "mv '%s/pin.yaml' '%s/moved.yaml'", program->folder,
             program->folder);
    assert_int_equal(system(words), 0);
    program_run(program, "check --baselines b");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "is not there");
    // that is no case any more
    write_file(program, "pin.yaml", "title: nothing\n");
    program_run(program, "check --baselines b");
    assert_int_equal(program->status, 3);
    // damaged, beside one that is whole: the whole one is checked all the same
    write_file(program, "pin.yaml", CASE);
    write_file(program, "b/a.json", "{}");
    program_run(program, "check --baselines b");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "the baseline b/a.json is not one of this program, or damaged");
    assert_says(program->output, "1 within, 0 out, 1 not checked");
}

static void a_run_that_fails_is_an_error_and_blesses_nothing(void **state)
{
    Program *program = *state;
    static char before[PROGRAM_OUTPUT_SIZE];
    static char after[PROGRAM_OUTPUT_SIZE];
    read_file(program, "b/pin.json", before);
    write_file(program, "fails.yaml", FAILS);
    program_run(program, "check --bless --baselines b fails.yaml");
    assert_int_equal(program->status, 4);
    assert_says(program->errors, "fails.yaml: no baseline of a run that fails: ode failed");
    // and what to do about it
    assert_says(program->errors, "; change the case until jointplay run completes it; one that is "
                                 "meant to end so states it under expect: and needs no baseline");
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "b/fails.json", path);
    assert_int_equal(access(path, F_OK), -1);
    program_run(program, "check --baselines b --time-limit 1us");
    assert_int_equal(program->status, 4);
    assert_says(program->errors, "pin.yaml: its process took longer than its limit");
    program_run(program, "check --bless --baselines b --time-limit 1us");
    assert_int_equal(program->status, 4);
    read_file(program, "b/pin.json", after);
    assert_string_equal(after, before);
}

// Whether xmllint, where there is one, finds a file to be as the schema says.
static void assert_valid(const Program *program, const char *name)
{
    if (getenv("JOINTPLAY_XMLLINT") == NULL || getenv("JOINTPLAY_XMLLINT")[0] == '\0') {
        print_message("# no xmllint: %s was not held against the schema\n", name);
        return;
    }
    char words[4 * PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words,
             "\"$JOINTPLAY_XMLLINT\" --noout --schema \"$JOINTPLAY_JUNIT\" '%s/%s' 2>/dev/null",
             program->folder, name);
    assert_int_equal(system(words), 0);
    // the control: a report of which a name is missing is not valid
    snprintf(
        words, sizeof words,
        "cd '%s' && sed 's/ classname=/ class=/' '%s' >broken.xml && "
        "! \"$JOINTPLAY_XMLLINT\" --noout --schema \"$JOINTPLAY_JUNIT\" broken.xml 2>/dev/null",
        program->folder, name);
    assert_int_equal(system(words), 0);
}

static void junit_is_valid_and_has_the_numbers_of_a_failure(void **state)
{
    Program *program = *state;
    static char text[PROGRAM_OUTPUT_SIZE];
    program_run(program, "check --baselines b --quick --junit good.xml");
    assert_int_equal(program->status, 0);
    assert_says(program->errors, "wrote good.xml");
    assert_valid(program, "good.xml");
    read_file(program, "good.xml", text);
    assert_says(text, "failures=\"0\" errors=\"0\"");
    assert_says(text, "<testcase classname=\"pin\" name=\"ode/hole/force_max_N\" time=\"0.000\"/>");
    assert_says(text, "<testcase classname=\"pin\" name=\"runs\" time=\"");
    assert_true(strstr(text, "name=\"runs\" time=\"0.000\"") == NULL);
    assert_says(text, "<skipped message=");

    program_run(program, "check --baselines b -q --junit bad.xml --set run.step='5.5 us'");
    assert_int_equal(program->status, 1);
    assert_string_equal(strstr(program->errors, "wrote") == NULL ? "" : "wrote", "");
    assert_valid(program, "bad.xml");
    read_file(program, "bad.xml", text);
    assert_says(text, "name=\"setting/run/step\"");
    assert_says(text, "setting run.step was 5e-06 s, is 5.5");
    assert_says(text, "<failure message=\"ode/hole/impulse_N_s was ");
    assert_says(text, ", allowed ");

    // a case in error is there as well
    write_file(program, "b/a&b.json", "{}");
    program_run(program, "check --baselines b -q --quick --junit error.xml");
    assert_int_equal(program->status, 5);
    assert_valid(program, "error.xml");
    read_file(program, "error.xml", text);
    assert_says(text, "<error message=");
    assert_says(text, "classname=\"b.a&amp;b\" name=\"runs\"");
    program_run(program, "check --baselines b --junit nowhere/x.xml");
    assert_int_equal(program->status, 5);
    assert_string_equal(program->output, "");
}

// Jenkins takes what stands before the last dot for a package.
static void the_class_of_a_case_has_dots_between_folders_alone(void **state)
{
    Program *program = *state;
    static char text[PROGRAM_OUTPUT_SIZE];
    char words[4 * PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "mkdir -p '%s/some.cases' && cp '%s/pin.yaml' '%s/%s'",
             program->folder, program->folder, program->folder, "some.cases/pin.v2.yaml");
    assert_int_equal(system(words), 0);
    program_run(program, "check --bless -q --baselines c ./some.cases/../some.cases/pin.v2.yaml "
                         "--junit new.xml");
    assert_int_equal(program->status, 0);
    assert_valid(program, "new.xml");
    read_file(program, "new.xml", text);
    assert_says(text, "<testsuite name=\"some_cases.some_cases.pin_v2\" tests=\"1\"");
    assert_says(text, "classname=\"some_cases.some_cases.pin_v2\" name=\"runs\"");
}

// A case of one's own with limits, and no baseline anywhere.
static void write_guarded(const Program *program, const char *name, const char *limits)
{
    char text[sizeof CASE + 1024];
    snprintf(text, sizeof text, "%sexpect:\n%s", CASE, limits);
    write_file(program, name, text);
}

static void limits_of_its_own_judge_a_case_without_a_baseline(void **state)
{
    Program *program = *state;
    static char text[PROGRAM_OUTPUT_SIZE];
    write_guarded(program, "guarded.yaml",
                  "  joints.hole.force_max: below 100 kN\n"
                  "  joints.hole.impacts: between 1 and 100\n"
                  "  ode.joints.hole.penetration_max: above 0 um\n"
                  "  error.omega_max: below 2\n"
                  "  ode.cost.steps: within 10 % of 2400\n");
    program_run(program, "check guarded.yaml --junit good.xml --baselines nowhere");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "7 of 7 limits kept");
    assert_says(program->output, "there is no baseline nowhere/guarded.json: judged by its limits");
    assert_valid(program, "good.xml");
    read_file(program, "good.xml", text);
    assert_says(text, "name=\"expect/ode/joints/hole/force_max\" time=\"0.000\"/>");
    assert_says(text, "name=\"baseline\" time=\"0.000\">\n      <skipped message=");

    // what is out, by how much, in the unit of the limit
    write_guarded(program, "guarded.yaml",
                  "  ode.joints.hole.force_max: below 0.1 N\n"
                  "  ode.joints.hole.impacts: equals 0\n"
                  "  analytic.joints.hole.force_max: below 1 kN\n");
    program_run(program, "check guarded.yaml --expect-only --junit bad.xml");
    assert_int_equal(program->status, 1);
    assert_says(program->errors, "1 of 1 cases out of limits or bands; guarded.yaml: "
                                 "ode.joints.hole.force_max is ");
    assert_says(program->errors, " N, expected below 0.1 N: ");
    assert_says(program->errors, " N too high (");
    assert_says(program->output, "0 of 3 limits kept");
    assert_says(program->output, "not measured");
    assert_valid(program, "bad.xml");
    read_file(program, "bad.xml", text);
    assert_says(text, "failures=\"3\"");
    assert_says(text, "<failure message=\"ode.joints.hole.impacts is ");
    assert_says(text, "<failure message=\"analytic.joints.hole.force_max is not measured, expected "
                      "below 1 kN\"");
    program_run(program, "check guarded.yaml --expect-only --json");
    assert_int_equal(program->status, 1);
    json_t *root = program_json(program);
    const json_t *item = json_array_get(json_object_get(root, "cases"), 0);
    const json_t *limit = json_array_get(json_object_get(item, "limits"), 0);
    assert_string_equal(json_string_value(json_object_get(limit, "verdict")), "out");
    const double value = json_number_value(json_object_get(limit, "value"));
    const double off = json_number_value(json_object_get(limit, "outside_by"));
    assert_close(value - off, 0.1, 1e-9);
    json_decref(root);
}

// The rod of a slider-crank, r / l = 1/4, turns by asin(sin(crank) / 4), whose first harmonic has
// the amplitude 1/4 + (1/4)^3 / 8 + 3 (1/4)^5 / 64 + ..., and no second.
static void limits_of_orders_and_sections_are_those_of_the_rod(void **state)
{
    Program *program = *state;
    static const char ROD[] =
        "slider-crank:\n  crank: {length: 50 mm, mass: 0.1 kg, inertia: 20 kg mm^2}\n"
        "  rod: {length: 200 mm, mass: 0.1 kg, inertia: 300 kg mm^2}\n"
        "  slider: {mass: 0.2 kg, inertia: 20 kg mm^2}\n"
        "drive: {speed: 1000 rpm}\n"
        "run: {revolutions: 3, samples: 720, backends: [analytic]}\n"
        "expect:\n"
        "  bodies.rod.omega_order_1: within 0.001 % of 26.3896 rad/s\n"
        "  bodies.rod.omega_order_2: below 1e-9 rad/s\n"
        "  bodies.rod.omega_between_orders: below 1e-9 rad/s\n"
        "  bodies.rod.omega_section: within 0.001 % of -26.1799 rad/s\n"
        "  section.period: equals 1\n"
        "  section.change: below 1e-9\n";
    write_file(program, "rod.yaml", ROD);
    program_run(program, "check rod.yaml --expect-only");
    assert_says(program->output, "6 of 6 limits kept");
    assert_int_equal(program->status, 0);
    // the control: one revolution cannot tell its period
    char text[sizeof ROD];
    snprintf(text, sizeof text, "%s", ROD);
    strstr(text, "revolutions: 3")[13] = '1';
    write_file(program, "rod.yaml", text);
    program_run(program, "check rod.yaml --expect-only");
    assert_int_equal(program->status, 1);
    assert_says(program->errors, "section.period is not measured");
}

// The paper's mechanism settles in one motion, in which a small change dies out by what a run finds
// of it. The control is a limit below that.
static void limits_of_the_settled_motion_are_judged_once_a_case(void **state)
{
    Program *program = *state;
    char words[4 * PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "cp '%s/paper/stackup-impact.yaml' '%s/paper.yaml'",
             getenv("JOINTPLAY_CASES"), program->folder);
    assert_int_equal(system(words), 0);
    program_run(program, "run paper.yaml -q --json --backend reference");
    json_t *root = program_json(program);
    const json_t *found = json_object_get(root, "settled");
    const double growth = json_number_value(json_object_get(found, "growth_per_revolution"));
    const double force = json_number_value(
        json_object_get(json_array_get(json_object_get(found, "joints"), 0), "force_max_N"));
    json_decref(root);
    assert_true(growth > 0.0 && growth < 1.0);
    assert_true(force > 0.0);
    for (int k = 0; k < 2; k++) {
        const double share = k == 0 ? 1.0 : 1.2; // of what is found, in the middle of 10 %
        snprintf(
            words, sizeof words,
            "printf 'expect:\n  settled.growth: within 10 %%%% of %.6g\n  settled.motions: equals "
            "1\n  settled.period: equals 1\n  settled.share: above 0.9\n  "
            "settled.joints.crank-coupler.force_max: within 0.1 %%%% of %.8g N\n  "
            "settled.joints.crank-coupler.force_median: above %.8g N\n  "
            "settled.joints.crank-coupler.force_largest: below 1 MN\n' | cat "
            "'%s/paper/stackup-impact.yaml' - > '%s/paper.yaml'",
            share * growth, force, 0.99 * share * force, getenv("JOINTPLAY_CASES"),
            program->folder);
        assert_int_equal(system(words), 0);
        program_run(program, "check paper.yaml --expect-only -q");
        assert_int_equal(program->status, k);
        assert_says(program->output, k == 0 ? "7 of 7 limits kept" : "5 of 7 limits kept");
    }
}

static void limits_stand_beside_a_baseline_and_are_no_setting_of_it(void **state)
{
    Program *program = *state;
    // the baseline was made without them
    write_guarded(program, "pin.yaml", "  joints.hole.force_max: below 100 kN\n");
    program_run(program, "check --baselines b --quick");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "2 of 2 limits kept");
    write_guarded(program, "pin.yaml", "  joints.hole.force_max: below 1 mN\n");
    program_run(program, "check --baselines b --quick --markdown -");
    assert_int_equal(program->status, 1);
    assert_says(program->errors, "expected below 1 mN");
    assert_says(program->output, "**`pin.yaml`**: limits of its own");
    // and a case that sets none cannot be judged by them
    write_file(program, "pin.yaml", CASE);
    program_run(program, "check --expect-only pin.yaml");
    assert_int_equal(program->status, 3);
    assert_says(program->errors, "pin.yaml sets no limits: it has no expect:");
    program_fails_usage(program, "check --expect-only", "--expect-only takes the cases to check");
    program_fails_usage(program, "check --expect-only --bless pin.yaml", "one of them, not both");
}

static void a_comment_is_short_and_folds_the_rest(void **state)
{
    Program *program = *state;
    static char text[PROGRAM_OUTPUT_SIZE];
    program_run(program, "check --baselines b --quick --markdown -");
    assert_int_equal(program->status, 0);
    assert_int_equal(strncmp(program->output, "### jointplay check: 1 case within its bands\n", 45),
                     0);
    assert_says(program->output, "<details><summary>All cases (quick check)</summary>");
    program_run(program, "check --baselines b --quick --markdown c.md --set gravity='9.8 m/s^2'");
    assert_int_equal(program->status, 1);
    read_file(program, "c.md", text);
    assert_says(text, "### jointplay check: 1 of 1 cases out of their bands");
    assert_says(text, "| `gravity` | `9.80665 m/s^2` | `9.8");
    assert_says(text, "and ");
    // a case that cannot be read has a row without numbers
    write_file(program, "pin.yaml", "title: nothing else\n");
    program_run(program, "check --baselines b --quick --markdown c.md");
    assert_true(program->status > 1);
    read_file(program, "c.md", text);
    assert_says(text, "| `pin.yaml` | | | | not checked |\n");
}

static void a_wrong_command_line_is_answered(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "check --quik", "did you mean '--quick'?");
    program_fails_usage(program, "check --bless --quick", "--bless measures in full");
    program_fails_usage(program, "check --shake 0", "--shake is 0");
    program_fails_usage(program, "check --junit x --markdown x", "would both write x");
    program_fails_usage(program, "check --baselines b --set run.stp=1us", "run.stp");
    program_fails_usage(program, "check --bless --baselines b --set run.step=1us",
                        "does not go with --set");
    program_fails_usage(program, "check --baselines b --json --markdown -", "--json");
    program_run(program, "check nowhere.yaml");
    assert_int_equal(program->status, 5);
    program_run(program, "check --help");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Usage: jointplay check [OPTION...] [CASE...]");
}

#define CHECK_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, program_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CHECK_TEST(a_case_that_has_not_changed_is_within),
        CHECK_TEST(another_machine_is_no_difference),
        CHECK_TEST(a_name_is_no_number),
        CHECK_TEST(what_moved_is_named_with_status_1),
        CHECK_TEST(a_number_edited_in_the_file_is_named),
        CHECK_TEST(a_baseline_says_what_it_is_to_the_one_before),
        CHECK_TEST(a_name_of_dashes_and_a_digit_ends),
        CHECK_TEST(more_jobs_than_processors_are_allowed),
        CHECK_TEST(a_baseline_that_was_stopped_goes_on_where_it_stood),
        CHECK_TEST(what_moved_says_was_and_is),
        CHECK_TEST(the_programs_own_baselines_are_for_those_who_ask),
        CHECK_TEST(what_cannot_be_checked_never_passes),
        CHECK_TEST(a_run_that_fails_is_an_error_and_blesses_nothing),
        CHECK_TEST(junit_is_valid_and_has_the_numbers_of_a_failure),
        CHECK_TEST(the_class_of_a_case_has_dots_between_folders_alone),
        CHECK_TEST(limits_of_its_own_judge_a_case_without_a_baseline),
        CHECK_TEST(limits_of_orders_and_sections_are_those_of_the_rod),
        CHECK_TEST(limits_of_the_settled_motion_are_judged_once_a_case),
        CHECK_TEST(limits_stand_beside_a_baseline_and_are_no_setting_of_it),
        CHECK_TEST(a_comment_is_short_and_folds_the_rest),
        CHECK_TEST(a_wrong_command_line_is_answered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
