// Can a store that somebody sent write or delete a file, or keep one waiting for ever?
#include "commands/study/store.h"

#include "study_store.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/stat.h>

enum { SENT_POINTS = 30, SECTOR = 512, PAGE = 4096, WAIT_S = 20, SENT_NAME_SIZE = PATH_SIZE + 32 };

static char journal[SENT_NAME_SIZE];
static char victim[SENT_NAME_SIZE];
static char merged[SENT_NAME_SIZE];

static int set_up_sent(void **state)
{
    const int status = set_up(state);
    snprintf(journal, sizeof journal, "%s-journal", path);
    snprintf(victim, sizeof victim, "%s/precious", folder);
    snprintf(merged, sizeof merged, "%s/merged.sqlite", folder);
    // what loops for ever ends the test
    alarm(WAIT_S);
    return status;
}

static int tear_down_sent(void **state)
{
    alarm(0);
    unlink(journal);
    unlink(victim);
    return tear_down(state);
}

static void write_file(const char *name, const void *bytes, size_t size)
{
    FILE *stream = fopen(name, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, size, stream), size);
    fclose(stream);
}

static uint64_t hash_file(uint64_t hash, const char *name)
{
    static unsigned char content[1 << 17];
    FILE *stream = fopen(name, "rb");
    assert_non_null(stream);
    const size_t size = fread(content, 1, sizeof content, stream);
    fclose(stream);
    return hash_bytes(hash, content, size);
}

// Names and contents of all files there are.
static uint64_t hash_folder(void)
{
    uint64_t hash = 0;
    DIR *stream = opendir(folder);
    assert_non_null(stream);
    for (const struct dirent *entry; (entry = readdir(stream)) != NULL;) {
        if (entry->d_name[0] != '.') {
            char name[2 * SENT_NAME_SIZE];
            snprintf(name, sizeof name, "%s/%s", folder, entry->d_name);
            // in whatever order they come
            hash += hash_file(hash_bytes(HASH_START, entry->d_name, strlen(entry->d_name)), name);
        }
    }
    closedir(stream);
    return hash;
}

static void write_big_endian(unsigned char *target, uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        target[i] = (unsigned char)(value >> (24 - 8 * i));
    }
}

static const unsigned char MAGIC[8] = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};

// A journal that undoes nothing and ends with the name of another file.
static void write_super_journal(void)
{
    unsigned char bytes[SECTOR + 4 + SENT_NAME_SIZE + 16] = {0};
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    memcpy(bytes, MAGIC, sizeof MAGIC);
    write_big_endian(bytes + 16, (uint32_t)(status.st_size / PAGE));
    write_big_endian(bytes + 20, SECTOR);
    write_big_endian(bytes + 24, PAGE);
    const size_t length = strlen(victim);
    unsigned char *end = bytes + SECTOR;
    uint32_t sum = 0;
    write_big_endian(end, 0x40000000 / PAGE + 1);
    memcpy(end + 4, victim, length);
    for (size_t i = 0; i < length; i++) {
        sum += (uint32_t)victim[i];
    }
    end += 4 + length;
    write_big_endian(end, (uint32_t)length);
    write_big_endian(end + 4, sum);
    memcpy(end + 8, MAGIC, sizeof MAGIC);
    write_file(journal, bytes, (size_t)(end + 16 - bytes));
    write_file(victim, "my thesis\n", 10);
}

// Every way to open the store of the path is an error with these words, and changes no file.
static void expect_refusal(const char *words)
{
    const Layout layout = study_layout();
    const StoreHead head = study_head(&layout, RUNS);
    const uint64_t before = hash_folder();
    for (int way = 0; way < 4; way++) {
        Err err = {0};
        uint64_t added;
        const char *source = path;
        bool is_opened = false;
        if (way == 0) {
            is_opened = store_view(path, &err) != NULL;
        } else if (way < 3) {
            is_opened = store_open(path, &head, way == 2, &err) != NULL;
        } else {
            is_opened = store_merge(merged, &source, 1, &added, &err);
        }
        assert_false(is_opened);
        assert_int_equal(err.kind, ERR_FILE);
        if (strstr(err.text, words) == NULL) {
            fail_msg("'%s' is not in: %s", words, err.text);
        }
        assert_true(hash_folder() == before);
    }
}

static void a_journal_that_names_another_file_is_refused(void **state)
{
    (void)state;
    make_store(SENT_POINTS);
    write_super_journal();
    expect_refusal("names another file that would be deleted (a super-journal)");
    // the control: SQLite by itself deletes it
    sqlite3 *base = NULL;
    assert_int_equal(sqlite3_open(path, &base), SQLITE_OK);
    sqlite3_exec(base, "SELECT count(*) FROM run", NULL, NULL, NULL);
    sqlite3_close(base);
    assert_int_equal(access(victim, F_OK), -1);
}

static void a_journal_that_is_no_file_of_its_own_is_refused(void **state)
{
    (void)state;
    make_store(SENT_POINTS);
    write_file(victim, "", 0);
    assert_int_equal(symlink(victim, journal), 0);
    expect_refusal("is a link; move it away");
    unlink(journal);
    assert_int_equal(link(victim, journal), 0);
    expect_refusal("is not a file of a single name; move it away");
    unlink(journal);
    assert_int_equal(mkfifo(journal, 0600), 0);
    Err err = {0};
    assert_null(store_view(path, &err));
    assert_non_null(strstr(err.text, "is not a file of a single name; move it away"));
    // the control: what was begun and not used is no harm
    unlink(journal);
    write_file(journal, "", 0);
    assert_int_equal(count_right_rows(), SENT_POINTS);
}

static void what_is_called_like_a_journal_and_is_none_is_not_deleted(void **state)
{
    (void)state;
    make_store(SENT_POINTS);
    write_file(journal, "my diary, begun in May\n", 23);
    expect_refusal("is not its journal, and would be deleted as one");
}

static void a_write_ahead_log_is_refused(void **state)
{
    (void)state;
    char log[SENT_NAME_SIZE];
    snprintf(log, sizeof log, "%s-wal", path);
    make_store(SENT_POINTS);
    write_file(log, "x", 1);
    expect_refusal("is a write-ahead log, which no store has");
    unlink(log);
    assert_int_equal(count_right_rows(), SENT_POINTS);
    sqlite3 *base = NULL;
    sqlite3_open(path, &base);
    sqlite3_exec(base, "PRAGMA journal_mode = WAL", NULL, NULL, NULL);
    sqlite3_close(base);
    expect_refusal("was set to a write-ahead log");
}

// Makes a store and changes what stands in it by SQL, in one go.
static void make_changed(const char *sql)
{
    unlink(path);
    make_store(SENT_POINTS);
    sqlite3 *base = NULL;
    char *error = NULL;
    sqlite3_open(path, &base);
    sqlite3_db_config(base, SQLITE_DBCONFIG_DEFENSIVE, 0, NULL);
    sqlite3_exec(base, sql, NULL, NULL, &error);
    if (error != NULL) {
        fail_msg("%s: %s", sql, error);
    }
    sqlite3_close(base);
}

// The store is an error with these words to all but who makes it anew.
static void expect_stranger(const char *sql, const char *words)
{
    const Layout layout = study_layout();
    make_changed(sql);
    for (int way = 0; way < 3; way++) {
        Err err = {0};
        uint64_t added;
        const char *source = path;
        if (way == 0) {
            assert_null(store_view(path, &err));
        } else if (way == 1) {
            assert_null(open_study(&layout, false, &err));
        } else {
            assert_false(store_merge(merged, &source, 1, &added, &err));
            assert_int_equal(access(merged, F_OK), -1);
        }
        assert_int_equal(err.kind, ERR_FILE);
        if (strstr(err.text, words) == NULL) {
            fail_msg("after '%s', '%s' is not in: %s", sql, words, err.text);
        }
    }
}

#define ENDLESS "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i FROM n) "

static void a_schema_that_is_not_word_for_word_a_store_s_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *sql;
        const char *words;
    } CHANGES[] = {
        {"DROP TABLE study; CREATE VIEW study AS " ENDLESS "SELECT i AS name, i AS value, "
         "i AS words FROM n",
         "it contains a view that no store has"},
        {"ALTER TABLE effort RENAME TO e; CREATE VIEW effort AS " ENDLESS
         "SELECT i AS run, i AS wall_s, i AS checksum FROM n",
         "that no store has"},
        {"CREATE TRIGGER t AFTER INSERT ON run BEGIN DELETE FROM run; END",
         "it contains a trigger that no store has"},
        {"CREATE TABLE other(x)", "it contains a table that no store has"},
        {"CREATE INDEX i ON run(outcome)", "it contains an index that no store has"},
        {"DROP TABLE effort", "it has no table effort"},
        {"ALTER TABLE run ADD COLUMN more", "the columns of its runs are not those of a store"},
        {"ALTER TABLE run ADD COLUMN more GENERATED ALWAYS AS (zeroblob(1e9)) VIRTUAL",
         "the columns of its runs are not those of a store"},
        {"ALTER TABLE effort ADD COLUMN more", "it contains a table that no store has"},
        {"PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = "
         "replace(sql, 'wall_s REAL', 'wall_s REAL CHECK(length(zeroblob(1e9)))') "
         "WHERE name = 'effort'",
         "it contains a table that no store has"},
    };
    for (size_t i = 0; i < sizeof CHANGES / sizeof *CHANGES; i++) {
        expect_stranger(CHANGES[i].sql, CHANGES[i].words);
    }
    // the control
    make_changed("SELECT 1");
    assert_int_equal(count_right_rows(), SENT_POINTS);
}

static void looking_at_a_store_changes_no_file(void **state)
{
    (void)state;
    Err err = {0};
    StoreCount count;
    StoreSpread spread;
    make_store(SENT_POINTS);
    const uint64_t before = hash_folder();
    Store *store = store_view(path, &err);
    assert_true(store_count(store, &count, &err) && store_spread(store, 4, &spread, &err));
    assert_int_equal(count.rows, SENT_POINTS);
    assert_true(hash_folder() == before);
    assert_true(store_close(store, &err));
    assert_true(hash_folder() == before);
}

#define SENT_TEST(name) cmocka_unit_test_setup_teardown(name, set_up_sent, tear_down_sent)

int main(void)
{
    const struct CMUnitTest tests[] = {
        SENT_TEST(a_journal_that_names_another_file_is_refused),
        SENT_TEST(a_journal_that_is_no_file_of_its_own_is_refused),
        SENT_TEST(what_is_called_like_a_journal_and_is_none_is_not_deleted),
        SENT_TEST(a_write_ahead_log_is_refused),
        SENT_TEST(a_schema_that_is_not_word_for_word_a_store_s_is_refused),
        SENT_TEST(looking_at_a_store_changes_no_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
