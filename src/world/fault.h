// What ODE ends the program for, while a step of the library is under way: it becomes an error.
//
// ODE checks its own numbers by assertions, which call a handler (dSetDebugHandler) and then end
// the program. The first world of the library puts a handler of its own there, and the last one
// takes it away. In a step of the library it leaves the step; else it hands on to the handler that
// was there before.
//
// Where ODE has no memory for a body or joint it goes on with a NULL. Handlers of the same kind for
// its allocations, which ask those that were there before, leave the step or whatever else of the
// library is under way.
//
// Messages, such as "LCP internal error", ODE prints and goes on, with forces that are not those
// asked for. In a step of the library they are noted and not printed.
#pragma once

#include <setjmp.h>
#include <stdbool.h>

enum { FAULT_TEXT_SIZE = 128 };

typedef struct Fault {
    jmp_buf left;                  // where to go on
    bool is_of_memory;             // ODE has none
    char text[FAULT_TEXT_SIZE];    // else what it says
    unsigned message_count;        // after which ODE went on
    char message[FAULT_TEXT_SIZE]; // the first of them
    struct Fault *outer;
} Fault;

// A world comes, or goes.
void fault_hold(void);
void fault_release(void);

// Faults of this thread leave to here from now on; and no longer. Of NULL they end the program, as
// those of the caller's own code are to.
void fault_begin(Fault *fault);
void fault_end(const Fault *fault);
Fault *fault_suspend(void);
void fault_resume(Fault *fault);
