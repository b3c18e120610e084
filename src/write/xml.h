// Text of a user's in XML: in pictures and in reports for CI.
#pragma once

#include "base/text.h"

// Appends words as they may stand between tags and in an attribute. What cannot be shown, see
// base/printable.h, and with it all that XML cannot hold, is escaped; a line break stays one.
void xml_append(const char *words, Text *text);

// Appends an element, by the name and attributes of its tag, around lines that are XML already,
// which it indents.
void xml_append_element(const char *tag, const char *lines, Text *text);
