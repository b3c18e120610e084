// Do all messages and tables fit a terminal of 80 columns, and do they name what to do?
#include "program.h"

enum { WIDTH_MAX = 80 };

static size_t count_characters(const char *line)
{
    size_t count = 0;
    for (; *line != '\0'; line++) {
        count += ((unsigned char)*line & 0xc0u) != 0x80u ? 1 : 0;
    }
    return count;
}

// A line that holds a path is as long as the path: the folder of cases may be anywhere.
static void expect_narrow(const char *text, const char *words)
{
    const char *folder = getenv("JOINTPLAY_CASES");
    while (*text != '\0') {
        const size_t length = strcspn(text, "\n");
        char line[1024];
        snprintf(line, sizeof line, "%.*s", (int)length, text);
        if (count_characters(line) > WIDTH_MAX && strstr(line, folder) == NULL) {
            fail_msg("%s: a line of %d columns: %s", words, (int)count_characters(line), line);
        }
        text += length + (text[length] == '\n' ? 1 : 0);
    }
}

static void every_line_fits_a_terminal(void **state)
{
    Program *program = *state;
    static const char *const WORDS[] = {
        "run $cases/paper/impact-k66.yaml --step '10 us'",
        "run $cases/paper/ideal-stackup.yaml",
        "run $cases/paper/stackup-impact.yaml --step '10 us'",
        "run $cases/paper/stackup-poisson.yaml --step '10 us' --backend ode",
        "run $cases/literature/four-bar-half-mm.yaml --step '10 us' --backend analytic,ode",
        "run $cases/literature/pin-in-hole-drop.yaml --step '10 us'",
        "run $cases/literature/parallelogram.yaml --step '10 us' --set run.revolutions=0.2",
        "run $cases/literature/three-clearances.yaml --step '10 us' --backend ode",
        ("compare $cases/paper/impact-k66.yaml --steps '50 us, 20 us' --fresh "
         "--set run.revolutions=0.2"),
        "map $cases/paper/impact-k66.yaml --steps '30 us, 1 us'",
        "map $cases/literature/three-clearances.yaml --steps '30 us'",
        "map --erp 0.2 --cfm 1e-6 --step '1 ms' --mass '0.1 kg'",
        ("tune $cases/paper/impact-k66.yaml --error 2e-2 --schemes direct/plain "
         "--set run.revolutions=0.1"),
        "check --baselines b --bless $cases/paper/ideal-nominal.yaml --all",
        "study $cases/studies/stackup-monte-carlo.yaml --dry-run",
        "study $cases/studies/clearance-spikes.yaml --dry-run",
        "paper",
        "help",
        "help case",
        "help study",
        "run --help",
        "compare --help",
        "map --help",
        "tune --help",
        "check --help",
        "study --help",
        "help study status",
        "help study export",
        "help study merge",
        "help study plot",
        "help study slurm",
        "paper --help",
        "report --help",
        "new --help",
    };
    for (size_t i = 0; i < sizeof WORDS / sizeof WORDS[0]; i++) {
        program_run(program, WORDS[i]);
        if (program->status > 1) {
            fail_msg("%s: status %d: %s", WORDS[i], program->status, program->errors);
        }
        assert_true(program->output[0] != '\0');
        expect_narrow(program->output, WORDS[i]);
    }
}

static void wide_tables_have_what_was_left_out(void **state)
{
    Program *program = *state;
    program_run(program, "run --full $cases/paper/impact-k66.yaml --step '20 us'");
    assert_says(program->output, "--wide shows them: at time, omega max");
    assert_null(strstr(program->output, "alpha max  angle max"));
    program_run(program, "run $cases/paper/impact-k66.yaml --step '20 us' --wide");
    assert_null(strstr(program->output, "--wide shows"));
    assert_says(program->output, "alpha max  angle max");
}

static void errors_stand_before_theory(void **state)
{
    Program *program = *state;
    program_run(program, "run --full $cases/paper/impact-k66.yaml --step '20 us' "
                         "--backend analytic,reference,ode");
    const char *errors = strstr(program->output, "Error at the samples");
    const char *extremes = strstr(program->output, "Extremes of the motion");
    const char *theory = strstr(program->output, "Kinematics of the ideal four-bar");
    assert_true(errors != NULL && extremes != NULL && theory != NULL);
    assert_true(errors < extremes && extremes < theory);
    assert_says(program->output, "The paper's bands");
    // anybody's four-bar is not the paper's
    program_run(program, "run --full $cases/paper/impact-k66.yaml --step '20 us' "
                         "--set four-bar.follower.length='271 mm'");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Spikes of the signals");
    assert_null(strstr(program->output, "bands"));
}

static void a_file_of_the_other_kind_names_its_command(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "run $cases/studies/mapping.yaml", "allowed: jointplay study");
    program_fails_usage(program, "study $cases/paper/impact-k66.yaml", "allowed: jointplay run");
}

static void a_case_may_come_from_standard_input(void **state)
{
    Program *program = *state;
    program_run(program, "run - -q --backend ode --step '20 us' --out o "
                         "< $cases/paper/impact-k66.yaml");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "case        stdin");
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "o/stdin.json", path);
    assert_int_equal(access(path, R_OK), 0);
    // compare reads the case again for each of its steps
    program_run(program, "compare - -q --fresh --steps '50 us, 20 us' --schemes "
                         "direct/plain/textbook < $cases/paper/impact-k66.yaml");
    assert_int_equal(program->status, 0);
    program_fails_usage(program, "study -", "its store has the file's name");
    program_run(program, "run - -q </dev/null");
    assert_int_equal(program->status, 3);
    assert_says(program->errors, "stdin: the file is empty");
}

static void a_picture_is_svg(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "run $cases/paper/impact-k66.yaml --plot x.png", "allowed: x.svg");
    program_fails_usage(program, "compare $cases/paper/impact-k66.yaml --plot x.pdf",
                        "allowed: x.svg");
    program_fails_usage(program, "map $cases/paper/impact-k66.yaml --plot x.png", "allowed: x.svg");
    program_run(program, "run $cases/paper/ideal-nominal.yaml -q --plot x.SVG");
    assert_int_equal(program->status, 0);
}

static void a_slip_of_the_finger_is_understood(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "help cas", "did you mean 'case'?");
    program_fails_usage(program, "help studdy", "did you mean 'study'?");
    program_fails_usage(program, "rnu", "did you mean 'run'?");
    program_fails_usage(program, "run --plto x", "did you mean '--plot'?");
    program_fails_usage(program, "study statsu x.sqlite", "did you mean 'jointplay study status'?");
}

static void a_run_without_a_contact_says_so(void **state)
{
    Program *program = *state;
    program_run(program, "run --full $cases/literature/pin-in-hole-drop.yaml --step '20 us' "
                         "--set run.duration='2 ms' --backend ode");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "hole, ode: no contact in the whole run.");
    assert_says(program->output, "the run of 2 ms is too short");
    // the control: it lands after 4.5 ms
    program_run(program, "run --full $cases/literature/pin-in-hole-drop.yaml --step '20 us' "
                         "--set run.duration='6 ms' --backend ode");
    assert_null(strstr(program->output, "no contact"));
}

static void a_joint_far_from_its_bodies_is_doubted(void **state)
{
    Program *program = *state;
    program_run(program, "run --full $cases/literature/pin-in-hole-drop.yaml --step '20 us' "
                         "--set joints.hole.at='[900 mm, 0 mm]' --backend ode "
                         "--set run.duration='2 ms'");
    assert_says(program->errors, "warning: joint 'hole' is 0.9 m from the centre of mass of 'pin'");
    program_run(program, "run --full $cases/literature/pin-in-hole-drop.yaml --step '20 us' "
                         "--backend ode --set run.duration='2 ms'");
    assert_null(strstr(program->errors, "warning"));
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)
    const struct CMUnitTest tests[] = {
        TEST(every_line_fits_a_terminal),
        TEST(wide_tables_have_what_was_left_out),
        TEST(errors_stand_before_theory),
        TEST(a_file_of_the_other_kind_names_its_command),
        TEST(a_case_may_come_from_standard_input),
        TEST(a_picture_is_svg),
        TEST(a_slip_of_the_finger_is_understood),
        TEST(a_run_without_a_contact_says_so),
        TEST(a_joint_far_from_its_bodies_is_doubted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
