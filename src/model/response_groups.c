// Finds what impulses in a few joints with play do to the few bodies that they move.
//
// As model/response.h has it for all joints. Ideal joints of different groups share no body that
// can give way: their columns of the factor have nothing in common.
#include "model/response_groups.h"

#include "base/union_find.h"
#include "base/zeroed.h"
#include "model/joint_nodes.h"

#include <string.h>

// The bodies that an ideal joint can move; the ground where there are fewer than two.
static void find_movers(const ResponseNodes *nodes, size_t node, int movers[2])
{
    for (int side = 0; side < 2; side++) {
        movers[side] = joint_nodes_mover(nodes->linkage, nodes->joints[node], side);
    }
    if (movers[0] == LINKAGE_GROUND) {
        movers[0] = movers[1];
        movers[1] = LINKAGE_GROUND;
    }
}

static void number_groups(const ResponseNodes *nodes, ResponseGroups *groups)
{
    const size_t body_count = nodes->linkage->body_count;
    size_t *parents = zeroed(body_count, sizeof *parents);
    union_find_start(parents, body_count);
    for (size_t node = 0; node < nodes->ideal; node++) {
        int movers[2];
        find_movers(nodes, node, movers);
        if (movers[1] != LINKAGE_GROUND) {
            union_find_join(parents, (size_t)movers[0], (size_t)movers[1]);
        }
    }
    for (size_t i = 0; i < body_count; i++) {
        const size_t leader = union_find_root(parents, i);
        if (!linkage_is_driven(nodes->linkage, (int)i)) {
            groups->group_of[i] = leader == i ? groups->count++ : groups->group_of[leader];
        }
    }
    for (size_t i = 0; i < linkage_drive_count(nodes->linkage); i++) {
        groups->group_of[linkage_drive_body(nodes->linkage, i)] = groups->count;
    }
    free(parents);
}

// Sorts things into groups, in their order: `group_of` of each, or the number of groups.
static void sort_into(size_t count, const size_t *group_of, size_t groups, size_t *first,
                      size_t *sorted)
{
    size_t *next = zeroed(groups + 2, sizeof *next);
    for (size_t i = 0; i < count; i++) {
        next[group_of[i] + 1]++;
    }
    for (size_t g = 0; g <= groups; g++) {
        next[g + 1] += next[g];
        first[g] = next[g];
    }
    for (size_t i = 0; i < count; i++) {
        sorted[next[group_of[i]]++] = i;
    }
    free(next);
}

// Lists the places of each group, which those between two groups have in common.
static void list_places(const ResponseNodes *nodes, ResponseGroups *groups)
{
    const size_t count = nodes->count - nodes->ideal;
    size_t *group_of = zeroed(2 * count, sizeof *group_of);
    for (size_t i = 0; i < 2 * count; i++) {
        const int joint = nodes->joints[nodes->ideal + i / 2];
        const int body = joint_nodes_mover(nodes->linkage, joint, (int)(i % 2));
        group_of[i] = body == LINKAGE_GROUND ? groups->count : groups->group_of[body];
    }
    groups->first_place = zeroed(groups->count + 1, sizeof *groups->first_place);
    groups->places = zeroed(2 * count, sizeof *groups->places);
    sort_into(2 * count, group_of, groups->count, groups->first_place, groups->places);
    for (size_t i = 0; i < 2 * count; i++) {
        groups->places[i] /= 2;
    }
    free(group_of);
}

void response_groups_make(const ResponseNodes *nodes, ResponseGroups *groups)
{
    const size_t *node_at = nodes->matrix->node_at;
    const size_t body_count = nodes->linkage->body_count;
    const size_t ideal = nodes->ideal;
    *groups = (ResponseGroups){.group_of = zeroed(body_count, sizeof *groups->group_of)};
    number_groups(nodes, groups);
    groups->first_body = zeroed(groups->count + 1, sizeof *groups->first_body);
    groups->bodies = zeroed(body_count, sizeof *groups->bodies);
    sort_into(body_count, groups->group_of, groups->count, groups->first_body, groups->bodies);
    list_places(nodes, groups);
    groups->first_node = zeroed(groups->count + 1, sizeof *groups->first_node);
    groups->nodes = zeroed(ideal, sizeof *groups->nodes);
    groups->joints = zeroed(ideal, sizeof *groups->joints);
    size_t *group_at = zeroed(ideal, sizeof *group_at);
    for (size_t p = 0; p < ideal; p++) {
        int movers[2];
        find_movers(nodes, node_at[p], movers);
        group_at[p] = movers[0] == LINKAGE_GROUND ? groups->count : groups->group_of[movers[0]];
    }
    sort_into(ideal, group_at, groups->count, groups->first_node, groups->nodes);
    for (size_t i = 0; i < ideal; i++) {
        groups->nodes[i] = node_at[groups->nodes[i]];
        groups->joints[i] = nodes->joints[groups->nodes[i]];
    }
    free(group_at);
}

// Lists the blocks of the response in the columns of each group's nodes.
static void list_group_blocks(const Response *response, ResponseGroups *groups)
{
    const size_t ideal = response->ideal_rows / 2;
    size_t *group_of_node = zeroed(ideal, sizeof *group_of_node);
    for (size_t n = 0; n < ideal; n++) {
        group_of_node[n] = groups->count;
    }
    for (size_t group = 0; group < groups->count; group++) {
        for (size_t n = groups->first_node[group]; n < groups->first_node[group + 1]; n++) {
            group_of_node[groups->nodes[n]] = group;
        }
    }
    size_t *group_of = zeroed(response->block_count, sizeof *group_of);
    for (size_t n = 0; n < response->block_count; n++) {
        const size_t column = response->blocks[n].columns;
        group_of[n] = column < response->ideal_rows ? group_of_node[column / 2] : groups->count;
    }
    groups->first_block = zeroed(groups->count + 1, sizeof *groups->first_block);
    groups->blocks = zeroed(response->block_count, sizeof *groups->blocks);
    sort_into(response->block_count, group_of, groups->count, groups->first_block, groups->blocks);
    free(group_of);
    free(group_of_node);
}

void response_groups_init(const Response *response, ResponseGroups *groups)
{
    const size_t ideal = response->ideal_rows / 2;
    const size_t count = ideal + response->place_count;
    int *joints = zeroed(count, sizeof *joints);
    for (size_t i = 0; i < count; i++) {
        joints[i] = i < ideal ? response->joint_of[2 * i] : response->places[i - ideal].joint;
    }
    response_groups_make(
        &(ResponseNodes){response->linkage, &response->matrix, ideal, count, joints}, groups);
    free(joints);
    list_group_blocks(response, groups);
}

void response_groups_finish(ResponseGroups *groups)
{
    free(groups->group_of);
    free(groups->first_body);
    free(groups->bodies);
    free(groups->first_place);
    free(groups->places);
    free(groups->first_node);
    free(groups->nodes);
    free(groups->joints);
    free(groups->first_block);
    free(groups->blocks);
    *groups = (ResponseGroups){.count = 0};
}

// Writes impulses of places, by row of play, among those of all rows; of all other places of the
// groups they are zero.
static void set_impulses(const Response *response, const ResponseGroups *groups,
                         const ResponsePart *part, const double *impulses, double *all)
{
    for (size_t i = 0; i < part->group_count; i++) {
        const size_t group = part->groups[i];
        for (size_t n = groups->first_place[group]; n < groups->first_place[group + 1]; n++) {
            const size_t place = groups->places[n];
            memset(all + response->ideal_rows + response->first_row[place], 0,
                   response_place_rows(&response->places[place]) * sizeof *all);
        }
    }
    for (size_t i = 0; i < part->place_count; i++) {
        const size_t place = part->places[i];
        const size_t row = response->first_row[place];
        memcpy(all + response->ideal_rows + row, impulses + row,
               response_place_rows(&response->places[place]) * sizeof *all);
    }
}

bool response_groups_place(Response *response, const ResponseGroups *groups,
                           const ResponsePart *part, const Motion *motions)
{
    for (size_t i = 0; i < part->place_count; i++) {
        response_rows_place_play(response, part->places[i], motions);
    }
    for (size_t i = 0; i < part->group_count; i++) {
        const size_t group = part->groups[i];
        const size_t first_node = groups->first_node[group];
        const size_t first_block = groups->first_block[group];
        if (!response_place_some(response, motions, groups->first_node[group + 1] - first_node,
                                 groups->nodes + first_node,
                                 groups->first_block[group + 1] - first_block,
                                 groups->blocks + first_block)) {
            return false;
        }
    }
    return true;
}

const double *response_groups_apply(const Response *response, const ResponseGroups *groups,
                                    const ResponsePart *part, const double *impulses,
                                    double *changes)
{
    double *all = response->work;
    set_impulses(response, groups, part, impulses, all);
    for (size_t i = 0; i < part->group_count; i++) {
        const size_t group = part->groups[i];
        const size_t first = groups->first_node[group];
        const size_t count = groups->first_node[group + 1] - first;
        for (size_t n = 0; n < count; n++) {
            const size_t row = 2 * groups->nodes[first + n];
            all[row] = all[row + 1] = 0.0;
        }
        sparse_back_some(&response->matrix, count, groups->nodes + first, all);
        for (size_t b = groups->first_body[group]; b < groups->first_body[group + 1]; b++) {
            memset(changes + 3 * groups->bodies[b], 0, 3 * sizeof *changes);
        }
    }
    for (size_t i = 0; i < part->group_count; i++) {
        const size_t group = part->groups[i];
        for (size_t n = groups->first_node[group]; n < groups->first_node[group + 1]; n++) {
            const size_t row = 2 * groups->nodes[n];
            response_add_row(response, row, all[row], changes);
            response_add_row(response, row + 1, all[row + 1], changes);
        }
    }
    for (size_t i = 0; i < part->place_count; i++) {
        const size_t place = part->places[i];
        const size_t row = response->ideal_rows + response->first_row[place];
        for (size_t k = 0; k < response_place_rows(&response->places[place]); k++) {
            response_add_row(response, row + k, all[row + k], changes);
        }
    }
    return all;
}
