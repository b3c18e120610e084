// Writes what every page has around its contents.
#include "commands/report/report_shell.h"
#include "commands/report/report_html.h"
#include "commands/report/report_pack.h"
#include "commands/report/report_sha256.h"

#include <string.h>

// The files that scripts are made of, and the style sheet; see meson.build.
// clang-format off
#define SHELL_RUN_LIST(member) \
    member(data) member(signals) member(plot) member(round) member(xy) member(turns) \
    member(joints) \
    member(shapes) member(mechanism) member(space) member(page)
#define SHELL_RESULT_LIST(member) member(data) member(saving)
// clang-format on
#define SHELL_DECLARE(name)                                                                        \
    extern const char embedded_report_##name[], embedded_report_##name##_end[];
SHELL_RUN_LIST(SHELL_DECLARE)
SHELL_DECLARE(saving)
SHELL_DECLARE(style)

// Appends a file without indentation, empty lines and lines that are a comment, which only its
// readers here need: a third of a script. No text in these files goes over a line's end.
static void append_embedded(const char *from, const char *end, Text *text)
{
    while (from < end) {
        while (from < end && (*from == ' ' || *from == '\n')) {
            from++;
        }
        const char *line_end = memchr(from, '\n', (size_t)(end - from));
        line_end = line_end != NULL ? line_end : end;
        if (end - from < 2 || strncmp(from, "//", 2) != 0) {
            text_append_bytes(text, from, (size_t)(line_end - from));
            text_append(text, "\n");
        }
        from = line_end;
    }
}

#define SHELL_APPEND(name)                                                                         \
    append_embedded(embedded_report_##name, embedded_report_##name##_end, &shell.script);

Shell shell_create(ShellKind kind, const char *title, const char *note)
{
    Shell shell = {.kind = kind, .title = title, .note = note};
    text_init(&shell.script);
    if (kind == SHELL_RUN) {
        SHELL_RUN_LIST(SHELL_APPEND)
    } else {
        SHELL_RESULT_LIST(SHELL_APPEND)
    }
    return shell;
}

void shell_finish(Shell *shell)
{
    text_finish(&shell->script);
}

static void append_hash(const Text *content, Text *html)
{
    unsigned char digest[SHA256_SIZE];
    report_sha256(content->data, content->length, digest);
    text_append(html, "'sha256-");
    pack_base64(digest, sizeof digest, html);
    text_append(html, "'");
}

static void append_head(const char *title, const Text *style, const Text *script, Text *html)
{
    text_append(html, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                      "<meta name=\"generator\" content=\"jointplay report\">\n"
                      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
                      "base-uri 'none'; form-action 'none'; img-src data:; script-src ");
    append_hash(script, html);
    text_append(html, "; style-src ");
    append_hash(style, html);
    text_append(html, "\">\n<meta name=\"viewport\" content=\"width=device-width, "
                      "initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n"
                      "<meta name=\"referrer\" content=\"no-referrer\">\n");
    html_words("title", title, html);
    text_append(html, "<style>%s</style>\n</head>\n", style->data);
}

void shell_begin(const Shell *shell, Text *html)
{
    Text style;
    text_init(&style);
    append_embedded(embedded_report_style, embedded_report_style_end, &style);
    append_head(shell->title, &style, &shell->script, html);
    text_append(html, "<body>\n<header>\n");
    html_words("h1", shell->title, html);
    html_words("p class=\"note\"", shell->note, html);
    text_append(html, "</header>\n<main>\n");
    text_finish(&style);
}

void shell_end(const Shell *shell, const char *data, Text *html)
{
    text_append(html,
                "</main>\n<template id=\"data\">\n%s</template>\n<script>%s</script>\n"
                "</body>\n</html>\n",
                data, shell->script.data);
}
