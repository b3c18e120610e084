// Things listed group by group.
#pragma once

#include <stddef.h>
#include <stdint.h>

// Of a thing that belongs to no group.
#define GROUPED_NONE SIZE_MAX

// Lists so many things, each of a group or none, group by group and in order: writes where the
// things of each group begin, and behind the last group how many there are.
static inline void grouped_list(size_t group_count, size_t count, const size_t *group_of,
                                size_t *first, size_t *things)
{
    for (size_t i = 0; i <= group_count; i++) {
        first[i] = 0;
    }
    for (size_t i = 0; i < count; i++) {
        if (group_of[i] != GROUPED_NONE) {
            first[group_of[i]]++;
        }
    }
    for (size_t i = 0; i < group_count; i++) {
        first[i + 1] += first[i];
    }
    // each begins at its end, and comes down as it is filled from there
    for (size_t i = count; i-- > 0;) {
        if (group_of[i] != GROUPED_NONE) {
            things[--first[group_of[i]]] = i;
        }
    }
}
