// Values of the options that several commands share, read with the case file's words for
// quantities.
#pragma once

#include "base/err.h"
#include "casefile/units.h"

#include <stdbool.h>
#include <stddef.h>

// The most values that --set may give on one command line.
enum { OPTION_SETTING_MAX = 256 };

// The most processes at a time that --jobs may ask for: more than the processors are allowed, for
// the number is often written for another machine.
enum { OPTION_JOB_MAX = 256 };

// Reads --name, a whole number from least to most. Fails with ERR_USAGE.
bool option_values_read_count(const char *name, const char *text, size_t least, size_t most,
                              size_t *count, Err *err);

// Reads --name, a quantity above 0 of a dimension, in SI. Fails with ERR_USAGE.
bool option_values_read_quantity(const char *name, const char *text, Dimension dimension,
                                 double *value, Err *err);

// Reads --name, a time above 0, s. Fails with ERR_USAGE.
bool option_values_read_time(const char *name, const char *text, double *seconds, Err *err);

// Reads --name, times between commas such as '10 us, 3 us', s, and puts the longest first. Fails
// with ERR_USAGE where there are none, more than there is room for, or one stands there twice.
bool option_values_read_times(const char *name, const char *list, size_t room, double *seconds,
                              size_t *count, Err *err);

// Adds a KEY=VALUE to the settings, OPTION_SETTING_MAX of them at most. Fails with ERR_USAGE.
bool option_values_take_setting(const char *value, const char **settings, size_t *count, Err *err);

// Whether the case of a path can be run at a step, s: it is read once more with it, so that the
// checks and their words are those of the case file. Fails as casefile_load does.
bool option_values_check_step(const char *path, const char *const *settings, size_t count,
                              double step_s, Err *err);

// Processes at a time where nothing is said: one a processor, OPTION_JOB_MAX at most.
size_t option_values_count_jobs(void);

// Whether a picture can be written there: they are SVG, and a name that ends otherwise asks for
// something else. NULL is no file. Fails with ERR_USAGE.
bool option_values_check_picture(const char *option, const char *path, Err *err);
