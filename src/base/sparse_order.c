// Orders the nodes of a sparse matrix for their elimination.
//
// Eliminating a node links all of its neighbours with each other. The next one is always the one
// with the fewest neighbours (Tinney and Walker's second scheme, minimum degree): chains and trees
// are then eliminated from their ends, and no block becomes other than zero; loops leave a few.
//
// Source: W. F. Tinney and J. W. Walker, Proc. IEEE 55 (1967) 1801.
#include "base/sparse_order.h"

#include "base/heap.h"

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// Writes the nodes that are in either of two lists, but for two.
static void join_lists(const SparseList *a, const SparseList *b, size_t but, size_t and_but,
                       SparseList *joined)
{
    if (joined->room < a->count + b->count) {
        joined->room = 2 * (a->count + b->count);
        free(joined->nodes);
        joined->nodes = malloc(joined->room * sizeof *joined->nodes);
        assert(joined->nodes != NULL);
    }
    size_t i = 0;
    size_t k = 0;
    joined->count = 0;
    while (i < a->count || k < b->count) {
        const bool from_a = k == b->count || (i < a->count && a->nodes[i] <= b->nodes[k]);
        const size_t node = from_a ? a->nodes[i] : b->nodes[k];
        i += i < a->count && a->nodes[i] == node ? 1 : 0;
        k += k < b->count && b->nodes[k] == node ? 1 : 0;
        if (node != but && node != and_but) {
            joined->nodes[joined->count++] = node;
        }
    }
}

static int compare_nodes(const void *a, const void *b)
{
    const size_t first = *(const size_t *)a;
    const size_t second = *(const size_t *)b;
    return first < second ? -1 : first > second;
}

static void list_add(SparseList *list, size_t node)
{
    if (list->count == list->room) {
        list->room = 2 * list->room + 4;
        list->nodes = realloc(list->nodes, list->room * sizeof *list->nodes);
        assert(list->nodes != NULL);
    }
    list->nodes[list->count++] = node;
}

// The neighbours of every node.
static void list_neighbours(size_t count, size_t link_count, const SparseLink *links,
                            SparseList *lists)
{
    memset(lists, 0, count * sizeof *lists);
    for (size_t i = 0; i < link_count; i++) {
        assert(links[i].a < count && links[i].b < count && links[i].a != links[i].b);
        list_add(&lists[links[i].a], links[i].b);
        list_add(&lists[links[i].b], links[i].a);
    }
    for (size_t i = 0; i < count; i++) {
        SparseList *list = &lists[i];
        size_t kept = 0;
        if (list->count > 0) {
            qsort(list->nodes, list->count, sizeof *list->nodes, compare_nodes);
        }
        for (size_t k = 0; k < list->count; k++) {
            if (kept == 0 || list->nodes[kept - 1] != list->nodes[k]) {
                list->nodes[kept++] = list->nodes[k];
            }
        }
        list->count = kept;
    }
}

// Links the neighbours of a node with each other and takes it out.
static void link_neighbours(const SparseList *later, size_t node, SparseList *lists,
                            SparseList *spare)
{
    for (size_t i = 0; i < later->count; i++) {
        SparseList *list = &lists[later->nodes[i]];
        join_lists(list, later, node, later->nodes[i], spare);
        const SparseList kept = *list;
        *list = *spare;
        *spare = kept;
    }
}

void sparse_order_find(size_t count, size_t eliminated, size_t link_count, const SparseLink *links,
                       size_t *node_at, SparseList *later)
{
    // by its number of neighbours; a node stands in it again whenever it has fewer or more of them
    Heap heap = {0};
    SparseList spare = {0};
    bool *is_out = calloc(count + 1, sizeof *is_out);
    assert(is_out != NULL);
    list_neighbours(count, link_count, links, later);
    for (size_t i = 0; i < eliminated; i++) {
        heap_push(&heap, later[i].count, i);
    }
    size_t next = 0;
    while (next < eliminated) {
        const HeapItem top = heap_pop(&heap);
        if (is_out[top.second] || top.first != later[top.second].count) {
            continue;
        }
        is_out[top.second] = true;
        node_at[next++] = top.second;
        link_neighbours(&later[top.second], top.second, later, &spare);
        for (size_t i = 0; i < later[top.second].count; i++) {
            const size_t node = later[top.second].nodes[i];
            if (node < eliminated) {
                heap_push(&heap, later[node].count, node);
            }
        }
    }
    // of the nodes that are kept, those behind each one
    for (size_t i = eliminated; i < count; i++) {
        size_t kept = 0;
        node_at[next++] = i;
        for (size_t k = 0; k < later[i].count; k++) {
            if (later[i].nodes[k] > i) {
                later[i].nodes[kept++] = later[i].nodes[k];
            }
        }
        later[i].count = kept;
    }
    heap_finish(&heap);
    free(spare.nodes);
    free(is_out);
}
