// Does the program do what its command line asks for, and say what is wrong with one?
#include "program.h"

static void the_commands_are_listed(void **state)
{
    Program *program = *state;
    static const char *const WAYS[] = {"help", "--help", "-h"};
    for (int i = 0; i < 3; i++) {
        program_run(program, WAYS[i]);
        assert_int_equal(program->status, 0);
        assert_says(program->output, "\n  run ");
        assert_says(program->output, "\n  paper ");
        assert_says(program->output, "Exit status: 0 done");
        assert_string_equal(program->errors, "");
    }
}

static void the_versions_at_work_are_printed(void **state)
{
    Program *program = *state;
    program_run(program, "--version");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "jointplay ");
    assert_says(program->output, "ODE ");
    assert_says(program->output, "libccd ");
}

static void each_command_tells_how_it_is_used(void **state)
{
    Program *program = *state;
    program_run(program, "run --help");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Usage: jointplay run [OPTION...] CASE...");
    assert_says(program->output, "--set=KEY=VALUE");
    program_run(program, "help paper");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Usage: jointplay paper [OPTION...]");
    program_run(program, "help help");
    assert_says(program->output, "Usage: jointplay help [OPTION...] [case|COMMAND]");
}

static void the_case_format_is_described(void **state)
{
    Program *program = *state;
    program_run(program, "help case");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "restitution");
    program_run(program, "help case --markdown");
    assert_int_equal(program->status, 0);
    assert_int_equal(strncmp(program->output, "# ", 2), 0);
}

static void the_study_format_is_described_behind_the_options(void **state)
{
    Program *program = *state;
    program_run(program, "help study");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Usage: jointplay study [OPTION...] FILE");
    assert_says(program->output, "draw.method");
    program_run(program, "help study --markdown");
    assert_int_equal(program->status, 0);
    assert_int_equal(strncmp(program->output, "# The study file", 16), 0);
    // a command of it has options alone
    program_run(program, "help study status");
    assert_null(strstr(program->output, "draw.method"));
}

static void a_wrong_command_line_is_answered_with_what_may_be_meant(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "", "no command given");
    program_fails_usage(program, "-", "no command given");
    program_fails_usage(program, "rnu", "unknown command 'rnu'; did you mean 'run'?");
    program_fails_usage(program, "rn", "did you mean 'run'?");
    program_fails_usage(program, "simulate", "did you mean 'jointplay run'?");
    program_fails_usage(program, "frobnicate", "'jointplay help' lists the commands");
    program_fails_usage(program, "--verison", "did you mean '--version'?");
    program_fails_usage(program, "help papre", "did you mean 'paper'?");
    program_fails_usage(program, "help run paper", "one topic at a time");
    program_fails_usage(program, "run", "no case given");
    program_fails_usage(program, "run --stepp 1us a.yaml", "did you mean '--step'?");
    // an option of another command
    program_fails_usage(program, "run a.yaml --error 1e-3",
                        "did you mean 'jointplay tune --error'?");
    program_fails_usage(program, "tune a.yaml --tolerance 1e-3", "did you mean '--error'?");
    // a key of the case, given as if it were an option
    program_fails_usage(program, "run a.yaml --tolerance=1e-5",
                        "unknown option '--tolerance'; did you mean '--set run.tolerance=1e-5' or "
                        "'--set reference.tolerance=1e-5'?");
    program_fails_usage(program, "report case.yaml --out x.pdf",
                        "a page is written as HTML alone; allowed: x.html");
    program_fails_usage(program, "check --contact.restitution 0.8",
                        "did you mean '--set contact.restitution=VALUE'?");
    program_fails_usage(program, "tune a.yaml --radial-clearence 9um",
                        "did you mean '--set joints.NAME.radial-clearance=VALUE'?");
    // the control: a command without --set is offered none
    program_fails_usage(program, "paper --tolerance 1e-5", "'jointplay paper --help' lists");
    program_fails_usage(program, "run -x a.yaml", "unknown option '-x'");
    program_fails_usage(program, "run -qx a.yaml", "unknown option '-qx'");
    program_fails_usage(program, "run --step", "option '--step' needs a value");
    program_fails_usage(program, "run --json=1 a.yaml", "takes no value");
    program_fails_usage(program, "run a.yaml b.yaml --series s.csv", "--series takes one case");
    program_fails_usage(program, "run a.yaml b.yaml --contacts c.csv", "--contacts takes one case");
    program_fails_usage(program, "run a.yaml --series ./x --contacts x", "both write");
    program_fails_usage(program, "run a.yaml --columns time_s",
                        "--columns chooses from the series: give --series FILE.csv or --out DIR");
    program_fails_usage(
        program, "run $cases/paper/impact-k66.yaml --series s.csv --columns 'coupler_omga_*'",
        "--columns: no column is called 'coupler_omga_*'");
    program_fails_usage(program, "run a.yaml b.yaml --plot s.svg", "--plot takes one case");
    program_fails_usage(program, "run a.yaml --series x --plot ./x", "both write ./x");
    program_fails_usage(program, "run a.yaml --backend ''", "--backend names no backend");
    program_fails_usage(program, "paper --frobnicate", "unknown option '--frobnicate'");
    program_fails_usage(program, "paper here", "takes no argument");
}

static void a_wrong_setting_is_a_wrong_command_line(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "run $cases/paper/ideal-nominal.yaml --set run.stp=1us",
                        "did you mean 'step'?");
    program_fails_usage(program, "run $cases/paper/ideal-nominal.yaml --backend odee",
                        "did you mean 'ode'?");
    program_fails_usage(program, "run $cases/paper/ideal-nominal.yaml --step 5kg", "5kg");
    // a key or a joint without what stands above it
    program_fails_usage(program, "run $cases/paper/ideal-nominal.yaml --set hole=9mm",
                        "unknown key 'hole'; the key is joints.NAME.hole");
    program_fails_usage(program, "run $cases/paper/ideal-nominal.yaml --set friction=0.1",
                        "the key is joints.NAME.friction or contact.friction");
    program_fails_usage(program, "run $cases/paper/ideal-nominal.yaml --set crank.mass=1kg",
                        "the key is four-bar.crank");
    program_fails_usage(program, "run $cases/mechanisms/pendulum.yaml --set pivot.backlash=1deg",
                        "the key is joints.pivot");
}

static void a_file_that_is_missing_is_answered_with_one_that_is_there(void **state)
{
    Program *program = *state;
    program_run(program, "run $cases/paper/ideal-nomnal.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "No such file or directory; did you mean '");
    assert_says(program->errors, "/paper/ideal-nominal.yaml'?");
    // the control: nothing is near
    program_run(program, "run $cases/paper/my-linkage.yaml");
    assert_int_equal(program->status, 5);
    assert_null(strstr(program->errors, "did you mean"));
}

static void one_group_of_keys_is_described_alone(void **state)
{
    Program *program = *state;
    program_run(program, "help case joints");
    assert_int_equal(program->status, 0);
    assert_int_equal(strncmp(program->output, "joints\n", 7), 0);
    assert_says(program->output, "joints.<joint>.radial-clearance");
    assert_null(strstr(program->output, "run.step"));
    program_run(program, "help joints");
    assert_says(program->output, "joints.<joint>.radial-clearance");
    program_run(program, "help case friction-speed");
    assert_says(program->output, "contact.friction-speed");
    assert_says(program->output, "joints.<joint>.friction-speed");
    program_run(program, "help joints.hinge.friction");
    assert_says(program->output, "joints.<joint>.friction\n");
    assert_null(strstr(program->output, "contact."));
    program_run(program, "help case --all");
    assert_says(program->output, "joints.<joint>.radial-clearance");
    program_run(program, "help case expect");
    assert_says(program->output, "A limit is one of");
    program_fails_usage(program, "help case jonts", "did you mean 'joints'?");
    program_fails_usage(program, "help case nothing", "allowed: four-bar, ");
}

static void the_paper_is_recomputed(void **state)
{
    Program *program = *state;
    program_run(program, "paper --quiet");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Table");
    program_run(program, "paper --json");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    json_decref(root);
}

#define COMMAND_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        COMMAND_TEST(the_commands_are_listed),
        COMMAND_TEST(the_versions_at_work_are_printed),
        COMMAND_TEST(each_command_tells_how_it_is_used),
        COMMAND_TEST(the_case_format_is_described),
        COMMAND_TEST(the_study_format_is_described_behind_the_options),
        COMMAND_TEST(a_wrong_command_line_is_answered_with_what_may_be_meant),
        COMMAND_TEST(a_wrong_setting_is_a_wrong_command_line),
        COMMAND_TEST(a_file_that_is_missing_is_answered_with_one_that_is_there),
        COMMAND_TEST(one_group_of_keys_is_described_alone),
        COMMAND_TEST(the_paper_is_recomputed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
