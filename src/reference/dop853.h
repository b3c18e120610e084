// An explicit Runge-Kutta integrator of order 8 with error control and dense output of order 7,
// made for motion that events interrupt: a step is tried, looked at, shortened, and only then
// taken. The polynomial through a step is worked out when the first state inside it is asked for.
#pragma once

#include "reference/coupling.h"

#include <stdbool.h>
#include <stddef.h>

// The method's coefficients (reference/dop853_table.c).
enum {
    DOP853_STAGES = 16,
    DOP853_DENSE_ROWS = 4,
    DOP853_POLYNOMIAL = 8,
    DOP853_ROWS = DOP853_STAGES + 2 + DOP853_DENSE_ROWS, // with the two of the errors
};

extern const double DOP853_NODE[DOP853_STAGES];
extern const double DOP853_COUPLING[DOP853_STAGES][DOP853_STAGES]; // row 12: the step's weights
extern const double DOP853_ERROR_5[DOP853_STAGES];
extern const double DOP853_ERROR_3[DOP853_STAGES];
extern const double DOP853_DENSE[DOP853_DENSE_ROWS][DOP853_STAGES];

// Writes dy/dt at a time and state.
typedef void (*Dop853Rates)(double time, const double *y, double *rates, void *context);

// Writes how the second rates of the coordinates change with these and their rates, as matrices of
// the coupling; see radau.h.
typedef void (*Dop853Slopes)(double time, const double *y, double *by_position, double *by_rate,
                             void *context);

// What processors of this kind add and multiply at once, the same to the last bit as one by one.
typedef double Dop853Pair __attribute__((vector_size(2 * sizeof(double)), may_alias));

// Of a row of coefficients those that are not zero, twice each, and where the rates that they
// weigh stand behind those of the first stage.
typedef struct Dop853Row {
    size_t count;
    size_t places[DOP853_STAGES];
    Dop853Pair weights[DOP853_STAGES];
} Dop853Row;

typedef struct Dop853 Dop853;

// Another method that takes the steps, as dop853_try and dop853_fill do.
typedef struct Dop853Method Dop853Method;
struct Dop853Method {
    double (*try_step)(Dop853Method *method, Dop853 *integrator, double step);
    void (*fill)(Dop853Method *method, Dop853 *integrator);
};

struct Dop853 {
    Dop853Method *method; // takes the steps where it is not NULL
    size_t size;          // number of equations
    // Of those, the first: the others are sums, on which no rate depends; their errors are judged
    // by themselves.
    size_t motion_size;
    Dop853Rates rates;
    Dop853Slopes slopes;      // for a method that needs them; NULL: from differences of the rates
    const Coupling *coupling; // of the coordinates; NULL: any may depend on any
    void *context;
    // Error allowed in each component of one step: fixed[i] + grown[i] times the step. A component
    // with both 0 is not controlled.
    double *fixed;
    double *grown;
    double time; // where the next step starts
    double *y;
    double *carry;   // what rounding has left out of y
    double shortest; // a step may be no shorter: rounding of the time would show
    double step;     // length suggested for the next step
    double tried;    // length of the step that is tried
    double *next;    // state at the end of the step that is tried
    double *next_carry;
    double *end_rates; // rates there, where has_end_rates says so; who has them may write them
    bool has_end_rates;
    bool is_filled; // whether the polynomial is that of the tried step
    Dop853Row rows[DOP853_ROWS];
    double *stages[DOP853_STAGES]; // rates, one behind the other in memory
    double *polynomial[DOP853_POLYNOMIAL];
    bool was_rejected; // the step before had to be shortened: the next must not grow
    double last_error; // of the step before, over the error allowed
    size_t accepted;
    size_t rejected;
    size_t evaluations;
    // room to work in
    double *at; // the state in the step that was asked for last
    double *stage_y;
    double *change;
    double *errors[2];
    double *memory; // owned: all of the vectors, each of whole blocks
};

// Makes room for so many equations, zeros, with nothing else set; dop853_finish frees it.
void dop853_init(Dop853 *integrator, size_t size, size_t motion_size);
void dop853_finish(Dop853 *integrator);

// Puts the integrator at a time and state; also after the right-hand side has changed.
void dop853_start(Dop853 *integrator, double time, const double *y);

// Tries a step of a length: fills `next`. Returns the error over the error allowed: at most 1 is
// good. Not finite where the state is not.
double dop853_try(Dop853 *integrator, double step);

// Tries steps, shortening them, until the error is allowed, beginning with the suggested length but
// at most `longest`. Suggests the length of the following one. Returns false where the step fell
// below the shortest.
bool dop853_attempt(Dop853 *integrator, double longest);

// The state at a time in the tried step, in memory of the integrator that holds it until the next
// such call. The first one of a step takes three evaluations, or four.
const double *dop853_dense(Dop853 *integrator, double time);

// The same of so many of the equations alone, by their numbers; the others are not for use.
const double *dop853_dense_some(Dop853 *integrator, double time, const size_t *numbers,
                                size_t count);

// The polynomial through the tried step, if it is not there yet.
void dop853_fill(Dop853 *integrator);

// The same, written elsewhere: of all equations, or of the motion alone.
void dop853_dense_all(Dop853 *integrator, double time, double *y);
void dop853_dense_motion(Dop853 *integrator, double time, double *y);

// The polynomial at a share of the step; beyond 1 as it goes on.
void dop853_polynomial(const Dop853 *integrator, double share, double *y);

// Moves the end of the tried step by a time so short that its cube counts for nothing; two
// evaluations. Not where another method takes the steps.
void dop853_shift(Dop853 *integrator, double by);

// Takes the tried step: its end becomes the start of the next.
void dop853_accept(Dop853 *integrator);

// For another method that takes the steps: the state at the end of the step that is tried, from how
// it has changed in it, and the error over the error allowed from two estimates of it times a
// factor.
void dop853_end(Dop853 *integrator, const double *change);
double dop853_judge(const Dop853 *integrator, const double *high, const double *low, double factor);
