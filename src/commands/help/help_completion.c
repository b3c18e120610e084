// Writes completion for bash and zsh from the tables of the commands.
//
// The scripts hold the words themselves, so that a shell completes without starting the program.
#include "casefile/schema.h"
#include "commands/help/help.h"

#include <stdio.h>
#include <string.h>

enum { NAME_SIZE = 64 };

HelpValue help_value_of(const OptionRow *row)
{
    if (row->value == NULL) {
        return HELP_VALUE_NONE;
    }
    if (row->words != NULL) {
        return row->type == OPTION_CHOICE ? HELP_VALUE_WORDS : HELP_VALUE_LIST;
    }
    if (strcmp(row->value, "KEY=VALUE") == 0) {
        return HELP_VALUE_KEYS;
    }
    if (strncmp(row->value, "FILE", 4) == 0) {
        return HELP_VALUE_FILE;
    }
    return strcmp(row->value, "DIR") == 0 ? HELP_VALUE_FOLDER : HELP_VALUE_OTHER;
}

void help_visit(void (*visit)(const Command *command, const char *name, void *target), void *target)
{
    for (size_t i = 0; COMMANDS[i] != NULL; i++) {
        visit(COMMANDS[i], COMMANDS[i]->name, target);
        for (size_t k = 0; COMMANDS[i]->parts != NULL && COMMANDS[i]->parts[k] != NULL; k++) {
            char name[NAME_SIZE];
            snprintf(name, sizeof name, "%s %s", COMMANDS[i]->name, COMMANDS[i]->parts[k]->name);
            visit(COMMANDS[i]->parts[k], name, target);
        }
    }
}

static void append_words(const char *const *words, Text *text)
{
    for (size_t i = 0; words[i] != NULL; i++) {
        text_append(text, "%s%s", i == 0 ? "" : " ", words[i]);
    }
}

static void append_names(const Command *const *commands, Text *text)
{
    for (size_t i = 0; commands[i] != NULL; i++) {
        text_append(text, "%s%s", i == 0 ? "" : " ", commands[i]->name);
    }
}

// The keys of a case but for those of things that the case names itself.
static void append_keys(Text *text)
{
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        if (strchr(SCHEMA_ROWS[i].path, '*') == NULL) {
            text_append(text, " %s=", SCHEMA_ROWS[i].path);
        }
    }
}

// Whether a command takes files; `help` takes the names of commands.
static bool takes_files(const Command *command)
{
    const char *usage = command->arguments->usage;
    return usage != NULL && (strstr(usage, "CASE") != NULL || strstr(usage, "FILE") != NULL);
}

static bool takes_stores(const Command *command)
{
    const char *usage = command->arguments->usage;
    return usage != NULL && (strstr(usage, "STORE") != NULL || strstr(usage, "sqlite") != NULL);
}

static bool takes_topics(const Command *command)
{
    const char *usage = command->arguments->usage;
    return usage != NULL && strstr(usage, "COMMAND") != NULL;
}

// bash

static void bash_options(const Command *command, const char *name, void *target)
{
    Text *text = target;
    const Arguments *arguments = command->arguments;
    text_append(text, "    '%s')\n        options='", name);
    for (size_t i = 0; i < arguments->option_count; i++) {
        text_append(text, "--%s ", arguments->options[i].name);
    }
    text_append(text, "--help'\n");
    if (command->parts != NULL) {
        text_append(text, "        [ \"$place\" != 2 ] || words='");
        append_names(command->parts, text);
        text_append(text, "'\n");
    }
    if (takes_topics(command)) {
        text_append(text, "        words='case ");
        append_names(COMMANDS, text);
        text_append(text, "'\n");
    } else if (takes_files(command)) {
        text_append(text, "        endings='yaml yml json%s'\n",
                    takes_stores(command) ? " sqlite" : "");
    }
    text_append(text, "        ;;\n");
}

static void bash_value(const OptionRow *row, const char *name, Text *text)
{
    const HelpValue value = help_value_of(row);
    if (value == HELP_VALUE_NONE) {
        return;
    }
    text_append(text, "    '%s --%s'", name, row->name);
    if (row->letter != 0) {
        text_append(text, " | '%s -%c'", name, row->letter);
    }
    text_append(text, ") ");
    switch (value) {
    case HELP_VALUE_WORDS:
    case HELP_VALUE_LIST:
        text_append(text, "kind=%s words='", value == HELP_VALUE_LIST ? "list" : "words");
        append_words(row->words, text);
        text_append(text, "'");
        break;
    case HELP_VALUE_KEYS:
        text_append(text, "kind=keys");
        break;
    case HELP_VALUE_FILE:
        text_append(text, "kind=file");
        break;
    case HELP_VALUE_FOLDER:
        text_append(text, "kind=folder");
        break;
    case HELP_VALUE_OTHER:
    case HELP_VALUE_NONE:
        text_append(text, "kind=other");
        break;
    }
    text_append(text, " ;;\n");
}

static void bash_values(const Command *command, const char *name, void *target)
{
    for (size_t i = 0; i < command->arguments->option_count; i++) {
        bash_value(&command->arguments->options[i], name, target);
    }
}

static const char BASH_HEAD[] =
    "# bash completion of jointplay, made from its tables by 'jointplay help --completion bash'\n"
    "_jointplay()\n"
    "{\n"
    "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
    "    local name=${COMP_WORDS[1]} place=$COMP_CWORD options='' words='' endings='' kind='' "
    "part\n"
    "    COMPREPLY=()\n"
    "    # --option=value are three words to bash\n"
    "    if [ \"$word\" = '=' ]; then\n"
    "        word=''\n"
    "    elif [ \"$before\" = '=' ]; then\n"
    "        before=${COMP_WORDS[COMP_CWORD - 2]}\n"
    "    fi\n";

static const char BASH_TAIL[] =
    "    if [ -z \"$kind\" ]; then\n"
    "        case $word in\n"
    "        -*) COMPREPLY=($(compgen -W \"$options\" -- \"$word\")) ;;\n"
    "        *)\n"
    "            COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
    "            for part in $endings; do kind=file; done\n"
    "            ;;\n"
    "        esac\n"
    "    fi\n"
    "    case $kind in\n"
    "    words) COMPREPLY=($(compgen -W \"$words\" -- \"$word\")) ;;\n"
    "    list)\n"
    "        part=${word%\"${word##*,}\"}\n"
    "        COMPREPLY=($(compgen -P \"$part\" -W \"$words\" -- \"${word##*,}\"))\n"
    "        compopt -o nospace 2>/dev/null\n"
    "        ;;\n"
    "    keys)\n"
    "        COMPREPLY=($(compgen -W \"$keys\" -- \"$word\"))\n"
    "        compopt -o nospace 2>/dev/null\n"
    "        ;;\n"
    "    folder)\n"
    "        compopt -o filenames 2>/dev/null\n"
    "        mapfile -t COMPREPLY < <(compgen -d -- \"$word\")\n"
    "        ;;\n"
    "    file)\n"
    "        compopt -o filenames 2>/dev/null\n"
    "        while IFS= read -r part; do\n"
    "            case \" ${endings:-${part##*.}} \" in\n"
    "            *\" ${part##*.} \"*) COMPREPLY+=(\"$part\") ;;\n"
    "            *) [ ! -d \"$part\" ] || COMPREPLY+=(\"$part\") ;;\n"
    "            esac\n"
    "        done < <(compgen -f -- \"$word\")\n"
    "        ;;\n"
    "    esac\n"
    "}\n"
    "complete -F _jointplay jointplay\n";

void help_completion_bash(Text *text)
{
    text_append(text, "%s    local keys='", BASH_HEAD);
    append_keys(text);
    text_append(text, "'\n    if [ \"$COMP_CWORD\" = 1 ]; then\n"
                      "        COMPREPLY=($(compgen -W '--help --version ");
    append_names(COMMANDS, text);
    text_append(text, "' -- \"$word\"))\n        return\n    fi\n"
                      "    case \"$name ${COMP_WORDS[2]}\" in\n");
    for (size_t i = 0; COMMANDS[i] != NULL; i++) {
        for (size_t k = 0; COMMANDS[i]->parts != NULL && COMMANDS[i]->parts[k] != NULL; k++) {
            text_append(text, "    '%s %s') [ \"$place\" = 2 ] || name='%s %s' ;;\n",
                        COMMANDS[i]->name, COMMANDS[i]->parts[k]->name, COMMANDS[i]->name,
                        COMMANDS[i]->parts[k]->name);
        }
    }
    text_append(text, "    esac\n    case $name in\n");
    help_visit(bash_options, text);
    text_append(text, "    esac\n    case \"$name $before\" in\n");
    help_visit(bash_values, text);
    text_append(text, "    esac\n%s", BASH_TAIL);
}

// zsh

// Words within single quotes; in a specification of _arguments a colon and brackets mean something.
static void zsh_append(const char *words, bool is_specified, Text *text)
{
    for (; *words != '\0'; words++) {
        if (*words == '\'') {
            text_append(text, "'\\''");
        } else {
            const bool is_escaped =
                *words == ':' || *words == '\\' || (is_specified && strchr("[]", *words) != NULL);
            text_append(text, "%s%c", is_escaped ? "\\" : "", *words);
        }
    }
}

static void zsh_described(const Command *const *commands, Text *text)
{
    for (size_t i = 0; commands[i] != NULL; i++) {
        text_append(text, " '%s:", commands[i]->name);
        zsh_append(commands[i]->summary, false, text);
        text_append(text, "'");
    }
}

static void zsh_value(const OptionRow *row, Text *text)
{
    text_append(text, ":%s:", row->value);
    switch (help_value_of(row)) {
    case HELP_VALUE_WORDS:
        text_append(text, "(");
        append_words(row->words, text);
        text_append(text, ")");
        break;
    case HELP_VALUE_LIST:
        text_append(text, "_values -s , %s ", row->name);
        append_words(row->words, text);
        break;
    case HELP_VALUE_KEYS:
        text_append(text, "_jointplay_keys");
        break;
    case HELP_VALUE_FILE:
        text_append(text, "_files");
        break;
    case HELP_VALUE_FOLDER:
        text_append(text, "_files -/");
        break;
    case HELP_VALUE_OTHER:
    case HELP_VALUE_NONE:
        text_append(text, " ");
        break;
    }
}

static void zsh_option(const OptionRow *row, Text *text)
{
    const char *sign = row->value == NULL ? "" : "=";
    const char *often = row->type == OPTION_LIST ? "*" : "";
    if (row->letter != 0) {
        text_append(text, " \\\n            '(-%c --%s)'{-%c,--%s%s}'[", row->letter, row->name,
                    row->letter, row->name, sign);
    } else {
        text_append(text, " \\\n            '%s--%s%s[", often, row->name, sign);
    }
    zsh_append(row->doc, true, text);
    text_append(text, "]");
    if (row->value != NULL) {
        zsh_value(row, text);
    }
    text_append(text, "'");
}

static void zsh_command(const Command *command, const char *name, void *target)
{
    Text *text = target;
    text_append(text, "    '%s')\n", name);
    if (command->parts != NULL) {
        text_append(text, "        local -a parts=(");
        zsh_described(command->parts, text);
        text_append(text, ")\n        (( CURRENT != 2 )) || _describe command parts\n");
    }
    text_append(text, "        _arguments");
    for (size_t i = 0; i < command->arguments->option_count; i++) {
        zsh_option(&command->arguments->options[i], text);
    }
    text_append(text, " \\\n            '(-h --help)'{-h,--help}'[Print this and do nothing]'");
    if (takes_topics(command)) {
        text_append(text, " \\\n            '*:topic:(case ");
        append_names(COMMANDS, text);
        text_append(text, ")'");
    } else if (takes_files(command)) {
        text_append(text, " \\\n            '*:file:_files -g \"*.(yaml|yml|json%s)\"'",
                    takes_stores(command) ? "|sqlite" : "");
    }
    text_append(text, "\n        ;;\n");
}

void help_completion_zsh(Text *text)
{
    text_append(
        text,
        "#compdef jointplay\n"
        "# zsh completion of jointplay, made from its tables by 'jointplay help --completion zsh'\n"
        "_jointplay_keys() {\n    local -a keys=(");
    append_keys(text);
    text_append(text, ")\n    compadd -S '' -- $keys\n}\n"
                      "_jointplay() {\n    local -a commands=(");
    zsh_described(COMMANDS, text);
    text_append(text, ")\n    if (( CURRENT == 2 )); then\n"
                      "        _describe command commands\n"
                      "        _arguments '--version[Print the versions at work]' "
                      "'--help[List the commands]'\n"
                      "        return\n    fi\n"
                      "    shift words\n    (( CURRENT-- ))\n    local name=$words[1]\n"
                      "    case \"$name $words[2]\" in\n");
    for (size_t i = 0; COMMANDS[i] != NULL; i++) {
        for (size_t k = 0; COMMANDS[i]->parts != NULL && COMMANDS[i]->parts[k] != NULL; k++) {
            const char *part = COMMANDS[i]->parts[k]->name;
            text_append(text,
                        "    '%s %s')\n        if (( CURRENT > 2 )); then\n"
                        "            name='%s %s'\n            shift words\n"
                        "            (( CURRENT-- ))\n        fi\n        ;;\n",
                        COMMANDS[i]->name, part, COMMANDS[i]->name, part);
        }
    }
    text_append(text, "    esac\n    case $name in\n");
    help_visit(zsh_command, text);
    text_append(text, "    esac\n}\n_jointplay \"$@\"\n");
}
