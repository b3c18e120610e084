// What a call of the library of cases carries with it through all threads of its work. The program
// has no call.
#pragma once

#include <locale.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct Call {
    atomic_bool is_cancelled;   // asked by whoever called
    size_t threads;             // at a time; 0: as many as there are processors
    atomic_size_t engine_bytes; // that ODE asked for in it and did not give back
    locale_t locale;            // of all its threads, in which a point is a point
    void *blocks;               // of its owner: the memory that it took
    struct Call *outer;         // that it was made within, as by a callback; NULL: none
} Call;

// The call that the thread works for, or NULL.
Call *call_current(void);

// Lets the thread work for a call, or for none; in `side_by_side` that of whoever asked.
void call_set_current(Call *call);

// Whether its work is to end: what steps in time asks now and then, and then fails.
bool call_is_cancelled(void);

// What a run that ended so says.
extern const char CALL_CANCELLED[];
