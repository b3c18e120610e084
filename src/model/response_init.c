// Which blocks of a linkage's D = J M^-1 J' are not zero?
//
// A node of D is an ideal joint or a place at which a joint with play touches, with its rows. Two
// nodes have a block where their joints share a body that can give way.
#include "model/response.h"

#include "base/zeroed.h"
#include "model/joint_nodes.h"

#include <stdlib.h>

void response_finish(Response *response)
{
    free(response->rows);
    free(response->joint_of);
    free(response->places);
    free(response->first_row);
    free(response->first_partner);
    free(response->partners);
    free(response->place_of);
    free(response->blocks);
    free(response->work);
    sparse_finish(&response->matrix);
    *response = (Response){.linkage = NULL};
}

static void add_rows(Response *response, int joint, int place, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        response->joint_of[response->row_count] = joint;
        response->place_of[response->row_count++] = place;
    }
}

static void add_block(Response *response, size_t a, size_t b)
{
    const Sparse *matrix = &response->matrix;
    const bool is_later = matrix->order[a] >= matrix->order[b];
    const size_t row = is_later ? a : b;
    const size_t column = is_later ? b : a;
    bool is_transposed;
    response->blocks[response->block_count++] = (ResponseBlock){
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

// Prepares D: its nodes, and which of their blocks are not zero.
static void init_matrix(Response *response, const int *joints, const size_t *sizes, size_t count)
{
    SparseLink *links;
    const size_t link_count = joint_nodes_link(response->linkage, joints, count, &links);
    sparse_init(count, sizes, response->ideal_rows / 2, link_count, links, &response->matrix);
    response->blocks = zeroed(count + link_count, sizeof *response->blocks);
    for (size_t i = 0; i < count; i++) {
        add_block(response, i, i);
    }
    // two joints may share both of their bodies
    qsort(links, link_count, sizeof *links, compare_links);
    for (size_t i = 0; i < link_count; i++) {
        if (i == 0 || compare_links(&links[i - 1], &links[i]) != 0) {
            add_block(response, links[i].a, links[i].b);
        }
    }
    free(links);
}

// The most rows of ideal joints that are connected: a column of the factor and the first one below
// belong together.
static size_t find_largest_group(const Sparse *matrix)
{
    size_t largest = 0;
    size_t *rows = zeroed(matrix->eliminated, sizeof *rows);
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

// Lists which places move each other: those whose mobility is not zero.
static void list_partners(Response *response)
{
    const Sparse *matrix = &response->matrix;
    const size_t first = matrix->eliminated;
    const size_t count = response->place_count;
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
    response->first_partner = zeroed(count + 1, sizeof *response->first_partner);
    response->partners = zeroed(blocks, sizeof *response->partners);
    for (size_t i = 0; i < count; i++) {
        next[i + 1] += next[i];
        response->first_partner[i + 1] = next[i + 1];
    }
    // column by column: the earlier partners of a place come before itself and the later ones
    for (size_t p = first; p < matrix->count; p++) {
        for (size_t b = matrix->first_block[p]; b < matrix->first_block[p + 1]; b++) {
            const size_t other = matrix->block_node[b];
            response->partners[next[p - first]++] = other - first;
            if (other != p) {
                response->partners[next[other - first]++] = p - first;
            }
        }
    }
    free(next);
}

void response_init_places(const Linkage *linkage, const ResponsePlace *places, size_t count,
                          Response *response)
{
    *response = (Response){.linkage = linkage, .place_count = count};
    const size_t most = 2 * linkage->joint_count + RESPONSE_ROWS_A_JOINT * count;
    const size_t node_most = linkage->joint_count + count;
    size_t *sizes = zeroed(node_most, sizeof *sizes);
    int *joints = zeroed(node_most, sizeof *joints);
    response->joint_of = zeroed(most, sizeof *response->joint_of);
    response->place_of = zeroed(most, sizeof *response->place_of);
    response->places = zeroed(count, sizeof *response->places);
    response->first_row = zeroed(count, sizeof *response->first_row);
    size_t nodes = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_is_ideal(linkage, i)) {
            add_rows(response, (int)i, -1, 2);
            sizes[nodes] = 2;
            joints[nodes++] = (int)i;
        }
    }
    response->ideal_rows = response->row_count;
    for (size_t i = 0; i < count; i++) {
        response->places[i] = places[i];
        response->first_row[i] = response_play_rows(response);
        sizes[nodes] = response_place_rows(&places[i]);
        add_rows(response, places[i].joint, (int)i, sizes[nodes]);
        joints[nodes++] = places[i].joint;
    }
    response->rows = zeroed(response->row_count, sizeof *response->rows);
    response->work = zeroed(response->row_count, sizeof *response->work);
    init_matrix(response, joints, sizes, nodes);
    response->largest_group = find_largest_group(&response->matrix);
    list_partners(response);
    free(sizes);
    free(joints);
}

void response_init(const Linkage *linkage, bool with_turns, Response *response)
{
    ResponsePlace *places = zeroed(linkage->joint_count, sizeof *places);
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint->kind == JOINT_CLEARANCE) {
            places[count++] = (ResponsePlace){
                .joint = (int)i,
                .has_turns = with_turns,
                .anchor_a = joint->anchor_a,
                .anchor_b = joint->anchor_b,
            };
        }
    }
    response_init_places(linkage, places, count, response);
    free(places);
}
