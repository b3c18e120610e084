// Writes manual pages from the tables of the commands, in the macros man(7).
#include "commands/help/help.h"
#include "version.h"

#include <assert.h>
#include <ctype.h>
#include <stdio.h>
#include <string.h>

// the sections that only the program's own page has
extern const char embedded_man_sections[];

// Text of the tables: a line break starts a line, a backslash and a dash are themselves, and what
// begins a line is no request.
static void man_words(const char *words, size_t length, Text *text)
{
    for (size_t i = 0; i < length; i++) {
        const bool is_first = i == 0 || words[i - 1] == '\n';
        if (is_first && (words[i] == '.' || words[i] == '\'')) {
            text_append(text, "\\&");
        }
        switch (words[i]) {
        case '\n':
            text_append(text, "\n.br\n");
            break;
        case '\\':
            text_append(text, "\\e");
            break;
        case '-':
            text_append(text, "\\-");
            break;
        case '\'':
            text_append(text, "\\(aq");
            break;
        case '^':
            text_append(text, "\\(ha");
            break;
        default:
            text_append(text, "%c", words[i]);
        }
    }
}

static void man_text(const char *words, Text *text)
{
    man_words(words, strlen(words), text);
}

// A way to call a command, one a line of its usage.
static void man_synopsis(const Arguments *arguments, Text *text)
{
    const char *usage = arguments->usage == NULL ? "" : arguments->usage;
    do {
        const size_t length = strcspn(usage, "\n");
        text_append(text, ".PP\n\\fB");
        man_text(arguments->program, text);
        text_append(text, "\\fR [\\fIOPTION\\fR...] ");
        man_words(usage, length, text);
        text_append(text, "\n");
        usage += length + (usage[length] == '\n' ? 1 : 0);
    } while (*usage != '\0');
}

// What the table says of a command, before and behind \v, and what the notes say.
static void man_description(const Arguments *arguments, const char *name, Text *text)
{
    const char *doc = arguments->doc;
    const size_t before = strcspn(doc, "\v");
    man_words(doc, before, text);
    text_append(text, "\n");
    if (doc[before] == '\v') {
        text_append(text, ".PP\n");
        man_text(doc + before + 1, text);
        text_append(text, "\n");
    }
    const char *note = help_notes_find(name, NULL);
    if (note != NULL) {
        text_append(text, ".PP\n");
        man_text(note, text);
        text_append(text, "\n");
    }
}

static void man_option(const OptionRow *row, const char *name, Text *text)
{
    text_append(text, ".TP\n");
    if (row->letter != 0) {
        text_append(text, "\\fB\\-%c\\fR, ", row->letter);
    }
    text_append(text, "\\fB\\-\\-");
    man_text(row->name, text);
    text_append(text, "\\fR");
    if (row->value != NULL) {
        text_append(text, " \\fI");
        man_text(row->value, text);
        text_append(text, "\\fR");
    }
    text_append(text, "\n");
    man_text(row->doc, text);
    const char *note = help_notes_find(name, row->name);
    text_append(text, note == NULL ? "." : ".\n");
    if (note != NULL) {
        man_text(note, text);
    }
    if (row->type == OPTION_CHOICE || row->type == OPTION_COUNT) {
        text_append(text, " Allowed: ");
        for (size_t i = 0; row->type == OPTION_CHOICE && row->words[i] != NULL; i++) {
            text_append(text, "%s", i == 0 ? "" : ", ");
            man_text(row->words[i], text);
        }
        if (row->type == OPTION_COUNT) {
            text_append(text, "%.0f to %.0f", row->low, row->high);
        }
        text_append(text, ".");
    }
    text_append(text, "\n");
}

static void man_options(const Arguments *arguments, const char *name, Text *text)
{
    for (size_t i = 0; i < arguments->option_count; i++) {
        man_option(&arguments->options[i], name, text);
    }
    text_append(text, ".TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nPrint how the command is used.\n");
}

static void man_head(const char *name, const char *summary, Text *text)
{
    text_append(text, ".\\\" Made by 'jointplay help --man' from the tables of the program.\n.TH ");
    for (const char *c = name; *c != '\0'; c++) {
        text_append(text, "%c", toupper((unsigned char)*c));
    }
    text_append(text, " 1 \"\" \"jointplay %s\" \"jointplay\"\n.SH NAME\n", JOINTPLAY_VERSION);
    man_text(name, text);
    text_append(text, " \\- ");
    man_text(summary, text);
    text_append(text, "\n");
}

static void man_part(const Command *command, const char *name, Text *text)
{
    text_append(text, ".SH ");
    for (const char *c = name; *c != '\0'; c++) {
        text_append(text, "%c", toupper((unsigned char)*c));
    }
    text_append(text, "\n");
    man_synopsis(command->arguments, text);
    text_append(text, ".PP\n");
    man_description(command->arguments, name, text);
    man_options(command->arguments, name, text);
}

static void man_see_also(const Command *command, Text *text)
{
    text_append(text, ".SH \"SEE ALSO\"\n\\fBjointplay\\fR(1)");
    for (size_t i = 0; COMMANDS[i] != NULL; i++) {
        if (COMMANDS[i] != command) {
            text_append(text, ",\n\\fBjointplay\\-%s\\fR(1)", COMMANDS[i]->name);
        }
    }
    text_append(text, "\n");
}

static void man_of_command(const Command *command, Text *text)
{
    char name[64];
    snprintf(name, sizeof name, "jointplay-%s", command->name);
    man_head(name, command->summary, text);
    text_append(text, ".SH SYNOPSIS\n");
    man_synopsis(command->arguments, text);
    text_append(text, ".SH DESCRIPTION\n");
    man_description(command->arguments, command->name, text);
    text_append(text, ".SH OPTIONS\n");
    man_options(command->arguments, command->name, text);
    for (size_t i = 0; command->parts != NULL && command->parts[i] != NULL; i++) {
        snprintf(name, sizeof name, "%s %s", command->name, command->parts[i]->name);
        man_part(command->parts[i], name, text);
    }
    text_append(text, ".SH \"EXIT STATUS\"\nAs in \\fBjointplay\\fR(1).\n");
    man_see_also(command, text);
}

static void man_of_program(Text *text)
{
    assert(help_notes_are_of_options());
    man_head("jointplay", "how far can ODE be trusted with a joint that has play, at what cost?",
             text);
    text_append(text, ".SH SYNOPSIS\n\\fBjointplay\\fR \\fICOMMAND\\fR [\\fIOPTION\\fR...] "
                      "[\\fIARGUMENT\\fR...]\n.PP\n\\fBjointplay \\-\\-version\\fR\n"
                      ".SH DESCRIPTION\n"
                      "Runs a mechanism with play in its joints on several solvers, compares them "
                      "with one another, and prints extremes of the motion, the contacts in the "
                      "joints, the error and the cost. Data go to standard output; messages and "
                      "progress go to standard error. Options and arguments may come in any "
                      "order.\n.SH COMMANDS\nEach has a page of its own, such as "
                      "\\fBjointplay\\-run\\fR(1).\n");
    for (size_t i = 0; COMMANDS[i] != NULL; i++) {
        text_append(text, ".TP\n\\fB%s\\fR\n", COMMANDS[i]->name);
        man_text(COMMANDS[i]->summary, text);
        text_append(text, ".\n");
    }
    text_append(text, "%s", embedded_man_sections);
    man_see_also(NULL, text);
}

void help_man(const Command *command, Text *text)
{
    if (command == NULL) {
        man_of_program(text);
    } else {
        man_of_command(command, text);
    }
}
