// How the response of a linkage changes as its bodies move (model/response.h).
#pragma once

#include "model/response.h"

// What changes with time: room for it, for as many rows of play as the response has.
typedef struct ResponseDrift {
    double
        *answers; // of an impulse of 1 in each row of play: all rows' impulses; owned, as all here
    double *columns; // what it does to all speeds, three a body; not owned
    double *rates;   // how that changes with time, 1/s of it
    double *drift;   // S, row by row, 1/(kg s): the mobility changes by S + S', and an impulse P in
                     // the rows of play changes their accelerations by 2 S P
    double *turned;  // how these change with time in the ideal rows, 1/s; NULL like `late`
    double *late;    // of an impulse of 1 in each row of play: what it adds to the forces of the
                     // ideal rows from there on, 1/s, as these go with the square of the speeds;
                     // NULL where that is not wanted
    bool are_points; // whether all rows are points': they turn with bodies, and nothing else
    ResponseRow *turning; // the rates of all rows
    Motion *ahead;
} ResponseDrift;

ResponseDrift response_drift_create(const Response *response);

// Lets it have `late`.
void response_drift_want_late(const Response *response, ResponseDrift *drift);
void response_drift_finish(ResponseDrift *drift);

// Writes what impulses in the rows of play do, from a response that has been placed: to `columns`,
// which are kept.
void response_drift_columns(const Response *response, double *columns, ResponseDrift *drift);

// Writes, after them, how that changes, and S, where the bodies move as given. Rows that are no
// points' are differences over a short time, s.
void response_drift_find(Response *response, const Motion *motions, double short_s,
                         ResponseDrift *drift);
