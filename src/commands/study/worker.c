// Worker slots, and the captured output of a worker process.
#define _GNU_SOURCE // memfd_create

#include "commands/study/worker.h"
#include "base/printable.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

// Each slot lets the next process start at once when the one before it is done.
//
// Each slot is a byte of a file in memory, locked by the process that works: the lock ends with the
// process, however it ends. The time limit counts from the moment the lock is taken; the system's
// timer measures it, because the parent cannot know that moment.

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

static void worker_lock(int slots, size_t slot, short kind)
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

void slot_limit_again(double limit_s)
{
    if (limit_s > 0.0) {
        set_timer(limit_s);
    }
}

void slot_enter(int slots, size_t slot, double limit_s)
{
    worker_lock(slots, slot, F_WRLCK);
    slot_limit_again(limit_s);
}

void slot_leave(int slots, size_t slot)
{
    const struct itimerval never = {0};
    setitimer(ITIMER_REAL, &never, NULL);
    worker_lock(slots, slot, F_UNLCK);
}

// The last message of a dying process is kept, and kept off the terminal.
//
// Both streams go to a file in memory of limited size; what is written beyond it is dropped.

enum {
    KEPT_MAX = 1 << 18, // bytes of one child: some thousand lines; later ones are dropped
    TAIL_SIZE = 1024,   // bytes in which the last line is looked for
};

int last_words_open(void)
{
    const int file = memfd_create("last words", MFD_CLOEXEC);
    // parent and child share one position: each write goes to the end
    if (file >= 0) {
        fcntl(file, F_SETFL, O_APPEND);
    }
    return file;
}

void last_words_close(int file)
{
    if (file >= 0) {
        close(file);
    }
}

void last_words_clear(int file)
{
    if (file >= 0 && ftruncate(file, 0) != 0) {
        // the message of one child is then taken for another's, which is no reason to stop
        return;
    }
}

void last_words_listen(int file)
{
    const int target = file >= 0 ? file : open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(target, STDOUT_FILENO);
    dup2(target, STDERR_FILENO);
    // a write beyond the limit then fails, and ends no one
    const struct rlimit most = {KEPT_MAX, KEPT_MAX};
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &most);
}

void last_words_read(int file, char *line, size_t size)
{
    char tail[TAIL_SIZE + 1];
    struct stat known;
    line[0] = '\0';
    if (file < 0 || fstat(file, &known) != 0) {
        return;
    }
    const off_t from = known.st_size > TAIL_SIZE ? known.st_size - TAIL_SIZE : 0;
    const ssize_t count = pread(file, tail, TAIL_SIZE, from);
    size_t end = count > 0 ? (size_t)count : 0;
    while (end > 0 && isspace((unsigned char)tail[end - 1])) {
        end--;
    }
    size_t start = end;
    while (start > 0 && tail[start - 1] != '\n') {
        start--;
    }
    tail[end] = '\0';
    for (size_t i = start; i < end; i++) {
        tail[i] = (char)(tail[i] >= ' ' && tail[i] <= '~' ? tail[i] : '?');
    }
    shorten_copy(line, size, tail + start);
}
