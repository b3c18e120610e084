// Which accelerations can depend on which coordinates and their rates, and sparse matrices of such
// derivatives.
//
// Coordinates that ideal joints tie to one another are a part: the acceleration of each depends on
// all of them. Forces between bodies, of contacts, springs and dampers, couple parts. Where bodies
// meet only their neighbours everything here is in proportion to the number of coordinates.
#pragma once

#include "base/grouped.h"
#include "model/linkage.h"

#include <stdbool.h>
#include <stddef.h>

enum { COUPLING_JOINT_PARTS = 3 };

// The parts that a joint's bodies belong to, each once: those of body a, of body b and of the
// carrier of gears; the ground and the driven body have none.
typedef struct CouplingJoint {
    size_t count;
    size_t parts[COUPLING_JOINT_PARTS];
} CouplingJoint;

// A matrix is an array of values, row by row: of each coordinate those of the columns that its part
// depends on, in order. What is in the pattern is so both ways round.
typedef struct Coupling {
    size_t count; // of coordinates
    size_t part_count;
    size_t *part_of;      // by coordinate; owned, like all below
    size_t *first_member; // by part and one more: where its coordinates begin
    size_t *members;      // coordinates, part by part, in order
    size_t *first_column; // by part and one more: where the coordinates that it depends on begin
    size_t *columns;      // in order
    size_t *first_value;  // by coordinate and one more: where its row begins
    // Parts that can be moved at once, because no acceleration depends on two of them.
    size_t colour_count;
    size_t *first_coloured; // by colour and one more
    size_t *coloured;       // parts, colour by colour
    CouplingJoint *joints;  // by joint; NULL where there is no linkage
} Coupling;

// A body that is free to move: its coordinates, one after the other, and its part.
typedef struct CouplingBody {
    int body;
    size_t part;
    size_t first; // coordinate
    size_t count;
} CouplingBody;

// The free bodies of a linkage, whose parts are coupled by its joints, springs and dampers. Never
// NULL; the caller destroys it.
Coupling *coupling_create(const Linkage *linkage, size_t part_count, size_t body_count,
                          const CouplingBody *bodies);

// Any acceleration may depend on any of so many coordinates: one part.
Coupling *coupling_create_full(size_t count);
void coupling_destroy(Coupling *coupling);

// The number of values in a matrix.
static inline size_t coupling_value_count(const Coupling *coupling)
{
    return coupling->first_value[coupling->count];
}

// The columns of a part's rows, and how many there are.
static inline const size_t *coupling_columns(const Coupling *coupling, size_t part)
{
    return coupling->columns + coupling->first_column[part];
}

static inline size_t coupling_width(const Coupling *coupling, size_t part)
{
    return coupling->first_column[part + 1] - coupling->first_column[part];
}

// Which of the columns of a part's rows a coordinate is; their number where it is none.
size_t coupling_place(const Coupling *coupling, size_t part, size_t column);

// An entry of a matrix; 0 where it is not in the pattern.
double coupling_entry(const Coupling *coupling, const double *values, size_t row, size_t column);

// Writes a matrix times x.
void coupling_multiply(const Coupling *coupling, const double *values, const double *x,
                       double *product);
