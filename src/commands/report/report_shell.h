// What every page has around its contents: a head with a policy (Content-Security-Policy) that
// allows its own script and style sheet, by their hashes, and no request; a title; and at its end
// the data that it carries.
#pragma once

#include "base/text.h"

typedef enum ShellKind {
    SHELL_RUN,   // plots and a mechanism that move, drawn by script
    SHELL_RESULT // tables and pictures that need none; the script saves what the page carries
} ShellKind;

typedef struct Shell {
    ShellKind kind;
    const char *title;
    const char *note; // below the title: which file it is of
    Text script;      // owned
} Shell;

Shell shell_create(ShellKind kind, const char *title, const char *note);
void shell_finish(Shell *shell);

// Appends all up to the contents; and all behind them, with the data in base64 (report_pack.h).
void shell_begin(const Shell *shell, Text *html);
void shell_end(const Shell *shell, const char *data, Text *html);
