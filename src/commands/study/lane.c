// How does the next process begin the moment the one before it is done?
//
// Each lane is a byte of a file in memory, and who works holds the lock on it: a lock of the
// process, which ends with it however that comes about. The clock of the limit runs from when the
// lock was had; the system keeps it, for the parent cannot know that moment.
#define _GNU_SOURCE // memfd_create

#include "commands/study/lane.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <unistd.h>

int lane_open(void)
{
    return memfd_create("lanes", MFD_CLOEXEC);
}

void lane_close(int lanes)
{
    if (lanes >= 0) {
        close(lanes);
    }
}

static void lock(int lanes, size_t lane, short kind)
{
    struct flock what = {.l_type = kind, .l_whence = SEEK_SET, .l_start = (off_t)lane, .l_len = 1};
    while (lanes >= 0 && fcntl(lanes, F_SETLKW, &what) != 0 && errno == EINTR) {
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

void lane_enter(int lanes, size_t lane, double limit_s)
{
    lock(lanes, lane, F_WRLCK);
    if (limit_s > 0.0) {
        set_timer(limit_s);
    }
}

void lane_leave(int lanes, size_t lane)
{
    const struct itimerval never = {0};
    setitimer(ITIMER_REAL, &never, NULL);
    lock(lanes, lane, F_UNLCK);
}
