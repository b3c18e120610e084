// How the bodies of a linkage in space answer what acts in its joints with play, its ideal joints
// holding and its driven body on its path: model/response.h in space.
#pragma once

#include "model/response_matrix.h"
#include "model/space_rows.h"

// What changes of a body: position and turn, velocity and angular velocity, or what acts on it,
// force and moment about its centre of mass.
typedef struct SpaceChange {
    Vec3 move; // m, m/s, N or N s
    Vec3 turn; // rad, rad/s, N m or N m s
} SpaceChange;

// A row and by how much an impulse of 1 in it, by itself, changes the velocities of its two bodies.
typedef struct SpaceResponseRow {
    SpaceRow row;
    int mover[2];          // its bodies; none where it cannot give way
    SpaceChange answer[2]; // of movers
} SpaceResponseRow;

// A place at which a joint with play can touch: a number of rows between the joint's bodies.
typedef struct SpaceResponsePlace {
    int joint;
    size_t rows;
} SpaceResponsePlace;

// Which rows of the joints hold them: bit k of chosen[joint] stands for its row k. Returns whether
// those asked for can be held so (model/space_rows.h).
typedef bool (*SpaceResponseChoice)(const Linkage *linkage, const SpaceMotion *motions,
                                    const bool *is_asked, unsigned *chosen);

typedef struct SpaceResponse {
    const Linkage *linkage;
    SpaceResponseChoice choose;
    bool *is_asked;      // by joint: whether it is held; owned, like all below
    SpaceEnd (*ends)[2]; // by joint
    Mat3 *own_inertia;   // kg m^2, by body, in its frame
    Mat3 *own_inverse;
    // where it was placed
    Mat3 *turns;       // by body, from its frame to the world's
    Mat3 *inverse;     // of the inertia, in the world's frame
    bool is_redundant; // whether rows of the joints were left out
    size_t choices;    // how often rows were chosen
    size_t ideal_rows; // independent ones; they come first
    size_t row_count;
    int *joint_of; // of an ideal row
    int *part_of;  // which of the joint's five
    Vec3 *direction_of;
    size_t node_count;
    int *joint_at;              // of a node of D: an ideal joint, or behind them a place's
    size_t ideal_count;         // nodes that are ideal joints
    size_t *first_ideal;        // by joint: its first ideal row; behind the last their number
    size_t place_count;         //
    SpaceResponsePlace *places; //
    size_t *first_row;          // by place, among the rows of play; behind the last their number
    size_t *first_partner;      // by place, and behind the last: which places an impulse in it
    size_t *partners;           // moves, itself among them, in order
    SpaceResponseRow *rows;     //
    Sparse matrix;              // D. Once placed, Cholesky's factor in the ideal columns, then
                                // the mobility
    size_t block_count;         //
    ResponseBlock *blocks;      // of D that are not zero
    double *work;               // by row
} SpaceResponse;

// Prepares the response of a linkage whose ideal joints have the rows that are independent at the
// motions given: the points of all joints, and as many of the directions of their axes; with places
// at which its joints touch. Fails with ERR_SOLVER where the points alone depend on each other. A
// zeroed response is to be finished after a failure too; it must not be copied.
bool space_response_init(const Linkage *linkage, const SpaceMotion *motions,
                         const SpaceResponsePlace *places, size_t count, SpaceResponse *response,
                         Err *err);

// The same without places, for joints that are asked for (by joint), by the rows of a choice.
// Returns whether that holds them.
bool space_response_init_joints(const Linkage *linkage, const SpaceMotion *motions,
                                const bool *is_asked, SpaceResponseChoice choose,
                                SpaceResponse *response);
void space_response_finish(SpaceResponse *response);

// Lists the rows that hold the joints where motions are, and prepares D for them: a part of
// space_response_init and space_response_place. Returns whether they do.
bool space_response_choose(SpaceResponse *response, const SpaceMotion *motions);

// The number of rows of play.
static inline size_t space_response_play_rows(const SpaceResponse *response)
{
    return response->first_row[response->place_count];
}

// Takes the response at the positions of the motions given, with rows of play, place by place
// (NULL: zeros; a row of zeros has no part). Where the rows of the ideal joints have ceased to be
// independent, or others have become more so, those are chosen. Returns false where none are.
bool space_response_place(SpaceResponse *response, const SpaceMotion *motions,
                          const SpaceRow *play_rows);

// The mobility between two places as it is stored, row by row: of the later one's rows, from the
// other's. The rates of rows change by the mobility times the impulses that act there. NULL where
// it is always zero.
const double *space_response_block(const SpaceResponse *response, size_t place, size_t other);

// Writes the mobility of all rows of play, row by row.
void space_response_mobility(const SpaceResponse *response, double *mobility);

// Fills in the accelerations that the bodies would have if no joint held them: gravity's, m/s^2,
// and that of turning inertias, I alpha = -omega x I omega. Those of the driven body stay.
void space_response_loosen(const SpaceResponse *response, Vec3 gravity, SpaceMotion *motions);

// Writes how fast the rates of the ideal rows change under the accelerations of the motions.
void space_response_drift(const SpaceResponse *response, const SpaceMotion *motions, double *drift);

// Writes how fast the rates of the rows of play change while nothing acts in them, the ideal joints
// holding: from the drifts of all rows under loosened motions.
void space_response_free(const SpaceResponse *response, const double *ideal_drift,
                         const double *play_drift, double *rates);

// Writes the impulses with which the ideal rows answer impulses in the rows of play.
void space_response_react(const SpaceResponse *response, const double *impulses, double *reactions);

// Adds to the forces of the ideal joints, by joint, on their bodies b what impulses in the ideal
// rows are.
void space_response_add_forces(const SpaceResponse *response, const double *reactions,
                               Vec3 *forces);

// The same of one ideal row.
void space_response_add_force(const SpaceResponse *response, size_t row, double reaction,
                              Vec3 *forces);

// Adds what impulses in the ideal rows are on one body.
void space_response_add_reactions(const SpaceResponse *response, const double *reactions, int body,
                                  SpaceChange *load);

// Writes what impulses in the rows of play are on the bodies they act on, the driven one too, and
// the ideal joints' answer left out.
void space_response_load(const SpaceResponse *response, const double *impulses, SpaceChange *loads);

// Writes by how much impulses in the rows of play change the velocities of all bodies, the ideal
// joints' own impulses included.
void space_response_apply(const SpaceResponse *response, const double *impulses,
                          SpaceChange *changes);

// Adds by how much an impulse in one of all rows, by itself, changes the velocities of its bodies.
void space_response_add_row(const SpaceResponse *response, size_t row, double impulse,
                            SpaceChange *changes);

// Solves D x = b for the ideal rows, D = J M^-1 J', in place.
void space_response_solve(const SpaceResponse *response, double *rows);

// Writes the changes, weighed by mass and inertia the least, that take from the ideal rows what is
// given there, and the impulses in those rows that change velocities so.
void space_response_close(const SpaceResponse *response, const double *openings, double *impulses,
                          SpaceChange *changes);

// How far the ideal rows are open at the positions of the motions, and how fast they open there.
void space_response_openings(const SpaceResponse *response, const SpaceMotion *motions,
                             double *openings, double *rates);

// Adds a change to a motion's position and turn, and another to its velocities; NULL for none.
void space_change(SpaceMotion *motion, const SpaceChange *place, const SpaceChange *speed);
