// Turns what ODE finds wrong in its own numbers into a status.
//
// ODE's handlers are the process's, worlds may be stepped in several threads, and which step is to
// be left is a matter of the thread. Handlers change under a lock, when worlds come and go.
#include "world/fault.h"

#include <ode/ode.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

static _Thread_local Fault *innermost;

typedef enum Kind {
    KIND_DEBUG,   // an assertion; without a handler ODE ends the program
    KIND_ERROR,   // likewise
    KIND_MESSAGE, // without a handler ODE prints it and goes on
    KIND_COUNT
} Kind;

static struct {
    pthread_mutex_t lock;
    size_t world_count;
    dMessageFunction *before[KIND_COUNT];
    dAllocFunction *allocate_before; // NULL: ODE's own
    dReallocFunction *reallocate_before;
} handlers = {.lock = PTHREAD_MUTEX_INITIALIZER};

// Leaves the step that is under way in this thread, or notes the message in it. Returns whether
// there is one.
static bool take(Kind kind, const char *message, va_list arguments)
{
    Fault *fault = innermost;
    if (fault == NULL) {
        return false;
    }
    if (kind == KIND_MESSAGE) {
        if (fault->message_count++ == 0) {
            vsnprintf(fault->message, sizeof fault->message, message, arguments);
        }
        return true;
    }
    vsnprintf(fault->text, sizeof fault->text, message, arguments);
    longjmp(fault->left, 1);
}

static void on_message(int number, const char *message, va_list arguments);

// What ODE does where there is no handler: for what it says without one it is asked to say it.
static void do_as_ode(Kind kind, int number, const char *message, va_list arguments)
{
    char text[FAULT_TEXT_SIZE];
    vsnprintf(text, sizeof text, message, arguments);
    switch (kind) {
    case KIND_DEBUG:
        dSetDebugHandler(NULL);
        dDebug(number, "%s", text);
        break;
    case KIND_ERROR:
        dSetErrorHandler(NULL);
        dError(number, "%s", text);
        break;
    default:
        dSetMessageHandler(NULL);
        dMessage(number, "%s", text);
        dSetMessageHandler(on_message);
    }
}

static void handle(Kind kind, int number, const char *message, va_list arguments)
{
    if (take(kind, message, arguments)) {
        return;
    }
    if (handlers.before[kind] != NULL) {
        handlers.before[kind](number, message, arguments);
    } else {
        do_as_ode(kind, number, message, arguments);
    }
}

static void on_debug(int number, const char *message, va_list arguments)
{
    handle(KIND_DEBUG, number, message, arguments);
}

static void on_error(int number, const char *message, va_list arguments)
{
    handle(KIND_ERROR, number, message, arguments);
}

static void on_message(int number, const char *message, va_list arguments)
{
    handle(KIND_MESSAGE, number, message, arguments);
}

// Memory that ODE has asked for.
static void *present(void *made)
{
    if (made == NULL && innermost != NULL) {
        innermost->is_of_memory = true;
        longjmp(innermost->left, 1);
    }
    return made;
}

static void *on_allocate(size_t size)
{
    return present(handlers.allocate_before != NULL ? handlers.allocate_before(size)
                                                    : malloc(size));
}

static void *on_reallocate(void *old, size_t old_size, size_t size)
{
    return present(handlers.reallocate_before != NULL
                       ? handlers.reallocate_before(old, old_size, size)
                       : realloc(old, size));
}

static const struct {
    dMessageFunction *(*get)(void);
    void (*set)(dMessageFunction *handler);
    dMessageFunction *own;
} KINDS[KIND_COUNT] = {
    [KIND_DEBUG] = {dGetDebugHandler, dSetDebugHandler, on_debug},
    [KIND_ERROR] = {dGetErrorHandler, dSetErrorHandler, on_error},
    [KIND_MESSAGE] = {dGetMessageHandler, dSetMessageHandler, on_message},
};

void fault_hold(void)
{
    pthread_mutex_lock(&handlers.lock);
    if (handlers.world_count++ == 0) {
        for (int kind = 0; kind < KIND_COUNT; kind++) {
            handlers.before[kind] = KINDS[kind].get();
            KINDS[kind].set(KINDS[kind].own);
        }
        handlers.allocate_before = dGetAllocHandler();
        handlers.reallocate_before = dGetReallocHandler();
        dSetAllocHandler(on_allocate);
        dSetReallocHandler(on_reallocate);
    }
    pthread_mutex_unlock(&handlers.lock);
}

// A handler that came later stays.
void fault_release(void)
{
    pthread_mutex_lock(&handlers.lock);
    if (--handlers.world_count == 0) {
        for (int kind = 0; kind < KIND_COUNT; kind++) {
            if (KINDS[kind].get() == KINDS[kind].own) {
                KINDS[kind].set(handlers.before[kind]);
            }
        }
        if (dGetAllocHandler() == on_allocate) {
            dSetAllocHandler(handlers.allocate_before);
        }
        if (dGetReallocHandler() == on_reallocate) {
            dSetReallocHandler(handlers.reallocate_before);
        }
    }
    pthread_mutex_unlock(&handlers.lock);
}

void fault_begin(Fault *fault)
{
    fault->outer = innermost;
    fault->is_of_memory = false;
    fault->text[0] = fault->message[0] = '\0';
    fault->message_count = 0;
    innermost = fault;
}

void fault_end(const Fault *fault)
{
    innermost = fault->outer;
}

Fault *fault_suspend(void)
{
    Fault *suspended = innermost;
    innermost = NULL;
    return suspended;
}

void fault_resume(Fault *fault)
{
    innermost = fault;
}
