// Does a series, and a file of contacts, hold the run's numbers to the last bit in every form: CSV,
// JSON Lines, SQLite? Read back by a reader of its own for each, and held against what the columns
// have in memory.
#include "commands/run/case_run.h"
#include "write/contact_table.h"
#include "write/row_file.h"
#include "write/series_rows.h"

#include "report_fixture.h"
#include "scratch.h"

#include <float.h>
#include <jansson.h>
#include <sqlite3.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

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

static void read_jsonl(const char *path, ReadTable *table)
{
    FILE *stream = fopen(path, "r");
    char *line = NULL;
    size_t room = 0;
    assert_non_null(stream);
    while (getline(&line, &room, stream) > 0) {
        json_t *row = json_loads(line, 0, NULL);
        const char *key;
        json_t *value;
        size_t column = 0;
        assert_non_null(row);
        json_object_foreach(row, key, value)
        {
            snprintf(table->names[column], NAME_SIZE, "%s", key);
            table->numbers[table->row_count][column] =
                json_is_number(value) ? json_number_value(value) : NAN;
            if (column++ == 0 && json_is_string(value)) {
                snprintf(table->words[table->row_count], WORD_SIZE, "%s", json_string_value(value));
            }
        }
        assert_true(table->row_count == 0 || column == table->column_count);
        table->column_count = column;
        table->row_count++;
        json_decref(row);
    }
    free(line);
    fclose(stream);
}

static void read_sqlite(const char *path, const char *name, ReadTable *table)
{
    sqlite3 *base;
    sqlite3_stmt *rows;
    char sql[64];
    assert_int_equal(sqlite3_open_v2(path, &base, SQLITE_OPEN_READONLY, NULL), SQLITE_OK);
    snprintf(sql, sizeof sql, "SELECT * FROM %s ORDER BY rowid", name);
    assert_int_equal(sqlite3_prepare_v2(base, sql, -1, &rows, NULL), SQLITE_OK);
    table->column_count = (size_t)sqlite3_column_count(rows);
    for (size_t i = 0; i < table->column_count; i++) {
        snprintf(table->names[i], NAME_SIZE, "%s", sqlite3_column_name(rows, (int)i));
    }
    while (sqlite3_step(rows) == SQLITE_ROW) {
        for (size_t i = 0; i < table->column_count; i++) {
            // no number is stored as anything but a double
            const int type = sqlite3_column_type(rows, (int)i);
            assert_true(type == SQLITE_FLOAT || type == SQLITE_NULL ||
                        (i == 0 && type == SQLITE_TEXT));
            table->numbers[table->row_count][i] =
                type == SQLITE_FLOAT ? sqlite3_column_double(rows, (int)i) : NAN;
            if (type == SQLITE_TEXT) {
                snprintf(table->words[table->row_count], WORD_SIZE, "%s",
                         (const char *)sqlite3_column_text(rows, (int)i));
            }
        }
        table->row_count++;
    }
    assert_int_equal(sqlite3_finalize(rows), SQLITE_OK);
    assert_int_equal(sqlite3_close(base), SQLITE_OK);
}

static const char *const ENDINGS[] = {"csv", "jsonl", "sqlite"};
enum { FORM_COUNT = sizeof ENDINGS / sizeof *ENDINGS };

// Reads a file of a form and takes it away.
static void read_back(size_t form, const char *path, const char *name, ReadTable *table)
{
    memset(table, 0, sizeof *table);
    switch (form) {
    case 0:
        read_csv(path, table);
        break;
    case 1:
        read_jsonl(path, table);
        break;
    default:
        read_sqlite(path, name, table);
        break;
    }
    unlink(path);
}

static void name_file(const char *name, size_t form, char path[256])
{
    char full[64];
    snprintf(full, sizeof full, "%s.%s", name, ENDINGS[form]);
    scratch_path(full, path, 256);
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
    const RowHead head = {"series", NAMES, 3};
    uint64_t seed = 1;
    for (size_t form = 0; form < FORM_COUNT; form++) {
        char path[256];
        double values[ROWS_MAX][3];
        Err err = {0};
        RowFile file;
        name_file("hard", form, path);
        assert_true(row_file_begin(&file, path, &head, &err));
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
        if (form == 0) {
            // its head has a comma and quotes, which the reader above does not know
            static char content[1 << 14];
            read_whole(path, content, sizeof content);
            assert_ptr_equal(strstr(content, "time_s,\"it\"\"s, hard\",b-c_N\n0,"), content);
            FILE *stream = fopen(path, "w");
            fprintf(stream, "a,b,c\n%s", strchr(content, '\n') + 1);
            fclose(stream);
        }
        read_back(form, path, "series", &table);
        assert_int_equal(table.column_count, 3);
        assert_int_equal(table.row_count, ROWS_MAX);
        assert_string_equal(table.names[1], form == 0 ? "b" : NAMES[1]);
        for (size_t i = 0; i < ROWS_MAX; i++) {
            for (size_t k = 0; k < 3; k++) {
                if (!is_same(table.numbers[i][k], values[i][k])) {
                    fail_msg("%s: %a became %a", ENDINGS[form], values[i][k], table.numbers[i][k]);
                }
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
    static const char *const CONTENTS[] = {
        "time_s,b,c,d\n0.2,100000,-0,0.30000000000000004\n",
        "{\"time_s\":0.2,\"b\":100000,\"c\":-0.0,\"d\":0.30000000000000004}\n"};
    const RowHead head = {"series", NAMES, 4};
    for (size_t form = 0; form < 2; form++) {
        char path[256];
        char content[256];
        Err err = {0};
        RowFile file;
        name_file("short", form, path);
        assert_true(row_file_begin(&file, path, &head, &err));
        row_file_number(&file, 0.2);
        row_file_number(&file, 100000.0);
        row_file_number(&file, -0.0);
        row_file_number(&file, 0.1 + 0.2);
        row_file_end_row(&file);
        assert_true(row_file_end(&file, &err));
        read_whole(path, content, sizeof content);
        unlink(path);
        assert_string_equal(content, CONTENTS[form]);
    }
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

static void a_series_is_the_run_to_the_last_bit_in_every_form(void **state)
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
    for (size_t form = 0; form < FORM_COUNT; form++) {
        for (size_t k = 0; k < 2; k++) {
            char path[256];
            Err err = {0};
            name_file("forms", form, path);
            assert_true(series_write(&fixture->scenario, run, PATTERNS[k], path, &err));
            read_back(form, path, "series", &table);
            assert_int_equal(count_differences(fixture, run, PATTERNS[k], &table), 0);
            // the control: a run that differs in one number by its last bit
            double *force = &run->states[3 * run->joint_count + 1].force_on_b.x;
            const double former = *force;
            *force = nextafter(former, 0.0);
            assert_true(count_differences(fixture, run, PATTERNS[k], &table) > 0);
            *force = former;
        }
    }
}

// The contacts of a run.

static void contacts_are_the_runs_to_the_last_bit_in_every_form(void **state)
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
    for (size_t form = 0; form < FORM_COUNT; form++) {
        char path[256];
        Err err = {0};
        name_file("contacts", form, path);
        assert_true(contact_table_claim(&run->linkage, "--contacts", path, &err));
        assert_true(contact_table_write(run, path, &err));
        read_back(form, path, "contacts", &table);
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
}

// What cannot be in a form.

static void claim_fails(const char *path, const RowHead *head, ErrKind kind, const char *words)
{
    Err err = {0};
    RowFile file;
    assert_false(row_file_claim("--series", path, head, &err));
    assert_int_equal(err.kind, kind);
    if (strstr(err.text, words) == NULL) {
        fail_msg("%s", err.text);
    }
    // nor is it begun
    assert_false(row_file_begin(&file, path, head, &(Err){0}));
}

static void what_a_form_cannot_hold_is_refused(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"time_s", "a_x_m", "A_x_m"};
    const RowHead head = {"series", NAMES, 2};
    const RowHead alike = {"series", NAMES, 3};
    char path[256];
    char other[300];
    Err err = {0};
    claim_fails("s.json", &head, ERR_USAGE,
                "--series does not write s.json: name the file .csv, .jsonl for JSON Lines or "
                ".sqlite for SQLite");
    claim_fails("a.b/s.SQLITE3", &head, ERR_USAGE, "--series does not write a.b/s.SQLITE3");
    scratch_path("refused.sqlite", path, sizeof path);
    claim_fails(path, &alike, ERR_USAGE, "SQLite takes the columns 'a_x_m' and 'A_x_m' for one");
    // more columns than a table of SQLite has
    enum { MANY = 2001 };
    static char names[MANY][16];
    static const char *heads[MANY];
    for (size_t i = 0; i < MANY; i++) {
        snprintf(names[i], sizeof names[i], "c%zu", i);
        heads[i] = names[i];
    }
    claim_fails(path, &(RowHead){"series", heads, MANY}, ERR_USAGE,
                "it would have 2001 columns, and a table of SQLite has at most 2000; choose some "
                "with --columns");
    // a pipe
    assert_int_equal(mkfifo(path, 0600), 0);
    claim_fails(path, &head, ERR_USAGE, "which is no regular file");
    unlink(path);
    // what belongs to another file, which SQLite would apply
    snprintf(other, sizeof other, "%s-journal", path);
    FILE *stream = fopen(other, "w");
    assert_non_null(stream);
    fclose(stream);
    claim_fails(path, &head, ERR_FILE, "next to it for a part of it; move that away");
    unlink(other);
    // the control: a good one, which leaves nothing
    assert_true(row_file_claim("--series", path, &head, &err));
    assert_int_equal(access(path, F_OK), -1);
}

static void each_form_replaces_its_own_alone(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"time_s", "b"};
    const RowHead head = {"series", NAMES, 2};
    for (size_t form = 0; form < FORM_COUNT; form++) {
        char path[256];
        name_file("own", form, path);
        for (int i = 0; i < 2; i++) {
            RowFile file;
            Err err = {0};
            assert_true(row_file_begin(&file, path, &head, &err));
            for (int k = 0; k < 4; k++) {
                row_file_number(&file, (double)i);
                k % 2 == 1 ? row_file_end_row(&file) : (void)0;
            }
            assert_true(row_file_end(&file, &err));
        }
        // under the name of another form it is another's
        for (size_t k = 0; k < FORM_COUNT; k++) {
            char other[256];
            Err err = {0};
            name_file("other", k, other);
            assert_int_equal(rename(path, other), 0);
            assert_int_equal(row_file_claim("--series", other, &head, &err), k == form);
            assert_int_equal(err.kind, k == form ? ERR_NONE : ERR_FILE);
            assert_int_equal(rename(other, path), 0);
        }
        unlink(path);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hard_numbers_read_back_to_the_last_bit),
        cmocka_unit_test(numbers_have_no_more_digits_than_they_need),
        cmocka_unit_test_setup_teardown(a_series_is_the_run_to_the_last_bit_in_every_form,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(contacts_are_the_runs_to_the_last_bit_in_every_form,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test(what_a_form_cannot_hold_is_refused),
        cmocka_unit_test(each_form_replaces_its_own_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
