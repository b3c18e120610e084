// Takes the place of malloc in the program, so that a refusal ends it in one way.
//
// Hundreds of places ask for memory, in the C library and in ODE, SQLite and others as well, and
// most have nothing to fall back on: one that went on without would give a result that lacks
// something. What is written meanwhile is taken away, as on a signal, and the exit status is that
// of a run that failed. Child processes end by a status that their parent knows (measure/child.c).
//
// A sanitizer has a malloc of its own and is left alone.
#include "cli/no_memory.h"

#include "base/err.h"
#include "base/memory.h"
#include "measure/child.h"
#include "write/file.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum {
    WORDS_SIZE = 256,
    STACK_SIZE = 1 << 16,    // for the handler, where the stack itself could not grow
    LITTLE_MEMORY = 1 << 20, // bytes: what a process that lacks memory cannot have
    SHOWN_LEAST = 1 << 20,   // bytes: less says nothing of how much is lacking
    UNKNOWN = 0,             // bytes: of a refusal that is only seen by its consequence
};

// Says it without asking for memory.
static _Noreturn void end_without_memory(size_t bytes)
{
    static atomic_flag is_ending = ATOMIC_FLAG_INIT;
    while (atomic_flag_test_and_set(&is_ending)) {
        // another thread is at it, and ends this one as well
        pause();
    }
    char words[WORDS_SIZE];
    char wanted[WORDS_SIZE / 2] = "more";
    if (bytes >= SHOWN_LEAST) {
        snprintf(wanted, sizeof wanted, "%.3g MB more", 1e-6 * (double)bytes);
    }
    const int length =
        snprintf(words, sizeof words,
                 "%sjointplay: there is no memory for this, %s would be needed; raise the limit "
                 "(ulimit -v) or ask for less: fewer samples, parts or --jobs\n",
                 isatty(STDERR_FILENO) ? "\r\033[K" : "", wanted);
    file_take_away_pending();
    const ssize_t written = write(STDERR_FILENO, words, (size_t)length);
    (void)written;
    _exit(ERR_SOLVER);
}

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) ||                         \
    __has_feature(thread_sanitizer)
#define HAS_OWN_MALLOC 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_OWN_MALLOC 1
#endif

#ifndef HAS_OWN_MALLOC

// A stack that cannot grow ends a process by a signal.
static void end_by_signal(int number)
{
    if (child_is_refused(LITTLE_MEMORY)) {
        end_without_memory(UNKNOWN);
    }
    signal(number, SIG_DFL);
    raise(number);
}

static void watch_stack(void)
{
    static char stack[STACK_SIZE];
    const stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    struct sigaction action = {.sa_handler = end_by_signal, .sa_flags = SA_ONSTACK};
    sigemptyset(&action.sa_mask);
    if (sigaltstack(&other, NULL) == 0) {
        sigaction(SIGSEGV, &action, NULL);
        sigaction(SIGBUS, &action, NULL);
    }
}

// those of the C library, under the names that it has for programs that replace them
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static void *made_or_refused(void *made, size_t bytes)
{
    if (made == NULL && bytes > 0) {
        memory_refuse(bytes);
        errno = ENOMEM;
    }
    return made;
}

void *malloc(size_t size)
{
    return made_or_refused(__libc_malloc(size), size);
}

void *calloc(size_t count, size_t size)
{
    const bool is_countable = size == 0 || count <= SIZE_MAX / size;
    return made_or_refused(__libc_calloc(count, size), is_countable ? count * size : SIZE_MAX);
}

void *realloc(void *old, size_t size)
{
    return made_or_refused(__libc_realloc(old, size), size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return made_or_refused(__libc_memalign(alignment, size), size);
}

int posix_memalign(void **target, size_t alignment, size_t size)
{
    void *made = made_or_refused(__libc_memalign(alignment, size), size);
    if (made == NULL && size > 0) {
        return ENOMEM;
    }
    *target = made;
    return 0;
}

#endif

void no_memory_begin(void)
{
    memory_end_by(end_without_memory);
#ifndef HAS_OWN_MALLOC
    watch_stack();
#endif
}
