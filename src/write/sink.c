// Why could a text not be written?
#define _GNU_SOURCE // fopencookie

#include "write/sink.h"

#include <errno.h>
#include <sys/types.h>
#include <unistd.h>

static ssize_t sink_write(void *context, const char *bytes, size_t size)
{
    Sink *sink = context;
    size_t sent = 0;
    while (sent < size && sink->reason == 0) {
        const ssize_t count = write(sink->file, bytes + sent, size - sent);
        sent += count > 0 ? (size_t)count : 0;
        if (count < 0 && errno != EINTR) {
            sink->reason = errno;
        }
    }
    return (ssize_t)sent;
}

// A network file system may report only now that there was no space.
static int sink_close(void *context)
{
    Sink *sink = context;
    const int status = close(sink->file);
    if (status != 0 && sink->reason == 0) {
        sink->reason = errno;
    }
    return status;
}

FILE *sink_open(Sink *sink, int file)
{
    *sink = (Sink){.file = file};
    const cookie_io_functions_t functions = {.write = sink_write, .close = sink_close};
    return fopencookie(sink, "w", functions);
}
