// The places at which bodies touch: where they are, what presses there, and the rows of relative
// motion that the contact kernel integrates. For every engine alike.
#pragma once

#include "drivers/common/actions.h"
#include "kernel/kernel.h"

// How a place is.
typedef struct PlacePose {
    Vec2 offset;     // m, from anchor a to anchor b
    double gap;      // m, rad of a turn; negative inside the metal
    Vec2 normal;     // unit, of the force on body b; zero of a turn, and without a nearest wall
    double approach; // m/s, rate of the penetration
    Vec2 point;      // m, where the force acts, in the world
} PlacePose;

PlacePose place_pose(const DriverPlace *place, const DriverMotion *motions);

// What the rate of a row is made of: by side the velocity of the body's centre and its turning. A
// push in a row acts on the bodies with the same coefficients.
typedef struct PlaceRow {
    Vec2 along[2];
    double turn[2]; // m, or 1 of a turn
} PlaceRow;

// The rows of a place as kernel/kernel.h has them.
PlaceRow place_row(const DriverPlace *place, const DriverMotion *motions, size_t row);

// The first two of them.
void place_rows(const DriverPlace *place, const DriverMotion *motions,
                PlaceRow rows[KERNEL_ROW_TURN]);

// Whether the first two rows are x and y of anchor b less anchor a.
bool place_is_point(const DriverPlace *place);

// The kernel's contact of a place.
KernelContact place_contact(const DriverPlace *place);

// Where the first two rows stand.
void place_position(const DriverPlace *place, const DriverMotion *motions, double position[2]);

// The rate of a row as bodies move.
double place_rate(const DriverPlace *place, const PlaceRow *row, const DriverMotion *motions);

// The force on body b of so much in a row, N; of a turn the torque, N m, and 0.
Vec2 place_force(const DriverPlace *place, const PlaceRow *row, double value);

// A contact whose law acts as a force, and what it did at the end of the step before.
typedef struct DriverContact {
    ContactState state;
    double gap_before;
    double approach_before;
    double begun_share; // of the last step, since the contact began in it; 0: it did not
    ContactPeaks peaks;
} DriverContact;

// Those of all places, at the start; zeroed of places that do not touch.
DriverContact *places_start(const DriverCase *of);

// Follows all contacts to the end of a step. A contact began where the gap was zero, and its impact
// speed is that between the speeds at both ends of the step.
void places_follow(const DriverCase *of, const DriverMotion *motions, DriverContact *contacts,
                   DriverTotals *totals);

// Adds what the contacts press their bodies with, friction included; NULL: to nothing. Writes the
// forces on body b by joint (those of joints that do not touch are 0). Where a run is given, they
// have been followed to the end of a step of a length, s, and their largest forces and depths,
// which are between the steps, are noted.
void places_press(const DriverCase *of, DriverContact *contacts, const DriverMotion *motions,
                  DriverAction *actions, Vec2 *forces, DriverRun *run, double step_s);

// Writes what the joints do in a step with forces that are given.
void places_touches(const DriverRun *run, const DriverMotion *motions, const Vec2 *forces,
                    DriverTouch *touches);
