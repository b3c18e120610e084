// Elements of a page, with all that is a user's as text.
#pragma once

#include "base/text.h"

// An element with words in it; the tag may have attributes: "th scope=\"row\"".
void html_words(const char *tag, const char *words, Text *html);

// A row of a table of two columns, the first of which heads it.
void html_pair(const char *head, const char *words, Text *html);

// A cell with a number in a unit, with a prefix as people write it, or by a format of printf; empty
// where it is not finite.
void html_cell_units(double value, const char *unit, Text *html);
void html_cell_number(const char *format, double value, Text *html);

// A list of sentences, one a line; blanks before them do not count. Nothing of none.
void html_list(const char *sentences, Text *html);
