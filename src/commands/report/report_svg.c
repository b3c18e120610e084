// Puts pictures of the program into a page.
#include "commands/report/report_svg.h"
#include "commands/report/report_html.h"
#include "write/xml.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// What a class of the picture's style sheet stands for, as attributes: they need no style sheet.
typedef struct ClassAttributes {
    const char *name;
    const char *attributes;
} ClassAttributes;

static const ClassAttributes CLASSES[] = {
    {"title", "font-size=\"17\" font-weight=\"bold\""},
    {"panel", "font-size=\"14\" font-weight=\"bold\""},
    {"note", "fill=\"#555\""},
    {"grid", "stroke=\"#e4e4e4\""},
    {"zero", "stroke=\"#b0b0b0\""},
    {"frame", "stroke=\"#444\" fill=\"none\""},
    {"line", "fill=\"none\" stroke-linejoin=\"round\""},
    {"halo", "fill=\"#555\" paint-order=\"stroke\" stroke=\"#fff\" stroke-width=\"3\""},
};

static void append_class(const char *name, size_t length, Text *html)
{
    for (size_t i = 0; i < sizeof CLASSES / sizeof *CLASSES; i++) {
        if (strlen(CLASSES[i].name) == length && strncmp(CLASSES[i].name, name, length) == 0) {
            text_append(html, "%s", CLASSES[i].attributes);
        }
    }
}

// Appends the data of a path up to its quote, and returns where that is. A line that goes up and
// down in one column of pixels many times goes there to its highest and lowest point once.
static const char *append_path(const char *at, Text *html)
{
    while (*at != '\0' && *at != '"') {
        const size_t plain = strcspn(at, "V\"");
        text_append_bytes(html, at, plain);
        at += plain;
        double low = INFINITY;
        double high = -INFINITY;
        double last = NAN;
        while (*at == 'V') {
            char *end = NULL;
            last = strtod(at + 1, &end);
            low = fmin(low, last);
            high = fmax(high, last);
            at = end;
        }
        if (low < last) {
            text_append(html, "V%.1f", low);
        }
        if (high > last) {
            text_append(html, "V%.1f", high);
        }
        if (isfinite(last)) {
            text_append(html, "V%.1f", last);
        }
    }
    return at;
}

// A quote in a text of a user's is escaped there, so that none looks like a class.
void svg_embed(const char *svg, const char *label, Text *html)
{
    // in HTML SVG needs no name of its own kind
    static const char OPENING[] = "<svg xmlns=\"http://www.w3.org/2000/svg\" ";
    static const char STYLE[] = "<style>";
    static const char STYLE_END[] = "</style>";
    static const char CLASS[] = "class=\"";
    static const char PATH[] = " d=\"";
    text_append(html,
                "<div class=\"wide picture\" " HTML_SCROLLS "><svg role=\"img\" aria-label=\"");
    xml_append(label, html);
    text_append(html, "\" font-family=\"Arial, sans-serif\" font-size=\"12\" ");
    const char *at = svg + strlen(OPENING);
    while (*at != '\0') {
        const size_t plain = strcspn(at, "<c ");
        text_append_bytes(html, at, plain);
        at += plain;
        if (strncmp(at, STYLE, strlen(STYLE)) == 0) {
            at = strstr(at, STYLE_END) + strlen(STYLE_END);
        } else if (strncmp(at, CLASS, strlen(CLASS)) == 0) {
            at += strlen(CLASS);
            const size_t length = strcspn(at, "\"");
            append_class(at, length, html);
            at += length + 1;
        } else if (strncmp(at, PATH, strlen(PATH)) == 0) {
            text_append(html, "%s", PATH);
            at = append_path(at + strlen(PATH), html);
        } else if (*at != '\0') {
            text_append_bytes(html, at++, 1);
        }
    }
    text_append(html, "</div>\n");
}
