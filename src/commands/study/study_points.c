// Which points does a picture of a study have?
#include "commands/study/study_points.h"

#include "base/sorted.h"
#include "base/text.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_ROOM = 1024 };

typedef struct Gathering {
    StudyPoints *points;
    size_t room;
    size_t x;
    size_t y;
    bool has_y;
    bool has_by;
} Gathering;

static double number_of(const Layout *layout, const Record *record, size_t column)
{
    return column < layout->setting_count ? record->settings[column].number
                                          : record->results[column - layout->setting_count];
}

static size_t group_of(const StudyPoints *points, const Layout *layout, const Record *record)
{
    const Cell *value = &record->settings[points->by];
    const bool is_word = layout->settings[points->by].kind == COLUMN_WORD;
    for (size_t i = 0; i < points->group_count; i++) {
        if (is_word ? strcmp(value->word, points->groups[i].word) == 0
                    : value->number == points->groups[i].number) {
            return i;
        }
    }
    return points->group_count;
}

static bool take_row(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)err;
    Gathering *gathering = context;
    StudyPoints *points = gathering->points;
    const StudyPoint point = {
        .x = number_of(layout, record, gathering->x),
        .y = gathering->has_y ? number_of(layout, record, gathering->y) : 0.0,
        .group = gathering->has_by ? group_of(points, layout, record) : 0,
    };
    const bool is_point = record->outcome == RUN_OUTCOME_OK && isfinite(point.x) &&
                          isfinite(point.y) && point.group < points->group_count;
    if (!is_point) {
        points->left_out++;
        return true;
    }
    if (points->count == gathering->room) {
        gathering->room = gathering->room == 0 ? FIRST_ROOM : 2 * gathering->room;
        points->points = realloc(points->points, gathering->room * sizeof *points->points);
        assert(points->points != NULL);
    }
    points->points[points->count++] = point;
    return true;
}

static int compare_points(const void *a, const void *b)
{
    const StudyPoint *left = a;
    const StudyPoint *right = b;
    if (left->group != right->group) {
        return left->group < right->group ? -1 : 1;
    }
    const int by_x = sorted_compare(&left->x, &right->x);
    return by_x != 0 ? by_x : sorted_compare(&left->y, &right->y);
}

static size_t count_x(const StudyPoints *points)
{
    double *x = malloc((points->count + 1) * sizeof *x);
    assert(x != NULL);
    for (size_t i = 0; i < points->count; i++) {
        x[i] = points->points[i].x;
    }
    sorted_make(x, points->count);
    size_t count = 0;
    for (size_t i = 0; i < points->count; i++) {
        count += i == 0 || x[i] != x[i - 1] ? 1 : 0;
    }
    free(x);
    return count;
}

static void put_in_order(StudyPoints *points)
{
    qsort(points->points, points->count, sizeof *points->points, compare_points);
    size_t i = 0;
    for (size_t group = 0; group < points->group_count; group++) {
        points->first[group] = i;
        while (i < points->count && points->points[i].group == group) {
            i++;
        }
    }
    points->first[points->group_count] = i;
    points->x_count = count_x(points);
}

typedef enum Wanted {
    NUMBER,  // a column of settings or results, not of words
    SETTING, // a column of settings alone
} Wanted;

// Finds a column by name. Fails with ERR_USAGE, naming the one that may have been meant.
static bool find_column(const Layout *layout, const char *name, Wanted wanted, size_t *column,
                        Err *err)
{
    const char *names[RECORD_SETTING_MAX + RECORD_RESULT_MAX];
    const size_t all = layout->setting_count + layout->result_count;
    const size_t count = wanted == SETTING ? layout->setting_count : all;
    for (size_t i = 0; i < count; i++) {
        names[i] = store_column_at(layout, i)->name;
    }
    *column = store_column(layout, name);
    if (*column >= count) {
        const char *nearest = text_nearest(name, names, count);
        return err_set(err, ERR_USAGE, "the study has no %s '%s'%s%s%s",
                       wanted == SETTING ? "setting" : "column", name,
                       nearest == NULL ? "" : "; did you mean '", nearest == NULL ? "" : nearest,
                       nearest == NULL ? "" : "'?");
    }
    return wanted == SETTING || store_column_at(layout, *column)->kind != COLUMN_WORD ||
           err_set(err, ERR_USAGE, "the column %s holds words, and numbers are wanted", name);
}

static bool find_groups(Store *store, const char *by, StudyPoints *points, Err *err)
{
    points->group_count = 1;
    if (by == NULL) {
        return true;
    }
    return find_column(store_layout(store), by, SETTING, &points->by, err) &&
           store_values(store, points->by, STUDY_GROUP_MAX, points->groups, &points->group_count,
                        err) &&
           (points->group_count <= STUDY_GROUP_MAX ||
            err_set(err, ERR_USAGE, "%s has more than %d values, too many to tell apart", by,
                    STUDY_GROUP_MAX));
}

bool study_points_read(Store *store, const char *x, const char *y, const char *by,
                       StudyPoints *points, Err *err)
{
    const Layout *layout = store_layout(store);
    *points = (StudyPoints){0};
    Gathering gathering = {.points = points, .has_y = y != NULL, .has_by = by != NULL};
    bool is_read = find_column(layout, x, NUMBER, &gathering.x, err) &&
                   (y == NULL || find_column(layout, y, NUMBER, &gathering.y, err)) &&
                   find_groups(store, by, points, err) &&
                   store_each(store, take_row, &gathering, err);
    if (is_read && points->count == 0) {
        is_read = err_set(err, ERR_USAGE, "no run of the study has a number in %s%s%s", x,
                          y == NULL ? "" : " and in ", y == NULL ? "" : y);
    }
    if (!is_read) {
        study_points_finish(points);
        return false;
    }
    put_in_order(points);
    return true;
}

void study_points_finish(StudyPoints *points)
{
    free(points->points);
    *points = (StudyPoints){0};
}

size_t study_points_pile(const StudyPoints *points, size_t first)
{
    const StudyPoint *point = &points->points[first];
    size_t end = first + 1;
    while (end < points->count && points->points[end].group == point->group &&
           points->points[end].x == point->x) {
        end++;
    }
    return end;
}

void study_points_group_name(const StudyPoints *points, const Layout *layout, size_t group,
                             char words[RECORD_WORD_SIZE])
{
    if (layout->settings[points->by].kind == COLUMN_WORD) {
        text_copy(words, RECORD_WORD_SIZE, points->groups[group].word);
    } else {
        snprintf(words, RECORD_WORD_SIZE, "%.4g", points->groups[group].number);
    }
}
