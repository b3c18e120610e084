// How the bodies of a linkage in space answer what acts in its joints with play, its ideal joints
// holding and its driven body on its path: model/response.h in space.
#pragma once

#include "model/response.h"
#include "model/space_rows.h"

enum {
    SPACE_RESPONSE_PLAY_MAX = 1024, // 56 pins with friction, and 256 without
    SPACE_RESPONSE_ROW_MAX = SPACE_COLUMN_MAX + SPACE_RESPONSE_PLAY_MAX,
};

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

typedef struct SpaceResponse {
    const Linkage *linkage;
    SpaceEnd ends[SPACE_JOINT_MAX][2];
    Mat3 own_inertia[SPACE_BODY_MAX]; // kg m^2, in the body's frame
    Mat3 own_inverse[SPACE_BODY_MAX];
    // where it was placed
    Mat3 turns[SPACE_BODY_MAX];   // from the body's frame to the world's
    Mat3 inverse[SPACE_BODY_MAX]; // of the inertia, in the world's frame
    size_t ideal_rows;            // independent ones; they come first
    size_t row_count;
    int joint_of[SPACE_COLUMN_MAX]; // of an ideal row
    int part_of[SPACE_COLUMN_MAX];  // which of the joint's five
    Vec3 direction_of[SPACE_COLUMN_MAX];
    SpaceResponseRow rows[SPACE_RESPONSE_ROW_MAX];
    // what an impulse of 1 in a row of play changes of all bodies, the ideal joints holding; and
    // with which impulses these hold: space_response_link
    SpaceChange moved[SPACE_RESPONSE_PLAY_MAX][SPACE_BODY_MAX];
    double reactions[SPACE_RESPONSE_PLAY_MAX][SPACE_COLUMN_MAX];
    // lower triangle, row after row: Cholesky's factor in the ideal columns, with the inverse of
    // its diagonal, then the mobility
    double matrix[SPACE_RESPONSE_ROW_MAX * (SPACE_RESPONSE_ROW_MAX + 1) / 2];
} SpaceResponse;

// Prepares the response of a linkage whose ideal joints have the rows that are independent at the
// motions given: the points of all joints, and as many of the directions of their axes. Fails with
// ERR_SOLVER where the points alone depend on each other. The response is large: not for the stack.
bool space_response_init(const Linkage *linkage, const SpaceMotion *motions,
                         SpaceResponse *response, Err *err);

// Takes the response at the positions of the motions given, with rows of play. Where the rows of
// the ideal joints have ceased to be independent, others are chosen. Returns false where none are.
bool space_response_place(SpaceResponse *response, const SpaceMotion *motions,
                          const SpaceRow *play_rows, size_t play_count);

// Works out what impulses in the rows of play do to all bodies, which space_response_react and
// space_response_apply need.
void space_response_link(SpaceResponse *response);

// Writes the mobility W of the rows of play, row by row: their rates change by W times the impulses
// that act there.
void space_response_mobility(const SpaceResponse *response, double *mobility);

// Fills in the accelerations that the bodies would have if no joint held them: gravity's, along -y,
// and that of turning inertias, I alpha = -omega x I omega. Those of the driven body stay.
void space_response_loosen(const SpaceResponse *response, double gravity, SpaceMotion *motions);

// Writes how fast the rates of the ideal rows change under the accelerations of the motions.
void space_response_drift(const SpaceResponse *response, const SpaceMotion *motions, double *drift);

// Writes how fast the rates of the rows of play change while nothing acts in them, the ideal joints
// holding: from the drifts of all rows under loosened motions.
void space_response_free(const SpaceResponse *response, const double *ideal_drift,
                         const double *play_drift, double *rates);

// Writes the impulses with which the ideal rows answer impulses in the rows of play.
void space_response_react(const SpaceResponse *response, const double *impulses, double *reactions);

// Adds to the forces of the ideal joints on their bodies b what impulses in the ideal rows are.
void space_response_add_forces(const SpaceResponse *response, const double *reactions,
                               Vec3 forces[SPACE_JOINT_MAX]);

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
