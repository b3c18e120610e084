// Writes a check as JUnit XML for a CI system.
//
// testsuites > testsuite, one a case > testcase: first one for the runs, whose time is theirs, then
// one an outcome or a limit of the case and one a number, which take none. A number out is a
// failure, whose message has the numbers; one not looked at is skipped; of a case that could not be
// checked the runs are in error.
//
// Jenkins takes what stands before the last dot of a class name for its package: the class of
// cases/paper/impact-k66.yaml is cases.paper.impact-k66, and no other dot stands in a name.
#include "commands/check/check_report.h"
#include "write/xml.h"

#include <math.h>
#include <string.h>

static const char RUNS[] = "runs"; // name of the test that is the runs themselves

static void append_attribute(Text *text, const char *name, const char *value)
{
    text_append(text, " %s=\"", name);
    xml_append(value, text);
    text_append(text, "\"");
}

// The class of a case: folders with dots between them, without the ending of its file.
static void append_class(Text *text, const char *path)
{
    Text name;
    text_init(&name);
    const char *slash = strrchr(path, '/');
    const char *file = slash != NULL ? slash + 1 : path;
    const char *ending = strrchr(file, '.');
    const char *end = ending != NULL && ending > file ? ending : path + strlen(path);
    while (path < end) {
        const size_t length = strcspn(path, "/");
        const size_t kept = path + length < end ? length : (size_t)(end - path);
        // . and .. name no folder
        if (strspn(path, ".") < kept) {
            text_append(&name, "%s", name.length > 0 ? "." : "");
            for (size_t i = 0; i < kept; i++) {
                text_append(&name, "%c", path[i] == '.' ? '_' : path[i]);
            }
        }
        path += length + (path[length] == '/' ? 1 : 0);
    }
    xml_append(name.data, text);
    text_finish(&name);
}

// A name without dots.
static void check_junit_append_name(Text *text, const char *prefix, const char *words)
{
    Text name;
    text_init(&name);
    text_append(&name, "%s", prefix);
    for (const char *c = words; *c != '\0'; c++) {
        text_append(&name, "%c", *c == '.' ? '/' : *c);
    }
    xml_append(name.data, text);
    text_finish(&name);
}

// A time as it is shown. The schema allows three decimals; what took time does not show as none.
static double shown_time(double time_s)
{
    return time_s > 0.0 ? fmax(time_s, 0.001) : 0.0;
}

// A test up to its outcome.
static void begin_test(Text *text, const CheckCase *item, const char *prefix, const char *name,
                       double time_s)
{
    text_append(text, "    <testcase classname=\"");
    append_class(text, item->path);
    text_append(text, "\" name=\"");
    check_junit_append_name(text, prefix, name);
    text_append(text, "\" time=\"%.3f\"", shown_time(time_s));
}

// <tag message="..." type="...">...</tag> in a test; some systems show the one, some the other.
static void append_outcome(Text *text, const char *tag, const char *type, const char *words)
{
    text_append(text, ">\n      <%s", tag);
    append_attribute(text, "message", words);
    append_attribute(text, "type", type);
    text_append(text, ">");
    xml_append(words, text);
    text_append(text, "</%s>\n    </testcase>\n", tag);
}

static void append_row(Text *text, const CheckCase *item, const CheckRow *row)
{
    begin_test(text, item, row->verdict == CHECK_SETTING ? "setting/" : "", row->name, 0.0);
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

static void append_limit(Text *text, const CheckCase *item, const CheckLimit *limit)
{
    begin_test(text, item, "expect/", limit->name, 0.0);
    if (limit->verdict == CHECK_WITHIN) {
        text_append(text, "/>\n");
        return;
    }
    char words[CHECK_WORDS_SIZE];
    check_report_limit(limit, words);
    Text message;
    text_init(&message);
    text_append(&message, "%s %s", limit->name, words);
    append_outcome(text, "failure", limit->verdict == CHECK_OUT ? "limit" : "not measured",
                   message.data);
    text_finish(&message);
}

static void check_junit_append_expected(Text *text, const CheckCase *item,
                                        const CheckOutcome *outcome)
{
    Text name;
    text_init(&name);
    text_append(&name, "%s/outcome", outcome->name);
    begin_test(text, item, "expect/", name.data, outcome->run.wall_s);
    if (outcome->is_as_expected) {
        text_append(text, "/>\n");
    } else {
        char words[CHECK_OUTCOME_TEXT_SIZE];
        check_outcome_words(outcome, words);
        append_outcome(text, "failure", "outcome", words);
    }
    text_finish(&name);
}

// A case that its limits alone judge has no baseline to pass.
static bool lacks_baseline(const CheckCase *item)
{
    return item->err.kind == ERR_NONE && item->baseline[0] == '\0' && item->limit_count > 0;
}

// Whether a row is a test of its own: the rows of ideal joints, which only say what was built, are
// one where they moved.
static bool is_test(const CheckRow *row)
{
    const char *slash = strrchr(row->name, '/');
    return check_row_is_out(row) || slash == NULL || strcmp(slash, "/constraint_rows") != 0;
}

static size_t count_tests(const CheckCase *item)
{
    size_t rows = 0;
    for (size_t i = 0; i < item->row_count; i++) {
        rows += is_test(&item->rows[i]) ? 1 : 0;
    }
    return 1 + rows + item->limit_count + item->outcome_count + (lacks_baseline(item) ? 1 : 0);
}

static void check_junit_append_case(Text *text, const CheckCase *item)
{
    const CheckCounts counts = check_report_count(item);
    const bool is_failed = item->err.kind != ERR_NONE;
    text_append(text, "  <testsuite name=\"");
    append_class(text, item->path);
    text_append(text,
                "\" tests=\"%zu\" failures=\"%zu\" errors=\"%d\" skipped=\"%zu\" "
                "time=\"%.3f\">\n",
                count_tests(item), counts.out + counts.limits_out + counts.outcomes_wrong,
                is_failed ? 1 : 0, counts.left_out + (lacks_baseline(item) ? 1 : 0), item->wall_s);
    begin_test(text, item, "", RUNS, item->wall_s);
    if (is_failed) {
        append_outcome(text, "error", "not checked", item->err.text);
    } else {
        text_append(text, "/>\n");
    }
    if (lacks_baseline(item)) {
        begin_test(text, item, "", "baseline", 0.0);
        append_outcome(text, "skipped", "no baseline",
                       item->note[0] != '\0' ? item->note : "judged by its limits alone");
    }
    for (size_t i = 0; i < item->outcome_count; i++) {
        check_junit_append_expected(text, item, &item->outcomes[i]);
    }
    for (size_t i = 0; i < item->limit_count; i++) {
        append_limit(text, item, &item->limits[i]);
    }
    for (size_t i = 0; i < item->row_count; i++) {
        if (is_test(&item->rows[i])) {
            append_row(text, item, &item->rows[i]);
        }
    }
    text_append(text, "  </testsuite>\n");
}

void check_junit_write(const void *target, Text *text)
{
    const CheckReport *report = target;
    size_t tests = 0;
    size_t failures = 0;
    double wall_s = 0.0;
    for (size_t i = 0; i < report->case_count; i++) {
        const CheckCase *item = &report->cases[i];
        const CheckCounts counts = check_report_count(item);
        tests += count_tests(item);
        failures += counts.out + counts.limits_out + counts.outcomes_wrong;
        wall_s += item->wall_s;
    }
    text_append(text,
                "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"jointplay check\" "
                "tests=\"%zu\" failures=\"%zu\" errors=\"%zu\" time=\"%.3f\">\n",
                tests, failures, check_report_errors(report), wall_s);
    for (size_t i = 0; i < report->case_count; i++) {
        check_junit_append_case(text, &report->cases[i]);
    }
    text_append(text, "</testsuites>\n");
}
