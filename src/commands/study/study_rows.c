// What do other programs read of a study?
#include "commands/study/study_rows.h"

#include "write/csv.h"
#include "write/file.h"
#include "write/json_value.h"

#include <inttypes.h>

enum { HASH_SIZE = 24 };

// 17 digits give back every number as it was
static const size_t LINE_FLAGS = JSON_REAL_PRECISION(17) | JSON_COMPACT;

static const double WHOLE_MAX = 9007199254740992.0; // 2^53: whole numbers up to it are exact

// In hexadecimal: many readers of JSON know no whole number beyond 2^53. Empty where there is none.
static void write_hash(uint64_t hash, char words[HASH_SIZE])
{
    words[0] = '\0';
    if (hash != 0) {
        snprintf(words, HASH_SIZE, "%016" PRIx64, hash);
    }
}

static void write_cell(FILE *stream, const RecordField *field, const Record *record)
{
    char hash[HASH_SIZE];
    switch (field->kind) {
    case COLUMN_RUN:
        fprintf(stream, "%" PRIu64, record->run);
        break;
    case COLUMN_FATE:
        fputs(RUN_OUTCOME_WORDS[record->outcome], stream);
        break;
    case COLUMN_WORD:
    case COLUMN_REASON:
        csv_write_word(stream, record_text(record, field));
        break;
    case COLUMN_HASH:
        write_hash(record->hash, hash);
        fputs(hash, stream);
        break;
    case COLUMN_REAL:
    case COLUMN_WHOLE:
        csv_write_number(stream, record_number(record, field));
        break;
    }
}

// The names of the columns where there is no record.
static void write_line(FILE *stream, const Layout *layout, const Record *record)
{
    RecordField field;
    for (size_t i = 0; record_field(layout, i, &field); i++) {
        if (i > 0) {
            fputc(',', stream);
        }
        if (record == NULL) {
            csv_write_word(stream, field.name);
        } else {
            write_cell(stream, &field, record);
        }
    }
    fputc('\n', stream);
}

static bool take_csv(const Layout *layout, const Record *record, void *file, Err *err)
{
    write_line(((const WholeFile *)file)->stream, layout, record);
    return file_check(file, err);
}

static json_t *build_number(ColumnKind kind, double number)
{
    const bool is_whole =
        kind == COLUMN_WHOLE && fabs(number) <= WHOLE_MAX && number == rint(number);
    return is_whole ? json_integer((json_int_t)number) : json_value_real(number);
}

static json_t *build_value(const RecordField *field, const Record *record)
{
    char hash[HASH_SIZE];
    switch (field->kind) {
    case COLUMN_RUN:
        return json_integer((json_int_t)record->run);
    case COLUMN_FATE:
        return json_string(RUN_OUTCOME_WORDS[record->outcome]);
    case COLUMN_WORD:
        return json_value_text(record_text(record, field));
    case COLUMN_REASON:
        return record->reason[0] == '\0' ? json_null() : json_value_text(record->reason);
    case COLUMN_HASH:
        write_hash(record->hash, hash);
        return hash[0] == '\0' ? json_null() : json_string(hash);
    case COLUMN_REAL:
    case COLUMN_WHOLE:
        break;
    }
    return build_number(field->kind, record_number(record, field));
}

static bool take_jsonl(const Layout *layout, const Record *record, void *file, Err *err)
{
    json_t *object = json_object();
    RecordField field;
    for (size_t i = 0; record_field(layout, i, &field); i++) {
        json_object_set_new(object, field.name, build_value(&field, record));
    }
    Text line;
    text_init(&line);
    json_value_write(object, LINE_FLAGS, &line);
    json_decref(object);
    fprintf(((const WholeFile *)file)->stream, "%s\n", line.data);
    text_finish(&line);
    return file_check(file, err);
}

static bool write_rows(Store *store, FileKind kind, const char *path, StoreTaker take, Err *err)
{
    WholeFile file;
    if (!file_begin(&file, kind, path, err)) {
        return false;
    }
    if (kind == FILE_TABLE) {
        write_line(file.stream, store_layout(store), NULL);
    }
    if (!store_each(store, take, &file, err)) {
        file_abandon(&file);
        return false;
    }
    return file_end(&file, err);
}

bool study_rows_write_csv(Store *store, const char *path, Err *err)
{
    return write_rows(store, FILE_TABLE, path, take_csv, err);
}

bool study_rows_write_jsonl(Store *store, const char *path, Err *err)
{
    return write_rows(store, FILE_ROWS, path, take_jsonl, err);
}
