// What presses in ideal joints that rub, for contacts integrated within the steps of any engine:
// the joints' reactions, as the kernel is to know them (kernel/kernel.h, KernelRub).
//
// Of a body i with all that hangs on it, in the coordinates of the tree,
//     F_i = m_i (a_i - g) - f_i + sum F_c,   M_i = J_i alpha_i - t_i + sum (M_c + (p_c - p_i) x
//     F_c)
// f_i and t_i what acts on it beside its joint: actions, rows, and what holds the loops. F_i is the
// force of the joint that carries it; the reaction of a pivot is that, of a slider its part across
// the line and the couple about anchor b over half its guide's length. A loop's is that of its
// rows.
#pragma once

#include "drivers/common/hold.h"
#include "drivers/common/place.h"

typedef struct Rubs {
    const Tree *tree;
    const Hold *hold;
    Kernel *kernel;
    size_t count;
    size_t rows;           // of the kernel
    double *answers;       // by rub and row, two numbers each; owned, as all arrays
    double *turning;       // likewise, how these change, 1/s
    double *late;          // likewise, what impulses add, 1/s
    double later_s;        // how much later answers have been looked at for that
    double *before;        // two a rub: reactions in the step before, with what its impulses added
    double *reactions;     // room, two a rub
    double *changes;       // how the frictions grow with each other, and room
    DriverMotion *carried; // room, by body
    DriverAction *carry;   // likewise: what the joint of each gives it
} Rubs;

// An instant at which reactions are asked for, all of it given.
typedef struct RubsInstant {
    const double *q;             // coordinates
    const double *a;             // their accelerations
    const DriverMotion *motions; // where the bodies are
    const Vec2 *bends;           // what their centres are accelerated by besides; NULL: nothing
    Vec2 gravity;
    const DriverAction *actions; // on the bodies
    const double *held;          // by row of the hold: its forces
} RubsInstant;

// Room, once the kernel has all contacts.
Rubs rubs_make(const Tree *tree, const Hold *hold, Kernel *kernel);

// Writes the reactions of all joints that rub, two numbers each.
void rubs_react(Rubs *rubs, const RubsInstant *at, double *reactions);

// Takes what a force of 1 in a row adds to the reactions: `answers`, `turning` or `late`.
void rubs_take(const Rubs *rubs, size_t row, const double *reactions, double *by_row);

// Before a step is integrated: the reactions at mid-step, where all answers are known, and how they
// change since the middle of the step before, so many s ago; 0: that is not known. Fails the run
// where the frictions have no single answer.
void rubs_fill(Rubs *rubs, const double *reactions, double since_s);

// After it: keeps these with what its impulses have added.
void rubs_keep(Rubs *rubs, const double *impulses);
