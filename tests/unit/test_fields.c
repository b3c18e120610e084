// One row of a field table is a key, a column of CSV, a line of a store and a column for people.
#include "write/fields.h"

#include <math.h>
#include <stdlib.h>

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

typedef struct Inner {
    double size;
} Inner;

typedef struct Record {
    const char *name;
    char words[16];
    unsigned choice;
    size_t count;
    bool is_right;
    double time_s;
    double angle;
    uint64_t hash;
    Inner inner;
    bool has_inner;
} Record;

static const char *const CHOICES[] = {"first", "second"};

static double twice(const void *record)
{
    return 2.0 * ((const Record *)record)->time_s;
}

static const void *if_inner(const void *record)
{
    const Record *of = record;
    return of->has_inner ? &of->inner : NULL;
}

#define AT(member) .offset = offsetof(Record, member)

enum { KEPT = FIELD_ALL | FIELD_STORE, OTHER = FIELD_OWN };

// clang-format off
static const Field INNER[] = {
    {"size_m", FIELD_NUMBER, KEPT, "size", "um", "%.3g", .offset = offsetof(Inner, size)},
    {0},
};
static const Field FIELDS[] = {
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "row"},
    {"name", FIELD_NAME, FIELD_ALL, "name", "", AT(name)},
    {"words", FIELD_TEXT, FIELD_FILES | FIELD_STORE, AT(words), .size = sizeof(((Record *)0)->words)},
    {"choice", FIELD_CHOICE, FIELD_ALL, "choice", "", AT(choice), .of = CHOICES},
    {"count", FIELD_COUNT, KEPT, "count", "", AT(count)},
    {"is_right", FIELD_FLAG, FIELD_FILES | FIELD_STORE, AT(is_right)},
    {"time_s", FIELD_NUMBER, KEPT, "time", "ms", "%.3g", AT(time_s), .absent = "never"},
    {"angle_deg", FIELD_DEGREES, FIELD_FILES, AT(angle)},
    {"hash", FIELD_HASH, FIELD_FILES | FIELD_STORE, AT(hash)},
    {"twice_s", FIELD_NUMBER, FIELD_JSON, .number = twice},
    {"inner", FIELD_GROUP, FIELD_FILES | FIELD_STORE, AT(inner), .of = INNER},
    {NULL, FIELD_PART, FIELD_FILES, .of = INNER, .part = if_inner},
    {"elsewhere", FIELD_COUNT, OTHER, AT(count)},
    {0},
};
// clang-format on

static Record example(void)
{
    return (Record){.name = "pin",
                    .words = "a, \"b\"",
                    .choice = 1,
                    .count = 3,
                    .is_right = true,
                    .time_s = 0.25,
                    .angle = acos(-1.0),
                    .hash = 0xabcu,
                    .inner = {2e-6},
                    .has_inner = true};
}

static void expect_json(const Record *record, unsigned where, const char *expected)
{
    json_t *object = fields_json(FIELDS, where, record);
    char *words = json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(6));
    assert_string_equal(words, expected);
    free(words);
    json_decref(object);
}

static void json_has_the_keys_of_its_place(void **state)
{
    (void)state;
    const Record record = example();
    expect_json(&record, FIELD_JSON,
                "{\"name\":\"pin\",\"words\":\"a, \\\"b\\\"\",\"choice\":\"second\",\"count\":3,"
                "\"is_right\":true,\"time_s\":0.25,\"angle_deg\":180.0,"
                "\"hash\":\"0000000000000abc\",\"twice_s\":0.5,\"inner\":{\"size_m\":2e-6},"
                "\"size_m\":2e-6}");
    expect_json(&record, OTHER, "{\"elsewhere\":3}");
}

static void what_is_not_known_is_null_and_a_part_without_a_key_is_left_out(void **state)
{
    (void)state;
    Record record = example();
    record.name = NULL;
    record.time_s = NAN;
    record.has_inner = false;
    json_t *object = fields_json(FIELDS, FIELD_JSON, &record);
    assert_true(json_is_null(json_object_get(object, "name")));
    assert_true(json_is_null(json_object_get(object, "time_s")));
    assert_null(json_object_get(object, "size_m"));
    json_decref(object);
}

static void a_store_reads_back_what_it_holds_and_nothing_else(void **state)
{
    (void)state;
    const Record record = example();
    Record read = {0};
    json_t *object = fields_json(FIELDS, FIELD_STORE, &record);
    assert_true(fields_json_read(FIELDS, FIELD_STORE, object, &read));
    assert_string_equal(read.words, record.words);
    assert_int_equal(read.count, record.count);
    assert_true(read.is_right);
    assert_true(read.time_s == record.time_s);
    assert_true(read.hash == record.hash);
    assert_true(read.inner.size == record.inner.size);
    // a missing key, and each value of another type
    const char *key;
    json_t *value;
    void *next;
    json_object_foreach_safe(object, next, key, value)
    {
        json_incref(value);
        json_object_set_new(object, key, json_array());
        assert_false(fields_json_read(FIELDS, FIELD_STORE, object, &read));
        json_object_set_new(object, key, value);
    }
    json_object_del(object, "count");
    assert_false(fields_json_read(FIELDS, FIELD_STORE, object, &read));
    json_decref(object);
}

static void csv_puts_the_key_of_a_group_before_its_columns(void **state)
{
    (void)state;
    Record record = example();
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    fields_csv_head(FIELDS, FIELD_CSV, stream);
    fields_csv_row(FIELDS, FIELD_CSV, &record, stream);
    record.has_inner = false;
    record.time_s = INFINITY;
    fields_csv_row(FIELDS, FIELD_CSV, &record, stream);
    fclose(stream);
    assert_string_equal(text, "name,words,choice,count,is_right,time_s,angle_deg,hash,"
                              "inner_size_m,size_m\n"
                              "pin,\"a, \"\"b\"\"\",second,3,1,0.25,180,0000000000000abc,"
                              "1.9999999999999999e-06,1.9999999999999999e-06\n"
                              "pin,\"a, \"\"b\"\"\",second,3,1,,180,0000000000000abc,"
                              "1.9999999999999999e-06,\n");
    free(text);
}

static void people_read_the_unit_of_the_column(void **state)
{
    (void)state;
    const Record record = example();
    Text text;
    text_init(&text);
    Table *table = fields_table("Head", FIELDS, FIELD_TABLE, &STYLE_PLAIN, &text);
    table_cell(table, "one");
    fields_table_row(FIELDS, FIELD_TABLE, &record, table);
    table_cell(table, "two");
    fields_table_row(FIELDS, FIELD_TABLE, NULL, table);
    section_end(table, &text);
    assert_string_equal(text.data, "\nHead\n\n"
                                   "  row  name  choice  count   time\n"
                                   "                               ms\n"
                                   "  -------------------------------\n"
                                   "  one  pin   second      3    250\n"
                                   "  two  -     -           -  never\n");
    text_finish(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_has_the_keys_of_its_place),
        cmocka_unit_test(what_is_not_known_is_null_and_a_part_without_a_key_is_left_out),
        cmocka_unit_test(a_store_reads_back_what_it_holds_and_nothing_else),
        cmocka_unit_test(csv_puts_the_key_of_a_group_before_its_columns),
        cmocka_unit_test(people_read_the_unit_of_the_column),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
