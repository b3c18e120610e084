// Finds which blocks of a linkage's D = J M^-1 J' are not zero.
#include "model/response_matrix.h"

#include "base/zeroed.h"
#include "model/joint_nodes.h"

#include <stdlib.h>
#include <string.h>

static ResponseBlock make_block(const Sparse *matrix, size_t a, size_t b)
{
    const bool is_later = matrix->order[a] >= matrix->order[b];
    const size_t row = is_later ? a : b;
    const size_t column = is_later ? b : a;
    bool is_transposed;
    return (ResponseBlock){
        .rows = matrix->first_row[row],
        .columns = matrix->first_row[column],
        .row_count = matrix->first_row[row + 1] - matrix->first_row[row],
        .column_count = matrix->first_row[column + 1] - matrix->first_row[column],
        .values = sparse_block(matrix, row, column, &is_transposed),
    };
}

static int compare_links(const void *a, const void *b)
{
    const SparseLink *first = a;
    const SparseLink *second = b;
    return first->a != second->a ? (first->a < second->a ? -1 : 1)
                                 : (first->b > second->b) - (first->b < second->b);
}

ResponseBlock *response_matrix_init(const Linkage *linkage, const int *joints, const size_t *sizes,
                                    size_t count, size_t ideal, Sparse *matrix, size_t *block_count)
{
    SparseLink *links;
    const size_t link_count = joint_nodes_link(linkage, joints, count, &links);
    sparse_init(count, sizes, ideal, link_count, links, matrix);
    ResponseBlock *blocks = zeroed(count + link_count, sizeof *blocks);
    *block_count = 0;
    for (size_t i = 0; i < count; i++) {
        blocks[(*block_count)++] = make_block(matrix, i, i);
    }
    // two joints may share both of their bodies
    qsort(links, link_count, sizeof *links, compare_links);
    for (size_t i = 0; i < link_count; i++) {
        if (i == 0 || compare_links(&links[i - 1], &links[i]) != 0) {
            blocks[(*block_count)++] = make_block(matrix, links[i].a, links[i].b);
        }
    }
    free(links);
    return blocks;
}

void response_matrix_partners(const Sparse *matrix, size_t **firsts, size_t **partners)
{
    const size_t first = matrix->eliminated;
    const size_t count = matrix->count - first;
    size_t *next = zeroed(count + 2, sizeof *next);
    size_t blocks = 0;
    for (size_t p = first; p < matrix->count; p++) {
        for (size_t b = matrix->first_block[p]; b < matrix->first_block[p + 1]; b++) {
            const size_t other = matrix->block_node[b];
            next[p - first + 1]++;
            next[other - first + 1] += other != p ? 1 : 0;
            blocks += other != p ? 2 : 1;
        }
    }
    *firsts = zeroed(count + 1, sizeof **firsts);
    *partners = zeroed(blocks, sizeof **partners);
    for (size_t i = 0; i < count; i++) {
        next[i + 1] += next[i];
        (*firsts)[i + 1] = next[i + 1];
    }
    // column by column: the earlier partners of a place come before itself and the later ones
    for (size_t p = first; p < matrix->count; p++) {
        for (size_t b = matrix->first_block[p]; b < matrix->first_block[p + 1]; b++) {
            const size_t other = matrix->block_node[b];
            (*partners)[next[p - first]++] = other - first;
            if (other != p) {
                (*partners)[next[other - first]++] = p - first;
            }
        }
    }
    free(next);
}

size_t response_matrix_largest(const Sparse *matrix)
{
    size_t largest = 0;
    size_t *rows = zeroed(matrix->eliminated, sizeof *rows);
    // a column of the factor and the first one below belong together
    for (size_t p = 0; p < matrix->eliminated; p++) {
        const size_t node = matrix->node_at[p];
        const size_t first = matrix->first_block[p];
        rows[p] += matrix->first_row[node + 1] - matrix->first_row[node];
        largest = rows[p] > largest ? rows[p] : largest;
        if (first + 1 < matrix->first_block[p + 1] &&
            matrix->block_node[first + 1] < matrix->eliminated) {
            rows[matrix->block_node[first + 1]] += rows[p];
        }
    }
    free(rows);
    return largest;
}

const double *response_matrix_block(const Sparse *matrix, size_t place, size_t other)
{
    bool is_transposed;
    return sparse_block(matrix, matrix->eliminated + place, matrix->eliminated + other,
                        &is_transposed);
}

void response_matrix_mobility(const Sparse *matrix, double *mobility)
{
    // the rows of the places stand behind those of the ideal joints
    const size_t *first = matrix->first_row + matrix->eliminated;
    const size_t count = matrix->count - matrix->eliminated;
    const size_t width = first[count] - first[0];
    memset(mobility, 0, width * width * sizeof *mobility);
    for (size_t a = 0; a < count; a++) {
        const size_t row = first[a] - first[0];
        const size_t rows = first[a + 1] - first[a];
        for (size_t b = 0; b <= a; b++) {
            const double *block = response_matrix_block(matrix, a, b);
            const size_t column = first[b] - first[0];
            const size_t columns = first[b + 1] - first[b];
            for (size_t i = 0; block != NULL && i < rows; i++) {
                for (size_t k = 0; k < columns; k++) {
                    mobility[(row + i) * width + column + k] = block[i * columns + k];
                    mobility[(column + k) * width + row + i] = block[i * columns + k];
                }
            }
        }
    }
}
