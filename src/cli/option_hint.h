// Which option was meant by one that does not exist?
#pragma once

#include "base/text.h"

#include <argp.h>

// Appends what may have been meant by an unknown option such as "--tolerance=1e-5": an option of
// the command, or a key of the case in the form that --set takes, where the command has that.
// Appends nothing where nothing is near.
void option_hint_write(const struct argp_option *options, const char *word, Text *text);
