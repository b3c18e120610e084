// How is the last message of a dying process kept, and kept off the terminal?
//
// Both streams go to a file in memory of limited size; what is written beyond it is dropped.
#define _GNU_SOURCE // memfd_create

#include "commands/study/last_words.h"

#include "base/printable.h"

#include <ctype.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

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
