// What the writers of a study's rows have in common.
#pragma once

#include "report/file.h"
#include "study/store.h"

// Begins the file. Fails with ERR_FILE, and with ERR_USAGE where it is the store itself.
static inline bool study_export_begin(const Store *store, const char *path, WholeFile *file,
                                      Err *err)
{
    if (file_is_same(path, store_path(store))) {
        return err_set(err, ERR_USAGE, "%s is the store itself, and would be lost", path);
    }
    return file_begin(file, path, err);
}
