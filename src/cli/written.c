// How does a file come to be there, and who is told?
#include "cli/written.h"

#include "base/text.h"
#include "cli/output.h"
#include "write/file.h"
#include "write/json_value.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

bool written_say(const char *path, bool is_quiet)
{
    if (!is_quiet) {
        output_say("wrote %s\n", path);
    }
    return true;
}

void written_damage(const Journal *journal, bool is_quiet)
{
    Text text;
    text_init(&text);
    journal_describe_damage(journal, &text);
    if (!is_quiet) {
        fputs(text.data, stderr);
    }
    text_finish(&text);
}

bool written_text(FileKind kind, const char *path, const char *text, bool is_quiet, Err *err)
{
    return file_write_text(kind, path, text, err) && written_say(path, is_quiet);
}

bool written_json(const char *path, const json_t *object, bool is_quiet, Err *err)
{
    Text text;
    text_init(&text);
    json_value_write(object, JSON_VALUE_FLAGS, &text);
    text_append(&text, "\n");
    const bool is_written = written_text(FILE_RESULT, path, text.data, is_quiet, err);
    text_finish(&text);
    return is_written;
}
