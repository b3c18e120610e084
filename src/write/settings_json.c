// Builds the JSON of versions and settings with which a result was made.
#include "write/settings_json.h"
#include "base/hash.h"
#include "casefile/casefile.h"
#include "version.h"
#include "write/json_value.h"
#include "write/settled.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

json_t *settings_json_tool(void)
{
    return json_pack("{s:s, s:s, s:s}", "version", JOINTPLAY_VERSION, "ode", JOINTPLAY_ODE_VERSION,
                     "ccd", JOINTPLAY_CCD_VERSION);
}

// A list from words separated by ", ".
static json_t *words_array(const char *words)
{
    json_t *list = json_array();
    while (*words != '\0') {
        const size_t length = strcspn(words, ",");
        json_array_append_new(list, json_stringn(words, length));
        words += length;
        words += strspn(words, ", ");
    }
    return list;
}

static json_t *points_array(const CasefileSetting *setting)
{
    json_t *list = json_array();
    for (size_t i = 0; i + 1 < setting->number_count; i += 2) {
        json_array_append_new(list, json_pack("[o, o]", json_value_real(setting->numbers[i]),
                                              json_value_real(setting->numbers[i + 1])));
    }
    return list;
}

// A number, or the list of a vector.
static json_t *numbers_value(const CasefileSetting *setting)
{
    if (setting->number_count == 1) {
        return json_value_real(setting->numbers[0]);
    }
    json_t *list = json_array();
    for (size_t i = 0; i < setting->number_count; i++) {
        json_array_append_new(list, json_value_real(setting->numbers[i]));
    }
    return list;
}

static json_t *setting_value(const CasefileSetting *setting)
{
    const double *numbers = setting->numbers;
    switch (setting->kind) {
    case CASEFILE_INTEGER:
        return json_integer((json_int_t)numbers[0]);
    case CASEFILE_NUMBER:
        return numbers_value(setting);
    case CASEFILE_TOLERATED:
        return json_pack("{s:o, s:o, s:o}", "nominal", json_value_real(numbers[0]), "lower",
                         json_value_real(numbers[1]), "upper", json_value_real(numbers[2]));
    case CASEFILE_POINTS:
        return points_array(setting);
    case CASEFILE_WORDS:
        return words_array(setting->text);
    default:
        return json_value_text(setting->text);
    }
}

// The settings that the scenario makes use of, by the key they have in a case file.
static void settings_json_set_settings(json_t *object, const Scenario *scenario)
{
    json_t *settings = json_object();
    json_t *units = json_object();
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, &setting)) {
        if (setting.applies) {
            json_object_set_new(settings, setting.key, setting_value(&setting));
        }
        if (setting.applies && setting.unit[0] != '\0') {
            json_object_set_new(units, setting.key, json_string(setting.unit));
        }
    }
    json_object_set_new(object, "settings", settings);
    json_object_set_new(object, "setting_units", units);
}

void settings_json_begin(json_t *object, const Scenario *scenario)
{
    json_object_set_new(object, "tool", settings_json_tool());
    json_object_set_new(object, "case", json_value_text(scenario_path(scenario)));
    json_object_set_new(object, "title", json_value_text(scenario->title));
    settings_json_set_settings(object, scenario);
    settled_json(object, scenario);
}

json_t *settings_json_all(const Scenario *scenario)
{
    json_t *settings = json_object();
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, &setting)) {
        json_object_set_new(settings, setting.key, setting_value(&setting));
    }
    return settings;
}

// The fingerprint of the program.

enum { CHUNK_WORDS = 1 << 13 };

void build_print(char text[BUILD_PRINT_SIZE])
{
    uint64_t chunk[CHUNK_WORDS] = {0};
    uint64_t hash = HASH_START;
    FILE *stream = fopen("/proc/self/exe", "rb");
    size_t count;
    while (stream != NULL && (count = fread(chunk, 1, sizeof chunk, stream)) > 0) {
        // by words, for the program has millions of bytes; those behind the last are of the chunk
        // before
        for (size_t i = 0; i < (count + sizeof *chunk - 1) / sizeof *chunk; i++) {
            hash = hash_word(hash, chunk[i]);
        }
    }
    if (stream != NULL) {
        fclose(stream);
    }
    snprintf(text, BUILD_PRINT_SIZE, "%016" PRIx64, hash);
}
