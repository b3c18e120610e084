// The paper's Tables VII and VIII, its five rows beside ours.
#pragma once

#include "base/err.h"
#include "measure/printed.h"
#include "model/trajectory.h"
#include "run/run.h"

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
} ExtremesRow;

// Fills the five rows. A run that fails is a row that says so; the function fails only where a
// case cannot be loaded.
bool extremes_compute(RunWatch watch, ExtremesRow rows[PRINTED_ROW_COUNT], Err *err);

// Over the target rows: the largest relative difference, and how many of their cells are as
// printed (and how many cells there are).
double extremes_difference_max(const ExtremesRow rows[PRINTED_ROW_COUNT]);
int extremes_as_printed(const ExtremesRow rows[PRINTED_ROW_COUNT], int *cell_count);
