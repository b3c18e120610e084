// By how much does a push in a joint with play move the bodies?
//
// Rows: relative velocity in each joint, u = J v. With M the masses and inertias
//     D = J M^-1 J',  D = [ D_ii D_ic ; D_ci D_cc ]      i ideal joints, c joints with play
// The ideal joints answer a push p with impulses that keep them closed,
//     D_ii y + D_ic p = 0,   v' = v + M^-1 J' (y, p)
// so that the joints with play see the Schur complement W = D_cc - D_ci D_ii^-1 D_ic. It is what
// is left of D when Cholesky's elimination stops after the ideal rows.
//
// Accelerations without a push: gamma = J a0 + dJ/dt v of all rows, a0 gravity's; then
//     g = gamma_c - D_ci D_ii^-1 gamma_i
// The driven body moves as its drive says: it is part of gamma, and of no row.
//
// Sources: E. Delassus, Ann. sci. Ec. norm. sup. 34 (1917) 95, for D; B. Brogliato, Nonsmooth
// Mechanics, 3rd ed., Springer 2016, ch. 5.
#include "model/response.h"

#include "model/joint_rows.h"

#include <string.h>

// the share of a row that must be left when the rows before it are taken out: rounding leaves
// 1e-15, of either sign, of one that they make redundant
static const double INDEPENDENT = 1e-12;

static bool add_rows(Response *response, int joint, int place, size_t count)
{
    if (response->row_count + count > RESPONSE_ROW_MAX) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        response->joint_of[response->row_count] = joint;
        response->place_of[response->row_count++] = place;
    }
    return true;
}

bool response_init_places(const Linkage *linkage, const ResponsePlace *places, size_t count,
                          Response *response, Err *err)
{
    memset(response, 0, sizeof *response);
    response->linkage = linkage;
    bool has_room = count <= RESPONSE_PLACE_MAX;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        has_room = has_room && (!linkage_is_ideal(linkage, i) || add_rows(response, (int)i, -1, 2));
    }
    response->ideal_rows = response->row_count;
    for (size_t i = 0; has_room && i < count; i++) {
        response->places[i] = places[i];
        response->first_row[i] = response_play_rows(response);
        has_room = add_rows(response, places[i].joint, (int)i, response_place_rows(&places[i]));
        response->place_count++;
    }
    return has_room || err_set(err, ERR_SOLVER,
                               "the linkage has more joint rows than the %d that contacts can be "
                               "solved with",
                               RESPONSE_ROW_MAX);
}

bool response_init(const Linkage *linkage, bool with_turns, Response *response, Err *err)
{
    ResponsePlace places[LINKAGE_JOINT_MAX];
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
    return response_init_places(linkage, places, count, response, err);
}

size_t response_play_rows(const Response *response)
{
    return response->row_count - response->ideal_rows;
}

// One entry of D: what the rows have in common through the bodies they share.
static double coupling(const Linkage *linkage, const ResponseRow *a, const ResponseRow *b)
{
    double sum = 0.0;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            if (a->body[i] != LINKAGE_GROUND && a->body[i] == b->body[k]) {
                const Body *body = &linkage->bodies[a->body[i]];
                sum += (a->x[i] * b->x[k] + a->y[i] * b->y[k]) / body->mass +
                       a->turn[i] * b->turn[k] / body->inertia;
            }
        }
    }
    return sum;
}

bool response_place(Response *response, const Motion *motions)
{
    response_rows_place(response, motions);
    const size_t count = response->row_count;
    double diagonal[RESPONSE_ROW_MAX];
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k <= i; k++) {
            response->matrix[i][k] =
                coupling(response->linkage, &response->rows[i], &response->rows[k]);
        }
        diagonal[i] = response->matrix[i][i];
    }
    // Cholesky's elimination, stopped after the ideal rows
    for (size_t pivot = 0; pivot < response->ideal_rows; pivot++) {
        const double square = response->matrix[pivot][pivot];
        if (!(square > INDEPENDENT * diagonal[pivot])) {
            return false;
        }
        const double inverse = 1.0 / sqrt(square);
        for (size_t i = pivot; i < count; i++) {
            response->matrix[i][pivot] *= inverse;
        }
        for (size_t i = pivot + 1; i < count; i++) {
            const double factor = response->matrix[i][pivot];
            for (size_t k = pivot + 1; k <= i && factor != 0.0; k++) {
                response->matrix[i][k] -= factor * response->matrix[k][pivot];
            }
        }
    }
    return true;
}

void response_mobility(const Response *response, double *mobility)
{
    const size_t first = response->ideal_rows;
    const size_t width = response->row_count - first;
    for (size_t i = 0; i < width; i++) {
        for (size_t k = 0; k < width; k++) {
            mobility[i * width + k] = k <= i ? response->matrix[first + i][first + k]
                                             : response->matrix[first + k][first + i];
        }
    }
}

void response_free(const Response *response, const Motion *motions, double gravity,
                   const BodyLoad *loads, double *rates)
{
    double gamma[RESPONSE_ROW_MAX];
    response_rows_loose(response, motions, gravity, loads, gamma);
    // forward through the factor: what is left in the rows of play is g
    for (size_t pivot = 0; pivot < response->ideal_rows; pivot++) {
        gamma[pivot] /= response->matrix[pivot][pivot];
        for (size_t i = pivot + 1; i < response->row_count; i++) {
            gamma[i] -= response->matrix[i][pivot] * gamma[pivot];
        }
    }
    memcpy(rates, gamma + response->ideal_rows, response_play_rows(response) * sizeof *rates);
}

// Adds what an impulse in a row does to its bodies: changes of their speeds, or without a linkage
// the impulses themselves.
static void add_row(const Linkage *linkage, const ResponseRow *row, double impulse, double *sums)
{
    for (int end = 0; end < 2; end++) {
        if (row->body[end] != LINKAGE_GROUND) {
            const Body *body = linkage != NULL ? &linkage->bodies[row->body[end]] : NULL;
            const double mass = body != NULL ? body->mass : 1.0;
            const double inertia = body != NULL ? body->inertia : 1.0;
            double *sum = sums + 3 * row->body[end];
            sum[0] += row->x[end] * impulse / mass;
            sum[1] += row->y[end] * impulse / mass;
            sum[2] += row->turn[end] * impulse / inertia;
        }
    }
}

// Back through the transposed factor.
static void solve_back(const Response *response, double *rows)
{
    for (size_t i = response->ideal_rows; i-- > 0;) {
        for (size_t k = i + 1; k < response->ideal_rows; k++) {
            rows[i] -= response->matrix[k][i] * rows[k];
        }
        rows[i] /= response->matrix[i][i];
    }
}

void response_react(const Response *response, const double *impulses, double *reactions)
{
    const size_t ideal = response->ideal_rows;
    for (size_t i = 0; i < ideal; i++) {
        reactions[i] = 0.0;
        for (size_t k = ideal; k < response->row_count; k++) {
            reactions[i] -= response->matrix[k][i] * impulses[k - ideal];
        }
    }
    solve_back(response, reactions);
}

void response_apply(const Response *response, const double *impulses, double *changes)
{
    const size_t ideal = response->ideal_rows;
    double reactions[RESPONSE_ROW_MAX];
    response_react(response, impulses, reactions);
    memset(changes, 0, 3 * response->linkage->body_count * sizeof *changes);
    for (size_t i = 0; i < response->row_count; i++) {
        const double impulse = i < ideal ? reactions[i] : impulses[i - ideal];
        add_row(response->linkage, &response->rows[i], impulse, changes);
    }
}

void response_load(const Response *response, const double *impulses, double *loads)
{
    memset(loads, 0, 3 * response->linkage->body_count * sizeof *loads);
    for (size_t i = response->ideal_rows; i < response->row_count; i++) {
        add_row(NULL, &response->rows[i], impulses[i - response->ideal_rows], loads);
    }
}

void response_solve(const Response *response, double *rows)
{
    for (size_t i = 0; i < response->ideal_rows; i++) {
        for (size_t k = 0; k < i; k++) {
            rows[i] -= response->matrix[i][k] * rows[k];
        }
        rows[i] /= response->matrix[i][i];
    }
    solve_back(response, rows);
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
        add_row(response->linkage, &response->rows[i], impulses[i], changes);
    }
}

void response_openings(const Response *response, const Motion *motions, double *positions,
                       double *rates)
{
    const Linkage *linkage = response->linkage;
    for (size_t row = 0; row < response->ideal_rows; row += 2) {
        JointRows joint;
        joint_rows_find(linkage, motions, response->joint_of[row], &joint);
        memcpy(positions + row, joint.position, sizeof joint.position);
        memcpy(rates + row, joint.rate, sizeof joint.rate);
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

static size_t rows_at(const Response *response, size_t first)
{
    const int place = response->place_of[response->ideal_rows + first];
    return response_place_rows(&response->places[place]);
}

double response_between(const Response *response, size_t first_from, const double *from,
                        size_t first_to, const double *to)
{
    const size_t from_count = rows_at(response, first_from);
    const size_t to_count = rows_at(response, first_to);
    double sum = 0.0;
    for (size_t i = 0; i < from_count; i++) {
        for (size_t k = 0; k < to_count; k++) {
            const size_t row = response->ideal_rows + first_from + i;
            const size_t column = response->ideal_rows + first_to + k;
            const double mobility =
                row < column ? response->matrix[column][row] : response->matrix[row][column];
            sum += from[i] * mobility * to[k];
        }
    }
    return sum;
}

double response_mass(const Response *response, size_t first_row, Vec2 normal)
{
    const size_t row = response->ideal_rows + first_row;
    const double xx = response->matrix[row][row];
    const double yx = response->matrix[row + 1][row];
    const double yy = response->matrix[row + 1][row + 1];
    return 1.0 / (normal.x * (xx * normal.x + 2.0 * yx * normal.y) + normal.y * yy * normal.y);
}
