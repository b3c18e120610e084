// What happens where ODE finds its own numbers wrong?
//
// ODE's handlers are the process's, worlds may be stepped in several threads, and which step is to
// be left is a matter of the thread. Handlers change under a lock, when worlds come and go.
#include "world/fault.h"

#include <ode/ode.h>
#include <pthread.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

static _Thread_local Fault *innermost;

static struct {
    pthread_mutex_t lock;
    size_t world_count;
    dMessageFunction *debug; // the handlers before
    dMessageFunction *error;
} handlers = {.lock = PTHREAD_MUTEX_INITIALIZER};

// Leaves the step that is under way in this thread, if there is one.
static void leave(const char *message, va_list arguments)
{
    Fault *fault = innermost;
    if (fault != NULL) {
        vsnprintf(fault->text, sizeof fault->text, message, arguments);
        longjmp(fault->left, 1);
    }
}

// Without a handler before, ODE's own says what is wrong and ends the program.
static void on_debug(int number, const char *message, va_list arguments)
{
    leave(message, arguments);
    if (handlers.debug != NULL) {
        handlers.debug(number, message, arguments);
        return;
    }
    char text[FAULT_TEXT_SIZE];
    vsnprintf(text, sizeof text, message, arguments);
    dSetDebugHandler(NULL);
    dDebug(number, "%s", text);
}

static void on_error(int number, const char *message, va_list arguments)
{
    leave(message, arguments);
    if (handlers.error != NULL) {
        handlers.error(number, message, arguments);
        return;
    }
    char text[FAULT_TEXT_SIZE];
    vsnprintf(text, sizeof text, message, arguments);
    dSetErrorHandler(NULL);
    dError(number, "%s", text);
}

void fault_hold(void)
{
    pthread_mutex_lock(&handlers.lock);
    if (handlers.world_count++ == 0) {
        handlers.debug = dGetDebugHandler();
        handlers.error = dGetErrorHandler();
        dSetDebugHandler(on_debug);
        dSetErrorHandler(on_error);
    }
    pthread_mutex_unlock(&handlers.lock);
}

// A handler that came later stays.
void fault_release(void)
{
    pthread_mutex_lock(&handlers.lock);
    if (--handlers.world_count == 0) {
        if (dGetDebugHandler() == on_debug) {
            dSetDebugHandler(handlers.debug);
        }
        if (dGetErrorHandler() == on_error) {
            dSetErrorHandler(handlers.error);
        }
    }
    pthread_mutex_unlock(&handlers.lock);
}

void fault_begin(Fault *fault)
{
    fault->outer = innermost;
    fault->text[0] = '\0';
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
