// Where in a step of the world contacts begin and end, and have their largest forces and depths.
#pragma once

#include "kernel/kernel.h"

// The instants within a step at which something stands out: contacts begin or end, forces and
// depths have their maxima, the step ends.
typedef struct Mark {
    double time_s; // since the start of the step
    size_t node;   // of the kernel: the state there is that of the interval behind it
    bool is_peak;  // whether it is there for a maximum alone
} Mark;

typedef struct Marks {
    size_t count;
    size_t room;
    size_t next; // the first that has not been handed on
    Mark *marks; // in order of time; owned
} Marks;

// Finds the marks of a kernel that has run. The last is the step's end. Of many maxima those
// that others nearly coincide with have no mark of their own.
void marks_find(Marks *marks, const Kernel *kernel);
void marks_finish(Marks *marks);
