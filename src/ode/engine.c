// Starts ODE once in a process, and keeps an engine that ends the process on its errors from ending
// ours.
//
// ODE calls a handler on an error and exits or aborts when the handler returns. In a step the
// handlers here do not return: they jump back to where the step was called. ODE hands them no
// context, so what they share with that step belongs to the thread. An error outside a step is left
// to ODE's own handler, which reports it and aborts.
#include "ode/engine.h"

#include <assert.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <threads.h>

enum { ENGINE_MESSAGE_SIZE = 256 };

// The step under way in this thread.
static _Thread_local struct {
    bool is_stepping;
    bool has_complained;
    jmp_buf way_back;
    char message[ENGINE_MESSAGE_SIZE];
} thread;

static void keep_message(const char *kind, int number, const char *text, va_list arguments)
{
    char words[ENGINE_MESSAGE_SIZE];
    vsnprintf(words, sizeof words, text, arguments);
    snprintf(thread.message, sizeof thread.message, "ODE %s %d: %.200s", kind, number, words);
}

static void leave(int number, const char *text, va_list arguments)
{
    keep_message("error", number, text, arguments);
    if (thread.is_stepping) {
        longjmp(thread.way_back, 1);
    }
    dSetDebugHandler(NULL);
    dDebug(number, "%s", thread.message);
}

// ODE also reports what it can go on from, such as a failed linear complementarity problem: the
// step's forces are then not to be trusted.
static void note(int number, const char *text, va_list arguments)
{
    thread.has_complained = true;
    keep_message("message", number, text, arguments);
}

static void start(void)
{
    // never closed: after a step that was left, ODE would abort over its unfinished job
    dInitODE2(0);
    dSetErrorHandler(leave);
    dSetDebugHandler(leave);
    dSetMessageHandler(note);
}

void engine_start(void)
{
    static once_flag started = ONCE_FLAG_INIT;
    call_once(&started, start);
    // what ODE keeps for each thread; at once where it has it
    const int has_data = dAllocateODEDataForThread(dAllocateMaskAll);
    assert(has_data != 0);
    (void)has_data;
}

bool engine_step(dWorldID world, double step_s, bool is_quick, Err *err)
{
    if (setjmp(thread.way_back) != 0) {
        thread.is_stepping = false;
        return err_set(err, ERR_SOLVER, "%s", thread.message);
    }
    thread.is_stepping = true;
    thread.has_complained = false;
    const int status = is_quick ? dWorldQuickStep(world, step_s) : dWorldStep(world, step_s);
    thread.is_stepping = false;
    if (thread.has_complained) {
        return err_set(err, ERR_SOLVER, "%s", thread.message);
    }
    return status != 0 ||
           err_set(err, ERR_SOLVER, "ODE could not allocate the memory for the step");
}

void engine_seed(size_t seed)
{
    dRandSetSeed((unsigned long)seed);
}

// Put in by its functions a turn is scaled to size one again, which may move its last bit. What its
// getters point to is the body's own: it is written there, once these have told the geoms.
void engine_carry_body(dBodyID body, Carry *carry)
{
    dReal *const position = (dReal *)dBodyGetPosition(body);
    dReal *const turn = (dReal *)dBodyGetQuaternion(body);
    dReal *const matrix = (dReal *)dBodyGetRotation(body);
    if (carry->is_back) {
        dBodySetPosition(body, position[0], position[1], position[2]);
        dBodySetQuaternion(body, turn);
    }
    CARRY_ARRAY(carry, position, 3);
    CARRY_ARRAY(carry, turn, 4);
    CARRY_ARRAY(carry, matrix, 12);
    CARRY_ARRAY(carry, (dReal *)dBodyGetLinearVel(body), 3);
    CARRY_ARRAY(carry, (dReal *)dBodyGetAngularVel(body), 3);
}
