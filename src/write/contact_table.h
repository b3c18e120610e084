// A row for each contact of a run.
#pragma once

#include "base/err.h"
#include "model/numbers.h"
#include "model/trajectory.h"

enum { CONTACT_COLUMN_MAX = 3 + 2 * NUMBER_COUNT };

// What a column has.
typedef enum ContactOf {
    CONTACT_JOINT,  // the joint: its name, or its number in the linkage
    CONTACT_NUMBER, // a number of model/number_list.h
    CONTACT_CRANK,  // deg, the crank's angle at the onset
    CONTACT_WALL,   // deg, where on the wall of its hole the pin pressed most
} ContactOf;

typedef struct ContactColumn {
    const char *name; // as in the head, with the unit; static
    ContactOf of;
    NumberId id; // of CONTACT_NUMBER, as all below
    NumberTurn turn;
    bool is_alike; // all joints have it in one unit; else it is NAN of those of the other turn
} ContactColumn;

// The columns of the contacts of a linkage: numbers with NUMBER_CSV, of which those that are forces
// or lengths stand twice where some joints have torques and angles.
typedef struct ContactTable {
    size_t count;
    ContactColumn columns[CONTACT_COLUMN_MAX];
} ContactTable;

ContactTable contact_table_of(const Linkage *linkage);

// A cell of a contact; NAN where it has no such number.
double contact_table_number(const ContactColumn *column, const Trajectory *trajectory,
                            const JointSpike *contact);

// Puts the contacts in the order of their onsets.
void contact_table_sort(const Trajectory *trajectory);

// Writes the contacts in the order of their onsets, whole or not at all (write/row_file.h, where
// the file is claimed before). The trajectory is complete and has kept them. Fails as row_file_end
// does.
bool contact_table_write(const Trajectory *trajectory, const char *path, Err *err);
