// The rows in which a pin in space moves against one place of its hole, as the linkage's response
// and a kernel take them (model/space_response.h, kernel/kernel.h).
//
// Of an end: the pin's axis against the end's centre along two directions across the axis, and
// with friction the turns of the hole's and the pin's body about the axis, the sliding along the
// axis, and the turns of both bodies about the two directions. Of a collar: along the hole's axis,
// and one row that nothing moves, so that it has two like an end.
#pragma once

#include "contact/pin_space.h"
#include "model/space_rows.h"

enum {
    PIN_SPACE_PLAIN_ROWS = 2,
    PIN_SPACE_ROWS = 9, // of an end with friction
};

// Frozen at one instant: the middle of a step.
typedef struct PinSpaceRows {
    size_t count;
    Vec3 across[2]; // unit; of a collar the first is along the hole's axis
    Vec3 axis;      // across[0] x across[1]
    Vec3 at_a;      // m: the points of the bodies in the first two rows
    Vec3 at_b;
    SpaceRow rows[PIN_SPACE_ROWS];
} PinSpaceRows;

// The number of rows of a place: more where its law has friction.
size_t pin_space_row_count(const PinSpace *place);

// Freezes the rows of a place.
void pin_space_rows_place(const PinSpace *place, const SpaceMotion *motions, PinSpaceRows *rows);

// Takes frozen rows along to where the bodies are at another instant, their directions as they are.
void pin_space_rows_move(const PinSpace *place, const SpaceMotion *motions, PinSpaceRows *rows);

// Where the pin is and how fast it goes in the rows at another instant of the step: of the first
// two rows the position, of all the rate.
void pin_space_rows_state(const PinSpace *place, const PinSpaceRows *rows,
                          const SpaceMotion *motions, double *position, double *speed);

// How fast the rates change under the accelerations of motions at the instant of the rows.
void pin_space_rows_drift(const PinSpace *place, const PinSpaceRows *rows,
                          const SpaceMotion *motions, double *drift);
