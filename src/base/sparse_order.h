// In which order the nodes of a sparse matrix are eliminated, and which blocks that leaves.
#pragma once

#include <stddef.h>

// Two nodes whose block may be other than zero.
typedef struct SparseLink {
    size_t a;
    size_t b;
} SparseLink;

// A list of nodes in increasing order; owned.
typedef struct SparseList {
    size_t count;
    size_t room;
    size_t *nodes;
} SparseList;

// Writes the order of elimination of all nodes, the first `eliminated` of minimum degree (of equal
// ones the first), the others behind them as they are; and for each node the later ones whose
// blocks in its column are not zero then. The lists are to be freed.
void sparse_order_find(size_t count, size_t eliminated, size_t link_count, const SparseLink *links,
                       size_t *node_at, SparseList *later);
