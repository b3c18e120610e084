// Starts ODE once in a process, and keeps an engine that ends the process on its errors from ending
// ours.
//
// ODE calls a handler on an error and exits or aborts when the handler returns. In a step the
// handlers here do not return: they jump back to where the step was called. ODE hands them no
// context, so what they share with that step belongs to the thread. An error outside a step leaves
// the guard of the thread (base/memory.h); without one it is left to the handler that was there
// before, or to ODE's own, which reports it and aborts.
//
// The handlers are the process's: in a library they hand on what belongs to worlds of others.
#include "ode/engine.h"

#include "base/call.h"
#include "base/memory.h"

#include <assert.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

enum { ENGINE_MESSAGE_SIZE = 256 };

// The step under way in this thread.
static _Thread_local struct {
    bool is_stepping;
    bool has_complained;
    jmp_buf way_back;
    char message[ENGINE_MESSAGE_SIZE];
} thread;

// What was there before, and whether ODE was started.
static struct {
    pthread_mutex_t lock;
    bool is_started;
    dMessageFunction *error;
    dMessageFunction *debug;
    dMessageFunction *message;
    dAllocFunction *allocate; // NULL: ODE's own, as the two below
    dReallocFunction *reallocate;
    dFreeFunction *release;
} before = {.lock = PTHREAD_MUTEX_INITIALIZER};

static void keep_message(const char *kind, int number, const char *text, va_list arguments)
{
    char words[ENGINE_MESSAGE_SIZE];
    vsnprintf(words, sizeof words, text, arguments);
    snprintf(thread.message, sizeof thread.message, "ODE %s %d: %.200s", kind, number, words);
}

static void leave(dMessageFunction *other, int number, const char *text, va_list arguments)
{
    if (other != NULL && !thread.is_stepping && call_current() == NULL) {
        other(number, text, arguments);
        return;
    }
    keep_message("error", number, text, arguments);
    if (thread.is_stepping) {
        longjmp(thread.way_back, 1);
    }
    if (call_current() != NULL) {
        memory_leave("ODE found an error outside a step");
    }
    dSetDebugHandler(NULL);
    dDebug(number, "%s", thread.message);
}

static void on_error(int number, const char *text, va_list arguments)
{
    leave(before.error, number, text, arguments);
}

static void on_debug(int number, const char *text, va_list arguments)
{
    leave(before.debug, number, text, arguments);
}

// ODE also reports what it can go on from, such as a failed linear complementarity problem: the
// step's forces are then not to be trusted.
static void on_message(int number, const char *text, va_list arguments)
{
    if (before.message != NULL && !thread.is_stepping && call_current() == NULL) {
        before.message(number, text, arguments);
        return;
    }
    thread.has_complained = true;
    keep_message("message", number, text, arguments);
}

// Memory of ODE in a call of the library: it is ODE's, and not among what the call gives back where
// it breaks off; but what ODE keeps of it is counted.

static void engine_count(Call *call, size_t bytes)
{
    if (call != NULL) {
        atomic_fetch_add_explicit(&call->engine_bytes, bytes, memory_order_relaxed);
    }
}

static void *on_allocate(size_t size)
{
    Call *call = call_current();
    call_set_current(NULL);
    void *made = before.allocate != NULL ? before.allocate(size) : malloc(size);
    call_set_current(call);
    if (made == NULL && call != NULL) {
        memory_leave(NULL);
    }
    engine_count(call, size);
    return made;
}

static void *on_reallocate(void *old, size_t old_size, size_t size)
{
    Call *call = call_current();
    call_set_current(NULL);
    void *made =
        before.reallocate != NULL ? before.reallocate(old, old_size, size) : realloc(old, size);
    call_set_current(call);
    if (made == NULL && call != NULL) {
        memory_leave(NULL);
    }
    engine_count(call, size - old_size);
    return made;
}

static void on_release(void *old, size_t size)
{
    Call *call = call_current();
    call_set_current(NULL);
    if (before.release != NULL) {
        before.release(old, size);
    } else {
        free(old);
    }
    call_set_current(call);
    engine_count(call, old != NULL ? (size_t)0 - size : 0);
}

// Handlers that came since the last run are handed on to, too.
static void take_over(bool is_call)
{
    if (dGetErrorHandler() != on_error) {
        before.error = dGetErrorHandler();
        dSetErrorHandler(on_error);
    }
    if (dGetDebugHandler() != on_debug) {
        before.debug = dGetDebugHandler();
        dSetDebugHandler(on_debug);
    }
    if (dGetMessageHandler() != on_message) {
        before.message = dGetMessageHandler();
        dSetMessageHandler(on_message);
    }
    // the program ends where there is no memory, and needs no handler for it
    if (is_call && dGetAllocHandler() != on_allocate) {
        before.allocate = dGetAllocHandler();
        before.reallocate = dGetReallocHandler();
        before.release = dGetFreeHandler();
        dSetAllocHandler(on_allocate);
        dSetReallocHandler(on_reallocate);
        dSetFreeHandler(on_release);
    }
}

void engine_start(void)
{
    Call *call = call_current();
    pthread_mutex_lock(&before.lock);
    const bool is_call = call != NULL;
    // nothing leaves the call as long as the lock is held
    call_set_current(NULL);
    if (!before.is_started) {
        // never closed: after a step that was left, ODE would abort over its unfinished job
        dInitODE2(0);
        before.is_started = true;
    }
    // what ODE keeps for each thread; at once where it has it
    const int has_data = dAllocateODEDataForThread(dAllocateMaskAll);
    take_over(is_call);
    call_set_current(call);
    pthread_mutex_unlock(&before.lock);
    if (has_data == 0) {
        memory_leave(NULL);
    }
    assert(has_data != 0);
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
