// The rows of a linkage's response (model/response.h), and where they stand.
#pragma once

#include "model/forces.h"
#include "model/response_matrix.h"

enum {
    RESPONSE_ROWS_A_JOINT = 4, // x and y of the pin against the hole, turns of the two bodies
    RESPONSE_ROW_MAX = 64,     // 16 joints with play and friction, and 24 without friction
    RESPONSE_PLACE_MAX = RESPONSE_ROW_MAX / 2,
};

// A place at which the bodies of a joint with play touch. It has two rows: x and y in the world of
// anchor b less anchor a; or, at a line or cam of body a, the rates at which the touching points of
// body b and body a part along the line's normal and along its tangent, the normal turned by a
// quarter turn; or, at an end of a limited coordinate, the rate at which it comes away from there
// and a row of nothing. With turns, two more: the angular velocities of body a and of body b.
// Friction at a line acts in the second row and needs none.
typedef struct ResponsePlace {
    int joint;    // number in the linkage
    bool is_line; // or a cam
    double sign;  // of the joint's coordinate (model/coordinate.h) at one of its ends; else 0
    bool has_turns;
    Vec2 anchor_a;    // in body a's frame, m
    Vec2 anchor_b;    // in body b's frame, m
    double direction; // rad, in body a's frame: of a line's normal
    double radius;    // m, of body b's circle that meets the line
    Cam cam;          // its profile is NULL where there is none
} ResponsePlace;

// A relative velocity as a sum over one or two bodies. A body that cannot give way has no part.
typedef struct ResponseRow {
    int body[2]; // LINKAGE_GROUND where there is none
    double x[2]; // 1, of the velocity of its centre
    double y[2];
    double turn[2]; // m, or 1 for a row that is a turn: of its angular velocity
} ResponseRow;

// The angle of a body, rad, and its cosine and sine.
typedef struct ResponseTurn {
    double angle; // NAN: not known yet
    Vec2 direction;
} ResponseTurn;

typedef struct Response {
    const Linkage *linkage;
    size_t ideal_rows; // they come first, two a joint; the drive's joint has none
    size_t row_count;
    ResponseRow *rows; // owned, as all below
    int *joint_of;     // of a row
    size_t place_count;
    ResponsePlace *places; // their rows come after the ideal ones
    size_t *first_row;     // of a place, among the rows of play
    size_t *first_partner; // of a place, and behind the last: which places an impulse in it moves,
    size_t *partners;      // itself among them, in order
    int *place_of;         // of a row; -1 of an ideal one
    Sparse matrix;         // D; a node is an ideal joint or a place. Once placed, Cholesky's factor
                           // in the ideal columns, then the mobility
    size_t largest_group;  // rows of the most ideal joints that hold one another
    size_t block_count;
    ResponseBlock *blocks; // of D that are not zero
    double *work;          // by row
    ResponseTurn *turns;   // of each body, the last that was asked for
} Response;

// The number of rows of a place.
static inline size_t response_place_rows(const ResponsePlace *place)
{
    return place->has_turns ? RESPONSE_ROWS_A_JOINT : 2;
}

// Adds what an impulse in a row does to its bodies, three each: changes of their speeds, or without
// a linkage the impulses themselves.
static inline void response_row_push(const Linkage *linkage, const ResponseRow *row, double impulse,
                                     double *sums)
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

// What a row makes of speeds, three a body.
static inline double response_row_of(const ResponseRow *row, const double *speeds)
{
    double sum = 0.0;
    for (int end = 0; end < 2; end++) {
        if (row->body[end] != LINKAGE_GROUND) {
            const double *speed = speeds + 3 * row->body[end];
            sum += row->x[end] * speed[0] + row->y[end] * speed[1] + row->turn[end] * speed[2];
        }
    }
    return sum;
}

// Where an anchor of a body is, seen from its centre: sine and cosine of an angle are found once.
static inline Vec2 response_arm(const Response *response, const Motion *motions, int body,
                                Vec2 anchor)
{
    ResponseTurn *turn = &response->turns[body];
    if (turn->angle != motions[body].angle) {
        turn->angle = motions[body].angle;
        turn->direction = (Vec2){cos(turn->angle), sin(turn->angle)};
    }
    const Vec2 direction = turn->direction;
    return (Vec2){direction.x * anchor.x - direction.y * anchor.y,
                  direction.y * anchor.x + direction.x * anchor.y};
}

// Writes the rows where the bodies are.
void response_rows_place(Response *response, const Motion *motions);

// The same of one ideal joint, whose first row is given, and of one place.
void response_rows_place_ideal(Response *response, size_t row, const Motion *motions);
void response_rows_place_play(Response *response, size_t number, const Motion *motions);

// Writes the accelerations of all rows under gravity and loads (NULL: none) while nothing acts in
// any of them, those of the ideal joints included.
void response_rows_loose(const Response *response, const Motion *motions, Vec2 gravity,
                         const BodyLoad *loads, double *rates);
