// With which mass the linkage meets what presses at a place.
#pragma once

#include "model/response.h"
#include "ode/contact_row.h"

typedef struct ContactMass {
    const World *world;
    Response response; // its places are the pairs of the world
    bool is_placed;    // the response is where the bodies are in this step, and so are the motions
    Motion *motions;   // owned by the rows
} ContactMass;

// Brings the masses of a row that touches up to date, all rows of the step having been found: each
// time where they have to be exact, else where they may have changed.
void contact_mass_find(ContactMass *mass, ContactRow *rows, size_t number, bool is_exact);

// Brings the response to where the bodies are in this step, and says how they move; NULL where
// ideal joints are redundant there.
const Motion *contact_mass_place(ContactMass *mass);
