// What does a run cost in the store of a study: bytes, time and memory, at 1e4, 1e5 and 1e6 runs?
//
// Bytes beyond the settings are those of a store of the same rows without the columns of settings.
// Rows come as from two jobs at a time: neighbours in the wrong order. Each size has a process of
// its own, so that its peak of memory is its own.
#include "base/clock.h"
#include "study_rows.h"

#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SHARDS = 10, BATCH = 1000, PATH_SIZE = 512 };

static char folder[PATH_SIZE - 64];

static void must(bool is_right, const Err *err)
{
    if (!is_right) {
        printf("%s\n", err->text);
        exit(1);
    }
}

static double file_size(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 ? (double)status.st_size : NAN;
}

static double peak_mb(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss / 1024.0;
}

// Writes the runs first, first + stride, ... of so many.
static void fill(const char *path, const Layout *layout, uint64_t first, uint64_t stride,
                 uint64_t runs)
{
    Err err = {0};
    const StoreHead head = study_head(layout, runs);
    Store *store = store_open(path, &head, true, &err);
    must(store != NULL, &err);
    uint64_t count = 0;
    for (uint64_t run = first; run < runs; run += stride, count++) {
        const uint64_t swapped = first + ((run - first) / stride ^ 1u) * stride;
        const Record record = study_record(layout, swapped < runs ? swapped : run);
        must(store_add(store, &record, &err), &err);
        must(count % BATCH != BATCH - 1 || store_commit(store, &err), &err);
    }
    must(store_close(store, &err), &err);
}

static bool count_row(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)layout;
    (void)record;
    (void)err;
    (*(uint64_t *)context)++;
    return true;
}

static void read_all(const char *path)
{
    Err err = {0};
    uint64_t count = 0;
    double start = clock_now_s();
    Store *store = store_view(path, &err);
    must(store != NULL, &err);
    StoreCount counted;
    must(store_count(store, &counted, &err), &err);
    printf("    counted in %.3f s", clock_now_s() - start);
    start = clock_now_s();
    must(store_each(store, count_row, &count, &err), &err);
    printf(", read at %.0f rows/s", (double)count / (clock_now_s() - start));
    StoreSpread spread;
    start = clock_now_s();
    must(store_spread(store, 4, &spread, &err), &err);
    printf(", one column's quantiles in %.3f s, peak %.1f MB\n", clock_now_s() - start, peak_mb());
    must(store_close(store, &err), &err);
}

static void merge(char shards[SHARDS][PATH_SIZE], const char *target)
{
    Err err = {0};
    const char *sources[SHARDS];
    for (int i = 0; i < SHARDS; i++) {
        sources[i] = shards[i];
    }
    uint64_t added = 0;
    const double start = clock_now_s();
    must(store_merge(target, sources, SHARDS, &added, &err), &err);
    const double time_s = clock_now_s() - start;
    printf("    %d shards merged in %.3f s, %.0f rows/s, %.1f bytes a run, peak %.1f MB\n", SHARDS,
           time_s, (double)added / time_s, file_size(target) / (double)added, peak_mb());
}

// Its own process, so that the peak is that of the work.
static void apart(void (*work)(uint64_t), uint64_t runs)
{
    fflush(stdout);
    const pid_t process = fork();
    if (process == 0) {
        work(runs);
        fflush(stdout);
        _exit(0);
    }
    waitpid(process, NULL, 0);
}

static void write_store(uint64_t runs)
{
    char path[PATH_SIZE];
    snprintf(path, sizeof path, "%s/whole.sqlite", folder);
    const Layout layout = study_layout();
    const double start = clock_now_s();
    fill(path, &layout, 0, 1, runs);
    printf("%8.0e runs: written at %.0f rows/s, %.1f bytes a run, peak %.1f MB\n", (double)runs,
           (double)runs / (clock_now_s() - start), file_size(path) / (double)runs, peak_mb());
    Layout bare = layout;
    bare.setting_count = 0;
    fill(path, &bare, 0, 1, runs);
    printf("    beyond the settings %.1f bytes a run\n", file_size(path) / (double)runs);
    unlink(path);
}

static void read_store(uint64_t runs)
{
    char path[PATH_SIZE];
    snprintf(path, sizeof path, "%s/whole.sqlite", folder);
    const Layout layout = study_layout();
    fill(path, &layout, 0, 1, runs);
    read_all(path);
    unlink(path);
}

static void merge_stores(uint64_t runs)
{
    char shards[SHARDS][PATH_SIZE];
    char target[PATH_SIZE];
    const Layout layout = study_layout();
    for (int i = 0; i < SHARDS; i++) {
        snprintf(shards[i], PATH_SIZE, "%s/shard-%d.sqlite", folder, i);
        fill(shards[i], &layout, (uint64_t)i, SHARDS, runs);
    }
    snprintf(target, sizeof target, "%s/merged.sqlite", folder);
    merge(shards, target);
    unlink(target);
    for (int i = 0; i < SHARDS; i++) {
        unlink(shards[i]);
    }
}

int main(void)
{
    static const uint64_t SIZES[] = {10000, 100000, 1000000};
    const char *parent = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/bench-store-XXXXXX", parent == NULL ? "/tmp" : parent);
    if (mkdtemp(folder) == NULL) {
        return 1;
    }
    for (size_t i = 0; i < sizeof SIZES / sizeof *SIZES; i++) {
        apart(write_store, SIZES[i]);
        apart(read_store, SIZES[i]);
        apart(merge_stores, SIZES[i]);
    }
    rmdir(folder);
    return 0;
}
