// A page of a study: what came of its runs, distributions, maps over two keys, and the section over
// a swept key.
#pragma once

#include "base/err.h"
#include "base/text.h"

#include <stdbool.h>

// Whether a file is a store of a study, by how it begins; or a study, by its ending and its keys.
bool study_page_is_store(const char *path);
bool study_page_is_study(const char *path);

// Appends the page of a store, or of the usual store of a study file. Titles, units and words are
// those of the study file, which of a store is the one of its name beside it. ERR_FILE where there
// is no store, or it cannot be read or is damaged; ERR_CASE where the study file is none.
bool study_page_write(const char *path, const char *command, Text *html, Err *err);
