// Writes elements of a page.
#include "commands/report/report_html.h"
#include "write/units.h"
#include "write/xml.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

void html_words(const char *tag, const char *words, Text *html)
{
    text_append(html, "<%s>", tag);
    xml_append(words, html);
    text_append(html, "</%.*s>\n", (int)strcspn(tag, " "), tag);
}

void html_pair(const char *head, const char *words, Text *html)
{
    text_append(html, "<tr>");
    html_words("th scope=\"row\"", head, html);
    html_words("td", words, html);
    text_append(html, "</tr>\n");
}

void html_cell_headed(const char *head, const char *words, Text *html)
{
    const bool is_words = head[0] == '~';
    text_append(html, "<td%s data-head=\"", is_words ? " class=\"words\"" : "");
    xml_append(head + (is_words ? 1 : 0), html);
    text_append(html, "\">");
    xml_append(words, html);
    text_append(html, "</td>\n");
}

void html_cell_units(double value, const char *unit, Text *html)
{
    Text words;
    text_init(&words);
    if (isfinite(value)) {
        units_append(&words, value, unit);
    }
    html_words("td", words.data, html);
    text_finish(&words);
}

void html_cell_number(const char *format, double value, Text *html)
{
    char words[32] = "";
    if (isfinite(value)) {
        snprintf(words, sizeof words, format, value);
    }
    html_words("td", words, html);
}

// Whether a word has a number with a negative exponent, 5e-05, which browsers break at its sign.
static bool has_breakable_number(const char *word, size_t length)
{
    bool has = false;
    for (size_t i = 1; i + 2 < length; i++) {
        has |= isdigit((unsigned char)word[i - 1]) && word[i] == 'e' && word[i + 1] == '-' &&
               isdigit((unsigned char)word[i + 2]);
    }
    return has;
}

// One sentence, whose numbers stay whole where it is broken into lines.
static void append_item(const char *sentence, size_t length, Text *html)
{
    text_append(html, "<li>");
    for (size_t at = 0; at < length;) {
        size_t end = at;
        while (end < length && sentence[end] != ' ') {
            end++;
        }
        Text word;
        text_init(&word);
        text_append_bytes(&word, sentence + at, end - at);
        const bool is_whole = has_breakable_number(sentence + at, end - at);
        text_append(html, "%s", is_whole ? "<span class=\"whole\">" : "");
        xml_append(word.length > 0 ? word.data : "", html);
        text_append(html, "%s%s", is_whole ? "</span>" : "", end < length ? " " : "");
        text_finish(&word);
        at = end + (end < length ? 1 : 0);
    }
    text_append(html, "</li>\n");
}

void html_list(const char *sentences, Text *html)
{
    if (sentences[0] == '\0') {
        return;
    }
    text_append(html, "<ul>\n");
    for (const char *at = sentences; *at != '\0';) {
        at += strspn(at, " ");
        const size_t length = strcspn(at, "\n");
        append_item(at, length, html);
        at += length + (at[length] == '\n' ? 1 : 0);
    }
    text_append(html, "</ul>\n");
}

static void begin_table(const char *class, const char *caption, size_t count,
                        const char *const *heads, Text *html)
{
    text_append(html, HTML_WIDE "<table class=\"%s\">\n", class);
    html_words("caption", caption, html);
    text_append(html, "<thead><tr>");
    for (size_t i = 0; i < count; i++) {
        const bool is_words = heads[i][0] == '~';
        html_words(is_words ? "th scope=\"col\" class=\"words\"" : "th scope=\"col\"",
                   heads[i] + (is_words ? 1 : 0), html);
    }
    text_append(html, "</tr></thead>\n<tbody>\n");
}

void html_table_begin(const char *caption, size_t count, const char *const *heads, Text *html)
{
    begin_table("numbers", caption, count, heads, html);
}

void html_cards_begin(const char *caption, size_t count, const char *const *heads, Text *html)
{
    begin_table("numbers cards", caption, count, heads, html);
}

void html_table_end(Text *html)
{
    text_append(html, "</tbody></table></div>\n");
}

double html_number_of(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

const char *html_text_of(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text != NULL ? text : "";
}

bool html_flag_of(const json_t *object, const char *key)
{
    return json_is_true(json_object_get(object, key));
}

void html_cell_text_of(const json_t *object, const char *key, Text *html)
{
    html_words("td", html_text_of(object, key), html);
}

void html_cell_number_of(const json_t *object, const char *key, const char *format, Text *html)
{
    html_cell_number(format, html_number_of(object, key), html);
}

void html_cell_units_of(const json_t *object, const char *key, const char *unit, Text *html)
{
    html_cell_units(html_number_of(object, key), unit, html);
}
