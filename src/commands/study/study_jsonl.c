// What does a program read of a study?
#include "commands/study/study_jsonl.h"

#include "write/file.h"
#include "write/json_value.h"

#include <inttypes.h>
#include <stdlib.h>

// 17 digits bring back every number as it was
static const size_t LINE_FLAGS = JSON_REAL_PRECISION(17) | JSON_COMPACT;

static const double WHOLE_MAX = 9007199254740992.0; // 2^53: whole numbers up to it are exact

static void set_number(json_t *object, const Column *column, double number)
{
    const bool is_whole =
        column->kind == COLUMN_WHOLE && fabs(number) <= WHOLE_MAX && number == rint(number);
    if (is_whole) {
        json_object_set_new(object, column->name, json_integer((json_int_t)number));
    } else {
        json_value_set(object, column->name, number);
    }
}

static json_t *build_row(const Layout *layout, const Record *record)
{
    json_t *object = json_object();
    json_object_set_new(object, "run", json_integer((json_int_t)record->run));
    for (size_t i = 0; i < layout->setting_count; i++) {
        const Column *column = &layout->settings[i];
        if (column->kind == COLUMN_WORD) {
            json_object_set_new(object, column->name, json_value_text(record->settings[i].word));
        } else {
            set_number(object, column, record->settings[i].number);
        }
    }
    json_object_set_new(object, "fate", json_string(FATE_WORDS[record->fate]));
    json_object_set_new(object, "reason",
                        record->reason[0] == '\0' ? json_null() : json_value_text(record->reason));
    for (size_t i = 0; i < layout->result_count; i++) {
        set_number(object, &layout->results[i], record->results[i]);
    }
    // hexadecimal: many readers of JSON know no whole number beyond 2^53
    char hash[32];
    snprintf(hash, sizeof hash, "%016" PRIx64, record->hash);
    json_object_set_new(object, "hash", record->hash == 0 ? json_null() : json_string(hash));
    json_value_set(object, "wall_s", record->wall_s);
    return object;
}

static bool write_row(const Layout *layout, const Record *record, void *context, Err *err)
{
    const WholeFile *file = context;
    json_t *object = build_row(layout, record);
    Text line;
    text_init(&line);
    json_value_write(object, LINE_FLAGS, &line);
    json_decref(object);
    fprintf(file->stream, "%s\n", line.data);
    text_finish(&line);
    return file_check(file, err);
}

bool study_jsonl_write(Store *store, const char *path, Err *err)
{
    WholeFile file;
    if (!file_begin(&file, FILE_ROWS, path, err)) {
        return false;
    }
    if (!store_each(store, write_row, &file, err)) {
        file_abandon(&file);
        return false;
    }
    return file_end(&file, err);
}
