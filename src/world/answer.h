// A world's answer to pushes in the places at which its joints with play touch, in one step.
#pragma once

#include "world/closing.h"
#include "world/play.h"

// A place, with the first of its rows among those of all places.
typedef struct AnswerPlace {
    JpJoint *joint;
    Place *place;
    size_t first_row;
    bool is_active; // whether its contacts are integrated
    bool is_known;  // whether the answers to pushes in its rows have been found
} AnswerPlace;

// What a step needs to know of a world's answer, and what it is to put right afterwards. Arrays are
// by row where nothing else is said.
typedef struct Answer {
    JpWorld *world;
    double step;      // s
    bool is_linear;   // whether no bound can be passed (world/closing.h)
    bool is_recalled; // whether the answers to pushes are those of steps before (world/recall.h)
    size_t place_count;
    size_t side_count; // of the active places
    size_t row_count;
    AnswerPlace *places; // all, in the world's order
    const Direction **rows;
    double *frozen;  // rates with the velocities of the step's start
    double *base;    // after the base
    double *found;   // after the step
    double *pushed;  // impulses of the base
    double *net;     // impulses of the contacts in the step
    double *moment;  // integrals of the impulses so far over the step
    double *rotors;  // 1/kg or 1/(kg m^2): mobility of the rotor, 0 where there is none
    double *free;    // accelerations while nothing presses, less those of rotors
    double *columns; // by row: rates of all rows for an impulse of 1 in it
    double *bodies;  // by row: speeds of all bodies for an impulse of 1 in it
    double *speeds;  // of all bodies after the base
    size_t *inside;  // of rows of the kernel: which row it is, and 1; 0 of one that is still
    double *signs;   // likewise
    void *memory;    // owned, of all of the above
    KernelSums sums; // owned: of the kernel, at a time within the step
    Closing closing; // owned, of a linear world
} Answer;

// Lists the places and rows of a step, with their rates as they are; false where there is no
// memory.
bool answer_make(JpWorld *world, double step, Answer *answer);
void answer_free(Answer *answer);

// The rates of all rows, and the speeds of all bodies, as they are.
void answer_read_rates(const Answer *answer, double *rates);
void answer_read_bodies(const JpWorld *world, double *speeds);

// Steps the world under the mean forces of the impulses of the base; writes the rates of all rows
// after that.
JpStatus answer_step(const Answer *answer, double step, double *rates, JpError *error);

// Gives the bodies the velocities that the answer has for the impulses of the contacts, as a step
// would: nothing pushes them any more.
void answer_take(const Answer *answer);

// Finds the answers to pushes in the rows of all active places beside the base, but for those that
// are known.
JpStatus answer_find_columns(Answer *answer, double step, JpError *error);

// Whether the answers that are not known yet, and contacts in all active places, can be found
// within the limit of work.
bool answer_is_within_work(const Answer *answer);

// What impulses in all rows do to the rate of one.
double answer_to(const Answer *answer, const double *impulses, size_t row);
