// Pictures of the program inside a page.
#pragma once

#include "base/text.h"

// Appends SVG of the program (write/plot.h) with attributes where it has classes and a style sheet,
// so that it looks the same where a page's style sheet is refused. The label is what a reader who
// does not see it is told.
void svg_embed(const char *svg, const char *label, Text *html);
