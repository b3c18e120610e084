// Reads rows of numbers of a driver's answer, and says which number is none.
#include "engine/row.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// SI: no number of a mechanism is larger, be it a speed, a force or a count
static const double NUMBER_MOST = 1e15;

// bytes of a value that is shown
enum { VALUE_SHOWN_MOST = 60 };

// What a line has in the place of a number, as a message shows it; the caller frees it.
static char *shown_value(const json_t *value)
{
    char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(6));
    if (text != NULL && strlen(text) > VALUE_SHOWN_MOST) {
        text[VALUE_SHOWN_MOST] = '\0';
    }
    return text;
}

bool engine_row_read(const json_t *row, const EngineRow *as, double *numbers, Err *err)
{
    if (!json_is_array(row) || json_array_size(row) != as->count) {
        return err_set(err, ERR_SOLVER, "its line '%s' has no '%s[%zu]' of %zu numbers", as->line,
                       as->field, as->index, as->count);
    }
    for (size_t i = 0; i < as->count; i++) {
        const json_t *value = json_array_get(row, i);
        const bool is_number = json_is_number(value);
        numbers[i] = is_number ? json_number_value(value) : NAN;
        if (is_number ? fabs(numbers[i]) <= NUMBER_MOST : i >= as->known && json_is_null(value)) {
            continue;
        }
        char *shown = shown_value(value);
        err_set(err, ERR_SOLVER,
                "its line '%s' has as '%s[%zu][%zu]' %s, which has to be a number of at most %.0e",
                as->line, as->field, as->index, i, shown != NULL ? shown : "no value", NUMBER_MOST);
        free(shown);
        return false;
    }
    return true;
}

bool engine_row_count(const json_t *rows, const EngineRow *as, size_t count, Err *err)
{
    return (json_is_array(rows) && json_array_size(rows) == count) ||
           err_set(err, ERR_SOLVER, "its line '%s' has no '%s' of %zu rows of %zu numbers",
                   as->line, as->field, count, as->count);
}
