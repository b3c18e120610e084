// The integrators of the motion, explicit and implicit, and the coupling of its coordinates.
//
// The coupling says which accelerations can depend on which coordinates and their rates, and gives
// sparse matrices of such derivatives their pattern. Coordinates that ideal joints tie to one
// another are a part: the acceleration of each depends on all of them. Forces between bodies, of
// contacts, springs and dampers, couple parts. Where bodies meet only their neighbours everything
// here is in proportion to the number of coordinates.
#pragma once

#include "base/banded.h"
#include "base/carry.h"
#include "base/grouped.h"
#include "model/linkage.h"

#include <stdbool.h>
#include <stddef.h>

enum { COUPLING_JOINT_PARTS = 2 };

// The parts that a joint's bodies belong to, each once: those of body a and of body b; the ground
// and the driven body have none.
typedef struct CouplingJoint {
    size_t count;
    size_t parts[COUPLING_JOINT_PARTS];
} CouplingJoint;

// A matrix is an array of values, row by row: of each coordinate those of the columns that its part
// depends on, in order. What is in the pattern is so both ways round.
typedef struct Coupling {
    size_t count; // of coordinates
    size_t part_count;
    size_t *part_of;          // by coordinate; owned, like all below
    size_t *first_coordinate; // by part and one more: where its coordinates begin
    size_t *coordinates;      // part by part, in order
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
size_t coupling_column_index(const Coupling *coupling, size_t part, size_t column);

// An entry of a matrix; 0 where it is not in the pattern.
double coupling_entry(const Coupling *coupling, const double *values, size_t row, size_t column);

// Writes a matrix times x.
void coupling_multiply(const Coupling *coupling, const double *values, const double *x,
                       double *product);

// An explicit Runge-Kutta integrator of order 8 with error control and dense output of order 7,
// made for motion that events interrupt: a step is tried, checked, shortened, and only then
// taken. The polynomial through a step is worked out when the first state inside it is asked for.

// The method's coefficients (reference/dop853.c).
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
// the coupling; see below.
typedef void (*Dop853Slopes)(double time, const double *y, double *by_position, double *by_rate,
                             void *context);

// What processors of this kind add and multiply at once, the same to the last bit as one by one.
typedef double Dop853Pair __attribute__((vector_size(2 * sizeof(double)), may_alias));

// Of a row of coefficients those that are not zero, twice each, and where the rates that they
// weigh stand behind those of the first stage.
typedef struct Dop853Row {
    size_t count;
    size_t offsets[DOP853_STAGES];
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
    // s: rather than a step of the method that is refused and would have to be shorter, one is
    // taken without it, and with a length; 0: none
    double method_least;
    double otherwise;
    size_t size; // number of equations
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

// One equation at a share of the step, on the polynomial through it, which must be there (fill),
// and how that changes there, per second: on a rate to within the error of a step.
double dop853_sketch(const Dop853 *integrator, size_t number, double share, double *slope);

// Moves the end of the tried step by a time so short that its cube counts for nothing; two
// evaluations. Not where another method takes the steps.
void dop853_shift(Dop853 *integrator, double by);

// Takes the tried step: its end becomes the start of the next.
void dop853_accept(Dop853 *integrator);

// Carries all that steps from here on depend on; the method is chosen by whoever has it.
void dop853_carry(Dop853 *integrator, Carry *carry);

// For another method that takes the steps: the state at the end of the step that is tried, from how
// it has changed in it, and the error over the error allowed from two estimates of it times a
// factor.
void dop853_end(Dop853 *integrator, const double *change);
double dop853_judge(const Dop853 *integrator, const double *high, const double *low, double factor);

// The coefficients of the implicit Runge-Kutta method of order 13.

enum { RADAU_STAGES = 7, RADAU_DENSE_ROWS = 6 };

extern const double RADAU_NODE[RADAU_STAGES];
extern const double RADAU_COUPLING[RADAU_STAGES][RADAU_STAGES]; // the last row: the step's weights
// Of what the stages have moved since the start: the coefficients of degree 7 and 6 of the
// polynomial through them, and those that its ends leave open in the form of Dop853.
extern const double RADAU_LAST[2][RADAU_STAGES];
extern const double RADAU_DENSE[RADAU_DENSE_ROWS][RADAU_STAGES];

// The linear equations of Newton's method for the stages of an implicit step. Coordinates that have
// nothing to do with one another are in separate blocks, each factored by itself; a block whose
// coordinates meet only their neighbours, as those of a long chain, is banded.

// Coordinates that depend on one another, directly or by others.
typedef struct RadauBlock {
    size_t size;  // of them
    size_t reach; // how far apart two are at most, in the block's order, of which one depends on
                  // the other
    bool is_banded;
    Banded banded;
} RadauBlock;

typedef struct RadauNewton {
    const Coupling *coupling;
    size_t count; // of coordinates
    // derivatives of the accelerations at the stages, 1/s^2 and 1/s, for the caller to fill in, as
    // matrices of the coupling
    double *by_position[RADAU_STAGES];
    double *by_rate[RADAU_STAGES];
    size_t block_count;
    RadauBlock *blocks;  // as many as there are coordinates
    size_t *coordinates; // which they are, block by block
    // room to work in, owned like all of the above
    bool *is_taken;
    double *own;
    size_t *index_in_block; // by coordinate
    double *matrix;         // of the blocks, one behind the other; NULL before the first
    size_t room;            // of it
    size_t *pivots;
} RadauNewton;

// The coupling must outlive it.
void radau_newton_init(RadauNewton *newton, const Coupling *coupling);
void radau_newton_finish(RadauNewton *newton);

// Sorts the coordinates into blocks by the derivatives and factors the matrix of each, for a step
// of a length. Returns false where one is singular.
bool radau_newton_factor(RadauNewton *newton, double step);

// Solves the factored equations in place; the unknowns by stages and coordinates.
void radau_newton_solve(const RadauNewton *newton, double *change);

// An implicit Runge-Kutta method of order 13 for motion that a strong damper makes stiff: its steps
// are as long as the motion is smooth, however short the time constants that have died away.
//
// It takes the steps of a Dop853, which then has the polynomial through the step and everything
// else as from its own stages.

typedef struct Radau {
    Dop853Method method; // what a Dop853 takes the steps by; the first
    // Changes of the coordinates and their rates by which accelerations are differentiated: small
    // against what they depend on, large against rounding.
    double *nudge;
    Coupling *own_coupling; // owned, of an integrator without one
    RadauNewton newton;
    double decay;                // 1/s, the largest rate of decay, where it was last found
    double *moved[RADAU_STAGES]; // of the stages since the start of the step
    double *rates[RADAU_STAGES];
    double before_s; // length of the step whose polynomial the integrator has; 0 for none
    size_t filled;   // accepted steps before that one began
    // room to work in
    double *y;
    double *changed;
    double *kept;
    double *start;
    double *change; // of all stages' rates
    double *memory; // owned: all vectors above
} Radau;

// For the integrator of coordinates and their rates, as many of each, with sums behind them. Never
// NULL; the caller destroys it.
Radau *radau_create(const Dop853 *integrator);
void radau_destroy(Radau *radau);

// Carries all that steps from here on depend on.
void radau_carry(Radau *radau, Carry *carry);

// What an implicit step costs by the number of its operations, in explicit steps, with the
// couplings that the last derivatives show.
double radau_step_cost(Radau *radau);

// How fast rates die away where the next step starts: the largest rate of decay, 1/s. The next step
// takes nothing from one before.
double radau_find_decay(Radau *radau, Dop853 *integrator);
