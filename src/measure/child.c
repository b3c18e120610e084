// Runs pieces of work in child processes, which may crash, hang or run out of memory.
//
// fork -> limits -> work -> the result through a socket -> _exit. The parent reads until the
// socket is closed and then asks how the child ended. A worker sends its result, waits for the next
// order on the same socket, and goes on until its parent closes it.
#include "measure/child.h"
#include "base/clock.h"
#include "base/memory.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    WATCHED_MAX = 512, // children at a time: two for each core of large machines
    NO_MEMORY = 113,   // exit status of a child that exceeded its limit of memory
    LEAVING_MS = 500,  // for a process whose socket is closed to be gone; it takes some 0.1
};

// some libraries go on after a refused allocation until nothing is left at all
static const size_t LITTLE_MEMORY = (size_t)16 << 20;

// the sanitizer's shadow lies in terabytes of address space, which no limit would let it have
#if defined(__SANITIZE_ADDRESS__)
const bool CHILD_CAN_LIMIT_MEMORY = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
const bool CHILD_CAN_LIMIT_MEMORY = false;
#else
const bool CHILD_CAN_LIMIT_MEMORY = true;
#endif
#else
const bool CHILD_CAN_LIMIT_MEMORY = true;
#endif

// A limit, or that of this process where it is lower.
static rlim_t lower_limit(__rlimit_resource_t resource, size_t most)
{
    struct rlimit known;
    const bool is_known = getrlimit(resource, &known) == 0;
    return is_known && known.rlim_cur < (rlim_t)most ? known.rlim_cur : (rlim_t)most;
}

static void limit(__rlimit_resource_t resource, size_t most)
{
    const rlim_t least = lower_limit(resource, most);
    const struct rlimit both = {least, least};
    setrlimit(resource, &both);
}

bool child_is_refused(size_t bytes)
{
    void *room = mmap(NULL, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (room == MAP_FAILED) {
        return true;
    }
    munmap(room, bytes);
    return false;
}

bool child_lacks_memory(void)
{
    return errno == ENOMEM || child_is_refused(LITTLE_MEMORY);
}

// Without memory a process aborts, or writes to an address that it was not given.
static void die(int number)
{
    if (child_lacks_memory()) {
        _exit(NO_MEMORY);
    }
    signal(number, SIG_DFL);
    raise(number);
}

static void limit_memory(size_t most)
{
    limit(RLIMIT_AS, most);
    signal(SIGABRT, die);
    signal(SIGSEGV, die);
    signal(SIGBUS, die);
}

static void end_without_memory(size_t bytes)
{
    (void)bytes;
    _exit(NO_MEMORY);
}

// Restores the default signals, and ends the child with its parent.
static void settle_in(pid_t parent, ChildLimits limits)
{
    static const int SIGNALS[] = {SIGABRT, SIGSEGV, SIGFPE, SIGILL, SIGBUS};
    for (size_t i = 0; i < sizeof SIGNALS / sizeof SIGNALS[0]; i++) {
        signal(SIGNALS[i], SIG_DFL);
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) {
        _exit(1);
    }
    limit(RLIMIT_CORE, 0);
    memory_end_by(end_without_memory);
    if (limits.memory_bytes > 0 && CHILD_CAN_LIMIT_MEMORY) {
        limit_memory(limits.memory_bytes);
    }
}

// What a child is to do, as it knows it from its parent.
typedef struct Job {
    ChildWork work;
    const void *context;
    size_t order_size; // 0: there is no other
    size_t result_size;
} Job;

static void send_result(int channel, const char *result, size_t size)
{
    for (size_t sent = 0; sent < size;) {
        const ssize_t count = send(channel, result + sent, size - sent, MSG_NOSIGNAL);
        if (count < 0 && errno != EINTR) {
            _exit(1);
        }
        sent += count > 0 ? (size_t)count : 0;
    }
}

// False where the parent has closed its end, and wants nothing more.
static bool await_order(int channel, char *order, size_t size)
{
    size_t received = 0;
    while (received < size) {
        const ssize_t count = recv(channel, order + received, size - received, 0);
        if (count == 0 || (count < 0 && errno != EINTR)) {
            return false;
        }
        received += count > 0 ? (size_t)count : 0;
    }
    return size > 0;
}

static _Noreturn void live(const Job *job, int channel)
{
    char *result = malloc(job->result_size);
    char *order = malloc(job->order_size + 1);
    if (result == NULL || order == NULL) {
        _exit(NO_MEMORY);
    }
    const void *context = job->context;
    do {
        memset(result, 0, job->result_size);
        errno = 0;
        job->work(context, result);
        send_result(channel, result, job->result_size);
        context = order;
    } while (await_order(channel, order, job->order_size));
    // _exit: the parent's buffers are not written a second time
    _exit(0);
}

static bool start(Child *child, const Job *job, void *result, ChildLimits limits, Err *err)
{
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        return err_set(err, ERR_SOLVER, "cannot start a child process: %s", strerror(errno));
    }
    const pid_t parent = getpid();
    const pid_t process = fork();
    if (process < 0) {
        const int reason = errno;
        close(ends[0]);
        close(ends[1]);
        return err_set(err, ERR_SOLVER, "cannot start a child process: %s", strerror(reason));
    }
    if (process == 0) {
        close(ends[0]);
        settle_in(parent, limits);
        live(job, ends[1]);
    }
    close(ends[1]);
    *child = (Child){
        .end = CHILD_RUNNING,
        .process = process,
        .channel = ends[0],
        .order_size = job->order_size,
        .result = result,
        .result_size = job->result_size,
        .started_s = clock_now_s(),
        .limits = limits,
    };
    return true;
}

bool child_start(Child *child, ChildWork work, const void *context, void *result,
                 size_t result_size, ChildLimits limits, Err *err)
{
    const Job job = {.work = work, .context = context, .result_size = result_size};
    return start(child, &job, result, limits, err);
}

bool child_start_worker(Child *child, ChildWork work, const void *context, size_t context_size,
                        void *result, size_t result_size, ChildLimits limits, Err *err)
{
    const Job job = {work, context, context_size, result_size};
    return start(child, &job, result, limits, err);
}

bool child_is_at_rest(const Child *child)
{
    return child->end == CHILD_DONE && child->process > 0;
}

bool child_order(Child *child, const void *context)
{
    assert(child_is_at_rest(child));
    // a resting worker has read all it was sent, so that there is room for the whole order
    const ssize_t sent = send(child->channel, context, child->order_size, MSG_NOSIGNAL);
    if (sent != (ssize_t)child->order_size) {
        child_kill(child);
        return false;
    }
    child->end = CHILD_RUNNING;
    child->received = 0;
    child->started_s = clock_now_s();
    return true;
}

// Whether a process is gone, or is so within a moment. Where the kernel cannot be asked it is
// taken to be.
static bool child_is_leaving(pid_t process)
{
    const int handle = pidfd_open(process, 0);
    if (handle < 0) {
        return true;
    }
    struct pollfd watched = {.fd = handle, .events = POLLIN};
    int ready;
    while ((ready = poll(&watched, 1, LEAVING_MS)) < 0 && errno == EINTR) {
    }
    close(handle);
    return ready != 0;
}

// Collects how a process ended that is gone or about to be.
static void bury(Child *child)
{
    int status = 0;
    close(child->channel);
    while (waitpid(child->process, &status, 0) < 0 && errno == EINTR) {
    }
    child->process = 0;
    if (WIFSIGNALED(status)) {
        child->end = CHILD_SIGNALLED;
        child->code = WTERMSIG(status);
        return;
    }
    child->code = WEXITSTATUS(status);
    const bool is_whole = child->code == 0 && child->received == child->result_size;
    const ChildEnd without = child->code == NO_MEMORY ? CHILD_NO_MEMORY : CHILD_EXITED;
    child->end = is_whole ? CHILD_DONE : without;
}

// The socket is closed: the process is ending, or something in it went wrong. With the whole result
// here there is nothing left that could: a busy machine has not let the process end yet.
static void see_off(Child *child)
{
    if (child_is_leaving(child->process)) {
        bury(child);
    } else {
        child_kill(child);
        child->end = child->received == child->result_size ? CHILD_DONE : CHILD_CLOSED;
    }
}

static void receive(Child *child)
{
    char nothing;
    const size_t wanted = child->result_size - child->received;
    char *target = wanted > 0 ? child->result + child->received : &nothing;
    const ssize_t count = read(child->channel, target, wanted > 0 ? wanted : 1);
    if (count > 0) {
        child->received += (size_t)count;
        const bool is_worker = child->order_size > 0;
        child->end = is_worker && child->received == child->result_size ? CHILD_DONE : child->end;
    } else if (count == 0 || errno != EINTR) {
        see_off(child);
    }
}

static bool is_running(const Child *child)
{
    return child->end == CHILD_RUNNING && child->process > 0;
}

static double child_time_left(const Child *child, double clock_s)
{
    const double limit_s = child->limits.time_s;
    return limit_s > 0.0 ? child->started_s + limit_s - clock_s : INFINITY;
}

// Waits for something to read once. True where a child has ended, or none is running.
static bool wait_once(Child *children, size_t count, double wait_s)
{
    struct pollfd watched[WATCHED_MAX];
    Child *owners[WATCHED_MAX];
    nfds_t watched_count = 0;
    for (size_t i = 0; i < count; i++) {
        if (is_running(&children[i])) {
            assert(watched_count < WATCHED_MAX);
            owners[watched_count] = &children[i];
            watched[watched_count++] = (struct pollfd){.fd = children[i].channel, .events = POLLIN};
            wait_s = fmin(wait_s, child_time_left(&children[i], clock_now_s()));
        }
    }
    if (watched_count == 0) {
        return true;
    }
    const int ready = poll(watched, watched_count, (int)ceil(1e3 * fmax(wait_s, 0.0)));
    bool has_ended = false;
    for (nfds_t i = 0; i < watched_count; i++) {
        if (ready > 0 && watched[i].revents != 0) {
            receive(owners[i]);
        }
        if (is_running(owners[i]) && child_time_left(owners[i], clock_now_s()) <= 0.0) {
            child_kill(owners[i]);
            owners[i]->end = CHILD_TIMED_OUT;
        }
        has_ended = has_ended || !is_running(owners[i]);
    }
    return has_ended;
}

void child_wait(Child *children, size_t count, double wait_s)
{
    const double stop_s = clock_now_s() + wait_s;
    while (!wait_once(children, count, stop_s - clock_now_s()) && clock_now_s() < stop_s) {
    }
}

void child_kill(Child *child)
{
    if (child->process > 0) {
        kill(child->process, SIGKILL);
        bury(child);
    }
}

void child_describe(const Child *child, char text[CHILD_TEXT_SIZE])
{
    switch (child->end) {
    case CHILD_RUNNING:
        snprintf(text, CHILD_TEXT_SIZE, "still running");
        break;
    case CHILD_DONE:
        snprintf(text, CHILD_TEXT_SIZE, "done");
        break;
    case CHILD_EXITED:
        snprintf(text, CHILD_TEXT_SIZE, "ended with status %d and no result", child->code);
        break;
    case CHILD_SIGNALLED:
        snprintf(text, CHILD_TEXT_SIZE, "ended by signal %d (%s)", child->code,
                 strsignal(child->code));
        break;
    case CHILD_TIMED_OUT:
        snprintf(text, CHILD_TEXT_SIZE, "took longer than its limit of %.4g s",
                 child->limits.time_s);
        break;
    case CHILD_NO_MEMORY:
        snprintf(text, CHILD_TEXT_SIZE, "wanted more than its limit of %.4g MB of memory",
                 1e-6 * (double)lower_limit(RLIMIT_AS, child->limits.memory_bytes));
        break;
    case CHILD_CLOSED:
        snprintf(text, CHILD_TEXT_SIZE, "closed its pipe without a result and went on");
        break;
    }
}

// Independent pieces of work at a time.
//
// fill the free slots -> wait -> take in what has ended.

static const double PAUSE_S = 0.2; // between two calls of `wait`

// A process at work, by slot.
typedef struct Slot {
    bool is_busy;
    size_t number; // of its piece
    void *result;  // owned
} Slot;

typedef struct Slots {
    Slot *slots;
    Child *children;
    size_t busy;
} Slots;

static void open_slots(const Pool *pool, Slots *slots)
{
    *slots = (Slots){.slots = calloc(pool->jobs, sizeof *slots->slots),
                     .children = calloc(pool->jobs, sizeof *slots->children)};
    assert(slots->slots != NULL && slots->children != NULL);
    for (size_t i = 0; i < pool->jobs; i++) {
        slots->slots[i].result = malloc(pool->result_size);
        assert(slots->slots[i].result != NULL);
    }
}

static void close_slots(const Pool *pool, Slots *slots)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        child_kill(&slots->children[i]);
        free(slots->slots[i].result);
    }
    free(slots->slots);
    free(slots->children);
}

static bool child_fill(const Pool *pool, Slots *slots, Err *err)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        Slot *slot = &slots->slots[i];
        const void *context;
        if (slot->is_busy) {
            continue;
        }
        if (!pool->next(pool->owner, &slot->number, &context)) {
            return true;
        }
        if (!child_start(&slots->children[i], pool->work, context, slot->result, pool->result_size,
                         pool->limits, err)) {
            return false;
        }
        slot->is_busy = true;
        slots->busy++;
    }
    return true;
}

static bool child_take(const Pool *pool, Slots *slots, Err *err)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        Slot *slot = &slots->slots[i];
        const Child *child = &slots->children[i];
        if (!slot->is_busy || child->end == CHILD_RUNNING) {
            continue;
        }
        slot->is_busy = false;
        slots->busy--;
        if (child->end == CHILD_NO_MEMORY && !pool->takes_no_memory) {
            char words[CHILD_TEXT_SIZE];
            child_describe(child, words);
            return err_set(err, ERR_SOLVER, "a run of its own process %s", words);
        }
        if (!pool->take(pool->owner, slot->number, slot->result, child, err)) {
            return false;
        }
    }
    return true;
}

bool pool_run(const Pool *pool, Err *err)
{
    assert(pool->jobs >= 1);
    Slots slots;
    open_slots(pool, &slots);
    bool is_going = child_fill(pool, &slots, err);
    while (is_going && slots.busy > 0 && pool->wait(pool->owner)) {
        child_wait(slots.children, pool->jobs, PAUSE_S);
        is_going = child_take(pool, &slots, err) && child_fill(pool, &slots, err);
    }
    close_slots(pool, &slots);
    return is_going;
}
