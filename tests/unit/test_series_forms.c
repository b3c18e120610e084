// Does a series, and a file of contacts, hold the run's numbers to the last bit? Read back by a
// reader of its own, and held against what the columns have in memory.
#include "commands/run/run_files.h"
#include "write/contact_table.h"
#include "write/row_file.h"
#include "write/series_rows.h"

#include "report_fixture.h"
#include "scratch.h"

#include <float.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 80, COLUMNS_MAX = 128, ROWS_MAX = 64, WORD_SIZE = 64 };

// What is read back: numbers, where a word stands its text.
typedef struct ReadTable {
    size_t column_count;
    size_t row_count;
    char names[COLUMNS_MAX][NAME_SIZE];
    double numbers[ROWS_MAX][COLUMNS_MAX]; // NaN where there is none
    char words[ROWS_MAX][WORD_SIZE];       // of the first column
} ReadTable;

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

// None is as none, whatever NaN it was.
static bool is_same(double a, double b)
{
    return isfinite(a) || isfinite(b) ? bits_of(a) == bits_of(b) : true;
}

// Readers.

static void read_csv(const char *path, ReadTable *table)
{
    FILE *stream = fopen(path, "r");
    char *line = NULL;
    size_t room = 0;
    assert_non_null(stream);
    assert_true(getline(&line, &room, stream) > 0);
    line[strcspn(line, "\n")] = '\0';
    for (char *name = strtok(line, ","); name != NULL; name = strtok(NULL, ",")) {
        snprintf(table->names[table->column_count++], NAME_SIZE, "%s", name);
    }
    while (getline(&line, &room, stream) > 0) {
        char *cell = line;
        for (size_t i = 0; i < table->column_count; i++) {
            char *end = cell + strcspn(cell, ",\n");
            char *stop;
            const double value = strtod(cell, &stop);
            table->numbers[table->row_count][i] = stop == end && end > cell ? value : NAN;
            if (i == 0) {
                snprintf(table->words[table->row_count], WORD_SIZE, "%.*s", (int)(end - cell),
                         cell);
            }
            cell = end + 1;
        }
        table->row_count++;
    }
    free(line);
    fclose(stream);
}

// Reads a file and takes it away.
static void read_back(const char *path, ReadTable *table)
{
    memset(table, 0, sizeof *table);
    read_csv(path, table);
    unlink(path);
}

// A table of numbers that are hard to write.

static const double HARD[] = {
    0.0,
    -0.0,
    1.0,
    10.0,
    -100000.0,
    0.1,
    1.0 / 3.0,
    2.0 / 3e7,
    DBL_MIN,
    DBL_MAX,
    -DBL_MAX,
    DBL_TRUE_MIN,
    0x1.fffffffffffffp-3,
    1e22,
    9007199254740993.0,
    1e15,
    1e16,
    5e-324,
    0x1p-1022,
    123456789012345678.0,
    NAN,
    INFINITY,
    -INFINITY,
};
enum { HARD_COUNT = sizeof HARD / sizeof *HARD };

static void hard_numbers_read_back_to_the_last_bit(void **state)
{
    (void)state;
    static ReadTable table;
    static const char *const NAMES[] = {"time_s", "it\"s, hard", "b-c_N"};
    uint64_t seed = 1;
    char path[256];
    double values[ROWS_MAX][3];
    Err err = {0};
    RowFile file;
    scratch_path("hard.csv", path, sizeof path);
    assert_true(row_file_begin(&file, path, NAMES, 3, &err));
    for (size_t i = 0; i < ROWS_MAX; i++) {
        for (size_t k = 0; k < 3; k++) {
            // those, and then any bits
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            const uint64_t bits = seed ^ (seed >> 29);
            memcpy(&values[i][k], &bits, sizeof bits);
            values[i][k] = i < HARD_COUNT ? HARD[(i + k) % HARD_COUNT] : values[i][k];
            row_file_number(&file, values[i][k]);
        }
        row_file_end_row(&file);
    }
    assert_true(row_file_end(&file, &err));
    // its head has a comma and quotes, which the reader above does not know
    static char content[1 << 14];
    read_whole(path, content, sizeof content);
    assert_ptr_equal(strstr(content, "time_s,\"it\"\"s, hard\",b-c_N\n0,"), content);
    FILE *stream = fopen(path, "w");
    fprintf(stream, "a,b,c\n%s", strchr(content, '\n') + 1);
    fclose(stream);
    read_back(path, &table);
    assert_int_equal(table.column_count, 3);
    assert_int_equal(table.row_count, ROWS_MAX);
    for (size_t i = 0; i < ROWS_MAX; i++) {
        for (size_t k = 0; k < 3; k++) {
            if (!is_same(table.numbers[i][k], values[i][k])) {
                fail_msg("%a became %a", values[i][k], table.numbers[i][k]);
            }
        }
    }
    // the control: the comparison sees the last bit, and the sign of a zero
    assert_false(is_same(1.0 / 3.0, nextafter(1.0 / 3.0, 1.0)) || is_same(0.0, -0.0));
    assert_false(is_same(NAN, 0.0));
}

static void numbers_have_no_more_digits_than_they_need(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"time_s", "b", "c", "d"};
    char path[256];
    char content[256];
    Err err = {0};
    RowFile file;
    scratch_path("short.csv", path, sizeof path);
    assert_true(row_file_begin(&file, path, NAMES, 4, &err));
    row_file_number(&file, 0.2);
    row_file_number(&file, 100000.0);
    row_file_number(&file, -0.0);
    row_file_number(&file, 0.1 + 0.2);
    row_file_end_row(&file);
    assert_true(row_file_end(&file, &err));
    read_whole(path, content, sizeof content);
    unlink(path);
    assert_string_equal(content, "time_s,b,c,d\n0.2,100000,-0,0.30000000000000004\n");
}

// The series of a run.

// How many numbers of a table are not those of a run.
static size_t count_differences(const Fixture *fixture, const Trajectory *run, const char *patterns,
                                const ReadTable *table)
{
    SeriesColumns columns = series_columns_create(&fixture->scenario, run->ranges.count > 0);
    if (patterns != NULL) {
        series_columns_choose(&columns, patterns);
    }
    assert_int_equal(table->column_count, columns.count);
    assert_int_equal(table->row_count, run->sample_count);
    size_t different = 0;
    for (size_t i = 0; i < columns.count; i++) {
        assert_string_equal(table->names[i], series_columns_name(&columns, i).name);
        for (size_t k = 0; k < run->sample_count; k++) {
            const double value = series_columns_value(&columns, run, k, i);
            different += is_same(table->numbers[k][i], value) ? 0 : 1;
        }
    }
    series_columns_finish(&columns);
    return different;
}

static void a_series_is_the_run_to_the_last_bit(void **state)
{
    Fixture *fixture = *state;
    static ReadTable table;
    static const char *const PATTERNS[] = {NULL, "crank_deg,*-coupler_force_?_N"};
    Trajectory *run = fixture->runs[1];
    // as crooked as numbers of a run are, and one that does not exist
    for (size_t i = 0; i < run->sample_count; i++) {
        run->states[i * run->joint_count + 1].force_on_b =
            (Vec2){1e3 * sqrt((double)i + 2.0), -1e-3 / 7.0};
        run->motions[i * run->body_count + 1].alpha = i == 2 ? INFINITY : 1e5 * sin((double)i);
    }
    for (size_t k = 0; k < 2; k++) {
        char path[256];
        Err err = {0};
        scratch_path("forms.csv", path, sizeof path);
        assert_true(series_write(&fixture->scenario, run, PATTERNS[k], path, &err));
        read_back(path, &table);
        assert_int_equal(count_differences(fixture, run, PATTERNS[k], &table), 0);
        // the control: a run that differs in one number by its last bit
        double *force = &run->states[3 * run->joint_count + 1].force_on_b.x;
        const double former = *force;
        *force = nextafter(former, 0.0);
        assert_true(count_differences(fixture, run, PATTERNS[k], &table) > 0);
        *force = former;
    }
}

static void contacts_are_the_runs_to_the_last_bit(void **state)
{
    Fixture *fixture = *state;
    static ReadTable table;
    Trajectory *run = fixture->runs[1];
    const JointExtremes *extremes = &run->joints[1];
    run->contacts = calloc(extremes->spike_count, sizeof *run->contacts);
    assert_non_null(run->contacts);
    for (size_t i = 0; i < extremes->spike_count; i++) {
        run->contacts[run->contact_count] = (JointSpike){.joint = 1, .spike = extremes->spikes[i]};
        run->contacts[run->contact_count].spike.impulse = 1.0 / (3.0 + (double)i);
        run->contacts[run->contact_count++].spike.eccentricity = (Vec2){1e-5, -2e-6 * (double)i};
    }
    char path[256];
    Err err = {0};
    scratch_path("contacts.csv", path, sizeof path);
    assert_true(row_file_claim("--contacts", path, &err));
    assert_true(contact_table_write(run, path, &err));
    read_back(path, &table);
    assert_int_equal(table.row_count, extremes->spike_count);
    assert_string_equal(table.names[0], "joint");
    assert_string_equal(table.names[6], "impulse_N_s");
    for (size_t i = 0; i < table.row_count; i++) {
        const Spike *spike = &run->contacts[i].spike;
        const double values[] = {spike->onset_s,        spike->duration_s,
                                 spike->peak_s,         spike->crank_rad * UNITS_DEG,
                                 spike->force_max,      spike->impulse,
                                 spike->approach_speed, spike->penetration_max};
        assert_string_equal(table.words[i], "crank-coupler");
        for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
            assert_true(is_same(table.numbers[i][k + 1], values[k]));
        }
        assert_true(isfinite(table.numbers[i][9]));
        // the control
        assert_false(is_same(table.numbers[i][6], nextafter(spike->impulse, 0.0)));
    }
}

static void claim_fails(const char *path, const char *words)
{
    static const char *const NAMES[] = {"time_s", "b"};
    Err err = {0};
    RowFile file;
    assert_false(row_file_claim("--series", path, &err));
    assert_int_equal(err.kind, ERR_USAGE);
    if (strstr(err.text, words) == NULL) {
        fail_msg("%s", err.text);
    }
    // nor is it begun
    assert_false(row_file_begin(&file, path, NAMES, 2, &(Err){0}));
}

static void a_name_of_another_form_is_refused(void **state)
{
    (void)state;
    char path[256];
    Err err = {0};
    claim_fails("s.json", "--series writes CSV, not s.json: name the file FILE.csv");
    claim_fails("a.b/s.SQLITE3", "--series writes CSV, not a.b/s.SQLITE3");
    claim_fails("s.jsonl", "--series writes CSV");
    // the control: a good one, which leaves nothing
    scratch_path("s.csv", path, sizeof path);
    assert_true(row_file_claim("--series", path, &err));
    assert_int_equal(access(path, F_OK), -1);
}

static void a_table_replaces_a_table_alone(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"time_s", "b"};
    char path[256];
    scratch_path("own.csv", path, sizeof path);
    for (int i = 0; i < 2; i++) {
        RowFile file;
        Err err = {0};
        assert_true(row_file_begin(&file, path, NAMES, 2, &err));
        for (int k = 0; k < 4; k++) {
            row_file_number(&file, (double)i);
            k % 2 == 1 ? row_file_end_row(&file) : (void)0;
        }
        assert_true(row_file_end(&file, &err));
    }
    Err err = {0};
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs("{\"time_s\": 0}\n", stream);
    fclose(stream);
    assert_false(row_file_claim("--series", path, &err));
    assert_int_equal(err.kind, ERR_FILE);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hard_numbers_read_back_to_the_last_bit),
        cmocka_unit_test(numbers_have_no_more_digits_than_they_need),
        cmocka_unit_test_setup_teardown(a_series_is_the_run_to_the_last_bit, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(contacts_are_the_runs_to_the_last_bit, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test(a_name_of_another_form_is_refused),
        cmocka_unit_test(a_table_replaces_a_table_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
