// Reads the values of a command line's options.
#include "cli/option_values.h"

#include "casefile/quantity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { PART_SIZE = 256 };

bool option_values_read_count(const char *name, const char *text, size_t least, size_t most,
                              size_t *count, Err *err)
{
    Complaint complaint;
    size_t value;
    if (!quantity_integer(text, &value, &complaint) || value < least || value > most) {
        return err_set(err, ERR_USAGE, "--%s is %s; allowed: a whole number from %zu to %zu", name,
                       text, least, most);
    }
    *count = value;
    return true;
}

bool option_values_read_quantity(const char *name, const char *text, Dimension dimension,
                                 double *value, Err *err)
{
    Complaint complaint;
    double si;
    if (!quantity_parse(text, dimension, &si, &complaint)) {
        return err_set(err, ERR_USAGE, "--%s: %s%s%s", name, complaint.text,
                       complaint.allowed[0] != '\0' ? "; allowed: " : "", complaint.allowed);
    }
    if (!(si > 0.0)) {
        return err_set(err, ERR_USAGE, "--%s: %s is not above 0", name, text);
    }
    *value = si;
    return true;
}

static int compare_falling(const void *a, const void *b)
{
    const double left = *(const double *)a;
    const double right = *(const double *)b;
    return (left < right) - (left > right);
}

bool option_values_read_times(const char *name, const char *list, size_t room, double *seconds,
                              size_t *count, Err *err)
{
    *count = 0;
    while (*list != '\0') {
        char part[PART_SIZE];
        const size_t length = strcspn(list, ",");
        snprintf(part, sizeof part, "%.*s", (int)length, list);
        list += length + (list[length] == ',' ? 1 : 0);
        if (*count == room) {
            return err_set(err, ERR_USAGE, "--%s: more than %zu", name, room);
        }
        if (!option_values_read_quantity(name, part + strspn(part, " "), DIMENSION_TIME,
                                         &seconds[*count], err)) {
            return false;
        }
        (*count)++;
    }
    qsort(seconds, *count, sizeof *seconds, compare_falling);
    for (size_t i = 1; i < *count; i++) {
        if (seconds[i] == seconds[i - 1]) {
            return err_set(err, ERR_USAGE, "--%s: %.6g us is given twice", name, 1e6 * seconds[i]);
        }
    }
    return *count > 0 || err_set(err, ERR_USAGE, "--%s: the list is empty", name);
}

bool option_values_check_picture(const char *option, const char *path, Err *err)
{
    const char *name = path != NULL && strrchr(path, '/') != NULL ? strrchr(path, '/') + 1 : path;
    const char *dot = name != NULL ? strrchr(name, '.') : NULL;
    if (dot == NULL || dot == name || dot[1] == '\0' || strcasecmp(dot, ".svg") == 0) {
        return true;
    }
    return err_set(err, ERR_USAGE, "%s: %s: pictures are written as SVG alone; allowed: %.*s.svg",
                   option, path, (int)(dot - path), path);
}
