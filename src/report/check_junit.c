// What does a CI system read of a regression check?
//
// testsuites > testsuite, one a case > testcase, one a number: classname is the case, name the
// metric. A number out is a failure, whose message has the numbers; one not looked at is skipped; a
// case that could not be checked is one test in error.
#include "report/check_junit.h"

// Text for an attribute or between tags. What XML cannot hold becomes a question mark.
static void append_escaped(Text *text, const char *words)
{
    for (const char *c = words; *c != '\0'; c++) {
        switch (*c) {
        case '&':
            text_append(text, "&amp;");
            break;
        case '<':
            text_append(text, "&lt;");
            break;
        case '>':
            text_append(text, "&gt;");
            break;
        case '"':
            text_append(text, "&quot;");
            break;
        case '\n':
            text_append(text, "&#10;");
            break;
        default:
            // 0x20 to 0x7e: a path need not be UTF-8
            text_append(text, "%c", *c >= 0x20 && *c < 0x7f ? *c : '?');
        }
    }
}

static void append_attribute(Text *text, const char *name, const char *value)
{
    text_append(text, " %s=\"", name);
    append_escaped(text, value);
    text_append(text, "\"");
}

static void begin_test(Text *text, const CheckCase *item, const char *name)
{
    text_append(text, "    <testcase");
    append_attribute(text, "classname", item->path);
    append_attribute(text, "name", name);
}

// <tag message="..." type="...">...</tag> in a test; some systems show the one, some the other.
static void append_outcome(Text *text, const char *tag, const char *type, const char *words)
{
    text_append(text, ">\n      <%s", tag);
    append_attribute(text, "message", words);
    append_attribute(text, "type", type);
    text_append(text, ">");
    append_escaped(text, words);
    text_append(text, "</%s>\n    </testcase>\n", tag);
}

static void append_row(Text *text, const CheckCase *item, const CheckRow *row)
{
    begin_test(text, item, row->name);
    if (row->verdict == CHECK_WITHIN) {
        text_append(text, "/>\n");
        return;
    }
    char words[CHECK_WORDS_SIZE];
    check_report_words(row, words);
    if (row->verdict == CHECK_LEFT_OUT) {
        append_outcome(text, "skipped", CHECK_VERDICT_WORDS[row->verdict], words);
        return;
    }
    Text message;
    text_init(&message);
    text_append(&message, "%s %s", row->name, words);
    append_outcome(text, "failure", CHECK_VERDICT_WORDS[row->verdict],
                   row->verdict == CHECK_SETTING ? words : message.data);
    text_finish(&message);
}

static void append_case(Text *text, const CheckCase *item)
{
    const CheckCounts counts = check_report_count(item);
    const bool is_failed = item->err.kind != ERR_NONE;
    text_append(text, "  <testsuite");
    append_attribute(text, "name", item->path);
    text_append(text, " tests=\"%zu\" failures=\"%zu\" errors=\"%d\" skipped=\"%zu\">\n",
                is_failed ? 1 : item->row_count, counts.out, is_failed ? 1 : 0, counts.left_out);
    if (is_failed) {
        begin_test(text, item, "check");
        append_outcome(text, "error", "not checked", item->err.text);
    }
    for (size_t i = 0; i < item->row_count; i++) {
        append_row(text, item, &item->rows[i]);
    }
    text_append(text, "  </testsuite>\n");
}

void check_junit_write(const CheckReport *report, Text *text)
{
    size_t tests = 0;
    size_t failures = 0;
    for (size_t i = 0; i < report->case_count; i++) {
        const CheckCase *item = &report->cases[i];
        tests += item->err.kind != ERR_NONE ? 1 : item->row_count;
        failures += check_report_count(item).out;
    }
    text_append(text,
                "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"jointplay check\" "
                "tests=\"%zu\" failures=\"%zu\" errors=\"%zu\">\n",
                tests, failures, check_report_errors(report));
    for (size_t i = 0; i < report->case_count; i++) {
        append_case(text, &report->cases[i]);
    }
    text_append(text, "</testsuites>\n");
}
