// Prepares what the response of a linkage in space is worked out from (model/space_response.c).
//
// The rows of ideal joints may be chosen anew: D is then made anew.
#include "model/space_response.h"

#include "base/zeroed.h"

static void free_rows(SpaceResponse *response)
{
    sparse_finish(&response->matrix);
    free(response->rows);
    free(response->blocks);
    free(response->work);
    free(response->first_partner);
    free(response->partners);
}

void space_response_finish(SpaceResponse *response)
{
    if (response->linkage == NULL) {
        return;
    }
    free_rows(response);
    free(response->is_asked);
    free(response->ends);
    free(response->own_inertia);
    free(response->own_inverse);
    free(response->turns);
    free(response->inverse);
    free(response->joint_of);
    free(response->part_of);
    free(response->direction_of);
    free(response->joint_at);
    free(response->first_ideal);
    free(response->places);
    free(response->first_row);
    *response = (SpaceResponse){.linkage = NULL};
}

// Lists the chosen rows of the joints.
static void list_ideal(SpaceResponse *response, const unsigned *chosen)
{
    response->ideal_rows = 0;
    for (size_t i = 0; i < response->linkage->joint_count; i++) {
        response->first_ideal[i] = response->ideal_rows;
        for (int part = 0; part < SPACE_JOINT_ROWS; part++) {
            if ((chosen[i] >> part & 1U) != 0) {
                response->joint_of[response->ideal_rows] = (int)i;
                response->part_of[response->ideal_rows++] = part;
            }
        }
    }
    response->first_ideal[response->linkage->joint_count] = response->ideal_rows;
}

static void make_matrix(SpaceResponse *response)
{
    size_t *sizes = zeroed(response->node_count, sizeof *sizes);
    for (size_t node = 0; node < response->node_count; node++) {
        const size_t joint = (size_t)response->joint_at[node];
        sizes[node] = node < response->ideal_count
                          ? response->first_ideal[joint + 1] - response->first_ideal[joint]
                          : response->places[node - response->ideal_count].rows;
    }
    response->row_count = response->ideal_rows + space_response_play_rows(response);
    response->rows = zeroed(response->row_count, sizeof *response->rows);
    response->work = zeroed(response->row_count, sizeof *response->work);
    response->blocks =
        response_matrix_init(response->linkage, response->joint_at, sizes, response->node_count,
                             response->ideal_count, &response->matrix, &response->block_count);
    response_matrix_partners(&response->matrix, &response->first_partner, &response->partners);
    free(sizes);
}

bool space_response_choose(SpaceResponse *response, const SpaceMotion *motions)
{
    unsigned *chosen = zeroed(response->linkage->joint_count, sizeof *chosen);
    const bool is_held = response->choose(response->linkage, motions, response->is_asked, chosen);
    list_ideal(response, chosen);
    free(chosen);
    response->is_redundant = response->ideal_rows < SPACE_JOINT_ROWS * response->ideal_count;
    response->choices++;
    free_rows(response);
    make_matrix(response);
    return is_held;
}

static void list_nodes(SpaceResponse *response, const SpaceResponsePlace *places, size_t count)
{
    const size_t joints = response->linkage->joint_count;
    response->joint_at = zeroed(joints + count, sizeof *response->joint_at);
    response->places = zeroed(count, sizeof *response->places);
    response->first_row = zeroed(count + 1, sizeof *response->first_row);
    for (size_t i = 0; i < joints; i++) {
        if (response->is_asked[i]) {
            response->joint_at[response->node_count++] = (int)i;
        }
    }
    response->ideal_count = response->node_count;
    response->place_count = count;
    for (size_t i = 0; i < count; i++) {
        response->places[i] = places[i];
        response->joint_at[response->node_count++] = places[i].joint;
        response->first_row[i + 1] = response->first_row[i] + places[i].rows;
    }
}

// All but the rows, for the joints that are asked for.
static void start(const Linkage *linkage, const SpaceResponsePlace *places, size_t count,
                  SpaceResponse *response)
{
    const size_t bodies = linkage->body_count;
    const size_t joints = linkage->joint_count;
    const size_t most = SPACE_JOINT_ROWS * joints;
    response->ends = zeroed(joints, sizeof *response->ends);
    response->own_inertia = zeroed(bodies, sizeof *response->own_inertia);
    response->own_inverse = zeroed(bodies, sizeof *response->own_inverse);
    response->turns = zeroed(bodies, sizeof *response->turns);
    response->inverse = zeroed(bodies, sizeof *response->inverse);
    response->joint_of = zeroed(most, sizeof *response->joint_of);
    response->part_of = zeroed(most, sizeof *response->part_of);
    response->direction_of = zeroed(most, sizeof *response->direction_of);
    response->first_ideal = zeroed(joints + 1, sizeof *response->first_ideal);
    for (size_t i = 0; i < bodies; i++) {
        response->own_inertia[i] = space_inertia(&linkage->bodies[i]);
        response->own_inverse[i] = mat3_inverse(&response->own_inertia[i]);
    }
    for (size_t i = 0; i < joints; i++) {
        response->ends[i][0] = space_end(linkage, i, 0);
        response->ends[i][1] = space_end(linkage, i, 1);
    }
    list_nodes(response, places, count);
}

// Chooses the points before the axes. Returns whether all points are among them.
static bool choose_points(const Linkage *linkage, const SpaceMotion *motions, const bool *is_asked,
                          unsigned *chosen)
{
    space_rows_choose_points(linkage, motions, is_asked, chosen);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (is_asked[i] && (chosen[i] & 7U) != 7U) {
            return false;
        }
    }
    return true;
}

bool space_response_init(const Linkage *linkage, const SpaceMotion *motions,
                         const SpaceResponsePlace *places, size_t count, SpaceResponse *response,
                         Err *err)
{
    *response = (SpaceResponse){
        .linkage = linkage,
        .choose = choose_points,
        .is_asked = zeroed(linkage->joint_count, sizeof *response->is_asked),
    };
    for (size_t i = 0; i < linkage->joint_count; i++) {
        response->is_asked[i] = linkage_is_ideal(linkage, i);
    }
    start(linkage, places, count, response);
    return space_response_choose(response, motions) ||
           err_set(err, ERR_SOLVER,
                   "the points of the ideal joints depend on each other, which ODE cannot solve: "
                   "give one joint of the loop some play");
}

bool space_response_init_joints(const Linkage *linkage, const SpaceMotion *motions,
                                const bool *is_asked, SpaceResponseChoice choose,
                                SpaceResponse *response)
{
    *response = (SpaceResponse){
        .linkage = linkage,
        .choose = choose,
        .is_asked = zeroed(linkage->joint_count, sizeof *response->is_asked),
    };
    for (size_t i = 0; i < linkage->joint_count; i++) {
        response->is_asked[i] = is_asked[i];
    }
    start(linkage, NULL, 0, response);
    return space_response_choose(response, motions);
}
