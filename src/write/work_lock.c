// How does one process keep others from its file for as long as it works on it?
#define _GNU_SOURCE // locks of an open file

#include "write/work_lock.h"

#include <errno.h>
#include <fcntl.h>
#include <unistd.h>

enum {
    TRIES = 100, // a second in all: children of a killed process were seen to live on for 0.3 s
    WAIT_US = 10000,
};

static struct flock lock_of(short type, off_t byte)
{
    return (struct flock){.l_type = type, .l_whence = SEEK_SET, .l_start = byte, .l_len = 1};
}

int work_lock_take(int file, off_t byte)
{
    struct flock lock = lock_of(F_WRLCK, byte);
    for (int i = 0; fcntl(file, F_OFD_SETLK, &lock) != 0; i++) {
        if (errno != EACCES && errno != EAGAIN) {
            return errno;
        }
        if (i == TRIES) {
            return EAGAIN;
        }
        usleep(WAIT_US);
    }
    return 0;
}

void work_lock_give(int file, off_t byte)
{
    struct flock lock = lock_of(F_UNLCK, byte);
    fcntl(file, F_OFD_SETLK, &lock);
}

bool work_lock_is_taken(int file, off_t byte)
{
    struct flock lock = lock_of(F_WRLCK, byte);
    return file >= 0 && fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}
