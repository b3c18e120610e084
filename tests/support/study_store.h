// A folder for a test with the store of a study in it, of rows made by hand.
#pragma once

#include "close.h"
#include "study_rows.h"

#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH_SIZE = 256, RUNS = 200 };

static char folder[PATH_SIZE - 64];
static char path[PATH_SIZE];

static inline int set_up(void **state)
{
    (void)state;
    const char *parent = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/store-XXXXXX", parent == NULL ? "/tmp" : parent);
    if (mkdtemp(folder) == NULL) {
        return -1;
    }
    snprintf(path, sizeof path, "%s/study.sqlite", folder);
    return 0;
}

static inline int tear_down(void **state)
{
    (void)state;
    unlink(path);
    // nothing else may be left, no journal either
    return rmdir(folder);
}

static inline Store *open_study(const Layout *layout, bool is_fresh, Err *err)
{
    const StoreHead head = study_head(layout, RUNS);
    *err = (Err){0};
    return store_open(path, &head, is_fresh, err);
}

static inline void add_runs(Store *store, const Layout *layout, uint64_t first, uint64_t end)
{
    Err err = {0};
    for (uint64_t run = first; run < end; run++) {
        const Record record = study_record(layout, run);
        assert_true(store_add(store, &record, &err));
    }
}

// A store of the first runs.
static inline void make_store(uint64_t runs)
{
    Err err;
    const Layout layout = study_layout();
    Store *store = open_study(&layout, false, &err);
    assert_non_null(store);
    add_runs(store, &layout, 0, runs);
    assert_true(store_close(store, &err));
}

static inline bool is_same_cell(double a, double b)
{
    return a == b || (isnan(a) && isnan(b));
}

// Takes a row that must be the one of study_record.
static inline bool check_row(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)err;
    const Record truth = study_record(layout, record->run);
    (*(uint64_t *)context)++;
    assert_int_equal(record->outcome, truth.outcome);
    assert_string_equal(record->reason, truth.reason);
    assert_true(record->hash == truth.hash);
    assert_near(record->wall_s, truth.wall_s, 0.0);
    for (size_t i = 0; i < layout->setting_count; i++) {
        if (layout->settings[i].kind == COLUMN_WORD) {
            assert_string_equal(record->settings[i].word, truth.settings[i].word);
        } else {
            assert_near(record->settings[i].number, truth.settings[i].number, 0.0);
        }
    }
    for (size_t i = 0; i < layout->result_count; i++) {
        assert_true(is_same_cell(record->results[i], truth.results[i]));
    }
    return true;
}

// The number of rows of a store, each of which is what was put in.
static inline uint64_t count_right_rows_of(const char *name)
{
    Err err = {0};
    uint64_t count = 0;
    Store *store = store_view(name, &err);
    assert_string_equal(err.text, "");
    assert_true(store_each(store, check_row, &count, &err));
    StoreCount counted;
    assert_true(store_count(store, &counted, &err));
    assert_true(counted.rows == count);
    store_close(store, &err);
    return count;
}

static inline uint64_t count_right_rows(void)
{
    return count_right_rows_of(path);
}

// The exit status of a child's work, or minus the signal that ended it. SQLite must not be carried
// into another process: nothing may be open.
static inline int in_a_child(int (*work)(void))
{
    fflush(stdout);
    const pid_t process = fork();
    if (process == 0) {
        _exit(work());
    }
    int status;
    waitpid(process, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}
