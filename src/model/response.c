// Finds by how much a push in a joint with play moves the bodies.
//
// Rows: relative velocity in each joint, u = J v. With M the masses and inertias
//     D = J M^-1 J',  D = [ D_ii D_ic ; D_ci D_cc ]      i ideal joints, c joints with play
// The ideal joints answer a push p with impulses that keep them closed,
//     D_ii y + D_ic p = 0,   v' = v + M^-1 J' (y, p)
// so that the joints with play see the Schur complement W = D_cc - D_ci D_ii^-1 D_ic. It is what
// is left of D when Cholesky's elimination stops after the ideal rows. Rows of joints that share no
// body leave zeros in D, and D is factored without them (base/sparse.h): a chain, a tree or a loop
// takes time and memory in proportion to its joints.
//
// Accelerations without a push: gamma = J a0 + dJ/dt v of all rows, a0 gravity's; then
//     g = gamma_c - D_ci D_ii^-1 gamma_i
// The driven body moves as its drive says: it is part of gamma, and of no row.
//
// Sources: E. Delassus, Ann. sci. Ec. norm. sup. 34 (1917) 95, for D; B. Brogliato, Nonsmooth
// Mechanics, 3rd ed., Springer 2016, ch. 5.
#include "model/response.h"
#include "model/response_matrix.h"

#include "model/joint_rows.h"

#include <string.h>

// the share of a row that must be left when the rows before it are taken out: rounding leaves
// 1e-15, of either sign, of one that they make redundant
static const double INDEPENDENT = 1e-12;

size_t response_play_rows(const Response *response)
{
    return response->row_count - response->ideal_rows;
}

// What two rows have in common through a body that is one end of each.
static inline double coupling_by(const Body *body, const ResponseRow *a, int end_a,
                                 const ResponseRow *b, int end_b)
{
    return (a->x[end_a] * b->x[end_b] + a->y[end_a] * b->y[end_b]) / body->mass +
           a->turn[end_a] * b->turn[end_b] / body->inertia;
}

// One entry of D: what the rows have in common through the bodies they share.
static double coupling(const Linkage *linkage, const ResponseRow *a, const ResponseRow *b)
{
    double sum = 0.0;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            if (a->body[i] != LINKAGE_GROUND && a->body[i] == b->body[k]) {
                sum += coupling_by(&linkage->bodies[a->body[i]], a, i, b, k);
            }
        }
    }
    return sum;
}

// The block of two rows of one joint and two of another, which have the same bodies: a row that has
// none is all zero.
static void couple_pairs(const Linkage *linkage, const ResponseRow a[2], const ResponseRow b[2],
                         double values[4])
{
    for (size_t n = 0; n < 4; n++) {
        values[n] = 0.0;
    }
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            if (a->body[i] != LINKAGE_GROUND && a->body[i] == b->body[k]) {
                const Body *body = &linkage->bodies[a->body[i]];
                for (size_t n = 0; n < 4; n++) {
                    values[n] += coupling_by(body, &a[n / 2], i, &b[n % 2], k);
                }
            }
        }
    }
}

static void couple_all(const Linkage *linkage, const ResponseRow *a, const ResponseRow *b,
                       const ResponseBlock *block)
{
    const bool is_own = block->rows == block->columns;
    for (size_t i = 0; i < block->row_count; i++) {
        double *row = block->values + i * block->column_count;
        for (size_t k = 0; k < (is_own ? i + 1 : block->column_count); k++) {
            row[k] = coupling(linkage, &a[i], &b[k]);
            if (is_own) {
                block->values[k * block->column_count + i] = row[k];
            }
        }
    }
}

static inline void fill_block(const Response *response, const ResponseBlock *block)
{
    const ResponseRow *a = &response->rows[block->rows];
    const ResponseRow *b = &response->rows[block->columns];
    if (block->row_count == 2 && block->column_count == 2) {
        couple_pairs(response->linkage, a, b, block->values);
    } else {
        couple_all(response->linkage, a, b, block);
    }
}

bool response_place(Response *response, const Motion *motions)
{
    response_rows_place(response, motions);
    sparse_clear(&response->matrix);
    for (size_t n = 0; n < response->block_count; n++) {
        fill_block(response, &response->blocks[n]);
    }
    return sparse_factor(&response->matrix, INDEPENDENT);
}

bool response_place_some(Response *response, const Motion *motions, size_t node_count,
                         const size_t *nodes, size_t block_count, const size_t *blocks)
{
    for (size_t i = 0; i < node_count; i++) {
        response_rows_place_ideal(response, 2 * nodes[i], motions);
    }
    sparse_clear_some(&response->matrix, node_count, nodes);
    for (size_t n = 0; n < block_count; n++) {
        fill_block(response, &response->blocks[blocks[n]]);
    }
    return sparse_factor_some(&response->matrix, INDEPENDENT, node_count, nodes);
}

const double *response_block(const Response *response, size_t place, size_t other)
{
    return response_matrix_block(&response->matrix, place, other);
}

void response_mobility(const Response *response, double *mobility)
{
    response_matrix_mobility(&response->matrix, mobility);
}

void response_free(const Response *response, const Motion *motions, Vec2 gravity,
                   const BodyLoad *loads, double *rates)
{
    double *gamma = response->work;
    response_rows_loose(response, motions, gravity, loads, gamma);
    // forward through the factor: what is left in the rows of play is g
    sparse_forward(&response->matrix, gamma);
    memcpy(rates, gamma + response->ideal_rows, response_play_rows(response) * sizeof *rates);
}

void response_free_reactions(const Response *response, const Motion *motions, Vec2 gravity,
                             const BodyLoad *loads, double *reactions)
{
    double *gamma = response->work;
    response_rows_loose(response, motions, gravity, loads, gamma);
    response_solve(response, gamma);
    for (size_t i = 0; i < response->ideal_rows; i++) {
        reactions[i] = -gamma[i];
    }
}

// The accelerations of all bodies if no joint held them.
static void accelerate_loose(const Linkage *linkage, const Motion *motions, Vec2 gravity,
                             const BodyLoad *loads, double *accelerations)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        Vec2 centre = gravity;
        double turning = 0.0;
        if (linkage_is_driven(linkage, (int)i)) {
            centre = motions[i].acceleration;
            turning = motions[i].alpha;
        } else if (loads != NULL) {
            centre = vec2_add(centre, vec2_scale(1.0 / body->mass, loads[i].force));
            turning = loads[i].moment / body->inertia;
        }
        accelerations[3 * i] = centre.x;
        accelerations[3 * i + 1] = centre.y;
        accelerations[3 * i + 2] = turning;
    }
}

void response_accelerate(const Response *response, const Motion *motions, Vec2 gravity,
                         const BodyLoad *loads, double *accelerations)
{
    double *gamma = response->work;
    response_rows_loose(response, motions, gravity, loads, gamma);
    response_solve(response, gamma);
    accelerate_loose(response->linkage, motions, gravity, loads, accelerations);
    for (size_t i = 0; i < response->ideal_rows; i++) {
        response_row_push(response->linkage, &response->rows[i], -gamma[i], accelerations);
    }
}

void response_add_row(const Response *response, size_t row, double impulse, double *changes)
{
    response_row_push(response->linkage, &response->rows[row], impulse, changes);
}

// All impulses that impulses in the joints with play bring with them, by row.
static const double *answer(const Response *response, const double *impulses)
{
    double *all = response->work;
    memset(all, 0, response->ideal_rows * sizeof *all);
    memcpy(all + response->ideal_rows, impulses, response_play_rows(response) * sizeof *all);
    sparse_back(&response->matrix, all);
    return all;
}

void response_react(const Response *response, const double *impulses, double *reactions)
{
    memcpy(reactions, answer(response, impulses), response->ideal_rows * sizeof *reactions);
}

void response_apply(const Response *response, const double *impulses, double *changes)
{
    const double *all = answer(response, impulses);
    memset(changes, 0, 3 * response->linkage->body_count * sizeof *changes);
    for (size_t i = 0; i < response->row_count; i++) {
        response_row_push(response->linkage, &response->rows[i], all[i], changes);
    }
}

void response_load(const Response *response, const double *impulses, double *loads)
{
    memset(loads, 0, 3 * response->linkage->body_count * sizeof *loads);
    for (size_t i = response->ideal_rows; i < response->row_count; i++) {
        response_row_push(NULL, &response->rows[i], impulses[i - response->ideal_rows], loads);
    }
}

void response_hold(const Response *response, const double *reactions, double *loads)
{
    memset(loads, 0, 3 * response->linkage->body_count * sizeof *loads);
    for (size_t i = 0; i < response->ideal_rows; i++) {
        response_row_push(NULL, &response->rows[i], reactions[i], loads);
    }
}

void response_solve(const Response *response, double *rows)
{
    sparse_solve(&response->matrix, rows);
}

void response_close(const Response *response, const double *openings, double *impulses,
                    double *changes)
{
    for (size_t i = 0; i < response->ideal_rows; i++) {
        impulses[i] = -openings[i];
    }
    response_solve(response, impulses);
    memset(changes, 0, 3 * response->linkage->body_count * sizeof *changes);
    for (size_t i = 0; i < response->ideal_rows; i++) {
        response_row_push(response->linkage, &response->rows[i], impulses[i], changes);
    }
}

// How a joint's end on a body stands and moves.
static JointGap end_of(const Response *response, const Motion *motions, JointEnd end)
{
    if (end.body == LINKAGE_GROUND) {
        return (JointGap){.position = end.anchor};
    }
    const Motion *motion = &motions[end.body];
    const Vec2 arm = response_arm(response, motions, end.body, end.anchor);
    return (JointGap){
        .position = vec2_add(motion->position, arm),
        .velocity = vec2_add(motion->velocity, vec2_scale(motion->omega, vec2_perp(arm))),
    };
}

void response_openings(const Response *response, const Motion *motions, double *positions,
                       double *rates)
{
    const Linkage *linkage = response->linkage;
    for (size_t row = 0; row < response->ideal_rows; row += 2) {
        const Joint *of = &linkage->joints[response->joint_of[row]];
        if (joint_slides(of->kind)) {
            JointRows joint;
            joint_rows_find(linkage, motions, response->joint_of[row], &joint);
            memcpy(positions + row, joint.position, sizeof joint.position);
            memcpy(rates + row, joint.rate, sizeof joint.rate);
            continue;
        }
        const JointGap a = end_of(response, motions, linkage_end(of, 0));
        const JointGap b = end_of(response, motions, linkage_end(of, 1));
        positions[row] = b.position.x - a.position.x;
        positions[row + 1] = b.position.y - a.position.y;
        rates[row] = b.velocity.x - a.velocity.x;
        rates[row + 1] = b.velocity.y - a.velocity.y;
    }
}

int response_joint(const Response *response, size_t play_row)
{
    return response->joint_of[response->ideal_rows + play_row];
}

size_t response_first_row(const Response *response, size_t place)
{
    return response->first_row[place];
}

size_t response_place_at(const Response *response, size_t play_row)
{
    return (size_t)response->place_of[response->ideal_rows + play_row];
}

double response_between(const Response *response, size_t first_from, const double *from,
                        size_t first_to, const double *to)
{
    const size_t from_place = response_place_at(response, first_from);
    const size_t to_place = response_place_at(response, first_to);
    const size_t from_count = response_place_rows(&response->places[from_place]);
    const size_t to_count = response_place_rows(&response->places[to_place]);
    const double *block = response_block(response, from_place, to_place);
    double sum = 0.0;
    for (size_t i = 0; block != NULL && i < from_count; i++) {
        for (size_t k = 0; k < to_count; k++) {
            const double mobility =
                from_place < to_place ? block[k * from_count + i] : block[i * to_count + k];
            sum += from[i] * mobility * to[k];
        }
    }
    return sum;
}

double response_mass(const Response *response, size_t first_row, Vec2 normal)
{
    const size_t place = response_place_at(response, first_row);
    const size_t width = response_place_rows(&response->places[place]);
    const double *block = response_block(response, place, place);
    const double xx = block[0];
    const double yx = block[width];
    const double yy = block[width + 1];
    return 1.0 / (normal.x * (xx * normal.x + 2.0 * yx * normal.y) + normal.y * yy * normal.y);
}
