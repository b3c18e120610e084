// Finds how what a push in a joint with play does changes as the bodies move.
//
// All rows J, those of the ideal joints and of play; an impulse of 1 in each row of play brings the
// impulses Y in all rows (model/response.c) and the speeds A = M^-1 J' Y. With J. the rate of the
// rows along the motion, S = Y' J. A:
//     W = Y' J A,   dW/dt = S + S'
//     dA/dt = M^-1 (J.' Y + J_i' z),   D_ii z = -(J_i M^-1 J.' Y + J._i A)
// and a change A p of the speeds, J. v being of second degree in them, changes the rows'
// accelerations by 2 S p. What an impulse P does in a row some time later is therefore, to the
// first order in that time, W P + (S - S') times the integral of P with the W of that time: to
// momenta W alone answers, and S - S' is the gyroscopic part that is left. The last holds of rows
// that are rates of something, as all are but the sliding along a line.
#include "model/response_drift.h"

#include "base/zeroed.h"

#include <stdlib.h>
#include <string.h>

static bool is_point(const Response *response, size_t row)
{
    if (row < response->ideal_rows) {
        return !joint_slides(response->linkage->joints[response->joint_of[row]].kind);
    }
    const ResponsePlace *place = &response->places[response->place_of[row]];
    return !place->is_line && place->sign == 0.0;
}

static bool are_points(const Response *response)
{
    for (size_t row = 0; row < response->row_count; row++) {
        if (!is_point(response, row)) {
            return false;
        }
    }
    return true;
}

ResponseDrift response_drift_create(const Response *response)
{
    const size_t play = response_play_rows(response);
    const size_t bodies = response->linkage->body_count;
    return (ResponseDrift){
        .answers = zeroed(play * response->row_count, sizeof(double)),
        .rates = zeroed(play * 3 * bodies, sizeof(double)),
        .drift = zeroed(play * play, sizeof(double)),
        .are_points = are_points(response),
        .turning = zeroed(response->row_count, sizeof(ResponseRow)),
        .ahead = zeroed(bodies, sizeof(Motion)),
    };
}

void response_drift_want_late(const Response *response, ResponseDrift *drift)
{
    drift->turned = zeroed(response_play_rows(response) * response->ideal_rows, sizeof(double));
    drift->late = zeroed(response_play_rows(response) * response->ideal_rows, sizeof(double));
}

void response_drift_finish(ResponseDrift *drift)
{
    free(drift->answers);
    free(drift->rates);
    free(drift->drift);
    free(drift->turned);
    free(drift->late);
    free(drift->turning);
    free(drift->ahead);
    *drift = (ResponseDrift){.answers = NULL};
}

void response_drift_columns(const Response *response, double *columns, ResponseDrift *drift)
{
    const size_t play = response_play_rows(response);
    const size_t all = response->row_count;
    const size_t speeds = 3 * response->linkage->body_count;
    drift->columns = columns;
    memset(drift->answers, 0, play * all * sizeof *drift->answers);
    for (size_t row = 0; row < play; row++) {
        double *answer = drift->answers + row * all;
        double *column = columns + row * speeds;
        answer[response->ideal_rows + row] = 1.0;
        sparse_back(&response->matrix, answer);
        memset(column, 0, speeds * sizeof *column);
        for (size_t i = 0; i < response->ideal_rows; i++) {
            response_row_push(response->linkage, &response->rows[i], answer[i], column);
        }
        response_row_push(response->linkage, &response->rows[response->ideal_rows + row], 1.0,
                          column);
    }
}

// The rates of two rows of a point: its arms turn with its bodies.
static void turn_point(const ResponseRow *rows, const Motion *motions, ResponseRow *turning)
{
    for (size_t k = 0; k < 2; k++) {
        turning[k] = (ResponseRow){.body = {rows[k].body[0], rows[k].body[1]}};
    }
    for (size_t end = 0; end < 2; end++) {
        const int body = rows[0].body[end];
        const double omega = body == LINKAGE_GROUND ? 0.0 : motions[body].omega;
        turning[0].turn[end] = -omega * rows[1].turn[end];
        turning[1].turn[end] = omega * rows[0].turn[end];
    }
}

// The rates of all rows that are no points', and nothing of the others.
static void turn_all(Response *response, const Motion *motions, double short_s,
                     ResponseDrift *drift)
{
    for (size_t i = 0; i < response->linkage->body_count; i++) {
        Motion *ahead = &drift->ahead[i];
        *ahead = motions[i];
        ahead->position = vec2_add(ahead->position, vec2_scale(short_s, ahead->velocity));
        ahead->angle += short_s * ahead->omega;
    }
    // the rows of there, into the other array
    ResponseRow *const rows = response->rows;
    memcpy(drift->turning, rows, response->row_count * sizeof *rows);
    response->rows = drift->turning;
    response_rows_place(response, drift->ahead);
    response->rows = rows;
    for (size_t i = 0; i < response->row_count; i++) {
        ResponseRow *turning = &drift->turning[i];
        for (size_t end = 0; end < 2; end++) {
            turning->x[end] = (turning->x[end] - rows[i].x[end]) / short_s;
            turning->y[end] = (turning->y[end] - rows[i].y[end]) / short_s;
            turning->turn[end] = (turning->turn[end] - rows[i].turn[end]) / short_s;
        }
    }
}

static void find_turning(Response *response, const Motion *motions, double short_s,
                         ResponseDrift *drift)
{
    if (!drift->are_points) {
        turn_all(response, motions, short_s, drift);
    }
    for (size_t row = 0; row < response->row_count; row += 2) {
        if (drift->are_points || is_point(response, row)) {
            turn_point(&response->rows[row], motions, &drift->turning[row]);
        }
        // turns of bodies are rows that stay as they are
        const bool has_turns =
            row >= response->ideal_rows && response->places[response->place_of[row]].has_turns;
        if (has_turns) {
            row += 2;
            for (size_t k = 0; k < 2; k++) {
                drift->turning[row + k] = (ResponseRow){.body = {LINKAGE_GROUND, LINKAGE_GROUND}};
            }
        }
    }
}

// What a row's rate makes of speeds, three a body, and what an impulse in it adds to them: of a
// point by the turning of its bodies alone.
static inline double turned_by(const ResponseDrift *drift, size_t number, const double *speeds)
{
    const ResponseRow *row = &drift->turning[number];
    if (!drift->are_points) {
        return response_row_of(row, speeds);
    }
    double sum = 0.0;
    for (int end = 0; end < 2; end++) {
        if (row->body[end] != LINKAGE_GROUND) {
            sum += row->turn[end] * speeds[3 * row->body[end] + 2];
        }
    }
    return sum;
}

static inline void push_turning(const Linkage *linkage, const ResponseDrift *drift, size_t number,
                                double impulse, double *sums)
{
    const ResponseRow *row = &drift->turning[number];
    if (!drift->are_points) {
        response_row_push(linkage, row, impulse, sums);
        return;
    }
    for (int end = 0; end < 2; end++) {
        const int body = row->body[end];
        if (body != LINKAGE_GROUND) {
            sums[3 * body + 2] += row->turn[end] * impulse / linkage->bodies[body].inertia;
        }
    }
}

// What the rates of the ideal rows, as their speeds have changed, ask of these: twice, for they are
// of second degree in the speeds.
static void find_late(const Response *response, const double *turned, double *late)
{
    memcpy(late, turned, response->ideal_rows * sizeof *late);
    response_solve(response, late);
    for (size_t i = 0; i < response->ideal_rows; i++) {
        late[i] *= -2.0;
    }
}

void response_drift_find(Response *response, const Motion *motions, double short_s,
                         ResponseDrift *drift)
{
    const size_t play = response_play_rows(response);
    const size_t all = response->row_count;
    const size_t speeds = 3 * response->linkage->body_count;
    double *turned = response->work;
    find_turning(response, motions, short_s, drift);
    memset(drift->rates, 0, play * speeds * sizeof *drift->rates);
    for (size_t of = 0; of < play; of++) {
        const double *answer = drift->answers + of * all;
        double *rate = drift->rates + of * speeds;
        for (size_t i = 0; i < all; i++) {
            turned[i] = turned_by(drift, i, drift->columns + of * speeds);
            push_turning(response->linkage, drift, i, answer[i], rate);
        }
        for (size_t row = 0; row < play; row++) {
            double sum = turned[response->ideal_rows + row];
            for (size_t i = 0; i < response->ideal_rows; i++) {
                sum += drift->answers[row * all + i] * turned[i];
            }
            drift->drift[row * play + of] = sum;
        }
        if (drift->late != NULL) {
            find_late(response, turned, drift->late + of * response->ideal_rows);
        }
        // the ideal joints stay closed
        for (size_t i = 0; i < response->ideal_rows; i++) {
            turned[i] = -turned[i] - response_row_of(&response->rows[i], rate);
        }
        response_solve(response, turned);
        if (drift->turned != NULL) {
            memcpy(drift->turned + of * response->ideal_rows, turned,
                   response->ideal_rows * sizeof *turned);
        }
        for (size_t i = 0; i < response->ideal_rows; i++) {
            response_row_push(response->linkage, &response->rows[i], turned[i], rate);
        }
    }
}
