// Finds by how much a push in a joint with play moves the bodies in space.
//
// The equations are those of model/response.c; rows are combinations of velocities and angular
// velocities in the world's frame (model/space_rows.h), and M holds masses and the inertias as they
// are turned, R I R'.
#include "model/space_response.h"
#include "base/zeroed.h"
#include "model/response_matrix.h"

#include <stdlib.h>
#include <string.h>

// the share of a row that must be left when the rows before it are taken out
static const double INDEPENDENT = 1e-12;

// rows that are less independent than this share of what others would be are chosen anew
static const double WORN = 0.25;

enum { NO_MOVER = -1 };

static const Vec3 AXES[SPACE_POINT_ROWS] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};

static bool gives_way(const SpaceResponse *response, int body)
{
    return body != LINKAGE_GROUND && body != linkage_driven_body(response->linkage);
}

// R A R' of a symmetric matrix.
static Mat3 turned(const Mat3 *turn, const Mat3 *own)
{
    Mat3 world;
    for (int i = 0; i < 3; i++) {
        world.row[i] = mat3_apply(turn, mat3_apply(own, turn->row[i]));
    }
    return world;
}

static void place_bodies(SpaceResponse *response, const SpaceMotion *motions)
{
    for (size_t i = 0; i < response->linkage->body_count; i++) {
        response->turns[i] = quat_matrix(motions[i].turn);
        response->inverse[i] = turned(&response->turns[i], &response->own_inverse[i]);
    }
}

// From the body's frame, or the ground's, to the world's.
static Vec3 direction(const SpaceResponse *response, int body, Vec3 local)
{
    return body == LINKAGE_GROUND ? local : mat3_apply(&response->turns[body], local);
}

// An ideal row, but for its answers.
static void place_ideal_row(SpaceResponse *response, size_t number)
{
    const SpaceEnd *ends = response->ends[response->joint_of[number]];
    const int part = response->part_of[number];
    SpaceRow *row = &response->rows[number].row;
    Vec3 along;
    if (part < SPACE_POINT_ROWS) {
        along = AXES[part];
    } else {
        const Vec3 axis = direction(response, ends[0].body, ends[0].axis);
        const Vec3 side = vec3_normal_to(axis);
        along = part == SPACE_POINT_ROWS ? side : vec3_cross(axis, side);
    }
    response->direction_of[number] = along;
    for (int side = 0; side < 2; side++) {
        const int body = ends[side].body;
        const double sign = side == 0 ? -1.0 : 1.0;
        row->body[side] = body;
        row->linear[side] = row->angular[side] = (Vec3){0.0, 0.0, 0.0};
        if (body != LINKAGE_GROUND && part < SPACE_POINT_ROWS) {
            const Vec3 arm = mat3_apply(&response->turns[body], ends[side].anchor);
            row->linear[side] = vec3_scale(sign, along);
            row->angular[side] = vec3_scale(sign, vec3_cross(arm, along));
        } else if (body != LINKAGE_GROUND) {
            row->angular[side] = vec3_scale(sign, along);
        }
    }
}

static void find_answers(const SpaceResponse *response, SpaceResponseRow *of)
{
    for (int side = 0; side < 2; side++) {
        const int body = of->row.body[side];
        of->mover[side] = gives_way(response, body) ? body : NO_MOVER;
        if (of->mover[side] != NO_MOVER) {
            const double mass = response->linkage->bodies[body].mass;
            of->answer[side].move = vec3_scale(1.0 / mass, of->row.linear[side]);
            of->answer[side].turn = mat3_apply(&response->inverse[body], of->row.angular[side]);
        }
    }
}

// One entry of D: what one row answers in the other, through the bodies they share.
static double coupling(const SpaceResponseRow *a, const SpaceResponseRow *b)
{
    double sum = 0.0;
    for (int i = 0; i < 2; i++) {
        const int mover = a->mover[i];
        if (mover == NO_MOVER || (mover != b->mover[0] && mover != b->mover[1])) {
            continue;
        }
        // a row has two different bodies
        const SpaceChange *answer = &b->answer[mover == b->mover[0] ? 0 : 1];
        sum += vec3_dot(a->row.linear[i], answer->move) + vec3_dot(a->row.angular[i], answer->turn);
    }
    return sum;
}

// Fills in D and eliminates by Cholesky's method, stopped after the ideal rows.
static bool factor_rows(SpaceResponse *response)
{
    for (size_t i = 0; i < response->row_count; i++) {
        find_answers(response, &response->rows[i]);
    }
    sparse_clear(&response->matrix);
    for (size_t n = 0; n < response->block_count; n++) {
        const ResponseBlock *block = &response->blocks[n];
        const bool is_own = block->rows == block->columns;
        for (size_t i = 0; i < block->row_count; i++) {
            double *row = block->values + i * block->column_count;
            for (size_t k = 0; k < (is_own ? i + 1 : block->column_count); k++) {
                row[k] =
                    coupling(&response->rows[block->rows + i], &response->rows[block->columns + k]);
                if (is_own) {
                    block->values[k * block->column_count + i] = row[k];
                }
            }
        }
    }
    return sparse_factor(&response->matrix, INDEPENDENT);
}

static void place_rows(SpaceResponse *response, const SpaceRow *play_rows)
{
    for (size_t i = 0; i < response->ideal_rows; i++) {
        place_ideal_row(response, i);
    }
    for (size_t i = response->ideal_rows; i < response->row_count; i++) {
        response->rows[i].row = play_rows != NULL
                                    ? play_rows[i - response->ideal_rows]
                                    : (SpaceRow){.body = {LINKAGE_GROUND, LINKAGE_GROUND}};
    }
}

// Whether the rows that were chosen are far less independent by now than others would be.
static bool is_worn(const SpaceResponse *response, const SpaceMotion *motions)
{
    const Linkage *linkage = response->linkage;
    unsigned *chosen = zeroed(2 * linkage->joint_count, sizeof *chosen);
    unsigned *fresh = chosen + linkage->joint_count;
    for (size_t i = 0; i < response->ideal_rows; i++) {
        chosen[response->joint_of[i]] |= 1U << response->part_of[i];
    }
    const double own = space_rows_least_share(linkage, motions, response->is_asked, chosen);
    bool is_worn = false;
    if (own < WORN && response->choose(linkage, motions, response->is_asked, fresh)) {
        is_worn = own < WORN * space_rows_least_share(linkage, motions, response->is_asked, fresh);
    }
    free(chosen);
    return is_worn;
}

bool space_response_place(SpaceResponse *response, const SpaceMotion *motions,
                          const SpaceRow *play_rows)
{
    place_bodies(response, motions);
    place_rows(response, play_rows);
    if (!(response->is_redundant && is_worn(response, motions)) && factor_rows(response)) {
        return true;
    }
    if (!space_response_choose(response, motions)) {
        return false;
    }
    place_rows(response, play_rows);
    return factor_rows(response);
}

const double *space_response_block(const SpaceResponse *response, size_t place, size_t other)
{
    return response_matrix_block(&response->matrix, place, other);
}

void space_response_mobility(const SpaceResponse *response, double *mobility)
{
    response_matrix_mobility(&response->matrix, mobility);
}

void space_response_free(const SpaceResponse *response, const double *ideal_drift,
                         const double *play_drift, double *rates)
{
    double *gamma = response->work;
    const size_t play = space_response_play_rows(response);
    memcpy(gamma, ideal_drift, response->ideal_rows * sizeof *gamma);
    memcpy(gamma + response->ideal_rows, play_drift, play * sizeof *gamma);
    sparse_forward(&response->matrix, gamma);
    memcpy(rates, gamma + response->ideal_rows, play * sizeof *rates);
}

// Adds what an impulse in a row does to its bodies by itself.
static void add_answer(const SpaceResponseRow *row, double impulse, SpaceChange *changes)
{
    for (int side = 0; side < 2; side++) {
        if (row->mover[side] != NO_MOVER) {
            SpaceChange *change = &changes[row->mover[side]];
            const SpaceChange *answer = &row->answer[side];
            change->move = vec3_add(change->move, vec3_scale(impulse, answer->move));
            change->turn = vec3_add(change->turn, vec3_scale(impulse, answer->turn));
        }
    }
}

// All impulses that impulses in the rows of play bring with them, by row.
static const double *answer_all(const SpaceResponse *response, const double *impulses)
{
    double *all = response->work;
    memset(all, 0, response->ideal_rows * sizeof *all);
    memcpy(all + response->ideal_rows, impulses, space_response_play_rows(response) * sizeof *all);
    sparse_back(&response->matrix, all);
    return all;
}

void space_response_react(const SpaceResponse *response, const double *impulses, double *reactions)
{
    memcpy(reactions, answer_all(response, impulses), response->ideal_rows * sizeof *reactions);
}

void space_response_add_force(const SpaceResponse *response, size_t row, double reaction,
                              Vec3 *forces)
{
    if (response->part_of[row] < SPACE_POINT_ROWS) {
        Vec3 *force = &forces[response->joint_of[row]];
        *force = vec3_add(*force, vec3_scale(reaction, response->direction_of[row]));
    }
}

void space_response_add_forces(const SpaceResponse *response, const double *reactions, Vec3 *forces)
{
    for (size_t i = 0; i < response->ideal_rows; i++) {
        space_response_add_force(response, i, reactions[i], forces);
    }
}

void space_response_load(const SpaceResponse *response, const double *impulses, SpaceChange *loads)
{
    memset(loads, 0, response->linkage->body_count * sizeof *loads);
    for (size_t i = response->ideal_rows; i < response->row_count; i++) {
        const SpaceRow *row = &response->rows[i].row;
        const double impulse = impulses[i - response->ideal_rows];
        for (int side = 0; side < 2; side++) {
            if (row->body[side] != LINKAGE_GROUND) {
                SpaceChange *load = &loads[row->body[side]];
                load->move = vec3_add(load->move, vec3_scale(impulse, row->linear[side]));
                load->turn = vec3_add(load->turn, vec3_scale(impulse, row->angular[side]));
            }
        }
    }
}

void space_response_add_reactions(const SpaceResponse *response, const double *reactions, int body,
                                  SpaceChange *load)
{
    for (size_t i = 0; i < response->ideal_rows; i++) {
        const SpaceRow *row = &response->rows[i].row;
        for (int side = 0; side < 2; side++) {
            if (row->body[side] == body) {
                load->move = vec3_add(load->move, vec3_scale(reactions[i], row->linear[side]));
                load->turn = vec3_add(load->turn, vec3_scale(reactions[i], row->angular[side]));
            }
        }
    }
}

void space_response_apply(const SpaceResponse *response, const double *impulses,
                          SpaceChange *changes)
{
    const double *all = answer_all(response, impulses);
    memset(changes, 0, response->linkage->body_count * sizeof *changes);
    for (size_t i = 0; i < response->row_count; i++) {
        add_answer(&response->rows[i], all[i], changes);
    }
}

void space_response_add_row(const SpaceResponse *response, size_t row, double impulse,
                            SpaceChange *changes)
{
    add_answer(&response->rows[row], impulse, changes);
}

void space_response_solve(const SpaceResponse *response, double *rows)
{
    sparse_solve(&response->matrix, rows);
}

void space_response_close(const SpaceResponse *response, const double *openings, double *impulses,
                          SpaceChange *changes)
{
    for (size_t i = 0; i < response->ideal_rows; i++) {
        impulses[i] = -openings[i];
    }
    space_response_solve(response, impulses);
    memset(changes, 0, response->linkage->body_count * sizeof *changes);
    for (size_t i = 0; i < response->ideal_rows; i++) {
        add_answer(&response->rows[i], impulses[i], changes);
    }
}
