// Writes elements of a page.
#include "commands/report/report_html.h"
#include "write/units.h"
#include "write/xml.h"

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

void html_list(const char *sentences, Text *html)
{
    if (sentences[0] == '\0') {
        return;
    }
    text_append(html, "<ul>\n");
    for (const char *at = sentences; *at != '\0';) {
        at += strspn(at, " ");
        const size_t length = strcspn(at, "\n");
        Text sentence;
        text_init(&sentence);
        text_append_bytes(&sentence, at, length);
        html_words("li", sentence.data, html);
        text_finish(&sentence);
        at += length + (at[length] == '\n' ? 1 : 0);
    }
    text_append(html, "</ul>\n");
}
