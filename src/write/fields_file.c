// Writes the records of a field table to a file.
#include "write/fields.h"
#include "write/file.h"

bool fields_csv_write(const Field *fields, unsigned where, const void *records, size_t count,
                      size_t size, const char *path, Err *err)
{
    WholeFile file;
    if (!file_begin(&file, FILE_TABLE, path, err)) {
        return false;
    }
    fields_csv_head(fields, where, file.stream);
    for (size_t i = 0; i < count; i++) {
        fields_csv_row(fields, where, (const char *)records + i * size, file.stream);
    }
    return file_end(&file, err);
}
