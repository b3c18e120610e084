// Checks that each key of a mapping is known, and there once.
#include "casefile/keys.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

Span keys_span(const Node *node)
{
    return node->key != NULL ? node->key->span : node->span;
}

size_t keys_text_start(const Node *node)
{
    const Span span = node->key->span;
    const size_t length = source_count(node->key->text, strlen(node->key->text));
    return span.start + (span.end - span.start > length ? 1 : 0);
}

// 14,5 mm inside braces is a value 14 and a key 5 mm.
static bool is_decimals(const char *name)
{
    const char *rest = name + strspn(name, "0123456789");
    return rest != name && *rest != '-' && *rest != '_';
}

// The choice that a key begins with whose colon was forgotten; NULL where there is none.
static const char *find_begun(const char *name, const char *const *choices, size_t count)
{
    const size_t length = strcspn(name, " ");
    for (size_t i = 0; i < count && name[length] == ' '; i++) {
        if (strncmp(name, choices[i], length) == 0 && choices[i][length] == '\0') {
            return choices[i];
        }
    }
    return NULL;
}

// What is known of a wrong word, as the end of a sentence.
static void append_hint(const char *name, const char *const *choices, size_t count, KeysHint hint,
                        Text *text)
{
    const char *nearest = text_nearest(name, choices, count);
    const char *begun = find_begun(name, choices, count);
    if (hint.words[0] != '\0' && (nearest == NULL || !hint.is_guess)) {
        text_append(text, "; %s", hint.words);
    } else if (begun != NULL) {
        text_append(text, "; a colon is missing behind '%s'", begun);
    } else if (nearest != NULL) {
        text_append(text, "; did you mean '%s'?", nearest);
    } else if (is_decimals(name)) {
        text_append(text, "; numbers have a decimal point");
    }
}

bool keys_refuse(const Source *source, Span span, const char *what, const char *name,
                 const char *const *choices, size_t count, Err *err)
{
    const KeysHint nothing = {"", true};
    return keys_refuse_knowing(source, span, what, name, choices, count, nothing, err);
}

bool keys_refuse_knowing(const Source *source, Span span, const char *what, const char *name,
                         const char *const *choices, size_t count, KeysHint hint, Err *err)
{
    Text allowed;
    Text words;
    text_init(&allowed);
    text_init(&words);
    for (size_t i = 0; i < count; i++) {
        text_append(&allowed, "%s%s", i > 0 ? ", " : "", choices[i]);
    }
    append_hint(name, choices, count, hint, &words);
    source_error(source, span, allowed.data, err, "unknown %s '%.40s'%s", what, name, words.data);
    text_finish(&words);
    text_finish(&allowed);
    return false;
}

bool keys_check_map(const Source *source, const Node *node, Err *err)
{
    if (node->kind == NODE_MAP) {
        return true;
    }
    const bool is_missing = node->kind == NODE_SCALAR && node->text[0] == '\0';
    return source_error(source, is_missing ? keys_span(node) : node->span,
                        "key: value, indented on lines of their own, or as {key: value}", err,
                        "expected a mapping of keys here, found %s",
                        is_missing                ? "nothing"
                        : node->kind == NODE_LIST ? "a list"
                                                  : "a single value");
}

bool keys_check_single(const Source *source, const Node *map, const Node *node, Err *err)
{
    for (const Node *other = map->first; other != node; other = other->next) {
        if (strcmp(other->key->text, node->key->text) == 0) {
            const size_t first = source_line(source, other->key->span.start);
            const size_t second = source_line(source, node->key->span.start);
            char lines[64];
            snprintf(lines, sizeof lines, first == second ? "line %zu" : "lines %zu and %zu", first,
                     second);
            return source_error(source, node->key->span, "one of them", err,
                                "the key '%s' is given twice, in %s", node->key->text, lines);
        }
    }
    return true;
}

bool keys_sort(const Source *source, const Node *map, const char *const *names, size_t count,
               const Node **values, Err *err)
{
    for (size_t i = 0; i < count; i++) {
        values[i] = NULL;
    }
    if (!keys_check_map(source, map, err)) {
        return false;
    }
    for (const Node *child = map->first; child != NULL; child = child->next) {
        size_t number = 0;
        while (number < count && strcmp(names[number], child->key->text) != 0) {
            number++;
        }
        if (number == count) {
            return keys_refuse(source, child->key->span, "key", child->key->text, names, count,
                               err);
        }
        if (!keys_check_single(source, map, child, err)) {
            return false;
        }
        values[number] = child;
    }
    return true;
}
