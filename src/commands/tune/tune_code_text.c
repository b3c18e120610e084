// What stands in front of every program, and how is a string written?
#include "commands/tune/tune_code_text.h"

#include "base/shell.h"
#include "version.h"

#include <math.h>

void tune_code_string(const char *string, Text *text)
{
    text_append(text, "\"");
    for (; *string != '\0'; string++) {
        const unsigned char letter = (unsigned char)*string;
        if (letter == '"' || letter == '\\' || letter == '?') {
            text_append(text, "\\%c", letter);
        } else if (letter < 0x20 || letter > 0x7e) {
            text_append(text, "\\%03o", letter);
        } else {
            text_append(text, "%c", letter);
        }
    }
    text_append(text, "\"");
}

void tune_code_head(const TuneCode *code, const char *what, const char *compile, Text *text)
{
    text_append(text,
                "// A mechanism with play in its joints in the Open Dynamics Engine, with the "
                "setting that\n// `jointplay tune` found%s. Written by jointplay %s (ODE %s).\n//\n"
                "//   cc THIS_FILE.c -o run %s && ./run > series.csv\n//\n// case     ",
                what, JOINTPLAY_VERSION, JOINTPLAY_ODE_VERSION, compile);
    // as in the command below: a name never ends the comment, nor joins the next line to it
    shell_append_word(text, scenario_path(code->scenario));
    text_append(text, "\n// setting  %s\n// error    %.3g measured", code->words, code->error);
    if (isfinite(code->target)) {
        text_append(text, ", %.3g asked for", code->target);
    }
    text_append(text, "\n// same as  %s\n", code->command);
}
