// How does the next process begin the moment the one before it is done?
//
// Each slot is a byte of a file in memory, locked by the process that works: the lock ends with the
// process, however it ends. The time limit counts from the moment the lock is taken; the system's
// timer measures it, because the parent cannot know that moment.
#define _GNU_SOURCE // memfd_create

#include "commands/study/slot.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <unistd.h>

int slot_open(void)
{
    return memfd_create("slots", MFD_CLOEXEC);
}

void slot_close(int slots)
{
    if (slots >= 0) {
        close(slots);
    }
}

static void lock(int slots, size_t slot, short kind)
{
    struct flock what = {.l_type = kind, .l_whence = SEEK_SET, .l_start = (off_t)slot, .l_len = 1};
    while (slots >= 0 && fcntl(slots, F_SETLKW, &what) != 0 && errno == EINTR) {
    }
}

// The longest that the system's timer is asked for, s: some thirty years.
static const double LIMIT_MAX = 1e9;

static void set_timer(double limit_s)
{
    const double most = fmin(limit_s, LIMIT_MAX);
    const double whole = floor(most);
    struct itimerval timer = {.it_value = {(time_t)whole, (suseconds_t)(1e6 * (most - whole))}};
    // all zeroes would turn it off
    timer.it_value.tv_usec += most < 1e-6 ? 1 : 0;
    signal(SIGALRM, SIG_DFL);
    setitimer(ITIMER_REAL, &timer, NULL);
}

void slot_enter(int slots, size_t slot, double limit_s)
{
    lock(slots, slot, F_WRLCK);
    if (limit_s > 0.0) {
        set_timer(limit_s);
    }
}

void slot_leave(int slots, size_t slot)
{
    const struct itimerval never = {0};
    setitimer(ITIMER_REAL, &never, NULL);
    lock(slots, slot, F_UNLCK);
}
