// Finds what impulses in a few joints with play in space do to the few bodies that they move.
#include "model/space_response_groups.h"

#include <string.h>

void space_response_groups_init(const SpaceResponse *response, ResponseGroups *groups)
{
    response_groups_make(&(ResponseNodes){response->linkage, &response->matrix,
                                          response->ideal_count, response->node_count,
                                          response->joint_at},
                         groups);
}

// Writes impulses of places among those of all rows; of other places of the groups, and of the
// ideal joints, they are zero.
static void set_impulses(const SpaceResponse *response, const ResponseGroups *groups,
                         const ResponsePart *part, const double *impulses, double *all)
{
    const size_t *first_row = response->first_row;
    double *play = all + response->ideal_rows;
    for (size_t i = 0; i < part->group_count; i++) {
        const size_t group = part->groups[i];
        for (size_t n = groups->first_place[group]; n < groups->first_place[group + 1]; n++) {
            const size_t place = groups->places[n];
            memset(play + first_row[place], 0,
                   (first_row[place + 1] - first_row[place]) * sizeof *play);
        }
        for (size_t n = groups->first_node[group]; n < groups->first_node[group + 1]; n++) {
            const size_t *row = response->matrix.first_row + groups->nodes[n];
            memset(all + row[0], 0, (row[1] - row[0]) * sizeof *all);
        }
    }
    for (size_t i = 0; i < part->place_count; i++) {
        const size_t *row = first_row + part->places[i];
        memcpy(play + row[0], impulses + row[0], (row[1] - row[0]) * sizeof *play);
    }
}

const double *space_response_groups_apply(const SpaceResponse *response,
                                          const ResponseGroups *groups, const ResponsePart *part,
                                          const double *impulses, SpaceChange *changes)
{
    double *all = response->work;
    set_impulses(response, groups, part, impulses, all);
    for (size_t i = 0; i < part->group_count; i++) {
        const size_t group = part->groups[i];
        const size_t first = groups->first_node[group];
        sparse_back_some(&response->matrix, groups->first_node[group + 1] - first,
                         groups->nodes + first, all);
        for (size_t b = groups->first_body[group]; b < groups->first_body[group + 1]; b++) {
            changes[groups->bodies[b]] = (SpaceChange){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
        }
    }
    for (size_t i = 0; i < part->group_count; i++) {
        const size_t group = part->groups[i];
        for (size_t n = groups->first_node[group]; n < groups->first_node[group + 1]; n++) {
            const size_t *row = response->matrix.first_row + groups->nodes[n];
            for (size_t k = row[0]; k < row[1]; k++) {
                space_response_add_row(response, k, all[k], changes);
            }
        }
    }
    for (size_t i = 0; i < part->place_count; i++) {
        const size_t *row = response->first_row + part->places[i];
        for (size_t k = response->ideal_rows + row[0]; k < response->ideal_rows + row[1]; k++) {
            space_response_add_row(response, k, all[k], changes);
        }
    }
    return all;
}
