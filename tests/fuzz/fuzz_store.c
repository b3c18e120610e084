// Do the bytes of a study's store, which may come from anyone, bring down what reads it?
//
// The input is the store's file and, behind SPLIT, the journal that lies beside it as if a write
// had been cut short; without SPLIT there is no journal.
#include "commands/study/store.h"

#include "fuzz_check.h"

#include <unistd.h>

static const char SPLIT[] = "<journal>";

enum { PATH_SIZE = 128, REASON_MAX = 4, VALUE_MAX = 5 };

static char folder[PATH_SIZE / 2] = "/tmp/fuzz-store-XXXXXX";
static char store_path[PATH_SIZE];
static char journal_path[PATH_SIZE];

static void tidy(void)
{
    unlink(journal_path);
    unlink(store_path);
    rmdir(folder);
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    fuzz_check(mkdtemp(folder) != NULL, "there is room for a folder");
    snprintf(store_path, sizeof store_path, "%s/store", folder);
    snprintf(journal_path, sizeof journal_path, "%s/store-journal", folder);
    atexit(tidy);
    return 0;
}

static void fill(const char *path, const uint8_t *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    fuzz_check(file != NULL && fwrite(data, 1, size, file) == size && fclose(file) == 0,
               "the file can be written");
}

static const uint8_t *find_split(const uint8_t *data, size_t size)
{
    const size_t length = sizeof SPLIT - 1;
    for (size_t i = 0; i + length <= size; i++) {
        if (memcmp(data + i, SPLIT, length) == 0) {
            return data + i;
        }
    }
    return NULL;
}

static bool take_row(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)layout;
    (void)record;
    (void)err;
    ++*(uint64_t *)context;
    return true;
}

static void check(bool is_done, const Err *err)
{
    if (!is_done) {
        fuzz_check_err(err);
        fuzz_check(err->kind == ERR_FILE, "a bad store is an error of its file");
    }
}

// Everything that a report asks of a store.
static void read_all(Store *store)
{
    Err err = {0};
    StoreCount count;
    check(store_count(store, &count, &err), &err);
    StoreReason reasons[REASON_MAX];
    size_t reason_count;
    err = (Err){0};
    check(store_reasons(store, REASON_MAX, reasons, &reason_count, &err), &err);
    for (size_t column = 0; column < 3; column++) {
        Cell values[VALUE_MAX];
        size_t value_count;
        StoreSpread spread;
        const Column *of = store_column_at(store_layout(store), column);
        err = (Err){0};
        check(store_values(store, column, VALUE_MAX, values, &value_count, &err), &err);
        err = (Err){0};
        check(of->kind == COLUMN_WORD || store_spread(store, column, &spread, &err), &err);
    }
    uint64_t rows = 0;
    err = (Err){0};
    check(store_each(store, take_row, &rows, &err), &err);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *split = find_split(data, size);
    const size_t length = split != NULL ? (size_t)(split - data) : size;
    fill(store_path, data, length);
    unlink(journal_path);
    if (split != NULL) {
        const size_t before = length + sizeof SPLIT - 1;
        fill(journal_path, data + before, size - before);
    }
    Err err = {0};
    Store *store = store_view(store_path, &err);
    if (store == NULL) {
        check(false, &err);
        return 0;
    }
    read_all(store);
    err = (Err){0};
    check(store_close(store, &err), &err);
    return 0;
}
