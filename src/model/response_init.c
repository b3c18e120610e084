// Prepares what the response of a linkage is worked out from.
#include "model/response.h"

#include "base/zeroed.h"

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
    free(response->turns);
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
    response->turns = zeroed(linkage->body_count, sizeof *response->turns);
    for (size_t i = 0; i < linkage->body_count; i++) {
        response->turns[i].angle = NAN;
    }
    response->blocks = response_matrix_init(linkage, joints, sizes, nodes, response->ideal_rows / 2,
                                            &response->matrix, &response->block_count);
    response->largest_group = response_matrix_largest(&response->matrix);
    response_matrix_partners(&response->matrix, &response->first_partner, &response->partners);
    free(sizes);
    free(joints);
}

void response_init(const Linkage *linkage, bool with_turns, Response *response)
{
    ResponsePlace *places = zeroed(linkage->joint_count, sizeof *places);
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint_has_hole(joint->kind)) {
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
