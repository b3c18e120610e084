// How the bodies of a linkage answer what acts in its joints with play, its ideal joints holding
// and its driven body on its path: the inverse of the effective mass, which the field calls the
// Delassus operator.
#pragma once

#include "model/response_rows.h"

// Prepares the response of a linkage with places at which its joints touch, joint by joint
// (contact/touch.h makes them). It keeps the pointer to the linkage, and must not be copied.
void response_init_places(const Linkage *linkage, const ResponsePlace *places, size_t count,
                          Response *response);

// The same where pins in holes are all that touches. With turns, each joint with play has four
// rows: velocity of the pin's centre less that of the hole's, x and y, then angular velocity of the
// hole's and of the pin's body; else only the first two.
void response_init(const Linkage *linkage, bool with_turns, Response *response);

// Frees what a response owns; accepts a zeroed one.
void response_finish(Response *response);

// The first row of a place among the rows of play.
size_t response_first_row(const Response *response, size_t place);

// The number of rows of the joints with play, all together.
size_t response_play_rows(const Response *response);

// Takes the response at the positions of the motions given. Returns false where ideal joints are
// redundant there.
bool response_place(Response *response, const Motion *motions);

// The same of some ideal joints alone, as nodes of the matrix in the order of their elimination, of
// which no other ideal joint shares a body, with the blocks of their columns. The rows of the
// places in these have been placed before.
bool response_place_some(Response *response, const Motion *motions, size_t node_count,
                         const size_t *nodes, size_t block_count, const size_t *blocks);

// Writes the mobility W of the joints with play, 1/kg (1/(kg m), 1/(kg m^2) of turns), row by row:
// their rows' velocities change by W times the impulses that act there.
void response_mobility(const Response *response, double *mobility);

// The mobility between two places as it is stored, row by row: of the later one's rows, from the
// other's. NULL where it is always zero.
const double *response_block(const Response *response, size_t place, size_t other);

// Writes the acceleration of the rows of the joints with play while nothing acts in them: under
// gravity, m/s^2, and loads on the bodies (NULL: none), at the velocities given; of the
// driven body its own acceleration.
void response_free(const Response *response, const Motion *motions, Vec2 gravity,
                   const BodyLoad *loads, double *rates);

// Writes the forces, N, with which the ideal joints hold the bodies then: two rows a joint, on its
// body b.
void response_free_reactions(const Response *response, const Motion *motions, Vec2 gravity,
                             const BodyLoad *loads, double *reactions);

// Writes the accelerations of all bodies then, three each: x, y, angle.
void response_accelerate(const Response *response, const Motion *motions, Vec2 gravity,
                         const BodyLoad *loads, double *accelerations);

// Writes the impulses, N s, with which the ideal joints answer impulses in the joints with play:
// two rows a joint, on its body b.
void response_react(const Response *response, const double *impulses, double *reactions);

// Writes what impulses in the joints with play are on the bodies they act on, the ideal joints'
// answer left out: x, y, N s, and moment, N m s, three a body.
void response_load(const Response *response, const double *impulses, double *loads);

// Writes what impulses in the ideal rows are on the bodies they act on: x, y, N s, and moment,
// N m s, three a body.
void response_hold(const Response *response, const double *reactions, double *loads);

// Writes by how much impulses in the joints with play, N s (N m s), change the velocities of all
// bodies: x, y, angle, three a body. The ideal joints' own impulses are in it.
void response_apply(const Response *response, const double *impulses, double *changes);

// Adds by how much an impulse in one of all rows, by itself, changes the velocities of its bodies.
void response_add_row(const Response *response, size_t row, double impulse, double *changes);

// Solves D x = b for the rows of the ideal joints, D = J M^-1 J', in place.
void response_solve(const Response *response, double *rows);

// Writes the changes, three a body, weighed by mass and inertia the least, that take from the rows
// of the ideal joints what is given there: openings, m, of positions or m/s of velocities; and the
// impulses in those rows, N s, that change velocities so.
void response_close(const Response *response, const double *openings, double *impulses,
                    double *changes);

// The opening of the ideal joints at the positions, and the rate at which they open, two rows a
// joint.
void response_openings(const Response *response, const Motion *motions, double *positions,
                       double *rates);

// The place that a row of play belongs to.
size_t response_place_at(const Response *response, size_t play_row);

// The number of the joint that a row of play belongs to.
int response_joint(const Response *response, size_t play_row);

// By how much an impulse of 1 along a combination of one joint's rows changes the velocity along a
// combination of another's, or of its own: from W to. As many numbers each as the place has rows;
// the first of them among the rows of play is given.
double response_between(const Response *response, size_t first_from, const double *from,
                        size_t first_to, const double *to);

// The mass, kg, with which the linkage meets a push along a unit vector in a joint with play:
// 1 / (n W n). `first_row` is the joint's first among the rows of play.
double response_mass(const Response *response, size_t first_row, Vec2 normal);
