// Writes files and reports them.
#include "cli/written.h"

#include "base/text.h"
#include "cli/output.h"
#include "write/file.h"

#include <stdio.h>
#include <stdlib.h>

bool written_say(const char *path, bool is_quiet)
{
    if (!is_quiet && !file_is_stream(path)) {
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
