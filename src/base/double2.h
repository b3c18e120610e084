// Two numbers that are added and multiplied side by side: the vectors of gcc and clang, which any
// processor has instructions for, in place of loops that the compilers may or may not turn into
// them. One times a number is both times that number.
#pragma once

typedef double Double2 __attribute__((vector_size(2 * sizeof(double))));
