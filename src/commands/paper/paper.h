// The paper's numbers: printed, recomputed, and what physics gives.
#pragma once

#include "measure/estimate.h"
#include "model/scenario.h"
#include "model/trajectory.h"
#include "run/run.h"
#include "write/fields.h"

enum { PAPER_CURVE_COUNT = 4, PAPER_CURVE_POINTS = 361 };

// Coupler and follower over the first revolution, one point every degree: what Figures 5 to 8
// show.
typedef struct PaperCurve {
    size_t count;                                         // 0: none
    double crank_deg[PAPER_CURVE_POINTS];                 // turned since the start, either way
    double values[PAPER_CURVE_COUNT][PAPER_CURVE_POINTS]; // coupler omega, follower omega, rad/s,
                                                          // coupler alpha, follower alpha, rad/s^2
} PaperCurve;

// Tables VII and VIII: a row of the paper beside ours (extremes.c).
typedef struct ExtremesRow {
    const char *name;
    double printed[PRINTED_QUANTITY_COUNT];
    bool is_target;                      // the ideal rows; the others are orders of magnitude
    bool is_known;                       // false: the run failed, see the message
    char message[ERR_TEXT_SIZE];         // why it failed
    double ours[PRINTED_QUANTITY_COUNT]; // rad/s and rad/s^2, in the order of the table
    int as_printed;                      // cells that round to the printed number
    double difference_max;               // 1, largest |ours - printed| / |printed|
    char label[TRAJECTORY_LABEL_SIZE];   // how ours was made
    // of the rows with play
    double step_s;    // 0 for a closed form
    size_t impacts;   // contacts begun in the joint with play
    double force_max; // N, largest in it
    PaperCurve curve; // of the rows that are runs
} ExtremesRow;

// Over the target rows: the largest relative difference, and how many of their cells are as
// printed (and how many cells there are).
double extremes_difference_max(const ExtremesRow rows[PRINTED_ROW_COUNT]);

// What physics gives where the paper estimates (physical.c): a pin at one speed, under the largest
// force that inverse dynamics finds over a turn.
typedef struct PhysicalPin {
    const char *name;
    double rpm;
    double force;            // N, largest over a turn, ideal joints, gravity included
    double hertz_approach;   // m, sphere in socket, the paper's own Eq. (3)
    double johnson_approach; // m, cylinder in hole
    double johnson_tangent;  // N/m, stiffness at that force
    double half_angle;       // rad, of the contact seen from the pin's axis, by Hertz's half width
} PhysicalPin;

// The laws at one force beside each other.
typedef struct PhysicalLaw {
    const char *name;
    double approach; // m
    double tangent;  // N/m
} PhysicalLaw;

enum {
    PHYSICAL_LAW_COUNT = LAW_COUNT - 1, // all but LAW_AUTO, which is one of them
    PHYSICAL_BASE_ROW = 9,              // of 1000 rpm
};

typedef struct Physical {
    PhysicalPin pins[PRINTED_SPEED_COUNT][PRINTED_PIN_COUNT];
    double estimated_force;                    // N: the paper's, crank-coupler pin at 1000 rpm
    PhysicalLaw estimated[PHYSICAL_LAW_COUNT]; // every law at that force
    double real_force;                         // N: of inverse dynamics, same pin and speed
    PhysicalLaw real[PHYSICAL_LAW_COUNT];      // every law at that force
} Physical;

// The four-bar must have joints named as in PRINTED_PIN_NAMES; its own speed does not matter.
// Fails with ERR_SOLVER where its crank does not turn fully.
bool physical_compute(const Scenario *fourbar, Physical *physical, Err *err);

// The largest forces on the two pins over a turn, N, at a speed, rpm.
bool physical_force(const Scenario *fourbar, double rpm, double forces[PRINTED_PIN_COUNT],
                    Err *err);

// Where in the output a slip is named.
typedef enum TypoPlace {
    TYPO_TABLE_1,
    TYPO_TABLE_2,
    TYPO_TABLE_3,
    TYPO_TABLES_7_8,
    TYPO_MODEL, // of no one table
} TypoPlace;

typedef struct Typo {
    TypoPlace place;
    const char *where;    // in the paper
    const char *printed;  // what stands there
    const char *reading;  // what it is taken for
    const char *evidence; // why, and what follows
} Typo;

extern const Typo TYPOS[];
extern const size_t TYPOS_COUNT;

typedef struct PaperResult {
    EstimateInputs inputs;                     // of Tables I to III
    EstimateTable tables[PRINTED_TABLE_COUNT]; // Tables I to III
    int cell_count;                            // of them
    int as_printed;                            // cells that come out as printed
    Physical physical;                         // the counterpart of Tables I to III
    ExtremesRow extremes[PRINTED_ROW_COUNT];   // Tables VII and VIII
    double ideal_difference_max;               // 1, relative, over the ideal rows
    int ideal_cell_count;                      // of the ideal rows
    int ideal_as_printed;                      // cells of them that round to the printed number
} PaperResult;

// Recomputes everything. The watch follows one of the two ODE runs, which take
// nearly all the time and go side by side.
// Fails where an embedded case cannot be loaded or solved in closed form.
bool paper_compute(PaperResult *result, RunWatch watch, Err *err);

// Fails with ERR_DIFFERS where the result is not the paper's: a cell of Tables I to III that does
// not come out as printed, or an ideal row of Tables VII and VIII more than 0.03 % off.
bool paper_check(const PaperResult *result, Err *err);

// The fields of PhysicalPin; beside Tables I to III stand those of PAPER_TABLE << 0 to 2.
enum { PAPER_TABLE = FIELD_OWN };
extern const Field PAPER_PIN_FIELDS[];

// What `jointplay paper` prints of a PaperResult: each table with its recomputed numbers, what
// physics gives, and the typos that concern it; or JSON, a new reference, with units in the keys.
void paper_text_write(const void *result, const Style *style, Text *text);
json_t *paper_json_make(const void *result);

// The paper's cases, inside the program: `jointplay paper` needs no file.

typedef enum EmbeddedCase {
    EMBEDDED_IDEAL_NOMINAL,
    EMBEDDED_IDEAL_STACKUP,
    EMBEDDED_STACKUP_POISSON,
    EMBEDDED_STACKUP_IMPACT,
    EMBEDDED_COUNT,
} EmbeddedCase;

// Loads one of them with the crank turning clockwise at 1000 rpm, as the paper's does. The scenario
// is untouched on failure.
bool embedded_load(EmbeddedCase which, Scenario *scenario, Err *err);
