// Puts pictures of the program into a page.
#include "commands/report/report_svg.h"
#include "write/xml.h"

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

// A quote in a text of a user's is escaped there, so that none looks like a class.
void svg_embed(const char *svg, const char *label, Text *html)
{
    // in HTML SVG needs no name of its own kind
    static const char OPENING[] = "<svg xmlns=\"http://www.w3.org/2000/svg\" ";
    static const char STYLE[] = "<style>";
    static const char STYLE_END[] = "</style>";
    static const char CLASS[] = "class=\"";
    text_append(html, "<div class=\"wide picture\"><svg role=\"img\" aria-label=\"");
    xml_append(label, html);
    text_append(html, "\" font-family=\"Arial, sans-serif\" font-size=\"12\" ");
    const char *at = svg + strlen(OPENING);
    while (*at != '\0') {
        const size_t plain = strcspn(at, "<c");
        text_append_bytes(html, at, plain);
        at += plain;
        if (strncmp(at, STYLE, strlen(STYLE)) == 0) {
            at = strstr(at, STYLE_END) + strlen(STYLE_END);
        } else if (strncmp(at, CLASS, strlen(CLASS)) == 0) {
            at += strlen(CLASS);
            const size_t length = strcspn(at, "\"");
            append_class(at, length, html);
            at += length + 1;
        } else if (*at != '\0') {
            text_append_bytes(html, at++, 1);
        }
    }
    text_append(html, "</div>\n");
}
