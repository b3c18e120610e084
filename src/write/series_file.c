// Writes the series and the contacts of a run as files: the heads and cells of their columns.
#include "base/zeroed.h"
#include "write/contact_table.h"
#include "write/row_file.h"
#include "write/series_rows.h"

static void write_rows(const SeriesColumns *columns, const Trajectory *trajectory, RowFile *file)
{
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        for (size_t i = 0; i < columns->count; i++) {
            row_file_number(file, series_columns_value(columns, trajectory, k, i));
        }
        row_file_end_row(file);
    }
}

bool series_columns_write(const SeriesColumns *columns, const Trajectory *trajectory,
                          const char *path, Err *err)
{
    const char **names = zeroed(columns->count, sizeof *names);
    for (size_t i = 0; i < columns->count; i++) {
        names[i] = series_columns_name(columns, i).name;
    }
    RowFile file;
    bool is_written = row_file_begin(&file, path, names, columns->count, err);
    if (is_written) {
        write_rows(columns, trajectory, &file);
        is_written = row_file_end(&file, err);
    }
    free(names);
    return is_written;
}

static void write_contact(const ContactTable *table, const Trajectory *trajectory,
                          const JointSpike *contact, RowFile *file)
{
    for (size_t i = 0; i < table->count; i++) {
        if (table->columns[i].of == CONTACT_JOINT) {
            row_file_word(file, trajectory->linkage.joints[contact->joint].name);
        } else {
            row_file_number(file, contact_table_number(&table->columns[i], trajectory, contact));
        }
    }
    row_file_end_row(file);
}

bool contact_table_write(const Trajectory *trajectory, const char *path, Err *err)
{
    const ContactTable table = contact_table_of(&trajectory->linkage);
    const char *heads[CONTACT_COLUMN_MAX];
    for (size_t i = 0; i < table.count; i++) {
        heads[i] = table.columns[i].name;
    }
    RowFile file;
    if (!row_file_begin(&file, path, heads, table.count, err)) {
        return false;
    }
    contact_table_sort(trajectory);
    for (size_t i = 0; i < trajectory->contact_count; i++) {
        write_contact(&table, trajectory, &trajectory->contacts[i], &file);
    }
    return row_file_end(&file, err);
}
