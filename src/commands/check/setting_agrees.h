// Whether two settings of a case say the same.
#pragma once

#include <stdbool.h>

// Words as they are, numbers to 1e-12 of the largest in the setting: a position may have been
// computed from others, and sines differ in their last digit from one processor to another.
bool setting_agrees(const char *was, const char *now);
