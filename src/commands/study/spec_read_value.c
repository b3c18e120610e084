// What does a value of a study file say, by itself?
#include "base/printable.h"
#include "base/text.h"
#include "commands/study/spec_read.h"

#include <stdarg.h>
#include <string.h>

enum { MESSAGE_SIZE = 256 };

bool spec_read_refuse(const Reading *reading, const Node *node, const char *allowed,
                      const char *format, ...)
{
    char message[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    shorten_list(message, sizeof message, format, arguments);
    va_end(arguments);
    const bool is_missing = node->kind == NODE_SCALAR && node->text[0] == '\0';
    return source_error(&reading->source, is_missing ? keys_span(node) : node->span, allowed,
                        reading->err, "%s", message);
}

bool spec_read_single(const Reading *reading, const Node *node, const char *what,
                      const char *allowed)
{
    return (node->kind == NODE_SCALAR && node->text[0] != '\0') ||
           spec_read_refuse(reading, node, allowed, "%s takes a single value", what);
}

const Node *spec_read_child(const Node *map, const char *name)
{
    const Node *child = map->first;
    while (child != NULL && strcmp(child->key->text, name) != 0) {
        child = child->next;
    }
    return child;
}

const Node *spec_read_first(const Node *list)
{
    return list->kind == NODE_SCALAR ? list : list->first;
}

const Node *spec_read_next(const Node *list, const Node *item)
{
    return item == list ? NULL : item->next;
}

void spec_read_write(const Node *node, Text *text)
{
    static const char PLAIN[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 ._/+^-";
    const char *separator = "";
    if (node->kind == NODE_SCALAR && node->text[0] != '\0' &&
        strspn(node->text, PLAIN) == strlen(node->text)) {
        text_append(text, "%s", node->text);
    } else if (node->kind == NODE_SCALAR) {
        text_append(text, "\"");
        for (const char *c = node->text; *c != '\0'; c++) {
            text_append(text, *c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
        }
        text_append(text, "\"");
    } else {
        text_append(text, node->kind == NODE_LIST ? "[" : "{");
        for (const Node *item = node->first; item != NULL; item = item->next) {
            text_append(text, "%s", separator);
            if (node->kind == NODE_MAP) {
                spec_read_write(item->key, text);
                text_append(text, ": ");
            }
            spec_read_write(item, text);
            separator = ", ";
        }
        text_append(text, node->kind == NODE_LIST ? "]" : "}");
    }
}

bool spec_read_number(Reading *reading, const Node *node, bool is_checked, double *number)
{
    const ProbeKey *key = &reading->key;
    Variable *variable = reading->variable;
    ProbeNumber read;
    if (is_checked && !probe_check(reading->probe, &reading->source, key, node, reading->err)) {
        return false;
    }
    const bool is_word = key->row->zero_word != NULL && node->kind == NODE_SCALAR &&
                         strcmp(node->text, key->row->zero_word) == 0;
    if (is_word) {
        return spec_read_refuse(reading, node, "numbers; the word stands under set",
                                "%s for %s is not a number", node->text, variable->key);
    }
    if (!probe_number(&reading->source, key, node, &read, reading->err)) {
        return false;
    }
    // the unit of a stiffness gives the exponent of its law, that of a span what it counts, that of
    // a backlash whether it is an angle
    const SchemaType type = key->row->type;
    const bool is_stiffness = type == SCHEMA_STIFFNESS;
    const bool has_own_unit =
        is_stiffness || type == SCHEMA_SPAN || type == SCHEMA_COORDINATE || type == SCHEMA_DAMPER;
    if (has_own_unit && variable->unit[0] != '\0' && strcmp(variable->unit, read.unit) != 0) {
        return spec_read_refuse(
            reading, node, is_stiffness ? "values with one exponent" : "values in one unit",
            "this value is in %s, those before it in %s", read.unit, variable->unit);
    }
    text_copy(variable->unit, sizeof variable->unit, read.unit);
    if (has_own_unit) {
        text_copy(variable->column_unit, sizeof variable->column_unit, read.unit);
    }
    *number = read.value;
    return true;
}
