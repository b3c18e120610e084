// Refuses memory to the program from the N-th piece on, N in FAILING_MEMORY: loaded before it, in
// place of what its own malloc asks (src/cli/no_memory.c).
#include <errno.h>
#include <malloc.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void *__libc_memalign(size_t alignment, size_t size);
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);

enum { ALIGNMENT = 16 };

static long asked;

static void *make(size_t size)
{
    static long first_refused = -1;
    if (first_refused < 0) {
        const char *words = getenv("FAILING_MEMORY");
        first_refused = words != NULL ? strtol(words, NULL, 10) : 0;
    }
    if (first_refused > 0 && ++asked >= first_refused) {
        errno = ENOMEM;
        return NULL;
    }
    return __libc_memalign(ALIGNMENT, size);
}

void *__libc_malloc(size_t size)
{
    return make(size);
}

void *__libc_calloc(size_t count, size_t size)
{
    if (size > 0 && count > SIZE_MAX / size) {
        return NULL;
    }
    void *made = make(count * size);
    return made != NULL ? memset(made, 0, count * size) : NULL;
}

void *__libc_realloc(void *old, size_t size)
{
    void *made = make(size);
    if (made != NULL && old != NULL) {
        const size_t former = malloc_usable_size(old);
        memcpy(made, old, former < size ? former : size);
        free(old);
    }
    return made;
}
