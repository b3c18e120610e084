// What can be wrong with a store whose bytes are all right?
#include "random_store.h"

#include <sqlite3.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { PATH_SIZE = 4096, JOURNAL_SIZE = 1024 };

// What changes a store so that SQLite finds nothing wrong with it.
static const char *const STATEMENTS[] = {
    "UPDATE run SET step_s = 7.7e8",
    "UPDATE run SET outcome = 99",
    "UPDATE run SET outcome = 'ok', reason = char(27, 91, 51, 49, 109)",
    "UPDATE run SET reason = randomblob(300), outcome = 3",
    "UPDATE run SET run = -run",
    "UPDATE run SET run = 9223372036854775807 - run",
    "UPDATE run SET hash = NULL, checksum = NULL",
    "DELETE FROM run",
    "DELETE FROM effort",
    "UPDATE effort SET wall_s = 9e999",
    "UPDATE effort SET wall_s = 'long'",
    "DELETE FROM study",
    "UPDATE study SET value = '18446744073709551616' WHERE name = 'runs'",
    "UPDATE study SET value = '-1' WHERE name = 'runs'",
    "UPDATE study SET value = randomblob(100000)",
    "UPDATE study SET name = zeroblob(5)",
    "INSERT INTO study SELECT name || rowid, value, words FROM study",
    "DROP TABLE effort",
    "DROP TABLE run",
    "DROP TABLE study",
    "DROP INDEX IF EXISTS unfinished",
    "ALTER TABLE run RENAME TO was; CREATE VIEW run AS SELECT * FROM was",
    "ALTER TABLE run RENAME TO was; CREATE VIEW run AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL "
    "SELECT i + 1 FROM n) SELECT was.* FROM was, n",
    "ALTER TABLE study RENAME TO was; CREATE VIEW study AS SELECT * FROM was",
    "CREATE TRIGGER t AFTER INSERT ON run BEGIN DELETE FROM run; END",
    "CREATE TRIGGER t BEFORE DELETE ON run BEGIN SELECT RAISE(ABORT, 'no'); END",
    "ALTER TABLE run ADD COLUMN more",
    "ALTER TABLE run ADD COLUMN g AS (1 / 0)",
    "ALTER TABLE study ADD COLUMN g AS (randomblob(9))",
    "CREATE TABLE strange(a, b)",
    "PRAGMA user_version = 3",
    "PRAGMA application_id = 0",
    "PRAGMA journal_mode = WAL",
    "PRAGMA encoding = 'UTF-16'; VACUUM",
    "PRAGMA auto_vacuum = FULL; VACUUM",
    "PRAGMA page_size = 65536; VACUUM",
    "PRAGMA writable_schema = ON; UPDATE sqlite_master SET sql = 'CREATE TABLE run(a)' WHERE name "
    "= 'run'",
    "PRAGMA writable_schema = ON; UPDATE sqlite_master SET rootpage = 2",
    "PRAGMA writable_schema = ON; UPDATE sqlite_master SET rootpage = 99999",
    "PRAGMA writable_schema = ON; DELETE FROM sqlite_master",
};
enum { STATEMENT_COUNT = sizeof STATEMENTS / sizeof *STATEMENTS };

static void run_statement(Draw *draw, const char *path)
{
    sqlite3 *base = NULL;
    const char *statement = STATEMENTS[draw_below(draw, STATEMENT_COUNT)];
    if (sqlite3_open_v2(path, &base, SQLITE_OPEN_READWRITE, NULL) == SQLITE_OK) {
        // one that does not go with this store changes nothing
        sqlite3_exec(base, statement, NULL, NULL, NULL);
    }
    sqlite3_close(base);
}

// A rollback journal: its magic, counts and sizes, some pages, and now and then the name of a
// super-journal, which SQLite takes for a file to be deleted.
static int write_journal(Draw *draw, const char *path)
{
    static const unsigned char MAGIC[] = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
    static const char *const SUPER[] = {"case.yaml", "victim", "study.yaml", "../victim", ""};
    char name[PATH_SIZE];
    snprintf(name, sizeof name, "%s%s", path, draw_chance(draw, 0.8) ? "-journal" : "-wal");
    FILE *file = fopen(name, "wb");
    if (file == NULL) {
        return 1;
    }
    fwrite(MAGIC, 1, draw_chance(draw, 0.9) ? sizeof MAGIC : 3, file);
    const size_t size = draw_below(draw, JOURNAL_SIZE);
    for (size_t i = 0; i < size; i++) {
        fputc(draw_chance(draw, 0.8) ? 0 : (int)draw_below(draw, 256), file);
    }
    if (draw_chance(draw, 0.5)) {
        const char *super = SUPER[draw_below(draw, sizeof SUPER / sizeof *SUPER)];
        const size_t length = strlen(super);
        unsigned sum = 0;
        fwrite("\0\0\0\0", 1, 4, file);
        for (size_t i = 0; i < length; i++) {
            fputc(super[i], file);
            sum += (unsigned char)super[i];
        }
        const unsigned tail[2] = {(unsigned)length, sum};
        for (size_t i = 0; i < 8; i++) {
            fputc((int)(tail[i / 4] >> (24 - 8 * (i % 4)) & 0xffu), file);
        }
        fwrite(MAGIC, 1, sizeof MAGIC, file);
    }
    return fclose(file) == 0 ? 0 : 1;
}

int random_store_damage(Draw *draw, const char *path)
{
    if (access(path, F_OK) != 0) {
        return 0;
    }
    if (draw_chance(draw, 0.3)) {
        return write_journal(draw, path);
    }
    run_statement(draw, path);
    return 0;
}
