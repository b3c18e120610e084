// Writes the rows of a mapping as CSV.
#include "commands/map/map.h"

bool mapping_rows_write_csv(const void *report, const char *path, Err *err)
{
    const Mapping *mapping = ((const MappingReport *)report)->mapping;
    return fields_csv_write(MAPPING_ROW_FIELDS, FIELD_CSV, mapping->rows, mapping->row_count,
                            sizeof *mapping->rows, path, err);
}
