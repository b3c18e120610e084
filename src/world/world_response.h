// A world's response to pushes in the places at which its joints with play touch, in one step.
#pragma once

#include "world/closing.h"
#include "world/play.h"

// A place, with the first of its rows among those of all places.
typedef struct ResponsePlace {
    JpJoint *joint;
    Place *place;
    size_t first_row;
    bool is_active; // whether its contacts are integrated
    bool is_known;  // whether the responses to pushes in its rows have been found
} ResponsePlace;

// What a step needs to know of a world's response, and what it is to put right afterwards. Arrays
// are by row where nothing else is said.
typedef struct WorldResponse {
    JpWorld *world;
    double step;    // s
    bool is_linear; // whether no bound can be passed (world/closing.h)
    bool is_held;   // whether ODE's joints are closed at its start and are held so (likewise)
    bool is_closed; // whether they are at its end
    bool is_beyond; // whether bodies are where they are expected at mid-step
    bool has_rates; // whether it is known how the responses change in it (world/response_rate.h)
    bool is_cached; // whether the responses to pushes are those of steps before
                    // (world/response_cache.h)
    size_t place_count;
    size_t side_count; // of the active places
    size_t row_count;
    size_t inside_count;   // rows of the kernel
    ResponsePlace *places; // all, in the world's order
    const Direction **rows;
    double *frozen;  // rates with the velocities of the step's start
    double *base;    // after the base
    double *found;   // after the step
    double *pushed;  // impulses of the base
    double *net;     // impulses of the contacts in the step
    double *moment;  // integrals of the impulses so far over the step; then those of these
    double *rotors;  // 1/kg or 1/(kg m^2): mobility of the rotor, 0 where there is none
    double *free;    // accelerations while nothing presses, less those of rotors
    double *columns; // by row: rates of all rows for an impulse of 1 in it
    double *bodies;  // by row: speeds of all bodies for an impulse of 1 in it
    double *rates;   // likewise, how these change with time, 1/s of it
    double *drift;   // S, row by row, 1/(kg s): W changes by S + S'
    double *speeds;  // of all bodies after the base
    double *beyond;  // of all bodies: how much further they are expected at mid-step, m, rad
    double *apart;   // likewise: what speeds after the base have more where they are not
    double *before;  // impulses of the base in the round before
    double *later;   // likewise, where they are a little later
    size_t *inside;  // of rows of the kernel: which row it is, and 1; 0 of one that is still
    double *signs;   // likewise
    void *memory;    // owned, of all of the above
    KernelSums sums; // owned: of the kernel, at a time within the step
    Closing closing; // owned, of a linear world
} WorldResponse;

// Lists the places and rows of a step, with their rates as they are; false where there is no
// memory.
bool world_response_make(JpWorld *world, double step, WorldResponse *response);
void world_response_free(WorldResponse *response);

// The rates of all rows, and the speeds of all bodies, as they are.
void world_response_read_rates(const WorldResponse *response, double *rates);
void world_response_read_bodies(const JpWorld *world, double *speeds);

// Steps the world under the mean forces of the impulses of the base; writes the rates of all rows
// after that.
JpStatus world_response_step(const WorldResponse *response, double step, double *rates,
                             JpError *error);

// Gives the bodies the velocities that the response has for the impulses of the contacts, as a step
// would: nothing pushes them any more.
void world_response_take(const WorldResponse *response);

// Finds the responses to pushes in the rows of all active places beside the base, but for those
// that are known.
JpStatus world_response_find_columns(WorldResponse *response, double step, JpError *error);

// Finds how the responses change as all bodies go on along their speeds, by trials where bodies are
// a little later: of all active places, whose responses are known.
JpStatus world_response_find_rates(WorldResponse *response, double step, JpError *error);

// Whether the responses that are not known yet, and contacts in all active places, can be found
// within the limit of work.
bool world_response_is_within_work(const WorldResponse *response);

// What impulses in all rows do to the rate of one.
double world_response_to(const WorldResponse *response, const double *impulses, size_t row);
