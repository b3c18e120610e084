// What do other programs read of a run?
#include "commands/run/series_csv.h"

#include "write/file.h"
#include "write/series_rows.h"

#include <assert.h>
#include <string.h>

bool series_csv_write(const Scenario *scenario, const Trajectory *trajectory, const char *path,
                      Err *err)
{
    assert(trajectory->is_complete);
    WholeFile file;
    if (!file_begin(&file, FILE_TABLE, path, err)) {
        return false;
    }
    series_rows_write(scenario, trajectory, file.stream);
    return file_end(&file, err);
}

void series_csv_path(const char *path, const char *backend, size_t run_count, char *target,
                     size_t size)
{
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash == NULL ? path : slash + 1, '.');
    const size_t stem = dot == NULL ? strlen(path) : (size_t)(dot - path);
    if (run_count == 1) {
        snprintf(target, size, "%s", path);
    } else {
        snprintf(target, size, "%.*s-%s%s", (int)stem, path, backend, path + stem);
    }
}
