// Is what `run` says first of a settled motion that of the whole motion, and how sure it is?
#include "program.h"

#include <math.h>

// A slider-crank in which the pin of the slider does not repeat.
static const char SLIDER[] = "title: Slider-crank\n"
                             "slider-crank:\n"
                             "  crank:  {length: 50 mm,  mass: 0.30 kg, inertia: 100 kg mm^2}\n"
                             "  rod:    {length: 120 mm, mass: 0.21 kg, inertia: 250 kg mm^2}\n"
                             "  slider: {mass: 0.14 kg, inertia: 100 kg mm^2}\n"
                             "joints:\n"
                             "  rod-slider: {hole: 20.4 mm, pin: 20 mm, width: 20 mm}\n"
                             "drive: {speed: 600 rpm}\n"
                             "contact: {restitution: 0.7}\n"
                             "run: {revolutions: 1, samples: 360, backends: [reference]}\n";

// Gears under a transmission error, which settle in one of two motions. The drive's angle
// is 1e-4 (1 - cos(80 rad/s t)) / 2 rad.
static const char GEARS[] =
    "title: Gears\n"
    "gravity: 0 m/s^2\n"
    "bodies:\n"
    "  pinion: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0 m, 0 m]}\n"
    "  wheel: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0.2 m, 0 m], spin: 0 rad/s}\n"
    "joints:\n"
    "  shaft-a: {between: [ground, pinion], at: [0 m, 0 m]}\n"
    "  shaft-b: {between: [ground, wheel], at: [0.2 m, 0 m]}\n"
    "  mesh: {gears: [shaft-a, shaft-b], teeth: [20, 20], backlash: 0.2 mm, stiffness: 1e4 N/m}\n"
    "torsion-springs:\n"
    "  oil: {joint: shaft-b, damping: 0.1 N m s/rad}\n"
    "loads:\n"
    "  load: {joint: shaft-b, torque: 0.01 N m}\n";

enum { GEAR_POINTS = 31 };

static FILE *open_case(const Program *program, const char *name)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    return stream;
}

static void write_slider(const Program *program)
{
    FILE *stream = open_case(program, "slider.yaml");
    fputs(SLIDER, stream);
    fclose(stream);
}

static void write_gears(const Program *program)
{
    const double pi = acos(-1.0);
    FILE *stream = open_case(program, "gears.yaml");
    fprintf(stream, "%sdrive:\n  joint: shaft-a\n  profile: spline\n  angle: [", GEARS);
    for (int k = 0; k < GEAR_POINTS; k++) {
        const double phase = 2.0 * pi * k / (GEAR_POINTS - 1);
        fprintf(stream, "%s[%.12g s, %.12g rad]", k > 0 ? ", " : "", phase / 80.0,
                0.5e-4 * (1.0 - cos(phase)));
    }
    fprintf(stream, "]\n  period: %.12g s\ncontact: {restitution: 1}\n", 2.0 * pi / 80.0);
    fprintf(stream, "run: {duration: %.12g s, samples: 360, backends: [reference]}\n",
            2.0 * pi / 80.0);
    fclose(stream);
}

static json_t *run_json(Program *program, const char *words)
{
    program_run(program, words);
    assert_int_equal(program->status, 0);
    return program_json(program);
}

static double number_at(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

static const json_t *overview_joint(const json_t *root)
{
    return json_array_get(json_object_get(json_object_get(root, "overview"), "joints"), 0);
}

static const json_t *settled_joint(const json_t *root)
{
    return json_array_get(json_object_get(json_object_get(root, "settled"), "joints"), 0);
}

static int ascending(const void *a, const void *b)
{
    const double first = *(const double *)a;
    const double second = *(const double *)b;
    return (first > second) - (first < second);
}

enum { TURNS = 200, TURNS_FIRST = 40 };

static const double TURN_S = 0.1; // at 600 rpm

// The largest force of each of the later revolutions of a long run from the start as written, in
// order, from the table of its contacts.
static void find_largest_forces(Program *program, double largest[TURNS - TURNS_FIRST])
{
    char path[PROGRAM_PATH_SIZE];
    program_run(program, "run slider.yaml -q --uncertified --contacts c.csv --set "
                         "run.start=centred --set run.revolutions=200 --set run.samples=400 ");
    assert_int_equal(program->status, 0);
    program_path(program, "c.csv", path);
    FILE *stream = fopen(path, "r");
    assert_non_null(stream);
    char line[4096];
    size_t rows = 0;
    assert_non_null(fgets(line, sizeof line, stream));
    assert_non_null(strstr(line, "joint,onset_s,duration_s,peak_s,onset_crank_deg,force_max_N,"));
    while (fgets(line, sizeof line, stream) != NULL) {
        double peak_s;
        double force;
        assert_int_equal(sscanf(line, "%*[^,],%*[^,],%*[^,],%lf,%*[^,],%lf", &peak_s, &force), 2);
        const int turn = (int)(peak_s / TURN_S) - TURNS_FIRST;
        if (turn >= 0 && turn < TURNS - TURNS_FIRST) {
            largest[turn] = fmax(largest[turn], force);
        }
        rows++;
    }
    fclose(stream);
    assert_true(rows > TURNS);
    qsort(largest, TURNS - TURNS_FIRST, sizeof *largest, ascending);
}

// An end of the 95 % interval of a quantile: the value whose rank is so many standard deviations of
// the binomial distribution above the quantile's own.
static double quantile_end(const double largest[TURNS - TURNS_FIRST], double share,
                           double deviations)
{
    const double count = TURNS - TURNS_FIRST;
    const double rank = share * count + deviations * sqrt(share * (1.0 - share) * count);
    return largest[(size_t)fmin(fmax(rank, 0.0), count - 1.0)];
}

static double quantile_low(const double largest[TURNS - TURNS_FIRST], double share)
{
    return quantile_end(largest, share, -1.96);
}

static double quantile_high(const double largest[TURNS - TURNS_FIRST], double share)
{
    return quantile_end(largest, share, 1.96);
}

// The truth is a run of 200 revolutions from the start as written, whose contacts say what the
// largest force of each is. Its own quantile is as unsure as the stated one: its 95 % interval, by
// ranks, meets the stated interval. The control is that of the median, which lies below.
static void a_motion_that_does_not_repeat_has_the_numbers_of_its_distribution(void **state)
{
    Program *program = *state;
    write_slider(program);
    json_t *root = run_json(program, "run slider.yaml -q --json --set run.settle-starts=4 --set "
                                     "run.settle-most=100 --set run.settle-budget='600 s'");
    const json_t *row = overview_joint(root);
    const double headline = number_at(row, "force_max_N");
    const double low = number_at(row, "force_max_low_N");
    const double high = number_at(row, "force_max_high_N");
    assert_true(headline == number_at(settled_joint(root), "force_max_N"));
    assert_true(low < headline && headline < high);
    assert_true(number_at(row, "force_median_N") < low);
    assert_true(number_at(row, "force_largest_N") >= headline);
    assert_true(json_is_null(json_object_get(row, "force_max_crank_deg")));
    double largest[TURNS - TURNS_FIRST] = {0.0};
    find_largest_forces(program, largest);
    assert_true(quantile_low(largest, 0.95) <= high && quantile_high(largest, 0.95) >= low);
    assert_true(quantile_high(largest, 0.5) < low);
    json_decref(root);
}

static void its_screen_says_how_sure_that_is(void **state)
{
    Program *program = *state;
    write_slider(program);
    program_run(program, "run slider.yaml -q --set run.settle-starts=4 --set run.settle-most=60 "
                         "--set run.settle-budget='600 s'");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "50 %  most  times  impacts  contact  deepest");
    assert_says(program->output, "Does not repeat in 60 revolutions of each of 4 starts; a longer "
                                 "transient cannot be ruled out. 4 of 4 starts move so (95 % "
                                 "sure: at least 40 % of all do).");
    assert_says(program->output, "95 %, 50 %: quantiles of a turn's largest; +-: 95 % interval; "
                                 "most: in ");
    assert_null(strstr(program->output, "settle-budget"));
    program_run(program, "run slider.yaml -q --full --set run.settle-starts=4 --set "
                         "run.settle-most=60 --set run.settle-budget='600 s'");
    assert_says(program->output, "start       settled: Does not repeat in 60 revolutions of each");
    assert_says(program->output, "rod-slider: largest of a revolution, of ");
    // other commands have no table with its numbers
    program_run(program, "map slider.yaml -q --set run.settle-starts=4 --set run.settle-most=60 "
                         "--set run.settle-budget='600 s'");
    assert_says(program->output, "Largest force of a revolution, 95 % quantile (its interval): "
                                 "rod-slider ");
}

static void a_spent_budget_is_said(void **state)
{
    Program *program = *state;
    write_slider(program);
    program_run(program, "run slider.yaml -q --set run.settle-budget='2 s'");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "run.settle-budget (2 s) ended the search by then; ");
    assert_says(program->output, " of 16 are undecided.");
    json_t *root = run_json(program, "run slider.yaml -q --json --set run.settle-budget='2 s'");
    const json_t *settled = json_object_get(root, "settled");
    assert_true(json_is_true(json_object_get(settled, "is_spent")));
    assert_true(number_at(settled, "starts_decided") < number_at(settled, "starts_tried"));
    json_decref(root);
}

#define PERIOD_2                                                                                   \
    "run $cases/paper/stackup-impact.yaml -q --json --backend reference --set "                    \
    "contact.resting-speed='150 mm/s' --set run.settle-starts=2 --set run.revolutions="

// The truth is a run of both revolutions. The control is what a run of one finds by itself.
static void a_motion_of_two_revolutions_has_the_largest_of_both(void **state)
{
    Program *program = *state;
    json_t *one = run_json(program, PERIOD_2 "1");
    json_t *two = run_json(program, PERIOD_2 "2");
    assert_true(number_at(json_object_get(one, "settled"), "period") == 2.0);
    const json_t *runs = json_object_get(two, "runs");
    const json_t *joint =
        json_object_get(json_object_get(json_array_get(runs, 0), "joints"), "crank-coupler");
    const double truth = number_at(joint, "force_max_N");
    const json_t *row = overview_joint(one);
    // a peak of the settled motion is as exact as the motion: to 1e-7 of it, and some more
    assert_close(number_at(row, "force_max_N"), truth, 1e-6);
    assert_close(number_at(row, "impacts_per_revolution"), 0.5 * number_at(joint, "impacts"),
                 1e-12);
    assert_close(number_at(row, "penetration_max_m"), number_at(joint, "penetration_max_m"), 1e-6);
    // the share is of a revolution whose end is another
    assert_close(number_at(row, "contact_fraction"), number_at(joint, "contact_fraction"), 1e-4);
    const json_t *alone =
        json_object_get(json_object_get(json_array_get(json_object_get(one, "runs"), 0), "joints"),
                        "crank-coupler");
    assert_true(number_at(alone, "force_max_N") < (1.0 - 1e-3) * truth);
    json_decref(one);
    json_decref(two);
    program_run(program, "run $cases/paper/stackup-impact.yaml -q --backend reference --set "
                         "contact.resting-speed='150 mm/s' --set run.settle-starts=2");
    assert_says(program->output, "Settled motion, which repeats every 2 revolutions, all of which "
                                 "the table is of (pictures of all: run.revolutions: 2);");
}

// The truth is a long run from a start that comes to the other motion. The control is the case from
// that start, whose motion no other is louder than.
static void a_louder_motion_is_said_in_the_first_line(void **state)
{
    Program *program = *state;
    write_gears(program);
    program_run(program, "run gears.yaml -q --set run.settle-starts=4");
    assert_int_equal(program->status, 0);
    const char *line = strstr(program->output, "\n\n  case");
    assert_non_null(line);
    line = strchr(line + 2, '\n');
    assert_non_null(line);
    assert_int_equal(strncmp(line,
                             "\n\n  Louder: 2 of 4 starts (7 to 93 %) come to another motion: "
                             "mesh 333 mN, 1.8\n  times the 187 mN below.\n",
                             strlen("\n\n  Louder: 2 of 4 starts")),
                     0);
    assert_says(program->output,
                "come to another motion: mesh 333 mN, 1.8 times the 187 mN below.");
    json_t *found = run_json(program, "run gears.yaml -q --json --set run.settle-starts=4");
    const json_t *louder = json_object_get(json_object_get(found, "settled"), "louder");
    json_t *truth = run_json(program, "run gears.yaml -q --json --set run.start=centred --set "
                                      "bodies.wheel.spin='0.12 rad/s' --set run.duration='8 s' "
                                      "--set run.report-from='7.9 s'");
    assert_close(number_at(louder, "force_max_N"), number_at(overview_joint(truth), "force_max_N"),
                 1e-4);
    assert_string_equal(json_string_value(json_object_get(louder, "joint")), "mesh");
    json_decref(found);
    json_decref(truth);
    program_run(program, "run gears.yaml -q --set bodies.wheel.spin='0.12 rad/s' --set "
                         "run.settle-starts=1");
    assert_null(strstr(program->output, "Louder"));
}

#define WORDS_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        WORDS_TEST(a_motion_that_does_not_repeat_has_the_numbers_of_its_distribution),
        WORDS_TEST(its_screen_says_how_sure_that_is),
        WORDS_TEST(a_spent_budget_is_said),
        WORDS_TEST(a_motion_of_two_revolutions_has_the_largest_of_both),
        WORDS_TEST(a_louder_motion_is_said_in_the_first_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
