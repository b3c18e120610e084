// A page of a study: what came of its runs, distributions, maps over two keys, and the section over
// a swept key.
#pragma once

#include "base/err.h"
#include "base/text.h"

#include <stdbool.h>

// Whether a file is a store of a study, by how it begins.
bool study_page_is_store(const char *path);

// Appends the page. ERR_FILE where the store cannot be read, or is damaged.
bool study_page_write(const char *path, const char *command, Text *html, Err *err);
