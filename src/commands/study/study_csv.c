// What does a spreadsheet read of a study?
#include "commands/study/study_csv.h"

#include "write/csv.h"
#include "write/file.h"

#include <inttypes.h>

static void write_names(FILE *stream, const Column *columns, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        fputc(',', stream);
        csv_write_word(stream, columns[i].name);
    }
}

static void write_head(FILE *stream, const Layout *layout)
{
    fputs("run", stream);
    write_names(stream, layout->settings, layout->setting_count);
    fputs(",fate,reason", stream);
    write_names(stream, layout->results, layout->result_count);
    fputs(",hash,wall_s\n", stream);
}

static void write_number(FILE *stream, double number)
{
    fputc(',', stream);
    csv_write_number(stream, number);
}

static bool write_row(const Layout *layout, const Record *record, void *context, Err *err)
{
    const WholeFile *file = context;
    FILE *stream = file->stream;
    fprintf(stream, "%" PRIu64, record->run);
    for (size_t i = 0; i < layout->setting_count; i++) {
        if (layout->settings[i].kind == COLUMN_WORD) {
            fputc(',', stream);
            csv_write_word(stream, record->settings[i].word);
        } else {
            write_number(stream, record->settings[i].number);
        }
    }
    fprintf(stream, ",%s,", FATE_WORDS[record->fate]);
    csv_write_word(stream, record->reason);
    for (size_t i = 0; i < layout->result_count; i++) {
        write_number(stream, record->results[i]);
    }
    fputc(',', stream);
    if (record->hash != 0) {
        fprintf(stream, "%016" PRIx64, record->hash);
    }
    write_number(stream, record->wall_s);
    fputc('\n', stream);
    return file_check(file, err);
}

bool study_csv_write(Store *store, const char *path, Err *err)
{
    WholeFile file;
    if (!file_begin(&file, FILE_TABLE, path, err)) {
        return false;
    }
    write_head(file.stream, store_layout(store));
    if (!store_each(store, write_row, &file, err)) {
        file_abandon(&file);
        return false;
    }
    return file_end(&file, err);
}
