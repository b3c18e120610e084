// Values of the options that several commands share, read with the case file's words for
// quantities.
#pragma once

#include "base/err.h"
#include "casefile/units.h"

#include <stdbool.h>
#include <stddef.h>

// Reads --name, a whole number from least to most. Fails with ERR_USAGE.
bool option_values_read_count(const char *name, const char *text, size_t least, size_t most,
                              size_t *count, Err *err);

// Reads --name, a quantity above 0 of a dimension, in SI. Fails with ERR_USAGE.
bool option_values_read_quantity(const char *name, const char *text, Dimension dimension,
                                 double *value, Err *err);

// Reads --name, times between commas such as '10 us, 3 us', s, and puts the longest first. Fails
// with ERR_USAGE where there are none, more than there is room for, or one is given twice.
bool option_values_read_times(const char *name, const char *list, size_t room, double *seconds,
                              size_t *count, Err *err);

// Whether a picture can be written there: they are SVG, and a name that ends otherwise asks for
// something else. NULL is no file. Fails with ERR_USAGE.
bool option_values_check_picture(const char *option, const char *path, Err *err);
