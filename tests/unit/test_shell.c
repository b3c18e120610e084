// Is a word that is printed for a shell that word to the shell, and harmless where it stands?
#include "base/shell.h"

#include "base/printable.h"
#include "close.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// names that would do harm in a shell, a comment or a terminal that took them as they are
static const char *const NASTY_NAMES[] = {
    "plain",
    "two words",
    "it's",
    "\"quoted\"",
    "$(false)",
    "`false`",
    "a\\b",
    "ends in \\",
    "\\",
    "-n",
    "--help",
    "-",
    "*",
    "%a%%s",
    "''",
    "'",
    "!x",
    "a;b&c|d>e",
    "~",
    "~root",
    "=ls",
    "#x",
    "",
    " ",
    "c'; touch broken; '.yaml",
    "*/ int broken; /*",
    "what?\?/",
    "a --set b",
    "title=it's",
    ("gr\xc3\xb6\xc3\x9f"
     "e.yaml"),
    "a\nb",
    "a\n\nb'; touch broken; '",
    "-e\nb",
    "\nfirst",
    "last\n",
    "two last\n\n",
    "tab\there",
    "return\rhere",
    "\x1b[31mred\x1b]0;title\a",
    "\xff\xfe no text",
    "cut \xe2\x82",
    "turned \xe2\x80\xae txt.exe",
    "octal\0331 digits behind\n1",
    "all \"$(printf '%d\\n' 1)\" `x` !! at once\n'",
};
enum { NASTY_COUNT = sizeof NASTY_NAMES / sizeof *NASTY_NAMES };

// What a shell makes of the text, fed to it as a command.
static void ask_shell(const char *shell, const char *command, char *answer, size_t size)
{
    setenv("ASKED", command, 1);
    char line[64];
    snprintf(line, sizeof line, "%s -c \"$ASKED\"", shell);
    FILE *stream = popen(line, "r");
    assert_non_null(stream);
    answer[fread(answer, 1, size - 1, stream)] = '\0';
    assert_int_equal(pclose(stream), 0);
}

static void check_word(const char *shell, const char *word)
{
    char answer[256];
    Text text;
    text_init(&text);
    text_append(&text, "printf '%%s.' ");
    shell_append_word(&text, word);
    text_append(&text, " again");
    ask_shell(shell, text.data, answer, sizeof answer);
    char wanted[256];
    snprintf(wanted, sizeof wanted, "%s.again.", word);
    assert_string_equal(answer, wanted);
    text_finish(&text);
}

static void a_word_is_that_word_to_a_shell(void **state)
{
    (void)state;
    const bool has_bash = system("command -v bash >/dev/null") == 0;
    for (size_t i = 0; i < NASTY_COUNT; i++) {
        const char *word = NASTY_NAMES[i];
        // $'...' is no word of every sh yet
        if (word[0] == '\0' || word[strlen(word) - 1] != '\n') {
            check_word("sh", word);
        }
        if (has_bash) {
            check_word("bash", word);
        }
    }
}

static void nothing_in_a_word_ends_a_line_or_reaches_a_terminal(void **state)
{
    (void)state;
    for (size_t i = 0; i < NASTY_COUNT; i++) {
        Text text;
        text_init(&text);
        shell_append_word(&text, NASTY_NAMES[i]);
        assert_true(text.length > 0);
        assert_true(printable_is_shown(text.data));
        assert_null(strchr(text.data, '\n'));
        assert_true(text.data[text.length - 1] != '\\' && text.data[text.length - 1] != '/');
        text_finish(&text);
    }
}

static void a_path_is_no_option(void **state)
{
    (void)state;
    static const char *const PATHS[][2] = {
        {"-h.yaml", "./-h.yaml"},     {"--help", "./--help"}, {"-", "-"}, {"a/-h", "a/-h"},
        {"- x.yaml", "'./- x.yaml'"}, {"./-h", "./-h"},       {"", "''"},
    };
    for (size_t i = 0; i < sizeof PATHS / sizeof *PATHS; i++) {
        char *path = shell_copy_path(PATHS[i][0]);
        assert_string_equal(path, PATHS[i][1]);
        free(path);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_word_is_that_word_to_a_shell),
        cmocka_unit_test(nothing_in_a_word_ends_a_line_or_reaches_a_terminal),
        cmocka_unit_test(a_path_is_no_option),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
