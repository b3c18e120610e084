// What a picture of a study shows of its runs: two numbers of each, and the group it belongs to.
#pragma once

#include "commands/study/store.h"

enum { STUDY_GROUP_MAX = 8 }; // that can be told apart in a picture

typedef struct StudyPoint {
    double x;
    double y;
    size_t group;
} StudyPoint;

// The points of all groups, by rising group, then x, then y.
typedef struct StudyPoints {
    size_t count;
    StudyPoint *points; // owned
    size_t group_count; // at least 1
    size_t by;          // the column of the groups; used where there is more than one value
    Cell groups[STUDY_GROUP_MAX];
    size_t first[STUDY_GROUP_MAX + 1]; // where each group begins, and where the last one ends
    size_t x_count;                    // different values of x
    uint64_t left_out;                 // runs without one of the numbers
} StudyPoints;

// Reads them. Without y (NULL) all y are 0, without `by` there is one group. Fails with ERR_FILE,
// or with ERR_USAGE where there is no such column, it has too many values, or there are no points;
// the points are then empty.
bool study_points_read(Store *store, const char *x, const char *y, const char *by,
                       StudyPoints *points, Err *err);

// Accepts zeroed points.
void study_points_finish(StudyPoints *points);

// The points from a number on that share its x and its group: the number of the first that does
// not.
size_t study_points_pile(const StudyPoints *points, size_t first);

// The value that a group has in its column, in words.
void study_points_group_name(const StudyPoints *points, const Layout *layout, size_t group,
                             char words[RECORD_WORD_SIZE]);
