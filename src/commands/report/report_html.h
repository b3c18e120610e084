// Elements of a page, with all that is a user's as text.
#pragma once

#include "base/text.h"

#include <jansson.h>
#include <stdbool.h>

// What is wider than a phone scrolls sideways, by the keyboard, too.
#define HTML_SCROLLS "tabindex=\"0\" role=\"group\" aria-label=\"Scrolls sideways\""
#define HTML_WIDE    "<div class=\"wide\" " HTML_SCROLLS ">"

// An element with words in it; the tag may have attributes: "th scope=\"row\"".
void html_words(const char *tag, const char *words, Text *html);

// A row of a table of two columns, the first of which heads it.
void html_pair(const char *head, const char *words, Text *html);

// A cell that names its column where a phone shows each row as a card; none there if it is empty.
// A head may begin with a ~, which is not shown: its cell has words.
void html_cell_headed(const char *head, const char *words, Text *html);

// A cell with a number in a unit, with a prefix as people write it, or by a format of printf; empty
// where it is not finite.
void html_cell_units(double value, const char *unit, Text *html);
void html_cell_number(const char *format, double value, Text *html);

// A list of sentences, one a line; blanks before them do not count. Nothing of none.
void html_list(const char *sentences, Text *html);

// Begins and ends a table of numbers, with a caption and a head of each column; one that begins
// with a ~, which is not shown, heads words, whose cells are "td class=\"words\"".
void html_table_begin(const char *caption, size_t count, const char *const *heads, Text *html);
void html_table_end(Text *html);

// The same of a table whose rows are cards on a phone: its cells are html_cell_headed.
void html_cards_begin(const char *caption, size_t count, const char *const *heads, Text *html);

// Members of JSON that may lack or be of another kind: NaN, an empty text, false.
double html_number_of(const json_t *object, const char *key);
const char *html_text_of(const json_t *object, const char *key);
bool html_flag_of(const json_t *object, const char *key);

// A cell with a text or a number of JSON.
void html_cell_text_of(const json_t *object, const char *key, Text *html);
void html_cell_number_of(const json_t *object, const char *key, const char *format, Text *html);
void html_cell_units_of(const json_t *object, const char *key, const char *unit, Text *html);
