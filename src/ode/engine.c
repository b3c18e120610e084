// How is an engine that ends the process on its errors kept from ending ours?
//
// ODE calls a handler on an error and exits or aborts when the handler returns. The handlers here
// do not return: they jump back to where the step was called. What they share with that place has
// to be static, for ODE hands them no context; runs that are to go side by side are processes.
#include "ode/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

enum { ENGINE_MESSAGE_SIZE = 256 };

static jmp_buf way_back;
static bool is_stepping = false;
static bool has_complained = false;
static char message[ENGINE_MESSAGE_SIZE];

static void leave(int number, const char *text, va_list arguments)
{
    const int written = snprintf(message, sizeof message, "ODE error %d: ", number);
    if (written > 0 && (size_t)written < sizeof message) {
        vsnprintf(message + written, sizeof message - (size_t)written, text, arguments);
    }
    if (is_stepping) {
        longjmp(way_back, 1);
    }
    fprintf(stderr, "%s\n", message);
    abort();
}

// ODE also reports what it can go on from, such as a failed linear complementarity problem: the
// step's forces are then not to be trusted.
static void note(int number, const char *text, va_list arguments)
{
    has_complained = true;
    const int written = snprintf(message, sizeof message, "ODE message %d: ", number);
    if (written > 0 && (size_t)written < sizeof message) {
        vsnprintf(message + written, sizeof message - (size_t)written, text, arguments);
    }
}

void engine_start(void)
{
    static bool is_started = false;
    if (is_started) {
        return;
    }
    // never closed: after a step that was left, ODE would abort over its unfinished job
    dInitODE2(0);
    dSetErrorHandler(leave);
    dSetDebugHandler(leave);
    dSetMessageHandler(note);
    is_started = true;
}

bool engine_step(dWorldID world, double step_s, bool is_quick, Err *err)
{
    if (setjmp(way_back) != 0) {
        is_stepping = false;
        return err_set(err, ERR_SOLVER, "%s", message);
    }
    is_stepping = true;
    has_complained = false;
    const int status = is_quick ? dWorldQuickStep(world, step_s) : dWorldStep(world, step_s);
    is_stepping = false;
    if (has_complained) {
        return err_set(err, ERR_SOLVER, "%s", message);
    }
    return status != 0 || err_set(err, ERR_SOLVER, "ODE had no memory for the step");
}

void engine_seed(size_t seed)
{
    dRandSetSeed((unsigned long)seed);
}
