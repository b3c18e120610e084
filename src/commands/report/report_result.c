// Writes a page of results that were written before.
#include "commands/report/report_result.h"
#include "base/printable.h"
#include "casefile/input.h"
#include "commands/report/report_html.h"
#include "commands/report/report_pack.h"
#include "commands/report/report_shell.h"
#include "write/json_value.h"
#include "write/settings_json.h"
#include "write/xml.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const ResultKind *const KINDS[] = {&REPORT_COMPARE, &REPORT_MAP, &REPORT_TUNE, &REPORT_CHECK,
                                          &REPORT_PAPER};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

// How results of the program begin, but for blanks: that of paper is of no case.
static const char *const OPENINGS[] = {"{\"tool\":", "{\"tables\":"};

static bool begins_so(const char *head, size_t size, const char *opening)
{
    size_t at = 0;
    for (const char *c = opening; *c != '\0'; c++) {
        while (at < size && head[at] != '\0' && strchr(" \t\r\n", head[at]) != NULL) {
            at++;
        }
        if (at == size || head[at++] != *c) {
            return false;
        }
    }
    return true;
}

size_t result_read_head(const char *path, char *head, size_t size)
{
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode)) {
        return 0;
    }
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) {
        return 0;
    }
    const size_t got = fread(head, 1, size, stream);
    fclose(stream);
    return got;
}

bool result_is_one(const char *path)
{
    char head[64];
    const size_t size = result_read_head(path, head, sizeof head);
    return begins_so(head, size, OPENINGS[0]) || begins_so(head, size, OPENINGS[1]);
}

static const ResultKind *find_kind(const json_t *result)
{
    for (size_t i = 0; i < KIND_COUNT; i++) {
        if (json_object_get(result, KINDS[i]->key) != NULL) {
            return KINDS[i];
        }
    }
    return NULL;
}

static bool refuse_kind(const char *path, const json_t *result, Err *err)
{
    if (json_object_get(result, "runs") != NULL) {
        return err_set(err, ERR_USAGE,
                       "%s is a result of jointplay run, which has no samples; jointplay report "
                       "CASE makes the page of a run",
                       path);
    }
    return err_set(err, ERR_USAGE,
                   "%s is no result of jointplay compare, map, tune, check or paper", path);
}

// A new reference, and its kind; NULL on failure.
static json_t *read_result(const char *path, const ResultKind **kind, Err *err)
{
    char *text = NULL;
    size_t size = 0;
    if (!input_read("result", path, &text, &size, err)) {
        return NULL;
    }
    json_error_t error;
    json_t *result = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    free(text);
    if (result == NULL) {
        err_set(err, ERR_FILE, "%s:%d:%d: this is no JSON: %s", path, error.line, error.column,
                error.text);
        return NULL;
    }
    *kind = find_kind(result);
    if (*kind == NULL) {
        refuse_kind(path, result, err);
        json_decref(result);
        return NULL;
    }
    return result;
}

// How it was made.

static void append_result_value(const json_t *value, Text *words)
{
    if (json_is_string(value)) {
        text_append(words, "%s", json_string_value(value));
    } else {
        json_value_write(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(10), words);
    }
}

static void append_result_settings(const json_t *result, Text *html)
{
    const json_t *units = json_object_get(result, "setting_units");
    const char *key;
    json_t *value;
    text_append(html,
                "<details><summary>All settings, in SI units</summary>\n" HTML_WIDE "<table>\n");
    json_object_foreach(json_object_get(result, "settings"), key, value)
    {
        const char *unit = html_text_of(units, key);
        Text words;
        text_init(&words);
        append_result_value(value, &words);
        text_append(&words, "%s%s", unit[0] != '\0' ? " " : "", unit);
        html_pair(key, words.data, html);
        text_finish(&words);
    }
    text_append(html, "</table></div></details>\n");
}

// The versions of the program and its libraries that made a result.
static void append_tool(const json_t *tool, Text *html)
{
    static const char *const NAMES[][2] = {
        {"version", "jointplay"}, {"ode", "ode"}, {"ccd", "ccd"}};
    for (size_t i = 0; i < 3; i++) {
        html_pair(NAMES[i][1], html_text_of(tool, NAMES[i][0]), html);
    }
}

void result_made_write(const json_t *result, const char *command, Text *html)
{
    text_append(html, "<section id=\"made\">\n<h2>How it was made</h2>\n<p>This command makes this "
                      "page again:</p>\n<pre " HTML_SCROLLS ">");
    xml_append(command, html);
    text_append(html, "</pre>\n<table>\n");
    json_t *own = settings_json_tool();
    const json_t *tool = json_object_get(result, "tool");
    append_tool(tool != NULL ? tool : own, html);
    json_decref(own);
    if (html_text_of(result, "machine")[0] != '\0') {
        html_pair("times are of", html_text_of(result, "machine"), html);
    }
    text_append(html, "</table>\n");
    if (json_object_size(json_object_get(result, "settings")) > 0) {
        append_result_settings(result, html);
    }
    text_append(html, "<div id=\"saving\" class=\"controls screen\" hidden></div>\n</section>\n");
}

// The results, for the script to save.
static void append_result_data(const ResultPage *page, json_t *const *results, Text *data)
{
    json_t *all = json_array();
    for (size_t i = 0; i < page->count; i++) {
        json_array_append(all, results[i]);
    }
    char stem[256];
    const char *slash = strrchr(page->paths[0], '/');
    snprintf(stem, sizeof stem, "%.200s", slash != NULL ? slash + 1 : page->paths[0]);
    char *dot = strrchr(stem, '.');
    if (dot != NULL) {
        *dot = '\0';
    }
    json_t *object = json_object();
    json_object_set_new(object, "stem", json_value_text(stem));
    json_object_set_new(object, "runs", json_array());
    json_object_set_new(object, "results",
                        page->count == 1 ? json_incref(results[0]) : json_incref(all));
    Text json;
    text_init(&json);
    Pack pack = {0};
    json_value_write(object, JSON_COMPACT | JSON_REAL_PRECISION(17), &json);
    pack_write(&pack, json.data, data);
    pack_finish(&pack);
    text_finish(&json);
    json_decref(object);
    json_decref(all);
}

static void append_results(const ResultPage *page, json_t *const *results,
                           const ResultKind *const *kinds, Text *html)
{
    for (size_t i = 0; i < page->count; i++) {
        if (page->count > 1) {
            Text head;
            text_init(&head);
            text_append(&head, "jointplay %s: %s", kinds[i]->command,
                        html_text_of(results[i], "title"));
            html_words("h2 class=\"part\"", head.data, html);
            html_words("p class=\"note\"", page->paths[i], html);
            text_finish(&head);
        }
        kinds[i]->write(results[i], html);
    }
}

static void append_result_page(const ResultPage *page, json_t *const *results,
                               const ResultKind *const *kinds, Text *html)
{
    Text title;
    text_init(&title);
    const char *own = html_text_of(results[0], "title");
    text_append(&title, "%s%s%s", own[0] != '\0' ? own : "jointplay ", own[0] != '\0' ? ": " : "",
                kinds[0]->command);
    if (page->count > 1) {
        text_append(&title, " and more");
    }
    const char *path = html_text_of(results[0], "case");
    Shell shell = shell_create(SHELL_RESULT, title.data, path[0] != '\0' ? path : page->paths[0]);
    Text data;
    text_init(&data);
    append_result_data(page, results, &data);
    shell_begin(&shell, html);
    append_results(page, results, kinds, html);
    result_made_write(results[0], page->command, html);
    shell_end(&shell, data.data, html);
    text_finish(&data);
    shell_finish(&shell);
    text_finish(&title);
}

bool result_page_write(const ResultPage *page, Text *html, Err *err)
{
    json_t *results[RESULT_MOST] = {NULL};
    const ResultKind *kinds[RESULT_MOST] = {NULL};
    bool is_read = true;
    for (size_t i = 0; i < page->count && is_read; i++) {
        results[i] = read_result(page->paths[i], &kinds[i], err);
        is_read = results[i] != NULL;
    }
    if (is_read) {
        append_result_page(page, results, kinds, html);
    }
    for (size_t i = 0; i < page->count; i++) {
        json_decref(results[i]);
    }
    return is_read;
}
