// Do the lines of a comparison's store, which anybody may have edited, bring down what reads and
// reports them?
//
// The first line, which holds the key, is put in front of the input, unless that begins with one.
// Lines that end like a whole one are given their checksum, or hardly any would be looked into.
#include "base/hash.h"
#include "commands/compare/compare.h"
#include "write/journal.h"

#include "fuzz_check.h"
#include "fuzz_file.h"
#include "mechanism.h"

#include <inttypes.h>

static const char HEAD[] = "{\"compare\":{\"build\":\"b\"}}";
static const char MACHINE[] = "m";

static void report(const Scenario *scenario, Ladder *ladder)
{
    ladder_conclude(ladder);
    const CompareReport report = {scenario, ladder, MACHINE};
    Text text;
    text_init(&text);
    compare_text_write(&report, &STYLE_PLAIN, &text);
    compare_plot_write(&report, &text);
    json_t *object = compare_json_build(&report);
    char *words = json_dumps(object, 0);
    fuzz_check(words != NULL, "what was taken can be written as JSON");
    free(words);
    json_decref(object);
    text_finish(&text);
}

static void take(const json_t *entries)
{
    static const Scheme SCHEMES[2] = {{.name = "direct/plain/textbook", .backend = BACKEND_ODE},
                                      {.name = "reference", .backend = BACKEND_REFERENCE}};
    static const double STEPS[2] = {1e-5, 3e-6};
    static Scenario scenario; // its linkage is kept to the end, so that it is made once
    if (scenario.linkage.body_count == 0) {
        scenario = mechanism_paper();
        mechanism_loosen(&scenario, "crank-coupler");
    }
    Ladder *ladder = ladder_create(SCHEMES, 2, STEPS, 2, 5);
    size_t index;
    json_t *entry;
    bool is_whole = true;
    json_array_foreach(entries, index, entry)
    {
        is_whole = is_whole && ladder_json_take(ladder, &scenario.linkage, entry, MACHINE) !=
                                   LADDER_JSON_DAMAGED;
    }
    if (is_whole) {
        report(&scenario, ladder);
    }
    ladder_destroy(ladder);
}

// Appends a line with its checksum: the last member of an object.
static void append_sealed(Text *text, const char *line, size_t length)
{
    const bool is_whole = length > 2 && line[length - 1] == '}';
    if (is_whole) {
        length--;
    }
    text_append(text, "%.*s", (int)length, line);
    if (is_whole) {
        text_append(text, ",\"checksum\":\"%016" PRIx64 "\"}",
                    hash_bytes(HASH_START, line, length));
    }
}

static void seal(const char *input, Text *text)
{
    if (strncmp(input, "{\"compare\"", strlen("{\"compare\"")) != 0) {
        append_sealed(text, HEAD, strlen(HEAD));
        text_append(text, "\n");
    }
    while (*input != '\0') {
        const size_t length = strcspn(input, "\n");
        append_sealed(text, input, length);
        input += length;
        if (*input == '\n') {
            text_append(text, "\n");
            input++;
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static FuzzFile file;
    Err err = {0};
    Journal journal;
    Text text;
    text_init(&text);
    char *input = fuzz_copy(data, size);
    seal(input, &text);
    fuzz_file_fill(&file, text.data, text.length);
    free(input);
    text_finish(&text);
    json_t *key = json_pack("{s:s}", "build", "b");
    if (journal_open(&journal, &JOURNAL_COMPARE, file.path, key, false, &err)) {
        take(journal.entries);
        journal_close(&journal);
    } else {
        fuzz_check_err(&err);
        fuzz_check(err.kind == ERR_FILE, "a bad store is an error of its file");
    }
    json_decref(key);
    return 0;
}
