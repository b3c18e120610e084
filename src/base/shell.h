// Words of a command line that the program prints, written so that a shell gives them back byte for
// byte, and so that nothing of a user's in them ends a comment, reaches a terminal raw or is run.
#pragma once

#include "base/text.h"

// Appends a word: bare where nothing in it means anything to a shell, else in single quotes, and
// what cannot be shown (printable.h) by octal numbers that printf turns back. What is appended has
// only characters that can be shown, and never ends in a backslash.
void shell_append_word(Text *text, const char *word);

// The same of a path, as an argument: one that begins with a dash gets "./" in front, so that it is
// no option. "-" is standard input and stays.
void shell_append_path(Text *text, const char *path);

// Such a path by itself, for a message; the caller frees it.
char *shell_copy_path(const char *path);
