// Does a store give back what was put in, and refuse what is not its own?
#include "write/journal.h"

#include "commands/compare/compare.h"

#include "close.h"
#include "mechanism.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH_SIZE = 256, CONTENT_SIZE = 1 << 16 };

static char folder[PATH_SIZE - 16];
static char path[PATH_SIZE];

static int set_up(void **state)
{
    (void)state;
    const char *parent = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/journal-XXXXXX", parent == NULL ? "/tmp" : parent);
    if (mkdtemp(folder) == NULL) {
        return -1;
    }
    snprintf(path, sizeof path, "%s/store.jsonl", folder);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(folder);
}

static json_t *make_key(int samples)
{
    return json_pack("{s:s, s:{s:i}}", "build", "b1", "settings", "run.samples", samples);
}

static void append(const char *text)
{
    FILE *stream = fopen(path, "a");
    assert_non_null(stream);
    fputs(text, stream);
    fclose(stream);
}

// Opens the store with a key; the number of its entries, or -1 with the error.
static int open_store(int samples, bool is_fresh, Err *err)
{
    Journal journal;
    json_t *key = make_key(samples);
    *err = (Err){0};
    int count = -1;
    if (journal_open(&journal, &JOURNAL_COMPARE, path, key, is_fresh, err)) {
        count = (int)json_array_size(journal.entries);
        journal_close(&journal);
    }
    json_decref(key);
    return count;
}

static void write_two(void)
{
    Journal journal;
    Err err = {0};
    json_t *key = make_key(10);
    assert_true(journal_open(&journal, &JOURNAL_COMPARE, path, key, false, &err));
    assert_true(journal_add(&journal, json_pack("{s:f}", "a", 1.0 / 3.0), &err));
    assert_true(journal_add(&journal, json_pack("{s:f}", "a", 2.0), &err));
    journal_close(&journal);
    json_decref(key);
}

static void entries_come_back_as_they_were(void **state)
{
    (void)state;
    write_two();
    Journal journal;
    Err err = {0};
    json_t *key = make_key(10);
    assert_true(journal_open(&journal, &JOURNAL_COMPARE, path, key, false, &err));
    assert_int_equal(json_array_size(journal.entries), 2);
    const json_t *first = json_array_get(journal.entries, 0);
    assert_near(json_number_value(json_object_get(first, "a")), 1.0 / 3.0, 0.0);
    journal_close(&journal);
    json_decref(key);
}

static void write_third(void)
{
    Journal journal;
    Err err = {0};
    json_t *key = make_key(10);
    assert_true(journal_open(&journal, &JOURNAL_COMPARE, path, key, false, &err));
    assert_true(journal_add(&journal, json_pack("{s:f}", "a", 4.0), &err));
    assert_int_equal(journal.damaged_count, 0);
    journal_close(&journal);
    json_decref(key);
}

static void a_torn_last_line_is_dropped(void **state)
{
    (void)state;
    Err err;
    write_two();
    append("{\"a\":3.0");
    assert_int_equal(open_store(10, false, &err), 2);
    // and what comes next stands on a line of its own
    write_third();
    assert_int_equal(open_store(10, false, &err), 3);
}

static void a_torn_first_line_is_begun_again(void **state)
{
    (void)state;
    Err err;
    append("{\"compare\":{\"bui");
    assert_int_equal(open_store(10, false, &err), 0);
    assert_int_equal(open_store(10, false, &err), 0);
}

static size_t read_content(char content[CONTENT_SIZE])
{
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    const size_t size = fread(content, 1, CONTENT_SIZE, stream);
    fclose(stream);
    assert_true(size < CONTENT_SIZE);
    return size;
}

static void write_content(const char *content, size_t size)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(content, 1, size, stream), size);
    fclose(stream);
}

// An entry that is used is one that was written.
static size_t count_right_entries(const Journal *journal)
{
    size_t count = 0;
    size_t index;
    json_t *entry;
    json_array_foreach(journal->entries, index, entry)
    {
        if (!json_is_null(entry)) {
            assert_int_equal(json_object_size(entry), 1);
            const double value = json_number_value(json_object_get(entry, "a"));
            assert_near(value, index == 0 ? 1.0 / 3.0 : 2.0, 0.0);
            count++;
        }
    }
    return count;
}

static void a_bit_that_turned_is_told_and_never_used(void **state)
{
    (void)state;
    static char content[CONTENT_SIZE];
    write_two();
    const size_t size = read_content(content);
    const size_t first = (size_t)((char *)memchr(content, '\n', size) + 1 - content);
    json_t *key = make_key(10);
    // one bit of each byte
    for (size_t i = 0; i < size; i++) {
        content[i] ^= (char)(1 << i % 8);
        write_content(content, size);
        Journal journal;
        Err err = {0};
        const bool is_open = journal_open(&journal, &JOURNAL_COMPARE, path, key, false, &err);
        if (i < first) {
            // of the first line, the key: nothing behind it can be trusted
            assert_false(is_open);
            assert_int_equal(err.kind, ERR_FILE);
        } else {
            assert_true(is_open);
            const size_t right = count_right_entries(&journal);
            const bool is_cut = i == size - 1; // the end of the last line
            assert_true(right == 1 || (right == 0 && !is_cut));
            assert_true(is_cut || journal.damaged_count + right >= 1);
            assert_true(is_cut || journal.damaged_count > 0);
            journal_close(&journal);
        }
        content[i] ^= (char)(1 << i % 8);
    }
    // the control
    write_content(content, size);
    Err err;
    assert_int_equal(open_store(10, false, &err), 2);
    json_decref(key);
}

static void a_damaged_line_is_told_and_the_others_are_kept(void **state)
{
    (void)state;
    Journal journal;
    Err err = {0};
    Text text;
    write_two();
    // a line without its checksum, one with a zero in it, and one behind them
    append("{\"a\":5.0}\n");
    FILE *stream = fopen(path, "a");
    fputc('\0', stream);
    fputs("}\n", stream);
    fclose(stream);
    json_t *key = make_key(10);
    assert_true(journal_open(&journal, &JOURNAL_COMPARE, path, key, false, &err));
    assert_true(journal_add(&journal, json_pack("{s:f}", "a", 2.0), &err));
    journal_close(&journal);
    assert_true(journal_open(&journal, &JOURNAL_COMPARE, path, key, false, &err));
    assert_int_equal(count_right_entries(&journal), 3);
    assert_int_equal(journal.damaged_count, 2);
    text_init(&text);
    journal_describe_damage(&journal, &text);
    assert_non_null(strstr(text.data, "line 4 of the store"));
    assert_non_null(strstr(text.data, ", as 1 others, is damaged and not used"));
    text_finish(&text);
    journal_close(&journal);
    json_decref(key);
    assert_int_equal(open_store(10, true, &err), 0);
}

static void a_store_of_an_older_program_is_one_of_another_key(void **state)
{
    (void)state;
    Err err;
    append("{\"compare\":{\"build\":\"b0\",\"settings\":{\"run.samples\":10}}}\n{\"a\":1.0}\n");
    assert_int_equal(open_store(10, false, &err), -1);
    assert_non_null(strstr(err.text, "build is \"b0\" there and \"b1\" here"));
    assert_int_equal(open_store(10, true, &err), 0);
}

static void another_key_is_refused_with_what_differs(void **state)
{
    (void)state;
    Err err;
    write_two();
    assert_int_equal(open_store(20, false, &err), -1);
    assert_int_equal(err.kind, ERR_FILE);
    assert_non_null(strstr(err.text, "settings.run.samples is 10 there and 20 here"));
    // nothing was lost by asking
    assert_int_equal(open_store(10, false, &err), 2);
    assert_int_equal(open_store(20, true, &err), 0);
    assert_int_equal(open_store(20, false, &err), 0);
}

static void what_is_no_store_is_left_alone(void **state)
{
    (void)state;
    static const char *const CONTENTS[] = {"my thesis\n", "my thesis", "{\"other\":1}\n"};
    for (int i = 0; i < 3; i++) {
        Err err;
        unlink(path);
        append(CONTENTS[i]);
        for (int fresh = 0; fresh < 2; fresh++) {
            assert_int_equal(open_store(10, fresh == 1, &err), -1);
            assert_non_null(strstr(err.text, "is not a store"));
        }
        char content[64] = "";
        FILE *stream = fopen(path, "r");
        assert_non_null(fgets(content, sizeof content, stream));
        fclose(stream);
        assert_string_equal(content, CONTENTS[i]);
    }
}

static void a_store_at_work_is_not_opened_twice(void **state)
{
    (void)state;
    Journal journal;
    Err err = {0};
    json_t *key = make_key(10);
    assert_true(journal_open(&journal, &JOURNAL_COMPARE, path, key, false, &err));
    assert_int_equal(open_store(10, false, &err), -1);
    assert_non_null(strstr(err.text, "in use by another process"));
    journal_close(&journal);
    assert_int_equal(open_store(10, false, &err), 0);
    json_decref(key);
}

static void a_place_that_cannot_be_written_is_told(void **state)
{
    (void)state;
    Journal journal;
    Err err = {0};
    json_t *key = make_key(10);
    assert_false(journal_open(&journal, &JOURNAL_COMPARE, "/nowhere/at/all", key, false, &err));
    assert_int_equal(err.kind, ERR_FILE);
    err = (Err){0};
    assert_false(journal_open(&journal, &JOURNAL_COMPARE, "/dev/full", key, false, &err));
    assert_int_equal(err.kind, ERR_FILE);
    json_decref(key);
}

static Ladder *make_ladder(void)
{
    static const Scheme SCHEMES[2] = {{.name = "direct/plain", .backend = BACKEND_ODE},
                                      {.name = "reference", .backend = BACKEND_REFERENCE}};
    static const double STEPS[2] = {1e-5, 3e-6};
    return ladder_create(SCHEMES, 2, STEPS, 2, 5);
}

static void every_run_comes_back_from_its_line(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    const Linkage *linkage = &scenario.linkage;
    Ladder *ladder = make_ladder();
    Ladder *other = make_ladder();
    LadderTruth truth = {true, "reference", 1e-9, 0.05, 1e3, true, 2.5, "too wild"};
    json_t *line = ladder_json_truth(&truth);
    assert_int_equal(ladder_json_take(other, linkage, line, "m"), LADDER_JSON_TAKEN);
    assert_int_equal(ladder_json_take(other, linkage, line, "m"), LADDER_JSON_UNUSED);
    assert_near(other->truth.horizon_s, 0.05, 0.0);
    assert_true(other->truth.is_limited);
    assert_string_equal(other->truth.message, "too wild");
    json_decref(line);
    LadderRun run = {.kind = LADDER_ERROR,
                     .point = 1,
                     .is_complete = true,
                     .steps = 20000,
                     .evaluations = 5,
                     .wall_s = 0.25,
                     .hash = 0xfedcba9876543210u};
    run.error = (TrajectoryError){.is_known = true, .max = 1.0 / 3.0, .alpha_max = INFINITY};
    line = ladder_json_run(ladder, &run, "m");
    assert_int_equal(ladder_json_take(other, linkage, line, "m"), LADDER_JSON_TAKEN);
    assert_int_equal(ladder_json_take(other, linkage, line, "m"), LADDER_JSON_UNUSED);
    json_decref(line);
    const LadderRun *taken = &other->points[1].run;
    assert_true(taken->hash == run.hash && taken->steps == 20000 && taken->is_complete);
    assert_near(taken->error.max, 1.0 / 3.0, 0.0);
    assert_true(isnan(taken->error.alpha_max));
    // times are only those of this machine
    run.kind = LADDER_TIMING;
    run.round = 3;
    line = ladder_json_run(ladder, &run, "m");
    assert_int_equal(ladder_json_take(other, linkage, line, "n"), LADDER_JSON_OTHER_MACHINE);
    assert_int_equal(ladder_json_take(other, linkage, line, "m"), LADDER_JSON_TAKEN);
    json_decref(line);
    assert_near(other->points[1].wall_s[3], 0.25, 0.0);
    ladder_destroy(ladder);
    ladder_destroy(other);
}

static void an_ensemble_comes_back_from_its_line(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    const size_t joint = (size_t)linkage_find_joint(&scenario.linkage, "crank-coupler");
    Ladder *ladder = make_ladder();
    Ladder *other = make_ladder();
    LadderEnsemble ensemble = {.is_known = true, .step_s = 3e-6};
    ensemble.ensemble.members = 15;
    ensemble.ensemble.failed = 1;
    strcpy(ensemble.ensemble.message, "too deep");
    ensemble.ensemble.joints[joint][ENSEMBLE_IMPULSE] = (Distribution){1.0, 2.0, 4.0, 2.5, 0.5};
    json_t *line = ladder_json_ensemble(ladder, &scenario.linkage, 0, &ensemble);
    assert_int_equal(ladder_json_take(other, &scenario.linkage, line, "m"), LADDER_JSON_TAKEN);
    assert_int_equal(ladder_json_take(other, &scenario.linkage, line, "m"), LADDER_JSON_UNUSED);
    const Ensemble *taken = &other->ensembles[0].ensemble;
    assert_int_equal(taken->members, 15);
    assert_string_equal(taken->message, "too deep");
    assert_near(taken->joints[joint][ENSEMBLE_IMPULSE].high, 4.0, 0.0);
    json_decref(line);
    // a line of a scheme that is not asked for
    const LadderRun run = {.kind = LADDER_ERROR};
    line = ladder_json_run(ladder, &run, "m");
    json_object_set_new(json_object_get(line, "error"), "scheme", json_string("quick/plain"));
    assert_int_equal(ladder_json_take(other, &scenario.linkage, line, "m"), LADDER_JSON_UNUSED);
    json_decref(line);
    ladder_destroy(ladder);
    ladder_destroy(other);
}

// Takes the line whole, then without each of its keys and with each of another type.
static void expect_every_key_to_count(Ladder *ladder, const Linkage *linkage, json_t *line)
{
    const char *key;
    json_t *value;
    const json_t *object = json_object_iter_value(json_object_iter(line));
    json_object_foreach((json_t *)object, key, value)
    {
        json_t *damaged = json_deep_copy(line);
        json_t *inner = json_object_iter_value(json_object_iter(damaged));
        json_object_set_new(inner, key, json_array());
        assert_int_equal(ladder_json_take(ladder, linkage, damaged, "m"), LADDER_JSON_DAMAGED);
        json_object_del(inner, key);
        assert_int_equal(ladder_json_take(ladder, linkage, damaged, "m"), LADDER_JSON_DAMAGED);
        json_decref(damaged);
    }
    assert_int_equal(ladder_json_take(ladder, linkage, line, "m"), LADDER_JSON_TAKEN);
    json_decref(line);
}

static void a_line_with_a_key_too_few_is_damaged(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    const Linkage *linkage = &scenario.linkage;
    Ladder *ladder = make_ladder();
    const LadderTruth truth = {.uncertainty = INFINITY, .backend = "reference"};
    LadderRun run = {.kind = LADDER_ERROR, .is_complete = true};
    const LadderEnsemble ensemble = {.step_s = 3e-6};
    expect_every_key_to_count(ladder, linkage, ladder_json_truth(&truth));
    expect_every_key_to_count(ladder, linkage, ladder_json_run(ladder, &run, "m"));
    run.kind = LADDER_TIMING;
    expect_every_key_to_count(ladder, linkage, ladder_json_run(ladder, &run, "m"));
    // an ensemble has the joints with play
    json_t *line = ladder_json_ensemble(ladder, linkage, 0, &ensemble);
    json_object_clear(json_object_get(json_object_get(line, "ensemble"), "joints"));
    assert_int_equal(ladder_json_take(ladder, linkage, line, "m"), LADDER_JSON_DAMAGED);
    json_decref(line);
    expect_every_key_to_count(ladder, linkage, ladder_json_ensemble(ladder, linkage, 0, &ensemble));
    line = json_object();
    assert_int_equal(ladder_json_take(ladder, linkage, line, "m"), LADDER_JSON_DAMAGED);
    json_decref(line);
    ladder_destroy(ladder);
}

static void the_key_holds_settings_steps_and_versions(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    Ladder *ladder = make_ladder();
    json_t *key = ladder_json_key(ladder, &scenario, "b1");
    json_t *same = ladder_json_key(ladder, &scenario, "b1");
    assert_true(json_equal(key, same));
    json_decref(same);
    // a setting that this scheme of the case makes no use of counts as well
    scenario.ode.iterations++;
    json_t *other = ladder_json_key(ladder, &scenario, "b1");
    assert_false(json_equal(key, other));
    json_decref(other);
    json_decref(key);
    ladder_destroy(ladder);
}

#define STORE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(entries_come_back_as_they_were),
        STORE_TEST(a_torn_last_line_is_dropped),
        STORE_TEST(a_torn_first_line_is_begun_again),
        STORE_TEST(a_bit_that_turned_is_told_and_never_used),
        STORE_TEST(a_damaged_line_is_told_and_the_others_are_kept),
        STORE_TEST(a_store_of_an_older_program_is_one_of_another_key),
        STORE_TEST(another_key_is_refused_with_what_differs),
        STORE_TEST(what_is_no_store_is_left_alone),
        STORE_TEST(a_store_at_work_is_not_opened_twice),
        STORE_TEST(a_place_that_cannot_be_written_is_told),
        cmocka_unit_test(every_run_comes_back_from_its_line),
        cmocka_unit_test(an_ensemble_comes_back_from_its_line),
        cmocka_unit_test(a_line_with_a_key_too_few_is_damaged),
        cmocka_unit_test(the_key_holds_settings_steps_and_versions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
