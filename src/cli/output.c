// Who is reading, and did all of it arrive?
#include "cli/output.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool output_is_terminal(FILE *stream)
{
    return isatty(fileno(stream)) == 1;
}

const Style *output_style(FILE *stream)
{
    const char *no_color = getenv("NO_COLOR");
    const char *terminal = getenv("TERM");
    const bool is_refused = no_color != NULL && no_color[0] != '\0';
    const bool is_dumb = terminal != NULL && strcmp(terminal, "dumb") == 0;
    return output_is_terminal(stream) && !is_refused && !is_dumb ? &STYLE_TERMINAL : &STYLE_PLAIN;
}

void output_json(json_t *object)
{
    json_dumpf(object, stdout, RUN_JSON_FLAGS);
    putchar('\n');
    json_decref(object);
}

bool output_end(Err *err)
{
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout)) {
        return true;
    }
    if (errno == EPIPE) {
        return err_set(err, ERR_FILE, "%s", "");
    }
    return err_set(err, ERR_FILE, "cannot write standard output: %s",
                   errno != 0 ? strerror(errno) : "a write failed");
}
