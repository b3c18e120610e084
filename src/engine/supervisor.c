// Starts another program so that nothing of it outlives the conversation with it.
//
// fork -> the supervisor: a subreaper, to which the system gives every process below it that has
// lost its parent -> fork -> exec. The supervisor waits for signals: of its children, of the
// caller, or of the system when the caller dies. Then it kills its children again and again, for
// the children of those come to it in turn, until there are none.
#define _GNU_SOURCE // close_range
#include "engine/supervisor.h"

#include "base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum {
    END_COUNT = 3,      // standard input, output and error
    NOT_STARTED = 127,  // exit status where there is nothing to run, as a shell has it
    LIST_SIZE = 1 << 12 // bytes of a list of children that are read at a time
};

// s: to kill all, and more for the caller to wait for that. A process that cannot be killed, for it
// belongs to another user or hangs in the kernel, is left then.
static const double SWEEP_S = 2.0;
static const double END_S = 3.0;

static const struct timespec SWEEP_PAUSE = {.tv_nsec = 1000000};

// other than the program's, so that who ends all processes of the program's name leaves it its work
static const char SUPERVISOR_NAME[] = "driver-guard";

// In the child of the supervisor: becomes the program.
static _Noreturn void become(const char *program, const int ends[END_COUNT], pid_t supervisor,
                             const sigset_t *mask)
{
    static const int SIGNALS[] = {SIGABRT, SIGSEGV, SIGFPE, SIGILL,
                                  SIGBUS,  SIGPIPE, SIGINT, SIGTERM};
    for (size_t i = 0; i < sizeof SIGNALS / sizeof SIGNALS[0]; i++) {
        signal(SIGNALS[i], SIG_DFL);
    }
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != supervisor) {
        _exit(NOT_STARTED);
    }
    for (int i = 0; i < END_COUNT; i++) {
        if (dup2(ends[i], i) < 0) {
            _exit(NOT_STARTED);
        }
    }
    sigprocmask(SIG_SETMASK, mask, NULL);
    char *const arguments[] = {(char *)program, NULL};
    execv(program, arguments);
    dprintf(STDERR_FILENO, "cannot be run: %s\n", strerror(errno));
    _exit(NOT_STARTED);
}

// Kills the supervisor's children, as many as one reading of the system's list has; where there is
// no such list, the program's group.
static void kill_children(pid_t program)
{
    char list[LIST_SIZE + 1];
    const int file = open("/proc/thread-self/children", O_RDONLY | O_CLOEXEC);
    const ssize_t size = file >= 0 ? read(file, list, LIST_SIZE) : -1;
    if (file >= 0) {
        close(file);
    }
    if (size < 0) {
        kill(-program, SIGKILL);
        return;
    }
    list[size] = '\0';
    // a number that no blank follows is not whole
    char *end;
    for (char *at = list; *at != '\0'; at = end + 1) {
        const long process = strtol(at, &end, 10);
        if (process <= 0 || *end != ' ') {
            return;
        }
        kill((pid_t)process, SIGKILL);
    }
}

// Takes in what has ended. Returns whether the program was among it, whose status it then writes;
// `is_last` becomes whether no children are left.
static bool reap(pid_t program, int *status, bool *is_last)
{
    bool has_ended = false;
    int how;
    pid_t gone;
    while ((gone = waitpid(-1, &how, WNOHANG)) > 0) {
        if (gone == program) {
            *status = how;
            has_ended = true;
        }
    }
    *is_last = gone < 0;
    return has_ended;
}

static void sweep(pid_t program, int *status, const sigset_t *awaited)
{
    const double stop_s = clock_now_s() + SWEEP_S;
    bool is_last = false;
    reap(program, status, &is_last);
    while (!is_last && clock_now_s() < stop_s) {
        kill_children(program);
        sigtimedwait(awaited, NULL, &SWEEP_PAUSE);
        reap(program, status, &is_last);
    }
}

// Ends this process as another one has ended.
static _Noreturn void end_as(int status)
{
    if (WIFSIGNALED(status)) {
        const int number = WTERMSIG(status);
        sigset_t only;
        sigemptyset(&only);
        sigaddset(&only, number);
        signal(number, SIG_DFL);
        // what there is to look at, the program has left
        prctl(PR_SET_DUMPABLE, 0);
        raise(number);
        sigprocmask(SIG_UNBLOCK, &only, NULL);
    }
    _exit(WEXITSTATUS(status));
}

// Is the supervisor; all signals are blocked.
static _Noreturn void supervise(const char *program, const int ends[END_COUNT], pid_t parent,
                                const sigset_t *mask)
{
    sigset_t awaited;
    sigemptyset(&awaited);
    sigaddset(&awaited, SIGCHLD);
    sigaddset(&awaited, SIGTERM);
    // where the caller ignores it, nobody could be waited for
    signal(SIGCHLD, SIG_DFL);
    setpgid(0, 0);
    prctl(PR_SET_NAME, SUPERVISOR_NAME);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    const pid_t self = getpid();
    const pid_t process = getppid() == parent ? fork() : -1;
    if (process == 0) {
        become(program, ends, self, mask);
    }
    if (process < 0) {
        dprintf(ends[STDERR_FILENO], "cannot be started: %s\n", strerror(errno));
        _exit(NOT_STARTED);
    }
    // none of the caller's files stays open for it, above all not the ends of the conversation
    close_range(0, ~0U, 0);
    int status = 0;
    bool is_last = false;
    int number = SIGCHLD;
    while (number != SIGTERM && !reap(process, &status, &is_last)) {
        number = sigwaitinfo(&awaited, NULL);
    }
    sweep(process, &status, &awaited);
    end_as(status);
}

pid_t supervisor_start(const char *program, const int ends[END_COUNT])
{
    sigset_t all;
    sigset_t mask;
    sigfillset(&all);
    const pid_t parent = getpid();
    // so that no handler of ours takes a signal that the supervisor waits for
    pthread_sigmask(SIG_SETMASK, &all, &mask);
    const pid_t supervisor = fork();
    if (supervisor == 0) {
        supervise(program, ends, parent, &mask);
    }
    const int reason = errno;
    pthread_sigmask(SIG_SETMASK, &mask, NULL);
    errno = reason;
    return supervisor;
}

void supervisor_end(pid_t supervisor)
{
    const double stop_s = clock_now_s() + END_S;
    kill(supervisor, SIGTERM);
    // one that was stopped has to go on for that
    kill(supervisor, SIGCONT);
    pid_t gone;
    while ((gone = waitpid(supervisor, NULL, WNOHANG)) == 0 && clock_now_s() < stop_s) {
        usleep(500);
    }
    if (gone == 0) {
        kill(supervisor, SIGKILL);
        while (waitpid(supervisor, NULL, 0) < 0 && errno == EINTR) {
        }
    }
}
