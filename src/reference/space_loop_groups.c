// Which loops in space share coordinates?
//
// A loop moves by the coordinates from its ends up to the body that both hang on. Those that share
// any, directly or by way of others, are a group.
#include "reference/space_loops.h"

#include "base/leaders.h"
#include "base/zeroed.h"

static int find_meeting(const SpaceTree *tree, int joint)
{
    int a = space_loop_groups_end(tree, joint, 0);
    int b = space_loop_groups_end(tree, joint, 1);
    while (a != b && a >= 0 && b >= 0) {
        int *deeper = tree->nodes[a].depth >= tree->nodes[b].depth ? &a : &b;
        *deeper = tree->nodes[*deeper].parent_node;
    }
    return a == b ? a : -1;
}

// Joins the nodes of every loop. Writes of each loop one of them, or the number of nodes.
static void join_nodes(const SpaceTree *tree, size_t count, const int *joints, const int *meetings,
                       size_t *leaders, size_t *members)
{
    leaders_start(leaders, tree->node_count);
    for (size_t i = 0; i < count; i++) {
        members[i] = tree->node_count;
        for (int side = 0; side < 2; side++) {
            for (int at = space_loop_groups_end(tree, joints[i], side); at != meetings[i];
                 at = tree->nodes[at].parent_node) {
                if (members[i] < tree->node_count) {
                    leaders_join(leaders, members[i], (size_t)at);
                }
                members[i] = (size_t)at;
            }
        }
    }
}

// Numbers the coordinates of each group, loop by loop.
static void number_columns(const SpaceTree *tree, const int *joints, SpaceLoopGroups *groups)
{
    bool *is_numbered = zeroed(tree->node_count, sizeof *is_numbered);
    for (size_t group = 0; group < groups->count; group++) {
        for (size_t i = groups->first_loop[group]; i < groups->first_loop[group + 1]; i++) {
            const size_t loop = groups->loops[i];
            for (int side = 0; side < 2; side++) {
                for (int at = space_loop_groups_end(tree, joints[loop], side);
                     at != groups->meetings[loop]; at = tree->nodes[at].parent_node) {
                    if (!is_numbered[at]) {
                        groups->columns[at] = groups->widths[group];
                        groups->widths[group] += space_loop_groups_freedoms(&tree->nodes[at]);
                        is_numbered[at] = true;
                    }
                }
            }
        }
    }
    free(is_numbered);
}

void space_loop_groups_init(const SpaceTree *tree, size_t count, const int *joints,
                            SpaceLoopGroups *groups)
{
    *groups = (SpaceLoopGroups){
        .first_loop = zeroed(count + 2, sizeof *groups->first_loop),
        .loops = zeroed(count, sizeof *groups->loops),
        .widths = zeroed(count + 1, sizeof *groups->widths),
        .meetings = zeroed(count, sizeof *groups->meetings),
        .columns = zeroed(tree->node_count, sizeof *groups->columns),
    };
    size_t *leaders = zeroed(tree->node_count, sizeof *leaders);
    size_t *members = zeroed(count, sizeof *members);
    size_t *group_of = zeroed(tree->node_count + 1, sizeof *group_of); // by leader, and 1 more
    for (size_t i = 0; i < count; i++) {
        groups->meetings[i] = find_meeting(tree, joints[i]);
    }
    join_nodes(tree, count, joints, groups->meetings, leaders, members);
    // a loop that nothing moves is in no group: members[i] becomes the group, from 1 on
    for (size_t i = 0; i < count; i++) {
        if (members[i] < tree->node_count) {
            size_t *group = &group_of[leaders_find(leaders, members[i])];
            *group = *group > 0 ? *group : ++groups->count;
            members[i] = *group;
            groups->first_loop[*group]++;
        } else {
            members[i] = 0;
        }
    }
    size_t *next = zeroed(groups->count + 1, sizeof *next);
    for (size_t group = 0; group < groups->count; group++) {
        groups->first_loop[group + 1] += groups->first_loop[group];
        next[group] = groups->first_loop[group];
    }
    for (size_t i = 0; i < count; i++) {
        if (members[i] > 0) {
            groups->loops[next[members[i] - 1]++] = i;
        }
    }
    number_columns(tree, joints, groups);
    free(next);
    free(group_of);
    free(members);
    free(leaders);
}

void space_loop_groups_finish(SpaceLoopGroups *groups)
{
    free(groups->first_loop);
    free(groups->loops);
    free(groups->widths);
    free(groups->meetings);
    free(groups->columns);
}
