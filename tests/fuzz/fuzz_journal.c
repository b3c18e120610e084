// Do the lines of a comparison's store, which anybody may have edited, bring down what reads and
// reports them?
//
// The first line, which holds the key, is put in front of the input, unless that begins with one.
#include "report/compare_json.h"
#include "report/compare_plot.h"
#include "report/compare_text.h"
#include "report/journal.h"
#include "report/ladder_json.h"

#include "fuzz_check.h"
#include "fuzz_file.h"
#include "mechanism.h"

static const char HEAD[] = "{\"compare\":{\"build\":\"b\"}}\n";
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
    static Scenario scenario; // too large for the stack
    scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static FuzzFile file;
    Err err = {0};
    Journal journal;
    char *text = fuzz_copy(data, size);
    const bool has_head = strncmp(text, "{\"compare\"", strlen("{\"compare\"")) == 0;
    char *whole = malloc(size + sizeof HEAD);
    fuzz_check(whole != NULL, "there is memory");
    const size_t lead = has_head ? 0 : strlen(HEAD);
    memcpy(whole, HEAD, lead);
    memcpy(whole + lead, data, size);
    fuzz_file_fill(&file, whole, lead + size);
    free(whole);
    free(text);
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
