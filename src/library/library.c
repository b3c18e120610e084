// Makes the calls of the library: each under a guard, and without a trace where it breaks off.
//
// malloc and the like of all that is linked into the library come here (the linker's --wrap), and
// nobody else's do. What a call takes is noted until it ends; where there is no memory, or an
// assertion fails, the call is left by longjmp and what was noted is given back. Of what ODE took
// the bytes are counted; jansson's and yaml's values are lost.
#include "library/library.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/printable.h"
#include "library/memory.h"

#include <locale.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double SHOWN_EVERY_S = 0.02;

static atomic_size_t lost_calls;
static atomic_size_t lost_bytes;

size_t jp_case_lost(size_t *bytes)
{
    if (bytes != NULL) {
        *bytes = atomic_load(&lost_bytes);
    }
    return atomic_load(&lost_calls);
}

// Errors.

static JpCaseStatus status_of(const Err *err)
{
    switch (err->kind) {
    case ERR_CASE:
        return JP_CASE_ERROR_CASE;
    case ERR_SOLVER:
        return JP_CASE_ERROR_SOLVER;
    case ERR_FILE:
        return JP_CASE_ERROR_FILE;
    case ERR_USAGE:
    case ERR_DIFFERS:
    case ERR_NONE:
        break;
    }
    return err->kind == ERR_NONE ? JP_CASE_ERROR_INTERNAL : JP_CASE_ERROR_USAGE;
}

static JpCaseStatus set_error(JpCaseError *error, JpCaseStatus status, const char *text)
{
    if (error != NULL) {
        error->status = status;
        error->line = error->column = 0;
        snprintf(error->text, sizeof error->text, "%s", text);
    }
    return status;
}

JpCaseStatus library_refuse(JpCaseError *error, const char *sentence)
{
    return set_error(error, JP_CASE_ERROR_USAGE, sentence);
}

JpCaseStatus library_accept(JpCaseError *error)
{
    return set_error(error, JP_CASE_OK, "");
}

// What stands behind a name that a message begins with, as messages show it; NULL where it begins
// otherwise.
static const char *behind_name(const char *message, const char *name)
{
    size_t left = strlen(name);
    while (left > 0) {
        const PrintableCharacter character = printable_character(name, left);
        const bool is_shown = character.escape[0] == '\0';
        const size_t size = is_shown ? character.size : strlen(character.escape);
        if (strncmp(message, is_shown ? name : character.escape, size) != 0) {
            return NULL;
        }
        message += size;
        name += character.size;
        left -= character.size;
    }
    return message;
}

// The place that a message begins with: NAME:LINE:COLUMN, or NAME:LINE.
static void find_place(const char *name, JpCaseError *error)
{
    const char *place = name != NULL ? behind_name(error->text, name) : NULL;
    if (place != NULL && place[0] == ':') {
        int line = 0;
        int column = 0;
        if (sscanf(place + 1, "%d:%d:", &line, &column) >= 1) {
            error->line = line;
            error->column = column;
        }
    }
}

static JpCaseStatus end_with(const LibraryCall *call, const Err *err, JpCaseError *error)
{
    const JpCaseStatus status = set_error(error, status_of(err), err->text);
    if (error != NULL) {
        find_place(call->name, error);
    }
    return status;
}

// Progress.

void library_watch_show(LibraryWatch *watch, double share)
{
    const LibraryCall *call = watch->call;
    const double now_s = clock_now_s();
    Call *current = call_current();
    if (call->progress == NULL || current == NULL || call_is_cancelled() ||
        now_s - watch->shown_s < SHOWN_EVERY_S) {
        return;
    }
    watch->shown_s = now_s;
    // what the callback does is no part of the call
    call_set_current(NULL);
    uselocale(call->callers);
    const int answer = call->progress(watch->doing, share, call->watcher);
    uselocale(current->locale);
    call_set_current(current);
    if (answer != 0) {
        atomic_store(&current->is_cancelled, true);
    }
}

static void show_run(double share, double wall_s, void *context)
{
    (void)wall_s;
    library_watch_show(context, share);
}

RunWatch library_watch(LibraryWatch *watch, const char *doing)
{
    watch->doing = doing;
    return (RunWatch){show_run, watch};
}

// Calls.

static pthread_mutex_t alone = PTHREAD_MUTEX_INITIALIZER;
static _Thread_local bool is_alone_here; // this thread has it

static const char NO_MEMORY[] = "there is no memory for this";

typedef enum CallEnd { CALL_DONE, CALL_FAILED, CALL_LEFT } CallEnd;

static CallEnd make_guarded(const LibraryCall *call, Err *err, const char **mistake)
{
    MemoryGuard guard;
    memory_guard_begin(&guard);
    volatile CallEnd end = CALL_LEFT;
    if (setjmp(guard.left) == 0) {
        end = call->work(call->context, err) ? CALL_DONE : CALL_FAILED;
    }
    *mistake = guard.mistake;
    memory_guard_end(&guard);
    return end;
}

// Lets no other such call be under way. False where one is in this very thread, whose callback
// this is.
static bool begin_alone(const LibraryCall *call)
{
    if (!call->is_alone) {
        return true;
    }
    if (is_alone_here) {
        return false;
    }
    pthread_mutex_lock(&alone);
    is_alone_here = true;
    return true;
}

static void end_alone(const LibraryCall *call)
{
    if (call->is_alone) {
        is_alone_here = false;
        pthread_mutex_unlock(&alone);
    }
}

JpCaseStatus library_call(LibraryCall *call, JpCaseError *error)
{
    Err err = {0};
    const char *mistake = NULL;
    Call own = {.threads = call->threads, .outer = call_current()};
    // numbers have a point, whatever the program's language
    own.locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (own.locale == (locale_t)0) {
        return set_error(error, JP_CASE_ERROR_MEMORY, NO_MEMORY);
    }
    if (!begin_alone(call)) {
        freelocale(own.locale);
        return library_refuse(error, "cases with ode.solver quick run one at a time, and this is "
                                     "the callback of one");
    }
    call->callers = uselocale(own.locale);
    memory_begin(&own);
    call_set_current(&own);
    const CallEnd end = make_guarded(call, &err, &mistake);
    call_set_current(own.outer);
    memory_end(&own, end == CALL_LEFT);
    uselocale(call->callers);
    freelocale(own.locale);
    end_alone(call);
    if (end == CALL_LEFT) {
        atomic_fetch_add(&lost_calls, 1);
        atomic_fetch_add(&lost_bytes, atomic_load(&own.engine_bytes));
        return mistake == NULL ? set_error(error, JP_CASE_ERROR_MEMORY, NO_MEMORY)
                               : set_error(error, JP_CASE_ERROR_INTERNAL, mistake);
    }
    if (atomic_load(&own.is_cancelled)) {
        return set_error(error, JP_CASE_ERROR_CANCELLED, "cancelled by the callback");
    }
    return end == CALL_DONE ? library_accept(error) : end_with(call, &err, error);
}
