// Runs another program, writes its input and reads its output, both at once and never for ever.
//
// The program runs under a supervisor (engine/supervisor.h), with three channels: sockets, so that
// writing to a program that has gone is an error and no signal. One loop waits for all of them.
#include "engine/converse.h"

#include "base/call.h"
#include "base/clock.h"
#include "base/memory.h"
#include "engine/supervisor.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    CHUNK_SIZE = 1 << 16, // bytes read at a time
    COMPLAINT_SIZE = 512, // bytes kept of what it says on standard error: the last ones
    LINE_MOST = 1 << 24,  // bytes of a line: of some 100,000 bodies
    LOOK_MS = 200,        // between two looks at whether it is still there
};

static const double LEAVING_S = 2.0; // for a program whose output is closed to be gone

typedef enum Channel { CHANNEL_INPUT, CHANNEL_OUTPUT, CHANNEL_COMPLAINTS, CHANNEL_COUNT } Channel;

typedef struct Talk {
    const Converse *with;
    pid_t supervisor;            // ends as the program does
    int channels[CHANNEL_COUNT]; // -1: closed
    size_t written;
    char *line; // that is not whole yet; owned
    size_t line_size;
    size_t line_room;
    size_t read;
    char complaints[COMPLAINT_SIZE];
    size_t complaint_size;
    int status; // as waitpid has it
    bool is_gone;
} Talk;

static void close_channel(Talk *talk, Channel which)
{
    if (talk->channels[which] >= 0) {
        close(talk->channels[which]);
        talk->channels[which] = -1;
    }
}

static bool make_channels(int ours[CHANNEL_COUNT], int theirs[CHANNEL_COUNT])
{
    for (int i = 0; i < CHANNEL_COUNT; i++) {
        int ends[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
            for (int k = 0; k < i; k++) {
                close(ours[k]);
                close(theirs[k]);
            }
            return false;
        }
        // a number of its own above 2, so that none is overwritten as it is put into its place
        ours[i] = ends[0];
        theirs[i] = fcntl(ends[1], F_DUPFD_CLOEXEC, CHANNEL_COUNT);
        close(ends[1]);
        fcntl(ours[i], F_SETFL, O_NONBLOCK);
    }
    return true;
}

static bool converse_start(Talk *talk, Err *err)
{
    int theirs[CHANNEL_COUNT];
    if (access(talk->with->program, X_OK) != 0) {
        return err_set(err, ERR_SOLVER, "%s cannot be run: %s", talk->with->program,
                       strerror(errno));
    }
    if (!make_channels(talk->channels, theirs)) {
        return err_set(err, ERR_SOLVER, "cannot talk to %s: %s", talk->with->program,
                       strerror(errno));
    }
    talk->supervisor = supervisor_start(talk->with->program, theirs);
    const int reason = errno;
    for (int i = 0; i < CHANNEL_COUNT; i++) {
        close(theirs[i]);
    }
    return talk->supervisor > 0 ||
           err_set(err, ERR_SOLVER, "cannot start %s: %s", talk->with->program, strerror(reason));
}

static void write_input(Talk *talk)
{
    const Converse *with = talk->with;
    const ssize_t count = send(talk->channels[CHANNEL_INPUT], with->input + talk->written,
                               with->input_size - talk->written, MSG_NOSIGNAL);
    talk->written += count > 0 ? (size_t)count : 0;
    const bool is_lost = count < 0 && errno != EAGAIN && errno != EINTR;
    if (is_lost || talk->written == with->input_size) {
        // whether all of it was wanted shows in the answer
        close_channel(talk, CHANNEL_INPUT);
    }
}

// Keeps the end of what it complains about.
static void take_complaints(Talk *talk, const char *bytes, size_t size)
{
    const size_t most = sizeof talk->complaints - 1;
    const size_t kept = size < most ? size : most;
    const size_t old = talk->complaint_size + kept > most ? most - kept : talk->complaint_size;
    memmove(talk->complaints, talk->complaints + talk->complaint_size - old, old);
    memcpy(talk->complaints + old, bytes + size - kept, kept);
    talk->complaint_size = old + kept;
    talk->complaints[talk->complaint_size] = '\0';
}

static bool take_output(Talk *talk, const char *bytes, size_t size, Err *err)
{
    talk->read += size;
    if (talk->read > talk->with->output_most) {
        return err_set(err, ERR_SOLVER, "wrote more than %zu MB", talk->with->output_most >> 20);
    }
    for (size_t from = 0; from < size;) {
        const char *end = memchr(bytes + from, '\n', size - from);
        const size_t count = end != NULL ? (size_t)(end - bytes) - from : size - from;
        if (talk->line_size + count > LINE_MOST) {
            return err_set(err, ERR_SOLVER, "wrote a line of more than %d MB", LINE_MOST >> 20);
        }
        if (talk->line_size + count + 1 > talk->line_room) {
            talk->line_room = 2 * (talk->line_size + count + 1);
            talk->line = memory_grown(talk->line, talk->line_room, 1);
        }
        memcpy(talk->line + talk->line_size, bytes + from, count);
        talk->line_size += count;
        from += count + 1;
        if (end != NULL) {
            talk->line[talk->line_size] = '\0';
            const size_t line_size = talk->line_size;
            talk->line_size = 0;
            if (!talk->with->take(talk->line, line_size, talk->with->context, err)) {
                return false;
            }
        }
    }
    return true;
}

// Reads what is there on one channel.
static bool read_channel(Talk *talk, Channel which, Err *err)
{
    char bytes[CHUNK_SIZE];
    const ssize_t count = read(talk->channels[which], bytes, sizeof bytes);
    if (count > 0) {
        if (which == CHANNEL_OUTPUT) {
            return take_output(talk, bytes, (size_t)count, err);
        }
        take_complaints(talk, bytes, (size_t)count);
    } else if (count == 0 || (errno != EAGAIN && errno != EINTR)) {
        close_channel(talk, which);
    }
    return true;
}

// Waits for the channels once and does what they ask for. Writes whether any had something.
static bool converse_once(Talk *talk, int wait_ms, bool *is_busy, Err *err)
{
    struct pollfd watched[CHANNEL_COUNT];
    for (int i = 0; i < CHANNEL_COUNT; i++) {
        watched[i] = (struct pollfd){.fd = talk->channels[i],
                                     .events = i == CHANNEL_INPUT ? POLLOUT : POLLIN};
    }
    const int ready = poll(watched, CHANNEL_COUNT, wait_ms);
    *is_busy = false;
    for (int i = 0; ready > 0 && i < CHANNEL_COUNT; i++) {
        if (watched[i].fd < 0 || watched[i].revents == 0) {
            continue;
        }
        *is_busy = true;
        if (i == CHANNEL_INPUT) {
            write_input(talk);
        } else if (!read_channel(talk, (Channel)i, err)) {
            return false;
        }
    }
    return true;
}

// Whether it has gone; how it ended stands in `status` then.
static bool look_after(Talk *talk)
{
    talk->is_gone =
        talk->is_gone || waitpid(talk->supervisor, &talk->status, WNOHANG) == talk->supervisor;
    return talk->is_gone;
}

static bool converse_until_closed(Talk *talk, Err *err)
{
    const double limit_s = talk->with->time_limit_s;
    const double stop_s = limit_s > 0.0 ? clock_now_s() + limit_s : INFINITY;
    while (talk->channels[CHANNEL_OUTPUT] >= 0) {
        const double left_s = stop_s - clock_now_s();
        bool is_busy;
        if (call_is_cancelled()) {
            return err_set(err, ERR_SOLVER, "%s", CALL_CANCELLED);
        }
        if (!(left_s > 0.0)) {
            return err_set(err, ERR_SOLVER, "took longer than its limit of %.4g s", limit_s);
        }
        const int wait_ms = left_s < 1e-3 * LOOK_MS ? (int)ceil(1e3 * left_s) : LOOK_MS;
        if (!converse_once(talk, wait_ms, &is_busy, err)) {
            return false;
        }
        // it may have left its output open to a process that it has started
        if (!is_busy && look_after(talk)) {
            break;
        }
    }
    return true;
}

// Lets a program end whose output is closed.
static bool converse_see_off(Talk *talk, Err *err)
{
    const double stop_s = clock_now_s() + LEAVING_S;
    while (!look_after(talk)) {
        bool is_busy;
        if (clock_now_s() > stop_s) {
            return err_set(err, ERR_SOLVER, "closed its output and went on");
        }
        if (!converse_once(talk, 1, &is_busy, err)) {
            return false;
        }
        if (talk->channels[CHANNEL_COMPLAINTS] < 0 || !is_busy) {
            usleep(500);
        }
    }
    // what it said last may not have been read yet
    for (bool is_busy = true; is_busy;) {
        if (!converse_once(talk, 0, &is_busy, err)) {
            return false;
        }
    }
    return true;
}

// The last line that it said on standard error.
static const char *last_complaint(Talk *talk)
{
    char *text = talk->complaints;
    size_t size = talk->complaint_size;
    while (size > 0 && text[size - 1] == '\n') {
        text[--size] = '\0';
    }
    const char *line = strrchr(text, '\n');
    return line != NULL ? line + 1 : text;
}

static bool converse_judge(Talk *talk, Err *err)
{
    const char *said = last_complaint(talk);
    const char *mark = said[0] != '\0' ? ": " : "";
    if (WIFSIGNALED(talk->status)) {
        const int number = WTERMSIG(talk->status);
        return err_set(err, ERR_SOLVER, "ended by signal %d (%s)%s%s", number, strsignal(number),
                       mark, said);
    }
    const int code = WEXITSTATUS(talk->status);
    return code == 0 || err_set(err, ERR_SOLVER, "ended with exit status %d%s%s", code, mark, said);
}

// Ends it and all that it has started.
static void converse_end(Talk *talk)
{
    if (talk->supervisor > 0 && !talk->is_gone) {
        supervisor_end(talk->supervisor);
    }
    for (int i = 0; i < CHANNEL_COUNT; i++) {
        close_channel(talk, (Channel)i);
    }
    free(talk->line);
}

bool converse(const Converse *with, Err *err)
{
    Talk talk = {.with = with, .channels = {-1, -1, -1}};
    Err own = {0};
    bool is_done = converse_start(&talk, &own) && converse_until_closed(&talk, &own) &&
                   converse_see_off(&talk, &own) && converse_judge(&talk, &own);
    if (is_done && talk.line_size > 0) {
        is_done = err_set(&own, ERR_SOLVER, "ended in the middle of a line");
    }
    converse_end(&talk);
    return is_done || err_set_lines(err, own.kind, own.text);
}
