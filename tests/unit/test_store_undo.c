// Is a store that was left in mid-write seen as SQLite itself would have taken it back?
//
// The truth is SQLite: a copy is opened to work, so that it plays the journal back, and the file is
// then compared with what store_view sees, byte for byte; for whole journals, and for
// those that were cut off or damaged anywhere.
#include "commands/study/store_inside.h"

#include "study_store.h"

#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/stat.h>

enum {
    UNDO_FILE_MAX = 1 << 18,
    UNDO_NAME_SIZE = PATH_SIZE + 32,
    VARIANTS = 60,
    HEADER = 28,
    PAGES = 16
};

// A store or its journal, as the killed process left it.
typedef struct Content {
    size_t size;
    unsigned char bytes[UNDO_FILE_MAX];
} Content;

static const unsigned char JOURNAL_MAGIC[8] = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};

static Content left;
static Content left_journal;
static Content taken_back;
static char journal[UNDO_NAME_SIZE];
static char copy[PATH_SIZE];
static char copy_journal[UNDO_NAME_SIZE];

static void read_store(const char *name, Content *content)
{
    FILE *stream = fopen(name, "rb");
    assert_non_null(stream);
    content->size = fread(content->bytes, 1, UNDO_FILE_MAX, stream);
    fclose(stream);
    assert_true(content->size < UNDO_FILE_MAX);
}

static void write_store(const char *name, const Content *content)
{
    FILE *stream = fopen(name, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(content->bytes, 1, content->size, stream), content->size);
    fclose(stream);
}

static int set_up_undo(void **state)
{
    const int status = set_up(state);
    snprintf(journal, sizeof journal, "%s-journal", path);
    snprintf(copy, sizeof copy, "%s/copy.sqlite", folder);
    snprintf(copy_journal, sizeof copy_journal, "%s-journal", copy);
    return status;
}

static int tear_down_undo(void **state)
{
    unlink(journal);
    unlink(copy);
    unlink(copy_journal);
    return tear_down(state);
}

// Changes rows and adds some, with so little memory that the file is changed before the commit, and
// several times, each with a header of its own in the journal.
static int die_in_mid_change(void)
{
    sqlite3 *base = NULL;
    sqlite3_open(path, &base);
    sqlite3_exec(
        base,
        "PRAGMA cache_size = 3; BEGIN IMMEDIATE; "
        "UPDATE run SET outcome = 5 WHERE run < 60; "
        "WITH RECURSIVE n(i) AS (SELECT 1000 UNION ALL SELECT i + 1 FROM n WHERE i < 1500) "
        "INSERT INTO effort SELECT i, i, i FROM n; "
        "DELETE FROM run WHERE run > 150; "
        "UPDATE run SET reason = hex(randomblob(200)) WHERE run > 100",
        NULL, NULL, NULL);
    raise(SIGKILL);
    return 0;
}

// All pages that a connection sees, to be freed with sqlite3_free; NULL where it cannot read them.
static unsigned char *read_image(sqlite3 *base, sqlite3_int64 *size)
{
    *size = 0;
    // to work: the journal is played back at the first read
    sqlite3_exec(base, "BEGIN; SELECT count(*) FROM sqlite_schema", NULL, NULL, NULL);
    return sqlite3_serialize(base, "main", size, 0);
}

static unsigned char *image_of_copy(sqlite3_int64 *size)
{
    sqlite3 *base = NULL;
    assert_int_equal(sqlite3_open_v2(copy, &base, SQLITE_OPEN_READWRITE, NULL), SQLITE_OK);
    unsigned char *image = read_image(base, size);
    sqlite3_close(base);
    return image;
}

static unsigned char *image_of_view(sqlite3_int64 *size)
{
    Err err = {0};
    Store store = {.path = path, .lock = -1};
    const bool is_open = store_file_view(&store, &err);
    unsigned char *image = is_open ? read_image(store.base, size) : NULL;
    *size = is_open ? *size : 0;
    store_file_close(&store);
    return image;
}

// Whether looking at the store shows what SQLite makes of a copy of it, and leaves it as it is.
static void check_same(const char *what, int variant)
{
    sqlite3_int64 size;
    sqlite3_int64 seen_size;
    read_store(path, &left);
    write_store(copy, &left);
    read_store(journal, &left_journal);
    write_store(copy_journal, &left_journal);
    unsigned char *image = image_of_copy(&size);
    unsigned char *seen = image_of_view(&seen_size);
    // what does not begin as a journal is refused, and SQLite, which would delete it, does not see
    // it
    const bool is_refused = left_journal.size < sizeof JOURNAL_MAGIC ||
                            memcmp(left_journal.bytes, JOURNAL_MAGIC, sizeof JOURNAL_MAGIC) != 0;
    const bool is_same = image == NULL || is_refused ? seen == NULL
                                                     : seen != NULL && size == seen_size &&
                                                           memcmp(image, seen, (size_t)size) == 0;
    if (!is_same) {
        fail_msg("%s, variant %d: %lld bytes are seen, %lld taken back", what, variant,
                 (long long)seen_size, (long long)size);
    }
    sqlite3_free(image);
    sqlite3_free(seen);
    read_store(path, &taken_back);
    assert_int_equal(taken_back.size, left.size);
    assert_memory_equal(taken_back.bytes, left.bytes, left.size);
    assert_int_equal(access(journal, F_OK), 0);
    read_store(copy, &taken_back);
}

static void make_left(Content *whole)
{
    struct stat status;
    make_store(RUNS);
    read_store(path, whole);
    assert_int_equal(in_a_child(die_in_mid_change), -SIGKILL);
    // the control: there is something to be undone
    read_store(path, &left);
    assert_int_equal(stat(journal, &status), 0);
    assert_true(left.size > whole->size || memcmp(left.bytes, whole->bytes, left.size) != 0);
}

static void what_is_seen_is_what_was_committed(void **state)
{
    (void)state;
    static Content whole;
    make_left(&whole);
    check_same("a whole journal", 0);
    // and that is the store before the change
    assert_int_equal(taken_back.size, whole.size);
    assert_memory_equal(taken_back.bytes, whole.bytes, whole.size);
    // which is what our own opening gives
    assert_int_equal(count_right_rows(), RUNS);
}

static void a_journal_that_was_cut_off_is_undone_as_far_as_it_goes(void **state)
{
    (void)state;
    static Content whole;
    static Content whole_journal;
    make_left(&whole);
    read_store(journal, &whole_journal);
    for (int i = 0; i < VARIANTS; i++) {
        Content *cut = &left_journal;
        memcpy(cut, &whole_journal, sizeof *cut);
        cut->size = 1 + (size_t)(i * (double)(whole_journal.size - 1) / VARIANTS);
        write_store(journal, cut);
        check_same("cut off", i);
    }
}

static void a_damaged_journal_is_undone_as_far_as_it_goes(void **state)
{
    (void)state;
    static Content whole;
    static Content whole_journal;
    make_left(&whole);
    read_store(journal, &whole_journal);
    unsigned seed = 11;
    for (int i = 0; i < 2 * VARIANTS; i++) {
        Content *damaged = &left_journal;
        memcpy(damaged, &whole_journal, sizeof *damaged);
        // the header, byte by byte, then anywhere; but for the number of pages, by which SQLite
        // would make the copy some gigabytes long
        const size_t place = i < HEADER ? (size_t)i : (size_t)rand_r(&seed) % damaged->size;
        if (place >= PAGES && place < PAGES + 3) {
            continue;
        }
        damaged->bytes[place] ^= (unsigned char)(1u << rand_r(&seed) % 8);
        write_store(journal, damaged);
        check_same("damaged", (int)place);
    }
}

static void a_journal_of_more_pages_than_there_can_be_is_damage(void **state)
{
    (void)state;
    static Content whole;
    make_left(&whole);
    read_store(journal, &left_journal);
    left_journal.bytes[PAGES] = 0x7f;
    write_store(journal, &left_journal);
    Err err = {0};
    assert_null(store_view(path, &err));
    assert_non_null(strstr(err.text, "is damaged"));
}

#define UNDO_TEST(name) cmocka_unit_test_setup_teardown(name, set_up_undo, tear_down_undo)

int main(void)
{
    const struct CMUnitTest tests[] = {
        UNDO_TEST(what_is_seen_is_what_was_committed),
        UNDO_TEST(a_journal_that_was_cut_off_is_undone_as_far_as_it_goes),
        UNDO_TEST(a_damaged_journal_is_undone_as_far_as_it_goes),
        UNDO_TEST(a_journal_of_more_pages_than_there_can_be_is_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
