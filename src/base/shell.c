// Quotes words for a shell.
//
// Single quotes keep all but themselves; a quote is written in double quotes between two such
// words. What cannot be shown is written as "$(printf '\033')", which every POSIX shell has; only a
// word that ends in a line break, which such a substitution drops, needs the newer $'\012'.
#include "base/shell.h"

#include "base/printable.h"

#include <stdbool.h>
#include <string.h>

#define SHELL_LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"

// Without a meaning to any shell. In front, = and the rest of the second has one to some.
static const char BARE[] = SHELL_LETTERS "./_-=+,:%@";
static const char BARE_FIRST[] = SHELL_LETTERS "./_-+,:@";
// Without a meaning to printf, and to a shell within double quotes.
static const char PLAIN[] = SHELL_LETTERS " ./_-=+,:@#()[]{};<>|&*~^";

static bool is_bare(const char *word)
{
    return word[0] != '\0' && strchr(BARE_FIRST, word[0]) != NULL &&
           strspn(word, BARE) == strlen(word);
}

static void append_quoted(Text *text, const char *word)
{
    text_append(text, "'");
    for (; *word != '\0'; word++) {
        text_append(text, *word == '\'' ? "'\"'\"'" : "%c", *word);
    }
    text_append(text, "'");
}

static void append_octal(Text *text, const char *word)
{
    const size_t length = strlen(word);
    const bool ends_a_line = word[length - 1] == '\n';
    text_append(text, ends_a_line ? "$'" : "\"$(printf '");
    for (size_t i = 0; i < length; i++) {
        // a dash in front would be an option of printf
        const bool is_plain = strchr(PLAIN, word[i]) != NULL && (i > 0 || word[i] != '-');
        text_append(text, is_plain ? "%c" : "\\%03o", (unsigned char)word[i]);
    }
    text_append(text, ends_a_line ? "'" : "')\"");
}

void shell_append_word(Text *text, const char *word)
{
    if (is_bare(word)) {
        text_append(text, "%s", word);
    } else if (printable_is_shown(word)) {
        append_quoted(text, word);
    } else {
        append_octal(text, word);
    }
}

void shell_append_path(Text *text, const char *path)
{
    if (path[0] == '-' && path[1] != '\0') {
        Text safe;
        text_init(&safe);
        text_append(&safe, "./%s", path);
        shell_append_word(text, safe.data);
        text_finish(&safe);
        return;
    }
    shell_append_word(text, path);
}

char *shell_copy_path(const char *path)
{
    Text text;
    text_init(&text);
    shell_append_path(&text, path);
    // the text's memory is the caller's now
    return text.data;
}
