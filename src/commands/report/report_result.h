// A page of results that were written before: by compare, map, tune and check, with --json or
// --out.
#pragma once

#include "base/err.h"
#include "base/text.h"

#include <jansson.h>
#include <stdbool.h>

// A kind of result.
typedef struct ResultKind {
    const char *command;
    const char *key; // that it alone has, at its top
    void (*write)(const json_t *result, Text *html);
} ResultKind;

extern const ResultKind REPORT_COMPARE;
extern const ResultKind REPORT_MAP;
extern const ResultKind REPORT_TUNE;
extern const ResultKind REPORT_CHECK;
extern const ResultKind REPORT_PAPER;

enum { RESULT_MOST = 32 }; // files of a page

// What a page is made of.
typedef struct ResultPage {
    size_t count;
    const char *const *paths;
    const char *command; // that makes it again, as a shell takes it
} ResultPage;

// Reads how a file begins, and returns how many bytes it has read: none of what is no regular file,
// because a pipe would not have them again.
size_t result_read_head(const char *path, char *head, size_t size);

// Whether a file that jointplay report is given is a result, by how it begins; false of what cannot
// be read, which its own reader refuses.
bool result_is_one(const char *path);

// Appends the page. ERR_FILE where a file cannot be read, ERR_USAGE where it is no result that a
// page can be made of.
bool result_page_write(const ResultPage *page, Text *html, Err *err);

// Appends what a page says of how it was made: the command, versions, and the settings of a result
// where it has any (`result` may be NULL).
void result_made_write(const json_t *result, const char *command, Text *html);
