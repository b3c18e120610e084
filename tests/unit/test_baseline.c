// Does a baseline that was written say the same when read, and is everything wrong in it found?
//
// Each single number of a baseline is edited, one by one, by more than its band and by less: the
// first must be named, the second must pass.
#include "base/lcg.h"
#include "load_case.h"
#include "scratch.h"

#include "commands/check/baseline.h"
#include "commands/check/check_judge.h"
#include "commands/check/check_report.h"
#include "kept.h"

#include <jansson.h>
#include <string.h>

// A case measured once: its baseline as made, and as a file.
typedef struct Bench {
    char path[256];
    Scenario scenario;
    CheckMeasure run;
    CheckMeasure members[2];
    Baseline made;
    CheckRow *rows;
} Bench;

static void measure(Bench *bench, unsigned member, CheckMeasure *target)
{
    const CheckPlan plan = {.has_truth = true, .uncertainty = 1e-7, .is_full = false};
    Scenario scenario = kept_copy(&bench->scenario);
    if (member > 0) {
        check_measure_start(&scenario, baseline_rounding_start(member));
    }
    check_measure(&scenario, &plan, target);
    assert_true(target->is_complete);
}

// Two members in place of eight keep the test short; a band is as good as any for editing.
static int set_up(void **state)
{
    Bench *bench = calloc(1, sizeof *bench);
    assert_non_null(bench);
    const char *const coarse[] = {"run.step=10 us", "ode.stepping=plain"};
    bench->scenario = load("cases/literature/pin-in-hole-drop.yaml", coarse, 2);
    scratch_path("baseline.json", bench->path, sizeof bench->path);
    measure(bench, 0, &bench->run);
    measure(bench, 1, &bench->members[0]);
    measure(bench, 2, &bench->members[1]);
    const CheckPlan plan = {.has_truth = true, .uncertainty = 1e-7, .is_full = true};
    Err err = {0};
    baseline_begin(&bench->made, &bench->scenario);
    bench->made.plan = plan;
    snprintf(bench->made.case_path, sizeof bench->made.case_path, "drop.yaml");
    assert_true(baseline_set_metrics(&bench->made, &bench->run, bench->members, 2, &err));
    assert_true(baseline_json_write(bench->path, &bench->made, &err));
    bench->rows = calloc(2048, sizeof *bench->rows);
    assert_non_null(bench->rows);
    *state = bench;
    return 0;
}

static int tear_down(void **state)
{
    Bench *bench = *state;
    unlink(bench->path);
    baseline_finish(&bench->made);
    check_measure_finish(&bench->run);
    check_measure_finish(&bench->members[0]);
    check_measure_finish(&bench->members[1]);
    free(bench->rows);
    free(bench);
    return 0;
}

static json_t *read_json(const Bench *bench)
{
    json_t *root = json_load_file(bench->path, 0, NULL);
    assert_non_null(root);
    return root;
}

// What a full check measured, with a sample of starts if there is one.
static CheckEvidence full_evidence(const Bench *bench, const CheckMeasure *sample)
{
    return (CheckEvidence){
        .run = &bench->run,
        .sample = sample,
        .sample_count = sample != NULL ? BASELINE_SAMPLE_SIZE : 0,
        .now = &bench->made,
        .is_full = true,
        .rate = 1e-3,
    };
}

// Judges the measures against the file as it stands; returns the rows that are out.
static size_t judge(Bench *bench, size_t *out)
{
    Baseline read;
    Err err = {0};
    if (!baseline_json_read(bench->path, &read, &err)) {
        fail_msg("%s", err.text);
    }
    const CheckEvidence evidence = full_evidence(bench, NULL);
    assert_true(check_row_max(&read, &evidence) <= 2048);
    const size_t count = check_judge(&read, &evidence, bench->rows);
    *out = 0;
    for (size_t i = 0; i < count; i++) {
        *out += check_row_is_out(&bench->rows[i]) ? 1 : 0;
    }
    baseline_finish(&read);
    return count;
}

static void what_is_written_reads_back_the_same(void **state)
{
    Bench *bench = *state;
    Baseline read;
    Err err = {0};
    assert_true(baseline_json_read(bench->path, &read, &err));
    assert_int_equal(read.count, bench->made.count);
    assert_int_equal(read.setting_count, bench->made.setting_count);
    assert_true(read.plan.has_truth);
    assert_false(read.plan.is_limited);
    for (size_t i = 0; i < read.count; i++) {
        const BaselineMetric *was = &bench->made.metrics[i];
        const BaselineMetric *now = &read.metrics[i];
        assert_string_equal(now->name, was->name);
        assert_true(now->value == was->value && now->band == was->band);
        assert_true(now->hash == was->hash && now->band_kind == was->band_kind);
        assert_string_equal(now->why, was->why);
    }
    baseline_finish(&read);
    size_t out;
    judge(bench, &out);
    assert_int_equal(out, 0);
}

// Puts another value of a metric into the file.
static void edit(const Bench *bench, const char *name, double value, bool is_count)
{
    json_t *root = read_json(bench);
    json_t *metric = json_object_get(json_object_get(root, "metrics"), name);
    json_object_set_new(metric, "value",
                        is_count ? json_integer((json_int_t)value) : json_real(value));
    assert_int_equal(json_dump_file(root, bench->path, JSON_REAL_PRECISION(17)), 0);
    json_decref(root);
}

static void every_number_edited_by_more_than_its_band_is_named(void **state)
{
    Bench *bench = *state;
    Err err = {0};
    size_t edited = 0;
    for (size_t i = 0; i < bench->made.count; i++) {
        const BaselineMetric *metric = &bench->made.metrics[i];
        if (metric->kind == CHECK_HASH) {
            continue;
        }
        // a whole number moves by one at least; a rounding more than the band where that is tiny
        const bool is_count = metric->kind == CHECK_COUNT;
        const double more =
            is_count ? floor(metric->band) + 1.0
                     : fmax(1.01 * metric->band,
                            4.0 * fabs(nextafter(metric->value, INFINITY) - metric->value));
        size_t out;
        edit(bench, metric->name, metric->value + more, is_count);
        judge(bench, &out);
        assert_int_equal(out, 1);
        assert_string_equal(bench->rows[0].name, metric->name);
        edit(bench, metric->name, metric->value + 0.5 * (is_count ? 0.0 : metric->band), is_count);
        judge(bench, &out);
        assert_int_equal(out, 0);
        assert_true(baseline_json_write(bench->path, &bench->made, &err));
        edited++;
    }
    print_message("# %zu numbers edited by more and by less than their bands\n", edited);
    assert_in_range(edited, 35, 60);
}

static void an_edited_hash_is_named_where_the_build_is_the_same(void **state)
{
    Bench *bench = *state;
    Err err = {0};
    size_t out;
    for (size_t i = 0; i < bench->made.count; i++) {
        BaselineMetric *metric = &bench->made.metrics[i];
        if (metric->kind == CHECK_HASH) {
            metric->hash ^= 1;
            assert_true(baseline_json_write(bench->path, &bench->made, &err));
            metric->hash ^= 1;
            judge(bench, &out);
            assert_string_equal(bench->rows[0].name, metric->name);
            assert_true(check_row_is_out(&bench->rows[0]));
        }
    }
    // another build has another hash and is not asked
    json_t *root = read_json(bench);
    json_object_set_new(root, "build", json_string("0123456789abcdef"));
    assert_int_equal(json_dump_file(root, bench->path, JSON_REAL_PRECISION(17)), 0);
    json_decref(root);
    judge(bench, &out);
    for (size_t i = 0; i < bench->made.count; i++) {
        assert_true(bench->rows[i].kind != CHECK_HASH || !check_row_is_out(&bench->rows[i]));
    }
}

// Signs in front of a digit at which no number begins: reading went round in circles there.
static void a_setting_with_signs_in_front_of_its_number_is_judged(void **state)
{
    static const char *const VALUES[] = {"--2 N/m^1.5", "--2", "-+.5", "+-+-1",
                                         "-.-.0",       "- 2", "."};
    Bench *bench = *state;
    for (size_t i = 0; i < sizeof VALUES / sizeof *VALUES; i++) {
        size_t out;
        json_t *root = read_json(bench);
        json_object_set_new(json_object_get(root, "settings"), "run.step", json_string(VALUES[i]));
        assert_int_equal(json_dump_file(root, bench->path, JSON_REAL_PRECISION(17)), 0);
        json_decref(root);
        judge(bench, &out);
        assert_int_equal(out, 1);
        assert_string_equal(bench->rows[0].name, "run.step");
        assert_string_equal(bench->rows[0].was_text, VALUES[i]);
    }
}

static void a_changed_setting_is_named_with_both_values(void **state)
{
    Bench *bench = *state;
    size_t out;
    json_t *root = read_json(bench);
    json_t *settings = json_object_get(root, "settings");
    assert_string_equal(json_string_value(json_object_get(settings, "run.step")), "1e-05 s");
    json_object_set_new(settings, "run.step", json_string("1.1e-05 s"));
    // what differs in the last digit was only worked out otherwise
    json_object_set_new(settings, "gravity", json_string("9.806650000000002 m/s^2"));
    assert_string_equal(json_string_value(json_object_get(settings, "bodies.pin.at")), "0, 0 m");
    assert_int_equal(json_dump_file(root, bench->path, JSON_REAL_PRECISION(17)), 0);
    json_decref(root);
    judge(bench, &out);
    assert_int_equal(out, 1);
    assert_string_equal(bench->rows[0].name, "run.step");
    assert_int_equal(bench->rows[0].verdict, CHECK_SETTING);
    char words[CHECK_WORDS_SIZE];
    check_report_words(&bench->rows[0], words);
    assert_string_equal(words, "setting run.step was 1.1e-05 s, is 1e-05 s");
}

static void a_number_that_came_or_went_is_a_difference(void **state)
{
    Bench *bench = *state;
    size_t out;
    json_t *root = read_json(bench);
    json_t *metrics = json_object_get(root, "metrics");
    json_object_set_new(metrics, "ode/hole/new_N",
                        json_incref(json_object_get(metrics, "ode/hole/"
                                                             "impacts")));
    json_object_del(metrics, "ode/hole/impacts");
    assert_int_equal(json_dump_file(root, bench->path, JSON_REAL_PRECISION(17)), 0);
    json_decref(root);
    judge(bench, &out);
    assert_int_equal(out, 2);
    assert_string_equal(bench->rows[0].name, "ode/hole/impacts");
    assert_int_equal(bench->rows[0].verdict, CHECK_NEW);
    assert_string_equal(bench->rows[1].name, "ode/hole/new_N");
    assert_int_equal(bench->rows[1].verdict, CHECK_GONE);
}

// A statistical metric in place of one that there is.
static void write_sample(const Bench *bench, const char *edited)
{
    json_t *root = read_json(bench);
    json_t *metrics = json_object_get(root, "metrics");
    json_t *metric = json_loads(edited, 0, NULL);
    assert_non_null(metric);
    json_object_set_new(metrics, "ode/hole/impulse_N_s", metric);
    assert_int_equal(json_dump_file(root, bench->path, JSON_REAL_PRECISION(17)), 0);
    json_decref(root);
}

static void expect_damage(const Bench *bench, const char *words)
{
    Baseline read;
    Err err = {0};
    assert_false(baseline_json_read(bench->path, &read, &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_null(read.metrics);
    if (strstr(err.text, words) == NULL) {
        fail_msg("'%s' is not in '%s'", words, err.text);
    }
}

static void a_sample_that_is_not_that_of_its_median_and_mean_is_damaged(void **state)
{
    Bench *bench = *state;
    Baseline read;
    Err err = {0};
    write_sample(bench,
                 "{\"value\": 2.0, \"band\": 1.0, \"mean\": 2.0, \"why\": \"statistical: x\","
                 " \"sample\": [1, 2, 3]}");
    assert_true(baseline_json_read(bench->path, &read, &err));
    baseline_finish(&read);
    // so is one of nothing but zeros
    write_sample(bench,
                 "{\"value\": 0.0, \"band\": 1.0, \"mean\": 0.0, \"why\": \"statistical: x\","
                 " \"sample\": [0, 0, 0]}");
    assert_true(baseline_json_read(bench->path, &read, &err));
    baseline_finish(&read);
    static const char *const WRONG[] = {
        "{\"value\": 2.0, \"band\": 1.0, \"mean\": 2.0, \"why\": \"statistical: x\", \"sample\": "
        "[1, 2, 4]}",
        "{\"value\": 2.5, \"band\": 1.0, \"mean\": 2.0, \"why\": \"statistical: x\", \"sample\": "
        "[1, 2, 3]}",
        "{\"value\": 2.0, \"band\": 1.0, \"mean\": 2.1, \"why\": \"statistical: x\", \"sample\": "
        "[1, 2, 3]}",
        "{\"value\": 2.0, \"band\": 1.0, \"mean\": 2.0, \"why\": \"statistical: x\", \"sample\": "
        "[3, 2, 1]}",
        "{\"value\": 2.0, \"band\": 1.0, \"why\": \"statistical: x\"}",
        "{\"value\": 2.0, \"band\": 1.0, \"why\": \"rounding: x\", \"mean\": 2.0}",
    };
    for (size_t i = 0; i < sizeof WRONG / sizeof WRONG[0]; i++) {
        write_sample(bench, WRONG[i]);
        expect_damage(bench, "ode/hole/impulse_N_s");
    }
}

static void write_words(const Bench *bench, const char *from, const char *to)
{
    static char whole[1 << 16];
    Err err = {0};
    // what an edit has left may be no baseline, which would stay
    unlink(bench->path);
    assert_true(baseline_json_write(bench->path, &bench->made, &err));
    read_whole(bench->path, whole, sizeof whole);
    const char *place = strstr(whole, from);
    assert_non_null(place);
    FILE *stream = fopen(bench->path, "w");
    fprintf(stream, "%.*s%s%s", (int)(place - whole), whole, to, place + strlen(from));
    fclose(stream);
}

static void everything_wrong_in_a_baseline_is_found(void **state)
{
    Bench *bench = *state;
    static const char *const EDITS[][3] = {
        {"jointplay baseline 2", "jointplay baseline 3", "its format is 'jointplay baseline 3'"},
        {"jointplay baseline 2", "jointplay baseline 1",
         "its errors are of omega alone, and now an error is that of the whole motion; bless "
         "again"},
        {"{\n  \"format\"", "[\n  \"format\"", "line "},
        {"\"band\": ", "\"band\": -", "'band' is negative"},
        {"\"band\": 0, \"why\": \"exact: a", "\"band\": 1, \"why\": \"exact: a", "'band' is not 0"},
        {"\"value\": ", "\"value\": NaN, \"x\": ", "line "},
        {"\"value\": ", "\"value\": 1e999, \"x\": ", "line "},
        {"\"value\": ", "\"value\": true, \"y\": ", "a key that means nothing"},
        {"\"value\": ", "\"valeu\": ", "'value' is missing"},
        {"\"why\": \"exact", "\"why\": \"because", "begins with none of"},
        {"\"case\": ", "\"case\": 3, \"cas\": ", "a key that means nothing"},
        {"\"case\": ", "\"format\": \"\", \"case\": ", "duplicate"},
        {"ode/hole/impacts", "ode/hole/force_max_N", "duplicate"},
        {"\"uncertainty\": ", "\"uncertainty\": -", "negative"},
        {"\"run.step\": ", "\"run.step\": 5, \"b\": ", "'run.step' is no text"},
    };
    for (size_t i = 0; i < sizeof EDITS / sizeof EDITS[0]; i++) {
        write_words(bench, EDITS[i][0], EDITS[i][1]);
        expect_damage(bench, EDITS[i][2]);
    }
    FILE *stream = fopen(bench->path, "w");
    fclose(stream);
    expect_damage(bench, "line 1");
    unlink(bench->path);
    expect_damage(bench, "there is no baseline");
}

static void a_start_beside_makes_a_band_and_a_wide_one_a_sample(void **state)
{
    Bench *bench = *state;
    Baseline made = {.settings = NULL};
    Err err = {0};
    const size_t place = baseline_find(&bench->run, "ode/hole/impulse_N_s", 0);
    assert_in_range(place, 0, bench->run.count - 1);
    bench->members[0].metrics[place].value = bench->run.metrics[place].value * (1.0 + 1e-6);
    assert_true(baseline_set_metrics(&made, &bench->run, bench->members, 2, &err));
    assert_int_equal(made.metrics[place].band_kind, BAND_ROUNDING);
    assert_close(made.metrics[place].band, 1e-5 * bench->run.metrics[place].value, 1e-6);
    bench->members[0].metrics[place].value = bench->run.metrics[place].value * (1.0 + 1e-3);
    assert_true(baseline_set_metrics(&made, &bench->run, bench->members, 2, &err));
    assert_int_equal(made.metrics[place].band_kind, BAND_STATISTICAL);
    assert_true(check_test_count(&made) > 0);
    // no other number of that run can be predicted then, and those of another run can
    const size_t other = baseline_find(&bench->run, "ode/energy/residual_J", 0);
    assert_int_equal(made.metrics[other].band_kind, BAND_STATISTICAL);
    const size_t exact = baseline_find(&bench->run, "ode/cost/steps", 0);
    assert_int_equal(made.metrics[exact].band_kind, BAND_EXACT);
    const size_t reference = baseline_find(&bench->run, "reference/energy/residual_J", 0);
    assert_int_equal(made.metrics[reference].band_kind, BAND_ROUNDING);
    // a member that measured in another order is brought into it
    CheckMetric *swapped = bench->members[1].metrics;
    const CheckMetric kept = swapped[place];
    swapped[place] = swapped[other];
    swapped[other] = kept;
    assert_true(baseline_set_metrics(&made, &bench->run, bench->members, 2, &err));
    assert_string_equal(swapped[place].name, "ode/hole/impulse_N_s");
    assert_string_equal(made.metrics[place].name, "ode/hole/impulse_N_s");
    // an ensemble that measures something else makes no baseline
    snprintf(bench->members[1].metrics[place].name, CHECK_NAME_SIZE, "other");
    assert_false(baseline_set_metrics(&made, &bench->run, bench->members, 2, &err));
    assert_int_equal(err.kind, ERR_SOLVER);
    baseline_finish(&made);
}

// Control: what the motion itself shows makes all of its numbers doubtful, in the test above.
static void steps_that_a_solver_chose_anew_make_no_number_of_the_motion_doubtful(void **state)
{
    Bench *bench = *state;
    Baseline made = {.settings = NULL};
    Err err = {0};
    const size_t place = baseline_find(&bench->run, "reference/cost/evaluations", 0);
    assert_in_range(place, 0, bench->run.count - 1);
    bench->members[0].metrics[place].value *= 2.0;
    assert_true(baseline_set_metrics(&made, &bench->run, bench->members, 2, &err));
    for (size_t i = 0; i < made.count; i++) {
        assert_int_equal(made.metrics[i].band_kind == BAND_STATISTICAL, i == place);
    }
    baseline_finish(&made);
}

// A pivot that carries nothing shows 1e-31 N here and 0 there.
static void a_force_of_nothing_but_rounding_has_a_band(void **state)
{
    (void)state;
    const char *const floating[] = {"gravity=0 m/s^2", "run.duration=10 ms", "run.step=1 ms",
                                    "run.backends=ode"};
    Scenario scenario = load("cases/mechanisms/pendulum.yaml", floating, 4);
    const CheckPlan plan = {.has_truth = false};
    CheckMeasure run = {.count = 0};
    check_measure(&scenario, &plan, &run);
    assert_true(run.is_complete);
    const size_t place = baseline_find(&run, "ode/pivot/force_max_N", 0);
    assert_in_range(place, 0, run.count - 1);
    assert_true(run.metrics[place].value < 1e-20);
    assert_true(run.metrics[place].floor > 1e-20 && run.metrics[place].floor < 1e-9);
    check_measure_finish(&run);
}

// A sample of a metric that cannot be predicted, of a baseline or a check.
static void fill_narrow_sample(CheckMeasure *members, const CheckMeasure *run, size_t place,
                               double width, double shift, uint64_t seed)
{
    for (int i = 0; i < BASELINE_SAMPLE_SIZE; i++) {
        check_measure_finish(&members[i]);
        members[i] = check_measure_copy(run);
        members[i].metrics[place].value = 100.0 + width * lcg_draw(&seed) + shift;
    }
}

static void fill_sample(CheckMeasure *members, const CheckMeasure *run, size_t place, double shift,
                        uint64_t seed)
{
    fill_narrow_sample(members, run, place, 1.0, shift, seed);
}

// The row of the metric when the check's own sample is shifted.
static CheckRow judge_shifted(Bench *bench, const Baseline *made, CheckMeasure *members,
                              size_t place, double shift)
{
    fill_sample(members, &bench->run, place, shift, 2);
    const CheckEvidence evidence = full_evidence(bench, members);
    const size_t count = check_judge(made, &evidence, bench->rows);
    for (size_t i = 0; i < count; i++) {
        if (bench->rows[i].band_kind == BAND_STATISTICAL) {
            return bench->rows[i];
        }
    }
    fail_msg("no row is statistical");
    return bench->rows[0];
}

static void what_cannot_be_predicted_is_judged_by_its_distribution(void **state)
{
    Bench *bench = *state;
    Err err = {0};
    CheckMeasure *members = calloc(BASELINE_SAMPLE_SIZE, sizeof *members);
    assert_non_null(members);
    const size_t place = baseline_find(&bench->run, "ode/hole/impulse_N_s", 0);
    bench->members[0].metrics[place].value *= 1.01;
    assert_true(baseline_set_metrics(&bench->made, &bench->run, bench->members, 2, &err));
    fill_sample(members, &bench->run, place, 0.0, 1);
    assert_true(baseline_set_sample(&bench->made, members, BASELINE_SAMPLE_SIZE, 1e-3, &err));
    // the run's other numbers did not move in the sample, and keep their bands
    assert_int_equal(check_test_count(&bench->made), 1);
    assert_true(baseline_json_write(bench->path, &bench->made, &err));
    Baseline read;
    assert_true(baseline_json_read(bench->path, &read, &err));

    // another sample of the same distribution is within, one that is shifted is out and is named
    CheckRow row = judge_shifted(bench, &read, members, place, 0.0);
    assert_int_equal(row.verdict, CHECK_WITHIN);
    assert_true(row.p > 1e-3);
    row = judge_shifted(bench, &read, members, place, 2.0 * read.metrics[place].band);
    assert_int_equal(row.verdict, CHECK_OUT);
    assert_string_equal(row.name, "ode/hole/impulse_N_s");
    assert_true(row.severity > 1.0);
    char words[CHECK_WORDS_SIZE];
    check_report_words(&row, words);
    assert_non_null(strstr(words, " of the rank test (statistical: "));

    // nor does a sample lose its distribution where that is a rounding of nine digits wide
    fill_narrow_sample(members, &bench->run, place, 1e-9, 4.9e-8, 1);
    assert_true(baseline_set_sample(&read, members, BASELINE_SAMPLE_SIZE, 1e-3, &err));
    fill_narrow_sample(members, &bench->run, place, 1e-9, 4.9e-8, 2);
    const CheckEvidence narrow = full_evidence(bench, members);
    const size_t narrow_count = check_judge(&read, &narrow, bench->rows);
    for (size_t i = 0; i < narrow_count; i++) {
        assert_false(check_row_is_out(&bench->rows[i]));
    }

    // a quick check does not look at it
    CheckEvidence quick = full_evidence(bench, NULL);
    quick.is_full = false;
    const size_t count = check_judge(&read, &quick, bench->rows);
    for (size_t i = 0; i < count; i++) {
        assert_false(check_row_is_out(&bench->rows[i]));
    }
    baseline_finish(&read);
    for (int i = 0; i < BASELINE_SAMPLE_SIZE; i++) {
        check_measure_finish(&members[i]);
    }
    free(members);
}

// The numbers of the starts are closer together than another machine's rounding would put them all.
// Control: ten times as wide a sample is judged by its ranks.
static void a_sample_narrower_than_rounding_keeps_its_band(void **state)
{
    Bench *bench = *state;
    Err err = {0};
    CheckMeasure *members = calloc(BASELINE_SAMPLE_SIZE, sizeof *members);
    assert_non_null(members);
    const size_t place = baseline_find(&bench->run, "ode/hole/impulse_N_s", 0);
    const size_t other = baseline_find(&bench->run, "ode/hole/force_max_N", 0);
    const double floor = bench->run.metrics[other].floor;
    for (int wide = 0; wide < 2; wide++) {
        bench->members[0].metrics[place].value = 1.01 * bench->run.metrics[place].value;
        assert_true(baseline_set_metrics(&bench->made, &bench->run, bench->members, 2, &err));
        fill_sample(members, &bench->run, place, 0.0, 1);
        for (int i = 0; i < BASELINE_SAMPLE_SIZE; i++) {
            members[i].metrics[other].value += (wide ? 10.0 : 0.9) * floor * i / 31.0;
        }
        assert_true(baseline_set_sample(&bench->made, members, BASELINE_SAMPLE_SIZE, 1e-3, &err));
        assert_int_equal(bench->made.metrics[place].band_kind, BAND_STATISTICAL);
        assert_int_equal(bench->made.metrics[other].band_kind,
                         wide ? BAND_STATISTICAL : BAND_ROUNDING);
    }
    for (int i = 0; i < BASELINE_SAMPLE_SIZE; i++) {
        check_measure_finish(&members[i]);
    }
    free(members);
}

// All starts but a few give the same number.
static void fill_shared_sample(CheckMeasure *members, const CheckMeasure *run, size_t place,
                               double shared)
{
    fill_sample(members, run, place, 0.0, 1);
    for (int i = 2; i < BASELINE_SAMPLE_SIZE; i++) {
        members[i].metrics[place].value = shared;
    }
}

// What nearly all starts share has more digits than a baseline keeps. Control: a shared number that
// is another one is out.
static void rounding_of_a_baseline_moves_no_number_that_starts_share(void **state)
{
    Bench *bench = *state;
    Err err = {0};
    CheckMeasure *members = calloc(BASELINE_SAMPLE_SIZE, sizeof *members);
    assert_non_null(members);
    const size_t place = baseline_find(&bench->run, "ode/hole/impulse_N_s", 0);
    bench->members[0].metrics[place].value *= 1.01;
    assert_true(baseline_set_metrics(&bench->made, &bench->run, bench->members, 2, &err));
    fill_shared_sample(members, &bench->run, place, 200.0 / 3.0);
    assert_true(baseline_set_sample(&bench->made, members, BASELINE_SAMPLE_SIZE, 1e-3, &err));
    assert_true(bench->made.metrics[place].sample[0] != 200.0 / 3.0);
    static const double SHARED[] = {200.0 / 3.0, 200.0 / 3.0 * (1.0 + 1e-7)};
    for (size_t k = 0; k < 2; k++) {
        fill_shared_sample(members, &bench->run, place, SHARED[k]);
        const CheckEvidence evidence = full_evidence(bench, members);
        const size_t count = check_judge(&bench->made, &evidence, bench->rows);
        size_t out = 0;
        for (size_t i = 0; i < count; i++) {
            out += check_row_is_out(&bench->rows[i]) ? 1 : 0;
        }
        assert_int_equal(out, k);
    }
    for (int i = 0; i < BASELINE_SAMPLE_SIZE; i++) {
        check_measure_finish(&members[i]);
    }
    free(members);
}

static void a_motion_is_measured_up_to_its_horizon_and_at_finer_steps(void **state)
{
    (void)state;
    CheckMeasure *measure = calloc(1, sizeof *measure);
    assert_non_null(measure);
    const char *const overrides[] = {"run.step=20 us", "ode.stepping=staggered",
                                     "run.duration=10 ms"};
    const Scenario scenario = load("cases/literature/pin-in-hole-drop.yaml", overrides, 3);
    const CheckPlan plan = {.has_truth = true,
                            .uncertainty = 1e-12,
                            .is_limited = true,
                            .horizon_s = 4e-3,
                            .is_full = true};
    check_measure(&scenario, &plan, measure);
    assert_true(measure->is_complete);
    // the whole run has no error, the part of it no contact: it falls 4.5 ms
    assert_int_equal(baseline_find(measure, "ode/error/omega_max_1", 0), measure->count);
    const size_t impacts = baseline_find(measure, "ode-to-horizon/hole/impacts", 0);
    assert_in_range(impacts, 0, measure->count - 1);
    assert_near(measure->metrics[impacts].value, 0.0, 0.0);
    const size_t all = baseline_find(measure, "ode/hole/impacts", 0);
    assert_true(measure->metrics[all].value >= 1.0);
    // the control: a horizon of no sample leaves the whole run alone
    CheckPlan empty = plan;
    empty.horizon_s = 1e-9;
    check_measure(&scenario, &empty, measure);
    assert_int_equal(baseline_find(measure, "ode-to-horizon/hole/impacts", 0), measure->count);
    check_measure_finish(measure);
    free(measure);
}

static void the_order_of_a_scheme_is_measured(void **state)
{
    (void)state;
    CheckMeasure *measure = calloc(1, sizeof *measure);
    assert_non_null(measure);
    const char *const overrides[] = {"run.step=100 us", "run.samples=180"};
    const CheckPlan plan = {.has_truth = true, .uncertainty = 1e-12, .is_full = true};
    const Scenario scenario = load("cases/paper/ideal-nominal.yaml", overrides, 2);
    check_measure(&scenario, &plan, measure);
    const size_t plain = baseline_find(measure, "ode/error/order_at_half_step_1", 0);
    assert_in_range(plain, 0, measure->count - 1);
    // plain stepping is of first order, staggered stepping of second
    assert_near(measure->metrics[plain].value, 1.0, 0.1);
    assert_true(measure->metrics[plain].is_slow);
    const char *const better[] = {"run.step=100 us", "run.samples=180", "ode.stepping=staggered"};
    const Scenario second = load("cases/paper/ideal-nominal.yaml", better, 3);
    check_measure(&second, &plan, measure);
    const size_t staggered = baseline_find(measure, "ode/error/order_at_half_step_1", 0);
    assert_near(measure->metrics[staggered].value, 2.0, 0.1);
    check_measure_finish(measure);
    free(measure);
}

// Pendulums side by side.
static Scenario many_pendulums(size_t count)
{
    Scenario scenario = scenario_default();
    scenario.linkage = linkage_create(
        (LinkageRoom){.bodies = count, .joints = count, .springs = 0, .torsions = 0});
    Linkage *linkage = &scenario.linkage;
    for (size_t i = 0; i < count; i++) {
        Body *body = &linkage->bodies[linkage->body_count++];
        Joint *joint = &linkage->joints[linkage->joint_count++];
        *body = (Body){.mass = 1.0, .inertia = 0.1};
        body->start.position = (Vec2){(double)i + 0.5, 0.0};
        snprintf(body->name, sizeof body->name, "bar-%zu", i);
        *joint = (Joint){.body_a = LINKAGE_GROUND, .body_b = (int)i, .anchor_b = {-0.5, 0.0}};
        joint->anchor_a.x = (double)i;
        snprintf(joint->name, sizeof joint->name, "pin-%zu", i);
    }
    scenario.gravity = scenario_downward(9.81);
    scenario.run.duration = 2e-3;
    scenario.run.samples = 4;
    scenario.run.step = 1e-3;
    scenario.run.backends[0] = BACKEND_REFERENCE;
    scenario.run.backends[1] = BACKEND_ODE;
    scenario.run.backend_count = 2;
    return scenario;
}

static void a_mechanism_of_many_bodies_is_measured_and_handed_on_whole(void **state)
{
    (void)state;
    enum { COUNT = 300, OF_EACH = 5 };
    Scenario scenario = many_pendulums(COUNT);
    const CheckPlan plan = {.has_truth = true, .uncertainty = 1e-12};
    CheckMeasure measure = {.is_complete = false};
    check_measure(&scenario, &plan, &measure);
    assert_true(measure.is_complete);
    assert_true(measure.count > 2 * COUNT * OF_EACH);
    const size_t size = check_measure_packed_size(&scenario);
    void *packed = malloc(size);
    assert_non_null(packed);
    check_measure_pack(&measure, packed, size);
    CheckMeasure unpacked = check_measure_unpack(packed);
    free(packed);
    assert_int_equal(unpacked.count, measure.count);
    assert_memory_equal(unpacked.metrics, measure.metrics, measure.count * sizeof *measure.metrics);
    // where a number is does not depend on where it is looked for first
    const size_t last = baseline_find(&measure, "ode/pin-299/force_max_N", 0);
    assert_in_range(last, 1, measure.count - 1);
    assert_int_equal(baseline_find(&unpacked, "ode/pin-299/force_max_N", last), last);
    assert_int_equal(baseline_find(&unpacked, "ode/pin-300/force_max_N", last), measure.count);
    check_measure_finish(&unpacked);
    check_measure_finish(&measure);
    scenario_free(&scenario);
}

#define BASELINE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        BASELINE_TEST(what_is_written_reads_back_the_same),
        cmocka_unit_test(a_mechanism_of_many_bodies_is_measured_and_handed_on_whole),
        BASELINE_TEST(every_number_edited_by_more_than_its_band_is_named),
        BASELINE_TEST(an_edited_hash_is_named_where_the_build_is_the_same),
        BASELINE_TEST(a_setting_with_signs_in_front_of_its_number_is_judged),
        BASELINE_TEST(a_changed_setting_is_named_with_both_values),
        BASELINE_TEST(a_number_that_came_or_went_is_a_difference),
        BASELINE_TEST(a_sample_that_is_not_that_of_its_median_and_mean_is_damaged),
        BASELINE_TEST(everything_wrong_in_a_baseline_is_found),
        BASELINE_TEST(a_start_beside_makes_a_band_and_a_wide_one_a_sample),
        BASELINE_TEST(what_cannot_be_predicted_is_judged_by_its_distribution),
        BASELINE_TEST(steps_that_a_solver_chose_anew_make_no_number_of_the_motion_doubtful),
        BASELINE_TEST(a_sample_narrower_than_rounding_keeps_its_band),
        cmocka_unit_test(a_force_of_nothing_but_rounding_has_a_band),
        BASELINE_TEST(rounding_of_a_baseline_moves_no_number_that_starts_share),
        cmocka_unit_test(a_motion_is_measured_up_to_its_horizon_and_at_finer_steps),
        cmocka_unit_test(the_order_of_a_scheme_is_measured),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
