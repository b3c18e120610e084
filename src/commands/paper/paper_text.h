// What `jointplay paper` prints for people.
#pragma once

#include "base/text.h"
#include "commands/paper/paper.h"
#include "write/style.h"

// The five tables, each printed, recomputed and with what physics gives, and the typos of the
// paper below the table where they matter.
void paper_text_write(const void *result, const Style *style, Text *text);
