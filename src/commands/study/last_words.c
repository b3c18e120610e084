// How is the complaint of a dying process heard, and no terminal spoilt by it?
//
// Both streams lead to a file in memory, which takes a limited number of bytes and drops the rest.
#define _GNU_SOURCE // memfd_create

#include "commands/study/last_words.h"

#include "base/shorten.h"

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
    const int place = memfd_create("last words", MFD_CLOEXEC);
    // parent and child share one position: each write goes to the end
    if (place >= 0) {
        fcntl(place, F_SETFL, O_APPEND);
    }
    return place;
}

void last_words_close(int place)
{
    if (place >= 0) {
        close(place);
    }
}

void last_words_clear(int place)
{
    if (place >= 0 && ftruncate(place, 0) != 0) {
        // then the words of one child are taken for another's, which is no reason to stop
        return;
    }
}

void last_words_listen(int place)
{
    const int target = place >= 0 ? place : open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(target, STDOUT_FILENO);
    dup2(target, STDERR_FILENO);
    // a write beyond the limit then fails, and ends no one
    const struct rlimit most = {KEPT_MAX, KEPT_MAX};
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &most);
}

void last_words_read(int place, char *line, size_t size)
{
    char tail[TAIL_SIZE + 1];
    struct stat known;
    line[0] = '\0';
    if (place < 0 || fstat(place, &known) != 0) {
        return;
    }
    const off_t from = known.st_size > TAIL_SIZE ? known.st_size - TAIL_SIZE : 0;
    const ssize_t count = pread(place, tail, TAIL_SIZE, from);
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
