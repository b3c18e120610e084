// Numbers in as few digits as read back to the very same one.
#pragma once

#include <stdio.h>
#include <stdlib.h>

typedef struct NumberText {
    char text[32];
} NumberText;

// Of a number: 0.2 and not 0.20000000000000001.
static inline NumberText number_shortest(double value)
{
    NumberText shortest;
    for (int precision = 1; precision <= 17; precision++) {
        snprintf(shortest.text, sizeof shortest.text, "%.*g", precision, value);
        if (strtod(shortest.text, NULL) == value) {
            break;
        }
    }
    return shortest;
}
