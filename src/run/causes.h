// Which joints with play can make a spike of a body: those whose forces reach it through ideal
// joints, with no other play between. A driven body moves as it is told, and hands on nothing.
#pragma once

#include "model/linkage.h"

typedef struct Causes {
    size_t *firsts; // by body, where its joints begin in the list; owned, like the next two
    size_t *counts; // by body
    int *joints;    // bodies that ideal joints connect share theirs
} Causes;

Causes causes_find(const Linkage *linkage);
void causes_finish(Causes *causes);
