// By how much does a push in a joint with play move the bodies in space?
//
// The equations are those of model/response.c; rows are combinations of velocities and angular
// velocities in the world's frame (model/space_rows.h), and M holds masses and the inertias as they
// are turned, R I R'.
#include "model/space_response.h"

#include <string.h>

// the share of a row that must be left when the rows before it are taken out
static const double INDEPENDENT = 1e-12;

enum { NO_MOVER = -1 };

static const Vec3 AXES[SPACE_POINT_ROWS] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};

static size_t triangle(size_t row)
{
    return row * (row + 1) / 2;
}

static bool gives_way(const SpaceResponse *response, int body)
{
    return body != LINKAGE_GROUND && body != linkage_driven_body(response->linkage);
}

// Lists the independent rows of the ideal joints. Returns whether all points are among them.
static bool choose_rows(SpaceResponse *response, const SpaceMotion *motions)
{
    const Linkage *linkage = response->linkage;
    bool is_asked[SPACE_JOINT_MAX];
    unsigned chosen[SPACE_JOINT_MAX];
    for (size_t i = 0; i < linkage->joint_count; i++) {
        is_asked[i] = linkage_is_ideal(linkage, i);
    }
    space_rows_choose_points(linkage, motions, is_asked, chosen);
    response->ideal_rows = 0;
    bool has_points = true;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        has_points = has_points && (!is_asked[i] || (chosen[i] & 7U) == 7U);
        for (int part = 0; part < SPACE_JOINT_ROWS; part++) {
            if ((chosen[i] >> part & 1U) != 0) {
                response->joint_of[response->ideal_rows] = (int)i;
                response->part_of[response->ideal_rows++] = part;
            }
        }
    }
    return has_points;
}

bool space_response_init(const Linkage *linkage, const SpaceMotion *motions,
                         SpaceResponse *response, Err *err)
{
    response->linkage = linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        response->own_inertia[i] = space_inertia(&linkage->bodies[i]);
        response->own_inverse[i] = mat3_inverse(&response->own_inertia[i]);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        response->ends[i][0] = space_end(linkage, i, 0);
        response->ends[i][1] = space_end(linkage, i, 1);
    }
    return choose_rows(response, motions) ||
           err_set(err, ERR_SOLVER,
                   "the points of the ideal joints depend on each other, which ODE cannot solve: "
                   "give one joint of the loop some play");
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
        double *const row = response->matrix + triangle(i);
        find_answers(response, &response->rows[i]);
        double diagonal = 0.0;
        for (size_t k = 0; k <= i; k++) {
            const double *other = response->matrix + triangle(k);
            const size_t known = k < response->ideal_rows ? k : response->ideal_rows;
            double sum = coupling(&response->rows[i], &response->rows[k]);
            diagonal = sum;
            for (size_t m = 0; m < known; m++) {
                sum -= row[m] * other[m];
            }
            row[k] = k < i && k < response->ideal_rows ? sum * other[k] : sum;
        }
        if (i < response->ideal_rows) {
            if (!(row[i] > INDEPENDENT * diagonal)) {
                return false;
            }
            row[i] = 1.0 / sqrt(row[i]);
        }
    }
    return true;
}

static void place_rows(SpaceResponse *response, const SpaceRow *play_rows, size_t play_count)
{
    for (size_t i = 0; i < response->ideal_rows; i++) {
        place_ideal_row(response, i);
    }
    for (size_t i = 0; i < play_count; i++) {
        response->rows[response->ideal_rows + i].row = play_rows[i];
    }
    response->row_count = response->ideal_rows + play_count;
}

bool space_response_place(SpaceResponse *response, const SpaceMotion *motions,
                          const SpaceRow *play_rows, size_t play_count)
{
    place_bodies(response, motions);
    place_rows(response, play_rows, play_count);
    if (factor_rows(response)) {
        return true;
    }
    if (!choose_rows(response, motions)) {
        return false;
    }
    place_rows(response, play_rows, play_count);
    return factor_rows(response);
}

void space_response_mobility(const SpaceResponse *response, double *mobility)
{
    const size_t first = response->ideal_rows;
    const size_t width = response->row_count - first;
    for (size_t i = 0; i < width; i++) {
        for (size_t k = 0; k <= i; k++) {
            mobility[i * width + k] = mobility[k * width + i] =
                response->matrix[triangle(first + i) + first + k];
        }
    }
}

void space_response_free(const SpaceResponse *response, const double *ideal_drift,
                         const double *play_drift, double *rates)
{
    const size_t ideal = response->ideal_rows;
    double solved[SPACE_COLUMN_MAX];
    for (size_t i = 0; i < response->row_count; i++) {
        const double *row = response->matrix + triangle(i);
        double sum = i < ideal ? ideal_drift[i] : play_drift[i - ideal];
        for (size_t k = 0; k < i && k < ideal; k++) {
            sum -= row[k] * solved[k];
        }
        if (i < ideal) {
            solved[i] = sum * row[i];
        } else {
            rates[i - ideal] = sum;
        }
    }
}

// Back through the transposed factor.
static void solve_back(const SpaceResponse *response, double *rows)
{
    for (size_t i = response->ideal_rows; i-- > 0;) {
        const double *row = response->matrix + triangle(i);
        rows[i] *= row[i];
        for (size_t k = 0; k < i; k++) {
            rows[k] -= row[k] * rows[i];
        }
    }
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

void space_response_link(SpaceResponse *response)
{
    const size_t ideal = response->ideal_rows;
    for (size_t k = ideal; k < response->row_count; k++) {
        double *const reactions = response->reactions[k - ideal];
        SpaceChange *const moved = response->moved[k - ideal];
        const double *row = response->matrix + triangle(k);
        for (size_t i = 0; i < ideal; i++) {
            reactions[i] = -row[i];
        }
        solve_back(response, reactions);
        memset(moved, 0, response->linkage->body_count * sizeof *moved);
        for (size_t i = 0; i < ideal; i++) {
            add_answer(&response->rows[i], reactions[i], moved);
        }
        add_answer(&response->rows[k], 1.0, moved);
    }
}

static size_t play_rows(const SpaceResponse *response)
{
    return response->row_count - response->ideal_rows;
}

void space_response_react(const SpaceResponse *response, const double *impulses, double *reactions)
{
    memset(reactions, 0, response->ideal_rows * sizeof *reactions);
    for (size_t k = 0; k < play_rows(response); k++) {
        for (size_t i = 0; i < response->ideal_rows; i++) {
            reactions[i] += response->reactions[k][i] * impulses[k];
        }
    }
}

void space_response_add_forces(const SpaceResponse *response, const double *reactions,
                               Vec3 forces[SPACE_JOINT_MAX])
{
    for (size_t i = 0; i < response->ideal_rows; i++) {
        if (response->part_of[i] < SPACE_POINT_ROWS) {
            Vec3 *force = &forces[response->joint_of[i]];
            *force = vec3_add(*force, vec3_scale(reactions[i], response->direction_of[i]));
        }
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
    const size_t bodies = response->linkage->body_count;
    memset(changes, 0, bodies * sizeof *changes);
    for (size_t k = 0; k < play_rows(response); k++) {
        const double impulse = impulses[k];
        for (size_t i = 0; i < bodies && impulse != 0.0; i++) {
            const SpaceChange *moved = &response->moved[k][i];
            changes[i].move = vec3_add(changes[i].move, vec3_scale(impulse, moved->move));
            changes[i].turn = vec3_add(changes[i].turn, vec3_scale(impulse, moved->turn));
        }
    }
}

void space_response_solve(const SpaceResponse *response, double *rows)
{
    for (size_t i = 0; i < response->ideal_rows; i++) {
        const double *row = response->matrix + triangle(i);
        for (size_t k = 0; k < i; k++) {
            rows[i] -= row[k] * rows[k];
        }
        rows[i] *= row[i];
    }
    solve_back(response, rows);
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
