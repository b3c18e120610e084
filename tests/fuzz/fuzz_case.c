// Does any text bring the case reader down, or pass it and then not be written back?
//
// Lines at the end that begin with #--set are given as overrides, so that a corpus is made of case
// files.
#include "casefile/casefile.h"
#include "write/settings_json.h"

#include "fuzz_check.h"

#include <math.h>

enum { OVERRIDE_MAX = 4 };

static const char OVERRIDE[] = "\n#--set ";

// Takes the overrides off the end of the text; their count.
static size_t split(char *text, const char *overrides[OVERRIDE_MAX])
{
    size_t count = 0;
    char *line;
    while (count < OVERRIDE_MAX && (line = strrchr(text, '\n')) != NULL &&
           strncmp(line, OVERRIDE, strlen(OVERRIDE)) == 0) {
        overrides[count++] = line + strlen(OVERRIDE);
        *line = '\0';
    }
    return count;
}

static void check_settings(const Scenario *scenario)
{
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, &setting)) {
        for (size_t k = 0; setting.applies && k < setting.number_count; k++) {
            fuzz_check(!isnan(setting.numbers[k]), "a setting is a number");
        }
    }
}

// The settings as JSON, and read from there again.
static void write_back(const Scenario *scenario)
{
    json_t *object = settings_json_all(scenario);
    settings_json_begin(object, scenario);
    char *words = json_dumps(object, JSON_REAL_PRECISION(17));
    fuzz_check(words != NULL, "settings can be written as JSON");
    json_t *again = json_loads(words, JSON_REJECT_DUPLICATES, NULL);
    fuzz_check(again != NULL && json_equal(again, object), "settings come back from JSON");
    json_decref(again);
    json_decref(object);
    free(words);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static Scenario scenario; // too large for the stack
    Err err = {0};
    const char *overrides[OVERRIDE_MAX];
    char *text = fuzz_copy(data, size);
    const size_t count = split(text, overrides);
    // what stands in front of the overrides, or all where there are none: a zero is no end
    const size_t length = count > 0 ? strlen(text) : size;
    if (casefile_load_text("case.yaml", text, length, overrides, count, &scenario, &err)) {
        check_settings(&scenario);
        write_back(&scenario);
        scenario_free(&scenario);
    } else {
        fuzz_check_err(&err);
        fuzz_check(err.kind == ERR_CASE || err.kind == ERR_USAGE,
                   "a bad case is an error of the case or of the command line");
    }
    free(text);
    return 0;
}
