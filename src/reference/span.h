// The tree over the bodies of a linkage: which ideal joints hold them, and which close loops.
#pragma once

#include "model/linkage.h"

// A body that hangs on a known one by an ideal joint, or floats.
typedef struct SpanStep {
    int body;
    int joint;  // -1: it floats
    int parent; // body at the joint's other end, or LINKAGE_GROUND
} SpanStep;

// A tree over all bodies but the driven ones. The joints that it does not use close loops.
typedef struct Span {
    const Linkage *linkage;
    size_t count;
    SpanStep *steps; // parents before children; owned, as the arrays below
    bool *is_used;   // by joint: the tree's, and the drives'
    int *parents;    // by body, and the ground first; LINKAGE_GROUND at a root
    size_t *depths;  // likewise: how many joints it is from a root; 0 at one
    int *ranks;      // likewise: the how manieth body of the tree, roots before; -1: not in it yet
    int rank;        // the next
} Span;

// For span_finish.
Span span_find(const Linkage *linkage);
void span_finish(Span *span);
