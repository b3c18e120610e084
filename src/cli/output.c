// Lays out output, and makes sure that all of it was written.
#include "cli/output.h"

#include "base/printable.h"
#include "write/file.h"
#include "write/json_value.h"

#include <assert.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

// Characters: a terminal's width is ignored outside this range.
enum { WIDTH_MIN = 40, WIDTH_MAX = 1000 };

// why standard output could not be written
static Sink sink;

static int descriptor_of(const FILE *stream)
{
    return stream == stderr ? STDERR_FILENO : STDOUT_FILENO;
}

bool output_is_terminal(FILE *stream)
{
    return isatty(descriptor_of(stream)) == 1;
}

void output_begin(void)
{
    stdout = sink_open(&sink, STDOUT_FILENO);
    assert(stdout != NULL);
    setvbuf(stdout, NULL, output_is_terminal(stdout) ? _IOLBF : _IOFBF, BUFSIZ);
}

// The columns of the terminal that a stream goes to.
static size_t terminal_width(FILE *stream)
{
    const char *columns = getenv("COLUMNS");
    struct winsize size;
    size_t width = columns != NULL ? strtoul(columns, NULL, 10) : 0;
    if (width == 0 && ioctl(descriptor_of(stream), TIOCGWINSZ, &size) == 0) {
        width = size.ws_col;
    }
    return width >= WIDTH_MIN && width <= WIDTH_MAX ? width : STYLE_WIDTH;
}

Style output_style(FILE *stream, bool is_wide)
{
    const char *no_color = getenv("NO_COLOR");
    const char *terminal = getenv("TERM");
    const bool is_refused = no_color != NULL && no_color[0] != '\0';
    const bool is_dumb = terminal != NULL && strcmp(terminal, "dumb") == 0;
    const bool is_terminal = output_is_terminal(stream);
    Style style = is_terminal && !is_refused && !is_dumb ? STYLE_TERMINAL : STYLE_PLAIN;
    style.width = is_wide ? 0 : is_terminal ? terminal_width(stream) : STYLE_WIDTH;
    return style;
}

void output_fold(Text *text, const Style *style)
{
    const char *const marks[] = {style->heading, style->failure, style->end, NULL};
    text_show(text, marks);
    text_fold(text, style->width > 0 ? style->width : STYLE_WIDTH);
}

void output_text(Text *text, const Style *style)
{
    output_fold(text, style);
    fputs(text->data, stdout);
}

void output_json(json_t *object)
{
    Text text;
    text_init(&text);
    json_value_write(object, JSON_VALUE_FLAGS, &text);
    text_append(&text, "\n");
    fputs(text.data, stdout);
    text_finish(&text);
    json_decref(object);
}

void output_say(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *words = printable_format(format, arguments);
    va_end(arguments);
    fputs(words, stderr);
    free(words);
}

bool output_end(Err *err)
{
    fflush(stdout);
    if (sink.reason == 0) {
        return true;
    }
    if (sink.reason == EPIPE) {
        return err_set(err, ERR_FILE, "%s", "");
    }
    return err_set(err, ERR_FILE, "cannot write standard output: %s", strerror(sink.reason));
}
