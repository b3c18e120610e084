// Does `jointplay map` print, write and end as it should?
#include "program.h"

#include <math.h>

static const char PAPER[] = "map $cases/paper/impact-k66.yaml --set run.start=centred "
                            "--set contact.resting-speed=none --full ";

static void run_words(Program *program, const char *start, const char *more)
{
    char words[PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "%s%s", start, more);
    program_run(program, words);
}

static double number(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

static const char *word(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

static const json_t *first(const json_t *object, const char *key)
{
    return json_array_get(json_object_get(object, key), 0);
}

static void settings_figures_and_verdicts_are_printed(void **state)
{
    Program *program = *state;
    run_words(program, PAPER, "");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Settings");
    assert_says(program->output, "Predicted and delivered");
    assert_says(program->output, "textbook, 10 us: over-damped: asked 0.913, delivers 0.675; use");
    assert_says(program->output, "valid");
    assert_says(program->output, "the median of");
    assert_null(strchr(program->output, '\x1b'));
    assert_string_equal(program->errors,
                        "--penalty adds the paper's penalty parameter over its 15 speeds\n");
}

static void json_holds_every_setting(void **state)
{
    Program *program = *state;
    run_words(program, PAPER, "--json -q --steps '1 us, 10 us' --maps 'textbook, exact, impulse'");
    assert_int_equal(program->status, 0);
    assert_string_equal(program->errors, "");
    json_t *root = program_json(program);
    assert_non_null(json_object_get(root, "tool"));
    assert_non_null(json_object_get(root, "settings"));
    const json_t *contact = first(root, "contacts");
    assert_string_equal(word(contact, "joint"), "crank-coupler");
    assert_string_equal(word(contact, "mass_from"), "median");
    assert_true(number(contact, "mass_kg") == number(contact, "mass_median_kg"));
    assert_near(number(json_object_get(contact, "asked"), "restitution"), 0.9132, 1e-4);
    const json_t *rows = json_object_get(contact, "rows");
    assert_int_equal(json_array_size(rows), 6);
    for (size_t i = 0; i < 6; i++) {
        const json_t *row = json_array_get(rows, i);
        const json_t *predicted = json_object_get(row, "predicted");
        const json_t *delivered = json_object_get(row, "delivered");
        assert_string_equal(word(delivered, "status"), "ok");
        assert_near(number(row, "step_s"), i % 2 == 0 ? 1e-5 : 1e-6, 1e-18);
        assert_close(number(json_object_get(delivered, "force_max_N"), "mean"),
                     number(json_object_get(predicted, "force_max_N"), "mean"), 0.01);
    }
    assert_string_equal(word(json_array_get(rows, 0), "verdict"), "over-damped");
    assert_string_equal(word(json_array_get(rows, 1), "verdict"), "valid");
    assert_true(json_is_null(json_object_get(json_array_get(rows, 5), "erp")));
    json_decref(root);
}

static void mass_speed_and_law_can_be_given(void **state)
{
    Program *program = *state;
    run_words(program, PAPER,
              "--json --mass '0.2 kg' --speed '100 mm/s' --laws 'johnson, hertz-socket' "
              "--step '1 us' --maps corrected");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *contacts = json_object_get(root, "contacts");
    assert_int_equal(json_array_size(contacts), 2);
    assert_string_equal(word(json_array_get(contacts, 0), "law"), "johnson");
    assert_string_equal(word(json_array_get(contacts, 1), "law"), "hertz-socket");
    for (size_t i = 0; i < 2; i++) {
        const json_t *contact = json_array_get(contacts, i);
        assert_near(number(contact, "mass_kg"), 0.2, 0.0);
        assert_near(number(contact, "speed_m_s"), 0.1, 0.0);
        assert_string_equal(word(contact, "speed_from"), "given");
        assert_int_equal(json_array_size(json_object_get(contact, "rows")), 1);
    }
    json_decref(root);
}

// The sentence names the place where the limit is passed.
static void an_unstable_setting_says_where(void **state)
{
    Program *program = *state;
    run_words(program, PAPER, "--json -q --step '50 us' --maps corrected");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *row = first(first(root, "contacts"), "rows");
    assert_string_equal(word(row, "verdict"), "unstable");
    double reaches = 0.0;
    double limit = 0.0;
    assert_int_equal(sscanf(word(row, "words"),
                            "unstable: omega h reaches %lf where the limit is %lf", &reaches,
                            &limit),
                     2);
    assert_true(number(row, "omega_h") < limit && reaches >= limit);
    json_decref(root);
}

static void no_step_is_so_fine_that_it_is_tried_for_ever(void **state)
{
    Program *program = *state;
    run_words(program, PAPER, "--json -q --steps '1e-9 s, 1e-17 s' --maps corrected");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *rows = json_object_get(first(root, "contacts"), "rows");
    for (size_t i = 0; i < 2; i++) {
        const json_t *row = json_array_get(rows, i);
        assert_string_equal(word(row, "verdict"), "too-fine");
        assert_string_equal(word(json_object_get(row, "delivered"), "status"), "not run");
    }
    json_decref(root);
}

static void every_line_fits_a_terminal(void **state)
{
    Program *program = *state;
    static const char *const MORE[] = {"-q", "-q --laws all --steps '1 ms, 60 us, 10 us'"};
    for (size_t i = 0; i < sizeof MORE / sizeof *MORE; i++) {
        run_words(program, PAPER, MORE[i]);
        assert_int_equal(program->status, 0);
        for (const char *line = program->output; *line != '\0';) {
            const size_t length = strcspn(line, "\n");
            if (length > 80) {
                fail_msg("%zu columns: %.*s", length, (int)length, line);
            }
            line += length + (line[length] == '\n' ? 1 : 0);
        }
    }
}

// Without a case: stiffness, mass and a step are enough, and a step that is held gets the best
// constants there.
static void a_lone_contact_needs_no_case(void **state)
{
    Program *program = *state;
    program_run(program,
                "map --stiffness '1e9 N/m^1.5' --mass '0.1 kg' --at-step '1 ms' --json -q");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *contact = first(root, "contacts");
    assert_near(number(contact, "mass_kg"), 0.1, 0.0);
    assert_string_equal(word(contact, "speed_from"), "usual");
    // the Hertzian impact in closed form, without its damping: within a twentieth of it
    const double depth = pow(1.25 * 0.1 * 0.01 / 1e9, 0.4);
    assert_close(number(json_object_get(contact, "asked"), "penetration_max_m"), depth, 0.05);
    const json_t *best = json_object_get(contact, "best_constants");
    assert_near(number(best, "step_s"), 1e-3, 1e-12);
    const json_t *settings = json_object_get(best, "settings");
    assert_int_equal(json_array_size(settings), 3);
    for (size_t i = 0; i < 3; i++) {
        const json_t *setting = json_array_get(settings, i);
        const json_t *predicted = json_object_get(setting, "predicted");
        const json_t *delivered = json_object_get(setting, "delivered");
        assert_close(number(json_object_get(delivered, "restitution"), "mean"),
                     number(json_object_get(predicted, "restitution"), "mean"), 1e-6);
        assert_true(json_is_true(json_object_get(setting, "restitution_met")));
    }
    json_decref(root);
    program_run(program, "map --full --stiffness '1e9 N/m^1.5' --mass '0.1 kg' --at-step '1 ms'");
    assert_says(program->output, "Best constants at 1000 us");
    assert_says(program->output, "Gazebo: nothing is right at 1000 us");
    program_fails_usage(program, "map --stiffness '1e9 N/m'", "needs the effective mass");
    program_fails_usage(program, "map --stiffness '1e9 kg' --mass '1 kg'", "a stiffness such as");
    program_fails_usage(program, "map --stiffness '1 N/m' --mass most", "no run to take the mass");
    program_fails_usage(program, "map a.yaml --stiffness '1 N/m'", "contact without a case");
    program_fails_usage(program, "map a.yaml --at-step '1 ms' --step '1 s'", "the only step");
    program_fails_usage(program, "map a.yaml --restitution .5", "with --stiffness");
    program_fails_usage(program, "map --stiffness '1 N/m' --mass '1 kg' --laws all",
                        "--laws needs a case");
}

// What takes long is said before it begins, also where no progress is wanted: nobody waits for it
// here, the warning is read from a command that is ended.
static void long_work_is_announced(void **state)
{
    Program *program = *state;
    char line[4 * PROGRAM_PATH_SIZE];
    static const char *const STEPS[] = {"0.0053 us, 0.0054 us, 0.0055 us, 0.0056 us", "0.2 us"};
    for (int i = 0; i < 2; i++) {
        snprintf(line, sizeof line,
                 "cd '%s' && timeout 1 \"$JOINTPLAY_PROGRAM\" map -q --stiffness '1e9 N/m^1.5' "
                 "--mass '0.1 kg' --steps '%s' >table 2>words; true",
                 program->folder, STEPS[i]);
        assert_int_equal(system(line), 0);
        char path[PROGRAM_PATH_SIZE];
        program_path(program, "words", path);
        program_read(path, program->errors);
        if (i == 0) {
            assert_says(program->errors, "warning: running the settings in ODE takes about");
        } else {
            // control: what is short is not announced
            assert_string_equal(program->errors, "");
        }
    }
}

static void files_are_written_where_they_are_wanted(void **state)
{
    Program *program = *state;
    run_words(program, PAPER, "--out made/here --csv rows.csv --plot curves.svg --steps '10 us'");
    assert_int_equal(program->status, 0);
    static const char *const NAMES[] = {"made/here/impact-k66-map.txt",
                                        "rows.csv",
                                        "curves.svg",
                                        "made/here/impact-k66-map.csv",
                                        "made/here/impact-k66-map.svg",
                                        "made/here/impact-k66-map.json"};
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
        char path[PROGRAM_PATH_SIZE];
        program_path(program, NAMES[i], path);
        assert_int_equal(access(path, R_OK), 0);
        assert_says(program->errors, NAMES[i]);
    }
    static char rows[PROGRAM_OUTPUT_SIZE];
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "rows.csv", path);
    program_read(path, rows);
    assert_says(rows, "joint,law,map,step_s,mass_kg");
    assert_says(rows, "crank-coupler,stiffness,corrected,1");
    size_t commas = 0;
    for (const char *at = rows; *at != '\n'; at++) {
        commas += *at == ',' ? 1 : 0;
    }
    assert_int_equal(commas, 26);
}

// A pendulum each: joints are not limited in number, and the mass of each is that of its bob.
static void every_one_of_many_joints_is_mapped(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "many.yaml", path);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "title: many\nbodies:\n");
    enum { COUNT = 40 };
    for (int i = 0; i < COUNT; i++) {
        fprintf(file, "  bob-%d: {mass: %d g, inertia: 1e-4 kg m^2, at: [0 m, 0 m]}\n", i, 100 + i);
    }
    fprintf(file, "joints:\n");
    for (int i = 0; i < COUNT; i++) {
        fprintf(file,
                "  pin-%d: {between: [ground, bob-%d], at: [0 m, 0 m], hole: 11 mm, pin: 10 mm}\n",
                i, i);
    }
    fprintf(file, "gravity: 9.81 m/s^2\ncontact: {stiffness: 1e8 N/m^1.5, restitution: 0.6}\n"
                  "run: {duration: 15 ms, samples: 10, step: 100 us}\n");
    fclose(file);
    program_run(program, "map many.yaml --json -q --steps '100 us' --maps midpoint");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *contacts = json_object_get(root, "contacts");
    assert_int_equal(json_array_size(contacts), COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        assert_near(number(json_array_get(contacts, i), "mass_kg"), 0.1 + 1e-3 * (double)i, 1e-9);
    }
    json_decref(root);
}

// A floor that is met, and a ceiling that never is.
static void a_joint_that_never_touches_hides_no_other(void **state)
{
    Program *program = *state;
    static const char CASE[] =
        "bodies:\n  ball: {mass: 1 kg, inertia: 100 kg mm^2, at: [0 mm, 10 mm]}\n"
        "joints:\n"
        "  floor: {between: [ground, ball], at-a: [0 mm, 0 mm], at-b: [0 mm, 10 mm], normal: 90 "
        "deg}\n"
        "  roof: {between: [ground, ball], at-a: [0 mm, 90 mm], at-b: [0 mm, 10 mm], normal: -90 "
        "deg}\n"
        "contact: {stiffness: 1e7 N/m, damping: exact, restitution: 0.5}\n"
        "run: {duration: 80 ms, samples: 100}\n";
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "ball.yaml", path);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(CASE, file);
    fclose(file);
    program_run(program, "map ball.yaml --full -q --steps '10 us' --maps midpoint");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "floor, K = 1e+07 N/m\n");
    assert_says(program->output, "roof, given stiffness\n");
    assert_says(program->output, "not mapped  no contact of the case's run begins with a closing");
    assert_says(program->output, "midpoint    10");
    // the control: where none touches there is nothing to map
    program_run(program, "map ball.yaml --full -q --set run.duration='10 ms'");
    assert_int_equal(program->status, 2);
    assert_says(program->errors, "floor: no contact of the case's run begins with a closing speed");
}

static void the_velocity_level_model_has_rows_of_its_own(void **state)
{
    Program *program = *state;
    program_run(program, "map $cases/paper/stackup-poisson.yaml --json -q");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *contact = first(root, "contacts");
    assert_string_equal(word(contact, "law"), "poisson");
    const json_t *row = first(contact, "rows");
    assert_string_equal(word(row, "map"), "poisson");
    assert_near(number(row, "cfm_m_N_s"), 1.0 / 973330.0, 1e-18);
    json_decref(root);
    program_fails_usage(program, "map $cases/paper/stackup-poisson.yaml --maps textbook",
                        "know no map and no elastic law");
}

static void a_law_that_no_joint_can_have_is_said(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "map $cases/mechanisms/servo-backlash.yaml -q --laws johnson",
                        "output: its stiffness is its own: the law johnson is for a pin in its "
                        "hole");
}

static void what_turns_has_its_impact_in_rad_s(void **state)
{
    Program *program = *state;
    program_run(program, "map $cases/mechanisms/servo-backlash.yaml -q --maps textbook "
                         "--steps '100 us'");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "  rad/s        us\n");
    assert_null(strstr(program->output, "  m/s  "));
}

static void the_papers_penalty_stands_beside_its_approach(void **state)
{
    Program *program = *state;
    run_words(program, PAPER, "--penalty --json -q --step '1 us' --maps textbook");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *penalty = json_object_get(root, "penalty");
    const json_t *rows = json_object_get(penalty, "rows");
    assert_int_equal(json_array_size(rows), 15);
    const json_t *row = json_array_get(rows, 9);
    assert_near(number(row, "speed_rpm"), 1000.0, 1e-9);
    // Tables II and III at 1000 rpm
    assert_near(number(row, "penalty_printed_N"), 973.33, 5e-3);
    assert_near(number(row, "approach_m"), 0.194e-6, 5e-11);
    assert_close(number(row, "penalty_cfm_m_N_s"), 1.0 / 973330.0, 1e-5);
    // read as a stiffness it has a viscous damper, whatever damping the case has: the depth of a
    // damped harmonic oscillator
    const double mass = number(row, "mass_kg"), stiffness = number(row, "stiffness_N_m");
    const double rate = sqrt(stiffness / mass);
    const double share = number(row, "damping_N_s_m") / (2.0 * mass * rate);
    const double turn = sqrt(1.0 - share * share);
    const double deepest =
        number(row, "speed_m_s") / rate * exp(-share / turn * atan2(turn, share));
    assert_close(number(json_object_get(row, "asked"), "penetration_max_m"), deepest, 1e-8);
    // a stiffness of P is soft: the pin goes in a hundred times the approach
    const json_t *delivered = json_object_get(row, "delivered_as_stiffness");
    const double depth = number(json_object_get(delivered, "penetration_max_m"), "mean");
    assert_close(depth, number(json_object_get(row, "asked"), "penetration_max_m"), 0.01);
    assert_true(depth > 100.0 * number(row, "approach_m"));
    json_decref(root);
    run_words(program, "map $cases/literature/pin-in-hole-drop.yaml ", "--penalty --step '1 us'");
    assert_int_equal(program->status, 3);
    assert_says(program->errors, "--penalty is for a driven four-bar");
}

static void a_row_is_read_as_spring_and_damper(void **state)
{
    Program *program = *state;
    program_run(program, "map --erp 0.2 --cfm 1e-5 --step '1 ms' --mass '0.1 kg' --json");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *mass = first(root, "masses");
    const json_t *textbook = first(mass, "readings");
    assert_close(number(textbook, "stiffness_N_m"), 2e7, 1e-12);
    assert_close(number(textbook, "damping_N_s_m"), 8e4, 1e-12);
    assert_close(number(mass, "delivered_restitution"), number(mass, "predicted_restitution"),
                 1e-6);
    json_decref(root);
    // Gazebo's pair, on the masses of a case
    program_run(program, "map --kp '1e7 N/m' --kd 10 --step '1 us' $cases/paper/impact-k66.yaml");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "ERP = 0.5, CFM = 0.05");
    assert_says(program->output, "the median of crank-coupler");
}

static void what_stands_for_no_spring_is_said_to(void **state)
{
    Program *program = *state;
    program_run(program, "map --erp 1.5 --cfm 1e-5 --step '1 ms' --mass '0.1 kg'");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "an ERP above 1 would be a negative damper");
    program_run(program, "map --erp 0 --cfm 1e-5 --step '1 ms' --mass '0.1 kg'");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "no spring: nothing is pressed out again");
    program_run(program, "map --erp 0.2 --cfm 1e-5 --step '1 ms'");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "needs the mass");
    program_fails_usage(program, "map --erp 0.2 --cfm 0 --step '1 ms'", "--cfm is 0");
    program_fails_usage(program, "map --erp -1 --cfm 1 --step '1 ms'", "--erp is -1");
    program_fails_usage(program, "map --erp 1e308 --cfm 1e308 --step '1 ms' --mass '0.1 kg'",
                        "no contact of numbers");
    program_fails_usage(program, "map --kp 0 --kd 0 --step '1 ms'", "--kp and --kd");
}

static void wrong_command_lines_end_with_status_2(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "map", "no case given");
    program_fails_usage(program, "map a.yaml b.yaml", "map takes one case");
    program_fails_usage(program, "map --erp 0.2 --step '1 ms'", "--cfm is missing");
    program_fails_usage(program, "map --kd 1 --step '1 ms'", "--kp is missing");
    program_fails_usage(program, "map --erp .2 --cfm 1 --kp 1 --kd 1", "not of both");
    program_fails_usage(program, "map --erp .2 --cfm 1", "at one step only");
    program_fails_usage(program, "map --erp .2 --cfm 1 --step '1 s' --plot a.svg", "reads one row");
    program_fails_usage(program, "map a.yaml --step '1 us' --steps '2 us'", "give either");
    program_fails_usage(program, "map a.yaml --csv x --plot x", "would both write x");
    program_fails_usage(program, "map --kp '1e7 N/m^1.5' --kd 1 --step '1 s'", "linear spring");
    program_fails_usage(program, "map --kp soft --kd 1 --step '1 s'", "--kp:");
    static const struct {
        const char *more;
        const char *message;
    } WRONG[] = {
        {"--steps ''", "the list is empty"},
        {"--steps '1 us, 1 us'", "is given twice"},
        {"--steps '1 kg'", "--steps:"},
        {"--maps texbook", "'texbook' is none of them; allowed: textbook"},
        {"--maps 'exact, exact'", "is given twice"},
        {"--laws hooke", "'hooke' is none of them"},
        {"--mass heavy", "--mass:"},
        {"--mass '-1 kg'", "--mass:"},
        {"--speed '0 m/s'", "is not above 0"},
        {"--set contact.restituion=1", "restitution"},
    };
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        char words[PROGRAM_PATH_SIZE];
        snprintf(words, sizeof words, "%s%s", PAPER, WRONG[i].more);
        program_fails_usage(program, words, WRONG[i].message);
    }
}

static void a_case_without_play_has_nothing_to_map(void **state)
{
    Program *program = *state;
    program_run(program, "map $cases/paper/ideal-nominal.yaml");
    assert_int_equal(program->status, 3);
    assert_says(program->errors, "no joint of");
    assert_says(program->errors, "has play");
    assert_string_equal(program->output, "");
    program_run(program, "map missing.yaml");
    assert_int_equal(program->status, 5);
    run_words(program, PAPER, "--csv /nowhere/x.csv");
    assert_int_equal(program->status, 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(settings_figures_and_verdicts_are_printed, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(json_holds_every_setting, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(mass_speed_and_law_can_be_given, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(every_one_of_many_joints_is_mapped, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_joint_that_never_touches_hides_no_other, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(an_unstable_setting_says_where, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(no_step_is_so_fine_that_it_is_tried_for_ever,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(every_line_fits_a_terminal, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_lone_contact_needs_no_case, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(long_work_is_announced, program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(files_are_written_where_they_are_wanted, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(the_velocity_level_model_has_rows_of_its_own,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(what_turns_has_its_impact_in_rad_s, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_law_that_no_joint_can_have_is_said, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(the_papers_penalty_stands_beside_its_approach,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(a_row_is_read_as_spring_and_damper, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(what_stands_for_no_spring_is_said_to, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(wrong_command_lines_end_with_status_2, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_case_without_play_has_nothing_to_map, program_set_up,
                                        program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
